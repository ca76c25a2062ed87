"""Scenes for the detector with their truth: masks, ends, crossings, tangles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from perception.camera import GreyImage
from perception.training import rasterise
from perception.training.connectors import SHIFT, Connector
from perception.training.scenes import Scene, SceneConfig, lay_scene, make_scene
from perception.training.waypoints import resample

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Kind = TypeVar("Kind", bound=np.generic)

NARROWEST_PX, WIDEST_PX = 3.5, 15.0
# Share of scenes without any cable.
EMPTY = 0.05
# Nodes are half a cable width apart: this many give the direction of an end.
DIRECTION_NODES = 6
# Crossings this near to each other [cable widths] and at least so many are a tangle.
LINK_WIDTHS, LEAST_CROSSINGS = 4.5, 3
WIDEST_TANGLE = 14.0
# A strand this much higher [cable radii] hides an end.
HIDES = 0.4


@dataclass(frozen=True, slots=True, eq=False)
class SightTruth:
    """A square image and what is to be seen in it; all places in pixels.

    Attributes:
        image: Grey image.
        width_px: Width of the cables.
        cable: Which pixels show cable.
        widths_px: How wide the cable at each of them is.
        connector: Which pixels show connectors.
        ends: Ends of cables, shape (N, 2), some of them outside the image.
        inwards: Unit vectors into the cable, shape (N, 2).
        plugged: Which ends carry a connector, shape (N,).
        visible: Which are not hidden by a strand, shape (N,).
        crossings: Where strands cross, shape (M, 2).
        tangles: Middles and radii of places with many crossings, shape (K, 3).
    """

    image: GreyImage
    width_px: float
    cable: Bools
    widths_px: NDArray[np.float32]
    connector: Bools
    ends: Floats
    inwards: Floats
    plugged: Bools
    visible: Bools
    crossings: Floats
    tangles: Floats

    @property
    def shown(self) -> Bools:
        """Which pixels show cable or connector."""
        pixels: Bools = self.cable | self.connector
        return pixels

    @property
    def usual_width_px(self) -> float:
        """Width that most of the cable in view has; that of the scene where there is none."""
        return float(np.median(self.widths_px[self.cable])) if self.cable.any() else self.width_px

    def near_ends(self, place_px: Floats, widths: float) -> Bools:
        """Say which ends lie within some cable widths of a place, shape (N,)."""
        near: Bools = np.linalg.norm(self.ends - place_px, axis=1) < widths * self.width_px
        return near

    def clear_ends(self, border_widths: float) -> Bools:
        """Say which ends can be seen and are not near to the border, shape (N,)."""
        last = np.array(self.image.shape[::-1]) - 1
        depth = np.minimum(self.ends, last - self.ends).min(axis=1)
        clear: Bools = self.visible & (depth > border_widths * self.width_px)
        return clear


def draw_truth(
    rng: np.random.Generator, size_px: tuple[int, int], hairpins: float = 0.0
) -> SightTruth:
    """Draw a scene of cables of any width that fills an image.

    Args:
        rng: Source of all randomness.
        size_px: (height, width) of the image.
        hairpins: Share of cables that are seen where they turn back tightly.
    """
    width_px = float(np.exp(rng.uniform(np.log(NARROWEST_PX), np.log(WIDEST_PX))))
    config = SceneConfig(
        extent=max(size_px) / width_px * rng.uniform(0.75, 1.25),
        size_px=size_px,
        narrowest_px=width_px,
        widest_px=width_px,
        hairpins=hairpins,
    )
    if rng.random() < EMPTY:
        beyond = np.array([[-200.0, -200.0], [-100.0, -200.0]])
        return truth_of(lay_scene(rng, [resample(beyond)], config))
    return truth_of(make_scene(rng, config))


def truth_of(scene: Scene) -> SightTruth:
    """Return what is to be seen in a scene."""
    height, widths_px = _strands(scene)
    cable, connector = _masks(scene, height)
    lines = [each.points_px for each in scene.cables]
    tips = np.array([line[end] for line in lines for end in (0, -1)])
    inner = np.array(
        [
            line[n]
            for line in lines
            for n in (min(DIRECTION_NODES, len(line) - 1), -min(DIRECTION_NODES + 1, len(line)))
        ]
    )
    inwards = inner - tips
    plugs = {(each.cable, each.end): each for each in scene.connectors}
    carried = [plugs.get((k, end)) for k in range(len(lines)) for end in (0, 1)]
    heights = [each.heights[end] for each in scene.cables for end in (0, -1)]
    crossings = _places(scene)
    return SightTruth(
        image=scene.image,
        width_px=scene.width_px,
        cable=cable,
        widths_px=widths_px,
        connector=connector,
        ends=tips,
        inwards=inwards / np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-9),
        plugged=np.array([plug is not None for plug in carried]),
        visible=np.array(
            [
                (plug is not None and not plug.covered)
                or not _is_hidden(height, tip, level * scene.width_px, scene.width_px)
                for plug, tip, level in zip(carried, tips, heights, strict=True)
            ]
        ),
        crossings=crossings,
        tangles=_tangles(crossings, scene.width_px),
    )


def _strands(scene: Scene) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return how high strands rise, and how wide the topmost one is, for each pixel."""
    size = scene.image.shape
    height, surface = np.zeros(size, np.float32), np.zeros((*size, 4), np.float32)
    for k, each in enumerate(scene.cables):
        strand = np.column_stack([each.points_px, each.heights * scene.width_px])
        fine = resample(strand, scene.width_px / 4.0)
        rasterise.splat(fine, 0.5 * each.width_px, float(k), height, surface)
    widths_px = np.array([each.width_px for each in scene.cables], np.float32)
    return height, widths_px[surface[:, :, 0].astype(int)]


