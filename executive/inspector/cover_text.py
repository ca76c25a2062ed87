"""What runs have covered, for a terminal: the share first, then what is missing."""

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from executive.inspector.cover import Cover, NodeCover, by_file
from executive.inspector.names import shortest_suffixes


def cover_lines(cover: Cover) -> Iterator[str]:
    """Return the lines of a report on coverage."""
    runs = f"{len(cover.runs)} run{'s' if len(cover.runs) > 1 else ''}"
    yield (
        f"{cover.percent:.0f} % covered: {cover.covered} of {cover.total} branches of "
        f"{cover.mission}, in {runs}"
    )
    for file, nodes in by_file(cover).items():
        covered, total = sum(n.covered for n in nodes), sum(len(n.taken) for n in nodes)
        never = sum(not node.started for node in nodes)
        asleep = f", {never} of {len(nodes)} nodes never ran" if never else ""
        yield f"  {PurePath(file).name}: {covered} of {total}{asleep}"
    yield from _retries(cover.nodes)
    names = dict(
        zip(
            (node.path for node in cover.nodes),
            shortest_suffixes([node.path for node in cover.nodes]),
            strict=True,
        )
    )
    missing = [node for node in cover.nodes if node.missing]
    if missing:
        yield "not covered:"
    for node in sorted(missing, key=lambda node: (PurePath(node.file).name, node.line)):
        what = missing_text(node)
        yield f"  {PurePath(node.file).name}:{node.line}  {names[node.path]}: {what}"


def missing_text(node: NodeCover) -> str:
    """Return what was not taken of a node."""
    return "; ".join(node.missing) if node.started else "never ran"


def _retries(nodes: Sequence[NodeCover]) -> Iterator[str]:
    for node in nodes:
        if node.attempts:
            used = ", ".join(f"{count} x {number}" for number, count in node.attempts.items())
            yield f"  attempts used by {node.path.rpartition('/')[2]}: {used}"
