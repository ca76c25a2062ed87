"""Arms: kinematics beside another's model, inverse kinematics, collisions, plans, limits.

Times are of this thread on its core (CPU time), so that what else the machine does is left out.
The other model of the YuMi is the one of the package robosuite-models, where that is installed;
OMPL, roboplan and toppra stand beside the planner where they are.
"""

import importlib.util
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from benchmarks.harness import Row, median, percentile_95, share
from benchmarks.motion_limits import limits_kept, tracking
from benchmarks.motion_plans import plans
from benchmarks.motion_problems import planner_in
from robots.descriptions.yumi import arm_joint_names
from robots.interfaces import ARMS, Floats
from robots.motion.ik import random_bank, solve_pose
from robots.motion.model import ArmKinematics, RobotModel, yumi_model
from robots.motion.solver import BANK_SIZE
from robots.placement import YUMI_AT_TABLE, table_scene

OTHER_MODEL = "assets/robots/yumi/robot.xml"
# Joints of the other model are numbered as the maker counts them.
OTHER_NUMBERS = (1, 2, 7, 3, 4, 5, 6)
# Of a tool that pinches: its axis is that close to straight down.
PINCH_COSINE = 0.9


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Measure everything (a tenth of it when quick)."""
    part = 10 if quick else 1
    robot, rng = yumi_model(YUMI_AT_TABLE), np.random.default_rng(seed)
    return [
        *_forward(robot, rng, 1000 // part),
        *_inverse(robot, rng, 1000 // part),
        *_broad_phase(robot, rng, 3000 // part),
        *plans("7", seed, None, 100 // part, ">= 0.99"),
        *plans("14", seed, ARMS, 50 // part, ">= 0.97"),
        *limits_kept(robot.limits, rng, 1000 // part),
        *tracking(robot.limits, rng, 10 // min(part, 5)),
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
    """Solve pinch poses that are known to be reached, from the starts that the planner uses."""
    banks = {
        arm: random_bank(robot.kinematics[arm], np.random.default_rng(0), BANK_SIZE) for arm in ARMS
    }
    solved, times_ms = 0, []
    for number in range(count):
        name = ARMS[number % 2]
        arm = robot.kinematics[name]
        target = _pinching(arm, rng)
        began = time.thread_time()
        solved += _solves(arm, target, banks[name].near(target, 100))
        times_ms.append(1e3 * (time.thread_time() - began))
    return [
        share("ik_solved", solved, count, ">= 0.995"),
        median("ik_time", times_ms, "ms", "<= 0.5"),
        percentile_95("ik_time_95", times_ms, "ms", "<= 6"),
    ]


def _pinching(arm: ArmKinematics, rng: np.random.Generator) -> pin.SE3:
    """Return the pose of a tool that points down in a random configuration."""
    while True:
        T_world_tcp = arm.tcp_pose(rng.uniform(arm.lower, arm.upper))
        if T_world_tcp.rotation[2, 2] < -PINCH_COSINE:
            return T_world_tcp


def _solves(arm: ArmKinematics, target: pin.SE3, starts: Iterator[Floats]) -> bool:
    return any(solve_pose(arm, target, start) is not None for start in starts)


def _broad_phase(robot: RobotModel, rng: np.random.Generator, count: int) -> list[Row]:
    collision = planner_in(robot, table_scene(), 0).solver.together
    wrong = collision.disagreements(rng, count)
    samples = rng.uniform(robot.limits.lower, robot.limits.upper, (count, robot.size))
    times_us = []
    for batch in np.array_split(samples, 20):
        began = time.thread_time()
        for q in batch:
            collision.collides(q)
        times_us.append(1e6 * (time.thread_time() - began) / len(batch))
    return [
        median("broad_phase_time", times_us, "us", "<= 15"),
        share("broad_phase_wrong", wrong, count, "= 0"),
    ]
