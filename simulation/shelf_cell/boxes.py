"""What the boxes of a scene weigh and how they rub."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.shelf.types import Box


@dataclass(frozen=True, slots=True)
class HeavyBox:
    """A cuboid with mass.

    Attributes:
        name: What it is.
        box: Where it stands at first.
        mass_kg: Its mass, evenly spread.
        friction: Coefficient of friction between two such boxes; on other matter it is the
            geometric mean of both.
    """

    name: str
    box: Box
    mass_kg: float
    friction: float


@dataclass(frozen=True, slots=True)
class Matter:
    """What boxes are made of, drawn evenly for each.

    Attributes:
        density_kg_m3: Least and greatest density; packages of pills are light, bottles heavy.
        friction: Least and greatest friction.
    """

    density_kg_m3: tuple[float, float] = (150.0, 500.0)
    friction: tuple[float, float] = (0.25, 0.45)


def weighed(
    names: Sequence[str], boxes: Sequence[Box], matter: Matter, rng: np.random.Generator
) -> tuple[HeavyBox, ...]:
    """Draw mass and friction for boxes, in their order."""
    drawn = rng.random((len(boxes), 2))
    rows = []
    for name, box, (dense, rough) in zip(names, boxes, drawn, strict=True):
        density = _between(matter.density_kg_m3, float(dense))
        volume_m3 = box.size_m[0] * box.size_m[1] * box.size_m[2]
        rows.append(HeavyBox(name, box, density * volume_m3, _between(matter.friction, rough)))
    return tuple(rows)


def _between(ends: tuple[float, float], share: float) -> float:
    return float(ends[0] + share * (ends[1] - ends[0]))
