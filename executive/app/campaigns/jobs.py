"""What goes to the process that runs a mission of a campaign, and what comes back."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, JsonValue

Ending = Literal[
    "success", "failure", "timeout", "aborted", "error", "died", "overdue", "out of memory"
]
"""Outcome of a run: that of its mission, or how its process was lost."""

LOST: frozenset[str] = frozenset({"died", "overdue", "out of memory"})


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Assignment(_Message):
    """What all runs of a campaign share.

    Attributes:
        mission: File of the mission.
        sources: Hashes of the files that it was built from when the campaign began, by file.
        wall_s: Limit of a run on the machine's clock [s].
        memory_mb: Limit of its memory [MB].
        timeout_s: Limit on the cell's clock [s]; None for that of the mission.
        keep: Which recordings stay.
        folder: The campaign's folder.
        directory: Where the campaign was started: files in settings are meant from there.
        path: Folders of trees that the user named, as in `CELLWRIGHT_PATH`.
    """

    mission: str
    sources: dict[str, str]
    wall_s: float
    memory_mb: float | None
    timeout_s: float | None
    keep: Literal["failed", "all", "none"]
    folder: str
    directory: str
    path: str


class Job(_Message):
    """One run."""

    name: str
    variant: int
    seed: int
    settings: dict[str, JsonValue]


class RunRecord(_Message):
    """What one run came to.

    `measures` are the numbers and truth values in the mission's claim and in the truth that the
    world told after it, by name; `peak_mb` is the memory that its process had at most [MB];
    `recording` is a file from the campaign's folder on.
    """

    name: str
    variant: int
    seed: int
    settings: dict[str, JsonValue]
    outcome: Ending
    reason: str = ""
    sim_s: float = 0.0
    wall_s: float = 0.0
    ticks: int = 0
    actions: int = 0
    measures: dict[str, float | bool] = {}
    claim: JsonValue = None
    truth: JsonValue = None
    peak_mb: float = 0.0
    host: str = ""
    recording: str = ""
