#!/usr/bin/env python3
"""A job in one zip or tar: taken as its files would be; what is hostile is refused, named, and leaves nothing."""
import io
import tarfile
import unittest
from pathlib import Path

import archives
from curl import curl
from service import ServiceTestCase
from small_jobs import write_job


def peak_mib(pid):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    raise AssertionError("no such process")


def files_of(job):
    return {f"room/{path.name}": path.read_bytes() for path in sorted(job.iterdir())}


def tar_of(files):
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w") as tar:
        for name, data in files.items():
            info = tarfile.TarInfo(name)
            info.size = len(data)
            tar.addfile(info, io.BytesIO(data))
    return out.getvalue()


class Archive(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()

    def send(self, data, *more, path="/v1/validate"):
        """-> the answer to the archive `data` as the part `archive`"""
        file = self.folder / "sent.archive"
        file.write_bytes(data)
        return curl(self.running.url + path, "-F", f"archive=@{file}", *more)

    def expect_nothing_kept(self):
        for folder in ("jobs", "tmp"):
            self.assertEqual(list((self.running.data / folder).iterdir()), [], folder)

    def test_a_zip_and_a_tar_are_the_same_job_as_their_files(self):
        job = write_job(self.folder / "job", frames=2)
        apart = self.running.submit(job, "/v1/validate").json()["forecast"]
        for data in (archives.honest_zip(files_of(job)), tar_of(files_of(job))):
            answer = self.send(data)
            self.assertEqual(answer.status, 200, answer.body)
            forecast = answer.json()["forecast"]
            for name in ("patches", "frames", "polygons"):
                self.assertEqual(forecast[name], apart[name])
        self.expect_nothing_kept()

    def test_a_job_from_an_archive_is_rendered_and_the_archive_is_not_kept(self):
        job = write_job(self.folder / "job", frames=2)
        answer = self.send(archives.honest_zip(files_of(job)), path="/v1/jobs")
        self.assertEqual(answer.status, 202, answer.body)
        done = self.running.wait_for(answer.json()["id"], ("succeeded",), 120)
        kept = self.running.job_folder(done["id"])
        self.assertEqual(sorted(path.name for path in (kept / "input").iterdir()),
                         sorted(path.name for path in job.iterdir()))
        self.assertFalse((kept / "archive").exists())

    def test_hostile_archives_are_refused_and_the_entry_is_named(self):
        before = peak_mib(self.running.process.pid)
        for name, data in [*archives.zips(), *archives.tars()]:
            code = name.split("--")[0]
            answer = self.send(data)
            with self.subTest(name):
                problem = answer.json()
                self.assertEqual(answer.headers["content-type"], "application/problem+json")
                self.assertEqual(answer.status, 413 if code.startswith("too_") else 422, problem)
                if code != "ok":  # those hold no whole job, and are refused for that
                    self.assertEqual(problem["errors"][0]["code"], code)
                    self.assertTrue(problem["errors"][0]["file"], problem)
        self.expect_nothing_kept()
        # Twice what one upload may hold in memory: pieces, a parsed document, heaps of a thread or two.
        self.assertLess(peak_mib(self.running.process.pid) - before, 32)

    def test_what_is_no_part_of_a_job_is_named(self):
        job = write_job(self.folder / "job", frames=2)
        problem = self.send(archives.honest_zip({**files_of(job), "inner.zip": b"PK"})).json()
        self.assertEqual((problem["errors"][0]["file"], problem["errors"][0]["code"]), ("inner.zip", "unknown_entry"))
        twice = self.send(archives.honest_zip(files_of(job)), "-F", f"scene=@{job / 'scene.obj'}")
        self.assertEqual((twice.status, twice.json()["errors"][0]["code"]), (422, "duplicate_part"))

    def test_options_may_lie_in_the_archive(self):
        job = write_job(self.folder / "job", frames=2)
        answer = self.send(archives.honest_zip({**files_of(job), "options.json": b'{"priority":7}'}), path="/v1/jobs")
        self.assertEqual(answer.status, 202, answer.body)
        self.assertEqual(answer.json()["priority"], 7)


if __name__ == "__main__":
    unittest.main(verbosity=2)
