#!/usr/bin/env python3
"""What the service promises in numbers, measured: prints one table. Judges nothing by its exit code, since a machine
that others use too is no place to judge times; beside what waits for the disk stands what the disk alone took.

usage: service_bars.py KEYLUME KEYLUME_SERVER CLAIM_TIMES [--only NAME]... [--jobs 10000] [--folder FOLDER]

Talks to 127.0.0.1 only, to servers that it starts and stops, in a folder of its own (up to 10 GB, removed).
"""
import argparse
import os
import shutil
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from bars_bytes import range_bars, upload_bars
from bars_clients import cancel_bar, health_bars, small_get_bars
from bars_queue import queue_bars
from bars_table import print_table

GROUPS = {"queue": queue_bars, "cancel": lambda *words: [cancel_bar(*words)], "health": health_bars,
          "uploads": upload_bars, "gets": small_get_bars, "ranges": range_bars}


@dataclass
class Programs:
    worker: Path
    server: Path
    claim_times: Path


def parsed():
    parser = argparse.ArgumentParser()
    for name in ("worker", "server", "claim_times"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--only", action="append", choices=sorted(GROUPS))
    parser.add_argument("--folder", type=Path, help="where to make the temporary folder: on the disk to be measured")
    for name, value in (("jobs", 10_000), ("fill-seconds", 90), ("submissions", 100), ("requests", 300), ("claims", 500), ("restarts", 5),
                        ("cancels", 10), ("wrk-seconds", 5)):
        parser.add_argument(f"--{name}", type=int, default=value)
    return parser.parse_args()


def slowness():
    """How much longer than on an idle machine work takes now: time that passes over time of the processor."""
    passed, worked = time.perf_counter(), time.process_time()
    while time.process_time() - worked < 0.2:
        pass
    return (time.perf_counter() - passed) / (time.process_time() - worked)


def say_load(when):
    print(f"load {when}: " + " ".join(f"{load:.1f}" for load in os.getloadavg()) +
          f" on {len(os.sched_getaffinity(0))} cores; work takes {slowness():.1f} times as long as alone", flush=True)


def main():
    given = parsed()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # servers and folders are not left behind
    programs = Programs(given.worker.resolve(), given.server.resolve(), given.claim_times.resolve())
    say_load("before")
    bars = []
    for name in given.only or GROUPS:
        if name == "gets" and not shutil.which("wrk"):
            print("no small GETs: wrk is not installed", flush=True)
            continue
        with tempfile.TemporaryDirectory(prefix="keylume-bars-", dir=given.folder) as folder:
            bars += GROUPS[name](programs, Path(folder), given)
        say_load(f"after {name}")
    print_table(bars)


if __name__ == "__main__":
    main()
