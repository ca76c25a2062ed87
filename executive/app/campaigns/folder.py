"""The folder of a campaign: what is run, and each result as soon as it is there."""

from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from executive.app.campaigns.document import CampaignDocument
from executive.app.campaigns.jobs import LOST, RunRecord
from executive.app.campaigns.one_run import RECORDINGS
from executive.core.errors import InputError
from executive.core.json_files import read_json
from executive.engine.recording.messages import SourceFile
from executive.engine.result_folders import PLAN, ResultLines, begin_folder

LOCK = "campaign.lock"


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
        self._lines = ResultLines(folder, RunRecord)

    @property
    def lock(self) -> Path:
        """The file that a process holds while it runs this campaign."""
        return self.folder / LOCK

    def begin(self, plan: CampaignPlan) -> None:
        """Make the folder.

        Raises:
            InputError: It holds a campaign already, or cannot be made.
        """
        begin_folder(self.folder, plan, RECORDINGS)

    def plan(self) -> CampaignPlan:
        """Return what the campaign was begun with.

        Raises:
            InputError: There is none, or it is damaged.
        """
        if not (self.folder / PLAN).exists():
            raise InputError(f"{self.folder}: holds no campaign; expected {PLAN} in it")
        return read_json(self.folder / PLAN, CampaignPlan, "a campaign")

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
        self._lines.end_last_line()
        self._clear()

    def add(self, record: RunRecord) -> None:
        """Keep a result: it is with the operating system when this returns.

        Raises:
            InputError: It cannot be written; the run is repeated when the campaign goes on.
        """
        self._lines.add(record)

    def records(self) -> Iterator[RunRecord]:
        """Yield the results so far; a line that was cut off or damaged is left out.

        A run that was repeated has its last result.
        """
        yield from self._last().values()

    def _last(self) -> dict[str, RunRecord]:
        return {record.name: record for record in self._lines}

    def finished(self, *, again: bool) -> set[str]:
        """Return the names of runs that need not be run.

        Args:
            again: Whether runs whose process was lost are to be repeated.
        """
        return {
            name for name, record in self._last().items() if not (again and record.outcome in LOST)
        }

    def _clear(self) -> None:
        """Remove recordings of runs that have no result: they are run again."""
        known = {Path(record.recording).name for record in self.records() if record.recording}
        for file in (self.folder / RECORDINGS).glob("*"):
            if f"{file.name.partition('.')[0]}.mcap" not in known:
                file.unlink(missing_ok=True)
