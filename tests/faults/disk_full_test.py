#!/usr/bin/env python3
"""No room: at an upload, the commit of a job, while a worker writes and publishes, when its results are taken down, at
a blob, a view, a video, a backup, and for the log. Refused with 507, or waiting with a reason that is shown; nothing is
lost, it goes on by itself once there is room, and the results are the bytes of a run that always had room."""
import contextlib
import hashlib
import json
import os
import shutil
import sqlite3
import subprocess
import time
import unittest

from curl import curl
from finished_jobs import finish_jobs
from service import SERVER, Service, ServiceTestCase, hashes_of, wait_until
from small_disk import SmallDiskTestCase, armed, go_on, is_halted
from small_jobs import write_job

JOB = {"frames": 3, "line_count": 20_000, "moving_line_count": 10_000, "patch_edge_m": 1.5, "samples_per_light": 1}
# Takes seconds, and some megabytes.
VIEW = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "width": 1920, "height": 1080, "formats": ["exr"],
        "samples_per_pixel": 4}


class DiskFull(SmallDiskTestCase):
    @classmethod
    def setUpClass(cls):
        """What comes of it where there is room."""
        roomy = finish_jobs(cls, **JOB)
        cls.input, cls.expected = roomy.input, roomy.expected

    def expect_whole(self, service, job_id, timeout_s=120):
        job = service.wait_for(job_id, ["succeeded"], timeout_s)
        self.assertEqual(hashes_of(service.job_folder(job_id) / "artefacts"), self.expected)
        return job

    def expect_held(self, service):
        """Whoever asks is told that nothing is started, and why."""
        queue = service.get("/v1/queue").json()
        self.assertFalse(queue["paused"])
        self.assertRegex(queue["held"], "the disk is full: [0-9]+ bytes are free, 67108864 are needed")
        time.sleep(1.1)  # it is looked at once a second
        ready = service.get("/readyz")
        self.assertEqual(ready.status, 503)
        self.assertIn("the disk is full", ready.json()["checks"]["disk"])
        self.assertEqual(service.get("/healthz").status, 200)

    def expect_free(self, service):
        self.assertIsNone(service.get("/v1/queue").json()["held"])
        wait_until(lambda: service.get("/readyz").status == 200, 10, "the service is ready again")

    def service_halting_at(self, place, name="small/data"):
        with armed(f"{place}:stop"):
            return self.service(name)

    def nudged(self, service, word):
        """Every worker is halted at its place, the later ones too: has them go on. -> how many"""
        halted = [pid for pid in self.workers_of(service, word) if is_halted(pid)]
        for pid in halted:
            go_on(pid)
        return len(halted)

    def folders_of(self, service):
        return [path.name for part in ("jobs", "tmp") for path in (service.data / part).iterdir()]

    def test_on_a_full_disk_a_job_can_be_removed(self):
        service = self.service("small/data")
        jobs = [self.submitted(service, self.input) for _ in range(3)]
        for job_id in jobs:
            service.wait_for(job_id, ["succeeded"], 120)
        ballast = service.data / "ballast"
        self.assertEqual(ballast.stat().st_blocks * 512, 16 << 20)
        filler = self.fill()
        for job_id in jobs:
            answer = service.get(f"/v1/jobs/{job_id}", "-X", "DELETE")
            self.assertEqual(answer.status, 204, answer.body)
            self.assertIsNone(service.job_folder(job_id))
        filler.unlink()
        self.assertEqual(service.stop(), 0)
        service.start()
        self.assertTrue(ballast.exists(), "for the next time")

    def test_an_upload_without_room_is_507_and_leaves_nothing(self):
        service = self.service("small/data")
        filler = self.fill()
        self.assertEqual(service.submit(self.input).status, 507)
        self.expect_held(service)
        self.assertEqual(self.folders_of(service), [])
        filler.unlink()
        self.expect_free(service)
        self.expect_whole(service, self.submitted(service, self.input))

    def test_an_upload_whose_size_nobody_told_is_507_once_the_disk_is_full(self):
        service = self.service("small/data")
        filler = self.fill(but=80 << 20)  # above what is kept free, so that it begins
        texture = self.folder / "big.png"
        with texture.open("wb") as file:
            file.truncate(100 << 20)
        fields = [f"scene=@{self.input / 'scene.obj'}", f"animation=@{self.input / 'animation.json'}",
                  f"textures=@{texture}"]
        answer = curl(service.url + "/v1/jobs", "-H", "Transfer-Encoding: chunked",
                      *(word for field in fields for word in ("-F", field)), timeout_s=60)
        self.assertEqual(answer.status, 507, answer.body)
        self.assertEqual(self.folders_of(service), [])
        self.assertEqual(service.get("/healthz").status, 200)
        filler.unlink()
        self.expect_whole(service, self.submitted(service, self.input))

    def least_free(self, commands):
        """Runs them all at once. -> (what curl printed, the least that was free meanwhile)"""
        running = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
                   for command in commands]
        least = 1 << 60
        while any(process.poll() is None for process in running):
            about = os.statvfs(self.mount)
            least = min(least, about.f_bavail * about.f_frsize)
            time.sleep(0.005)
        return [process.communicate()[0] for process in running], least

    def test_uploads_that_come_at_once_leave_the_room_that_is_kept_free(self):
        service = self.service("small/data")
        texture = self.folder / "big.png"
        with texture.open("wb") as file:
            file.truncate(60 << 20)
        command = ["curl", "-sS", "--max-time", "60", "-o", os.devnull, "-w", "%{http_code}", "-H",
                   "Transfer-Encoding: chunked", "-F", f"scene=@{self.input / 'scene.obj'}", "-F",
                   f"animation=@{self.input / 'animation.json'}", "-F", f"textures=@{texture}",
                   service.url + "/v1/validate"]
        statuses, least = self.least_free([command] * 4)
        self.assertIn("507", statuses)
        self.assertGreaterEqual(least, 64 << 20)
        self.assertEqual(self.folders_of(service), [])
        self.assertEqual(service.get("/readyz").status, 200)

    def test_a_blob_that_is_named_often_needs_room_each_time(self):
        service = self.service("small/data")
        files = []
        for field, path in (("scene", self.input / "scene.obj"), ("animation", self.input / "animation.json")):
            sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
            service.get(f"/v1/blobs/sha256/{sha256}", "-T", str(path))
            files.append({"field": field, "name": path.name, "sha256": sha256})
        big = self.folder / "big"
        big.write_bytes(os.urandom(1 << 20) * 40)
        sha256 = hashlib.sha256(big.read_bytes()).hexdigest()
        self.assertEqual(service.get(f"/v1/blobs/sha256/{sha256}", "-T", str(big)).status, 201)
        files += [{"field": "textures", "name": f"{i}.png", "sha256": sha256} for i in range(5)]
        answers, least = self.least_free([[
            "curl", "-sS", "--max-time", "60", "-o", os.devnull, "-w", "%{http_code}", "-H",
            "Content-Type: application/json", "--data-binary", json.dumps({"files": files}), service.url + "/v1/jobs"]])
        self.assertEqual(answers, ["507"])
        self.assertGreaterEqual(least, 64 << 20)
        self.assertEqual(self.folders_of(service), [])

    def test_a_blob_without_room_is_507_and_leaves_nothing(self):
        service = self.service("small/data")
        blob = self.folder / "blob"
        blob.write_bytes(os.urandom(1 << 20) * 100)
        path = "/v1/blobs/sha256/" + hashlib.sha256(blob.read_bytes()).hexdigest()
        send = ("-X", "PUT", "-T", str(blob))
        filler = self.fill(but=80 << 20)
        for more in ((), ("-H", "Transfer-Encoding: chunked")):  # refused before it begins, and in its middle
            self.assertEqual(service.get(path, *send, *more).status, 507)
            self.assertEqual(self.folders_of(service), [])
        self.assertEqual(service.get(path).status, 404)
        filler.unlink()
        self.assertEqual(service.get(path, *send).status, 201)

    def test_a_job_that_cannot_be_committed_is_507_and_leaves_nothing(self):
        service = self.service_halting_at("folder_moved:1")
        fields = [f"scene=@{self.input / 'scene.obj'}", f"animation=@{self.input / 'animation.json'}",
                  *(f"materials=@{path}" for path in self.input.glob("*.mtl"))]
        sent = subprocess.Popen(["curl", "-sS", "-o", str(self.folder / "answer"), "-w", "%{http_code}",
                                 service.url + "/v1/jobs", *(word for field in fields for word in ("-F", field))],
                                stdout=subprocess.PIPE, text=True)
        wait_until(lambda: is_halted(service.process.pid), 20, "the server is halted before the commit")
        # What has been in the write-ahead log before leaves room in it; an empty one needs some.
        with contextlib.closing(sqlite3.connect(service.data / "keylume.db")) as database:
            self.assertEqual(database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0], 0)
        filler = self.fill()
        go_on(service.process.pid)
        self.assertEqual(sent.communicate(timeout=30)[0], "507", (self.folder / "answer").read_text())
        self.assertEqual(self.folders_of(service), [])
        self.assertEqual(service.get("/v1/jobs").json()["jobs"], [])
        filler.unlink()
        self.expect_whole(service, self.submitted(service, self.input))

    def test_a_job_waits_for_room_wherever_its_worker_was(self):
        for place in ("patches_lit:1", "file_written:4", "manifest_due:1"):
            with self.subTest(place=place):
                name = "small/" + place.replace(":", "_")
                service = self.service_halting_at(place, name)
                job_id = self.submitted(service, self.input)
                worker = self.halted_worker(service)
                filler = self.fill()
                go_on(worker)
                wait_until(lambda: not service.worker_pids(), 60, "the worker ends")
                time.sleep(1.5)  # the supervisor looks whether it can start another
                self.assertEqual(service.worker_pids(), [], "none is started on a full disk")
                self.assertIn(service.job(job_id)["state"], ("running", "queued"))
                self.assertEqual(service.submit(self.input).status, 507)
                self.expect_held(service)
                filler.unlink()
                wait_until(lambda: self.nudged(service, "render") or service.job(job_id)["state"] == "succeeded", 120,
                           "it goes on")
                self.expect_whole(service, job_id)
                self.expect_free(service)
                service.stop()
                shutil.rmtree(service.data)

    def test_the_same_server_takes_the_job_up_again(self):
        service = self.service("small/data")
        job = write_job(self.folder / "long", **{**JOB, "line_count": 3_000_000})
        job_id = self.submitted(service, job)
        wait_until(service.worker_pids, 20, "a worker runs")
        filler = self.fill()
        wait_until(lambda: not service.worker_pids(), 60, "the worker ends")
        self.expect_held(service)
        filler.unlink()

        def begun_again():
            job = service.job(job_id)
            return job if job["attempt"] >= 2 or "disk_full" in (job["reason"] or "") else None
        wait_until(begun_again, 60, "its reason is told, or it runs again")
        service.wait_for(job_id, ["succeeded"], 120)

    def test_results_that_cannot_be_taken_down_are_taken_down_later(self):
        refused = 0
        for place in ("worker_ended:1", "results_collected:1"):
            with self.subTest(place=place):
                service = self.service_halting_at(place, "small/" + place.replace(":", "_"))
                job_id = self.submitted(service, self.input)
                wait_until(lambda: is_halted(service.process.pid), 60, "the server is halted before it keeps them")
                filler = self.fill()
                self.addCleanup(filler.unlink, missing_ok=True)
                go_on(service.process.pid)
                # The database's log may have had room in itself; then they are kept at once.
                wait_until(lambda: "cannot record the end" in service.log.read_text() or
                           service.job(job_id)["state"] == "succeeded", 20, "the log says so")
                refused += service.job(job_id)["state"] == "running"
                self.expect_held(service)
                filler.unlink()
                self.assertEqual(self.expect_whole(service, job_id)["attempt"], 1, "nothing is done twice")
                service.stop()
        self.assertGreater(refused, 0, "there was no room at least once")

    def finished(self):
        service = self.service("small/data")
        job_id = self.submitted(service, self.input)
        self.expect_whole(service, job_id)
        service.stop()
        return job_id

    def test_a_view_waits_for_room(self):
        job_id = self.finished()
        post = ("-H", "Content-Type: application/json", "--data-binary", json.dumps(VIEW))
        service = self.service("small/data")
        view = service.get(f"/v1/jobs/{job_id}/views", *post).json()["links"]["self"]
        wait_until(lambda: self.workers_of(service, "view"), 20, "a worker is at it")
        filler = self.fill()
        waiting = wait_until(lambda: "error" in service.get(view).json() and service.get(view).json(), 60, "it waits")
        self.assertEqual(waiting["state"], "waiting")
        self.assertIn("the disk of the service is full", waiting["error"])
        filler.unlink()

        def ready():
            now = service.get(view).json()
            return now if now["state"] == "ready" else None
        made = wait_until(ready, 120, "the view is made")
        self.assertEqual(service.get(made["files"][0]["href"]).status, 200)

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg here")
    def test_a_video_waits_for_room(self):
        job_id = self.finished()
        service = self.service("small/data")
        camera = json.loads((self.input / "animation.json").read_text())["images"][0]["camera"]
        path = f"/v1/jobs/{job_id}/video.mp4?camera={camera}"
        filler = self.fill()

        def asked(wanted):
            answer = service.get(path)
            return answer if wanted(answer) else None
        waiting = wait_until(lambda: asked(lambda now: now.status == 202 and "error" in now.json()), 60, "it waits")
        self.assertEqual(waiting.json()["state"], "waiting")
        filler.unlink()
        whole = wait_until(lambda: asked(lambda now: now.status == 200), 60, "the video is made")
        self.assertEqual(whole.body[4:8], b"ftyp")

    def test_a_backup_without_room_says_so_and_leaves_nothing(self):
        roomy = self.service("data")
        self.expect_whole(roomy, self.submitted(roomy, self.input))
        roomy.stop()
        before = hashes_of(roomy.data / "jobs")
        words = [SERVER, "backup", str(self.mount / "backup"), "--data", str(roomy.data)]
        filler = self.fill(but=100_000)
        full = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(full.returncode, 1)
        self.assertIn("full", (full.stdout + full.stderr).replace("No space left on device", "full"))
        self.assertEqual([path.name for path in self.mount.iterdir()], ["filler"])
        self.assertEqual(hashes_of(roomy.data / "jobs"), before)
        filler.unlink()
        self.assertEqual(subprocess.run(words, capture_output=True, timeout=60, check=False).returncode, 0)
        restored = ["restore", str(self.mount / "backup"), "--data", str(self.folder / "restored")]
        done = subprocess.run([SERVER, *restored], capture_output=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        restored = hashes_of(self.folder / "restored/jobs")
        self.assertEqual(restored, {path: before[path] for path in restored})
        self.assertEqual([path for path in before if "/artefacts/" in path or "/input/" in path],
                         [path for path in restored if "/artefacts/" in path or "/input/" in path])


class Log(ServiceTestCase):
    """What nobody takes is lost; the service goes on."""

    def served_with(self, **streams):
        service = Service(self.folder / "data")
        self.addCleanup(service.clean_up)
        service.process = subprocess.Popen(service.command(), stdin=subprocess.DEVNULL, **streams)
        wait_until(lambda: service.process.poll() is None and service.answers_quietly(), 20, "the server answers")
        job_id = self.submitted(service, write_job(self.folder / "job", **JOB))
        service.wait_for(job_id, ["succeeded"], 60)
        return service

    def lost_of(self, service):
        for line in service.get("/metrics").body.decode().splitlines():
            if line.startswith("keylume_log_lines_lost_total "):
                return int(float(line.split()[1]))
        self.fail("no such metric")

    def test_a_full_device(self):
        with open("/dev/full", "wb") as full:
            service = self.served_with(stdout=full, stderr=full)
        self.assertGreater(self.lost_of(service), 0)
        self.assertEqual(service.stop(), 0)

    def test_a_pipe_whose_reader_is_gone(self):
        reader, writer = os.pipe()
        os.close(reader)
        service = self.served_with(stdout=writer, stderr=writer)
        os.close(writer)
        self.assertGreater(self.lost_of(service), 0)
        self.assertEqual(service.stop(), 0)

    def test_a_pipe_that_nobody_reads(self):
        reader, writer = os.pipe()
        service = self.served_with(stdout=writer, stderr=writer)
        os.close(writer)
        for _ in range(400):  # each leaves a line of a few hundred bytes
            self.assertEqual(service.get("/v1/jobs").status, 200)
            if self.lost_of(service):
                break
        self.assertGreater(self.lost_of(service), 0, "the pipe was full")
        text = os.read(reader, 1 << 20)
        self.assertIn(b"listening on", text)
        self.assertEqual(service.get("/v1/jobs").status, 200)
        self.assertIn(b"lines of the log were lost", os.read(reader, 1 << 20))
        self.assertEqual(service.stop(), 0)
        os.close(reader)

    def test_standard_streams_that_are_closed(self):
        service = Service(self.folder / "data")
        self.addCleanup(service.clean_up)
        service.process = subprocess.Popen(["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *service.command()])
        wait_until(service.answers_quietly, 20, "the server answers")
        job_id = self.submitted(service, write_job(self.folder / "job", **JOB))
        service.wait_for(job_id, ["succeeded"], 60)
        for number in (0, 1, 2):
            self.assertEqual(os.readlink(f"/proc/{service.process.pid}/fd/{number}"), "/dev/null", "no file of ours")
        self.assertEqual(service.stop(), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
