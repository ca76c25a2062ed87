"""Numbers of nodes that may be expressions: how long, how often, how likely.

A literal is checked when the document is read; an expression is worked out each time the
node starts.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from executive.core.errors import InputError
from executive.engine.language.node_models import NodeModel
from executive.engine.language.scope import Scope, evaluate
from executive.engine.language.values import parse_value

FOREVER: Final = "forever"
Number = float | Callable[[], float]
"""What a node takes: a number, or what gives it each time the node starts."""


def number(given: Number) -> float:
    """Return the number as it is now."""
    return given() if callable(given) else given


@dataclass(frozen=True, slots=True)
class Limits:
    """What a number may be.

    Attributes:
        least: Smallest value.
        most: Largest value.
        excluded: Whether `least` itself is too small.
        whole: Whether it is an integer.
        unit: Its unit.
    """

    least: float = 0.0
    most: float = math.inf
    excluded: bool = False
    whole: bool = False
    unit: str = ""

    @property
    def type(self) -> type[float]:
        """Type of the number."""
        return int if self.whole else float

    def check(self, value: Any) -> float:
        """Return the number.

        Raises:
            InputError: It is no number, or out of its limits.
        """
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        fits = is_number and (not self.whole or isinstance(value, int)) and math.isfinite(value)
        if not fits or not self.least <= value <= self.most:
            raise InputError(f"expected {self}, got {value!r}")
        if self.excluded and value == self.least:
            raise InputError(f"expected {self}, got {value!r}")
        return float(value)

    def __str__(self) -> str:
        """Return what it asks for, as messages say it."""
        kind = "an integer" if self.whole else "a number"
        if self.most < math.inf:
            return f"{kind} from {self.least:g} to {self.most:g}"
        return (
            f"{kind} above {self.least:g}" if self.excluded else f"{kind}, {self.least:g} or more"
        )


LIMITS: Final[Mapping[str, Limits]] = {
    "seconds": Limits(excluded=True, unit="s"),
    "delay_s": Limits(unit="s"),
    "wait": Limits(unit="s"),
    "times": Limits(least=1, whole=True),
    "chance": Limits(most=1.0),
}
"""Limits of the keys of nodes that hold such numbers."""


def amounts_of(model: NodeModel) -> Iterator[tuple[str, object, Limits]]:
    """Yield key, value and limits of the numbers of a node."""
    for key, limits in LIMITS.items():
        if key in type(model).model_fields:
            yield key, getattr(model, key), limits


class Amount:
    """One number of one node; call it when the node starts."""

    def __init__(self, model: NodeModel, key: str, scope: Scope) -> None:
        """Prepare the number that stands under a key of a node."""
        raw = getattr(model, key)
        self._key, self._limits, self._scope = key, LIMITS[key], scope
        self._value = None if raw == FOREVER else parse_value(raw)

    def __call__(self) -> float:
        """Return the number; infinite for `forever`.

        Raises:
            InputError: It has no value yet, is no number, or is out of its limits.
        """
        if self._value is None:
            return math.inf
        try:
            return self._limits.check(evaluate(self._value, self._scope))
        except InputError as error:
            raise InputError(f"{self._key}: {error}") from None
