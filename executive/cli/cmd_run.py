"""`cellwright run`: run a mission, record it, and say what it came to."""

from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from executive.cli.reported_run import (
    BreakOption,
    BreaksOption,
    Debugging,
    FaultsOption,
    HtmlOption,
    InjectOption,
    JsonOption,
    OverwriteOption,
    PausedOption,
    Prepared,
    RecordOption,
    SpeedOption,
    Subject,
    TimeoutOption,
    ViewOption,
    read_lines,
    require_free,
    run_and_exit,
)
from executive.cli.settings import apply_settings
from executive.engine.loading.loader import load_mission
from executive.engine.running.control import RunControl

if TYPE_CHECKING:
    from executive.engine.faults.grammar import Injection


@dataclass(frozen=True, slots=True)
class _Request:
    """What the user asked for."""

    mission: str
    seed: int
    assignments: tuple[str, ...]
    record: Path | None
    overwrite: bool
    timeout_s: float | None
    inject: tuple[str, ...]
    faults: Path | None


def run(
    mission: Annotated[str, typer.Argument(help="Name of a mission, or its YAML file.")],
    seed: Annotated[int, typer.Option(min=0, help="Seed of everything random.")] = 0,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set an input or a part of the scenario."),
    ] = None,
    record: RecordOption = None,
    overwrite: OverwriteOption = False,
    timeout: TimeoutOption = None,
    speed: SpeedOption = None,
    view: ViewOption = False,
    html: HtmlOption = None,
    breakpoints: BreakOption = None,
    breaks: BreaksOption = None,
    paused: PausedOption = False,
    inject: InjectOption = None,
    faults: FaultsOption = None,
    as_json: JsonOption = False,
) -> None:
    """Run a mission and record it.

    Exit codes: 0 success, 1 mission failed, 2 bad input, 3 error, 4 stopped by the user.

    Ctrl-C stops the mission in order; a second one stops the arms at once. Ctrl-Z pauses the
    mission; a second one lets it go on. One that was killed is taken up by `cellwright resume`.
    """
    request = _Request(
        mission=mission,
        seed=seed,
        assignments=tuple(assignments or ()),
        record=record,
        overwrite=overwrite,
        timeout_s=timeout,
        inject=tuple(inject or ()),
        faults=faults,
    )

    def prepare(control: RunControl, console: Console, stack: ExitStack) -> Prepared:
        return _prepared(request, control, console, stack)

    debugging = Debugging(tuple(breakpoints or ()), breaks, paused)
    run_and_exit(Subject(mission, seed, view, html, debugging, speed), prepare, as_json=as_json)


def _prepared(
    request: _Request, control: RunControl, console: Console, stack: ExitStack
) -> Prepared:
    from executive.app.catalogue import port_types, skills

    mission = load_mission(request.mission, skills=skills(), types=port_types())
    settings = apply_settings(
        request.assignments, tuple(mission.document.in_), mission.document.scenario
    )
    injections = _injections(request)
    require_free(request.record, overwrite=request.overwrite)
    # Only now, with the input in order, is it worth loading simulators and planners.
    from executive.app.cell_locks import running
    from executive.app.compose import open_cell
    from executive.engine.nodes.builder import build
    from executive.engine.running.mission_run import RunPlan, default_recording

    plan = RunPlan(
        mission=mission,
        seed=request.seed,
        inputs=settings.inputs,
        scenario=settings.scenario,
        timeout_s=mission.document.timeout_s if request.timeout_s is None else request.timeout_s,
        recording=request.record or default_recording(mission.document.name, request.seed),
        faults=injections,
    )
    stack.enter_context(running(mission))
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
    return Prepared(plan, tree, cell)


def _injections(request: _Request) -> "tuple[Injection, ...]":
    from executive.engine.faults.grammar import parse_injection, parse_injection_file

    found = [parse_injection(text) for text in request.inject]
    if request.faults is not None:
        found += read_lines(request.faults, parse_injection_file)
    return tuple(found)
