"""BehaviorTree.CPP v4 XML as documents of ours, or as every reason why not."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final

from executive.core.errors import DocumentError, Fault, InputError
from executive.core.registry import Registry
from executive.core.skill import Skill
from executive.engine.exchange.conditions import NO_SKIPPING
from executive.engine.exchange.cpptypes import read_literal
from executive.engine.exchange.dataflow import Dataflow
from executive.engine.exchange.draft import Draft, Skip, block, leaf
from executive.engine.exchange.foreign import ForeignTrees, read_text, read_trees
from executive.engine.exchange.plan import Plan, PlannedPort, make_plan, with_skills_at_hand
from executive.engine.exchange.skipping import may_skip
from executive.engine.exchange.translating import TreeTranslator
from executive.engine.exchange.yamltext import comment_lines, document_text
from executive.engine.formatting.formatter import format_text

DRY_CELL: Final = "dry"
MISSION_LIMIT_S: Final = 600.0
_PLACEHOLDERS: Final[Mapping[str, object]] = MappingProxyType(
    {"bool": False, "int": 0, "float": 0.0, "str": ""}
)
_LONGEST_ABOUT: Final = 160


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What the user says about an import.

    Attributes:
        models: Files whose TreeNodesModel is read besides.
        enums: Values of the words that scripts use and C++ code registers.
        mission: Name of a mission to write as well, empty for none.
    """

    models: tuple[Path, ...] = ()
    enums: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))
    mission: str = ""


@dataclass(frozen=True, slots=True)
class Imported:
    """What an import came to.

    Attributes:
        files: Text of each document, by the name of its file.
        notes: What is different here, or was taken for granted.
    """

    files: Mapping[str, str]
    notes: tuple[Fault, ...]


def import_file(
    file: Path, skills: Registry[type[Skill]], options: ImportOptions | None = None
) -> Imported:
    """Import a file with everything that it includes.

    Args:
        file: XML of BehaviorTree.CPP v4.
        skills: Skills that are at hand; other leaves become stubs.
        options: What the user says about it.

    Raises:
        DocumentError: Everything that cannot be said in our language.
        InputError: A file cannot be opened.
    """
    options = options or ImportOptions()
    return _import(str(file), read_trees(file, options.models), skills, options)


def import_text(
    file: str, data: bytes, skills: Registry[type[Skill]], options: ImportOptions | None = None
) -> Imported:
    """Import XML that is in memory.

    Raises:
        DocumentError: Everything that cannot be said in our language.
    """
    return _import(file, read_text(file, data), skills, options or ImportOptions())


def _import(
    file: str, trees: ForeignTrees, skills: Registry[type[Skill]], options: ImportOptions
) -> Imported:
    if trees.faults:
        raise DocumentError(trees.faults)
    try:
        return _Import(file, trees, skills, options).run()
    except RecursionError:
        raise DocumentError([Fault(file, 1, 1, "", "nested much too deeply")]) from None


