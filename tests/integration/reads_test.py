#!/usr/bin/env python3
"""Reading while somebody's write waits, as it does for a disk that stalls: nothing that only asks waits with it.

The write is held by a second process' lock, which keeps whoever writes out of the database, and nobody else. What counts
is the order of things: the writes that were under way when the questions began are still so when the last is answered."""
import contextlib
import hashlib
import http.client
import json
import sqlite3
import subprocess
import threading
import unittest

from curl import curl
from service import SERVER, Service, ServiceTestCase, free_port, wait_until
from small_jobs import write_job

# A write gives up 5 s after it began to wait. Where the machine is so slow that the questions take longer than that,
# they are asked again.
ROUNDS = 3
# The use of results is noted when they are asked for first: none is asked for before the write is held.
OF_JOB = ("", "/key-frames", "/frames", "/frames/0", "/frames/0/image.png", 
          "/frames/0/radiosity.npy", "/frames/1/radiosity.json", "/patches/0/series.json", "/patches.npz", "/report.json",
          "/manifest.json", "/log", "/views", "/results.tar", "/video.mp4")
OF_SERVICE = ("/v1/jobs", "/v1/jobs?state=succeeded&limit=5", "/v1/queue", "/v1/limits", "/healthz", "/readyz", "/metrics",
              "/version", "/", "/jobs/any", "/system")


class Writer(threading.Thread):
    """Renames the job, and notes what came of it."""

    def __init__(self, port, path, headers, name):
        super().__init__(daemon=True)
        self.port, self.path, self.headers, self.name_wanted = port, path, headers, name
        self.status = None

    def run(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        with contextlib.closing(connection):
            headers = {**self.headers, "Content-Type": "application/merge-patch+json"}
            connection.request("PATCH", self.path, json.dumps({"name": self.name_wanted}), headers)
            self.status = connection.getresponse().status


class Reads(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.ops_port = free_port()
        service = Service(self.folder / "data")
        self.addCleanup(service.clean_up)
        words = [*service.command(), "--ops-listen", f"127.0.0.1:{self.ops_port}"]
        service.command = lambda: words
        run = subprocess.run([SERVER, "token", "create", "root", "--scopes", "jobs:read,jobs:write,queue:admin,metrics:read",
                              "--data", str(service.data)], capture_output=True, text=True, timeout=20, check=True)
        self.headers = {"Authorization": "Bearer " + run.stdout.strip()}
        self.running = service.start()
        self.blob = hashlib.sha256(b"v 0 0 0").hexdigest()
        self.curl(f"/v1/blobs/sha256/{self.blob}", "-X", "PUT", "--data-binary", "v 0 0 0")
        self.job_id = self.finished_job()

    def curl(self, path, *words):
        return curl(self.running.url + path, "-H", f"Authorization: {self.headers['Authorization']}", *words)

    def finished_job(self):
        job = write_job(self.folder / "job", frames=2)
        words = ["-F", f"scene=@{job / 'scene.obj'}", "-F", f"animation=@{job / 'animation.json'}"]
        words += [word for path in job.glob("*.mtl") for word in ("-F", f"materials=@{path}")]
        job_id = self.curl("/v1/jobs", *words).json()["id"]
        wait_until(lambda: self.curl(f"/v1/jobs/{job_id}").json()["state"] == "succeeded", 120, "the job is done")
        return job_id

    @contextlib.contextmanager
    def held(self):
        """Nobody can write to the database until the end of this."""
        database = sqlite3.connect(self.running.data / "keylume.db", isolation_level=None)
        with contextlib.closing(database):
            database.execute("BEGIN IMMEDIATE")
            try:
                yield
            finally:
                database.execute("ROLLBACK")

    def ask(self, path, method="GET", port=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", port or self.running.port, timeout=60)
        with contextlib.closing(connection):
            connection.request(method, path, headers={**self.headers, **(headers or {})})
            answer = connection.getresponse()
            return answer.status, answer.read()

    def first_event(self, path):
        """What a stream of events begins with, as far as to the first whole event."""
        connection = http.client.HTTPConnection("127.0.0.1", self.running.port, timeout=60)
        with contextlib.closing(connection):
            connection.request("GET", path, headers={**self.headers, "Last-Event-ID": "0"})
            answer = connection.getresponse()
            self.assertEqual(answer.status, 200)
            lines = []
            while "data:" not in "".join(lines):
                lines.append(answer.readline().decode())
                self.assertNotEqual(lines[-1], "", "the stream ended")
            return "".join(lines)

    def questions(self):
        """[(what is asked, a function that asks it)]"""
        of_job = f"/v1/jobs/{self.job_id}"

        def get(path, allowed=(200,), **more):
            status, body = self.ask(path, **more)
            self.assertIn(status, allowed, (path, body[:300]))
        # A video that is not there is begun, which is no reason to wait either; while nothing can be written the service
        # may well say that it is not ready.
        allowed = {"/video.mp4": (200, 202, 501), "/readyz": (200, 503)}
        for path in OF_JOB:
            yield of_job + path, lambda: get(of_job + path, allowed.get(path, (200,)))
        for path in OF_SERVICE:
            yield path, lambda: get(path, allowed.get(path, (200,)))
        for path in ("/healthz", "/metrics", "/readyz"):
            yield "ops " + path, lambda: get(path, allowed.get(path, (200,)), port=self.ops_port)
        yield "a blob", lambda: get(f"/v1/blobs/sha256/{self.blob}", method="HEAD")
        for path in (of_job + "/events", "/v1/events"):
            yield path, lambda: self.assertIn('"state":"queued"', self.first_event(path))

    def late_question(self):
        """-> the first question that was answered only after a write that was under way when it was asked; None: none"""
        late = None
        with self.held():
            writers = [Writer(self.running.port, f"/v1/jobs/{self.job_id}", self.headers, f"write {i}") for i in range(3)]
            for writer in writers:
                writer.start()
            # Nothing tells a client that its write waits, so they are given some time to come so far. Were it too
            # short, a service that makes us wait would be found out by a later question.
            writers[0].join(0.3)
            for name, ask in self.questions():
                ask()
                if not all(writer.is_alive() for writer in writers):
                    late = name
                    break
        for writer in writers:
            writer.join(60)
        # Of those that have waited, one at least had its turn after the lock.
        done = [writer.name_wanted for writer in writers if writer.status == 200]
        if not late:
            self.assertIn(json.loads(self.ask(f"/v1/jobs/{self.job_id}")[1])["name"], done)
        return late

    def test_nothing_that_only_asks_waits_for_a_write(self):
        late = [self.late_question()]
        while late[-1] and len(late) < ROUNDS:
            late.append(self.late_question())
        self.assertIsNone(late[-1], f"answered only when a write had ended: {late}")
        self.assertEqual(self.ask("/readyz")[0], 200)

    def test_what_was_written_is_read(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.running.port, timeout=60)
        with contextlib.closing(connection):
            for i in range(200):
                connection.request("PATCH", f"/v1/jobs/{self.job_id}", json.dumps({"name": f"name {i}"}),
                                   {**self.headers, "Content-Type": "application/merge-patch+json"})
                etag = connection.getresponse()
                self.assertEqual((etag.status, etag.read() != b""), (200, True))
                connection.request("GET", f"/v1/jobs/{self.job_id}", headers=self.headers)
                answer = connection.getresponse()
                job = json.loads(answer.read())
                self.assertEqual((job["name"], answer.headers["ETag"]), (f"name {i}", etag.headers["ETag"]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
