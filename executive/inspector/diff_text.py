"""How two runs differ, for a terminal: the first divergence first."""

from collections.abc import Iterator
from pathlib import PurePath

from rich.text import Text

from executive.inspector.diff import NOT_AGAIN, Consequence, DiffKind, Divergence, RunDiff
from executive.inspector.past import PastRun

_MANY = 12


def diff_lines(diff: RunDiff, run: PastRun) -> Iterator[Text]:
    """Return the lines of a comparison; names are those of the first run."""
    if not diff.first:
        yield Text("equal: same outcomes, values and timing", "bold green")
        yield from (Text(f"  although {line}") for line in diff.before)
        return
    first, *others = diff.first
    yield Text.assemble(("they differ first in ", "bold"), (_headline(first, run), "bold red"))
    yield from _detail(first, run)
    if diff.before:
        yield Text("before the first tick:", "bright_black")
        yield from (Text(f"  {line}") for line in diff.before)
    else:
        yield Text("nothing differed before the first tick", "bright_black")
    for other in others:
        yield Text.assemble(("then in ", "bright_black"), _headline(other, run))
        yield from _detail(other, run)
    yield from _later(diff, run)
    yield Text.assemble(("A ", "bold"), diff.ends[0])
    yield Text.assemble(("B ", "bold"), diff.ends[1])


def _headline(found: Divergence, run: PastRun) -> str:
    if found.kind is DiffKind.VALUE:
        path, _, name = found.name.rpartition(":")
        subject = f"the value of {name} (of {PurePath(path).name})"
    else:
        word = "the outcome" if found.kind is DiffKind.OUTCOME else "the timing"
        subject = f"{word} of {run.names.of_path(found.name)}"
    return f"{subject}, at {_tick(found.a.tick)} of A and {_tick(found.b.tick)} of B"


def _tick(tick: int | None) -> str:
    return "no tick" if tick is None else f"tick {tick}"


def _detail(found: Divergence, run: PastRun) -> Iterator[Text]:
    yield Text(f"  {found.detail}")
    node = run.index.indices.get(found.name)
    if found.kind is DiffKind.VALUE:
        yield Text(f"  {found.a.what} in A, {found.b.what} in B")
    elif found.kind is DiffKind.OUTCOME and NOT_AGAIN in (found.a.what, found.b.what):
        yield Text("  one run did not come to it: what was decided before made the difference")
    elif found.kind is DiffKind.OUTCOME and found.inputs:
        names = ", ".join(key.rpartition(":")[2] for key in found.inputs)
        yield Text(f"  it had read other values: {names}")
    elif found.kind is DiffKind.OUTCOME:
        yield Text("  from the same recorded inputs: the cell, chance or time made the difference")
    if node is not None:
        yield Text(f"  {run.names.where(node)}", "bright_black")


def _later(diff: RunDiff, run: PastRun) -> Iterator[Text]:
    count = len(diff.consequences)
    if not count:
        return
    yield Text(f"in all, {count} leaves ended otherwise:", "bright_black")
    for found in diff.consequences[:_MANY]:
        yield Text(f"  {run.names.of_path(found.path)}: {_ends(found)}")
    if count > _MANY:
        yield Text(f"  and {count - _MANY} more")


def _ends(found: Consequence) -> str:
    parts = [f"{found.matched} alike"]
    parts += [f"only in A {_counted(found.only_a)}"] if found.only_a else []
    parts += [f"only in B {_counted(found.only_b)}"] if found.only_b else []
    return ", ".join(parts)


def _counted(words: tuple[str, ...]) -> str:
    return ", ".join(f"{words.count(word)} x {word}" for word in dict.fromkeys(words))
