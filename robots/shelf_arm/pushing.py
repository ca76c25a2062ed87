"""A push along the shelf: the blade goes in beside an object, pushes by feel, and leaves."""

from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np

from robots.descriptions.kinova import CUP_AHEAD_M, CUP_RADIUS_M
from robots.interfaces import Floats
from robots.shelf_arm.driver import Guard
from robots.shelf_arm.motions import ActionError, ShelfMotions
from robots.shelf_tool import PushAlong, ToolFailure, ToolResult, ToolShape

# Blade along that share of an object's side, so that the push goes near its middle.
_ALONGSIDE = 0.6
# A push that moves an object by less has moved nothing [m].
_LEAST_SHIFT_M = 0.002
# A wall that stands where it should is felt by then [m].
_INTO_WALL_M = 0.008
# What it takes to slide an object is learnt over that way [m].
_LEARNING_M = 0.008
# Nothing that stands in shelves is lighter [kg/m3] or smoother.
_LIGHTEST_KG_M3, _SMOOTHEST, _GRAVITY_M_S2 = 100.0, 0.2, 9.81


@dataclass(frozen=True, slots=True)
class _Lane:
    """Where the blade goes.

    Attributes:
        x_m: Of the blade on its way in.
        tip_m: How far in its tip goes (y).
        height_m: Of its middle.
        gap_m: From the blade to the object's side.
        sign: +1 pushes along x.
    """

    x_m: float
    tip_m: float
    height_m: float
    gap_m: float
    sign: float


def push(
    motions: ShelfMotions, shape: ToolShape, action: PushAlong
) -> Generator[None, None, ToolResult]:
    """Push an object; raises `ActionError` where that cannot be, the tool wherever it is then."""
    lane = _lane(motions, shape, action)
    along = yield from _go_in(motions, action, lane)
    if along is None:
        # Sides are known to some millimetres: it may have been the edge of the object itself.
        lane = _aside(motions, lane, 0.5 * shape.blade_m)
        yield from motions.retreat()
        along = yield from _go_in(motions, action, lane)
    if along is None:
        text = f"the blade met something at x = {lane.x_m:.3f} m, y = {motions.tip_m()[1]:.3f} m"
        raise ActionError(ToolFailure.NO_BLADE_ROOM, text)
    feeling = _Feeling(motions, lane, action)
    yield from feeling.push(along)
    back = np.array([-lane.sign * motions.settings.back_off_m, 0.0, 0.0])
    yield from motions.line_by(back, motions.settings.entry_speed_m_s)
    yield from motions.retreat()
    return feeling.result()


def _lane(motions: ShelfMotions, shape: ToolShape, action: PushAlong) -> _Lane:
    thing = action.thing
    sign = 1.0 if action.shift_m > 0.0 else -1.0
    width_m, depth_m, _ = thing.size_m
    side_m = thing.x_m - sign * 0.5 * width_m
    alongside_m = min(max(shape.overlap_m, _ALONGSIDE * depth_m), depth_m)
    return _Lane(
        x_m=side_m - sign * 0.5 * shape.blade_m,
        tip_m=thing.y_m - 0.5 * depth_m + alongside_m + CUP_AHEAD_M,
        height_m=thing.bottom_m + motions.settings.push_height_m,
        gap_m=0.5 * shape.blade_m - CUP_RADIUS_M,
        sign=sign,
    )


def _aside(motions: ShelfMotions, lane: _Lane, by_m: float) -> _Lane:
    """Return a lane farther from the object, as far as the walls let it."""
    low_m, high_m = CUP_RADIUS_M, motions.shelf.width_m - CUP_RADIUS_M
    x_m = float(np.clip(lane.x_m - lane.sign * by_m, low_m, high_m))
    return replace(lane, x_m=x_m, gap_m=lane.gap_m + abs(x_m - lane.x_m))


def _way_m(motions: ShelfMotions, action: PushAlong) -> float:
    """Return how far to push: as far as is asked, and not far into a wall."""
    half_m = 0.5 * action.thing.size_m[0]
    to_wall_m = action.thing.x_m - half_m
    if action.shift_m > 0.0:
        to_wall_m = motions.shelf.width_m - action.thing.x_m - half_m
    return min(abs(action.shift_m), max(to_wall_m, 0.0) + _INTO_WALL_M)


