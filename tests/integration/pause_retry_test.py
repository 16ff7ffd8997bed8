#!/usr/bin/env python3
"""Jobs are paused, resumed and tried again with the real worker, and come out bit for bit as if nothing had been."""
import json
import time
import unittest

from service import ServiceTestCase, hashes_of, is_alive, wait_until
from small_jobs import write_job

# Long enough to be stopped in the middle, short enough to be run three times.
JOB = dict(frames=24, width=96, height=54, line_count=7_000_000, moving_line_count=7_000_000)


class PauseAndRetry(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()
        self.files = write_job(self.folder / "job", **JOB)

    def wish(self, job_id, word, query=""):
        return self.running.get(f"/v1/jobs/{job_id}/{word}{query}", "-X", "POST")

    def wait_for_solve(self, job_id):
        def reached():
            job = self.running.job(job_id)
            self.assertIn(job["state"], ("queued", "running"), job)
            progress = job["progress"]
            return progress["stage"] == "solve" and progress["stage_fraction"] > 0.1
        wait_until(reached, 60, "the worker solves")

    def wait_for_state(self, job_id, state, timeout_s=120):
        return wait_until(lambda: (job := self.running.job(job_id))["state"] == state and job, timeout_s, state)

    def results(self, job_id):
        return hashes_of(self.running.job_folder(job_id) / "artefacts")

    def test_a_paused_job_stays_so_across_a_restart_and_ends_as_if_it_had_never_stopped(self):
        whole = self.submitted(self.running, self.files)
        self.wait_for_state(whole, "succeeded")
        expected = self.results(whole)

        job_id = self.submitted(self.running, self.files)
        self.wait_for_solve(job_id)
        pids = self.running.worker_pids()
        self.assertEqual(len(pids), 1)
        self.assertIn(self.wish(job_id, "pause").json()["state"], ("pause_requested", "paused"))
        paused = self.wait_for_state(job_id, "paused", 20)
        self.assertFalse(is_alive(pids[0]), "paused means that the worker is gone")
        self.assertEqual(paused["reason"], "paused: on request")
        self.assertIn("resume", paused["links"])
        self.assertEqual(self.wish(job_id, "pause").json()["state"], "paused", "asking twice is the same as once")

        self.assertEqual(self.running.stop(), 0)
        self.running.start()
        time.sleep(1.5)
        self.assertEqual(self.running.job(job_id)["state"], "paused", "nobody but its owner wakes it")
        self.assertEqual(self.running.worker_pids(), [])
        self.assertIn(self.wish(job_id, "resume").json()["state"], ("queued", "running"))
        done = self.wait_for_state(job_id, "succeeded")
        self.assertEqual(done["attempt"], 2)
        self.assertEqual(self.results(job_id), expected)

    def test_a_paused_job_goes_on_from_where_it_was(self):
        job_id = self.submitted(self.running, write_job(self.folder / "long", **JOB, standard_errors=True))
        def is_on_its_way():
            progress = self.running.job(job_id)["progress"]
            return progress["stage"] == "solve" and progress["stage_fraction"] > 0.5 and progress["stage_fraction"]
        reached = wait_until(is_on_its_way, 120, "half of the work is done")
        self.wish(job_id, "pause")
        self.wait_for_state(job_id, "paused", 20)
        self.wish(job_id, "resume")
        lines = self.running.job_folder(job_id) / "progress.ndjson"
        def resumed():
            found = [json.loads(line) for line in lines.read_text().splitlines() if '"resumed' in line]
            return [line for line in found if line["stage"] == "solve"]
        # What is lost is the part of the lines that was being traced.
        self.assertGreater(wait_until(resumed, 60, "it goes on")[-1]["stage_fraction"], reached - 0.25)
        self.wait_for_state(job_id, "succeeded")

    def test_a_job_that_was_to_pause_when_the_server_was_killed_is_paused_at_the_next_start(self):
        job_id = self.submitted(self.running, self.files)
        self.wait_for_solve(job_id)
        self.wish(job_id, "pause")
        self.running.kill()
        self.running.start()
        self.assertEqual(self.wait_for_state(job_id, "paused", 20)["reason"].split(":")[0], "paused")
        self.assertEqual(self.running.worker_pids(), [])

    def test_a_canceled_job_can_be_tried_again_from_its_checkpoint_or_from_the_start(self):
        job_id = self.submitted(self.running, self.files)
        self.wait_for_solve(job_id)
        pid = self.running.worker_pids()[0]
        told = time.monotonic()
        self.assertEqual(self.wish(job_id, "cancel").status, 202)
        wait_until(lambda: not is_alive(pid), 10, "the worker is dead")
        print(f"cancel to dead worker: {time.monotonic() - told:.2f} s")
        self.wait_for_state(job_id, "canceled", 10)
        self.assertEqual(self.wish(job_id, "resume").status, 409)
        self.assertEqual(self.wish(job_id, "retry").status, 202)
        done = self.wait_for_state(job_id, "succeeded")
        self.assertGreaterEqual(done["attempt"], 2)
        self.assertEqual(self.wish(job_id, "retry").status, 409, "what has succeeded stays as it is")

        again = self.submitted(self.running, self.files)
        self.wait_for_solve(again)
        self.wish(again, "cancel")
        self.wait_for_state(again, "canceled", 10)
        self.assertEqual(self.wish(again, "retry", "?from=start").status, 202)
        self.wait_for_state(again, "succeeded")
        self.assertEqual(self.results(again), self.results(job_id))


if __name__ == "__main__":
    unittest.main(verbosity=2)
