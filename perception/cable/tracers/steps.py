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
        crop: What the network saw, shape (3, P, P).
        cells: Probability of each cell of the crop, shape (G, G).
        end: Probability that the cable ends before.
        later: The same for two, three, ... steps ahead if it does not end, shape (K, G, G).
        clear: Whether the first step is beyond doubt.
    """

    frame: CropFrame
    crop: Crop
    cells: Floats
    end: float
    later: Floats
    clear: bool


class StepModel:
    """A trained tracer network.

    Attributes:
        zoom: Pixels a unit of the images that it needs.
        looks: How many crops it has looked at so far.

    Args:
        folder: A trained version, see `perception.models.store`.
    """

    def __init__(self, folder: FilePath) -> None:
        self._network = load_network(folder)
        config = read_config(folder)
        self._temperature, self.zoom = config.temperature, config.zoom
        self.looks = 0

    def outlooks(self, image: ScaledImage, paths: Sequence[Path]) -> list[Outlook]:
        """Return where each path may go on; where that is not clear, a mirror is asked as well."""
        frames = [turned_frame(path.points[-1], path.heading, HERE) for path in paths]
        crops = np.stack(
            [make_crop(image, p.points, f) for p, f in zip(paths, frames, strict=True)]
        )
        cells, ends = self._beliefs(crops)
        clear = cells[:, 0].max(axis=(1, 2)) >= CLEAR * PEAK / self._temperature
        unclear = np.flatnonzero(~clear)
        if len(unclear):
            mirrored, mirrored_ends = self._beliefs(np.ascontiguousarray(crops[unclear, :, ::-1]))
            cells[unclear] = 0.5 * (cells[unclear] + mirrored[:, :, ::-1])
            ends[unclear] = 0.5 * (ends[unclear] + mirrored_ends)
        return [
            Outlook(frames[k], crops[k], cells[k, 0], float(ends[k]), cells[k, 1:], bool(clear[k]))
            for k in range(len(paths))
        ]

    @torch.inference_mode()
    def _beliefs(self, crops: Crop) -> tuple[Floats, Floats]:
        """Return the probability of each cell, shape (N, K, G, G), and of the end, shape (N,)."""
        self.looks += len(crops)
        heat, stop = self._network(
            torch.from_numpy(crops).contiguous(memory_format=torch.channels_last)
        )
        first = torch.softmax(step_logits(heat, stop) / self._temperature, 1)
        later = torch.softmax(heat[:, 1:].flatten(2) / self._temperature, 2)
        grid = SIZE // CELL
        cells = torch.cat([first[:, None, :-1], later], 1).double().numpy()
        return cells.reshape(len(crops), -1, grid, grid), first[:, -1].double().numpy().copy()
