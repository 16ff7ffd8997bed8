#!/usr/bin/env python3
"""Adds up ctest's JUnit files: a table of labels, the names of what failed or was skipped, one closing line.

usage: summary.py FOLDER LABEL...     reads FOLDER/LABEL.xml, and FOLDER/LABEL.seconds, how long all of it took
exit 0: at least one test passed in every label and none failed.  A label without a result file has failed.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

LINES_OF_A_FAILURE = 40
# What a label is to take at most on two cores that do nothing else: told, not judged. Together 40 minutes with the build.
BUDGET_MINUTES = {"conventions": 1, "unit": 2, "accuracy": 2, "integration": 7, "faults": 5, "bench": 2, "browser": 4,
                  "fuzz": 2, "container": 12}
SHOWN_ALWAYS = ("ratio: ", "left out: ")  # lines of tests that begin so are told also where they passed


def said(case):
    """The end of what a test printed."""
    output = case.find("system-out")
    lines = (output.text or "").strip().splitlines() if output is not None else []
    return (["..."] if len(lines) > LINES_OF_A_FAILURE else []) + lines[-LINES_OF_A_FAILURE:]


def ratios(case):
    """What a test measured, to be shown whatever came out."""
    output = case.find("system-out")
    return [line for line in (output.text or "").splitlines() if line.startswith(SHOWN_ALWAYS)] if output is not None else []


def read_label(path):
    """-> (passed, failed, skipped, seconds, lines about what did not pass, and ratios)"""
    passed, failed, skipped, seconds, lines = 0, 0, 0, 0.0, []
    if not path.is_file():
        return 0, 1, 0, 0.0, [f"failed:  {path.stem}: ctest left no result"]
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        seconds += float(case.get("time") or 0)
        # ctest also calls skipped what it could not run, e.g. a test that was not built; that is a failure.
        skip = case.find("skipped")
        if case.get("status") == "run" and case.find("failure") is None and skip is None:
            passed += 1
            lines += ratios(case)
        elif skip is not None and skip.get("message", "").startswith("SKIP_"):
            skipped += 1
            lines.append(f"skipped: {case.get('name')}")
            lines += [line for line in ratios(case) if line.startswith("left out: ")]
        else:
            failed += 1
            lines.append(f"failed:  {case.get('name')}")
            lines += [f"    {line}" for line in said(case)]
    if passed + failed == 0:
        failed, lines = 1, lines + [f"failed:  {path.stem}: no test ran"]
    return passed, failed, skipped, seconds, lines


def time_of(path, seconds):
    """As it is shown: of the whole label where that is known, of its tests one by one otherwise, and its budget."""
    whole = path.with_suffix(".seconds")
    seconds = float(whole.read_text()) if whole.is_file() else seconds
    budget = BUDGET_MINUTES.get(path.stem)
    return f"{seconds:>10.1f} s" + (f" of {60 * budget:>4}" if budget else "")


def main(folder, labels):
    total_passed = total_failed = total_skipped = 0
    table, remarks = [], []
    for label in labels:
        passed, failed, skipped, seconds, lines = read_label(Path(folder) / f"{label}.xml")
        table.append(f"{label:<14}{passed:>8}{failed:>8}{skipped:>9}{time_of(Path(folder) / f'{label}.xml', seconds)}")
        remarks += lines
        total_passed, total_failed = total_passed + passed, total_failed + failed
        total_skipped += skipped
    print(f"\n{'label':<14}{'passed':>8}{'failed':>8}{'skipped':>9}{'time':>12}")
    print("\n".join(table + remarks))
    skipped_note = f", {total_skipped} skipped" if total_skipped else ""
    print(f"\n{total_passed} passed, {total_failed} failed{skipped_note}")
    return 0 if total_failed == 0 and total_passed > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
