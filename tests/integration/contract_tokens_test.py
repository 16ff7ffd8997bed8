#!/usr/bin/env python3
"""Who is let in to which operation: the table is the `security` of the OpenAPI document."""
import json
import random
import subprocess
import unittest
from urllib.parse import quote

from contract import Contract
from contract_client import Client
from contract_values import Values
from service import SERVER, ServiceTestCase

SCOPES = ("jobs:read", "jobs:write", "queue:admin", "metrics:read")
STRANGER = "kl_AAAAAAAA_" + "A" * 43


def scope_of(operation):
    """None: anyone may."""
    schemes = [scheme for scheme in operation.security if "token" in scheme]
    return schemes[0]["token"][0] if schemes else None


class ContractTokens(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        cls.contract = Contract()
        cls.values = Values(cls.contract.resolved)

    def token(self, service, scope):
        words = [SERVER, "token", "create", scope.replace(":", "-"), "--data", str(service.data), "--scopes", scope]
        return subprocess.run(words, capture_output=True, text=True, timeout=20, check=True).stdout.strip()

    def ask(self, client, operation, headers, token_text):
        """A request for what is not there: whoever is let in changes nothing, and learns that."""
        rng = random.Random(operation.name)
        path = operation.template
        for parameter in operation.parameters:
            if parameter["in"] == "path":
                value = "none" if parameter["name"] == "id" else str(self.values.valid(rng, parameter["schema"])) or "x"
                path = path.replace("{" + parameter["name"] + "}", quote(value, safe=""))
        content = (operation.request_body or {}).get("content", {})
        body = None
        if operation.name == "logIn":
            body = json.dumps({"token": token_text}).encode()
        elif content:
            body = b"{}"
        if content:
            headers = [*headers, ("Content-Type", "application/json" if "application/json" in content else next(iter(content)))]
        exchange = client.exchange(operation.method, path, headers, body)
        self.assertEqual(self.contract.problems(exchange), [], (operation.name, headers))
        return exchange

    def session(self, client, token_text):
        login = next(operation for operation in self.contract.operations if operation.name == "logIn")
        cookie = self.ask(client, login, [], token_text).headers["set-cookie"]
        return cookie.split(";")[0].partition("=")[2]

    def test_each_operation_asks_for_the_scope_that_the_document_says(self):
        service = self.service()
        tokens = {scope: self.token(service, scope) for scope in SCOPES}
        client = Client(service.port)
        for operation in self.contract.operations:
            wanted = scope_of(operation)
            with self.subTest(operation.name):
                for headers in ([], [("Authorization", f"Bearer {STRANGER}")], [("Cookie", f"keylume_session={STRANGER}")]):
                    answer = self.ask(client, operation, headers, tokens["jobs:read"])
                    self.assertEqual(answer.status == 401, wanted is not None, answer)
                for scope, token in tokens.items():
                    answer = self.ask(client, operation, [("Authorization", f"Bearer {token}")], token)
                    self.assertNotEqual(answer.status, 401, answer)
                    self.assertEqual(answer.status == 403, wanted not in (None, scope), (scope, answer))
                    if answer.status == 403:
                        self.assertIn(f'scope="{wanted}"', answer.headers["www-authenticate"])

    def test_a_cookie_changes_nothing_without_the_origin_of_our_own_pages(self):
        service = self.service()
        client = Client(service.port)
        session = {scope: self.session(client, self.token(service, scope)) for scope in SCOPES}
        for operation in self.contract.operations:
            wanted = scope_of(operation)
            if wanted is None:
                continue
            with self.subTest(operation.name):
                cookie = [("Cookie", f"keylume_session={session[wanted]}")]
                changes = operation.method != "GET"
                self.assertEqual(self.ask(client, operation, cookie, "").status == 403, changes)
                foreign = [*cookie, ("Origin", "http://example.com")]
                self.assertEqual(self.ask(client, operation, foreign, "").status == 403, changes)
                ours = [*cookie, ("Origin", service.url)]
                self.assertNotIn(self.ask(client, operation, ours, "").status, (401, 403))


if __name__ == "__main__":
    unittest.main(verbosity=2)
