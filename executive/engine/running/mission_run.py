"""One recorded run of a mission on a cell: from the built tree to the report."""

import dataclasses
import itertools
import platform
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from pydantic import JsonValue
from pydantic_core import to_jsonable_python

from executive.core.world import Cell
from executive.engine.checkpoints.messages import CHECKPOINTS_TOPIC
from executive.engine.checkpoints.past import Resumption
from executive.engine.checkpoints.taking import CheckpointRecorder
from executive.engine.debugging.commands import RunCommands
from executive.engine.debugging.debugger import Debugger
from executive.engine.faults.grammar import Injection
from executive.engine.faults.injector import Injector
from executive.engine.loading.loader import Mission
from executive.engine.nodes.builder import BuiltTree, NodeInfo
from executive.engine.recording.actions import ActionLog
from executive.engine.recording.messages import (
    MissionHeader,
    RecordedNode,
    ResultMessage,
    RunReport,
    SourceFile,
)
from executive.engine.recording.slow import SlowLog
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.control import RunControl
from executive.engine.running.remote import CommandServer
from executive.engine.running.runner import Runner, one_line
from executive.engine.ticks import RunObserver

CLAIM = "claim"
"""Output of a mission that says what it believes to have reached."""

# Everything whose version can change how a run goes.
_PACKAGES = (
    *("cellwright", "mcap", "numba", "numpy", "opencv-python-headless", "pin", "py_trees"),
    *("pybullet", "pydantic", "ruckig", "scipy"),
)


@dataclasses.dataclass(frozen=True, slots=True)
class RunPlan:
    """What is run, and with what.

    Attributes:
        mission: The mission.
        seed: Seed of everything random.
        inputs: Values of the mission's inputs.
        scenario: What is set up in the cell.
        timeout_s: Longest duration on the cell's clock [s]; None for no limit.
        recording: Where the recording goes.
        resumption: The checkpoint that it goes on from; None where it begins.
        faults: What is injected.
    """

    mission: Mission
    seed: int
    inputs: Mapping[str, object]
    scenario: Mapping[str, object]
    timeout_s: float | None
    recording: Path
    resumption: Resumption | None = None
    faults: tuple[Injection, ...] = ()


def run_mission(
    plan: RunPlan,
    tree: BuiltTree,
    cell: Cell,
    control: RunControl,
    observers: Sequence[RunObserver] = (),
    debugger: Debugger | None = None,
) -> ResultMessage:
    """Run a mission to its end, record it, and score it where the cell knows the truth.

    A claim or a truth that cannot be had costs neither the recording nor the rest of the report.

    Args:
        plan: What is run, and with what.
        tree: The mission's tree, bound to the cell; it has not been ticked.
        cell: The cell; it stays open.
        control: How to pause and stop the run.
        observers: Who else is told of every tick.
        debugger: Who may pause it anywhere; its run can be commanded from outside.

    Raises:
        InputError: A fault that is to be injected means nothing in this mission.
        RecordingError: The recording cannot be written.
    """
    injector = Injector(tree, plan.mission, plan.faults, seed=plan.seed)
    header = mission_header(plan, tree.nodes)
    with RecordingWriter(plan.recording, header) as writer:
        actions, slow = ActionLog(header.nodes), SlowLog(header.nodes)
        if plan.resumption is not None:
            _repeat(plan.resumption, writer, (actions, slow))
        runner = Runner(
            tree,
            cell,
            tick_hz=header.tick_hz,
            timeout_s=plan.timeout_s,
            observers=(writer, actions, slow, injector, *observers),
            control=control,
            debugger=debugger,
            interceptors=(injector.intercept,) if plan.faults else (),
            interventions=(injector.interventions,),
            past=plan.resumption.past if plan.resumption else None,
        )
        CheckpointRecorder(tree, cell, runner, writer, first=_next_checkpoint(plan.resumption))
        with commanded(plan.recording, control, debugger):
            result = runner.run()
        raised = [one_line(error) for error in result.survived]
        report = RunReport(
            mission=header.mission,
            seed=plan.seed,
            outcome=result.outcome.value,
            reason=result.reason,
            claim=_asked(CLAIM, lambda: tree.outputs().get(CLAIM), raised),
            truth=_asked("truth", cell.truth, raised),
            sim_s=result.sim_s,
            wall_s=result.wall_s,
            ticks=result.ticks,
            actions=actions.reports(),
            recording=str(plan.recording),
        )
        message = ResultMessage(
            report=report,
            rate=result.rate,
            slow=slow.reports(),
            raised=tuple(raised),
            injected=injector.reports(),
        )
        writer.write_result(message)
    return message


