"""Random scenes of one to three cables with exact truth: geometry first, then an image."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from perception.camera import GreyImage
from perception.training import contact, curves
from perception.training.connectors import Connector
from perception.training.looks import Look, draw_look
from perception.training.render import render
from perception.training.waypoints import SPACING

Floats = NDArray[np.float64]
# Whether the earlier of two nodes (numbered through all cables) is on top where their strands
# cross; None where chance may say.
FirstOver = Callable[[float, float], bool | None]

MOST_NODES = 1400
# Fewest nodes in view, and how often new curves are drawn to have them.
FEWEST_NODES, TRIES = 60, 6
# Share of further cables that run along another one for a while.
NEAR_ANOTHER = 0.45
NEAR_SHARES = (0.5, 0.3, 0.2)
SHARES = {
    "random": 0.12,
    "parallel": 0.14,
    "dense": 0.14,
    "coil": 0.12,
    "tight": 0.13,
    "settled": 0.35,
}


@dataclass(frozen=True, slots=True, eq=False)
class SceneCable:
    """One cable of a scene.

    Attributes:
        points_px: Centre line, half a cable width apart, shape (N, 2).
        heights: Height of the centre line above the table [widths of the scene], shape (N,).
        width_px: Width of this cable.
    """

    points_px: Floats
    heights: Floats
    width_px: float


@dataclass(frozen=True, slots=True)
class SceneCrossing:
    """Where two strands cross, as cable and node number with fraction; the upper one first."""

    over: tuple[int, float]
    under: tuple[int, float]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """An image and everything that is true about it.

    Attributes:
        image: Grey image.
        width_px: Width of the cables; single ones may differ from it.
        cables: Their centre lines.
        crossings: Where strands cross; those at nearly one height, or under a connector, are
            left out.
        connectors: Plugs and adapters at the ends of the cables.
    """

    image: GreyImage
    width_px: float
    cables: tuple[SceneCable, ...]
    crossings: tuple[SceneCrossing, ...]
    connectors: tuple[Connector, ...] = ()


@dataclass(frozen=True, slots=True)
class SceneConfig:
    """What scenes to draw; lengths in cable widths unless a name says otherwise.

    Attributes:
        extent: Side of the square that curves are drawn in.
        size_px: (height, width) of the image; None for a square of `extent`.
        narrowest_px: Least width of a cable.
        widest_px: Greatest width of a cable.
        family: One family of curves, or None for all.
        cables: Number of cables, or None for 1 to 3.
        bright: Whether cables are brighter than the table, or None for either.
        style: One of `perception.training.looks.STYLES`, or None for any.
        alike: Whether all cables look the same, or None for half of all scenes.
        leaving: Share of scenes that are moved aside, so that more strands leave the view.
        hairpins: Share of cables that are settled ones, seen where they turn back tightly.
        look: How it looks; None to draw that, too.
    """

    extent: float = 46.0
    size_px: tuple[int, int] | None = None
    narrowest_px: float = 4.0
    widest_px: float = 14.0
    family: str | None = None
    cables: int | None = None
    bright: bool | None = None
    style: str | None = None
    alike: bool | None = None
    leaving: float = 0.15
    hairpins: float = 0.0
    look: Look | None = None


def make_scene(rng: np.random.Generator, config: SceneConfig | None = None) -> Scene:
    """Draw a scene."""
    config = config or SceneConfig()
    return lay_scene(rng, seen_lines(rng, config), config)


def lay_scene(
    rng: np.random.Generator,
    lines: Sequence[Floats],
    config: SceneConfig,
    first_over: FirstOver | None = None,
) -> Scene:
    """Return a scene of cables along given lines; arguments as for `lay_scenes`."""
    return lay_scenes(rng, lines, config, first_over, shots=1)[0]


def lay_scenes(
    rng: np.random.Generator,
    lines: Sequence[Floats],
    config: SceneConfig,
    first_over: FirstOver | None = None,
    *,
    shots: int,
) -> tuple[Scene, ...]:
    """Return scenes of the very same cables along given lines, alike but for light and noise.

    Args:
        rng: Source of all randomness.
        lines: Centre lines with nodes half a cable width apart, in cable widths, in the square
            of the config's extent; shape (N, 2) each.
        config: What the scene looks like.
        first_over: Says where over and under is prescribed.
        shots: How many images to take.
    """
    return shoot(rng, lay(rng, lines, config, first_over), shots)


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """Cables as they lie, and how they will look.

    Attributes:
        nodes: Nodes of all cables (x, y, height) [widths], in the square of the extent.
        cable: Which cable each belongs to, shape (N,).
        width_px: Width of the cables.
        side_px: Side of the square.
        size_px: (height, width) of the image.
        look: How the scene looks.
    """

    nodes: Floats
    cable: NDArray[np.int64]
    width_px: float
    side_px: int
    size_px: tuple[int, int]
    look: Look


def lay(
    rng: np.random.Generator,
    lines: Sequence[Floats],
    config: SceneConfig,
    first_over: FirstOver | None = None,
) -> Laid:
    """Choose look, over and under of cables along given lines; arguments as for `lay_scenes`."""
    width_px = float(np.exp(rng.uniform(np.log(config.narrowest_px), np.log(config.widest_px))))
    side_px = int(config.extent * width_px)
    look = config.look or draw_look(rng, len(lines), config.bright, config.style, config.alike)
    nodes, cable = _settled(rng, lines, look, first_over)
    return Laid(nodes, cable, width_px, side_px, config.size_px or (side_px, side_px), look)


def shoot(rng: np.random.Generator, laid: Laid, shots: int = 1) -> tuple[Scene, ...]:
    """Return scenes of cables as they lie, alike but for light and noise."""
    width_px, size_px, look = laid.width_px, laid.size_px, laid.look
    parts = [laid.nodes[laid.cable == k] for k in range(len(look.cables))]
    origin_px = np.array([size_px[1] - laid.side_px, size_px[0] - laid.side_px]) / 2.0
    strands = [
        np.column_stack([part[:, :2] * width_px + origin_px, part[:, 2] * width_px])
        for part in parts
    ]
    images, connectors = render(rng, strands, width_px, size_px, look, shots)
    cables = tuple(
        SceneCable(strand[:, :2], part[:, 2], own.width * width_px)
        for strand, part, own in zip(strands, parts, look.cables, strict=True)
    )
    crossings = _true_crossings(laid.nodes, laid.cable)
    seen = [each for each in crossings if not _covered(each, cables, connectors)]
    return tuple(Scene(image, width_px, cables, tuple(seen), connectors) for image in images)


def _covered(
    crossing: SceneCrossing, cables: Sequence[SceneCable], connectors: Sequence[Connector]
) -> bool:
    """Say whether a connector hides a crossing."""
    which, node = crossing.over
    line = cables[which].points_px
    place = np.array([np.interp(node, np.arange(len(line)), axis) for axis in line.T])
    return any(connector.hides(place) for connector in connectors)


def seen_lines(rng: np.random.Generator, config: SceneConfig) -> list[Floats]:
    """Return centre lines of which enough lies in view."""
    aside = rng.uniform(-0.35, 0.35, 2) * config.extent * (rng.random() < config.leaving)
    lines: list[Floats] = []
    for _ in range(TRIES):
        lines = [line + aside for line in _lines(rng, config)]
        points = np.vstack([*lines, np.zeros((0, 2))])
        inside = (points > 0.0).all(axis=1) & (points < config.extent).all(axis=1)
        if inside.sum() >= FEWEST_NODES:
            break
    return lines


def _lines(rng: np.random.Generator, config: SceneConfig) -> list[Floats]:
    count = config.cables or int(rng.choice([1, 2, 3], p=[0.25, 0.4, 0.35]))
    lines: list[Floats] = []
    left = MOST_NODES
    for _ in range(count):
        family = config.family or str(rng.choice(list(SHARES), p=list(SHARES.values())))
        if config.hairpins > 0.0 and rng.random() < config.hairpins:
            family = "hairpin"
        if lines and rng.random() < NEAR_ANOTHER:
            near = curves.NEAR[rng.choice(len(curves.NEAR), p=NEAR_SHARES)]
            line = near(rng, lines[-1])
        else:
            line = curves.FAMILIES[family](rng, config.extent)
        line = line[: max(left, 2)]
        left -= len(line)
        if len(line) > 20:
            lines.append(line)
    return lines


def _settled(
    rng: np.random.Generator, lines: Sequence[Floats], look: Look, first_over: FirstOver | None
) -> tuple[Floats, NDArray[np.int64]]:
    """Choose what lies over what, and part the strands; returns balls and their cables."""
    xy = np.vstack(lines)
    cable = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    heights = 0.5 + _lifts(rng, cable)
    in_order = rng.random() < 0.3
    number = np.arange(len(xy))
    for first, second in contact.crossings(xy, cable):
        known = first_over(first, second) if first_over is not None else None
        upper = second if in_order and rng.random() < 0.85 else rng.choice([first, second])
        if known is not None:
            upper = first if known else second
        heights += 0.7 * np.exp(-(((number - upper) * SPACING / 1.5) ** 2))
    nodes = np.column_stack([xy, heights])
    widths = np.array([own.width for own in look.cables])
    contact.settle(nodes, cable, contact.near_pairs(xy, cable), 40, widths)
    return nodes, cable


def _lifts(rng: np.random.Generator, cable: NDArray[np.int64]) -> Floats:
    """Return heights of strands that stand up from the table, as stiff cables do."""
    lifts = np.abs(gaussian_filter1d(rng.normal(size=len(cable)), rng.uniform(8.0, 30.0)))
    highest = rng.choice([0.15, 1.0, 4.0], p=[0.4, 0.4, 0.2]) * rng.random()
    return np.asarray(highest * lifts / max(float(lifts.max()), 1e-9))


def _true_crossings(nodes: Floats, cable: NDArray[np.int64]) -> tuple[SceneCrossing, ...]:
    starts = np.searchsorted(cable, np.arange(cable[-1] + 1))
    found = []
    for pair in contact.crossings(np.ascontiguousarray(nodes[:, :2]), cable):
        heights = np.interp(pair, np.arange(len(nodes)), nodes[:, 2])
        if abs(heights[0] - heights[1]) < 0.5:
            continue
        places = [(int(cable[int(at)]), float(at - starts[cable[int(at)]])) for at in pair]
        over = int(heights[1] > heights[0])
        found.append(SceneCrossing(places[over], places[1 - over]))
    return tuple(found)
