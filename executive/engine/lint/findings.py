"""What a rule is, and what it finds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from executive.engine.language.outline import NodeSpec

if TYPE_CHECKING:
    from executive.engine.lint.subject import Subject


@dataclass(frozen=True, slots=True, order=True)
class Finding:
    """One thing that is legal but surely wrong.

    Attributes:
        file: Path as the user gave it.
        line: Line, counted from 1.
        column: Column, counted from 1.
        node: Path of the node in the tree, `""` for the document itself.
        code: Code of the rule.
        rule: Name of the rule.
        message: What is wrong, and what to try.
    """

    file: str
    line: int
    column: int
    node: str
    code: str
    rule: str
    message: str

    def __str__(self) -> str:
        """Return `file:line:col: CODE name: node: message`, which editors can jump to."""
        where = f"{self.file}:{self.line}:{self.column}: {self.code} {self.rule}: "
        return f"{where}{self.node}: {self.message}" if self.node else f"{where}{self.message}"


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a rule found something, and what to say; the rule adds its own name.

    Attributes:
        node: The node.
        message: What is wrong, and what to try.
        at: Keys in the file that lead to the place from the node.
    """

    node: NodeSpec
    message: str
    at: tuple[str | int, ...] = ()


@dataclass(frozen=True, slots=True)
class PortSpot:
    """The same for a port of the tree itself.

    Attributes:
        direction: `in` or `out`.
        port: Name of the port.
        message: What is wrong, and what to try.
    """

    direction: str
    port: str
    message: str


@dataclass(frozen=True, slots=True)
class Rule:
    """One way to be wrong.

    Attributes:
        code: Code that waivers name, never given to another rule.
        name: Name in a few words.
        about: Why it is wrong, in a sentence or two.
        look: Yields what it finds in a tree.
        missions_only: Whether it shows only in a mission with all its subtrees.
    """

    code: str
    name: str
    about: str
    look: "Callable[[Subject], Iterator[Spot | PortSpot]]"
    missions_only: bool = False
