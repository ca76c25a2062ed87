"""The messages of a recording as models: their JSON schemas go into the file itself.

Times are those of the cell's clock, so that two runs with one seed differ only in
`started_utc`, in durations and in `wall_s`.
"""

from dataclasses import dataclass
from functools import cache
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from executive.core.outcome import Status
from executive.core.skill import PausePolicy
from executive.engine.blackboard import Write
from executive.engine.running.rate import RateReport
from executive.engine.ticks import Halt, NodeFault, NodeOutcome, NodeStatus, SlowStep

KEYFRAME_EVERY = 256

MISSION_TOPIC = "/mission"
TICKS_TOPIC = "/ticks"
IMAGES_TOPIC = "/images"
PAUSES_TOPIC = "/pauses"
INTERVENTIONS_TOPIC = "/interventions"
ARRAYS_TOPIC = "/arrays"
RESULT_TOPIC = "/result"


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


@cache
def schema_of(kind: type[BaseModel]) -> dict[str, JsonValue]:
    """Return the JSON schema of a message, made once: that takes longer than a short run."""
    return kind.model_json_schema()


class SourceFile(_Message):
    """A document that the mission was built from."""

    file: str
    sha256: str
    text: str


class RecordedNode(_Message):
    """One node of the tree; its index is its place in the table."""

    path: str
    name: str
    kind: str
    type: str
    parent: int | None
    file: str
    line: int
    acts: bool = False


class ResumedFrom(_Message):
    """The recording that this one goes on from, and begins with a copy of."""

    file: str
    checkpoint: int
    node: str
    tick: int
    time_s: float


class MissionHeader(_Message):
    """The first message: what is run, from which files, with what.

    `faults` are those that are to be injected, as they were written.
    """

    format: Literal[1]
    mission: str
    about: str = ""
    seed: int
    tick_hz: float
    timeout_s: float | None
    inputs: dict[str, JsonValue] = Field(default_factory=dict)
    scenario: dict[str, JsonValue] = Field(default_factory=dict)
    cell: dict[str, JsonValue] = Field(default_factory=dict)
    sources: tuple[SourceFile, ...] = ()
    nodes: tuple[RecordedNode, ...]
    versions: dict[str, str] = Field(default_factory=dict)
    started_utc: str
    resumed_from: ResumedFrom | None = None
    faults: tuple[str, ...] = ()


class Keyframe(_Message):
    """Everything that is needed to know the state after a tick without reading back further.

    `written` and `ended` name the tick of the last write of each key, and of the last recorded
    outcome of each leaf.
    """

    statuses: tuple[NodeStatus, ...]
    written: dict[str, int]
    ended: dict[int, int]


class TickMessage(_Message):
    """One tick; what is left out is empty, and `visited` is that of the tick before."""

    tick: int
    time_s: float
    duration_s: float
    visited: tuple[int, ...] | None = None
    changes: tuple[tuple[int, NodeStatus], ...] = ()
    halts: tuple[Halt, ...] = ()
    outcomes: tuple[NodeOutcome, ...] = ()
    writes: tuple[Write, ...] = ()
    faults: tuple[NodeFault, ...] = ()
    slow: tuple[SlowStep, ...] = ()
    keyframe: Keyframe | None = None


class ArrayMessage(_Message):
    """A large array; `data` is its bytes, row by row, little endian, zstd, then base64."""

    dtype: str
    shape: tuple[int, ...]
    compression: Literal["zstd"] = "zstd"
    data: str


@dataclass(frozen=True, slots=True)
class PausedLeaf:
    """What a pause did to a leaf that ran, by the index of the leaf."""

    node: int
    policy: PausePolicy


class PauseMessage(_Message):
    """The mission was paused, or went on."""

    state: Literal["paused", "resumed"]
    time_s: float
    by: str
    leaves: tuple[PausedLeaf, ...] = ()


class InterventionMessage(_Message):
    """Something outside the tree answers in the place of a node, or no longer does.

    `what` says it in words, such as `force failure once`; `by` says who asked for it. `answer` is
    what it answered in this tick in the place of the node, None where that is only arranged.
    """

    tick: int
    node: int
    what: str
    by: str
    answer: Status | None = None


class ActionReport(_Message):
    """One activation of a skill that moves something; times on the cell's clock."""

    name: str
    start_s: float
    duration_s: float
    status: Literal["running", "success", "failure", "halted"]
    reason: str


class InjectedReport(_Message):
    """What came of a fault that was to be injected: at which nodes or keys, and how often."""

    fault: str
    times: int
    first_tick: int | None
    places: tuple[str, ...] = ()


class RunReport(_Message):
    """What a run came to, as `cellwright run --json` prints it."""

    mission: str
    seed: int
    outcome: Literal["success", "failure", "timeout", "aborted", "error"]
    reason: str
    claim: JsonValue
    truth: JsonValue = None
    sim_s: float
    wall_s: float
    ticks: int
    actions: tuple[ActionReport, ...]
    recording: str | None


class SlowNode(_Message):
    """How often steps of a node took longer than they may, and the longest [s]."""

    path: str
    times: int
    worst_s: float
    budget_s: float


class ResultMessage(_Message):
    """The last message of a run that came to its end.

    `slow` has the slowest node first; `raised` is what went wrong without ending the mission;
    `injected` what came of the faults that were to be injected.
    """

    report: RunReport
    rate: RateReport
    slow: tuple[SlowNode, ...] = ()
    raised: tuple[str, ...] = ()
    injected: tuple[InjectedReport, ...] = ()


COMPRESSED_IMAGE_SCHEMA: dict[str, JsonValue] = {
    "title": "foxglove.CompressedImage",
    "description": "A compressed image",
    "type": "object",
    "properties": {
        "timestamp": {
            "type": "object",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
        },
        "frame_id": {"type": "string"},
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": {"type": "string"},
    },
}
