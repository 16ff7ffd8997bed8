"""Walls, doorway, door and lamps of the office."""

from motion import DOOR_HINGE
from place import Place

ROOM = (0, 0, 0), (12, 9, 3)
WEST, EAST = 8.2, 8.3  # faces of the partition with the doorway
SOUTH, NORTH = 5.2, 5.3  # faces of the other partition
DOORWAY = 3.5, 4.45, 2.1  # from y, to y, height
CEILING_LAMPS = (2.9, 2.1), (2.9, 6.7), (6.6, 4.4), (10.2, 7.2)
PRIVATE_LAMP = 10.2, 2.5
UPLIGHTER = 11.4, 5.75


def shell(obj):
    obj.object("shell")
    place, (low, high) = Place(obj), ROOM
    place.side("carpet", low, (*high[:2], low[2]), "+z")
    place.side("ceiling", (*low[:2], high[2]), high, "-z")
    for material, face in (("wall", "-x"), ("teal", "+x"), ("wall", "-y"), ("wall", "+y")):
        inward_wall(place, material, face)
    partition_with_doorway(place)
    wide = {"-y": (NORTH, "+y", WEST), "+y": (SOUTH, "-y", EAST)}
    for y, face, x in wide.values():
        place.side("wall", (x, y, 0), (high[0], y, high[2]), face)
    skirting(place)


def inward_wall(place, material, face):
    low, high = ROOM
    axis = "xyz".index(face[1])
    at = (low if face[0] == "-" else high)[axis]
    a, b = list(low), list(high)
    a[axis] = b[axis] = at
    place.side(material, a, b, ("+" if face[0] == "-" else "-") + face[1])


def partition_with_doorway(place):
    height = ROOM[1][2]
    y0, y1, top = DOORWAY
    for x, face, end, material in ((WEST, "-x", NORTH, "accent"), (EAST, "+x", SOUTH, "wall")):
        place.side(material, (x, 0, 0), (x, y0, height), face)
        place.side(material, (x, y1, 0), (x, end, height), face)
        place.side(material, (x, y0, top), (x, y1, height), face)
    place.side("white", (WEST, y0, 0), (EAST, y0, top), "+y")
    place.side("white", (WEST, y1, 0), (EAST, y1, top), "-y")
    place.side("white", (WEST, y0, top), (EAST, y1, top), "-z")
    # The frame overlaps the doorway a little, so that the closed door has no gap to shine through.
    for x0, x1, lap in ((WEST - 0.03, WEST + 0.02, 0.025), (EAST, EAST + 0.03, 0)):
        place.box("white", (x0, y0 - 0.07, 0), (x1, y0 + lap, top + 0.07), ("-z",))
        place.box("white", (x0, y1 - lap, 0), (x1, y1 + 0.07, top + 0.07), ("-z",))
        place.box("white", (x0, y0 + lap, top - lap), (x1, y1 - lap, top + 0.07), ("-y", "+y"))


def skirting(place):
    """Along the walls without doors."""
    (x0, y0, _), (x1, y1, _) = ROOM
    for low, high, without in (((x0, y0, 0), (WEST, y0 + 0.015, 0.08), "-y"),
                               ((EAST, y0, 0), (x1, y0 + 0.015, 0.08), "-y"),
                               ((x0, y1 - 0.015, 0), (x1, y1, 0.08), "+y"),
                               ((x0, y0 + 0.015, 0), (x0 + 0.015, y1 - 0.015, 0.08), "-x"),
                               ((x1 - 0.015, y0 + 0.015, 0), (x1, SOUTH, 0.08), "+x"),
                               ((x1 - 0.015, NORTH, 0), (x1, y1 - 0.015, 0.08), "+x")):
        place.box("white", low, high, ("-z", without))


def ceiling_lamp(place, material):
    """A panel of 1.2 m x 0.6 m in a frame, 1.5 cm below the ceiling; it faces down."""
    dx, dy, low, high = 0.6, 0.3, ROOM[1][2] - 0.03, ROOM[1][2]
    z = high - 0.015
    place.side(material, (-dx, -dy, z), (dx, dy, z), "-z")
    for y in (-dy - 0.02, dy):
        place.box("white", (-dx - 0.02, y, low), (dx + 0.02, y + 0.02, high), ("+z",))
    for x in (-dx - 0.02, dx):
        place.box("white", (x, -dy, low), (x + 0.02, dy, high), ("+z", "-y", "+y"))


def uplighter(place):
    """A square bowl on a pole; its lamp lies below the rim and faces up, so only what is above sees it."""
    place.drum("black", [(0.17, 0), (0.16, 0.03)], 12, ("top",))
    place.drum("black", [(0.015, 0.03), (0.015, 1.72)], 6, ())
    place.drum("white", [(0.06, 1.72), (0.27, 1.9)], 4, ("bottom",))
    for k in range(4):
        inner = place.at(yaw=90 * k)
        inner.polygon("white", [(0.135, -0.135, 1.83), (0.135, 0.135, 1.83), (0.185, 0.185, 1.9), (0.185, -0.185, 1.9)],
                      (-1, 0, 0.5))
    place.side("lamp_up", (-0.135, -0.135, 1.83), (0.135, 0.135, 1.83), "+z")


def lamps(obj):
    obj.object("lamps")
    for x, y in CEILING_LAMPS:
        ceiling_lamp(Place(obj, x, y), "lamp")
    ceiling_lamp(Place(obj, *PRIVATE_LAMP), "lamp_private")
    uplighter(Place(obj, *UPLIGHTER))


def door(obj):
    """Closed, as frame 0 has it: its leaf reaches from the hinge along +y."""
    obj.object("door")
    x, y = DOOR_HINGE
    place = Place(obj, x, y)
    place.box("door", (-0.04, 0, 0.008), (0, 0.915, 2.085))
    for z in (0.25, 1.15):
        for low, high, without in ((-0.048, -0.04, "+x"), (0, 0.008, "-x")):
            place.box("wood", (low, 0.12, z), (high, 0.8, z + 0.7), (without,))
    for sign, rest in ((-1, ("+x",)), (1, ("-x",))):
        near, far = sorted((0.0 if sign > 0 else -0.04, 0.0 + sign * 0.07 - (0.04 if sign < 0 else 0) + 0.0))
        place.box("metal", (near, 0.84, 1.02), (far, 0.86, 1.04), rest)
        grip = far - 0.015 if sign > 0 else near
        place.box("metal", (grip, 0.74, 1.02), (grip + 0.015, 0.84, 1.04), ("+y",))
