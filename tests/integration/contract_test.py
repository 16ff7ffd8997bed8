#!/usr/bin/env python3
"""Requests made from the OpenAPI document, valid and mutated, against a real server with jobs in every state: no answer
that the document does not have, none with a status, header or body other than it says.

KEYLUME_REQUESTS (2000), KEYLUME_CLIENTS at once (1), KEYLUME_SEED (1): the same seed makes the same requests, but for the
ids of jobs. A request that fails is printed with its number and as a curl command.
"""
import collections
import os
import random
import threading
import unittest

from contract import Contract
from contract_client import Client
from contract_requests import FRAMING, Requests
from contract_world import World
from service import WORKER, Service, ServiceTestCase

REQUESTS = int(os.environ.get("KEYLUME_REQUESTS", "2000"))
CLIENTS = int(os.environ.get("KEYLUME_CLIENTS", "1"))
SEED = os.environ.get("KEYLUME_SEED", "1")
RESTORE_EVERY = 40
TRIES = 60
# Of what a sanitizer prints, where the server is built with one.
SANITIZER_WORDS = ("runtime error:", "ERROR: AddressSanitizer", "WARNING: ThreadSanitizer", "ERROR: LeakSanitizer")
# Long streams and work for the whole machine: less often than the others.
RARE = {"followJobs": 0.1, "resumeQueue": 0.1, "getVideoMp4": 0.3, "getVideoWebm": 0.3}
# Succeeds where there are tokens: contract_tokens_test.py.
WITH_TOKENS = {"logIn"}
# What comes with the dashboard, which may not have been built.
OF_DASHBOARD = {"getAsset", "listExamples", "getExampleFile"}


class Run:
    """One client's share of the requests."""

    def __init__(self, number, contract, service, folder):
        self.number, self.contract, self.service = number, contract, service
        self.client = Client(service.port)
        self.world = World(service, folder / f"job{number}", self.uncounted)
        self.requests = Requests(contract, self.world)
        self.failures, self.seen = {}, collections.Counter()

    def uncounted(self, *words):
        return self.client.exchange(*words)

    def go(self, count):
        for at in range(count):
            rng = random.Random(f"{SEED}:{self.number}:{at}")
            operation = self.contract.operations[at % len(self.contract.operations)]
            if rng.random() > RARE.get(operation.name, 1):
                operation = rng.choice([other for other in self.contract.operations if other.name not in RARE])
            request = self.requests.make(rng, operation)
            self.send(request, f"request {at} of client {self.number}, KEYLUME_SEED={SEED}")
            if at % RESTORE_EVERY == 0:
                self.world.restore()
        self.go_on_until_all_succeeded()

    def go_on_until_all_succeeded(self):
        """A valid request may still be of a frame or picture that there is not: what has not succeeded is asked again."""
        self.world.restore()
        absent = WITH_TOKENS if self.world.has_dashboard else WITH_TOKENS | OF_DASHBOARD
        for operation in (other for other in self.contract.operations if other.name not in absent):
            for at in range(TRIES):
                if any(name == operation.name and str(status)[0] == "2" for name, status in self.seen):
                    break
                rng = random.Random(f"{SEED}:{self.number}:{operation.name}:{at}")
                request = self.requests.make(rng, operation, mutated_share=0)
                self.send(request, f"valid request {at} of client {self.number}, KEYLUME_SEED={SEED}")

    def send(self, request, label):
        alone = any(name in FRAMING for name, _ in request.headers)
        try:
            exchange = self.client.exchange(request.method, request.path, request.headers, request.body, alone)
        except Exception as error:
            return self.failed(label, request, [f"no answer: {error!r}"])
        if not exchange:
            self.seen["(framing)", "no answer"] += 1
            return
        problems = self.contract.problems(exchange)
        if problems:
            self.failed(label, request, problems)
        found = self.contract.find(exchange.method, exchange.path)
        self.seen[found[0].name if found else "(elsewhere)", exchange.status] += 1
        self.world.learn(request, exchange)

    def failed(self, label, request, problems):
        """Kept once of each kind."""
        text = "\n  ".join([label, *problems, request.curl(self.service.url)[:4000]])
        self.failures.setdefault(problems[0][:60], text)


class ContractTest(ServiceTestCase):
    def started(self):
        service = Service(self.folder / "data")
        words = service.command() + ["--worker", WORKER, "--worker-threads-total", "1"]
        service.command = lambda: words
        self.addCleanup(service.clean_up)
        return service.start()

    def test_every_answer_to_requests_made_from_the_document_is_one_it_has(self):
        contract, service = Contract(), self.started()
        runs = [Run(number, contract, service, self.folder) for number in range(CLIENTS)]
        for run in runs:
            run.world.prepare()
        service.get("/v1/queue/pause", "-X", "POST")
        for run in runs:
            run.world.prepare_states()
        threads = [threading.Thread(target=run.go, args=(REQUESTS // CLIENTS,)) for run in runs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        code = service.stop()
        log = service.log.read_text(errors="replace")
        found = [line for line in log.splitlines() if any(words in line for words in SANITIZER_WORDS)]
        self.assertEqual((code, found), (0, []), log[-2000:])
        self.report(contract, runs)

    def report(self, contract, runs):
        seen = sum((run.seen for run in runs), collections.Counter())
        documented = {f"{operation.name} {status}" for operation in contract.operations for status in operation.responses}
        reached = {f"{name} {status}" for name, status in seen}
        classes = collections.Counter(str(status)[0] + "xx" for (_, status), count in seen.items() for _ in range(count))
        print(f"{sum(seen.values())} requests: {dict(classes)}; {len(documented & reached)} of {len(documented)} documented answers seen")
        failures = [failure for run in runs for failure in run.failures.values()]
        self.assertEqual(failures, [], "\n\n".join(["", *failures]))
        succeeded = {name for name, status in seen if str(status)[0] == "2"}
        missed = {operation.name for operation in contract.operations} - succeeded - WITH_TOKENS
        if not runs[0].world.has_dashboard:
            missed -= OF_DASHBOARD
        self.assertEqual(missed, set(), "these operations never did what they are for")


if __name__ == "__main__":
    unittest.main(verbosity=2)
