#!/usr/bin/env python3
"""The forms in which a finished job gives out what it made: text, archives, glTF."""
import base64
import csv
import hashlib
import io
import json
import re
import struct
import subprocess
import tarfile
import unittest
import zipfile

import numpy

from service import WORKER, ServiceTestCase
from small_jobs import changed, write_job

FRAMES = 6


def middle_grey_curve(x):
    """The tone curve `clip`: exposed light, no more than 1."""
    return numpy.clip(x, 0, 1)


def read_glb(data):
    """A reader of our own -> (document, function of an accessor's index that gives its array)."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data)), (magic, version, length, len(data))
    json_length, json_type = struct.unpack_from("<I4s", data, 12)
    assert json_type == b"JSON" and json_length % 4 == 0
    document = json.loads(data[20:20 + json_length])
    binary_length, binary_type = struct.unpack_from("<I4s", data, 20 + json_length)
    begin = 28 + json_length
    assert binary_type == b"BIN\0" and begin + binary_length == len(data) and binary_length % 4 == 0
    assert document["buffers"] == [{"byteLength": binary_length}]

    def array(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        dtype = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        count = accessor["count"] * width
        assert view["byteOffset"] % 4 == 0 and view["byteLength"] == count * numpy.dtype(dtype).itemsize
        return numpy.frombuffer(data, dtype, count, begin + view["byteOffset"]).reshape(-1, width)
    return document, array


class Results(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = cls("runTest")
        cls.shared.setUp()
        cls.addClassCleanup(cls.shared.doCleanups)
        job = write_job(cls.shared.folder / "job", frames=FRAMES)
        changed(job, lambda document: document.update(name='Garage "5"/..\\ü'))
        cls.running = cls.shared.service()
        cls.job_id = cls.shared.submitted(cls.running, job)
        cls.running.wait_for(cls.job_id, ["succeeded"], 240)
        cls.radiosity = numpy.load(io.BytesIO(cls.fetch("/radiosity.npy").body))
        cls.errors = numpy.load(io.BytesIO(cls.fetch("/artefacts/radiosity_se.npy").body))
        cls.patches = numpy.load(io.BytesIO(cls.fetch("/patches.npz").body))

    def runTest(self):
        pass

    @classmethod
    def fetch(cls, path, *arguments):
        return cls.running.get(f"/v1/jobs/{cls.job_id}{path}", *arguments)

    def test_a_frame_as_json_is_the_same_numbers(self):
        answer = self.fetch("/frames/2/radiosity.json")
        self.assertEqual((answer.status, answer.headers["content-type"]), (200, "application/json"))
        frame = answer.json()
        self.assertEqual((frame["frame"], frame["unit"], frame["patch_count"]), (2, "W/m2", self.radiosity.shape[1]))
        numpy.testing.assert_array_equal(numpy.array(frame["radiosity"], numpy.float32), self.radiosity[2])
        numpy.testing.assert_array_equal(numpy.array(frame["standard_error"], numpy.float32), self.errors[2])
        self.assertEqual(self.fetch("/frames/2/radiosity.json", "-H", f"If-None-Match: {answer.headers['etag']}").status, 304)

    def test_a_frame_as_csv_is_the_same_numbers(self):
        answer = self.fetch("/frames/1/radiosity.csv")
        self.assertTrue(answer.headers["content-type"].startswith("text/csv"))
        rows = list(csv.reader(io.StringIO(answer.body.decode())))
        self.assertEqual(rows[0], ["patch", "r", "g", "b", "r_se", "g_se", "b_se"])
        values = numpy.array(rows[1:], dtype=numpy.float64).astype(numpy.float32)
        numpy.testing.assert_array_equal(values[:, 0], numpy.arange(self.radiosity.shape[1]))
        numpy.testing.assert_array_equal(values[:, 1:4], self.radiosity[1])
        numpy.testing.assert_array_equal(values[:, 4:], self.errors[1])

    def test_a_patch_over_time(self):
        patch = self.radiosity.shape[1] - 1
        series = self.fetch(f"/patches/{patch}/series.json").json()
        self.assertEqual(series["patch"], patch)
        numpy.testing.assert_array_equal(numpy.array(series["radiosity"], numpy.float32), self.radiosity[:, patch])
        numpy.testing.assert_array_equal(numpy.array(series["standard_error"], numpy.float32), self.errors[:, patch])
        rows = list(csv.reader(io.StringIO(self.fetch(f"/patches/{patch}/series.csv").body.decode())))
        self.assertEqual(rows[0][0], "frame")
        numpy.testing.assert_array_equal(numpy.array(rows[1:], float).astype(numpy.float32)[:, 1:4],
                                         self.radiosity[:, patch])
        for wrong in (patch + 1, -1, "x", "1e1", 2 ** 70):
            self.assertEqual(self.fetch(f"/patches/{wrong}/series.json").status, 404, wrong)

    def post_series(self, document):
        return self.fetch("/patches/series", "-H", "Content-Type: application/json", "--data-binary", json.dumps(document))

    def test_many_patches_over_time_in_one_request(self):
        wanted = [5, 0, self.radiosity.shape[1] - 1, 5]
        answer = self.post_series({"patches": wanted})
        self.assertEqual(answer.status, 200, answer.body)
        series = answer.json()["series"]
        self.assertEqual([entry["patch"] for entry in series], wanted)
        for entry in series:
            numpy.testing.assert_array_equal(numpy.array(entry["radiosity"], numpy.float32),
                                             self.radiosity[:, entry["patch"]])
        rows = list(csv.reader(io.StringIO(self.post_series({"patches": wanted, "format": "csv"}).body.decode())))
        self.assertEqual(rows[0][:3], ["patch", "frame", "r"])
        self.assertEqual(len(rows), 1 + len(wanted) * FRAMES)
        many = self.post_series({"patches": list(range(1000))})
        self.assertEqual(len(many.json()["series"]), 1000)

    def test_wrong_series_requests_name_every_place(self):
        for document, pointers in (({}, ["/patches"]), ({"patches": []}, ["/patches"]),
                                   ({"patches": list(range(1001))}, ["/patches"]),
                                   ({"patches": [0, -1, 1.5, self.radiosity.shape[1]], "format": "xml", "x": 1},
                                    ["/x", "/patches/1", "/patches/2", "/patches/3", "/format"])):
            answer = self.post_series(document)
            self.assertEqual(answer.status, 422, answer.body)
            self.assertEqual(sorted(error["pointer"] for error in answer.json()["errors"]), sorted(pointers))

    def test_radiosity_npz_is_an_archive_that_numpy_and_zipfile_read(self):
        answer = self.fetch("/radiosity.npz")
        self.assertEqual(int(answer.headers["content-length"]), len(answer.body))
        self.assertIsNone(zipfile.ZipFile(io.BytesIO(answer.body)).testzip())
        arrays = numpy.load(io.BytesIO(answer.body))
        self.assertEqual(sorted(arrays.files), ["radiosity", "radiosity_se"])
        numpy.testing.assert_array_equal(arrays["radiosity"], self.radiosity)
        numpy.testing.assert_array_equal(arrays["radiosity_se"], self.errors)
        size = len(answer.body)
        for first, last in ((size - 300, size - 1), (0, 99), (size // 2, size // 2 + 5000), (size - 30, size - 10)):
            part = self.fetch("/radiosity.npz", "-H", f"Range: bytes={first}-{last}")
            self.assertEqual((part.status, part.body), (206, answer.body[first:last + 1]), (first, last))

    def test_results_tar_verifies_itself_and_renders_again_to_the_same_bytes(self):
        answer = self.fetch("/results.tar")
        self.assertEqual(int(answer.headers["content-length"]), len(answer.body))
        self.assertEqual(answer.body, self.fetch("/results.tar").body, "the same bytes each time")
        with tarfile.open(fileobj=io.BytesIO(answer.body)) as archive:
            for member in archive.getmembers():
                self.assertTrue(member.isreg() and member.name.startswith(self.job_id + "/"), member.name)
                self.assertNotIn("..", member.name.split("/"))
            archive.extractall(self.folder)
        top = self.folder / self.job_id
        check = subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=top, capture_output=True, text=True)
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)
        listed = {line.split("  ", 1)[1] for line in (top / "SHA256SUMS").read_text().splitlines()}
        on_disk = {str(path.relative_to(top)) for path in top.rglob("*") if path.is_file()}
        self.assertEqual(listed, on_disk - {"SHA256SUMS"})
        reproduce = json.loads((top / "reproduce.json").read_text())
        self.assertEqual(reproduce["seed"], 1)
        self.assertEqual(reproduce["lighting"]["preset"], "draft")
        self.assertEqual({entry["path"] for entry in reproduce["inputs"]},
                         {path.name for path in (top / "input").iterdir()})
        again = self.folder / "again"
        again.mkdir()
        (top / "input").rename(again / "input")
        subprocess.run([WORKER, "render", str(again)], check=True, capture_output=True, timeout=200)
        for entry in reproduce["artefacts"]:
            data = (again / "artefacts" / entry["path"]).read_bytes()
            self.assertEqual(hashlib.sha256(data).hexdigest(), entry["sha256"], entry["path"])

    def test_ranges_of_an_archive_are_parts_of_the_whole(self):
        whole = self.fetch("/results.tar").body
        for first, last in ((0, 511), (300, 700), (1000, 200_000), (len(whole) - 1500, len(whole) - 1)):
            part = self.fetch("/results.tar", "-H", f"Range: bytes={first}-{last}")
            self.assertEqual((part.status, part.body), (206, whole[first:last + 1]), (first, last))

    def test_a_frame_as_gltf_has_the_geometry_and_colours_of_that_frame(self):
        frame = 3
        answer = self.fetch(f"/frames/{frame}/patches.glb?exposure=1.5&tone_map=clip")
        self.assertEqual((answer.status, answer.headers["content-type"]), (200, "model/gltf-binary"), answer.body[:300])
        document, array = read_glb(answer.body)
        primitive = document["meshes"][0]["primitives"][0]
        self.assertEqual(document["extensionsUsed"], ["KHR_materials_unlit"])
        self.assertEqual(document["materials"][primitive["material"]]["extensions"], {"KHR_materials_unlit": {}})
        attributes = primitive["attributes"]
        p = self.patches
        seen = p["visible"][p["object"], frame] == 1
        pose = p["poses"][p["object"], frame]
        world = numpy.einsum("pij,pcj->pci", pose[:, :, :3], p["corners"].astype(float)) + pose[:, None, :, 3]
        self.assertEqual(p["up"].tolist(), [0, 0, 1], "the garage has z up")
        y_up = numpy.stack([world[..., 0], world[..., 2], -world[..., 1]], axis=-1)[seen]
        positions = array(attributes["POSITION"])
        numpy.testing.assert_allclose(positions.reshape(-1, 4, 3), y_up, atol=1e-5)
        accessor = document["accessors"][attributes["POSITION"]]
        numpy.testing.assert_array_equal(numpy.float32(accessor["min"]), positions.min(axis=0))
        numpy.testing.assert_array_equal(numpy.float32(accessor["max"]), positions.max(axis=0))
        true_values = array(attributes["_RADIOSITY"]).reshape(-1, 4, 3)
        for corner in range(4):
            numpy.testing.assert_array_equal(true_values[:, corner], self.radiosity[frame][seen])
        colours = array(attributes["COLOR_0"]).reshape(-1, 4, 4) / 65535
        expected = middle_grey_curve(2 ** 1.5 * self.radiosity[frame][seen].astype(float) / numpy.pi)
        numpy.testing.assert_allclose(colours[:, 2, :3], expected, atol=1 / 65535)
        self.assertTrue((colours[..., 3] == 1).all())
        indices = array(primitive["indices"]).reshape(-1, 6)
        numpy.testing.assert_array_equal(indices, 4 * numpy.arange(len(indices))[:, None] + [0, 1, 2, 0, 2, 3])

    def test_gltf_ranges_and_exposure(self):
        whole = self.fetch("/frames/0/patches.glb")
        document, array = read_glb(whole.body)
        self.assertAlmostEqual(document["extras"]["exposure_factor"], float(self.patches["auto_exposure"][0]), 5)
        for first, last in ((0, 50), (701, 5003), (len(whole.body) // 3, len(whole.body) // 3 + 100_000),
                            (len(whole.body) - 17, len(whole.body) - 1)):
            part = self.fetch("/frames/0/patches.glb", "-H", f"Range: bytes={first}-{last}")
            self.assertEqual(part.body, whole.body[first:last + 1])
        self.assertNotEqual(self.fetch("/frames/0/patches.glb?exposure=-2").headers["etag"], whole.headers["etag"])
        for query in ("exposure=bright", "exposure=33", "exposure=nan", "tone_map=Filmic"):
            answer = self.fetch(f"/frames/0/patches.glb?{query}")
            self.assertEqual((answer.status, answer.json()["errors"][0]["file"]), (400, query.split("=")[0]))
        self.assertEqual(self.fetch(f"/frames/{FRAMES}/patches.glb").status, 404)

    def test_files_have_a_digest_and_a_name_that_is_safe(self):
        for path in ("/radiosity.npy", "/frames/0/image.png", "/manifest.json"):
            answer = self.fetch(path)
            digest = base64.b64encode(hashlib.sha256(answer.body).digest()).decode()
            self.assertEqual(answer.headers["repr-digest"], f"sha-256=:{digest}:")
            part = self.fetch(path, "-H", "Range: bytes=0-9")
            self.assertEqual((part.status, part.headers["repr-digest"]), (206, f"sha-256=:{digest}:"), "of the whole")
        for path in ("/radiosity.npy", "/frames/0/image.png", "/frames/1/radiosity.csv", "/results.tar",
                     "/frames/0/patches.glb", "/frames/1/radiosity.npy", "/radiosity.npz"):
            named = self.fetch(path, "-I").headers["content-disposition"]
            self.assertRegex(named, r'^(inline|attachment); filename="Garage-5-[A-Za-z0-9._-]+"$', path)
            self.assertNotIn("..", re.sub(r".*filename", "", named))


if __name__ == "__main__":
    unittest.main()
