#!/usr/bin/env python3
"""The queue over HTTP with real workers: order, budget, pausing, limits in time, batches, labels, retention."""
import json
import time
import unittest

from service import ServiceTestCase, wait_until
from small_jobs import write_job

LONG = dict(frames=60, line_count=50_000_000)


class Queue(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.long_job = write_job(self.folder / "long", **LONG)
        self.short_job = write_job(self.folder / "short", frames=2)

    def start(self, *options):
        running = self.service_with(*options)
        return running

    def service_with(self, *options):
        from service import Service
        service = Service(self.folder / "data")
        command = service.command
        service.command = lambda: [*command(), *options]
        self.addCleanup(service.clean_up)
        return service.start()

    def submit(self, running, job, *arguments, **options):
        """-> the job as answered"""
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}"]
        fields += [f"materials=@{path}" for path in sorted(job.glob("*.mtl"))]
        fields += [f"options={json.dumps(options)};type=application/json"]
        answer = running.get("/v1/jobs", *(word for field in fields for word in ("-F", field)), *arguments)
        self.assertIn(answer.status, (200, 202), answer.body.decode(errors="replace"))
        return answer.json()

    def send(self, running, method, path, body=None):
        data = [] if body is None else ["-H", "Content-Type: application/json", "-d", json.dumps(body)]
        return running.get(path, "-X", method, *data)

    def state(self, running, job_id):
        return running.job(job_id)["state"]

    def test_jobs_wait_in_order_of_priority_and_a_paused_queue_starts_none(self):
        running = self.start()
        self.assertEqual(self.send(running, "POST", "/v1/queue/pause", {"reason": "maintenance"}).json()["paused"], True)
        low = self.submit(running, self.short_job, priority=10, name="low")
        middle = self.submit(running, self.short_job)
        high = self.submit(running, self.short_job, priority=90, labels={"project": "garage"})
        self.assertEqual((low["name"], low["queue_position"], middle["queue_position"], high["queue_position"]),
                         ("low", 1, 1, 1), "each as it was when it came")
        places = {job["id"]: job["queue_position"] for job in running.get("/v1/jobs").json()["jobs"]}
        self.assertEqual([places[job["id"]] for job in (high, middle, low)], [1, 2, 3])
        raised = self.send(running, "PATCH", f"/v1/jobs/{low['id']}", {"priority": 100})
        self.assertEqual((raised.status, raised.json()["queue_position"]), (200, 1))
        found = running.get("/v1/jobs?label=project:garage&state=queued").json()["jobs"]
        self.assertEqual([job["id"] for job in found], [high["id"]])
        time.sleep(1.5)
        self.assertEqual(running.worker_pids(), [])
        queue = running.get("/v1/queue").json()
        self.assertEqual((queue["reason"], queue["jobs"]["queued"]), ("maintenance", 3))

        self.assertEqual(running.stop(), 0)
        running.start()
        self.assertTrue(running.get("/v1/queue").json()["paused"], "it holds across restarts")
        self.send(running, "POST", "/v1/queue/resume")
        done = [running.wait_for(job["id"], ["succeeded"], 120) for job in (low, high, middle)]
        began = [job["started_at"] for job in done]
        self.assertEqual(began, sorted(began), "the raised one first, then by priority")
        self.assertIsNotNone(done[0]["forecast"])
        self.assertGreater(done[0]["bytes"], 1000)

    def test_as_many_jobs_run_at_once_as_the_cores_allow(self):
        running = self.start("--worker-threads", "1", "--worker-threads-total", "2")
        jobs = [self.submit(running, self.long_job)["id"] for _ in range(3)]
        wait_until(lambda: len(running.worker_pids()) == 2, 30, "two workers")
        time.sleep(0.5)
        self.assertEqual(sorted(self.state(running, job) for job in jobs), ["queued", "running", "running"])
        workers = running.get("/v1/queue").json()["workers"]
        self.assertEqual((workers["running"], workers["cores"], workers["cores_max"]), (2, 2, 2))
        self.assertGreater(workers["memory_bytes"], 0, "as forecast")
        batch = self.send(running, "POST", "/v1/jobs/batch", {"ids": jobs, "action": "cancel"})
        self.assertEqual([result["status"] for result in batch.json()["results"]], [202, 202, 202])
        for job in jobs:
            running.wait_for(job, ["canceled"], 20)
        self.assertEqual(running.worker_pids(), [])
        removed = self.send(running, "POST", "/v1/jobs/batch", {"ids": [*jobs, "nobody"], "action": "delete"})
        self.assertEqual([result["status"] for result in removed.json()["results"]], [204, 204, 204, 404])

    def test_jobs_that_need_more_memory_than_there_is_run_one_after_the_other(self):
        running = self.start("--worker-threads", "1", "--worker-threads-total", "2", "--worker-memory-mb", "64")
        jobs = [self.submit(running, self.long_job) for _ in range(2)]
        self.assertGreater(jobs[0]["forecast"]["memory_bytes"], 32 << 20, "or they would fit beside each other")
        running.wait_for(jobs[0]["id"], ["running"], 30)
        time.sleep(1)
        self.assertEqual(self.state(running, jobs[1]["id"]), "queued")

    def test_limits_in_time_end_jobs(self):
        running = self.start()
        slow = self.submit(running, self.long_job, max_run_seconds=1)
        ended = wait_until(lambda: (job := running.job(slow["id"]))["state"] == "failed" and job, 30, "stopped")
        self.assertTrue(ended["reason"].startswith("run_time_exceeded"), ended["reason"])
        blocking = self.submit(running, self.long_job)
        soon = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() + 2))
        late = self.submit(running, self.short_job, deadline=soon)
        ended = wait_until(lambda: (job := running.job(late["id"]))["state"] == "failed" and job, 30, "overdue")
        self.assertTrue(ended["reason"].startswith("deadline_passed"), ended["reason"])
        self.assertEqual(ended["attempt"], 0)
        self.assertEqual(self.state(running, blocking["id"]), "running", "the other one goes on")

    def test_who_prefers_to_wait_gets_the_finished_job_or_202_in_time(self):
        running = self.start()
        job = self.submit(running, self.short_job, "-H", "Prefer: wait=60")
        self.assertEqual(job["state"], "succeeded")
        told = time.monotonic()
        other = self.submit(running, self.long_job, "-H", "Prefer: wait=1")
        self.assertIn(other["state"], ("queued", "running"))
        self.assertLess(time.monotonic() - told, 30)

    def test_quotas_refuse_with_a_reason(self):
        running = self.start("--max-queued-per-token", "1", "--max-stored-bytes", "1000000000")
        self.send(running, "POST", "/v1/queue/pause")
        self.submit(running, self.short_job)
        refused = running.submit(self.short_job)
        self.assertEqual(refused.status, 429)
        self.assertIn("retry-after", refused.headers)
        self.assertEqual(refused.json()["type"], "urn:keylume:problem:too-many")
        self.assertEqual(running.stop(), 0)
        small = self.service_with("--max-stored-bytes", "100")
        refused = small.submit(self.short_job)
        self.assertEqual((refused.status, refused.json()["type"]), (507, "urn:keylume:problem:over-quota"))
        self.assertIn("of 100 bytes", refused.json()["detail"])

    def test_options_that_are_wrong_are_refused_with_their_places(self):
        running = self.start()
        fields = ["-F", f"scene=@{self.short_job / 'scene.obj'}", "-F", f"animation=@{self.short_job / 'animation.json'}"]
        for options, pointer in (('{"priority": 101}', "/priority"), ('{"colour": 1}', "/colour"),
                                 ('{"deadline": "2001-01-01T00:00:00Z"}', "/deadline")):
            answer = running.get("/v1/jobs", *fields, "-F", f"options={options}")
            self.assertEqual(answer.status, 422, options)
            self.assertEqual([(e["file"], e["pointer"]) for e in answer.json()["errors"]], [("options", pointer)])
        self.assertEqual(running.get("/v1/jobs").json()["jobs"], [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
