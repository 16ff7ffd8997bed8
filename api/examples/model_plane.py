"""The model plane that flies through the examples: four boxes, nose along +x, wing span 4 m."""

import math

BOXES = {
    "fuselage": ((-1.6, -0.22, -0.2), (1.6, 0.22, 0.25)),
    "wing": ((-0.35, -2, -0.04), (0.55, 2, 0.04)),
    "tailplane": ((-1.6, -0.75, 0.12), (-1.1, 0.75, 0.18)),
    "fin": ((-1.6, -0.03, 0.25), (-1.05, 0.03, 0.85)),
}


def add_plane(obj, scale=1):
    obj.object("plane")
    obj.material("plane")
    for part, corners in BOXES.items():
        obj.lines.append(f"# {part}")
        obj.box(*(tuple(scale * x for x in corner) for corner in corners))


def headings(velocities):
    """Yaw [degrees] along each (dx, dy), without jumps from one to the next."""
    yaws = []
    for dx, dy in velocities:
        yaw = math.degrees(math.atan2(dy, dx))
        if yaws:
            yaw += 360 * round((yaws[-1] - yaw) / 360)
        yaws.append(yaw)
    return yaws
