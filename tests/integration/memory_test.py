#!/usr/bin/env python3
"""The server is small, at rest and while it takes a large upload."""
import re
import unittest
from pathlib import Path

from service import ServiceTestCase
from small_jobs import write_job

MIB = 1 << 20
UPLOAD_BYTES = 300 * MIB


def resident_bytes(pid, field):
    """VmRSS: now; VmHWM: the highest since it was reset."""
    text = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(rf"^{field}:\s+(\d+) kB", text, re.MULTILINE)[1]) * 1024


class Memory(ServiceTestCase):
    def test_at_rest_and_during_a_large_upload(self):
        service = self.service()
        pid = service.process.pid
        for _ in range(20):
            service.get("/v1/jobs")
        at_rest = resident_bytes(pid, "VmRSS")
        self.assertLess(at_rest, 64 * MIB)

        job = self.large_job()
        Path(f"/proc/{pid}/clear_refs").write_text("5")  # the highest mark starts anew
        job_id = self.submitted(service, job)
        highest = resident_bytes(pid, "VmHWM")
        print(f"at rest {at_rest / MIB:.1f} MiB, highest during the upload {highest / MIB:.1f} MiB")
        self.assertLess(highest - at_rest, 32 * MIB)
        self.assertEqual((service.job_folder(job_id) / "input/scene.obj").stat().st_size,
                         (job / "scene.obj").stat().st_size, "all of it arrived")

    def large_job(self):
        """The garage with comments before it: nothing to render more than without, but bytes to take."""
        job = write_job(self.folder / "job", frames=2)
        geometry = (job / "scene.obj").read_bytes()
        comment = b"# " + b"x" * 1021 + b"\n"
        with (job / "scene.obj").open("wb") as scene:
            for _ in range(UPLOAD_BYTES // len(comment) // 1024):
                scene.write(comment * 1024)
            scene.write(geometry)
        return job


if __name__ == "__main__":
    unittest.main(verbosity=2)
