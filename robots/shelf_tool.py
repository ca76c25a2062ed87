"""What skills ask of a robot at a shelf, in any world; numpy only, so that checks stay light.

The robot carries a camera and a bluction tool, a thin blade with a suction cup at its tip (thesis,
sections 5.2 and 7.5). It is told what to do in the shelf's frame (origin at the front left lower
corner of the inside as a camera before it sees it, x along the shelf, y into it, z up), about what
was seen there, never about objects by name. It does one thing at a time: start it, then ask tick
by tick for its result.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Viewpoints that every shelf cell has: before the shelf's middle, and to either side of it.
VIEWPOINTS = ("left", "centre", "right")


@dataclass(frozen=True, slots=True)
class Cuboid:
    """Where something stands, as far as was seen; sides along the axes of the shelf.

    Attributes:
        x_m: Centre along the shelf.
        y_m: Centre into the shelf.
        size_m: Width (x), depth (y) and height (z).
        bottom_m: Height of its lower side above the floor of the shelf.
    """

    x_m: float
    y_m: float
    size_m: tuple[float, float, float]
    bottom_m: float = 0.0


@dataclass(frozen=True, slots=True)
class LookFrom:
    """Take the camera to a viewpoint of the cell, and rest there.

    Attributes:
        viewpoint: One of `ShelfTool.viewpoints`.
    """

    viewpoint: str


@dataclass(frozen=True, slots=True, eq=False)
class LookAlong:
    """Take the camera to any pose, and rest there.

    Attributes:
        T_shelf_camera: Maps camera coordinates (x right, y down, z along the view) to the shelf's,
            shape (4, 4).
    """

    T_shelf_camera: Floats


@dataclass(frozen=True, slots=True)
class PushAlong:
    """Bring the blade in beside an object, push it along the shelf, and leave.

    The blade goes in on the far side of the push, from the front, and pushes until the object has
    gone that far or meets something. Meeting something is a result, not a failure.

    Attributes:
        thing: The object.
        shift_m: How far along x; negative pushes against it, from the other side.
    """

    thing: Cuboid
    shift_m: float


@dataclass(frozen=True, slots=True)
class PutElsewhere:
    """Take an object out with the cup, put it down elsewhere on the floor, and leave.

    Attributes:
        thing: The object.
        x_m: Where its centre goes, along the shelf.
        y_m: Where its centre goes, into the shelf.
    """

    thing: Cuboid
    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True)
class TakeOut:
    """Take an object out with the cup and bring it to where the cell hands things over.

    Attributes:
        thing: The object.
    """

    thing: Cuboid


ToolAction = LookFrom | LookAlong | PushAlong | PutElsewhere | TakeOut


class ToolFailure(StrEnum):
    """Why an action did not do what was asked; skills fail with the same codes."""

    UNREACHABLE = "motion.unreachable"  # the arm cannot go there
    COLLISION = "motion.collision"  # it would hit the shelf, or what is known to stand there
    NO_PATH = "motion.no_path"  # no way was found in time
    NO_BLADE_ROOM = "push.no_room_for_blade"  # something stands where the blade goes in
    BLOCKED = "push.blocked"  # the object met something at once and has not moved
    NOTHING_THERE = "push.nothing_there"  # the blade has met no object at all
    NO_CUP = "suction.no_cup"  # the tool has none
    OBSTRUCTED = "suction.obstructed"  # something stands in front of the object
    MISSED = "suction.missed"  # the cup has not taken hold; nothing has moved
    LOST = "suction.lost"  # the object fell off on the way; where it is must be looked for
    NO_PLACE = "suction.no_place"  # the place is taken; the object is back where it was


@dataclass(frozen=True, slots=True)
class ToolResult:
    """What came of an action, as far as an arm can feel.

    Attributes:
        failure: Why it did not succeed; None when it did.
        text: A sentence for people.
        moved_m: How far the object went.
        met_m: By how much a push that met something stopped short of what was asked; 0 when it
            went all the way.
    """

    failure: ToolFailure | None = None
    text: str = ""
    moved_m: float = 0.0
    met_m: float = 0.0


@dataclass(frozen=True, slots=True)
class ToolShape:
    """What a tool needs of room.

    Attributes:
        blade_m: Thickness of the blade that goes in beside an object.
        overlap_m: How far along an object's side the blade must reach to push it.
        gap_m: What stays between a pushed object and what stopped it.
        suction: Whether there is a cup.
        lift_kg: What it lifts, when that is close to its lips.
        lift_nm: The greatest moment about its lips that it takes, of what hangs out before them.
    """

    blade_m: float = 0.01
    overlap_m: float = 0.02
    gap_m: float = 0.002
    suction: bool = True
    lift_kg: float = float("inf")
    lift_nm: float = float("inf")


@runtime_checkable
class ShelfTool(Protocol):
    """An arm before a shelf, with camera and tool; never blocks."""

    @property
    def shape(self) -> ToolShape:
        """What the tool needs of room."""
        ...

    @property
    def viewpoints(self) -> tuple[str, ...]:
        """Names of the viewpoints that `LookFrom` takes; at least `VIEWPOINTS`."""
        ...

    def start(self, action: ToolAction) -> None:
        """Begin an action; its result comes from `result`.

        Raises:
            DeviceError: Another one is under way, or was stopped and has not come to rest.
            InputError: It names no viewpoint of the cell.
        """
        ...

    def result(self) -> ToolResult | None:
        """Return what came of the action that was started last; None while it is under way.

        After `stop` there is no result until the next `start`.
        """
        ...

    def hold(self) -> None:
        """Bring the motion to rest on its own path, to be taken up again by `go_on`."""
        ...

    def go_on(self) -> None:
        """Take up a motion that was held."""
        ...

    def resting(self) -> bool:
        """Return whether nothing moves: no action is under way, or it is held."""
        ...

    def stop(self) -> None:
        """Bring the arm to rest within its limits and give the action up; the cup keeps hold."""
        ...
