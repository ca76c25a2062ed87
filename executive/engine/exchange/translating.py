"""One foreign tree, node by node, as drafts of our nodes."""

import ast
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.exchange.conditions import NO_SKIPPING, assignments, with_conditions
from executive.engine.exchange.cpptypes import our_type, read_literal
from executive.engine.exchange.dataflow import (
    is_automatic,
    key_in,
    node_id,
    ports_of,
    subtree_of,
    wired_ports,
)
from executive.engine.exchange.draft import Draft, Skip, block, leaf, none_of
from executive.engine.exchange.markup import Element
from executive.engine.exchange.naming import our_name
from executive.engine.exchange.parameters import Parameters, Wires
from executive.engine.exchange.plan import Plan, is_custom, key_type
from executive.engine.exchange.scripts import Kind, Vocabulary, read_condition, read_script
from executive.engine.exchange.skipping import may_skip
from executive.engine.exchange.vocabulary import (
    CONDITIONS,
    ENDINGS,
    EXPLICIT,
    FALLBACKS,
    IGNORED,
    LOOPS,
    PORTS,
    REFUSED,
    SEQUENCES,
    SWITCHES,
)

_KINDS: Final[Mapping[str, Kind]] = {
    "bool": "bool",
    "int": "number",
    "float": "number",
    "str": "str",
}
_OPPOSITE: Final[Mapping[Skip, Skip]] = {"success": "failure", "failure": "success"}
_PLAIN: Final[Mapping[str, str]] = {
    "Sequence": "sequence",
    "AsyncSequence": "sequence",
    "ReactiveSequence": "reactive_sequence",
    "Fallback": "selector",
    "AsyncFallback": "selector",
    "ReactiveFallback": "reactive_selector",
}

Method = Callable[[Element, Skip | None], Draft]


