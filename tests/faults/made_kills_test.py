#!/usr/bin/env python3
"""kill -9 while a view or a video is made: it comes out all the same, of itself or when it is asked for again, with
the bytes of one that nobody disturbed. Until then nobody is given any of it, and nothing of the attempt stays."""
import hashlib
import json
import os
import shutil
import subprocess
import time
import unittest
from pathlib import Path

from finished_jobs import finish_jobs
from service import SERVER, ServiceTestCase, is_alive, wait_until
from small_disk import armed, is_halted

JOB = {"frames": 3, "line_count": 20_000, "moving_line_count": 10_000, "patch_edge_m": 1.5, "samples_per_light": 1,
       "width": 640, "height": 360}  # so that ffmpeg takes a while
VIEW = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0, 2], "width": 64, "height": 36}
# Places in the server, and in the worker that renders the view.
OF_VIEW = ["view_promised", "view_hashed"]
OF_VIEW_WORKER = ["view_rendered", "view_renamed"]
OF_VIDEO = ["video_written", "video_renamed", "video_summed"]
PLACES = set(OF_VIEW + OF_VIEW_WORKER + OF_VIDEO)
HAS_FFMPEG = shutil.which("ffmpeg") is not None


def sha256(body):
    return hashlib.sha256(body).hexdigest()


