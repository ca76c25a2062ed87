"""The arm of the kinematic shelf cell: `ShelfTool` that takes time and moves objects at its end.

It is told places, and finds out by touch what stands there: whatever its blade or cup meets is what
is moved. What goes wrong by chance is drawn from the cell's own random numbers.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from executive.core.errors import DeviceError, InputError
from executive.core.registry import closest
from perception.camera import CameraModel
from perception.shelf.types import Box, corners
from robots.shelf_tool import (
    Cuboid,
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
from simulation.shelf.cell_config import ToolConfig
from simulation.shelf.contents import MoveFailure, MoveResult, ShelfContents

# How long things take [s]: to a viewpoint, in and out with the blade, out and in with the cup.
LOOK_S, PUSH_S, PLACE_S, OUT_S = 1.5, 4.0, 7.0, 6.0
PUSH_SPEED_M_S = 0.1
# A push that stops shorter than asked by less has met nothing.
SHORT_M = 0.002
# What is more than so many times as high as wide may fall over.
TALL = 2.0
_FAILURES: Mapping[MoveFailure, ToolFailure] = {
    MoveFailure.NO_SUCTION: ToolFailure.NO_CUP,
    MoveFailure.OBSTRUCTED: ToolFailure.OBSTRUCTED,
    MoveFailure.NO_PLACE: ToolFailure.NO_PLACE,
    MoveFailure.NO_BLADE: ToolFailure.NO_BLADE_ROOM,
    MoveFailure.NO_ROOM: ToolFailure.BLOCKED,
}


@dataclass(frozen=True, slots=True)
class _UnderWay:
    """An action and how much of its time is left."""

    action: ToolAction
    left_s: float


class KinematicTool:
    """Acts on `ShelfContents` when the time of an action is over."""

    def __init__(
        self,
        contents: ShelfContents,
        cameras: Mapping[str, CameraModel],
        config: ToolConfig,
        rng: np.random.Generator,
    ) -> None:
        """Rest at the first viewpoint.

        Args:
            contents: What stands on the shelf.
            cameras: Cameras by viewpoint.
            config: The tool and its luck.
            rng: Chance of mishaps.
        """
        self._contents, self._cameras, self._config, self._rng = contents, cameras, config, rng
        self.viewpoint = next(iter(cameras))
        self.camera = cameras[self.viewpoint]
        self.taken: tuple[str, ...] = ()
        self.toppled = 0
        self._under_way: _UnderWay | None = None
        self._result: ToolResult | None = None
        self._held = self._over = False

    @property
    def shape(self) -> ToolShape:
        """See `ShelfTool`."""
        return ToolShape(blade_m=self._config.blade_m, suction=self._config.suction)

    @property
    def viewpoints(self) -> tuple[str, ...]:
        """See `ShelfTool`."""
        return tuple(self._cameras)

    @property
    def chance_state(self) -> Mapping[str, object]:
        """State of the chance of mishaps."""
        return self._rng.bit_generator.state

    def restore(
        self, viewpoint: str, taken: tuple[str, ...], toppled: int, chance: Mapping[str, object]
    ) -> None:
        """Go on from a state in which the tool rested."""
        self.viewpoint, self.camera = viewpoint, self._cameras[viewpoint]
        self.taken, self.toppled = taken, toppled
        self._rng.bit_generator.state = chance
        self._under_way = self._result = None

    def start(self, action: ToolAction) -> None:
        """See `ShelfTool`."""
        if self._over:
            raise DeviceError("shelf tool: no command is taken after an emergency stop")
        if self._under_way is not None:
            got, other = type(action).__name__, type(self._under_way.action).__name__
            raise DeviceError(
                f"shelf tool: got {got} while {other} is under way; expected one action at a time"
            )
        if isinstance(action, LookFrom) and action.viewpoint not in self._cameras:
            known = closest(action.viewpoint, list(self._cameras))
            raise InputError(f"shelf tool: unknown viewpoint {action.viewpoint!r}; {known}")
        self._result = None
        self._under_way = _UnderWay(action, _duration_s(action))

    def result(self) -> ToolResult | None:
        """See `ShelfTool`."""
        return self._result

    def hold(self) -> None:
        """See `ShelfTool`."""
        self._held = True

    def go_on(self) -> None:
        """See `ShelfTool`."""
        self._held = False

    def resting(self) -> bool:
        """See `ShelfTool`."""
        return self._under_way is None or self._held

    def stop(self) -> None:
        """See `ShelfTool`."""
        self._under_way, self._held = None, False

    def emergency_stop(self) -> None:
        """Stop for good."""
        self._over = True
        self.stop()

    def advance(self, step_s: float) -> None:
        """Let time pass."""
        if self._under_way is None or self._held:
            return
        left_s = self._under_way.left_s - step_s
        if left_s > 0.0:
            self._under_way = _UnderWay(self._under_way.action, left_s)
            return
        action, self._under_way = self._under_way.action, None
        self._result = self._done(action)

    def _done(self, action: ToolAction) -> ToolResult:
        match action:
            case LookFrom(viewpoint=viewpoint):
                self.viewpoint, self.camera = viewpoint, self._cameras[viewpoint]
                return ToolResult()
            case LookAlong():
                return self._look_along(action)
            case PushAlong():
                return self._push(action)
            case PutElsewhere(thing=thing, x_m=x_m, y_m=y_m):
                return self._carry(thing, lambda name: self._contents.place(name, x_m, y_m))
            case TakeOut(thing=thing):
                return self._take_out(thing)

    def _look_along(self, action: LookAlong) -> ToolResult:
        base = self.camera
        self.viewpoint = ""
        self.camera = CameraModel(
            base.width_px, base.height_px, base.focal_px, base.centre_px, action.T_shelf_camera
        )
        return ToolResult()

    def _push(self, action: PushAlong) -> ToolResult:
        name = self._touched(action.thing)
        if name is None:
            return _failed(ToolFailure.NOTHING_THERE)
        result = self._contents.push(name, action.shift_m)
        if result.failure is not None:
            return _failed(_FAILURES[result.failure])
        box = self._contents.boxes[name]
        tall = box.size_m[2] > TALL * box.size_m[0]
        if tall and self._rng.random() < self._config.toppled:
            self.toppled += self._contents.topple(name, 1 if action.shift_m > 0.0 else -1)
        met_m = result.short_m if result.short_m > SHORT_M else 0.0
        return ToolResult(moved_m=result.moved_m, met_m=met_m)

    def _take_out(self, thing: Cuboid) -> ToolResult:
        def out(name: str) -> MoveResult:
            result = self._contents.take_out(name)
            if result.failure is None:
                self.taken += (name,)
            return result

        return self._carry(thing, out)

    def _carry(self, thing: Cuboid, carry: Callable[[str], MoveResult]) -> ToolResult:
        """Take hold of what is there, and carry it unless that goes wrong."""
        name = self._touched(thing)
        if not self._config.suction:
            return _failed(ToolFailure.NO_CUP)
        if name is None or self._rng.random() < self._config.missed:
            return _failed(ToolFailure.MISSED)
        before = dict(self._contents.boxes)
        result = carry(name)
        if result.failure is not None:
            return _failed(_FAILURES[result.failure])
        if self._rng.random() < self._config.lost:
            self._contents.set_boxes(before)
            self.taken = tuple(one for one in self.taken if one != name)
            self._contents.drop(name)
            return _failed(ToolFailure.LOST)
        return ToolResult(moved_m=result.moved_m)

    def _touched(self, thing: Cuboid) -> str | None:
        """Return what stands where something is said to stand: the object with most overlap."""
        boxes = self._contents.boxes
        said = Box(thing.x_m, thing.y_m, thing.size_m, thing.bottom_m)
        lows_m, highs_m = corners(list(boxes.values()))
        low, high = np.maximum(lows_m, said.low_m), np.minimum(highs_m, said.high_m)
        common = np.maximum(high - low, 0.0).prod(axis=1)
        best = int(np.argmax(common)) if len(common) else 0
        return list(boxes)[best] if len(common) and common[best] > 0.0 else None


def _duration_s(action: ToolAction) -> float:
    match action:
        case LookFrom() | LookAlong():
            return LOOK_S
        case PushAlong(shift_m=shift_m):
            return PUSH_S + abs(shift_m) / PUSH_SPEED_M_S
        case PutElsewhere():
            return PLACE_S
        case TakeOut():
            return OUT_S


def _failed(failure: ToolFailure) -> ToolResult:
    return ToolResult(failure, _TEXTS[failure])


_TEXTS: Mapping[ToolFailure, str] = {
    ToolFailure.NOTHING_THERE: "the blade has met nothing",
    ToolFailure.NO_CUP: "the tool has no cup",
    ToolFailure.OBSTRUCTED: "something stands in front of the object, or on it",
    ToolFailure.NO_PLACE: "the place is taken",
    ToolFailure.NO_BLADE_ROOM: "something stands where the blade goes in",
    ToolFailure.BLOCKED: "the object has something beside it and does not move",
    ToolFailure.MISSED: "the cup has taken hold of nothing",
    ToolFailure.LOST: "the object fell off the cup",
}
