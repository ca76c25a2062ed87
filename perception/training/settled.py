"""Centre lines of cables that physics laid and pulled about, from a file.

The file is written by `python -m benchmarks.settled_cables`; perception knows no physics.
"""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perception.training.waypoints import through

Points = NDArray[np.float64]

FILE = Path(__file__).parent / "settled.npz"


@cache
def settled_lines() -> tuple[Points, ...]:
    """Return centre lines in cable widths, shape (N, 2) each."""
    with np.load(FILE) as file:
        nodes_m = np.cumsum(file["steps"].astype(np.int64), axis=0) * float(file["unit_m"])
        lines = np.split(nodes_m[:, :2] / float(file["width_m"]), np.cumsum(file["counts"])[:-1])
    return tuple(lines)


def settled_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return one of the centre lines, turned, mirrored and scaled, some place of it in view."""
    lines = settled_lines()
    line = lines[int(rng.integers(len(lines)))]
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    scale = np.array([rng.uniform(0.7, 1.4), rng.choice([-1.0, 1.0]) * rng.uniform(0.7, 1.4)])
    moved = ((line - line[int(rng.integers(len(line)))]) * scale) @ rotation.T
    return through(moved + rng.uniform(0.3, 0.7, 2) * extent, rng.uniform(0.4, 0.9))
