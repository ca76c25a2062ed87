"""Semantic occupancy: where a target stands by the company that objects keep (thesis, section 6.3).

A place is as likely as the target is to have the object that is nearest to that place as its
neighbour: P(L_T = l | L, C) is proportional to M[target, N(l)].
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from perception.camera import CameraModel
from perception.shelf.affinity import AffinityMatrix
from perception.shelf.types import Box, Floats, Shelf, Sighting

# The thesis smooths over 50 px (section 7.4), of images 640 px wide (section 7.5).
SMOOTHING_SHARE = 50.0 / 640.0
# Places along a ray on the floor of the shelf.
STEPS = 36


def floor_semantics(
    places_m: Floats, boxes: Mapping[str, Box], affinity: AffinityMatrix, target: str
) -> Floats:
    """Return the affinity of the target to what stands nearest to each place.

    Args:
        places_m: Places (x, y) on the floor [m], shape (K, 2).
        boxes: The objects where they were first seen; names that the affinities do not know are
            left out.
        affinity: Affinities.
        target: Name of the target.

    Returns:
        Shape (K,); even where nothing known is seen.

    Raises:
        InputError: The affinities do not know the target.
    """
    row = affinity.row(target)
    known = [name for name in boxes if name in affinity.names and name != target]
    if not known:
        return np.full(len(places_m), 1.0 / len(affinity.names))
    centres_m = np.array([(boxes[name].x_m, boxes[name].y_m) for name in known])
    values = np.array([row[affinity.index(name)] for name in known])
    apart = ((places_m[:, None, :] - centres_m[None]) ** 2).sum(axis=2)
    return values[apart.argmin(axis=1)]


def column_semantics(
    camera: CameraModel,
    shelf: Shelf,
    boxes: Mapping[str, Box],
    affinity: AffinityMatrix,
    target: str,
) -> Floats:
    """Return semantic occupancy along the image, added up along camera rays over the floor.

    Args:
        camera: What looks into the shelf.
        shelf: The shelf.
        boxes: The objects where they were first seen.
        affinity: Affinities.
        target: Name of the target.

    Returns:
        One value for each column of the image, shape (width,), smoothed; 0 beside the shelf.
    """
    columns = (np.arange(camera.width_px) - camera.centre_px[0]) / camera.focal_px
    rays = np.column_stack([columns, np.zeros_like(columns), np.ones_like(columns)])
    rays = rays @ camera.T_world_camera[:3, :3].T
    origin_m = camera.T_world_camera[:3, 3]
    y_m = shelf.depth_m * (np.arange(STEPS) + 0.5) / STEPS
    x_m = origin_m[0] + (y_m[None] - origin_m[1]) * (rays[:, 0] / rays[:, 1])[:, None]
    places_m = np.column_stack([x_m.ravel(), np.broadcast_to(y_m, x_m.shape).ravel()])
    values = floor_semantics(places_m, boxes, affinity, target).reshape(x_m.shape)
    inside = (x_m >= 0.0) & (x_m <= shelf.width_m)
    return smooth_columns((values * inside).sum(axis=1))


def image_semantics(seen: Sequence[Sighting], affinity: AffinityMatrix, target: str) -> Floats:
    """Return semantic occupancy in the image by distance in pixels, for depth that is too noisy.

    The thesis's variant for its physical experiments (section 6.3).

    Args:
        seen: Objects as they were first seen, at least one.
        affinity: Affinities.
        target: Name of the target.

    Returns:
        Shape (height, width), smoothed along x.
    """
    height, width = seen[0].mask.shape
    rows, columns = np.mgrid[:height, :width]
    boxes = {}
    for sighting in seen:
        y_px, x_px = (float(axis.mean()) for axis in np.nonzero(sighting.mask))
        boxes[sighting.label] = Box(x_px, y_px, (0.0, 0.0, 0.0))
    places = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
    values = floor_semantics(places, boxes, affinity, target).reshape(height, width)
    return smooth_columns(values)


def smooth_columns(values: Floats) -> Floats:
    """Smooth along the image's width with the thesis's Gaussian, scaled to the width."""
    sigma_px = SMOOTHING_SHARE * values.shape[-1]
    smoothed: Floats = gaussian_filter1d(values, sigma_px, axis=-1, mode="nearest")
    return smoothed
