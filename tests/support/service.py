"""A real server in a data folder of its own, on a free port; ends only what it started.
Where KEYLUME_CONTAINER names an image it runs in a container of that."""
import hashlib
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from container import popen
from curl import curl

SERVER = os.environ["KEYLUME_SERVER"]
WORKER = os.environ["KEYLUME_WORKER"]
FINAL_STATES = ("succeeded", "failed", "canceled")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_until(condition, timeout_s, what):
    """The first true value of `condition()`."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"not within {timeout_s} s: {what}")


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def hashes_of(folder):
    """SHA-256 of every file below the folder, by its path in there."""
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


class Service:
    def __init__(self, data):
        self.data = Path(data)
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.process = None
        self.log = self.data.parent / f"{self.data.name}.log"

    def command(self):
        return [SERVER, "--data", str(self.data), "--listen", f"127.0.0.1:{self.port}"]

    def start(self):
        with self.log.open("ab") as log:
            self.process = popen(self.command(), stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        wait_until(self.answers, 20, "the server answers /healthz\n" + self.log.read_text(errors="replace"))
        return self

    def answers(self):
        if self.process.poll() is not None:
            raise AssertionError(f"the server ended with {self.process.returncode}:\n{self.log.read_text()}")
        return self.answers_quietly()

    def answers_quietly(self):
        try:
            return curl(self.url + "/healthz", timeout_s=2).status == 200
        except subprocess.CalledProcessError:
            return False

    def stop(self):
        """-> exit code after SIGTERM"""
        self.process.terminate()
        return self.process.wait(timeout=20)

    def kill(self):
        self.process.kill()
        self.process.wait(timeout=20)

    def worker_pids(self):
        """Workers that run on jobs of this data folder, whoever is their parent by now."""
        found = []
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
            except OSError:
                continue
            is_ours = any(word.startswith(str(self.data)) for word in words)
            if is_ours and "render" in words and Path(words[0]).name == Path(WORKER).name and is_alive(entry.name):
                found.append(int(entry.name))
        return found

    def kill_workers(self):
        for pid in self.worker_pids():
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def clean_up(self):
        if self.process and self.process.poll() is None:
            self.kill()
        self.kill_workers()

    def get(self, path, *arguments):
        return curl(self.url + path, *arguments)

    def submit(self, job, path="/v1/jobs"):
        """`job`: a folder with scene.obj, one MTL or more, animation.json -> Answer"""
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}"]
        fields += [f"materials=@{path}" for path in sorted(job.glob("*.mtl"))]
        return curl(self.url + path, *(word for field in fields for word in ("-F", field)))

    def job(self, job_id):
        return self.get(f"/v1/jobs/{job_id}").json()

    def wait_for(self, job_id, states, timeout_s):
        def reached():
            job = self.job(job_id)
            if job["state"] in FINAL_STATES and job["state"] not in states:
                raise AssertionError(f"the job ended so: {job}\n{self.get(f'/v1/jobs/{job_id}/log').body.decode()}")
            return job if job["state"] in states else None
        return wait_until(reached, timeout_s, f"job in state {' or '.join(states)}")

    def job_folder(self, job_id):
        """Where the job's files lie on disk; None when there are none."""
        found = [path for path in self.data.rglob(job_id) if path.is_dir()]
        return found[0] if found else None


class ServiceTestCase(unittest.TestCase):
    """Gives each test a temporary folder and, by service(), servers that end with it."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="keylume-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def service(self, name="data"):
        service = Service(self.folder / name)
        self.addCleanup(service.clean_up)
        return service.start()

    def submitted(self, service, job):
        """Submits and expects it to be queued -> job id"""
        answer = service.submit(job)
        self.assertEqual(answer.status, 202, answer.body.decode(errors="replace"))
        return answer.json()["id"]
