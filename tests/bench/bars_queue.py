"""Bars of a long queue: submission, list, restart, claim."""
import json
import random
import shutil
import sqlite3
import threading
import time

from bars_service import BarService, Client, run_tool, small_body, until
from bars_table import Bar, Disk, timed_ms

CLIENTS = 8
ROUNDS = 3


def submit_many(service, body, count, seconds_max):
    """Submits through the API, by several clients at once, and stops when it takes too long."""
    left = [count]
    lock = threading.Lock()
    end = time.monotonic() + seconds_max
    trouble = []

    def submit_some():
        client = service.connect()
        try:
            while not trouble and time.monotonic() < end:
                with lock:
                    if left[0] == 0:
                        return
                    left[0] -= 1
                client.submit(body)
        except BaseException as error:  # also SystemExit: the others must not go on without it
            trouble.append(error)
        finally:
            client.close()
    threads = [threading.Thread(target=submit_some) for _ in range(CLIENTS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if trouble:
        raise SystemExit(f"filling the queue failed: {trouble[0]}")


def count_queued(service):
    client = service.connect()
    try:
        return client.json("GET", "/v1/queue")["jobs"]["queued"]
    finally:
        client.close()


def copy_last_job(data, count):
    """Rows and files as the service left them for its newest job, under new ids."""
    with sqlite3.connect(data / "keylume.db") as database:
        seq, job = database.execute("SELECT seq, id FROM job ORDER BY seq DESC LIMIT 1").fetchone()
        tables = {name: [row[1] for row in database.execute(f"PRAGMA table_info({name})")]
                  for name in ("job", "job_input", "event")}
        for _ in range(count):
            new_id = "job_" + "".join(random.choices("ABCDEFGHJKMNPQRSTVWXYZ0123456789", k=26))
            shutil.copytree(data / "jobs" / job, data / "jobs" / new_id)
            columns = [name for name in tables["job"] if name not in ("seq", "id")]
            new_seq = database.execute(f"INSERT INTO job(id, {', '.join(columns)}) SELECT ?, {', '.join(columns)} "
                                       "FROM job WHERE seq = ?", (new_id, seq)).lastrowid
            for table in ("job_input", "event"):
                columns = [name for name in tables[table] if name not in ("id", "job_seq")]
                database.execute(f"INSERT INTO {table}(job_seq, {', '.join(columns)}) SELECT ?, {', '.join(columns)} "
                                 f"FROM {table} WHERE job_seq = ?", (new_seq, seq))
    database.close()


def fill_up(service, body, count, seconds_max):
    before = count_queued(service)
    begun = time.monotonic()
    submit_many(service, body, count - before, seconds_max)
    submitted = count_queued(service) - before
    print(f"{submitted} jobs submitted by {CLIENTS} clients in {time.monotonic() - begun:.0f} s", flush=True)
    if before + submitted < count:
        print(f"the other {count - before - submitted} are copies of the last of them", flush=True)
        service.stop()
        copy_last_job(service.data, count - before - submitted)
        service.start_again()


def submit_bar(service, body, disk, name, count):
    client = service.connect()
    rounds = []
    for _ in range(ROUNDS):
        times = []
        for _ in range(count):
            times.append(timed_ms(lambda: client.submit(body)))
            disk.probe()
        rounds.append(times)
    client.close()
    bar = Bar(name, 50, "ms", rounds)
    bar.note = disk.note(bar.median())
    return bar


def list_bars(service, given):
    client = service.connect()
    pages = {"list, newest 50": "/v1/jobs?limit=50", "list, newest 200": "/v1/jobs?limit=200",
             "list, those queued": "/v1/jobs?state=queued&limit=50"}
    last = client.json("GET", "/v1/jobs?limit=200")
    for _ in range(given.jobs // 400 - 1):
        last = client.json("GET", f"/v1/jobs?limit=200&cursor={last['next_cursor']}")
    pages["list, a page far down"] = f"/v1/jobs?limit=50&cursor={last['next_cursor']}"
    bars = []
    for name, path in pages.items():
        rounds = [[timed_ms(lambda: client.json("GET", path)) for _ in range(given.requests)] for _ in range(ROUNDS)]
        bars.append(Bar(name, 50, "ms", rounds))
    client.close()
    return bars


def is_ready(port):
    client = Client(port)
    try:
        return client.ask("GET", "/readyz")[0] == 200
    except OSError:
        return False
    finally:
        client.close()


def restart_bar(service, repetitions):
    times = []
    for _ in range(repetitions):
        service.stop()
        begun = time.monotonic()
        service.spawn()
        until(lambda: is_ready(service.port), 60, "/readyz says 200")
        times.append(time.monotonic() - begun)
    return Bar("restart to ready", 2, "s", [times], judged="median", note=f"slowest {max(times):.3f} s")


def queue_bars(programs, folder, given):
    data = folder / "queue"
    service = BarService(programs.server, programs.worker, data)
    disk = Disk(folder)
    try:
        body = small_body(folder / "small")
        client = service.connect()
        client.json("POST", "/v1/queue/pause")
        bars = [submit_bar(service, body, disk, "submit, short queue", given.submissions)]
        last = ROUNDS * given.submissions
        client.close()
        fill_up(service, body, given.jobs - last, given.fill_seconds)
        bars.append(submit_bar(service, body, disk, "submit, long queue", given.submissions))
        bars += list_bars(service, given)
        bars.append(Bar("memory, idle, long queue", 64, "MiB", [[service.memory_mib("VmRSS")]], judged="median"))
        bars.append(restart_bar(service, given.restarts))
        service.stop()
    finally:
        service.kill()
    return bars + claim_bars(programs, data, given)


def claim_bars(programs, data, given):
    """The store's own code on the database that the server left: claims cannot be seen from outside."""
    rounds, commits = [], []
    for _ in range(ROUNDS):
        told = json.loads(run_tool(programs.claim_times, data, given.claims))
        rounds.append(told["claims_ms"])
        commits.append(told["commits_ms"])
    claim, commit = Bar("claim", 5, "ms", rounds), Bar("a commit alone", 5, "ms", commits)
    claim.note = (f"beside it a commit of one changed number {commit.median():.2f} ms, p99 {commit.p99():.2f} ms; "
                  f"{claim.median() / commit.median():.1f} times as long")
    return [claim]
