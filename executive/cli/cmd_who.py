"""`cellwright who` and `history`: where a value of the blackboard came from."""

import json
from typing import Annotated

import typer
from rich.text import Text

from executive.cli.console import results
from executive.cli.recordings import RunArgument
from executive.inspector.answer_view import written_document, written_view
from executive.inspector.brief import brief
from executive.inspector.names import split_at
from executive.inspector.past import PastRun
from executive.inspector.provenance import who_wrote

Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")]


def who(
    recording: RunArgument,
    key: Annotated[
        str,
        typer.Argument(
            metavar="KEY[@TICK]", help="A key by name, full name or glob; the tick as 41 or 12.3s."
        ),
    ],
    as_json: Json = False,
) -> None:
    """Say who wrote a key last before a tick, what it was before, and who has read it since."""
    run = PastRun.open(recording)
    name, at = split_at(key)
    tick = run.index.last_tick if at is None else run.names.tick(at)
    full = run.names.key(name)
    written = who_wrote(run, full, tick)
    if as_json:
        typer.echo(json.dumps(None if written is None else written_document(run, written)))
    elif written is None:
        first = run.index.writes[full][0]
        by = run.names.of_path(first.writer)
        typer.echo(f"{full} had no value at tick {tick}; {by} wrote it first, at tick {first.tick}")
    else:
        results().print(written_view(run, written))


def history(
    recording: RunArgument,
    key: Annotated[str, typer.Argument(metavar="KEY", help="A key by name, full name or glob.")],
    as_json: Json = False,
) -> None:
    """List every write of a key, in order."""
    run = PastRun.open(recording)
    places = [place for full in run.names.keys(key) for place in run.index.writes[full]]
    places.sort(key=lambda place: (place.tick, place.position))
    if as_json:
        typer.echo(
            json.dumps(
                [
                    {
                        "key": place.key,
                        "tick": place.tick,
                        "time_s": float(run.index.times_s[place.tick]),
                        "writer": place.writer or None,
                        "value": run.index.value_at(place),
                    }
                    for place in places
                ]
            )
        )
        return
    console = results()
    several = len({place.key for place in places}) > 1
    for place in places:
        name = f"{place.key} = " if several else ""
        by = run.names.of_path(place.writer) or "an input of the mission"
        head = f"tick {place.tick:>5}  {run.index.times_s[place.tick]:>8.1f} s  "
        value = brief(run.index.value_at(place))
        line = Text.assemble((head, "bright_black"), name, value, (f"  by {by}", "bright_black"))
        console.print(line, soft_wrap=True)
