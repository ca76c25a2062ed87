"""Lay cables with the physics and pull them about: centre lines that training draws from.

The first cables have the plainest knots or none, at all sizes. Then come all knots of the
thesis, and fakes of them, loose and dense by turns. `python -m benchmarks.settled_cables`
writes `perception/training/settled.npz`. Perception does not know the physics, so what it
learns from is kept in a file.
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from simulation.cable.configurations import starting_configuration
from simulation.cable.knots import TEMPLATES, KnotName
from simulation.cable.layout import Area
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.rules import ConfigurationRules

Floats = NDArray[np.float64]

TARGET = Path("perception/training/settled.npz")
SEED = 970_001
PLAIN: tuple[KnotName, ...] = ("overhand", "figure_8", "none")
PLAIN_CABLES = 160
# Lengths are kept as whole tenths of a millimetre.
UNIT_M = 1.0e-4
STEP_S = 1.0 / 240.0
PULL_M_S = 0.25
# How often plain cables are pulled, and the others.
PULLS, FEWER_PULLS = 4, 2
# The rest are drawn outwards, which pulls knots tight.
INWARDS = 0.65
AREA = Area((-0.45, -0.32), (0.45, 0.32))
# They are pulled about afterwards and need not have come to a full rest.
RULES = ConfigurationRules(
    length_m=2.4, diameter_m=(0.06, 0.2), most_crossings=8, area=AREA, still_m=np.inf
)
DENSE = replace(RULES, diameter_m=(0.05, 0.12), most_crossings=10)
LOOSE = replace(RULES, diameter_m=(0.2, 0.4), most_crossings=9, length_m=3.0)


@dataclass(frozen=True, slots=True)
class Sort:
    """What kind of cable to lay.

    Attributes:
        knot: What is tied.
        fake: Whether it is but a fake.
        rules: How large it is, and how it lies.
        pulls: How often it is pulled about.
    """

    knot: KnotName
    fake: bool
    rules: ConfigurationRules
    pulls: int


def sort_of(number: int) -> Sort:
    """Return of which sort the cable with a number is."""
    if number < PLAIN_CABLES:
        return Sort(PLAIN[number % len(PLAIN)], False, RULES, PULLS)
    kinds = [(knot, fake) for fake in (False, True) for knot in TEMPLATES]
    turn, kind = divmod(number - PLAIN_CABLES, len(kinds))
    return Sort(*kinds[kind], (DENSE, LOOSE)[turn % 2], FEWER_PULLS)


def settled_cables(seed: int) -> list[Floats]:
    """Return one cable as it was laid, and after each of some pulls, shape (N, 3) each."""
    rng, sort = np.random.default_rng([SEED, seed]), sort_of(seed)
    parameters = replace(
        RodParameters(), bending_stiffness_n_m2=float(np.exp(rng.uniform(-10.8, -9.2)))
    )
    nodes_m = starting_configuration(sort.knot, rng, parameters, sort.rules, sort.fake)
    found, rod = [nodes_m], Rod(nodes_m, parameters)
    for number in range(sort.pulls):
        _pull(rod, f"hand {number}", rng)
        found.append(rod.positions_m.copy())
    return found


def _pull(rod: Rod, hand: str, rng: np.random.Generator) -> None:
    """Take the cable somewhere, pull it inwards or outwards, let go, and wait a while."""
    nodes_m = rod.positions_m
    at = nodes_m[int(rng.integers(5, len(nodes_m) - 5))].copy()
    rod.move_hand(hand, _tool_at(at))
    if not rod.close_hand(hand, "pinch", 0.05, 0.03, 0.02):
        return
    aim = rng.normal(0.0, 0.12, 2) - at[:2]
    aim *= 1.0 if rng.random() < INWARDS else -1.0
    velocity_m_s = PULL_M_S * np.append(aim / max(float(np.linalg.norm(aim)), 1e-9), 0.06)
    for step in range(int(rng.uniform(0.4, 1.6) / STEP_S)):
        rod.move_hand(hand, _tool_at(at + velocity_m_s * (step + 1) * STEP_S))
        rod.advance(STEP_S)
    rod.release_hand(hand)
    rod.advance(0.4)


def _tool_at(point_m: Floats) -> Floats:
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[:3, 3] = point_m
    return pose


def main() -> None:
    """Lay cables and write their centre lines."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.settled_cables")
    parser.add_argument("--out", type=Path, default=TARGET)
    parser.add_argument("--cables", type=int, default=292)
    options = parser.parse_args()
    lines: list[Floats] = []
    for seed in range(options.cables):
        try:
            lines += settled_cables(seed)
        except InputError as error:
            print(f"cable {seed}: {error}")
        if seed % 10 == 9:
            print(f"{seed + 1} cables, {len(lines)} centre lines", flush=True)
            _write(options.out, lines)
    _write(options.out, lines)


def _write(path: Path, lines: list[Floats]) -> None:
    nodes = np.round(np.vstack(lines) / UNIT_M).astype(np.int16)
    counts = np.array([len(line) for line in lines], dtype=np.int16)
    # Steps along a line compress better than places.
    steps = np.diff(nodes, axis=0, prepend=np.zeros((1, 3), np.int16))
    np.savez_compressed(
        path,
        steps=steps,
        counts=counts,
        unit_m=UNIT_M,
        width_m=2.0 * RodParameters().radius_m,
    )


if __name__ == "__main__":
    main()
