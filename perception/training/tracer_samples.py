"""Samples for the tracer's network: crops with the path so far, and where the cable goes on."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.tracers.centre_line import tangents
from perception.models import tracer_crop
from perception.models.frames import Crop, Floats, ScaledImage, scale_image, turned_frame
from perception.models.tracer_crop import make_crop
from perception.models.tracer_net import HORIZONS
from perception.training.contact import crossings, near_pairs
from perception.training.scenes import Scene, SceneConfig, make_scene
from perception.training.waypoints import hairpin_nodes

NOWHERE = -1000.0
# Strands closer than this touch [cable widths].
BESIDE = 1.4
BESIDE_NODES = 12
# Nodes to either side of a hairpin within which the cable turns back.
HAIRPIN_NODES = 8
# Length over which a trace drifts off and comes back [steps].
DRIFT_STEPS = 1.5
# Farther off a trace may be on the next strand, and what is right is no longer known.
FARTHEST_ASIDE = 0.45 * tracer_crop.WIDTH


@dataclass(frozen=True, slots=True, eq=False)
class TracerSamples:
    """A batch.

    Attributes:
        crops: From `make_crop`, shape (N, 3, P, P).
        targets: Where the cable is after 1, 2, ... steps, (x, y) in crop pixels, shape
            (N, HORIZONS, 2); `NOWHERE` where it has ended.
    """

    crops: Crop
    targets: Floats


@dataclass(frozen=True, slots=True)
class SampleConfig:
    """How samples are drawn from scenes.

    Attributes:
        from_scene: Samples a scene.
        zoom: Pixels of a crop a unit.
        hairpins: Share of samples placed where the cable turns back tightly, if it does.
        interesting: Share of samples placed where other strands are near.
        ends: Share of samples within three steps of an end of a cable.
        scale_error: Standard deviation of the logarithm of the cable's assumed width.
        jitter: Largest standard deviation of points of the path [cable widths].
        drift: Largest standard deviation of how far stretches of it lie aside [cable widths].
        short: Share of samples with a path of one to three points.
    """

    from_scene: int = 32
    zoom: float = 1.0
    hairpins: float = 0.2
    interesting: float = 0.65
    ends: float = 0.1
    scale_error: float = 0.12
    jitter: float = 0.2
    drift: float = 0.25
    short: float = 0.12


def sample_stream(
    seed: int, first: int, stride: int, scenes: SceneConfig, config: SampleConfig
) -> Iterator[TracerSamples]:
    """Yield the samples of scenes `first`, `first + stride`, ...; each has a seed of its own."""
    number = first
    while True:
        rng = np.random.default_rng([seed, number])
        yield scene_samples(rng, make_scene(rng, scenes), config)
        number += stride


def scene_samples(rng: np.random.Generator, scene: Scene, config: SampleConfig) -> TracerSamples:
    """Draw samples from one scene."""
    width_px = scene.width_px * float(np.exp(rng.normal(0.0, config.scale_error)))
    scaled = scale_image(scene.image, width_px, tracer_crop.WIDTH, config.zoom)
    lines = [scaled.into(cable.points_px) for cable in scene.cables]
    near, bends = _near_strands(lines), [hairpin_nodes(each, HAIRPIN_NODES) for each in lines]
    crops, targets = [], []
    for _ in range(config.from_scene):
        which = int(rng.integers(len(lines)))
        line = lines[which]
        at = _place(rng, len(line), near[which], bends[which], config)
        if rng.random() < 0.5:
            line, at = line[::-1], len(line) - 1 - at
        drawn = _draw_sample(rng, scaled, line, at, config)
        if drawn is not None:
            crops.append(drawn[0])
            targets.append(drawn[1])
    if not crops:
        return TracerSamples(
            np.zeros((0, 3, *2 * (round(tracer_crop.SIZE * config.zoom),)), np.float32),
            np.zeros((0, HORIZONS, 2)),
        )
    return TracerSamples(np.stack(crops), np.stack(targets))


def _near_strands(lines: list[Floats]) -> list[Floats]:
    """Return, for each cable, the node numbers where it crosses or touches a strand."""
    cable = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    starts = np.searchsorted(cable, np.arange(len(lines) + 1))
    # Both are looked for in cable widths, as nodes are half a width apart.
    nodes = np.vstack(lines) / tracer_crop.WIDTH
    pairs = near_pairs(nodes, cable)
    gaps = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1)
    # Nodes this close along one strand are no two strands.
    apart = (cable[pairs[:, 0]] != cable[pairs[:, 1]]) | (pairs[:, 1] - pairs[:, 0] > BESIDE_NODES)
    touching = np.unique(pairs[(gaps < BESIDE) & apart]).astype(float)
    crossed = crossings(nodes, cable).ravel()
    # Long touches have many nodes; both kinds of places shall be met about equally often.
    repeats = max(round(len(touching) / max(len(crossed), 1)), 1)
    places = np.concatenate([touching, np.repeat(crossed, repeats)])
    return [
        places[(places >= starts[k]) & (places < starts[k + 1])] - starts[k]
        for k in range(len(lines))
    ]


def _place(
    rng: np.random.Generator,
    nodes: int,
    near: Floats,
    bends: NDArray[np.int64],
    config: SampleConfig,
) -> float:
    """Return the node number, with fraction, that a sample is about."""
    if len(bends) and rng.random() < config.hairpins:
        return float(rng.choice(bends) + rng.uniform(-10.0, 10.0))
    if rng.random() < config.ends:
        return float(nodes - 1 - rng.uniform(0.0, 12.0))
    if len(near) and rng.random() < config.interesting:
        return float(rng.choice(near) + rng.uniform(-18.0, 18.0))
    return float(rng.uniform(0.0, nodes - 1))


def _draw_sample(
    rng: np.random.Generator,
    scaled: ScaledImage,
    line: Floats,
    at: float,
    config: SampleConfig,
) -> tuple[Crop, Floats] | None:
    along = arc_lengths(line)
    here = float(np.interp(at, np.arange(len(line)), along))
    if not 0.0 < here < along[-1] - 0.05 * tracer_crop.STEP:
        return None
    known = _known_arcs(rng, here, config)
    path = point_at(line, along, known)
    # A trace may start at the very end of a cable; its first step then lies beyond it.
    outwards = (line[0] - line[1]) / max(float(along[1]), 1e-9)
    path += np.minimum(known, 0.0)[:, None] * -outwards
    if not scaled.holds(path[-1]):
        return None
    path = path + _errors(rng, path, config)
    heading = path[-1] - path[-2]
    unit = heading / max(float(np.linalg.norm(heading)), 1e-9)
    frame = turned_frame(path[-1], unit, tracer_crop.HERE)
    ahead = here + tracer_crop.STEP * np.arange(1.0, HORIZONS + 1.0)
    targets = frame.into(point_at(line, along, ahead))
    targets[ahead > along[-1]] = NOWHERE
    return make_crop(scaled, path, frame), targets


def _errors(rng: np.random.Generator, path: Floats, config: SampleConfig) -> Floats:
    """Return errors as traces have them: of single points, and aside of the cable for a while."""
    jitter, drift = rng.uniform(0.0, (config.jitter, config.drift)) * tracer_crop.WIDTH
    slow = gaussian_filter1d(rng.normal(0.0, 1.0, len(path)), DRIFT_STEPS, mode="nearest")
    # White noise loses this much of its deviation to the filter.
    slow *= np.sqrt(2.0 * DRIFT_STEPS * np.sqrt(np.pi))
    aside = np.clip(drift * slow, -FARTHEST_ASIDE, FARTHEST_ASIDE)
    along = tangents(path, 1)
    errors: Floats = rng.normal(0.0, jitter, path.shape)
    return errors + aside[:, None] * np.column_stack([-along[:, 1], along[:, 0]])


def _known_arcs(rng: np.random.Generator, here: float, config: SampleConfig) -> Floats:
    """Return arc positions of the path so far, ending at `here`."""
    most = max(int(here / (0.8 * tracer_crop.STEP)), 1)
    if rng.random() < config.short:
        most = min(most, int(rng.integers(1, 4)))
    elif rng.random() < 0.5:
        most = min(most, int(rng.integers(4, 60)))
    strides = tracer_crop.STEP * rng.uniform(0.8, 1.15, most)
    back = here - np.concatenate([[0.0], np.cumsum(strides)])
    return back[: max(int((back >= 0.0).sum()), 2)][::-1]
