"""The search for joint positions of one arm that satisfy a goal, with a record of what failed."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from robots.descriptions.specs import ARM
from robots.interfaces import Cause, Floats, Goal, MotionFailure, PoseGoal
from robots.motion.collision import CollisionModel
from robots.motion.grasp import ToolPose, tool_poses
from robots.motion.ik import nearest_turns, solve_pose
from robots.motion.line import comfort, follow_line, line_steps
from robots.motion.model import ArmKinematics, RobotModel

_DISTINCT_RAD = 0.1
_TILT_COST = 0.8  # of leaning by a radian, in seconds of motion
_DISCOMFORT_COST = 2.0  # of standing at a joint limit or singularity, in seconds of motion


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Joint positions of one arm that satisfy a goal.

    Attributes:
        positions_rad: Shape (n,).
        cost: Roughly the seconds to get there, plus penalties for leaning and discomfort.
    """

    positions_rad: Floats
    cost: float


class GoalSearch:
    """Collects distinct, collision-free solutions of one arm, and what became of the others.

    Attributes:
        tried: Descents so far.
    """

    def __init__(
        self,
        robot: RobotModel,
        arm: str,
        goal: Goal,
        present_rad: Floats,
        checker: CollisionModel,
    ) -> None:
        """Take a goal of an arm, and the present configuration of all arms."""
        self._name = arm
        self._arm = robot.kinematics[arm]
        self._joints = robot.joints_of(arm)
        self._speeds = robot.limits.velocity[self._joints]
        self._goal = goal
        shoulder_m = self._arm.shoulder_m
        within = np.linalg.norm(goal.position_m - shoulder_m) <= self._arm.reach_m
        self._poses = tool_poses(goal, shoulder_m) if within else iter(())
        self._present = present_rad
        self._checker = checker
        self._seen: list[Floats] = []
        self._found: list[Solution] = []
        self._pairs: Counter[tuple[str, str]] = Counter()
        self._distances_m: dict[tuple[str, str], float] = {}
        self._cut_short = self.tried = 0
        self._first: tuple[Sequence[Floats], tuple[ToolPose, ...]] = ((), ())

    def found(self) -> list[Solution]:
        """Return the solutions so far, the cheapest first."""
        return sorted(self._found, key=lambda solution: solution.cost)

    def widen(self, starts: Sequence[Floats], count: int) -> bool:
        """Look among the next poses, those that lean a little more; False when none are left.

        Args:
            starts: Joint positions to descend from, shape (n,) each.
            count: Solutions to look for among these poses.
        """
        poses = next(self._poses, None)
        if poses is None:
            return False
        if not self.tried:
            self._first = starts, poses
        self._try(product(starts, poses), len(self._found) + count)
        return True

    def failure(self) -> MotionFailure:
        """Return why nothing was found."""
        if self._pairs and self._pairs.total() >= self._cut_short:
            return self._collision()
        if self._cut_short:
            text = "the straight motions onward do not fit"
            return self._failure("motion.unreachable", "onward", text)
        turned, tilt_rad = _orientation(self._goal), self._goal.max_tilt_rad
        asked = f"with {turned} and up to {tilt_rad:.2f} rad of tilt"
        return self._beyond_limits(asked) or self._failure(
            "motion.unreachable", "reach", f"out of reach {asked}"
        )

    def _collision(self) -> MotionFailure:
        pair, hits = self._pairs.most_common(1)[0]
        distance_m = self._distances_m[pair]
        apart = f"{1e3 * distance_m:.0f} mm apart" if distance_m > 0.0 else "in each other"
        text = (
            f"all {self._pairs.total()} ways collide, {hits} of them {' and '.join(pair)}, "
            f"{apart} at best"
        )
        failure = self._failure("motion.collision", "collision", text)
        return replace(failure, pair=pair, distance_m=distance_m)

    def _beyond_limits(self, asked: str) -> MotionFailure | None:
        """Return which limit hinders the way that goes least beyond one, if limits are all."""
        arm, ways = self._arm, []
        middle = 0.5 * (arm.lower + arm.upper)
        for start, pose in product(*self._first):
            q = solve_pose(arm, pose.T_world_tcp, start, limited=False)
            if q is not None:
                ways.append((q - middle + np.pi) % (2.0 * np.pi) - np.pi + middle)
        if not ways:
            return None
        q = min(ways, key=lambda q: float(_beyond(arm, q).max()))
        worst = int(_beyond(arm, q).argmax())
        name = str(arm.model.names[worst + 1])
        limit = arm.lower[worst] if q[worst] < arm.lower[worst] else arm.upper[worst]
        text = (
            f"out of reach {asked}: {name} would be at {q[worst]:.2f} rad; its limit is "
            f"{limit:.2f} rad"
        )
        return replace(self._failure("motion.unreachable", "joint_limit", text), joint=name)

    def _failure(self, code: str, cause: Cause, text: str) -> MotionFailure:
        where = f"{called(self._name)} to {place(self._goal)}: {text}"
        return MotionFailure(code, "ik", where, cause=cause, tried=self.tried)

    def _try(self, attempts: Iterator[tuple[Floats, ToolPose]], enough: int) -> None:
        for start, pose in attempts:
            self.tried += 1
            q = solve_pose(self._arm, pose.T_world_tcp, start)
            if q is None:
                continue
            q = nearest_turns(self._arm, q, self._present[self._joints])
            if self._is_new(q):
                self._seen.append(q)
                self._judge(q, pose.tilt_rad)
                if len(self._found) >= enough:
                    return

    def _is_new(self, q: Floats) -> bool:
        return all(np.abs(q - other).max() > _DISTINCT_RAD for other in self._seen)

    def _judge(self, q: Floats, tilt_rad: float) -> None:
        if self._is_free(q) and self._can_go_on(q):
            self._found.append(Solution(q, self._cost(q, tilt_rad)))

    def _is_free(self, q: Floats) -> bool:
        whole = self._present.copy()
        whole[self._joints] = q
        if not self._checker.collides(whole):
            return True
        pair = self._checker.colliding_pair(whole)
        if pair is not None:
            self._pairs[pair] += 1
            distance_m = self._checker.distance_m(pair, whole)
            self._distances_m[pair] = max(distance_m, self._distances_m.get(pair, -np.inf))
        return False

    def _can_go_on(self, q: Floats) -> bool:
        """Return whether the goal's onward lines are possible from a solution."""
        for displacement in self._goal.onward_m:
            line = follow_line(self._arm, q, displacement, line_steps(displacement))
            if not line.complete:
                self._cut_short += 1
                return False
            if not all(self._is_free(sample) for sample in line.samples_rad[1:]):
                return False
            q = line.samples_rad[-1]
        return True

    def _cost(self, q: Floats, tilt_rad: float) -> float:
        times = np.abs(q - self._present[self._joints]) / self._speeds
        travel = float(times.max() + 0.2 * times.sum())
        discomfort = 1.0 - comfort(self._arm, q)
        return travel + _DISCOMFORT_COST * discomfort + _TILT_COST * tilt_rad


def _beyond(arm: ArmKinematics, q: Floats) -> Floats:
    """Return how far joints are beyond their limits [rad]."""
    beyond: Floats = np.maximum(arm.lower - q, q - arm.upper)
    return beyond


def called(*arms: str) -> str:
    """Return what arms are called in a message; a single one needs no name."""
    return "arm" if arms == (ARM,) else f"{' and '.join(arms)} arm"


def _orientation(goal: Goal) -> str:
    if isinstance(goal, PoseGoal):
        return f"quaternion ({', '.join(f'{value:.2f}' for value in goal.quat_xyzw)})"
    return "any yaw" if goal.yaw_rad is None else f"yaw {goal.yaw_rad:.2f} rad"


def place(goal: Goal) -> str:
    """Return a goal's position for a message."""
    x, y, z = goal.position_m
    return f"({x:.3f}, {y:.3f}, {z:.3f}) m"
