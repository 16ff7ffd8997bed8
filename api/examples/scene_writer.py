"""Writes what the examples' make_scene.py compute: OBJ and JSON, the same bytes on every machine."""

import json
import math
import pathlib
import sys

DECIMALS = 9  # coarser than what differs between two machines' sine, finer than anything visible


def tidy(value):
    """A number as short as it can be written; without -0."""
    value = round(value, DECIMALS) + 0.0
    return int(value) if value == int(value) else value


class Obj:
    """An OBJ file that grows by polygons."""

    def __init__(self, comment, mtl):
        self.lines = [f"# {comment}", f"mtllib {mtl}"]
        self.vertices = 0

    def object(self, name):
        self.lines += ["", f"o {name}"]

    def material(self, name):
        self.lines.append(f"usemtl {name}")

    def polygon(self, corners, facing):
        """`corners` in either order round; counter-clockwise is chosen as seen against `facing`."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners[:3]
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - bx, cy - by, cz - bz
        normal = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        if sum(n * f for n, f in zip(normal, facing)) < 0:
            corners = corners[::-1]
        self.lines += ["v " + " ".join(str(tidy(x)) for x in corner) for corner in corners]
        self.lines.append("f " + " ".join(str(self.vertices + i + 1) for i in range(len(corners))))
        self.vertices += len(corners)

    def box(self, low, high, inward=False):
        for axis in range(3):
            for side, value in ((-1, low[axis]), (1, high[axis])):
                self.side(low, high, axis, value, -side if inward else side)

    def side(self, low, high, axis, value, facing):
        """The rectangle of a box in which coordinate `axis` is `value`."""
        i, j = [k for k in range(3) if k != axis]
        corners = []
        for a, b in ((low[i], low[j]), (high[i], low[j]), (high[i], high[j]), (low[i], high[j])):
            corner = [0, 0, 0]
            corner[axis], corner[i], corner[j] = value, a, b
            corners.append(tuple(corner))
        normal = [0, 0, 0]
        normal[axis] = facing
        self.polygon(corners, normal)

    def room(self, low, high):
        """A box seen from within, z up: floor, ceiling and walls of the materials of these names."""
        self.object("room")
        self.material("floor")
        self.side(low, high, 2, low[2], 1)
        self.material("ceiling")
        self.side(low, high, 2, high[2], -1)
        self.material("wall")
        for axis in (0, 1):
            self.side(low, high, axis, low[axis], 1)
            self.side(low, high, axis, high[axis], -1)

    def text(self):
        return "\n".join(self.lines) + "\n"


def mtl(reflectance, exitance_w_m2):
    """Materials: {name: reflectance} and, of those that emit, {name: exitance}; both red, green, blue."""
    lines = ["# Kd is the reflectance, Ke the emitted radiance: exitance / pi. Written by make_scene.py."]
    for name, rgb in reflectance.items():
        lines += ["", f"newmtl {name}", "Kd " + " ".join(str(rho) for rho in rgb)]
        if name in exitance_w_m2:
            lines.append("Ke " + " ".join(str(tidy(e / math.pi)) for e in exitance_w_m2[name]))
    return "\n".join(lines) + "\n"


def keys(values, **more):
    """A track with one key per value, or the keys of a {frame: value}."""
    if not isinstance(values, dict):
        values = dict(enumerate(values))
    track = [{"frame": frame, "value": [tidy(x) for x in value]} for frame, value in values.items()]
    return {**more, "keys": track}


def json_text(value, indent=0):
    """Everything that fits on a line on one line."""
    flat = json.dumps(value)
    if len(flat) + indent <= 100 or not isinstance(value, (dict, list)):
        return flat
    pad = " " * (indent + 2)
    if isinstance(value, dict):
        items = [pad + json.dumps(name) + ": " + json_text(item, indent + 2) for name, item in value.items()]
        return "{\n" + ",\n".join(items) + "\n" + " " * indent + "}"
    return "[\n" + ",\n".join(pad + json_text(item, indent + 2) for item in value) + "\n" + " " * indent + "]"


def write(script, files):
    """Writes {name: text} beside `script`, or into the folder given on the command line."""
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(script).parent
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
