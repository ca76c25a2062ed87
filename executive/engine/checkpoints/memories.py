"""What nodes remember from one tick to the next, taken down and given back by name.

A class says itself which of its attributes these are:

- `MEMORY` names what it keeps as it is: counts, lists, statuses, flags, children of its own;
- `TIMES` names moments on the mission's clock, None allowed.

py_trees' own classes are listed here. A test holds every kind of node to its list.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.composites import Composite
from py_trees.decorators import OneShot

Memory = Mapping[str, object]

_OF_PY_TREES: Mapping[str, Mapping[type[Behaviour], tuple[str, ...]]] = {
    "MEMORY": {OneShot: ("final_status",), Composite: ("current_child",)},
    "TIMES": {},
}


@dataclass(frozen=True, slots=True)
class Child:
    """Stands for a child of a node, by its place."""

    place: int


def remembers(node: Behaviour) -> bool:
    """Return whether a node says what it remembers, be it nothing, so that it can go on."""
    return any(hasattr(node, listing) for listing in _OF_PY_TREES)


def memory_of(node: Behaviour) -> dict[str, object]:
    """Return what a node remembers; most remember nothing."""
    names = (*_listed(node, "MEMORY"), *_listed(node, "TIMES"))
    return {name: _taken_down(getattr(node, name), node) for name in names}


def recall(node: Behaviour, memory: Memory, shift_s: float) -> None:
    """Give a node what it remembered.

    Args:
        node: The node, fresh from the builder.
        memory: As `memory_of` has returned it.
        shift_s: What the clock shows now, less what it showed then [s].

    Raises:
        KeyError: It is the memory of another kind of node.
        IndexError: It is that of a node with more children.
    """
    for name in _listed(node, "MEMORY"):
        value = memory[name]
        setattr(node, name, node.children[value.place] if isinstance(value, Child) else value)
    for name in _listed(node, "TIMES"):
        time_s: Any = memory[name]
        setattr(node, name, None if time_s is None else time_s + shift_s)


def _listed(node: Behaviour, listing: str) -> Iterator[str]:
    yield from getattr(node, listing, ())
    for kind, names in _OF_PY_TREES[listing].items():
        if isinstance(node, kind):
            yield from names


def _taken_down(value: object, node: Behaviour) -> object:
    if isinstance(value, Behaviour):
        return Child(next(i for i, other in enumerate(node.children) if other is value))
    return list(value) if isinstance(value, list) else value
