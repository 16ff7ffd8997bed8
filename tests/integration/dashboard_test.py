#!/usr/bin/env python3
"""The dashboard over a socket: what browsers get, also before they have a token; and the one that was built."""
import gzip
import re
import subprocess
import unittest
from pathlib import Path

from service import SERVER, Service, ServiceTestCase

BUILT = Path(SERVER).parent / "dashboard"
PAGES = ("/", "/new", "/jobs/job_01JDA2V7Y0K3V9X0Q2M7RA4N5P", "/compare", "/system", "/login")
SCRIPT_BYTES_MAX = 250_000  # of all scripts, as gzip sends them


class WithDashboard(Service):
    def __init__(self, data, folder):
        super().__init__(data)
        self.dashboard = folder

    def command(self):
        return [*super().command(), "--dashboard", str(self.dashboard)]


class Dashboard(ServiceTestCase):
    def served(self, folder):
        service = WithDashboard(self.folder / "data", folder)
        self.addCleanup(service.clean_up)
        return service.start()

    def small(self):
        folder = self.folder / "dashboard"
        (folder / "assets").mkdir(parents=True)
        (folder / "index.html").write_text('<!doctype html><script type="module" src="/assets/a.B.js"></script>')
        (folder / "assets/a.B.js").write_text("let x = 1;" * 100)
        (folder / "assets/a.B.js.gz").write_bytes(gzip.compress(b"let x = 1;" * 100))
        return folder

    def test_pages_and_files_come_without_a_token_and_nothing_else_does(self):
        service = self.served(self.small())
        made = subprocess.run([SERVER, "token", "create", "a", "--data", str(service.data)], capture_output=True, timeout=20)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(service.get("/v1/jobs").status, 401)
        for path in (*PAGES, "/assets/a.B.js"):
            answer = service.get(path)
            self.assertEqual(answer.status, 200, path)
            self.assertEqual(answer.headers["x-content-type-options"], "nosniff")
            policy = answer.headers["content-security-policy"]
            self.assertTrue(policy.startswith("default-src 'none'; script-src 'self'"), policy)
            self.assertNotIn("unsafe", policy)
        self.assertEqual(service.get("/jobs").status, 401, "strangers do not learn which paths there are")

    def test_head_codings_and_conditions(self):
        service = self.served(self.small())
        whole = service.get("/assets/a.B.js")
        self.assertIn("immutable", whole.headers["cache-control"])
        packed = service.get("/assets/a.B.js", "-H", "Accept-Encoding: gzip")
        self.assertEqual(packed.headers["content-encoding"], "gzip")
        self.assertEqual(gzip.decompress(packed.body), whole.body)
        head = service.get("/assets/a.B.js", "-I")
        self.assertEqual((head.status, int(head.headers["content-length"])), (200, len(whole.body)))
        index = service.get("/")
        self.assertEqual(index.headers["cache-control"], "no-cache")
        self.assertEqual(service.get("/", "-H", f"If-None-Match: {index.headers['etag']}").status, 304)
        self.assertEqual(service.get("/", "-X", "POST").status, 405)
        self.assertEqual(service.get("/assets/../index.html", "--path-as-is").status, 404)

    def test_a_folder_that_is_no_dashboard_leaves_a_page_that_says_how_to_get_one(self):
        empty = self.folder / "empty"
        empty.mkdir()
        service = self.served(empty)
        answer = service.get("/")
        self.assertEqual(answer.status, 200)
        self.assertIn(b"npm", answer.body)
        self.assertEqual(service.get("/v1/jobs").status, 200)
        self.assertIn("no dashboard", service.log.read_text())

    @unittest.skipUnless(BUILT.is_dir(), "the dashboard was not built (no npm, or no network)")
    def test_the_built_one_is_whole_small_and_asks_nobody_else(self):
        service = self.service()
        texts = [service.get("/").body.decode()]
        self.assertNotIn("<style", texts[0])
        self.assertNotRegex(texts[0], r"<script(?![^>]*src=)")
        seen, packed = set(), 0
        while texts:
            for name in re.findall(r"[\w-]+\.[A-Z0-9]{8}\.(?:js|css)", texts.pop()):
                if name in seen:
                    continue
                seen.add(name)
                answer = service.get(f"/assets/{name}")
                self.assertEqual(answer.status, 200, name)
                texts.append(answer.body.decode())
                if name.endswith(".js"):
                    packed += len(gzip.compress(answer.body))
                self.assertNotRegex(texts[-1], r"(?:src|href|fetch\(|import\(|url\()=?[\"']?https?://", name)
        self.assertGreater(len(seen), 5)
        self.assertLessEqual(packed, SCRIPT_BYTES_MAX)
        examples = service.get("/examples/index.json").json()["examples"]
        self.assertIn("garage", [example["name"] for example in examples])
        for example in examples:
            fields = [file["field"] for file in example["files"]]
            self.assertEqual((fields.count("scene"), fields.count("animation")), (1, 1), example["name"])
            for file in example["files"]:
                self.assertEqual(service.get(file["href"]).status, 200, file["href"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
