#!/usr/bin/env python3
"""A database that is damaged, newer or incomplete, a folder that cannot be written, a clock that jumps: the service
starts with all its jobs, or says why it does not, and never begins anew on top of what it cannot read."""
import json
import os
import shutil
import sqlite3
import subprocess
import time
import unittest
from pathlib import Path

from service import SERVER, ServiceTestCase, free_port, wait_until
from small_disk import mounted
from small_jobs import write_job

PAGE_BYTES = 4096
JOB = {"frames": 3, "line_count": 20_000, "moving_line_count": 10_000, "patch_edge_m": 1.5, "samples_per_light": 1}


class Damage(ServiceTestCase):
    def data_with_a_job(self):
        """-> folder of a server that has ended, the id of its finished job"""
        service = self.service("origin")
        job_id = self.submitted(service, write_job(self.folder / "job", **JOB))
        service.wait_for(job_id, ["succeeded"], 60)
        self.assertEqual(service.stop(), 0)
        return service.data, job_id

    def copy_of(self, data, name):
        shutil.copytree(data, self.folder / name)
        return self.folder / name

    def start(self, data):
        """-> (exit code or None, the Service or None, what it said): it serves, or it has ended."""
        try:
            service = self.service(data.name)
            return None, service, service.log.read_text()
        except AssertionError as failed:
            code = int(str(failed).split("ended with ")[1].split(":")[0]) if "ended with" in str(failed) else -1
            return code, None, str(failed)

    def test_a_damaged_page_is_refused_or_harmless(self):
        data, job_id = self.data_with_a_job()
        pages = (data / "keylume.db").stat().st_size // PAGE_BYTES
        refused = 0
        for page in range(pages):
            with self.subTest(page=page):
                damaged = self.copy_of(data, f"page{page}")
                with (damaged / "keylume.db").open("r+b") as file:
                    file.seek(page * PAGE_BYTES)
                    file.write(b"\xa5" * PAGE_BYTES)
                before = (damaged / "keylume.db").read_bytes()
                code, service, said = self.start(damaged)
                if service:
                    self.assertEqual([job["id"] for job in service.get("/v1/jobs").json()["jobs"]], [job_id])
                    service.kill()
                else:
                    self.assertGreater(code, 0, "it ends by itself, with a code")
                    self.assertRegex(said, "damaged|malformed|not a database|another application")
                    self.assertEqual((damaged / "keylume.db").read_bytes(), before, "left as it was")
                    refused += 1
                shutil.rmtree(damaged)
        self.assertGreater(refused, pages // 2)

    def test_a_log_that_is_missing_costs_what_was_in_it_and_no_more(self):
        service = self.service()
        first = self.submitted(service, write_job(self.folder / "job", **JOB))
        service.wait_for(first, ["succeeded"], 60)
        self.assertEqual(service.stop(), 0)  # everything is in the database itself now
        service.start()
        self.submitted(service, self.folder / "job")
        service.kill()
        wait_until(lambda: not service.worker_pids(), 5, "the worker ends")
        (service.data / "keylume.db-wal").unlink()
        service.start()
        jobs = [job["id"] for job in service.get("/v1/jobs").json()["jobs"]]
        self.assertIn(first, jobs)
        for job_id in jobs:
            service.wait_for(job_id, ["succeeded"], 60)

    def test_a_newer_schema_is_refused_and_left_alone(self):
        data, _ = self.data_with_a_job()
        with sqlite3.connect(data / "keylume.db") as database:
            database.execute("PRAGMA user_version=4711")
        database.close()
        before = (data / "keylume.db").read_bytes()
        code, _, said = self.start(data)
        self.assertGreater(code, 0)
        self.assertIn("4711", said)
        self.assertEqual((data / "keylume.db").read_bytes(), before)

    def test_a_folder_that_cannot_be_written_is_named(self):
        data, _ = self.data_with_a_job()
        mount = self.folder / "read-only"
        if not mounted(mount, "size=64m"):
            self.skipTest("no mounts here")
        self.addCleanup(subprocess.run, ["umount", "-l", str(mount)], check=False)
        shutil.copytree(data, mount / "data")
        subprocess.run(["mount", "-o", "remount,ro", str(mount)], check=True)
        ended = subprocess.run([SERVER, "--data", str(mount / "data"), "--listen", f"127.0.0.1:{free_port()}"],
                               capture_output=True, text=True, timeout=20, check=False)
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn("Read-only file system", ended.stdout + ended.stderr)
        self.assertIn(str(mount / "data"), ended.stdout + ended.stderr)


class Clock(ServiceTestCase):
    """The wall clock jumps; time is faked for the server and its workers alone. It jumps by a year, and a month is what
    the jobs have: who believed it would remove what is kept and give up what waits or runs."""
    A_MONTH_S = 30 * 24 * 3600
    COLLECTED_S = 62  # every minute the server removes what its time is over for
    LONG = {"frames": 16, "line_count": 3_000_000}

    def setUp(self):
        super().setUp()
        library = next((path for path in Path("/usr/lib").glob("*/faketime/libfaketime.so.1")), None)
        if not library:
            self.skipTest("no faketime here")
        self.now = self.folder / "now"
        self.ahead_s = 0
        self.jump(0)
        faked = {"LD_PRELOAD": str(library), "FAKETIME_TIMESTAMP_FILE": str(self.now), "FAKETIME_NO_CACHE": "1",
                 "FAKETIME_DONT_FAKE_MONOTONIC": "1"}
        os.environ.update(faked)
        try:
            self.running = self.service()
        finally:
            for name in faked:
                del os.environ[name]

    def jump(self, years):
        """To so many years from now."""
        self.ahead_s = years * 365 * 24 * 3600
        self.now.write_text(f"{self.ahead_s:+d}s\n")

    def submit(self, name, **lighting):
        """A job that has a month until its deadline, and once it is done a month until it is removed. -> id"""
        job = write_job(self.folder / name, **{**JOB, **lighting})
        deadline = time.gmtime(time.time() + self.ahead_s + self.A_MONTH_S)
        options = {"ttl_seconds": self.A_MONTH_S, "deadline": time.strftime("%Y-%m-%dT%H:%M:%SZ", deadline)}
        fields = [f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}",
                  *(f"materials=@{path}" for path in job.glob("*.mtl")), f"options={json.dumps(options)}"]
        answer = self.running.get("/v1/jobs", *(word for field in fields for word in ("-F", field)))
        self.assertEqual(answer.status, 202, answer.body)
        return answer.json()["id"]

    def one_of_each(self, name):
        """-> ids of a job that is done, one that runs and one that waits"""
        done = self.submit(f"done_{name}")
        self.running.wait_for(done, ["succeeded"], 60)
        runs = self.submit(f"runs_{name}", **self.LONG)
        self.running.wait_for(runs, ["running"], 60)
        waits = self.submit(f"waits_{name}")
        self.assertEqual(self.running.job(waits)["state"], "queued")
        return done, runs, waits

    def expect_unharmed(self, done, runs, waits):
        self.assertIn(self.running.job(runs)["state"], ("running", "succeeded"))
        self.assertEqual(self.running.wait_for(runs, ["succeeded"], 120)["attempt"], 1)
        self.assertEqual(self.running.wait_for(waits, ["succeeded"], 60)["attempt"], 1)
        self.assertEqual(self.running.get(f"/v1/jobs/{done}/radiosity.npy").status, 200)

    def pass_a_collection(self):
        time.sleep(self.COLLECTED_S)

    def test_a_year_forward(self):
        jobs = self.one_of_each("here")
        self.jump(1)
        self.pass_a_collection()
        self.expect_unharmed(*jobs)
        self.jump(0)
        self.expect_unharmed(*jobs)

    def test_a_year_back_and_forward_again(self):
        self.jump(-1)
        jobs = self.one_of_each("before")
        self.jump(0)
        self.pass_a_collection()
        self.expect_unharmed(*jobs)

    def test_a_year_back(self):
        jobs = self.one_of_each("here")
        self.jump(-1)
        self.expect_unharmed(*jobs)


if __name__ == "__main__":
    unittest.main(verbosity=2)
