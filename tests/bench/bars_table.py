"""One bar: what was asked for, what was measured. Nothing is judged but in the last column of the table."""
import math
import os
import statistics
import time
from dataclasses import dataclass


def percentile(values, share):
    """The smallest of the values that `share` of them do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


@dataclass
class Bar:
    name: str
    limit: float
    unit: str
    rounds: list  # of lists of values
    at_least: bool = False  # otherwise the limit is one from above
    judged: str = "p99"  # or "median"
    note: str = ""

    def median(self):
        return statistics.median(value for values in self.rounds for value in values)

    def p99(self):
        """Of each round, the median of them: one bad second of a shared machine is one round's."""
        share = 0.01 if self.at_least else 0.99
        return statistics.median(percentile(values, share) for values in self.rounds)

    def met(self):
        value = self.p99() if self.judged == "p99" else self.median()
        return value >= self.limit if self.at_least else value < self.limit

    def cells(self):
        count = sum(len(values) for values in self.rounds)
        sign = ">=" if self.at_least else "<"
        p99 = f"{self.p99():.4g}" if self.judged == "p99" else "-"
        return [self.name, f"{sign} {self.limit:g} {self.unit}", f"{self.median():.4g}", p99, str(count),
                "yes" if self.met() else "NO", self.note]


def print_table(bars):
    rows = [["bar", "limit", "median", "p99", "of", "met", ""]] + [bar.cells() for bar in bars]
    widths = [max(len(row[i]) for row in rows) for i in range(6)]
    for row in rows:
        print(("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " | " + row[6]).rstrip())


def timed_ms(act):
    begun = time.perf_counter()
    act()
    return (time.perf_counter() - begun) * 1000


class Disk:
    """What the disk alone takes at this moment: a small file, written anew and made durable."""

    def __init__(self, folder):
        self.path = folder / "fsync-probe"
        self.times_ms = []

    def probe(self):
        def write_durably():
            file = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
            try:
                os.write(file, b"x" * 4096)
                os.fsync(file)
            finally:
                os.close(file)
        self.times_ms.append(timed_ms(write_durably))

    def note(self, bar_median):
        """Of the probes since the last note."""
        times, self.times_ms = self.times_ms, []
        median = statistics.median(times)
        return (f"bare fsync {median:.2f} ms, p99 {percentile(times, 0.99):.2f} ms; "
                f"{bar_median / median:.1f} times as long")
