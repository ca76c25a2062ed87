"""Over and under by a network that sees both strands of a crossing at once."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch

from perception.cable.crossings import CrossingSite, decide, find_sites
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Crossing, Points, Trace
from perception.cable.width import mask_under
from perception.camera import GreyImage
from perception.models.crossing_crop import REACH, WIDTH, make_views
from perception.models.frames import Crop, ScaledImage, scale_image
from perception.models.store import load_network, read_config


class LearnedClassifier:
    """Implements `CrossingClassifier` with a trained network.

    P(a over b) = 1 - P(b over a) by construction, see `CrossingNet`; the temperature of the
    trained version makes beliefs as high as answers are often right.

    Args:
        folder: A trained version, see `perception.models.store`.
    """

    def __init__(self, folder: Path) -> None:
        self._network = load_network(folder)
        self._temperature = read_config(folder).temperature

    def classify(self, image: GreyImage, traces: Sequence[Trace]) -> tuple[Crossing, ...]:
        """Return every crossing; see `CrossingClassifier.classify`."""
        sites = find_sites(traces)
        if not sites:
            return ()
        on_cable_px = np.vstack([trace.points_px for trace in traces])
        mask = mask_under(image, on_cable_px)
        if mask is None:
            return ()
        scaled = scale_image(image, mask.width_px, WIDTH)
        views = np.stack([_views(scaled, site, traces) for site in sites])
        believed = self._believe(torch.from_numpy(views))
        return tuple(decide(site, belief) for site, belief in zip(sites, believed, strict=True))

    @torch.inference_mode()
    def _believe(self, views: torch.Tensor) -> list[float]:
        beliefs: list[float] = torch.sigmoid(self._network(views) / self._temperature).tolist()
        return beliefs


def _views(scaled: ScaledImage, site: CrossingSite, traces: Sequence[Trace]) -> Crop:
    a, b = (
        _piece(traces[trace].points_px, arc, REACH / scaled.scale)
        for trace, arc in zip(site.traces, site.arcs, strict=True)
    )
    return make_views(scaled, scaled.into(site.position_px), (scaled.into(a), scaled.into(b)))


def _piece(points_px: Points, arc: float, reach_px: float) -> Points:
    """Return the part of a trace within `reach_px` of an arc position."""
    arcs = arc_lengths(points_px)
    at_px = arc * arcs[-1]
    places = np.linspace(max(at_px - reach_px, 0.0), min(at_px + reach_px, float(arcs[-1])), 13)
    return point_at(points_px, arcs, places)
