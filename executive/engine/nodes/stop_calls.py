"""How each kind of node is stopped, as plain calls; see `executive.engine.nodes.tick_calls`."""

from collections.abc import Sequence
from typing import Any

from py_trees.common import Status

from executive.engine.nodes.calls import Spot, StopCall
from executive.engine.ticks import NodeStatus

RUNNING, INVALID = Status.RUNNING, Status.INVALID


def stop_of_leaf(spot: Spot) -> StopCall:
    """Stop a node without children."""
    node, log, events = spot.node, spot.log, spot.log.events
    stopped = spot.index, NodeStatus.INVALID

    def stop_silent(status: Status) -> None:
        node.status = status
        if status is INVALID:
            events.append(stopped)

    if not spot.defines("terminate"):
        return stop_silent

    def stop(status: Status) -> None:
        try:
            node.terminate(status)
        except BaseException:
            log.note_raised(node, terminating=True)
            raise
        node.status = status
        if status is INVALID:
            events.append(stopped)

    return stop


def stop_of_composite(spot: Spot) -> StopCall:
    """Stop a composite: when it is told to forget, its children first."""
    node, children, itself = spot.node, spot.children, stop_of_leaf(spot)

    def stop(status: Status) -> None:
        if status is INVALID:
            node.current_child = None
            forget(children)
        itself(status)

    return stop


def stop_of_decorator(spot: Spot) -> StopCall:
    """Stop a decorator, and then its child."""
    node, log, events = spot.node, spot.log, spot.log.events
    stopped = spot.index, NodeStatus.INVALID
    ((child, stop_child),), terminates = spot.children, spot.defines("terminate")

    def stop(status: Status) -> None:
        try:
            if terminates:
                node.terminate(status)
        except BaseException:
            log.note_raised(node, terminating=True)
            raise
        try:
            if status is INVALID or child.status is RUNNING:
                stop_child(INVALID)
        finally:
            # Also when the child raised: its own `terminate` is not to be called again.
            node.status = status
            if status is INVALID:
                events.append(stopped)

    return stop


def stop_of_while_running(spot: Spot) -> StopCall:
    """Stop a decorator, and its child only when it is halted."""
    halt, itself = stop_of_decorator(spot), stop_of_leaf(spot)
    return lambda status: halt(status) if status is INVALID else itself(status)


def forget(children: Sequence[tuple[Any, StopCall]]) -> None:
    """Tell nodes to forget how they ended, or that they run."""
    for child, stop in children:
        if child.status is not INVALID:
            stop(INVALID)
