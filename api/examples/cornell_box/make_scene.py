#!/usr/bin/env python3
"""The Cornell box, 5.5 m wide, with a short block that slides and turns from the green wall to the red one.

The measured dimensions of the real box (Cornell Program of Computer Graphics), with its walls made straight;
their millimetres stand for centimetres here: metres_per_unit is 0.01. y up; the open front faces -z, and
the camera.

usage: make_scene.py [FOLDER]    writes scene.obj, cornell_box.mtl and animation.json
"""

import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scene_writer import Obj, json_text, keys, write  # noqa: E402

FRAMES = 48
ROOM = (0, 0, 0), (555, 548.8, 559.2)
DOWN, UP = (0, -1, 0), (0, 1, 0)
LIGHT_Y = 548.6  # just below the ceiling
SHORT_BLOCK = ((130, 65), (82, 225), (240, 272), (290, 114)), 165  # (x, z) of the corners, height
TALL_BLOCK = ((423, 247), (265, 296), (314, 456), (472, 406)), 330


def block(obj, name, corners, height):
    obj.object(name)
    obj.material("white")
    obj.polygon([(x, height, z) for x, z in corners], UP)
    centre_x = sum(x for x, _ in corners) / 4
    centre_z = sum(z for _, z in corners) / 4
    for (ax, az), (bx, bz) in zip(corners, corners[1:] + corners[:1]):
        outward = ((ax + bx) / 2 - centre_x, 0, (az + bz) / 2 - centre_z)
        obj.polygon([(ax, 0, az), (bx, 0, bz), (bx, height, bz), (ax, height, az)], outward)


def cornell_box():
    obj = Obj("Cornell box. Centimetres, y up. Written by make_scene.py.", "cornell_box.mtl")
    obj.object("room")
    obj.material("white")
    low, high = ROOM
    obj.side(low, high, 1, low[1], 1)
    obj.side(low, high, 1, high[1], -1)
    obj.side(low, high, 2, high[2], -1)
    obj.material("green")
    obj.side(low, high, 0, low[0], 1)
    obj.material("red")
    obj.side(low, high, 0, high[0], -1)
    obj.object("light")
    obj.material("light")
    obj.polygon([(343, LIGHT_Y, 227), (343, LIGHT_Y, 332), (213, LIGHT_Y, 332), (213, LIGHT_Y, 227)], DOWN)
    block(obj, "tall_block", *TALL_BLOCK)
    block(obj, "short_block", *SHORT_BLOCK)
    return obj.text()


def mtl():
    materials = {
        "white": "Kd 0.73 0.73 0.73",
        "red": "Kd 0.63 0.06 0.05",
        "green": "Kd 0.14 0.45 0.09",
        "light": "Kd 0 0 0\nKe 17 13 7",
    }
    head = "# Kd is the reflectance, Ke the emitted radiance [W sr^-1 m^-2]. Written by make_scene.py.\n"
    return head + "".join(f"\nnewmtl {name}\n{lines}\n" for name, lines in materials.items())


def animation():
    last = FRAMES - 1
    front = {"sides": "front"}
    return json_text({
        "name": "Cornell box",
        "frames": {"count": FRAMES, "fps": 24},
        "metres_per_unit": 0.01,
        "up": "y",
        "objects": {
            "short_block": {
                "pivot": [185.5, 0, 169],
                # Round the front of the tall block, and no further than the open front.
                "translate": keys({0: (0, 0, 0), 24: (100, 0, -46), last: (200, 0, -46)}, interpolation="cubic"),
                "rotate": {"euler_degrees": keys({0: (0, 0, 0), last: (0, 90, 0)})},
            }
        },
        "materials": {"white": front, "red": front, "green": front, "light": front},
        "cameras": {"main": {"position": [278, 273, -800], "target": [278, 273, 0], "vertical_fov_degrees": 39.3}},
        "lighting": {"preset": "standard", "mode": "default", "samples_per_light": 64},
        "images": [{"camera": "main", "width": 512, "height": 512, "formats": ["png"]}],
    }) + "\n"


write(__file__, {"scene.obj": cornell_box(), "cornell_box.mtl": mtl(), "animation.json": animation()})
