"""Scenes of three cables as in the thesis's Table 4.3, drawn: dropped, knotted, tied together.

Two cables of 3 m and one of 2 m lie upon each other and go from three adapters to free ends.
B1: dropped one after another. B2: each with an overhand or a figure-8 knot of 5 to 10 cm.
B3: two tied together by a square knot, the third wound round one of them. The thesis's tiers
are photographs; these are drawn by what also draws the learned tracer's training, along
lines of another making.
"""

import numpy as np
from numpy.typing import NDArray

from benchmarks.laying import CONFIG, GROWTHS, HIGH, LOW, WIDTH_M, Core, fits, grown, laid, turned
from perception.training.scenes import Scene, lay_scene
from simulation.cable.knots import TEMPLATES

Floats = NDArray[np.float64]

# Lengths in cable widths.
LENGTHS = (3.0 / WIDTH_M, 3.0 / WIDTH_M, 2.0 / WIDTH_M)
KNOT_WIDTHS = (0.05 / WIDTH_M, 0.10 / WIDTH_M)
TRIES = 400


def draw_tier(rng: np.random.Generator, tier: str) -> Scene:
    """Draw a scene of tier B1, B2 or B3."""
    draw = {"B1": _dropped, "B2": _knotted, "B3": _tied}[tier]
    for _ in range(TRIES):
        found = laid(rng, draw(rng), LENGTHS)
        if found is not None:
            return lay_scene(rng, found[0], CONFIG, found[1])
    raise RuntimeError(f"no scene of tier {tier} in {TRIES} tries")


def _dropped(rng: np.random.Generator) -> list[Core]:
    straight = np.array([[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]])
    places = rng.uniform(LOW + 30.0, HIGH - 30.0, (3, 2))
    return [Core(place + turned(rng, straight)) for place in places]


def _knotted(rng: np.random.Generator) -> list[Core]:
    cores = []
    for place in rng.uniform(LOW + 25.0, HIGH - 25.0, (3, 2)):
        template = TEMPLATES["overhand" if rng.random() < 0.5 else "figure_8"]
        mirrored = bool(rng.random() < 0.5)
        size = rng.uniform(*KNOT_WIDTHS) / template.diameter
        points = np.array(template.corners) * size * ((1.0, -1.0) if mirrored else (1.0, 1.0))
        over = tuple(on_top != mirrored for on_top in template.over)
        cores.append(Core(place + turned(rng, points), over))
    return cores


# One of both bights of a square knot: in between its legs, and out round the other's. It
# passes the other one six times; both legs lie on one side of the other's bight.
HALF_BIGHT = np.array([[-3.2, 0.75], [-1.2, 0.75], [0.0, 1.15], [0.9, 1.5], [1.3, 0.8]])
BIGHT = np.vstack([HALF_BIGHT, [[1.35, 0.0]], HALF_BIGHT[::-1] * (1.0, -1.0)])
BIGHT_OVER = (True, False, True, True, False, True)


def _tied(rng: np.random.Generator) -> list[Core]:
    size = rng.uniform(*KNOT_WIDTHS) / 3.0
    place = rng.uniform(LOW + 45.0, HIGH - 45.0)
    both = turned(rng, np.vstack([BIGHT, -BIGHT]) * size)
    first, second = place + both[: len(BIGHT)], place + both[len(BIGHT) :]
    tries = (grown(rng, first, LENGTHS[0]) for _ in range(GROWTHS))
    leg = next((line for line in tries if fits(line, [])), first)
    # The third cable winds round the first one, away from the knot.
    begin = int(rng.uniform(0.08, 0.25) * len(leg))
    half_turns = int(rng.integers(2, 5))
    along = leg[begin : begin + int(half_turns * rng.uniform(14.0, 22.0))]
    return [
        Core(leg, BIGHT_OVER, other=1),
        Core(second),
        Core(_wound(along, half_turns), tuple(k % 2 == 0 for k in range(half_turns)), other=0),
    ]


def _wound(along: Floats, half_turns: int) -> Floats:
    """Return waypoints of a line that changes sides of another one so many times."""
    tangent = np.gradient(along, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    phase = np.linspace(-0.5, half_turns - 0.5, len(along)) * np.pi
    wave = 1.3 * np.cos(phase + 0.5 * np.pi)
    # It comes from well aside, and goes off to where it came to last.
    ends = np.maximum(np.abs(np.linspace(-1.0, 1.0, len(along))) - 0.8, 0.0) * 20.0
    wound: Floats = (along + normal * (wave + np.sign(wave) * ends)[:, None])[::4]
    return wound
