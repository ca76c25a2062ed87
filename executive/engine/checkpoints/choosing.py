"""Which checkpoint of a recording a mission goes on from, or why there is none."""

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import ValidationError

from executive.core.errors import InputError, RecordingError
from executive.core.registry import closest
from executive.engine.checkpoints.messages import CHECKPOINTS_TOPIC, CheckpointMessage
from executive.engine.recording.messages import MissionHeader
from executive.engine.recording.reader import Recording
from executive.engine.running.runner import MissionOutcome

GATE = ".checkpoint"
"""What the path of a gate adds to that of the node that it stands around."""

_ANSWERED = (MissionOutcome.SUCCESS, MissionOutcome.FAILURE)


@dataclass(frozen=True, slots=True)
class CheckpointInfo:
    """One checkpoint of a recording.

    Attributes:
        message: All of it.
        path: Path of the node that was about to start.
    """

    message: CheckpointMessage
    path: str

    def __str__(self) -> str:
        """Return `PATH@TICK`, which names it."""
        return f"{self.path}@{self.message.progress.tick}"


def checkpoints(recording: Recording) -> tuple[CheckpointInfo, ...]:
    """Return the checkpoints that a recording holds completely, in order.

    Raises:
        RecordingError: One of them is none of this version's.
    """
    found = []
    for data in recording.messages(CHECKPOINTS_TOPIC):
        try:
            message = CheckpointMessage.model_validate_json(data)
            found.append(CheckpointInfo(message, _path(recording.header, message.node)))
        except (ValidationError, IndexError) as cause:
            raise RecordingError(
                f"{recording.path}: checkpoint {len(found)} cannot be read; got {cause}; "
                "expected what this version writes; try the version that recorded it: "
                f"{recording.header.versions.get('cellwright', 'unknown')}"
            ) from cause
    return tuple(found)


def chosen(recording: Recording, wanted: str = "") -> CheckpointInfo:
    """Return the checkpoint to go on from.

    Args:
        recording: What was recorded.
        wanted: `NODE@TICK`, `NODE` or `@TICK`, where a node may be named by the end of its
            path; the last usable one without it.

    Raises:
        InputError: There is none, none of that name, or it cannot be gone on from.
        RecordingError: The checkpoints cannot be read.
    """
    found = checkpoints(recording)
    if wanted:
        return _named(recording, found, wanted)
    _refuse_when_answered(recording, found)
    usable = [info for info in found if not info.message.refused]
    if usable:
        return usable[-1]
    if found:
        last = found[-1]
        raise InputError(
            f"{recording.path}: no checkpoint to go on from; got {len(found)} of them, the last "
            f"one {last}: {last.message.refused}"
        )
    raise InputError(f"{recording.path}: no checkpoint yet; {_why_none(recording)}")


def _refuse_when_answered(recording: Recording, found: Sequence[CheckpointInfo]) -> None:
    if recording.result is None or recording.result.report.outcome not in _ANSWERED:
        return
    report = recording.result.report
    back = f"; try --from {found[-1]} to go back there" if found else ""
    raise InputError(
        f"{recording.path}: the mission has ended with {report.outcome} after {report.ticks} "
        f"ticks, and there is nothing left to do{back}"
    )


def _named(recording: Recording, found: Sequence[CheckpointInfo], wanted: str) -> CheckpointInfo:
    name, _, tick = wanted.partition("@")
    matches = [
        info
        for info in found
        if (not name or f"/{info.path}".endswith(f"/{name}"))
        and (not tick or str(info.message.progress.tick) == tick)
    ]
    if not matches:
        known = [str(info) for info in found]
        raise InputError(f"{recording.path}: no checkpoint {wanted!r}; {closest(wanted, known)}")
    if matches[-1].message.refused:
        raise InputError(
            f"{recording.path}: {matches[-1]} cannot be gone on from: {matches[-1].message.refused}"
        )
    return matches[-1]


def _why_none(recording: Recording) -> str:
    marked = [node for node in recording.header.nodes if node.kind == "checkpoint"]
    if not marked:
        return "no node of this mission says 'checkpoint: true'; start it anew"
    first = marked[0]
    return (
        f"the run was over before {first.path.removesuffix(GATE)} ({first.file}:{first.line}) "
        "had started; start it anew"
    )


def _path(header: MissionHeader, node: int) -> str:
    return header.nodes[node].path.removesuffix(GATE)
