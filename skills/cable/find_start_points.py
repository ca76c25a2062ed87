"""Find where a trace can start."""

from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.interfaces import CableVision
from perception.cable.types import Endpoint, Trace, TraceStart
from perception.camera import CameraFrame


class FindStartPoints(Skill):
    """Follow the cable for the first 96 px from an end, trying the surest end first.

    After another trace it is the end farthest from where that began, to trace the other way.

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
        after: Annotated[Trace | None, In("a trace whose beginning is to be avoided")] = None,
    ) -> SkillRun:
        """Try one end a tick."""
        if after is not None:
            begin_px = after.points_px[0]
            endpoints = tuple(
                sorted(endpoints, key=lambda e: -np.linalg.norm(e.position_px - begin_px))
            )
        for endpoint in endpoints:
            points_px = yield from self._worker.run(
                self._vision.start_points, frame.image, endpoint
            )
            if points_px is not None:
                return success(start=TraceStart(points_px, endpoint))
        if endpoints and not clear:
            return success(start=TraceStart.at(endpoints[0]))
        return failure(
            "start.unclear", "no end has a clear piece of cable behind it", ends=len(endpoints)
        )
