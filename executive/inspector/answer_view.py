"""Answers as text for a terminal and as JSON for programs."""

from collections.abc import Iterator
from pathlib import PurePath

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from executive.engine.ticks import NodeStatus
from executive.inspector.past import PastRun
from executive.inspector.provenance import Written
from executive.inspector.sentences import Answer, Sentence
from executive.inspector.tick_list import Stretch, TickEvents
from executive.inspector.views import ICONS


def answer_view(run: PastRun, answer: Answer) -> RenderableType:
    """Return an answer: the headline first, the ways down as tables."""
    parts: list[RenderableType] = [Text(answer.headline, "bold")]
    parts += [Text(f"  {note}", "bright_black") for note in answer.notes]
    for title, sentences in answer.sections:
        parts.append(Text(f"{title}:", "bright_black"))
        table = Table(box=None, show_header=False, padding=(0, 2, 0, 0), pad_edge=False)
        table.add_column(no_wrap=True)
        table.add_column(overflow="fold")
        table.add_column(no_wrap=True, style="bright_black")
        for sentence in sentences:
            table.add_row(*_row(run, sentence))
        parts.append(table)
    return Group(*parts)


def _row(run: PastRun, sentence: Sentence) -> tuple[Text, Text, Text]:
    if sentence.node is None:
        return Text("  the runner"), Text(sentence.text), Text("")
    icon, colour = ICONS[run.index.answer(sentence.node, sentence.tick)]
    name = Text.assemble("  ", (f"{icon} ", colour), run.names.short(sentence.node))
    return name, Text(sentence.text), Text(run.names.where(sentence.node))


def answer_document(run: PastRun, answer: Answer) -> dict[str, object]:
    """Return an answer for programs."""
    return {
        "answer": answer.headline,
        "notes": list(answer.notes),
        "sections": [
            {"title": title, "steps": [_step(run, sentence) for sentence in sentences]}
            for title, sentences in answer.sections
        ],
    }


def _step(run: PastRun, sentence: Sentence) -> dict[str, object]:
    step: dict[str, object] = {"tick": sentence.tick, "text": sentence.text, "path": None}
    if sentence.node is not None:
        node = run.index.nodes[sentence.node]
        status = run.index.answer(sentence.node, sentence.tick).value
        step |= {"path": node.path, "file": node.file, "line": node.line, "status": status}
    return step


def written_view(run: PastRun, written: Written) -> RenderableType:
    """Return who wrote a value, what it was before, and who reads it."""
    place, names = written.place, run.names
    time_s = run.index.times_s[place.tick]
    who = names.of_path(place.writer) if place.writer else "an input of the mission"
    lines = [
        Text(f"{_name(place.key)} = {written.value}", "bold"),
        Text(
            f"  written by {who} at tick {place.tick} ({time_s:.1f} s){_where(run, place.writer)}"
        ),
    ]
    if written.previous is None:
        lines.append(Text("  it had no value before"))
    else:
        by = names.of_path(written.previous.writer) or "an input of the mission"
        lines.append(
            Text(f"  before: {written.previous_value}, by {by} at tick {written.previous.tick}")
        )
    until = "the end" if written.until is None else f"tick {written.until}"
    lines.append(Text(f"  it kept that value until {until}"))
    lines.append(
        Text("read, by the wiring of the tree, by:" if written.readers else "nothing reads it")
    )
    for reader in written.readers:
        shown = ", ".join(f"@{tick}" for tick in reader.runs[:8])
        more = f" and {len(reader.runs) - 8} times more" if len(reader.runs) > 8 else ""
        ran = f"ran with it {shown}{more}" if reader.runs else "has not run with it"
        lines.append(Text(f"  {names.short(reader.node)}: {ran}  {names.where(reader.node)}"))
    return Group(*lines)


def _where(run: PastRun, path: str) -> str:
    node = run.index.indices.get(path)
    return "" if node is None else f"  {run.names.where(node)}"


def _name(key: str) -> str:
    path, _, name = key.rpartition(":")
    return f"{name} (of {PurePath(path).name})"


def written_document(run: PastRun, written: Written) -> dict[str, object]:
    """Return who wrote a value, for programs; values whole, in their JSON form."""
    place, previous = written.place, written.previous
    return {
        "key": place.key,
        "tick": place.tick,
        "time_s": float(run.index.times_s[place.tick]),
        "writer": place.writer or None,
        "value": run.index.value_at(place),
        "previous": None
        if previous is None
        else {
            "tick": previous.tick,
            "writer": previous.writer or None,
            "value": run.index.value_at(previous),
        },
        "until_tick": written.until,
        "readers": [
            {"path": run.index.nodes[reader.node].path, "ticks": list(reader.runs)}
            for reader in written.readers
        ],
    }


def ticks_lines(run: PastRun, told: TickEvents | Stretch) -> Iterator[Text]:
    """Return the lines of one tick, or the one line of a stretch of them."""
    if isinstance(told, Stretch):
        yield Text(stretch_text(told), "bright_black")
        return
    took = f"{told.duration_s * 1e3:.1f} ms"
    yield Text.assemble(
        (f"tick {told.tick}", "bold"), (f"  {told.time_s:.2f} s  took {took}", "bright_black")
    )
    for event in told.events:
        if event.what == "write":
            name = f"{_name(event.name)} = {event.text}"
            by = run.names.of_path(event.writer) or "input"
            yield Text.assemble("  = ", name, (f"  by {by}", "bright_black"))
        elif event.what == "fault":
            yield Text(f"  ! {run.names.of_path(event.name) or 'cell'}: {event.text}", "bold red")
        else:
            icon, colour = ICONS[NodeStatus(event.what)]
            because = f"  {event.text}" if event.text else ""
            name = run.names.of_path(event.name)
            yield Text.assemble((f"  {icon} {event.what:<8}", colour), name, (because, colour))


def stretch_text(told: Stretch) -> str:
    """Return `ticks 40-410 the same`."""
    one = told.first == told.last
    which = f"tick {told.first}" if one else f"ticks {told.first}-{told.last}"
    if told.period == 0:
        return f"{which} the same"
    pattern = "like it" if told.period == 1 else f"like these {told.period} over and over"
    values = f", but for the values of {', '.join(map(_name, told.values))}" if told.values else ""
    return f"{which} {pattern}{values}"


def ticks_document(told: TickEvents | Stretch) -> dict[str, object]:
    """Return one tick, or a stretch of them, for programs."""
    if isinstance(told, Stretch):
        return {
            "from": told.first,
            "to": told.last,
            "same": True,
            "period": told.period,
            "values_differ": list(told.values),
        }
    return {
        "tick": told.tick,
        "time_s": told.time_s,
        "duration_s": told.duration_s,
        "events": [
            {"what": e.what, "name": e.name, "text": e.text, "writer": e.writer or None}
            for e in told.events
        ],
    }
