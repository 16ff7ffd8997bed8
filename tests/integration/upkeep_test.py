#!/usr/bin/env python3
"""keylume-server backup, restore, check, gc and migrate on real data, with a server running and without."""
import hashlib
import sqlite3
import subprocess
import unittest

from service import SERVER, Service, ServiceTestCase, is_alive, wait_until
from small_disk import armed, go_on, is_halted
from small_jobs import write_job


def command(*words):
    return subprocess.run([SERVER, *map(str, words)], capture_output=True, text=True, timeout=60, stdin=subprocess.DEVNULL)


class Upkeep(ServiceTestCase):
    def finished(self, service, name="job"):
        job_id = self.submitted(service, write_job(self.folder / name, frames=2))
        service.wait_for(job_id, ["succeeded"], 120)
        return job_id

    def test_a_backup_of_a_running_service_restores_to_the_same_results(self):
        service = self.service()
        job_id = self.finished(service)
        self.assertEqual(command("token", "create", "a", "--data", service.data, "--scopes", "jobs:read").returncode, 0)
        token = ["-H", "Authorization: Bearer " + command("token", "create", "b", "--scopes", "jobs:read,queue:admin",
                                                            "--data", service.data).stdout.strip()]
        picture = service.get(f"/v1/jobs/{job_id}/frames/1/image.png", *token)
        self.assertEqual(picture.status, 200)
        backup = self.folder / "backup"
        made = command("backup", backup, "--data", service.data)
        self.assertEqual(made.returncode, 0, made.stderr)
        sums = (backup / "SHA256SUMS").read_text().splitlines()
        for line in sums:
            digest, path = line.split("  ", 1)
            self.assertEqual(hashlib.sha256((backup / path).read_bytes()).hexdigest(), digest, path)
        self.assertEqual({line.split("  ", 1)[1] for line in sums},
                         {str(path.relative_to(backup)) for path in backup.rglob("*") if path.is_file()} - {"SHA256SUMS"})
        self.assertEqual(service.get("/v1/jobs", *token).status, 200, "the service was not disturbed")
        self.assertEqual(service.stop(), 0)

        restored = Service(self.folder / "restored")
        self.assertEqual(command("restore", backup, "--data", restored.data).returncode, 0)
        self.assertEqual(command("check", "--data", restored.data).returncode, 0)
        self.addCleanup(restored.clean_up)
        restored.start()
        again = restored.get(f"/v1/jobs/{job_id}/frames/1/image.png", *token)
        self.assertEqual((again.status, again.body), (200, picture.body))

    def test_a_backup_takes_what_waits_and_leaves_what_a_worker_is_at(self):
        service = self.service()
        long = self.submitted(service, write_job(self.folder / "long", frames=16, line_count=3_000_000))
        service.wait_for(long, ["running"], 30)
        backup = self.folder / "backup"
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 0)
        scene = backup / "jobs" / long / "input/scene.obj"
        self.assertEqual(scene.stat().st_nlink, 1, "what a worker writes into its input does not reach the copy")
        self.assertFalse((backup / "jobs" / long / "checkpoint").exists())
        restored = Service(self.folder / "restored")
        self.assertEqual(command("restore", backup, "--data", restored.data).returncode, 0)
        self.addCleanup(restored.clean_up)
        restored.start()
        self.assertIn(restored.job(long)["state"], ("queued", "running"), "it begins anew")
        self.assertIn(("restored",), self.rows(restored, "SELECT reason FROM event"))
        pid, = self.rows(service, "SELECT worker_pid FROM attempt")[0]
        self.assertTrue(is_alive(pid), "the worker belongs to the original")
        self.assertEqual(service.job(long)["state"], "running")
        for each in (service, restored):
            each.get(f"/v1/jobs/{long}/cancel", "-X", "POST")

    def rows(self, service, sql):
        database = sqlite3.connect(f"file:{service.data}/keylume.db?mode=ro", uri=True)
        try:
            return database.execute(sql).fetchall()
        finally:
            database.close()

    def test_what_is_still_written_is_not_taken(self):
        service = self.service()
        job_id = self.finished(service)
        job = service.data / "jobs" / job_id
        for half in ("views/.tmp.0123/image.png", "videos/.tmp.7.camera.mp4", "videos/half.mp4", "artefacts/.tmp.x",
                     "views/0123.report.json"):
            (job / half).parent.mkdir(parents=True, exist_ok=True)
            (job / half).write_bytes(b"half")
        (job / "videos/whole.mp4").write_bytes(b"whole")
        (job / "videos/whole.mp4.sha256").write_text(hashlib.sha256(b"whole").hexdigest())
        backup = self.folder / "backup"
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 0)
        taken = [path.relative_to(backup / "jobs" / job_id).as_posix() for path in backup.rglob("*")
                 if path.is_relative_to(backup / "jobs" / job_id)]
        self.assertEqual([name for name in taken if "tmp" in name or "half" in name or "report" in name], ["report.json"])
        self.assertIn("videos/whole.mp4", taken)
        for half in ("views/.tmp.0123/image.png", "videos/.tmp.7.camera.mp4", "artefacts/.tmp.x"):
            (job / half).write_bytes(b"more of it")
        self.assertEqual(command("restore", backup, "--data", self.folder / "restored").returncode, 0)
        self.assertEqual(command("check", "--data", self.folder / "restored").returncode, 0)

    def test_one_damaged_job_of_a_backup_keeps_no_other_back(self):
        service = self.service()
        jobs = [self.finished(service, name) for name in ("first", "second")]
        backup = self.folder / "backup"
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 0)
        service.stop()
        report = backup / "jobs" / jobs[0] / "report.json"
        report.write_bytes(report.read_bytes() + b"x")
        restored = Service(self.folder / "restored")
        told = command("restore", backup, "--data", restored.data)
        self.assertEqual(told.returncode, 1)
        self.assertIn(jobs[0], told.stderr)
        self.assertIn("report.json", told.stderr)
        self.assertEqual(command("check", "--data", restored.data).returncode, 0)
        self.addCleanup(restored.clean_up)
        restored.start()
        self.assertEqual([job["id"] for job in restored.get("/v1/jobs").json()["jobs"]], jobs[1:])
        self.assertEqual(restored.get(f"/v1/jobs/{jobs[1]}/radiosity.npy").status, 200)

    def test_folders_of_others_are_not_removed(self):
        service = self.service()
        self.finished(service)
        backup = self.folder / "backup"
        mine = self.folder / "backup.part/mine"
        mine.parent.mkdir()
        mine.write_text("mine")
        refused = command("backup", backup, "--data", service.data)
        self.assertEqual((refused.returncode, mine.read_text()), (75, "mine"))
        self.assertIn("backup.part", refused.stderr)
        mine.unlink()
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 0)
        mine = self.folder / "restored.part"
        mine.write_text("mine")
        self.assertEqual(command("restore", backup, "--data", self.folder / "restored").returncode, 75)
        self.assertEqual(mine.read_text(), "mine")

    def test_check_looks_at_inputs_views_and_videos(self):
        service = self.service()
        job_id = self.finished(service)
        job = service.data / "jobs" / job_id
        (job / "videos").mkdir(exist_ok=True)
        (job / "videos/camera.mp4").write_bytes(b"whole")
        (job / "videos/camera.mp4.sha256").write_text(hashlib.sha256(b"whole").hexdigest())
        whole = command("check", "--data", service.data)
        self.assertEqual(whole.returncode, 0, whole.stdout + whole.stderr)
        (job / "videos/camera.mp4").write_bytes(b"hole")
        (job / "views" / ("a" * 32)).mkdir(parents=True)
        scene = job / "input/scene.obj"
        scene.chmod(0o600)
        scene.write_bytes(scene.read_bytes()[:-1])
        damaged = command("check", "--data", service.data)
        self.assertEqual(damaged.returncode, 1)
        for name in ("scene.obj", "videos/camera.mp4", "views/" + "a" * 32):
            self.assertIn(name, damaged.stdout)

    def test_check_does_not_complain_of_what_is_removed_meanwhile(self):
        service = self.service()
        job_id = self.finished(service)
        with armed("check_listed:1:stop"):
            check = subprocess.Popen([SERVER, "check", "--data", str(service.data)], stdout=subprocess.PIPE, text=True)
        self.addCleanup(lambda: check.poll() is None and check.kill())
        wait_until(lambda: is_halted(check.pid), 20, "check has listed what to look at")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}", "-X", "DELETE").status, 204)
        go_on(check.pid)
        said, _ = check.communicate(timeout=60)
        self.assertEqual(check.returncode, 0, said)

    def test_a_backup_never_overwrites_and_a_damaged_one_is_not_restored(self):
        service = self.service()
        self.finished(service)
        backup = self.folder / "backup"
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 0)
        self.assertEqual(command("backup", backup, "--data", service.data).returncode, 75)
        self.assertEqual(command("restore", backup, "--data", service.data).returncode, 75)
        database = backup / "keylume.db"
        database.write_bytes(database.read_bytes() + b"x")
        refused = command("restore", backup, "--data", self.folder / "restored")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("keylume.db", refused.stderr)
        self.assertFalse((self.folder / "restored").exists())
        (backup / "SHA256SUMS").unlink()
        self.assertEqual(command("restore", backup, "--data", self.folder / "restored").returncode, 1)

    def test_check_names_the_file_that_changed(self):
        service = self.service()
        job_id = self.finished(service)
        whole = command("check", "--data", service.data)
        self.assertEqual(whole.returncode, 0, whole.stdout + whole.stderr)
        file = service.data / "jobs" / job_id / "artefacts/radiosity.npy"
        content = bytearray(file.read_bytes())
        content[-1] ^= 1
        file.chmod(0o600)
        file.write_bytes(content)
        damaged = command("check", "--data", service.data)
        self.assertEqual(damaged.returncode, 1)
        self.assertIn("radiosity.npy", damaged.stdout)

    def test_check_sees_damaged_pages(self):
        service = self.service()
        for i in range(3):
            self.finished(service, f"job{i}")
        service.stop()
        self.assertEqual(command("check", "--data", service.data).returncode, 0)
        file = service.data / "keylume.db"
        content = bytearray(file.read_bytes())
        for at in range(4096, len(content) - 4096, 4096):
            content[at:at + 64] = b"\xa5" * 64
        file.write_bytes(content)
        damaged = command("check", "--data", service.data)
        self.assertEqual(damaged.returncode, 1)
        self.assertIn("database", damaged.stdout + damaged.stderr)

    def test_what_writes_waits_for_no_server_but_names_it(self):
        service = self.service()
        for name in ("gc", "migrate"):
            refused = command(name, "--data", service.data)
            self.assertEqual(refused.returncode, 75, refused.stderr)
            self.assertIn(f"process {service.process.pid}", refused.stderr)
        service.stop()
        (service.data / "jobs" / "left-over").mkdir()
        for name in ("gc", "migrate"):
            done = command(name, "--data", service.data)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse((service.data / "jobs" / "left-over").exists())

    def test_the_page_for_people_holds_every_operation_and_no_script(self):
        service = self.service()
        page = service.get("/docs")
        self.assertEqual(page.status, 200)
        text = page.body.decode()
        for item in service.get("/openapi.json").json()["paths"].values():
            for method, operation in item.items():
                if method != "parameters":
                    self.assertIn(f'id="{operation["operationId"]}"', text)
        self.assertNotIn("<script", text)
        policy = page.headers["content-security-policy"]
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("unsafe", policy)

    def test_the_limits_are_told(self):
        limits = self.service().get("/v1/limits").json()
        self.assertEqual(limits["frames_max"], 2000)
        self.assertEqual(limits["upload_bytes_max"], 2 << 30)
        self.assertIsNone(limits["requests_per_second_max"], "none on loopback")
        self.assertIsNone(limits["stored_bytes_per_token_max"], "none by default")
        self.assertEqual(limits["queued_jobs_per_token_max"], 10_000)
        for name in ("idle_connections_max", "waits_at_once_max", "archive_entries_max", "views_per_job_max",
                     "series_patches_max", "requests_answered_at_once_max", "stream_seconds_max"):
            self.assertGreater(limits[name], 0, name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
