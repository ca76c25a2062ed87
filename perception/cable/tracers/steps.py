"""Where a cable may go on from the end of each path: what the tracer's network believes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np
import torch

from perception.cable.tracers.paths import Path
from perception.models.frames import Crop, CropFrame, Floats, ScaledImage, turned_frame
from perception.models.store import load_network, read_config
from perception.models.tracer_crop import CELL, HERE, SIZE, make_crop
from perception.models.tracer_math import SPREAD, step_logits

# A belief that is all in one place has this peak, less where a temperature spreads it; with
# less than a share of that the way is unclear.
PEAK = 1.0 / (2.0 * np.pi * SPREAD**2)
CLEAR = 0.75


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """Where one path may go on.

    Attributes:
        frame: Where its crop lies.
        cells: Probability of each cell of the crop, shape (G, G).
        end: Probability that the cable ends before.
    """

    frame: CropFrame
    cells: Floats
    end: float


class StepModel:
    """A trained tracer network.

    Attributes:
        zoom: Pixels a unit of the images that it needs.

    Args:
        folder: A trained version, see `perception.models.store`.
    """

    def __init__(self, folder: FilePath) -> None:
        self._network = load_network(folder)
        config = read_config(folder)
        self._temperature, self.zoom = config.temperature, config.zoom

    def outlooks(self, image: ScaledImage, paths: Sequence[Path]) -> list[Outlook]:
        """Return where each path may go on; where that is not clear, a mirror is asked as well."""
        frames = [turned_frame(path.points[-1], path.heading, HERE) for path in paths]
        crops = np.stack(
            [make_crop(image, p.points, f) for p, f in zip(paths, frames, strict=True)]
        )
        cells, ends = self._beliefs(crops)
        unclear = np.flatnonzero(cells.max(axis=(1, 2)) < CLEAR * PEAK / self._temperature)
        if len(unclear):
            mirrored, mirrored_ends = self._beliefs(np.ascontiguousarray(crops[unclear, :, ::-1]))
            cells[unclear] = 0.5 * (cells[unclear] + mirrored[:, ::-1])
            ends[unclear] = 0.5 * (ends[unclear] + mirrored_ends)
        return [
            Outlook(frame, own, float(end))
            for frame, own, end in zip(frames, cells, ends, strict=True)
        ]

    @torch.inference_mode()
    def _beliefs(self, crops: Crop) -> tuple[Floats, Floats]:
        """Return the probability of each cell, shape (N, G, G), and of the end, shape (N,)."""
        heat, stop = self._network(torch.from_numpy(crops))
        beliefs = torch.softmax(step_logits(heat, stop) / self._temperature, 1).double().numpy()
        grid = SIZE // CELL
        return beliefs[:, :-1].reshape(-1, grid, grid).copy(), beliefs[:, -1].copy()
