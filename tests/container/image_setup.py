#!/usr/bin/env python3
"""Sets up what all tests of this folder share: an Engine, and the image, built from a context that holds the files of the
checkout and nothing else. usage: image_setup.py up|down FOLDER        (FOLDER: build/container)
exit 0: done; 77: there can be no Engine here, with the reason; 1: failed"""
import json
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
ENGINE = ROOT / "tests/support/docker/engine"
TAG = "test"
IMAGES = {"runtime": f"keylume:{TAG}", "proxy": f"keylume-proxy:{TAG}", "prometheus": f"keylume-prometheus:{TAG}"}
SIZE_MB_MAX = {"runtime": 400}
BUILD_SECONDS_MAX = 1500
NO_ENGINE = 77


def files_of_the_checkout():
    """As they are now: what git has, and what it would be told of. Without git all but what is built."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]
    left_out = {"build", "data", "node_modules", ".git"}
    return [str(path.relative_to(ROOT)) for path in ROOT.rglob("*")
            if path.is_file() and not left_out.intersection(path.relative_to(ROOT).parts)]


def make_context(folder):
    shutil.rmtree(folder, ignore_errors=True)
    for name in files_of_the_checkout():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name, follow_symlinks=False)


def start_engine(folder):
    """-> its environment; ends this program where there can be none"""
    run = subprocess.run([ENGINE, "up", folder / "engine"], stdout=subprocess.PIPE, text=True, timeout=600)
    if run.returncode != 0:
        sys.exit(run.returncode)
    return dict(re.findall(r"(DOCKER_\w+)='?([^'\s]+)", run.stdout))


def build(folder, target, tag, secrets):
    """-> seconds; ends this program with the end of the log where it fails"""
    begun = time.monotonic()
    command = ["docker", "build", "--progress=plain", *secrets, "-f", "docker/Dockerfile", "--target", target, "-t", tag, "."]
    log = folder / f"build_{target}.log"
    with log.open("w") as output:
        run = subprocess.run(command, cwd=folder / "context", stdout=output, stderr=output, timeout=BUILD_SECONDS_MAX)
    if run.returncode != 0:
        print("\n".join(log.read_text(errors="replace").splitlines()[-40:]))
        sys.exit(f"docker build --target {target} failed")
    return time.monotonic() - begun


def build_all(folder):
    """Side by side: most of it waits for packages, and they share their first stage.  -> {target: seconds}"""
    secrets = subprocess.run([ENGINE, "secrets", folder / "engine"], stdout=subprocess.PIPE, text=True, check=True)
    with ThreadPoolExecutor() as pool:
        builds = {target: pool.submit(build, folder, target, tag, secrets.stdout.splitlines()) for target, tag in IMAGES.items()}
    return {target: done.result() for target, done in builds.items()}


def take_dashboard(folder):
    """The files of the image's dashboard, for the tests that look at them from outside."""
    shutil.rmtree(folder / "dashboard", ignore_errors=True)
    made = subprocess.run(["docker", "create", "--label=keylume.test", IMAGES["runtime"]], capture_output=True, text=True, check=True)
    subprocess.run(["docker", "cp", f"{made.stdout.strip()}:/usr/bin/dashboard", folder / "dashboard"],
                   stdout=subprocess.DEVNULL, check=True)
    subprocess.run(["docker", "rm", made.stdout.strip()], stdout=subprocess.DEVNULL, check=True)


def size_mb(tag):
    run = subprocess.run(["docker", "image", "inspect", "--format={{.Size}}", tag], capture_output=True, text=True, check=True)
    return int(run.stdout) / 1e6


def up(folder):
    folder.mkdir(parents=True, exist_ok=True)
    environment = start_engine(folder)
    os.environ.update(environment)
    make_context(folder / "context")
    times = build_all(folder)
    take_dashboard(folder)
    environment.update(KEYLUME_CONTAINER=IMAGES["runtime"], KEYLUME_TAG=TAG)
    (folder / "environment.json").write_text(json.dumps(environment))
    for target, tag in IMAGES.items():
        size = size_mb(tag)
        print(f"ratio: image {target}: {size:.0f} MB, built in {times[target]:.0f} s", flush=True)
        if size > SIZE_MB_MAX.get(target, size):
            sys.exit(f"image {target}: {size:.0f} MB, more than {SIZE_MB_MAX[target]}")


def down(folder):
    """In an Engine that goes on afterwards, nothing of the tests but the image stays."""
    known = folder / "environment.json"
    if known.is_file():
        os.environ.update(json.loads(known.read_text()))
        for kind, remove in (("container", ["rm", "-f", "-v"]), ("volume", ["volume", "rm", "-f"])):
            listed = subprocess.run(["docker", kind, "ls", "-q", *(["-a"] if kind == "container" else []), "--filter=label=keylume.test"],
                                    capture_output=True, text=True, timeout=60).stdout.split()
            if listed:
                subprocess.run(["docker", *remove, *listed], capture_output=True, timeout=120)
        known.unlink()
    shutil.rmtree(folder / "context", ignore_errors=True)
    return subprocess.run([ENGINE, "down", folder / "engine"], timeout=300).returncode


def main(what, folder):
    folder = Path(folder).resolve()
    if what == "down":
        return down(folder)
    (folder / "environment.json").unlink(missing_ok=True)
    up(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
