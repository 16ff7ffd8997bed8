"""Bars of many clients at once: health beside slow ones, cancel, small GETs."""
import re
import selectors
import socket
import subprocess
import threading
import time

from bars_service import BarService, Client, long_body, small_body, until
from bars_table import Bar, timed_ms

SLOW_CLIENTS = 200
LISTENERS = 32
DRIBBLE_EVERY_S = 1


class Crowd:
    """Clients that send a head byte by byte, or nothing, and are there again when they are cut off; and listeners."""

    def __init__(self, port):
        self.port = port
        self.over = threading.Event()
        self.slow, self.listeners = [], []
        self.came_back = 0
        for i in range(SLOW_CLIENTS):
            self.slow.append(self.connect(self.head_of(i)))
        for _ in range(LISTENERS):
            self.listeners.append(self.connect(b"GET /v1/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"))
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    @staticmethod
    def head_of(i):
        return (b"", b"GET /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")[i % 2]

    def connect(self, first):
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=30)
        connection.sendall(first)
        return connection

    def run(self):
        while not self.over.wait(DRIBBLE_EVERY_S):
            for i, connection in enumerate(self.slow):
                try:
                    if i % 2 == 1:
                        connection.sendall(b"a")
                    if self.is_closed(connection):
                        raise ConnectionError
                except OSError:
                    connection.close()
                    self.slow[i] = self.connect(self.head_of(i))
                    self.came_back += 1

    @staticmethod
    def is_closed(connection):
        connection.setblocking(False)
        try:
            return connection.recv(4096) == b""
        except BlockingIOError:
            return False
        finally:
            connection.settimeout(30)

    def listening(self):
        """How many of the listeners have been told something."""
        count = 0
        with selectors.DefaultSelector() as selector:
            for connection in self.listeners:
                selector.register(connection, selectors.EVENT_READ)
            for key, _ in selector.select(0):
                count += key.fileobj.recv(4096, socket.MSG_PEEK).startswith(b"HTTP/1.1 200")
        return count

    def stop(self):
        self.over.set()
        self.thread.join()
        for connection in self.slow + self.listeners:
            connection.close()


def health_rounds(port, count):
    def once():
        client = Client(port)
        try:
            status, _ = client.ask("GET", "/healthz")
        finally:
            client.close()
        if status != 200:
            raise SystemExit(f"/healthz: {status}")
    rounds = []
    for _ in range(3):
        rounds.append([])
        for _ in range(count):
            rounds[-1].append(timed_ms(once))
            time.sleep(0.005)
    return rounds


def health_bars(programs, folder, given):
    service = BarService(programs.server, programs.worker, folder / "health")
    crowd = None
    try:
        crowd = Crowd(service.port)
        until(lambda: crowd.listening() == LISTENERS, 60, f"{LISTENERS} clients listen", 0.1)
        bars = [Bar("health, main listener", 100, "ms", health_rounds(service.port, given.requests)),
                Bar("health, second listener", 100, "ms", health_rounds(service.ops_port, given.requests))]
        for bar in bars:
            bar.note = (f"{SLOW_CLIENTS} slow clients (cut off and back {crowd.came_back} times), "
                        f"{crowd.listening()} listeners; a new connection each")
        return bars
    finally:
        if crowd:
            crowd.stop()
        service.kill()


def worker_pids(server_pid):
    run = subprocess.run(["ps", "-o", "pid=", "--ppid", str(server_pid)], capture_output=True, text=True, check=False)
    return [int(word) for word in run.stdout.split()]


def is_alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def cancel_bar(programs, folder, given):
    service = BarService(programs.server, programs.worker, folder / "cancel")
    body = long_body(folder / "long")
    client = service.connect()
    times = []
    try:
        for _ in range(given.cancels):
            job = client.submit(body)
            until(lambda: client.json("GET", f"/v1/jobs/{job}")["state"] == "running", 30, "the job runs", 0.01)
            until(lambda: worker_pids(service.process.pid), 10, "there is a worker", 0.01)
            time.sleep(0.5 + 0.3 * len(times) % 1.7)  # at different stages
            pids = worker_pids(service.process.pid)
            begun = time.monotonic()
            client.json("POST", f"/v1/jobs/{job}/cancel", 200, 202)
            until(lambda: not any(map(is_alive, pids)), 30, "the worker is dead")
            times.append(time.monotonic() - begun)
            until(lambda: client.json("GET", f"/v1/jobs/{job}")["state"] == "canceled", 10, "the job is canceled", 0.01)
    finally:
        service.kill()
    return Bar("cancel to dead worker", 1, "s", [times], note=f"slowest {max(times):.3f} s")


def requests_per_s(port, path, seconds):
    told = subprocess.run(["wrk", "-t1", "-c16", f"-d{seconds}s", f"http://127.0.0.1:{port}{path}"],
                          capture_output=True, text=True, timeout=60 + seconds, check=True).stdout
    if "Non-2xx" in told:
        raise SystemExit(f"{path}: {told}")
    return float(re.search(r"Requests/sec:\s+([\d.]+)", told)[1])


def small_get_bars(programs, folder, given):
    service = BarService(programs.server, programs.worker, folder / "gets")
    try:
        client = service.connect()
        client.json("POST", "/v1/queue/pause")
        job = client.submit(small_body(folder / "get-job"))
        client.close()
        return [Bar(f"small GETs, {name}", 20000, "/s",
                    [[requests_per_s(service.port, path, given.wrk_seconds) for _ in range(3)]], at_least=True,
                    judged="median", note="wrk, 16 connections, on the same cores")
                for name, path in (("/version", "/version"), ("/healthz", "/healthz"), ("a job", f"/v1/jobs/{job}"))]
    finally:
        service.kill()
