"""Taking objects by a face, carrying them out of the shelf, and putting them down elsewhere."""

from collections.abc import Generator

import numpy as np

from robots.interfaces import Floats
from robots.shelf_arm.motions import ActionError, ShelfMotions, Step
from robots.shelf_tool import Cuboid, PutElsewhere, TakeOut, ToolFailure, ToolResult

# Lowered that much beyond where the floor should be, until it is felt [m].
_OVER_LOWER_M = 0.004
_RELEASE_S = 0.2


def put_elsewhere(motions: ShelfMotions, action: PutElsewhere) -> Generator[None, None, ToolResult]:
    """Take an object out and put it down elsewhere on the floor."""
    thing = action.thing
    yield from take(motions, thing)
    yield from bring_out(motions, thing)
    yield from put_down(motions, thing, action.x_m, action.y_m)
    moved_m = float(np.hypot(action.x_m - thing.x_m, action.y_m - thing.y_m))
    return ToolResult(None, f"put at x = {action.x_m:.3f} m, y = {action.y_m:.3f} m", moved_m)


def take_out(
    motions: ShelfMotions, action: TakeOut, counter_m: tuple[float, float]
) -> Generator[None, None, ToolResult]:
    """Take an object out and put it on the counter, at the middle (x, y) of it."""
    yield from take(motions, action.thing)
    yield from bring_out(motions, action.thing)
    yield from put_down(motions, action.thing, *counter_m)
    moved_m = float(np.hypot(counter_m[0] - action.thing.x_m, counter_m[1] - action.thing.y_m))
    return ToolResult(None, "handed over on the counter", moved_m)


def bring_back(motions: ShelfMotions) -> Step:
    """Free the tool: what is still carried goes back to where it was taken from.

    Raises:
        ActionError: That cannot be, or it fell off.
    """
    thing = motions.carried
    if thing is not None and motions.driver.holds():
        yield from bring_out(motions, thing)
        yield from put_down(motions, thing, thing.x_m, thing.y_m, thing.bottom_m)
        return
    if motions.driver.holds():  # but it still stands where it stood
        motions.driver.suck(False)
        yield from motions.wait(_RELEASE_S)
    motions.driver.suck(False)
    motions.carried = None
    yield from motions.retreat()


def take(motions: ShelfMotions, thing: Cuboid) -> Step:
    """Bring the cups to the front face, let them seal, and lift.

    Raises:
        ActionError: Something is before the face, or the cups do not hold; the tool is in the
            shelf then, and its valve shut.
    """
    settings, driver = motions.settings, motions.driver
    face_m = thing.y_m - 0.5 * thing.size_m[1]
    height_m = _face_height_m(motions, thing, thing.bottom_m)
    start = np.array([thing.x_m, -settings.before_m, height_m])
    near_m = face_m - settings.face_slack_m + settings.before_m
    up = np.array([0.0, 0.0, settings.lift_m])
    inward = np.array([0.0, near_m, 0.0])
    touch = np.array([0.0, 2.0 * settings.face_slack_m, 0.0])
    yield from motions.free_to(start, inward, touch, up)
    yield from motions.line_by(inward, settings.entry_speed_m_s, settings.entry_force_n)
    if driver.tripped():
        at_m = motions.tip_m()[1]
        raise ActionError(ToolFailure.OBSTRUCTED, f"the cups met something at y = {at_m:.3f} m")
    driver.suck(True)
    yield from _touch(motions, touch)
    motions.carried = thing
    for _ in motions.line_by(up, settings.touch_speed_m_s):
        if not driver.holds():
            driver.suck(False)
            driver.stop()
        yield
    if not driver.holds():
        motions.carried = None
        raise ActionError(ToolFailure.MISSED, "the cups let go as they took up the weight")


