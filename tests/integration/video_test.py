#!/usr/bin/env python3
"""Videos: made once on request, kept, with the frames and the size of the job."""
import hashlib
import json
import os
import shutil
import subprocess
import unittest

import service as service_module
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

    def test_without_ffmpeg_a_problem_says_so(self):
        empty = self.folder / "bin"
        empty.mkdir()
        before = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", before)
        running = service_module.Service(self.folder / "data")
        self.addCleanup(running.clean_up)
        curl_folder = os.path.dirname(shutil.which("curl"))
        for tool in ("curl",):
            (empty / tool).symlink_to(os.path.join(curl_folder, tool))
        os.environ["PATH"] = str(empty)
        running.start()
        job_id = self.finished(running)
        answer = running.get(f"/v1/jobs/{job_id}/video.mp4")
        self.assertEqual((answer.status, answer.headers["content-type"]), (503, "application/problem+json"))
        self.assertIn("ffmpeg", answer.json()["detail"])


if __name__ == "__main__":
    unittest.main()
