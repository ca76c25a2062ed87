"""Move an end of the cable away from what lies beside it."""

from typing import Annotated

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.cable.covered_ends import connector_px, crossed_ends
from perception.cable.types import Endpoint, Trace
from perception.camera import CameraFrame
from skills.cable.shifting import Hold, ShiftSkill

# Where to hold: behind the connector, measured from the detected end into the cable.
HOLD_BEHIND_PX = (25.0, 40.0, 60.0)


class PerturbEndpoint(ShiftSkill):
    """Grasp the cable behind its surest reachable end and shift the end into free space.

    An end whose connector lies under or over a strand comes first: that crossing does not show
    in a trace.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `ends.clear` when only covered ends were asked for and there is none;
        `grasp.unreachable` when no arm reaches any end; `grasp.missed` when the fingers closed
        on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = ShiftSkill.REASONS | {"ends.clear"}

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        endpoints: Annotated[tuple[Endpoint, ...], In("ends of the cable, surest first")],
        trace: Annotated[Trace | None, In("path of the cable, where it is known")] = None,
        only_covered: Annotated[bool, In("leave ends alone that nothing lies across")] = False,
    ) -> SkillRun:
        """Hold behind an end and shift it."""
        crossed = (False,) * len(endpoints) if trace is None else crossed_ends(trace, endpoints)
        if only_covered and not any(crossed):
            return failure("ends.clear", "no strand lies across a connector")
        order = sorted(range(len(endpoints)), key=lambda number: not crossed[number])
        holds = [
            Hold(end.position_px + behind * end.direction, end.direction, connector_px(end))
            for end in (
                endpoints[number] for number in order if crossed[number] or not only_covered
            )
            for behind in HOLD_BEHIND_PX
        ]
        return (yield from self.shift(frame, holds))
