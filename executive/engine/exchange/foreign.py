"""A set of BehaviorTree.CPP v4 files as trees and models of nodes, with everything included."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from executive.core.errors import Fault, InputError
from executive.core.registry import closest
from executive.engine.exchange.markup import Element, read_markup

FORMAT: Final = "4"
Direction = Literal["in", "out", "inout"]
NodeKind = Literal["Action", "Condition", "Control", "Decorator", "SubTree"]

_DIRECTIONS: Final[Mapping[str, Direction]] = {
    "input_port": "in",
    "output_port": "out",
    "inout_port": "inout",
}
_KINDS: Final[tuple[NodeKind, ...]] = ("Action", "Condition", "Control", "Decorator", "SubTree")


@dataclass(frozen=True, slots=True)
class ForeignPort:
    """A port as a TreeNodesModel declares it.

    Attributes:
        direction: Whether the node reads it, writes it, or both.
        type: Its C++ type, empty where none is named.
        default: What it is wired to when the node does not say.
        about: One line for people.
    """

    direction: Direction
    type: str = ""
    default: str | None = None
    about: str = ""


@dataclass(frozen=True, slots=True)
class NodeModel:
    """A node as a TreeNodesModel declares it."""

    id: str
    kind: NodeKind
    ports: Mapping[str, ForeignPort]


@dataclass(slots=True)
class ForeignTrees:
    """What a file and all files that it includes hold.

    Attributes:
        main: ID of the tree that is to be executed, empty where none is named.
        trees: The elements `BehaviorTree`, by ID.
        models: The models of nodes, by ID.
        notes: What was read but means less here than there.
        faults: What cannot be read.
    """

    main: str = ""
    trees: dict[str, Element] = field(default_factory=dict)
    models: dict[str, NodeModel] = field(default_factory=dict)
    notes: list[Fault] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def read_trees(file: Path, models: Iterable[Path] = ()) -> ForeignTrees:
    """Read a file with everything that it includes.

    Args:
        file: The file.
        models: Files whose TreeNodesModel is read besides.

    Raises:
        InputError: A file cannot be opened that the user named.
    """
    found = ForeignTrees()
    reader = _Reader(found)
    reader.read(file, _bytes(file))
    _settle_main(found, str(file))
    for extra in models:
        reader.read(extra, _bytes(extra), only_models=True)
    return found


def read_text(file: str, data: bytes) -> ForeignTrees:
    """Read one file that is already in memory."""
    found = ForeignTrees()
    _Reader(found).read(Path(file), data)
    _settle_main(found, file)
    return found


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or error
        raise InputError(f"{file}: cannot be read: {what}") from None


class _Reader:
    def __init__(self, found: ForeignTrees) -> None:
        self._found = found
        self._seen: set[Path] = set()

    def read(self, file: Path, data: bytes, *, only_models: bool = False) -> None:
        self._seen.add(file.resolve())
        root, faults = read_markup(str(file), data)
        self._found.faults += faults
        if root is None:
            return
        if root.tag != "root":
            self._refuse(root, "expected the element <root> of BehaviorTree.CPP here")
            return
        if not only_models:
            self._check_format(root)
        self._found.main = self._found.main or root.attributes.get("main_tree_to_execute", "")
        for child in root.children:
            self._part(child, file, only_models)

    def _part(self, child: Element, file: Path, only_models: bool) -> None:
        match child.tag:
            case "TreeNodesModel":
                for model in child.children:
                    self._model(model)
            case _ if only_models:
                return
            case "BehaviorTree":
                self._tree(child)
            case "include":
                self._include(child, file)
            case _:
                known = closest(child.tag, ["BehaviorTree", "TreeNodesModel", "include"])
                self._refuse(child, f"is not known here; {known}")

    def _check_format(self, root: Element) -> None:
        version = root.attributes.get("BTCPP_format")
        if version is None:
            note = f'says no BTCPP_format; taken as "{FORMAT}", as BehaviorTree.CPP v4 does'
            self._found.notes.append(root.fault(note))
        elif version.strip() != FORMAT:
            self._refuse(
                root,
                f'BTCPP_format is "{version}"; expected "{FORMAT}", try the converter '
                "convert_v3_to_v4.py that comes with BehaviorTree.CPP",
            )

    def _tree(self, tree: Element) -> None:
        name = tree.attributes.get("ID", "")
        if not name:
            name = f"BehaviorTree_{len(self._found.trees)}"
            self._found.notes.append(tree.fault(f"has no ID; called {name}"))
        if name in self._found.trees:
            first = self._found.trees[name]
            where = f"{first.file}:{first.line}"
            self._refuse(tree, f"another tree has this ID too, in {where}")
            return
        if len(tree.children) != 1:
            self._refuse(tree, f"expected one node in it, got {len(tree.children)}")
            return
        self._found.trees[name] = tree

    def _include(self, element: Element, file: Path) -> None:
        path = element.attributes.get("path", "")
        if "ros_pkg" in element.attributes:
            self._refuse(element, "names a ROS package, which is not looked up; try its path")
            return
        if not path:
            self._refuse(element, "needs a path")
            return
        target = file.parent / path
        try:
            if target.resolve() not in self._seen:
                self.read(target, _bytes(target))
        except (InputError, OSError, ValueError, RuntimeError) as error:
            self._refuse(element, str(error))

    def _model(self, element: Element) -> None:
        kind = next((kind for kind in _KINDS if kind == element.tag), None)
        name = element.attributes.get("ID", "")
        if kind is None:
            self._refuse(element, f"is no kind of node; {closest(element.tag, [*_KINDS])}")
            return
        if not name:
            self._refuse(element, "a model needs an ID")
            return
        ports = {}
        for child in element.children:
            direction = _DIRECTIONS.get(child.tag)
            port = child.attributes.get("name", "")
            if direction is None or not port:
                if child.tag != "MetadataFields":
                    self._refuse(child, f"expected one of {', '.join(_DIRECTIONS)} with a name")
                continue
            ports[port] = ForeignPort(
                direction,
                child.attributes.get("type", ""),
                child.attributes.get("default"),
                child.text or child.attributes.get("description", ""),
            )
        self._found.models.setdefault(name, NodeModel(name, kind, ports))

    def _refuse(self, element: Element, message: str) -> None:
        self._found.faults.append(element.fault(message))


def _settle_main(found: ForeignTrees, file: str) -> None:
    """Find the tree to execute: the one that is named, or the only one."""
    if found.faults:
        return
    if not found.trees:
        found.faults.append(Fault(file, 1, 1, "", "holds no BehaviorTree"))
    elif found.main and found.main not in found.trees:
        known = closest(found.main, [*found.trees])
        message = f"main_tree_to_execute: there is no tree {found.main!r}; {known}"
        found.faults.append(Fault(file, 1, 1, "", message))
    elif not found.main and len(found.trees) == 1:
        found.main = next(iter(found.trees))
