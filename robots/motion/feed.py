"""Feed hold: a motion slows down to rest on its own path, and is taken up again from there.

The path q(s) stays, only its clock s(t) changes, so what was checked for collisions stays
true. With q', q'', q''' the derivatives of the motion by its own clock,

    velocity      q' s'
    acceleration  q'' s'^2 + q' s''
    jerk          q''' s'^3 + 3 q'' s' s'' + q' s'''

Where the motion itself is at its limits, s must change slowly or later: of all ramps that are
tried, the first to rest is taken whose three rates stay within the limits.
"""

from dataclasses import dataclass

import numpy as np

from robots.interfaces import Floats, Trajectory
from robots.limits import JointLimits

_GRID_S = 1 / 480
# Where the jerk of a motion jumps inside a cell of the grid, its mean is blurred by that much.
_SLACK = 1.0 + 1e-3
_RAMPS_S = tuple(0.08 * 1.35**n for n in range(11))
_DELAY_STEP_S = 0.03
_RATES = (1.0, 0.97, 0.92, 0.85, 0.75, 0.6, 0.45, 0.3)


@dataclass(frozen=True, slots=True)
class _Ramp:
    """A way from 0 to 1 in unit time: its slope rises, stays and falls, in straight lines.

    Attributes:
        rise: For how long the slope rises.
        fall: For how long it falls.
    """

    rise: float
    fall: float

    def at(self, x: Floats) -> tuple[Floats, Floats, Floats]:
        """Return integral, value and slope at times within [0, 1], shape (n,) each."""
        peak = 1.0 / (1.0 - 0.5 * (self.rise + self.fall))
        y, flat, left = np.minimum(x, self.rise), np.maximum(x - self.rise, 0.0), 1.0 - x
        falling = left < self.fall
        slope = peak * np.where(falling, left / self.fall, y / self.rise)
        value = peak * (0.5 * y**2 / self.rise + flat)
        value = np.where(falling, 1.0 - 0.5 * peak * left**2 / self.fall, value)
        integral = peak * (y**3 / (6.0 * self.rise) + 0.5 * self.rise * flat + 0.5 * flat**2)
        at_end = self._integral(peak) - left + peak * left**3 / (6.0 * self.fall)
        return np.where(falling, at_end, integral), value, slope

    def _integral(self, peak: float) -> float:
        """Return the integral over the whole ramp."""
        flat = 1.0 - self.rise - self.fall
        rising = peak * (self.rise**2 / 6.0 + 0.5 * self.rise * flat + 0.5 * flat**2)
        return rising + self.fall - peak * self.fall**2 / 6.0


@dataclass(frozen=True, slots=True)
class _Clock:
    """A clock whose rate goes from one value to another in between.

    Attributes:
        from_s: What it shows at first [s].
        rates: Rate before and after the ramp.
        delay_s: Time before the ramp [s].
        ramp_s: Length of the ramp [s].
        ramp: Its shape.
    """

    from_s: float
    rates: tuple[float, float]
    delay_s: float
    ramp_s: float
    ramp: _Ramp = _Ramp(0.25, 0.25)

    def at(self, times_s: Floats) -> tuple[Floats, Floats, Floats]:
        """Return what it shows [s], its rate and the change of that [1/s], shape (n,) each."""
        first, change = self.rates[0], self.rates[1] - self.rates[0]
        passed = (times_s - self.delay_s) / self.ramp_s
        integral, value, slope = self.ramp.at(np.clip(passed, 0.0, 1.0))
        integral = integral + np.maximum(passed - 1.0, 0.0)
        return (
            self.from_s + first * times_s + change * self.ramp_s * integral,
            first + change * value,
            change * slope / self.ramp_s,
        )


# Near full rate, where the motion's own accelerations are large, gentle ramps are legal sooner.
_SLOWING = (_Ramp(0.2, 0.2), _Ramp(0.45, 0.25), _Ramp(0.7, 0.25))
_TAKING_UP = tuple(_Ramp(ramp.fall, ramp.rise) for ramp in _SLOWING)


class FedTrajectory:
    """A motion on another clock; itself a `Trajectory`.

    Attributes:
        motion: The motion.
        duration_s: Until the motion is done, or rests on its way [s].
    """

    def __init__(self, motion: Trajectory, clock: _Clock) -> None:
        """Take a motion and the clock that it is to follow."""
        self.motion, self._clock = motion, clock
        self.duration_s = self._duration_s()

    @property
    def rate(self) -> float:
        """How fast the motion's own clock runs after the ramp; 0 where it rests."""
        return self._clock.rates[1]

    def progress_s(self, time_s: float) -> float:
        """Return what the motion's own clock shows [s]."""
        inside = min(max(time_s, 0.0), self.duration_s)
        return float(self._clock.at(np.array([inside]))[0][0])

    def ramping(self, time_s: float) -> bool:
        """Return whether the rate is still changing, or about to."""
        return time_s < self._clock.delay_s + self._clock.ramp_s

    def at(self, time_s: float) -> tuple[Floats, Floats, Floats]:
        """Return position, velocity and acceleration; outside, the first or last state."""
        inside = min(max(time_s, 0.0), self.duration_s)
        s, rate, change = (float(row[0]) for row in self._clock.at(np.array([inside])))
        position, velocity, acceleration = self.motion.at(s)
        return position, velocity * rate, acceleration * rate**2 + velocity * change

    def _duration_s(self) -> float:
        ramped_s = self._clock.delay_s + self._clock.ramp_s
        if self.rate == 0.0:
            return ramped_s
        left_s = self.motion.duration_s - float(self._clock.at(np.array([ramped_s]))[0][0])
        return ramped_s + max(left_s, 0.0) / self.rate


