"""Paths by our planner and by others, on the same problems and judged by the same checker.

OMPL asks our collision model, state by state; roboplan has its own, over the same URDF and boxes,
without our margins, which makes it a little easier. Each gets one start and one end, and up to as
many checks as ours, or as many nodes. Shortcuts are left out, so that the search alone is timed. A
path counts when no configuration on it, a hundredth of a radian apart, is in collision.
"""

import importlib.util
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.motion_problems import OPENINGS_M, Problem
from robots.descriptions.yumi import yumi
from robots.interfaces import Floats, MotionFailure
from robots.motion.collision import CollisionModel, Margins
from robots.motion.model import RobotModel
from robots.motion.path import RrtConnect, Space
from robots.motion.planner import PlannerSettings

MAX_CHECKS = 3 * PlannerSettings().path_checks
STEP_RAD = 0.05
JUDGED_RAD = 0.01
ROBOPLAN_NODES, ROBOPLAN_S = 20_000, 10.0


@dataclass(frozen=True, slots=True, eq=False)
class PathProblem:
    """A way to find from one configuration to another.

    Attributes:
        robot: The robot.
        collision: What must not be touched, with margins.
        judge: The same without margins.
        whole_rad: Configuration of all joints at the start.
        moving: Indices of the joints that move.
        end_rad: Where they are to go, shape (m,).
        problem: Where this comes from.
    """

    robot: RobotModel
    collision: CollisionModel
    judge: CollisionModel
    whole_rad: Floats
    moving: Floats
    end_rad: Floats
    problem: Problem

    @property
    def start_rad(self) -> Floats:
        """Where the joints that move are."""
        start: Floats = self.whole_rad[self.moving]
        return start

    def space(self) -> Space:
        """Return the joints that move, with the check that all but roboplan ask."""
        whole = self.whole_rad.copy()

        def collides(positions_rad: Floats) -> bool:
            whole[self.moving] = positions_rad
            return self.collision.collides(whole)

        limits = self.robot.limits.of(self.moving)
        return Space(limits.lower, limits.upper, self.robot.levers_m[self.moving], collides)

    def accepts(self, path: Sequence[Floats] | None) -> bool:
        """Return whether a path leads to the end free of collisions."""
        if path is None or not np.allclose(path[-1], self.end_rad, atol=1e-6):
            return False
        whole = self.whole_rad.copy()
        for a, b in pairwise(path):
            count = 1 + int(np.abs(b - a).max() / JUDGED_RAD)
            for share in np.linspace(0.0, 1.0, count + 1):
                whole[self.moving] = a + share * (b - a)
                if self.judge.collides(whole):
                    return False
        return True


def path_problem(problem: Problem) -> PathProblem | None:
    """Return the way that our planner would try first; None where a straight edge is free."""
    planner = problem.planner()
    found = planner.solver.configurations(problem.goals, problem.start_rad, 6)
    if isinstance(found, MotionFailure):
        return None
    robot = planner.robot
    judge = CollisionModel(robot, problem.scene, margins=Margins(0.0, 0.0, 0.0, 0.0))
    judge.set_openings(OPENINGS_M)
    moving = np.concatenate([np.r_[robot.joints_of(arm)] for arm in problem.goals])
    whole = problem.start_rad
    way = PathProblem(
        robot, planner.solver.together, judge, whole, moving, found[0][moving], problem
    )
    return None if way.space().edge_is_free(way.start_rad, way.end_rad) else way


Path = list[Floats] | None


def ours(way: PathProblem) -> Callable[[], Path]:
    """Return our RRT-Connect, ready to be timed."""
    space, rng = way.space(), np.random.default_rng(way.problem.seed)
    return lambda: RrtConnect(space, rng, MAX_CHECKS).path(way.start_rad, way.end_rad)


def ompl(way: PathProblem, name: str) -> Callable[[], Path]:
    """Return a planner of OMPL, by its name, that asks our collision model."""
    from ompl import base, geometric, util

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(way.problem.seed + 1)
    space, checks = way.space(), [0]
    size = len(way.moving)
    states = base.RealVectorStateSpace(size)
    bounds = base.RealVectorBounds(size)
    for index, (low, high) in enumerate(zip(space.lower, space.upper, strict=True)):
        bounds.setLow(index, float(low))
        bounds.setHigh(index, float(high))
    states.setBounds(bounds)
    states.setLongestValidSegmentFraction(STEP_RAD / states.getMaximumExtent())
    setup = geometric.SimpleSetup(states)

    def valid(state: Any) -> bool:
        checks[0] += 1
        return not space.collides(np.array([state[index] for index in range(size)]))

    setup.setStateValidityChecker(valid)
    ends = []
    for positions in (way.start_rad, way.end_rad):
        state = states.allocState()
        for index, value in enumerate(positions):
            state[index] = float(value)
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(geometric, name)(setup.getSpaceInformation()))
    enough = base.PlannerTerminationCondition(lambda: checks[0] >= MAX_CHECKS)

    def solve() -> Path:
        setup.solve(enough)
        if not setup.haveExactSolutionPath():
            return None
        found = setup.getSolutionPath()
        rows = [found.getState(index) for index in range(found.getStateCount())]
        return [np.array([row[index] for index in range(size)]) for row in rows]

    return solve


