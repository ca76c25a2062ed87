"""What the shelf cell records of itself: joint states and the scene, as JSON.

`/joint_states`, schema `JointStates`: as in `simulation.streams`, joints in chain order.

`/scene`, schema `ShelfScene`:
    {"links": {name: [x, y, z, qx, qy, qz, qw]}, "boxes": {name: [x, y, z, qx, qy, qz, qw]},
     "sizes_m": {name: [width, depth, height]}, "colours": {name: [red, green, blue]},
     "held": str}
    Poses in the world [m], quaternion last, of the arm's links and of the boxes' centres; what
    the cups hold, or nothing.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from perception.shelf.types import Floats
from robots.interfaces import ArmsState
from simulation.shelf_cell.physics import ShelfPhysics


def joint_states_json(names: tuple[str, ...], state: ArmsState) -> bytes:
    """Return a `JointStates` message."""
    return _json(
        {
            "names": list(names),
            "positions": _rounded(state.positions_rad, 5),
            "velocities": _rounded(state.velocities_rad_s, 4),
        }
    )


def scene_json(
    physics: ShelfPhysics, colours: Mapping[str, tuple[int, int, int]], held: str
) -> bytes:
    """Return a `ShelfScene` message."""
    links = _rounded(physics.link_poses(), 4)
    boxes = _rounded(physics.box_poses(), 4)
    sizes = _rounded(physics.box_sizes_m, 4)
    names = physics.box_names
    return _json(
        {
            "links": dict(zip(physics.link_names, links, strict=True)),
            "boxes": dict(zip(names, boxes, strict=True)),
            "sizes_m": dict(zip(names, sizes, strict=True)),
            "colours": {name: list(colours[name]) for name in names},
            "held": held,
        }
    )


def _rounded(values: Floats, digits: int) -> list[Any]:
    # Adding zero turns -0.0, which would look like a change, into 0.0.
    rounded: list[Any] = (np.round(np.asarray(values, dtype=np.float64), digits) + 0.0).tolist()
    return rounded


def _json(message: dict[str, object]) -> bytes:
    return json.dumps(message, separators=(",", ":")).encode()
