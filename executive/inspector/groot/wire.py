"""Groot2's protocol on the wire: headers, statuses and transitions as bytes.

The facts are those of `groot2_protocol.h` and `groot2_publisher.cpp` of BehaviorTree.CPP 4. A
request is one or two frames, the first of them six bytes: protocol, type, number of the request
(little endian). A reply begins with the same six bytes and sixteen that identify the tree.
"""

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum

from executive.core.errors import InputError

PROTOCOL = 2
MOST_NODES = 0xFFFF
"""The protocol numbers nodes with two bytes."""

TREE_ID_BYTES = 16

_HEADER = struct.Struct("<BBI")
_STATUS = struct.Struct("<HB")


class Request(IntEnum):
    """What a client may ask, by the letter that says so."""

    FULLTREE = ord("T")
    STATUS = ord("S")
    BLACKBOARD = ord("B")
    HOOK_INSERT = ord("I")
    HOOK_REMOVE = ord("R")
    BREAKPOINT_REACHED = ord("N")
    BREAKPOINT_UNLOCK = ord("U")
    HOOKS_DUMP = ord("D")
    REMOVE_ALL_HOOKS = ord("A")
    DISABLE_ALL_HOOKS = ord("X")
    TOGGLE_RECORDING = ord("r")
    GET_TRANSITIONS = ord("t")


class NodeByte(IntEnum):
    """Status of a node; `IDLE_AFTER` is added to what it was when it went idle."""

    IDLE = 0
    RUNNING = 1
    SUCCESS = 2
    FAILURE = 3
    SKIPPED = 4
    IDLE_AFTER = 10


@dataclass(frozen=True, slots=True)
class Header:
    """The first six bytes of a request."""

    request: Request
    number: int


@dataclass(frozen=True, slots=True)
class Transition:
    """A node changed its status.

    Attributes:
        time_s: When, since recording began [s].
        uid: Number of the node.
        status: Its new status.
    """

    time_s: float
    uid: int
    status: int


def read_header(data: bytes) -> Header:
    """Read the first frame of a request.

    Raises:
        InputError: It is none.
    """
    if len(data) != _HEADER.size:
        raise InputError(f"wrong request header: got {len(data)} bytes; expected {_HEADER.size}")
    _, letter, number = _HEADER.unpack(data)
    try:
        return Header(Request(letter), number)
    except ValueError:
        known = " ".join(chr(request) for request in Request)
        raise InputError(f"unknown request {chr(letter)!r}; expected one of {known}") from None


def write_header(header: Header) -> bytes:
    """Return the six bytes of a header; a client sends them, a reply repeats them."""
    return _HEADER.pack(PROTOCOL, header.request, header.number)


def write_statuses(statuses: Sequence[int]) -> bytes:
    """Return the status of every node; the first one has number 1."""
    return b"".join(_STATUS.pack(uid, status) for uid, status in enumerate(statuses, start=1))


def write_transitions(transitions: Iterable[Transition]) -> bytes:
    """Return nine bytes for each: microseconds in six, number of the node, status."""
    return b"".join(
        round(max(one.time_s, 0.0) * 1e6).to_bytes(8, "little")[:6]
        + _STATUS.pack(one.uid, one.status)
        for one in transitions
    )
