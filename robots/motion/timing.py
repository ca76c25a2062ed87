"""Jerk-limited timing with Ruckig: edges, and paths without stops.

Only Ruckig's local, state-to-state calculation is used; its waypoints need a cloud service.
Rest-to-rest edges are phase-synchronised, so that they stay on the straight edge that was
checked for collisions.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
import ruckig

from robots.interfaces import Floats
from robots.limits import JointLimits

# States cut out of a motion at its limits may exceed them by rounding; Ruckig refuses such.
_ROUNDING = 1.0 + 1e-6
JointState = tuple[Floats, Floats, Floats]


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A stretch of one Ruckig trajectory, from `start_s` to `end_s` of its own time."""

    profile: ruckig.Trajectory
    start_s: float
    end_s: float

    def at(self, time_s: float) -> JointState:
        """Return the state `time_s` after the start of the piece."""
        position, velocity, acceleration = self.profile.at_time(self.start_s + time_s)
        return np.array(position), np.array(velocity), np.array(acceleration)

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self.end_s - self.start_s


class PiecewiseTrajectory:
    """Ruckig pieces one after the other; exact at any rate."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        """Take at least one piece."""
        self.pieces = tuple(pieces)
        self._ends = list(accumulate(piece.duration_s for piece in self.pieces))

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self._ends[-1]

    def at(self, time_s: float) -> JointState:
        """Return position, velocity and acceleration; outside, the first or last state."""
        index = min(bisect_right(self._ends, time_s), len(self.pieces) - 1)
        begin = self._ends[index - 1] if index else 0.0
        inside = min(max(time_s, 0.0), self.duration_s) - begin
        return self.pieces[index].at(min(inside, self.pieces[index].duration_s))

    def with_shortcut(self, from_s: float, to_s: float, piece: Piece) -> "PiecewiseTrajectory":
        """Return a trajectory in which `piece` replaces what lies between two times."""
        return PiecewiseTrajectory([*self._cut(0.0, from_s), piece, *self._cut(to_s, np.inf)])

    def _cut(self, from_s: float, to_s: float) -> list[Piece]:
        kept = []
        begin = 0.0
        for piece, end in zip(self.pieces, self._ends, strict=True):
            low, high = max(from_s, begin), min(to_s, end)
            if high > low:
                shift = piece.start_s - begin
                kept.append(Piece(piece.profile, low + shift, high + shift))
            begin = end
        return kept


def connect(
    start: JointState,
    end: JointState,
    limits: JointLimits,
    synchronization: ruckig.Synchronization = ruckig.Synchronization.Time,
) -> Piece | None:
    """Return the fastest motion between two states, or None when Ruckig finds none."""
    problem = ruckig.InputParameter(len(start[0]))
    problem.current_position, problem.current_velocity, problem.current_acceleration = start
    problem.target_position, problem.target_velocity, problem.target_acceleration = end
    problem.synchronization = synchronization
    return solve(problem, limits)


def solve(problem: ruckig.InputParameter, limits: JointLimits) -> Piece | None:
    """Return the answer to a Ruckig problem under limits, or None when there is none."""
    problem.max_velocity = limits.velocity * _ROUNDING
    problem.max_acceleration = limits.acceleration * _ROUNDING
    problem.max_jerk = limits.jerk * _ROUNDING
    size = len(limits.velocity)
    profile = ruckig.Trajectory(size)
    try:
        result = ruckig.Ruckig(size).calculate(problem, profile)
    except ruckig.RuckigError:  # a state from which no motion within the limits leads on
        return None
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        return None
    return Piece(profile, 0.0, profile.duration)


def rest_to_rest(a: Floats, b: Floats, limits: JointLimits) -> Piece | None:
    """Return the fastest motion along the straight edge between two configurations."""
    still: Floats = np.zeros_like(a)
    return connect((a, still, still), (b, still, still), limits, ruckig.Synchronization.Phase)


def stop_at_waypoints(path: Sequence[Floats], limits: JointLimits) -> PiecewiseTrajectory | None:
    """Return a motion along a path that rests at each waypoint."""
    pieces = [rest_to_rest(a, b, limits) for a, b in pairwise(path)]
    whole = [piece for piece in pieces if piece is not None]
    return PiecewiseTrajectory(whole) if len(whole) == len(pieces) else None


def cut_corners(
    trajectory: PiecewiseTrajectory,
    limits: JointLimits,
    is_free: Callable[[Floats], bool],
    rng: np.random.Generator,
    tries: int,
    step_s: float = 0.01,
) -> PiecewiseTrajectory:
    """Shorten a motion by Ruckig shortcuts between states of its own.

    The method of Hauser and Ng-Thow-Hing (ICRA 2010) with jerk-limited shortcuts: draw two
    times, connect the states there by one state-to-state motion, keep it when it is shorter,
    within limits and free of collisions. It can only get faster, and never has to stop.

    Args:
        trajectory: A legal motion.
        limits: Limits of the joints.
        is_free: Answers for configurations, shape (n,).
        rng: Draws the times.
        tries: Shortcuts to try.
        step_s: Between two checks along a shortcut [s].
    """
    for _ in range(tries):
        from_s, to_s = np.sort(rng.uniform(0.0, trajectory.duration_s, 2))
        piece = connect(trajectory.at(from_s), trajectory.at(to_s), limits)
        if piece is None or piece.duration_s >= to_s - from_s - 1e-3:
            continue
        times = np.arange(step_s, piece.duration_s, step_s)
        positions = np.array([piece.at(t)[0] for t in times]).reshape(len(times), -1)
        if limits.contain(positions) and all(is_free(q) for q in positions):
            trajectory = trajectory.with_shortcut(from_s, to_s, piece)
    return trajectory
