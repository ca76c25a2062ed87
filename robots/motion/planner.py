"""Plans of one robot: goal, configuration, path, timing, verification; or why not.

Each request is answered from its arguments and the seed, counted by request, alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from robots.interfaces import ArmName, Floats, Goal, MotionFailure, Trajectory
from robots.motion.collision import CollisionModel
from robots.motion.failures import (
    beyond_limits,
    collision_failure,
    costed,
    cut_short,
    no_path,
    untimed,
)
from robots.motion.line import ArmLine, in_step, line_steps, line_variants
from robots.motion.line_timing import time_curve
from robots.motion.model import RobotModel
from robots.motion.own_pace import beside_each_other
from robots.motion.path import Space
from robots.motion.path_search import PathSearch
from robots.motion.solver import GoalSolver
from robots.motion.timing import cut_corners, stop_at_waypoints
from robots.motion.verify import find_fault
from robots.placement import PlanningScene


@dataclass(frozen=True, slots=True)
class PlannerSettings:
    """How much work a plan may cost, and how fast motions are.

    Attributes:
        goal_solutions: Inverse solutions that are looked for.
        path_checks: Collision checks that one RRT-Connect query may spend.
        path_goals: Solutions to which a path is searched.
        corner_tries: Shortcuts in time that are tried.
        line_timings: Ways along a line that are timed and verified.
        speed_scale: 1 is the joints' full speed.
        line_speed_m_s: Largest tool speed on lines [m/s].
    """

    goal_solutions: int = 6
    path_checks: int = 20_000
    path_goals: int = 3
    corner_tries: int = 100
    line_timings: int = 4
    speed_scale: float = 1.0
    line_speed_m_s: float = 0.25


class MotionPlanner:
    """Plans motions of all arms of a robot among static boxes.

    Attributes:
        requests: How many free motions have been planned; each has randomness of its own.
    """

    def __init__(
        self,
        robot: RobotModel,
        scene: PlanningScene,
        rest_rad: Floats,
        seed: int,
        settings: PlannerSettings | None = None,
    ) -> None:
        """Prepare collision models and inverse kinematics.

        Args:
            robot: The robot.
            scene: What stands around it.
            rest_rad: An ordinary configuration of all arms, shape (n,).
            seed: Of everything random.
            settings: Effort and speed.
        """
        self.robot = robot
        self.solver = GoalSolver(robot, scene, rest_rad, seed)
        self.settings = settings or PlannerSettings()
        self.limits = robot.limits.slowed(self.settings.speed_scale)
        self._seed, self._rest_rad = seed, rest_rad
        self.requests = 0

    def set_scene(self, scene: PlanningScene) -> None:
        """Take note of what stands around the robot, and what it carries, in all later plans.

        Raises:
            InputError: An arm that carries something is not known, or names are not unique.
        """
        self.solver.set_scene(scene)

    def observe(self, positions_rad: Floats, openings_m: Mapping[ArmName, float]) -> None:
        """Take note of where the arms stand and how far grippers are open, for what follows.

        What is too close where the arms stand may stay so, but get no closer.
        """
        self.solver.set_openings(openings_m)
        self.solver.together.excuse(positions_rad)
        if None in self.solver.clear:
            self.solver.clear[None].excuse(positions_rad)

    @costed
    def to_goals(
        self, start_rad: Floats, goals: Mapping[ArmName, Goal]
    ) -> Trajectory | MotionFailure:
        """Plan to goals of some arms, at least one; the others stay where they are."""
        found = self.solver.configurations(goals, start_rad, self.settings.goal_solutions)
        if isinstance(found, MotionFailure):
            return found
        return self._to_any(start_rad, found, tuple(goals))

    @costed
    def at_own_pace(
        self, start_rad: Floats, goals: Mapping[ArmName, Goal]
    ) -> Trajectory | MotionFailure:
        """Plan to goals of arms, each as fast as it can, together free of collisions in time.

        Where they are there sooner in step, as `to_goals` has them move, they are in step.
        """
        found = self.solver.configurations(goals, start_rad, self.settings.goal_solutions)
        if isinstance(found, MotionFailure):
            return found
        in_step = self._to_any(start_rad, found, tuple(goals))
        apart = self._apart(start_rad, found[: self.settings.path_goals], tuple(goals))
        answers = [way for way in (in_step, apart) if not isinstance(way, MotionFailure | None)]
        return min(answers, key=lambda way: way.duration_s) if answers else in_step

    def _apart(
        self, start: Floats, ends: Sequence[Floats], arms: Sequence[str]
    ) -> Trajectory | None:
        """Return a motion of two arms at their own pace to the first end that has one."""
        for end in ends if len(arms) == 2 else ():
            motions = {}
            for arm in arms:
                alone = self._to_any(start, [end], (arm,), alone=arm)
                if not isinstance(alone, MotionFailure):
                    motions[arm] = alone
            if len(motions) == len(arms):
                together = beside_each_other(self.robot, self.solver.together, motions)
                if together and not isinstance(self._checked(together), MotionFailure):
                    return together
        return None

    @costed
    def to_configuration(self, start_rad: Floats, end_rad: Floats) -> Trajectory | MotionFailure:
        """Plan to a configuration of all arms."""
        if not self.limits.contain(end_rad, slack_rad=1e-6):
            return beyond_limits(self.robot, end_rad)
        together = self.solver.together
        if together.collides(end_rad):
            return collision_failure(together, end_rad, "path", "at the configuration asked for")
        return self._to_any(start_rad, [end_rad], self.robot.arms)

    @costed
    def along_lines(
        self, start_rad: Floats, displacements_m: Mapping[ArmName, Floats]
    ) -> Trajectory | MotionFailure:
        """Plan straight tool motions of at least one arm, in step, orientation kept."""
        failures: list[MotionFailure] = []
        timed = 0
        for lines in line_variants(self.robot, start_rad, displacements_m):
            answer = self._line(start_rad, displacements_m, lines)
            if not isinstance(answer, MotionFailure):
                return answer
            failures.append(answer)
            timed += answer.stage == "verify"
            if timed >= self.settings.line_timings:
                break
        return replace(failures[0], tried=len(failures))

    def _line(
        self,
        start: Floats,
        displacements_m: Mapping[ArmName, Floats],
        lines: Mapping[ArmName, ArmLine],
    ) -> Trajectory | MotionFailure:
        steps = line_steps(*displacements_m.values())
        for arm, line in lines.items():
            if not line.complete:
                return cut_short(arm, displacements_m[arm], len(line.samples_rad) - 1, steps)
        samples = in_step(self.robot, start, lines)
        hit = next((q for q in samples if self.solver.together.collides(q)), None)
        if hit is not None:
            return collision_failure(self.solver.together, hit, "line", "on the line")
        longest_m = max(float(np.linalg.norm(d)) for d in displacements_m.values())
        rate_1_s = self.settings.line_speed_m_s / max(longest_m, 1e-9)
        trajectory = time_curve(samples, self.limits, rate_1_s)
        return untimed("line") if trajectory is None else self._checked(trajectory)

    def _to_any(
        self,
        start: Floats,
        ends: Sequence[Floats],
        arms: Sequence[str],
        *,
        alone: str | None = None,
    ) -> Trajectory | MotionFailure:
        """Plan over loose things where that can be, else between them."""
        clear = self.solver.clear.get(alone)
        if clear is not None and not clear.collides(start):
            outside = [end for end in ends if not clear.collides(end)]
            answer = self._among(start, outside, arms, clear) if outside else None
            if isinstance(answer, Trajectory):
                return answer
        plain = self.solver.together if alone is None else self.solver.alone[alone]
        return self._among(start, ends, arms, plain)

    def _among(
        self,
        start: Floats,
        ends: Sequence[Floats],
        arms: Sequence[str],
        collision: CollisionModel,
    ) -> Trajectory | MotionFailure:
        rng = np.random.default_rng([self._seed, self.requests])
        self.requests += 1
        joints = [np.r_[self.robot.joints_of(arm)] for arm in arms]
        moving = np.concatenate(joints)
        space = self._space(start, moving, collision)
        failure: MotionFailure | None = None
        search = PathSearch(
            space,
            rng,
            self.settings.path_checks,
            self.settings.path_goals,
            self._rest_rad[moving],
            np.split(np.arange(len(moving)), np.cumsum([len(own) for own in joints])[:-1]),
        )
        for path in search.paths(start[moving], [end[moving] for end in ends]):
            whole = np.tile(start, (len(path), 1))
            whole[:, moving] = path
            answer = self._timed(whole, rng, collision)
            if not isinstance(answer, MotionFailure):
                return answer
            failure = answer
        if failure is not None:
            return failure
        return no_path(arms, search.tried, self.settings.path_checks)

    def _space(self, base: Floats, moving: Floats, collision: CollisionModel) -> Space:
        whole = base.copy()

        def collides(positions_rad: Floats) -> bool:
            whole[moving] = positions_rad
            return collision.collides(whole)

        limits = self.limits.of(moving)
        return Space(limits.lower, limits.upper, self.robot.levers_m[moving], collides)

    def _timed(
        self, path: Floats, rng: np.random.Generator, collision: CollisionModel
    ) -> Trajectory | MotionFailure:
        stops = stop_at_waypoints(list(path), self.limits)
        if stops is None:
            return untimed("timing")
        tries = self.settings.corner_tries if len(path) > 2 else 0
        cut = cut_corners(stops, self.limits, lambda q: not collision.collides(q), rng, tries)
        answer = self._checked(cut, collision)
        if isinstance(answer, MotionFailure) and tries:
            return self._checked(stops, collision)
        return answer

    def _checked(
        self, trajectory: Trajectory, checker: CollisionModel | None = None
    ) -> Trajectory | MotionFailure:
        return find_fault(trajectory, self.limits, checker or self.solver.together) or trajectory
