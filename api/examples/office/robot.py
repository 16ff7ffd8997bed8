"""The robot: a body on two wheels, a head that looks around, arms that swing. Nose along +x, standing at z = 0."""

from place import Place

WHEEL_RADIUS = 0.11
SHOULDER_Z = 0.98
HEAD_Z = 1.13
WHEEL_Y = 0.25
SHOULDER_Y = 0.265


def body(obj):
    obj.object("robot_body")
    place = Place(obj)
    place.drum("robot_dark", [(0.2, 0.05), (0.24, 0.1), (0.24, 0.2)], 16, ("bottom", "top"))
    place.drum("robot_white", [(0.17, 0.2), (0.2, 0.45), (0.23, 0.85), (0.2, 1.02), (0.1, 1.08)], 16, ("top",))
    place.drum("robot_dark", [(0.05, 1.08), (0.05, HEAD_Z)], 8, ())
    place.box("robot_orange", (0.17, -0.09, 0.6), (0.24, 0.09, 0.82), ("-x",))
    for k in range(3):
        place.box("robot_dark", (0.24, -0.06, 0.64 + 0.06 * k), (0.247, 0.06, 0.67 + 0.06 * k), ("-x",))
    place.box("robot_dark", (-0.31, -0.12, 0.5), (-0.16, 0.12, 0.9), ("+x",))
    place.box("robot_orange", (0.15, -0.2, 0.44), (0.42, 0.2, 0.46))
    place.at(0.3, 0.06, 0.46).drum("mug_orange", [(0.035, 0), (0.045, 0.1)], 8, ("top",))
    place.at(0.3, -0.08, 0.46).board("paper", (0.15, 0.2, 0.02), 0, without=("-z",))


def head(obj):
    obj.object("robot_head")
    place = Place(obj, z=HEAD_Z)
    place.drum("robot_white", [(0.1, 0.02), (0.155, 0.07), (0.165, 0.17), (0.13, 0.25), (0.06, 0.29)], 12)
    place.box("robot_dark", (0.1, -0.1, 0.1), (0.175, 0.1, 0.18), ("-x",))
    for y in (-0.05, 0.05):
        place.box("robot_orange", (0.175, y - 0.02, 0.12), (0.182, y + 0.02, 0.16), ("-x",))
    place.drum("robot_dark", [(0.008, 0.29), (0.006, 0.4)], 6, ())
    place.at(z=0.4).drum("robot_orange", [(0.01, 0), (0.025, 0.02), (0.025, 0.035), (0.01, 0.05)], 8)


def arm(obj, name, y):
    obj.object(name)
    place = Place(obj, y=y, z=SHOULDER_Z)
    place.drum("robot_orange", [(0.03, -0.06), (0.055, -0.03), (0.055, 0.03), (0.03, 0.06)], 8)
    place.box("robot_white", (-0.035, -0.03, -0.33), (0.035, 0.03, -0.06), ("+z",))
    place.box("robot_dark", (-0.04, -0.035, -0.39), (0.04, 0.035, -0.33))
    place.box("robot_white", (-0.03, -0.025, -0.42), (0.26, 0.025, -0.36))
    for side in (-1, 1):
        place.box("robot_dark", (0.26, 0.012 * side - 0.008, -0.41), (0.34, 0.012 * side + 0.008, -0.37), ("-x",))


def wheel(obj, name, y):
    """A drum that lies on its side, with bolts that show it turning."""
    obj.object(name)
    lying = Lying(obj, y)
    lying.drum("robot_dark", [(WHEEL_RADIUS, -0.03), (WHEEL_RADIUS, 0.03)], 16)
    for k in range(3):
        bolt = Lying(obj, y, yaw=120 * k)
        bolt.box("robot_orange", (0.05, -0.015, 0.03 if y > 0 else -0.04), (0.09, 0.015, 0.04 if y > 0 else -0.03),
                 ("-z",) if y > 0 else ("+z",))


class Lying(Place):
    """The axis of its drums is y; its boxes are turned by `yaw` about that axis."""

    def __init__(self, obj, y, yaw=0):
        super().__init__(obj, y=y, z=WHEEL_RADIUS, yaw=yaw)

    def turned(self, v):
        x, y, z = super().turned(v)
        return x, z, -y


def add_robot(obj):
    body(obj)
    head(obj)
    for side, sign in (("left", 1), ("right", -1)):
        arm(obj, f"robot_arm_{side}", sign * SHOULDER_Y)
        wheel(obj, f"robot_wheel_{side}", sign * WHEEL_Y)
