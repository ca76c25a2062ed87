"""Move an end of the cable away from what lies beside it."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.cable.covered_ends import connector_px, crossed_ends
from perception.cable.types import Endpoint, Trace
from perception.camera import CameraFrame
from skills.cable.shifting import HALF_SQUARE_M, Hold, ShiftSkill

# Where to hold: behind the connector, measured from the detected end into the cable.
HOLD_BEHIND_PX = (25.0, 40.0, 60.0)
# Ends that lie nearer to each other have strands side by side behind them, which a trace
# confuses: one of them is taken farther away than a strand across a connector asks for.
BESIDE_PX, HALF_SQUARE_APART_M = 45.0, 0.15


class PerturbEndpoint(ShiftSkill):
    """Grasp the cable behind its surest reachable end and shift the end into free space.

    An end whose connector lies under or over a strand comes first: that crossing does not show
    in a trace. So does one that lies beside the other end.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `ends.clear` when only covered ends were asked for and none is that, or beside another;
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
        beside = beside_another(endpoints)
        close = not any(crossed) and any(beside)
        crossed = beside if close else crossed
        if only_covered and not any(crossed):
            return failure("ends.clear", "no strand lies across a connector, ends are apart")
        order = sorted(range(len(endpoints)), key=lambda number: not crossed[number])
        holds = [
            Hold(end.position_px + behind * end.direction, end.direction, connector_px(end))
            for end in (
                endpoints[number] for number in order if crossed[number] or not only_covered
            )
            for behind in HOLD_BEHIND_PX
        ]
        half_m = HALF_SQUARE_APART_M if close else HALF_SQUARE_M
        return (yield from self.shift(frame, holds, half_m))


def beside_another(endpoints: Sequence[Endpoint]) -> tuple[bool, ...]:
    """Return of each end whether another one lies beside it."""
    return tuple(
        any(
            other is not end and np.linalg.norm(other.position_px - end.position_px) < BESIDE_PX
            for other in endpoints
        )
        for end in endpoints
    )
