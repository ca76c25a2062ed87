"""Names inside one tree, and the keys of the blackboard that they stand for."""

from collections.abc import Mapping

from executive.core.errors import InputError
from executive.core.skill import REQUIRED
from executive.engine.blackboard import Blackboard
from executive.engine.language.expression import Expression
from executive.engine.language.values import Literal, Value, key_of


class Scope:
    """The names that the nodes of one tree see.

    An input is another name for the key, expression or literal that the outer tree gave, so
    it follows its source; an output is another name for the outer key. Every other name is a
    key of this tree alone.
    """

    def __init__(self, path: str, blackboard: Blackboard) -> None:
        """Begin with no ports; `path` is that of the root node."""
        self._path = path
        self._blackboard = blackboard
        self._keys: dict[str, str] = {}
        self._inputs: dict[str, tuple[Value, Scope, str | None]] = {}
        self._defaults: dict[str, object] = {}
        self._kept: frozenset[str] = frozenset()

    def bind_input(self, name: str, value: Value, outer: "Scope", default: object) -> None:
        """Make an input stand for what the outer tree gave.

        Args:
            name: The input.
            value: What it is wired to.
            outer: Names of the outer tree.
            default: Its value while the key that it is wired to has none, or `REQUIRED`.
        """
        key = key_of(value)
        if key is None or key in outer._inputs or key in outer._defaults:
            self._inputs[name] = value, outer, key
        else:
            self._keys[name] = outer.key(key)
        if default is not REQUIRED:
            self._defaults[name] = default

    def bind_output(self, name: str, key: str, outer: "Scope") -> None:
        """Make an output stand for a key of the outer tree."""
        self._keys[name] = outer.key(key)

    def key(self, name: str) -> str:
        """Return the key on the blackboard that a name stands for."""
        key = self._keys.get(name)
        if key is None:
            key = self._keys[name] = f"{self._path}:{name}"
        return key

    def __getitem__(self, name: str) -> object:
        if name in self._defaults and not self._has_source(name):
            return self._defaults[name]
        source = self._inputs.get(name)
        if source is not None:
            value, outer, _ = source
            return evaluate(value, outer)
        return self._blackboard.read(self.key(name))

    def __contains__(self, name: object) -> bool:
        return name in self._defaults or self._has_source(str(name))

    def _has_source(self, name: str) -> bool:
        source = self._inputs.get(name)
        if source is None:
            return self.key(name) in self._blackboard
        _, outer, key = source
        return key is None or key in outer

    def write(self, name: str, value: object, writer: str) -> None:
        """Set a key."""
        self._blackboard.write(self.key(name), value, writer)

    def keep(self, values: Mapping[str, object]) -> None:
        """Name the keys that outlive an activation, and give them their first values."""
        self._kept = frozenset(self.key(name) for name in values)
        for name, value in values.items():
            self.write(name, value, self._path)

    def start_anew(self) -> None:
        """Forget what the tree has written in earlier activations, but for what it keeps."""
        for key in self._blackboard.owned_by(self._path):
            if key not in self._kept:
                self._blackboard.unset(key, self._path)

    def unset(self, name: str, writer: str) -> None:
        """Take the value of a key away."""
        self._blackboard.unset(self.key(name), writer)


def evaluate(value: Value, scope: Scope) -> object:
    """Return what a value comes to in a scope.

    Raises:
        InputError: A key has no value yet, or the expression fails on what it finds.
    """
    return value.value if isinstance(value, Literal) else value.evaluate(scope)


class Inputs:
    """What the inputs of a leaf are wired to; sorted once, read at every start."""

    def __init__(
        self, wired: Mapping[str, Value], defaults: Mapping[str, object], scope: Scope
    ) -> None:
        """Keep what is wired; `defaults` are of the inputs that have one."""
        self._scope = scope
        self._literals = {p: one.value for p, one in wired.items() if isinstance(one, Literal)}
        self._expressions = [
            (port, value, key_of(value) if port in defaults else None)
            for port, value in wired.items()
            if isinstance(value, Expression)
        ]

    def read(self) -> dict[str, object]:
        """Return the inputs of a leaf that starts.

        An input with a default is left out while the key that it is wired to has no value.

        Raises:
            InputError: An input has neither.
        """
        values = self._literals.copy()
        for port, expression, optional in self._expressions:
            if optional is not None and optional not in self._scope:
                continue
            try:
                values[port] = expression.evaluate(self._scope)
            except InputError as error:
                raise InputError(f"input {port!r}: {error}") from error
        return values
