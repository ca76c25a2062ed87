"""Trees for timing ticks: each as one of ours, built from YAML, and as one of py_trees' nodes.

Both have the same shape and the same leaves, which run for as many ticks and end as a script
says that both read, and every leaf has one key of the blackboard that it writes when it
succeeds. So both do the same work, status for status.
"""

import json
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, ClassVar

import numpy as np
from py_trees.behaviour import Behaviour
from py_trees.behaviours import CheckBlackboardVariableValue
from py_trees.blackboard import Blackboard
from py_trees.common import Access, ComparisonExpression, ParallelPolicy, Status
from py_trees.composites import Composite, Parallel, Selector
from py_trees.composites import Sequence as SequenceNode
from py_trees.decorators import Inverter, Retry, Timeout

from executive.core.clock import ManualClock
from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import In, Port, Skill, SkillRun
from executive.engine.loading.loader import Program, load_program
from executive.engine.nodes.builder import BuiltTree, build

BLOCK_NODES = 9
FAILED = "bench.failed"
SUBTREE = "subtree"
DEEPEST_FILE = 100


@dataclass(frozen=True, slots=True)
class Node:
    """One node of a shape.

    Attributes:
        kind: As in YAML.
        name: Its name; a leaf that does something writes the key of this name.
        children: Its children.
        steps: How many ticks a leaf may run at most.
        fails: How often a leaf fails, as a share.
    """

    kind: str
    name: str
    children: tuple["Node", ...] = ()
    steps: int = 0
    fails: float = 0.0

    @property
    def size(self) -> int:
        """Number of nodes; a subtree is none itself."""
        return (self.kind != SUBTREE) + sum(child.size for child in self.children)


def cell(stations: int) -> Node:
    """Return stations side by side that do their cycles: 22 nodes each, and the root."""
    return Node("parallel", "cell", tuple(_station(f"st{i}") for i in range(stations)))


def _station(name: str) -> Node:
    def work(what: str, steps: int, fails: float = 0.0) -> Node:
        return Node("skill", f"{name}_{what}", (), steps, fails)

    def inner(kind: str, what: str, *children: Node) -> Node:
        return Node(kind, f"{name}_{what}", children)

    cycle = inner(
        "sequence",
        "cycle",
        work("look", 2),
        inner("retry", "retry", work("grasp", 8, 0.2)),
        inner("timeout", "in_time", work("move", 20)),
        inner("parallel", "both", work("left", 6), work("right", 9)),
        inner("inverter", "free", work("blocked", 1, 1.0)),
        inner("reactive_selector", "hold", inner("when", "held"), work("regrasp", 4)),
        work("place", 6, 0.1),
    )
    recovery = inner("sequence", "recover", work("open", 2), work("home", 12), work("report", 0))
    do = inner("selector", "do", cycle, recovery)
    return inner("reactive_sequence", "safely", inner("when", "safe"), do)


def blocks(nodes: int) -> Node:
    """Return blocks side by side nearly all of whose nodes are ticked every time."""
    amount = max(1, round((nodes - 1) / BLOCK_NODES))
    return Node("parallel", "cell", tuple(_block(f"b{i}") for i in range(amount)))


def _block(name: str) -> Node:
    def work(what: str, steps: int = 0, fails: float = 0.0) -> Node:
        return Node("skill", f"{name}_{what}", (), steps, fails)

    ways = Node("reactive_selector", f"{name}_ways", (work("a", 0, 1.0), work("b", 0, 0.1)))
    last = Node("sequence", f"{name}_last", (work("d", 6), work("e", 3)))
    guard = Node("when", f"{name}_guard")
    return Node("reactive_sequence", name, (guard, ways, work("c"), last))


def chain(depth: int) -> Node:
    """Return decorators one in another around one leaf, in as many files as that takes."""
    node = Node("skill", "leaf", (), 3)
    for level in range(1, depth):
        if level % DEEPEST_FILE == 0:
            node = Node(SUBTREE, node.name, (node,))
        node = Node("inverter", f"level{level}", (node,))
    return node


class Scripts:
    """How long each activation of each leaf takes and how it ends: by name, over and over."""

    def __init__(self, root: Node, seed: int) -> None:
        """Draw the scripts of all leaves."""
        rng = np.random.default_rng(seed)
        self.updates = 0
        self._scripts = {
            node.name: [
                (int(rng.integers(0, node.steps + 1)), bool(rng.random() >= node.fails))
                for _ in range(32)
            ]
            for node in _walk(root)
            if node.kind == "skill"
        }
        self._next = {name: count() for name in self._scripts}

    def draw(self, leaf: str) -> tuple[int, bool]:
        """Return how many ticks the next activation of a leaf runs, and whether it succeeds."""
        script = self._scripts[leaf]
        return script[next(self._next[leaf]) % len(script)]


def _walk(node: Node) -> list[Node]:
    return [node, *(below for child in node.children for below in _walk(child))]