def held(motion: Trajectory, at_s: float, rate: float, limits: JointLimits) -> FedTrajectory:
    """Bring a motion to rest on its path, as soon as its limits let it.

    Args:
        motion: The motion; it ends at rest.
        at_s: What its own clock shows now [s].
        rate: How fast that clock runs now, steadily.
        limits: Of the joints.

    Returns:
        The way to rest; the rest of the motion where that is over sooner.
    """
    rows = _Rows(motion, at_s, limits)
    left_s = (motion.duration_s - at_s) / rate
    for delay_s, ramp_s in _delays_and_ramps(left_s):
        for ramp in _SLOWING:
            clock = _Clock(at_s, (rate, 0.0), delay_s, ramp_s, ramp)
            if rows.allow(clock):
                return FedTrajectory(motion, clock)
    return FedTrajectory(motion, _Clock(at_s, (rate, rate), 0.0, _RAMPS_S[0]))


def resumed(motion: Trajectory, at_s: float, limits: JointLimits) -> FedTrajectory:
    """Take up a motion that rests on its path, as near to its own speed as limits let.

    Args:
        motion: The motion.
        at_s: What its own clock shows [s].
        limits: Of the joints.

    Returns:
        The rest of the motion, which is over as soon as can be.
    """
    rows = _Rows(motion, at_s, limits)
    ways = []
    for rate in _RATES:
        clocks = (
            _Clock(at_s, (0.0, rate), 0.0, ramp_s, ramp)
            for ramp_s in _RAMPS_S
            for ramp in _TAKING_UP
        )
        ways += [FedTrajectory(motion, clock) for clock in clocks if rows.allow(clock)][:1]
    slowest = FedTrajectory(motion, _Clock(at_s, (0.0, _RATES[-1]), 0.0, _RAMPS_S[-1]))
    return min(ways, key=lambda way: way.duration_s, default=slowest)


def _delays_and_ramps(left_s: float) -> list[tuple[float, float]]:
    """Return what to try, the soonest rest first; none that takes longer than the motion."""
    delays_s = np.arange(0.0, left_s, _DELAY_STEP_S)
    pairs = [(float(delay_s), ramp_s) for delay_s in delays_s for ramp_s in _RAMPS_S]
    return sorted((pair for pair in pairs if sum(pair) < left_s), key=sum)


class _Rows:
    """The rates of a motion on a grid of its own clock, to try other clocks on."""

    def __init__(self, motion: Trajectory, from_s: float, limits: JointLimits) -> None:
        self._from_s, self._limits = from_s, limits
        count = max(2, int((motion.duration_s - from_s) / _GRID_S) + 2)
        states = [motion.at(from_s + index * _GRID_S) for index in range(count)]
        self._velocities = np.array([velocity for _, velocity, _ in states])
        self._accelerations = np.array([acceleration for _, _, acceleration in states])

    def allow(self, clock: _Clock) -> bool:
        """Return whether the motion keeps its limits on a clock, until that runs steadily."""
        times_s = np.arange(0.0, clock.delay_s + clock.ramp_s + 2.0 * _GRID_S, _GRID_S)
        shown_s, rates, changes = clock.at(times_s)
        places = np.clip((shown_s - self._from_s) / _GRID_S, 0.0, len(self._velocities) - 1.001)
        velocities = _between(self._velocities, places)
        accelerations = _between(self._accelerations, places) * rates[:, None] ** 2
        accelerations += velocities * changes[:, None]
        jerks = np.diff(accelerations, axis=0) / _GRID_S
        limits = self._limits
        return (
            _within(velocities * rates[:, None], limits.velocity)
            and _within(accelerations, limits.acceleration)
            and _within(jerks, limits.jerk)
        )


def _between(rows: Floats, places: Floats) -> Floats:
    """Return rows at fractional indices, linearly interpolated."""
    below = places.astype(int)
    share = (places - below)[:, None]
    blend: Floats = rows[below] * (1.0 - share) + rows[below + 1] * share
    return blend


def _within(values: Floats, limits: Floats) -> bool:
    return bool((np.abs(values) <= limits * _SLACK).all())
