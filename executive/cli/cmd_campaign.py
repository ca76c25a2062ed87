"""`cellwright campaign`: many runs of one mission, and what they come to together."""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from executive.cli.campaign_faults import faults
from executive.cli.campaign_signals import terminated_like_interrupted
from executive.cli.console import chatter, results
from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.running.runner import MissionOutcome

if TYPE_CHECKING:
    from executive.app.campaigns.campaign import Campaign
    from executive.app.campaigns.jobs import RunRecord

_RUN = "run"
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")]


class _RunByDefault(TyperGroup):
    """What is no subcommand is the file of a campaign to run."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a subcommand with its arguments, as the base class does."""
        if args and args[0] not in self.commands:
            if not args[0].startswith("-"):
                _document_file(Path(args[0]))
            args = [_RUN, *args]
        return super().resolve_command(ctx, args)


campaign = typer.Typer(
    cls=_RunByDefault,
    help="Run one mission many times: cellwright campaign FILE.",
    no_args_is_help=True,
    context_settings={"ignore_unknown_options": True},
)
campaign.command()(faults)


@campaign.callback()
def _group() -> None:
    """Run one mission many times: cellwright campaign FILE."""


@campaign.command(_RUN)
def run_campaign(
    file: Annotated[Path, typer.Argument(help="YAML document of the campaign.")],
    workers: Annotated[int, typer.Option(min=0, help="Runs at a time; one a core by default.")] = 0,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on that Dask cluster: tcp://HOST:8786."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", file_okay=False, help="Folder; runs/TIME_NAME by default."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the campaign in that folder.")
    ] = False,
    again: Annotated[
        bool, typer.Option("--again", help="With --resume: repeat runs whose process was lost.")
    ] = False,
    listed: Annotated[
        bool, typer.Option("--list", help="Show the runs that are wanted, and run nothing.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Run the campaign that a document describes; the word run may be left out.

    Exit codes: 0 every run came to an end, 1 some processes were lost, 2 bad input, 4 stopped.
    """
    from executive.app.campaigns.campaign import Campaign, Where
    from executive.app.campaigns.document import read_campaign

    document, _ = read_campaign(_document_file(file))
    folder = _folder(document.campaign, out, resume=resume)
    one = Campaign(document, file.parent, folder)
    if listed:
        _list(one)
        return
    if resume:
        one.resume()
    else:
        one.begin()
    where = Where(workers or _cores(), scheduler)
    try:
        with terminated_like_interrupted():
            _run(one, where, again=again)
    except KeyboardInterrupt:
        chatter().print(f"stopped; go on with --resume --out {folder}")
        raise typer.Exit(MissionOutcome.ABORTED.exit_code) from None
    found = list(one.folder.records())
    _write_table(folder, found)
    _show(folder, found, as_json=as_json)
    from executive.app.campaigns.jobs import LOST

    raise typer.Exit(1 if any(record.outcome in LOST for record in found) else 0)


@campaign.command()
def show(
    folder: Annotated[Path, typer.Argument(help="Folder of a campaign.")],
    as_json: JsonOption = False,
) -> None:
    """Show what a campaign has come to so far, and bring its table up to date."""
    found = _records(folder)
    _write_table(folder, found)
    _show(folder, found, as_json=as_json)


@campaign.command()
def compare(
    a: Annotated[str, typer.Argument(help="Folder of a campaign, or FOLDER:VARIANT.")],
    b: Annotated[str, typer.Argument(help="Folder of another one, or FOLDER:VARIANT.")],
    as_json: JsonOption = False,
) -> None:
    """Say what differs between two campaigns, or two variants, beyond noise.

    Exit codes: 0 nothing does, 1 something does, 2 bad input.
    """
    from dataclasses import asdict

    from executive.app.campaigns.comparing import compare as compared
    from executive.cli.campaign_text import comparison_lines

    found = compared(_side(a), _side(b))
    if as_json:
        typer.echo(json.dumps(asdict(found)))
    else:
        for line in comparison_lines(found, a, b):
            results().print(line, soft_wrap=True)
    raise typer.Exit(1 if any(one.beyond_noise for one in found.differences) else 0)


def _document_file(file: Path) -> Path:
    if not file.is_file():
        raise InputError(
            f"{file}: no such file; expected the document of a campaign, or one of the words "
            f"show, compare, faults; {closest(str(file), ['show', 'compare', 'faults'])}"
        )
    return file


def _folder(name: str, out: Path | None, *, resume: bool) -> Path:
    if resume and out is None:
        raise InputError("--resume: which campaign? try --out FOLDER")
    return out or Path("runs") / f"{datetime.now(UTC).strftime('%Y%m%dT%H%M%SZ')}_{name}"


def _cores() -> int:
    import os

    return len(os.sched_getaffinity(0))


def _list(one: "Campaign") -> None:
    from executive.app.campaigns.variants import variants

    console, seeds = results(), one.document.all_seeds
    for variant in variants(one.document):
        console.print(f"v{variant.number:03d}  {variant}", soft_wrap=True)
    console.print(f"{one.count} runs: each with {len(seeds)} seeds, {seeds[0]} to {seeds[-1]}")


def _run(one: "Campaign", where: Any, *, again: bool) -> None:
    from executive.cli.campaign_text import Progress

    done = len(one.folder.finished(again=again))
    with Progress(chatter(), one.count, done) as progress:
        for record in one.run(where, again=again):
            progress.tell(record)


def _records(folder: Path) -> "list[RunRecord]":
    from executive.app.campaigns.folder import CampaignFolder

    kept = CampaignFolder(folder)
    kept.plan()
    return list(kept.records())


def _side(named: str) -> "list[RunRecord]":
    """Return the runs of a campaign, or of one variant of it."""
    name, colon, number = named.rpartition(":")
    if not colon or Path(named).exists():
        return _some(named, _records(Path(named)))
    wanted = number.removeprefix("v")
    if not wanted.isdigit():
        raise InputError(f"{named}: got variant {number!r}; expected a number such as {name}:1")
    return _some(named, [one for one in _records(Path(name)) if one.variant == int(wanted)])


def _some(named: str, found: "list[RunRecord]") -> "list[RunRecord]":
    if not found:
        raise InputError(f"{named}: no run has ended there; nothing can be compared")
    return found


def _write_table(folder: Path, found: "list[RunRecord]") -> None:
    from executive.app.campaigns.table import TABLE, write_table

    if found:
        write_table(found, folder / TABLE)


def _show(folder: Path, found: "list[RunRecord]", *, as_json: bool) -> None:
    from executive.cli.campaign_text import summary_document, summary_lines

    if as_json:
        typer.echo(json.dumps({"folder": str(folder), **summary_document(found)}))
        return
    console = results()
    for line in summary_lines(found, folder):
        console.print(line, soft_wrap=True)
