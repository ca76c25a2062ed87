"""What is true of an untangling run, from its recording: knots left, why it failed, its motions.

Kinds of failure are those of the thesis's Table 4.2. Nothing here is known to the mission.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import RecordingError
from executive.engine.recording.messages import RunReport
from executive.engine.recording.reader import Recording
from perception.cable.topology import classify_curve, close_over, curve_crossings
from perception.cable.topology.names import OTHER, UNKNOT, UNKNOWN, knot_type
from robots.drivers.samples import JOINTS
from robots.interfaces import Floats
from robots.limits import JointLimits, yumi_limits
from robots.motion.collision import CollisionModel, Margins
from robots.motion.model import yumi_model
from robots.placement import YUMI_AT_TABLE, table_scene

# What stands between the names of knots in series.
SUM = "#"
# Cable that has fallen off, and cable that hangs on an arm: so much of it, so high.
FALLEN_M, FALLEN_SHARE, DRAPED_M = -0.05, 0.35, 0.08
# Samples are rounded, and of arms that lag behind by a step of control.
RATE_SLACK, POSITION_SLACK_RAD = 1.02, 1e-3
TOUCHING = Margins(world_m=0.0, finger_world_m=-0.001, arms_m=0.0, own_m=0.0)


class Failure(IntEnum):
    """Why a cable was not untangled, numbered as in the thesis (section 4.3)."""

    COMPLEX_KNOT = 1
    MISSED_GRASP = 2
    FELL_OFF = 3
    DRAPED = 4
    FALSE_CLAIM = 5
    MANIPULATION = 6
    TIMEOUT = 7


@dataclass(frozen=True, slots=True, eq=False)
class CableMoments:
    """The cable at some moments of a run.

    Attributes:
        times_s: When, on the robot's clock, shape (K,).
        nodes_m: Its centre line then, shape (N, 3) each.
    """

    times_s: Floats
    nodes_m: tuple[Floats, ...]


def cable_moments(recording: Recording, after_s: Sequence[float]) -> CableMoments:
    """Return the cable at the start, after each of some times, and at the end.

    Raises:
        RecordingError: It holds no scenes.
    """
    scenes = [m for m in recording.streams() if m.topic == "/scene"]
    if not scenes:
        raise RecordingError(f"{recording.path}: got no message of /scene; expected a cable")
    times_s = np.array([scene.time_s for scene in scenes])
    # A scene that would repeat the one before it is not recorded.
    wanted = np.searchsorted(times_s, [*after_s], side="right") - 1
    numbers = sorted({0, len(scenes) - 1, *(int(n) for n in wanted.clip(0))})
    lines = tuple(np.array(json.loads(scenes[n].data)["cable_nodes_m"]) for n in numbers)
    return CableMoments(times_s[numbers], lines)


def knots_left(nodes_m: Floats, at_first: int) -> int:
    """Return how many knots in series there are, at most as many as at first; 0 if proved."""
    name = knot_type(close_over(curve_crossings(nodes_m)))
    if name in (OTHER, UNKNOWN):
        return at_first
    return 0 if name == UNKNOT else min(at_first, 1 + name.count(SUM))


def undone_s(moments: CableMoments, at_first: int) -> tuple[float, ...]:
    """Return when the first, the second... knot was undone for good; those never are left out."""
    left = [knots_left(nodes_m, at_first) for nodes_m in moments.nodes_m]
    times = []
    for count in range(at_first - 1, -1, -1):
        above = [k for k, now in enumerate(left) if now > count]
        begin = above[-1] + 1 if above else 0
        if begin < len(left):
            times.append(float(moments.times_s[begin]))
    return tuple(times)


def failure_of(report: RunReport, untangled: bool, moments: CableMoments) -> Failure | None:
    """Return why a run failed; None where the cable is untangled.

    What is plain from the cable comes first; of a run that just did not come to its end, what
    its later moves failed at decides.
    """
    if untangled:
        return None
    claimed = isinstance(report.claim, dict) and bool(report.claim["untangled"])
    if claimed:
        return Failure.FALSE_CLAIM
    first, last = moments.nodes_m[0], moments.nodes_m[-1]
    if float((last[:, 2] < FALLEN_M).mean()) > FALLEN_SHARE:
        return Failure.FELL_OFF
    if float(last[:, 2].max()) > DRAPED_M:
        return Failure.DRAPED
    crossings = [classify_curve(line).reduced_crossings for line in (first, last)]
    if crossings[1] > crossings[0]:
        return Failure.COMPLEX_KNOT
    return _of_moves(report)


def _of_moves(report: RunReport) -> Failure:
    acted = [action for action in report.actions if action.name != "go_home"]
    late = [action.reason for action in acted[len(acted) // 2 :]]
    missed = sum(reason.startswith("grasp.missed") for reason in late)
    refused = sum(reason.startswith(("motion.", "grasp.unreachable")) for reason in late)
    if max(missed, refused) * 2 <= len(late):
        return Failure.TIMEOUT
    return Failure.MISSED_GRASP if missed > refused else Failure.MANIPULATION


@dataclass(frozen=True, slots=True)
class ExecutedMotion:
    """What arms did in a run.

    Attributes:
        samples: How many moments were looked at.
        broken: Moments with a joint beyond a limit of position, velocity, acceleration or jerk.
        touching: Moments at which two bodies touched.
    """

    samples: int
    broken: int
    touching: int


def executed_motion(recording: Recording) -> ExecutedMotion:
    """Look at all recorded joint states of a YuMi; rates beyond speed come from differences."""
    messages = [m for m in recording.streams() if m.topic == "/joint_states"]
    states = [json.loads(message.data) for message in messages]
    times_s = np.array([message.time_s for message in messages])
    both = np.array([state["positions"] for state in states])
    velocities = np.array([state["velocities"] for state in states])[:, :JOINTS]
    positions, openings_m = both[:, :JOINTS], both[:, JOINTS:]
    robot = yumi_model(YUMI_AT_TABLE)
    collision = CollisionModel(robot, table_scene(), margins=TOUCHING)
    touching = 0
    for position, opening in zip(positions, openings_m, strict=True):
        collision.set_openings({"left": float(opening[0]), "right": float(opening[1])})
        touching += collision.collides(position)
    broken = broken_limits(yumi_limits(), times_s, positions, velocities)
    return ExecutedMotion(len(times_s), int(broken.sum()), touching)


def broken_limits(
    limits: JointLimits, times_s: Floats, positions: Floats, velocities: Floats
) -> NDArray[np.bool_]:
    """Say of each sample whether a joint is beyond a limit, shape (K,)."""
    low, high = limits.lower - POSITION_SLACK_RAD, limits.upper + POSITION_SLACK_RAD
    beyond = np.asarray(((positions < low) | (positions > high)).any(axis=1))
    rates, at_s = velocities, times_s
    for number, limit in enumerate((limits.velocity, limits.acceleration, limits.jerk)):
        if number:
            # A mean over an interval differs from that over the next one by no more than the
            # limit times what lies between their middles, however uneven the samples are.
            rates = np.diff(rates, axis=0) / np.diff(at_s)[:, None]
            at_s = (at_s[1:] + at_s[:-1]) / 2.0
        beyond[number:] |= (np.abs(rates) > RATE_SLACK * limit).any(axis=1)
    return beyond
