"""Follow a cable with a network that says where it goes on, keeping several ways open.

After thesis 3.1: the path so far and the image around its last point go into a small U-Net,
which answers with a heat map of the next point. The thesis takes its maximum; here every
distinct mode starts a path of its own, and the likeliest paths go on side by side.
"""

from collections.abc import Sequence
from pathlib import Path as FilePath

import numpy as np

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.tracers.paths import Ends, Path
from perception.cable.tracers.search import Search, SearchConfig, run_searches
from perception.cable.tracers.steps import StepModel
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.cable.width import cable_width
from perception.camera import GreyImage
from perception.models.frames import ScaledImage, scale_image
from perception.models.tracer_crop import STEP, WIDTH


class LearnedTracer:
    """Follows one cable with a trained network.

    Args:
        folder: A trained version, see `perception.models.store`.
        config: Settings of the search.
    """

    def __init__(self, folder: FilePath, config: SearchConfig | None = None) -> None:
        self._model = StepModel(folder)
        self._config = config or SearchConfig()

    def trace(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> Trace | None:
        """Follow the cable that starts at `start_px`; see `Tracer.trace`."""
        return next(iter(self.hypotheses(image, start_px, endpoints)), None)

    def hypotheses(
        self, image: GreyImage, start_px: Points, endpoints: Sequence[Endpoint]
    ) -> tuple[Trace, ...]:
        """Return the traces that are believed in, likeliest first; their beliefs add up to <= 1."""
        start_px = np.atleast_2d(np.asarray(start_px, dtype=float))
        width_px = cable_width(image, start_px)
        if width_px is None:
            return ()
        scaled = scale_image(image, width_px, WIDTH, self._model.zoom)
        far = [
            end
            for end in endpoints
            if np.linalg.norm(end.position_px - start_px[0]) > 3.0 * width_px
        ]
        ends = Ends(
            scaled.into(np.array([end.position_px for end in far]).reshape(-1, 2)),
            np.array([end.direction for end in far]).reshape(-1, 2),
        )
        starts = self._starts(scaled.into(start_px), endpoints, scaled)
        search = Search(starts, ends, self._config)
        run_searches(self._model, scaled, [search], self._config.most_looks)
        found = search.found()
        # Ways that met more than once are counted more than once.
        beliefs = np.exp(np.minimum([path.log_probability for path in found], 0.0))
        beliefs /= max(float(beliefs.sum()), 1.0)
        return tuple(
            Trace(
                points_px=np.vstack([start_px[:1], scaled.back(path.points)]),
                end=path.end or TraceEnd.LOST,
                probability=float(belief),
            )
            for path, belief in zip(found, beliefs, strict=True)
        )

    def _starts(
        self, points: Points, endpoints: Sequence[Endpoint], scaled: ScaledImage
    ) -> list[Path]:
        """Return first paths: one, or one for each direction where none is known."""
        if len(points) > 1:
            return [_fresh(_even(points))]
        known = [
            end.direction
            for end in endpoints
            if np.linalg.norm(scaled.into(end.position_px) - points[0]) < STEP
        ]
        turns = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
        ways = known[:1] or list(np.column_stack([np.cos(turns), np.sin(turns)]))
        return [_fresh(np.vstack([points[0] - STEP * way, points[0]])) for way in ways]


def _fresh(points: Points) -> Path:
    """Return a path before any choice."""
    return Path(points, np.zeros(len(points)))


def _even(points: Points) -> Points:
    """Return points one step apart that end at the last one."""
    along = arc_lengths(points)
    arcs = along[-1] - STEP * np.arange(int(along[-1] / STEP) + 1)
    if len(arcs) < 2:
        arcs = along[[-1, 0]]
    return point_at(points, along, arcs[::-1])
