#!/usr/bin/env python3
"""The office by night: an open-plan room and a private office behind a door. A robot drives up, the door opens and
lets the light of the private office out, and a model plane flies a round above the desks. Six lamps; one of them is an
uplighter, whose light comes from the ceiling only.

As large as the third scene of Besuievsky and Pueyo, "A Monte Carlo Method for Accelerating the Computation of Animated
Radiosity Sequences": about 4,200 polygons of which 500 move, 120 frames. Metres, z up.

usage: make_scene.py [FOLDER]    writes scene.obj, office.mtl, animation.json and animation_light_groups.json
"""

import pathlib
import random
import sys

sys.dont_write_bytecode = True
sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent), str(pathlib.Path(__file__).resolve().parent.parent)]
import furniture  # noqa: E402
import motion  # noqa: E402
import rooms  # noqa: E402
from model_plane import add_plane  # noqa: E402
from place import Place, SharedObj  # noqa: E402
from robot import add_robot  # noqa: E402
from scene_writer import json_text, mtl, write  # noqa: E402

PLANE_SCALE = 0.3
POLYGONS, MOVING_POLYGONS = (4100, 4300), (480, 520)
# Emitted by the ceiling lamps, by that of the private office, and by the uplighter  [W/m^2 RGB]. So bright that Table 1
# at a threshold of .05 finds as many key-frames as the paper reports, 34.
LAMPS = {"lamp": (10, 10.3, 11.2), "lamp_private": (25, 21.4, 16), "lamp_up": (35, 28, 19)}
REFLECTANCE = {
    "carpet": (0.2, 0.23, 0.28), "ceiling": (0.8, 0.8, 0.8), "wall": (0.72, 0.7, 0.66), "accent": (0.62, 0.27, 0.13),
    "teal": (0.13, 0.36, 0.38), "wood": (0.5, 0.33, 0.19), "door": (0.45, 0.26, 0.13), "white": (0.75, 0.75, 0.74),
    "metal": (0.42, 0.43, 0.45), "black": (0.05, 0.05, 0.055), "screen": (0.06, 0.09, 0.13),
    "night": (0.02, 0.03, 0.06), "divider": (0.2, 0.42, 0.42), "fabric": (0.1, 0.17, 0.38),
    "fabric_orange": (0.65, 0.27, 0.06), "sofa": (0.42, 0.1, 0.09), "cushion": (0.5, 0.14, 0.12),
    "paper": (0.8, 0.79, 0.75), "mug_orange": (0.7, 0.3, 0.08), "pot": (0.55, 0.53, 0.5), "soil": (0.08, 0.05, 0.03),
    "leaf": (0.11, 0.34, 0.08), "book_red": (0.5, 0.08, 0.06), "book_blue": (0.08, 0.16, 0.42),
    "book_cream": (0.7, 0.63, 0.48), "book_green": (0.1, 0.3, 0.15), "book_ochre": (0.6, 0.4, 0.1),
    "book_plum": (0.28, 0.09, 0.25), "picture_blue": (0.15, 0.32, 0.55), "picture_ochre": (0.65, 0.46, 0.15),
    "robot_white": (0.75, 0.75, 0.75), "robot_dark": (0.08, 0.08, 0.09), "robot_orange": (0.75, 0.3, 0.05),
    "plane": (0.75, 0.55, 0.08), **{lamp: (0, 0, 0) for lamp in LAMPS},
}


def workgroup(floor, x, y, chance):
    """Four desks with a divider between, and their chairs."""
    for side, yaw in ((1, 0), (-1, 180)):
        for dx in (-0.76, 0.76):
            desk = floor.at(x + dx, y + side * 0.4, yaw=yaw)
            furniture.desk(desk)
            furniture.workplace(desk, "mug_orange")
            furniture.chair(desk.at(chance.uniform(-0.2, 0.1), 0.72, yaw=chance.uniform(-35, 35)))
    furniture.divider(floor.at(x, y))