class MadeKilled(ServiceTestCase):
    expected_view = {}  # hashes by their paths; unknown until the first is made

    @classmethod
    def setUpClass(cls):
        finished = finish_jobs(cls, **JOB)
        cls.finished, cls.job_id = finished.data, finished.ids[0]
        cls.camera = json.loads((finished.input / "animation.json").read_text())["images"][0]["camera"]
        undisturbed = cls()
        undisturbed.setUp()
        cls.addClassCleanup(undisturbed.doCleanups)
        service = undisturbed.with_the_job("undisturbed")
        cls.expected_view = undisturbed.made_view(service, undisturbed.ask_view(service))
        cls.expected_video = sha256(undisturbed.made_video(service).body) if HAS_FFMPEG else None
        service.stop()

    def with_the_job(self, name):
        shutil.copytree(self.finished, self.folder / name)
        return self.service(name)

    def ask_view(self, service):
        """-> its address, or None where the server died before it answered"""
        try:
            asked = service.get(f"/v1/jobs/{self.job_id}/views", "-H", "Content-Type: application/json",
                                "--data-binary", json.dumps(VIEW))
        except subprocess.CalledProcessError:
            return None
        self.assertIn(asked.status, (200, 202), asked.body)
        return asked.json()["links"]["self"]

    def state_of(self, service, address):
        answer = service.get(address)
        return answer.json()["state"] if answer.status == 200 else answer.status

    def files_of(self, service, address):
        """Whoever guesses their names is given all of a file, or nothing."""
        found = {}
        for path in self.expected_view:
            answer = service.get(f"{address}/{path}")
            if answer.status == 200:
                self.assertEqual(sha256(answer.body), self.expected_view[path], f"half of {path}")
                found[path] = sha256(answer.body)
        return found

    def made_view(self, service, address):
        """Waits for it. -> hashes of its files, by their paths"""
        def ready():
            self.files_of(service, address)
            self.assertNotIn(self.state_of(service, address), ("failed", 404))
            return self.state_of(service, address) == "ready"
        wait_until(ready, 60, "the view is made")
        files = service.get(address).json()["files"]
        return {file["href"].removeprefix(address + "/"): sha256(service.get(file["href"]).body) for file in files}

    def ask_video(self, service):
        try:
            return service.get(f"/v1/jobs/{self.job_id}/video.mp4?camera={self.camera}")
        except subprocess.CalledProcessError:
            return None

    def made_video(self, service):
        def made():
            answer = self.ask_video(service)
            self.assertIn(answer.status, (200, 202), answer.body[:200])
            return answer if answer.status == 200 else None
        return wait_until(made, 60, "the video is made")

    def processes_of(self, service):
        """All that has to do with this data folder, but for its server: workers and ffmpeg."""
        found = []
        for entry in Path("/proc").iterdir():
            try:
                is_ours = entry.name.isdigit() and str(service.data).encode() in (entry / "cmdline").read_bytes()
            except OSError:
                continue
            if is_ours and int(entry.name) != service.process.pid and is_alive(entry.name):
                found.append(int(entry.name))
        return found

    def dies(self, service):
        wait_until(lambda: service.process.poll() is not None, 60, "the server is cut off")
        self.assertEqual(service.process.returncode, -9)
        wait_until(lambda: not self.processes_of(service), 5, "what it had started ends with it")

    def expect_no_leftovers(self, service, views, videos):
        """And `check` finds all of it whole."""
        folder = service.job_folder(self.job_id)
        names = {part: sorted(os.listdir(folder / part)) if (folder / part).exists() else []
                 for part in ("views", "videos")}
        self.assertEqual((len(names["views"]), len(names["videos"])), (3 * views, 2 * videos), names)
        self.assertFalse([name for part in names.values() for name in part if name.startswith(".")], names)
        self.assertEqual(self.processes_of(service), [])
        self.assertEqual(service.stop(), 0)
        checked = subprocess.run([SERVER, "check", "--data", str(service.data)], capture_output=True, text=True,
                                 timeout=60, check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def expect_view(self, service, address):
        self.assertEqual(self.made_view(service, address), self.expected_view)
        self.expect_no_leftovers(service, views=1, videos=0)

    def test_the_server_while_a_view_is_made(self):
        for place in OF_VIEW:
            with self.subTest(place=place):
                with armed(place):
                    service = self.with_the_job(place)
                address = self.ask_view(service)
                self.dies(service)
                service.start()
                # Where nobody was told of it, it comes all the same.
                known = service.get(f"/v1/jobs/{self.job_id}/views").json()["views"]
                self.assertEqual(len(known), 1)
                self.expect_view(service, address or known[0]["links"]["self"])

    def test_the_worker_that_renders_a_view(self):
        for place in OF_VIEW_WORKER:
            with self.subTest(place=place):
                with armed(place):
                    service = self.with_the_job(place)
                address = self.ask_view(service)
                wait_until(lambda: self.state_of(service, address) == "failed", 60, "the worker is cut off")
                self.assertEqual(self.files_of(service, address), {})
                self.assertEqual(os.listdir(service.job_folder(self.job_id) / "views"), [])
                service.stop()
                service.start()
                self.expect_view(service, self.ask_view(service))

    def test_the_server_and_its_worker_while_a_view_is_made(self):
        for place in OF_VIEW_WORKER:
            with self.subTest(place=place):
                with armed(f"{place}:1:stop"):
                    service = self.with_the_job(f"{place}_both")
                address = self.ask_view(service)
                wait_until(lambda: any(map(is_halted, self.processes_of(service))), 60, "the worker is there")
                service.kill()
                self.dies(service)
                service.start()
                self.expect_view(service, address)

    @unittest.skipUnless(HAS_FFMPEG, "no ffmpeg here")
    def test_the_server_while_a_video_is_made(self):
        for place in OF_VIDEO:
            with self.subTest(place=place):
                with armed(place):
                    service = self.with_the_job(place)
                self.ask_video(service)
                self.dies(service)
                service.start()
                self.expect_no_leftovers(service, views=0, videos=1 if place == "video_summed" else 0)
                service.start()
                self.assertEqual(sha256(self.made_video(service).body), self.expected_video)
                self.expect_no_leftovers(service, views=0, videos=1)

    @unittest.skipUnless(HAS_FFMPEG, "no ffmpeg here")
    def test_the_server_while_ffmpeg_runs(self):
        service = self.with_the_job("ffmpeg")
        self.ask_video(service)
        deadline = time.monotonic() + 20
        while not self.processes_of(service):  # without a pause, for it does not run long
            self.assertLess(time.monotonic(), deadline, "ffmpeg runs")
        service.kill()
        self.dies(service)
        service.start()
        self.expect_no_leftovers(service, views=0, videos=0)
        service.start()
        self.assertEqual(sha256(self.made_video(service).body), self.expected_video)
        self.expect_no_leftovers(service, views=0, videos=1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
