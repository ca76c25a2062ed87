"""What a simulated cell records of itself: joint states and the scene, as JSON.

`/joint_states`, schema `JointStates`:
    {"names": [str], "positions": [rad or m], "velocities": [rad/s]}
    All revolute joints first (left arm, then right arm, in chain order), then the opening [m]
    of each gripper as `left_gripper` and `right_gripper`, whose velocity is not told (0).

`/scene`, schema `Scene`:
    {"links": {name: [x, y, z, qx, qy, qz, qw]}, "cable_nodes_m": [[x, y, z], ...],
     "cable_radius_m": float, "more_cables_m": [[[x, y, z], ...], ...]}
    Poses of the robot's links in the world [m], quaternion last; the centre line of the only
    cable, or of the first one, in the world; those of the others, left out without any. Lengths
    are rounded to 0.1 mm, quaternions to 1e-4.

A message is written when something has changed since the last of its kind.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.world import StreamMessage
from robots.descriptions.yumi import arm_joint_names
from robots.interfaces import ARMS, ArmsState

Floats = NDArray[np.float64]

JOINT_NAMES = [name for arm in ARMS for name in arm_joint_names(arm)]
GRIPPER_NAMES = [f"{arm}_gripper" for arm in ARMS]


def joint_states_json(state: ArmsState) -> bytes:
    """Return a `JointStates` message."""
    openings_m = [state.openings_m[arm] for arm in ARMS]
    return json_bytes(
        {
            "names": JOINT_NAMES + GRIPPER_NAMES,
            "positions": rounded([*state.positions_rad, *openings_m], 5),
            "velocities": rounded([*state.velocities_rad_s, *(0.0 for _ in ARMS)], 4),
        }
    )


def scene_json(
    link_names: Sequence[str],
    positions_m: Floats,
    quats_xyzw: Floats,
    lines_m: Sequence[Floats],
    radius_m: float,
) -> bytes:
    """Return a `Scene` message; poses shape (L, 3) and (L, 4), cables shape (N_k, 3) each."""
    poses = np.hstack([positions_m, quats_xyzw])
    first_m, *others_m = lines_m
    message: dict[str, object] = {
        "links": dict(zip(link_names, rounded(poses, 4), strict=True)),
        "cable_nodes_m": rounded(first_m, 4),
        "cable_radius_m": radius_m,
    }
    if others_m:
        message["more_cables_m"] = [rounded(line_m, 4) for line_m in others_m]
    return json_bytes(message)


@dataclass(slots=True)
class Stream:
    """Messages of one topic, thinned to a rate and to those that differ from the last one."""

    topic: str
    schema: str
    rate_hz: float
    _last: bytes = b""
    _due_s: float = 0.0
    _messages: list[StreamMessage] = field(default_factory=list)

    def due(self, now_s: float) -> bool:
        """Return whether it is time for another message."""
        return now_s >= self._due_s - 1e-9

    def add(self, now_s: float, data: bytes) -> None:
        """Keep a message unless it repeats the last one."""
        self._due_s = now_s + 1.0 / self.rate_hz
        if data != self._last:
            self._last = data
            self._messages.append(StreamMessage(self.topic, self.schema, now_s, data))

    def restart(self) -> None:
        """Forget what has been kept; the next message is due now, and differs from all before."""
        self._last, self._due_s = b"", 0.0
        self._messages.clear()

    def drain(self) -> list[StreamMessage]:
        """Return and forget what has been kept."""
        messages, self._messages = self._messages, []
        return messages


def rounded(values: object, digits: int) -> list[Any]:
    """Return numbers of any shape as lists, rounded to so many digits."""
    # Adding zero turns -0.0, which would look like a change, into 0.0.
    numbers: list[Any] = (np.round(np.asarray(values, dtype=np.float64), digits) + 0.0).tolist()
    return numbers


def json_bytes(message: dict[str, object]) -> bytes:
    """Return a message as JSON without spaces."""
    return json.dumps(message, separators=(",", ":")).encode()
