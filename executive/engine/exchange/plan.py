"""What the documents of an import are called, and what ports their trees and stubs have."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from executive.core.errors import Fault
from executive.core.registry import Registry
from executive.core.skill import Skill, input_ports
from executive.engine.exchange.cpptypes import guess_type, our_type
from executive.engine.exchange.dataflow import (
    Access,
    Dataflow,
    Entry,
    Scope,
    key_in,
    node_id,
    ports_of,
    subtree_of,
    wired_ports,
)
from executive.engine.exchange.foreign import Direction, ForeignPort, ForeignTrees, NodeModel
from executive.engine.exchange.markup import Element
from executive.engine.exchange.naming import Namer, our_name
from executive.engine.exchange.vocabulary import PORTS, REFUSED
from executive.engine.language.porttypes import type_name


@dataclass(frozen=True, slots=True)
class PlannedPort:
    """A port of a tree or a stub.

    Attributes:
        direction: Whether it is read, written, or both.
        type: Its type in our words.
        about: One line for people.
        default: Text of its default, None where it has none.
    """

    direction: Direction
    type: str = "any"
    about: str = ""
    default: str | None = None


@dataclass(slots=True)
class Plan:
    """Names and ports of everything that is written.

    Attributes:
        trees: The foreign trees.
        flow: Who reads and writes which key.
        skills: Skills that are at hand.
        keys: Names of keys.
        tree_names: Names of trees.
        skill_names: Names of skills, by the foreign ID.
        ports: Ports of each tree by foreign ID and key.
        stubs: Ports of each skill that is not at hand, by foreign ID.
        notes: What means less, or was taken for granted.
        faults: What is refused.
    """

    trees: ForeignTrees
    flow: Dataflow
    skills: Registry[type[Skill]]
    keys: Namer = field(default_factory=lambda: Namer("key"))
    tree_names: Namer = field(default_factory=lambda: Namer("tree"))
    skill_names: Namer = field(default_factory=lambda: Namer("skill"))
    ports: dict[str, dict[str, PlannedPort]] = field(default_factory=dict)
    stubs: dict[str, dict[str, PlannedPort]] = field(default_factory=dict)
    notes: list[Fault] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    def refuse(self, element: Element, message: str) -> None:
        """Put a fault at an element on record."""
        self.faults.append(element.fault(message))

    def note(self, element: Element, message: str) -> None:
        """Put on record what is different here."""
        self.notes.append(element.fault(message))


def with_skills_at_hand(trees: ForeignTrees, skills: Registry[type[Skill]]) -> None:
    """Take the ports of nodes that are skills of ours from those."""
    for tree in trees.trees.values():
        for element in tree.walk():
            name = node_id(element)
            if our_name(name) in skills and name not in PORTS and name not in trees.trees:
                trees.models[name] = NodeModel(name, "Action", _ports_of_skill(skills, name))


def _ports_of_skill(skills: Registry[type[Skill]], name: str) -> dict[str, ForeignPort]:
    skill = skills.get(our_name(name))
    ports = {
        port: ForeignPort("in", type_name(each.type), None, each.about)
        for port, each in input_ports(skill).items()
    }
    for port, each in skill.OUT.items():
        ports[port] = ForeignPort("out", type_name(each.type), None, each.about)
    return ports


def make_plan(trees: ForeignTrees, flow: Dataflow, skills: Registry[type[Skill]]) -> Plan:
    """Work out names and ports."""
    plan = Plan(trees, flow, skills)
    plan.notes += [*trees.notes, *flow.notes]
    plan.faults += [*trees.faults, *flow.faults]
    for tree in trees.trees:
        plan.tree_names(tree)
        plan.ports[tree] = _tree_ports(tree, plan)
    for tree, element in trees.trees.items():
        for below in element.children[0].walk():
            if is_custom(below, trees) and subtree_of(below, trees) is None:
                _add_stub(plan, below, tree)
    return plan


def is_custom(element: Element, trees: ForeignTrees) -> bool:
    """Return whether an element runs a leaf that only its maker defines."""
    name = node_id(element)
    model = trees.models.get(name)
    if name in PORTS or name in REFUSED or element.children or not name:
        return False
    return model is None or model.kind in ("Action", "Condition")


def _add_stub(plan: Plan, element: Element, tree: str) -> None:
    name = node_id(element)
    if our_name(name) in plan.skills:
        return
    plan.skill_names(name)
    declared = ports_of(element, plan.trees)
    ports = plan.stubs.setdefault(name, {})
    for port, each in declared.items():
        ports[port] = PlannedPort(each.direction, our_type(each.type), each.about, each.default)
    for port, text in wired_ports(element, plan.trees):
        if port not in declared:
            kind = _inferred(plan, tree, port, text)
            direction = plan.flow.direction(element, port)
            known = ports.get(port)
            same = known is None or known.type == kind
            ports[port] = PlannedPort(direction, kind if same else "any")


def _inferred(plan: Plan, tree: str, port: str, text: str) -> str:
    key = key_in(text, port)
    return guess_type(text) if key is None else key_type(plan, tree, key)


def key_type(plan: Plan, tree: str, key: str) -> str:
    """Return the type that the ports behind a key agree on, `any` where they do not."""
    entries = [
        scope.keys[key] for scope in plan.flow.scopes if scope.tree == tree and key in scope.keys
    ]
    return _agreed(access for entry in entries for access in entry.accesses)


def _agreed(accesses: Iterable[Access]) -> str:
    kinds = {access.type for access in accesses if access.type != "any"}
    return kinds.pop() if len(kinds) == 1 else "any"


def _tree_ports(tree: str, plan: Plan) -> dict[str, PlannedPort]:
    """Return the keys that a tree shares with the trees around it, or needs from outside."""
    ports: dict[str, PlannedPort] = {}
    for scope in plan.flow.scopes:
        if scope.tree != tree:
            continue
        for key, direction in _shared(scope, plan.flow):
            known = ports.get(key)
            if known is not None and known.direction != direction:
                direction = "inout"
            ports[key] = PlannedPort(direction, key_type(plan, tree, key))
    return ports


def _shared(scope: Scope, flow: Dataflow) -> Iterator[tuple[str, Direction]]:
    for key, entry in scope.keys.items():
        inside = scope.inside(entry)
        if inside and _crosses(scope, key, entry, flow):
            needs, gives = flow.reads(inside), flow.writes(inside)
            yield key, "inout" if needs and gives else "out" if gives else "in"


def _crosses(scope: Scope, key: str, entry: Entry, flow: Dataflow) -> bool:
    nobody_writes = not flow.writes(entry.accesses)
    if scope.outer is None:
        return nobody_writes and entry.literal is None
    if key in scope.remapped:
        return True
    is_outer = any(entry is other for other in scope.outer.keys.values())
    return is_outer and (nobody_writes or len(scope.inside(entry)) < len(entry.accesses))
