#!/usr/bin/env python3
"""A job from submission to its results, over HTTP."""
import collections
import hashlib
import io
import unittest

import numpy

from service import ServiceTestCase
from small_jobs import write_job

FRAMES = 12


class OneJob(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        """One job serves all the tests of this class."""
        cls.shared = cls("runTest")
        cls.shared.setUp()
        cls.addClassCleanup(cls.shared.doCleanups)
        job = write_job(cls.shared.folder / "job", frames=FRAMES)
        cls.running = cls.shared.service()
        cls.accepted = cls.running.submit(job)
        if cls.accepted.status != 202:
            raise AssertionError(cls.accepted.body.decode())
        cls.job_id = cls.accepted.json()["id"]
        cls.finished = cls.running.wait_for(cls.job_id, ["succeeded"], 240)

    def runTest(self):
        pass

    def fetch(self, path, *arguments):
        return self.running.get(f"/v1/jobs/{self.job_id}{path}", *arguments)

    def test_submission_answers_where_to_watch_the_job(self):
        self.assertEqual(self.accepted.headers["location"], f"/v1/jobs/{self.job_id}")
        self.assertIn(self.accepted.json()["state"], ("queued", "running"))

    def test_a_finished_job_tells_what_it_did(self):
        self.assertEqual(self.finished["progress"]["fraction"], 1)
        self.assertEqual(self.finished["frame_count"], FRAMES)
        self.assertTrue(1 < self.finished["key_frame_count"] <= self.finished["solved_frame_count"] <= FRAMES,
                        self.finished)
        listed = self.running.get("/v1/jobs").json()["jobs"]
        self.assertEqual([job["id"] for job in listed], [self.job_id])

    def test_every_link_answers(self):
        for name, path in self.finished["links"].items():
            self.assertEqual(self.running.get(path).status, 200, f"{name}: {path}")

    def test_every_frame_has_an_image(self):
        sums = set()
        for frame in range(FRAMES):
            answer = self.fetch(f"/frames/{frame}/image.png")
            self.assertEqual((answer.status, answer.headers["content-type"]), (200, "image/png"))
            self.assertEqual(answer.body[:8], b"\x89PNG\r\n\x1a\n")
            sums.add(hashlib.sha256(answer.body).hexdigest())
        self.assertGreater(len(sums), FRAMES // 2, "the plane moves, so do the pictures")
        self.assertEqual(self.fetch(f"/frames/{FRAMES}/image.png").status, 404)

    def test_radiosity_and_patches_are_numpy_files_that_fit_together(self):
        radiosity = numpy.load(io.BytesIO(self.fetch("/radiosity.npy").body))
        patches = numpy.load(io.BytesIO(self.fetch("/patches.npz").body))
        count = len(patches["area_m2"])
        self.assertEqual((radiosity.shape, radiosity.dtype), ((FRAMES, count, 3), numpy.float32))
        self.assertTrue(numpy.isfinite(radiosity).all() and (radiosity >= 0).all())
        self.assertGreater(radiosity.mean(), 0.0)
        self.assertEqual(patches["corners"].shape, (count, 4, 3))
        numpy.testing.assert_allclose(numpy.linalg.norm(patches["normal"], axis=1), 1, atol=1e-5)
        for frame in (0, FRAMES - 1):
            one = numpy.load(io.BytesIO(self.fetch(f"/frames/{frame}/radiosity.npy").body))
            numpy.testing.assert_array_equal(one, radiosity[frame])

    def test_the_manifest_has_the_hash_of_every_file(self):
        entries = {entry["path"]: entry for entry in self.fetch("/manifest.json").json()["artefacts"]}
        served = {path: f"/{path}" for path in ("radiosity.npy", "patches.npz")}
        images = sorted(path for path in entries if path.endswith(".png"))
        self.assertEqual(len(images), FRAMES)
        served.update({path: f"/frames/{frame}/image.png" for frame, path in enumerate(images)})
        for path, route in served.items():
            body = self.fetch(route).body
            self.assertEqual(entries[path]["bytes"], len(body), path)
            self.assertEqual(entries[path]["sha256"], hashlib.sha256(body).hexdigest(), path)

    def test_key_frames_cover_the_animation(self):
        report = self.fetch("/key-frames").json()
        self.assertEqual(len(report["frames"]), FRAMES)
        kinds = collections.Counter(frame["kind"] for frame in report["frames"])
        self.assertEqual(kinds["key"], self.finished["key_frame_count"])
        self.assertEqual(kinds["key"] + kinds["check"], self.finished["solved_frame_count"])
        self.assertEqual((report["intervals"][0]["first"], report["intervals"][-1]["last"]), (0, FRAMES - 1))

    def test_files_carry_their_hash_as_etag_and_answer_304(self):
        whole = self.fetch("/radiosity.npy")
        etag = f'"{hashlib.sha256(whole.body).hexdigest()}"'
        self.assertEqual(whole.headers["etag"], etag)
        again = self.fetch("/radiosity.npy", "-H", f"If-None-Match: {etag}")
        self.assertEqual((again.status, again.body), (304, b""))
        other = self.fetch("/radiosity.npy", "-H", 'If-None-Match: "0000"')
        self.assertEqual(other.status, 200)

    def test_files_answer_ranges(self):
        whole = self.fetch("/radiosity.npy").body
        size = len(whole)
        for text, first, last in (("0-9", 0, 9), ("10-10", 10, 10), (f"{size - 5}-", size - 5, size - 1),
                                  ("-7", size - 7, size - 1), (f"5-{size + 100}", 5, size - 1)):
            part = self.fetch("/radiosity.npy", "-H", f"Range: bytes={text}")
            self.assertEqual((part.status, part.body), (206, whole[first:last + 1]), text)
            self.assertEqual(part.headers["content-range"], f"bytes {first}-{last}/{size}", text)
        self.assertEqual(self.fetch("/radiosity.npy", "-H", f"Range: bytes={size}-").status, 416)

    def test_head_answers_the_headers_alone(self):
        head = self.fetch("/radiosity.npy", "-I")
        self.assertEqual(head.status, 200)
        self.assertEqual(int(head.headers["content-length"]), len(self.fetch("/radiosity.npy").body))

    def test_what_is_not_there_is_a_problem_document(self):
        for path in ("/v1/jobs/nobody", f"/v1/jobs/{self.job_id}/frames/0/image.png?camera=nobody",
                     f"/v1/jobs/{self.job_id}/frames/{FRAMES}", "/v1/nothing"):
            answer = self.running.get(path)
            self.assertEqual((answer.status, answer.headers["content-type"]), (404, "application/problem+json"), path)
            self.assertEqual(answer.json()["status"], 404)


if __name__ == "__main__":
    unittest.main(verbosity=2)
