"""Spatial occupancy as a network tells it, in LAX-RAY's manner (thesis, section 7.4)."""

from pathlib import Path

import numpy as np
import torch

from perception.models.spatial_input import prepare, seen_through, spread, window_camera
from perception.models.spatial_net import USUAL
from perception.models.store import FOLDER, load_network
from perception.shelf.types import Floats, Shelf, ShelfView, Size

VERSION = "thesis_spatial_v1"


class LearnedOccupancy:
    """Tells from depth alone where a target of known size may show."""

    def __init__(self, folder: Path | None = None) -> None:
        """Read a trained version.

        Args:
            folder: Of the version; None for the one that ships.
        """
        self._network = load_network(folder or FOLDER / VERSION)

    def heat(self, view: ShelfView, shelf: Shelf, target_m: Size) -> Floats:
        """Return the share of poses that would show in each pixel, shape (height, width).

        Args:
            view: A look from before the shelf's middle, level, along y.
            shelf: What is looked into.
            target_m: Size of the target.
        """
        window = window_camera(view.camera, shelf)
        inputs = prepare(seen_through(view.depth_m, view.camera, window), window, shelf, target_m)
        with torch.inference_mode():
            roots = self._network(torch.from_numpy(inputs)[None])[0].numpy()
        return spread(np.float32(USUAL) * roots**2, view.camera, window)
