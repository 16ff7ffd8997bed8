#!/usr/bin/env python3
"""The garage: a closed room with 15 ceiling lamps, and a model plane that flies through it.

After the scene of Besuievsky and Pueyo, "A Monte Carlo Method for Accelerating the Computation of Animated
Radiosity Sequences". Metres, z up. All reflectances are grey, so that red, green and blue agree.

usage: make_scene.py [FOLDER]    writes scene.obj, animation.json and animation_light_off.json
"""

import math
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from model_plane import add_plane  # noqa: E402
from scene_writer import Obj, json_text, keys, mtl, write  # noqa: E402

FRAMES = 120
ROOM = (-15, -9, 0), (15, 9, 4)
LAMP_SIZE = 1.2, 0.6
LAMP_Z = 3.98
LAMP_EXITANCE_W_M2 = 23
REFLECTANCE = {"floor": 0.3, "ceiling": 0.7, "wall": 0.5, "plane": 0.6}


def garage():
    obj = Obj("Garage: room, lamps and plane. Metres, z up. Written by make_scene.py.", "garage.mtl")
    obj.room(*ROOM)

    obj.object("lamps")
    for column in range(-2, 3):
        for row in range(-1, 2):
            x, y = 5.6 * column, 6 * row
            dx, dy = LAMP_SIZE[0] / 2, LAMP_SIZE[1] / 2
            # The lamp in the middle has a material of its own, so that a job can switch it off.
            obj.material("lamp_0_0" if column == 0 and row == 0 else "lamp")
            obj.side((x - dx, y - dy, LAMP_Z), (x + dx, y + dy, LAMP_Z), 2, LAMP_Z, -1)

    add_plane(obj)
    return obj.text()


def flight():
    """Position [m] and rotation (roll, 0, yaw) [degrees] per frame: T Rz(yaw) Rx(roll), nose along +x."""
    positions, angles = [], []
    for frame in range(FRAMES):
        t = frame / (FRAMES - 1)
        positions.append((-12.5 + 25 * t, 1.5 * math.sin(2 * math.pi * t), 1.9 + 0.5 * math.sin(3 * math.pi * t)))
        yaw = math.atan2(3 * math.pi * math.cos(2 * math.pi * t), 25)
        roll = -0.5 * math.sin(2 * math.pi * t)
        angles.append((math.degrees(roll), 0, math.degrees(yaw)))
    return positions, angles


def animation(name, middle_lamp_w_m2):
    positions, angles = flight()
    front = {"sides": "front"}
    return json_text({
        "name": name,
        "frames": {"count": FRAMES, "fps": 24},
        "metres_per_unit": 1,
        "up": "z",
        "objects": {
            "plane": {
                "translate": keys(positions, interpolation="linear"),
                "rotate": {"euler_order": "xyz", "euler_degrees": keys(angles, interpolation="linear")},
            }
        },
        "materials": {
            "floor": front,
            "ceiling": front,
            "wall": front,
            "plane": front,
            "lamp": {"exitance_w_m2": LAMP_EXITANCE_W_M2, **front},
            "lamp_0_0": {"exitance_w_m2": middle_lamp_w_m2, **front},
        },
        "cameras": {
            "main": {"position": [0, -8.7, 3.3], "target": [0, 1.5, 0.9], "vertical_fov_degrees": 65}
        },
        "lighting": {"preset": "standard", "mode": "default"},
        "images": [{"camera": "main", "width": 640, "height": 360, "formats": ["png"]}],
    }) + "\n"


def materials():
    lamps = ("lamp", "lamp_0_0")
    reflectance = {name: (rho,) * 3 for name, rho in REFLECTANCE.items()} | {name: (0,) * 3 for name in lamps}
    return mtl(reflectance, {name: (LAMP_EXITANCE_W_M2,) * 3 for name in lamps})


write(__file__, {
    "scene.obj": garage(),
    "garage.mtl": materials(),
    "animation.json": animation("garage", LAMP_EXITANCE_W_M2),
    "animation_light_off.json": animation("garage, middle lamp off", 0),
})
