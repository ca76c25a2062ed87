"""`cellwright campaign faults`: every single fault tried, and what came of each."""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from executive.cli.campaign_signals import terminated_like_interrupted
from executive.cli.console import chatter, results
from executive.cli.fault_runs import Campaign
from executive.cli.fault_table import print_progress, summary, survived_percent, table
from executive.core.errors import InputError
from executive.engine.faults.processes import Processes
from executive.engine.faults.store import CampaignFolder, CampaignPlan, FaultRun
from executive.engine.faults.variants import Wanted, parse_kinds, variants
from executive.engine.loading.loader import load_mission
from executive.engine.running.runner import MissionOutcome
from executive.inspector.fault_effects import seen_in
from executive.inspector.past import PastRun


def faults(
    mission: Annotated[str, typer.Argument(help="Name of a mission, or its YAML file.")],
    seed: Annotated[int, typer.Option(min=0, help="Seed of every run.")] = 0,
    only: Annotated[
        str, typer.Option(metavar="GLOB", help="Skills and keys to try: 'grasp_*|frame'.")
    ] = "",
    kinds: Annotated[
        str, typer.Option(help="What goes wrong: some of fail, hang, raise, stale, drop.")
    ] = "fail,hang,raise,stale",
    at: Annotated[int, typer.Option(min=1, help="Activation or write in which it goes wrong.")] = 1,
    workers: Annotated[int, typer.Option(min=1, help="Runs at a time.")] = 1,
    timeout: Annotated[
        float | None,
        typer.Option(min=0.0, help="Limit of a run on the cell's clock, in seconds."),
    ] = None,
    wall_limit: Annotated[
        float, typer.Option(min=1.0, help="Limit of a run on the machine's clock, in seconds.")
    ] = 600.0,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set an input or a part of the scenario."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", file_okay=False, help="Folder; runs/TIME_faults_MISSION_SEED by default."
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the campaign in that folder.")
    ] = False,
    fail_under: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT", min=0.0, max=100.0, help="Exit with 1 when fewer are survived."
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")] = False,
) -> None:
    """Try every single fault in simulation: each skill with each kind, each key stale.

    Exit codes: 0 every run ended in order, 1 some did not, 2 bad input, 4 stopped by the user.
    """
    plan = CampaignPlan(
        mission=mission,
        seed=seed,
        timeout_s=timeout,
        assignments=tuple(assignments or ()),
    )
    wanted = Wanted(parse_kinds(kinds), at, only)
    _check(mission)
    folder = _folder(plan, out, resume=resume)
    try:
        with terminated_like_interrupted():
            baseline, runs = _runs(Campaign(plan, folder, Processes(workers, wall_limit)), wanted)
    except KeyboardInterrupt:
        chatter().print(f"stopped; go on with --resume --out {folder.folder}")
        raise typer.Exit(MissionOutcome.ABORTED.exit_code) from None
    if as_json:
        typer.echo(_document(plan, folder, baseline, runs))
    else:
        _print(folder, baseline, runs)
    wrong = any(run.verdict == "wrong" for run in runs)
    low = fail_under is not None and survived_percent(runs) < fail_under
    raise typer.Exit(1 if wrong or low else 0)


def _check(mission: str) -> None:
    """Find every fault of the documents before a folder is made."""
    from executive.app.catalogue import port_types, skills

    load_mission(mission, skills=skills(), types=port_types())


def _folder(plan: CampaignPlan, out: Path | None, *, resume: bool) -> CampaignFolder:
    if resume and out is None:
        raise InputError("--resume: which campaign? try --out FOLDER")
    name = Path(plan.mission).stem
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    folder = CampaignFolder(out or Path("runs") / f"{stamp}_faults_{name}_{plan.seed}")
    if resume:
        folder.resume(plan)
    else:
        folder.begin(plan)
    return folder


def _runs(campaign: Campaign, wanted: Wanted) -> tuple[PastRun, list[FaultRun]]:
    """Run what is left of a campaign; return all of it in the order of the tree."""
    console = chatter()
    with console.status("running without a fault"):
        baseline = campaign.baseline()
    tried, names = variants(seen_in(baseline.index), wanted), _names(baseline)
    done = sum(one.fault in campaign.folder.finished() for one in tried)
    for place, run in enumerate(campaign.runs(tried, baseline), start=done + 1):
        print_progress(console, run, place, len(tried), names)
    found = campaign.folder.results()
    return baseline, [found[one.fault] for one in tried]


def _names(run: PastRun) -> dict[str, str]:
    return {node.path: run.names.short(number) for number, node in enumerate(run.index.nodes)}


def _print(folder: CampaignFolder, baseline: PastRun, runs: list[FaultRun]) -> None:
    console, result = results(), baseline.recording.result
    assert result is not None
    usual = result.report
    console.print(f"without a fault: {usual.outcome} after {usual.sim_s:.1f} s", soft_wrap=True)
    for line in table(runs, _names(baseline)):
        console.print(line, soft_wrap=True)
    console.print(summary(runs), soft_wrap=True)
    console.print(f"recordings: {folder.folder}", soft_wrap=True)


def _document(
    plan: CampaignPlan, folder: CampaignFolder, baseline: PastRun, runs: list[FaultRun]
) -> str:
    result = baseline.recording.result
    assert result is not None
    verdicts = [run.verdict for run in runs]
    return json.dumps(
        {
            "plan": plan.model_dump(mode="json"),
            "folder": str(folder.folder),
            "baseline": result.report.model_dump(mode="json"),
            "runs": [run.model_dump(mode="json") for run in runs],
            "survived": verdicts.count("survived"),
            "ended": verdicts.count("ended"),
            "wrong": verdicts.count("wrong"),
            "not_reached": verdicts.count("not reached"),
            "survived_percent": survived_percent(runs),
        }
    )
