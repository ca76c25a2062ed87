"""`robots.shelf_tool.ShelfTool` by one planned arm with a bluction tool."""

from collections.abc import Callable, Generator, Mapping
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from executive.core.errors import DeviceError, InputError
from executive.core.registry import closest
from robots.interfaces import Floats
from robots.shelf_arm.carrying import bring_back, put_elsewhere, take_out
from robots.shelf_arm.driver import ShelfArmDriver
from robots.shelf_arm.motions import ActionError, ShelfMotions
from robots.shelf_arm.pushing import push
from robots.shelf_tool import (
    LookAlong,
    LookFrom,
    PushAlong,
    PutElsewhere,
    TakeOut,
    ToolAction,
    ToolFailure,
    ToolResult,
    ToolShape,
)

Routine = Generator[None, None, ToolResult]


class ArmShelfTool:
    """Does one action after the other.

    Whoever lets time pass calls `poll` often enough that guards and vacuum are watched; it is what
    makes an action go on.

    Attributes:
        shape: What the tool needs of room.
        viewpoints: Names of the viewpoints.
        at: Viewpoint at which the camera rests; empty elsewhere.
    """

    def __init__(
        self,
        motions: ShelfMotions,
        driver: ShelfArmDriver,
        shape: ToolShape,
        viewpoints: Mapping[str, Floats],
        T_tip_camera: Floats,
        counter_m: tuple[float, float],
    ) -> None:
        """Bind an arm at rest.

        Args:
            motions: Moves it.
            driver: Its controllers.
            shape: What the tool needs of room.
            viewpoints: T_shelf_camera by name, shape (4, 4).
            T_tip_camera: Where the camera is in the suction frame, shape (4, 4).
            counter_m: Where things are handed over, (x, y).
        """
        self._motions, self._driver = motions, driver
        self.shape = shape
        self._poses, self._T_tip_camera = dict(viewpoints), T_tip_camera
        self.viewpoints = tuple(viewpoints)
        self._counter_m = counter_m
        self._routine: Routine | None = None
        self._result: ToolResult | None = None
        self._held = False
        self.at = ""

    def start(self, action: ToolAction) -> None:
        """Begin an action.

        Raises:
            DeviceError: Another one is under way, or was stopped and has not come to rest.
            InputError: It names no viewpoint of the cell.
        """
        if self._routine is not None or self._driver.state().moving:
            raise DeviceError(
                "shelf tool: an action is under way; got another; expected one at a time; "
                "try: wait for its result"
            )
        self._result, self._held = None, False
        self._routine = self._routine_of(action)
        self.at = ""

    def result(self) -> ToolResult | None:
        """Return what came of the action that was started last; None while it is under way."""
        return self._result

    def poll(self) -> None:
        """Take the action on, as far as it can go now."""
        if self._routine is None or (self._held and self._resting()):
            return
        try:
            next(self._routine)
        except StopIteration as end:
            self._routine, self._result = None, end.value
        except DeviceError as error:  # controllers that refuse end the action, not the cell
            self._routine, self._result = None, ToolResult(ToolFailure.NO_PATH, str(error))

    def hold(self) -> None:
        """Bring the motion to rest on its own path, to be taken up again by `go_on`."""
        self._held = True
        self._driver.hold()

    def go_on(self) -> None:
        """Take up a motion that was held."""
        self._held = False
        self._driver.go_on()

    def resting(self) -> bool:
        """Return whether nothing moves: no action is under way, or it is held."""
        return self._resting() and (self._routine is None or self._held)

    def stop(self) -> None:
        """Bring the arm to rest within its limits and give the action up; the cup keeps hold."""
        self.give_up()
        self._driver.stop()

    def give_up(self) -> None:
        """Forget the action; what moves goes on moving."""
        if self._routine is not None:
            self._routine.close()
        self._routine, self._result, self._held = None, None, False

    def _resting(self) -> bool:
        return self._driver.held() or not self._driver.state().moving

    def _routine_of(self, action: ToolAction) -> Routine:
        match action:
            case LookFrom(viewpoint=viewpoint):
                look = partial(self._look, self._pose(viewpoint), viewpoint)
                return self._safely(look)
            case LookAlong(T_shelf_camera=T_shelf_camera):
                return self._safely(partial(self._look, T_shelf_camera, ""))
            case PushAlong():
                return self._safely(partial(push, self._motions, self.shape, action))
            case PutElsewhere():
                return self._safely(partial(put_elsewhere, self._motions, action))
            case TakeOut():
                return self._safely(partial(take_out, self._motions, action, self._counter_m))

    def _pose(self, viewpoint: str) -> Floats:
        if viewpoint not in self._poses:
            known = closest(viewpoint, [*self._poses])
            raise InputError(f"shelf tool: unknown viewpoint {viewpoint!r}; {known}")
        return self._poses[viewpoint]

    def _look(self, T_shelf_camera: Floats, name: str) -> Routine:
        T_shelf_tip = T_shelf_camera @ np.linalg.inv(self._T_tip_camera)
        quat_xyzw = Rotation.from_matrix(T_shelf_tip[:3, :3]).as_quat()
        yield from self._motions.free_to(T_shelf_tip[:3, 3], quat_xyzw=quat_xyzw)
        self.at = name
        return ToolResult(None, f"at the viewpoint {name}" if name else "there")

    def _safely(self, begin: Callable[[], Routine]) -> Routine:
        """Do an action; where it fails, free the tool and leave the shelf before that is told."""
        try:
            # A stop may have left the tool in the shelf, or something in its cups.
            yield from bring_back(self._motions)
            return (yield from begin())
        except ActionError as error:
            failure = error
        self._driver.guard(None)
        try:
            yield from bring_back(self._motions)
        except ActionError as error:
            text = f"{failure.text}; nor can the tool be freed: {error.text}"
            return ToolResult(failure.failure, text)
        return ToolResult(failure.failure, failure.text)
