"""From goals of tools to configurations: several, collision-free, best first, or the reason."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice, product

import numpy as np

from robots.interfaces import Arm, Floats, MotionFailure, TcpGoal
from robots.motion.collision import CollisionModel
from robots.motion.grasp import ToolPose, tool_poses
from robots.motion.ik import random_bank, solve_pose
from robots.motion.model import RobotModel
from robots.placement import PlanningScene

BANK_SIZE = 200
_STARTS = 6
_DISTINCT_RAD = 0.1
_TILT_COST = 0.8  # of leaning by a radian, in seconds of motion
_LIMIT_COST = 0.5  # of standing at a joint limit, in seconds of motion
_LIMIT_ZONE_RAD = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Joint positions of one arm that satisfy a goal.

    Attributes:
        positions_rad: Shape (7,).
        cost: Roughly the seconds to get there, plus penalties for leaning and near limits.
    """

    positions_rad: Floats
    cost: float


class GoalSolver:
    """Inverse kinematics of goals with collision checks; the same question, the same answer."""

    def __init__(
        self, robot: RobotModel, scene: PlanningScene, rest_rad: Floats, seed: int
    ) -> None:
        """Prepare the starts of each arm's descent.

        Args:
            robot: The robot.
            scene: What stands around it.
            rest_rad: An ordinary configuration of all arms, one of the starts.
            seed: Of the random starts.
        """
        self.robot = robot
        self.together = CollisionModel(robot, scene)
        self.alone = {arm: CollisionModel(robot, scene, arms=(arm,)) for arm in robot.arms}
        self._rest_rad = rest_rad
        rng = np.random.default_rng(seed)
        self._banks = {
            arm: random_bank(robot.kinematics[arm], rng, BANK_SIZE) for arm in robot.arms
        }

    def set_openings(self, openings_m: Mapping[Arm, float]) -> None:
        """Take note of how far the grippers are open [m] in all later checks."""
        for model in (self.together, *self.alone.values()):
            model.set_openings(openings_m)

    def solutions(
        self,
        arm: Arm,
        goal: TcpGoal,
        positions_rad: Floats,
        count: int,
        *,
        alone: bool,
    ) -> list[Solution] | MotionFailure:
        """Return up to `count` distinct solutions for one arm, the cheapest first.

        Args:
            arm: The arm that moves.
            goal: Where its tool should be.
            positions_rad: Present configuration of all arms; solutions near it are cheap.
            count: Solutions to look for.
            alone: Whether to ignore the other arms (they will move too).
        """
        checker = self.alone[arm] if alone else self.together
        search = _Search(self.robot, arm, positions_rad, checker)
        shoulder_m = self.robot.kinematics[arm].shoulder_m
        if np.linalg.norm(goal.position_m - shoulder_m) > self.robot.specs[arm].reach_m:
            return _unreachable(arm, goal)
        for poses in tool_poses(goal, shoulder_m):
            search.run(poses, self._starts(arm, goal, positions_rad), count)
            if search.found:
                return sorted(search.found, key=lambda solution: solution.cost)
        return _collision(arm, goal, search.pairs) if search.pairs else _unreachable(arm, goal)

    def configurations(
        self, goals: Mapping[Arm, TcpGoal], positions_rad: Floats, count: int
    ) -> list[Floats] | MotionFailure:
        """Return up to `count` configurations of all arms that satisfy goals, best first.

        Arms without a goal stay where they are.
        """
        alone = len(goals) > 1
        per_arm: dict[Arm, list[Solution]] = {}
        for arm, goal in goals.items():
            answer = self.solutions(arm, goal, positions_rad, count, alone=alone)
            if isinstance(answer, MotionFailure):
                return answer
            per_arm[arm] = answer
        combined = self._combine(per_arm, positions_rad)
        if not alone:
            return combined
        free = list(islice((q for q in combined if not self.together.collides(q)), count))
        return free or self._clash(goals, combined[0])

    def _combine(
        self, per_arm: Mapping[Arm, list[Solution]], positions_rad: Floats
    ) -> list[Floats]:
        # The slowest arm decides how long a joint motion takes.
        ranked = sorted(
            product(*per_arm.values()),
            key=lambda choice: (max(s.cost for s in choice), sum(s.cost for s in choice)),
        )
        configurations = []
        for choice in ranked:
            q = positions_rad.copy()
            for arm, solution in zip(per_arm, choice, strict=True):
                q[self.robot.joints_of(arm)] = solution.positions_rad
            configurations.append(q)
        return configurations

    def _clash(self, goals: Mapping[Arm, TcpGoal], positions_rad: Floats) -> MotionFailure:
        pair = self.together.colliding_pair(positions_rad)
        places = " and ".join(f"{arm} at {_place(goal)}" for arm, goal in goals.items())
        return MotionFailure(
            "motion.collision",
            "ik",
            f"{places}: each can be reached, but not at once: {_names(pair)} collide",
            pair,
        )

    def _starts(self, arm: Arm, goal: TcpGoal, positions_rad: Floats) -> Iterator[Floats]:
        joints = self.robot.joints_of(arm)
        yield positions_rad[joints]
        yield self._rest_rad[joints]
        yield from self._banks[arm].near(goal.position_m, _STARTS)


