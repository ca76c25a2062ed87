"""From a checked mission to a tree that ticks: py_trees nodes, bound devices, one blackboard.

A subtree is no node of its own: its root stands in its place, under the name of the node
that uses it, and sees the ports that were wired there under its own names.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from py_trees.behaviour import Behaviour
from py_trees.behaviours import Failure

from executive.core.clock import Clock, MissionClock
from executive.core.errors import DocumentError, Fault, InputError
from executive.core.registry import closest
from executive.core.skill import input_ports
from executive.engine.blackboard import Blackboard
from executive.engine.checkpoints.node import CheckpointGate, CheckpointSignal
from executive.engine.language.fitting import fit
from executive.engine.language.node_models import SkillNode, SubtreeNode
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.scope import Scope
from executive.engine.language.values import Literal, fitted, parse_value
from executive.engine.loading.loader import Mission, Program
from executive.engine.loading.wiring import label
from executive.engine.nodes.activations import starting_with
from executive.engine.nodes.assembly import Site, assemble, guard
from executive.engine.nodes.devices import bind
from executive.engine.nodes.skill_node import SkillBehaviour
from executive.engine.nodes.supervision import Supervision


@dataclass(frozen=True, slots=True, eq=False)
class NodeInfo:
    """What is known about one node before the first tick.

    Attributes:
        index: Place in `BuiltTree.nodes`, depth first, parents before children.
        path: Names from the root down to it, the same for no two nodes.
        name: Its own name.
        kind: `skill`, `sequence`, `when`, ...; `guard` for the conditions around a node.
        type: Name of its skill, the kind otherwise.
        tree: Name of the tree that it stands in.
        parent: Index of its parent, None for the root.
        file: File that it stands in.
        line: Line, counted from 1.
        column: Column, counted from 1.
        acts: Whether it is a skill that moves something.
        behaviour: The node itself.
    """

    index: int
    path: str
    name: str
    kind: str
    type: str
    tree: str
    parent: int | None
    file: str
    line: int
    column: int
    acts: bool
    behaviour: Behaviour


@dataclass(frozen=True, slots=True, eq=False)
class BuiltTree:
    """A tree that can be ticked.

    Attributes:
        root: The root node.
        nodes: Every node, depth first.
        blackboard: Its values.
        checkpoints: Says when a node with a checkpoint is about to start.
        clock: The cell's clock less pauses, which the runner tells it.
        supervision: What its leaves answer to.
        scope: The names of the outermost tree.
        output_names: Outputs that it declares.
    """

    root: Behaviour
    nodes: tuple[NodeInfo, ...]
    blackboard: Blackboard
    checkpoints: CheckpointSignal
    clock: MissionClock
    supervision: Supervision
    scope: Scope
    output_names: tuple[str, ...]

    def outputs(self) -> Mapping[str, object]:
        """Return the declared outputs that have been written so far, by name."""
        return MappingProxyType(
            {name: self.scope[name] for name in self.output_names if name in self.scope}
        )


def build(
    program: Program,
    *,
    devices: Mapping[str, object],
    clock: Clock,
    inputs: Mapping[str, object] = MappingProxyType({}),
    seed: int = 0,
    blackboard: Blackboard | None = None,
) -> BuiltTree:
    """Build a checked mission or tree.

    Args:
        program: What to build.
        devices: Devices of the cell, by name.
        clock: The cell's clock; timeouts and delays are on it, less pauses.
        inputs: Values of its inputs by name: as in YAML, or of the declared type.
        seed: Seed of the run, for nodes that leave things to chance.
        blackboard: Where its values go; an empty one, its own if None.

    Raises:
        InputError: An input is unknown, missing or does not fit.
        DocumentError: Skills ask for devices that the cell does not have.
    """
    blackboard = Blackboard() if blackboard is None else blackboard
    scope = Scope(program.tree.name, blackboard)
    for name, value in _inputs(program.tree, inputs).items():
        scope.write(name, value, writer="")
    scope.keep(program.tree.document.keep)
    mission_clock, supervision = MissionClock(clock), _supervision(program)
    builder = _Builder(program, devices, mission_clock, blackboard, supervision, seed)
    root = builder.build(program.tree.root, _Place(program.tree.name, None, scope, program.tree))
    if builder.faults:
        raise DocumentError(sorted(set(builder.faults)))
    nodes = tuple(node for node in builder.nodes if node is not None)
    return BuiltTree(
        root,
        nodes,
        blackboard,
        builder.checkpoints,
        mission_clock,
        supervision,
        scope,
        tuple(program.tree.outputs),
    )


def _supervision(program: Program) -> Supervision:
    if not isinstance(program, Mission):
        return Supervision()
    document = program.document
    return Supervision(document.on_error, budget_s=1.0 / document.tick_hz)


def _inputs(tree: TreeSpec, given: Mapping[str, object]) -> dict[str, object]:
    for name in given:
        if name not in tree.inputs:
            raise InputError(
                f"{tree.name}: unknown input {name!r}; {closest(name, [*tree.inputs])}"
            )
    values = {}
    for name, port in tree.inputs.items():
        if name not in given and port.required:
            raise InputError(f"{tree.name}: input {name!r} is needed, and has no default")
        try:
            values[name] = fit(given.get(name, port.default), port.type)
        except ValueError as error:
            raise InputError(f"{tree.name}: input {name!r}: {error}") from None
    return values


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a node is put.

    Attributes:
        path: Its path.
        parent: Index of its parent.
        scope: Names that it sees.
        tree: Tree that it stands in.
    """

    path: str
    parent: int | None
    scope: Scope
    tree: TreeSpec

    @property
    def name(self) -> str:
        return self.path.rpartition("/")[2]


