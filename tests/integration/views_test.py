#!/usr/bin/env python3
"""Views over HTTP: other pictures of a finished job, and pictures of one that is still at work."""
import hashlib
import json
import unittest

from service import ServiceTestCase, wait_until
from small_jobs import changed, write_job

FRAMES = 6


class Views(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = cls("runTest")
        cls.shared.setUp()
        cls.addClassCleanup(cls.shared.doCleanups)
        job = write_job(cls.shared.folder / "job", frames=FRAMES)
        cls.camera = json.loads((job / "animation.json").read_text())["images"][0]["camera"]
        cls.running = cls.shared.service()
        cls.job_id = cls.shared.submitted(cls.running, job)
        cls.running.wait_for(cls.job_id, ["succeeded"], 240)

    def runTest(self):
        pass

    @classmethod
    def fetch(cls, path, *arguments):
        return cls.running.get(f"/v1/jobs/{cls.job_id}{path}", *arguments)

    def post(self, request, service=None):
        body = request if isinstance(request, str) else json.dumps(request)
        return (service or self.running).get(f"/v1/jobs/{self.job_id}/views", "-H", "Content-Type: application/json",
                                             "--data-binary", body)

    def made(self, request):
        """Posts and waits until the view is ready -> its JSON"""
        answer = self.post(request)
        self.assertIn(answer.status, (200, 202), answer.body)
        location = answer.headers["location"]

        def ready():
            view = self.running.get(location).json()
            self.assertNotEqual(view["state"], "failed", view)
            return view if view["state"] == "ready" else None
        return wait_until(ready, 60, "the view is made")

    def test_a_view_is_made_once_and_served_with_its_hash(self):
        request = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0, 3], "width": 80,
                   "height": 45, "formats": ["jpg", "png"]}
        view = self.made(request)
        self.assertEqual(view["request"]["frames"], [0, 3])
        self.assertEqual([file["href"].rsplit("/", 1)[1] for file in view["files"]],
                         ["0.png", "0.jpg", "3.png", "3.jpg"])
        for file in view["files"]:
            answer = self.running.get(file["href"])
            self.assertEqual(answer.status, 200)
            self.assertEqual(hashlib.sha256(answer.body).hexdigest(), file["sha256"])
            self.assertEqual(answer.headers["etag"], f'"{file["sha256"]}"')
        reordered = {"formats": ["png", "jpg"], **request}
        again = self.post(reordered)
        self.assertEqual((again.status, again.json()["id"]), (200, view["id"]), "the same request is the same view")
        self.assertIn(view["id"], [entry["id"] for entry in self.fetch("/views").json()["views"]])
        for wrong in ("1.png", "0.exr", "3", "x.png", "0.png.png", "manifest.json", "..%2f0.png"):
            self.assertEqual(self.fetch(f"/views/{view['id']}/frames/{wrong}").status, 404, wrong)
        self.assertEqual(self.fetch(f"/views/{view['id']}", "-X", "DELETE").status, 204)
        self.assertEqual(self.fetch(f"/views/{view['id']}").status, 404)
        self.assertEqual(self.fetch(f"/views/{view['id']}", "-X", "DELETE").status, 404)

    def test_a_picture_that_is_not_there_says_what_to_post_and_is_there_afterwards(self):
        stored = self.fetch("/frames/2/image.png")
        self.assertEqual(stored.status, 200)
        for query in ("jpg", "png?exposure=-1.5", "png?tone_map=clip", "exr"):
            kind, _, parameters = query.partition("?")
            path = f"/frames/2/image.{kind}?camera={self.camera}&{parameters}"
            missing = self.fetch(path)
            self.assertEqual(missing.status, 404, missing.body[:200])
            hint = missing.json()["view"]
            self.assertEqual((hint["method"], hint["href"]), ("POST", f"/v1/jobs/{self.job_id}/views"))
            self.made(hint["body"])
            found = self.fetch(path)
            self.assertEqual(found.status, 200, found.body[:200])
            self.assertNotEqual(found.body, stored.body)
        self.assertEqual(self.fetch("/frames/2/image.png?exposure=auto&tone_map=filmic").body, stored.body)
        self.assertEqual(self.fetch("/frames/2/image.png?exposure=lots").status, 400)
        self.assertEqual(self.fetch("/frames/2/image.png?camera=nobody").status, 404)

    def test_wrong_requests_name_every_place(self):
        answer = self.post({"camera": "nobody", "frames": [FRAMES], "height": 1e9, "light": 1})
        self.assertEqual(answer.status, 422)
        self.assertEqual(sorted(error["pointer"] for error in answer.json()["errors"]),
                         ["/camera", "/frames/0", "/height", "/light"])
        self.assertEqual(self.post("").status, 422)
        self.assertEqual(self.post("[" * 100_000).status, 422)

    def test_a_promised_view_is_made_after_a_kill(self):
        service = self.service("killed")
        job = write_job(self.folder / "job2", frames=FRAMES)
        job_id = self.submitted(service, job)
        service.wait_for(job_id, ["succeeded"], 240)
        large = {"camera": self.camera, "width": 1600, "height": 900, "samples_per_pixel": 16}
        answer = service.get(f"/v1/jobs/{job_id}/views", "--data-binary", json.dumps(large))
        self.assertEqual(answer.status, 202, answer.body)
        service.kill()
        service.start()
        location = answer.headers["location"]
        view = wait_until(lambda: (lambda v: v if v.get("state") == "ready" else None)(service.get(location).json()),
                          100, "the view is made by the next server")
        self.assertEqual(len(view["files"]), FRAMES)
        folder = service.job_folder(job_id) / "views"
        self.assertEqual([path.name for path in folder.iterdir() if path.name.startswith(".tmp")], [])
        self.assertEqual(service.get(location.rsplit("/", 2)[0], "-X", "DELETE").status, 204, "the job with all views")

    def test_pictures_are_shown_while_the_job_is_at_work(self):
        service = self.service("early")
        # Pictures come in blocks of 32 frames: several of them, so that some are there well before the last.
        job = write_job(self.folder / "job3", frames=110, width=320, height=180)
        changed(job, lambda document: document["images"][0].update(samples_per_pixel=16))
        job_id = self.submitted(service, job)

        def first_pictures():
            answer = service.get(f"/v1/jobs/{job_id}/preview").json()
            return answer if answer["images"] else None
        early = wait_until(first_pictures, 240, "the first picture")
        self.assertFalse(early["complete"], "too late to see anything: the job is done already")
        picture = service.get(early["images"][0]["href"])
        self.assertEqual((picture.status, picture.headers["x-keylume-partial"]), (200, "true"))
        self.assertEqual(picture.headers["cache-control"], "no-store")
        self.assertNotIn("etag", picture.headers)
        self.assertEqual(picture.body[-8:-4], b"IEND", "whole")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/radiosity.npy").status, 404)
        service.wait_for(job_id, ["succeeded"], 240)
        final = service.get(early["images"][0]["href"])
        self.assertEqual(final.body, picture.body)
        self.assertNotIn("x-keylume-partial", final.headers)
        self.assertTrue(service.get(f"/v1/jobs/{job_id}/preview").json()["complete"])


if __name__ == "__main__":
    unittest.main()
