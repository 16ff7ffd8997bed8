#!/usr/bin/env python3
"""What keeps a server from starting, and how it ends."""
import os
import socket
import subprocess
import unittest
from pathlib import Path

from service import SERVER, Service, ServiceTestCase, wait_until
from small_jobs import write_job

ROOT = Path(__file__).resolve().parent.parent.parent


class Start(ServiceTestCase):
    def refusal(self, command):
        run = subprocess.run(command, capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertGreater(run.returncode, 0, run.stderr)
        return run.stdout + run.stderr

    def test_a_second_server_on_the_same_data_is_refused(self):
        first = self.service()
        second = Service(first.data)
        self.assertIn(str(first.data), self.refusal(second.command()))
        self.assertEqual(first.get("/healthz").status, 200, "the first goes on")

    def test_help_and_version_are_told_whatever_the_options(self):
        wrong = {**os.environ, "KEYLUME_CONFIG": "/nonexistent", "KEYLUME_EVICT": "perhaps"}
        for words, said in ((["--help"], "usage: keylume-server"), (["--version"], "keylume-server "),
                            (["--data", "/nonexistent", "-h"], "usage: keylume-server")):
            run = subprocess.run([SERVER, *words], capture_output=True, text=True, timeout=20, env=wrong,
                                 stdin=subprocess.DEVNULL)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(said, run.stdout)

    def test_a_taken_port_is_named(self):
        first = self.service()
        second = Service(self.folder / "other")
        second.port = first.port
        self.assertIn(str(first.port), self.refusal(second.command()))

    def test_the_start_script_names_a_taken_port_before_it_builds(self):
        first = self.service()
        run = subprocess.run([ROOT / "server/run", "--no-install", "--port", str(first.port)], capture_output=True,
                             text=True, timeout=10, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 1)
        self.assertIn(f"port {first.port} of 127.0.0.1 is taken by Keylume itself", run.stderr)
        self.assertIn("--data", run.stderr)
        self.assertEqual(run.stdout, "", "nothing was begun")

    def test_the_start_script_tells_another_program_from_keylume(self):
        with socket.create_server(("127.0.0.1", 0)) as mute:
            port = mute.getsockname()[1]
            run = subprocess.run([ROOT / "server/run", "--no-install", "--port", str(port)], capture_output=True,
                                 text=True, timeout=10, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 1)
        self.assertIn(f"port {port} of 127.0.0.1 is taken by another program", run.stderr)

    def test_sigterm_ends_it_with_0_and_its_worker_too(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=16, line_count=3_000_000))
        service.wait_for(job_id, ["running"], 20)
        wait_until(service.worker_pids, 5, "a worker")
        self.assertEqual(service.stop(), 0)
        self.assertEqual(service.worker_pids(), [])

    def test_jobs_outlive_a_restart(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=2))
        finished = service.wait_for(job_id, ["succeeded"], 120)
        service.stop()
        service.start()
        self.assertEqual(service.job(job_id), finished)
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/frames/1/image.png").status, 200)

    def test_a_wrong_command_line_is_refused(self):
        service = Service(self.folder / "data")
        self.refusal([*service.command(), "--no-such-option"])
        self.refusal([service.command()[0]])


if __name__ == "__main__":
    unittest.main(verbosity=2)
