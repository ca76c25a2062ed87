"""`cellwright run`: run a mission, record it, and say what it came to."""

import traceback
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from pydantic import JsonValue
from rich.console import Console
from rich.text import Text

from executive.cli.console import chatter, print_error, results, stdout_kept_for_the_result
from executive.cli.run_display import RunDisplay
from executive.cli.settings import apply_settings
from executive.core.errors import CellwrightError, InputError
from executive.engine.control import EmergencyStopped, RunControl, stopped_by_signals
from executive.engine.loader import load_mission
from executive.engine.recording.messages import RunReport, SlowNode
from executive.engine.runner import MissionOutcome, one_line
from executive.inspector.views import OUTCOME_STYLES

if TYPE_CHECKING:
    from executive.app.views import LiveView

_BAD_INPUT, _ERROR = 2, MissionOutcome.ERROR.exit_code
_SLOW_SHOWN = 3


@dataclass(frozen=True, slots=True)
class _Request:
    """What the user asked for."""

    mission: str
    seed: int
    assignments: tuple[str, ...]
    record: Path | None
    timeout_s: float | None
    view: bool
    html: Path | None


@dataclass(frozen=True, slots=True)
class _Result:
    """What it came to: the report, nodes that were too slow, and what was raised on the way."""

    report: RunReport
    slow: tuple[SlowNode, ...] = ()
    raised: tuple[str, ...] = ()


def run(
    mission: Annotated[str, typer.Argument(help="Name of a mission, or its YAML file.")],
    seed: Annotated[int, typer.Option(min=0, help="Seed of everything random.")] = 0,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set an input or a part of the scenario."),
    ] = None,
    record: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="Recording; runs/TIME_MISSION_SEED.mcap by default."),
    ] = None,
    timeout: Annotated[
        float | None, typer.Option(min=0.0, help="Limit on the cell's clock, in seconds.")
    ] = None,
    view: Annotated[bool, typer.Option("--view", help="Show the cell live in a browser.")] = False,
    html: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="Write a replay of the cell as one HTML file."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document on stdout.")
    ] = False,
) -> None:
    """Run a mission and record it.

    Exit codes: 0 success, 1 mission failed, 2 bad input, 3 error, 4 stopped by the user.

    Ctrl-C stops the mission in order; a second one stops the arms at once. Ctrl-Z pauses the
    mission; a second one lets it go on.
    """
    request = _Request(mission, seed, tuple(assignments or ()), record, timeout, view, html)
    with stdout_kept_for_the_result():
        result, exit_code = _reported(request, chatter())
    report = result.report
    if as_json:
        typer.echo(report.model_dump_json(exclude={"truth"} if report.truth is None else None))
    else:
        _print_summary(result)
    raise typer.Exit(exit_code)


def _reported(request: _Request, console: Console) -> tuple[_Result, int]:
    """Run what is asked for; whatever goes wrong becomes a report and an exit code."""
    control = RunControl()
    try:
        with stopped_by_signals(control):
            result = _recorded_run(request, control, console)
    except InputError as error:
        print_error(console, str(error))
        return _no_run(request, "error", str(error)), _BAD_INPUT
    except (EmergencyStopped, KeyboardInterrupt):
        reason = f"stopped by {control.stop_reason} before the first tick"
        return _no_run(request, "aborted", reason), MissionOutcome.ABORTED.exit_code
    except Exception as error:  # the last place that can say what happened
        _print_unexpected(console, error)
        return _no_run(request, "error", one_line(error)), _ERROR
    written = _write_html(request, result.report, console)
    return result, MissionOutcome(result.report.outcome).exit_code if written else _ERROR


def _recorded_run(request: _Request, control: RunControl, console: Console) -> _Result:
    from executive.app.catalogue import port_types, skills

    mission = load_mission(request.mission, skills=skills(), types=port_types())
    settings = apply_settings(
        request.assignments, tuple(mission.document.in_), mission.document.scenario
    )
    # Only now, with the input in order, is it worth loading simulators and planners.
    from executive.app.compose import open_cell
    from executive.engine.builder import build
    from executive.engine.mission_run import (
        RunPlan,
        default_recording,
        recorded_nodes,
        run_mission,
    )

    plan = RunPlan(
        mission=mission,
        seed=request.seed,
        inputs=settings.inputs,
        scenario=settings.scenario,
        timeout_s=mission.document.timeout_s if request.timeout_s is None else request.timeout_s,
        recording=request.record or default_recording(mission.document.name, request.seed),
    )
    with ExitStack() as stack:
        with control.interruptible(), console.status(f"opening {mission.document.cell}"):
            cell = open_cell(mission.cell, settings.scenario, request.seed)
        stack.enter_context(closing(cell))
        tree = build(
            mission,
            devices=cell.devices,
            clock=cell.clock,
            inputs=settings.inputs,
            seed=request.seed,
        )
        live = [stack.enter_context(closing(_live_view(console)))] if request.view else []
        with RunDisplay(console, recorded_nodes(tree.nodes)) as display:
            done = run_mission(plan, tree, cell, control, (display, *live))
    return _Result(done.report, done.slow, done.raised)


def _live_view(console: Console) -> "LiveView":
    from executive.app.views import open_live_view

    view = open_live_view()
    console.print(f"live view: {view.url}")
    return view


def _write_html(request: _Request, report: RunReport, console: Console) -> bool:
    """Write the replay if it is asked for; return whether nothing went wrong."""
    if request.html is None or report.recording is None:
        return True
    try:
        from executive.app.views import write_html

        request.html.parent.mkdir(parents=True, exist_ok=True)
        write_html(Path(report.recording), request.html)
    except Exception as error:  # the run itself is over and recorded: its report is still wanted
        _print_unexpected(console, error)
        return False
    console.print(f"replay: {request.html}")
    return True


def _no_run(request: _Request, outcome: Literal["aborted", "error"], reason: str) -> _Result:
    """Return the report of a mission that did not begin."""
    report = RunReport(
        mission=request.mission,
        seed=request.seed,
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
        ("took", Text(took)),
        *(("slow", Text(_too_slow(node))) for node in result.slow[:_SLOW_SHOWN]),
        *(("raised", Text(line)) for line in result.raised),
        ("recorded", Text(report.recording or "")),
        ("open it", Text(f"cellwright inspect {report.recording}" if report.recording else "")),
    ]
    console = results()
    for name, text in lines:
        if text:
            console.print(Text.assemble((f"{name:<10}", "bright_black"), text), soft_wrap=True)


def _too_slow(node: SlowNode) -> str:
    times = "once" if node.times == 1 else f"{node.times} times"
    return f"{node.path}: {times} over {node.budget_s:.3g} s a step, at worst {node.worst_s:.2f} s"


def _words(value: JsonValue) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name}: {item}" for name, item in value.items())
    return "" if value is None else str(value)
