"""What a client may ask of a cell, and what it hears."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue, StringConstraints

from executive.engine.recording.messages import RunReport

CellStateName = Literal["idle", "starting", "running", "paused", "stopping", "held"]
MissionStateName = Literal["queued", "running", "done", "lost", "withdrawn"]

MissionName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*$", max_length=100)]
SettingKey = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*(\.\w+)*$", max_length=200)]


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class MissionRequest(_Message):
    """A mission that is to be run."""

    mission: MissionName = Field(description="Name of a mission of this cell.")
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = 0
    settings: Annotated[dict[SettingKey, JsonValue], Field(max_length=100)] = Field(
        default_factory=dict, description="Inputs, and parts of the scenario, by key."
    )
    timeout_s: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = Field(
        default=None, description="Limit on the cell's clock [s]; that of the mission otherwise."
    )
    speed: Annotated[float, Field(ge=0.05, allow_inf_nan=False)] | None = Field(
        default=None, description="At most so many times as fast as real time."
    )
    key: Annotated[str, StringConstraints(max_length=100)] = Field(
        default="",
        description="Any text of the client's: a request that comes again with the same one is "
        "the same mission and not a second one.",
    )


class MissionView(_Message):
    """A mission that was asked for, and how far it is."""

    id: int
    request: MissionRequest
    state: MissionStateName
    ahead: int = Field(default=0, description="Missions that come before it.")
    report: RunReport | None = Field(default=None, description="What it came to, when it is done.")
    reason: str = Field(default="", description="Why there is no report.")
    recording: str | None = None
    resumes: int | None = Field(default=None, description="The mission that it goes on with.")


class CellState(_Message):
    """What the cell does now."""

    cell: str
    state: CellStateName
    mission: int | None = Field(default=None, description="Id of the mission that runs.")
    ticks: int = Field(default=0, description="Ticks of that mission so far.")
    time_s: float = Field(default=0.0, description="Its time on the cell's clock [s].")
    queued: int
    last: int | None = Field(default=None, description="Id of the mission that ended last.")
    why_held: str = ""


class TickView(_Message):
    """What one tick of a running mission changed."""

    mission: int
    tick: int
    time_s: float
    changes: dict[str, str] = Field(description="New status by path of the node.")
    outcomes: dict[str, str] = Field(description="Why leaves failed, by path.")
    writes: tuple[str, ...] = Field(description="Keys of the blackboard that were written.")


class Refusal(_Message):
    """Why something was not done."""

    error: str
