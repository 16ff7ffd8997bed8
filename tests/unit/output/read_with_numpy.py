"""read_with_numpy.py WRITE_SAMPLE: what the engine writes is what NumPy, zipfile and json read."""
import hashlib, json, pathlib, subprocess, sys, tempfile, zipfile
import numpy as np


def written_sample(folder):
    subprocess.run([sys.argv[1], str(folder)], check=True)
    return folder


def check_radiosity(folder, patch_count):
    b = np.load(folder / "radiosity.npy", allow_pickle=False)
    assert b.shape == (3, patch_count, 3) and b.dtype == np.dtype("<f4") and b.flags.c_contiguous
    patch, frame = np.arange(patch_count)[None, :], np.arange(3)[:, None]
    assert (b[..., 0] == patch + 1000 * frame).all()
    assert (b[..., 1] == -np.broadcast_to(patch, (3, patch_count))).all() and (b[..., 2] == 0.5).all()


def check_patches(folder):
    assert zipfile.ZipFile(folder / "patches.npz").testzip() is None  # every CRC-32
    p = np.load(folder / "patches.npz", allow_pickle=False)
    assert set(p.files) == {"corners", "normal", "area_m2", "object", "material", "poses", "visible",
                            "object_names", "material_names", "up", "auto_exposure"}, p.files
    assert p["object_names"].tolist() == ["Fußboden", 'wing "left"']
    assert p["material_names"].tolist() == ["concrete", "paint"]
    # 2 m x 1 m in cells of 0.5 m: 8 fronts and 8 backs. Triangle: the longest edge, sqrt(2) m, needs 3 parts.
    count = len(p["area_m2"])
    assert count == 16 + 9 and p["object"].tolist() == [0] * 16 + [1] * 9
    assert (p["material"] == p["object"]).all() and p["object"].dtype == np.dtype("<u4")
    np.testing.assert_allclose(p["area_m2"][:16], 0.25, rtol=1e-6)
    np.testing.assert_allclose(p["area_m2"][16:], 0.5 / 9, rtol=1e-6)
    corners = p["corners"].astype(float)
    assert corners.shape == (count, 4, 3)
    # Half the cross product of the diagonals: area and normal, so the corners turn counter-clockwise.
    vector = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    np.testing.assert_allclose(vector, p["normal"] * p["area_m2"][:, None], atol=1e-6)
    assert (p["normal"][:8, 2] == 1).all() and (p["normal"][8:16, 2] == -1).all()
    assert (corners[16:, 2] == corners[16:, 3]).all()
    assert p["visible"].tolist() == [[1, 1, 1], [1, 0, 1]] and p["visible"].dtype == np.uint8
    assert p["poses"].shape == (2, 3, 3, 4) and p["poses"].dtype == np.dtype("<f8")
    assert p["poses"][1, :, 0, 3].tolist() == [10, 0, 30]
    assert p["up"].tolist() == [0, 0, 1] and p["auto_exposure"].tolist() == [0.25]
    return count


def check_walk(folder):
    assert zipfile.ZipFile(folder / "shading_mesh.npz").testzip() is None
    w, p = np.load(folder / "shading_mesh.npz", allow_pickle=False), np.load(folder / "patches.npz")
    nodes, count = len(w["node_position"]), len(p["area_m2"])
    # 2 m x 1 m in cells of 0.5 m: 5 x 3 points on each side; a triangle of 3 rows: 10 points.
    assert nodes == 2 * 15 + 10 and w["node_position"].dtype == np.dtype("<f4")
    corner = w["patch_nodes"].copy()
    assert corner.shape == (count, 4) and corner.dtype == np.dtype("<u4")
    assert (corner[:16] != 0xffffffff).all() and (corner[16:, 3] == 0xffffffff).all()
    corner[16:, 3] = corner[16:, 2]  # as patches.npz repeats it
    np.testing.assert_allclose(w["node_position"][corner], p["corners"], atol=1e-6)
    first, patch, weight = w["row_first"], w["row_patch"], w["row_weight"]
    assert len(first) == nodes + 1 and first[0] == 0 and first[-1] == len(patch) == len(weight)
    np.testing.assert_allclose(np.add.reduceat(weight, first[:-1]), 1, rtol=1e-6)
    for n in range(nodes):  # equal patches around: their mean
        around = sorted(np.nonzero((w["patch_nodes"] == n).any(axis=1))[0])
        assert sorted(patch[first[n]:first[n + 1]]) == around
    assert (w["patch_object"] == p["object"]).all() and (w["patch_material"] == p["material"]).all()
    assert w["patch_facet"].tolist() == [0] * 16 + [1] * 9
    np.testing.assert_allclose(w["patch_reflectance"][[0, 20]], [[.3, .3, .3], [.6, .1, .1]], rtol=1e-6)
    assert w["object_names"].tolist() == p["object_names"].tolist()
    assert w["poses"].dtype == np.dtype("<f4") and (w["poses"] == p["poses"]).all()
    assert (w["visible"] == p["visible"]).all() and w["material_emits"].tolist() == [0, 1]
    assert w["camera_names"].tolist() == ["above", "side"]
    assert w["camera_position"][1].tolist() == [[0, -4, 1], [1, -4, 1], [2, -4, 1]]
    np.testing.assert_allclose(w["camera_forward"][:, 0], [[0, 0, -1], [0, 1, 0]], atol=1e-6)
    np.testing.assert_allclose(w["camera_up"][:, 2], [[0, 1, 0], [0, 0, 1]], atol=1e-6)
    assert w["camera_vertical_fov_deg"].tolist() == [[40] * 3, [50] * 3]
    assert w["image_size"].tolist() == [[0, 0], [640, 360]]
    assert w["light_names"].tolist() == ["lamp"] and w["light_kind"].tolist() == [1]
    assert w["light_position"].tolist() == [[[1, 2, 3]] * 3] and w["light_direction"].tolist() == [[[0, 0, -1]] * 3]
    assert w["up"].tolist() == [0, 0, 1] and w["fps"].tolist() == [12.5] and w["metres_per_unit"].tolist() == [0.5]
    assert w["auto_exposure"].tolist() == [0.25] and w["half_scale"].tolist() == [2]


def check_manifest(folder):
    artefacts = json.loads((folder / "manifest.json").read_text())["artefacts"]
    assert [a["path"] for a in artefacts] == ["radiosity.npy", "patches.npz"]
    for a in artefacts:
        data = (folder / a["path"]).read_bytes()
        assert a["bytes"] == len(data) and a["sha256"] == hashlib.sha256(data).hexdigest()


with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
    first, second = written_sample(pathlib.Path(one)), written_sample(pathlib.Path(two))
    check_radiosity(first, check_patches(first))
    check_walk(first)
    check_manifest(first)
    names = sorted(f.name for f in first.iterdir())
    assert names == ["manifest.json", "patches.npz", "radiosity.npy", "shading_mesh.npz"], names  # no temporary is left
    for name in names:
        assert (first / name).read_bytes() == (second / name).read_bytes(), name
