"""What a search for cage and pinch points works on, and what it answers.

Two searches do: `grasp_room` wants room for fingers, `grasp_tusk` is the thesis's. Both get the
strand prepared here and the knot's first and last visit on it, in pixels along the strand.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Crossing, Points, Trace


@dataclass(frozen=True, slots=True)
class GraspConfig:
    """Settings of the search for grasp points.

    Attributes:
        policy: `room` for our search; `tusk` for the thesis's, which goes by what is cable
            around a point, in units of the cable's width.
        room_px: Wanted distance to other strands, for two fingers of about 12 mm.
        crossing_px: Wanted distance to crossings along the strand.
        apart_px: Smallest distance between cage and pinch.
        own_px: Cable nearer than this along the trace is the held piece itself.
        farther_px: How far the search goes on beyond its region when that has no room.
    """

    policy: Literal["room", "tusk"] = "room"
    room_px: float = 18.0
    crossing_px: float = 20.0
    apart_px: float = 60.0
    own_px: float = 36.0
    farther_px: float = 260.0


class GraspFlaw(StrEnum):
    """Why grasp points are not good ones, though the best that were found."""

    PINCH_CROWDED = "no place to pinch has room around it"
    CAGE_CROWDED = "no place to cage has room around it"
    TOO_CLOSE = "cage and pinch are nearer to each other than two hands can be"


@dataclass(frozen=True, slots=True)
class CagePinch:
    """Where to hold a knot.

    Attributes:
        cage_px: Where the caging hand takes the strand, in pixels along it.
        pinch_px: Where the pinching hand does.
        flaw: Why that is not a good grasp; None where it is one.
    """

    cage_px: float
    pinch_px: float
    flaw: GraspFlaw | None


class GraspPolicy(Protocol):
    """A search for cage and pinch points."""

    def choose(self, strand: "HeldStrand", begin_px: float, end_px: float) -> CagePinch:
        """Return the best points of a knot, with what is wrong with them.

        Args:
            strand: The strand that the knot is in.
            begin_px: Where the knot begins: it runs under another strand.
            end_px: Where it ends: it runs over that strand.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class CablePixels:
    """What is cable in an image.

    Attributes:
        cable: Which pixels are, shape (height, width).
        width_px: Width of the cable.
    """

    cable: NDArray[np.bool_]
    width_px: float


@dataclass(frozen=True, slots=True, eq=False)
class HeldStrand:
    """A trace prepared for grasping.

    Attributes:
        line: Its points, shape (N, 2).
        arcs: Length up to each of them [px], shape (N,).
        others: Points of all other traces, shape (M, 2).
        crossings_px: Where it crosses anything, in pixels along it.
        unders_px: Where it does so below, growing.
    """

    line: Points
    arcs: Points
    others: Points
    crossings_px: Points
    unders_px: Points

    @property
    def length_px(self) -> float:
        """Length of the strand."""
        return float(self.arcs[-1])

    def point(self, at_px: float) -> Points:
        """Return the point of the strand there, shape (2,)."""
        return point_at(self.line, self.arcs, at_px)

    def clearance_px(self, at_px: float, config: GraspConfig) -> float:
        """Return the distance to the nearest other strand, reduced near crossings."""
        return float(self.clearances_px(np.array([at_px]), config)[0])

    def clearances_px(self, at_px: Points, config: GraspConfig) -> Points:
        """Return that distance at many places of the strand, shape (K,)."""
        here = point_at(self.line, self.arcs, at_px)
        gaps_px = np.linalg.norm(self.line[None] - here[:, None], axis=2)
        gaps_px[np.abs(self.arcs[None] - at_px[:, None]) <= config.own_px] = np.inf
        near_px = gaps_px.min(axis=1)
        if len(self.others):
            aside_px = np.linalg.norm(self.others[None] - here[:, None], axis=2)
            near_px = np.minimum(near_px, aside_px.min(axis=1))
        along_px = np.abs(self.crossings_px[None] - at_px[:, None]).min(axis=1, initial=np.inf)
        clearances: Points = np.minimum(near_px, along_px * config.room_px / config.crossing_px)
        return clearances

    def to_crossing_px(self, at_px: float) -> float:
        """Return how far along the strand the nearest crossing is."""
        return float(np.abs(self.crossings_px - at_px).min(initial=1e3))

    def direction(self, at_px: float) -> Points:
        """Return the unit tangent."""
        ends = point_at(self.line, self.arcs, np.array([at_px - 6.0, at_px + 6.0]))
        unit: Points = (ends[1] - ends[0]) / max(float(np.linalg.norm(ends[1] - ends[0])), 1e-9)
        return unit

    def apart_px(self, a_px: float, b_px: float) -> float:
        """Return the distance of two of its points."""
        return float(np.linalg.norm(self.point(a_px) - self.point(b_px)))


def held_strand(traces: Sequence[Trace], index: int, crossings: Sequence[Crossing]) -> HeldStrand:
    """Prepare one of the traces of an image."""
    line = traces[index].points_px
    arcs = arc_lengths(line)
    overs = [c.arc_over for c in crossings if c.trace_over == index]
    unders = [c.arc_under for c in crossings if c.trace_under == index]
    others = [trace.points_px for k, trace in enumerate(traces) if k != index]
    return HeldStrand(
        line,
        arcs,
        np.concatenate(others) if others else np.empty((0, 2)),
        np.array(overs + unders) * arcs[-1],
        np.sort(np.array(unders)) * arcs[-1],
    )
