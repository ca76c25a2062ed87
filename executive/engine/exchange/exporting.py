"""Our trees as XML of BehaviorTree.CPP v4, or every reason why that cannot say them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from executive.core.errors import DocumentError, Fault, InputError
from executive.core.skill import Port, Skill, input_ports
from executive.engine.exchange.attributes import (
    comment_text,
    input_text,
    literal_text,
    milliseconds,
    plain_text,
    times_text,
)
from executive.engine.exchange.cpptypes import write_literal
from executive.engine.exchange.dataflow import key_in
from executive.engine.exchange.palette import foreign_id, skill_model, tree_model
from executive.engine.exchange.scripting import write_assignments, write_condition
from executive.engine.exchange.vocabulary import COUNTERPARTS, LOOPS, SWITCHES
from executive.engine.exchange.xmltext import XmlElement
from executive.engine.language.block_models import (
    ForEachBody,
    ParallelBody,
    ReactiveSwitchBody,
    RepeatBody,
    RetryBody,
    RunOnceBody,
    TimeoutBody,
)
from executive.engine.language.node_models import (
    NodeModel,
    SetNode,
    SkillNode,
    SubtreeNode,
    UnsetNode,
    WaitNode,
    WhenNode,
)
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.values import Literal, key_of, parse_value
from executive.engine.loading.loader import Program

_REFUSED: Final[Mapping[str, str]] = {
    "cooldown": "has no counterpart there; try a skill that refuses to start so soon",
    "wait_for": "has no counterpart there that waits between ticks; try a skill that waits",
    "chance": "has no counterpart there; try a skill that draws",
    "switch": "decides once, SwitchN there in every tick; try reactive_switch",
    "running_is_success": "has no counterpart there",
    "running_is_failure": "has no counterpart there",
    "observe": "has no counterpart there; try a logger of BehaviorTree.CPP",
}
_ENDS: Final[Mapping[str, str]] = {
    "on_success": "_onSuccess",
    "on_failure": "_onFailure",
    "on_halt": "_onHalted",
}
_ITEMS: Final = {"int": "int", "bool": "bool", "double": "float", "std::string": "str"}
_IN_ONE_TICK: Final = (
    "a child that answers at once is run again within one tick there, here in the next one"
)


@dataclass(frozen=True, slots=True)
class Exported:
    """What an export came to.

    Attributes:
        text: The XML.
        notes: What is different there.
    """

    text: str
    notes: tuple[Fault, ...]


def export_program(program: Program) -> Exported:
    """Export a tree or a mission with every subtree.

    Raises:
        DocumentError: Everything that BehaviorTree.CPP cannot say.
    """
    return _Export(program).run()


class _Export:
    def __init__(self, program: Program) -> None:
        self._program = program
        self._faults: list[Fault] = []
        self._notes: list[Fault] = []
        self._skills: dict[str, type[Skill]] = {}
        self._builders: Mapping[str, Callable[[NodeSpec, Any], XmlElement]] = self._table()

    def _table(self) -> dict[str, Callable[[NodeSpec, Any], XmlElement]]:
        return {
            **dict.fromkeys(COUNTERPARTS, self._plain),
            "skill": self._skill,
            "subtree": self._subtree,
            "when": self._when,
            "set": self._set,
            "unset": self._unset,
            "wait": self._wait,
            "fail": self._fail,
            "reactive_switch": self._switch,
            "parallel": self._parallel,
            "retry": self._retry,
            "repeat": self._repeat,
            "timeout": self._timeout,
            "for_each": self._for_each,
            "run_once": self._run_once,
        }

    def run(self) -> Exported:
        trees = [self._program.tree, *self._program.subtrees.values()]
        main = self._program.tree.name
        root = XmlElement("root", {"BTCPP_format": "4", "main_tree_to_execute": main})
        root.children = [self._tree(tree) for tree in trees]
        self._note_inputs(self._program.tree)
        skills = [skill_model(name, skill) for name, skill in sorted(self._skills.items())]
        models = [*skills, *map(tree_model, trees)]
        if models:
            root.children.append(XmlElement("TreeNodesModel", {}, models))
        if self._faults:
            raise DocumentError(self._faults)
        text = "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *root.lines()])
        return Exported(f"{text}\n", tuple(self._notes))

    def _tree(self, tree: TreeSpec) -> XmlElement:
        root = self._node(tree.root)
        if tree.document.keep:
            root = self._with_first_values(tree, root)
        comment = comment_text(tree.document.about)
        return XmlElement("BehaviorTree", {"ID": tree.name}, [root], comment=comment)

    def _with_first_values(self, tree: TreeSpec, root: XmlElement) -> XmlElement:
        """Set keys once, however often the tree starts: RunOnce is skipped ever after."""
        sets = []
        for key, value in tree.document.keep.items():
            try:
                sets.append(f"{key} := {write_condition(_as_expression(value))}")
            except InputError as error:
                self._refuse(tree.root, str(error))
        once = XmlElement("RunOnce", {}, [XmlElement("Script", {"code": "; ".join(sets)})])
        return XmlElement("Sequence", {}, [once, root])

    def _note_inputs(self, tree: TreeSpec) -> None:
        for name in tree.inputs:
            message = f"input {name!r}: C++ code sets {{{name}}} before the first tick there"
            line, column = tree.source.key_mark(("in", name))
            self._notes.append(Fault(tree.source.file, line, column, "", message))

    def _refuse(self, node: NodeSpec, message: str) -> None:
        self._faults.append(node.fault(message))

    def _note(self, node: NodeSpec, message: str) -> None:
        self._notes.append(node.fault(message))

    def _node(self, node: NodeSpec) -> XmlElement:
        model = node.model
        try:
            if model.kind not in self._builders:
                what = _REFUSED.get(model.kind, "has no counterpart there")
                raise InputError(f"{model.kind} {what}")
            built = self._builders[model.kind](node, model)
            if model.name:
                built.attributes = {**_named(built, model.name)}
            return self._guarded(model, built)
        except InputError as error:
            self._refuse(node, str(error))
            for child in node.children:  # what is wrong below is told in the same pass
                self._node(child)
            return XmlElement("AlwaysFailure")

    def _guarded(self, model: NodeModel, built: XmlElement) -> XmlElement:
        if model.about:
            built.attributes["_description"] = plain_text(model.about)
        if model.while_ is not None:
            asks = XmlElement("ScriptCondition", {"code": write_condition(model.while_)})
            built = XmlElement("ReactiveSequence", {}, [asks, built])
        if model.if_ is not None:
            built.attributes["_failureIf"] = write_condition(model.if_, turned=True)
        if model.unless is not None:
            built.attributes["_successIf"] = write_condition(model.unless)
        endings = model.endings
        if "on_start" in endings:
            raise InputError("on_start has no counterpart there; try a set before the node")
        for keyword, attribute in _ENDS.items():
            parts = [endings[k] for k in (keyword, "finally") if k in endings]
            if parts:
                built.attributes[attribute] = "; ".join(map(write_assignments, parts))
        return built

    def _children(self, node: NodeSpec) -> list[XmlElement]:
        return [self._node(child) for child in node.children]

    def _plain(self, node: NodeSpec, model: NodeModel) -> XmlElement:
        return XmlElement(COUNTERPARTS[model.kind], {}, self._children(node))

    def _skill(self, node: NodeSpec, model: SkillNode) -> XmlElement:
        skill = self._program.skills.get(model.skill)
        name = foreign_id(model.skill, skill)
        self._skills[name] = skill
        if model.budget_s is not None:
            self._note(node, "budget_s is left out: nothing watches the time of a step there")
        attributes = {"ID": name, **self._wires(model, input_ports(skill))}
        return XmlElement("Action", attributes)

    def _subtree(self, _: NodeSpec, model: SubtreeNode) -> XmlElement:
        tree = self._program.subtrees[model.subtree]
        attributes = {"ID": tree.name, **self._wires(model, tree.inputs)}
        for name, port in tree.inputs.items():
            if name not in model.in_ and not port.required:
                attributes[name] = literal_text(port.default, port)
        return XmlElement("SubTree", attributes)

    def _wires(self, model: SkillNode | SubtreeNode, ports: Mapping[str, Port]) -> dict[str, str]:
        wires: dict[str, str] = {}
        for name, raw in model.in_.items():
            if name == "name":
                raise InputError("an input called 'name' cannot be told from the node's name there")
            wires[name] = input_text(name, raw, ports[name])
        for name, reference in model.out.items():
            wires[name] = f"{{{reference.removeprefix('$')}}}"
        return wires

    def _when(self, _: NodeSpec, model: WhenNode) -> XmlElement:
        constant = {"true": "AlwaysSuccess", "false": "AlwaysFailure"}.get(model.when.strip())
        if constant:
            return XmlElement(constant)
        return XmlElement("ScriptCondition", {"code": write_condition(model.when)})

    def _set(self, _: NodeSpec, model: SetNode) -> XmlElement:
        return XmlElement("Script", {"code": write_assignments(model.set)})

    def _unset(self, _: NodeSpec, model: UnsetNode) -> XmlElement:
        each = [XmlElement("UnsetBlackboard", {"key": key}) for key in model.keys]
        return each[0] if len(each) == 1 else XmlElement("Sequence", {}, each)

    def _wait(self, _: NodeSpec, model: WaitNode) -> XmlElement:
        if model.wait == "forever":
            raise InputError("wait: forever has no counterpart there; try a skill that waits")
        return XmlElement("Sleep", {"msec": milliseconds(model.wait)})

    def _fail(self, node: NodeSpec, _: NodeModel) -> XmlElement:
        self._note(node, "the reason is left out: a node fails without one there")
        return XmlElement("AlwaysFailure")

    def _switch(self, node: NodeSpec, model: ReactiveSwitchBody) -> XmlElement:
        tag = f"Switch{len(model.cases)}"
        if tag not in SWITCHES:
            raise InputError(f"{len(model.cases)} cases; expected 2 to 6 there, try a selector")
        key = key_of(parse_value(f"${model.on}"))
        if key is None:
            raise InputError(f"on: {model.on!r} is no plain key; try to set one before")
        attributes = {"variable": f"{{{key}}}"}
        for i, text in enumerate(model.cases, start=1):
            if key_in(text, "") is not None:
                raise InputError(f"case {text!r} would be a key there")
            attributes[f"case_{i}"] = plain_text(text)
        children = self._children(node)
        if model.default is None:
            children.append(XmlElement("AlwaysFailure"))
        return XmlElement(tag, attributes, children)

    def _parallel(self, node: NodeSpec, model: ParallelBody) -> XmlElement:
        count = len(node.children)
        need = _needed(model, [child.name for child in node.children])
        possible = count - need + 1  # so many failures put success out of reach
        amounts = {"any": 1, "all": count, None: possible}
        fail = model.fail if isinstance(model.fail, int) else amounts[model.fail]
        children = self._children(node)
        if fail > possible:
            raise InputError(
                f"fail: {fail} waits for failures when success is out of reach; there a Parallel "
                f"fails with {possible}, try fail: {possible}"
            )
        if model.on_done == "wait":
            if fail != possible:
                raise InputError(
                    f"on_done: wait needs fail: {possible} to be a ParallelAll there; got {fail}"
                )
            return XmlElement("ParallelAll", {"max_failures": str(fail)}, children)
        if fail < possible:
            self._note(
                node,
                "when enough children succeed and enough fail in one tick, it succeeds here; "
                "there the first of them decides",
            )
        return XmlElement(
            "Parallel", {"success_count": str(need), "failure_count": str(fail)}, children
        )

    def _retry(self, node: NodeSpec, model: RetryBody) -> XmlElement:
        if model.delay_s != 0.0:
            raise InputError(
                "delay_s has no counterpart there; try a sequence of the child after a wait"
            )
        if model.gives_up_on:
            raise InputError("gives_up_on has no counterpart there; try fewer times")
        self._note(node, _IN_ONE_TICK)
        times = times_text(model.times)
        return XmlElement("RetryUntilSuccessful", {"num_attempts": times}, self._children(node))

    def _repeat(self, node: NodeSpec, model: RepeatBody) -> XmlElement:
        if model.delay_s != 0.0:
            raise InputError("delay_s has no counterpart there; try a wait in a sequence")
        self._note(node, _IN_ONE_TICK)
        return XmlElement("Repeat", {"num_cycles": times_text(model.times)}, self._children(node))

    def _timeout(self, node: NodeSpec, model: TimeoutBody) -> XmlElement:
        return XmlElement("Timeout", {"msec": milliseconds(model.seconds)}, self._children(node))

    def _for_each(self, node: NodeSpec, model: ForEachBody) -> XmlElement:
        value = parse_value(model.in_)
        items = value.value if isinstance(value, Literal) else None
        if not isinstance(items, list):
            raise InputError(
                "in: a queue is emptied by its loop there, so a key of a list would not keep it; "
                "try a literal list"
            )
        kinds = {type(item).__name__ for item in items}
        if kinds == {"int", "float"}:
            kinds = {"float"}
        tag = next((loop for loop, kind in LOOPS.items() if {_ITEMS[kind]} == kinds), None)
        if tag is None:
            raise InputError("in: expected a list of texts or of numbers there, with one or more")
        texts = [write_literal(item) for item in items]
        if any(";" in text or text != text.strip() for text in texts):
            raise InputError("in: a text with ';' cannot stand in a queue there")
        key = model.item.removeprefix("$")
        attributes = {"queue": ";".join(texts), "if_empty": "SUCCESS", "value": f"{{{key}}}"}
        self._note(node, "ends one tick after the last item there, here in the same one")
        return XmlElement(tag, attributes, self._children(node))

    def _run_once(self, node: NodeSpec, model: RunOnceBody) -> XmlElement:
        if model.until != "finished":
            raise InputError("until: success has no counterpart there; RunOnce keeps any answer")
        return XmlElement("RunOnce", {"then_skip": "false"}, self._children(node))


def _named(element: XmlElement, name: str) -> dict[str, str]:
    """Put the name of a node behind its ID, before its ports."""
    first = {k: v for k, v in element.attributes.items() if k == "ID"}
    return {**first, "name": name, **element.attributes}


def _needed(model: ParallelBody, names: list[str]) -> int:
    if isinstance(model.succeed, int):
        return model.succeed
    if isinstance(model.succeed, tuple):
        if sorted(model.succeed) != sorted(names):
            raise InputError("succeed by names has no counterpart there; try a count")
        return len(names)
    return len(names) if model.succeed == "all" else 1


def _as_expression(value: object) -> str:
    if value is None or isinstance(value, bool):
        return {None: "none", True: "true", False: "false"}[value]
    return repr(value)
