"""What the shelf cell records of itself: joint states and the scene, as JSON.

`/joint_states`, schema `JointStates`: as in `simulation.streams`, joints in chain order.

`/scene`, schema `ShelfScene`:
    {"links": {name: [x, y, z, qx, qy, qz, qw]}, "boxes": {name: [x, y, z, qx, qy, qz, qw]},
     "sizes_m": {name: [width, depth, height]}, "colours": {name: [red, green, blue]},
     "held": str}
    Poses in the world [m], quaternion last, of the arm's links and of the boxes' centres; what
    the cups hold, or nothing.
"""

from collections.abc import Mapping

from robots.interfaces import ArmsState
from simulation.shelf_cell.physics import ShelfPhysics
from simulation.streams import json_bytes, rounded


def joint_states_json(names: tuple[str, ...], state: ArmsState) -> bytes:
    """Return a `JointStates` message."""
    return json_bytes(
        {
            "names": list(names),
            "positions": rounded(state.positions_rad, 5),
            "velocities": rounded(state.velocities_rad_s, 4),
        }
    )


def scene_json(
    physics: ShelfPhysics, colours: Mapping[str, tuple[int, int, int]], held: str
) -> bytes:
    """Return a `ShelfScene` message."""
    links = rounded(physics.link_poses(), 4)
    boxes = rounded(physics.box_poses(), 4)
    sizes = rounded(physics.box_sizes_m, 4)
    names = physics.box_names
    return json_bytes(
        {
            "links": dict(zip(physics.link_names, links, strict=True)),
            "boxes": dict(zip(names, boxes, strict=True)),
            "sizes_m": dict(zip(names, sizes, strict=True)),
            "colours": {name: list(colours[name]) for name in names},
            "held": held,
        }
    )