def _go_in(
    motions: ShelfMotions, action: PushAlong, lane: _Lane
) -> Generator[None, None, Floats | None]:
    """Bring the blade in beside an object; return the way to push, or None where it has no room."""
    settings = motions.settings
    before_m = -settings.before_m
    inward = np.array([0.0, lane.tip_m - before_m, 0.0])
    along = np.array([lane.sign * (lane.gap_m + _way_m(motions, action)), 0.0, 0.0])
    start = np.array([lane.x_m, before_m, lane.height_m])
    yield from motions.free_to(start, inward, along)
    yield from motions.line_by(inward, settings.entry_speed_m_s, settings.entry_force_n)
    if not motions.driver.tripped():
        return along
    front_m = action.thing.y_m - 0.5 * action.thing.size_m[1]
    deep_m = float(motions.tip_m()[1]) - CUP_AHEAD_M - front_m
    return along if deep_m >= 0.5 * (lane.tip_m - CUP_AHEAD_M - front_m) else None


class _Feeling:
    """What is felt while the blade pushes."""

    def __init__(self, motions: ShelfMotions, lane: _Lane, action: PushAlong) -> None:
        self._motions, self._lane, self._action = motions, lane, action
        self._touched_m: float | None = None
        self._slide_n = self._most_felt_n = 0.0
        self._pushed_m = 0.0
        self._met = False

    def push(self, along: Floats) -> Generator[None, None, None]:
        """Push until the way is gone or the object meets something."""
        motions = self._motions
        settings, driver = motions.settings, motions.driver
        start_m = float(motions.tip_m()[0])
        direction = np.array([self._lane.sign, 0.0, 0.0])
        way = motions.line_by(along, settings.push_speed_m_s, settings.wedge_force_n)
        for _ in way:
            self._pushed_m = abs(float(motions.tip_m()[0]) - start_m)
            against_n = -float(driver.force_n() @ direction)
            self._feel(against_n)
            if self._learnt():
                driver.guard(Guard(direction, self._limit_n()))
            yield
        self._pushed_m = abs(float(motions.tip_m()[0]) - start_m)
        self._met = driver.tripped()

    def result(self) -> ToolResult:
        """Return what came of it, as far as was felt."""
        asked_m, met = abs(self._action.shift_m), self._met
        touched_m = self._lane.gap_m if self._touched_m is None else self._touched_m
        moved_m = max(0.0, min(self._pushed_m - touched_m, asked_m))
        short_m = max(0.0, self._lane.gap_m + asked_m - self._pushed_m) if met else 0.0
        if met and moved_m < _LEAST_SHIFT_M:
            text = f"the object met something at once; it was pushed with {self._limit_n():.1f} N"
            return ToolResult(ToolFailure.BLOCKED, text, moved_m, short_m)
        if self._touched_m is None and self._expected_n() > self._motions.settings.felt_n:
            text = f"nothing was felt over {self._pushed_m:.3f} m"
            return ToolResult(ToolFailure.NOTHING_THERE, text)
        return ToolResult(None, f"pushed by {moved_m:.3f} m", moved_m, short_m)

    def _feel(self, against_n: float) -> None:
        if self._touched_m is None and against_n > self._motions.settings.felt_n:
            self._touched_m = self._pushed_m
        if self._touched_m is not None and not self._learnt():
            self._slide_n = max(self._slide_n, against_n)

    def _learnt(self) -> bool:
        return self._touched_m is not None and self._pushed_m > self._touched_m + _LEARNING_M

    def _limit_n(self) -> float:
        settings = self._motions.settings
        rise_n = max(settings.rise_n, settings.rise_share * self._slide_n)
        return min(self._slide_n + rise_n, settings.wedge_force_n)

    def _expected_n(self) -> float:
        """Return the least force that an object of that size takes to slide."""
        width_m, depth_m, height_m = self._action.thing.size_m
        mass_kg = _LIGHTEST_KG_M3 * width_m * depth_m * height_m
        return mass_kg * _SMOOTHEST * _GRAVITY_M_S2
