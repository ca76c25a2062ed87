"""What a checkpoint is in a recording: channel `/checkpoints`; docs/recording.md says more."""

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from executive.engine.blackboard import Write
from executive.engine.ticks import NodeOutcome, NodeStatus

CHECKPOINTS_TOPIC = "/checkpoints"


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Progress(_Message):
    """How far a run had come, on the cell's clock.

    Attributes:
        tick: Number of the tick.
        time_s: When it began [s].
        start_s: When the run began [s].
        grid_s: A moment at which a tick is due; the others are whole periods away [s].
        paused_s: Pauses so far [s].
    """

    tick: int
    time_s: float
    start_s: float
    grid_s: float
    paused_s: float = 0.0


class CheckpointMessage(_Message):
    """Everything that a mission goes on from, beside the values that ticks before have written.

    Attributes:
        number: Counted from 0 in its recording.
        node: Index of the node that was about to start.
        progress: How far the run had come.
        statuses: Of all nodes.
        memories: What nodes remember, by index and name.
        events: What nodes had answered in this tick, in order; INVALID where one was stopped.
        outcomes: How leaves had ended in it.
        writes: What had been written to the blackboard in it.
        devices: What devices remember, by name.
        cell: Snapshot of the cell, base64; None where the cell gives none.
        refused: Why a mission cannot go on from here; empty where it can.
    """

    number: int
    node: int
    progress: Progress
    statuses: tuple[NodeStatus, ...]
    memories: dict[int, dict[str, JsonValue]] = Field(default_factory=dict)
    events: tuple[tuple[int, NodeStatus], ...] = ()
    outcomes: tuple[NodeOutcome, ...] = ()
    writes: tuple[Write, ...] = ()
    devices: dict[str, JsonValue] = Field(default_factory=dict)
    cell: str | None = None
    refused: str = ""
