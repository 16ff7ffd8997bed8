#!/usr/bin/env python3
"""How far forecasts are off: tests/bench/forecast_costs.py KEYLUME [EXAMPLE...]

Renders small jobs made from the examples with the worker KEYLUME and prints, for each stage of each, the seconds that
were forecast and taken, and their ratio; then the same of memory. To be run on a machine that does nothing else.
The costs of engine/pipeline/forecast_costs.cpp are to be multiplied by the last column, `median`, of their stage.
"""
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))
from small_jobs import write_job  # noqa: E402

# Different in what they take most of: lines, frames, patches, pixels.
SIZES = {
    "lines": {"frames": 8, "line_count": 4_000_000},
    "frames": {"frames": 60},
    "patches": {"frames": 8, "patch_edge_m": 0.1},
    "pixels": {"frames": 12, "width": 640, "height": 360},
}


def rendered(keylume, folder, example, options):
    write_job(folder / "input", example=example, **options)
    subprocess.run([keylume, "render", str(folder)], check=True, capture_output=True, stdin=subprocess.DEVNULL)
    return json.loads((folder / "report.json").read_text())


def main(keylume, *examples):
    ratios = {}
    with tempfile.TemporaryDirectory(prefix="keylume-forecast-") as base:
        for example in examples or ("garage", "cornell_box"):
            for size, options in SIZES.items():
                report = rendered(keylume, Path(base) / f"{example}-{size}", example, options)
                counts = {count["name"]: count["value"] for count in report["counts"]}
                print(f"{example}, {size}: {report['forecast']['seconds']:.2f} s forecast, "
                      f"{counts['wall_seconds']:.2f} s taken")
                rows = [(row["stage"], counts.get(f"forecast_{row['stage']}_seconds", 0), row["seconds"], "s")
                        for row in report["stage_seconds"]]
                rows.append(("memory", report["forecast"]["memory_bytes"] / 2**20,
                             report["peak_memory_bytes"] / 2**20, "MiB"))
                for name, forecast, taken, unit in rows:
                    print(f"  {name:12} {forecast:10.3f} {taken:10.3f} {unit}")
                    if forecast > 0 and (taken > 0.02 or name == "memory"):
                        ratios.setdefault(name, []).append(taken / forecast)
    print("taken over forecast: smallest, largest, median")
    for name, values in ratios.items():
        print(f"  {name:12} {min(values):8.2f} {max(values):8.2f} {statistics.median(values):8.2f}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
