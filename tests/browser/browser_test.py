#!/usr/bin/env python3
"""Runs one file of tests in a browser by node's own test runner.  usage: browser_test.py TOPIC_test.mjs PACKAGES_FOLDER
With a file of another name, a program: browser_test.py PROGRAM.mjs PACKAGES_FOLDER [ARGUMENT...]

PACKAGES_FOLDER, in the build folder, is where npm puts what they need.
Environment: KEYLUME_SERVER, KEYLUME_WORKER, KEYLUME_DASHBOARD (the built one).
exit 0: passed; 1: failed; 77: node, npm or Chromium is missing, said so."""
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SKIPPED = 77
NODE_MAJOR_MIN = 18


def program(*names):
    return next((found for found in map(shutil.which, names) if found), None)


def what_is_missing(node, npm, chromium):
    if not node or not npm:
        return "node and npm (Debian, Ubuntu: the packages nodejs and npm)"
    version = subprocess.run([node, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    if int(version.lstrip("v").split(".")[0]) < NODE_MAJOR_MIN:
        return f"node {NODE_MAJOR_MIN} or newer, this is {version}"
    return None if chromium else "Chromium (Debian: the package chromium)"


def install(packages, npm):
    """What package-lock.json names, unless it is there already. Fails where npm does."""
    lock = (HERE / "package-lock.json").read_bytes()
    stamp, wanted = packages / "installed.sha256", hashlib.sha256(lock).hexdigest()
    if stamp.is_file() and stamp.read_text() == wanted:
        return
    packages.mkdir(parents=True, exist_ok=True)
    stamp.unlink(missing_ok=True)
    for name in ("package.json", "package-lock.json", ".npmrc"):
        shutil.copy(HERE / name, packages)
    subprocess.run([npm, "ci", "--prefer-offline", "--ignore-scripts", "--fetch-retries=1", "--fetch-timeout=30000",
                    "--loglevel=error"], cwd=packages, check=True, timeout=120)
    stamp.write_text(wanted)


def main(tests, packages, *arguments):
    node, npm, chromium = program("node", "nodejs"), program("npm"), program("chromium", "chromium-browser")
    missing = what_is_missing(node, npm, chromium)
    if missing:
        print(f"skipped: these tests need {missing}")
        return SKIPPED
    dashboard = Path(os.environ["KEYLUME_DASHBOARD"])
    if not (dashboard / "index.html").is_file():
        print("the dashboard was not built: npm could not fetch its packages (is there a network?)")
        return 1
    install(Path(packages), npm)
    environment = {**os.environ, "KEYLUME_BROWSER_PACKAGES": packages, "KEYLUME_CHROMIUM": chromium}
    command = [node, "--test", tests] if tests.endswith("_test.mjs") else [node, tests, *arguments]
    with subprocess.Popen(command, cwd=HERE, env=environment, stdout=subprocess.PIPE, text=True) as run:
        for line in run.stdout:  # what a test says is a comment of node's report
            print(line.removeprefix("# ") if line.startswith("# ratio: ") else line, end="", flush=True)
    return run.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
