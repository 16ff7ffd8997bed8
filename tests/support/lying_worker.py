#!/usr/bin/env python3
"""A worker that lies: its check is the real one, its run does what the job's name says. See BEHAVIOURS.

usage: as keylume; the real one is KEYLUME_HONEST_WORKER
"""
import hashlib
import json
import os
import shutil
import signal
import sys
import time
from pathlib import Path

MIB = 1 << 20


def progress(job, line):
    with (job / "progress.ndjson").open("ab") as file:
        file.write(line + b"\n")


def publish(job, entries, key_frames=b'{"mode":"full","frames":[],"intervals":[]}', report=b'{"outcome":"succeeded"}'):
    """entries: (path, bytes, claimed hash or None for the right one)"""
    artefacts = job / "artefacts"
    shutil.rmtree(artefacts, ignore_errors=True)  # an earlier attempt may have left pipes
    (job / "report.json").unlink(missing_ok=True)
    artefacts.mkdir()
    listed = []
    for path, data, claimed in entries:
        if not path.startswith("/") and ".." not in path and "\0" not in path:
            (artefacts / path).parent.mkdir(parents=True, exist_ok=True)
            (artefacts / path).write_bytes(data)
        listed.append({"path": path, "media_type": "application/octet-stream", "bytes": len(data),
                       "sha256": claimed or hashlib.sha256(data).hexdigest()})
    (artefacts / "key_frames.json").write_bytes(key_frames)
    (job / "report.json").write_bytes(report)
    (artefacts / "manifest.json").write_text(json.dumps({"artefacts": listed}))


def flood_stdout(job):
    line = b"x" * 1023 + b"\n"
    for _ in range(200 * 1024):
        os.write(1, line)


def long_lines(job):
    for _ in range(40):
        progress(job, b'{"message":"' + b"y" * MIB + b'"}')


def endless_progress(job):
    while True:
        progress(job, b'{"stage":"solve","fraction":0.1,"stage_fraction":0.1,"message":"z"}' * 1000)


def bad_json(job):
    for line in (b"[" * 60_000, b'{"stage":"solve","fraction":1e999}', b'{"stage":"dance","fraction":-5}', b"\xff\xfe", b"null",
                 b'{"stage":"solve","fraction":NaN}', b'{"stage":"solve","fraction":0.5,"stage_fraction":7,"message":"\\u0000"}'):
        progress(job, line)
    publish(job, [], key_frames=b"[" * 100_000, report=b"{" * 100_000)


def wrong_hash(job):
    publish(job, [("radiosity.npy", b"numbers", hashlib.sha256(b"others").hexdigest())])


def up_and_out(job):
    for path in ("../input/scene.obj", "/etc/passwd", "a/../../input/scene.obj", "..", "x\0y"):
        publish(job, [(path, b"", None)])
        time.sleep(0.01)


def links(job):
    publish(job, [("radiosity.npy", b"numbers", None)])
    secret = Path(os.environ["KEYLUME_SECRET"])
    (job / "artefacts/radiosity.npy").unlink()
    (job / "artefacts/radiosity.npy").symlink_to(secret)
    data = secret.read_bytes()
    manifest = [{"path": "radiosity.npy", "media_type": "text/plain", "bytes": len(data),
                 "sha256": hashlib.sha256(data).hexdigest()}]
    (job / "artefacts/manifest.json").write_text(json.dumps({"artefacts": manifest}))


def pipes(job):
    """Whoever opens these waits for ever, unless he looks first."""
    publish(job, [])
    for path in ("worker.log", "progress.ndjson", "report.json", "check.json", "artefacts/manifest.json",
                 "artefacts/key_frames.json"):
        (job / path).unlink(missing_ok=True)
        os.mkfifo(job / path)


def huge_files(job):
    publish(job, [])
    for path in ("report.json", "artefacts/manifest.json", "artefacts/key_frames.json"):
        with (job / path).open("wb") as file:
            file.truncate(10 << 30)


def ignore_term(job):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        progress(job, b'{"stage":"solve","fraction":0.3,"stage_fraction":0.3,"message":"never"}')
        time.sleep(0.02)


def hide(job):
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            (job / "hidden").write_text(str(os.getpid()))
            while True:
                time.sleep(60)
        os._exit(0)
    deadline = time.monotonic() + 2  # it may be found out before it has said where it is
    while not (job / "hidden").exists() and time.monotonic() < deadline:
        time.sleep(0.01)


def breed(job):
    """A tree of 63 processes, each in a session of its own."""
    for _ in range(6):
        if os.fork() == 0:
            os.setsid()
        time.sleep(0.02)
    while str(os.getpid()) not in (job / "attempts").read_text().split():
        time.sleep(60)


def hang(job):
    while True:
        time.sleep(60)


def eat_memory(job):
    held = []
    try:
        while len(held) < 1024:
            held.append(bytearray(b"\1") * (16 * MIB))
            (job / "eaten").write_text(str(16 * len(held)))
    except MemoryError:
        pass
    os._exit(3)


def eat_disk(job):
    with (job / "artefacts.bin").open("wb") as file:
        try:
            file.truncate(1 << 40)
            (job / "grown").write_text("yes")
        except OSError as error:
            (job / "grown").write_text(str(error.errno))


BEHAVIOURS = {act.__name__: act for act in (
    flood_stdout, long_lines, endless_progress, bad_json, wrong_hash, up_and_out, links, pipes, huge_files, ignore_term,
    hide, breed, hang, eat_memory, eat_disk)}
BEHAVIOURS["nothing"] = lambda job: None


def main():
    if sys.argv[1] != "render":
        os.execv(os.environ["KEYLUME_HONEST_WORKER"], ["keylume", *sys.argv[1:]])
    job = Path(sys.argv[2])
    with (job / "attempts").open("a") as file:
        file.write(f"{os.getpid()}\n")
    BEHAVIOURS[json.loads((job / "input/animation.json").read_text())["name"]](job)


if __name__ == "__main__":
    main()
