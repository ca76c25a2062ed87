"""The runs of a fault campaign: each a `cellwright run` of its own, judged by its recording."""

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from executive.core.errors import InputError
from executive.engine.faults.grammar import Kind
from executive.engine.faults.processes import Ended, Processes
from executive.engine.faults.store import (
    CampaignFolder,
    CampaignPlan,
    FaultRun,
    changed_sources,
)
from executive.engine.faults.variants import Variant
from executive.engine.recording.messages import RunReport
from executive.inspector.fault_effects import effect_of, left_running
from executive.inspector.past import PastRun

BASELINE = "no_fault.mcap"
_TIED = "from executive.engine.faults.tether import tie_to_stdin; tie_to_stdin()"
_COMMAND = (sys.executable, "-c", f"{_TIED}; from executive.cli.main import main; main()", "run")


@dataclass(frozen=True, slots=True)
class Campaign:
    """A campaign that is under way.

    Attributes:
        plan: What is tried.
        folder: Where it is kept.
        processes: Who runs it.
    """

    plan: CampaignPlan
    folder: CampaignFolder
    processes: Processes

    def baseline(self) -> PastRun:
        """Return the run without a fault, which is made when there is none.

        Raises:
            InputError: The mission cannot be run, or has changed since.
        """
        file = self.folder.folder / BASELINE
        if not file.exists():
            ((_, ended),) = self.processes.run([self._command(file)])
            if ended.overdue or _report(ended) is None or not file.exists():
                file.unlink(missing_ok=True)
                why = "takes too long" if ended.overdue else ended.last_words
                raise InputError(f"{self.plan.mission}: no run without a fault: {why}")
        run = PastRun.open(file)
        if run.recording.result is None:
            file.unlink()  # it was killed
            return self.baseline()
        if changed := changed_sources(run.recording.header.sources):
            raise InputError(
                f"{changed[0]}: has changed since the campaign began; try another --out"
            )
        return run

    def runs(self, tried: Sequence[Variant], baseline: PastRun) -> Iterator[FaultRun]:
        """Run what has no result yet, keep each result, and yield them as they come."""
        result = baseline.recording.result
        assert result is not None
        usual = result.report.outcome
        done = self.folder.finished()
        left = [one for one in tried if one.fault not in done]
        for one in (one for one in left if not one.reached):
            yield self._kept(FaultRun(fault=one.fault, verdict="not reached", outcome=usual))
        left = [one for one in left if one.reached]
        files = [self._file(one, baseline) for one in left]
        commands = [self._command(file, one.fault) for file, one in zip(files, left, strict=True)]
        for place, ended in self.processes.run(commands):
            yield self._kept(judged(left[place], ended, files[place], usual))

    def _kept(self, run: FaultRun) -> FaultRun:
        self.folder.add(run)
        return run

    def _file(self, variant: Variant, baseline: PastRun) -> Path:
        node = baseline.names.of_path(variant.target)
        name = variant.fault.replace(variant.target, node).removeprefix("key ")
        return self.folder.folder / f"{re.sub('[^a-z0-9_]+', '.', name)}.mcap"

    def _command(self, recording: Path, fault: str | None = None) -> list[str]:
        plan = self.plan
        words = [*_COMMAND, plan.mission, "--seed", str(plan.seed)]
        # What a run that died has left there is repeated.
        words += ["--record", str(recording), "--overwrite"]
        if plan.timeout_s is not None:
            words += ["--timeout", f"{plan.timeout_s:.9g}"]
        for assignment in plan.assignments:
            words += ["--set", assignment]
        return [*words, "--json", *(("--inject", fault) if fault else ())]


def judged(variant: Variant, ended: Ended, file: Path, usual: str) -> FaultRun:
    """Return what a run came to.

    Args:
        variant: The fault.
        ended: How its process ended.
        file: Its recording.
        usual: Outcome of the run without a fault.
    """
    report = _report(ended)
    if report is None or ended.overdue:
        return _without_report(variant, ended, file)
    past = PastRun.open(file)
    effect = effect_of(past, variant.kind)
    run = FaultRun(
        fault=variant.fault,
        verdict="not reached",
        outcome=report.outcome,
        reason=report.reason,
        sim_s=report.sim_s,
        wall_s=ended.wall_s,
        answered_by=effect.answered_by,
        answer=effect.answer,
        left_running=effect.left_running,
        recording=str(file),
    )
    if not effect.happened:
        return run
    wrong = _wrong(run, variant.kind, to_the_end=effect.to_the_end)
    survived = report.outcome == "success" or report.outcome == usual == "timeout"
    verdict = "wrong" if wrong else "survived" if survived else "ended"
    return run.model_copy(update={"verdict": verdict, "wrong": wrong})


def _wrong(run: FaultRun, kind: Kind, *, to_the_end: bool) -> str:
    """Return what is wrong with the end of a run, empty where nothing is."""
    if run.left_running:
        return f"left running: {', '.join(run.left_running)}"
    if run.outcome == "timeout" and kind is Kind.HANG and to_the_end:
        return "nothing ended the node that hung but the time limit of the mission"
    asked_for = kind is Kind.RAISE and "InjectedError" in run.reason
    if run.outcome == "aborted" or (run.outcome == "error" and not asked_for):
        return "the mission broke"
    return "" if run.outcome == "success" or run.reason else "no reason was given"


def _without_report(variant: Variant, ended: Ended, file: Path) -> FaultRun:
    how = "overdue" if ended.overdue else "died"
    what = "took too long" if ended.overdue else f"exit code {ended.code}"
    reason = f"{what}: {ended.last_words}" if ended.last_words else what
    running: tuple[str, ...] = ()
    if file.exists():
        try:
            running = left_running(PastRun.open(file).index)
        except InputError:
            running = ()  # killed before its first tick
    return FaultRun(
        fault=variant.fault,
        verdict="wrong",
        outcome=how,
        reason=reason,
        wall_s=ended.wall_s,
        left_running=running,
        wrong=f"its process {'was ended' if ended.overdue else 'died'}: {reason}",
        recording=str(file) if file.exists() else "",
    )


def _report(ended: Ended) -> RunReport | None:
    lines = ended.stdout.strip().splitlines()
    try:
        report = RunReport.model_validate_json(lines[-1]) if lines else None
    except ValidationError:
        return None
    return report if report is not None and report.recording is not None else None