class _Import:
    def __init__(
        self,
        file: str,
        trees: ForeignTrees,
        skills: Registry[type[Skill]],
        options: ImportOptions,
    ) -> None:
        self._file, self._trees, self._options = file, trees, options
        with_skills_at_hand(trees, skills)
        flow = Dataflow(trees, options.enums)
        self._plan: Plan = make_plan(trees, flow, skills)
        self._stubs = self._plan.tree_names.fresh(f"{self._title()}_stubs")
        self._skips: dict[str, Skip | None] = {}

    def _title(self) -> str:
        first = self._trees.main or next(iter(self._trees.trees))
        return self._plan.tree_names(first)

    def run(self) -> Imported:
        files: dict[str, str] = {}
        if not self._plan.faults:
            for tree in self._in_order():
                text = self._tree(tree)
                files[f"{self._plan.tree_names(tree)}.yaml"] = text
        if self._plan.stubs:
            files[f"{self._stubs}.yaml"] = self._stubs_text()
        if self._options.mission:
            files[f"{self._options.mission}.yaml"] = self._mission()
        if self._plan.faults:
            raise DocumentError(list(dict.fromkeys(self._plan.faults)))
        laid_out = {name: format_text(name, text) for name, text in files.items()}
        return Imported(MappingProxyType(laid_out), tuple(dict.fromkeys(self._plan.notes)))

    def _in_order(self) -> Sequence[str]:
        """Return the trees so that each comes after the trees that use it."""
        order: list[str] = []
        for scope in self._plan.flow.scopes:
            if scope.tree in order:
                order.remove(scope.tree)
            order.append(scope.tree)
        return order

    def _tree(self, tree: str) -> str:
        element = self._trees.trees[tree]
        translator = TreeTranslator(self._plan, tree, self._options.enums)
        skip: Skip | None = self._skips.get(tree, "success")
        root = translator.root(skip)
        for called, meant, where in translator.called:
            skips = may_skip(self._trees.trees[called].children[0], self._trees)
            if skips and self._skips.get(called, meant) != meant:
                self._plan.refuse(where, NO_SKIPPING)
            self._skips.setdefault(called, meant)
        if root is None:
            return ""
        if tree not in self._skips and may_skip(element.children[0], self._trees):
            self._plan.note(element, "may be SKIPPED as a whole; here it succeeds then")
        return self._document(tree, root, translator)

    def _document(self, tree: str, root: Draft, translator: TreeTranslator) -> str:
        element = self._trees.trees[tree]
        head: dict[str, object] = {"format": 1, "tree": self._plan.tree_names(tree)}
        about, comments = _about(element.attributes.get("_description", ""), element.comments)
        if about:
            head["about"] = about
        if translator.uses_stubs:
            head["uses"] = [self._stubs]
        ports = self._plan.ports[tree]
        head |= _ports(self._plan, ports)
        if translator.kept:
            head["keep"] = translator.kept
        root = _with_copies(self._plan, ports, root)
        origin = f"{tree} of {Path(element.file).name}"
        lines = [line for comment in (origin, *comments) for line in comment_lines(comment)]
        return "\n".join([*lines, document_text(head, root)])

    def _stubs_text(self) -> str:
        skills: dict[str, object] = {}
        for name, ports in self._plan.stubs.items():
            skills[self._plan.skill_names(name)] = self._stub(name, ports)
        head = {
            "format": 1,
            "stubs": self._stubs,
            "about": f"What {Path(self._file).name} runs and is not at hand; script its outcomes.",
            "skills": skills,
        }
        return document_text(head)

    def _stub(self, name: str, ports: Mapping[str, PlannedPort]) -> dict[str, object]:
        stub: dict[str, object] = {"stands_for": name, **_ports(self._plan, ports, stub=True)}
        outs = stub.get("out")
        values = {
            port: _placeholder(str(declared["type"]))
            for port, declared in (outs.items() if isinstance(outs, dict) else ())
        }
        outcome: dict[str, object] = {"outcome": "success"}
        stub["outcomes"] = [{**outcome, "out": values} if values else outcome]
        return stub

    def _mission(self) -> str:
        name = self._options.mission
        if not self._trees.main:
            known = ", ".join(self._trees.trees)
            raise InputError(
                f"{self._file}: a mission runs one tree; name it by main_tree_to_execute "
                f"(trees: {known})"
            )
        if self._plan.tree_names.fresh(name) != name:
            raise InputError(f"mission {name!r}: a tree or the stubs have this name; try another")
        ports = self._plan.ports[self._trees.main]
        head: dict[str, object] = {
            "format": 1,
            "mission": name,
            "about": f"Run {self._title()} with stubs, on no cell at all.",
            "cell": DRY_CELL,
            "timeout_s": MISSION_LIMIT_S,
        }
        inputs = {
            self._plan.keys(key): {
                "type": port.type,
                "default": _placeholder(port.type),
                "about": port.about or "set from outside there; a placeholder",
            }
            for key, port in ports.items()
        }
        body: dict[str, object] = {}
        if inputs:
            head["in"] = inputs
            body["in"] = {key: f"${key}" for key in inputs}
        return document_text(head, leaf("subtree", self._title(), **body))


def _about(description: str, comments: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """Return the one line about a tree, and the comments that do not fit in it."""
    about = " ".join(description.split())
    if about or len(comments) != 1 or len(comments[0]) > _LONGEST_ABOUT:
        return about, comments
    return comments[0], ()


def _ports(
    plan: Plan, ports: Mapping[str, PlannedPort], *, stub: bool = False
) -> dict[str, dict[str, dict[str, object]]]:
    """Return the keys `in` and `out` of a document; what is both is declared twice."""
    ins: dict[str, dict[str, object]] = {}
    outs: dict[str, dict[str, object]] = {}
    for key, port in ports.items():
        name, about = plan.keys(key), {"about": port.about} if port.about else {}
        plain: dict[str, object] = {"type": port.type, **about}
        if port.direction == "in":
            ins[name] = plain | _default(port) if stub else plain
        elif port.direction == "out":
            outs[name] = plain
        else:
            kind = "any" if port.type == "any" else f"{port.type} | None"
            ins[f"{name}_in"] = {"type": kind, "default": None, **about}
            outs[name] = plain
    found = {"in": ins, "out": outs}
    return {direction: declared for direction, declared in found.items() if declared}


def _default(port: PlannedPort) -> dict[str, object]:
    if port.default is None or port.default.strip().startswith("{"):
        return {}
    try:
        return {"default": read_literal(port.default, port.type)}
    except InputError:
        return {}


def _with_copies(plan: Plan, ports: Mapping[str, PlannedPort], root: Draft) -> Draft:
    """Let keys that are read and written begin with what was given."""
    both = [plan.keys(key) for key, port in ports.items() if port.direction == "inout"]
    copies = [
        leaf("set", {name: f"{name}_in"}, **{"unless": f"{name}_in is none"}) for name in both
    ]
    return block("sequence", *copies, root) if copies else root


def _placeholder(kind: str) -> object:
    return [] if kind.startswith("list[") else _PLACEHOLDERS.get(kind)
