#!/usr/bin/env python3
"""POST /v1/validate: what a job would take, or why it would be refused; nothing stays."""
import shutil
import unittest

from service import ServiceTestCase, wait_until
from small_jobs import EXAMPLES, write_job


class Validate(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()

    def validate(self, job):
        return self.running.submit(job, "/v1/validate")

    def expect_nothing_kept(self):
        for folder in ("jobs", "tmp"):
            self.assertEqual(list((self.running.data / folder).iterdir()), [], folder)
        self.assertEqual(self.running.get("/v1/jobs").json()["jobs"], [])

    def test_a_sound_job_is_answered_with_a_forecast(self):
        small = self.validate(write_job(self.folder / "small", frames=2))
        self.assertEqual((small.status, small.headers["content-type"]), (200, "application/json"))
        self.assertEqual(set(small.json()), {"forecast", "warnings"})
        forecast = small.json()["forecast"]
        self.assertEqual(forecast["frames"], 2)
        for name in ("polygons", "patches", "memory_bytes", "seconds"):
            self.assertGreater(forecast[name], 0, name)
        large = self.validate(write_job(self.folder / "large", frames=24, line_count=20_000_000)).json()["forecast"]
        self.assertGreater(large["seconds"], 2 * forecast["seconds"])
        self.assertGreater(large["memory_bytes"], forecast["memory_bytes"])
        self.assertEqual(large["patches"], forecast["patches"])
        self.expect_nothing_kept()

    def test_a_wrong_job_is_refused_as_it_would_be_on_submission(self):
        job = self.folder / "wrong"
        shutil.copytree(EXAMPLES / "rejected/obj_index_out_of_range", job)
        here, there = self.validate(job), self.running.submit(job)
        self.assertEqual((here.status, there.status), (422, 422))
        self.assertEqual(here.headers["content-type"], "application/problem+json")
        self.assertEqual(here.json()["errors"], there.json()["errors"])
        self.expect_nothing_kept()

    def test_what_is_no_upload_is_refused(self):
        answer = self.running.get("/v1/validate", "-X", "POST", "-d", "{}")
        self.assertEqual((answer.status, answer.headers["content-type"]), (415, "application/problem+json"))
        self.assertEqual(self.running.get("/v1/validate").status, 405)
        self.expect_nothing_kept()

    def test_what_a_crash_leaves_is_removed_at_the_next_start(self):
        left = self.running.data / "tmp/job_left"
        self.running.kill()
        (left / "input").mkdir(parents=True)
        (left / "input/scene.obj").write_text("v 0 0 0")
        self.running.start()
        wait_until(lambda: not left.exists(), 10, "the leftover upload goes")
        self.expect_nothing_kept()


if __name__ == "__main__":
    unittest.main(verbosity=2)
