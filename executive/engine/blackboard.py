"""The blackboard of one tree: who wrote what, key by key.

It belongs to one tree and to nothing else: py_trees' own is one for the whole process, so
two missions would see each other's values (trap e11).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum


@dataclass(frozen=True, slots=True)
class Write:
    """One value written to the blackboard.

    Attributes:
        key: `TREE/PATH:name`, where the path is that of the root of the tree that owns it;
            `TREE/PATH.OWNER:name` where a subtree is the root of another tree.
        value: The value itself, not a copy: values on the blackboard are never changed;
            `Unset.UNSET` where the key has none from then on.
        writer: Path of the node that wrote it; `""` for an input of the mission.
    """

    key: str
    value: object
    writer: str


class Unset(Enum):
    """What stands for the value in the record of a write that took it away."""

    UNSET = "unset"


WriteFilter = Callable[[Write], Write | None]
"""Returns what is written instead; None where the write is lost."""


class Blackboard:
    """Values by key, with the writes since somebody last asked."""

    def __init__(self) -> None:
        """Start empty."""
        self._values: dict[str, object] = {}
        self._owned: dict[str, set[str]] = {}
        self._writes: list[Write] = []
        self._filter: WriteFilter | None = None

    def filter_with(self, change: WriteFilter) -> None:
        """Let something change the writes that follow, for injected faults."""
        self._filter = change

    def write(self, key: str, value: object, writer: str) -> None:
        """Set a key."""
        if self._filter is not None:
            write = self._filter(Write(key, value, writer))
            if write is None:
                return
            value = write.value
        if key not in self._values:
            self._owned.setdefault(key.rpartition(":")[0], set()).add(key)
        self._values[key] = value
        self._writes.append(Write(key, value, writer))

    def unset(self, key: str, writer: str) -> None:
        """Take the value of a key away; nothing happens where it has none."""
        if key in self._values:
            del self._values[key]
            self._owned[key.rpartition(":")[0]].discard(key)
            self._writes.append(Write(key, Unset.UNSET, writer))

    def read(self, key: str) -> object:
        """Return the value of a key.

        Raises:
            KeyError: Nothing has written it yet.
        """
        return self._values[key]

    def owned_by(self, path: str) -> tuple[str, ...]:
        """Return the keys with a value that belong to the tree whose root has that path."""
        return tuple(sorted(self._owned.get(path, ())))

    def __contains__(self, key: object) -> bool:
        return key in self._values

    def keys(self) -> tuple[str, ...]:
        """Return every key that has been written, in the order of first writes."""
        return tuple(self._values)

    @property
    def pending_writes(self) -> tuple[Write, ...]:
        """The writes that `drain_writes` would return."""
        return tuple(self._writes)

    def restore(self, values: Iterable[Write], pending: Iterable[Write]) -> None:
        """Hold what these writes leave behind, and nothing else.

        Args:
            values: Writes that have been drained.
            pending: Later writes, which `drain_writes` has yet to return.
        """
        self._values, self._writes = {}, []
        for write in values:
            self._put(write)
        for write in pending:
            self._put(write)
            self._writes.append(write)

    def drain_writes(self) -> list[Write]:
        """Return the writes since the last call, in order."""
        writes, self._writes = self._writes, []
        return writes

    def _put(self, write: Write) -> None:
        if write.value is Unset.UNSET:
            self._values.pop(write.key, None)
        else:
            self._values[write.key] = write.value
