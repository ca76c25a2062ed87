"""What the attributes of a foreign node say: parameters of built-in nodes, and wires of ports."""

from executive.core.errors import InputError
from executive.engine.exchange.cpptypes import read_literal
from executive.engine.exchange.dataflow import key_in
from executive.engine.exchange.draft import Draft
from executive.engine.exchange.markup import Element
from executive.engine.exchange.naming import Namer


class Parameters:
    """Reads parameters as literals, or as references to keys where we allow them."""

    def __init__(self, keys: Namer) -> None:
        """Know what the keys are called here."""
        self._keys = keys

    def read(self, element: Element, port: str, kind: str, default: object = None) -> object:
        """Return a parameter as a literal, or as `$key`.

        Raises:
            InputError: It is missing and has no default, or is no literal of that kind.
        """
        text = element.attributes.get(port)
        if text is None:
            if default is None:
                raise InputError(f"needs the port {port!r}")
            return default
        key = key_in(text, port)
        if key is not None:
            return f"${self._keys(key)}"
        try:
            return read_literal(text, kind)
        except InputError as error:
            raise InputError(f"{port}: {error}") from None

    def seconds(self, element: Element, port: str) -> float | str:
        """Return a time that is given in milliseconds.

        Raises:
            InputError: It is missing, or no whole number, 0 or more.
        """
        value = self.read(element, port, "int")
        if isinstance(value, str):
            return f"{value} / 1000"
        assert isinstance(value, int)
        if value < 0:
            raise InputError(f"{port}: expected 0 or more, got {value}")
        return value / 1000

    def threshold(self, element: Element, port: str, default: int) -> int:
        """Return how many of a node's children are meant; negative numbers count from all.

        Raises:
            InputError: There are not so many, or a key says how many.
        """
        count = len(element.children)
        value = self.read(element, port, "int", default)
        if not isinstance(value, int):
            raise InputError(f"{port} is read from a key; our parallel takes a number")
        wanted = count + value + 1 if value < 0 else value
        if not 1 <= wanted <= count:
            raise InputError(f"{port}={value} asks for {wanted} of {count} children")
        return wanted


class Wires:
    """Gathers the inputs and outputs of one leaf."""

    def __init__(self, keys: Namer) -> None:
        """Know what keys and ports are called here."""
        self._keys = keys
        self._ins: dict[str, object] = {}
        self._outs: dict[str, str] = {}

    def add(self, port: str, text: str, direction: str, kind: str) -> None:
        """Wire a port; one that is read and written is an input and an output here.

        Args:
            port: Its foreign name.
            text: What its attribute says: `{key}` or a literal.
            direction: `in`, `out` or `inout`.
            kind: Our type of it.

        Raises:
            InputError: The literal is none of that type, or the key is on another blackboard.
        """
        name = self._keys(port)
        key = key_in(text, port)
        if direction != "out":
            reads = name if direction == "in" else f"{name}_in"
            self._ins[reads] = (
                _input(read_literal(text, kind)) if key is None else self._reference(key)
            )
        if direction != "in" and key is not None:
            self._outs[name] = self._reference(key)

    def onto(self, draft: Draft) -> Draft:
        """Put the wires on the draft of the leaf, and return that."""
        if self._ins:
            draft.body["in"] = self._ins
        if self._outs:
            draft.body["out"] = self._outs
        return draft

    def _reference(self, key: str) -> str:
        if key.startswith("@"):
            raise InputError(f"{key!r} is on the root's blackboard; our trees see their own keys")
        return f"${self._keys(key)}"


def _input(value: object) -> object:
    """Return a literal as it stands at an input, where `$` means a key."""
    return f"${value}" if isinstance(value, str) and value.startswith("$") else value
