"""A server of the bench's own, and what clients do with it. Connections are kept, as clients keep them."""
import http.client
import json
import re
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))

from service_latency import BOUNDARY, Service, multipart  # noqa: E402
from small_jobs import write_job  # noqa: E402

FORM = {"Content-Type": f"multipart/form-data; boundary={BOUNDARY}"}


class BarService(Service):
    def __init__(self, server, worker, data, *options):
        super().__init__(server, worker, data, *options)
        self.data = Path(data)
        ports = self.listening_ports() - {self.port}
        self.ops_port = ports.pop() if ports else None

    def spawn(self):
        self.process = subprocess.Popen(self.process.args, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start_again(self):
        self.spawn()
        until(self.answers, 60, "the server answers", 0.05)

    def listening_ports(self):
        """Of the server, as the kernel knows them."""
        own = {str(link.readlink()) for link in Path(f"/proc/{self.process.pid}/fd").iterdir()}
        ports = set()
        for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in own:
                ports.add(int(words[1].split(":")[1], 16))
        return ports

    def connect(self):
        return Client(self.port)

    def memory_mib(self, field):
        """VmRSS: now; VmHWM: the highest since forget_highest()."""
        text = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(rf"^{field}:\s+(\d+) kB", text, re.MULTILINE)[1]) / 1024

    def forget_highest(self):
        Path(f"/proc/{self.process.pid}/clear_refs").write_text("5")

    def kill(self):
        self.connection.close()
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(timeout=30)


class Client:
    """One connection; opened anew where the server has closed it meanwhile."""

    def __init__(self, port):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=120)

    def ask(self, method, path, body=None, **headers):
        for attempt in (1, 2):
            try:
                self.connection.request(method, path, body, headers)
                answer = self.connection.getresponse()
                return answer.status, answer.read()
            except (ConnectionError, http.client.RemoteDisconnected):
                self.connection.close()
                if attempt == 2 or method != "GET":
                    raise
        raise AssertionError("not reached")

    def json(self, method, path, *expected):
        status, text = self.ask(method, path)
        if status not in (expected or (200,)):
            raise SystemExit(f"{method} {path}: {status} {text[:500]!r}")
        return json.loads(text)

    def submit(self, body):
        """-> job id"""
        self.connection.request("POST", "/v1/jobs", body, FORM)
        answer = self.connection.getresponse()
        text = answer.read()
        if answer.status != 202:
            raise SystemExit(f"the job is refused: {answer.status} {text[:500]!r}")
        return json.loads(text)["id"]

    def close(self):
        self.connection.close()


def small_body(folder):
    return multipart(write_job(folder, frames=2))


def long_body(folder):
    return multipart(write_job(folder, frames=60, line_count=50_000_000))


def until(condition, timeout_s, what, every_s=0.002):
    deadline = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f"not within {timeout_s} s: {what}")
        time.sleep(every_s)


def run_tool(*words, timeout_s=120):
    run = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=timeout_s)
    if run.returncode != 0:
        raise SystemExit(f"{words[0]} ended with {run.returncode}: {run.stderr[-1000:]}")
    return run.stdout
