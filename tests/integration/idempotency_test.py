#!/usr/bin/env python3
"""A submission that is repeated makes one job, whatever happens in between."""
import os
import shutil
import subprocess
import threading
import unittest

from curl import curl
from service import ServiceTestCase, wait_until
from small_jobs import changed, write_job

REPEATS = 50


class Idempotency(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()
        self.running.get("/v1/queue/pause", "-X", "POST")
        self.job = write_job(self.folder / "job", frames=2)

    def submit(self, job, key):
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}"]
        fields += [f"materials=@{path}" for path in sorted(job.glob("*.mtl"))]
        return curl(self.running.url + "/v1/jobs", "-H", f"Idempotency-Key: {key}",
                    *(word for field in fields for word in ("-F", field)))

    def job_ids(self):
        return [job["id"] for job in self.running.get("/v1/jobs?limit=200").json()["jobs"]]

    def test_fifty_at_once_with_the_same_key_make_one_job(self):
        answers = []
        threads = [threading.Thread(target=lambda: answers.append(self.submit(self.job, "same")))
                   for _ in range(REPEATS)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(answers), REPEATS)
        made = [answer for answer in answers if answer.status == 202]
        self.assertEqual(sorted({answer.status for answer in answers} - {202, 409, 503}), [])
        for answer in answers:
            if answer.status == 409:
                self.assertEqual(answer.headers["retry-after"], "1")
        self.assertEqual(len(self.job_ids()), 1)
        self.assertEqual({answer.json()["id"] for answer in made}, set(self.job_ids()))
        first = [answer for answer in made if "idempotency-replayed" not in answer.headers]
        self.assertEqual(len(first), 1, "one has made it, the others were told of it")

    def test_who_waits_for_the_end_keeps_neither_the_key_nor_a_place_for_uploads(self):
        fields = [word for part in ("scene=@scene.obj", "animation=@animation.json") for word in ("-F", part)]
        fields += [word for path in sorted(self.job.glob("*.mtl")) for word in ("-F", f"materials=@{path.name}")]
        url = self.running.url + "/v1/jobs"
        waiting = [subprocess.Popen(["curl", "-sS", "--max-time", "40", "-o", os.devnull, "-w", "%{http_code}",
                                     "-H", f"Idempotency-Key: {name}", "-H", "Prefer: wait=15", *fields, url],
                                    cwd=self.job, stdout=subprocess.PIPE, text=True) for name in "abcdef"]
        try:
            wait_until(lambda: len(self.job_ids()) == len(waiting), 30, "all are submitted")
            again = self.submit(self.job, "a")
            self.assertEqual((again.status, again.headers.get("idempotency-replayed")), (202, "true"), again.body)
            self.assertTrue(any(process.poll() is None for process in waiting), "somebody still waits")
            place = self.running.get("/metrics").body.decode().partition("\nkeylume_uploads_in_flight ")[2]
            self.assertEqual(float(place.split()[0]), 0)
        finally:
            for process in waiting:
                process.kill()
                process.communicate()

    def test_a_repetition_after_the_server_was_killed_is_answered_with_the_same_job(self):
        first = self.submit(self.job, "key")
        self.running.kill()
        self.running.start()
        again = self.submit(self.job, "key")
        self.assertEqual((again.status, again.headers["idempotency-replayed"]), (202, "true"))
        self.assertEqual(again.json()["id"], first.json()["id"])
        self.assertEqual(again.headers["location"], first.headers["location"])
        self.assertEqual(len(self.job_ids()), 1)

    def test_another_upload_with_the_same_key_is_refused_and_another_key_makes_another_job(self):
        first = self.submit(self.job, "key")
        other = shutil.copytree(self.job, self.folder / "other")
        changed(other, lambda animation: animation.update(name="other"))
        refused = self.submit(other, "key")
        self.assertEqual(refused.status, 422)
        self.assertEqual([(e["file"], e["code"]) for e in refused.json()["errors"]], [("Idempotency-Key", "reused_key")])
        self.assertIn(first.json()["id"], refused.json()["detail"])
        self.assertEqual(self.submit(self.job, "key2").status, 202)
        self.assertEqual(len(self.job_ids()), 2)

    def test_a_refused_upload_leaves_its_key_free(self):
        wrong = shutil.copytree(self.job, self.folder / "wrong")
        (wrong / "scene.obj").write_text("f 1 2 3\n")
        self.assertEqual(self.submit(wrong, "key").status, 422)
        mended = self.submit(self.job, "key")
        self.assertEqual(mended.status, 202)
        self.assertNotIn("idempotency-replayed", mended.headers)

    def test_a_key_that_is_none_is_refused(self):
        for key in ("a b", "x" * 256, "\u00e9"):
            answer = self.submit(self.job, key)
            self.assertEqual((answer.status, answer.json()["errors"][0]["file"]), (400, "Idempotency-Key"), key)


if __name__ == "__main__":
    unittest.main(verbosity=2)
