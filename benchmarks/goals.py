"""Goals of figures as text, `>= 5`, and whether a figure meets its own."""

import re
from dataclasses import dataclass

_FORM = re.compile(r"(>=|<=|<|>|=) ?(\S+)")


@dataclass(frozen=True, slots=True)
class Goal:
    """What a figure should reach.

    Attributes:
        sign: One of `>=`, `<=`, `>`, `<`, `=`.
        value: The number after it.
        decimals: With how many decimals that is written.
    """

    sign: str
    value: float
    decimals: int

    def is_met(self, figure: float) -> bool:
        """Say whether a figure meets it; `= 0.65` as rounded, `= 1` exactly."""
        match self.sign:
            case ">=":
                return figure >= self.value
            case "<=":
                return figure <= self.value
            case ">":
                return figure > self.value
            case "<":
                return figure < self.value
            case _:
                return (round(figure, self.decimals) if self.decimals else figure) == self.value


def parse_goal(text: str) -> Goal | None:
    """Return the goal that a row names, None for a row without one.

    Raises:
        ValueError: The text is no goal.
    """
    if not text:
        return None
    found = _FORM.fullmatch(text.strip())
    if found is None:
        raise ValueError(f"goal: is none; got {text!r}; expected a sign and a number, as '>= 5'")
    sign, number = found.groups()
    return Goal(sign, float(number), len(number.partition(".")[2]))