def _masks(scene: Scene, height: NDArray[np.float32]) -> tuple[Bools, Bools]:
    """Return which pixels show cable, and which connectors."""
    size = scene.image.shape
    above = _outlined(size, [each for each in scene.connectors if not each.covered])
    below = _outlined(size, [each for each in scene.connectors if each.covered])
    cable = (height > 0.0) & ~above
    return cable, above | (below & ~cable)


def _outlined(size: tuple[int, ...], connectors: Sequence[Connector]) -> Bools:
    drawn = np.zeros(size, np.uint8)
    for connector in connectors:
        for outline in connector.outlines_px:
            places = np.round(outline * 2**SHIFT).astype(np.int32)
            cv2.fillPoly(drawn, [places[:, None]], 1, cv2.LINE_8, SHIFT)
    filled: Bools = drawn.astype(bool)
    return filled


def _is_hidden(height: NDArray[np.float32], tip: Floats, level_px: float, width_px: float) -> bool:
    x, y = (round(float(value)) for value in tip)
    if not (0 <= y < height.shape[0] and 0 <= x < height.shape[1]):
        return False
    return bool(height[y, x] > level_px + 0.5 * width_px * (1.0 + HIDES))


def _places(scene: Scene) -> Floats:
    places = [
        0.5 * (_at(scene, crossing.over) + _at(scene, crossing.under))
        for crossing in scene.crossings
    ]
    return np.array(places).reshape(-1, 2)


def _at(scene: Scene, place: tuple[int, float]) -> Floats:
    line = scene.cables[place[0]].points_px
    return np.array([np.interp(place[1], np.arange(len(line)), axis) for axis in line.T])


def _tangles(crossings: Floats, width_px: float) -> Floats:
    """Return middles and radii of groups of near crossings, shape (K, 3)."""
    if len(crossings) < LEAST_CROSSINGS:
        return np.empty((0, 3))
    near = cKDTree(crossings)
    graph = near.sparse_distance_matrix(near, LINK_WIDTHS * width_px)
    # Crossings at one place have no distance, which a sparse matrix takes for none.
    graph.data = graph.data + 1.0 if hasattr(graph, "data") else graph
    count, labels = connected_components(graph.tocsr(), directed=False)
    found = []
    for label in range(count):
        group = crossings[labels == label]
        if len(group) >= LEAST_CROSSINGS:
            middle = 0.5 * (group.min(axis=0) + group.max(axis=0))
            reach = float(np.linalg.norm(group - middle, axis=1).max())
            found.append([*middle, reach + width_px])
    return np.array(found).reshape(-1, 3)


def turned(truth: SightTruth, mirrored: bool, quarters: int) -> SightTruth:
    """Return the same seen in a mirror and turned by quarters, counter-clockwise."""
    last = truth.image.shape[0] - 1
    middle, sign = np.full(2, 0.5 * last), (-1.0 if mirrored else 1.0)

    def vectors(values: Floats) -> Floats:
        moved = values * (sign, 1.0)
        for _ in range(quarters):
            moved = np.column_stack([moved[:, 1], -moved[:, 0]])
        return moved

    def places(values: Floats) -> Floats:
        return vectors(values - middle) + middle

    def pixels(values: NDArray[Kind]) -> NDArray[Kind]:
        return np.ascontiguousarray(np.rot90(values[:, ::-1] if mirrored else values, quarters))

    return replace(
        truth,
        image=pixels(truth.image),
        cable=pixels(truth.cable),
        widths_px=pixels(truth.widths_px),
        connector=pixels(truth.connector),
        ends=places(truth.ends),
        inwards=vectors(truth.inwards),
        crossings=places(truth.crossings),
        tangles=np.column_stack([places(truth.tangles[:, :2]), truth.tangles[:, 2]]),
    )


def relit(rng: np.random.Generator, image: GreyImage) -> GreyImage:
    """Return the image as another camera in another light may show it, perhaps as a negative."""
    levels = np.linspace(0.0, 1.0, 256) ** float(np.exp(rng.uniform(-0.5, 0.5)))
    gain = rng.uniform(0.5, 1.0)
    levels = rng.uniform(0.0, 1.0 - gain) + gain * levels
    if rng.random() < 0.3:
        levels = 1.0 - levels
    lit = np.asarray(cv2.LUT(image, (255.0 * levels).astype(np.uint8)), np.uint8)
    if rng.random() < 0.2:
        lit = np.asarray(cv2.GaussianBlur(lit, (0, 0), rng.uniform(0.4, 1.3)), np.uint8)
    if rng.random() < 0.3:
        noise = rng.standard_normal(image.shape, dtype=np.float32) * rng.uniform(0.5, 6.0)
        lit = np.clip(lit + noise, 0.0, 255.0).astype(np.uint8)
    return lit
