#!/usr/bin/env python3
"""A worker that lies, floods, hides and devours: contained, named for what it did, and the next job is served."""
import os
import time
import unittest
from pathlib import Path

from curl import curl
from service import WORKER, Service, ServiceTestCase, is_alive, wait_until
from small_jobs import changed, write_job

LIAR = Path(__file__).resolve().parent.parent / "support/lying_worker.py"
SERVER_MEMORY_MAX_MIB = 64
ATTEMPTS_MAX = 3  # without progress


def resident_mib(pid):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    raise AssertionError("no such process")


def processes_named(word):
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and is_alive(entry.name):
            try:
                if word in (entry / "cmdline").read_bytes():
                    found.append(int(entry.name))
            except OSError:
                pass
    return found


class ServiceOfALiar(Service):
    def command(self):
        return [*super().command(), "--worker", str(LIAR), "--worker-memory-mb", "64"]


class LyingWorker(ServiceTestCase):
    def setUp(self):
        super().setUp()
        secret = self.folder / "secret"
        secret.write_text("of the operator")
        for name, value in (("KEYLUME_HONEST_WORKER", WORKER), ("KEYLUME_SECRET", str(secret))):
            os.environ[name] = value
            self.addCleanup(os.environ.pop, name)
        self.running = ServiceOfALiar(self.folder / "data")
        self.addCleanup(self.kill_what_is_left)
        self.addCleanup(self.running.clean_up)
        self.running.start()

    def kill_what_is_left(self):
        """Where the service was killed by a test that failed: liars do not look whether it lives."""
        for pid in processes_named(str(self.folder).encode()):
            os.kill(pid, 9)

    def tearDown(self):
        self.assertIsNone(self.running.process.poll(), self.running.log.read_text(errors="replace")[-2000:])
        self.assertEqual(self.running.get("/healthz").status, 200)
        self.assertLess(resident_mib(self.running.process.pid), SERVER_MEMORY_MAX_MIB)
        data = str(self.running.data).encode()
        left = [pid for pid in processes_named(data) if pid != self.running.process.pid]
        self.assertEqual(left, [], "nothing of a worker outlives it")

    def lie(self, behaviour, **options):
        """Submits a job on which the worker does that -> job id"""
        job = write_job(self.folder / f"job_{behaviour}", frames=2)
        changed(job, lambda whole: whole.update(name=behaviour))
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}",
                  *(f"materials=@{path}" for path in job.glob("*.mtl"))]
        if options:
            fields.append("options=" + str(options).replace("'", '"'))
        answer = curl(self.running.url + "/v1/jobs", *(word for field in fields for word in ("-F", field)))
        self.assertEqual(answer.status, 202, answer.body)
        return answer.json()["id"]

    def ended(self, job_id, timeout_s=60):
        return self.running.wait_for(job_id, ("failed", "succeeded", "canceled"), timeout_s)

    def expect_failed(self, behaviour, *reasons, **options):
        job_id = self.lie(behaviour, **options)
        job = self.ended(job_id)
        self.assertEqual(job["state"], "failed", job)
        self.assertTrue(job["reason"].startswith(reasons), job)
        self.assertLessEqual(len((self.running.job_folder(job_id) / "attempts").read_text().split()), ATTEMPTS_MAX)
        for path in ("radiosity.npy", "key-frames", "manifest.json"):
            self.assertEqual(self.running.get(f"/v1/jobs/{job_id}/{path}").status, 404, path)
        return job_id

    def test_floods_of_output_are_cut_in_the_log(self):
        job_id = self.expect_failed("flood_stdout", "bad_artefacts")
        self.assertLess((self.running.job_folder(job_id) / "worker.log").stat().st_size, (ATTEMPTS_MAX + 1) << 20)

    def test_progress_without_end_is_a_flood(self):
        self.expect_failed("endless_progress", "worker_flooded")

    def test_progress_lines_of_a_megabyte_are_passed_over(self):
        self.expect_failed("long_lines", "bad_artefacts")

    def test_broken_json_is_no_progress_and_no_result(self):
        self.expect_failed("bad_json", "bad_artefacts")

    def test_wrong_hashes_and_paths_that_lead_out_are_no_results(self):
        self.expect_failed("wrong_hash", "bad_artefacts")
        self.expect_failed("up_and_out", "bad_artefacts")

    def test_links_are_not_followed(self):
        job_id = self.expect_failed("links", "bad_artefacts")
        for path in ("radiosity.npy", "report.json", "log"):
            self.assertNotIn(b"of the operator", self.running.get(f"/v1/jobs/{job_id}/{path}").body)

    def test_pipes_in_place_of_files_make_nobody_wait(self):
        self.expect_failed("pipes", "bad_artefacts")
        self.expect_failed("nothing", "bad_artefacts")

    def test_files_that_claim_gigabytes_are_not_read(self):
        self.expect_failed("huge_files", "bad_artefacts")

    def test_success_with_nothing_to_show_is_a_failure(self):
        self.expect_failed("nothing", "bad_artefacts")

    def test_who_ignores_sigterm_is_killed_within_a_second(self):
        job_id = self.lie("ignore_term")
        self.running.wait_for(job_id, ("running",), 20)
        progress = self.running.job_folder(job_id) / "progress.ndjson"
        wait_until(progress.exists, 10, "it runs")
        pid = int((self.running.job_folder(job_id) / "attempts").read_text().split()[0])
        begun = time.monotonic()
        self.assertEqual(self.running.get(f"/v1/jobs/{job_id}/cancel", "-X", "POST").status, 202)
        wait_until(lambda: not is_alive(pid), 10, "the worker is dead")
        took = time.monotonic() - begun
        print(f"cancel to dead worker: {1000 * took:.0f} ms", flush=True)
        self.assertLess(took, 3)
        self.assertEqual(self.ended(job_id)["state"], "canceled")

    def test_who_hangs_ends_with_the_time_that_the_job_may_take(self):
        self.expect_failed("hang", "run_time_exceeded", max_run_seconds=1)

    def test_processes_that_hide_or_breed_end_with_their_worker(self):
        job_id = self.expect_failed("hide", "bad_artefacts")
        hidden = int((self.running.job_folder(job_id) / "hidden").read_text())
        wait_until(lambda: not is_alive(hidden), 10, "the hidden process is dead")
        self.expect_failed("breed", "bad_artefacts")
        service = [self.running.process.pid]  # which names its worker
        wait_until(lambda: processes_named(LIAR.name.encode()) == service, 20, "no process is left")

    def test_memory_is_had_up_to_a_limit(self):
        job_id = self.expect_failed("eat_memory", "limit_exceeded")
        eaten = int((self.running.job_folder(job_id) / "eaten").read_text())
        print(f"eaten before the limit: {eaten} MiB", flush=True)
        self.assertLess(eaten, 4096)

    def test_files_are_had_up_to_a_limit(self):
        job_id = self.expect_failed("eat_disk", "bad_artefacts")
        self.assertNotEqual((self.running.job_folder(job_id) / "grown").read_text(), "yes")

    def test_one_that_does_not_care_whether_its_server_lives_dies_with_it(self):
        """It neither listens to its standard input nor asks the kernel for anything, as a program taken over would."""
        job_id = self.lie("hang")
        attempts = self.running.data / "jobs" / job_id / "attempts"
        pid = int(wait_until(lambda: attempts.exists() and attempts.read_text().strip(), 20, "it has begun"))
        self.assertTrue(is_alive(pid))
        self.running.kill()
        wait_until(lambda: not is_alive(pid), 2, "the kernel ends it")
        self.running.start()
        self.assertEqual(self.running.get(f"/v1/jobs/{job_id}/cancel", "-X", "POST").status, 202)
        self.ended(job_id)

    def test_the_next_job_is_not_the_worse_for_it(self):
        for behaviour in ("pipes", "hide", "huge_files"):
            self.lie(behaviour)
        wait_until(lambda: all(job["state"] == "failed" for job in self.running.get("/v1/jobs").json()["jobs"]), 60,
                   "all have failed")
        self.assertEqual(self.running.stop(), 0)
        self.running = self.service()  # the same folder, an honest worker
        job = self.submitted(self.running, write_job(self.folder / "honest", frames=2))
        self.running.wait_for(job, ("succeeded",), 120)


if __name__ == "__main__":
    unittest.main(verbosity=2)
