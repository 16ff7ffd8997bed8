#!/usr/bin/env python3
"""kill -9 at every named place (fault_point in the sources), and at random times: no job that was accepted is lost,
none runs twice at once, no process is left over, and the results are the bytes of a run that nothing interrupted.

KEYLUME_KILLS: how many times to kill at random (12).
"""
import os
import random
import re
import subprocess
import time
import unittest
from pathlib import Path

from finished_jobs import finish_jobs
from service import FINAL_STATES, ServiceTestCase, hashes_of, wait_until
from small_disk import armed
from made_kills_test import PLACES as OF_MAKING
from upkeep_kills_test import PLACES as OF_UPKEEP

SOURCES = Path(__file__).resolve().parent.parent.parent
KILLS = int(os.environ.get("KEYLUME_KILLS", "12"))
JOB = {"frames": 6, "line_count": 60_000, "moving_line_count": 30_000, "patch_edge_m": 1.0,
       "standard_errors": True}

# Places in the server, on a job's way from its upload to its end.
OF_SUBMISSION = ["upload_received", "upload_checked", "folder_moved", "job_committed", "claimed", "worker_started",
                 "worker_recorded", "worker_ended", "results_collected", "results_committed"]
OF_REMOVAL = ["removal_marked", "files_removed"]
OF_START = ["migration_begun", "migrated"]
# Places in the worker; some are passed many times.
OF_WORKER = ["patches_lit", "window_estimated:3", "replicate_solved:2", "file_written:2", "file_written:4",
             "file_written:9", "file_renamed:2", "file_renamed:3", "file_renamed:8", "manifest_due",
             "artefacts_published"]


class FaultTestCase(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        finished = finish_jobs(cls, **JOB)
        cls.input, cls.expected = finished.input, finished.expected

    def submit(self, service):
        """-> the id of the job, or None where the server died before it answered"""
        try:
            answer = service.submit(self.input)
        except subprocess.CalledProcessError:
            return None
        self.assertEqual(answer.status, 202, answer.body)
        return answer.json()["id"]

    def jobs_of(self, service):
        return [job["id"] for job in service.get("/v1/jobs").json()["jobs"]]

    def finish(self, service, job_id):
        """Waits for the job's end; never sees two workers."""
        def ended():
            self.assertLessEqual(len(service.worker_pids()), 1, "two workers on one job")
            job = service.job(job_id)
            return job if job["state"] in FINAL_STATES else None
        job = wait_until(ended, 120, f"the end of {job_id}")
        self.assertEqual(job["state"], "succeeded", job)
        self.assertEqual(hashes_of(service.job_folder(job_id) / "artefacts"), self.expected)

    def expect_whole(self, service, accepted):
        """All that was accepted is there and ends as if nothing had happened."""
        jobs = self.jobs_of(service)
        if accepted:
            self.assertIn(accepted, jobs, "the job was accepted")
        for job_id in jobs:
            self.finish(service, job_id)
        self.assertEqual(list((service.data / "tmp").iterdir()), [], "uploads that no one owns")
        on_disk = {path.name for path in service.data.rglob("job_*") if path.is_dir()}
        self.assertEqual(on_disk, set(jobs), "folders that no job owns")

    def dies(self, service):
        wait_until(lambda: service.process.poll() is not None, 60, "the server is cut off")
        self.assertEqual(service.process.returncode, -9)
        wait_until(lambda: not service.worker_pids(), 5, "its worker ends with it")


class AtNamedPlaces(FaultTestCase):
    def test_every_place_in_the_sources_is_visited_here(self):
        found = set()
        for folder in ("api", "engine", "server"):
            for path in (SOURCES / folder).rglob("*.cpp"):
                found |= set(re.findall(r'fault_point\("(\w+)"\)', path.read_text()))
        visited = {name.split(":")[0] for name in OF_SUBMISSION + OF_REMOVAL + OF_START + OF_WORKER}
        self.assertEqual(found, visited | OF_UPKEEP | OF_MAKING)

    def test_the_server_between_upload_and_end(self):
        for place in OF_SUBMISSION:
            with self.subTest(place=place):
                with armed(place):
                    service = self.service(place)
                accepted = self.submit(service)
                self.dies(service)
                service.start()
                self.expect_whole(service, accepted)
                service.stop()

    def test_the_worker(self):
        for place in OF_WORKER:
            with self.subTest(place=place):
                with armed(place):
                    service = self.service(place.replace(":", "_"))
                accepted = self.submit(service)
                wait_until(lambda: service.job(accepted)["attempt"] >= 2, 60, "the worker is cut off")
                service.kill()
                service.start()
                self.expect_whole(service, accepted)
                service.stop()

    def test_the_server_while_it_removes_a_job(self):
        for place in OF_REMOVAL:
            with self.subTest(place=place):
                service = self.service(place)
                job_id = self.submit(service)
                self.finish(service, job_id)
                service.stop()
                with armed(place):
                    service.start()
                try:
                    service.get(f"/v1/jobs/{job_id}", "-X", "DELETE")
                except subprocess.CalledProcessError:
                    pass
                self.dies(service)
                service.start()
                self.assertEqual(service.get(f"/v1/jobs/{job_id}").status, 404)
                self.expect_whole(service, None)
                service.stop()

    def test_the_server_while_it_makes_its_database(self):
        for place in OF_START:
            with self.subTest(place=place):
                with armed(place), self.assertRaisesRegex(AssertionError, "ended with -9"):
                    self.service(place)
                service = self.service(place)
                self.expect_whole(service, self.submit(service))
                service.stop()


class AtRandom(FaultTestCase):
    def test_worker_and_server_and_both(self):
        chance = random.Random(20)
        service = self.service()
        for number in range(KILLS):
            accepted = self.submit(service)
            time.sleep(chance.uniform(0, 1.2))
            victims = chance.choice(["worker", "server", "both"])
            with self.subTest(number=number, victims=victims):
                if victims != "server":
                    service.kill_workers()
                if victims != "worker":
                    service.kill()
                    wait_until(lambda: not service.worker_pids(), 5, "workers end with their server")
                    service.start()
                self.finish(service, accepted)
                self.assertEqual(service.get(f"/v1/jobs/{accepted}", "-X", "DELETE").status, 204)
        self.expect_whole(service, None)


if __name__ == "__main__":
    unittest.main(verbosity=2)
