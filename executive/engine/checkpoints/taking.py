"""Takes checkpoints of a run while a node with `checkpoint: true` is about to start.

Everything is put down in that very moment, in the middle of the tick: which child every
composite is at, what was written in this tick before, and the state of the cell, in which no
time passes until the tick is over.
"""

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from py_trees.common import Status
from pydantic import BaseModel, JsonValue

from executive.core.errors import DeviceError
from executive.core.memento import Remembering
from executive.core.world import Cell, RestorableCell
from executive.engine.blackboard import Write
from executive.engine.checkpoints.chance import generator_words
from executive.engine.checkpoints.memories import memory_of, remembers
from executive.engine.checkpoints.messages import CHECKPOINTS_TOPIC, CheckpointMessage
from executive.engine.checkpoints.past import Moment
from executive.engine.nodes.builder import BuiltTree, NodeInfo
from executive.engine.ticks import NodeOutcome, NodeStatus


class CheckpointWriter(Protocol):
    """Where checkpoints go; `RecordingWriter` is one."""

    def encoded(self, key: str, value: object, time_s: float) -> JsonValue:
        """Return the JSON form of a value, with what is large stored beside it."""
        ...

    def write_now(self, topic: str, message: BaseModel, time_s: float, number: int) -> None:
        """Write a message that a kill in the next moment does not take back."""
        ...


class MomentSource(Protocol):
    """Who knows how far a run has come; `Runner` does."""

    @property
    def moment(self) -> Moment:
        """How far it has come, in the middle of a tick too."""
        ...


class CheckpointRecorder:
    """Writes a checkpoint whenever the tree signals one."""

    def __init__(
        self,
        tree: BuiltTree,
        cell: Cell,
        run: MomentSource,
        writer: CheckpointWriter,
        first: int = 0,
    ) -> None:
        """Listen to a tree from now on; the first checkpoint gets the number `first`."""
        self._tree, self._cell, self._run, self._writer = tree, cell, run, writer
        self._count = first
        tree.checkpoints.listen(self.take)

    def take(self, node: int) -> None:
        """Write the checkpoint of the node with that index, which is about to start.

        Raises:
            RecordingError: It cannot be written.
        """
        moment = self._run.moment
        time_s = moment.progress.time_s
        snapshot, refused = self._snapshot()
        message = CheckpointMessage(
            number=self._count,
            node=node,
            progress=moment.progress,
            statuses=tuple(NodeStatus(each.behaviour.status.value) for each in self._tree.nodes),
            memories=dict(self._memories(time_s)),
            events=moment.events,
            outcomes=tuple(self._ends(moment.outcomes, time_s)),
            writes=tuple(self._writes(time_s)),
            devices=dict(_device_memories(self._cell.devices)),
            cell=snapshot,
            refused=refused or _running_elsewhere(self._tree.nodes, node),
        )
        self._writer.write_now(CHECKPOINTS_TOPIC, message, time_s, self._count)
        self._count += 1

    def _snapshot(self) -> tuple[str | None, str]:
        """Return the state of the cell as text, and why there is none to go on from."""
        if not isinstance(self._cell, RestorableCell):
            return None, ""
        try:
            return base64.b64encode(self._cell.snapshot()).decode(), ""
        except DeviceError as error:
            return None, str(error)

    def _memories(self, time_s: float) -> Iterator[tuple[int, dict[str, JsonValue]]]:
        for info in self._tree.nodes:
            memory = memory_of(info.behaviour)
            if memory:
                encoded = self._writer.encoded
                yield (
                    info.index,
                    {name: encoded(info.path, memory[name], time_s) for name in memory},
                )

    def _ends(self, outcomes: Sequence[NodeOutcome], time_s: float) -> Iterator[NodeOutcome]:
        for end in outcomes:
            reason = end.reason
            if reason is not None:
                data = {
                    name: self._writer.encoded(reason.code, value, time_s)
                    for name, value in reason.data.items()
                }
                reason = replace(reason, data=data)
            yield replace(end, reason=reason)

    def _writes(self, time_s: float) -> Iterator[Write]:
        for write in self._tree.blackboard.pending_writes:
            encoded = self._writer.encoded(write.key, write.value, time_s)
            yield Write(write.key, encoded, write.writer)


def _running_elsewhere(nodes: Sequence[NodeInfo], node: int) -> str:
    """Return which leaves run beside a node, and would be lost; empty for none."""
    lost = [
        info.path
        for info in nodes
        if info.index != node
        and info.behaviour.status is Status.RUNNING
        and not info.behaviour.children
        and not remembers(info.behaviour)
    ]
    return f"{', '.join(lost)}: still ran, and cannot be taken up again" if lost else ""


def _device_memories(devices: Mapping[str, object]) -> Iterator[tuple[str, JsonValue]]:
    for name, device in devices.items():
        if isinstance(device, np.random.Generator):
            yield name, generator_words(device)
        elif isinstance(device, Remembering):
            yield name, device.memento()