@contextmanager
def commanded(recording: Path, control: RunControl, debugger: Debugger | None) -> Iterator[None]:
    """Take commands from other processes while the block lasts, where there is a debugger."""
    if debugger is None:
        yield
        return
    with CommandServer(recording, RunCommands(control, debugger).by_name()):
        yield


def _repeat(
    resumption: Resumption, writer: RecordingWriter, observers: Sequence[RunObserver]
) -> None:
    """Take over what an earlier run has recorded up to the checkpoint."""
    origin = resumption.origin
    writer.carry_over(resumption.earlier, CHECKPOINTS_TOPIC, origin.checkpoint)
    for number in range(origin.tick):
        for observer in observers:
            observer.on_tick(resumption.earlier.tick(number))


def _next_checkpoint(resumption: Resumption | None) -> int:
    return 0 if resumption is None else resumption.origin.checkpoint + 1


def _asked(what: str, ask: Callable[[], object], raised: list[str]) -> JsonValue:
    """Return an answer as JSON; where asking raises, None, with a line in `raised`."""
    try:
        return as_json(ask())
    except Exception as error:  # the run is over: what it came to is wanted all the same
        raised.append(f"{what}: {one_line(error)}")
        return None


def mission_header(plan: RunPlan, nodes: Sequence[NodeInfo]) -> MissionHeader:
    """Return the first message of a recording."""
    document = plan.mission.document
    return MissionHeader(
        format=1,
        mission=document.name,
        about=document.about,
        seed=plan.seed,
        tick_hz=document.tick_hz,
        timeout_s=plan.timeout_s,
        inputs={name: as_json(value) for name, value in plan.inputs.items()},
        scenario={name: as_json(value) for name, value in plan.scenario.items()},
        cell=plan.mission.cell.model_dump(mode="json"),
        sources=tuple(
            SourceFile(file=source.file, sha256=source.sha256, text=source.text)
            for source in plan.mission.sources
        ),
        nodes=recorded_nodes(nodes),
        versions=versions(),
        started_utc=datetime.now(UTC).isoformat(timespec="seconds"),
        resumed_from=plan.resumption.origin if plan.resumption else None,
        faults=tuple(fault.text for fault in plan.faults),
    )


def default_recording(mission: str, seed: int) -> Path:
    """Return a file in `runs/` that is not there yet and says when, what and with which seed."""
    name = f"{datetime.now(UTC).strftime('%Y%m%dT%H%M%SZ')}_{mission}_{seed}"
    names = itertools.chain([name], (f"{name}_{number}" for number in itertools.count(2)))
    paths = (Path("runs") / f"{one}.mcap" for one in names)
    return next(path for path in paths if not path.exists())


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that a run depends on."""
    found = {"python": platform.python_version(), "platform": sys.platform}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:  # e.g. a cell without a simulator
            continue
    return found


def as_json(value: object) -> JsonValue:
    """Return a value as plain JSON, without the types of its parts."""
    plain: JsonValue = to_jsonable_python(value, fallback=_plain)
    return plain


def _plain(value: object) -> object:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else str(value)


def recorded_nodes(nodes: Sequence[NodeInfo]) -> tuple[RecordedNode, ...]:
    """Return the node table as recordings hold it."""
    return tuple(
        RecordedNode(
            path=node.path,
            name=node.name,
            kind=node.kind,
            type=node.type,
            parent=node.parent,
            file=node.file,
            line=node.line,
            acts=node.acts,
        )
        for node in nodes
    )
