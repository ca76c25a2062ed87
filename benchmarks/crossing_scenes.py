"""Scenes with known over and under: drawn ones, and settled cables in three other renderers.

`camera` is the table cell's own ray caster; `bullet` and `strokes` are those of
`benchmarks.foreign_views`. Training has seen none of the three. Over and under follow from the
heights of the cable.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from benchmarks.foreign_views import draw_view, settled_line
from executive.core.errors import InputError
from perception.cable.polyline import arc_lengths, resample
from perception.cable.topology import curve_crossings
from perception.cable.types import Points, Trace, TraceEnd
from perception.camera import GreyImage
from perception.training.crossing_samples import MeetingConfig, erring_line
from perception.training.scenes import make_scene
from robots.placement import TABLE_SIZE_M
from simulation.cable.knot_names import KnotName
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.overhead_camera import overhead_camera_model
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose
from simulation.render.shapes import cable_shapes
from simulation.table_cell_config import CameraConfig

Floats = NDArray[np.float64]

SEED = 950_001
KNOTS: tuple[KnotName, ...] = ("overhand", "figure_8", "none")
# Strands that are less far apart lie beside each other [m].
LEAST_HEIGHT_M = 0.5 * RodParameters().radius_m
ERRORS = MeetingConfig()


@dataclass(frozen=True, slots=True)
class TrueCrossing:
    """Where strands cross: cable and arc position on it, the upper one first."""

    over: tuple[int, float]
    under: tuple[int, float]


@dataclass(frozen=True, slots=True, eq=False)
class CrossingScene:
    """An image, its cables and their crossings.

    Attributes:
        image: Grey image.
        traces: Cables, as a tracer with the usual errors gives them.
        width_px: Width of the cables.
        crossings: What is true.
    """

    image: GreyImage
    traces: tuple[Trace, ...]
    width_px: float
    crossings: tuple[TrueCrossing, ...]


def drawn_scenes(seed: int, count: int, exact: bool = False) -> Iterator[CrossingScene]:
    """Yield scenes as hard as those of training."""
    for number in range(count):
        rng = np.random.default_rng([SEED, seed, number])
        scene = make_scene(rng)
        lines = [cable.points_px for cable in scene.cables]
        arcs = [arc_lengths(line) / arc_lengths(line)[-1] for line in lines]
        crossings = tuple(
            TrueCrossing(
                (crossing.over[0], _at(arcs[crossing.over[0]], crossing.over[1])),
                (crossing.under[0], _at(arcs[crossing.under[0]], crossing.under[1])),
            )
            for crossing in scene.crossings
            if _in_view(scene.image, lines[crossing.over[0]][int(crossing.over[1])])
        )
        traces = tuple(_trace(rng, line, scene.width_px, exact) for line in lines)
        yield CrossingScene(scene.image, traces, scene.width_px, crossings)


def settled_scenes(
    renderer: str, seed: int, count: int, exact: bool = False
) -> Iterator[CrossingScene]:
    """Yield settled cables with a knot or none, seen by one of `RENDERERS`."""
    found, number = 0, 100_000 * seed
    while found < count:
        try:
            line_m, scene = RENDERERS[renderer](KNOTS[number % len(KNOTS)], number)
        except InputError:
            # Some seeds lead to no configuration within the rules.
            number += 1
            continue
        rng = np.random.default_rng([SEED, number])
        yield _with_truth(rng, line_m, *scene, exact)
        found, number = found + 1, number + 1


Seen = tuple[GreyImage, Floats, float]


def _with_truth(
    rng: np.random.Generator,
    line_m: Floats,
    image: GreyImage,
    line_px: Floats,
    width_px: float,
    exact: bool,
) -> CrossingScene:
    heights = line_m[:, 2]
    arcs = arc_lengths(line_px) / arc_lengths(line_px)[-1]
    crossings = []
    for crossing in curve_crossings(np.column_stack([line_px, heights])).crossings:
        nodes = (crossing.first, crossing.second)
        if not _in_view(image, line_px[int(crossing.first)]):
            continue
        if abs(_at(heights, nodes[0]) - _at(heights, nodes[1])) < LEAST_HEIGHT_M:
            continue
        upper = 0 if crossing.first_over else 1
        over, under = ((0, _at(arcs, nodes[k])) for k in (upper, 1 - upper))
        crossings.append(TrueCrossing(over, under))
    trace = _trace(rng, line_px, width_px, exact)
    return CrossingScene(image, (trace,), width_px, tuple(crossings))


def _trace(rng: np.random.Generator, line_px: Floats, width_px: float, exact: bool) -> Trace:
    points = resample(line_px, 0.5 * width_px)
    line = points if exact else erring_line(rng, points, width_px, ERRORS)
    return Trace(line, TraceEnd.ENDPOINT, 1.0)


def _in_view(image: GreyImage, place_px: Floats) -> bool:
    size = np.array(image.shape[::-1])
    return bool((place_px > 0.0).all() and (place_px < size - 1.0).all())


def _at(values: Points, node: float) -> float:
    return float(np.interp(node, np.arange(len(values), dtype=float), values))


def _camera(knot: KnotName, number: int) -> tuple[Floats, Seen]:
    """Show a settled cable to the cell's camera, from nearer or farther than usual."""
    line_m = settled_line(knot, number)
    rng = np.random.default_rng([SEED, number, 1])
    config = CameraConfig(
        scale_m_px=float(rng.uniform(0.0007, 0.0013)), blur_px=float(rng.uniform(0.3, 1.3))
    )
    model, parameters = overhead_camera_model(config), RodParameters()
    rod = Rod(line_m, parameters)
    shapes = cable_shapes(line_m, parameters.radius_m, rod.connector_poses())
    rendering = Renderer(model, TABLE_SIZE_M, rng).render(shapes)
    sensor = replace(SensorParameters(), blur_px=config.blur_px)
    width_px = 2.0 * parameters.radius_m / config.scale_m_px
    return line_m, (expose(rendering, sensor, rng), model.project(line_m), width_px)


def _foreign(renderer: str) -> Callable[[KnotName, int], tuple[Floats, Seen]]:
    def show(knot: KnotName, number: int) -> tuple[Floats, Seen]:
        view = draw_view(renderer, knot, number)
        return settled_line(knot, number), (view.image, view.line_px, view.width_px)

    return show


RENDERERS: Mapping[str, Callable[[KnotName, int], tuple[Floats, Seen]]] = MappingProxyType(
    {"camera": _camera, "bullet": _foreign("bullet"), "strokes": _foreign("strokes")}
)
