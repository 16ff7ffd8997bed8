#!/usr/bin/env python3
"""What no honest client sends: refused, within bounds of memory and time, and nobody else notices."""
import gzip
import io
import socket
import threading
import time
import unittest
from pathlib import Path

from curl import curl
from service import ServiceTestCase, wait_until
from slow_clients import dribbling
from small_jobs import write_job

MEMORY_MAX_MIB = 32  # more than before the attack
ANSWER_MAX_S = 20


def resident_mib(pid, field="VmRSS:"):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith(field):
            return int(line.split()[1]) / 1024
    raise AssertionError("no such process")


def multipart(parts, boundary="bound"):
    """[(headers, bytes)] -> body"""
    body = b""
    for headers, data in parts:
        body += b"--" + boundary.encode() + b"\r\n" + headers.encode() + b"\r\n\r\n" + data + b"\r\n"
    return body + b"--" + boundary.encode() + b"--\r\n"


def part(field, name, data):
    return f'Content-Disposition: form-data; name="{field}"; filename="{name}"', data


class Hostile(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()
        self.assertEqual(self.running.get("/v1/jobs").status, 200)
        self.before = resident_mib(self.running.process.pid)

    def tearDown(self):
        """Whatever was tried: the service serves, is no larger, and keeps nothing of it."""
        pid = self.running.process.pid
        self.assertIsNone(self.running.process.poll(), self.running.log.read_text(errors="replace")[-2000:])
        self.assertEqual(self.running.get("/healthz").status, 200)
        peak = resident_mib(pid, "VmHWM:") - self.before
        print(f"{self.id().rsplit('.', 1)[1]}: {peak:.1f} MiB more at most", flush=True)
        self.assertLess(peak, MEMORY_MAX_MIB)
        wait_until(lambda: not list((self.running.data / "tmp").iterdir()), 20, "nothing is left of uploads")
        self.assertEqual(list((self.running.data / "jobs").iterdir()), [])

    def connect(self, timeout_s=ANSWER_MAX_S):
        connection = socket.create_connection(("127.0.0.1", self.running.port), timeout=timeout_s)
        self.addCleanup(connection.close)
        return connection

    def exchange(self, pieces):
        """Sends the pieces, as far as they are taken -> (status or None where the connection was cut, answer)"""
        connection = self.connect()
        try:
            for piece in pieces:
                connection.sendall(piece)
            connection.shutdown(socket.SHUT_WR)
        except OSError:
            pass  # it has heard enough; an answer may wait
        return self.answer_of(connection)

    def answer_of(self, connection):
        answer = b""
        try:
            while len(answer) < 1 << 20:
                got = connection.recv(65536)
                if not got:
                    break
                answer += got
        except ConnectionError:
            pass
        words = answer.split(b" ", 2)
        return (int(words[1]) if answer.startswith(b"HTTP/1.1 ") else None), answer

    def expect_refused(self, pieces, statuses=None):
        """4xx (one of `statuses` where given), or cut off without an answer."""
        status, answer = self.exchange(pieces)
        if status is not None:
            self.assertTrue(400 <= status < 500 or status == 501, answer[:300])
            if statuses:
                self.assertIn(status, statuses, answer[:300])
        return status

    def head(self, method="GET", path="/v1/jobs", *headers):
        lines = [f"{method} {path} HTTP/1.1", f"Host: 127.0.0.1:{self.running.port}", *headers]
        return "\r\n".join(lines).encode() + b"\r\n\r\n"

    def upload_head(self, length, boundary="bound", *headers):
        return self.head("POST", "/v1/jobs", f"Content-Type: multipart/form-data; boundary={boundary}",
                         f"Content-Length: {length}", *headers)

    # heads

    def test_eighty_thousand_headers(self):
        lines = b"".join(b"X-%d: y\r\n" % i for i in range(80_000))
        self.expect_refused([self.head()[:-2], lines, b"\r\n"])

    def test_a_header_line_of_100_mb(self):
        self.expect_refused([self.head()[:-2], b"X-Long: ", *[b"y" * (1 << 20)] * 100, b"\r\n\r\n"])

    def test_a_request_line_of_100_mb(self):
        self.expect_refused([b"GET /", *[b"y" * (1 << 20)] * 100, b" HTTP/1.1\r\n\r\n"])

    # Each with an upload that makes a job if its length or its chunks are read in any way at all, and with another
    # request behind it that is answered if the connection is kept.

    def good_upload(self):
        job = write_job(self.folder / "good", frames=2)
        material = next(job.glob("*.mtl"))
        return multipart([part("scene", "scene.obj", (job / "scene.obj").read_bytes()),
                          part("materials", material.name, material.read_bytes()),
                          part("animation", "animation.json", (job / "animation.json").read_bytes())])

    def expect_no_job(self, lines, body):
        """Refused in words, no job made, and the connection closed with what follows on it."""
        head = self.head("POST", "/v1/validate", "Content-Type: multipart/form-data; boundary=bound", *lines)
        connection = self.connect()
        begun = time.monotonic()
        try:
            connection.sendall(head + body + self.head())
        except OSError:
            pass
        status, answer = self.answer_of(connection)
        self.assertIn(status, (400, 413, 501), answer[:300])
        self.assertEqual(answer.count(b"HTTP/1.1 "), 1, answer[:500])
        self.assertLess(time.monotonic() - begun, 5, "it is closed, not waited on")

    def test_lengths_that_conflict_or_are_none(self):
        body = self.good_upload()
        chunked = f"{len(body):x}".encode() + b"\r\n" + body + b"\r\n0\r\n\r\n"
        length = f"Content-Length: {len(body)}"
        self.assertEqual(self.exchange([self.head("POST", "/v1/validate", "Content-Type: multipart/form-data; boundary=bound",
                                                  length, "Connection: close"), body])[0], 200, "it is a good one")
        for lines in ((length, "Content-Length: 6"), ("Content-Length: 6", length), (length, "Transfer-Encoding: chunked"),
                      ("Content-Length: -1",), ("Content-Length: abc",), (f"Content-Length: {len(body)}, {len(body)}",),
                      (f"Content-Length: +{len(body)}",), ("Content-Length: %35",), ("Content-Length: 18446744073709551615",),
                      ("Content-Length: 9223372036854775808",), ("Content-Length: 99999999999999999999999",),
                      (f"Content-Length : {len(body)}",)):
            with self.subTest(lines):
                self.expect_no_job(lines, body)
        for coding in ("gzip, chunked", "identity", "%63hunked", "chunked, chunked", "xchunked"):
            with self.subTest(coding):
                self.expect_no_job((f"Transfer-Encoding: {coding}",), chunked)
        self.expect_no_job(("Transfer-Encoding: chunked", "Transfer-Encoding: identity"), chunked)

    def test_chunk_sizes_that_are_none(self):
        body = self.good_upload()
        size = f"{len(body):x}".encode()
        for wrong in (b"-" + size, b"+" + size, b"0x" + size, b" " + size, size + b" x", size + b";" + b"e" * 100_000, b"",
                      b"zz", b"ffffffffffffffffffff", b"fffffffffffffffe", b"7fffffffffffffff", b"1" * 100_000, b"-2"):
            with self.subTest(wrong[:30]):
                self.expect_no_job(("Transfer-Encoding: chunked",), wrong + b"\r\n" + body + b"\r\n0\r\n\r\n")
        self.expect_no_job(("Transfer-Encoding: chunked",), size + b"\n" + body + b"\r\n0\r\n\r\n")
        self.expect_no_job(("Transfer-Encoding: chunked",), size + b"\r\n" + body + b"0\r\n\r\n")

    def test_a_second_request_hidden_in_the_first(self):
        hidden = self.head("GET", "/version")
        for path in ("/v1/jobs/x/cancel", "/v1/login", "/v1/validate"):
            for lines in (("Content-Length: 0", f"Content-Length: {len(hidden)}"),
                          (f"Content-Length: {len(hidden)}", "Transfer-Encoding: chunked"),
                          (f"Content-Length: {len(hidden)}", "Transfer-Encoding: %63hunked"),
                          ("Content-Length: %30", "X: y")):
                status, answer = self.exchange([self.head("POST", path, *lines), hidden])
                self.assertEqual(answer.count(b"HTTP/1.1 "), 1, answer[:500])
                self.assertNotIn(b"worker_sandbox", answer)
                self.assertIn(status, (400, 501), "no request is read out of this")
        # Where the length is said once, the body is the body and what follows is the next request.
        status, answer = self.exchange([self.head("POST", "/v1/queue/resume", f"Content-Length: {len(hidden)}"), hidden,
                                        self.head("GET", "/healthz", "Connection: close")])
        self.assertNotIn(b"worker_sandbox", answer)

    def test_bodies_of_a_megabyte_from_everywhere_are_given_back(self):
        def send():
            for _ in range(2):
                status, _ = self.exchange([self.head("POST", "/v1/jobs/x/cancel", "Content-Length: 1000000",
                                                     "Content-Type: application/json"), b" " * 1_000_000])
                statuses.append(status)
        statuses = []
        for _ in range(8):  # 8 at once, and all threads of the service after one another
            threads = [threading.Thread(target=send) for _ in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(set(statuses), {404})
        now = resident_mib(self.running.process.pid)
        print(f"{now - self.before:.1f} MiB more afterwards", flush=True)
        # Every thread's stack has been used by now, 100 to 200 KiB of it; 64 bodies kept would be 60 MiB.
        self.assertLess(now - self.before, 20)

    def test_line_ends_in_names_and_values_reach_no_header(self):
        for path in ("/v1/jobs%0d%0aX-Injected:%20yes", "/v1/jobs/a%0d%0aSet-Cookie:%20x=1", "/v1/jobs?state=%0d%0aX-Injected:1",
                     "/v1/jobs/%0aX-Injected:1/cancel"):
            status, answer = self.exchange([self.head("GET", path, "X-Request-Id: a%0d%0aX-Injected: 1", "Connection: close")])
            self.assertIn(status, range(400, 500), answer[:300])
            head = answer.split(b"\r\n\r\n")[0].lower()
            self.assertNotIn(b"x-injected", head)
            self.assertNotIn(b"set-cookie", head)
        for name in ('a\r\nX: y.mtl', 'a%0d%0aX.mtl\r', '\r\n\r\n.mtl'):
            body = multipart([part("materials", name, b"newmtl a\n")])
            status, answer = self.exchange([self.upload_head(len(body), "bound", "Connection: close"), body])
            self.assertIn(status, range(400, 500), answer[:300])

    def test_dots_in_every_spelling_lead_nowhere(self):
        secret = self.running.data / "keylume.db"
        self.assertTrue(secret.exists())
        ups = ("..", "%2e%2e", ".%2e", "%2E.", "%252e%252e", "..%00", "..;", "%c0%ae%c0%ae", "..%5c", "..\\", "%uff0e.")
        for up in ups:
            for start in ("", "v1/", "v1/jobs/", "v1/jobs/x/", "v1/jobs/x/frames/0/"):
                for slash in ("/", "%2f", "%5c"):
                    path = "/" + start + (up + slash) * 4
                    for file in ("etc/passwd", "keylume.db"):
                        status, answer = self.exchange([self.head("GET", path + file, "Connection: close")])
                        self.assertIn(status, range(400, 500), path + file)
                        self.assertNotIn(b"root:", answer)
                        self.assertNotIn(b"SQLite format", answer)

    # bodies

    def test_chunks_without_end(self):
        head = self.head("POST", "/v1/jobs", "Transfer-Encoding: chunked",
                         "Content-Type: multipart/form-data; boundary=bound")
        chunk = b"100000\r\n" + b"x" * 0x100000 + b"\r\n"
        self.expect_refused([head, *[chunk] * 256])
        other = self.head("POST", "/v1/jobs/x/cancel", "Transfer-Encoding: chunked", "Content-Type: application/json")
        self.expect_refused([other, *[chunk] * 256])

    def test_gzip_bombs(self):
        out = io.BytesIO()
        with gzip.GzipFile(fileobj=out, mode="wb") as bomb:
            for _ in range(200):
                bomb.write(b"\0" * (1 << 20))
        data = out.getvalue()
        for method, path, kind in (("POST", "/v1/jobs", "multipart/form-data; boundary=bound"),
                                   ("POST", "/v1/validate", "multipart/form-data; boundary=bound"),
                                   ("POST", "/v1/jobs/x/cancel", "application/json"),
                                   ("GET", "/v1/jobs", "application/json")):
            status = self.expect_refused([self.head(method, path, f"Content-Type: {kind}", "Content-Encoding: gzip",
                                                    f"Content-Length: {len(data)}"), data])
            self.assertIn(status, (404, 413, 415), "refused in words")

    def test_ten_thousand_parts(self):
        body = multipart([part("textures", f"t{i}.png", b"x") for i in range(10_000)])
        self.assertIn(self.expect_refused([self.upload_head(len(body)), body]), (413, None))
        body = multipart([part(f"f{i}", "x", b"x") for i in range(10_000)])
        self.assertIn(self.expect_refused([self.upload_head(len(body)), body]), (422, None))

    def test_parts_that_are_no_parts(self):
        long = "x" * (1 << 20)
        bodies = {
            "nothing": b"", "no boundary": b"x" * 100_000, "only the end": b"--bound--\r\n",
            "endless first line": b"-" * (4 << 20),
            "endless headers": b"--bound\r\n" + b"A: b\r\n" * 200_000,
            "a megabyte of field name": multipart([part(long, "a", b"x")]),
            "a megabyte of file name": multipart([part("materials", long, b"x")]),
            "no disposition": multipart([("A: b", b"x")]),
            "nul in a name": multipart([part("materials", "a\0.mtl", b"x")]),
            "a broken quote": multipart([('Content-Disposition: form-data; name="scene; filename=x', b"x")]),
            "percent signs": multipart([("Content-Disposition: form-data; name=materials; filename*=UTF-8''%", b"x")]),
            "regex bait": multipart([("Content-Disposition: form-data; name=materials; filename*=UTF-8''" + "a" * 8000, b"x")]),
            "twice the same": multipart([part("scene", "a", b"v 0 0 0"), part("scene", "a", b"v 0 0 0")]),
        }
        for name, body in bodies.items():
            with self.subTest(name):
                status = self.expect_refused([self.upload_head(len(body)), body])
                self.assertIn(status, (400, 413, 422, None))
        for boundary in ('""', "x" * 71, "a\tb", "", '"', "bound; boundary=other"):
            self.expect_refused([self.head("POST", "/v1/jobs", f"Content-Type: multipart/form-data; boundary={boundary}",
                                           "Content-Length: 4"), b"abcd"])

    def test_an_upload_cut_anywhere_leaves_nothing(self):
        job = write_job(self.folder / "job", frames=2)
        body = multipart([part("scene", "scene.obj", (job / "scene.obj").read_bytes()),
                          part("materials", next(job.glob("*.mtl")).name, next(job.glob("*.mtl")).read_bytes()),
                          part("animation", "animation.json", (job / "animation.json").read_bytes())])
        cuts = sorted({len(body) * percent // 100 for percent in range(100)} |
                      {at + shift for at in (i for i in range(len(body)) if body.startswith(b"\r\n--bound", i))
                       for shift in (0, 1, 2, 5, 9, 10) if at + shift < len(body) - 4})
        for cut in cuts:
            # Announced in full and cut, or announced as long as it is.
            for length in (len(body), cut):
                status, answer = self.exchange([self.upload_head(length, "bound", "Connection: close"), body[:cut]])
                self.assertIn(status, (400, 422, None), f"cut at {cut}: {answer[:200]}")
        self.assertEqual(self.running.get("/v1/jobs").json()["jobs"], [])

    # time

    def test_clients_that_dribble_or_say_nothing_do_not_stop_the_others(self):
        idle = [self.connect(60) for _ in range(30)]
        slow = [self.connect(60) for _ in range(20)]
        for connection in slow[:10]:
            connection.sendall(b"GET /v1/jobs HTTP/1.1\r\nHost: 127")
        for connection in slow[10:]:
            connection.sendall(self.upload_head(1 << 20) + b"--bound\r\n")
        with dribbling(slow):
            worst = 0.0
            for _ in range(20):
                begun = time.monotonic()
                self.assertEqual(curl(self.running.url + "/healthz", timeout_s=10).status, 200)
                worst = max(worst, time.monotonic() - begun)
            print(f"slowest /healthz beside 50 slow clients: {1000 * worst:.0f} ms", flush=True)
            self.assertLess(worst, 5)
            # They are given up one day, whatever they do: still dribbling, none of them is held.
            ends = time.monotonic() + 30
            for connection in idle + slow:
                connection.settimeout(max(0.1, ends - time.monotonic()))
                self.assertIn(self.answer_of(connection)[0], (None, 408, 400))

    def test_three_hundred_that_dribble_their_heads_hold_up_nobody(self):
        slow = [self.connect(40) for _ in range(300)]
        for connection in slow:
            connection.sendall(self.head()[:-2] + b"X-Slow: ")
        with dribbling(slow, every_s=2):
            worst = 0.0
            end = time.monotonic() + 8  # less than it takes until they are sent away
            while time.monotonic() < end:
                begun = time.monotonic()
                self.assertEqual(curl(self.running.url + "/v1/jobs", timeout_s=30).status, 200)
                worst = max(worst, time.monotonic() - begun)
            print(f"slowest /v1/jobs beside 300 that dribble: {1000 * worst:.0f} ms", flush=True)
            self.assertLess(worst, 15)
            statuses = [self.answer_of(connection)[0] for connection in slow]
            self.assertGreater(statuses.count(408), 290, "their time for a head is limited")


if __name__ == "__main__":
    unittest.main(verbosity=2)
