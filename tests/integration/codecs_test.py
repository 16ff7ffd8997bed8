#!/usr/bin/env python3
"""The worker without its module of image codecs: it renders PNG files, and names what is missing for anything else."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from small_jobs import changed, write_job

WORKER = Path(os.environ["KEYLUME_WORKER"])
MODULE = "keylume-codecs.so"


class Codecs(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="keylume-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.programs = self.folder / "bin"
        self.programs.mkdir()
        shutil.copy(WORKER, self.programs)

    def render(self, formats):
        job = self.folder / formats[0]
        write_job(job / "input", frames=1)
        changed(job / "input", lambda all_of_it: all_of_it["images"][0].update(formats=formats))
        run = subprocess.run([self.programs / WORKER.name, "render", job], capture_output=True, text=True,
                             timeout=120, stdin=subprocess.DEVNULL)
        return run, sorted(path.name for path in (job / "artefacts/images").rglob("*.*"))

    def test_png_needs_no_module(self):
        run, images = self.render(["png"])
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(images, ["0000.png"])

    def test_exr_names_the_module_that_is_missing_and_takes_it_from_either_place(self):
        run, images = self.render(["exr"])
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertIn(str(self.programs / MODULE), run.stderr)
        self.assertEqual(images, [])
        installed = self.folder / "lib/keylume"
        installed.mkdir(parents=True)
        for place in (installed, self.programs):
            shutil.rmtree(self.folder / "exr")
            shutil.copy(WORKER.parent / MODULE, place)
            run, images = self.render(["exr"])
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(images, ["0000.exr"])
            (place / MODULE).unlink()

    def test_the_worker_itself_does_not_depend_on_openimageio(self):
        libraries = subprocess.run(["ldd", WORKER], capture_output=True, text=True, timeout=20, check=True).stdout
        self.assertIn("libstdc++", libraries)
        self.assertNotIn("OpenImageIO", libraries)


if __name__ == "__main__":
    unittest.main(verbosity=2)
