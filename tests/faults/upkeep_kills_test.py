#!/usr/bin/env python3
"""kill -9 in the middle of a backup, a restore and a collection of garbage: what was there is unharmed, what is half
done is known for it and refused, and doing it again does it."""
import sqlite3
import subprocess
import time
import unittest

from finished_jobs import finish_jobs
from service import SERVER, Service, ServiceTestCase, hashes_of
from small_disk import armed

JOB = {"frames": 2, "line_count": 20_000, "moving_line_count": 10_000, "patch_edge_m": 1.5, "samples_per_light": 1}
# Places in their order.
OF_BACKUP = ["backup_database_copied", "backup_job_taken:1", "backup_job_taken:2", "backup_sums_written", "folder_made",
             "folder_named"]
OF_RESTORE = ["restore_file_copied:1", "restore_file_copied:7", "folder_made", "folder_named"]
OF_GC = ["leftover_removed:1", "removal_marked:1", "files_removed:1", "expired_removed:1", "removal_marked:2",
         "files_removed:2"]
PLACES = {name.split(":")[0] for name in OF_BACKUP + OF_RESTORE + OF_GC} | {"check_listed"}  # where upkeep_test halts


def command(*words):
    return subprocess.run([SERVER, *map(str, words)], capture_output=True, text=True, timeout=60,
                          stdin=subprocess.DEVNULL, check=False)


class UpkeepKilled(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        finished = finish_jobs(cls, count=2, **JOB)
        cls.input, cls.jobs, cls.data = finished.input, finished.ids, finished.data
        cls.before = hashes_of(cls.data)

    def cut_off(self, place, *words):
        with armed(place):
            self.assertEqual(command(*words).returncode, -9, f"{words[0]} passes {place}")

    def expect_unharmed(self, data=None):
        # SQLite's log and its index come and go with whoever reads.
        now = {path: sha for path, sha in hashes_of(self.data).items() if not path.startswith("keylume.db-")}
        self.assertEqual(now, {path: sha for path, sha in self.before.items() if not path.startswith("keylume.db-")})
        checked = command("check", "--data", data or self.data)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def expect_served(self, data):
        """The jobs are there with their results."""
        self.expect_unharmed(data)
        service = Service(data)
        self.addCleanup(service.clean_up)
        service.start()
        for job_id in self.jobs:
            self.assertEqual(service.job(job_id)["state"], "succeeded")
            self.assertEqual(service.get(f"/v1/jobs/{job_id}/radiosity.npy").status, 200)
        service.stop()

    def test_a_backup(self):
        for place in OF_BACKUP:
            with self.subTest(place=place):
                folder = self.folder / place.replace(":", "_")
                self.cut_off(place, "backup", folder, "--data", self.data)
                self.expect_unharmed()
                again = command("backup", folder, "--data", self.data)
                if place == "folder_named":  # that one was whole
                    self.assertEqual(again.returncode, 75)
                    self.assertIn("exists already", again.stderr)
                else:
                    self.assertEqual(again.returncode, 0, again.stderr)
                restored = self.folder / f"restored_{place.replace(':', '_')}"
                self.assertEqual(command("restore", folder, "--data", restored).returncode, 0)
                self.expect_served(restored)

    def test_half_a_backup_is_not_restored(self):
        for place in OF_BACKUP[:-1]:
            with self.subTest(place=place):
                folder = self.folder / place.replace(":", "_")
                self.cut_off(place, "backup", folder, "--data", self.data)
                self.assertFalse(folder.exists(), "it gets its name when it is whole")
                for name in (folder, f"{folder}.part", f"{folder}.part/"):
                    refused = command("restore", name, "--data", self.folder / "never")
                    self.assertEqual(refused.returncode, 1)
                    self.assertIn("half a backup", refused.stderr)
                    self.assertFalse((self.folder / "never").exists())
        (self.folder / "renamed").mkdir()
        refused = command("restore", self.folder / "renamed", "--data", self.folder / "never")
        self.assertIn("is no backup", refused.stderr)
        refused = command("restore", self.folder / "none", "--data", self.folder / "never")
        self.assertIn("does not exist", refused.stderr)

    def test_a_restore(self):
        backup = self.folder / "backup"
        self.assertEqual(command("backup", backup, "--data", self.data).returncode, 0)
        whole = hashes_of(backup)
        for place in OF_RESTORE:
            with self.subTest(place=place):
                data = self.folder / place.replace(":", "_")
                self.cut_off(place, "restore", backup, "--data", data)
                self.assertEqual(hashes_of(backup), whole, "the backup is only read")
                if place != "folder_named":
                    self.assertFalse(data.exists(), "no server finds half of it")
                    self.assertEqual(command("restore", backup, "--data", data).returncode, 0)
                self.expect_served(data)

    def with_expired_jobs(self, data):
        """A data folder with two jobs whose time is over, one that stays and a folder that no job owns."""
        backup = self.folder / f"{data.name}_backup"
        self.assertEqual(command("backup", backup, "--data", self.data).returncode, 0)
        self.assertEqual(command("restore", backup, "--data", data).returncode, 0)
        service = Service(data)
        self.addCleanup(service.clean_up)
        service.start()
        stays = self.submitted(service, self.input)
        service.wait_for(stays, ["succeeded"], 120)
        service.stop()
        with sqlite3.connect(data / "keylume.db") as database:
            database.execute("UPDATE job SET ttl_ms = 0 WHERE id <> ?", (stays,))
        database.close()
        time.sleep(0.01)
        (data / "jobs" / "left-over").mkdir()
        return stays

    def test_a_collection_of_garbage(self):
        for place in OF_GC:
            with self.subTest(place=place):
                data = self.folder / place.replace(":", "_")
                stays = self.with_expired_jobs(data)
                kept = hashes_of(data / "jobs" / stays)
                self.cut_off(place, "gc", "--data", data)
                self.assertEqual(hashes_of(data / "jobs" / stays), kept)
                checked = command("check", "--data", data)
                # Between a job's files and its row: it is being removed, and its files are missed by nobody.
                self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
                done = command("gc", "--data", data)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual([path.name for path in (data / "jobs").iterdir()], [stays])
                self.assertEqual(hashes_of(data / "jobs" / stays), kept)
                service = Service(data)
                self.addCleanup(service.clean_up)
                service.start()
                self.assertEqual([job["id"] for job in service.get("/v1/jobs").json()["jobs"]], [stays])
                service.stop()


if __name__ == "__main__":
    unittest.main(verbosity=2)
