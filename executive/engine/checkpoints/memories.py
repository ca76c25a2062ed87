"""What nodes remember from one tick to the next, taken down and given back by name.

A class says itself which of its attributes these are, in `MEMORY`: counts, lists, statuses,
flags, moments on the mission's clock, children of its own. py_trees' own classes are listed
here. A test holds every kind of node to its list.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from py_trees.behaviour import Behaviour
from py_trees.composites import Composite
from py_trees.decorators import OneShot

Memory = Mapping[str, object]

_OF_PY_TREES: Mapping[type[Behaviour], tuple[str, ...]] = {
    OneShot: ("final_status",),
    Composite: ("current_child",),
}


@dataclass(frozen=True, slots=True)
class Child:
    """Stands for a child of a node, by its place."""

    place: int


def remembers(node: Behaviour) -> bool:
    """Return whether a node says what it remembers, be it nothing, so that it can go on."""
    return hasattr(node, "MEMORY") or isinstance(node, tuple(_OF_PY_TREES))


def memory_of(node: Behaviour) -> dict[str, object]:
    """Return what a node remembers; most remember nothing."""
    return {name: _taken_down(getattr(node, name), node) for name in _listed(node)}


def recall(node: Behaviour, memory: Memory) -> None:
    """Give a node, fresh from the builder, what it remembered.

    Raises:
        KeyError: It is the memory of another kind of node.
        IndexError: It is that of a node with more children.
    """
    for name in _listed(node):
        value = memory[name]
        setattr(node, name, node.children[value.place] if isinstance(value, Child) else value)


def _listed(node: Behaviour) -> Iterator[str]:
    yield from getattr(node, "MEMORY", ())
    for kind, names in _OF_PY_TREES.items():
        if isinstance(node, kind):
            yield from names


def _taken_down(value: object, node: Behaviour) -> object:
    if isinstance(value, Behaviour):
        return Child(next(i for i, other in enumerate(node.children) if other is value))
    return list(value) if isinstance(value, list) else value
