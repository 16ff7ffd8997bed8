#!/usr/bin/env python3
"""Server-sent events of a real job, across kill -9 and restart, and polling by ETag."""
import json
import socket
import threading
import time
import unittest

from service import ServiceTestCase, wait_until
from small_jobs import write_job

LISTENERS_MAX = 32


class Stream:
    """A GET of events over a socket, read by a thread of its own until it ends."""

    def __init__(self, service, path, last=None):
        self.socket = socket.create_connection(("127.0.0.1", service.port), timeout=30)
        header = f"Last-Event-ID: {last}\r\n" if last is not None else ""
        self.socket.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n{header}\r\n".encode())
        self.bytes = b""
        self.ended = False
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read(self):
        try:
            while piece := self.socket.recv(65536):
                self.bytes += piece
                if self.bytes.endswith(b"\r\n0\r\n\r\n"):
                    break
        except OSError:
            pass
        self.ended = True

    def close(self):
        self.socket.close()

    def status(self):
        return int(self.bytes.split(b" ", 2)[1]) if b"\r\n" in self.bytes else 0

    def events(self, kind):
        """[(id or None, data)] of the whole events so far."""
        head, _, body = self.bytes.partition(b"\r\n\r\n")
        text = b""
        while body:  # chunks
            size, _, body = body.partition(b"\r\n")
            count = int(size or b"0", 16)
            if count == 0 or len(body) < count:
                break
            text, body = text + body[:count], body[count + 2:]
        found = []
        for block in text.decode().split("\n\n"):
            lines = dict(line.split(": ", 1) for line in block.splitlines() if not line.startswith(":") and ": " in line)
            if lines.get("event") == kind:
                found.append((int(lines["id"]) if "id" in lines else None, json.loads(lines["data"])))
        return found


class Events(ServiceTestCase):
    def test_a_job_is_followed_to_its_end(self):
        service = self.service()
        everything = Stream(service, "/v1/events")
        self.addCleanup(everything.close)
        wait_until(lambda: b"retry: 3000" in everything.bytes, 10, "the stream of all jobs begins")
        job_id = self.submitted(service, write_job(self.folder / "job", frames=4))
        stream = Stream(service, f"/v1/jobs/{job_id}/events")
        wait_until(lambda: stream.ended, 120, "the stream ends with the job")
        states = [data["state"] for _, data in stream.events("state")]
        self.assertEqual(states, ["queued", "running", "succeeded"])
        fractions = [data["fraction"] for _, data in stream.events("progress")]
        self.assertTrue(fractions, "progress was told")
        self.assertEqual(fractions, sorted(fractions))
        wait_until(lambda: [id for id, _ in everything.events("state")] == [id for id, _ in stream.events("state")],
                   10, "the stream of all jobs tells the same")

    def test_a_stream_goes_on_after_kill_9_without_gap_or_repetition(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=12, line_count=2_000_000))
        path = f"/v1/jobs/{job_id}/events"
        stream = Stream(service, path)
        wait_until(lambda: len(stream.events("progress")) > 0, 60, "progress")
        before = stream.events("state")
        service.kill()
        wait_until(lambda: stream.ended, 10, "the stream breaks")
        service.start()
        rest = Stream(service, path, last=before[-1][0])
        wait_until(lambda: rest.ended, 240, "the job's end")
        after = rest.events("state")
        self.assertEqual(after[-1][1]["state"], "succeeded")
        whole = Stream(service, path, last=0)
        wait_until(lambda: whole.ended, 10, "the whole story once more")
        self.assertEqual(before + after, whole.events("state"))
        done = Stream(service, path, last=after[-1][0])
        wait_until(lambda: done.status() == 204, 10, "nothing more to come")
        done.close()

    def test_listeners_have_few_places(self):
        service = self.service()
        streams = [Stream(service, "/v1/events") for _ in range(LISTENERS_MAX)]
        wait_until(lambda: all(stream.status() == 200 for stream in streams), 20, "all places are taken")
        refused = service.get("/v1/events")
        self.assertEqual(refused.status, 503)
        self.assertIn("retry-after", refused.headers)
        self.assertEqual(service.get("/healthz").status, 200)
        for stream in streams:
            stream.close()
        wait_until(lambda: self.place_is_free(service), 20, "the places come free")

    def place_is_free(self, service):
        stream = Stream(service, "/v1/events")
        wait_until(lambda: stream.status() != 0, 10, "an answer")
        stream.close()
        return stream.status() == 200

    def test_an_unchanged_job_costs_a_poller_nothing(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=2))
        service.wait_for(job_id, ["succeeded"], 120)
        first = service.get(f"/v1/jobs/{job_id}")
        tag = first.headers["etag"]
        self.assertTrue(tag.startswith('"'), tag)
        second = service.get(f"/v1/jobs/{job_id}", "-H", f"If-None-Match: {tag}")
        self.assertEqual((second.status, second.body), (304, b""))

    def test_sigterm_ends_streams_at_once(self):
        service = self.service()
        stream = Stream(service, "/v1/events")
        wait_until(lambda: stream.status() == 200, 10, "a listener")
        begun = time.monotonic()
        self.assertEqual(service.stop(), 0)
        self.assertLess(time.monotonic() - begun, 8)
        wait_until(lambda: stream.ended, 5, "its stream ends")


if __name__ == "__main__":
    unittest.main(verbosity=2)