class TreeTranslator:
    """Translates the nodes of one tree.

    Attributes:
        kept: Keys that the translation adds, with their first values.
        uses_stubs: Whether a node runs a skill that is not at hand.
        called: Subtrees that it uses, and what their uses make of SKIPPED.
    """

    def __init__(self, plan: Plan, tree: str, enums: Mapping[str, int]) -> None:
        """Look at one tree of a plan."""
        self._plan, self._tree = plan, tree
        self._parameters = Parameters(plan.keys)
        self._words = Vocabulary(plan.keys, enums=enums, kinds=self._known_kinds())
        self.kept: dict[str, object] = {}
        self.uses_stubs = False
        self.called: list[tuple[str, Skip | None, Element]] = []
        self._methods: Mapping[str, Method] = self._table()

    def _known_kinds(self) -> dict[str, Kind]:
        keys = {
            key
            for scope in self._plan.flow.scopes
            if scope.tree == self._tree
            for key in scope.keys
        }
        types = {key: key_type(self._plan, self._tree, key) for key in keys}
        return {key: _KINDS[kind] for key, kind in types.items() if kind in _KINDS}

    def _table(self) -> dict[str, Method]:
        return {
            **dict.fromkeys(SEQUENCES | FALLBACKS, self._composite),
            **dict.fromkeys(LOOPS, self._loop),
            **dict.fromkeys(SWITCHES, self._switch),
            "SequenceWithMemory": self._sequence_with_memory,
            "Parallel": self._parallel,
            "ParallelAll": self._parallel_all,
            "IfThenElse": self._branches,
            "WhileDoElse": self._branches,
            "Inverter": self._inverter,
            "ForceSuccess": lambda e, skip: self._forced(e, skip, "success"),
            "ForceFailure": lambda e, skip: self._forced(e, skip, "failure"),
            "Repeat": lambda e, skip: self._again(e, skip, "num_cycles"),
            "RetryUntilSuccessful": lambda e, skip: self._again(e, skip, "num_attempts"),
            "KeepRunningUntilFailure": self._keep_running,
            "Timeout": self._timeout,
            "Delay": self._delay,
            "RunOnce": self._run_once,
            "Precondition": self._precondition,
            "AlwaysSuccess": lambda *_: leaf("when", True),
            "AlwaysFailure": lambda *_: leaf("when", False),
            "Sleep": lambda e, _: leaf("wait", self._parameters.seconds(e, "msec")),
            "SetBlackboard": self._set_blackboard,
            "UnsetBlackboard": self._unset_blackboard,
            "Script": self._script,
            "ScriptCondition": self._script_condition,
        }

    def root(self, skip: Skip | None) -> Draft | None:
        """Return the root of the tree; what is refused on the way is in the plan."""
        element = self._without_first_values(self._plan.trees.trees[self._tree].children[0])
        draft = self.node(element, skip)
        if draft is not None:
            draft.body.pop("name", None)  # the root is named after its tree
            for each in draft.walk():
                _name_apart(each.children)
        return draft

    def _without_first_values(self, element: Element) -> Element:
        """Take what a script sets once, before anything else, for first values of keys."""
        match element:
            case Element(
                tag="Sequence",
                attributes=none,
                children=[
                    Element(
                        tag="RunOnce",
                        attributes=also_none,
                        children=[Element(tag="Script", attributes=script)],
                    ),
                    rest,
                ],
            ) if not none and not also_none and [*script] == ["code"]:
                values = self._constants(script["code"])
                if values is not None:
                    self.kept.update(values)
                    return rest
        return element

    def _constants(self, code: str) -> dict[str, object] | None:
        try:
            statements = read_script(code, self._words)
        except InputError:
            return None
        if not statements or not all(each.key and not each.reads for each in statements):
            return None
        try:
            return {each.key: _constant(each.text) for each in statements}
        except ValueError:
            return None

    def node(self, element: Element, skip: Skip | None) -> Draft | None:
        """Return one node with everything below it, None where something is refused."""
        try:
            draft = self._bare(element, skip)
        except InputError as error:
            self._plan.refuse(element, str(error))
            for child in element.children:  # what is wrong below is told in the same pass
                self.node(child, skip or "success")
            return None
        known = {"ID", "name", *CONDITIONS, *ENDINGS, *IGNORED}
        odd = [key for key in element.attributes if key[:1] == "_" and key not in known]
        if odd:
            message = f"unknown attribute {odd[0]!r}; {closest(odd[0], [*CONDITIONS, *ENDINGS])}"
            self._plan.refuse(element, message)
        try:
            self._describe(draft, element)
            return with_conditions(draft, element, self._words, skip)
        except InputError as error:
            self._plan.refuse(element, str(error))
            return None

    def _describe(self, draft: Draft, element: Element) -> None:
        name = our_name(element.attributes.get("name", ""))
        if name and name != draft.label:
            draft.body["name"] = name
        about = " ".join(element.attributes.get("_description", "").split())
        if about:
            draft.body["about"] = about
        draft.comments = element.comments

    def _bare(self, element: Element, skip: Skip | None) -> Draft:
        name = node_id(element)
        if element.tag in EXPLICIT and not name:
            raise InputError("needs an ID")
        tree = subtree_of(element, self._plan.trees)
        if tree is not None:
            return self._subtree(element, tree, skip)
        if name in REFUSED:
            raise InputError(REFUSED[name])
        if name in self._methods:
            self._check_ports(element, [*PORTS[name]])
            return self._methods[name](element, skip)
        if is_custom(element, self._plan.trees):
            return self._custom(element, name)
        raise InputError(
            f"runs {'the control' if len(element.children) > 1 else 'the decorator'} {name!r}, "
            f"which is not built in; {closest(name, [*PORTS])}; a stub has no children"
        )

    def _check_ports(self, element: Element, known: Sequence[str]) -> None:
        for port in element.attributes:
            if port not in ("ID", "name", *known) and not port.startswith("_"):
                raise InputError(f"has no port {port!r}; {closest(port, [*known])}")

    def _children(
        self, element: Element, skip: Skip | None, *, least: int = 1, most: int | None = None
    ) -> list[Draft]:
        count = len(element.children)
        if count < least or (most is not None and count > most):
            wanted = f"{least}" if least == most else f"{least} to {most}" if most else "one"
            raise InputError(f"expected {wanted} children, got {count}")
        drafts = [self.node(child, skip) for child in element.children]
        return [draft or leaf("when", False) for draft in drafts]

    def _child(self, element: Element, skip: Skip | None) -> Draft:
        return self._children(element, skip, most=1)[0]

    def _composite(self, element: Element, skip: Skip | None) -> Draft:
        name = node_id(element)
        passes: Skip = "success" if name in SEQUENCES else "failure"
        if self._may_skip(element) and skip != passes:
            raise InputError(NO_SKIPPING)
        if name.startswith("Async"):
            self._plan.note(element, "answers RUNNING between its children there, here it does not")
        return block(_PLAIN[name], *self._children(element, passes))

    def _may_skip(self, element: Element) -> bool:
        """Return whether a node may be SKIPPED because of what is below it."""
        bare = {k: v for k, v in element.attributes.items() if k not in ("_skipIf", "_while")}
        inner = Element(
            element.tag, bare, element.file, element.line, element.column, (), element.children
        )
        return may_skip(inner, self._plan.trees)

    def _sequence_with_memory(self, element: Element, skip: Skip | None) -> Draft:
        """Remember in a key how many children have succeeded, also across failures and halts."""
        if self._may_skip(element) and skip != "success":
            raise InputError(NO_SKIPPING)
        wanted = our_name(element.attributes.get("name", "")) or "sequence"
        done = self._plan.keys.fresh(f"{wanted}_done")
        self.kept[done] = 0
        steps = []
        for i, child in enumerate(self._children(element, "success"), start=1):
            guarded = {"unless": f"{done} >= {i}", "on_success": {done: str(i)}}
            if guarded.keys() & child.body.keys() or "if" in child.body:
                child = block("sequence", child)
            child.body.update(guarded)
            steps.append(child)
        return block("sequence", *steps, leaf("set", {done: "0"}))

    def _parallel(self, element: Element, _: Skip | None) -> Draft:
        count = len(element.children)
        need = self._parameters.threshold(element, "success_count", -1)
        fail = self._parameters.threshold(element, "failure_count", 1)
        children = self._told_apart(element)
        possible = count - need + 1  # so many failures put success out of reach
        if fail < possible:
            self._plan.note(
                element,
                "when enough children succeed and enough fail in one tick, the first of them "
                "decides there; here it succeeds",
            )
        body: dict[str, object] = {}
        if need < count:
            body["succeed"] = "any" if need == 1 else need
        if fail < possible:
            body["fail"] = "any" if fail == 1 else fail
        return Draft("parallel", body, children)

    def _parallel_all(self, element: Element, _: Skip | None) -> Draft:
        count = len(element.children)
        fail = self._parameters.threshold(element, "max_failures", 1)
        children = self._told_apart(element)
        body: dict[str, object] = {}
        if fail > 1:
            body = {"succeed": count - fail + 1, "fail": fail}
        return Draft("parallel", {**body, "on_done": "wait"}, children)

    def _told_apart(self, element: Element) -> list[Draft]:
        if any(may_skip(child, self._plan.trees) for child in element.children):
            raise InputError("a child may be SKIPPED, and is asked again in every tick; " + _WRAP)
        return self._children(element, None)

    def _branches(self, element: Element, skip: Skip | None) -> Draft:
        if not 2 <= len(element.children) <= 3:
            raise InputError(f"expected 2 or 3 children, got {len(element.children)}")
        condition, *rest = element.children
        if may_skip(condition, self._plan.trees):
            raise InputError("its condition may be SKIPPED; " + _WRAP)
        drafts = [self.node(condition, None), *(self.node(child, skip) for child in rest)]
        kind = "if_then_else" if node_id(element) == "IfThenElse" else "while_do_else"
        return block(kind, *(draft or leaf("when", False) for draft in drafts))

    def _switch(self, element: Element, skip: Skip | None) -> Draft:
        count = SWITCHES[node_id(element)]
        children = self._children(element, skip, least=count + 1, most=count + 1)
        if "variable" not in element.attributes:
            raise InputError("needs the port 'variable'")
        key = key_in(element.attributes["variable"], "variable")
        if key is None:
            raise InputError("variable is a text, so that one case always fits; try {key}")
        cases = [element.attributes.get(f"case_{i + 1}") for i in range(count)]
        texts = [self._case(text) for text in cases if text is not None]
        if len(set(texts)) < count:
            raise InputError("expected a text for every case, and no two the same")
        body: dict[str, object] = {"on": self._plan.keys(key)}
        return Draft("reactive_switch", body, children, cases=tuple(texts))

    def _case(self, text: str) -> str:
        if key_in(text, "") is not None:
            raise InputError(f"case {text!r} is read from a key; our cases are texts")
        return str(self._words.enums.get(text, text))

    def _inverter(self, element: Element, skip: Skip | None) -> Draft:
        turned = None if skip is None else _OPPOSITE[skip]
        return block("inverter", self._child(element, turned))

    def _forced(self, element: Element, skip: Skip | None, answer: Skip) -> Draft:
        passed = answer if skip == answer else None
        return block(f"force_{answer}", self._child(element, passed))

    def _again(self, element: Element, skip: Skip | None, port: str) -> Draft:
        """Translate Repeat and RetryUntilSuccessful, which end on the other answer."""
        kind, ends = ("repeat", "failure") if port == "num_cycles" else ("retry", "success")
        times = self._parameters.read(element, port, "int")
        if times == -1:
            times = "forever"
        elif isinstance(times, int) and times < 1:
            raise InputError(f"{port}={times} never runs its child; take it out")
        return block(kind, self._child(element, skip if skip == ends else None), times=times)

    def _keep_running(self, element: Element, _: Skip | None) -> Draft:
        return block("repeat", self._child(element, None), times="forever")

    def _timeout(self, element: Element, skip: Skip | None) -> Draft:
        child, seconds = self._child(element, skip), self._parameters.seconds(element, "msec")
        if seconds == 0:
            self._plan.note(element, "msec=0 sets no limit there; left out")
            return child
        return block("timeout", child, seconds=seconds)

    def _delay(self, element: Element, skip: Skip | None) -> Draft:
        child, seconds = self._child(element, skip), self._parameters.seconds(element, "delay_msec")
        return block("sequence", leaf("wait", seconds), child)

    def _run_once(self, element: Element, skip: Skip | None) -> Draft:
        then_skip = self._parameters.read(element, "then_skip", "bool", True)
        child = self._child(element, None)
        if then_skip is False:
            return block("run_once", child)
        if then_skip is not True:
            raise InputError("then_skip is read from a key; here it is decided once and for all")
        if skip is None:
            raise InputError(NO_SKIPPING)
        ran = self._plan.keys.fresh(f"{our_name(child.label) or 'child'}_ran")
        self.kept[ran] = False
        noted = {"on_success": {ran: "true"}, "on_failure": {ran: "true"}}
        asked = {"unless": ran} if skip == "success" else {"if": none_of(ran)}
        return block("sequence", child, **asked, **noted)

    def _precondition(self, element: Element, skip: Skip | None) -> Draft:
        child = self._child(element, skip)
        asked = read_condition(element.attributes.get("if", ""), self._words).text
        otherwise = element.attributes.get("else", "FAILURE").strip()
        if otherwise == "SKIPPED":
            if skip is None:
                raise InputError(NO_SKIPPING)
            otherwise = skip.upper()
        if otherwise == "FAILURE":
            return block("sequence", child, **{"if": asked})
        if otherwise == "SUCCESS":
            return block("sequence", child, unless=none_of(asked))
        raise InputError(f"else={otherwise!r}: expected SUCCESS, FAILURE or SKIPPED")

    def _loop(self, element: Element, skip: Skip | None) -> Draft:
        kind = our_type(LOOPS[node_id(element)])
        value = key_in(element.attributes.get("value", ""), "value")
        if value is None:
            raise InputError("needs the port 'value', as in value=\"{item}\"")
        items = self._parameters.read(element, "queue", f"list[{kind}]")
        if isinstance(items, str):
            self._plan.note(element, "takes its items out of the queue there, here the list stays")
        child = self._child(element, "success")
        loop = block("for_each", child, item=f"${self._plan.keys(value)}", **{"in": items})
        match element.attributes.get("if_empty", "SUCCESS").strip():
            case "SUCCESS":
                return loop
            case "FAILURE":
                return block("force_failure", loop)
            case "SKIPPED" if skip == "success":
                return loop
            case "SKIPPED" if skip == "failure":
                return block("force_failure", loop)
        raise InputError(NO_SKIPPING)

    def _set_blackboard(self, element: Element, _: Skip | None) -> Draft:
        target = element.attributes.get("output_key", "").strip()
        key = key_in(target, "output_key") or target
        if not key:
            raise InputError("needs the port 'output_key'")
        text = element.attributes.get("value", "")
        source = key_in(text, "value")
        if source is not None:
            return leaf("set", {self._plan.keys(key): self._plan.keys(source)})
        value = read_literal(text, key_type(self._plan, self._tree, key))
        if isinstance(value, dict):
            raise InputError(f"value {text!r} is a mapping, which no expression writes")
        return leaf("set", {self._plan.keys(key): _expression(value)})

    def _unset_blackboard(self, element: Element, _: Skip | None) -> Draft:
        text = element.attributes.get("key", "").strip()
        key = key_in(text, "key") or text
        if not key:
            raise InputError("needs the port 'key'")
        return leaf("unset", self._plan.keys(key))

    def _script(self, element: Element, _: Skip | None) -> Draft:
        statements = read_script(element.attributes.get("code", ""), self._words)
        sets = [leaf("set", each) for each in assignments(statements)]
        if not sets:
            raise InputError("its script sets no key; take it out")
        return sets[0] if len(sets) == 1 else block("sequence", *sets)

    def _script_condition(self, element: Element, _: Skip | None) -> Draft:
        return leaf("when", read_condition(element.attributes.get("code", ""), self._words).text)

    def _subtree(self, element: Element, tree: str, skip: Skip | None) -> Draft:
        trees = self._plan.trees.trees
        if tree not in trees:
            raise InputError(f"there is no tree {tree!r}; {closest(tree, [*trees])}")
        if element.children:
            raise InputError("a SubTree has no children")
        self.called.append((tree, skip, element))
        ports = self._plan.ports[tree]
        wired = dict(wired_ports(element, self._plan.trees))
        wires = Wires(self._plan.keys)
        for key, port in ports.items():
            text = wired.get(key)
            if text is None and is_automatic(element) and not key.startswith("_"):
                text = f"{{{key}}}"
            if text is None and port.direction != "out":
                raise InputError(f"tree {tree!r} reads {key!r}, which is not given; try remapping")
            if text is not None:
                wires.add(key, text, port.direction, port.type)
        for key in wired:
            if key not in ports:
                self._plan.note(element, f"tree {tree!r} does not use {key!r}; left out")
        return wires.onto(leaf("subtree", self._plan.tree_names(tree)))

    def _custom(self, element: Element, name: str) -> Draft:
        is_stub = name in self._plan.stubs
        self.uses_stubs |= is_stub
        skill = self._plan.skill_names(name) if is_stub else our_name(name)
        declared = ports_of(element, self._plan.trees)
        if name in self._plan.trees.models:
            self._check_ports(element, [*declared])
        wires = Wires(self._plan.keys)
        for port, text in wired_ports(element, self._plan.trees):
            direction = self._plan.flow.direction(element, port)
            kind = self._port_type(name, port, declared[port].type if port in declared else "")
            if direction == "out" and key_in(text, port) is None:
                raise InputError(f"{port} is an output; expected a key such as {{{port}}}")
            wires.add(port, text, direction, kind)
        return wires.onto(leaf("skill", skill))

    def _port_type(self, name: str, port: str, declared: str) -> str:
        if name in self._plan.stubs:
            return self._plan.stubs[name][port].type
        return declared or "any"


_WRAP: Final = "try it in a ForceSuccess or a Sequence of its own"


def _expression(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "none"}[value]
    if isinstance(value, list):
        return f"[{', '.join(_expression(item) for item in value)}]"
    return repr(value)


def _constant(text: str) -> object:
    words = {"true": True, "false": False}
    return words[text] if text in words else ast.literal_eval(text)


def _name_apart(children: list[Draft]) -> None:
    """Number the given names that siblings share, which no two may."""
    given = Counter(child.body["name"] for child in children if "name" in child.body)
    taken = {str(name) for name in given}
    for child in children:
        name = child.body.get("name")
        if name is None or given[name] == 1:
            continue
        given[name] -= 1
        number = 2
        while f"{name}_{number}" in taken:
            number += 1
        child.body["name"] = f"{name}_{number}"
        taken.add(f"{name}_{number}")
