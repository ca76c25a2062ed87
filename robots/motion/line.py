"""Straight tool motions of one or both arms, in step, with the orientation of the tools kept.

An arm of seven joints can follow a line in many ways, since its elbow is free to swing; one of
six joints has a single way. The elbow goes as it comes, pushed away from joint limits and
singularities; where that ends at a limit or in a collision, variants with a steady swing to
either side are tried. Swings are spread over the whole line, since sudden ones would have to be
driven slowly.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import ceil

import numpy as np

from robots.interfaces import ArmName, Floats
from robots.motion.chain_kernels import Swing, restored, swing_along
from robots.motion.ik import DESCENT
from robots.motion.model import SINGULAR_ZONE, ArmKinematics, RobotModel

SAMPLE_SPACING_M = 0.008
_LEAST_SAMPLES = 4
_SWINGS_RAD = (0.03, -0.03, 0.08, -0.08)  # of the elbow's free motion, a sample
_LIMIT_ZONE_RAD = 0.35
_SWING = Swing(
    largest_step=0.4,  # between samples; more means that the arm jumps to another branch
    limit_zone=_LIMIT_ZONE_RAD,
    largest_push=0.08,
    probe=0.02,
    singular_zone=SINGULAR_ZONE,
)
_BLUR_SAMPLES = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class ArmLine:
    """How one arm follows a line.

    Attributes:
        samples_rad: Configurations from the start on, shape (k, n), equally spaced on the line.
        complete: Whether the last sample is the line's end.
    """

    samples_rad: Floats
    complete: bool


def line_steps(*displacements_m: Floats) -> int:
    """Return into how many steps lines that are followed in step are cut."""
    longest = max(float(np.linalg.norm(displacement)) for displacement in displacements_m)
    return max(_LEAST_SAMPLES, ceil(longest / SAMPLE_SPACING_M))


def follow_line(
    arm: ArmKinematics,
    start_rad: Floats,
    displacement_m: Floats,
    count: int,
    swing_rad: float = 0.0,
) -> ArmLine:
    """Follow a straight line of the tool as far as it goes.

    Args:
        arm: Kinematics of the arm.
        start_rad: Joint positions at the line's beginning, shape (n,).
        displacement_m: Vector of the tool in the world [m], shape (3,).
        count: Steps to cut the line into.
        swing_rad: Motion of the elbow that is added at each step [rad].
    """
    T_start = arm.tcp_pose(start_rad)
    rotation = np.ascontiguousarray(T_start.rotation)
    places_m = T_start.translation + np.linspace(0.0, 1.0, count + 1)[:, None] * displacement_m
    samples = swing_along(
        arm.chain, start_rad, rotation, places_m, swing_rad, arm.redundant, DESCENT, _SWING
    )
    if len(samples) < len(places_m):
        return ArmLine(samples, complete=False)
    smooth, whole = restored(arm.chain, rotation, places_m, _blurred(arm, samples), DESCENT)
    return ArmLine(smooth if whole else samples, complete=True)


def _blurred(arm: ArmKinematics, samples: Floats) -> Floats:
    """Spread sudden swings over the line: blur the joint positions, then restore the poses.

    Odd reflection at both ends keeps the first sample where it is.
    """
    width = min(_BLUR_SAMPLES, len(samples) / 4)
    reach = min(ceil(3 * width), len(samples) - 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    before = 2 * samples[0] - samples[reach:0:-1]
    after = 2 * samples[-1] - samples[-2 : -reach - 2 : -1]
    padded = np.concatenate([before, samples, after])
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=0)
    blurred: Floats = np.clip(windows @ (weights / weights.sum()), arm.lower, arm.upper)
    blurred[0] = samples[0]
    return blurred


def line_variants(
    robot: RobotModel, start_rad: Floats, displacements_m: Mapping[ArmName, Floats]
) -> Iterator[dict[ArmName, ArmLine]]:
    """Yield ways in which arms can follow their lines, the most promising first.

    Args:
        robot: The robot.
        start_rad: Present configuration of all arms, shape (n,).
        displacements_m: Vector of each moving tool in the world [m], shape (3,).
    """
    count = line_steps(*displacements_m.values())
    starts = {arm: start_rad[robot.joints_of(arm)] for arm in displacements_m}
    plain = {
        arm: follow_line(robot.kinematics[arm], starts[arm], displacement, count)
        for arm, displacement in displacements_m.items()
    }
    if all(_promise(robot.kinematics[arm], line) >= 1.0 for arm, line in plain.items()):
        yield plain
    ranked = {}
    for arm, displacement in displacements_m.items():
        kinematics = robot.kinematics[arm]
        swung = (
            follow_line(kinematics, starts[arm], displacement, count, swing)
            for swing in (_SWINGS_RAD if kinematics.redundant else ())
        )
        lines = [plain[arm], *swung]
        ranked[arm] = sorted(lines, key=partial(_promise, kinematics), reverse=True)
    choices = product(*(enumerate(lines) for lines in ranked.values()))
    for choice in sorted(choices, key=lambda choice: sum(rank for rank, _ in choice)):
        yield {arm: line for arm, (_, line) in zip(ranked, choice, strict=True)}


def _promise(arm: ArmKinematics, line: ArmLine) -> float:
    """Return 1 for a complete line with a comfortable end; below 0 for one that is cut short."""
    if not line.complete:
        return -1.0 / len(line.samples_rad)
    return round(comfort(arm, line.samples_rad[-1]), 1)


def comfort(arm: ArmKinematics, q: Floats) -> float:
    """Return 1 for a configuration away from limits and singularities, down to 0 at one."""
    room = float(np.minimum(q - arm.lower, arm.upper - q).min())
    return min(1.0, max(0.0, room) / _LIMIT_ZONE_RAD, arm.dexterity(q) / SINGULAR_ZONE)


def in_step(robot: RobotModel, start_rad: Floats, lines: Mapping[ArmName, ArmLine]) -> Floats:
    """Return configurations of all arms while some follow complete lines, shape (k, n)."""
    count = len(next(iter(lines.values())).samples_rad)
    samples: Floats = np.tile(start_rad, (count, 1))
    for arm, line in lines.items():
        samples[:, robot.joints_of(arm)] = line.samples_rad
    return samples
