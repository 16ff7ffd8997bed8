#!/usr/bin/env python3
"""What a run takes of memory is what was forecast: no more, for the queue relies on it, and not much less."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))
from small_jobs import changed, write_job  # noqa: E402

WORKER = os.environ["KEYLUME_WORKER"]
MIB = 1 << 20
# A program that does next to nothing takes 15 to 20 MiB, by what the system has it map.
MORE_AT_MOST, OF_THE_PROGRAM_BYTES = 1.25, 8 * MIB

SMALL = {"width": 64, "height": 36}
LARGE = {"width": 960, "height": 540}


class ForecastMemory(unittest.TestCase):
    def report_of(self, example, formats, options):
        with tempfile.TemporaryDirectory(prefix="keylume-memory-") as folder:
            job = write_job(Path(folder) / "input", example=example, **options)
            if formats:
                changed(job, lambda whole: [image.update(formats=formats) for image in whole["images"]])
            run = subprocess.run([WORKER, "render", folder, "--threads", "2"], capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(run.returncode, 0, run.stderr)
            return json.loads((Path(folder) / "report.json").read_text())

    def assert_as_forecast(self, example, formats=None, **options):
        with self.subTest(example=example, formats=formats, **options):
            report = self.report_of(example, formats, options)
            forecast, taken = report["forecast"]["memory_bytes"], report["peak_memory_bytes"]
            print(f"{example} {options}: {forecast / MIB:.0f} MiB forecast, {taken / MIB:.0f} taken", flush=True)
            self.assertLessEqual(taken, forecast)
            self.assertLessEqual(forecast, MORE_AT_MOST * taken + OF_THE_PROGRAM_BYTES)

    def test_of_lines_and_frames(self):
        self.assert_as_forecast("cornell_box", frames=48, preset="standard", **SMALL)
        self.assert_as_forecast("garage", frames=1, **SMALL)
        self.assert_as_forecast("garage", frames=60, **SMALL)
        self.assert_as_forecast("room", frames=30, preset="standard", **SMALL)

    def test_without_errors_there_are_fewer_and_longer_sets_of_lines(self):
        self.assert_as_forecast("garage", frames=120, standard_errors=False, **SMALL)
        self.assert_as_forecast("cornell_box", frames=48, preset="standard", standard_errors=False, **SMALL)

    def test_of_many_patches(self):
        self.assert_as_forecast("garage", frames=12, patch_edge_m=0.1, **SMALL)

    def test_of_modes(self):
        for options in ({"mode": "reference"}, {"interpolated": "total"}, {"target_error": 0.05}):
            self.assert_as_forecast("garage", frames=40, **options, **SMALL)

    def test_of_pictures_and_their_files(self):
        self.assert_as_forecast("cornell_box", frames=24, **LARGE)
        self.assert_as_forecast("room", frames=40, **LARGE)
        self.assert_as_forecast("cornell_box", ["exr"], frames=12, width=320, height=180)

    def test_of_much_that_moves(self):
        self.assert_as_forecast("office", frames=12, **SMALL)


if __name__ == "__main__":
    unittest.main(verbosity=2)
