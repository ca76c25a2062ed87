"""Centre lines of cables that physics laid and pulled about, from a file.

The file is written by `python -m benchmarks.settled_cables`; perception knows no physics.
"""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perception.training.waypoints import hairpin_nodes, through

Points = NDArray[np.float64]

FILE = Path(__file__).parent / "settled.npz"
# Nodes to either side of a hairpin within which the line turns back.
HAIRPIN_NODES = 3
# Lines are smoothed over such lengths [cable widths]; smoothing blunts hairpins.
SMOOTHED, BARELY_SMOOTHED = (0.4, 0.9), (0.05, 0.6)


@cache
def settled_lines() -> tuple[Points, ...]:
    """Return centre lines in cable widths, shape (N, 2) each."""
    with np.load(FILE) as file:
        nodes_m = np.cumsum(file["steps"].astype(np.int64), axis=0) * float(file["unit_m"])
        lines = np.split(nodes_m[:, :2] / float(file["width_m"]), np.cumsum(file["counts"])[:-1])
    return tuple(lines)


@cache
def hairpins() -> tuple[tuple[int, int], ...]:
    """Return line and node numbers of places where a line turns back within a few widths."""
    return tuple(
        (number, int(node))
        for number, line in enumerate(settled_lines())
        for node in hairpin_nodes(line, HAIRPIN_NODES)
    )


def settled_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return one of the centre lines, turned, mirrored and scaled, some place of it in view."""
    lines = settled_lines()
    line = lines[int(rng.integers(len(lines)))]
    return _seen(rng, extent, line, None, SMOOTHED)


def hairpin_curve(rng: np.random.Generator, extent: float) -> Points:
    """Return the same, but with a place in view where the line turns back tightly."""
    number, node = hairpins()[int(rng.integers(len(hairpins())))]
    return _seen(rng, extent, settled_lines()[number], node, BARELY_SMOOTHED)


def _seen(
    rng: np.random.Generator,
    extent: float,
    line: Points,
    node: int | None,
    smoothed: tuple[float, float],
) -> Points:
    """Return a line turned, mirrored and scaled, with a node, or any, near the middle."""
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    scale = np.array([rng.uniform(0.7, 1.4), rng.choice([-1.0, 1.0]) * rng.uniform(0.7, 1.4)])
    middle = line[int(rng.integers(len(line))) if node is None else node]
    moved = ((line - middle) * scale) @ rotation.T
    return through(moved + rng.uniform(0.3, 0.7, 2) * extent, rng.uniform(*smoothed))
