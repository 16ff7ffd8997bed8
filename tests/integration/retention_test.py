#!/usr/bin/env python3
"""What is kept and what goes: quotas that count views and videos, time to live by default, eviction."""
import json
import unittest

from service import Service, ServiceTestCase, wait_until
from small_jobs import write_job


class Retention(ServiceTestCase):
    def with_options(self, *options):
        service = Service(self.folder / "data")
        words = service.command() + list(options)
        service.command = lambda: words
        self.addCleanup(service.clean_up)
        return service.start()

    def finished(self, service, name="job", *more):
        job_id = self.submitted(service, self.folder / name if (self.folder / name).exists()
                                else write_job(self.folder / name, frames=2))
        return service.wait_for(job_id, ["succeeded"], 120)

    def test_the_bytes_of_a_view_are_its_jobs_until_it_goes(self):
        service = self.with_options()
        before = self.finished(service)
        path = f"/v1/jobs/{before['id']}"
        request = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0], "width": 320, "height": 180,
                   "formats": ["png", "exr"]}
        asked = service.get(path + "/views", "-H", "Content-Type: application/json", "-d", json.dumps(request))
        view = asked.headers["location"]
        files = wait_until(lambda: service.get(view).json().get("files"), 60, "the view is ready")
        with_view = wait_until(lambda: (job := service.job(before["id"]))["bytes"] > before["bytes"] and job, 10, "counted")
        self.assertGreaterEqual(with_view["bytes"], before["bytes"] + sum(file["bytes"] for file in files))
        self.assertEqual(service.get(view, "-X", "DELETE").status, 204)
        self.assertLess(service.job(before["id"])["bytes"], before["bytes"] + 10_000, "a line of the log may stay")
        metrics = service.get("/metrics").body.decode()
        self.assertIn("keylume_stored_bytes ", metrics)

    def test_who_is_over_the_quota_makes_no_more_views(self):
        service = self.with_options()
        job = self.finished(service)
        self.assertEqual(service.stop(), 0)
        words = service.command() + ["--max-stored-bytes", str(job["bytes"])]
        service.command = lambda: words
        service.start()
        request = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0]}
        refused = service.get(f"/v1/jobs/{job['id']}/views", "-H", "Content-Type: application/json", "-d", json.dumps(request))
        self.assertEqual((refused.status, refused.json()["type"]), (507, "urn:keylume:problem:over-quota"))

    def test_the_least_recently_used_job_makes_room(self):
        service = self.with_options()
        jobs = [self.finished(service) for _ in range(3)]
        self.assertEqual(service.get(f"/v1/jobs/{jobs[0]['id']}/frames/0/image.png").status, 200, "it is used again")
        self.assertEqual(service.get(f"/v1/jobs/{jobs[1]['id']}", "-X", "PATCH", "-H", "Content-Type: application/json",
                                     "-d", '{"pinned": true}').status, 200)
        self.assertEqual(service.stop(), 0)
        words = service.command() + ["--evict", "--max-stored-bytes", str(sum(job["bytes"] for job in jobs) + 10)]
        service.command = lambda: words
        service.start()
        new = self.submitted(service, self.folder / "job")
        left = {job["id"] for job in service.get("/v1/jobs").json()["jobs"]}
        self.assertEqual(left, {jobs[0]["id"], jobs[1]["id"], new})
        self.assertIn("keylume_evicted_jobs_total 1", service.get("/metrics").body.decode())
        self.assertIn(f"{jobs[2]['id']}: evicted", service.log.read_text())

    def test_jobs_are_kept_as_long_as_the_operator_says_unless_they_say_it(self):
        service = self.with_options("--default-ttl-days", "30")
        job = write_job(self.folder / "job", frames=2)
        self.assertEqual(service.submit(job).json()["ttl_seconds"], 30 * 24 * 3600)


if __name__ == "__main__":
    unittest.main(verbosity=2)
