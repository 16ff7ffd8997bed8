#!/usr/bin/env python3
"""The room: one square ceiling lamp, a red and a green cube, and the model plane that circles above them.

After figures 3 and 4 of Besuievsky and Pueyo, "A Monte Carlo Method for Accelerating the Computation of Animated
Radiosity Sequences", which follow three patches through time: on the red cube, where the plane's shadow passes, on the
green cube, where it never does, and on the wing. Metres, z up.

usage: make_scene.py [FOLDER]    writes scene.obj, room.mtl and animation.json
"""

import math
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from model_plane import add_plane, headings  # noqa: E402
from scene_writer import Obj, json_text, keys, mtl, write  # noqa: E402

FRAMES = 120
ROOM = (-4, -3, 0), (4, 3, 3.2)
CUBES = {"red_cube": ((-1.5, 0.5, 0.5), 1), "green_cube": ((1.8, -1, 0.45), 0.9)}  # centre, edge
LAMP = (-0.6, -0.6, 3.18), (0.6, 0.6, 3.18)
LAMP_EXITANCE_W_M2 = 40
PLANE_SCALE = 0.35
REFLECTANCE = {
    "floor": (0.4, 0.4, 0.4),
    "ceiling": (0.7, 0.7, 0.7),
    "wall": (0.6, 0.6, 0.6),
    "red_cube": (0.6, 0.1, 0.1),
    "green_cube": (0.1, 0.5, 0.15),
    "plane": (0.6, 0.6, 0.6),
    "lamp": (0, 0, 0),
}


def room():
    obj = Obj("Room: lamp, two cubes and plane. Metres, z up. Written by make_scene.py.", "room.mtl")
    obj.room(*ROOM)
    obj.object("lamp")
    obj.material("lamp")
    obj.side(*LAMP, 2, LAMP[0][2], -1)
    for name, (centre, edge) in CUBES.items():
        obj.object(name)
        obj.material(name)
        obj.box(*([x + sign * edge / 2 for x in centre] for sign in (-1, 1)))
    add_plane(obj, PLANE_SCALE)
    return obj.text()


def flight():
    """Position [m] and rotation (roll, 0, yaw) [degrees] per frame: one round, nose along the path."""
    turns = [2 * math.pi * frame / (FRAMES - 1) for frame in range(FRAMES)]
    positions = [(2.6 * math.cos(a), 1.6 * math.sin(a), 2.1 + 0.25 * math.sin(2 * a)) for a in turns]
    yaws = headings((-2.6 * math.sin(a), 1.6 * math.cos(a)) for a in turns)
    return positions, [(math.degrees(-0.3), 0, yaw) for yaw in yaws]


def animation():
    positions, angles = flight()
    materials = {name: {"sides": "front"} for name in REFLECTANCE}
    materials["lamp"]["exitance_w_m2"] = LAMP_EXITANCE_W_M2
    return json_text({
        "name": "room",
        "frames": {"count": FRAMES, "fps": 24},
        "metres_per_unit": 1,
        "up": "z",
        "objects": {
            "plane": {
                "translate": keys(positions, interpolation="linear"),
                "rotate": {"euler_order": "xyz", "euler_degrees": keys(angles, interpolation="linear")},
            }
        },
        "materials": materials,
        "cameras": {"main": {"position": [3.7, 2.75, 2.35], "target": [-0.5, -0.55, 0.85], "vertical_fov_degrees": 55}},
        "lighting": {"preset": "standard", "mode": "default", "samples_per_light": 64},
        "images": [{"camera": "main", "width": 640, "height": 360, "formats": ["png"]}],
    }) + "\n"


write(__file__, {"scene.obj": room(), "room.mtl": mtl(REFLECTANCE, {"lamp": (LAMP_EXITANCE_W_M2,) * 3}), "animation.json": animation()})
