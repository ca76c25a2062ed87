"""Move the cable where it is understood least."""

from collections.abc import Sequence
from typing import Annotated

from executive.core.skill import In, SkillRun
from perception.cable.grasp_sites import sites_between
from perception.cable.types import Crossing, Points, Trace, TraceEnd
from perception.camera import CameraFrame
from skills.cable.shifting import Hold, ShiftSkill

# A crossing that is this sure is not what is in doubt.
SURE = 0.95
# Where to hold: on the strand beside the doubtful place, as a share of the trace.
REACH_ARC = 0.08
# How far it is shifted at most, either way: strands of a bundle come along for a while.
HALF_SQUARE_M = 0.08


class PerturbDoubt(ShiftSkill):
    """Grasp the cable beside its least sure place and shift it into free space.

    Strands that are too close to be told apart are told apart when one of them moves.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `grasp.unreachable` when no arm reaches the cable there; `grasp.missed` when the
        fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        crossings: Annotated[tuple[Crossing, ...], In("crossings of the trace")],
    ) -> SkillRun:
        """Hold beside the doubt and shift."""
        arc, doubt_px = _doubt(trace, crossings)
        sites = sites_between(trace, max(0.0, arc - REACH_ARC), min(1.0, arc + REACH_ARC))
        order = sorted(sites, key=lambda site: (-round(site.room_px / 10.0), abs(site.arc - arc)))
        holds = [Hold(site.point_px, site.direction, doubt_px[None]) for site in order]
        return (yield from self.shift(frame, holds, HALF_SQUARE_M))


def _doubt(trace: Trace, crossings: Sequence[Crossing]) -> tuple[float, Points]:
    """Return arc position and image point of what is in doubt.

    That is the least sure crossing; else where the trace was lost; else where it runs closest
    beside itself.
    """
    doubtful = [crossing for crossing in crossings if crossing.probability < SURE]
    if doubtful:
        least = min(doubtful, key=lambda crossing: crossing.probability)
        return least.arc_over, least.position_px
    if trace.end is not TraceEnd.ENDPOINT:
        return 1.0, trace.points_px[-1]
    closest = min(sites_between(trace, 0.0, 1.0), key=lambda site: site.room_px, default=None)
    if closest is None:  # it is too short to have a middle
        return 1.0, trace.points_px[-1]
    return closest.arc, closest.point_px
