"""From the network's maps to ends, crossings and tangles."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from perception.cable.sight.seen import Seen, Tangle
from perception.cable.types import Endpoint, Points
from perception.models import sight_net
from perception.models.sight_input import STRIDE
from perception.models.sight_peaks import apart, cell_middle, find_peaks
from perception.models.store import ModelConfig

Maps = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class ReadingConfig:
    """How maps are read; lengths in cable widths.

    Attributes:
        least_end: Least belief in an end.
        least_crossing: Least belief in a crossing.
        least_tangle: Least belief in a tangle.
        ends_apart: Two ends are at least this far apart.
        crossings_apart: Two crossings are at least this far apart.
        border: An end nearer to the border of the image is cable that leaves the view.
        least_cable: So many squared widths of cable tell its width.
    """

    least_end: float = 0.3
    least_crossing: float = 0.4
    least_tangle: float = 0.4
    ends_apart: float = 1.5
    crossings_apart: float = 0.7
    border: float = 0.8
    least_cable: float = 4.0


def read_maps(cable_logits: Maps, grid: Maps, model: ModelConfig, config: ReadingConfig) -> Seen:
    """Return what maps show.

    Args:
        cable_logits: Of each pixel, shape (height, width).
        grid: Maps of `sight_net` on its grid, shape (GRID_MAPS, h, w).
        model: Whose temperature and bias make ends as likely as they are often right.
        config: How to read.
    """
    cable = expit(cable_logits).astype(np.float32)
    connector = _enlarged(expit(grid[sight_net.CONNECTOR]).astype(np.float32), cable.shape)
    width_px = _width(cable, grid, config)
    if width_px is None:
        none = np.empty((0, 2))
        return Seen(cable, connector, None, (), (), none, np.empty(0), ())
    size = (cable.shape[1], cable.shape[0])
    endpoints, plugged = _ends(grid, width_px, size, model, config)
    crossings_px, beliefs = _crossings(grid, width_px, size, config)
    tangles = _tangles(grid, size, config)
    return Seen(cable, connector, width_px, endpoints, plugged, crossings_px, beliefs, tangles)


def _enlarged(cells: Maps, shape: tuple[int, ...]) -> Maps:
    """Return a map of the grid for every pixel of an image."""
    size = (cells.shape[1] * STRIDE, cells.shape[0] * STRIDE)
    pixels = cv2.resize(cells, size, interpolation=cv2.INTER_LINEAR)
    return np.ascontiguousarray(pixels[: shape[0], : shape[1]], dtype=np.float32)


def _width(cable: NDArray[np.float32], grid: Maps, config: ReadingConfig) -> float | None:
    """Return the width that most cable pixels are believed to have."""
    half = STRIDE // 2
    there = cable[half::STRIDE, half::STRIDE] > 0.5
    widths = np.exp(grid[sight_net.LOG_WIDTH][: there.shape[0], : there.shape[1]][there])
    if not len(widths):
        return None
    width_px = float(np.median(widths))
    enough = len(widths) * STRIDE**2 > config.least_cable * width_px**2
    return width_px if enough else None


def _ends(
    grid: Maps,
    width_px: float,
    size: tuple[int, int],
    model: ModelConfig,
    config: ReadingConfig,
) -> tuple[tuple[Endpoint, ...], tuple[float, ...]]:
    heat = grid[sight_net.END] / model.temperature + model.bias
    rows, columns, beliefs = find_peaks(heat.astype(np.float32), config.least_end)
    found = grid[:, rows, columns].astype(float)
    places = cell_middle(columns, rows) + STRIDE * found[sight_net.OFFSET].T
    ways = found[sight_net.DIRECTION].T
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
    depth = np.minimum(places, np.array(size) - 1.0 - places).min(axis=1, initial=np.inf)
    lone = apart(places, config.ends_apart * width_px)
    kept = [k for k in lone if depth[k] > config.border * width_px]
    return (
        tuple(Endpoint(places[k], ways[k], float(beliefs[k])) for k in kept),
        tuple(float(expit(found[sight_net.PLUGGED, k])) for k in kept),
    )


def _crossings(
    grid: Maps, width_px: float, size: tuple[int, int], config: ReadingConfig
) -> tuple[Points, Points]:
    rows, columns, beliefs = find_peaks(grid[sight_net.CROSSING], config.least_crossing)
    places = cell_middle(columns, rows)
    near = apart(places, config.crossings_apart * width_px)
    kept = [k for k in near if (places[k] < size).all()]
    return places[kept], beliefs[kept]


def _tangles(grid: Maps, size: tuple[int, int], config: ReadingConfig) -> tuple[Tangle, ...]:
    rows, columns, beliefs = find_peaks(grid[sight_net.TANGLE], config.least_tangle)
    places = cell_middle(columns, rows)
    radii = np.exp(grid[sight_net.LOG_RADIUS, rows, columns].astype(float))
    found: list[Tangle] = []
    for place, radius, belief in zip(places, radii, beliefs, strict=True):
        lone = all(np.linalg.norm(place - other.centre_px) > other.radius_px for other in found)
        if lone and (place < size).all():
            found.append(Tangle(place, float(radius), float(belief)))
    return tuple(found)
