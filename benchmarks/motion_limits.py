"""Limits of motions at 1 kHz, and how closely simulated arms follow them."""

import numpy as np
import pinocchio as pin

from benchmarks.harness import Row, median, share
from robots.interfaces import ARMS, Floats, Trajectory
from robots.limits import JointLimits
from robots.motion.model import yumi_model
from robots.motion.timing import cut_corners, stop_at_waypoints
from robots.placement import YUMI_AT_TABLE
from simulation.table_world import TableWorld

STEP_HZ = 240
SAMPLED_S = 0.001
# Ruckig is exact up to rounding; a jerk is told from differences of accelerations.
TOLERANCE = 1.0 + 1e-4


def limits_kept(limits: JointLimits, rng: np.random.Generator, count: int) -> list[Row]:
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


def tracking(limits: JointLimits, rng: np.random.Generator, count: int) -> list[Row]:
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