def open_plan(obj, chance):
    obj.object("open_plan")
    floor = Place(obj)
    workgroup(floor, 3.0, 2.1, chance)
    workgroup(floor, 3.0, 6.7, chance)
    furniture.bookshelf(floor.at(8.2, 1.9, yaw=90), chance)
    furniture.bookshelf(floor.at(9.5, 5.3), chance)
    furniture.round_table(floor.at(6.3, 1.6))
    for yaw in (30, 150, 270):
        furniture.chair(floor.at(6.3, 1.6, yaw=yaw).at(0, 0.85), "fabric_orange")
    for y in (5.9, 6.4):
        furniture.cabinet(floor.at(0, y, yaw=-90))
    furniture.sofa(floor.at(12, 7.3, yaw=90))
    furniture.coffee_table(floor.at(10.4, 7.3, yaw=90))
    for x, y in ((11.5, 8.6), (7.8, 0.4), (0.4, 4.9)):
        furniture.plant(floor.at(x, y), chance)
    for x, y in ((5.0, 3.2), (5.0, 7.5)):
        furniture.bin_(floor.at(x, y))
    for x in (2.2, 5.2):
        furniture.window(floor.at(x, 0, 1.0))
    for y in (2.0, 7.3):
        furniture.window(floor.at(0, y, 1.0, yaw=-90))
    furniture.picture(floor.at(8.2, 4.87, 1.6, yaw=90), "picture_ochre", 0.5, 0.7)
    furniture.picture(floor.at(12, 7.3, 1.65, yaw=90), "picture_blue", 1.3, 0.8)
    furniture.clock(floor.at(11.0, 5.3, 2.2))


def private_office(obj, chance):
    obj.object("private_office")
    floor = Place(obj)
    desk = floor.at(10.5, 1.5, yaw=90)
    furniture.desk(desk)
    furniture.workplace(desk)
    furniture.chair(desk.at(0, 0.72, yaw=20), "fabric_orange")
    furniture.chair(desk.at(0.1, -0.85, yaw=170), "fabric_orange")
    furniture.bookshelf(floor.at(12, 3.6, yaw=90), chance, width=1.2)
    furniture.cabinet(floor.at(8.65, 0, yaw=0))
    furniture.plant(floor.at(11.6, 4.8), chance)
    furniture.window(floor.at(10.4, 0, 1.0))
    furniture.picture(floor.at(10.2, 5.2, 1.6, yaw=180), "picture_blue", 0.9, 0.6)


def office():
    obj = SharedObj("Office: rooms, furniture, door, robot and plane. Metres, z up. Written by make_scene.py.",
                    "office.mtl")
    chance = random.Random(2026)
    rooms.shell(obj)
    rooms.lamps(obj)
    open_plan(obj, chance)
    private_office(obj, chance)
    rooms.door(obj)
    add_robot(obj)
    add_plane(obj, PLANE_SCALE)
    check_counts(obj.counts)
    return obj.text()


def check_counts(counts):
    moving = sum(counts[name] for name in motion.objects())
    total = sum(counts.values())
    assert POLYGONS[0] <= total <= POLYGONS[1], (total, counts)
    assert MOVING_POLYGONS[0] <= moving <= MOVING_POLYGONS[1], (moving, counts)


LIGHT_GROUPS = {"ceiling": ["lamp"], "private_office": ["lamp_private"], "uplighter": ["lamp_up"]}


def animation(title, **lighting):
    materials = {name: {"sides": "both" if name == "leaf" else "front"} for name in sorted(REFLECTANCE)}
    for name, exitance in LAMPS.items():
        materials[name]["exitance_w_m2"] = list(exitance)
    return json_text({
        "name": title,
        "frames": {"count": motion.FRAMES, "fps": 24},
        "metres_per_unit": 1,
        "up": "z",
        "objects": motion.objects(),
        "materials": materials,
        "cameras": {
            "main": {"position": [0.45, 8.55, 2.3], "target": [6.4, 3.7, 0.85], "vertical_fov_degrees": 58},
            "door": {"position": [5.2, 5.3, 1.7], "target": [9.3, 3.6, 1.0], "vertical_fov_degrees": 60},
        },
        "lighting": {"preset": "standard", "mode": "default", "patch_edge_m": 0.144, **lighting},
        "images": [{"camera": "main", "width": 640, "height": 360, "formats": ["png"]}],
    }) + "\n"


write(__file__, {
    "scene.obj": office(),
    "office.mtl": mtl(REFLECTANCE, LAMPS),
    "animation.json": animation("office"),
    # The lights kept apart, so that they can be dimmed and coloured afterwards; noise differs, light does not.
    "animation_light_groups.json": animation("office, light groups", light_groups=LIGHT_GROUPS),
})
