"""Faults as text, one a line, the same on the command line and in files.

grasp_*: fail@3                 fails in its third activation
untangle/dilate: fail@2+        ... in the second and in every later one
dilate_*: fail 0.2              ... by chance, with the seed of the mission
trace: hang                     runs for ever and does nothing
go_home: delay 2.5              starts 2.5 s late, on the cell's clock
trace: raise@1                  raises an exception
key frame: stale@2              the second write keeps the value of the first
key confidence: value nan       every write is of that value instead: JSON, or nan
key claim: drop@1               the first write is lost
"""

import json
import math
import re
from dataclasses import dataclass
from enum import StrEnum

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.line_files import parsed_lines

_SHAPE = re.compile(
    r"(?:key\s+(?P<key>\S+?)\s*:\s+|(?P<node>[^\s:]+)\s*:\s*)(?P<what>\S.*?)\s*", re.DOTALL
)
_WHAT = re.compile(
    r"(?P<kind>[a-z]+)(?:\s+(?P<argument>[^\s@].*?))?\s*(?:@\s*(?P<nth>\d+)(?P<on>\+)?)?", re.DOTALL
)


class Kind(StrEnum):
    """What a fault does."""

    FAIL = "fail"
    HANG = "hang"
    DELAY = "delay"
    RAISE = "raise"
    STALE = "stale"
    VALUE = "value"
    DROP = "drop"


NODE_KINDS = (Kind.FAIL, Kind.HANG, Kind.DELAY, Kind.RAISE)
KEY_KINDS = (Kind.STALE, Kind.VALUE, Kind.DROP)


@dataclass(frozen=True, slots=True)
class Injection:
    """A fault that is to be injected.

    Attributes:
        text: As it was written.
        target: Pattern of nodes or of keys.
        kind: What it does; one of `KEY_KINDS` where it is about keys.
        nth: Activation or write that it is for, counted from 1; None for every one.
        onwards: Whether it is for all later ones too.
        probability: How likely it happens then.
        seconds: How long a delay is [s].
        value: What is written instead, as JSON has it; NaN for `nan`.
    """

    text: str
    target: str
    kind: Kind
    nth: int | None = None
    onwards: bool = False
    probability: float = 1.0
    seconds: float = 0.0
    value: object = None

    @property
    def of_key(self) -> bool:
        """Whether it is about keys and not about nodes."""
        return self.kind in KEY_KINDS

    def is_for(self, number: int) -> bool:
        """Return whether it is for an activation or a write, counted from 1."""
        if self.nth is None:
            return True
        return number >= self.nth if self.onwards else number == self.nth


def parse_injection(text: str) -> Injection:
    """Read a fault.

    Raises:
        InputError: It is none; says what is wrong with it.
    """
    text = text.strip()
    shape = _SHAPE.fullmatch(text)
    if shape is None:
        raise _refused(text, "expected NODES: KIND or key NAME: KIND, such as 'grasp_*: fail@3'")
    what = _WHAT.fullmatch(shape["what"])
    if what is None:
        raise _refused(text, f"got {shape['what']!r}; expected KIND, KIND@3 or KIND@3+")
    kind = _kind(text, what["kind"], of_key=shape["key"] is not None)
    nth = None if what["nth"] is None else int(what["nth"])
    if nth == 0:
        raise _refused(text, "@0: expected 1 or more, the first is @1")
    if kind is Kind.STALE and nth == 1 and not what["on"]:
        raise _refused(text, "stale@1: nothing was written before the first write; try stale@2")
    argument = what["argument"]
    return Injection(
        text,
        shape["key"] or shape["node"],
        kind,
        nth,
        onwards=what["on"] is not None,
        probability=_probability(text, kind, argument),
        seconds=_seconds(text, argument) if kind is Kind.DELAY else 0.0,
        value=_value(text, argument) if kind is Kind.VALUE else None,
    )


def parse_injection_file(text: str) -> list[Injection]:
    """Read a file of faults; empty lines and what follows a `#` are left out.

    Raises:
        InputError: A line is no fault; says which.
    """
    return parsed_lines(text, parse_injection)


def _kind(text: str, name: str, *, of_key: bool) -> Kind:
    here, there = (KEY_KINDS, NODE_KINDS) if of_key else (NODE_KINDS, KEY_KINDS)
    if name in here:
        return Kind(name)
    subject = "a key" if of_key else "a node"
    known = [kind.value for kind in here]
    if name in there:
        other = "NODES: KIND" if of_key else "key NAME: KIND"
        raise _refused(
            text, f"{name} is nothing that {subject} does (known: {', '.join(known)}); try {other}"
        )
    raise _refused(text, f"unknown kind {name!r} for {subject}; {closest(name, known)}")


def _probability(text: str, kind: Kind, argument: str | None) -> float:
    if argument is None or kind in (Kind.DELAY, Kind.VALUE):
        return 1.0
    number = _number(argument)
    if not 0.0 < number <= 1.0:
        raise _refused(
            text, f"{kind}: got {argument!r}; expected a probability, above 0 and at most 1"
        )
    return number


def _seconds(text: str, argument: str | None) -> float:
    number = math.nan if argument is None else _number(argument)
    if not 0.0 < number < math.inf:
        got = "nothing" if argument is None else repr(argument)
        raise _refused(text, f"delay: got {got}; expected seconds above 0, such as delay 2.5")
    return number


def _value(text: str, argument: str | None) -> object:
    if argument is None:
        raise _refused(text, "value: got nothing; expected JSON or nan, such as value 0.5")
    if argument.lower() == "nan":
        return math.nan
    try:
        return json.loads(argument)
    except ValueError as error:
        what = f"value: {argument!r} is no JSON ({error}); texts need quotes: '\"edge\"'"
        raise _refused(text, what) from None


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _refused(text: str, what: str) -> InputError:
    return InputError(f"fault {text!r}: {what}")
