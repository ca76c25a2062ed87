"""Follow a cable with a network that says where it goes on, keeping several ways open.

After thesis 3.1: the path so far and the image around its last point go into a small U-Net,
which answers with a heat map of the next point. The thesis takes its maximum; here every
distinct mode starts a path of its own, and the likeliest paths go on side by side.
"""

from collections.abc import Sequence
from pathlib import Path as FilePath

import numpy as np

from perception.cable.tracers.paths import Ends
from perception.cable.tracers.search import Search, SearchConfig, run_searches
from perception.cable.tracers.starts import first_paths, from_start
from perception.cable.tracers.steps import StepModel
from perception.cable.tracers.survey import OWN_END_WIDTHS
from perception.cable.types import Endpoint, Points, Trace, TraceEnd
from perception.cable.width import cable_width
from perception.camera import GreyImage
from perception.models.frames import scale_image
from perception.models.tracer_crop import WIDTH


class LearnedTracer:
    """Follows one cable with a trained network, one way.

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
            if np.linalg.norm(end.position_px - start_px[0]) > OWN_END_WIDTHS * width_px
        ]
        starts = first_paths(start_px, endpoints, scaled)
        search = Search(starts, Ends.of(far, scaled), self._config)
        run_searches(self._model, scaled, [search], self._config.most_looks)
        found = search.found()
        # Ways that met more than once are counted more than once.
        beliefs = np.exp(np.minimum([path.log_probability for path in found], 0.0))
        beliefs /= max(float(beliefs.sum()), 1.0)
        return tuple(
            Trace(
                points_px=scaled.back(from_start(scaled.into(start_px[0]), path.points)),
                end=path.end or TraceEnd.LOST,
                probability=float(belief),
            )
            for path, belief in zip(found, beliefs, strict=True)
        )
