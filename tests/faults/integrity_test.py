#!/usr/bin/env python3
"""A file changes on the disk: the check that runs by itself finds it, log, metrics and /readyz tell of it, and nobody
is given wrong bytes."""
import hashlib
import io
import json
import shutil
import subprocess
import tarfile
import unittest

from curl import curl
from service import SERVER, Service, ServiceTestCase, wait_until
from small_jobs import write_job

JOB = {"frames": 2, "line_count": 20_000, "moving_line_count": 10_000, "patch_edge_m": 1.5, "samples_per_light": 1}


class ServiceThatLooksOften(Service):
    def command(self):
        return [*super().command(), "--check-seconds", "1", "--log", "json"]


class Integrity(ServiceTestCase):
    def metric(self, service, name):
        for line in service.get("/metrics").body.decode().splitlines():
            if line.startswith(f"keylume_integrity_{name} "):
                return float(line.split()[1])
        self.fail(f"no metric {name}")

    def rounds(self, service):
        """Waits until every file has been looked at once more."""
        since = self.metric(service, "round_timestamp_seconds")
        wait_until(lambda: self.metric(service, "round_timestamp_seconds") > since, 30, "every file is looked at")

    def running(self):
        service = ServiceThatLooksOften(self.folder / "data")
        self.addCleanup(service.clean_up)
        service.start()
        job_id = self.submitted(service, write_job(self.folder / "job", **JOB))
        service.wait_for(job_id, ["succeeded"], 60)
        return service, job_id

    def change(self, service, job_id, path):
        """One bit of a file, as a disk does. -> what it was"""
        file = service.job_folder(job_id) / "artefacts" / path
        before = file.read_bytes()
        file.chmod(0o600)
        file.write_bytes(before[:-1] + bytes([before[-1] ^ 1]))
        return file, before

    def expect_damaged(self, answer, path):
        self.assertEqual(answer.status, 500, answer.body[:200])
        self.assertEqual(answer.headers["content-type"], "application/problem+json")
        problem = answer.json()
        self.assertIn("damaged on the disk", problem["detail"])
        self.assertEqual((problem["errors"][0]["code"], problem["errors"][0]["file"]), ("damaged_file", path))

    def test_a_damaged_file_is_told_of_and_not_given_out(self):
        service, job_id = self.running()
        self.rounds(service)
        self.assertEqual(self.metric(service, "damaged_files"), 0)
        self.assertGreater(self.metric(service, "checked_files_total"), 3)
        self.assertEqual(service.get("/readyz").json()["checks"]["integrity"], "ok")
        file, before = self.change(service, job_id, "radiosity.npy")
        wait_until(lambda: self.metric(service, "damaged_files") == 1, 30, "it is found")

        lines = [json.loads(line) for line in service.log.read_text().splitlines() if line.startswith("{")]
        self.assertTrue(any(job_id in line["message"] and "radiosity.npy" in line["message"] and
                            "integrity check" in line["message"] for line in lines))
        ready = service.get("/readyz")
        self.assertEqual(ready.status, 200, "others can still be rendered")
        self.assertIn("1 files of jobs are damaged", ready.json()["checks"]["integrity"])
        for path in ("radiosity.npy", "frames/1/radiosity.npy", "frames/1/radiosity", "radiosity.npz",
                     "frames/1/patches.glb", "results.tar", "artefacts/radiosity.npy"):
            answer = curl(f"{service.url}/v1/jobs/{job_id}/{path}", checked=False)  # no other test expects a 500
            if answer.status != 404:  # no such route
                self.expect_damaged(answer, "radiosity.npy")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/patches.npz").status, 200, "the others are as they were")
        view = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0], "width": 64, "height": 36}
        asked = service.get(f"/v1/jobs/{job_id}/views", "-H", "Content-Type: application/json", "--data-binary",
                            json.dumps(view))

        def failed():
            now = service.get(asked.headers["location"]).json()
            return now if now["state"] == "failed" else None
        made = wait_until(failed, 30, "no picture is made of it")
        self.assertIn("damaged", json.dumps(made))

        service.stop()
        service.start()  # known across restarts
        self.expect_damaged(curl(f"{service.url}/v1/jobs/{job_id}/radiosity.npy", checked=False), "radiosity.npy")
        file.write_bytes(before)  # from a backup
        wait_until(lambda: self.metric(service, "damaged_files") == 0, 30, "it is whole again")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/radiosity.npy").body, before)

    def flip(self, file):
        before = file.read_bytes()
        file.chmod(0o600)
        file.write_bytes(before[:-2] + bytes([before[-2] ^ 1]) + before[-1:])
        return before

    def test_a_damaged_input_is_told_of_and_nobody_vouches_for_it(self):
        service, job_id = self.running()
        sums = self.sums_of(service, job_id)
        self.rounds(service)
        scene = service.job_folder(job_id) / "input/scene.obj"
        before = self.flip(scene)
        self.assertEqual(self.sums_of(service, job_id), sums, "as it came in, not as it is")
        wait_until(lambda: self.metric(service, "damaged_files") == 1, 30, "it is found")
        self.expect_damaged(curl(f"{service.url}/v1/jobs/{job_id}/results.tar", checked=False), "input/scene.obj")
        self.assertEqual(service.get(f"/v1/jobs/{job_id}/radiosity.npy", "-I").status, 200, "that is whole")
        service.stop()
        checked = subprocess.run([SERVER, "check", "--data", str(service.data)], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 1, checked.stdout)
        self.assertIn(f"{job_id}: input 'scene.obj' has another SHA-256", checked.stdout)
        scene.write_bytes(before)
        checked = subprocess.run([SERVER, "check", "--data", str(service.data)], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout)

    def sums_of(self, service, job_id):
        answer = service.get(f"/v1/jobs/{job_id}/results.tar")
        if answer.status != 200:
            return None
        with tarfile.open(fileobj=io.BytesIO(answer.body)) as tar:
            return tar.extractfile(f"{job_id}/SHA256SUMS").read()

    def test_nothing_is_made_from_a_damaged_input(self):
        service = self.service()
        service.get("/v1/queue/pause", "-X", "POST")
        job_id = self.submitted(service, write_job(self.folder / "job", **JOB))
        self.flip(service.job_folder(job_id) / "input/scene.obj")
        service.get("/v1/queue/resume", "-X", "POST")
        job = service.wait_for(job_id, ["failed"], 30)
        self.assertTrue(job["reason"].startswith("input_damaged"), job["reason"])
        self.assertIn("scene.obj", job["reason"])

    def test_a_damaged_blob_makes_no_job_and_can_be_sent_again(self):
        service = self.service()
        files = []
        for path in sorted(write_job(self.folder / "job", **JOB).iterdir()):
            sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
            self.assertEqual(service.get(f"/v1/blobs/sha256/{sha256}", "-T", str(path)).status, 201)
            field = {".obj": "scene", ".mtl": "materials", ".json": "animation"}[path.suffix]
            files.append((path, {"field": field, "name": path.name, "sha256": sha256}))
        path, scene = next(each for each in files if each[1]["field"] == "scene")
        self.flip(service.data / "blobs" / scene["sha256"][:2] / scene["sha256"])
        body = json.dumps({"files": [file for _, file in files]})
        post = ("-H", "Content-Type: application/json", "--data-binary", body)
        refused = service.get("/v1/jobs", *post)
        self.assertEqual((refused.status, refused.json()["errors"][0]["code"]), (422, "unknown_blob"))
        self.assertEqual(service.get(f"/v1/blobs/sha256/{scene['sha256']}", "-T", str(path)).status, 201)
        self.assertEqual(service.get("/v1/jobs", *post).status, 202)

    def view_of(self, service, job_id):
        """Has a view made. -> its address, its folder, the body of its picture"""
        view = {"camera": {"position": [1, 1, 1.5], "target": [3, 3, 1]}, "frames": [0], "width": 64, "height": 36}
        address = service.get(f"/v1/jobs/{job_id}/views", "-H", "Content-Type: application/json", "--data-binary",
                              json.dumps(view)).json()["links"]["self"]
        wait_until(lambda: service.get(address).json()["state"] == "ready", 60, "the view is made")
        return address, service.job_folder(job_id) / "views" / address.split("/")[-1], self.picture_of(service, address)

    def picture_of(self, service, address):
        answer = service.get(service.get(address).json()["files"][0]["href"])
        self.assertEqual(answer.status, 200)
        return answer.body

    def logged(self, service, *parts):
        lines = [json.loads(line)["message"] for line in service.log.read_text().splitlines() if line.startswith("{")]
        return sum(all(part in line for part in ("integrity check", *parts)) for line in lines)

    def test_a_damaged_view_is_made_again(self):
        service, job_id = self.running()
        address, folder, picture = self.view_of(service, job_id)
        png = next(folder.rglob("*.png"))
        self.rounds(service)
        self.rounds(service)
        backup = [SERVER, "backup", str(self.folder / "backup"), "--data", str(service.data)]
        subprocess.run(backup, check=True, capture_output=True, timeout=60)  # gives its files a second name
        self.rounds(service)
        self.rounds(service)
        self.assertEqual(self.logged(service, folder.name), 0, "nothing was wrong with it")
        checked = subprocess.run([SERVER, "check", "--data", str(service.data)], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        damages = {"changed": lambda: self.flip(png), "removed": png.unlink,
                   "manifest changed": lambda: self.flip(folder / "manifest.json"),
                   "hashes changed": lambda: self.flip_at(folder.with_name(folder.name + ".hashes"), 20),
                   "another picture": lambda: self.replace_consistently(folder, png)}
        for number, (what, damage) in enumerate(damages.items()):
            with self.subTest(what=what):
                damage()
                wait_until(lambda: self.logged(service, folder.name, "made again") == number + 1, 30, "it is told of")
                wait_until(lambda: service.get(address).json().get("state") == "ready", 60, "it is made again")
                self.assertEqual(self.picture_of(service, address), picture)
        self.assertEqual(self.metric(service, "damaged_files"), 0, "the job itself is whole")
        self.assertEqual(sorted(path.name for path in folder.parent.iterdir()),
                         [folder.name, folder.name + ".hashes", folder.name + ".json"])

    def flip_at(self, file, position):
        text = bytearray(file.read_bytes())
        text[position] = ord("0") if text[position] != ord("0") else ord("1")
        file.write_bytes(text)

    def replace_consistently(self, folder, png):
        """As somebody does who knows of the manifest, but not of the hashes that were kept."""
        before = hashlib.sha256(png.read_bytes()).hexdigest()
        self.flip(png)
        manifest = folder / "manifest.json"
        manifest.write_text(manifest.read_text().replace(before, hashlib.sha256(png.read_bytes()).hexdigest()))

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg here")
    def test_a_damaged_video_is_made_again_when_it_is_asked_for(self):
        service, job_id = self.running()
        path = f"/v1/jobs/{job_id}/video.mp4"

        def video():
            answer = service.get(path)
            return answer.body if answer.status == 200 else None
        before = wait_until(video, 60, "the video is made")
        mp4 = next((service.job_folder(job_id) / "videos").glob("*.mp4"))
        self.flip(mp4)
        wait_until(lambda: self.logged(service, mp4.name, "asked for") == 1, 30, "it is told of")
        self.assertEqual(list(mp4.parent.iterdir()), [])
        self.assertEqual(wait_until(video, 60, "it is made again"), before)
        mp4.unlink()
        self.assertEqual(wait_until(video, 60, "one that is gone, too"), before)

    def test_a_picture_that_is_gone_is_damage_too(self):
        service, job_id = self.running()
        frame = service.get(f"/v1/jobs/{job_id}/frames/0").json()["images"][0]
        path = next(iter(sorted((service.job_folder(job_id) / "artefacts/images").rglob("0000.png"))))
        path.unlink()
        wait_until(lambda: self.metric(service, "damaged_files") == 1, 30, "it is found")
        self.expect_damaged(curl(service.url + frame["png"], checked=False),
                            str(path.relative_to(service.job_folder(job_id) / "artefacts")))
        self.assertEqual(service.get(f"/v1/jobs/{job_id}", "-X", "DELETE").status, 204)
        wait_until(lambda: self.metric(service, "damaged_files") == 0, 30, "what is removed is not damaged")


if __name__ == "__main__":
    unittest.main(verbosity=2)
