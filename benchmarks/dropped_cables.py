"""Scenes of three cables as in the thesis's Table 4.3, drawn: dropped, knotted, tied together.

Two cables of 3 m and one of 2 m lie upon each other and go from three adapters to free ends.
B1: dropped one after another. B2: each with one of the thesis's six knots, of 5 to 10 cm. B3:
tied to each other by one to three square knots, carrick bends and sheet bends of that size. The
thesis's tiers are photographs; these are drawn by what also draws the learned tracer's
training, along lines of another making.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.knot_cores import knot_core
from benchmarks.laying import CONFIG, HIGH, LOW, WIDTH_M, Core, Part, apart, laid, turned
from benchmarks.tied_cables import tied
from perception.training.scenes import Scene, lay_scenes
from simulation.cable.knots import TEMPLATES

Floats = NDArray[np.float64]
Layout = tuple[Sequence[Core], Sequence[Sequence[Part]]]

# Lengths in cable widths.
LENGTHS = (3.0 / WIDTH_M, 3.0 / WIDTH_M, 2.0 / WIDTH_M)
KNOT_WIDTHS = (0.05 / WIDTH_M, 0.10 / WIDTH_M)
MOST_TIES = 3
# The thesis takes so many images of each scene, and asks that two of them are traced right.
IMAGES = 3
TRIES = 400


def draw_tier(rng: np.random.Generator, tier: str) -> Scene:
    """Draw a scene of tier B1, B2 or B3."""
    return _drawn(rng, tier, 1)[0]


def draw_tier_images(rng: np.random.Generator, tier: str) -> tuple[Scene, ...]:
    """Draw a scene of a tier and photograph it three times, each in light and noise of its own.

    The first of them is the scene that `draw_tier` draws.
    """
    return _drawn(rng, tier, IMAGES)


def _drawn(rng: np.random.Generator, tier: str, shots: int) -> tuple[Scene, ...]:
    draw = {"B1": _dropped, "B2": _knotted, "B3": _tied}[tier]
    for _ in range(TRIES):
        cores, ties = draw(rng)
        found = laid(rng, cores, LENGTHS, ties)
        if found is not None:
            return lay_scenes(rng, found[0], CONFIG, found[1], shots=shots)
    raise RuntimeError(f"no scene of tier {tier} in {TRIES} tries")


def _dropped(rng: np.random.Generator) -> Layout:
    straight = np.array([[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]])
    places = rng.uniform(LOW + 30.0, HIGH - 30.0, (3, 2))
    return [Core(place + turned(rng, straight)) for place in places], []


def _knotted(rng: np.random.Generator) -> Layout:
    names, cores = list(TEMPLATES), []
    for place in apart(rng, len(LENGTHS)):
        knot = names[int(rng.integers(len(names)))]
        least = TEMPLATES[knot].least_diameter_m(WIDTH_M) / WIDTH_M
        diameter = max(float(rng.uniform(*KNOT_WIDTHS)), least)
        cores.append(knot_core(rng, knot, diameter, place, tied=True))
    return cores, []


def _tied(rng: np.random.Generator) -> Layout:
    return tied(rng, 1 + int(rng.integers(MOST_TIES)), KNOT_WIDTHS)
