"""Breakpoints as text, one a line, the same on the command line, in files and in the page.

untangle/dilate                         before that node starts
dilate_* when size(knots) > 1           ... and only when an expression is true
dilate_* on failure                     when a node ends so: success, failure, end, halt
on failure                              any leaf
on write trace when trace.probability < 0.5
on fault                                something was raised
on slow 0.2                             a tick took longer than that many seconds
on tick 120
"""

import re
from dataclasses import dataclass
from enum import StrEnum

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.line_files import parsed_lines

_SHAPE = re.compile(
    r"^(?P<node>(?!on\b|when\b)\S+)?\s*(?:\bon\s+(?P<event>\S+)(?:\s+(?P<subject>(?!when\b)\S+))?)?"
    r"\s*(?:\bwhen\s+(?P<condition>.+))?$"
)


class Event(StrEnum):
    """What a breakpoint waits for."""

    START = "start"
    SUCCESS = "success"
    FAILURE = "failure"
    END = "end"
    HALT = "halt"
    WRITE = "write"
    FAULT = "fault"
    SLOW = "slow"
    TICK = "tick"


_OF_NODES = (Event.START, Event.SUCCESS, Event.FAILURE, Event.END, Event.HALT)
_OF_A_NUMBER = (Event.SLOW, Event.TICK)


@dataclass(frozen=True, slots=True)
class Breakpoint:
    """Where a mission is to pause.

    Attributes:
        text: As it was written.
        event: What it waits for.
        node: Pattern of the nodes; empty for any leaf.
        key: Pattern of the key, for writes.
        number: Seconds of a slow tick, or the number of a tick.
        condition: What must be true besides; None for nothing.
    """

    text: str
    event: Event
    node: str = ""
    key: str = ""
    number: float = 0.0
    condition: Expression | None = None


def parse_breakpoint(text: str) -> Breakpoint:
    """Read a breakpoint.

    Raises:
        InputError: It is none.
    """
    shape = _SHAPE.match(text.strip())
    if not text.strip() or shape is None:
        raise _no_breakpoint(text, "expected [NODE] [on EVENT] [when EXPRESSION]")
    node, subject = shape["node"] or "", shape["subject"] or ""
    name = shape["event"] or Event.START.value
    events = [event.value for event in Event]
    if name not in events:
        raise _no_breakpoint(text, f"unknown event {name!r}; {closest(name, events)}")
    event = Event(name)
    if event is Event.START and not node:
        raise _no_breakpoint(text, "expected the node that starts")
    if node and event not in _OF_NODES:
        raise _no_breakpoint(text, f"on {event} is about no node; got {node!r}")
    if bool(subject) != (event is Event.WRITE or event in _OF_A_NUMBER):
        what = f"got {subject!r} after it" if subject else "expected what after it"
        raise _no_breakpoint(text, f"on {event}: {what}")
    number = _number(text, event, subject) if event in _OF_A_NUMBER else 0.0
    key = subject if event is Event.WRITE else ""
    condition = parse_expression(shape["condition"]) if shape["condition"] else None
    return Breakpoint(text.strip(), event, node, key, number, condition)


def parse_breakpoint_file(text: str) -> list[Breakpoint]:
    """Read a file of breakpoints; empty lines and what follows a `#` are left out.

    Raises:
        InputError: A line is no breakpoint; says which.
    """
    return parsed_lines(text, parse_breakpoint)


def _number(text: str, event: Event, subject: str) -> float:
    try:
        number = float(subject)
    except ValueError:
        raise _no_breakpoint(text, f"on {event}: got {subject!r}; expected a number") from None
    if not number >= 0.0 or (event is Event.TICK and number != int(number)):
        raise _no_breakpoint(text, f"on {event}: got {subject!r}")
    return number


def _no_breakpoint(text: str, what: str) -> InputError:
    return InputError(f"breakpoint {text!r}: {what}")
