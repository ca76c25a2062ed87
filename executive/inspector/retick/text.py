"""What came of ticking a run again, for a terminal and for other programs."""

import dataclasses
from collections.abc import Iterator

from rich.text import Text

from executive.inspector.past import PastRun
from executive.inspector.retick.differences import NodeDifference, WriteDifference
from executive.inspector.retick.retick import OUTSIDE, Outside, Retick

_MANY = 12


def retick_document(found: Retick) -> dict[str, object]:
    """Return the result as JSON."""
    return {"identical": found.identical, **dataclasses.asdict(found)}


def retick_lines(found: Retick, run: PastRun) -> Iterator[Text]:
    """Return the lines of a result: the first difference first."""
    yield from _headline(found)
    if found.first is not None:
        yield from _some([_node(node, run) for node in found.first.nodes], "nodes")
        yield from _some([_write(write, run) for write in found.first.writes], "values")
        yield from _later(found, run)
    for outside in found.outside[:_MANY]:
        yield _outside(outside, run)
    yield from _some([f"moved: {old} is {new} now" for old, new in found.moved], "moved nodes")
    yield from _some([f"new: {path}" for path in found.added], "new nodes")
    yield from _some([f"no longer there: {path}" for path in found.removed], "nodes that are gone")
    yield from (Text(f"  {note}", "bright_black") for note in found.notes)
    if found.identical:
        yield Text.assemble(("it ended with ", "bold"), found.recorded_end)
    else:
        yield Text.assemble(("the run ", "bold"), f"ended with {found.recorded_end}")
        yield Text.assemble(("now ", "bold"), found.end)
        if found.end.startswith(OUTSIDE):
            yield Text("  try --beyond running to go on", "bright_black")


def _headline(found: Retick) -> Iterator[Text]:
    if found.identical:
        what = "statuses, order, halts and values are as they were recorded"
        yield Text(f"identical: {found.ticks} ticks of {found.nodes} nodes; {what}", "bold green")
        return
    if found.first is None:
        yield Text(f"the first {found.ticks} of {found.of_ticks} ticks are identical", "bold")
        return
    where = f"tick {found.first.tick} ({found.first.time_s:.1f} s)"
    yield Text.assemble(("it differs first at ", "bold"), (where, "bold red"))
    yield from (Text(f"  because {cause}", "bold") for cause in found.causes)


def _node(node: NodeDifference, run: PastRun) -> str:
    index = run.index.indices[node.path]
    return f"{run.names.short(index)}: was {node.recorded}, is {node.now}  {run.names.where(index)}"


def _write(write: WriteDifference, run: PastRun) -> str:
    path, _, name = write.key.rpartition(":")
    was, now = write.recorded or "not written", write.now or "not written"
    return f"{name} (of {run.names.of_path(path)}): was {was}, is {now}"


def _later(found: Retick, run: PastRun) -> Iterator[Text]:
    if not found.later_ticks:
        return
    nodes = [f"{run.names.of_path(path)} {times}" for path, times in found.later_nodes]
    shown = ", ".join(nodes[:_MANY]) + (f" and {len(nodes) - _MANY} more" if nodes[_MANY:] else "")
    ticks = (
        "1 later tick differs"
        if found.later_ticks == 1
        else f"{found.later_ticks} later ticks differ"
    )
    yield Text(f"{ticks}; nodes, and in how many of them: {shown}", "bright_black")


def _outside(outside: Outside, run: PastRun) -> Text:
    name = run.names.of_path(outside.path)
    return Text(f"outside the recording: {name} is asked in tick {outside.tick}; {outside.why}")


def _some(lines: list[str], what: str) -> Iterator[Text]:
    yield from (Text(f"  {line}") for line in lines[:_MANY])
    if len(lines) > _MANY:
        yield Text(f"  and {len(lines) - _MANY} more {what}")
