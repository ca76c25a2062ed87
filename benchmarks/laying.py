"""Lay cables at random in a view: a piece of each first, tails of a given length after it.

All lengths are in cable widths of 6.6 mm. A piece may prescribe what is over and what under
at its crossings; tails wander with slowly changing curvature, as dropped cable lies.
"""

import math
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
# Between the middles of two knots, and from there to the margin.
BETWEEN, INSIDE = 36.0, 25.0
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
        over: Whether the cable is on top at each of its visits of crossings with itself, in
            order; nothing for as chance will have it.
    """

    points: Floats
    over: tuple[bool, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What one cable has to do with a knot.

    Attributes:
        cable: Number of the cable.
        points: Its waypoints from one side of the knot to the other, shape (N, 2).
        over: Whether it is on top at each of its visits of the knot's crossings, in order.
    """

    cable: int
    points: Floats
    over: tuple[bool, ...]


@dataclass(frozen=True, slots=True)
class Prescribed:
    """What is prescribed: for each pair of nodes, whether the earlier one is on top."""

    pairs: dict[tuple[float, float], bool]

    def __call__(self, first: float, second: float) -> bool | None:
        """Say so of one pair; None where nothing is prescribed."""
        return self.pairs.get((first, second))


def laid(
    rng: np.random.Generator,
    cores: Sequence[Core],
    lengths: Sequence[float],
    ties: Sequence[Sequence[Part]] = (),
) -> tuple[list[Floats], Prescribed] | None:
    """Lay cables of these lengths, grown from their cores.

    Args:
        rng: Source of all randomness.
        cores: What is laid first of each cable.
        lengths: How long the cables are [cable widths].
        ties: Knots that lie within the cores and tie several cables together; of each, its
            parts by the numbers of their cables.

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
    knots = [*ties, *([Part(k, c.points, c.over)] for k, c in enumerate(cores) if c.over)]
    known = _prescribed(knots, lines)
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


def apart(rng: np.random.Generator, count: int) -> Floats:
    """Return places for knots, apart from each other and well within the view, shape (N, 2)."""
    while True:
        places = rng.uniform(LOW + INSIDE, HIGH - INSIDE, (count, 2))
        gaps = np.linalg.norm(places[:, None] - places[None], axis=2)
        if (gaps + 2.0 * BETWEEN * np.eye(count) > BETWEEN).all():
            return places


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
    (x, y), curvature = core[-1], 0.0
    heading = float(np.arctan2(*(core[-1] - core[-2])[::-1]))
    noise = rng.normal(0.0, CURVATURE * np.sqrt(1.0 - MEMORY**2), max(int(length / STEP), 1))
    points = []
    for change in noise:
        curvature = MEMORY * curvature + change + _inwards(x, y, heading)
        curvature = min(max(curvature, -1.0 / TIGHTEST), 1.0 / TIGHTEST)
        heading += curvature * STEP
        x, y = x + STEP * math.cos(heading), y + STEP * math.sin(heading)
        points.append((x, y))
    return np.array(points)


def _inwards(x: float, y: float, heading: float) -> float:
    """Return how much to turn more, so as not to leave the area."""
    inwards = _excess(x, LOW[0], HIGH[0]), _excess(y, LOW[1], HIGH[1])
    pull = math.hypot(*inwards)
    if pull == 0.0:
        return 0.0
    wanted = math.atan2(inwards[1], inwards[0])
    off = (wanted - heading + math.pi) % (2.0 * math.pi) - math.pi
    return math.copysign(0.25 * pull * min(abs(off), 1.0), off)


def _excess(at: float, low: float, high: float) -> float:
    """Return how far a place is beyond the lower border, less how far beyond the upper one."""
    below, above = (low + BORDER - at) / BORDER, (at - high + BORDER) / BORDER
    return min(max(below, 0.0), 1.0) - min(max(above, 0.0), 1.0)


def _prescribed(knots: Sequence[Sequence[Part]], lines: Sequence[Floats]) -> Prescribed | None:
    """Return over and under of all knots; None where lines do not cross as the knots should."""
    xy, cable = _numbered(lines)
    starts = np.searchsorted(cable, np.arange(len(lines)))
    found = contact.crossings(xy, cable)
    pairs: dict[tuple[float, float], bool] = {}
    for parts in knots:
        spans = [starts[part.cable] + span(part, lines[part.cable]) for part in parts]
        within = sum((found >= low) & (found <= high) for low, high in spans) > 0
        mine = [(float(a), float(b)) for a, b in found[within.all(axis=1)]]
        visits = sorted((at, pair) for pair in mine for at in pair)
        over = [on_top for part in parts for on_top in part.over]
        if len(visits) != len(over):
            return None
        on_top_at = {at: on_top for (at, _), on_top in zip(visits, over, strict=True)}
        if any(on_top_at[a] == on_top_at[b] for a, b in mine):
            return None
        pairs |= {pair: on_top_at[pair[0]] for pair in mine}
    return Prescribed(pairs)


def _is_semi_planar(lines: Sequence[Floats]) -> bool:
    """Say whether no more than two strands lie upon each other anywhere."""
    places = np.vstack(lines)[contact.crossings(*_numbered(lines))[:, 0].astype(int)]
    return len(places) < 2 or not cKDTree(places).query_pairs(SEMI_PLANAR)


def _numbered(lines: Sequence[Floats]) -> tuple[Floats, NDArray[np.int64]]:
    """Return the nodes of all cables, and which cable each belongs to."""
    return np.vstack(lines), np.repeat(np.arange(len(lines)), [len(line) for line in lines])


def span(core: Core | Part, line: Floats) -> NDArray[np.int64]:
    """Return the nodes at which a core, or a part, begins and ends in its line."""
    ends = [int(np.linalg.norm(line - end, axis=1).argmin()) for end in core.points[[0, -1]]]
    return np.array(sorted(ends))