class _Search:
    """Collects distinct, collision-free solutions of one arm, and what the others hit."""

    def __init__(
        self, robot: RobotModel, arm: Arm, positions_rad: Floats, checker: CollisionModel
    ) -> None:
        self._arm = robot.kinematics[arm]
        self._joints = robot.joints_of(arm)
        self._limits = robot.limits.of(self._joints)
        self._present = positions_rad
        self._checker = checker
        self._seen: list[Floats] = []
        self.found: list[Solution] = []
        self.pairs: Counter[tuple[str, str]] = Counter()

    def run(self, poses: tuple[ToolPose, ...], starts: Iterator[Floats], count: int) -> None:
        for start, pose in product(starts, poses):
            q = solve_pose(self._arm, pose.T_world_tcp, start)
            if q is not None and self._is_new(q):
                self._seen.append(q)
                self._judge(q, pose.tilt_rad)
                if len(self.found) >= count:
                    return

    def _is_new(self, q: Floats) -> bool:
        return all(np.abs(q - other).max() > _DISTINCT_RAD for other in self._seen)

    def _judge(self, q: Floats, tilt_rad: float) -> None:
        whole = self._present.copy()
        whole[self._joints] = q
        if self._checker.collides(whole):
            pair = self._checker.colliding_pair(whole)
            if pair is not None:
                self.pairs[pair] += 1
        else:
            self.found.append(Solution(q, self._cost(q, tilt_rad)))

    def _cost(self, q: Floats, tilt_rad: float) -> float:
        times = np.abs(q - self._present[self._joints]) / self._limits.velocity
        room = np.minimum(q - self._limits.lower, self._limits.upper - q)
        crowding = float(np.maximum(0.0, 1.0 - room / _LIMIT_ZONE_RAD).max())
        travel = float(times.max() + 0.2 * times.sum())
        return travel + _LIMIT_COST * crowding + _TILT_COST * tilt_rad


def _place(goal: TcpGoal) -> str:
    x, y, z = goal.position_m
    return f"({x:.3f}, {y:.3f}, {z:.3f}) m"


def _names(pair: tuple[str, str] | None) -> str:
    return " and ".join(pair) if pair else "two bodies"


def _unreachable(arm: Arm, goal: TcpGoal) -> MotionFailure:
    yaw = "any yaw" if goal.yaw_rad is None else f"yaw {goal.yaw_rad:.2f} rad"
    return MotionFailure(
        "motion.unreachable",
        "ik",
        f"{arm} arm: {_place(goal)} with {yaw} and up to {goal.max_tilt_rad:.2f} rad of tilt"
        " is out of reach within the joint limits",
    )


def _collision(arm: Arm, goal: TcpGoal, pairs: "Counter[tuple[str, str]]") -> MotionFailure:
    pair, hits = pairs.most_common(1)[0]
    return MotionFailure(
        "motion.collision",
        "ik",
        f"{arm} arm: all {pairs.total()} ways to {_place(goal)} collide,"
        f" {hits} of them {_names(pair)}",
        pair,
    )
