#!/usr/bin/env python3
"""A worker that shuts itself in renders what a free one does, and says what the kernel holds it to."""
import json
import os
import struct
import subprocess
import unittest
import zlib

from service import ServiceTestCase
from small_jobs import changed, write_job

WORKER = os.environ["KEYLUME_WORKER"]


def png(width, height):
    """A checkerboard."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(200 if (x + y) % 2 else 60 for x in range(3 * width)) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Sandbox(ServiceTestCase):
    def textured_job(self, folder):
        """With a textured floor, and EXR files: both make the worker load libraries while it runs."""
        job = write_job(folder / "input", frames=2)
        changed(job, lambda whole: whole["images"][0].update(formats=["png", "exr"]))
        materials = next(job.glob("*.mtl"))
        materials.write_text(materials.read_text() + "\nnewmtl checkered\nKd 0.5 0.5 0.5\nmap_Kd checker.png\n")
        scene = job / "scene.obj"
        count = sum(line.startswith("v ") for line in scene.read_text().splitlines())
        corners = "".join(f"v {x} 0.01 {z}\n" for x, z in ((0, 0), (0, 1), (1, 1), (1, 0)))
        scene.write_text(scene.read_text() + f"\no checkered_tile\n{corners}vt 0 0\nvt 0 1\nvt 1 1\nvt 1 0\n"
                         "usemtl checkered\nf " + " ".join(f"{count + i}/-{5 - i}" for i in range(1, 5)) + "\n")
        (job / "checker.png").write_bytes(png(8, 8))
        return folder

    def run_worker(self, command, folder, *options):
        run = subprocess.run([WORKER, command, folder, *options], capture_output=True, text=True, timeout=200,
                             stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 0, run.stderr)
        name = "report.json" if command == "render" else "check.json"
        return json.loads((folder / name).read_text())

    def hashes(self, folder):
        manifest = json.loads((folder / "artefacts/manifest.json").read_text())
        return {file["path"]: file["sha256"] for file in manifest["artefacts"]}

    def test_it_renders_the_same_bytes_as_a_free_worker(self):
        free, shut_in = (self.textured_job(self.folder / name) for name in ("free", "shut_in"))
        self.assertIsNone(self.run_worker("render", free)["sandbox"])
        report = self.run_worker("render", shut_in, "--sandbox")
        self.assertTrue(report["sandbox"].endswith("limits"), report["sandbox"])
        self.assertEqual(self.hashes(shut_in), self.hashes(free))
        self.assertTrue(any(path.endswith(".exr") for path in self.hashes(shut_in)))

    def test_a_check_in_the_sandbox_reads_textures_too(self):
        folder = self.textured_job(self.folder / "job")
        self.assertTrue(self.run_worker("check", folder, "--sandbox")["sandbox"])

    def test_the_service_shuts_its_workers_in(self):
        running = self.service()
        job = self.submitted(running, write_job(self.folder / "job", frames=2))
        running.wait_for(job, ("succeeded",), 120)
        report = running.get(f"/v1/jobs/{job}/report.json").json()
        self.assertTrue(report["sandbox"].endswith("limits"), report["sandbox"])
        self.assertEqual(running.get("/version").json()["worker_sandbox"], report["sandbox"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
