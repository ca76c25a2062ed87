"""Nodes by what people call them: a path, the end of a path, a name, or a glob of these."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Protocol

from executive.core.errors import InputError
from executive.core.registry import closest


class NamedNode(Protocol):
    """A node with a path."""

    @property
    def path(self) -> str:
        """Names from the root down."""
        ...


def matching(nodes: Sequence[NamedNode], pattern: str) -> frozenset[int]:
    """Return the indices of the nodes that a pattern means.

    Raises:
        InputError: It means none.
    """
    found = frozenset(
        index
        for index, node in enumerate(nodes)
        if fnmatchcase(node.path, pattern) or fnmatchcase(node.path, f"*/{pattern}")
    )
    if not found:
        names = sorted({node.path.rpartition("/")[2] for node in nodes})
        raise InputError(f"no node {pattern!r}; {closest(pattern, names)}")
    return found
