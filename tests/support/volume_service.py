"""A service in a container with a named volume, as a user runs it: its data is seen through HTTP alone."""
import hashlib
import io
import json
import os
import signal
import tarfile
import time
import uuid
from pathlib import Path

from container import CONFINED, IMAGE, LABEL, docker
from curl import curl
from service import Service, ServiceTestCase, free_port, wait_until

UNLIMITED = ("--insecure-public", "--rate-limit", "0")


class VolumeService(Service):
    def __init__(self, volume, options=UNLIMITED, run=(), confined=CONFINED):
        self.volume, self.options, self.run, self.confined = volume, list(options), list(run), list(confined)
        self.name = f"keylume-test-{uuid.uuid4().hex[:12]}"
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"

    def create(self):
        docker("create", f"--name={self.name}", f"--label={LABEL}", f"--volume={self.volume}:/data",
               f"--publish=127.0.0.1:{self.port}:8080", *self.confined, *self.run, IMAGE, *self.options)
        return self

    def start(self):
        """Also again, after stop() or kill()."""
        if docker("container", "inspect", self.name, checked=False).returncode != 0:
            self.create()
        begun = time.monotonic()
        docker("start", self.name)
        wait_until(self.answers, 30, "the service in the container answers")
        self.start_seconds = time.monotonic() - begun
        return self

    def state(self):
        return json.loads(docker("inspect", "--format={{json .State}}", self.name))

    def answers(self):
        if not self.state()["Running"]:
            raise AssertionError(f"the container ended with {self.state()['ExitCode']}:\n{self.logs()}")
        return self.answers_quietly()

    def logs(self):
        run = docker("logs", self.name, checked=False)
        return run.stdout + run.stderr

    def stop(self):
        """-> (exit code, seconds) of docker stop, which kills after its 10 s"""
        begun = time.monotonic()
        docker("stop", self.name)
        return self.state()["ExitCode"], time.monotonic() - begun

    def processes(self):
        """[(pid as this machine counts, command line)], the server first"""
        lines = docker("top", self.name, "-eo", "pid,args").splitlines()[1:]
        return [(int(pid), words) for pid, words in (line.split(None, 1) for line in lines)]

    def worker_pids(self):
        return [pid for pid, words in self.processes() if " render " in words and Path(words.split()[0]).name == "keylume"]

    def kill(self):
        """kill -9 of the server itself, not by Docker's own means."""
        if os.getuid() == 0:
            os.kill(self.state()["Pid"], signal.SIGKILL)
        else:
            docker("kill", self.name)

    def clean_up(self):
        docker("rm", "-f", "-v", self.name, checked=False)

    def results(self, job_id, *headers):
        """SHA-256 of each artefact, by its name"""
        archive = tarfile.open(fileobj=io.BytesIO(self.get(f"/v1/jobs/{job_id}/results.tar", *headers).body))
        return {member.name.partition("/")[2]: hashlib.sha256(archive.extractfile(member).read()).hexdigest()
                for member in archive if "/artefacts/" in member.name}

    def artefact(self, job_id, name):
        return curl(f"{self.url}/v1/jobs/{job_id}/artefacts/{name}").body


class VolumeTestCase(ServiceTestCase):
    def volume(self, *options):
        """A new one, removed in the end."""
        name = docker("volume", "create", f"--label={LABEL}", *options)
        self.addCleanup(docker, "volume", "rm", "-f", name, checked=False)
        return name

    def service(self, volume=None, **options):
        service = VolumeService(volume or self.volume(), **options)
        self.addCleanup(service.clean_up)
        return service.start()

    def in_the_solve(self, service, job_id):
        """Waits for the middle of the job."""
        def reached():
            progress = service.job(job_id)["progress"]
            return progress["stage"] == "solve" and 0.1 < progress["stage_fraction"] < 0.9
        wait_until(reached, 120, "the middle of the solve")
