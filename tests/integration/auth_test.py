#!/usr/bin/env python3
"""Tokens from the command line to the answer: who is let in, by header or by cookie, and to what."""
import json
import socket
import subprocess
import unittest

from service import SERVER, WORKER, Service, ServiceTestCase
from small_jobs import write_job


def command(*words):
    return subprocess.run([SERVER, *words], capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)


class Auth(ServiceTestCase):
    def token(self, service, name, *options):
        run = command("token", "create", name, "--data", str(service.data), *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout.strip()

    def with_token(self, service, token, path, *arguments):
        return service.get(path, "-H", f"Authorization: Bearer {token}", *arguments)

    def test_a_running_service_obeys_tokens_as_they_come_and_go(self):
        service = self.service()
        self.assertEqual(service.get("/v1/jobs").status, 200, "nobody is asked before there is a token")
        token = self.token(service, "farm")
        self.assertRegex(token, r"^kl_[A-Za-z0-9]{8}_[A-Za-z0-9_-]{43}$")
        refused = service.get("/v1/jobs")
        self.assertEqual(refused.status, 401)
        self.assertEqual(refused.headers["www-authenticate"], 'Bearer realm="keylume"')
        self.assertEqual(refused.json()["status"], 401)
        self.assertEqual(self.with_token(service, token, "/v1/jobs").status, 200)
        self.assertEqual(self.with_token(service, token[:-1] + "!", "/v1/jobs").status, 401)
        self.assertEqual(service.get("/healthz").status, 200)
        kept = b"".join(path.read_bytes() for path in service.data.rglob("*") if path.is_file())
        self.assertNotIn(token[12:].encode(), kept, "the secret is nowhere on disk")
        listed = command("token", "list", "--data", str(service.data)).stdout
        self.assertIn("farm", listed)
        self.assertNotIn(token, listed)
        self.assertEqual(command("token", "revoke", "farm", "--data", str(service.data)).returncode, 0)
        self.assertEqual(self.with_token(service, token, "/v1/jobs").status, 401)

    def test_a_stream_of_events_ends_with_its_token(self):
        service = self.service()
        self.token(service, "other")
        token = self.token(service, "farm")
        listener = self.listen(service, ["-H", f"Authorization: Bearer {token}"])
        with self.assertRaises(subprocess.TimeoutExpired):
            listener.wait(timeout=5)
        self.assertEqual(command("token", "revoke", "farm", "--data", str(service.data)).returncode, 0)
        self.assertEqual(listener.wait(timeout=20), 0, "ended by the service, in order")

    def test_a_stream_of_events_ends_with_its_login(self):
        service = self.service()
        token = self.token(service, "farm")
        cookies = [self.login(service, token) for _ in range(2)]
        listeners = [self.listen(service, cookie) for cookie in cookies]
        logout = service.get("/v1/logout", "-X", "POST", *cookies[0], "-H", f"Origin: {service.url}")
        self.assertEqual(logout.status, 204, logout.body)
        self.assertEqual(listeners[0].wait(timeout=20), 0, "ended by the service, in order")
        with self.assertRaises(subprocess.TimeoutExpired, msg="the other login of the same token goes on"):
            listeners[1].wait(timeout=3)

    def login(self, service, token):
        """-> the cookie, as curl sends it"""
        login = service.get("/v1/login", "-H", "Content-Type: application/json", "-d", json.dumps({"token": token}))
        self.assertEqual(login.status, 204, login.body)
        return ["-H", "Cookie: " + login.headers["set-cookie"].split(";")[0]]

    def listen(self, service, credentials):
        """A listener whose stream has begun."""
        listener = subprocess.Popen(["curl", "-sSN", "--max-time", "60", *credentials, service.url + "/v1/events"],
                                    stdout=subprocess.PIPE)
        self.addCleanup(listener.communicate)
        self.addCleanup(listener.kill)
        self.assertEqual(listener.stdout.readline(), b"retry: 3000\n")
        return listener

    def test_scopes_hold_for_jobs(self):
        service = self.service()
        job = write_job(self.folder / "job", frames=2)
        writer = self.token(service, "farm")
        reader = self.token(service, "farm", "--scopes", "jobs:read", "--again")
        fields = [word for name in ("scene=@scene.obj", "animation=@animation.json", "materials=@" + next(job.glob("*.mtl")).name)
                  for word in ("-F", name.replace("@", f"@{job}/"))]
        refused = self.with_token(service, reader, "/v1/jobs", *fields)
        self.assertEqual(refused.status, 403)
        self.assertIn("jobs:write", refused.json()["detail"])
        submitted = self.with_token(service, writer, "/v1/jobs", *fields)
        self.assertEqual(submitted.status, 202, submitted.body)
        path = submitted.headers["location"]
        self.assertEqual(self.with_token(service, reader, path).status, 200)
        self.assertEqual(self.with_token(service, reader, path + "/cancel", "-X", "POST").status, 403)
        self.assertEqual(self.with_token(service, writer, path + "/cancel", "-X", "POST").status, 202)

    def test_the_login_cookie_reads_and_writes_from_our_own_pages_only(self):
        service = self.service()
        token = self.token(service, "a")
        login = service.get("/v1/login", "-H", "Content-Type: application/json", "-d", json.dumps({"token": token}))
        self.assertEqual(login.status, 204, login.body)
        self.assertIn("HttpOnly", login.headers["set-cookie"])
        cookie = ["-H", "Cookie: " + login.headers["set-cookie"].split(";")[0]]
        self.assertEqual(service.get("/v1/jobs", *cookie).status, 200)
        cancel = ["/v1/jobs/none/cancel", "-X", "POST", *cookie]
        self.assertEqual(service.get(*cancel).status, 403)
        self.assertEqual(service.get(*cancel, "-H", "Origin: http://example.com").status, 403)
        self.assertEqual(service.get(*cancel, "-H", f"Origin: {service.url}").status, 404, "let in; there is no such job")

    def test_an_upload_without_a_token_is_refused_before_its_body(self):
        service = self.service()
        self.token(service, "a")
        with socket.create_connection(("127.0.0.1", service.port), timeout=10) as connection:
            connection.sendall(b"POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\n"
                               b"Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 100000000\r\n\r\n")
            self.assertTrue(connection.recv(65536).startswith(b"HTTP/1.1 401"))

    def test_a_public_address_needs_a_token_first(self):
        service = Service(self.folder / "data")
        public = [SERVER, "--data", str(service.data), "--listen", f"0.0.0.0:{service.port}", "--worker", WORKER]
        run = subprocess.run(public, capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 64)
        self.assertIn("token create", run.stderr, "it says what to do")
        self.token(service, "old", "--expires-days", "1")
        file = next((service.data / "tokens").glob("*.json"))
        kept = json.loads(file.read_text())
        file.write_text(json.dumps({**kept, "expires_ms": kept["created_ms"]}))
        self.assertEqual(subprocess.run(public, capture_output=True, timeout=20).returncode, 64, "it has expired")
        token = self.token(service, "new")
        service.command = lambda: public
        self.addCleanup(service.clean_up)
        service.start()
        self.assertEqual(service.get("/v1/jobs").status, 401)
        answer = self.with_token(service, token, "/v1/jobs")
        self.assertEqual(answer.status, 200)
        self.assertIn("ratelimit", answer.headers, "strangers could come, so requests are counted")

    def test_a_second_listener_that_others_reach_needs_a_token_first_too(self):
        service = Service(self.folder / "data")
        words = service.command() + ["--ops-listen", "0.0.0.0:0"]
        run = subprocess.run(words, capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 64)
        self.assertIn("--ops-listen: 0.0.0.0", run.stderr)

    def test_a_token_is_in_its_file_before_it_is_valid(self):
        data, file = self.folder / "data", self.folder / "token"
        first = ["token", "create", "first", "--data", str(data), "--out", str(file), "--if-none"]
        made = command(*first)
        self.assertEqual(made.returncode, 0, made.stderr)
        token = file.read_text().strip()
        self.assertEqual(made.stdout.strip(), token)
        self.assertEqual(file.stat().st_mode & 0o077, 0)
        self.assertNotEqual(command("token", "create", "second", "--data", str(data), "--out", str(file)).returncode, 0,
                            "never over another file")
        self.assertNotIn("second", command("token", "list", "--data", str(data)).stdout)
        # As a crash between the file and the token leaves it.
        self.assertEqual(command("token", "revoke", "first", "--data", str(data)).returncode, 0)
        again = command(*first)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(file.read_text().strip(), token)
        service = self.service()
        self.assertEqual(self.with_token(service, token, "/v1/jobs").status, 200)

    def test_who_asks_too_often_is_told_to_wait(self):
        service = Service(self.folder / "data")
        words = service.command() + ["--rate-limit", "2"]
        service.command = lambda: words
        self.addCleanup(service.clean_up)
        service.start()
        answers = [service.get("/v1/jobs") for _ in range(20)]
        refused = [answer for answer in answers if answer.status == 429]
        self.assertTrue(refused)
        self.assertGreaterEqual(int(refused[0].headers["retry-after"]), 1)

    def test_every_answer_tells_browsers_to_take_it_for_data(self):
        service = self.service()
        for path in ("/healthz", "/v1/jobs", "/nowhere"):
            headers = service.get(path).headers
            self.assertEqual(headers["x-content-type-options"], "nosniff", path)
            self.assertIn("frame-ancestors 'none'", headers["content-security-policy"], path)
            self.assertEqual(headers["referrer-policy"], "no-referrer", path)

    def test_wrong_commands_are_refused(self):
        data = str(self.folder / "data")
        for words in (["token"], ["token", "dance", "--data", data], ["token", "create", "--data", data],
                      ["token", "create", "a"], ["token", "create", "a b", "--data", data],
                      ["token", "create", "a", "--data", data, "--scopes", "jobs:dance"],
                      ["token", "create", "a", "--data", data, "--expires-days", "0"],
                      ["token", "revoke", "nobody", "--data", data]):
            self.assertNotEqual(command(*words).returncode, 0, words)


if __name__ == "__main__":
    unittest.main(verbosity=2)
