"""Lay cables at random in a view: a piece of each first, tails of a given length after it.

All lengths are in cable widths of 6.6 mm. A piece may prescribe what is over and what under
at its crossings; tails wander with slowly changing curvature, as dropped cable lies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from perception.training import contact
from perception.training.scenes import SceneConfig
from perception.training.waypoints import through

Floats = NDArray[np.float64]

WIDTH_M = 0.0066
CONFIG = SceneConfig(
    extent=180.0,
    size_px=(773, 1032),
    narrowest_px=5.0,
    widest_px=5.6,
    bright=True,
    style="photograph",
    alike=True,
)
# What of the square of that extent the camera sees, less a margin.
LOW, HIGH = np.array([6.0, 28.0]), np.array([174.0, 152.0])
STEP = 3.0
# Typical curvature of cable on a table, and how fast it changes; its least radius.
CURVATURE, MEMORY, TIGHTEST = 1.0 / 18.0, 0.8, 5.0
BORDER = 22.0
GROWTHS = 40
# No strand is nearer than this to the last nodes of a cable; crossings are this far apart.
END_NODES, CLEARANCE = 14, 3.5
SEMI_PLANAR = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Core:
    """A piece of one cable that is laid first.

    Attributes:
        points: Waypoints, shape (N, 2).
        over: Whether the cable is on top at each of its visits in order: of crossings with
            itself, or where `other` is given of those with another core.
        other: Which core that is.
    """

    points: Floats
    over: tuple[bool, ...] = ()
    other: int | None = None


@dataclass(frozen=True, slots=True)
class Prescribed:
    """What is prescribed: for each pair of nodes, whether the earlier one is on top."""

    pairs: dict[tuple[float, float], bool]

    def __call__(self, first: float, second: float) -> bool | None:
        """Say so of one pair; None where nothing is prescribed."""
        return self.pairs.get((first, second))


def laid(
    rng: np.random.Generator, cores: Sequence[Core], lengths: Sequence[float]
) -> tuple[list[Floats], Prescribed] | None:
    """Lay cables of these lengths, grown from their cores.

    Returns:
        Their lines and what is prescribed of their crossings; None where some end finds no
        room, or lines do not cross as their cores should.
    """
    lines: list[Floats] = []
    for core, length in zip(cores, lengths, strict=True):
        tries = (grown(rng, core.points, length) for _ in range(GROWTHS))
        line = next((line for line in tries if fits(line, lines)), None)
        if line is None:
            return None
        lines.append(line)
    known = _prescribed(cores, lines)
    return None if known is None else (lines, known)


def fits(line: Floats, others: Sequence[Floats]) -> bool:
    """Say whether a cable lies in view, and neither hides ends nor has hidden ends itself."""
    if (line < LOW - 3.0).any() or (line > HIGH + 3.0).any():
        return False
    rest = np.vstack([line[END_NODES + 12 : -END_NODES - 12], *others])
    own = np.vstack([line[:END_NODES], line[-END_NODES:]])
    ends = [np.vstack([other[:END_NODES], other[-END_NODES:]]) for other in others]
    if not _apart(own, rest) or not all(_apart(end, line) for end in ends):
        return False
    return _is_semi_planar([*others, line])


def _apart(ends: Floats, rest: Floats) -> bool:
    gaps, _ = cKDTree(rest).query(ends)
    return bool(gaps.min() > CLEARANCE)


def turned(rng: np.random.Generator, points: Floats) -> Floats:
    """Return points turned at random about the origin."""
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.asarray(points @ rotation.T)


def grown(rng: np.random.Generator, core: Floats, length: float) -> Floats:
    """Return a cable of a length, grown from its core to both sides, as nodes."""
    there = float(np.linalg.norm(np.diff(core, axis=0), axis=1).sum())
    if there >= length - 2.0 * STEP:
        return core
    left = length - there
    first = rng.uniform(0.3, 0.7) * left
    head, tail = _walk(rng, core[::-1], first), _walk(rng, core, left - first)
    return through(np.vstack([head[::-1], core, tail]), 0.8)


def _walk(rng: np.random.Generator, core: Floats, length: float) -> Floats:
    """Return waypoints that lead on from the last point of a core, and stay in the area."""
    here, curvature = core[-1], 0.0
    heading = float(np.arctan2(*(core[-1] - core[-2])[::-1]))
    points = []
    for _ in range(max(int(length / STEP), 1)):
        noise = rng.normal(0.0, CURVATURE * np.sqrt(1.0 - MEMORY**2))
        curvature = MEMORY * curvature + noise + _inwards(here, heading)
        curvature = float(np.clip(curvature, -1.0 / TIGHTEST, 1.0 / TIGHTEST))
        heading += curvature * STEP
        here = here + STEP * np.array([np.cos(heading), np.sin(heading)])
        points.append(here)
    return np.array(points)


def _inwards(here: Floats, heading: float) -> float:
    """Return how much to turn more, so as not to leave the area."""
    excess = np.clip((LOW + BORDER - here) / BORDER, 0.0, 1.0)
    excess -= np.clip((here - HIGH + BORDER) / BORDER, 0.0, 1.0)
    pull = float(np.linalg.norm(excess))
    if pull == 0.0:
        return 0.0
    wanted = float(np.arctan2(excess[1], excess[0]))
    off = float((wanted - heading + np.pi) % (2.0 * np.pi) - np.pi)
    return 0.25 * pull * float(np.sign(off)) * min(abs(off), 1.0)


def _prescribed(cores: Sequence[Core], lines: Sequence[Floats]) -> Prescribed | None:
    """Return over and under of all cores; None where lines do not cross as their cores should."""
    xy, cable = _numbered(lines)
    starts = np.searchsorted(cable, np.arange(len(lines)))
    found = contact.crossings(xy, cable)
    spans = [
        starts[k] + span(core, line)
        for k, (core, line) in enumerate(zip(cores, lines, strict=True))
    ]
    pairs: dict[tuple[float, float], bool] = {}
    for number, core in enumerate(cores):
        if not core.over:
            continue
        other = number if core.other is None else core.other
        mine = [pair for pair in found if _joins(pair, spans[number], spans[other])]
        visits = sorted(
            (float(at), (float(a), float(b)))
            for a, b in mine
            for at in ((a, b) if other == number else ((a,) if number < other else (b,)))
        )
        if len(visits) != len(core.over):
            return None
        for (at, pair), on_top in zip(visits, core.over, strict=True):
            pairs[pair] = on_top if at == pair[0] else not on_top
    return Prescribed(pairs)


def _is_semi_planar(lines: Sequence[Floats]) -> bool:
    """Say whether no more than two strands lie upon each other anywhere."""
    places = np.vstack(lines)[contact.crossings(*_numbered(lines))[:, 0].astype(int)]
    return len(places) < 2 or not cKDTree(places).query_pairs(SEMI_PLANAR)


def _numbered(lines: Sequence[Floats]) -> tuple[Floats, NDArray[np.int64]]:
    """Return the nodes of all cables, and which cable each belongs to."""
    return np.vstack(lines), np.repeat(np.arange(len(lines)), [len(line) for line in lines])


def span(core: Core, line: Floats) -> NDArray[np.int64]:
    """Return the nodes at which a core begins and ends in its line."""
    ends = [int(np.linalg.norm(line - end, axis=1).argmin()) for end in core.points[[0, -1]]]
    return np.array(sorted(ends))


def _joins(pair: Floats, one: NDArray[np.int64], other: NDArray[np.int64]) -> bool:
    """Say whether a crossing lies within both spans, either way round."""
    a, b = pair
    return bool(
        (one[0] <= a <= one[1] and other[0] <= b <= other[1])
        or (one[0] <= b <= one[1] and other[0] <= a <= other[1])
    )
