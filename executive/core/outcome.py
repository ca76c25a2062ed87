"""What a skill answers: running, success with outputs, or failure with a listed reason."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType


class Status(StrEnum):
    """Status of a leaf after a tick."""

    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a skill failed.

    Attributes:
        code: Listed code such as `grasp.missed`; trees, recordings and tests use it.
        text: A sentence for people; never parsed.
        data: Numbers that belong to it, with units in their names.
    """

    code: str
    text: str = ""
    data: Mapping[str, object] = field(default_factory=dict)

    def __str__(self) -> str:
        """Return `code: text`."""
        return f"{self.code}: {self.text}" if self.text else self.code


@dataclass(frozen=True, slots=True)
class Outcome:
    """Status of a skill after one step, with what belongs to it."""

    status: Status
    outputs: Mapping[str, object] = field(default_factory=dict)
    reason: Reason | None = None


RUNNING = Outcome(Status.RUNNING)


def success(**outputs: object) -> Outcome:
    """Return a success that writes `outputs` to the skill's output ports."""
    return Outcome(Status.SUCCESS, outputs=MappingProxyType(outputs))


def failure(code: str, text: str = "", **data: object) -> Outcome:
    """Return a failure with a reason code that the skill lists in `REASONS`."""
    return Outcome(Status.FAILURE, reason=Reason(code, text, MappingProxyType(data)))
