"""Searches from all ends of cables in one image, side by side.

Every doubtful place is then looked at from both sides, and cables that other ends belong to
are known as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.tracers.paths import Ends, Path
from perception.cable.tracers.search import Search, SearchConfig, Sketch, run_searches
from perception.cable.tracers.starts import first_paths
from perception.cable.tracers.steps import StepModel
from perception.cable.tracers.stretches import Stretches
from perception.cable.types import Endpoint, Points
from perception.cable.width import mask_under, width_with
from perception.camera import GreyImage
from perception.models.frames import ScaledImage, scale_image
from perception.models.tracer_crop import WIDTH

Bools = NDArray[np.bool_]

# The mask is kept so small that a cable is this wide [px]; it only tells lengths.
MASK_WIDTH = 3.0
# An end of a cable is not where the same cable's trace finishes within so many widths.
OWN_END_WIDTHS = 3.0
# A start points into the cable from this far along it.
LEAD = 2.0 * WIDTH


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What is known of an image before any cable is followed.

    Attributes:
        width_px: Width of the cables.
        cable: Which pixels show cable or connector, shape (height, width).
        stretches: Pieces of cable that lie alone, shape (N, 2) each.
        dead_ends: Where the mask of a cable ends; many of these are no ends of a cable.
    """

    width_px: float
    cable: Bools
    stretches: tuple[Points, ...] = ()
    dead_ends: tuple[Endpoint, ...] = ()

    def sketch(self, scaled: ScaledImage) -> Sketch:
        """Return what is known of the cables in a scaled image."""
        return Sketch(Stretches(self.stretches, scaled), Ends.of(self.dead_ends, scaled))

    def wider(self, by: float) -> "View":
        """Return the same with cables so many times as wide."""
        return replace(self, width_px=by * self.width_px)


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """What searches from all ends have found.

    Attributes:
        image: The scaled image that all points here lie in.
        cable: Mask of the cables, `zoom` pixels a unit.
        zoom: Pixels of the mask a unit of the image.
        ends: The ends; the first ones are those that were asked for.
        found: Paths from each end, likeliest first.
    """

    image: ScaledImage
    cable: NDArray[np.uint8]
    zoom: float
    ends: Ends
    found: tuple[tuple[Path, ...], ...]


def view_from(image: GreyImage, start_px: Points) -> View | None:
    """Look at an image without a network; None where no cable is seen at the start."""
    mask = mask_under(image, start_px)
    width_px = width_with(mask, image, start_px)
    if width_px is None:
        return None
    cable = mask.cable if mask is not None else np.zeros(image.shape, dtype=bool)
    return View(width_px, cable)


def survey(
    model: StepModel,
    config: SearchConfig,
    image: GreyImage,
    view: View,
    starts_px: Sequence[Points],
    endpoints: Sequence[Endpoint],
    from_all: bool = True,
) -> Survey:
    """Follow cables from starts, and from all other ends.

    Args:
        model: Looks ahead.
        config: Settings of the searches.
        image: Grey image.
        view: What is known of it.
        starts_px: First points of cables, in order, shape (N, 2) each.
        endpoints: Ends of cables; those at starts are left out.
        from_all: Whether cables are followed from other ends than the starts, too.
    """
    scaled = scale_image(image, view.width_px, WIDTH, model.zoom)
    near = OWN_END_WIDTHS * view.width_px
    firsts = np.array([start[0] for start in starts_px])
    far = [
        end
        for end in endpoints
        if float(np.linalg.norm(firsts - end.position_px, axis=1).min()) > near
    ]
    paths = [first_paths(start, endpoints, scaled) for start in starts_px]
    begun = [_as_end(start, own, scaled) for start, own in zip(starts_px, paths, strict=True)]
    ends = Ends.of([*begun, *far], scaled)
    if from_all:
        paths += [first_paths(end.position_px[None], [end], scaled) for end in far]
    sketch = view.sketch(scaled)
    searches = [
        Search(own, ends.without(ends.points[number], OWN_END_WIDTHS * WIDTH), config, sketch)
        for number, own in enumerate(paths)
    ]
    run_searches(model, scaled, searches, config.most_looks)
    zoom = MASK_WIDTH / WIDTH
    size = tuple(int(side) for side in np.maximum(np.rint(scaled.size * zoom), 1.0))
    small = cv2.resize(view.cable.astype(np.uint8) * 255, size, interpolation=cv2.INTER_AREA)
    found = tuple(tuple(search.found()) for search in searches)
    return Survey(scaled, (small > 127).astype(np.uint8), zoom, ends, found)


def _as_end(start_px: Points, paths: Sequence[Path], scaled: ScaledImage) -> Endpoint:
    """Return a start as an end where traces from elsewhere may finish."""
    points = scaled.back(paths[0].points) if len(paths) == 1 else start_px
    along = points[-1] - points[0]
    length = float(np.linalg.norm(along))
    return Endpoint(start_px[0], along / length if length > 0.0 else along, 1.0)
