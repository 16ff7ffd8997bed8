#!/usr/bin/env python3
"""Files sent once and named by their hashes: jobs from them are those of the files, and lies about hashes buy nothing."""
import contextlib
import hashlib
import json
import sqlite3
import subprocess
import unittest

import archives
from curl import curl
from service import SERVER, ServiceTestCase
from small_jobs import write_job


class Blob(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()

    def put(self, data, sha256=None):
        """-> (answer, hash)"""
        sha256 = sha256 or hashlib.sha256(data).hexdigest()
        file = self.folder / "blob"
        file.write_bytes(data)
        return curl(f"{self.running.url}/v1/blobs/sha256/{sha256}", "-T", str(file)), sha256

    def post(self, document, path="/v1/jobs", *more):
        return curl(self.running.url + path, "-H", "Content-Type: application/json", "--data-binary",
                    document if isinstance(document, str) else json.dumps(document), *more)

    def named(self, job):
        """Sends the job's files as blobs -> what names them"""
        fields = {".obj": "scene", ".mtl": "materials", ".json": "animation"}
        files = []
        for path in sorted(job.iterdir()):
            answer, sha256 = self.put(path.read_bytes())
            self.assertIn(answer.status, (200, 201), answer.body)
            files.append({"field": fields[path.suffix], "name": path.name, "sha256": sha256})
        return files

    def expect_nothing_in_tmp(self):
        self.assertEqual(list((self.running.data / "tmp").iterdir()), [])

    def test_a_blob_is_sent_once(self):
        path = f"/v1/blobs/sha256/{hashlib.sha256(b'v 0 0 0').hexdigest()}"
        self.assertEqual(self.running.get(path, "-I").status, 404)
        first, sha256 = self.put(b"v 0 0 0")
        self.assertEqual((first.status, first.json()["sha256"]), (201, sha256))
        self.assertEqual(self.put(b"v 0 0 0")[0].status, 200)
        self.assertEqual(self.running.get(path, "-I").status, 200)
        self.assertNotIn(b"v 0 0 0", self.running.get(path).body, "knowing a hash is not owning a file")
        self.expect_nothing_in_tmp()

    def test_a_job_of_blobs_is_the_job_of_its_files(self):
        job = write_job(self.folder / "job", frames=2)
        files = self.named(job)
        answer = self.post({"files": files, "options": {"priority": 7}})
        self.assertEqual(answer.status, 202, answer.body)
        self.assertEqual(answer.json()["priority"], 7)
        done = self.running.wait_for(answer.json()["id"], ("succeeded",), 120)
        kept = self.running.job_folder(done["id"]) / "input"
        self.assertEqual({path.name: path.read_bytes() for path in kept.iterdir()},
                         {path.name: path.read_bytes() for path in job.iterdir()})
        forecast = self.post({"files": files}, "/v1/validate").json()["forecast"]
        self.assertEqual(forecast["frames"], 2)
        zipped, sha256 = self.put(archives.honest_zip({path.name: path.read_bytes() for path in job.iterdir()}))
        self.assertEqual(zipped.status, 201)
        self.assertEqual(self.post({"files": [{"field": "archive", "sha256": sha256}]}, "/v1/validate").status, 200)

    def test_wrong_hashes_and_names_that_are_none_are_refused(self):
        wrong, _ = self.put(b"v 0 0 0", "0" * 64)
        self.assertEqual((wrong.status, wrong.json()["errors"][0]["code"]), (422, "wrong_hash"))
        self.assertEqual(self.running.get("/v1/blobs/sha256/" + "0" * 64).status, 404)
        for name in ("0" * 63, "A" * 64, "..%2f" + "0" * 60, "0" * 64 + "x", "%00" * 64):
            answer = self.running.get("/v1/blobs/sha256/" + name)
            self.assertIn(answer.status, (400, 404), name)
            sent, _ = self.put(b"v", name)
            self.assertIn(sent.status, (400, 404), name)
        self.expect_nothing_in_tmp()

    def test_every_place_of_a_wrong_list_is_named(self):
        unknown = self.post({"files": [{"field": "scene", "sha256": "0" * 64}]})
        self.assertEqual((unknown.status, unknown.json()["errors"][0]["code"]), (422, "unknown_blob"))
        self.assertEqual(unknown.json()["errors"][0]["pointer"], "/files/0/sha256")
        several = self.post({"files": [{"field": "scenes", "sha256": "x"}], "more": 1}).json()
        self.assertEqual({error["pointer"] for error in several["errors"]}, {"/more", "/files/0/field", "/files/0/sha256"})
        for body in ("[" * 100_000, "{}", "null", '{"files":[]}', "{", '{"files":[{}]}'):
            self.assertEqual(self.post(body if len(body) < 1000 else body[:50_000]).status, 422, body[:20])
        _, sha256 = self.put(b"v 0 0 0")
        for name in ("../x.mtl", "", ".hidden", "scene.obj"):
            answer = self.post({"files": [{"field": "materials", "name": name, "sha256": sha256}]})
            self.assertEqual(answer.status, 422, name)
        self.expect_nothing_in_tmp()

    def test_what_is_unused_for_a_day_goes(self):
        _, old = self.put(b"old")
        _, young = self.put(b"young")
        path = self.running.data / "blobs" / old[:2] / old
        self.assertEqual(self.running.stop(), 0)
        with contextlib.closing(sqlite3.connect(self.running.data / "keylume.db")) as database:
            database.execute("UPDATE blob SET used_ms = 1 WHERE sha256 = ?", [old])
            database.commit()
        self.running.start()
        self.put(b"another")
        self.assertFalse(path.exists())
        self.assertEqual(self.running.get(f"/v1/blobs/sha256/{old}").status, 404)
        self.assertEqual(self.running.get(f"/v1/blobs/sha256/{young}").status, 200)

    def test_limits_are_told_and_kept(self):
        self.assertEqual(self.running.stop(), 0)
        words = self.running.command() + ["--max-blob-bytes", "10", "--blob-hours", "2"]
        self.running.command = lambda: words
        self.running.start()
        limits = self.running.get("/v1/limits").json()
        self.assertEqual((limits["all_blobs_bytes_max"], limits["blob_unused_seconds_max"]), (10, 7200))
        self.assertEqual(self.put(b"12345678")[0].status, 201)
        full = self.put(b"123")[0]
        self.assertEqual((full.status, full.json()["type"]), (507, "urn:keylume:problem:over-quota"))
        self.expect_nothing_in_tmp()

    def test_check_finds_a_blob_that_is_not_what_its_name_says(self):
        _, sha256 = self.put(b"v 0 0 0")
        check = [SERVER, "check", "--data", str(self.running.data)]
        self.assertEqual(subprocess.run(check, capture_output=True, timeout=60).returncode, 0)
        (self.running.data / "blobs" / sha256[:2] / sha256).write_bytes(b"v 0 0 1")
        found = subprocess.run(check, capture_output=True, text=True, timeout=60)
        self.assertEqual(found.returncode, 1)
        self.assertIn(sha256, found.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
