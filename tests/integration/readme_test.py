#!/usr/bin/env python3
"""The README's curl section, run as written (but for the port, which may be taken here)."""
import json
import re
import subprocess
import unittest
from pathlib import Path

import numpy

from service import ServiceTestCase

ROOT = Path(__file__).resolve().parent.parent.parent


def curl_section():
    """The shell block between the markers."""
    text = (ROOT / "README.md").read_text()
    section = re.search(r"<!-- curl: begin.*?-->(.*?)<!-- curl: end -->", text, re.DOTALL)[1]
    return re.fullmatch(r"\s*```sh\n(.*)```\s*", section, re.DOTALL)[1]


class Readme(ServiceTestCase):
    def test_the_curl_section_works_as_written(self):
        service = self.service()
        script = curl_section()
        self.assertIn("127.0.0.1:8080", script)
        script = script.replace("127.0.0.1:8080", f"127.0.0.1:{service.port}")
        place = self.folder / "checkout"  # the files it fetches do not litter the real one
        place.mkdir()
        (place / "api").symlink_to(ROOT / "api")
        run = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=place, capture_output=True, text=True,
                             timeout=300)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        job = json.loads((place / "job.json").read_text())
        self.assertEqual(job["state"], "succeeded", run.stdout)
        self.assertEqual((place / "frame0.png").read_bytes()[:4], b"\x89PNG")
        radiosity, patches = numpy.load(place / "radiosity.npy"), numpy.load(place / "patches.npz")
        self.assertEqual(radiosity.shape, (job["frame_count"], len(patches["area_m2"]), 3))
        self.assertEqual(len(json.loads((place / "key_frames.json").read_text())["frames"]), job["frame_count"])
        self.assertEqual(service.get("/v1/jobs").json()["jobs"], [], "the last command removed the job")


if __name__ == "__main__":
    unittest.main(verbosity=2)
