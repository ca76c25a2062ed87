"""Where a cable may go on from the end of each path: what the tracer's network believes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np
import torch

from perception.cable.tracers.paths import Path
from perception.models.frames import CropFrame, Floats, ScaledImage, turned_frame
from perception.models.store import load_network, read_config
from perception.models.tracer_crop import CELL, HERE, SIZE, make_crop
from perception.models.tracer_math import step_logits


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

    @torch.inference_mode()
    def outlooks(self, image: ScaledImage, paths: Sequence[Path]) -> list[Outlook]:
        """Return where each path may go on."""
        frames = [turned_frame(path.points[-1], path.heading, HERE) for path in paths]
        crops = np.stack(
            [make_crop(image, p.points, f) for p, f in zip(paths, frames, strict=True)]
        )
        heat, stop = self._network(torch.from_numpy(crops))
        beliefs = torch.softmax(step_logits(heat, stop) / self._temperature, 1).double().numpy()
        grid = SIZE // CELL
        return [
            Outlook(frame, belief[:-1].reshape(grid, grid), float(belief[-1]))
            for frame, belief in zip(frames, beliefs, strict=True)
        ]
