#!/usr/bin/env python3
"""keylume view: pictures from the radiosity of a finished job, by hand."""
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from png_pixels import light_of, png_pixels, shown
from small_jobs import changed, write_job

WORKER = os.environ["KEYLUME_WORKER"]
FRAMES = 6


class Views(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="keylume-test-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.job = cls.folder / "job"
        write_job(cls.job / "input", frames=FRAMES, patch_layout="adaptive")
        changed(cls.job / "input", lambda job: job["images"][0].update(formats=["png", "exr", "jpg"]))
        cls.camera = json.loads((cls.job / "input/animation.json").read_text())["images"][0]["camera"]
        subprocess.run([WORKER, "render", str(cls.job)], check=True, capture_output=True, timeout=200)
        cls.images = cls.job / "artefacts/images" / cls.camera

    def view(self, name, request, *options, job=None):
        """-> (CompletedProcess, folder, report)"""
        views = (job or self.job) / "views"
        views.mkdir(exist_ok=True)
        (views / f"{name}.json").write_text(request if isinstance(request, str) else json.dumps(request))
        run = subprocess.run([WORKER, "view", str(job or self.job), "--name", name, *options], capture_output=True,
                             text=True, timeout=100)
        report = views / f"{name}.report.json"
        return run, views / name, json.loads(report.read_text()) if report.exists() else None

    def test_the_jobs_own_view_is_its_pictures_byte_for_byte(self):
        for name, frames in (("all", None), ("some", [1, 4])):
            request = {"camera": self.camera, "width": 64, "height": 36, "formats": ["png", "exr", "jpg"]}
            if frames:
                request["frames"] = frames
            run, folder, _ = self.view(name, request)
            self.assertEqual(run.returncode, 0, run.stderr)
            expected = [f"{frame:04d}.{kind}" for frame in frames or range(FRAMES) for kind in ("exr", "jpg", "png")]
            self.assertEqual(sorted(path.name for path in folder.iterdir()), expected + ["manifest.json"])
            for file in expected:
                self.assertEqual((folder / file).read_bytes(), (self.images / file).read_bytes(), file)
            for entry in json.loads((folder / "manifest.json").read_text())["artefacts"]:
                self.assertEqual(hashlib.sha256((folder / entry["path"]).read_bytes()).hexdigest(), entry["sha256"])

    def test_another_camera_size_and_exposure_without_solving(self):
        camera = {"position": [1, 1, 1.5], "target": [3, 3, 1], "vertical_fov_degrees": 70}
        begin = time.monotonic()
        run, folder, report = self.view("other", {"camera": camera, "frames": [0], "width": 101, "height": 57,
                                                  "formats": ["jpg", "png"], "exposure_stops": 1, "tone_map": "clip"})
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertLess(time.monotonic() - begin, 20)
        self.assertNotIn("solve", report.get("stage_seconds", {}))
        jpeg = (folder / "0000.jpg").read_bytes()
        self.assertEqual((jpeg[:2], jpeg[-2:]), (b"\xff\xd8", b"\xff\xd9"))
        self.assertEqual((folder / "0000.png").read_bytes()[16:24], bytes([0, 0, 0, 101, 0, 0, 0, 57]))
        _, brighter, _ = self.view("brighter", {"camera": camera, "frames": [0], "width": 101, "height": 57,
                                                "exposure_stops": 2, "tone_map": "clip"})
        self.assertNotEqual((brighter / "0000.png").read_bytes(), (folder / "0000.png").read_bytes())

    def test_all_that_is_wrong_is_said_at_once(self):
        run, folder, report = self.view("wrong", {"camera": "nobody", "frames": [0, FRAMES, 0], "width": 0,
                                                  "formats": ["gif"], "exposure_stops": 40, "light": 1})
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertEqual(sorted(error["pointer"] for error in report["violations"]),
                         ["/camera", "/exposure_stops", "/formats/0", "/frames/1", "/frames/2", "/light", "/width"])
        self.assertFalse(folder.exists())
        for name, text in (("cut", '{"camera": '), ("empty", "{}")):
            run, folder, report = self.view(name, text)
            self.assertEqual((run.returncode, folder.exists()), (2, False), run.stderr)
        run, _, report = self.view("large", {"camera": self.camera, "width": 8192, "height": 8192,
                                             "frames": list(range(FRAMES)), "samples_per_pixel": 1, "formats": ["png"],
                                             "tone_map": "clip"}, "--seconds", "1")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertFalse((self.job / "views/large").exists())

    def test_lights_as_bright_as_asked_add_up(self):
        """One lamp of the garage is a group: a picture of it alone, of the others alone, and of both, by linearity."""
        job = self.folder / "groups"
        write_job(job / "input", frames=2, standard_errors=False, light_groups={"first": ["lamp_0_0"]})
        subprocess.run([WORKER, "render", str(job)], check=True, capture_output=True, timeout=200)

        def picture(name, **gains):
            request = {"camera": self.camera, "frames": [1], "width": 64, "height": 36, "tone_map": "clip",
                       "exposure_stops": -1, "light_gains": gains}
            run, folder, _ = self.view(name, request, job=job)
            self.assertEqual(run.returncode, 0, run.stderr)
            return png_pixels(folder / "0001.png")

        first, other = picture("first", other=0), picture("other", first=0)
        self.assertGreater(first.mean(), 5)
        self.assertGreater(other.mean(), 5)
        # Lamps are cut off at white before their edges are filtered, which does not add up: a sample of the four on one
        # makes a pixel 137 at least.
        seen = (first > 0) & (other > 0) & (first < 130) & (other < 130)
        self.assertGreater(seen.mean(), 0.5)
        for name, gains in (("as_it_is", {}), ("mixed", {"first": [3, 2, 1], "other": 0.5})):
            expected = shown(light_of(first) * gains.get("first", 1) + light_of(other) * gains.get("other", 1))
            # Each of the two was rounded to a 255th before.
            self.assertLessEqual(abs(picture(name, **gains) - expected)[seen].max(), 3, name)

    def test_groups_that_are_not_there_are_named(self):
        run, _, report = self.view("unknown", {"camera": self.camera, "light_gains": {"frist": 2}})
        self.assertEqual(run.returncode, 2)
        self.assertEqual(report["violations"][0]["pointer"], "/light_gains/frist")

    def test_results_of_another_job_are_refused(self):
        other = self.folder / "other"
        shutil.copytree(self.job / "input", other / "input")
        self.assertEqual(self.view("early", {"camera": self.camera}, job=other)[0].returncode, 1, "not rendered yet")
        shutil.copytree(self.job / "artefacts", other / "artefacts")
        changed(other / "input", lambda job: job["lighting"].update(patch_layout="uniform"))
        run, folder, report = self.view("stale", {"camera": self.camera}, job=other)
        self.assertEqual((run.returncode, folder.exists()), (1, False), run.stderr)
        self.assertIn("rendered again", report["message"])

    def test_names_that_lead_elsewhere_are_refused(self):
        for name in ("", "..", "a/b", ".x", "x" * 65):
            run = subprocess.run([WORKER, "view", str(self.job), "--name", name], capture_output=True, timeout=20)
            self.assertEqual(run.returncode, 64, name)


if __name__ == "__main__":
    unittest.main()
