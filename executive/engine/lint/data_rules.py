"""Rules about keys and ports."""

from collections.abc import Iterator
from itertools import combinations

from executive.engine.lint.findings import PortSpot, Rule, Spot
from executive.engine.lint.outcomes import traits
from executive.engine.lint.subject import Subject


def _parallel_writers(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        if not traits(node).concurrent:
            continue
        for first, second in combinations(node.children, 2):
            both = subject.written_below(first) & subject.written_below(second)
            for key in sorted(both):
                message = f"${key} is written here and in {first.name!r} at the same time"
                yield Spot(second, f"{message}; try a key for each")


def _never_read(subject: Subject) -> Iterator[Spot]:
    read = frozenset().union(*(subject.reads(node) for node, _ in subject.nodes()))
    for node, _ in subject.nodes():
        for gives in subject.wirings[node].written:
            if gives.key not in read and gives.key not in subject.tree.outputs:
                yield Spot(node, f"${gives.key} is written, but nothing reads it", gives.at)


def _unused_input(subject: Subject) -> Iterator[PortSpot]:
    read = frozenset().union(*(subject.reads(node) for node, _ in subject.nodes()))
    for name in subject.tree.inputs:
        if name not in read:
            yield PortSpot("in", name, f"nothing reads the input {name!r}; drop it")


def _uncertain_output(subject: Subject) -> Iterator[PortSpot]:
    certain, root = subject.certain, subject.tree.root
    for name in subject.tree.outputs:
        if not certain.on_success(root, name):
            where = certain.gap(root, name)
            path = f", for one by {where.path}" if where is not root else ""
            message = f"output {name!r} is not written on every way to success{path}"
            yield PortSpot("out", name, f"{message}; write it there, or set it first")


PARALLEL_WRITERS = Rule(
    "L201",
    "parallel writers",
    "Two children of a parallel write one key: who wrote last is chance.",
    _parallel_writers,
)
NEVER_READ = Rule(
    "L202",
    "key never read",
    "A key that is written, but that nothing in the tree reads and no output gives out.",
    _never_read,
)
UNUSED_INPUT = Rule(
    "L203",
    "input never used",
    "A declared input that no node reads: whoever uses the tree thinks that it matters.",
    _unused_input,
)
UNCERTAIN_OUTPUT = Rule(
    "L204",
    "output not always written",
    "The tree can succeed without having written one of its outputs; whoever reads it gets an "
    "old value, or none.",
    _uncertain_output,
)
