"""What is believed about cables in one image.

Image points are (x, y) in pixels. Arc positions are fractions of a trace's length in [0, 1].
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


class TraceEnd(StrEnum):
    """Why a trace ended."""

    ENDPOINT = "endpoint"
    EDGE = "edge"
    RETRACE = "retrace"
    LOST = "lost"


# A trace that starts at an end has its second point so far into the cable.
AHEAD_PX = 4.0
# How much a trace that ends like this can tell about the whole cable.
COMPLETENESS = {
    TraceEnd.ENDPOINT: 1.0,
    TraceEnd.EDGE: 0.6,
    TraceEnd.LOST: 0.4,
    TraceEnd.RETRACE: 0.2,
}


@dataclass(frozen=True, slots=True, eq=False)
class Endpoint:
    """One end of a cable.

    Attributes:
        position_px: Where the cable itself ends (or its connector starts), shape (2,).
        direction: Unit vector from the end into the cable, shape (2,).
        probability: Belief that this is an end of a cable.
    """

    position_px: Points
    direction: Points
    probability: float


@dataclass(frozen=True, slots=True, eq=False)
class TraceStart:
    """First points of a trace, and the end that they come from.

    Attributes:
        points_px: Points in order from the end into the cable, shape (N, 2).
        endpoint: The end that tracing starts from.
    """

    points_px: Points
    endpoint: Endpoint

    @classmethod
    def at(cls, endpoint: Endpoint) -> "TraceStart":
        """Return an end and a point a little into the cable, which says which way to go."""
        ahead_px = endpoint.position_px + AHEAD_PX * endpoint.direction
        return cls(np.stack([endpoint.position_px, ahead_px]), endpoint)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """The path of one cable.

    Attributes:
        points_px: Ordered centre line, shape (N, 2).
        end: Why it ended.
        probability: Belief that it follows one cable from its start to its end.
    """

    points_px: Points
    end: TraceEnd
    probability: float


@dataclass(frozen=True, slots=True, eq=False)
class ImaginedHand:
    """What one hand would do to a cable.

    Attributes:
        role: Whether it holds the cable, or lets it slide.
        arc: Arc position where it takes it, in [0, 1].
        to_m: Where on the table it goes with it, shape (2,).
        lets_go: Share of its way after which it opens and stays; 1 for at its end.
    """

    role: Literal["pinch", "cage"]
    arc: float
    to_m: Points
    lets_go: float = 1.0


@dataclass(frozen=True, slots=True)
class Coverage:
    """How much of the cable in view a trace accounts for.

    Attributes:
        share: Share of the cable's pixels that lie along it, in [0, 1]; 1 where there are none.
        left_px: Pixels of the largest piece of cable away from it.
    """

    share: float
    left_px: int


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """One place where a strand lies over another.

    Attributes:
        position_px: Where, shape (2,).
        trace_over: Index of the upper strand's trace.
        arc_over: Arc position on it.
        trace_under: Index of the lower strand's trace.
        arc_under: Arc position on it.
        probability: Belief that over and under are this way round, in [0.5, 1].
    """

    position_px: Points
    trace_over: int
    arc_over: float
    trace_under: int
    arc_under: float
    probability: float


@dataclass(frozen=True, slots=True, eq=False)
class Knot:
    """One knot on a trace, and where to hold it to loosen it.

    Attributes:
        trace: Index of the trace.
        interval: Arc positions of its first (under) and last (over) visit of the crossing
            that closes it.
        first_undercrossing_px: Where it begins, shape (2,).
        cage_px: Where a caging gripper lets the cable slide, shape (2,).
        pinch_px: Where a pinching gripper holds the cable, shape (2,).
        cage_direction: Unit tangent of the cable at the cage point, shape (2,).
        pinch_direction: Unit tangent of the cable at the pinch point, shape (2,).
    """

    trace: int
    interval: tuple[float, float]
    first_undercrossing_px: Points
    cage_px: Points
    pinch_px: Points
    cage_direction: Points
    pinch_direction: Points


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """One way to read one cable.

    Attributes:
        trace: The path; its probability is the belief that this reading is right.
        crossings: Its crossings with itself.
    """

    trace: Trace
    crossings: tuple[Crossing, ...]


@dataclass(frozen=True, slots=True)
class KnotBelief:
    """How likely a cable holds a knot.

    Attributes:
        name: The knot as `perception.cable.topology.names` names it, with its ends joined
            over everything; `0_1` for no knot, `unknown` where the cable was not read.
        probability: Belief in it.
    """

    name: str
    probability: float


class QuestionKind(StrEnum):
    """What may be asked about an image."""

    CROSSING = "crossing"  # Which strand is on top?
    PATH = "path"  # Which way does the cable go on?


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """Something unsure, and how much its answer would tell.

    Attributes:
        kind: Whether over and under or the way of the cable is asked for.
        position_px: Where to look, shape (2,).
        bits: By how much the answer lowers the entropy of the belief, on average.
    """

    kind: QuestionKind
    position_px: Points
    bits: float


@dataclass(frozen=True, slots=True, eq=False)
class CableScene:
    """Everything that is believed about one image.

    Attributes:
        traces: Cables, the traced one first.
        endpoints: Ends that were seen.
        crossings: Crossings in the order of the first trace.
        knots: Knots in the order of the first trace.
        knotted_probability: Belief that at least one cable is knotted.
        seconds: Time it took [s].
        knot_types: Beliefs in the knot of the first trace, the likeliest first.
        telling: What to look at to learn most about whether a cable is knotted.
    """

    traces: tuple[Trace, ...]
    endpoints: tuple[Endpoint, ...]
    crossings: tuple[Crossing, ...]
    knots: tuple[Knot, ...]
    knotted_probability: float
    seconds: float
    knot_types: tuple[KnotBelief, ...] = ()
    telling: Question | None = None


@dataclass(frozen=True, slots=True)
class CableClaim:
    """What a mission says about the cable at its end.

    Attributes:
        untangled: Whether it says that no knot is left.
        knotted_probability: Belief that a knot is left.
    """

    untangled: bool
    knotted_probability: float
