"""Cables as renderers show them that neither training nor the cell's camera uses.

Centre lines are those that the physics settled, on seeds of their own. `bullet` is PyBullet's
software renderer: chains of capsules, plain or patterned tables, a camera that may be tilted.
`strokes` is a diagram: flat strokes, broken where they pass below.
"""

import itertools
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, gaussian_filter1d

from perception.camera import GreyImage
from simulation.cable.configurations import starting_configuration
from simulation.cable.knots import KnotName
from simulation.cable.layout import Area
from simulation.cable.parameters import RodParameters
from simulation.cable.rules import ConfigurationRules

Floats = NDArray[np.float64]

SEED = 930_001
SIZES_PX = ((480, 640), (600, 800), (773, 1032), (720, 1280))
# Half of what is seen across [m], and how much more that may be.
VIEW_M, FARTHEST = 0.42, 1.25
CAMERA_M, NEAREST_M = 4.0, 0.1
STEEPEST = 0.12
LEAST_CONTRAST = 60.0
RULES = ConfigurationRules(
    length_m=2.0, diameter_m=(0.08, 0.25), most_crossings=7, area=Area((-0.38, -0.28), (0.38, 0.28))
)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """An image and the true line in it.

    Attributes:
        image: Grey image.
        line_px: Centre line, shape (N, 2).
        width_px: Width of the cable.
        knot: What is tied.
    """

    image: GreyImage
    line_px: Floats
    width_px: float
    knot: KnotName


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """What both renderers are told: grey values in [0, 255], the cable's radius, the view."""

    table: float
    cable: float
    radius_m: float
    scale_px_m: float
    size_px: tuple[int, int]


def draw_view(renderer: str, knot: KnotName, number: int) -> View:
    """Return one view.

    Args:
        renderer: One of `RENDERERS`.
        knot: What is tied.
        number: Of the configuration and of its look.
    """
    line_m = settled_line(knot, number)
    rng = np.random.default_rng([SEED, number, len(renderer)])
    look = _draw_look(rng)
    image, line_px = RENDERERS[renderer](rng, line_m, look)
    return View(image, line_px, 2.0 * look.radius_m * look.scale_px_m, knot)


def settled_line(knot: KnotName, number: int) -> Floats:
    """Return a cable at rest, shape (N, 3)."""
    rng = np.random.default_rng([SEED, number])
    stiffness = float(np.exp(rng.uniform(-10.8, -9.2)))
    parameters = replace(RodParameters(), bending_stiffness_n_m2=stiffness)
    return starting_configuration(knot, rng, parameters, RULES)


def _draw_look(rng: np.random.Generator) -> _Look:
    table, cable = rng.uniform(0.0, 255.0, 2)
    while abs(table - cable) < LEAST_CONTRAST:
        table, cable = rng.uniform(0.0, 255.0, 2)
    size_px = SIZES_PX[int(rng.integers(len(SIZES_PX)))]
    half_px = min(size_px[1] / 2.0, 1.25 * size_px[0] / 2.0)
    scale_px_m = half_px / (VIEW_M * rng.uniform(1.0, FARTHEST))
    radius_m = rng.uniform(0.8, 1.25) * RodParameters().radius_m
    return _Look(table, cable, float(radius_m), float(scale_px_m), size_px)


def _strokes(rng: np.random.Generator, line_m: Floats, look: _Look) -> tuple[GreyImage, Floats]:
    """Draw pieces from the lowest to the highest, each with a border of the table's grey."""
    line_px = 0.5 * (np.array(look.size_px[::-1]) - 1.0)
    line_px = line_px + line_m[:, :2] * look.scale_px_m * (1.0, -1.0)
    width = 2.0 * look.radius_m * look.scale_px_m
    gap = width * rng.uniform(0.25, 0.8)
    smooth = cv2.LINE_AA if rng.random() < 0.7 else cv2.LINE_8
    picture = np.full(look.size_px, look.table, np.float32)
    for k in np.argsort(gaussian_filter1d(line_m[:, 2], 2.0), kind="stable"):
        # What is drawn reaches farther than the gap beside it, so that the line is whole.
        for reach, grey, thickness in ((1, look.table, width + 2.0 * gap), (2, look.cable, width)):
            piece = np.round(line_px[max(k - reach, 0) : k + reach + 1] * 16.0).astype(np.int32)
            cv2.polylines(
                picture, [piece[:, None]], False, grey, max(round(thickness), 1), smooth, 4
            )
    return np.clip(picture, 0.0, 255.0).astype(np.uint8), line_px


