"""Pairs of places to hold a knot at: one to cage, one to pinch, with room for two hands."""

from collections.abc import Callable, Sequence

import numpy as np

from perception.cable.grasp_sites import (
    SIDE_ROOM_PX,
    GraspSite,
    cage_sites,
    pinch_sites,
    sites_between,
)
from perception.cable.types import Crossing, Knot, Points, Trace
from perception.camera import CameraFrame
from robots.interfaces import Floats

# Where to cage and where to pinch.
Pair = tuple[GraspSite, GraspSite]

# Two grippers that point straight down touch each other when they are nearer than this.
HANDS_APART_M = 0.11
# Where hands can go on the table (measured reach of both arms, straight down).
REACH_X_M = 0.38
REACH_Y_M = (-0.20, 0.17)
# Only weighs arc lengths against crowding; the real length may differ.
CABLE_LENGTH_M = 3.0
# A cage farther inside a knot than this would draw the knot, and not its tail.
DEEPEST_CAGE_M = 0.35
# How far behind a knot a pinch may be where there is no room in it, and what that costs.
BEHIND_M, BEHIND_COST = 0.4, 20.0
# A pinch so little beyond where a knot closes is still at its last strand.
IN_ARC = 0.02
# Beyond the places that are given for a knot others are tried along so much of the trace.
WALK_ARC = 0.15


def searched_pairs(
    trace: Trace,
    crossings: Sequence[Crossing],
    knot: Knot,
    frame: CameraFrame,
    behind: bool = True,
) -> list[Pair]:
    """Return the pairs of all places around a knot, best first; deeper in it comes last.

    Behind the knot comes after that, or not at all: it draws the knot together.
    """
    cages, pinches = cage_sites(trace, crossings, knot), pinch_sites(trace, crossings, knot)
    pairs = [
        *ranked_pairs(cages, pinches, knot, frame),
        *deeper_pairs(trace, crossings, knot, frame),
    ]
    return [pair for pair in pairs if behind or pair[1].arc <= knot.interval[1] + IN_ARC]


def deeper_pairs(
    trace: Trace, crossings: Sequence[Crossing], knot: Knot, frame: CameraFrame
) -> list[Pair]:
    """Return pairs anywhere in a knot and behind it, the cage first along the trace, best first.

    Drawing the tail through more crossings rubs more, and so does a loop that is held farther
    from where it closes; but a small knot has no other room for two hands. Behind the knot comes
    last: it is drawn together before the tail comes.
    """
    visits = np.array([arc for c in crossings for arc in (c.arc_over, c.arc_under)])
    low, high = knot.interval
    behind = high + BEHIND_M / CABLE_LENGTH_M

    def cost(pair: Pair) -> float:
        outside = (visits < pair[0].arc) | (visits > pair[1].arc)
        inside = (visits > low) & (visits < high)
        crowding = sum(max(0.0, 1.0 - site.room_px / SIDE_ROOM_PX) for site in pair)
        between_m = (pair[1].arc - pair[0].arc) * CABLE_LENGTH_M
        inwards_m = (pair[0].arc - low) * CABLE_LENGTH_M
        beyond = BEHIND_COST if pair[1].arc > high else 0.0
        visited = float((outside & inside).sum())
        return visited + between_m + 2.0 * inwards_m + 0.4 * crowding + beyond

    cages = sites_between(trace, low, min(high, low + DEEPEST_CAGE_M / CABLE_LENGTH_M))
    pinches = sites_between(trace, low, min(1.0, behind))
    return [pair for pair in _roomy(cages, pinches, frame, cost) if pair[0].arc < pair[1].arc]


def ranked_pairs(
    cages: Sequence[GraspSite], pinches: Sequence[GraspSite], knot: Knot, frame: CameraFrame
) -> list[Pair]:
    """Return pairs of sites that leave room for two hands, best first.

    A pinch beyond the knot would tighten it, so that is the last resort. What is drawn out of
    the knot is the final separation less the cable that already lies between the hands, so
    short pieces come first. A crowded site costs more than a long piece.
    """

    def cost_m(pair: Pair) -> float:
        beyond_m = max(0.0, pair[1].arc - knot.interval[1]) * CABLE_LENGTH_M
        between_m = abs(pair[1].arc - pair[0].arc) * CABLE_LENGTH_M
        crowding = sum(max(0.0, 1.0 - site.room_px / SIDE_ROOM_PX) for site in pair)
        return 5.0 * beyond_m + between_m + 0.4 * crowding

    return _roomy(cages, pinches, frame, cost_m)


def given_pairs(trace: Trace, knot: Knot, frame: CameraFrame) -> list[Pair]:
    """Return the pair that perception gives for a knot, then those that a walk comes to.

    Where two hands cannot be there, the search goes on along the trace from both places, as in
    the thesis (section 3.4).
    """
    cages = _walked(trace, knot.cage_px, knot.cage_direction)
    pinches = _walked(trace, knot.pinch_px, knot.pinch_direction)
    return _roomy(cages, pinches, frame, lambda pair: pair[0].arc + pair[1].arc)


def _walked(trace: Trace, point_px: Points, direction: Points) -> tuple[GraspSite, ...]:
    nearest = int(np.linalg.norm(trace.points_px - point_px, axis=1).argmin())
    lengths = np.linalg.norm(np.diff(trace.points_px, axis=0), axis=1)
    arc = float(lengths[:nearest].sum() / max(float(lengths.sum()), 1e-9))
    first = GraspSite(point_px, direction, arc, SIDE_ROOM_PX)
    return (first, *sites_between(trace, arc, min(1.0, arc + WALK_ARC)))


def _roomy(
    cages: Sequence[GraspSite],
    pinches: Sequence[GraspSite],
    frame: CameraFrame,
    cost: Callable[[Pair], float],
) -> list[Pair]:
    """Return the pairs in reach that leave room for two hands, the cheapest first."""
    spots_m = {id(site): _spot_m(frame, site) for site in (*cages, *pinches)}
    roomy = [
        (cage, pinch)
        for cage in cages
        for pinch in pinches
        if np.linalg.norm(spots_m[id(cage)] - spots_m[id(pinch)]) >= HANDS_APART_M
        and in_reach(spots_m[id(cage)])
        and in_reach(spots_m[id(pinch)])
    ]
    return sorted(roomy, key=cost)


def in_reach(position_m: Floats) -> bool:
    """Return whether a point lies in the part of the table that the arms reach."""
    return bool(abs(position_m[0]) <= REACH_X_M and REACH_Y_M[0] <= position_m[1] <= REACH_Y_M[1])


def _spot_m(frame: CameraFrame, site: GraspSite) -> Floats:
    spot_m: Floats = frame.camera.on_plane(site.point_px)[0]
    return spot_m
