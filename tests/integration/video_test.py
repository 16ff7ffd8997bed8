#!/usr/bin/env python3
"""Videos: made once on request, kept, with the frames and the size of the job, by an ffmpeg that is shut in."""
import hashlib
import json
import os
import shutil
import subprocess
import unittest

import service as service_module
from curl import curl
from service import ServiceTestCase, wait_until
from small_jobs import write_job

FRAMES = 12


class Videos(ServiceTestCase):
    def finished(self, service):
        job_id = self.submitted(service, write_job(self.folder / "job", frames=FRAMES, width=65, height=37))
        service.wait_for(job_id, ["succeeded"], 240)
        return job_id

    @unittest.skipUnless(shutil.which("ffmpeg") and shutil.which("ffprobe"), "ffmpeg is not installed")
    def test_mp4_and_webm_play_every_frame(self):
        service = self.service()
        job_id = self.finished(service)
        fps = json.loads((self.folder / "job/animation.json").read_text())["frames"]["fps"]
        for kind, codec in (("mp4", "h264"), ("webm", "vp9")):
            path = f"/v1/jobs/{job_id}/video.{kind}"
            first = service.get(path)
            self.assertEqual((first.status, "retry-after" in first.headers), (202, True), first.body[:200])
            video = wait_until(lambda: (lambda a: a if a.status == 200 else None)(service.get(path)), 100, kind)
            self.assertEqual(video.headers["content-type"], f"video/{kind}")
            self.assertEqual(video.headers["etag"], f'"{hashlib.sha256(video.body).hexdigest()}"')
            self.assertEqual(service.get(path, "-H", "Range: bytes=4-7").body, video.body[4:8])
            file = self.folder / f"video.{kind}"
            file.write_bytes(video.body)
            probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-of", "json",
                                    "-show_entries", "stream=codec_name,pix_fmt,width,height,nb_read_frames,r_frame_rate",
                                    str(file)], check=True, capture_output=True, text=True, timeout=60)
            stream = json.loads(probe.stdout)["streams"][0]
            self.assertEqual((stream["codec_name"], stream["pix_fmt"]), (codec, "yuv420p"))
            self.assertEqual((stream["width"], stream["height"]), (66, 38), "even, as 4:2:0 needs")
            self.assertEqual(int(stream["nb_read_frames"]), FRAMES)
            numerator, denominator = map(int, stream["r_frame_rate"].split("/"))
            self.assertAlmostEqual(numerator / denominator, fps, 2)
        mp4 = (self.folder / "video.mp4").read_bytes()
        self.assertLess(mp4.index(b"moov"), mp4.index(b"mdat"), "the index comes first: it starts at once")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/video.mp4?camera=nobody").status, 404)

    def service_with_path(self, folder):
        """A service whose PATH is that folder alone."""
        (folder / "curl").symlink_to(shutil.which("curl"))
        running = service_module.Service(self.folder / "data")
        self.addCleanup(running.clean_up)
        self.addCleanup(os.environ.__setitem__, "PATH", os.environ["PATH"])
        os.environ["PATH"] = str(folder)
        return running.start()

    def video_of(self, running, job_id, checked=True):
        def answered():
            answer = curl(f"{running.url}/v1/jobs/{job_id}/video.mp4", checked=checked)
            return answer if answer.status != 202 else None
        return wait_until(answered, 60, "a video, or why there is none")

    def test_an_ffmpeg_that_is_taken_over_reaches_nothing(self):
        tools = self.folder / "bin"
        tools.mkdir()
        (tools / "ffmpeg").symlink_to(os.environ["KEYLUME_FAKE_FFMPEG"])
        running = self.service_with_path(tools)
        job_id = self.finished(running)
        folder = running.job_folder(job_id)
        before = {path: path.read_bytes() for part in ("input", "artefacts") for path in (folder / part).rglob("*")
                  if path.is_file()}
        said = dict(line.split(": ") for line in self.video_of(running, job_id).body.decode().splitlines())
        print(said)
        in_force = running.get("/version").json()["worker_sandbox"]
        for name in ("read a picture", "start a thread", "lead its own group"):
            self.assertEqual(said[name], "done", name)
        self.assertEqual((said["no_new_privs"], said["core"], said["open files"]), ("1", "0", "64"))
        self.assertNotEqual(said["inherit files"], "done")
        if "seccomp" in in_force:
            for name in ("open a socket", "open a unix socket"):
                self.assertEqual(said[name], "EPERM", name)
            for name in ("run a program beside", "run a program instead", "run itself again", "signal the server"):
                self.assertNotEqual(said[name], "done", name)
        if "landlock" in in_force:
            for name in ("write a picture", "read the scene", "read the radiosity", "write the radiosity",
                         "write another video", "write in the job", "read the database", "write the database",
                         "write outside", "read the passwords"):
                self.assertEqual(said[name], "EACCES", name)
            self.assertFalse((running.data.parent / "made").exists())
            self.assertEqual(sorted(path.name.split(".", 1)[1] for path in (folder / "videos").iterdir()),
                             ["mp4", "mp4.sha256"])
        self.assertEqual({path: path.read_bytes() for path in before}, before)

    def test_an_ffmpeg_that_cannot_be_run_is_a_problem_and_leaves_nothing(self):
        tools = self.folder / "bin"
        tools.mkdir()
        (tools / "ffmpeg").write_text("#!/bin/sh\nexit 0\n")
        (tools / "ffmpeg").chmod(0o755)
        running = self.service_with_path(tools)
        job_id = self.finished(running)
        if "landlock" not in running.get("/version").json()["worker_sandbox"]:
            self.skipTest("without Landlock a script is run")
        answer = self.video_of(running, job_id, checked=False)
        self.assertEqual(answer.status, 500, answer.body)
        self.assertEqual(list((running.job_folder(job_id) / "videos").iterdir()), [])

    def test_without_ffmpeg_a_problem_says_so(self):
        empty = self.folder / "bin"
        empty.mkdir()
        running = self.service_with_path(empty)
        job_id = self.finished(running)
        answer = running.get(f"/v1/jobs/{job_id}/video.mp4")
        self.assertEqual((answer.status, answer.headers["content-type"]), (503, "application/problem+json"))
        self.assertIn("ffmpeg", answer.json()["detail"])


if __name__ == "__main__":
    unittest.main()
