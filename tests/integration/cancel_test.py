#!/usr/bin/env python3
"""Jobs are canceled and removed, and the queue goes on."""
import time
import unittest

from service import ServiceTestCase
from small_jobs import write_job


class Cancel(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()
        self.long_job = write_job(self.folder / "long", frames=60, line_count=50_000_000)
        self.short_job = write_job(self.folder / "short", frames=2)

    def cancel(self, job_id):
        return self.running.get(f"/v1/jobs/{job_id}/cancel", "-X", "POST")

    def delete(self, job_id):
        return self.running.get(f"/v1/jobs/{job_id}", "-X", "DELETE")

    def start_long_job(self):
        job_id = self.submitted(self.running, self.long_job)
        self.running.wait_for(job_id, ["running"], 20)
        return job_id

    def test_a_running_job_is_stopped_within_two_seconds_and_the_next_one_runs(self):
        first = self.start_long_job()
        second = self.submitted(self.running, self.short_job)
        self.assertEqual(self.running.job(second)["state"], "queued")
        told = time.monotonic()
        self.assertEqual(self.cancel(first).status, 202)
        self.running.wait_for(first, ["canceled"], 10)
        self.assertLess(time.monotonic() - told, 2.0)
        self.running.wait_for(second, ["succeeded"], 120)

    def test_a_queued_job_is_canceled_at_once(self):
        first = self.start_long_job()
        second = self.submitted(self.running, self.short_job)
        self.assertEqual(self.cancel(second).json()["state"], "canceled")
        self.assertEqual(self.running.job(first)["state"], "running", "the other one goes on")

    def test_canceling_a_finished_job_is_a_wrong_state(self):
        job_id = self.submitted(self.running, self.short_job)
        self.running.wait_for(job_id, ["succeeded"], 120)
        answer = self.cancel(job_id)
        self.assertEqual((answer.status, answer.headers["content-type"]), (409, "application/problem+json"))

    def test_only_a_finished_job_can_be_removed_and_nothing_of_it_stays(self):
        job_id = self.start_long_job()
        self.assertEqual(self.delete(job_id).status, 409)
        self.cancel(job_id)
        self.running.wait_for(job_id, ["canceled"], 10)
        self.assertIsNotNone(self.running.job_folder(job_id))
        self.assertEqual(self.delete(job_id).status, 204)
        self.assertIsNone(self.running.job_folder(job_id))
        self.assertEqual(self.running.get(f"/v1/jobs/{job_id}").status, 404)
        self.assertEqual(self.delete(job_id).status, 404)

    def test_a_job_that_nobody_knows(self):
        self.assertEqual(self.cancel("nobody").status, 404)
        self.assertEqual(self.delete("nobody").status, 404)


if __name__ == "__main__":
    unittest.main(verbosity=2)
