"""One cable of 3 m with one knot or with what looks like one: the thesis's tiers A1 to A3.

A1: loose knots of 35 to 40 cm. A2: dense ones of 5 to 10 cm. A3: the same shapes of any size,
over and under such that nothing is knotted. The rest of the cable lies across itself and the
knot as it falls. What is true is said by knot theory about the line in space; a scene in which
that is not what was meant is drawn anew. Scenes are drawn by the training's renderer in any
look or in the thesis's own, or laid by the physics and seen by the camera of the table cell.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.knot_cores import knot_core
from benchmarks.knot_look import thesis_look
from benchmarks.knot_truth import (
    first_undercrossings,
    is_knotted,
    is_unknotted,
    part,
    polynomial,
)
from benchmarks.laying import CONFIG, WIDTH_M, Core, laid, span
from perception.cable.topology import curve_crossings
from perception.camera import GreyImage
from perception.training.scenes import Scene, SceneConfig, lay_scene
from robots.placement import TABLE_SIZE_M
from simulation.cable.configurations import settle
from simulation.cable.knots import TEMPLATES, KnotName, evenly
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.overhead_camera import overhead_camera_model
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose
from simulation.render.shapes import cable_shapes
from simulation.table_cell_config import CameraConfig

Floats = NDArray[np.float64]

SEED = 950_001
TIERS = ("A1", "A2", "A3")
KNOTS: tuple[KnotName, ...] = (
    "overhand",
    "figure_8",
    "overhand_honda",
    "bowline",
    "linked_overhand",
    "figure_8_honda",
)
LENGTH_M = 3.0
DIAMETERS_M = {"A1": (0.35, 0.40), "A2": (0.05, 0.10), "A3": (0.05, 0.40)}
# The table with a margin; the middle of the view [cable widths].
ROOM = (np.array(TABLE_SIZE_M) - 0.06) / WIDTH_M
MIDDLE = np.array([0.5, 0.5]) * CONFIG.extent
# Strands that cross lie at least so far apart in height [cable widths].
APART = 0.5
TRIES = 3000


@dataclass(frozen=True, slots=True, eq=False)
class KnotScene:
    """An image of a cable and its line in space.

    Attributes:
        tier: A1, A2 or A3.
        knot: What is tied, or looks as if it were.
        image: Grey image.
        width_px: Width of the cable.
        nodes_px: Centre line, height as the third column, shape (N, 3).
        tied: Between which nodes the knot is tied.
    """

    tier: str
    knot: KnotName
    image: GreyImage
    width_px: float
    nodes_px: Floats
    tied: tuple[float, float]

    @property
    def is_knotted(self) -> bool:
        """Whether there is a knot."""
        return self.tier != "A3"

    def nodes_from(self, start_px: Floats) -> Floats:
        """Return the line from the end that lies nearest to a start, shape (N, 3)."""
        gaps = np.linalg.norm(self.nodes_px[[0, -1], :2] - start_px, axis=1)
        return self.nodes_px if gaps[0] <= gaps[1] else self.nodes_px[::-1]

    def undercrossings_from(self, start_px: Floats) -> Floats:
        """Return where the first knot begins for who traces from a start, shape (K, 2)."""
        nodes, last = self.nodes_from(start_px), len(self.nodes_px) - 1.0
        turned = nodes is not self.nodes_px
        tied = (last - self.tied[1], last - self.tied[0]) if turned else self.tied
        return first_undercrossings(nodes, tied)


def drawn(tier: str, number: int, seed: int) -> KnotScene:
    """Return a scene of a tier as the training's renderer draws it; knots take turns."""
    rng = np.random.default_rng([SEED, seed, TIERS.index(tier), number])
    knot = KNOTS[number % len(KNOTS)]
    return next(_drawn(rng, tier, knot))


def as_in_thesis(tier: str, number: int, seed: int) -> KnotScene:
    """Return a scene of a tier as `drawn`, but in the look that the thesis measured on."""
    rng = np.random.default_rng([SEED, seed, TIERS.index(tier), number, 2])
    config = replace(CONFIG, look=thesis_look(rng))
    return next(_drawn(rng, tier, KNOTS[number % len(KNOTS)], config))