def bring_out(motions: ShelfMotions, thing: Cuboid) -> Step:
    """Carry what the cups hold straight out, until all of it is before the shelf.

    Raises:
        ActionError: It is caught on something, or falls off. What is caught is put down.
    """
    settings, driver = motions.settings, motions.driver
    out_m = motions.tip_m()[1] + thing.size_m[1] + settings.clear_m
    if out_m <= 0.0:
        return
    way = np.array([0.0, -out_m, 0.0])
    yield from carry(motions, way, settings.caught_force_n)
    if driver.tripped():
        yield from set_down(motions)
        at_m = motions.tip_m()[1]
        raise ActionError(ToolFailure.OBSTRUCTED, f"it was caught on the way out, y = {at_m:.3f}")


def put_down(
    motions: ShelfMotions, thing: Cuboid, x_m: float, y_m: float, bottom_m: float = 0.0
) -> Step:
    """Carry what is held before the shelf to where its middle is to be, and let go of it.

    Args:
        motions: The tool.
        thing: What is held, where it was taken from.
        x_m: Where its middle is to be.
        y_m: The same, into the shelf.
        bottom_m: Height of what it is to stand on; 0 is the floor.

    Raises:
        ActionError: Something is in the way (the object is held before the shelf then), or it
            fell off.
    """
    settings, driver = motions.settings, motions.driver
    before_m = motions.tip_m()
    height_m = _face_height_m(motions, thing, bottom_m) + settings.lift_m
    aside = np.array([x_m - before_m[0], 0.0, height_m - before_m[2]])
    yield from carry(motions, aside)
    inward = np.array([0.0, y_m - 0.5 * thing.size_m[1] - before_m[1], 0.0])
    yield from carry(motions, inward, settings.entry_force_n)
    if driver.tripped():
        met_m = motions.tip_m()[1] + thing.size_m[1]
        back = np.array([0.0, before_m[1] - motions.tip_m()[1], 0.0])
        yield from carry(motions, back)
        raise ActionError(ToolFailure.NO_PLACE, f"it met something at y = {met_m:.3f} m")
    yield from set_down(motions)
    yield from motions.retreat()


def set_down(motions: ShelfMotions) -> Step:
    """Lower what is held until the floor is felt, and let go of it; the floor may take it off."""
    settings, driver = motions.settings, motions.driver
    down = np.array([0.0, 0.0, -settings.lift_m - _OVER_LOWER_M])
    yield from motions.line_by(down, settings.lower_speed_m_s, settings.floor_force_n)
    driver.suck(False)
    motions.carried = None
    yield from motions.wait(_RELEASE_S)


def carry(
    motions: ShelfMotions,
    way: Floats,
    most_n: float | None = None,
) -> Step:
    """Carry what the cups hold along a line.

    Raises:
        ActionError: It fell off.
    """
    driver = motions.driver
    for _ in motions.line_by(way, motions.settings.carry_speed_m_s, most_n):
        if not driver.holds():
            driver.suck(False)
            driver.stop()
        yield
    if not driver.holds():
        motions.carried = None
        tip = motions.tip_m()
        raise ActionError(
            ToolFailure.LOST, f"it fell off near x = {tip[0]:.3f} m, y = {tip[1]:.3f} m"
        )


def _face_height_m(motions: ShelfMotions, thing: Cuboid, bottom_m: float) -> float:
    """Return how high the cups hold an object by its face, when it stands at some height."""
    return bottom_m + max(motions.settings.cup_height_m, 0.5 * thing.size_m[2])


def _touch(motions: ShelfMotions, touch: Floats) -> Step:
    settings, driver = motions.settings, motions.driver
    for _ in motions.line_by(touch, settings.touch_speed_m_s, settings.touch_force_n):
        if driver.holds():
            driver.stop()
        yield
    end_s = motions.now_s() + settings.seal_wait_s
    while not driver.holds():
        if motions.now_s() >= end_s:
            driver.suck(False)
            at_m = motions.tip_m()[1]
            text = f"the cups have not sealed on a face up to y = {at_m:.3f} m"
            raise ActionError(ToolFailure.MISSED, text)
        yield
