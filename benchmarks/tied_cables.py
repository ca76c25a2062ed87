"""Cables that are tied to each other: cores that lead through one knot, or through two."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.laying import WIDTH_M, Core, Part, apart, turned
from perception.training.waypoints import resample
from simulation.cable.knots import PAIRS

Floats = NDArray[np.float64]

# Which cables the first, the second and the third knot tie together.
PARTNERS = ((0, 1), (1, 2), (0, 2))
# From one knot to the next a cable bends out by this share of the way.
BOWS = (0.35, 0.8)
WAYPOINTS = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Tie:
    """A knot in two cables, in place.

    Attributes:
        cables: Which two.
        lines: Their waypoints, shape (N, 2) each.
        over: For each, whether it is on top at each visit.
    """

    cables: tuple[int, int]
    lines: tuple[Floats, Floats]
    over: tuple[tuple[bool, ...], tuple[bool, ...]]


def tied(
    rng: np.random.Generator, knots: int, diameters: tuple[float, float]
) -> tuple[list[Core], list[list[Part]]]:
    """Return cores of three cables that one to three knots tie together, and the knots.

    Args:
        rng: Source of all randomness.
        knots: How many.
        diameters: Least and greatest size of a knot [cable widths].
    """
    places = apart(rng, knots)
    ties = [_tie(rng, PARTNERS[k], diameters, places[k]) for k in range(knots)]
    parts: list[list[Part]] = [[] for _ in ties]
    cores = []
    for cable in range(3):
        own = [(k, tie.cables.index(cable)) for k, tie in enumerate(ties) if cable in tie.cables]
        pieces = [_either_way(rng, ties[k].lines[side], ties[k].over[side]) for k, side in own]
        for (k, _), (points, over) in zip(own, pieces, strict=True):
            parts[k].append(Part(cable, points, over))
        cores.append(Core(_joined(rng, [points for points, _ in pieces])))
    return cores, parts


def _tie(
    rng: np.random.Generator, cables: tuple[int, int], diameters: tuple[float, float], at: Floats
) -> Tie:
    name = list(PAIRS)[int(rng.integers(len(PAIRS)))]
    pair, mirrored = PAIRS[name], bool(rng.random() < 0.5)
    size = max(float(rng.uniform(*diameters)), pair.least_diameter_m(WIDTH_M) / WIDTH_M)
    first, second = pair.curves_m(size, WAYPOINTS)
    both = turned(rng, np.vstack([first, second]) * (1.0, rng.choice([-1.0, 1.0])))
    over = tuple(tuple(on_top != mirrored for on_top in line) for line in pair.over)
    return Tie(cables, (at + both[: len(first)], at + both[len(first) :]), (over[0], over[1]))


def _either_way(
    rng: np.random.Generator, line: Floats, over: tuple[bool, ...]
) -> tuple[Floats, tuple[bool, ...]]:
    return (line, over) if rng.random() < 0.5 else (line[::-1], over[::-1])


def _joined(rng: np.random.Generator, pieces: list[Floats]) -> Floats:
    """Return one line through all pieces; a straight one anywhere where there are none."""
    if not pieces:
        straight = np.array([[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]])
        return np.asarray(apart(rng, 1)[0] + turned(rng, straight))
    line = pieces[0]
    for piece in pieces[1:]:
        line = np.vstack([line, _bow(rng, line, piece), piece])
    return line


def _bow(rng: np.random.Generator, before: Floats, after: Floats) -> Floats:
    """Return a way from the end of one line to the start of another, without a kink."""
    ends = np.array([before[-1], after[0]])
    ways = np.array([before[-1] - before[-2], after[1] - after[0]])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    reach = 3.0 * rng.uniform(*BOWS, (2, 1)) * np.linalg.norm(ends[1] - ends[0])
    t = np.linspace(0.0, 1.0, 60)[:, None]
    # The cubic with these ends and slopes (Hermite).
    line = (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * ends[0] + t * (1.0 - t) ** 2 * reach[0] * ways[0]
        + t**2 * (3.0 - 2.0 * t) * ends[1] - t**2 * (1.0 - t) * reach[1] * ways[1]
    )  # fmt: skip
    return resample(line, 2.0 * WAYPOINTS)[1:-1]
