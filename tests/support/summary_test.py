#!/usr/bin/env python3
"""The closing lines of tests/run count what ctest's result files say."""
import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import summary

PASSED = '<testcase name="good" status="run" time="1.5"/>'
FAILED = ('<testcase name="bad" status="fail" time="0.5"><failure message=""/>'
          '<system-out>what it said</system-out></testcase>')
SKIPPED = '<testcase name="absent" status="notrun" time="0"><skipped message="SKIP_RETURN_CODE=77"/></testcase>'
UNBUILT = '<testcase name="unbuilt" status="notrun" time="0"><skipped message="Unable to find executable"/></testcase>'
MEASURED = '<testcase name="bench" status="run" time="9"><system-out>noise\nratio: lines: 1.31\n</system-out></testcase>'


class Summary(unittest.TestCase):
    def run_on(self, **cases_of_label):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as output:
            for label, cases in cases_of_label.items():
                if cases is not None:
                    Path(folder, f"{label}.xml").write_text(f"<testsuite>{cases}</testsuite>")
            code = summary.main(folder, list(cases_of_label))
        return code, output.getvalue()

    def test_all_passed(self):
        code, output = self.run_on(unit=PASSED * 2, accuracy=PASSED)
        self.assertEqual((code, output.splitlines()[-1]), (0, "3 passed, 0 failed"))

    def test_what_a_test_measured_is_shown_where_it_passed(self):
        code, output = self.run_on(bench=MEASURED)
        self.assertEqual((code, output.splitlines()[-1]), (0, "1 passed, 0 failed"))
        self.assertIn("\nratio: lines: 1.31\n", output)
        self.assertNotIn("noise", output)

    def test_the_time_of_a_label_is_told_with_its_budget(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "container.xml")
            self.assertEqual(summary.time_of(path, 1.5).split(), ["1.5", "s", "of", "720"])
            path.with_suffix(".seconds").write_text("90\n")
            self.assertEqual(summary.time_of(path, 1.5).split(), ["90.0", "s", "of", "720"], "of tests that ran at once")
            self.assertEqual(summary.time_of(Path(folder, "peers.xml"), 1.5).split(), ["1.5", "s"])

    def test_what_was_left_out_is_shown_also_of_what_was_skipped(self):
        told = SKIPPED.replace("</testcase>", "<system-out>left out: a: why\n</system-out></testcase>")
        self.assertIn("left out: a: why", self.run_on(container=PASSED + told)[1])

    def test_a_failure_is_named_and_counted(self):
        code, output = self.run_on(unit=PASSED + FAILED)
        self.assertEqual((code, output.splitlines()[-1]), (1, "1 passed, 1 failed"))
        self.assertIn("failed:  bad\n    what it said\n", output)

    def test_what_is_skipped_is_named_and_has_not_passed(self):
        code, output = self.run_on(conventions=PASSED + SKIPPED)
        self.assertEqual((code, output.splitlines()[-1]), (0, "1 passed, 0 failed, 1 skipped"))
        self.assertIn("skipped: absent", output)

    def test_what_was_not_built_is_a_failure(self):
        code, output = self.run_on(unit=PASSED + UNBUILT)
        self.assertEqual((code, output.splitlines()[-1]), (1, "1 passed, 1 failed"))

    def test_no_test_at_all_is_a_failure(self):
        self.assertEqual(self.run_on(unit="")[0], 1)
        self.assertEqual(self.run_on(unit=SKIPPED)[0], 1)

    def test_a_label_without_results_is_a_failure(self):
        code, output = self.run_on(unit=PASSED, integration=None)
        self.assertEqual((code, output.splitlines()[-1]), (1, "1 passed, 1 failed"))


if __name__ == "__main__":
    unittest.main()
