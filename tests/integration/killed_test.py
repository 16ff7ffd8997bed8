#!/usr/bin/env python3
"""kill -9 in the middle of the solve: the job is taken up again and leaves the same bytes."""
import hashlib
import unittest

from service import ServiceTestCase, wait_until
from small_jobs import write_job

# Enough lines that the solve takes seconds, so that the kill falls into it.
JOB = {"frames": 16, "line_count": 3_000_000, "estimate_line_count": 20_000}


def hashes_of(folder):
    """SHA-256 of every file below the artefacts folder, the manifest included."""
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


class Killed(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        """The uninterrupted run, which every interrupted one is compared with."""
        shared = cls("runTest")
        shared.setUp()
        cls.addClassCleanup(shared.doCleanups)
        cls.job = write_job(shared.folder / "job", **JOB)
        service = shared.service()
        job_id = shared.submitted(service, cls.job)
        service.wait_for(job_id, ["succeeded"], 240)
        cls.expected = hashes_of(service.job_folder(job_id) / "artefacts")

    def runTest(self):
        pass

    def start_and_reach_the_solve(self):
        service = self.service()
        job_id = self.submitted(service, self.job)

        def in_the_solve():
            progress = service.job(job_id)["progress"]
            return progress["stage"] == "solve" and 0.1 < progress["stage_fraction"] < 0.9
        wait_until(in_the_solve, 120, "the middle of the solve")
        pids = service.worker_pids()
        self.assertEqual(len(pids), 1, "one worker runs the job")
        return service, job_id

    def expect_the_same_bytes(self, service, job_id):
        finished = service.wait_for(job_id, ["succeeded"], 240)
        self.assertGreaterEqual(finished["attempt"], 2, "it was interrupted, so this is another attempt")
        self.assertEqual(hashes_of(service.job_folder(job_id) / "artefacts"), self.expected)
        manifest = service.get(f"/v1/jobs/{job_id}/manifest.json").body
        self.assertEqual(hashlib.sha256(manifest).hexdigest(), self.expected["manifest.json"])

    def test_the_reference_run_left_files(self):
        self.assertIn("radiosity.npy", self.expected)
        self.assertEqual(sum(path.endswith(".png") for path in self.expected), JOB["frames"])

    def test_the_worker_is_killed(self):
        service, job_id = self.start_and_reach_the_solve()
        service.kill_workers()
        self.expect_the_same_bytes(service, job_id)

    def test_the_server_is_killed(self):
        service, job_id = self.start_and_reach_the_solve()
        service.kill()
        wait_until(lambda: not service.worker_pids(), 5, "the worker ends with its server")
        service.start()
        self.expect_the_same_bytes(service, job_id)

    def test_both_are_killed(self):
        service, job_id = self.start_and_reach_the_solve()
        service.kill_workers()
        service.kill()
        service.start()
        self.expect_the_same_bytes(service, job_id)


if __name__ == "__main__":
    unittest.main(verbosity=2)
