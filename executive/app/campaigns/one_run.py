"""One run of a campaign in this process: the mission on a cell of its own, recorded."""

import traceback
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path

from pydantic import JsonValue

from executive.app.campaigns.jobs import Assignment, Ending, Job, RunRecord
from executive.app.missions import settings_of
from executive.core.errors import InputError
from executive.engine.loading.loader import Mission
from executive.engine.running.control import RunControl, stopped_by_signals

RECORDINGS = "recordings"


def run_job(mission: Mission, assignment: Assignment, job: Job) -> RunRecord:
    """Run a mission to its end, keep or remove its recording, and say what it came to.

    Whatever goes wrong is an outcome of the run.
    """
    recording = Path(assignment.folder) / RECORDINGS / f"{job.name}.mcap"
    control = RunControl()
    try:
        with stopped_by_signals(control):
            record = _run(mission, assignment, job, recording, control)
    except InputError as error:
        return _of(job, "error", str(error), recording)
    except BaseException as error:  # the last place that can say what happened
        last = "".join(traceback.format_exception(error)[-2:])
        return _of(job, "error", " ".join(last.split()), recording)
    if assignment.keep == "none" or (assignment.keep == "failed" and record.outcome == "success"):
        for part in parts(recording):
            part.unlink(missing_ok=True)
        return record.model_copy(update={"recording": ""})
    return record


def parts(recording: Path) -> list[Path]:
    """Return the files of a recording that are there."""
    from executive.engine.recording.parts import parts_of

    return [part for part in parts_of(recording) if part.exists()]


def _run(
    mission: Mission, assignment: Assignment, job: Job, recording: Path, control: RunControl
) -> RunRecord:
    from executive.app.compose import open_cell
    from executive.engine.nodes.builder import build
    from executive.engine.running.mission_run import RunPlan, run_mission

    settings, document = settings_of(mission, job.settings), mission.document
    timeout_s = document.timeout_s if assignment.timeout_s is None else assignment.timeout_s
    plan = RunPlan(mission, job.seed, settings.inputs, settings.scenario, timeout_s, recording)
    with closing(open_cell(mission.cell, settings.scenario, job.seed)) as cell:
        tree = build(
            mission,
            devices=cell.devices,
            clock=cell.clock,
            inputs=settings.inputs,
            seed=job.seed,
        )
        report = run_mission(plan, tree, cell, control).report
    return _of(job, report.outcome, report.reason, recording).model_copy(
        update={
            "sim_s": report.sim_s,
            "wall_s": report.wall_s,
            "ticks": report.ticks,
            "actions": len(report.actions),
            "claim": report.claim,
            "truth": report.truth,
            "measures": {**_leaves("claim", report.claim), **_leaves("truth", report.truth)},
        }
    )


def _of(job: Job, outcome: Ending, reason: str, recording: Path) -> RunRecord:
    return RunRecord(
        **job.model_dump(),
        outcome=outcome,
        reason=reason,
        recording=f"{RECORDINGS}/{recording.name}" if recording.exists() else "",
    )


def lost(job: Job, outcome: Ending, reason: str, assignment: Assignment) -> RunRecord:
    """Return the record of a run whose process was lost."""
    return _of(job, outcome, reason, Path(assignment.folder) / RECORDINGS / f"{job.name}.mcap")


def _leaves(name: str, value: JsonValue) -> dict[str, float | bool]:
    return dict(_numbers((name,), value))


def _numbers(path: Sequence[str], value: JsonValue) -> Iterator[tuple[str, float | bool]]:
    """Yield the numbers and truth values in a JSON value; lists are not gone into."""
    if isinstance(value, bool | int | float):
        yield ".".join(path), value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _numbers((*path, key), item)
