#!/usr/bin/env python3
"""Bad input: 422 with every place to fix, nothing left on disk, and the queue goes on."""
import json
import os
import shutil
import socket
import subprocess
import sys
import unittest

from curl import curl
from service import ServiceTestCase
from small_jobs import EXAMPLES, changed, write_job


class Rejected(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = self.service()

    def files(self):
        """Files and folders of jobs and uploads."""
        data = self.running.data
        return sorted(path.relative_to(data).as_posix() for top in ("jobs", "tmp") for path in (data / top).rglob("*"))

    def expect_refused(self, answer, what):
        self.assertEqual(answer.status, 422, f"{what}: {answer.body.decode(errors='replace')}")
        self.assertEqual(answer.headers["content-type"], "application/problem+json", what)
        problem = answer.json()
        self.assertEqual(problem["status"], 422, what)
        self.assertTrue(1 <= len(problem["errors"]) <= 20, f"{what}: {problem}")
        self.assertEqual(self.files(), [], f"{what}: something is left on disk")
        return problem["errors"]

    def expect_the_queue_goes_on(self):
        job_id = self.submitted(self.running, write_job(self.folder / "good", frames=2))
        self.running.wait_for(job_id, ["succeeded"], 120)
        self.assertIn(f"jobs/{job_id}/artefacts/radiosity.npy", self.files(), "this is where files would be seen")
        self.assertEqual([job["id"] for job in self.running.get("/v1/jobs").json()["jobs"]], [job_id])

    def test_every_rejected_example(self):
        folders = sorted(path for path in (EXAMPLES / "rejected").iterdir() if path.is_dir())
        self.assertGreater(len(folders), 10)
        for folder in folders:
            with self.subTest(example=folder.name):
                expected = json.loads((folder / "expected.json").read_text())
                errors = self.expect_refused(self.running.submit(self.whole_example(folder)), folder.name)
                self.assertEqual(len(errors), len(expected["errors"]), errors)
                for wanted, found in zip(expected["errors"], errors):
                    self.assertEqual({name: found.get(name) for name in wanted}, wanted)
        self.expect_the_queue_goes_on()

    def whole_example(self, folder):
        """A copy of it, with the animation made where that is computed."""
        copy = shutil.copytree(folder, self.folder / "rejected" / folder.name)
        if (folder / "make_animation.py").exists():
            subprocess.run([sys.executable, folder / "make_animation.py", copy], check=True)
        return copy

    def test_what_is_wrong_in_every_file_comes_in_one_answer(self):
        job = write_job(self.folder / "job", frames=2)
        changed(job, lambda animation: animation["lighting"].update(tolerance=-1))
        with open(job / "scene.obj", "a") as scene:
            scene.write("f 1 2 999999\n")
        material = next(job.glob("*.mtl"))
        material.write_text(material.read_text() + "newmtl more\nKd many\n")
        expected = [("animation.json", "out_of_range"), ("scene.obj", "index_out_of_range"), (material.name, "syntax")]
        for path in ("/v1/jobs", "/v1/validate"):
            errors = self.expect_refused(self.running.submit(job, path), path)
            self.assertEqual([(error["file"], error["code"]) for error in errors], expected)
        folder = self.folder / "by hand"
        shutil.copytree(job, folder / "input")
        run = subprocess.run([os.environ["KEYLUME_WORKER"], "check", str(folder)], capture_output=True, text=True)
        self.assertEqual(run.returncode, 2, run.stderr)
        for file, _ in expected:
            self.assertIn(f"keylume: {file}", run.stderr)
        self.expect_the_queue_goes_on()

    def test_places_are_in_the_files_as_they_were_sent(self):
        job = write_job(self.folder / "job", frames=2)
        changed(job, lambda animation: animation["objects"].update(lantern={}))
        animation = job / "animation.json"
        animation.write_text(json.dumps(json.loads(animation.read_text()), indent=1))
        lines = animation.read_text().splitlines()
        line = next(i for i, text in enumerate(lines, 1) if '"lantern"' in text)
        with open(job / "scene.obj", "a") as scene:
            scene.write("f 1 2 999999\n")
        fields = [f"scene=@{job / 'scene.obj'};filename=my hall.obj", f"animation=@{animation};filename=C:\\walk.v2.json",
                  f"materials=@{next(job.glob('*.mtl'))}"]
        words = [word for field in fields for word in ("-F", field)]
        for path in ("/v1/jobs", "/v1/validate"):
            face, name = self.expect_refused(self.running.get(path, *words), path)
            self.assertEqual((face["file"], face["code"]), ("my hall.obj", "index_out_of_range"))
            self.assertEqual((name["file"], name["pointer"], name["line"]), ("walk.v2.json", "/objects/lantern", line))
            self.assertEqual(lines[line - 1][name["column"] - 1], "{")
            self.assertIn("my hall.obj has no object or group", name["detail"])

    def test_a_misspelt_section_is_one_error(self):
        job = write_job(self.folder / "job", frames=9)
        changed(job, lambda animation: animation.update(fraems=animation.pop("frames")))
        (error,) = self.expect_refused(self.running.submit(job), "a typo")
        self.assertEqual((error["pointer"], error["code"]), ("/fraems", "unknown_field"))
        self.assertIn('did you mean "frames"?', error["detail"])

    def test_a_scene_sent_by_name_instead_of_as_a_file_is_told_so(self):
        job = write_job(self.folder / "job", frames=2)
        answer = curl(self.running.url + "/v1/jobs", "-F", "scene=scene.obj", "-F",
                      f"animation=@{job / 'animation.json'}")
        self.expect_refused(answer, "a value")
        self.assertIn("-F scene=@FILE", answer.json()["detail"])

    def test_json_nested_100000_deep(self):
        for name, text in (("arrays", "[" * 100_000), ("closed arrays", "[" * 100_000 + "]" * 100_000),
                           ("objects", '{"a":' * 100_000)):
            with self.subTest(name):
                job = write_job(self.folder / name, frames=2)
                (job / "animation.json").write_text(text)
                errors = self.expect_refused(self.running.submit(job), name)
                self.assertEqual([error["code"] for error in errors], ["too_deep"])
        self.expect_the_queue_goes_on()

    def test_json_cut_off_anywhere(self):
        job = write_job(self.folder / "cut", frames=2)
        whole = (job / "animation.json").read_bytes()
        for length in (0, 1, len(whole) // 2, len(whole) - 1):
            with self.subTest(length=length):
                (job / "animation.json").write_bytes(whole[:length])
                errors = self.expect_refused(self.running.submit(job), f"{length} bytes")
                self.assertEqual(errors[0]["file"], "animation.json")

    def test_a_request_that_is_no_job_at_all(self):
        url = self.running.url + "/v1/jobs"
        job = write_job(self.folder / "job", frames=2)
        scene, animation = f"scene=@{job / 'scene.obj'}", f"animation=@{job / 'animation.json'}"
        for what, arguments, status, errors in (
                ("no scene", ["-F", animation], 422, [("scene.obj", "missing")]),
                ("no animation", ["-F", scene], 422, [("animation.json", "missing")]),
                ("scene twice", ["-F", scene, "-F", scene, "-F", animation], 422, [("scene.obj", "duplicate_part")]),
                ("an unknown part", ["-F", scene, "-F", animation, "-F", "else=1"], 422, [("else", "unknown_part")]),
                ("JSON that names no files", ["-H", "Content-Type: application/json", "-d", "{}"], 422,
                 [("body", "missing")]),
                ("text instead of parts", ["-H", "Content-Type: text/plain", "-d", "{}"], 415, []),
                ("no body", ["-X", "POST"], 415, [])):
            with self.subTest(what):
                answer = curl(url, *arguments)
                self.assertEqual(answer.status, status, answer.body.decode(errors="replace"))
                self.assertEqual(answer.headers["content-type"], "application/problem+json")
                self.assertEqual([(error["file"], error["code"]) for error in answer.json()["errors"]], errors)
                self.assertEqual(self.files(), [])
        self.expect_the_queue_goes_on()

    def test_an_upload_that_breaks_off_leaves_nothing(self):
        head = ("POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000000\r\n"
                "Content-Type: multipart/form-data; boundary=edge\r\n\r\n"
                '--edge\r\nContent-Disposition: form-data; name="scene"; filename="scene.obj"\r\n\r\nv 0 0 0\n')
        with socket.create_connection(("127.0.0.1", self.running.port), timeout=20) as connection:
            connection.sendall(head.encode())
            connection.shutdown(socket.SHUT_WR)
            connection.recv(65536)
        self.assertEqual(self.files(), [])
        self.expect_the_queue_goes_on()

    def test_file_names_of_parts_do_not_lead_outside(self):
        job = write_job(self.folder / "job", frames=2)
        material = next(job.glob("*.mtl"))
        outside = self.folder / "escaped.mtl"
        answer = curl(self.running.url + "/v1/jobs", "-F", f"scene=@{job / 'scene.obj'}",
                      "-F", f"animation=@{job / 'animation.json'}",
                      "-F", f"materials=@{material};filename=../../../escaped.mtl",
                      "-F", f"materials=@{material};filename={outside}")
        self.assertIn(answer.status, (400, 422), answer.body.decode(errors="replace"))
        self.assertFalse(outside.exists())
        self.assertEqual(list(self.folder.rglob("escaped.mtl")), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
