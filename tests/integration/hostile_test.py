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

    def test_lengths_that_conflict_or_are_none(self):
        for lines in (("Content-Length: 5", "Content-Length: 6"), ("Content-Length: 5", "Transfer-Encoding: chunked"),
                      ("Content-Length: -1",), ("Content-Length: abc",), ("Content-Length: 99999999999999999999999",),
                      ("Content-Length: 5, 6",), ("Content-Length: +5",), ("Transfer-Encoding: gzip, chunked",),
                      ("Transfer-Encoding: chunked", "Transfer-Encoding: identity")):
            with self.subTest(lines):
                self.expect_refused([self.head("POST", "/v1/jobs", "Content-Type: multipart/form-data; boundary=bound",
                                               *lines), b"5\r\nhello\r\n0\r\n\r\n"])

    def test_chunk_sizes_that_are_none(self):
        for size in (b"-2", b"ffffffffffffffffffff", b"0x5", b"5;" + b"e" * 100_000, b"", b" ", b"5\n", b"zz",
                     b"7fffffffffffffff", b"1" * 100_000):
            with self.subTest(size[:30]):
                self.expect_refused([self.head("POST", "/v1/jobs", "Transfer-Encoding: chunked",
                                               "Content-Type: multipart/form-data; boundary=bound"),
                                     size + b"\r\nhello\r\n0\r\n\r\n"])

    def test_a_second_request_hidden_in_the_first(self):
        hidden = b"DELETE /v1/jobs/x HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
        for lines in (("Content-Length: 0", f"Content-Length: {len(hidden)}"),
                      (f"Content-Length: {len(hidden)}", "Transfer-Encoding: chunked")):
            status, answer = self.exchange([self.head("GET", "/v1/jobs", *lines), hidden])
            self.assertLessEqual(answer.count(b"HTTP/1.1 "), 1, answer[:500])
            self.assertNotEqual(status, 200, "conflicting lengths are no request")

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
        dribbling = [self.connect(60) for _ in range(20)]
        for connection in dribbling[:10]:
            connection.sendall(b"GET /v1/jobs HTTP/1.1\r\nHost: 127")
        for connection in dribbling[10:]:
            connection.sendall(self.upload_head(1 << 20) + b"--bound\r\n")
        stop = threading.Event()

        def dribble():
            while not stop.wait(0.5):
                for connection in dribbling:
                    try:
                        connection.sendall(b"a")
                    except OSError:
                        pass
        thread = threading.Thread(target=dribble)
        thread.start()
        try:
            worst = 0.0
            for _ in range(20):
                begun = time.monotonic()
                self.assertEqual(curl(self.running.url + "/healthz", timeout_s=10).status, 200)
                worst = max(worst, time.monotonic() - begun)
            print(f"slowest /healthz beside 50 slow clients: {1000 * worst:.0f} ms", flush=True)
            self.assertLess(worst, 5)
            # They are given up one day, whatever they do.
            for connection in idle:
                connection.settimeout(30)
                self.assertEqual(self.answer_of(connection)[0] in (None, 408, 400), True)
        finally:
            stop.set()
            thread.join()


if __name__ == "__main__":
    unittest.main(verbosity=2)
