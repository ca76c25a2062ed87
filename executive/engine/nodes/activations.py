"""When a node starts anew: from its first tick until it has an answer or is halted."""

from collections.abc import Callable

from py_trees.behaviour import Behaviour
from py_trees.common import Status


def starting_with(node: Behaviour, act: Callable[[], None]) -> Behaviour:
    """Make a node do something whenever an activation of it begins, and return it.

    A node that has answered for a child that runs on (`running_is_success`) does not begin anew.
    """
    method = "begin" if hasattr(node, "begin") else "initialise"
    begin: Callable[[], None] = getattr(node, method)

    def begin_anew() -> None:
        if all(child.status is not Status.RUNNING for child in node.children):
            act()
        begin()

    setattr(node, method, begin_anew)
    return node
