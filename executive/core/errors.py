"""The project's own exceptions.

A *failure* of a skill is normal and is returned (`executive.core.outcome`).
An exception says that something is wired or written wrongly:

    CellwrightError
    ├── InputError        what the user gave cannot be used        exit code 2
    │   └── DocumentError one or more faults in YAML documents     exit code 2
    ├── NodeError         a node of the tree raised                exit code 3
    ├── ClaimError        two nodes want one arm                   exit code 3
    ├── DeviceError       a driver, camera or simulator broke      exit code 3
    └── RecordingError    a recording cannot be written or read    exit code 3
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass


class CellwrightError(Exception):
    """Base of every exception that this project raises on purpose."""


class InputError(CellwrightError):
    """What the user gave cannot be used: says where, what, got, expected, try."""


@dataclass(frozen=True, slots=True, order=True)
class Fault:
    """One thing that is wrong in a document.

    Attributes:
        file: Path as the user gave it.
        line: Line, counted from 1.
        column: Column, counted from 1.
        node: Path of the node in the tree, `""` for the document itself.
        message: What is wrong, what was expected, and what to try.
    """

    file: str
    line: int
    column: int
    node: str
    message: str

    def __str__(self) -> str:
        """Return `file:line:col: node/path: message`, which editors can jump to."""
        where = f"{self.file}:{self.line}:{self.column}: "
        return f"{where}{self.node}: {self.message}" if self.node else f"{where}{self.message}"


class DocumentError(InputError):
    """All faults of a set of documents, found in one pass."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        """Keep the faults in the order of file and line."""
        self.faults = tuple(sorted(faults))
        super().__init__("\n".join(str(fault) for fault in self.faults))


class NodeError(CellwrightError):
    """A node raised; the cause is chained.

    Attributes:
        path: Path of the node in the tree, e.g. `untangle/trace`.
        node_type: Name of the skill or node class.
        tick: Tick at which it raised.
    """

    def __init__(self, path: str, node_type: str, tick: int, cause: BaseException) -> None:
        """Remember where it happened and chain the cause."""
        self.path, self.node_type, self.tick = path, node_type, tick
        super().__init__(
            f"{path} ({node_type}): raised at tick {tick}: {type(cause).__name__}: {cause}"
        )
        self.__cause__ = cause


class ClaimError(CellwrightError):
    """A node needs what another one holds, such as an arm."""


class DeviceError(CellwrightError):
    """A driver, a camera or a simulated world broke its contract."""


class RecordingError(CellwrightError):
    """A recording cannot be written or read."""


@contextmanager
def recording_named_by_the_user() -> Iterator[None]:
    """Turn a `RecordingError` into an `InputError`: the file is not what the user took it for."""
    try:
        yield
    except RecordingError as error:
        raise InputError(str(error)) from error
