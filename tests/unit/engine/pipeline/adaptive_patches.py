"""adaptive_patches.py KEYLUME: an adaptive job's files as NumPy reads them, and the same bytes with any threads."""
import collections
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

OBJ = """\
mtllib scene.mtl
o floor
usemtl floor
v 0 0 0
v 4 0 0
v 4 4 0
v 0 4 0
f 1 2 3 4
o panel
usemtl panel
v 4 0 0
v 4 2 0
v 4 1.1 0.7
v 4 2 2
v 4 0 2
f 5 6 7 8 9
o card
usemtl card
v 1.51 1.53 1
v 2.03 1.53 1
v 2.03 2.05 1
v 1.51 2.05 1
f 10 11 12 13
o lamp
usemtl lamp
v 1.9 1.9 3
v 1.9 2.1 3
v 2.1 2.1 3
v 2.1 1.9 3
f 14 15 16 17
"""
MTL = """\
newmtl floor
Kd 0.5 0.5 0.5
newmtl panel
Kd 0.8 0.7 0.6
newmtl card
Kd 0.3 0.3 0.3
newmtl lamp
Kd 0 0 0
Ke 200 200 180
"""
# The panel has a corner that points inwards: 2 x 2 less the triangle (2, 0), (2, 2), (1.1, 0.7).
AREAS_M2 = {"floor": 16, "panel": 4 - 0.5 * 2 * 0.9, "card": 0.52 ** 2, "lamp": 0.04}
FRAMES, PATCHES_MAX, PATCH_EDGE_M = 3, 2000, 0.2
JOB = {
    "frames": {"count": FRAMES},
    "up": "z",
    "objects": {"card": {"translate": {"keys": [{"frame": 0, "value": [0, 0, 0]},
                                                {"frame": FRAMES - 1, "value": [0.6, 0.2, 0]}]}}},
    "materials": {"lamp": {"sides": "front"}},
    "lighting": {"preset": "draft", "patch_layout": "adaptive", "patch_count_max": PATCHES_MAX,
                 "patch_edge_m": PATCH_EDGE_M, "line_count": 5000, "estimate_line_count": 5000},
}


def rendered(folder, threads):
    (folder / "input").mkdir(parents=True)
    for name, text in (("scene.obj", OBJ), ("scene.mtl", MTL), ("animation.json", json.dumps(JOB))):
        (folder / "input" / name).write_text(text)
    subprocess.run([sys.argv[1], "render", folder, "--threads", str(threads)], check=True, stdin=subprocess.DEVNULL,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return {path.name: path.read_bytes() for path in (folder / "artefacts").iterdir() if path.is_file()}


def of_material(p, name):
    return p["material"] == p["material_names"].tolist().index(name)


def check_areas(p):
    # Half the cross product of the diagonals is area and normal, of three corners (the last twice) or four.
    corners = p["corners"].astype(float)
    vector = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    np.testing.assert_allclose(vector, p["normal"] * p["area_m2"][:, None], atol=2e-6)
    for name, area_m2 in AREAS_M2.items():
        of_name = of_material(p, name)
        sides = collections.Counter()
        for normal, area in zip(p["normal"][of_name].round().tolist(), p["area_m2"][of_name].tolist()):
            sides[tuple(normal)] += area
        assert len(sides) == (1 if name == "lamp" else 2), (name, sides)
        for side in sides.values():
            np.testing.assert_allclose(side, area_m2, rtol=1e-5, err_msg=name)


def floor_cells(p):
    """Lowest and highest (x, y) of the cells of the floor's upper side, a square each."""
    of_floor = of_material(p, "floor") & (p["normal"][:, 2] > 0)
    corners = p["corners"][of_floor].astype(float)[:, :, :2]
    assert (p["corners"][of_floor][:, :, 2] == 0).all()
    low, high = corners.min(axis=1), corners.max(axis=1)
    for cell, a, b in zip(corners, low, high):
        assert {tuple(c) for c in cell} == {(a[0], a[1]), (b[0], a[1]), (b[0], b[1]), (a[0], b[1])}
    np.testing.assert_allclose((high - low)[:, 0], (high - low)[:, 1], rtol=1e-5)
    return low, high


def check_layout(low, high):
    """Of several sizes, each half of the next; every point is in one cell; neighbours are twice as long at most."""
    edges = (high - low)[:, 0]
    halvings = np.log2(edges.max() / edges)
    np.testing.assert_allclose(halvings, halvings.round(), atol=1e-3)
    assert len(set(halvings.round())) >= 3, "hardly adaptive"
    points = np.random.default_rng(1).uniform(0, 4, (4000, 2))
    inside = ((points[:, None] >= low) & (points[:, None] < high)).all(axis=2).sum(axis=1)
    assert (inside == 1).all(), np.bincount(inside)
    near = 1e-4
    for k in range(len(edges)):
        touches = ((low[k] - near < high) & (high[k] + near > low)).all(axis=1)
        by_corner = ((np.abs(low[k] - high) < near) | (np.abs(high[k] - low) < near)).all(axis=1)
        assert edges[touches & ~by_corner].max() < 2.01 * edges[k], (low[k], edges[k])


def check(artefacts, folder):
    p = np.load(folder / "artefacts/patches.npz", allow_pickle=False)
    count = len(p["area_m2"])
    assert p["corners"].shape == (count, 4, 3) and 500 < count <= PATCHES_MAX, count
    radiosity = np.load(folder / "artefacts/radiosity.npy", allow_pickle=False)
    assert radiosity.shape == (FRAMES, count, 3) and np.isfinite(radiosity).all() and (radiosity >= 0).all()
    check_areas(p)
    check_layout(*floor_cells(p))
    assert {"patches.npz", "radiosity.npy", "radiosity_se.npy", "key_frames.json", "manifest.json"} <= set(artefacts)


with tempfile.TemporaryDirectory() as name:
    base = pathlib.Path(name)
    one = rendered(base / "1", 1)
    check(one, base / "1")
    for threads in (2, 7):
        other = rendered(base / str(threads), threads)
        assert other.keys() == one.keys()
        for file in one:
            assert other[file] == one[file], f"{file} differs with {threads} threads"
