#!/usr/bin/env python3
"""A job is removed while somebody makes and reads pictures of it: the removal wins, and whoever was late gets 404."""
import json
import random
import subprocess
import threading
import time
import unittest

from service import ServiceTestCase
from small_jobs import write_job

ROUNDS = 50
JOB = {"frames": 2, "line_count": 2_000, "moving_line_count": 1_000, "patch_edge_m": 2.0, "samples_per_light": 1,
       "width": 32, "height": 18}
# Large enough to be still at it when the removal comes.
VIEW = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "width": 1600, "height": 900, "formats": ["png"],
        "samples_per_pixel": 4}


class RemovalRace(ServiceTestCase):
    def crowd(self, service, job_id, statuses, stop):
        """Asks for all that is made of a job, until told to stop."""
        path = f"/v1/jobs/{job_id}"
        view = ("-H", "Content-Type: application/json", "--data-binary", json.dumps(VIEW))
        asks = [("/views", *view), ("/video.mp4?camera=" + self.camera,), ("/views",), ("/results.tar",),
                ("/radiosity.npy",), ("",)]
        while not stop.is_set():
            for more, *arguments in asks:
                try:
                    answer = service.get(path + more, *arguments)
                except subprocess.CalledProcessError as broken:
                    # A body that breaks off: its file was removed while it was sent.
                    if broken.returncode not in (18, 56, 92):
                        raise
                    continue
                statuses.append((answer.status, more, answer.body[:200]))

    def test_removing_wins_and_nothing_fails_inside(self):
        chance = random.Random(5)
        service = self.service()
        job = write_job(self.folder / "job", **JOB)
        self.camera = json.loads((job / "animation.json").read_text())["images"][0]["camera"]
        statuses, removed, made = [], [], 0
        for number in range(ROUNDS):
            job_id = self.submitted(service, job)
            service.wait_for(job_id, ["succeeded"], 60)
            stop = threading.Event()
            askers = [threading.Thread(target=self.crowd, args=(service, job_id, statuses, stop)) for _ in range(2)]
            for asker in askers:
                asker.start()
            time.sleep(chance.uniform(0, 0.4))
            views = service.data / "jobs" / job_id / "views"
            made += views.exists()
            removed.append(service.get(f"/v1/jobs/{job_id}", "-X", "DELETE").status)
            time.sleep(0.05)
            stop.set()
            for asker in askers:
                asker.join(60)
            self.assertEqual(service.get(f"/v1/jobs/{job_id}").status, 404)
            self.assertFalse((service.data / "jobs" / job_id).exists(), "nobody makes its folder again")
        self.assertEqual(set(removed), {204})
        failed = [entry for entry in statuses if entry[0] >= 500 and not (entry[0] == 503 and "video" in entry[1])]
        self.assertEqual(failed, [])
        self.assertGreater(made, ROUNDS // 4, "views were on their way")
        self.assertGreater(sum(status == 404 for status, _, _ in statuses), ROUNDS)
        self.assertEqual(service.get("/healthz").status, 200)


if __name__ == "__main__":
    unittest.main(verbosity=2)
