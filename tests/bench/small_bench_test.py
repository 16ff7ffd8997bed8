#!/usr/bin/env python3
"""A small `keylume bench limit`: does it run to its end, and is all that it measures a number?

usage: small_bench_test.py KEYLUME
Prints a line "ratio: ..." for each kernel beside raw Embree in the same run. No time is judged.
"""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

TABLES = {"bars", "load", "lines", "channels", "reference", "ladder", "standard_errors", "alone", "key_frames", "images"}


def not_finite(tables):
    """Places whose value should be a number and is none, infinite, or below zero."""
    for table in tables:
        for row, values in enumerate(table["rows"]):
            for key, value in values.items():
                if value is None or (isinstance(value, (int, float)) and not (math.isfinite(value) and value >= 0)):
                    yield f"{table['name']}, row {row}: {key} is {value}"


def problems_of(report):
    tables = {table["name"]: table["rows"] for table in report["tables"]}
    yield from (f"there is no table {name}" for name in sorted(TABLES - tables.keys()))
    yield from (f"table {name} is empty" for name, rows in tables.items() if not rows)
    yield from not_finite(report["tables"])
    for row in tables.get("ladder", []):
        if not row["seconds"] > 0 or not row["rmse_percent"] > 0:
            yield f"setting {row['setting']} took no time or has no error: {row}"


def main(keylume):
    with tempfile.TemporaryDirectory(prefix="keylume-bench-") as folder:
        subprocess.run([keylume, "bench", "limit", "--quick", "--out", folder], check=True, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL)
        report = json.loads((Path(folder) / "report.json").read_text())
    problems = list(problems_of(report))
    tables = {table["name"]: table["rows"] for table in report["tables"]}
    for row in tables.get("lines", []):
        print(f"ratio: lines of the {row['scene']}, threads {row['threads']:.0f}: {row['ratio']:.2f} of raw Embree, "
              f"{row['ratio_kept']:.2f} with rows kept")
    for row in tables.get("channels", []):
        print(f"ratio: gather of three channels beside one: {row['ratio']:.2f}")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
