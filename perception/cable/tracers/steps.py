"""Where a cable may go on from the end of each path: what the tracer's network believes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import cv2
import numpy as np
import torch

from perception.cable.mask import CableMask
from perception.cable.tracers.paths import Path
from perception.camera import GreyImage
from perception.models.frames import CropFrame, Floats, ScaledImage, cut, scale_image, turned_frame
from perception.models.store import load_network, read_config
from perception.models.tracer_crop import CELL, HERE, SIZE, WIDTH, make_crop
from perception.models.tracer_math import step_logits

# How much of its belief a place keeps where the mask shows no cable: the mask has gaps.
OFF_CABLE = 0.05
MARGIN = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class TracingView:
    """One image, scaled to the width that the network knows.

    Attributes:
        image: Grey values.
        cable: 255 where cable may be, that is on the mask, a little around it, and outside
            the image.
    """

    image: ScaledImage
    cable: ScaledImage


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


def make_view(image: GreyImage, mask: CableMask, zoom: float = 1.0) -> TracingView:
    """Return the view of an image, with `zoom` pixels a unit."""
    margin = 2 * max(round(MARGIN * mask.width_px), 1) + 1
    near = cv2.dilate(mask.cable.astype(np.uint8) * 255, np.ones((margin, margin), np.uint8))
    cable = scale_image(near.astype(np.uint8), mask.width_px, WIDTH)
    beyond = ScaledImage(cable.pixels, cable.scale, 255.0)
    return TracingView(scale_image(image, mask.width_px, WIDTH, zoom), beyond)


class StepModel:
    """A trained tracer network.

    Attributes:
        zoom: Pixels a unit of the views that it needs.

    Args:
        folder: A trained version, see `perception.models.store`.
    """

    def __init__(self, folder: FilePath) -> None:
        self._network = load_network(folder)
        config = read_config(folder)
        self._temperature, self.zoom = config.temperature, config.zoom

    @torch.inference_mode()
    def outlooks(self, view: TracingView, paths: Sequence[Path]) -> list[Outlook]:
        """Return where each path may go on."""
        frames = [turned_frame(path.points[-1], path.heading, HERE) for path in paths]
        crops = np.stack(
            [make_crop(view.image, p.points, f) for p, f in zip(paths, frames, strict=True)]
        )
        heat, stop = self._network(torch.from_numpy(crops))
        beliefs = torch.softmax(step_logits(heat, stop) / self._temperature, 1).double().numpy()
        return [
            _outlook(view, frame, belief) for frame, belief in zip(frames, beliefs, strict=True)
        ]


def _outlook(view: TracingView, frame: CropFrame, belief: Floats) -> Outlook:
    grid = SIZE // CELL
    on_cable = cut(view.cable, frame, SIZE).reshape(grid, CELL, grid, CELL).max(axis=(1, 3)) / 255.0
    kept = OFF_CABLE + (1.0 - OFF_CABLE) * on_cable
    return Outlook(frame, belief[:-1].reshape(grid, grid) * kept, float(belief[-1]))
