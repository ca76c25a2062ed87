"""Puts a tree, its blackboard and its cell back to where a checkpoint was taken."""

import base64
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Selector
from pydantic import JsonValue

from executive.core.errors import InputError, RecordingError
from executive.core.memento import Remembering
from executive.core.outcome import Outcome
from executive.core.outcome import Status as SkillStatus
from executive.core.world import Cell, RestorableCell
from executive.engine.blackboard import Write
from executive.engine.checkpoints.chance import generator_state
from executive.engine.checkpoints.choosing import CheckpointInfo
from executive.engine.checkpoints.later import LaterCell
from executive.engine.checkpoints.memories import recall
from executive.engine.checkpoints.messages import CheckpointMessage
from executive.engine.nodes.builder import BuiltTree, NodeInfo
from executive.engine.recording.decoding import decode
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeOutcome

Decode = Callable[[Any], object]


def restored_cell(info: CheckpointInfo, cell: Cell, *, as_it_stands: bool) -> Cell:
    """Put a cell and its devices back, or take the cell as it stands.

    Args:
        info: The checkpoint.
        cell: Freshly opened with the settings of then.
        as_it_stands: Whether somebody vouches for a cell that cannot be put back: that nothing
            is held and nothing moves, as it was then.

    Returns:
        The cell to go on in, whose clock shows what it showed then.

    Raises:
        InputError: It cannot be put back.
    """
    snapshot = info.message.cell
    if snapshot is not None and isinstance(cell, RestorableCell):
        cell.restore(base64.b64decode(snapshot))
    elif as_it_stands:
        cell = LaterCell(cell, info.message.progress.time_s)
    else:
        raise InputError(
            f"{info}: the cell cannot be put back into the state of then; try --as-it-stands "
            f"once all is in the cell as it was before {info.path} started: nothing is held, "
            "nothing moves"
        )
    for name, memento in info.message.devices.items():
        _restore_device(name, cell.devices.get(name), memento)
    return cell


def restore_tree(
    info: CheckpointInfo,
    recording: Recording,
    tree: BuiltTree,
    classes: Iterable[type],
    *,
    anyway: bool,
) -> tuple[str, ...]:
    """Give nodes and blackboard back what they remembered.

    Args:
        info: The checkpoint.
        recording: Where it is.
        tree: Freshly built; its nodes are those of the recording.
        classes: Classes of values on the blackboard that are not of this project.
        anyway: Whether a key whose value was not kept may lose it.

    Returns:
        Keys that have lost their values, with the reason.

    Raises:
        InputError: A value was not kept, or what a node remembered cannot be given back.
    """
    kinds = (Status, *classes)

    def decoded(value: Any) -> object:
        return decode(value, recording, kinds)

    lost = _restore_blackboard(info.message, recording, tree, decoded)
    if lost and not anyway:
        raise InputError(
            f"{info}: the recording does not hold all of the blackboard:\n"
            + "\n".join(f"  {each}" for each in lost)
            + "\ntry --anyway to go on without these values"
        )
    for index, memory in info.message.memories.items():
        _restore_node(tree.nodes[index], memory, decoded)
    _restore_statuses(info.message, tree.nodes)
    for end in info.message.outcomes:
        node: Any = tree.nodes[end.node].behaviour
        node.outcome = _outcome(end, decoded)
    return lost


def _restore_device(name: str, device: object, memento: JsonValue) -> None:
    if isinstance(device, np.random.Generator):
        device.bit_generator.state = generator_state(memento)
    elif isinstance(device, Remembering):
        device.recall(memento)
    else:
        raise InputError(
            f"device {name!r}: remembered something in the recording; got one that cannot be "
            "told; expected the device of then"
        )


def _restore_blackboard(
    message: CheckpointMessage, recording: Recording, tree: BuiltTree, decoded: Decode
) -> tuple[str, ...]:
    before = message.progress.tick - 1
    held = recording.blackboard(before) if before >= 0 else {}
    writes = [Write(key, state.value, state.writer) for key, state in held.items()]
    values, lost = _decoded(writes, decoded)
    pending, also_lost = _decoded(message.writes, decoded)
    tree.blackboard.restore(values, pending)
    return (*lost, *also_lost)


def _decoded(writes: Sequence[Write], decoded: Decode) -> tuple[list[Write], list[str]]:
    found, lost = [], []
    for write in writes:
        try:
            found.append(Write(write.key, decoded(write.value), write.writer))
        except RecordingError as error:
            lost.append(f"{write.key}: {error}")
    return found, lost


def _restore_node(info: NodeInfo, memory: Mapping[str, JsonValue], decoded: Decode) -> None:
    try:
        values = {name: decoded(value) for name, value in memory.items()}
        recall(info.behaviour, values)
    except (RecordingError, KeyError, IndexError, TypeError) as cause:
        raise InputError(
            f"{info.path}: what it remembered cannot be given back; got {cause!r}; expected what "
            f"a {info.kind} remembers"
        ) from cause


def _outcome(end: NodeOutcome, decoded: Decode) -> Outcome:
    """Return how a node had ended in the tick that was under way."""
    reason = end.reason
    if reason is not None:
        data = {name: _as_far_as_kept(value, decoded) for name, value in reason.data.items()}
        reason = replace(reason, data=data)
    return Outcome(SkillStatus(end.status), reason=reason)


def _as_far_as_kept(value: object, decoded: Decode) -> object:
    try:
        return decoded(value)
    except RecordingError:
        return value


def _restore_statuses(message: CheckpointMessage, nodes: Sequence[NodeInfo]) -> None:
    for info, status in zip(nodes, message.statuses, strict=True):
        info.behaviour.status = Status[status]
    # Whoever was started in that very tick says so only at its end.
    child = nodes[message.node]
    child.behaviour.status = Status.RUNNING
    while child.parent is not None:
        parent = nodes[child.parent]
        parent.behaviour.status = Status.RUNNING
        if isinstance(parent.behaviour, Selector) and parent.behaviour.memory:
            _move_on(parent.behaviour, child.behaviour)
        child = parent


def _move_on(selector: Selector, child: Behaviour) -> None:
    """Let a selector be at a child of which it takes note only when the child has answered."""
    if selector.current_child is not child:
        selector.current_child = child
        place = next(i for i, other in enumerate(selector.children) if other is child)
        for later in selector.children[place + 1 :]:
            for node in later.iterate():
                node.status = Status.INVALID
