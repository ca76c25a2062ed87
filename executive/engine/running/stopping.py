"""Stops what still runs in a tree: every node once, each in its own guard.

py_trees alone would leave siblings running when one `terminate` raises (trap e2), and would
not stop anything when a node raised or the loop ended (traps e1, e3, e5).
"""

from collections.abc import Callable, Iterable

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.core.errors import NodeError

ErrorOf = Callable[[Behaviour, BaseException], NodeError]


def stop_running(root: Behaviour, raised: Behaviour | None, error_of: ErrorOf) -> list[NodeError]:
    """Stop every running node, leaves first, and the node that raised.

    Nodes that have finished keep their status: it is what a reader of the recording wants.

    Args:
        root: Root of the tree.
        raised: Node whose exception ended the run: it may have begun something without
            having answered RUNNING.
        error_of: Makes an error of a node out of what its `terminate` raised.

    Returns:
        What was raised meanwhile; every other node was stopped all the same.
    """
    running = [node for node in root.iterate() if node.status is Status.RUNNING or node is raised]
    running.sort(key=lambda node: bool(node.children))
    return each_guarded(running, _terminate, error_of)


def _terminate(node: Behaviour) -> None:
    try:
        # Not `stop`: a composite would pass it on to its children, which have had theirs.
        node.terminate(Status.INVALID)
    finally:
        node.status = Status.INVALID


def each_guarded(
    nodes: Iterable[Behaviour], act: Callable[[Behaviour], None], error_of: ErrorOf
) -> list[NodeError]:
    """Do something with every node and return all that was raised (traps e4, e5).

    That goes for exits and interrupts too: what asked for them does not want arms that move.
    """
    errors = []
    for node in nodes:
        try:
            act(node)
        except BaseException as cause:  # one node's failure must not keep the others waiting
            errors.append(error_of(node, cause))
    return errors
