#!/usr/bin/env python3
"""What a container is given and no more: memory, room, a root that is read-only, a user that is nobody, one address."""
import hashlib
import json
import os
import re
import unittest
from pathlib import Path

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)
from container import IMAGE, USER, docker
from service import wait_until
from small_jobs import write_job
from volume_service import VolumeTestCase

MEMORY = "256m"
# Far above MEMORY, far below what the worker may have besides, so that the kernel is first.
GREEDY = {"frames": 40, "patch_edge_m": 0.06, "line_count": 1_000_000}
ROOM = "160m"


class Confined(VolumeTestCase):
    def test_who_is_killed_for_want_of_memory_says_so_and_the_service_stays(self):
        service = self.service(run=[f"--memory={MEMORY}", f"--memory-swap={MEMORY}"])
        before = service.state()["Pid"]
        answer = service.submit(write_job(self.folder / "greedy", **GREEDY))
        self.assertEqual(answer.status, 202, answer.body)
        job = service.wait_for(answer.json()["id"], ["failed"], 240)
        print("the job ended so:", job["reason"], flush=True)
        self.assertIn("out of memory", job["reason"])
        self.assertEqual(service.state()["Pid"], before, "the service itself was not ended")
        self.assertEqual(service.get("/healthz").status, 200)
        small = self.submitted(service, write_job(self.folder / "small", frames=1, line_count=20_000, patch_edge_m=1.5))
        service.wait_for(small, ["succeeded"], 120)

    def test_a_volume_without_room_is_507_and_the_service_goes_on(self):
        volume = self.volume("--driver=local", "--opt=type=tmpfs", "--opt=device=tmpfs",
                             f"--opt=o=size={ROOM},uid={USER},gid={USER},mode=700")
        service = self.service(volume)
        blob = self.folder / "blob"
        blob.write_bytes(os.urandom(1 << 20) * 150)
        path = "/v1/blobs/sha256/" + hashlib.sha256(blob.read_bytes()).hexdigest()
        for more in ((), ("-H", "Transfer-Encoding: chunked")):  # refused before it begins, and in its middle
            answer = service.get(path, "-X", "PUT", "-T", str(blob), *more)
            self.assertEqual(answer.status, 507, answer.body)
        self.assertEqual(service.get("/healthz").status, 200)
        job_id = self.submitted(service, write_job(self.folder / "job", frames=1, line_count=20_000, patch_edge_m=1.5))
        service.wait_for(job_id, ["succeeded"], 120)

    def test_inside_nothing_but_the_volume_can_be_written(self):
        service = self.service()
        for place in ("", "/usr/bin", "/etc", "/run"):
            made = docker("exec", service.name, "keylume-server", "backup", f"{place}/made", "--data", "/data", checked=False)
            self.assertNotEqual(made.returncode, 0, place)
            self.assertIn("Read-only file system", made.stderr + made.stdout, place)
        made = docker("exec", service.name, "keylume-server", "backup", "/data/made", "--data", "/data", checked=False)
        self.assertEqual(made.returncode, 0, made.stderr)
        # What the kernel says of the processes themselves.
        mounts = Path(f"/proc/{service.state()['Pid']}/mountinfo")
        if os.getuid() == 0 and mounts.exists():
            writable = {line.split()[4] for line in mounts.read_text().splitlines() if line.split()[5].startswith("rw")}
            self.assertNotIn("/", writable)
            self.assertIn("/data", writable)

    def test_inside_nobody_is_root_nor_can_become_it(self):
        service = self.service()
        self.submitted(service, write_job(self.folder / "job", frames=16, line_count=3_000_000))
        wait_until(service.worker_pids, 30, "a worker")
        for pid, words in service.processes():
            status = dict(re.findall(r"^(\w+):\s*(.*)$", Path(f"/proc/{pid}/status").read_text(), re.MULTILINE))
            self.assertEqual(status["Uid"].split(), [str(USER)] * 4, words)
            self.assertEqual(status["Gid"].split(), [str(USER)] * 4, words)
            self.assertEqual(status["NoNewPrivs"], "1", words)
            self.assertEqual(int(status["CapEff"], 16) | int(status["CapBnd"], 16), 0, words)
            self.assertEqual(status["Seccomp"], "2", words)

    def test_without_options_the_image_is_not_root_and_has_no_shell(self):
        about = json.loads(docker("image", "inspect", IMAGE))[0]["Config"]
        self.assertEqual(about["User"].split(":")[0], str(USER))
        for shell in ("sh", "bash", "/bin/sh"):
            run = docker("run", "--rm", "--network=none", f"--entrypoint={shell}", IMAGE, "-c", "true", checked=False)
            self.assertEqual(run.returncode, 127, shell)

    def test_docker_says_that_it_is_healthy(self):
        service = self.service(run=["--health-interval=1s"])
        wait_until(lambda: service.state()["Health"]["Status"] == "healthy", 60, "Docker calls it healthy")

    def test_workers_are_held_inside_it_too(self):
        held = self.service().get("/version").json()["worker_sandbox"]
        print(f"ratio: workers in the container are held by: {held}", flush=True)
        self.assertIn("seccomp", held)
        self.assertIn("limits", held)


if __name__ == "__main__":
    unittest.main(verbosity=2)
