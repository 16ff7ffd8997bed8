#!/usr/bin/env python3
"""A server that others can reach and that is told by its environment, as in a container: its first token, and whether
it is well."""
import os
import re
import stat
import subprocess
import unittest

from curl import curl
from service import SERVER, Service, ServiceTestCase, free_port

TOKEN = re.compile(r"^kl_[A-Za-z0-9]{8}_[A-Za-z0-9_-]{43}$", re.M)


class PublicService(Service):
    """Told by variables alone."""

    def __init__(self, data):
        super().__init__(data)
        self.ops_port = free_port()
        self.token_file = self.data.parent / "first_token"
        self.more = {}

    def environment(self):
        return {"KEYLUME_DATA": str(self.data), "KEYLUME_LISTEN": f"0.0.0.0:{self.port}",
                "KEYLUME_OPS_LISTEN": f"0.0.0.0:{self.ops_port}", "KEYLUME_TOKEN_FILE": str(self.token_file), **self.more}

    def command(self):
        return ["/usr/bin/env", *(f"{name}={value}" for name, value in self.environment().items()), SERVER]

    def health(self, **more):
        return subprocess.run([SERVER, "health"], env={**os.environ, **self.environment(), **more}, capture_output=True,
                              text=True, timeout=20, stdin=subprocess.DEVNULL)

    def status_with(self, token):
        return self.get("/v1/jobs", "-H", f"Authorization: Bearer {token}").status


class FirstStart(ServiceTestCase):
    def public_service(self):
        service = PublicService(self.folder / "data")
        self.addCleanup(service.clean_up)
        return service

    def test_the_first_token_is_made_kept_and_shown_once(self):
        service = self.public_service().start()
        kept = service.token_file.read_text().strip()
        self.assertRegex(kept, TOKEN)
        self.assertEqual(stat.S_IMODE(service.token_file.stat().st_mode), 0o600)
        self.assertEqual(TOKEN.findall(service.log.read_text()), [kept])
        self.assertEqual(service.get("/v1/jobs").status, 401)
        self.assertEqual(service.status_with(kept), 200)
        self.assertEqual(service.stop(), 0)
        service.start()
        self.assertEqual(TOKEN.findall(service.log.read_text()), [kept], "not shown again")
        self.assertEqual(service.status_with(kept), 200)

    def test_a_token_that_is_given_as_a_secret_is_taken_and_never_shown(self):
        service = self.public_service()
        secret = "kl_Abcdefg1_" + "x" * 43
        service.token_file.write_text(secret + "\n")
        service.start()
        self.assertEqual(service.status_with(secret), 200)
        self.assertNotIn(secret, service.log.read_text())

    def test_a_first_token_that_was_revoked_does_not_come_back(self):
        service = self.public_service().start()
        kept = service.token_file.read_text().strip()
        words = [SERVER, "token", "revoke", "operator"]
        subprocess.run(words, env={**os.environ, "KEYLUME_DATA": str(service.data)}, check=True, timeout=20)
        self.assertEqual(service.status_with(kept), 401)
        self.assertEqual(service.stop(), 0)
        again = subprocess.run(service.command(), capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(again.returncode, 64)
        self.assertIn("there is no valid token", again.stderr)

    def test_a_file_that_holds_no_token_is_refused(self):
        service = self.public_service()
        service.token_file.write_text("secret\n")
        refused = subprocess.run(service.command(), capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(refused.returncode, 64)
        self.assertIn(str(service.token_file), refused.stderr)

    def test_metrics_ask_strangers_for_a_token_unless_that_listener_is_open(self):
        service = self.public_service().start()
        metrics = f"http://127.0.0.1:{service.ops_port}/metrics"
        self.assertEqual(curl(metrics).status, 401)
        self.assertEqual(service.stop(), 0)
        service.more = {"KEYLUME_OPS_OPEN": "true"}
        service.start()
        self.assertEqual(curl(metrics).status, 200)
        self.assertEqual(service.get("/v1/jobs").status, 401, "only that listener")

    def test_health_says_by_its_exit_code_whether_the_server_answers(self):
        service = self.public_service()
        self.assertEqual(service.health().returncode, 1, "not started")
        service.start()
        well = service.health()
        self.assertEqual((well.returncode, well.stdout, well.stderr), (0, "", ""))
        self.assertEqual(service.health(KEYLUME_OPS_LISTEN="off").returncode, 0, "the first listener is asked")
        self.assertEqual(service.stop(), 0)
        ended = service.health()
        self.assertEqual(ended.returncode, 1)
        self.assertIn(f"no answer from 127.0.0.1:{service.ops_port}", ended.stderr)


if __name__ == "__main__":
    unittest.main()
