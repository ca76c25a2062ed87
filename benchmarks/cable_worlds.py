"""`python -m benchmarks.cable_worlds SEED SECONDS`: a digest of all that happened in a world.

Arms take hold of the cable and pull it about at random until the time is up; every quarter of a
second, joints and cable go into the digest with all their bits.
"""

import hashlib
import sys

import numpy as np

from robots.dual_arm import PlannedDualArm
from robots.interfaces import ARMS, Arm, MotionFailure, TcpGoal, Trajectory
from simulation.cable.configurations import starting_configuration
from simulation.table_world import TableWorld

GRASP_M, TRAVEL_M = 0.008, 0.06
STEP_HZ, EVERY_STEPS = 240, 60


class _Watched:
    """A world whose time is spent in quarters of a second, each of them noted."""

    def __init__(self, seed: int, until_s: float) -> None:
        nodes_m = starting_configuration("overhand", np.random.default_rng(seed))
        self.world = TableWorld(nodes_m, STEP_HZ)
        self.arms = PlannedDualArm(self.world.driver, seed=seed)
        self._until_s, self._digest = until_s, hashlib.sha256()

    @property
    def over(self) -> bool:
        return self.world.now_s() >= self._until_s

    def digest(self) -> str:
        self.world.body.close()
        return self._digest.hexdigest()

    def settle(self) -> None:
        """Let time pass until nothing moves, at least once."""
        while True:
            self.world.advance(EVERY_STEPS)
            state, rod = self.world.driver.state(), self.world.rod
            for row in (state.positions_rad, state.velocities_rad_s, rod.positions_m):
                self._digest.update(row.tobytes())
            if self.over or not self.arms.moving():
                return

    def run(self, plan: Trajectory | MotionFailure) -> bool:
        if isinstance(plan, MotionFailure) or self.over:
            return False
        self.arms.start(plan)
        self.settle()
        return not self.over


def world_digest(seed: int, seconds: float) -> str:
    """Return the digest of so many seconds of a seeded world."""
    rng = np.random.default_rng(seed)
    watched = _Watched(seed, seconds)
    while not watched.over:
        _pull(watched, ARMS[int(rng.integers(2))], rng)
        if not watched.run(watched.arms.plan_home()):
            watched.settle()
    return watched.digest()


def _pull(watched: _Watched, arm: Arm, rng: np.random.Generator) -> None:
    """Go to a point of the cable, close the hand on it, pull, and let go."""
    nodes_m = watched.world.rod.positions_m
    x, y, _ = nodes_m[int(rng.integers(20, len(nodes_m) - 20))]
    down, angle = np.array([0.0, 0.0, TRAVEL_M]), rng.uniform(0.0, 2.0 * np.pi)
    above = TcpGoal(np.array([x, y, GRASP_M + TRAVEL_M]), None, onward_m=(-down,))
    if not watched.run(watched.arms.plan({arm: above})):
        return
    if watched.run(watched.arms.plan_line({arm: -down})):
        watched.arms.grip(arm, "pinch")
        watched.settle()
        aside = 0.08 * np.array([np.cos(angle), np.sin(angle), 0.3])
        watched.run(watched.arms.plan_line({arm: aside}))
        watched.arms.grip(arm, "open")
        watched.settle()
    watched.run(watched.arms.plan_line({arm: down}))


if __name__ == "__main__":
    sys.stdout.write(world_digest(int(sys.argv[1]), float(sys.argv[2])) + "\n")
