"""A box room with boards in it. A ray's distance has a closed form for each plane."""

import numpy as np

# A board: corner, two edges at right angles.
ROOM = (np.array([-6.0, -5.0, -3.2]), np.array([7.5, 9.0, 4.1]))
BOARDS = [
    (np.array([2.0, 3.0, -2.0]), np.array([1.5, 1.5, 0.0]), np.array([0.0, 0.0, 2.5])),
    (np.array([-3.5, 4.0, -1.5]), np.array([1.2, 0.3, 0.0]), np.array([0.0, 0.0, 2.0])),
    (np.array([-1.0, -3.5, -2.5]), np.array([2.5, 0.0, 0.0]), np.array([0.0, -0.8, 1.6])),
]


def distances(origin, direction):
    """The distance to the first surface along each ray from inside the room."""
    low, high = ROOM
    with np.errstate(divide="ignore", invalid="ignore"):
        wall = np.where(direction > 0.0, high, low)
        along = np.where(direction == 0.0, np.inf, (wall - origin) / direction)
        nearest = along.min(axis=1)
        for corner, u, v in BOARDS:
            normal = np.cross(u, v)
            t = ((corner - origin) @ normal) / (direction @ normal)
            hit = origin + t[:, None] * direction - corner
            a = hit @ u / (u @ u)
            b = hit @ v / (v @ v)
            inside = (t > 0.0) & (a >= 0.0) & (a <= 1.0) & (b >= 0.0) & (b <= 1.0)
            nearest = np.where(inside & (t < nearest), t, nearest)
    return nearest
