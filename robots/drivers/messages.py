"""The messages between `SocketArms` and a controller; docs/drivers.md explains them.

Each is one MessagePack map with its `kind`. Rows of numbers are little-endian float64, left arm
first. Times are those of the sender's own clock unless said otherwise.
"""

from typing import Annotated, Literal

import numpy as np
import umsgpack
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from robots.drivers.samples import JOINTS
from robots.interfaces import Arm, Floats, Grip

VERSION = 1

Row = Annotated[bytes, Field(min_length=8 * JOINTS, max_length=8 * JOINTS)]
Mode = Literal["rest", "motion", "stop", "brake"]


class WireError(Exception):
    """A connection cannot be used any more: it is closed, or what came is no message."""


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Hello(_Message):
    """The first message of a driver; with a session that is known, it goes on with it."""

    kind: Literal["hello"] = "hello"
    version: int
    session: str


class Beat(_Message):
    """A driver is alive: its time, and the stamp of the newest state that it has."""

    kind: Literal["beat"] = "beat"
    time_s: float
    seen_s: float


class Numbered(_Message):
    """A command; they are numbered from 1 in the order of asking."""

    number: Annotated[int, Field(ge=1)]


class Execute(Numbered):
    """Follow a trajectory: samples of positions, velocities and accelerations, (n, 3, 14)."""

    kind: Literal["execute"] = "execute"
    period_s: Annotated[float, Field(gt=0.0)]
    samples: bytes


class GripCommand(Numbered):
    """Open or close one gripper."""

    kind: Literal["grip"] = "grip"
    arm: Arm
    grip: Grip


class Hold(Numbered):
    """Bring the motion to rest on its path."""

    kind: Literal["hold"] = "hold"


class GoOn(Numbered):
    """Take the motion up again."""

    kind: Literal["go_on"] = "go_on"


class Stop(Numbered):
    """Come to rest and give the motion up; done at once, whatever is missing before it."""

    kind: Literal["stop"] = "stop"


class EmergencyStop(Numbered):
    """Brake and take no more commands; done at once, whatever is missing before it."""

    kind: Literal["emergency_stop"] = "emergency_stop"


class Advance(_Message):
    """Let the time of a controller in lock-step go on to a moment of its clock."""

    kind: Literal["advance"] = "advance"
    until_s: float


class Welcome(_Message):
    """A controller takes a driver.

    `resumed` says whether it still knows the session, `now_s` is its time. It stops the arms
    when it hears nothing for `silence_s`, and takes trajectories that begin within
    `tolerance_rad`.
    """

    kind: Literal["welcome"] = "welcome"
    version: int
    resumed: bool
    now_s: float
    cycle_s: float
    silence_s: float
    tolerance_rad: float
    lockstep: bool


class Sorry(_Message):
    """A controller does not take a driver, and why."""

    kind: Literal["sorry"] = "sorry"
    text: str


class ControllerState(_Message):
    """Everything that a driver has to know; each one replaces all before.

    `taken` is the number of the last command that was taken or refused, `refused` that of the
    last one that was refused, with `refusal` to say why. `echo_s` is the `time_s` of the newest
    beat. Left arm first in all pairs.
    """

    kind: Literal["state"] = "state"
    stamp_s: float
    mode: Mode
    held: bool
    positions_rad: Row
    velocities_rad_s: Row
    accelerations_rad_s2: Row
    openings_m: tuple[float, float]
    gripping: tuple[bool, bool]
    holding: tuple[bool, bool]
    taken: int
    refused: int
    refusal: str
    echo_s: float | None
    fault: str


class Advanced(_Message):
    """A controller in lock-step has come to a moment, and sent all that was due by then."""

    kind: Literal["advanced"] = "advanced"
    now_s: float


Command = Execute | GripCommand | Hold | GoOn | Stop | EmergencyStop
ToController = Hello | Beat | Advance | Command
ToDriver = Welcome | Sorry | ControllerState | Advanced
Message = ToController | ToDriver
_ANY: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def to_bytes(message: Message) -> bytes:
    """Return a message as it goes over the wire."""
    data: bytes = umsgpack.packb(message.model_dump())
    return data


def from_bytes(data: bytes) -> Message:
    """Read a message.

    Raises:
        WireError: It is none.
    """
    try:
        return _ANY.validate_python(umsgpack.unpackb(data))
    except ValidationError as cause:
        first = cause.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise WireError(f"got a message that is none; {where}: {first['msg']}") from cause
    except (umsgpack.UnpackException, TypeError, ValueError) as cause:
        raise WireError(f"got bytes that are no MessagePack: {cause}") from cause


def row(values: Floats) -> bytes:
    """Return one number a joint as it goes over the wire."""
    return values.astype("<f8").tobytes()


def numbers(data: Row) -> Floats:
    """Read one number a joint, shape (14,)."""
    return np.frombuffer(data, "<f8").copy()