def roboplan(way: PathProblem) -> Callable[[], Path]:
    """Return roboplan's RRT-Connect over the same robot and boxes."""
    from roboplan import core, rrt

    scene = _roboplan_scene(way)
    names = [name for spec in way.robot.spec.arms.values() for name in spec.joints]
    moving = [names[int(index)] for index in way.moving]
    scene.addGroup("moving", moving)
    planner = rrt.RRT(
        scene,
        rrt.RRTOptions(
            group_name="moving",
            max_nodes=ROBOPLAN_NODES,
            max_planning_time=ROBOPLAN_S,
            collision_check_step_size=STEP_RAD,
            rrt_connect=True,
        ),
    )
    planner.setRngSeed(way.problem.seed)
    start, end = (core.JointConfiguration(moving, q) for q in (way.start_rad, way.end_rad))

    def solve() -> Path:
        try:
            found = planner.plan(start, end)
        except RuntimeError:
            return None
        return [np.array(row) for row in found.positions]

    return solve


def _roboplan_scene(way: PathProblem) -> Any:
    from roboplan import core

    robot, scene = way.robot, way.problem.scene
    there = core.Scene("yumi", core.loadUrdfSceneDescription(str(robot.spec.urdf), []))
    links = [link.name for link in yumi().links if link.shapes]
    checked = {frozenset(pair) for pair in way.collision.checked_bodies()}
    off = [pair for pair in combinations(links, 2) if frozenset(pair) not in checked]
    off += [("body", f"{arm}_link_2") for arm in robot.arms]
    there.setCollisions(off, False)
    stands = scene.placement
    turn = pin.rpy.rpyToMatrix(0.0, 0.0, stands.yaw_rad)
    T_body_world = pin.SE3(turn, np.array(stands.position_m)).inverse()
    for box in scene.boxes:
        placed = T_body_world * pin.XYZQUATToSE3(np.array([*box.centre_m, *box.quat_xyzw]))
        there.addBoxGeometry(
            box.name, "body", core.Box(*box.size_m), placed.homogeneous, np.ones(4)
        )
    boxes = [box.name for box in scene.boxes]
    there.setCollisions([*combinations(boxes, 2)], False)
    there.setJointPositions(robot.complete(way.whole_rad, OPENINGS_M))
    return there


def planners() -> dict[str, Callable[[PathProblem], Callable[[], Path]]]:
    """Return the planners that are installed, ours first."""
    found: dict[str, Callable[[PathProblem], Callable[[], Path]]] = {"ours": ours}
    if importlib.util.find_spec("ompl"):
        found["ompl_rrtconnect"] = lambda way: ompl(way, "RRTConnect")
        found["ompl_lbkpiece"] = lambda way: ompl(way, "LBKPIECE1")
    if importlib.util.find_spec("roboplan"):
        found["roboplan"] = roboplan
    return found


def fastest_without_jerk_s(positions_rad: Floats, velocity: Floats, acceleration: Floats) -> float:
    """Return how long toppra needs along the same path when jerk is not limited [s].

    Args:
        positions_rad: Dense samples of the path, shape (k, n).
        velocity: Limits, shape (n,).
        acceleration: Limits, shape (n,).

    Returns:
        A bound from below, or NaN where toppra finds none.
    """
    import toppra
    from toppra import algorithm, constraint

    toppra.setup_logging("ERROR")
    steps = np.linalg.norm(np.diff(positions_rad, axis=0), axis=1)
    kept = np.concatenate([[True], steps > 1e-6])
    rows = positions_rad[kept]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rows, axis=0), axis=1))])
    path = toppra.SplineInterpolator(along, rows)
    limits = [
        constraint.JointVelocityConstraint(np.column_stack([-velocity, velocity])),
        constraint.JointAccelerationConstraint(np.column_stack([-acceleration, acceleration])),
    ]
    grid = np.linspace(0.0, along[-1], 400)
    found = algorithm.TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    timed = found.compute_trajectory()
    return math.nan if timed is None else float(timed.duration)
