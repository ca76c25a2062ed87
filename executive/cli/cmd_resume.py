"""`cellwright resume`: go on with a mission that was killed or stopped, from its recording."""

import json
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from executive.cli.console import chatter, results
from executive.cli.recordings import recording_argument
from executive.cli.reported_run import (
    Debugging,
    HtmlOption,
    JsonOption,
    OverwriteOption,
    Prepared,
    RecordOption,
    SpeedOption,
    Subject,
    TimeoutOption,
    ViewOption,
    require_free,
    run_and_exit,
)
from executive.core.errors import InputError, recording_named_by_the_user
from executive.engine.checkpoints.choosing import CheckpointInfo, checkpoints, chosen
from executive.engine.recording.reader import Recording
from executive.engine.running.control import RunControl


@dataclass(frozen=True, slots=True)
class _Request:
    """What the user asked for."""

    wanted: str
    record: Path | None
    overwrite: bool
    timeout_s: float | None
    anyway: bool
    as_it_stands: bool


def resume(
    recording: Annotated[Path, recording_argument("RUN", "Recording of the mission")],
    wanted: Annotated[
        str,
        typer.Option(
            "--from", metavar="NODE@TICK", help="An earlier checkpoint; the last one otherwise."
        ),
    ] = "",
    listed: Annotated[
        bool, typer.Option("--list", help="Show the checkpoints, and run nothing.")
    ] = False,
    anyway: Annotated[
        bool,
        typer.Option(
            "--anyway", help="Also with changed files of the same nodes, and with values lost."
        ),
    ] = False,
    as_it_stands: Annotated[
        bool,
        typer.Option(
            "--as-it-stands", help="The cell is safe as it is: nothing is held, nothing moves."
        ),
    ] = False,
    record: RecordOption = None,
    overwrite: OverwriteOption = False,
    timeout: TimeoutOption = None,
    speed: SpeedOption = None,
    view: ViewOption = False,
    html: HtmlOption = None,
    as_json: JsonOption = False,
) -> None:
    """Go on with a mission that was killed, from the last checkpoint in its recording.

    Exit codes: those of `run`; 2 when it cannot be gone on with, and the message says why.

    The new recording begins with a copy of the old one, which stays as it is.
    """
    earlier = _opened(recording)
    if listed:
        _print_checkpoints(checkpoints(earlier), as_json=as_json)
        return
    request = _Request(wanted, record, overwrite, timeout, anyway, as_it_stands)

    def prepare(control: RunControl, console: Console, stack: ExitStack) -> Prepared:
        return _prepared(earlier, request, control, console, stack)

    subject = Subject(earlier.header.mission, earlier.header.seed, view, html, Debugging(), speed)
    run_and_exit(subject, prepare, as_json=as_json)


def _opened(recording: Path) -> Recording:
    with recording_named_by_the_user():
        return Recording.open(recording)


def _prepared(
    earlier: Recording,
    request: _Request,
    control: RunControl,
    console: Console,
    stack: ExitStack,
) -> Prepared:
    info = chosen(earlier, request.wanted)
    _require_another_file(request.record, earlier.path)
    require_free(request.record, overwrite=request.overwrite)
    from executive.app.catalogue import port_types, skills
    from executive.engine.checkpoints.resuming import Consent, recorded_mission, take_up

    header, types = earlier.header, port_types()
    consent = Consent(request.anyway, request.as_it_stands)
    mission, notes = recorded_mission(header, consent, skills=skills(), types=types)
    # Only now, with the input in order, is it worth loading simulators and planners.
    from executive.app.cell_locks import running
    from executive.app.compose import open_cell
    from executive.engine.running.mission_run import RunPlan, default_recording

    stack.enter_context(running(mission))
    with control.interruptible(), console.status(f"opening {mission.document.cell}"):
        cell = open_cell(mission.cell, header.scenario, header.seed)
    stack.enter_context(closing(cell))
    classes = [types.get(name) for name in types]
    taken_up = take_up(info, earlier, mission, cell, consent, classes=classes)
    _say_where(info, (*notes, *taken_up.notes))
    plan = RunPlan(
        mission=mission,
        seed=header.seed,
        inputs=header.inputs,
        scenario=header.scenario,
        timeout_s=header.timeout_s if request.timeout_s is None else request.timeout_s,
        recording=request.record or default_recording(header.mission, header.seed),
        resumption=taken_up.resumption,
    )
    return Prepared(plan, taken_up.tree, taken_up.cell)


def _require_another_file(record: Path | None, earlier: Path) -> None:
    if record is not None and record.resolve() == earlier.resolve():
        raise InputError(
            f"--record {record}: is the recording to go on from; got the same file; expected "
            "another one; try no --record"
        )


def _say_where(info: CheckpointInfo, notes: tuple[str, ...]) -> None:
    console, progress = chatter(), info.message.progress
    where = f"goes on at {info.path}, tick {progress.tick}, {progress.time_s:.1f} s"
    console.print(Text(where), soft_wrap=True)
    for note in notes:
        console.print(Text(f"note: {note}", "yellow"), soft_wrap=True)


def _print_checkpoints(found: tuple[CheckpointInfo, ...], *, as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps([_document(info) for info in found]))
        return
    console = results()
    for info in found:
        progress, refused = info.message.progress, info.message.refused
        line = f"{progress.tick:6d} {progress.time_s:9.2f} s  {info}"
        console.print(
            Text.assemble(line, (f"  cannot be gone on from: {refused}" if refused else "", "red")),
            soft_wrap=True,
        )
    if not found:
        console.print("no checkpoint")


def _document(info: CheckpointInfo) -> dict[str, object]:
    progress = info.message.progress
    return {
        "name": str(info),
        "node": info.path,
        "tick": progress.tick,
        "time_s": progress.time_s,
        "refused": info.message.refused,
    }
