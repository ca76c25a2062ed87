"""The blackboard of one tree: who wrote what, key by key.

It belongs to one tree and to nothing else: py_trees' own is one for the whole process, so
two missions would see each other's values (trap e11).
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Write:
    """One value written to the blackboard.

    Attributes:
        key: `TREE/PATH:name`, where the path is that of the root of the tree that owns it.
        value: The value itself, not a copy: values on the blackboard are never changed.
        writer: Path of the node that wrote it; `""` for an input of the mission.
    """

    key: str
    value: object
    writer: str


class Blackboard:
    """Values by key, with the writes since somebody last asked."""

    def __init__(self) -> None:
        """Start empty."""
        self._values: dict[str, object] = {}
        self._writes: list[Write] = []

    def write(self, key: str, value: object, writer: str) -> None:
        """Set a key."""
        self._values[key] = value
        self._writes.append(Write(key, value, writer))

    def read(self, key: str) -> object:
        """Return the value of a key.

        Raises:
            KeyError: Nothing has written it yet.
        """
        return self._values[key]

    def __contains__(self, key: object) -> bool:
        return key in self._values

    def keys(self) -> tuple[str, ...]:
        """Return every key that has been written, in the order of first writes."""
        return tuple(self._values)

    def drain_writes(self) -> list[Write]:
        """Return the writes since the last call, in order."""
        writes, self._writes = self._writes, []
        return writes
