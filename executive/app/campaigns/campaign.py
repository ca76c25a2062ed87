"""A campaign from its document to its last run."""

import os
from collections.abc import Generator
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from executive.app.campaigns.cluster import Cluster
from executive.app.campaigns.document import CampaignDocument
from executive.app.campaigns.folder import CampaignFolder, CampaignPlan
from executive.app.campaigns.jobs import Assignment, RunRecord
from executive.app.campaigns.variants import jobs, variants
from executive.app.missions import load, settings_of
from executive.core.locks import FileLock
from executive.engine.loading.loader import Mission
from executive.engine.loading.packages import PATH_VARIABLE
from executive.engine.recording.messages import SourceFile
from executive.engine.running.mission_run import versions


@dataclass(frozen=True, slots=True)
class Where:
    """Who runs a campaign.

    Attributes:
        workers: Runs at a time, on the cores here.
        scheduler: Address of the scheduler of a Dask cluster instead.
    """

    workers: int = 1
    scheduler: str | None = None


class Campaign:
    """One campaign in its folder."""

    def __init__(self, document: CampaignDocument, beside: Path, folder: Path) -> None:
        """Load the mission and hold every variant against it; nothing is written yet.

        Args:
            document: What is wanted.
            beside: Folder that the mission is looked for in first.
            folder: Where the campaign is kept.

        Raises:
            InputError: The mission has faults, or a setting means nothing in it.
        """
        self.document = document
        self.folder = CampaignFolder(folder.resolve())
        self._mission = load(_mission_file(document.mission, beside))
        for job in jobs(document.model_copy(update={"seeds": (0,)})):
            settings_of(self._mission, job.settings)

    @property
    def count(self) -> int:
        """How many runs are wanted."""
        return len(variants(self.document)) * len(self.document.all_seeds)

    def begin(self) -> None:
        """Make the folder.

        Raises:
            InputError: It holds a campaign already, or cannot be made.
        """
        self.folder.begin(self._plan())

    def resume(self) -> None:
        """Check that the folder holds this campaign.

        Raises:
            InputError: It holds none, or another one.
        """
        self.folder.plan()  # there is one at all
        with FileLock(self.folder.lock, f"the campaign {self.folder.folder}"):
            self.folder.resume(self._plan())

    def run(self, where: Where, *, again: bool = False) -> Generator[RunRecord, None, None]:
        """Run what has no result yet, keep each result, and yield it.

        Args:
            where: Who runs it.
            again: Whether runs whose process was lost are repeated.

        Raises:
            InputError: Another process runs this campaign, or a worker cannot run the mission.
        """
        with FileLock(self.folder.lock, f"the campaign {self.folder.folder}"):
            done = self.folder.finished(again=again)
            left = (job for job in jobs(self.document) if job.name not in done)
            with closing(Cluster(self._assignment(), where.workers, where.scheduler)) as cluster:
                for record in cluster.run(left):
                    self.folder.add(record)
                    yield record

    def _assignment(self) -> Assignment:
        limits, sources = self.document.limits, self._mission.sources
        return Assignment(
            mission=str(Path(sources[0].file).resolve()),
            sources={str(Path(one.file).resolve()): one.sha256 for one in sources},
            wall_s=limits.wall_s,
            memory_mb=limits.memory_mb,
            timeout_s=limits.timeout_s,
            keep=self.document.keep,
            folder=str(self.folder.folder),
            directory=str(Path.cwd()),
            path=os.environ.get(PATH_VARIABLE, ""),
        )

    def _plan(self) -> CampaignPlan:
        return CampaignPlan(
            document=self.document,
            mission=self._mission.name,
            sources=_sources(self._mission),
            versions=versions(),
            started_utc=datetime.now(UTC).isoformat(timespec="seconds"),
        )


def _mission_file(mission: str, beside: Path) -> str:
    """Return the file of a mission next to the document that names it, or the name itself."""
    for file in (beside / mission, beside / f"{mission}.yaml"):
        if file.is_file() and not _is_campaign(file):
            return str(file)
    return mission


def _is_campaign(file: Path) -> bool:
    """Return whether a file looks like a campaign, which may have the name of its mission."""
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    return any(line.startswith("campaign:") for line in lines)


def _sources(mission: Mission) -> tuple[SourceFile, ...]:
    return tuple(
        SourceFile(file=one.file, sha256=one.sha256, text=one.text) for one in mission.sources
    )
