#!/usr/bin/env python3
"""`keylume render JOB_FOLDER` without a server: the same bytes with 1 and 2 threads, stops when told, says how it ended."""
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from small_jobs import changed, write_job

ROOT = Path(__file__).resolve().parent.parent.parent
WORKER = os.environ["KEYLUME_WORKER"]


class WorkerByHand(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="keylume-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def job_folder(self, name, **options):
        write_job(self.folder / name / "input", **options)
        return self.folder / name

    def render(self, folder, *options):
        return subprocess.run([WORKER, "render", str(folder), *options], capture_output=True, text=True, timeout=240,
                              stdin=subprocess.DEVNULL)

    def artefacts(self, folder):
        base = folder / "artefacts"
        return {path.relative_to(base).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
                for path in base.rglob("*") if path.is_file()}

    def test_one_and_two_threads_leave_the_same_bytes(self):
        results = []
        for threads in ("1", "2"):
            folder = self.job_folder(f"threads-{threads}", frames=8)
            run = self.render(folder, "--threads", threads)
            self.assertEqual(run.returncode, 0, run.stderr)
            results.append(self.artefacts(folder))
        self.assertEqual(sum(path.endswith(".png") for path in results[0]), 8)
        self.assertEqual(results[0], results[1])

    def test_what_is_rendered_already_is_not_rendered_again_unless_asked_for_or_changed(self):
        folder = self.job_folder("job", frames=2)
        self.assertEqual(self.render(folder).returncode, 0)
        first = self.artefacts(folder)
        checked = subprocess.run([WORKER, "check", str(folder)], capture_output=True, text=True, timeout=60)
        self.assertEqual(checked.returncode, 0, checked.stderr)

        def lines():
            return len((folder / "progress.ndjson").read_text().splitlines())
        for options, change, done, message in (
                ((), None, True, "already rendered, nothing to do"),
                (("--again",), None, False, "succeeded in"),
                ((), lambda: (folder / "artefacts/radiosity.npy").write_bytes(b"?"), False, "not all of its artefacts"),
                ((), lambda: changed(folder / "input", lambda job: job.update(name="other")), False, "another job was")):
            with self.subTest(message):
                if change:
                    change()
                before = lines()
                run = self.render(folder, *options)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertIn(message, run.stderr)
                self.assertEqual(lines() == before, done)
                self.assertEqual(self.artefacts(folder), first, "a name is nothing that is computed with")

    def test_a_target_error_is_told_at_the_end(self):
        folder = self.job_folder("job", frames=2, target_error=0.5)
        run = self.render(folder)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stderr, r"keylume: noise [\d.]+ % of the mean radiosity; the target error of 50 % is met\n")

    def test_another_seed_leaves_other_bytes(self):
        sums = set()
        for seed in (1, 2):
            folder = self.job_folder(f"seed-{seed}", frames=4, seed=seed)
            self.assertEqual(self.render(folder).returncode, 0)
            sums.add(self.artefacts(folder)["radiosity.npy"])
        self.assertEqual(len(sums), 2)

    def test_progress_never_falls_and_ends_at_one(self):
        folder = self.job_folder("job", frames=4)
        self.assertEqual(self.render(folder).returncode, 0)
        lines = [json.loads(line) for line in (folder / "progress.ndjson").read_text().splitlines()]
        fractions = [line["fraction"] for line in lines]
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(fractions[-1], 1)
        stages = list(dict.fromkeys(line["stage"] for line in lines))
        schema = json.loads((ROOT / "api/schemas/progress_line.schema.json").read_text())
        self.assertEqual(stages, schema["properties"]["stage"]["enum"], "all of them, in the order of the contract")
        self.assertEqual(json.loads((folder / "report.json").read_text())["outcome"], "succeeded")

    def test_a_forecast_is_of_the_right_size(self):
        reports = []
        for name, options in {"few": {"frames": 2}, "many": {"frames": 24, "line_count": 4_000_000}}.items():
            folder = self.job_folder(name, **options)
            checked = subprocess.run([WORKER, "check", str(folder)], capture_output=True, text=True, timeout=60)
            self.assertEqual(checked.returncode, 0, checked.stderr)
            forecast = json.loads((folder / "check.json").read_text())["forecast"]
            self.assertIn(f"{forecast['memory_bytes'] >> 20} MiB", checked.stderr)
            self.assertEqual(self.render(folder).returncode, 0)
            taken = json.loads((folder / "report.json").read_text())
            self.assertEqual(taken["forecast"]["patches"], forecast["patches"])
            ratio = taken["peak_memory_bytes"] / forecast["memory_bytes"]
            self.assertTrue(0.5 < ratio < 2, f"{name}: {ratio} of the memory forecast")
            reports.append(forecast)
        self.assertLess(2 * reports[0]["seconds"], reports[1]["seconds"])

    def test_sigterm_stops_it_within_a_second(self):
        for stage in ("direct", "solve", "images"):
            with self.subTest(stage=stage):
                folder = self.job_folder(f"stop-in-{stage}", frames=60, line_count=3_000_000, samples_per_light=64,
                                         width=640, height=360)
                process = subprocess.Popen([WORKER, "render", str(folder)], stdin=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL)
                self.addCleanup(process.kill)
                self.wait_for_stage(process, folder, stage)
                told = time.monotonic()
                process.send_signal(signal.SIGTERM)
                self.assertEqual(process.wait(timeout=10), 4)
                self.assertLess(time.monotonic() - told, 1.0)
                self.assertFalse((folder / "artefacts/manifest.json").exists())
                self.assertEqual(json.loads((folder / "report.json").read_text())["outcome"], "stopped")

    def wait_for_stage(self, process, folder, stage):
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            try:
                if f'"stage":"{stage}"' in (folder / "progress.ndjson").read_text():
                    return
            except FileNotFoundError:
                pass
            self.assertIsNone(process.poll(), f"it ended before the stage {stage}")
            time.sleep(0.01)
        self.fail(f"it did not reach the stage {stage}")

    def test_a_wrong_job_ends_with_2_and_names_the_place(self):
        folder = self.job_folder("job", frames=2)
        changed(folder / "input", lambda job: job["lighting"].update(tolerance=-1))
        run = self.render(folder)
        self.assertEqual(run.returncode, 2, run.stderr)
        violations = json.loads((folder / "report.json").read_text())["violations"]
        self.assertEqual([violation["pointer"] for violation in violations], ["/lighting/tolerance"])

    def test_a_wrong_command_line_ends_with_64(self):
        self.assertEqual(self.render(self.folder, "--no-such-option").returncode, 64)


if __name__ == "__main__":
    unittest.main(verbosity=2)
