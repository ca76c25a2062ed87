"""What the panes beside the tree say, as lines."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from executive.engine.recording.messages import MissionHeader
from executive.engine.recording.reader import Recording
from executive.engine.ticks import RUNNER, NodeStatus, Tick
from executive.inspector.brief import brief
from executive.inspector.past import PastRun
from executive.inspector.provenance import Written, who_wrote
from executive.inspector.sentences import Answer, Sentence
from executive.inspector.terminal.rows import STATUS_LOOKS
from executive.inspector.terminal.told import Line
from executive.inspector.views import ICONS
from executive.inspector.why import why, why_ended

_NEAR = 50
"""Writes of a key that are listed before and after the one that counts."""


def tick_page(recording: Recording, number: int) -> list[Line]:
    """Return what one tick did: how long it took, what changed and why, writes and faults."""
    tick, budget_s = recording.tick(number), 1.0 / recording.header.tick_hz
    took = f"took {tick.duration_s * 1e3:.1f} ms of {budget_s * 1e3:.0f} ms"
    late = tick.duration_s > budget_s
    head = f"tick {number}  {tick.time_s:.2f} s  "
    lines = [Line(parts=((head, "strong"), (took + (", too slow" if late else ""), _late(late))))]
    nodes = recording.header.nodes
    for step in sorted(tick.slow, key=lambda slow: -slow.seconds):
        name = nodes[step.node].path
        text = f"slow  {name} took {step.seconds:.2f} s, may take {step.budget_s:g} s"
        lines.append(Line(text, "failure", node=step.node, tick=number))
    for fault in tick.faults:
        lines.append(Line(f"! {fault.path or 'cell'}: {fault.message}", "failure"))
        lines += [Line(text, "muted") for text in fault.traceback.splitlines()]
    changed = [*_changed(recording, tick)]
    lines += changed or [Line("no node changed", "muted")]
    for write in tick.writes:
        by = write.writer.rpartition("/")[2] or "input"
        said = (
            (f"= {_tail(write.key)} = ", "name"),
            (brief(write.value), ""),
            (f"  by {by}", "muted"),
        )
        lines.append(Line(parts=said, key=write.key))
    return lines


def _late(late: bool) -> str:
    return "failure" if late else "muted"


def _changed(recording: Recording, tick: Tick) -> Iterator[Line]:
    """Yield nodes that got another status, save those that were done and were put back."""
    nodes = recording.header.nodes
    reasons = {end.node: str(end.reason) for end in tick.outcomes if end.reason is not None}
    halted = {halt.node: halt.by for halt in tick.halts}
    statuses = dict(tick.changes)
    statuses |= {end.node: end.status for end in tick.outcomes}
    for node, status in sorted(statuses.items()):
        if status is NodeStatus.INVALID and node not in halted:
            continue
        icon, look = ICONS[status][0], STATUS_LOOKS[status]
        said = reasons.get(node, "")
        if node in halted:
            by = "the runner" if halted[node] == RUNNER else nodes[halted[node]].name
            icon, look, said = "■", "halted", f"halted by {by}"
        parts = ((f"{icon} ", look), (nodes[node].name, "strong"), (f"  {said}", look))
        yield Line(parts=parts, node=node, tick=tick.number)


def why_page(run: PastRun, node: int, tick: int) -> list[Line]:
    """Return why a node did what it did in a tick; for the root at the end, why it ended so."""
    answers = [why(run, node, tick)]
    if node == 0 and tick >= run.index.last_tick and run.recording.result is not None:
        answers.insert(0, why_ended(run))
    lines: list[Line] = []
    for answer in answers:
        lines += [Line()] if lines else []
        lines += _answer(run, answer)
    return lines


def _answer(run: PastRun, answer: Answer) -> list[Line]:
    lines = [Line(answer.headline, "strong"), *(Line(note, "muted") for note in answer.notes)]
    for title, sentences in answer.sections:
        lines.append(Line(f"{title}:", "muted"))
        lines += [_sentence(run, sentence) for sentence in sentences]
    return lines


def _sentence(run: PastRun, sentence: Sentence) -> Line:
    if sentence.node is None:
        return Line(f"  the runner  {sentence.text}", tick=sentence.tick)
    status = run.index.answer(sentence.node, sentence.tick)
    parts = (
        (f"  {ICONS[status][0]} ", STATUS_LOOKS[status]),
        (run.names.short(sentence.node), "strong"),
        (f"  {sentence.text}", ""),
        (f"  {run.names.where(sentence.node)}", "muted"),
    )
    return Line(parts=parts, node=sentence.node, tick=sentence.tick)


def key_page(run: PastRun, key: str, tick: int) -> tuple[list[Line], int]:
    """Return where a value comes from, who read it, its history and all of it.

    Returns:
        The lines, and which of them is the write that counts.
    """
    written = who_wrote(run, key, tick) if key in run.index.writes else None
    if written is None:
        return [Line(key, "strong"), Line(f"no value at tick {tick}", "muted")], 0
    lines = [Line(parts=((f"{key} = ", "strong"), (written.value, "")))]
    lines += [*_provenance(run, written)]
    here = len(lines)
    history, place = _history(run, key, written)
    lines += [Line("history:", "muted"), *history, Line("all of it:", "muted")]
    whole = json.dumps(run.index.value_at(written.place), indent=1, ensure_ascii=False)
    return [*lines, *(Line(text) for text in whole.splitlines())], here + 1 + place


def _provenance(run: PastRun, written: Written) -> Iterator[Line]:
    place, before = written.place, written.previous
    until = "the end" if written.until is None else f"@{written.until}"
    node = run.index.indices.get(place.writer)
    yield Line(
        f"written by {_writer(run, place.writer)} @{place.tick}, kept until {until}",
        node=node,
        tick=place.tick,
    )
    if before is None:
        yield Line("it had no value before", "muted")
    else:
        by = f"{_writer(run, before.writer)} @{before.tick}"
        yield Line(f"before: {written.previous_value}  by {by}", "muted", tick=before.tick)
    readers = [reader for reader in written.readers if reader.runs]
    for reader in readers:
        ticks = " ".join(f"@{at}" for at in reader.runs[:6])
        more = f" and {len(reader.runs) - 6} times more" if len(reader.runs) > 6 else ""
        yield Line(
            f"read by {run.names.short(reader.node)} {ticks}{more}",
            node=reader.node,
            tick=reader.runs[0],
        )
    if not readers:
        yield Line("nothing has run with it", "muted")


def _history(run: PastRun, key: str, written: Written) -> tuple[list[Line], int]:
    places = run.index.writes[key]
    at = places.index(written.place)
    first = max(0, at - _NEAR)
    lines = []
    for place in places[first : at + _NEAR + 1]:
        mark = "▸" if place is written.place else " "
        head = f"{mark} @{place.tick:<6} {run.index.times_s[place.tick]:8.1f} s  "
        value = brief(run.index.value_at(place))
        by = f"  by {_writer(run, place.writer)}"
        parts = ((head, "muted"), (value, ""), (by, "muted"))
        lines.append(Line(parts=parts, tick=place.tick))
    more = len(places) - len(lines)
    if more:
        lines.append(Line(f"  {more} more writes", "muted"))
    return lines, at - first


def _writer(run: PastRun, path: str) -> str:
    return run.names.of_path(path) or "an input of the mission"


def _tail(path: str) -> str:
    return path.rpartition("/")[2]


def source_page(header: MissionHeader, node: int) -> tuple[list[Line], int]:
    """Return the document of a node, and which line is that of the node."""
    at = header.nodes[node]
    source = next((one for one in header.sources if one.file == at.file), None)
    if source is None:
        return [Line(f"{at.file} is not in the recording", "muted")], 0
    lines = [Line(PurePath(at.file).name, "muted")]
    for number, text in enumerate(source.text.splitlines(), start=1):
        marked = number == at.line
        code, comment = _split(text)
        parts = (
            (f"{'▸' if marked else ' '}{number:4d}  ", "running" if marked else "muted"),
            (code, "strong" if marked else ""),
            (comment, "muted"),
        )
        lines.append(Line(parts=parts))
    return lines, min(at.line, len(lines) - 1)


def _split(text: str) -> tuple[str, str]:
    """Return a line of YAML without its comment, and the comment."""
    if text.lstrip().startswith("#"):
        return "", text
    code, mark, comment = text.partition(" #")
    return code, mark + comment


def debug_page(state: Mapping[str, Any] | None, name: str) -> list[Line]:
    """Return where a live run stands, what can be done, its breakpoints and forced answers.

    Args:
        state: What the run's debugger says; None where nothing runs it.
        name: Path of the selected node.
    """
    if state is None:
        return [Line("nothing runs this mission: it can be looked at, not commanded", "muted")]
    paused = state["paused"]
    lines = [Line(_standing(state), "running" if paused else "success")]
    lines += [Line(f"  {words}", "name", act=act) for words, act in _steps(paused)]
    lines.append(Line("breakpoints:", "muted"))
    for one in state["breakpoints"]:
        text = f"  {one['number']}  {one['text']}  hit {one['hits']} times  (Enter removes it)"
        lines.append(Line(text, act=f"unbreak({one['number']})"))
    lines.append(Line(f"  + b  break at {name}", "name", act="ask('break')"))
    lines.append(Line(f"answers of {name}:", "muted"))
    for answer in ("success", "failure", "running"):
        lines.append(Line(f"  answer {answer} in its place", "name", act=f"force('{answer}')"))
    for path, answer in state["forced"].items():
        text = f"  {path} = {answer}  (Enter lets it go)"
        lines.append(Line(text, "running", act=f"unforce({path!r})"))
    return lines


def _steps(paused: bool) -> Sequence[tuple[str, str]]:
    steps: tuple[tuple[str, str], ...] = (("p  pause", "pause_or_resume"),)
    if paused:
        steps = (
            ("p  resume", "pause_or_resume"),
            ("s  one tick", "step('tick')"),
            ("i  into: to the next node", "step('into')"),
            ("o  over: until this node has answered", "step('over')"),
            ("u  out: until its parent has answered", "step('out')"),
        )
    ends = ("x  stop the mission in order", "stop"), ("X  stop the arms now", "emergency_stop")
    return (*steps, *ends)


def _standing(state: Mapping[str, Any]) -> str:
    place = state["standing"]
    if state["stopping"]:
        return f"stopping: {state['stopping']}"
    if place is None:
        return "the mission is running"
    where = "between two ticks"
    if place["node"]:
        where = f"{'after' if place['answered'] else 'before'} {place['node']}"
    return f"paused at tick {place['tick']}, {where}: {place['why']}"


def text_page(text: str) -> list[Line]:
    """Return plain text."""
    return [Line(line) for line in text.splitlines()]
