"""What a recording looks like in a terminal: its summary, and the tree at one tick."""

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from executive.engine.recording.messages import RecordedNode
from executive.engine.recording.reader import Recording
from executive.engine.ticks import NodeStatus, Tick
from executive.inspector.brief import brief
from executive.inspector.injected import injected_lines

ICONS = {
    NodeStatus.SUCCESS: ("✓", "green"),
    NodeStatus.FAILURE: ("✗", "red"),
    NodeStatus.RUNNING: ("▶", "yellow"),
    NodeStatus.INVALID: ("·", "bright_black"),
}
OUTCOME_STYLES = {
    "success": "bold green",
    "failure": "bold red",
    "timeout": "bold red",
    "aborted": "bold yellow",
    "error": "bold white on red",
}


def summary_view(recording: Recording) -> RenderableType:
    """Return what was run and what it came to."""
    header, result = recording.header, recording.result
    title = Text.assemble((header.mission, "bold"), f"  seed {header.seed}  {header.started_utc}")
    if result is None:
        ending = Text("no result: the run was killed, or still goes on", "bold red")
        return Group(title, ending, *_injected(recording))
    report = result.report
    outcome = Text.assemble(
        (report.outcome, OUTCOME_STYLES[report.outcome]),
        f"  {report.ticks} ticks, {report.sim_s:.1f} s on the cell's clock, {report.wall_s:.1f} s",
    )
    lines = [title, outcome]
    if report.reason:
        lines.append(Text(f"because  {report.reason}"))
    lines += [Text(f"claim    {brief(report.claim)}")] if report.claim is not None else []
    lines += [Text(f"truth    {brief(report.truth)}")] if report.truth is not None else []
    return Group(*lines, *_injected(recording))


def _injected(recording: Recording) -> list[Text]:
    return [Text(f"injected {line}", "magenta") for line in injected_lines(recording)]


def tick_view(recording: Recording, number: int, nodes: frozenset[int]) -> RenderableType:
    """Return the tree and the blackboard after one tick; nodes that are not asked for are dim."""
    tick = recording.tick(number)
    parts: list[RenderableType] = [
        _tick_line(recording, tick),
        tree_view(recording, number, nodes),
    ]
    for fault in tick.faults:
        parts.append(Text(f"! {fault.path or 'cell'}: {fault.message}", "bold red"))
        parts.append(Text(fault.traceback, "bright_black"))
    board = blackboard_view(recording, number)
    return Group(*parts, *([board] if board is not None else []))


def _tick_line(recording: Recording, tick: Tick) -> Text:
    last = len(recording) - 1
    line = Text(f"tick {tick.number} of 0-{last}  t = {tick.time_s:.2f} s", "bold")
    if tick.visited:
        return line.append(f"  took {tick.duration_s * 1e3:.1f} ms", "not bold bright_black")
    return line.append("  what the runner stopped at the end", "not bold bright_black")


def tree_view(recording: Recording, number: int, nodes: frozenset[int]) -> Text:
    """Return the tree with the status of every node, and why leaves failed."""
    table, visited = recording.header.nodes, frozenset(recording.tick(number).visited)
    statuses, reasons = recording.statuses(number), recording.reasons(number)
    text = Text()
    for index, (node, prefix) in enumerate(zip(table, _prefixes(table), strict=True)):
        icon, colour = ICONS[statuses[index]]
        style = colour if index in visited else f"{colour} dim"
        text.append(prefix, "bright_black")
        text.append(f"{icon} ", style)
        text.append(node.name, "dim" if index not in nodes else "bold" if index in visited else "")
        if node.type not in (node.name, ""):
            text.append(f" {node.type}", "bright_black")
        if statuses[index] is NodeStatus.FAILURE and index in reasons:
            text.append(f"  {reasons[index]}", "red")
        text.append("\n")
    return text


def _prefixes(nodes: Sequence[RecordedNode]) -> list[str]:
    """Return the lines that lead to each node of a table in which parents come first."""
    last_child = {node.parent: index for index, node in enumerate(nodes)}
    prefixes: list[str] = []
    for index, node in enumerate(nodes):
        if node.parent is None:
            prefixes.append("")
            continue
        above = prefixes[node.parent].replace("├─ ", "│  ").replace("└─ ", "   ")
        prefixes.append(above + ("└─ " if last_child[node.parent] == index else "├─ "))
    return prefixes


def blackboard_view(recording: Recording, number: int) -> RenderableType | None:
    """Return keys, values and writers after a tick, None where nothing was written yet."""
    states = recording.blackboard(number)
    if not states:
        return None
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="bright_black", expand=True)
    for column in ("tick", "key", "written by"):
        table.add_column(column, no_wrap=True)
    table.add_column("value", no_wrap=True, overflow="ellipsis", ratio=1)
    for key, state in states.items():
        fresh = "bold" if state.tick == number else ""
        writer = _tail(state.writer) or "input"
        table.add_row(str(state.tick), Text(_tail(key), fresh), writer, Text(brief(state.value)))
    return table


def _tail(path: str) -> str:
    """Return the end of a path: keys and nodes of deep trees have names longer than a line."""
    return path.rpartition("/")[2]
