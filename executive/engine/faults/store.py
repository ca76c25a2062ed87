"""The folder of a campaign: what was asked for, and each result as soon as it is there."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from executive.core.errors import InputError
from executive.engine.recording.messages import SourceFile
from executive.engine.result_folders import PLAN, ResultLines, begin_folder

Verdict = Literal["survived", "ended", "wrong", "not reached"]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CampaignPlan(_Model):
    """What is run; the faults may become more while a campaign goes on."""

    format: Literal[1] = 1
    mission: str
    seed: int
    timeout_s: float | None
    assignments: tuple[str, ...]


class FaultRun(_Model):
    """One run of a campaign, and what its fault led to.

    `outcome` is that of the run, or `died` or `overdue` where its process did not end by itself.
    `answered_by` is the node that answered for the fault, `answer` what came of that: it
    `recovered`, or was `still trying` when the run ended.
    """

    fault: str
    verdict: Verdict
    outcome: str
    reason: str = ""
    sim_s: float = 0.0
    wall_s: float = 0.0
    answered_by: str = ""
    answer: Literal["", "recovered", "still trying"] = ""
    left_running: tuple[str, ...] = ()
    wrong: str = ""
    recording: str = ""


class CampaignFolder:
    """The folder of one campaign."""

    def __init__(self, folder: Path) -> None:
        """Name it; nothing is read or written yet."""
        self.folder = folder
        self._lines = ResultLines(folder, FaultRun)

    def begin(self, plan: CampaignPlan) -> None:
        """Make the folder.

        Raises:
            InputError: It holds a campaign already, or cannot be made.
        """
        begin_folder(self.folder, plan)

    def resume(self, plan: CampaignPlan) -> None:
        """Check that the folder holds a campaign of the same plan.

        Raises:
            InputError: It holds none, or another one; says what differs.
        """
        file = self.folder / PLAN
        try:
            begun = CampaignPlan.model_validate_json(file.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, ValidationError):
            raise InputError(f"{file}: no campaign to resume; try without --resume") from None
        for name in CampaignPlan.model_fields:
            before, now = getattr(begun, name), getattr(plan, name)
            if before != now:
                raise InputError(
                    f"{file}: that campaign has {name} {before!r}, not {now!r}; "
                    "try the same options, or another --out"
                )
        self._lines.end_last_line()

    def add(self, run: FaultRun) -> None:
        """Keep a result.

        Raises:
            InputError: It cannot be written; the run is repeated when the campaign goes on.
        """
        self._lines.add(run)

    def results(self) -> dict[str, FaultRun]:
        """Return the results so far by fault; a line that was cut off by a kill is left out."""
        return {run.fault: run for run in self._lines}

    def finished(self) -> dict[str, FaultRun]:
        """Return the results that need not be had again: those of runs that came to an end."""
        broken = ("died", "overdue")
        return {fault: run for fault, run in self.results().items() if run.outcome not in broken}


def changed_sources(sources: Sequence[SourceFile]) -> list[str]:
    """Return the documents that are not any more what they were."""
    return [one.file for one in sources if _sha256(Path(one.file)) != one.sha256]


def _sha256(file: Path) -> str:
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError:
        return ""