class _Builder:
    def __init__(
        self,
        program: Program,
        devices: Mapping[str, object],
        clock: Clock,
        blackboard: Blackboard,
        supervision: Supervision,
        seed: int,
    ) -> None:
        self._program, self._devices = program, devices
        self._clock, self._blackboard = clock, blackboard
        self._supervision, self._seed = supervision, seed
        self.nodes: list[NodeInfo | None] = []
        self.faults: list[Fault] = []
        self.checkpoints = CheckpointSignal()
        self._paths_around: set[str] = set()
        self._owners = {program.tree.name}

    def build(self, spec: NodeSpec, place: _Place) -> Behaviour:
        """Build a node and everything below it."""
        if not spec.model.guards and not spec.model.endings:
            return self._unguarded(spec, place)
        index = self._reserve()
        child = self._unguarded(spec, _Place(place.path, index, place.scope, place.tree))
        behaviour = guard(spec.model, place.name, place.path, child, place.scope)
        path = self._path_around(place.path, "guard")
        site = _Place(path, place.parent, place.scope, place.tree)
        self._fill(index, spec, site, behaviour, "guard")
        return behaviour

    def _path_around(self, path: str, kind: str) -> str:
        """Return the path of a node around one; a subtree and its root may both have some."""
        path = f"{path}.{kind}"
        while path in self._paths_around:
            path = f"{path}.{kind}"
        self._paths_around.add(path)
        return path

    def _unguarded(self, spec: NodeSpec, place: _Place) -> Behaviour:
        if not spec.model.checkpoint:
            return self._bare(spec, place)
        index = self._reserve()
        child = self._bare(spec, _Place(place.path, index, place.scope, place.tree))
        gate = CheckpointGate(place.name, child, index=index, signal=self.checkpoints)
        path = self._path_around(place.path, CheckpointGate.KIND)
        site = _Place(path, place.parent, place.scope, place.tree)
        self._fill(index, spec, site, gate, CheckpointGate.KIND)
        return gate

    def _bare(self, spec: NodeSpec, place: _Place) -> Behaviour:
        if isinstance(spec.model, SubtreeNode):
            return self._subtree(spec.model, place)
        index = self._reserve()
        if isinstance(spec.model, SkillNode):
            behaviour: Behaviour = self._skill(spec, spec.model, place)
        else:
            children = [
                self.build(
                    child, _Place(f"{place.path}/{child.name}", index, place.scope, place.tree)
                )
                for child in spec.children
            ]
            names = [child.name for child in spec.children]
            site = Site(
                place.name,
                place.path,
                place.scope,
                self._clock,
                self._supervision,
                children,
                names,
                self._seed,
            )
            behaviour = assemble(spec.model, site)
        self._fill(index, spec, place, behaviour, spec.model.kind)
        return behaviour

    def _owner(self, path: str, tree: TreeSpec) -> str:
        """Return what the keys of a tree begin with; at its root another may stand already."""
        owner = path if path not in self._owners else f"{path}.{tree.name}"
        self._owners.add(owner)
        return owner

    def _subtree(self, model: SubtreeNode, place: _Place) -> Behaviour:
        tree = self._program.subtrees[model.subtree]
        scope = Scope(self._owner(place.path, tree), self._blackboard)
        wired = {name: parse_value(raw) for name, raw in model.in_.items()}
        for name, port in tree.inputs.items():
            value = fitted(wired.get(name, Literal(port.default)), port.type)
            scope.bind_input(name, value, place.scope, port.default)
        for name, reference in model.out.items():
            scope.bind_output(name, reference.removeprefix("$"), place.scope)
        scope.keep(tree.document.keep)
        root = self.build(tree.root, _Place(place.path, place.parent, scope, tree))
        return starting_with(root, scope.start_anew)

    def _skill(self, spec: NodeSpec, model: SkillNode, place: _Place) -> Behaviour:
        skill = self._program.skills.get(model.skill)
        bound, problems = bind(skill, self._devices)
        self.faults += [spec.fault(problem, "skill") for problem in problems]
        if problems:
            return Failure(place.name)  # the tree is not going to be ticked
        ports = input_ports(skill)
        wired = {name: parse_value(raw) for name, raw in model.in_.items()}
        return SkillBehaviour(
            place.name,
            place.path,
            skill(**bound),
            scope=place.scope,
            inputs={name: fitted(value, ports[name].type) for name, value in wired.items()},
            defaults={name: port.default for name, port in ports.items() if not port.required},
            outputs={port: key.removeprefix("$") for port, key in model.out.items()},
            ports=skill.OUT,
            supervision=self._supervision,
            budget_s=model.budget_s,
        )

    def _reserve(self) -> int:
        self.nodes.append(None)
        return len(self.nodes) - 1

    def _fill(
        self, index: int, spec: NodeSpec, place: _Place, behaviour: Behaviour, kind: str
    ) -> None:
        line, column = spec.mark
        runs_skill = isinstance(spec.model, SkillNode) and kind == SkillNode.kind
        acts = runs_skill and self._program.skills.get(label(spec.model)).ACTS
        self.nodes[index] = NodeInfo(
            index=index,
            path=place.path,
            name=behaviour.name,
            kind=kind,
            type=label(spec.model) if runs_skill else kind,
            tree=place.tree.name,
            parent=place.parent,
            file=spec.source.file,
            line=line,
            column=column,
            acts=acts,
            behaviour=behaviour,
        )
