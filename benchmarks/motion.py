"""Arms: kinematics beside another's model, inverse kinematics, collisions, plans, limits.

Problems are pick motions among random boxes on the table, see `benchmarks.motion_problems`.
The other model of the YuMi is the one of the package robosuite-models, where that is installed.
"""

import importlib.util
import time
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np
import pinocchio as pin

from benchmarks.harness import Row, median, percentile_95, share
from benchmarks.motion_problems import Problem, pick_problems, planner_in
from robots.descriptions.yumi import arm_joint_names
from robots.interfaces import ARMS, Floats, MotionFailure, Trajectory
from robots.limits import JointLimits
from robots.motion.ik import random_bank, solve_pose
from robots.motion.model import ArmKinematics, RobotModel, yumi_model
from robots.motion.planner import PlannerSettings
from robots.motion.solver import BANK_SIZE
from robots.motion.timing import cut_corners, stop_at_waypoints
from robots.placement import YUMI_AT_TABLE, table_scene
from simulation.table_world import TableWorld

OTHER_MODEL = "assets/robots/yumi/robot.xml"
# Joints of the other model are numbered as the maker counts them.
OTHER_NUMBERS = (1, 2, 7, 3, 4, 5, 6)
STEP_HZ = 240
SAMPLED_S = 0.001
# Ruckig is exact up to rounding; a jerk is told from differences of accelerations.
TOLERANCE = 1.0 + 1e-4


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Measure everything (a tenth of it when quick)."""
    part = 10 if quick else 1
    robot, rng = yumi_model(YUMI_AT_TABLE), np.random.default_rng(seed)
    return [
        *_forward(robot, rng, 1000 // part),
        *_inverse(robot, rng, 1000 // part),
        *_broad_phase(robot, rng, 3000 // part),
        *_plans("plan_7", islice(pick_problems(seed, None), 100 // part), ">= 0.99"),
        *_plans("plan_14", islice(pick_problems(seed, ARMS), 50 // part), ">= 0.97"),
        *_limits(robot.limits, rng, 1000 // part),
        *_tracking(robot.limits, rng, 10 // min(part, 5)),
    ]


def _forward(robot: RobotModel, rng: np.random.Generator, count: int) -> list[Row]:
    """Compare where both models have the links of both arms."""
    package = importlib.util.find_spec("robosuite_models")
    if package is None or package.origin is None:
        return []
    other = pin.buildModelFromMJCF(str(Path(package.origin).parent / OTHER_MODEL))
    own = robot.model
    errors_mm = [1e3 * _apart(own, other, rng) for _ in range(count)]
    return [median("fk_error", errors_mm, "mm", "<= 0.01"), _worst("fk_error_worst", errors_mm)]


def _worst(name: str, errors_mm: Sequence[float]) -> Row:
    worst = max(errors_mm)
    return Row(name, worst, "mm", len(errors_mm), worst, worst, "<= 0.01")


def _apart(own: pin.Model, other: pin.Model, rng: np.random.Generator) -> float:
    """Return by how much links are apart in two models at one random configuration [m]."""
    q, other_q = pin.neutral(own), pin.neutral(other)
    pairs = []
    for arm in ARMS:
        for number, name in zip(OTHER_NUMBERS, arm_joint_names(arm), strict=True):
            joint = own.joints[own.getJointId(name)]
            limits = own.lowerPositionLimit[joint.idx_q], own.upperPositionLimit[joint.idx_q]
            value = rng.uniform(*limits)
            q[joint.idx_q] = value
            its = other.getJointId(f"yumi_joint_{number}_{arm[0]}")
            other_q[other.joints[its].idx_q] = value
            pairs.append((own.getJointId(name), its))
    mine, theirs = own.createData(), other.createData()
    pin.forwardKinematics(own, mine, q)
    pin.forwardKinematics(other, theirs, other_q)
    places = [(mine.oMi[a], theirs.oMi[b]) for a, b in pairs]
    # Both count from the first joint: the bodies stand in different places.
    root, their_root = places[0]
    return max(
        float(np.linalg.norm(root.actInv(a).translation - their_root.actInv(b).translation))
        for a, b in places
    )


def _inverse(robot: RobotModel, rng: np.random.Generator, count: int) -> list[Row]:
    """Solve poses that are known to be reached, from the starts that the planner uses."""
    solved, times_ms = 0, []
    for number in range(count):
        arm = robot.kinematics[ARMS[number % 2]]
        bank = random_bank(arm, np.random.default_rng(0), BANK_SIZE)
        target = arm.tcp_pose(random_bank(arm, rng, 1).positions_rad[0])
        began = time.perf_counter()
        solved += _solves(arm, target, bank.near(target, 100))
        times_ms.append(1e3 * (time.perf_counter() - began))
    return [
        share("ik_solved", solved, count, ">= 0.995"),
        median("ik_time", times_ms, "ms", "<= 0.5"),
        percentile_95("ik_time_95", times_ms, "ms", "<= 6"),
    ]


def _solves(arm: ArmKinematics, target: pin.SE3, starts: Iterator[Floats]) -> bool:
    return any(solve_pose(arm, target, start) is not None for start in starts)


def _broad_phase(robot: RobotModel, rng: np.random.Generator, count: int) -> list[Row]:
    collision = planner_in(robot, table_scene(), 0).solver.together
    samples = rng.uniform(robot.limits.lower, robot.limits.upper, (count, robot.size))
    wrong = collision.disagreements(rng, count)
    began = time.perf_counter()
    for q in samples:
        collision.collides(q)
    each_us = 1e6 * (time.perf_counter() - began) / count
    return [
        Row("broad_phase_time", each_us, "us", count, each_us, each_us, "<= 15"),
        share("broad_phase_wrong", wrong, count, "= 0"),
    ]


def _plans(name: str, problems: Iterator[Problem], goal: str) -> list[Row]:
    """Plan each problem, with and without cutting corners on the same path."""
    times_ms, ratios, planned = [], [], 0
    for problem in problems:
        planner = problem.planner()
        began = time.perf_counter()
        trajectory = planner.to_goals(problem.start_rad, problem.goals)
        times_ms.append(1e3 * (time.perf_counter() - began))
        if isinstance(trajectory, MotionFailure):
            continue
        planned += 1
        stopping = problem.planner()
        stopping.settings = PlannerSettings(corner_tries=0)
        stops = stopping.to_goals(problem.start_rad, problem.goals)
        # Straight edges have no corners to cut.
        if not isinstance(stops, MotionFailure) and stops.duration_s > trajectory.duration_s:
            ratios.append(trajectory.duration_s / stops.duration_s)
    rows = [
        share(f"{name}_found", planned, len(times_ms), goal),
        median(f"{name}_time", times_ms, "ms"),
        percentile_95(f"{name}_time_95", times_ms, "ms"),
    ]
    return [*rows, median(f"{name}_duration_ratio", ratios, "1", "<= 0.72")] if ratios else rows


def _limits(limits: JointLimits, rng: np.random.Generator, count: int) -> list[Row]:
    """Look at motions along random waypoints at 1 kHz."""
    broken = 0
    for _ in range(count):
        waypoints = list(rng.uniform(limits.lower, limits.upper, (4, len(limits.lower))))
        stops = stop_at_waypoints(waypoints, limits)
        if stops is None:
            broken += 1
            continue
        broken += breaks(cut_corners(stops, limits, lambda _: True, rng, 20), limits)
    return [share("limits_broken", broken, count, "= 0")]


def breaks(trajectory: Trajectory, limits: JointLimits) -> bool:
    """Say whether a motion leaves a limit of position, velocity, acceleration or jerk."""
    times = np.arange(0.0, trajectory.duration_s, SAMPLED_S)
    states = [trajectory.at(float(t)) for t in times]
    position, velocity, acceleration = (np.array([state[k] for state in states]) for k in range(3))
    jerk = np.diff(acceleration, axis=0) / SAMPLED_S
    within = limits.contain(position, slack_rad=1e-6)
    rates: list[tuple[Floats, Floats]] = [
        (velocity, limits.velocity),
        (acceleration, limits.acceleration),
        (jerk, limits.jerk),
    ]
    return not within or any(bool((np.abs(x) > most * TOLERANCE).any()) for x, most in rates)


def _tracking(limits: JointLimits, rng: np.random.Generator, count: int) -> list[Row]:
    """Let the simulated arms follow motions, and see how far the tools lag."""
    worst_mm = []
    for _ in range(count):
        nodes_m = np.column_stack([np.linspace(-0.1, 0.1, 21), np.full(21, 0.3), np.full(21, 4e-3)])
        world = TableWorld(nodes_m, STEP_HZ)
        try:
            worst_mm.append(1e3 * _lag(world, limits, rng))
        finally:
            world.body.close()
    return [median("tracking_error", worst_mm, "mm", "<= 0.5")]


def _lag(world: TableWorld, limits: JointLimits, rng: np.random.Generator) -> float:
    """Return how far a tool is at most from where its motion has it [m]."""
    driver, robot = world.driver, yumi_model(YUMI_AT_TABLE)
    start = driver.state().positions_rad
    away = np.clip(start + rng.uniform(-0.5, 0.5, len(start)), limits.lower, limits.upper)
    motion = stop_at_waypoints([start, away, start], limits)
    if motion is None:
        raise RuntimeError("no motion between two configurations")
    driver.execute(motion)
    worst, steps = 0.0, 0
    while driver.state().moving:
        world.advance(1)
        steps += 1
        asked = motion.at(steps / STEP_HZ)[0]
        seen = driver.state().positions_rad
        gaps = [_gap(robot.tcp_pose(arm, asked), robot.tcp_pose(arm, seen)) for arm in ARMS]
        worst = max(worst, *gaps)
    return worst


def _gap(a: pin.SE3, b: pin.SE3) -> float:
    return float(np.linalg.norm(a.translation - b.translation))
