"""From goals of tools to configurations: several, collision-free, best first, or the reason."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, product

import numpy as np

from robots.interfaces import ArmName, Floats, Goal, MotionFailure
from robots.motion.collision import CollisionModel
from robots.motion.grasp import tool_poses
from robots.motion.ik import random_bank
from robots.motion.line import follow_line, in_step, line_steps
from robots.motion.model import RobotModel
from robots.motion.search import GoalSearch, Solution, called, place
from robots.placement import PlanningScene

BANK_SIZE = 800
# Random configurations on which fast and thorough collision checks are held to agree.
AGREEMENT_CHECKS = 100
_BANK_STARTS = 6


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

        Raises:
            DeviceError: The broad phase of collision checks cannot be trusted on this machine.
        """
        self.robot = robot
        self._openings_m: dict[str, float] = {}
        self.set_scene(scene)
        self._rest_rad = rest_rad
        rng = np.random.default_rng(seed)
        self.together.demand_agreement(np.random.default_rng(seed), AGREEMENT_CHECKS)
        self._banks = {
            arm: random_bank(robot.kinematics[arm], rng, BANK_SIZE) for arm in robot.arms
        }

    def set_scene(self, scene: PlanningScene) -> None:
        """Take note of what stands around the robot, and what it carries, in all later checks.

        Raises:
            InputError: See `CollisionModel`.
        """
        robot = self.robot
        self.together = CollisionModel(robot, scene)
        alone = (self.together,) if len(robot.arms) == 1 else ()
        models = alone or (CollisionModel(robot, scene, arms=(arm,)) for arm in robot.arms)
        self.alone = dict(zip(robot.arms, models, strict=True))
        self.clear = self._keeping_clear(scene)
        self.set_openings(self._openings_m)

    def _keeping_clear(self, scene: PlanningScene) -> dict[str | None, CollisionModel]:
        """Return what `together` and `alone` are where rooms of loose things are taken for full."""
        if not scene.kept_clear:
            return {}
        full = replace(scene, boxes=(*scene.boxes, *scene.kept_clear))
        models: dict[str | None, CollisionModel] = {None: CollisionModel(self.robot, full)}
        for arm in self.robot.arms:
            models[arm] = CollisionModel(self.robot, full, arms=(arm,))
        return models

    def set_openings(self, openings_m: Mapping[ArmName, float]) -> None:
        """Take note of how far the grippers are open [m] in all later checks."""
        self._openings_m = dict(openings_m.items())
        for model in (self.together, *self.alone.values(), *self.clear.values()):
            model.set_openings(openings_m)

    def reaches(self, arm: str, goal: Goal, present_rad: Floats) -> bool:
        """Return whether an arm, alone in the cell, has a solution."""
        search = GoalSearch(self.robot, arm, goal, present_rad, self.alone[arm])
        starts = self._starts(arm, goal, present_rad)
        while not search.found() and search.widen(starts, 1):
            pass
        return bool(search.found())

    def configurations(
        self, goals: Mapping[ArmName, Goal], present_rad: Floats, count: int
    ) -> list[Floats] | MotionFailure:
        """Return configurations of all arms that satisfy goals, best first.

        Arms without a goal stay where they are.

        Args:
            goals: By arm.
            present_rad: Present configuration; solutions near it are cheap.
            count: How many solutions to look for, of each arm and in all.
        """
        searches = {}
        for arm, goal in goals.items():
            checker = self.alone[arm] if len(goals) > 1 else self.together
            searches[arm] = GoalSearch(self.robot, arm, goal, present_rad, checker)
        starts = {arm: self._starts(arm, goal, present_rad) for arm, goal in goals.items()}
        tried: set[tuple[int, ...]] = set()
        # Poses that lean more are looked at only while straighter ones do not do.
        while sum(search.widen(starts[arm], count) for arm, search in searches.items()):
            found = {arm: search.found() for arm, search in searches.items()}
            free = list(islice(self._free(goals, found, present_rad, tried), count))
            if free:
                return free
        for search in searches.values():
            if not search.found():
                return search.failure()
        return self._clash(goals, searches, present_rad)

    def _free(
        self,
        goals: Mapping[ArmName, Goal],
        found: Mapping[ArmName, list[Solution]],
        present_rad: Floats,
        tried: set[tuple[int, ...]],
    ) -> Iterator[Floats]:
        """Yield combinations that were not tried yet and do not collide, best first."""
        for choice in _ranked(found):
            key = tuple(map(id, choice))
            if key not in tried:
                tried.add(key)
                q = self._combined(found, choice, present_rad)
                if not self.together.collides(q) and self._can_go_on(goals, q):
                    yield q

    def _combined(
        self, arms: Iterable[str], choice: Sequence[Solution], present_rad: Floats
    ) -> Floats:
        q = present_rad.copy()
        for arm, solution in zip(arms, choice, strict=True):
            q[self.robot.joints_of(arm)] = solution.positions_rad
        return q

    def _can_go_on(self, goals: Mapping[ArmName, Goal], q: Floats) -> bool:
        """Return whether two arms can make their onward motions in step; one has been checked."""
        legs = zip(*(goal.onward_m for goal in goals.values()), strict=False)
        for leg in legs if len(goals) > 1 else ():
            count = line_steps(*leg)
            lines = {}
            for arm, displacement in zip(goals, leg, strict=True):
                start = q[self.robot.joints_of(arm)]
                lines[arm] = follow_line(self.robot.kinematics[arm], start, displacement, count)
                if not lines[arm].complete:
                    return False
            samples = in_step(self.robot, q, lines)
            if any(self.together.collides(sample) for sample in samples):
                return False
            q = samples[-1]
        return True

    def _clash(
        self,
        goals: Mapping[ArmName, Goal],
        searches: Mapping[ArmName, GoalSearch],
        present_rad: Floats,
    ) -> MotionFailure:
        found = {arm: search.found() for arm, search in searches.items()}
        best = self._combined(found, next(iter(_ranked(found))), present_rad)
        pair = self.together.colliding_pair(best)
        distance_m = self.together.distance_m(pair, best) if pair else None
        names = " and ".join(pair) if pair else "the straight motions onward"
        places = " and ".join(f"{called(arm)} to {place(goal)}" for arm, goal in goals.items())
        text = f"{places}: each can be reached, but not at once: {names} collide"
        tried = sum(search.tried for search in searches.values())
        return MotionFailure(
            "motion.collision", "ik", text, pair, "collision", distance_m, tried=tried
        )

    def _starts(self, arm: str, goal: Goal, present_rad: Floats) -> list[Floats]:
        joints = self.robot.joints_of(arm)
        asked = next(tool_poses(goal, self.robot.kinematics[arm].shoulder_m))[0]
        near = self._banks[arm].near(asked.T_world_tcp, _BANK_STARTS)
        return [present_rad[joints], self._rest_rad[joints], *near]


def _ranked(found: Mapping[ArmName, list[Solution]]) -> list[tuple[Solution, ...]]:
    """Return all choices of one solution an arm; the slowest arm decides how long it takes."""
    return sorted(
        product(*found.values()),
        key=lambda choice: (max(s.cost for s in choice), sum(s.cost for s in choice)),
    )
