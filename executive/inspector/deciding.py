"""Which children decided what a node answered, by the rules of its kind.

A leaf, and a decorator that answered without its child, decided themselves.
"""

from executive.engine.ticks import NodeStatus
from executive.inspector.index import Activation, RunIndex

SEQUENCES = ("sequence", "reactive_sequence")
SELECTORS = ("selector", "reactive_selector")
CHOOSING = ("if_then_else", "while_do_else")
REACTIVE = ("reactive_sequence", "reactive_selector")

Decision = tuple[int, int]
"""Index of a node, and the tick of the answer that counted."""


def deciders(index: RunIndex, node: int, tick: int) -> list[Decision]:
    """Return the children whose answers made a node answer what it did in a tick.

    Any change of the answer needs a change of one of theirs; where a sequence succeeded (a
    selector failed), every child had a say, some of them in earlier ticks.

    Args:
        index: The run.
        node: A node that was asked in the tick.
        tick: The tick.
    """
    kind, answer = index.nodes[node].kind, index.answer(node, tick)
    if kind in CHOOSING and answer is not NodeStatus.RUNNING:
        life = index.activation(node, tick)
        ends = _ends(index, node, life.start if life else tick, tick)
        return [(end.node, end.end) for end in ends]
    if _all_agree(kind, answer) or kind == "parallel":
        return _all_that_say(index, node, tick, answer)
    asked = [(child, tick) for child in index.children[node] if index.answers[tick, child]]
    if kind == "run_once" and not asked:
        return [(end.node, end.end) for end in _ends(index, node, 0, tick)]
    same = [(child, at) for child, at in asked if index.answer(child, at) is answer]
    return same[-1:] or asked[-1:]


def _all_agree(kind: str, answer: NodeStatus) -> bool:
    """Return whether an answer takes all children, and not one."""
    return (kind in SEQUENCES and answer is NodeStatus.SUCCESS) or (
        kind in SELECTORS and answer is NodeStatus.FAILURE
    )


def _all_that_say(index: RunIndex, node: int, tick: int, answer: NodeStatus) -> list[Decision]:
    life = index.activation(node, tick)
    since = life.start if life else tick
    ended = {end.node: end for end in _ends(index, node, since, tick)}
    running = [c for c in index.children[node] if index.answer(c, tick) is NodeStatus.RUNNING]
    if answer is NodeStatus.RUNNING:
        return [(child, tick) for child in running]
    return [(end.node, end.end) for end in ended.values() if end.status is answer]


def _ends(index: RunIndex, node: int, since: int, until: int) -> list[Activation]:
    """Return how each child ended last in a stretch of ticks, in the order of the children."""
    ends = (index.last_end(child, until) for child in index.children[node])
    return [end for end in ends if end is not None and end.end >= since]


def earlier_ends(index: RunIndex, node: int, child: int, tick: int) -> list[Activation]:
    """Return how the children before a child ended last, in the present life of their parent."""
    life = index.activation(node, tick)
    since = life.start if life else tick
    return [end for end in _ends(index, node, since, tick) if end.node < child]


def deciding_leaves(index: RunIndex, node: int, tick: int) -> list[Decision]:
    """Return the nodes without deciders of their own that a node's answer comes from."""
    found: list[Decision] = []
    to_follow: list[Decision] = [(node, tick)]
    while to_follow:
        decision = to_follow.pop(0)
        below = deciders(index, *decision)
        if not below:
            found.append(decision)
        to_follow = below + to_follow
    return list(dict.fromkeys(found))


def chain(index: RunIndex, node: int, tick: int) -> list[Decision]:
    """Return one way down from a node to a leaf that decided: always the last decider."""
    way = [(node, tick)]
    while below := deciders(index, *way[-1]):
        way.append(below[-1])
    return way
