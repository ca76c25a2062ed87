"""What arms are about to do, as a stream: the ways of their tools in the motion that runs.

`/plan`, schema `Plan`:
    {"tools": {arm: [[x, y, z, qx, qy, qz, qw], ...]}, "duration_s": float}
    Poses of each tool that moves, in the world [m], from where the motion begins to where it ends;
    none and 0 at rest. One is written when a motion begins, and one when it has ended.
"""

import json

import numpy as np
import pinocchio as pin

from robots.interfaces import Trajectory
from robots.motion.model import RobotModel
from simulation.streams import Stream

SAMPLES = 25
_MOVED_M = 1e-3


class PlanStream(Stream):
    """Keeps a message whenever another motion runs."""

    def __init__(self, robot: RobotModel, rate_hz: float) -> None:
        """Begin at rest.

        Args:
            robot: Whose motions they are.
            rate_hz: Motions looked at a second, at most.
        """
        super().__init__("/plan", "Plan", rate_hz)
        self._robot = robot
        self._shown: Trajectory | None = None

    def watch(self, now_s: float, motion: Trajectory | None) -> None:
        """Take note of the motion that runs now; None at rest."""
        if motion is not self._shown:
            self._shown = motion
            self.add(now_s, plan_json(self._robot, motion))


def plan_json(robot: RobotModel, motion: Trajectory | None) -> bytes:
    """Return a `Plan` message."""
    tools, duration_s = {}, 0.0
    if motion is not None:
        duration_s = motion.duration_s
        rows = [motion.at(float(t))[0] for t in np.linspace(0.0, duration_s, SAMPLES)]
        for arm in robot.arms:
            poses = [pin.SE3ToXYZQUAT(robot.tcp_pose(arm, row)) for row in rows]
            if np.ptp(np.array(poses)[:, :3], axis=0).max() > _MOVED_M:
                tools[arm] = np.round(poses, 4).tolist()
    message = {"tools": tools, "duration_s": round(duration_s, 3)}
    return json.dumps(message, separators=(",", ":")).encode()