def _drawn(
    rng: np.random.Generator, tier: str, knot: KnotName, config: SceneConfig = CONFIG
) -> Iterator[KnotScene]:
    """Yield scenes of a tier.

    Raises:
        RuntimeError: There are no more.
    """
    for core in _cores(rng, tier, knot):
        found = laid(rng, [core], [LENGTH_M / WIDTH_M])
        if found is None or (np.ptp(found[0][0], axis=0) > ROOM).any():
            continue
        lines, known = found
        first, last = span(core, lines[0])
        scene = lay_scene(rng, lines, config, known)
        seen = KnotScene(
            tier, knot, scene.image, scene.width_px, _nodes_px(scene), (float(first), float(last))
        )
        if is_as_meant(seen):
            yield seen
    raise RuntimeError(f"{tier} {knot}: no scene in {TRIES} tries")


def _nodes_px(scene: Scene) -> Floats:
    cable = scene.cables[0]
    return np.column_stack([cable.points_px, cable.heights * scene.width_px])


def _cores(rng: np.random.Generator, tier: str, knot: KnotName) -> Iterator[Core]:
    """Yield knots of a tier, lying anyhow near the middle of the view."""
    low, high = np.array(DIAMETERS_M[tier]) / WIDTH_M
    for _ in range(TRIES):
        diameter = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        place = MIDDLE + rng.uniform(-0.25, 0.25, 2) * ROOM
        yield knot_core(rng, knot, diameter, place, tied=tier != "A3")


def is_as_meant(scene: KnotScene) -> bool:
    """Say whether the knot is tied where it should be and nowhere else, or nothing is tied.

    Strands that cross must also lie clearly over each other.
    """
    nodes = scene.nodes_px
    strand = curve_crossings(nodes)
    places = np.array([(c.first, c.second) for c in strand.crossings]).reshape(-1, 2)
    heights = np.interp(places, np.arange(len(nodes), dtype=float), nodes[:, 2])
    if (np.abs(np.diff(heights, axis=1)) < APART * scene.width_px).any():
        return False
    if not scene.is_knotted:
        return is_unknotted(strand)
    wanted = polynomial(TEMPLATES[scene.knot].strand())
    both = (strand, part(strand, *scene.tied))
    return all(is_knotted(one) and polynomial(one) == wanted for one in both)


def settled(tier: str, number: int, seed: int) -> KnotScene:
    """Return a scene of a tier that came to rest on the table, as the cell's camera sees it."""
    rng = np.random.default_rng([SEED, seed, TIERS.index(tier), number, 1])
    parameters = RodParameters()
    for drawing in _drawn(rng, tier, KNOTS[number % len(KNOTS)]):
        nodes_m = settle(_planned_m(drawing, parameters), parameters)
        if (np.abs(nodes_m[:, :2]) < 0.5 * np.array(TABLE_SIZE_M)).all():
            scene = _photographed(rng, drawing, nodes_m, parameters)
            if is_as_meant(scene):
                return scene
    raise AssertionError("drawings end with an error")


def _planned_m(drawing: KnotScene, parameters: RodParameters) -> Floats:
    """Return the line of a drawing in the middle of the table, shape (N, 3)."""
    line_m = drawing.nodes_px * (WIDTH_M / drawing.width_px) * (1.0, -1.0, 1.0)
    middle_m = 0.5 * (line_m.min(axis=0) + line_m.max(axis=0))
    return evenly(line_m - middle_m * (1.0, 1.0, 0.0), parameters.node_spacing_m)


def _photographed(
    rng: np.random.Generator, drawing: KnotScene, nodes_m: Floats, parameters: RodParameters
) -> KnotScene:
    """Return what the cell's camera sees of a cable that was laid after a drawing."""
    config = CameraConfig()
    camera = overhead_camera_model(config)
    rod = Rod(nodes_m, parameters)
    shapes = cable_shapes(nodes_m, parameters.radius_m, rod.connector_poses())
    rendering = Renderer(camera, TABLE_SIZE_M, rng).render(shapes)
    sensor = SensorParameters(config.blur_px, config.read_noise, config.speckle)
    share = (len(nodes_m) - 1) / (len(drawing.nodes_px) - 1)
    return KnotScene(
        drawing.tier,
        drawing.knot,
        expose(rendering, sensor, rng),
        2.0 * parameters.radius_m / config.scale_m_px,
        np.column_stack([camera.project(nodes_m), nodes_m[:, 2] / config.scale_m_px]),
        (drawing.tied[0] * share, drawing.tied[1] * share),
    )
