"""Desks, chairs, shelves and what lies on them. The front of everything looks along +y of its place."""

import math

BOOKS = "book_red", "book_blue", "book_cream", "book_green", "book_ochre", "book_plum"
ON_FLOOR = ("-z",)
AGAINST_WALL = ("-y",)


def desk(place):
    """1.5 m x 0.75 m; one sits at +y."""
    place.board("wood", (1.5, 0.75, 0.03), 0.71)
    for x in (-0.71, 0.71):
        for y in (-0.33, 0.33):
            place.board("metal", (0.04, 0.04, 0.71), 0, x, y, ("-z", "+z"))
    place.board("metal", (1.36, 0.015, 0.35), 0.33, 0, -0.33)
    place.board("white", (0.4, 0.6, 0.58), 0.04, 0.42, -0.02)
    for k in range(3):
        z = 0.06 + 0.19 * k
        place.box("white", (0.235, 0.28, z), (0.605, 0.298, z + 0.17), AGAINST_WALL)
        place.box("metal", (0.36, 0.298, z + 0.11), (0.48, 0.315, z + 0.125), AGAINST_WALL)


def workplace(place, mug="mug_orange"):
    """What lies on a desk: screen, keyboard, mouse, papers, mug."""
    top = place.at(z=0.74)
    top.board("black", (0.24, 0.16, 0.015), 0, -0.1, -0.2, ON_FLOOR)
    top.board("metal", (0.05, 0.03, 0.14), 0.015, -0.1, -0.23, ("-z", "+z"))
    top.board("black", (0.62, 0.03, 0.37), 0.13, -0.1, -0.21)
    top.polygon("screen", [(x, -0.193, z) for x, z in ((-0.4, 0.145), (0.2, 0.145), (0.2, 0.485), (-0.4, 0.485))],
                (0, 1, 0))
    top.board("black", (0.44, 0.15, 0.02), 0, -0.1, 0.12, ON_FLOOR)
    top.board("metal", (0.41, 0.11, 0.008), 0.02, -0.1, 0.12, ON_FLOOR)
    top.board("black", (0.06, 0.1, 0.03), 0, 0.22, 0.12, ON_FLOOR)
    top.at(0.42, 0.08, yaw=12).board("paper", (0.21, 0.29, 0.012), 0, without=ON_FLOOR)
    top.at(0.43, 0.07, yaw=-6).board("paper", (0.21, 0.29, 0.008), 0.012, without=ON_FLOOR)
    top.at(-0.58, 0.16).drum(mug, [(0.035, 0), (0.045, 0.1)], 8, ("top",))


def divider(place):
    """The low screen between two desks that face each other."""
    place.board("divider", (3, 0.04, 0.42), 0.74)
    for x in (-1.2, 0, 1.2):
        place.board("metal", (0.06, 0.06, 0.05), 1.16, x)


def chair(place, fabric="fabric"):
    """A swivel chair; who sits on it looks along -y, so its back is at +y."""
    for k in range(5):
        foot = place.at(yaw=72 * k + 18)
        foot.board("black", (0.29, 0.045, 0.035), 0.03, 0.16, 0, ("-x", "-z"))
    place.drum("metal", [(0.03, 0.06), (0.03, 0.43)], 6, ())
    place.board(fabric, (0.48, 0.46, 0.07), 0.43)
    place.board("black", (0.08, 0.03, 0.22), 0.4, 0, 0.245, ("-z",))
    back = [(-0.22, 0.55), (0.22, 0.55), (0.2, 1.02), (-0.2, 1.02)]
    lean = {0.55: 0.22, 1.02: 0.3}
    front, rear = ([(x, lean[z] + d, z) for x, z in back] for d in (0, 0.06))
    place.polygon(fabric, front, (0, -1, 0))
    place.polygon(fabric, rear, (0, 1, 0))
    for k in range(4):
        n = (k + 1) % 4
        outward = (back[k][0] + back[n][0], 0, back[k][1] + back[n][1] - 1.57)
        place.polygon(fabric, [front[k], front[n], rear[n], rear[k]], outward)
    for x in (-0.26, 0.26):
        place.board("black", (0.04, 0.03, 0.19), 0.46, x, 0.02, ("-z", "+z"))
        place.board("black", (0.06, 0.28, 0.03), 0.65, x, 0.02)


def books(place, width, random):
    """A row of books on a shelf, some leaning out further than others; now and then a gap."""
    x = 0
    while True:
        thick = random.uniform(0.05, 0.1)
        if x + thick > width:
            return
        if random.random() < 0.88:
            high, deep = random.uniform(0.2, 0.29), random.uniform(0.17, 0.21)
            place.box(random.choice(BOOKS), (x, 0, 0), (x + thick - 0.002, deep, high), ("-z", "-y"))
        x += thick


def bookshelf(place, random, shelves=5, width=1.6):
    """With its back at y = 0, against a wall."""
    depth, height, half = 0.3, 0.36 * shelves + 0.1, width / 2
    for x in (-half, half - 0.025):
        place.box("wood", (x, 0, 0), (x + 0.025, depth, height), ("-z", "-y"))
    place.box("wood", (-half + 0.025, 0, height - 0.025), (half - 0.025, depth, height), ("-x", "+x", "-y"))
    place.side("wood", (-half + 0.025, 0.01, 0), (half - 0.025, 0.01, height - 0.025), "+y")
    for k in range(shelves):
        z = 0.08 + 0.36 * k
        place.box("wood", (-half + 0.025, 0.01, z), (half - 0.025, depth, z + 0.02), ("-x", "+x", "-y"))
        books(place.at(-half + 0.04, 0.015, z + 0.02), width - 0.08, random)


