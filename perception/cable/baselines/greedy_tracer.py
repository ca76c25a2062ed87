"""The learned tracer as the thesis has it (section 3.1): the best next point, step by step.

No step is taken back, there is one path, and what the network believes about ends is not asked:
a trace stops at a known end, at the border, or when it goes over itself again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from perception.cable.tracers.modes import find_modes
from perception.cable.tracers.paths import Path
from perception.cable.tracers.starts import stepwise
from perception.cable.tracers.steps import StepModel
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.cable.width import cable_width
from perception.camera import GreyImage
from perception.models.frames import ScaledImage, scale_image
from perception.models.tracer_crop import WIDTH


@dataclass(frozen=True, slots=True)
class GreedyConfig:
    """When traces stop; lengths in cable widths, where the thesis's cable is 6 px wide.

    Attributes:
        most_steps: Longest trace.
        border: A trace that comes so near to the border has left the view, as shares of the
            image's width and height (30 px of 1,032 and 50 px of 772).
        endpoint: One that comes so near to an end of a cable is there (15 px).
        shortest: Shorter ones just pass it (800 px).
        window: Points that are held against all earlier ones of as many.
        same: Root mean square distance of points that run the same way again.
        back: The same for points that run back.
    """

    most_steps: int = 500
    border: tuple[float, float] = (30.0 / 1032.0, 50.0 / 772.0)
    endpoint: float = 2.5
    shortest: float = 130.0
    window: int = 10
    same: float = 0.53
    back: float = 1.6


class GreedyTracer:
    """Implements `Tracer` with a trained network and no search.

    Args:
        folder: A trained version, see `perception.models.store`.
        config: When traces stop.
    """

    def __init__(self, folder: FilePath, config: GreedyConfig | None = None) -> None:
        self._model = StepModel(folder)
        self._config = config or GreedyConfig()

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`; see `Tracer.trace`."""
        start_px = np.atleast_2d(np.asarray(start_px, dtype=float))
        width_px = cable_width(image, start_px)
        if width_px is None or len(start_px) < 2:
            return None
        scaled = scale_image(image, width_px, WIDTH, self._model.zoom)
        begin = scaled.into(start_px)
        ends = scaled.into(np.array([end.position_px for end in endpoints]).reshape(-1, 2))
        points, end, log_probability = self._followed(scaled, stepwise(begin), ends)
        return Trace(
            np.vstack([start_px[:1], scaled.back(points)]), end, float(np.exp(log_probability))
        )

    def _followed(
        self, scaled: ScaledImage, start: Points, ends: Points
    ) -> tuple[Points, TraceEnd, float]:
        """Return the points of a trace, why it ended, and the logarithm of its belief."""
        path = Path(start, np.zeros(len(start)))
        for _ in range(self._config.most_steps):
            outlook = self._model.outlooks(scaled, [path])[0]
            modes = find_modes(outlook.cells, 0.0, 1)
            if not modes:
                return path.points, TraceEnd.LOST, path.log_probability
            mode = modes[0]
            path = path.extended(outlook.frame.back(mode.point_crop), mode.probability)
            if self._is_at_end(path.points, ends):
                return path.points, TraceEnd.ENDPOINT, path.log_probability
            if self._is_at_border(path.points[-1], scaled):
                return path.points, TraceEnd.EDGE, path.log_probability
            if self._retraces(path.points):
                kept = path.shortened(self._config.window)
                return kept.points, TraceEnd.RETRACE, kept.log_probability
        return path.points, TraceEnd.LOST, path.log_probability

    def _is_at_end(self, points: Points, ends: Points) -> bool:
        length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        if not len(ends) or length < self._config.shortest * WIDTH:
            return False
        return bool(np.abs(ends - points[-1]).max(axis=1).min() < self._config.endpoint * WIDTH)

    def _is_at_border(self, point: Points, scaled: ScaledImage) -> bool:
        margin = np.array(self._config.border) * scaled.size
        return bool((point < margin).any() or (point > scaled.size - 1.0 - margin).any())

    def _retraces(self, points: Points) -> bool:
        """Say whether the last points repeat as many earlier ones, one by one."""
        count = self._config.window
        if len(points) < 2 * count:
            return False
        earlier = np.lib.stride_tricks.sliding_window_view(points[:-count], count, axis=0)
        last = points[-count:].T
        same, back = (
            np.sqrt(((earlier - line) ** 2).sum(axis=1).mean(axis=1)).min()
            for line in (last, last[:, ::-1])
        )
        return bool(same < self._config.same * WIDTH or back < self._config.back * WIDTH)
