#!/usr/bin/env python3
"""kill -9 in the middle: the job is taken up again, goes on from its checkpoint and leaves the same bytes."""
import hashlib
import json
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from finished_jobs import finish_jobs
from service import WORKER, ServiceTestCase, hashes_of, wait_until
from small_jobs import changed, write_job

# Enough lines that the solve takes seconds, so that the kill falls into it.
JOB = {"frames": 16, "line_count": 6_000_000, "estimate_line_count": 20_000}


class Killed(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        """The uninterrupted run, which every interrupted one is compared with."""
        finished = finish_jobs(cls, timeout_s=240, **JOB)
        cls.job, cls.expected = finished.input, finished.expected

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
        self.assertFalse((service.job_folder(job_id) / "checkpoint").exists(), "it goes when the job has ended")
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


class DoneAlready(ServiceTestCase):
    def test_a_job_that_was_done_when_the_server_was_killed_is_not_rendered_twice(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=4))
        wait_until(service.worker_pids, 20, "a worker runs the job")
        service.process.send_signal(signal.SIGSTOP)  # so that it cannot record the end
        folder = service.job_folder(job_id)
        wait_until(lambda: not service.worker_pids() and (folder / "report.json").exists(), 120, "the worker is done")
        made, told = hashes_of(folder / "artefacts"), (folder / "progress.ndjson").read_bytes()
        service.kill()
        service.start()
        self.assertEqual(service.wait_for(job_id, ["succeeded"], 60)["attempt"], 2)
        self.assertEqual((folder / "progress.ndjson").read_bytes(), told)
        self.assertEqual(hashes_of(folder / "artefacts"), made)
        self.assertIn("already rendered", service.get(f"/v1/jobs/{job_id}/log").body.decode())


def count_of(report, name):
    return sum(count["value"] for count in report["counts"] if count["name"] == name)


class GoesOn(unittest.TestCase):
    """The worker by hand, so that checkpoints come quickly."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="keylume-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def job(self, name, **options):
        write_job(self.folder / name / "input", **options)
        return self.folder / name

    def start(self, job):
        with (job / "log").open("ab") as log:
            worker = subprocess.Popen([WORKER, "render", str(job), "--checkpoint-seconds", "0"],
                                      stdin=subprocess.DEVNULL, stderr=log)
        self.addCleanup(worker.wait)
        self.addCleanup(worker.kill)
        return worker

    def finish(self, job):
        worker = self.start(job)
        self.assertEqual(worker.wait(timeout=240), 0, (job / "log").read_text())
        return json.loads((job / "report.json").read_text())

    def cut_off(self, job, reached, how):
        """Starts the job, and ends it once `reached(newest progress line)`."""
        worker = self.start(job)

        def there():
            self.assertIsNone(worker.poll(), "it ended before it could be cut off\n" + (job / "log").read_text())
            progress = job / "progress.ndjson"
            lines = progress.read_text().splitlines() if progress.exists() else []
            return lines and lines[-1].endswith("}") and reached(json.loads(lines[-1]))
        wait_until(there, 120, "where it is to be cut off")
        worker.send_signal(how)
        worker.wait(timeout=10)
        return (job / "progress.ndjson").stat().st_size

    def lines_after(self, job, offset):
        """Progress that was told after the file had `offset` bytes."""
        lines = (job / "progress.ndjson").read_bytes()[offset:].decode().splitlines()
        return [json.loads(line) for line in lines if line.endswith("}") and line.startswith("{")]

    def test_from_the_middle_of_the_solve_to_the_same_bytes(self):
        whole = self.job("whole", **JOB)
        self.finish(whole)
        expected = hashes_of(whole / "artefacts")
        self.assertFalse((whole / "checkpoint").exists(), "nothing is left to go on from")
        for how in (signal.SIGKILL, signal.SIGTERM):
            with self.subTest(signal=how.name):
                job = self.job(how.name, **JOB)
                end = self.cut_off(job, lambda line: line["stage"] == "solve" and line["stage_fraction"] > 0.5, how)
                self.assertTrue((job / "checkpoint").is_dir())
                self.assertFalse((job / "artefacts/manifest.json").exists())
                self.finish(job)
                resumed = [line for line in self.lines_after(job, end)
                           if line["stage"] == "solve" and line["message"].startswith("resumed, from ")]
                self.assertTrue(resumed, "it went on in the solve")
                self.assertGreater(resumed[0]["stage_fraction"], 0.1, "not from its beginning")
                self.assertEqual(hashes_of(job / "artefacts"), expected)
                self.assertFalse((job / "checkpoint").exists())

    def test_images_that_are_finished_are_not_rendered_again(self):
        options = {"frames": 96, "width": 960, "height": 540, "line_count": 20_000, "moving_line_count": 20_000}
        whole, job = self.job("whole", **options), self.job("job", **options)
        self.assertEqual(count_of(self.finish(whole), "resumed_images"), 0)
        self.cut_off(job, lambda line: line["stage"] == "images" and line["stage_fraction"] > 0.2, signal.SIGKILL)
        image = next(path for path in sorted((job / "artefacts/images").rglob("*.png"))
                     if not path.name.startswith(".tmp"))
        written = image.stat().st_mtime_ns
        report = self.finish(job)
        self.assertGreaterEqual(count_of(report, "resumed_images"), 4)
        # Whether the light was solved again depends on whether a save was due: small jobs are quicker solved than saved.
        self.assertEqual(image.stat().st_mtime_ns, written, "left as it was")
        self.assertEqual(hashes_of(job / "artefacts"), hashes_of(whole / "artefacts"))

    def test_the_checkpoint_of_another_job_is_not_used(self):
        job = self.job("job", **JOB)
        self.cut_off(job, lambda line: line["stage"] == "solve" and line["stage_fraction"] > 0.5, signal.SIGKILL)
        changed(job / "input", lambda animation: animation["lighting"].update(seed=7))
        other = self.job("other", **JOB, seed=7)
        end = (job / "progress.ndjson").stat().st_size
        self.finish(job)
        self.finish(other)
        self.assertFalse([line for line in self.lines_after(job, end) if line["message"]])
        self.assertEqual(hashes_of(job / "artefacts"), hashes_of(other / "artefacts"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
