"""What moves in the office, frame by frame: the door, the robot that drives through it, the plane above the desks."""

import math

from model_plane import headings
from robot import SHOULDER_Y, SHOULDER_Z, WHEEL_RADIUS, WHEEL_Y
from scene_writer import keys

FRAMES = 120
DOOR_HINGE = 8.27, 3.52
DOOR_OPENS = {0: 0, 34: 0, 62: -92}  # frame: degrees
# The robot's way: (frame, x, y) [m].
WAY = ((0, 1.2, 4.5), (25, 3.5, 4.5), (50, 5.9, 4.4), (74, 7.7, 4.02), (92, 9.2, 4.0), (119, 10.4, 3.3))


def catmull_rom(t, points):
    """Through (time, value) points, times not evenly spaced."""
    k = max(i for i in range(len(points) - 1) if points[i][0] <= t or i == 0)
    slopes = []
    for i in (k, k + 1):
        before, after = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        slopes.append((after[1] - before[1]) / (after[0] - before[0]))
    (t0, v0), (t1, v1) = points[k], points[k + 1]
    h, u = t1 - t0, (t - t0) / (t1 - t0)
    return ((1 + 2 * u) * (1 - u) ** 2 * v0 + u * (1 - u) ** 2 * h * slopes[0] +
            u * u * (3 - 2 * u) * v1 + u * u * (u - 1) * h * slopes[1])


def along_way(frame):
    return tuple(catmull_rom(frame, [(f, xy[axis]) for f, *xy in WAY]) for axis in (0, 1))


def tracks(positions, angles):
    """`angles`: about x, then y, then z."""
    return {"translate": keys(positions), "rotate": {"euler_degrees": keys(angles)}}


def part(pivot, swing):
    """A part that the robot's body carries, turned by `swing[frame]` degrees about y through `pivot`."""
    return {"parent": "robot_body", "pivot": list(pivot),
            "rotate": {"euler_degrees": keys([(0, angle, 0) for angle in swing])}}


def robot():
    ways = [along_way(frame) for frame in range(FRAMES)]
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(ways, ways[1:])]
    yaws = headings(steps + steps[-1:])
    gone = [0.0]
    for step in steps:
        gone.append(gone[-1] + math.hypot(*step))
    moves = {"robot_body": tracks([(x, y, 0) for x, y in ways], [(0, 0, yaw) for yaw in yaws])}
    look = [(0, 0, 35 * math.sin(2 * math.pi * frame / 60)) for frame in range(FRAMES)]
    moves["robot_head"] = {"parent": "robot_body", "rotate": {"euler_degrees": keys(look)}}
    for side, sign in (("left", 1), ("right", -1)):
        swing = [sign * 22 * math.sin(2 * math.pi * frame / 30) for frame in range(FRAMES)]
        moves[f"robot_arm_{side}"] = part((0, sign * SHOULDER_Y, SHOULDER_Z), swing)
        rolled = [math.degrees(metres / WHEEL_RADIUS) for metres in gone]
        moves[f"robot_wheel_{side}"] = part((0, sign * WHEEL_Y, WHEEL_RADIUS), rolled)
    return moves


def plane():
    """One round above the desks, banked into the curve."""
    turns = [2 * math.pi * frame / (FRAMES - 1) + 0.6 for frame in range(FRAMES)]
    places = [(4.2 + 2.7 * math.cos(a), 4.4 + 2.3 * math.sin(a), 2.1 + 0.25 * math.sin(2 * a)) for a in turns]
    yaws = headings((-2.7 * math.sin(a), 2.3 * math.cos(a)) for a in turns)
    return tracks(places, [(-20, 0, yaw) for yaw in yaws])


def door():
    return {"pivot": [*DOOR_HINGE, 0],
            "rotate": {"euler_degrees": keys({f: (0, 0, a) for f, a in DOOR_OPENS.items()})}}


def objects():
    return {"door": door(), "plane": plane(), **robot()}
