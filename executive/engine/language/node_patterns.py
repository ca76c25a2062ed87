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

    A `*` of a path also stands for several names; that of a name alone does not.

    Raises:
        InputError: It means none.
    """
    found = frozenset(index for index, node in enumerate(nodes) if _means(pattern, node.path))
    if not found:
        names = sorted({node.path.rpartition("/")[2] for node in nodes})
        raise InputError(f"no node {pattern!r}; {closest(pattern, names)}")
    return found


def _means(pattern: str, path: str) -> bool:
    if "/" not in pattern:
        return fnmatchcase(path.rpartition("/")[2], pattern)
    return fnmatchcase(path, pattern) or fnmatchcase(path, f"*/{pattern}")
