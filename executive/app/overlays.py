"""What a run has planned, seen and believed, as overlays of its scene."""

import json
from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from executive.engine.recording.reader import Recording
from robots.interfaces import Floats
from robots.shelf_arm.scene import ShelfSize
from robots.viewer import Eye
from robots.viewer.overlays import Dots, Lines, Screen, axes_lines, facing, joined, path_lines

# Ways of tools, by arm; a single arm has that of the left one.
_WAYS = {"left": (0.35, 0.85, 1.0), "right": (1.0, 0.55, 0.85)}
_AXES_M = 0.05
# Pictures are made that wide; a page holds one for every look.
_PICTURE_PX = 400
_KEPT = 16
# Places that are this share as probable as the best one, or less, are left out.
_LEAST_SHARE = 0.02
# Boxes hide what is behind them: dots lie on the roof, over the places that they mean.
_MOST_DOTS, _DOT_M, _OVER_ROOF_M = 3000, 0.012, 0.025


def plan_overlay(data: bytes) -> Lines | None:
    """Return the ways of tools in a message of the stream `/plan`, and the frames they end in."""
    parts = []
    for arm, poses in json.loads(data)["tools"].items():
        rows = np.array(poses)
        axes = Rotation.from_quat(rows[-1, 3:]).as_matrix()
        parts.append(path_lines(rows[:, :3], _WAYS.get(arm, _WAYS["left"])))
        parts.append(axes_lines(rows[-1, :3], axes, _AXES_M))
    return joined(*parts) if parts else None


def target_overlay(places_m: Floats, weights: Floats) -> Dots | None:
    """Return where a target may be, on the shelf's roof: brighter where it is more probable.

    Args:
        places_m: On the floor of the shelf, shape (K, 2).
        weights: Probability of each, shape (K,).
    """
    if not len(weights) or weights.max() <= 0.0:
        return None
    shares = weights / weights.max()
    kept = np.argsort(-shares, kind="stable")[:_MOST_DOTS]
    kept = kept[shares[kept] > _LEAST_SHARE]
    points_m = np.column_stack(
        [places_m[kept], np.full(len(kept), ShelfSize().height_m + _OVER_ROOF_M)]
    )
    # From dark red over orange to yellow.
    hot = np.column_stack([0.35 + 0.65 * shares, 0.9 * shares, 0.1 * shares])[kept]
    return Dots(points_m, hot, _DOT_M)


def picture_overlay(png: bytes, middle_m: Floats, eye: Eye, width_m: float) -> Screen:
    """Return a picture on a screen that faces the eye.

    Args:
        png: The picture.
        middle_m: Of the screen, in the world, shape (3,).
        eye: From where the scene is looked at.
        width_m: Of the screen.
    """
    image = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None
    share = image.shape[0] / image.shape[1]
    if image.shape[1] > _PICTURE_PX:
        size = (_PICTURE_PX, round(_PICTURE_PX * share))
        image = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    small = cv2.imencode(".png", image)[1].tobytes()
    T_world_screen = facing(middle_m, np.array(eye.from_m))
    return Screen(small, T_world_screen, width_m, width_m * share)


class Pictures:
    """Images of a recording by number, read on in the order in which they were written."""

    def __init__(self, recording: Recording) -> None:
        """Begin before the first one."""
        self._images = recording.images()
        self._latest: dict[int, bytes] = {}

    def png(self, number: int) -> bytes | None:
        """Return an image as a PNG file; None for one that was written long before the last."""
        while number not in self._latest:
            image = next(self._images, None)
            if image is None:
                return None
            self._latest[image.number] = image.png
            if len(self._latest) > _KEPT:
                del self._latest[min(self._latest)]
        return self._latest[number]


def encoded_array(value: Mapping[str, Any]) -> NDArray[np.float64] | None:
    """Return an array as recordings hold it; None where it is kept elsewhere."""
    values = value.get("values")
    return None if values is None else np.array(values, dtype=np.float64)