def _bullet(rng: np.random.Generator, line_m: Floats, look: _Look) -> tuple[GreyImage, Floats]:
    """Let PyBullet's software renderer draw the chain on a table, lit from a side."""
    import pybullet
    from pybullet_utils.bullet_client import BulletClient

    client: Any = BulletClient(pybullet.DIRECT)
    try:
        _add_table(client, rng, look)
        _add_chain(client, line_m, look)
        view, projection = _camera(client, rng, look)
        light = rng.normal((0.0, 0.0, 2.0), 1.0)
        rows, columns = look.size_px
        pixels = client.getCameraImage(
            columns,
            rows,
            view,
            projection,
            lightDirection=[*light[:2], abs(light[2]) + 0.5],
            shadow=int(rng.random() < 0.6),
            lightAmbientCoeff=float(rng.uniform(0.3, 0.7)),
            lightDiffuseCoeff=float(rng.uniform(0.3, 0.6)),
            lightSpecularCoeff=float(rng.uniform(0.0, 0.4)),
            renderer=pybullet.ER_TINY_RENDERER,
        )[2]
    finally:
        client.disconnect()
    colour = np.asarray(pixels, np.uint8).reshape(rows, columns, 4)[:, :, :3]
    grey = np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), np.uint8)
    return grey, _projected(line_m, view, projection, look.size_px)


def _add_table(client: Any, rng: np.random.Generator, look: _Look) -> None:
    colour = [1.0, 1.0, 1.0, 1.0] if rng.random() < 0.5 else [*[look.table / 255.0] * 3, 1.0]
    shape = client.createVisualShape(
        client.GEOM_BOX, halfExtents=[1.5, 1.5, 0.01], rgbaColor=colour
    )
    table = client.createMultiBody(0.0, -1, shape, [0.0, 0.0, -0.011])
    if colour[0] < 1.0:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "table.png"
        cv2.imwrite(str(path), _pattern(rng, look.table))
        client.changeVisualShape(table, -1, textureUniqueId=client.loadTexture(str(path)))


def _pattern(rng: np.random.Generator, grey: float) -> NDArray[np.uint8]:
    """Return cloth: noise of several sizes, and threads."""
    cloth = np.full((1024, 1024), grey)
    for sigma in (1.0, 4.0, 30.0):
        strength = sigma * rng.uniform(0.0, 14.0)
        cloth += gaussian_filter(rng.normal(size=cloth.shape), sigma) * strength
    threads = np.sin(np.arange(1024) * rng.uniform(0.3, 1.5)) * rng.uniform(0.0, 8.0)
    pattern: NDArray[np.uint8] = np.clip(cloth + threads[:, None], 0.0, 255.0).astype(np.uint8)
    return pattern


def _add_chain(client: Any, line_m: Floats, look: _Look) -> None:
    colour = [*[look.cable / 255.0] * 3, 1.0]
    for start, stop in itertools.pairwise(line_m):
        step = stop - start
        length_m = float(np.linalg.norm(step))
        shape = client.createVisualShape(
            client.GEOM_CAPSULE, radius=look.radius_m, length=length_m, rgbaColor=colour
        )
        client.createMultiBody(0.0, -1, shape, list(0.5 * (start + stop)), _along(step / length_m))


def _along(unit: Floats) -> list[float]:
    """Return the quaternion (x, y, z, w) that turns the z axis to a direction."""
    quat = np.append(np.cross([0.0, 0.0, 1.0], unit), 1.0 + unit[2])
    return list(quat / np.linalg.norm(quat))


def _camera(client: Any, rng: np.random.Generator, look: _Look) -> tuple[list[float], list[float]]:
    """Return view and projection matrices of a camera high above, half of the time tilted."""
    tilt = rng.uniform(-STEEPEST, STEEPEST, 2) * (rng.random() < 0.5)
    eye_m = [CAMERA_M * float(tilt[0]), CAMERA_M * float(tilt[1]), CAMERA_M]
    half = 0.5 * np.array(look.size_px[::-1]) / look.scale_px_m * NEAREST_M / CAMERA_M
    view = client.computeViewMatrix(eye_m, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    projection = client.computeProjectionMatrix(
        -half[0], half[0], -half[1], half[1], NEAREST_M, 10.0
    )
    return view, projection


def _projected(
    line_m: Floats, view: list[float], projection: list[float], size_px: tuple[int, int]
) -> Floats:
    """Return where points are seen, shape (N, 2) [px]."""
    # OpenGL's matrices come column by column.
    both = np.array(projection).reshape(4, 4).T @ np.array(view).reshape(4, 4).T
    seen = np.column_stack([line_m, np.ones(len(line_m))]) @ both.T
    device = seen[:, :2] / seen[:, 3:]
    size = np.array(size_px[::-1])
    line_px: Floats = (device * (0.5, -0.5) + 0.5) * size - 0.5
    return line_px


RENDERERS: dict[str, Callable[[np.random.Generator, Floats, _Look], tuple[GreyImage, Floats]]] = {
    "bullet": _bullet,
    "strokes": _strokes,
}
