"""Places where strands meet in drawn scenes, seen along lines with the errors of traces."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from perception.cable.classifiers.passes import StrandPass
from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import intersections
from perception.cable.tracers.centre_line import tangents
from perception.models.frames import Floats
from perception.training.contact import near_pairs
from perception.training.scenes import Scene

# Nodes of scenes are half a cable width apart.
SPACING_WIDTHS = 0.5
REACH_NODES = 14
# Errors move a crossing along its strands by no more than this, and merge what is as near.
MOVED_NODES = 5.0
# Strands closer than this touch [cable widths].
BESIDE = 1.35
# Nearer than this along one cable, strands are its bend.
LEAST_LOOP_NODES = 10
LEAST_EXCHANGE_NODES = 6
TRIES = 5
# Touching strands that part at more than this angle would have to cross.
MOST_ALIKE_SINE = 0.7


@dataclass(frozen=True, slots=True)
class MeetingConfig:
    """How lines err, and how many meetings a scene gives.

    Attributes:
        aside: Largest standard deviation of how far lines lie aside [cable widths].
        drift: Over which lengths that changes [cable widths].
        jitter: Largest standard deviation of single points [cable widths].
        coarse: Share of lines that keep one node in four, as steps of a tracer do.
        most: Most crossings of a scene.
        exchanged: Most places of a scene where lines go over from one strand to the other.
    """

    aside: float = 0.16
    drift: tuple[float, float] = (0.7, 3.0)
    jitter: float = 0.08
    coarse: float = 0.4
    most: int = 24
    exchanged: int = 4


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """Two lines that cross somewhere.

    Attributes:
        passes: Both lines; where the strands really cross, the first one is on top.
        real: Whether strands cross there; else the lines go over from one to the other.
    """

    passes: tuple[StrandPass, StrandPass]
    real: bool


def meetings(
    rng: np.random.Generator, scene: Scene, config: MeetingConfig | None = None
) -> list[Meeting]:
    """Return meetings of a scene in its pixels; crossings first, then exchanges."""
    config = config or MeetingConfig()
    lines = [cable.points_px for cable in scene.cables]
    found = list(_crossings(rng, scene, lines, config))[: config.most]
    return found + list(_exchanges(rng, scene, lines, config))[: config.exchanged]


def _crossings(
    rng: np.random.Generator, scene: Scene, lines: list[Floats], config: MeetingConfig
) -> Iterator[Meeting]:
    for index in rng.permutation(len(scene.crossings)):
        crossing = scene.crossings[index]
        if not _in_view(scene, lines[crossing.over[0]][int(crossing.over[1])]):
            continue
        strands = [_piece(lines[cable], node) for cable, node in (crossing.over, crossing.under)]
        erring = _erring(rng, strands, scene.width_px, config)
        true = _near(strands)
        passes = _crossing_of(erring, true.meeting, true.turns.tolist())
        if passes is not None:
            yield Meeting(passes, real=True)


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """Part of a line, and the node of it where a meeting is."""

    points: Floats
    node: float


def _piece(line: Floats, node: float) -> _Piece:
    first = max(int(node) - REACH_NODES, 0)
    return _Piece(line[first : int(node) + REACH_NODES + 2], node - first)


def _erring(
    rng: np.random.Generator, pieces: Sequence[_Piece], width_px: float, config: MeetingConfig
) -> list[_Piece]:
    """Return lines as a tracer would see them."""
    return [_erring_piece(rng, piece, width_px, config) for piece in pieces]


def _erring_piece(
    rng: np.random.Generator, piece: _Piece, width_px: float, config: MeetingConfig
) -> _Piece:
    line = erring_line(rng, piece.points, width_px, config)
    if len(line) > 12 and rng.random() < config.coarse:
        first = int(rng.integers(4))
        return _Piece(line[first::4], (piece.node - first) / 4.0)
    return _Piece(line, piece.node)


def erring_line(
    rng: np.random.Generator, points: Floats, width_px: float, config: MeetingConfig
) -> Floats:
    """Return a line that lies aside of the true one here and there, as traces do.

    Args:
        rng: Source of all randomness.
        points: The true line, with nodes half a cable width apart, shape (N, 2).
        width_px: Width of the cable.
        config: How far lines err.
    """
    drift = rng.uniform(*config.drift) / SPACING_WIDTHS
    aside = gaussian_filter1d(rng.normal(size=len(points)), drift, mode="nearest")
    # Smoothing takes this share of white noise's deviation away.
    aside *= np.sqrt(2.0 * drift * np.sqrt(np.pi)) * config.aside * rng.random() * width_px
    along = tangents(points, 2)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    jitter = rng.normal(0.0, config.jitter * rng.random() * width_px, points.shape)
    line: Floats = points + aside[:, None] * across + jitter
    return line


@dataclass(frozen=True, slots=True, eq=False)
class _Near:
    """Where two lines cross near their meeting, in the order of the first.

    Attributes:
        arcs: Arc lengths on both lines, shape (2, K).
        turns: To which side the second line crosses, shape (K,).
        meeting: Which of them is nearest to the meeting; 0 without any.
    """

    arcs: Floats
    turns: NDArray[np.int64]
    meeting: int


def _near(pieces: Sequence[_Piece]) -> _Near:
    *nodes, turns = intersections(pieces[0].points, pieces[1].points)
    at = np.array([_arc(piece, found) for piece, found in zip(pieces, nodes, strict=True)])
    here = np.array([_arc(piece, np.array([piece.node])) for piece in pieces])
    reach = MOVED_NODES * float(arc_lengths(pieces[0].points)[-1]) / (2.0 * REACH_NODES)
    gaps = np.abs(at - here).max(axis=0, initial=0.0)
    near = np.flatnonzero(gaps < reach)
    near = near[np.argsort(at[0, near])]
    return _Near(at[:, near], turns[near], int(gaps[near].argmin()) if len(near) else 0)


def _crossing_of(
    pieces: Sequence[_Piece], meeting: int = 0, turns: Sequence[int] = (0,)
) -> tuple[StrandPass, StrandPass] | None:
    """Return where two lines cross near their meeting, None where errors have parted them.

    Args:
        pieces: Both lines.
        meeting: Which of the true crossings near there is meant.
        turns: To which sides the second strand really crosses near there.
    """
    if min(len(piece.points) for piece in pieces) < 3:
        return None
    found = _near(pieces)
    if len(turns) > 1:
        # Neighbours are told apart only where errors have left all of them.
        if list(found.turns) != list(turns):
            return None
        which = meeting
    elif len(found.turns) % 2 == 1:
        which = len(found.turns) // 2
    else:
        return None
    first, second = (
        StrandPass(piece.points, float(arc))
        for piece, arc in zip(pieces, found.arcs[:, which], strict=True)
    )
    return first, second


def _arc(piece: _Piece, nodes: Floats) -> Floats:
    arcs = arc_lengths(piece.points)
    return np.interp(nodes, np.arange(len(arcs), dtype=float), arcs)


def _exchanges(
    rng: np.random.Generator, scene: Scene, lines: list[Floats], config: MeetingConfig
) -> Iterator[Meeting]:
    """Yield places where strands touch, with lines that go over from one to the other."""
    widths = np.vstack(lines) / scene.width_px
    cable = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    starts = np.searchsorted(cable, np.arange(len(lines)))
    pairs = near_pairs(widths, cable)
    touching = np.linalg.norm(widths[pairs[:, 0]] - widths[pairs[:, 1]], axis=1) < BESIDE
    far = (np.diff(pairs, axis=1)[:, 0] > LEAST_LOOP_NODES) | (np.diff(cable[pairs])[:, 0] > 0)
    for pair in rng.permutation(pairs[touching & far])[: TRIES * config.exchanged]:
        if not _in_view(scene, widths[pair[0]] * scene.width_px):
            continue
        strands = [_piece(lines[cable[node]], float(node - starts[cable[node]])) for node in pair]
        exchanged = _gone_over(rng, *strands)
        if exchanged is None:
            continue
        passes = _crossing_of(_erring(rng, exchanged, scene.width_px, config))
        if passes is not None:
            yield Meeting(passes, real=False)


def _gone_over(
    rng: np.random.Generator, one: _Piece, other: _Piece
) -> tuple[_Piece, _Piece] | None:
    """Return lines that change over from each strand to the other; None where these cross."""
    along, beside = (tangents(piece.points, 2)[int(piece.node)] for piece in (one, other))
    if abs(along[0] * beside[1] - along[1] * beside[0]) > MOST_ALIKE_SINE:
        return None
    if along @ beside < 0.0:
        other = _Piece(other.points[::-1], len(other.points) - 1 - other.node)
    before = min(int(one.node), int(other.node))
    after = min(len(piece.points) - int(piece.node) for piece in (one, other))
    if min(before, after) < LEAST_EXCHANGE_NODES:
        return None
    a, b = (
        piece.points[int(piece.node) - before : int(piece.node) + after] for piece in (one, other)
    )
    if len(intersections(a, b)[0]):
        return None
    steps = np.arange(-before, after) / rng.uniform(0.5, 3.0)
    share = (1.0 / (1.0 + np.exp(-steps)))[:, None]
    return (
        _Piece(a * (1.0 - share) + b * share, float(before)),
        _Piece(b * (1.0 - share) + a * share, float(before)),
    )


def _in_view(scene: Scene, place: Floats) -> bool:
    size = np.array(scene.image.shape[::-1])
    return bool((place > 0.0).all() and (place < size - 1.0).all())
