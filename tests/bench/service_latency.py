#!/usr/bin/env python3
"""What the service adds to `keylume render`: the same job through both, in turns. No time is judged.

usage: service_latency.py KEYLUME KEYLUME_SERVER [--example garage] [--preset draft] [--repetitions 5] [--poll-ms 10]

A client submits the example, asks for the job and its first picture every --poll-ms, and fetches the radiosity as soon as
it is there. By hand the worker runs at the niceness it has under the service, so that on a busy machine both wait
for the processor alike. Prints medians: seconds since the submission began, and processor seconds of all processes.
"""
import argparse
import http.client
import json
import os
import shutil
import socket
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent.parent / "api/examples"
NICENESS = 10
TICKS = os.sysconf("SC_CLK_TCK")
BOUNDARY = "keylume-latency"
TIMEOUT_S = 600


def write_input(folder, example, preset):
    folder.mkdir(parents=True)
    for path in (EXAMPLES / example).iterdir():
        if path.suffix in (".obj", ".mtl"):
            shutil.copy(path, folder)
    job = json.loads((EXAMPLES / example / "animation.json").read_text())
    job["lighting"] = {**job.get("lighting", {}), "preset": preset}
    (folder / "animation.json").write_text(json.dumps(job))
    return folder


def multipart(folder):
    roles = {".obj": "scene", ".mtl": "materials", ".json": "animation"}
    parts = [f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="{roles[path.suffix]}"; filename="{path.name}"'
             f"\r\n\r\n".encode() + path.read_bytes() + b"\r\n" for path in sorted(folder.iterdir())]
    return b"".join(parts) + f"--{BOUNDARY}--\r\n".encode()


class Service:
    def __init__(self, server, worker, data, *options):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.process = subprocess.Popen([server, "--data", data, "--worker", worker, "--listen",
                                         f"127.0.0.1:{self.port}", *options],
                                        stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        while not self.answers():
            time.sleep(0.05)

    def answers(self):
        if self.process.poll() is not None:
            raise SystemExit(f"the server ended with {self.process.returncode}")
        try:
            return self.ask("GET", "/healthz")[0] == 200
        except OSError:
            self.connection.close()
            return False

    def ask(self, method, path, body=None, **headers):
        self.connection.request(method, path, body, headers)
        answer = self.connection.getresponse()
        return answer.status, answer.read()

    def processor_s(self):
        """Of the server and of the workers that have ended."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return sum(int(field) for field in fields[11:15]) / TICKS

    def stop(self):
        self.connection.close()
        self.process.terminate()
        self.process.wait(timeout=30)


def through_service(service, body, poll_s):
    """-> {stamp: seconds since the submission began}"""
    used = service.processor_s()
    began = time.monotonic()
    stamps = {}

    def stamp(name):
        stamps.setdefault(name, time.monotonic() - began)
    status, text = service.ask("POST", "/v1/jobs", body, **{"Content-Type": f"multipart/form-data; boundary={BOUNDARY}"})
    stamp("answered 202")
    if status != 202:
        raise SystemExit(f"the job is refused: {text.decode()}")
    job = f"/v1/jobs/{json.loads(text)['id']}"
    state = "queued"
    while state != "succeeded":
        time.sleep(poll_s)
        state = json.loads(service.ask("GET", job)[1])["state"]
        if state != "queued":
            stamp("seen running")
        if "first picture" not in stamps and service.ask("GET", job + "/frames/0/image.png")[0] == 200:
            stamp("first picture")  # those that are rendered are served while the job runs
        if state in ("failed", "canceled") or time.monotonic() - began > TIMEOUT_S:
            raise SystemExit(f"the job is {state}")
    stamp("seen succeeded")
    if "first picture" not in stamps or service.ask("GET", job + "/radiosity.npy")[0] != 200:
        raise SystemExit("no picture, or no radiosity")
    stamp("radiosity")
    report = json.loads(service.ask("GET", job + "/report.json")[1])
    stamps["worker says"] = dict((count["name"], count["value"]) for count in report["counts"])["wall_seconds"]
    service.ask("DELETE", job)
    service.connection.close()  # the server would, while nothing is asked of it; the next request opens another
    stamps["processor"] = service.processor_s() - used
    return stamps


def by_hand(worker, folder):
    shutil.rmtree(folder / "artefacts", ignore_errors=True)
    began = time.monotonic()
    process = subprocess.Popen(["nice", "-n", str(NICENESS), worker, "render", "--again", folder],
                               stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"keylume render ended with {process.returncode}")
    return {"by hand": time.monotonic() - began, "by hand, processor": usage.ru_utime + usage.ru_stime}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("worker", type=Path)
    parser.add_argument("server", type=Path)
    parser.add_argument("--example", default="garage")
    parser.add_argument("--preset", default="draft")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--poll-ms", type=float, default=10)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="keylume-latency-") as name:
        folder = Path(name)
        body = multipart(write_input(folder / "job/input", given.example, given.preset))
        service = Service(given.server.resolve(), given.worker.resolve(), folder / "data")
        try:
            runs = [{**through_service(service, body, given.poll_ms / 1000), **by_hand(given.worker, folder / "job")}
                    for _ in range(given.repetitions)]
        finally:
            service.stop()
    for run in runs:
        run["added by the service"] = run["seen succeeded"] - run["by hand"]
        run["added around the worker"] = run["seen succeeded"] - run["worker says"]
        run["added, processor"] = run["processor"] - run["by hand, processor"]
    print(f"{given.example}, preset {given.preset}, medians of {given.repetitions} (least .. most) [s]")
    for key in runs[0]:
        values = [run[key] for run in runs]
        print(f"  {key:24} {statistics.median(values):7.3f}  ({min(values):.3f} .. {max(values):.3f})")


if __name__ == "__main__":
    main()
