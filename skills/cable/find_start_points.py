"""Find where a trace can start."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Endpoint, Points, TraceStart
from perception.camera import CameraFrame

# A second point this far into the cable tells a tracer which way to go from an end.
AHEAD_PX = 4.0


class FindStartPoints(Skill):
    """Follow the cable for the first 96 px from an end, trying the surest end first.

    SUCCESS: `start` has points of one unbranched piece of cable; or, where `clear` is false and
        there is none, the surest end and the way it points.
    FAILURE: `start.unclear` when other strands are too close to every end, or there is no end.
    """

    OUT = {"start": Port(TraceStart, "first points of the trace")}
    REASONS = frozenset({"start.unclear"})

    def __init__(self, vision: CableVision, worker: Worker) -> None:
        """Bind perception, and who has the time for it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        endpoints: Annotated[tuple[Endpoint, ...], In("ends of the cable, surest first")],
        clear: Annotated[bool, In("only start where no other strand is near")] = True,
    ) -> SkillRun:
        """Try one end a tick."""
        for endpoint in endpoints:
            points_px = yield from self._worker.run(
                self._vision.start_points, frame.image, endpoint
            )
            if points_px is not None:
                return success(start=TraceStart(points_px, endpoint))
        if endpoints and not clear:
            return success(start=start_at(endpoints[0]))
        return failure(
            "start.unclear", "no end has a clear piece of cable behind it", ends=len(endpoints)
        )


def start_at(endpoint: Endpoint) -> TraceStart:
    """Return an end and a point a little into the cable as the start of a trace."""
    steps_px: Points = np.array([[0.0], [AHEAD_PX]])
    return TraceStart(endpoint.position_px + steps_px * endpoint.direction, endpoint)
