"""A file system of a few megabytes, to be filled on purpose."""
import os
import signal
import subprocess
from pathlib import Path

from service import Service, ServiceTestCase, wait_until


def mounted(folder, *options):
    """A small file system of its own at `folder`; False where that is not allowed."""
    folder.mkdir(parents=True, exist_ok=True)
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join(options), "none", str(folder)],
                          capture_output=True, check=False)
    return made.returncode == 0


class armed:
    """Whoever is started within has its fault; workers inherit it from their server."""

    def __init__(self, fault):
        self.fault = fault

    def __enter__(self):
        os.environ["KEYLUME_FAULT"] = self.fault

    def __exit__(self, *_):
        del os.environ["KEYLUME_FAULT"]


def is_halted(pid):
    """By SIGSTOP, as KEYLUME_FAULT=NAME:1:stop does."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "T"
    except OSError:
        return False


def go_on(pid):
    os.kill(pid, signal.SIGCONT)


class SmallDiskTestCase(ServiceTestCase):
    SIZE = "200m"

    def setUp(self):
        super().setUp()
        self.mount = self.folder / "small"
        if not mounted(self.mount, f"size={self.SIZE}"):
            self.skipTest("no mounts here")
        self.addCleanup(subprocess.run, ["umount", "-l", str(self.mount)], check=False)

    def service(self, name="data"):
        """Its log has room: what it says is looked at."""
        service = Service(self.folder / name)
        service.log = self.folder / f"{name.replace('/', '_')}.log"
        self.addCleanup(service.clean_up)
        return service.start()

    def fill(self, but=0):
        """Takes all room that is left, but for so many bytes. -> the file to remove"""
        filler = self.mount / "filler"
        with filler.open("wb", buffering=0) as file:
            for piece in (1 << 20, 1 << 12):
                try:
                    while True:
                        file.write(b"\0" * piece)
                except OSError:
                    pass
            if but:
                file.truncate(file.tell() - but)
        return filler

    def workers_of(self, service, word):
        """Processes of this service's worker program with that command, halted or not."""
        found = []
        for entry in Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
            except (OSError, ValueError):
                continue
            if entry.name.isdigit() and word in words and any(each.startswith(str(service.data)) for each in words):
                found.append(int(entry.name))
        return found

    def halted_worker(self, service, word="render"):
        return wait_until(lambda: next((pid for pid in self.workers_of(service, word) if is_halted(pid)), None), 60,
                          f"a worker is halted at {os.environ.get('KEYLUME_FAULT', 'its place')}")
