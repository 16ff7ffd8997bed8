#!/usr/bin/env python3
"""The README's curl section, run as written (but for the port, which may be taken here)."""
import json
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import numpy

from service import SERVER, ServiceTestCase, free_port

ROOT = Path(__file__).resolve().parent.parent.parent


def curl_section():
    """The shell block between the markers."""
    text = (ROOT / "README.md").read_text()
    section = re.search(r"<!-- curl: begin.*?-->(.*?)<!-- curl: end -->", text, re.DOTALL)[1]
    return re.fullmatch(r"\s*```sh\n(.*)```\s*", section, re.DOTALL)[1]


class Readme(ServiceTestCase):
    def run_in(self, place, port, timeout_s):
        """Not with bash -e: the block itself must stop at a failure."""
        script = curl_section()
        self.assertIn("127.0.0.1:8080", script)
        script = script.replace("127.0.0.1:8080", f"127.0.0.1:{port}")
        return subprocess.run(["bash", "-c", script], cwd=place, capture_output=True, text=True, timeout=timeout_s)

    def test_the_curl_section_works_as_written(self):
        service = self.service()
        place = self.folder / "checkout"  # the files it fetches do not litter the real one
        place.mkdir()
        (place / "api").symlink_to(ROOT / "api")
        run = self.run_in(place, service.port, 300)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertTrue(run.stdout.endswith("\n"), run.stdout)
        watched = run.stdout.splitlines()
        self.assertTrue(any(re.fullmatch(r"running \w+ \d+%", line) for line in watched), run.stdout)
        self.assertTrue(any(re.fullmatch(r"succeeded \w* 100%", line) for line in watched), run.stdout)
        fetched = place / "cornell"
        self.assertEqual(sorted(path.name for path in place.iterdir()), ["api", "cornell"])
        job = json.loads((fetched / "job.json").read_text())
        self.assertEqual(job["state"], "succeeded", run.stdout)
        self.assertEqual((fetched / "frame0.png").read_bytes()[:4], b"\x89PNG")
        radiosity, patches = numpy.load(fetched / "radiosity.npy"), numpy.load(fetched / "patches.npz")
        self.assertEqual(radiosity.shape, (job["frame_count"], len(patches["area_m2"]), 3))
        self.assertEqual(len(json.loads((fetched / "key_frames.json").read_text())["frames"]), job["frame_count"])
        self.assertEqual(json.loads((fetched / "view.json").read_text())["request"]["frames"], [24])
        self.assertEqual([each["id"] for each in json.loads((fetched / "jobs.json").read_text())["jobs"]], [job["id"]])
        seen, removal = re.fullmatch(r"See it: (\S+)   Remove it: (.+)", watched[-1]).groups()
        self.assertTrue(seen.endswith("/jobs/" + job["id"]), seen)
        subprocess.run(["bash", "-c", removal], check=True, capture_output=True, timeout=20)
        self.assertEqual(service.get("/v1/jobs").json()["jobs"], [])

    def test_the_curl_section_stops_when_the_job_is_refused(self):
        service = self.service()
        example = shutil.copytree(ROOT / "api/examples/cornell_box", self.folder / "api/examples/cornell_box")
        (example / "animation.json").write_text('{"frame": 1}')
        run = self.run_in(self.folder, service.port, 30)
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertIn("is refused", run.stdout)

    def test_the_curl_section_stops_where_nothing_listens(self):
        shutil.copytree(ROOT / "api/examples/cornell_box", self.folder / "api/examples/cornell_box")
        run = self.run_in(self.folder, free_port(), 30)
        self.assertEqual(run.returncode, 1, run.stderr)

    def test_the_table_of_options_is_that_of_the_program(self):
        shown = subprocess.run([SERVER, "--help"], capture_output=True, text=True, timeout=20, check=True).stdout
        shown = shown.partition("other commands")[0]
        begins = re.split(r"^  (?=--)", shown, flags=re.MULTILINE)[1:]
        in_help = {re.match(r"--\S+(?: [A-Z][A-Z:]*| text\|json)?", begin)[0]: " ".join(begin.split()) for begin in begins}
        del in_help["--help,"]
        section = (ROOT / "README.md").read_text().partition("## Running the service")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| `(--[^`]+)` \| (.*?) ?\| (.+?) \| (.+) \|$", section, re.MULTILINE)
        in_readme = {name.replace("\\|", "|"): default for name, _, default, _ in rows}
        self.assertEqual(list(in_readme), list(in_help), "the same options in the same order")
        for name, text in in_help.items():
            told = re.search(r"default:? (\d+)\b(?!\.\d)", text)
            self.assertEqual(in_readme[name] if in_readme[name].isdigit() else None, told and told[1], (name, text))


if __name__ == "__main__":
    unittest.main(verbosity=2)
