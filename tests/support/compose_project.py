"""docker/compose.yaml brought up as a user does, but with ports and names of the test's own; ends with all its volumes."""
import json
import os
import re
import subprocess
import uuid
from pathlib import Path

from container import docker
from service import FINAL_STATES, Service, free_port, wait_until

COMPOSE = Path(__file__).resolve().parent.parent.parent / "docker/compose.yaml"
TOKEN = re.compile(r"kl_[\w-]+")


class ComposeProject(Service):
    """The service of the project, asked with the token of its first start."""

    def __init__(self, *profiles):
        self.project = f"keylume-test-{uuid.uuid4().hex[:8]}"
        self.profiles = profiles
        self.port, self.proxy_port, self.prometheus_port = free_port(), free_port(), free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.environment = {**os.environ, "KEYLUME_PORT": str(self.port), "KEYLUME_TLS_PORT": str(self.proxy_port),
                            "KEYLUME_PROMETHEUS_PORT": str(self.prometheus_port)}

    def compose(self, *words, timeout_s=180):
        command = ["docker", "compose", "-f", str(COMPOSE), "-p", self.project]
        command += [word for profile in self.profiles for word in ("--profile", profile)]
        run = subprocess.run([*command, *words], capture_output=True, text=True, timeout=timeout_s, env=self.environment,
                             stdin=subprocess.DEVNULL)
        if run.returncode != 0:
            raise AssertionError(f"docker compose {' '.join(words)}: {run.returncode}\n{run.stdout}{run.stderr}")
        return run.stdout

    def start(self):
        self.compose("up", "--detach", "--no-build")
        wait_until(self.answers_quietly, 30, "the service answers")
        self.token = wait_until(lambda: TOKEN.search(self.compose("logs", "keylume")), 10, "the first token")[0]
        return self

    def containers(self):
        """{service: what docker inspect says}"""
        found = json.loads(docker("inspect", *self.compose("ps", "--quiet").split()))
        return {each["Config"]["Labels"]["com.docker.compose.service"]: each for each in found}

    def bearer(self):
        return ("-H", f"Authorization: Bearer {self.token}")

    def get(self, path, *arguments):
        return super().get(path, *self.bearer(), *arguments)

    def submitted(self, job):
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}"]
        fields += [f"materials=@{path}" for path in sorted(job.glob("*.mtl"))]
        answer = self.get("/v1/jobs", *(word for field in fields for word in ("-F", field)))
        if answer.status != 202:
            raise AssertionError(answer.body)
        return answer.json()["id"]

    def ended(self, job_id):
        job = self.job(job_id)
        return job if job["state"] in FINAL_STATES else None

    def clean_up(self):
        self.compose("down", "--volumes", "--timeout", "5")