def cabinet(place):
    """A filing cabinet, its back at y = 0."""
    place.box("metal", (-0.22, 0, 0), (0.22, 0.6, 1.3), ("-z", "-y"))
    for k in range(4):
        z = 0.03 + 0.315 * k
        place.box("white", (-0.2, 0.6, z), (0.2, 0.615, z + 0.295), AGAINST_WALL)
        place.box("black", (-0.06, 0.615, z + 0.2), (0.06, 0.635, z + 0.22), AGAINST_WALL)


def sofa(place, width=2.0):
    """Its back at y = 0."""
    half = width / 2
    place.box("sofa", (-half, 0, 0.1), (half, 0.85, 0.3))
    place.box("sofa", (-half + 0.16, 0, 0.3), (half - 0.16, 0.2, 0.78), ("-z",))
    for x in (-half, half - 0.16):
        place.box("sofa", (x, 0, 0.3), (x + 0.16, 0.85, 0.6), ("-z",))
    for k in (-1, 1):
        middle = k * (half - 0.16) / 2
        place.board("cushion", (half - 0.18, 0.62, 0.14), 0.3, middle, 0.52, ON_FLOOR)
        for y in (0.06, 0.79):
            place.board("wood", (0.06, 0.06, 0.1), 0, k * (half - 0.1), y, ("-z", "+z"))


def coffee_table(place):
    place.board("wood", (1.0, 0.55, 0.04), 0.38)
    for x in (-0.44, 0.44):
        for y in (-0.22, 0.22):
            place.board("metal", (0.04, 0.04, 0.38), 0, x, y, ("-z", "+z"))
    place.at(-0.2, 0.05, 0.42, 20).board("book_blue", (0.22, 0.3, 0.03), 0, without=ON_FLOOR)
    place.at(-0.19, 0.04, 0.45, -8).board("book_cream", (0.2, 0.27, 0.025), 0, without=ON_FLOOR)
    place.at(0.25, -0.08, 0.42).drum("mug_orange", [(0.035, 0), (0.045, 0.1)], 8, ("top",))


def round_table(place):
    place.drum("white", [(0.62, 0.71), (0.62, 0.74)], 16)
    place.drum("metal", [(0.05, 0.03), (0.05, 0.71)], 8, ())
    place.drum("metal", [(0.32, 0), (0.3, 0.03)], 12, ("top",))


def plant(place, random, leaves=15, height=1.1):
    """A pot with leaves of two halves each, seen from both sides."""
    place.drum("pot", [(0.14, 0), (0.19, 0.36)], 8, ())
    place.drum("soil", [(0.186, 0.32), (0.186, 0.325)], 8, ("top",))
    for k in range(leaves):
        stalk = place.at(yaw=360 * k * 0.381966)
        rise, reach = height * random.uniform(0.55, 1.0), random.uniform(0.18, 0.5)
        low, middle = (0.02, 0, 0.33), (0.45 * reach, 0, 0.33 + 0.75 * rise)
        tip, wide = (reach, 0, 0.33 + 0.8 * rise), random.uniform(0.05, 0.085)
        left, right = ((middle[0], side * wide, middle[2]) for side in (-1, 1))
        stalk.polygon("leaf", [low, left, right], (-1, 0, 1))
        stalk.polygon("leaf", [left, tip, right], (-1, 0, 1))


def bin_(place):
    place.drum("black", [(0.11, 0), (0.14, 0.3)], 8, ())
    place.drum("paper", [(0.125, 0.2), (0.125, 0.21)], 8, ("top",))


def picture(place, material, width, height):
    """Its centre at the place, hanging on a wall at y = 0."""
    half, tall = width / 2, height / 2
    place.box("black", (-half, 0, -tall), (half, 0.025, tall), AGAINST_WALL)
    place.polygon(material, [(x, 0.027, z) for x, z in
                             ((0.03 - half, 0.03 - tall), (half - 0.03, 0.03 - tall), (half - 0.03, tall - 0.03),
                              (0.03 - half, tall - 0.03))], (0, 1, 0))


def clock(place):
    """On a wall at y = 0: a disc of 24 sides with its hands at ten past ten."""
    ring = [(0.16 * math.cos(a), 0.16 * math.sin(a)) for a in (2 * math.pi * k / 24 for k in range(24))]
    for k in range(24):
        (ax, az), (bx, bz) = ring[k], ring[(k + 1) % 24]
        place.polygon("black", [(ax, 0, az), (bx, 0, bz), (bx, 0.03, bz), (ax, 0.03, az)], (ax + bx, 0, az + bz))
    place.polygon("white", [(x, 0.03, z) for x, z in ring], (0, 1, 0))
    for degrees, length in ((150, 0.08), (30, 0.12)):
        x, z = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        wide = 0.007
        place.polygon("black", [(-wide * z, 0.033, wide * x), (wide * z, 0.033, -wide * x),
                                (length * x, 0.033, length * z)], (0, 1, 0))


def window(place, width=1.7, height=1.3):
    """By night. On a wall at y = 0, its sill at the place."""
    half = width / 2
    place.polygon("night", [(-half, 0.004, 0), (half, 0.004, 0), (half, 0.004, height), (-half, 0.004, height)],
                  (0, 1, 0))
    for x in (-half - 0.05, -0.025, half):
        place.box("white", (x, 0, 0), (x + 0.05, 0.04, height), AGAINST_WALL)
    for z in (-0.05, height):
        place.box("white", (-half - 0.05, 0, z), (half + 0.05, 0.05, z + 0.05), AGAINST_WALL)
    place.box("white", (-half - 0.08, 0, -0.09), (half + 0.08, 0.16, -0.05), AGAINST_WALL)
