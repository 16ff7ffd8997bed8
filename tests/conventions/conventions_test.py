#!/usr/bin/env python3
"""Runs one check of checks.py on the checkout.  usage: conventions_test.py CHECK BUILD_FOLDER
exit 0: kept; 1: broken, each place on a line; 77: cannot be told here, with the reason."""
import sys
from pathlib import Path

import checks

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SKIPPED = 77


def layout_or_reason():
    version = checks.clang_format_version()
    if version != checks.CLANG_FORMAT_MAJOR:
        found = "there is none" if version is None else f"this is {version}"
        print(f"skipped: the layout is that of clang-format {checks.CLANG_FORMAT_MAJOR}, {found}")
        sys.exit(SKIPPED)
    return checks.layout(ROOT)


CHECKS = {
    "includes": lambda build: checks.includes(ROOT, HERE / "includes.txt"),
    "sources_are_built": lambda build: checks.sources_are_built(ROOT, build),
    "own_names": lambda build: checks.own_names(ROOT, build),
    "tests_are_registered": lambda build: checks.tests_are_registered(ROOT, checks.registered_tests(build)),
    "file_lengths": lambda build: checks.file_lengths(ROOT, HERE / "long_files.txt"),
    "layout": lambda build: layout_or_reason(),
    "dashboard_layout": lambda build: checks.dashboard_layout(ROOT),
    "dashboard_imports": lambda build: checks.dashboard_imports(ROOT),
    "words": lambda build: checks.words(ROOT, HERE / "words.txt", HERE / "allowed_addresses.txt",
                                        checks.commit_messages(ROOT)),
    "documents": lambda build: checks.documents(ROOT),
}

if __name__ == "__main__":
    problems = CHECKS[sys.argv[1]](sys.argv[2])
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
