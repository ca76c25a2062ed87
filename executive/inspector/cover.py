"""Which branches of a tree its runs have taken, merged over recordings of the same tree."""

import hashlib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce

from executive.core.errors import InputError
from executive.engine.recording.messages import SourceFile
from executive.engine.ticks import NodeStatus
from executive.inspector.branches import Counts, branches, taken
from executive.inspector.past import PastRun
from executive.inspector.times import attempts


@dataclass(frozen=True, slots=True)
class NodeCover:
    """What runs did with one node.

    Attributes:
        path: Path of the node.
        kind: Its kind.
        file: File that it stands in.
        line: Line, counted from 1.
        started: How often it started.
        succeeded: How often it succeeded.
        failed: How often it failed.
        halted: How often it was halted.
        running_ticks: Ticks after which it was RUNNING.
        taken: How often each of its branches was taken, 0 where it was not.
        attempts: For a retry, how often how many attempts were used.
    """

    path: str
    kind: str
    file: str
    line: int
    started: int
    succeeded: int
    failed: int
    halted: int
    running_ticks: int
    taken: dict[str, int]
    attempts: dict[int, int]

    @property
    def missing(self) -> tuple[str, ...]:
        """Branches that were not taken."""
        return tuple(branch for branch, count in self.taken.items() if not count)

    @property
    def covered(self) -> int:
        """How many of its branches were taken."""
        return len(self.taken) - len(self.missing)


@dataclass(frozen=True, slots=True)
class Cover:
    """What runs of one tree did with its nodes.

    Attributes:
        mission: Name of the mission.
        tree: Hash of the tree; runs of different trees are not merged.
        runs: The recordings.
        sources: The files that nodes stand in.
        nodes: Every node, in the order of the tree.
    """

    mission: str
    tree: str
    runs: tuple[str, ...]
    sources: tuple[SourceFile, ...]
    nodes: tuple[NodeCover, ...]

    @property
    def total(self) -> int:
        """How many branches there are."""
        return sum(len(node.taken) for node in self.nodes)

    @property
    def covered(self) -> int:
        """How many branches were taken."""
        return sum(node.covered for node in self.nodes)

    @property
    def percent(self) -> float:
        """Share of the branches that were taken [%]."""
        return 100.0 * self.covered / self.total if self.total else 100.0


def cover_run(run: PastRun) -> Cover:
    """Return what one run did with its tree."""
    header, files = run.recording.header, {node.file for node in run.index.nodes}
    sources = tuple(source for source in header.sources if source.file in files)
    nodes = tuple(_node_cover(run, node) for node in range(len(run.index.nodes)))
    return Cover(header.mission, tree_hash(run), (str(run.recording.path),), sources, nodes)


def tree_hash(run: PastRun) -> str:
    """Return a hash of a tree: of its nodes, and of the files that they stand in."""
    files = {node.file for node in run.index.nodes}
    sources = sorted(s.sha256 for s in run.recording.header.sources if s.file in files)
    nodes = [(node.path, node.kind, node.type, node.line) for node in run.index.nodes]
    return hashlib.blake2b(repr((sources, nodes)).encode(), digest_size=6).hexdigest()


def merged(covers: Iterable[Cover]) -> Cover:
    """Return what several runs of one tree did together.

    Raises:
        InputError: They are runs of different trees.
    """
    return reduce(_merge, covers)


def _merge(one: Cover, other: Cover) -> Cover:
    if one.tree != other.tree:
        raise InputError(
            f"{other.runs[0]}: a run of another tree ({other.mission} {other.tree}) than "
            f"{one.runs[0]} ({one.mission} {one.tree}); expected runs of one version of one "
            "tree; try cover on each tree by itself"
        )
    nodes = tuple(_merge_nodes(a, b) for a, b in zip(one.nodes, other.nodes, strict=True))
    return Cover(one.mission, one.tree, one.runs + other.runs, one.sources, nodes)


def _merge_nodes(one: NodeCover, other: NodeCover) -> NodeCover:
    return NodeCover(
        one.path,
        one.kind,
        one.file,
        one.line,
        one.started + other.started,
        one.succeeded + other.succeeded,
        one.failed + other.failed,
        one.halted + other.halted,
        one.running_ticks + other.running_ticks,
        {branch: count + other.taken[branch] for branch, count in one.taken.items()},
        dict(sorted((Counter(one.attempts) + Counter(other.attempts)).items())),
    )


def _node_cover(run: PastRun, node: int) -> NodeCover:
    recorded, index = run.index.nodes[node], run.index
    ends = [life.status for life in index.activations(node)]
    counts: Counts = taken(run, node) if ends else Counter()
    used = attempts(index, node) if recorded.kind == "retry" else []
    return NodeCover(
        path=recorded.path,
        kind=recorded.kind,
        file=recorded.file,
        line=recorded.line,
        started=len(ends),
        succeeded=ends.count(NodeStatus.SUCCESS),
        failed=ends.count(NodeStatus.FAILURE),
        halted=ends.count(NodeStatus.INVALID),
        running_ticks=int((index.statuses[:, node] == 1).sum()),
        taken={branch: counts[branch] for branch in branches(run, node)},
        attempts=dict(sorted(Counter(used).items())),
    )


def by_file(cover: Cover) -> dict[str, Sequence[NodeCover]]:
    """Return the nodes by the file that they stand in."""
    files: dict[str, list[NodeCover]] = {}
    for node in cover.nodes:
        files.setdefault(node.file, []).append(node)
    return dict(files)
