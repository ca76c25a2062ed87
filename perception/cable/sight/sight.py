"""Looks at a whole image with one small network, which takes the place of Mask R-CNN."""

from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from executive.core.errors import InputError
from perception.cable.sight.reading import ReadingConfig, read_maps
from perception.cable.sight.scales import apparent_width, better_scale, resized
from perception.cable.sight.seen import Seen
from perception.camera import GreyImage
from perception.models.sight_input import prepare
from perception.models.store import load_network, read_config

SMALLEST_PX = 32
MOST_LOOKS = 3


class Sight:
    """Sees cable, ends, crossings and tangles in a grey image of any size.

    Args:
        folder: A trained version of the network `sight`, see `perception.models.store`.
        config: How its maps are read.
    """

    def __init__(self, folder: Path, config: ReadingConfig | None = None) -> None:
        self._network = load_network(folder)
        self._model = read_config(folder)
        self._config = config or ReadingConfig()
        # Steps of perception ask one after the other about the same image.
        self._look = lru_cache(maxsize=2)(self._look_at)

    def look(self, image: GreyImage) -> Seen:
        """Return what is seen.

        Args:
            image: Grey image, shape (height, width), uint8.

        Raises:
            InputError: It is no such image.
        """
        array = np.asarray(image)
        if array.ndim != 2 or array.dtype != np.uint8 or min(array.shape) < SMALLEST_PX:
            raise InputError(
                f"sight: image: got shape {array.shape} of {array.dtype}; expected a grey image "
                f"of uint8, at least {SMALLEST_PX} pixels on each side; "
                "try cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)"
            )
        return self._look(array.tobytes(), array.shape)

    def _look_at(self, pixels: bytes, shape: tuple[int, int]) -> Seen:
        """Look at the image as it is; where cables are wider or thinner than usual, once more."""
        image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
        scale, seen = 1.0, self._read(image)
        for _ in range(MOST_LOOKS - 1):
            wanted = better_scale(scale, apparent_width(seen), shape)
            if wanted is None:
                break
            scale = wanted
            size = (
                max(round(shape[1] * scale), SMALLEST_PX),
                max(round(shape[0] * scale), SMALLEST_PX),
            )
            way = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
            other = np.asarray(cv2.resize(image, size, interpolation=way), np.uint8)
            seen = resized(self._read(other), shape)
        return seen

    def _read(self, image: GreyImage) -> Seen:
        cable, grid = self._maps(image)
        return read_maps(cable, grid, self._model, self._config)

    @torch.inference_mode()
    def _maps(self, image: GreyImage) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the logits of cable, and the maps on the grid, of the image without padding."""
        inputs = torch.from_numpy(prepare(image))[None]
        cable, grid = self._network(inputs.contiguous(memory_format=torch.channels_last))
        rows, columns = image.shape
        return cable[0, 0, :rows, :columns].numpy(), grid[0].numpy()
