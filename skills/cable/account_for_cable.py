"""Make sure that a trace leaves no cable out before anything is claimed about it."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.polyline import arc_lengths
from perception.cable.types import Trace
from perception.camera import CameraFrame
from skills.cable.connectors import with_connectors

# Traces cut corners. On 14 looks at untied cables of 3 m the trace was up to 0.6 % short, on four
# at cables with a knot drawn tight at an end, or a loop that was passed over, 3 % and more.
MOST_SHORT = 0.015


class AccountForCable(Skill):
    """Compare a trace with all the cable that is in view, and with how long the cable is.

    SUCCESS: the trace accounts for the cable.
    FAILURE: `cable.unexplained` when more than `share` of its pixels, or a piece of more than
        `piece_px` of them, is left over: the trace took a short cut, or there is another cable;
        `cable.short` when the trace is shorter than the cable is: the rest may be in a knot that
        was drawn tight.
    """

    OUT = {"explained": Port(float, "share of the cable in view that the trace accounts for")}
    REASONS = frozenset({"cable.unexplained", "cable.short"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        share: Annotated[float, In("share that must be accounted for")] = 0.96,
        piece_px: Annotated[int, In("largest piece that may be left over", "px")] = 60,
        length_m: Annotated[float, In("length of the cable; 0 where it is not known", "m")] = 0.0,
    ) -> SkillRun:
        """Count cable pixels near the trace and away from it, and measure the trace."""
        whole = with_connectors(trace)
        covered = yield from self._worker.run(self._vision.coverage, frame.image, whole)
        if covered.share < share:
            text = f"the trace accounts for {covered.share:.0%} of the cable in view"
            return failure("cable.unexplained", text, explained=covered.share)
        if covered.left_px > piece_px:
            text = f"the trace leaves out a piece of cable of {covered.left_px} pixels"
            return failure("cable.unexplained", text, left_px=covered.left_px)
        traced_m = float(arc_lengths(frame.camera.on_plane(whole.points_px))[-1])
        if traced_m < (1.0 - MOST_SHORT) * length_m:
            text = f"{traced_m:.2f} m of {length_m:g} m are seen; the rest may be in a tight knot"
            return failure("cable.short", text, traced_m=traced_m)
        return success(explained=covered.share)
