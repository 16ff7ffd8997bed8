#!/usr/bin/env python3
"""What a browser walks through: the mesh that pictures are shaded on, radiosity as half floats, and a scene before it is lit."""
import io
import json
import sqlite3
import shutil
import unittest

import numpy

from service import ServiceTestCase
from small_jobs import EXAMPLES, changed, write_job

FRAMES = 6
NO_NODE = 0xffffffff


def load(answer):
    return numpy.load(io.BytesIO(answer.body), allow_pickle=False)


class Walk(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = cls("runTest")
        cls.shared.setUp()
        cls.addClassCleanup(cls.shared.doCleanups)
        cls.job = write_job(cls.shared.folder / "job", frames=FRAMES, light_groups={"first": ["lamp_0_0"]})
        cls.running = cls.shared.service()
        cls.job_id = cls.shared.submitted(cls.running, cls.job)
        cls.running.wait_for(cls.job_id, ["succeeded"], 240)
        cls.whole = cls.fetch("/half/radiosity.npy")
        cls.mesh = load(cls.fetch("/shading_mesh.npz"))
        cls.patches = load(cls.fetch("/patches.npz"))

    def runTest(self):
        pass

    @classmethod
    def fetch(cls, path, *arguments):
        return cls.running.get(f"/v1/jobs/{cls.job_id}{path}", *arguments)

    def expect_problem(self, answer, status, *words):
        self.assertEqual((answer.status, answer.headers["content-type"]), (status, "application/problem+json"), answer.body)
        for word in words:
            self.assertIn(word, answer.json()["detail"])

    def test_half_floats_are_the_radiosity_to_eleven_bits(self):
        scale = self.mesh["half_scale"][0]
        self.assertEqual(numpy.frexp(scale)[0], 0.5, "a power of two")
        for name in ("radiosity", "radiosity_se", "radiosity_first"):
            exact = load(self.fetch(f"/artefacts/{name}.npy")).astype(float)
            answer = self.fetch(f"/half/{name}.npy")
            self.assertEqual((answer.status, answer.headers["content-type"]), (200, "application/x-npy"))
            half = load(answer)
            self.assertEqual((half.dtype, half.shape), (numpy.dtype("<f2"), exact.shape))
            numpy.testing.assert_array_equal(half, (exact / scale).astype(numpy.float16), name)
            # Half of the last of 11 bits; below 2^-14 half of the least half float.
            numpy.testing.assert_allclose(half.astype(float) * scale, exact, rtol=2**-11, atol=2**-25 * scale)
        mean = load(self.fetch("/radiosity.npy")).mean()
        self.assertTrue(1 / 8 < scale / mean < 8, f"{scale} is next to {mean}")

    def test_ranges_are_slices_of_the_whole(self):
        self.assertEqual(self.whole.headers["accept-ranges"], "bytes")
        whole, size = self.whole.body, len(self.whole.body)
        for first, last in ((0, 0), (0, 9), (5, 200), (127, 128), (128, 129), (129, 131), (1001, 1001), (1000, 200_001),
                            (65_537, 300_000), (size - 1, size - 1), (size - 3, size + 100)):
            answer = self.fetch("/half/radiosity.npy", "-H", f"Range: bytes={first}-{last}")
            self.assertEqual(answer.status, 206)
            self.assertEqual(answer.headers["content-range"], f"bytes {first}-{min(last, size - 1)}/{size}")
            self.assertEqual(answer.body, whole[first:last + 1], f"{first}-{last}")
        self.assertEqual(self.fetch("/half/radiosity.npy", "-H", "Range: bytes=-7").body, whole[-7:])
        self.assertEqual(self.fetch("/half/radiosity.npy", "-H", f"Range: bytes={size}-").status, 416)

    def test_the_etag_names_the_bytes(self):
        etag = self.whole.headers["etag"]
        self.assertRegex(etag, r'^"[^"]+"$')
        self.assertEqual(self.fetch("/half/radiosity.npy", "-H", f"If-None-Match: {etag}").status, 304)
        ranged = ("-H", "Range: bytes=3-8", "-H")
        self.assertEqual(self.fetch("/half/radiosity.npy", *ranged, f"If-Range: {etag}").status, 206)
        self.assertEqual(self.fetch("/half/radiosity.npy", *ranged, 'If-Range: "other"').status, 200)
        others = {self.fetch(path, "-I").headers["etag"] for path in ("/radiosity.npy", "/half/radiosity_se.npy")}
        self.assertEqual(len(others | {etag}), 3)
        head = self.fetch("/half/radiosity.npy", "-I")
        self.assertEqual((head.status, int(head.headers["content-length"])), (200, len(self.whole.body)))

    def test_what_is_no_series_is_not_found(self):
        self.expect_problem(self.fetch("/half/radiosity_lamp.npy"), 404, "radiosity, ", "radiosity_first")
        for name in ("key_frames", "patches", "manifest", "..%2Fradiosity", "radiosity_..%2Fse"):
            self.expect_problem(self.fetch(f"/half/{name}.npy"), 404)
        for path in ("/half/radiosity.npz", "/half/.npy", "/half/radiosity"):
            self.assertEqual(self.fetch(path).status, 404, path)

    def test_a_job_that_is_not_done_has_no_half_floats(self):
        running = self.service("paused")
        running.get("/v1/queue/pause", "-X", "POST", "-H", "Content-Type: application/json", "-d", "{}")
        job_id = self.submitted(running, self.job)
        self.expect_problem(running.get(f"/v1/jobs/{job_id}/half/radiosity.npy"), 404, "queued")

    def test_a_job_rendered_before_there_was_a_mesh_says_so(self):
        running = self.service("old")
        job_id = self.submitted(running, write_job(self.folder / "small", frames=1))
        running.wait_for(job_id, ["succeeded"], 240)
        self.assertEqual(running.get(f"/v1/jobs/{job_id}/half/radiosity.npy").status, 200)
        running.stop()
        with sqlite3.connect(next(running.data.glob("*.db"))) as store:
            self.assertEqual(store.execute("DELETE FROM artefact WHERE path = 'shading_mesh.npz'").rowcount, 1)
        store.close()
        running.start()
        self.expect_problem(running.get(f"/v1/jobs/{job_id}/half/radiosity.npy"), 404, "shading_mesh.npz")

    def test_the_mesh_is_that_of_the_patches(self):
        mesh, patches = self.mesh, self.patches
        nodes = mesh["patch_nodes"].copy()
        triangle = nodes[:, 3] == NO_NODE
        nodes[triangle, 3] = nodes[triangle, 2]
        extent = numpy.abs(patches["corners"]).max()
        numpy.testing.assert_allclose(mesh["node_position"][nodes], patches["corners"], atol=4e-6 * extent)
        first, patch, weight = mesh["row_first"], mesh["row_patch"], mesh["row_weight"]
        self.assertTrue((numpy.diff(first.astype(int)) > 0).all() and first[-1] == len(patch) == len(weight))
        self.assertLess(patch.max(), len(patches["area_m2"]))
        sums = numpy.add.reduceat(weight, first[:-1])
        self.assertTrue((sums > 1 - 1e-5).all(), "a mean; more around what stands on a patch")
        self.assertGreater((sums < 1 + 1e-5).mean(), 0.5)
        numpy.testing.assert_array_equal(mesh["poses"], patches["poses"].astype(numpy.float32))
        numpy.testing.assert_array_equal(mesh["visible"], patches["visible"])
        numpy.testing.assert_array_equal(mesh["auto_exposure"], patches["auto_exposure"])
        numpy.testing.assert_array_equal(mesh["up"], patches["up"])

    def test_the_cameras_are_those_of_the_job(self):
        document = json.loads((self.job / "animation.json").read_text())
        self.assertEqual(self.mesh["camera_names"].tolist(), sorted(document["cameras"]))
        self.assertEqual(self.mesh["fps"].tolist(), [document["frames"]["fps"]])
        self.assertEqual(self.mesh["image_size"].tolist(), [[64, 36]])
        forward, up = self.mesh["camera_forward"][0], self.mesh["camera_up"][0]
        self.assertEqual(forward.shape, (FRAMES, 3))
        numpy.testing.assert_allclose(numpy.linalg.norm([forward, up], axis=2), 1, rtol=1e-5)
        numpy.testing.assert_allclose((forward * up).sum(axis=1), 0, atol=1e-5)
        self.assertTrue((up @ self.mesh["up"] > 0).all())

    def preview(self, job):
        return self.running.submit(job, "/v1/preview")

    def expect_nothing_kept(self):
        self.assertEqual(list((self.running.data / "tmp").iterdir()), [])
        self.assertEqual(len(self.running.get("/v1/jobs").json()["jobs"]), 1)

    def test_a_preview_has_the_motion_that_the_job_will_have(self):
        answer = self.preview(self.job)
        self.assertEqual((answer.status, answer.headers["content-type"]), (200, "application/zip"), answer.body[:500])
        preview = load(answer)
        self.assertEqual(set(preview.files), set(self.mesh.files))
        for name in ("object_names", "material_names", "material_emits", "poses", "visible", "up", "fps", "image_size",
                     *(name for name in self.mesh.files if name.startswith(("camera_", "light_")))):
            numpy.testing.assert_array_equal(preview[name], self.mesh[name], name)
        plane = preview["object_names"].tolist().index("plane")
        self.assertEqual(len({pose.tobytes() for pose in preview["poses"][plane]}), FRAMES, "it moves in every frame")
        self.assertEqual((preview["auto_exposure"][0], preview["half_scale"][0]), (1, 1))
        self.assertEqual((len(preview["row_patch"]), len(preview["row_weight"])), (0, 0))
        self.assertTrue((preview["row_first"] == 0).all() and len(preview["row_first"]) == len(preview["node_position"]) + 1)
        # Every flat piece is one patch on each side that the finished job's patches lie on, in the same colour.
        sides = len(preview["patch_nodes"])
        self.assertLess(sides, len(self.mesh["patch_nodes"]))
        self.assertEqual(set(preview["patch_facet"]), set(self.mesh["patch_facet"]))
        for name in ("patch_object", "patch_material", "patch_reflectance"):
            by_facet = dict(zip(self.mesh["patch_facet"].tolist(), self.mesh[name].tolist()))
            self.assertEqual(preview[name].tolist(), [by_facet[facet] for facet in preview["patch_facet"].tolist()])
        for box in (numpy.min, numpy.max):
            numpy.testing.assert_allclose(box(preview["node_position"], axis=0), box(self.mesh["node_position"], axis=0), rtol=1e-5)
        self.expect_nothing_kept()

    def test_a_preview_of_the_whole_garage_is_small(self):
        answer = self.preview(write_job(self.folder / "garage", frames=120))
        self.assertEqual(answer.status, 200)
        self.assertEqual(load(answer)["poses"].shape[1:], (120, 3, 4))
        self.assertLess(len(answer.body), 1_000_000)
        self.expect_nothing_kept()

    def test_lights_without_a_surface_are_shown(self):
        job = write_job(self.folder / "lit", frames=3)
        moving = {"keys": [{"frame": 0, "value": [0, 0, 2]}, {"frame": 2, "value": [2, 0, 2]}]}
        changed(job, lambda document: document.update(lights={
            "bulb": {"type": "point", "position": moving, "intensity_w_sr": [1, 1, 1]},
            "sun": {"type": "directional", "direction": [0, 0, -2], "irradiance_w_m2": [1, 1, 1]}}))
        answer = self.preview(job)
        self.assertEqual(answer.status, 200, answer.body)
        preview = load(answer)
        self.assertEqual((preview["light_names"].tolist(), preview["light_kind"].tolist()), (["bulb", "sun"], [0, 2]))
        numpy.testing.assert_allclose(preview["light_position"][0][:, 0], [0, 1, 2])
        self.assertEqual(preview["light_position"][1].tolist(), [[0, 0, 0]] * 3)
        self.assertEqual(preview["light_direction"][1].tolist(), [[0, 0, -1]] * 3)

    def test_a_wrong_job_is_refused_as_by_validate(self):
        job = self.folder / "wrong"
        shutil.copytree(EXAMPLES / "rejected/obj_index_out_of_range", job)
        here, there = self.preview(job), self.running.submit(job, "/v1/validate")
        self.assertEqual((here.status, there.status), (422, 422))
        self.assertEqual(here.json()["errors"], there.json()["errors"])
        self.expect_problem(self.running.get("/v1/preview", "-X", "POST", "-d", "{}"), 415)
        self.assertEqual(self.running.get("/v1/preview").status, 405)
        self.expect_nothing_kept()

    def test_what_is_too_large_to_be_shown_is_refused(self):
        job = write_job(self.folder / "large", frames=1, patch_edge_m=100)
        square = "".join(f"f {k} {k + 1} {k + 2}\n" for k in range(1, 4)) * 170_000
        points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv 0 0 1\n"
        (job / "scene.obj").write_text(points + square)
        changed(job, lambda document: document.update(
            objects={}, materials={}, lights={"lamp": {"type": "point", "position": [0, 0, 2], "intensity_w_sr": [1, 1, 1]}}))
        answer = self.preview(job)
        self.expect_problem(answer, 422)
        self.assertEqual([error["code"] for error in answer.json()["errors"]], ["limit_exceeded"], answer.body)
        self.expect_nothing_kept()


if __name__ == "__main__":
    unittest.main()
