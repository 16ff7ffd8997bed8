"""Shapes at a place: a point and a heading, in whose coordinates furniture is described."""

import math

from scene_writer import Obj, tidy

FACES = {"-x": (0, -1), "+x": (0, 1), "-y": (1, -1), "+y": (1, 1), "-z": (2, -1), "+z": (2, 1)}


class SharedObj(Obj):
    """An OBJ file in which the polygons of one object share their vertices; counts polygons by object."""

    def __init__(self, comment, mtl):
        super().__init__(comment, mtl)
        self.counts = {}

    def object(self, name):
        super().object(name)
        self.name, self.known, self.used = name, {}, None

    def material(self, name):
        if name != self.used:
            super().material(name)
        self.used = name

    def polygon(self, corners, facing):
        corners = corners if is_facing(corners, facing) else corners[::-1]
        indices = []
        for corner in corners:
            text = "v " + " ".join(str(tidy(round(x, 4))) for x in corner)  # tenths of a millimetre
            if text not in self.known:
                self.vertices += 1
                self.known[text] = self.vertices
                self.lines.append(text)
            indices.append(self.known[text])
        assert len(set(indices)) == len(corners), corners
        self.lines.append("f " + " ".join(map(str, indices)))
        self.counts[self.name] = self.counts.get(self.name, 0) + 1


def is_facing(corners, facing):
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners[:3]
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - bx, cy - by, cz - bz
    normal = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
    return sum(n * f for n, f in zip(normal, facing)) > 0


class Place:
    """`obj` seen from (x, y, z), turned by `yaw` degrees about z."""

    def __init__(self, obj, x=0, y=0, z=0, yaw=0):
        self.obj, self.origin, self.yaw = obj, (x, y, z), yaw
        self.cos, self.sin = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))

    def turned(self, v):
        return self.cos * v[0] - self.sin * v[1], self.sin * v[0] + self.cos * v[1], v[2]

    def at(self, x=0, y=0, z=0, yaw=0):
        """A place given in the coordinates of this one."""
        moved = [a + b for a, b in zip(self.origin, self.turned((x, y, z)))]
        return Place(self.obj, *moved, self.yaw + yaw)

    def polygon(self, material, corners, facing):
        self.obj.material(material)
        world = [tuple(a + b for a, b in zip(self.origin, self.turned(corner))) for corner in corners]
        self.obj.polygon(world, self.turned(facing))

    def side(self, material, low, high, face):
        """One face of a box."""
        axis, sign = FACES[face]
        i, j = [k for k in range(3) if k != axis]
        corners = []
        for a, b in ((low[i], low[j]), (high[i], low[j]), (high[i], high[j]), (low[i], high[j])):
            corner = [0, 0, 0]
            corner[axis], corner[i], corner[j] = (low, high)[sign > 0][axis], a, b
            corners.append(tuple(corner))
        self.polygon(material, corners, [sign * (k == axis) for k in range(3)])

    def box(self, material, low, high, without=()):
        """Without the faces that touch something else: what nobody sees need not be there."""
        for face in FACES:
            if face not in without:
                self.side(material, low, high, face)

    def board(self, material, size, z, x=0, y=0, without=()):
        """A box of `size`, centred at (x, y), standing at height `z`."""
        dx, dy, dz = size
        self.box(material, (x - dx / 2, y - dy / 2, z), (x + dx / 2, y + dy / 2, z + dz), without)

    def drum(self, material, rings, sides, caps=("bottom", "top")):
        """Stacked rings (radius, z) about this place's axis, with `sides` walls each; from low to high."""
        corners = [(math.cos(a), math.sin(a)) for a in (2 * math.pi * (k + 0.5) / sides for k in range(sides))]
        circles = [[(r * c, r * s, z) for c, s in corners] for r, z in rings]
        for (low_r, low_z), (high_r, high_z), low, high in zip(rings, rings[1:], circles, circles[1:]):
            for k in range(sides):
                n = (k + 1) % sides
                (cx, sx), (cy, sy) = corners[k], corners[n]
                outward = ((cx + cy) * (high_z - low_z), (sx + sy) * (high_z - low_z), 2 * (low_r - high_r))
                self.polygon(material, [low[k], low[n], high[n], high[k]], outward)
        if "bottom" in caps:
            self.polygon(material, circles[0], (0, 0, -1))
        if "top" in caps:
            self.polygon(material, circles[-1], (0, 0, 1))
