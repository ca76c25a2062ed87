"""What `run` and `resume` share: a mission is run, recorded and reported, whatever happens."""

import traceback
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn, TypeVar

import typer
from pydantic import JsonValue
from rich.console import Console
from rich.text import Text

from executive.cli.console import chatter, print_error, results, stdout_kept_for_the_result
from executive.cli.run_display import RunDisplay
from executive.core.errors import CellwrightError, InputError
from executive.core.world import Cell
from executive.engine.recording.messages import InjectedReport, RunReport, SlowNode
from executive.engine.running.control import EmergencyStopped, RunControl, stopped_by_signals
from executive.engine.running.runner import MissionOutcome, one_line
from executive.engine.ticks import RunObserver
from executive.inspector.injected import injected_line
from executive.inspector.views import OUTCOME_STYLES

if TYPE_CHECKING:
    from executive.app.views import LiveView
    from executive.engine.debugging.debugger import Debugger
    from executive.engine.nodes.builder import BuiltTree
    from executive.engine.running.mission_run import RunPlan

_BAD_INPUT, _ERROR = 2, MissionOutcome.ERROR.exit_code
_SLOW_SHOWN = 3
T = TypeVar("T")

RecordOption = Annotated[
    Path | None,
    typer.Option(dir_okay=False, help="Recording; runs/TIME_MISSION_SEED.mcap by default."),
]
OverwriteOption = Annotated[
    bool, typer.Option("--overwrite", help="Replace a recording that is there already.")
]
TimeoutOption = Annotated[
    float | None, typer.Option(min=0.0, help="Limit on the cell's clock, in seconds.")
]
SpeedOption = Annotated[
    float | None,
    typer.Option(
        min=0.05, help="At most so many times as fast as real time; 1 to watch a simulation."
    ),
]
ViewOption = Annotated[bool, typer.Option("--view", help="Show the cell live in a browser.")]
HtmlOption = Annotated[
    Path | None,
    typer.Option(dir_okay=False, help="Write a replay of the cell as one HTML file."),
]
BreakOption = Annotated[
    list[str] | None,
    typer.Option(
        "--break",
        metavar="BREAKPOINT",
        help="Pause there: 'dilate_knot when size(knots) > 1', 'on failure', 'on write trace'.",
    ),
]
BreaksOption = Annotated[
    Path | None,
    typer.Option("--breaks", dir_okay=False, exists=True, help="File of breakpoints, one a line."),
]
PausedOption = Annotated[
    bool, typer.Option("--paused", help="Pause before the first tick; see cellwright attach.")
]
InjectOption = Annotated[
    list[str] | None,
    typer.Option(
        "--inject",
        metavar="FAULT",
        help="Inject it: 'grasp_*: fail@3', 'trace: hang', 'key frame: stale@2'.",
    ),
]
FaultsOption = Annotated[
    Path | None,
    typer.Option("--faults", dir_okay=False, exists=True, help="File of faults, one a line."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]


@dataclass(frozen=True, slots=True)
class Subject:
    """What is run, as far as the user has named it, and what is wanted beside the recording."""

    mission: str
    seed: int
    view: bool
    html: Path | None
    debugging: "Debugging"
    speed: float | None = None


@dataclass(frozen=True, slots=True)
class Debugging:
    """Where a mission is to pause: breakpoints as text, a file of them, before the first tick."""

    breakpoints: tuple[str, ...] = ()
    file: Path | None = None
    paused: bool = False


@dataclass(frozen=True, slots=True)
class Prepared:
    """A mission that can be run: its plan, its tree, and the cell that the tree is bound to."""

    plan: "RunPlan"
    tree: "BuiltTree"
    cell: Cell


Prepare = Callable[[RunControl, Console, ExitStack], Prepared]
"""Prepares a mission; what has to be closed after it goes on the stack."""


@dataclass(frozen=True, slots=True)
class _Result:
    """What it came to: the report, slow nodes, what was raised on the way, what was injected."""

    report: RunReport
    slow: tuple[SlowNode, ...] = ()
    raised: tuple[str, ...] = ()
    injected: tuple[InjectedReport, ...] = ()


def run_and_exit(subject: Subject, prepare: Prepare, *, as_json: bool) -> NoReturn:
    """Run what is prepared, print what it came to, and leave with its exit code."""
    with stdout_kept_for_the_result():
        result, exit_code = _reported(subject, prepare, chatter())
    report = result.report
    if as_json:
        typer.echo(report.model_dump_json(exclude={"truth"} if report.truth is None else None))
    elif report.ticks or report.recording or report.outcome != "error":
        _print_summary(result)  # of what did not even begin, the error has said all
    raise typer.Exit(exit_code)


def _reported(subject: Subject, prepare: Prepare, console: Console) -> tuple[_Result, int]:
    """Run what is asked for; whatever goes wrong becomes a report and an exit code."""
    control = RunControl()
    try:
        with stopped_by_signals(control):
            result = _recorded_run(subject, prepare, control, console)
    except InputError as error:
        print_error(console, str(error))
        return _no_run(subject, "error", str(error)), _BAD_INPUT
    except (EmergencyStopped, KeyboardInterrupt):
        reason = f"stopped by {control.stop_reason} before the first tick"
        return _no_run(subject, "aborted", reason), MissionOutcome.ABORTED.exit_code
    except Exception as error:  # the last place that can say what happened
        _print_unexpected(console, error)
        return _no_run(subject, "error", one_line(error)), _ERROR
    written = _write_html(subject, result.report, console)
    return result, MissionOutcome(result.report.outcome).exit_code if written else _ERROR


def _recorded_run(
    subject: Subject, prepare: Prepare, control: RunControl, console: Console
) -> _Result:
    with ExitStack() as stack:
        prepared = prepare(control, console, stack)
        # Only now, with the input in order, is it worth loading what a run needs.
        from executive.engine.running.mission_run import recorded_nodes, run_mission
        from executive.engine.running.pace import Pace

        tree, debugger = prepared.tree, _debugger(subject.debugging, prepared.tree, control)
        world = prepared.plan.mission.cell.world
        live = [stack.enter_context(closing(_live_view(world, console)))] if subject.view else []
        with RunDisplay(console, recorded_nodes(tree.nodes)) as display:
            pace = [Pace(subject.speed)] if subject.speed is not None else []
            observers: tuple[RunObserver, ...] = (display, *live, *pace)
            done = run_mission(prepared.plan, tree, prepared.cell, control, observers, debugger)
    return _Result(done.report, done.slow, done.raised, done.injected)


def _debugger(debugging: Debugging, tree: "BuiltTree", control: RunControl) -> "Debugger":
    from executive.engine.debugging.breakpoints import parse_breakpoint_file
    from executive.engine.debugging.debugger import Debugger

    debugger = Debugger(tree, control)
    for text in debugging.breakpoints:
        debugger.add(text)
    if debugging.file is not None:
        for one in read_lines(debugging.file, parse_breakpoint_file):
            debugger.add(one.text)
    if debugging.paused:
        control.pause("--paused")
    return debugger


def require_free(record: Path | None, *, overwrite: bool) -> None:
    """Refuse to write over an earlier recording, unless that is asked for.

    Raises:
        InputError: There is one.
    """
    if record is not None and record.exists() and not overwrite:
        raise InputError(
            f"--record {record}: is there already, and nobody can record its run again; "
            "try another name, or --overwrite"
        )


def read_lines(file: Path, parse: Callable[[str], list[T]]) -> list[T]:
    """Read a file of breakpoints or faults.

    Raises:
        InputError: It is none; says which file.
    """
    try:
        return parse(file.read_text(encoding="utf-8"))
    except (InputError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: {error}") from None


def _live_view(world: str, console: Console) -> "LiveView":
    from executive.app.views import open_live_view

    view = open_live_view(world)
    console.print(f"live view: {view.url}")
    return view


def _write_html(subject: Subject, report: RunReport, console: Console) -> bool:
    """Write the replay if it is asked for; return whether nothing went wrong."""
    if subject.html is None or report.recording is None:
        return True
    try:
        from executive.app.views import write_html

        subject.html.parent.mkdir(parents=True, exist_ok=True)
        write_html(Path(report.recording), subject.html)
    except Exception as error:  # the run itself is over and recorded: its report is still wanted
        _print_unexpected(console, error)
        return False
    console.print(f"replay: {subject.html}")
    return True


def _no_run(subject: Subject, outcome: Literal["aborted", "error"], reason: str) -> _Result:
    """Return the report of a mission that did not begin."""
    report = RunReport(
        mission=subject.mission,
        seed=subject.seed,
        outcome=outcome,
        reason=reason,
        claim=None,
        sim_s=0.0,
        wall_s=0.0,
        ticks=0,
        actions=(),
        recording=None,
    )
    return _Result(report)


def _print_unexpected(console: Console, error: Exception) -> None:
    """Print an error; one that is not ours is a bug, and its traceback tells where."""
    print_error(console, one_line(error))
    if not isinstance(error, CellwrightError):
        console.print(Text("".join(traceback.format_exception(error)), "bright_black"))


def _print_summary(result: _Result) -> None:
    report = result.report
    took = (
        f"{report.sim_s:.1f} s on the cell's clock, {report.wall_s:.1f} s here, "
        f"{report.ticks} ticks, {len(report.actions)} actions"
    )
    lines = [
        (report.mission, Text(report.outcome, OUTCOME_STYLES[report.outcome])),
        ("because", Text(report.reason)),
        ("claim", Text(_words(report.claim))),
        ("truth", Text(_words(report.truth))),
        ("took", Text(took if report.recording else "")),
        *(("slow", Text(_too_slow(node))) for node in result.slow[:_SLOW_SHOWN]),
        *(("raised", Text(line)) for line in result.raised),
        *(("injected", Text(injected_line(one))) for one in result.injected),
        ("recorded", Text(report.recording or "")),
        ("open it", Text(f"cellwright inspect {report.recording}" if report.recording else "")),
    ]
    console = results()
    width = max(9, len(report.mission)) + 1
    for name, text in lines:
        if text:
            console.print(Text.assemble((f"{name:<{width}}", "bright_black"), text), soft_wrap=True)


def _too_slow(node: SlowNode) -> str:
    times = "once" if node.times == 1 else f"{node.times} times"
    return f"{node.path}: {times} over {node.budget_s:.3g} s a step, at worst {node.worst_s:.2f} s"


def _words(value: JsonValue) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name}: {item}" for name, item in value.items())
    return "" if value is None else str(value)