class ScriptedSkill(Skill):
    """Do as the script says."""

    OUT: ClassVar = {"value": Port(int, "how long it ran")}
    REASONS: ClassVar = frozenset({FAILED})

    def __init__(self, scripts: Scripts) -> None:
        self._scripts = scripts

    def run(self, leaf: Annotated[str, In("its name")]) -> SkillRun:
        """Run, then end."""
        ticks, succeeds = self._scripts.draw(leaf)
        for _ in range(ticks):
            self._scripts.updates += 1
            yield
        self._scripts.updates += 1
        return success(value=ticks) if succeeds else failure(FAILED, "as the script says")


def our_tree(shape: Node, scripts: Scripts) -> BuiltTree:
    """Return a shape as a tree of ours, by way of a file (JSON is YAML), checks and builder."""
    return build(our_program(shape), devices={"scripts": scripts}, clock=ManualClock())


def our_program(shape: Node) -> Program:
    """Return a shape as a checked program."""
    skills: Registry[type[Skill]] = Registry("skill")
    skills.add("scripted", ScriptedSkill)
    with TemporaryDirectory() as name:
        folder = Path(name)
        _write(shape, folder)
        for node in _walk(shape):
            if node.kind == SUBTREE:
                _write(node.children[0], folder, node.name)
        file = folder / f"{shape.name}.yaml"
        return load_program(file, skills=skills, types=Registry("port type"))


def _write(shape: Node, folder: Path, name: str = "") -> None:
    root = _as_yaml(shape)
    next(iter(root.values())).pop("name")  # that of the tree
    inputs = {"safe": {"type": "int", "default": 1}}
    name = name or shape.name
    document = {"format": 1, "tree": name, "in": inputs, "root": root}
    (folder / f"{name}.yaml").write_text(json.dumps(document), encoding="utf-8")


_BODIES: dict[str, dict[str, Any]] = {
    "retry": {"times": 3},
    "timeout": {"seconds": 1e6},
    "parallel": {"succeed": "all", "fail": "any"},
}


def _as_yaml(node: Node) -> dict[str, Any]:
    if node.kind == "skill":
        out = {"value": f"${node.name}"}
        return {"skill": "scripted", "name": node.name, "in": {"leaf": node.name}, "out": out}
    if node.kind == "when":
        return {"when": "safe >= 1", "name": node.name}
    if node.kind == SUBTREE:
        return {SUBTREE: node.name}
    children = [_as_yaml(child) for child in node.children]
    below = {"child": children[0]} if node.kind in _DECORATORS else {"children": children}
    return {node.kind: {"name": node.name, **_BODIES.get(node.kind, {}), **below}}


class ScriptedBehaviour(Behaviour):  # type: ignore[misc]  # py_trees is untyped to mypy
    """Does as the script says, as py_trees' users write it."""

    def __init__(self, name: str, scripts: Scripts) -> None:
        super().__init__(name)
        self._scripts = scripts
        self._ticks, self._left, self._succeeds = 0, 0, True
        self._values = self.attach_blackboard_client(name)
        self._values.register_key("value", Access.WRITE, remap_to=f"/bench/{name}")

    def initialise(self) -> None:
        """Take the next entry of the script."""
        self._ticks, self._succeeds = self._scripts.draw(self.name)
        self._left = self._ticks

    def update(self) -> Status:
        """Run, then end."""
        self._scripts.updates += 1
        if self._left:
            self._left -= 1
            return Status.RUNNING
        if self._succeeds:
            self._values.value = self._ticks
            return Status.SUCCESS
        self.feedback_message = "as the script says"
        return Status.FAILURE


def their_tree(shape: Node, scripts: Scripts) -> Behaviour:
    """Return a shape as a tree of py_trees' nodes."""
    Blackboard.set("/bench/safe", 1)
    return _as_behaviour(shape, scripts)


_COMPOSITES: dict[str, Callable[[str, Sequence[Behaviour]], Composite]] = {
    "sequence": lambda name, children: SequenceNode(name, True, [*children]),
    "reactive_sequence": lambda name, children: SequenceNode(name, False, [*children]),
    "selector": lambda name, children: Selector(name, True, [*children]),
    "reactive_selector": lambda name, children: Selector(name, False, [*children]),
    "parallel": lambda name, children: Parallel(
        name, ParallelPolicy.SuccessOnAll(synchronise=True), [*children]
    ),
}
_DECORATORS: dict[str, Callable[[str, Behaviour], Behaviour]] = {
    "retry": lambda name, child: Retry(name, child, 3),
    "timeout": lambda name, child: Timeout(name, child, 1e6),
    "inverter": Inverter,
}


def _as_behaviour(node: Node, scripts: Scripts) -> Behaviour:
    if node.kind == "skill":
        return ScriptedBehaviour(node.name, scripts)
    if node.kind == "when":
        check = ComparisonExpression("/bench/safe", 1, operator.ge)
        return CheckBlackboardVariableValue(node.name, check)
    children = [_as_behaviour(child, scripts) for child in node.children]
    if node.kind == SUBTREE:
        return children[0]
    if node.kind in _DECORATORS:
        return _DECORATORS[node.kind](node.name, children[0])
    return _COMPOSITES[node.kind](node.name, children)
