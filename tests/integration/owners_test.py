#!/usr/bin/env python3
"""Two tokens and an admin's: nobody finds, reads, steers or hears of another's jobs and blobs."""
import hashlib
import json
import subprocess
import unittest

from curl import curl
from service import SERVER, Service, ServiceTestCase, wait_until
from small_jobs import write_job

ADMIN = "jobs:read,jobs:write,queue:admin"


class Owners(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()
        self.job = write_job(self.folder / "job", frames=2)
        self.of_nobody = self.submitted(self.running, self.job)
        self.anna, self.bert, self.root = self.token("anna"), self.token("bert"), self.token("root", "--scopes", ADMIN)

    def token(self, name, *options):
        """-> what curl is told to use a new token of this name"""
        run = subprocess.run([SERVER, "token", "create", name, "--data", str(self.running.data), *options],
                             capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 0, run.stderr)
        return ["-H", "Authorization: Bearer " + run.stdout.strip()]

    def submit_as(self, token, *more):
        fields = ["-F", f"scene=@{self.job / 'scene.obj'}", "-F", f"animation=@{self.job / 'animation.json'}"]
        fields += [word for path in self.job.glob("*.mtl") for word in ("-F", f"materials=@{path}")]
        answer = self.running.get("/v1/jobs", *fields, *token, *more)
        self.assertEqual(answer.status, 202, answer.body)
        return answer.json()["id"]

    def listed(self, token, query=""):
        return [job["id"] for job in self.running.get("/v1/jobs" + query, *token).json()["jobs"]]

    def finished(self, token):
        job_id = self.submit_as(token)
        wait_until(lambda: self.running.get(f"/v1/jobs/{job_id}", *token).json()["state"] == "succeeded", 120, "done")
        return job_id

    def test_a_stranger_finds_no_route_into_a_finished_job(self):
        job_id = self.finished(self.anna)
        document = self.running.get("/openapi.json").json()
        tried = 0
        for path, operations in document["paths"].items():
            if "{id}" not in path:
                continue
            values = {"{id}": job_id, "{f}": "0", "{p}": "0", "{file}": "manifest.json", "{view}": "0" * 16}
            for name, value in values.items():
                path = path.replace(name, value)
            for method in operations.keys() - {"parameters"}:
                body = ["-H", "Content-Type: application/json", "-d", "{}"] if method in ("post", "patch") else []
                answer = self.running.get(path, "-X", method.upper(), *body, *self.bert)
                self.assertEqual(answer.status, 404, (method, path, answer.body))
                self.assertIn(f"there is no job '{job_id}'", answer.json()["detail"], (method, path))
                tried += 1
        self.assertGreater(tried, 30)
        self.assertEqual(self.running.get(f"/v1/jobs/{job_id}/frames/0/image.png", *self.anna).status, 200)
        self.assertEqual(self.running.get(f"/v1/jobs/{job_id}/frames/0/image.png", *self.root).status, 200)

    def test_lists_and_batches_end_at_the_owner(self):
        of_anna, of_bert = self.submit_as(self.anna), self.submit_as(self.bert)
        self.assertEqual(self.listed(self.anna), [of_anna])
        self.assertEqual(self.listed(self.bert, "?owner=anna"), [])
        self.assertEqual(set(self.listed(self.root)), {of_anna, of_bert, self.of_nobody})
        self.assertEqual(self.listed(self.root, "?owner="), [self.of_nobody])
        self.assertEqual(self.running.get(f"/v1/jobs/{self.of_nobody}", *self.anna).status, 404)
        self.assertEqual(self.running.get(f"/v1/jobs/{of_anna}", *self.root).json()["owner"], "anna")
        body = json.dumps({"action": "cancel", "ids": [of_anna, of_bert]})
        results = self.running.get("/v1/jobs/batch", "-d", body, "-H", "Content-Type: application/json", *self.bert).json()
        self.assertEqual([entry["status"] for entry in results["results"]][0], 404)
        self.assertNotIn("cancel", self.running.get(f"/v1/jobs/{of_anna}", *self.anna).json()["state"])

    def test_events_are_those_of_their_own_jobs(self):
        of_anna, of_bert = self.finished(self.anna), self.finished(self.bert)
        heard = subprocess.run(["curl", "-sN", "--max-time", "3", "-H", "Last-Event-ID: 0", *self.bert,
                                self.running.url + "/v1/events"], capture_output=True, text=True, timeout=20).stdout
        self.assertIn(of_bert, heard)
        self.assertIn('"state":"succeeded"', heard)
        self.assertNotIn(of_anna, heard)
        self.assertNotIn(self.of_nobody, heard)

    def test_a_key_is_its_owners(self):
        key = ["-H", "Idempotency-Key: once"]
        of_anna, of_bert = self.submit_as(self.anna, *key), self.submit_as(self.bert, *key)
        self.assertNotEqual(of_anna, of_bert)
        self.assertEqual(self.submit_as(self.anna, *key), of_anna)

    def test_a_token_is_replaced_without_losing_its_jobs(self):
        job_id = self.submit_as(self.anna)
        new = self.token("anna", "--again")
        self.assertEqual(self.listed(new), [job_id])
        old_prefix = self.anna[1].split("_")[1]
        subprocess.run([SERVER, "token", "revoke", old_prefix, "--data", str(self.running.data)], timeout=20, check=True)
        self.assertEqual(self.running.get("/v1/jobs", *self.anna).status, 401)
        self.assertEqual(self.listed(new), [job_id])

    def test_a_blob_tells_nobody_but_its_sender_that_it_is_there(self):
        data = b"v 0 0 0"
        sha256 = hashlib.sha256(data).hexdigest()
        path = f"{self.running.url}/v1/blobs/sha256/{sha256}"
        file = self.folder / "blob"
        file.write_bytes(data)
        self.assertEqual(curl(path, "-T", str(file), *self.anna).status, 201)
        self.assertEqual(curl(path, "-I", *self.anna).status, 200)
        for token in (self.bert, self.root):
            self.assertEqual(curl(path, "-I", *token).status, 404)
            named = json.dumps({"files": [{"field": "scene", "sha256": sha256}]})
            answer = curl(self.running.url + "/v1/validate", "-H", "Content-Type: application/json", "-d", named, *token)
            self.assertEqual((answer.status, answer.json()["errors"][0]["code"]), (422, "unknown_blob"))
        self.assertEqual(curl(path, "-T", str(file), *self.bert).status, 201, "as if it were the first")
        self.assertEqual(curl(path, "-I", *self.bert).status, 200)
        self.assertEqual(len([kept for kept in (self.running.data / "blobs").rglob("*") if kept.is_file()]), 1)


class Hosts(ServiceTestCase):
    def test_a_public_service_answers_for_numbers_and_the_names_it_was_given(self):
        service = Service(self.folder / "data")
        run = subprocess.run([SERVER, "token", "create", "a", "--data", str(service.data)], capture_output=True, text=True,
                             timeout=20, check=True)
        token = ["-H", "Authorization: Bearer " + run.stdout.strip()]
        words = [SERVER, "--data", str(service.data), "--listen", f"0.0.0.0:{service.port}", "--ops-listen", "off",
                 "--public-host", "render.example.org"]
        service.command = lambda: words
        self.addCleanup(service.clean_up)
        service.start()
        for host, status in (("192.0.2.7", 200), (f"127.0.0.1:{service.port}", 200), ("localhost", 200),
                             ("render.example.org:443", 200), ("rebound.example", 421), ("example.org", 421)):
            answer = service.get("/v1/jobs", "-H", f"Host: {host}", *token)
            self.assertEqual(answer.status, status, host)


if __name__ == "__main__":
    unittest.main(verbosity=2)
