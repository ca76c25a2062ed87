"""What each node of a tree reads and writes, gathered before the first tick."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args, get_origin
from typing import Literal as WordsOf

from executive.core.errors import Fault, InputError
from executive.core.registry import closest
from executive.core.skill import Port
from executive.engine.language.amounts import FOREVER, Limits, amounts_of
from executive.engine.language.block_models import CasesBody, ForEachBody, ObserveBody
from executive.engine.language.counts import NodeCounts
from executive.engine.language.evaluation import WRITTEN
from executive.engine.language.expression import Expression, parse_expression
from executive.engine.language.fitting import fit
from executive.engine.language.node_models import (
    NodeModel,
    SetNode,
    SkillNode,
    SubtreeNode,
    UnsetNode,
    WaitForNode,
    WhenNode,
)
from executive.engine.language.outline import NodeSpec
from executive.engine.language.values import Literal, Value, key_of, parse_value
from executive.engine.loading.nodeports import PortTable
from executive.engine.ticks import NodeStatus


@dataclass(frozen=True, slots=True, eq=False)
class Use:
    """A place where a node reads keys.

    Attributes:
        value: What is read; a single key or an expression.
        at: Keys in the file that lead to it from the node.
        port: The input that it goes to, None for a condition or an assignment.
        name: What a message calls the place.
        is_condition: Whether it must be true or false.
        optional: Whether the key may be without a value, because the input has a default.
        cases: What the value is compared with, by a `switch`.
    """

    value: Expression
    at: tuple[str, ...]
    port: Port | None
    name: str
    is_condition: bool = False
    optional: bool = False
    cases: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Gives:
    """A key that a node writes.

    Attributes:
        key: The key.
        at: Keys in the file that lead to it from the node.
        port: The output that it comes from, None for an assignment or an item.
        value: The expression that it gets, None for an output.
        item_of: The list that it is an item of, None for anything else.
    """

    key: str
    at: tuple[str, ...]
    port: Port | None = None
    value: Expression | None = None
    item_of: Expression | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Wiring:
    """Everything that one node reads and writes.

    Attributes:
        node: The node.
        uses: What it reads, in order.
        gives: What it writes when it succeeds.
        ends: What it may write however it ends: outputs of a subtree, `on_...`, an item.
    """

    node: NodeSpec
    uses: tuple[Use, ...]
    gives: tuple[Gives, ...]
    ends: tuple[Gives, ...]

    @property
    def written(self) -> tuple[Gives, ...]:
        """All that it may write."""
        return self.gives + self.ends


def wire(node: NodeSpec, ports: PortTable, faults: list[Fault]) -> Wiring:
    """Return what a node reads and writes; what is wrong with it is added to `faults`."""
    return _Wirer(node, faults).wire(ports)


class _Wirer:
    def __init__(self, node: NodeSpec, faults: list[Fault]) -> None:
        self._node, self._faults = node, faults
        self._uses: list[Use] = []
        self._gives: list[Gives] = []
        self._ends: list[Gives] = []

    def wire(self, ports: PortTable) -> Wiring:
        model = self._node.model
        for key, text in model.guards.items():
            self._condition(key, text)
        match model:
            case SkillNode() | SubtreeNode():
                self._leaf(model, ports)
            case WhenNode(when=text):
                self._condition("when", text)
            case WaitForNode(wait_for=text):
                self._condition("wait_for", text)
            case UnsetNode():
                self._unset(model)
            case CasesBody():
                self._cases(model)
            case ObserveBody():
                self._observe(model)
            case SetNode(set=assignments):
                self._gives += self._assignments("set", assignments)
            case ForEachBody():
                self._for_each(model)
        for key, raw, limits in amounts_of(model):
            self._amount(key, raw, limits)
        for key, assignments in model.endings.items():
            self._ends += self._assignments(key, assignments)
        return Wiring(self._node, tuple(self._uses), tuple(self._gives), tuple(self._ends))

    def _complain(self, message: str, *at: str) -> None:
        self._faults.append(self._node.fault(message, *at))

    def _condition(self, key: str, text: str) -> None:
        if expression := self._expression(text, key):
            self._uses.append(Use(expression, (key,), None, key, is_condition=True))

    def _expression(self, text: str, *at: str) -> Expression | None:
        try:
            return parse_expression(text)
        except InputError as error:
            self._complain(f"{'/'.join(at)}: {error}", *at)
            return None

    def _assignments(self, kind: str, assignments: Mapping[str, str]) -> Iterator[Gives]:
        for key, text in assignments.items():
            expression = self._expression(text, kind, key)
            if expression is not None:
                self._uses.append(Use(expression, (kind, key), None, f"{kind}/{key}"))
                yield Gives(key, (kind, key), value=expression)

    def _amount(self, key: str, raw: object, limits: Limits) -> None:
        value = self._value(raw, key) if isinstance(raw, str) and raw != FOREVER else None
        if not isinstance(value, Expression):
            return
        if value.reads or value.asks:
            port = Port(limits.type, unit=limits.unit)
            self._uses.append(Use(value, (key,), port, key))
            return
        try:
            limits.check(value.evaluate({}))
        except InputError as error:
            self._complain(f"{key}: {error}", key)

    def _unset(self, model: UnsetNode) -> None:
        for key in model.keys:
            asked = parse_expression(f"{WRITTEN}({key})")
            self._uses.append(Use(asked, ("unset",), None, "unset"))

    def _cases(self, model: CasesBody) -> None:
        if expression := self._expression(model.on, "on"):
            cases = tuple(model.cases)
            self._uses.append(Use(expression, ("on",), None, "on", cases=cases))

    def _observe(self, model: ObserveBody) -> None:
        kinds = {"status": (model.status, NodeStatus), "counts": (model.counts, NodeCounts)}
        for field, (reference, kind) in kinds.items():
            if reference is not None:
                key = reference.removeprefix("$")
                self._ends.append(Gives(key, (field,), port=Port(kind)))

    def _for_each(self, model: ForEachBody) -> None:
        value = self._value(model.in_, "in")
        items: Expression | None = None
        if isinstance(value, Expression):
            items = value
            self._uses.append(Use(items, ("in",), Port(list[Any], "the list"), "in"))
        elif isinstance(value, Literal) and not isinstance(value.value, list):
            self._complain(f"in: expected a list, got {value.value!r}", "in")
        self._ends.append(Gives(model.item.removeprefix("$"), ("item",), item_of=items))

    def _value(self, raw: object, *at: str) -> Value | None:
        try:
            return parse_value(raw)
        except InputError as error:
            self._complain(f"{'/'.join(at)}: {error}", *at)
            return None

    def _leaf(self, model: SkillNode | SubtreeNode, table: PortTable) -> None:
        ports = table.of(self._node)
        what = f"{model.kind} {getattr(model, model.kind)!r}"
        inputs = ports.inputs if ports else None
        outputs = ports.outputs if ports else None
        for name, raw in model.in_.items():
            self._input(name, raw, inputs, what)
        for name, port in (inputs or {}).items():
            if port.required and name not in model.in_:
                self._complain(f"{what} needs the input {name!r}, which is not given")
        written = self._ends if isinstance(model, SubtreeNode) else self._gives
        for name, reference in model.out.items():
            written += self._output(name, reference, outputs, what)

    def _input(self, name: str, raw: object, ports: Mapping[str, Port] | None, what: str) -> None:
        value = self._value(raw, "in", name)
        if ports is not None and name not in ports:
            self._complain(f"{what} has no input {name!r}; {closest(name, [*ports])}", "in", name)
            return
        port = ports[name] if ports is not None else Port(Any)
        if isinstance(value, Literal):
            try:
                fit(value.value, port.type)
            except ValueError as error:
                self._complain(f"input {name!r}: {error}{_hint(raw, port.type)}", "in", name)
        elif value is not None:
            optional = not port.required and key_of(value) is not None
            place = f"input {name!r}"
            self._uses.append(Use(value, ("in", name), port, place, optional=optional))

    def _output(
        self, name: str, reference: str, ports: Mapping[str, Port] | None, what: str
    ) -> Iterator[Gives]:
        if ports is not None and name not in ports:
            self._complain(f"{what} has no output {name!r}; {closest(name, [*ports])}", "out", name)
            return
        port = ports[name] if ports is not None else Port(Any)
        yield Gives(reference.removeprefix("$"), ("out", name), port=port)


def _hint(raw: object, kind: Any) -> str:
    """Say what may have been meant by a text: a word of the type, or the key of that name."""
    words = [str(word) for word in get_args(kind)] if get_origin(kind) is WordsOf else []
    if isinstance(raw, str) and (meant := closest(raw, words)).startswith("did you mean"):
        return f"; {meant}"
    is_name = isinstance(raw, str) and raw.isidentifier()
    return f"; try ${raw} for the key of that name" if is_name else ""


def label(model: NodeModel) -> str:
    """Return what a node runs: the name of its skill or tree, its kind otherwise."""
    if isinstance(model, (SkillNode, SubtreeNode)):
        return str(getattr(model, model.kind))
    return model.kind
