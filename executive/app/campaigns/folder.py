"""The folder of a campaign: what is run, and each result as soon as it is there."""

import os
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from executive.app.campaigns.document import CampaignDocument
from executive.app.campaigns.jobs import LOST, RunRecord
from executive.app.campaigns.one_run import RECORDINGS
from executive.core.errors import InputError
from executive.engine.recording.messages import SourceFile

PLAN, RESULTS, LOCK = "campaign.json", "results.jsonl", "campaign.lock"


class CampaignPlan(BaseModel):
    """What a campaign was begun with: its document, and the files of the mission as they were."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: int = 1
    document: CampaignDocument
    mission: str
    sources: tuple[SourceFile, ...]
    versions: dict[str, str]
    started_utc: str


class CampaignFolder:
    """One folder; results are lines of JSON that a kill cannot take back."""

    def __init__(self, folder: Path) -> None:
        """Name it; nothing is read or written yet."""
        self.folder = folder

    @property
    def lock(self) -> Path:
        """The file that a process holds while it runs this campaign."""
        return self.folder / LOCK

    def begin(self, plan: CampaignPlan) -> None:
        """Make the folder.

        Raises:
            InputError: It holds a campaign already, or cannot be made.
        """
        if (self.folder / PLAN).exists():
            raise InputError(
                f"{self.folder}: holds a campaign already; try --resume, or another --out"
            )
        try:
            (self.folder / RECORDINGS).mkdir(parents=True, exist_ok=True)
            file = self.folder / f"{PLAN}.new"
            file.write_text(plan.model_dump_json(indent=1, by_alias=True), encoding="utf-8")
            file.replace(self.folder / PLAN)
        except OSError as error:
            raise InputError(f"{self.folder}: cannot be written: {error.strerror}") from None

    def plan(self) -> CampaignPlan:
        """Return what the campaign was begun with.

        Raises:
            InputError: There is none.
        """
        file = self.folder / PLAN
        try:
            return CampaignPlan.model_validate_json(file.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError):
            raise InputError(f"{self.folder}: holds no campaign; expected {PLAN} in it") from None
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise InputError(f"{file}: is damaged; got {first['msg']}") from None

    def resume(self, plan: CampaignPlan) -> None:
        """Check that the folder holds this campaign, and clear what a kill has left there.

        Raises:
            InputError: It holds none, or another one; says what differs.
        """
        begun = self.plan()
        for name in CampaignDocument.model_fields:
            before, now = getattr(begun.document, name), getattr(plan.document, name)
            if before != now and name != "about":
                raise InputError(
                    f"{self.folder}: that campaign has another {name.rstrip('_')!r}; got {now!r}; "
                    f"expected {before!r}; try another --out"
                )
        was = {one.file: one.sha256 for one in begun.sources}
        for source in plan.sources:
            if was.get(source.file) != source.sha256:
                raise InputError(
                    f"{source.file}: is not what it was when the campaign began; try another --out"
                )
        self._end_last_line()
        self._clear()

    def add(self, record: RunRecord) -> None:
        """Keep a result: it is with the operating system when this returns.

        Raises:
            InputError: It cannot be written; the run is repeated when the campaign goes on.
        """
        line = record.model_dump_json().encode() + b"\n"
        file = self.folder / RESULTS
        try:
            with file.open("ab", buffering=0) as results:
                begun = results.tell()
                if results.write(line) != len(line):
                    os.truncate(file, begun)
                    raise OSError(0, "no space for a whole line")
        except OSError as error:
            raise InputError(
                f"{file}: cannot be written; got {error.strerror}; "
                "make room, and go on with --resume"
            ) from None

    def records(self) -> Iterator[RunRecord]:
        """Yield the results so far; a line that was cut off or damaged is left out.

        A run that was repeated has its last result.
        """
        yield from self._last().values()

    def _last(self) -> dict[str, RunRecord]:
        found: dict[str, RunRecord] = {}
        try:
            with (self.folder / RESULTS).open("rb") as lines:
                for line in lines:
                    try:
                        record = RunRecord.model_validate_json(line)
                    except ValidationError:
                        continue
                    found[record.name] = record
        except FileNotFoundError:
            pass
        return found

    def finished(self, *, again: bool) -> set[str]:
        """Return the names of runs that need not be run.

        Args:
            again: Whether runs whose process was lost are to be repeated.
        """
        return {
            name for name, record in self._last().items() if not (again and record.outcome in LOST)
        }

    def _end_last_line(self) -> None:
        """End a line that was cut off by a kill, so that the next result has its own."""
        file = self.folder / RESULTS
        if file.exists() and (data := file.read_bytes()) and not data.endswith(b"\n"):
            with file.open("ab") as results:
                results.write(b"\n")

    def _clear(self) -> None:
        """Remove recordings of runs that have no result: they are run again."""
        known = {Path(record.recording).name for record in self.records() if record.recording}
        for file in (self.folder / RECORDINGS).glob("*"):
            if f"{file.name.partition('.')[0]}.mcap" not in known:
                file.unlink(missing_ok=True)
