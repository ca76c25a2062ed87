"""Where a hidden target would show: its poses as columns of an image, for looking ahead."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from perception.camera import CameraModel
from perception.shelf.planning.kernels import Ints, rising, survey
from perception.shelf.types import Box, Floats, Size, corners

# So much more of a target is to show than is asked for: places are known to some millimetres.
MARGIN = 0.03


@dataclass(frozen=True, slots=True)
class Grain:
    """How finely it is judged what shows.

    Attributes:
        columns: Columns across the image; 0 for one in the middle of each pixel.
        shown: A pose counts as seen when it rises above what is before it by this share of its own
            face. More than the thesis's 1 %: poses stand for their neighbours, and places are known
            to some millimetres.
        more: By this share of its face a pose must rise higher that should show and does not.
        clear_m: What is pushed aside leaves so much on its side of a line of sight.
        sight: Such a line ends at this share of the target's height.
    """

    columns: int = 96
    shown: float = 0.04
    more: float = 0.04
    clear_m: float = 0.008
    sight: float = 0.8

    def showing(self, share: float) -> "Grain":
        """Return the same for a target of which at least so much has to show."""
        return replace(self, shown=max(self.shown, share + MARGIN))


# Finer columns cost time and change no decision where there is room.
COARSE = Grain()
# Where there is little room, a slit of a pixel is worth a try.
FINE = Grain(columns=0, shown=0.012, more=0.012, clear_m=0.0025, sight=0.88)


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """The columns in which each pose of a target would show.

    Attributes:
        eye: Position of the camera [m], shape (3,).
        slopes: Direction of each column, x over depth, shape (C,).
        column: Column of each entry, shape (E,).
        depth: Depth of the target there [m].
        top: Its elevation there.
        start: First entry of each pose, and the end of the last, shape (K + 1,).
        shows: By how much a pose must rise above what is before it to be seen, shape (K,).
    """

    eye: Floats
    slopes: Floats
    column: Ints
    depth: Floats
    top: Floats
    start: Ints
    shows: Floats


def outlook(
    camera: CameraModel, places_m: Floats, target_m: Size, grain: Grain = COARSE
) -> Outlook:
    """Return where a target would show.

    Args:
        camera: What looks into the shelf, about level, along y.
        places_m: Where the target's centre may be, shape (K, 2).
        target_m: Its size.
        grain: How finely it is judged.
    """
    eye = camera.T_world_camera[:3, 3].copy()
    right, along = camera.T_world_camera[:3, 0], camera.T_world_camera[:3, 2]
    pixels = np.arange(camera.width_px, dtype=np.float64)
    if grain.columns:
        pixels = np.linspace(-0.5, camera.width_px - 0.5, grain.columns)
    across = (pixels - camera.centre_px[0]) / camera.focal_px
    slopes = (along[0] + across * right[0]) / (along[1] + across * right[1])
    half = 0.5 * np.array(target_m[:2])
    heights = np.full((len(places_m), 1), target_m[2])
    near, rise = survey(np.hstack([places_m - half, places_m + half, heights]), slopes, eye)
    cell, column = np.nonzero(np.isfinite(near))
    depth, top = near[cell, column], rise[cell, column]
    faces = np.bincount(cell, weights=top + eye[2] / depth, minlength=len(places_m))
    start = np.searchsorted(cell, np.arange(len(places_m) + 1))
    return Outlook(eye, slopes, column, depth, top, start, np.maximum(grain.shown * faces, 1e-6))


def restricted(whole: Outlook, poses: Ints) -> Outlook:
    """Return the outlook of some of the poses, by number, ascending."""
    counts = whole.start[poses + 1] - whole.start[poses]
    start = np.concatenate([[0], np.cumsum(counts)])
    entries = np.repeat(whole.start[poses] - start[:-1], counts) + np.arange(start[-1])
    return Outlook(
        whole.eye, whole.slopes, whole.column[entries], whole.depth[entries], whole.top[entries],
        start, whole.shows[poses],
    )  # fmt: skip


def shares_shown(
    places_m: Floats, target_m: Size, boxes: Sequence[Box], camera: CameraModel
) -> Floats:
    """Return how much of its face a target would show in each place, shape (K,).

    Args:
        places_m: Where its centre may be, shape (K, 2).
        target_m: Its size.
        boxes: What may hide it.
        camera: See `outlook`.
    """
    view = outlook(camera, places_m, target_m)
    lows_m, highs_m = corners(tuple(boxes))
    rows = np.hstack([lows_m[:, :2], highs_m])
    rises = rising(
        rows, view.slopes, view.eye, view.column, view.depth, view.top, view.start,
        np.ones(len(places_m)),
    )  # fmt: skip
    shares: Floats = rises * COARSE.shown / view.shows
    return shares
