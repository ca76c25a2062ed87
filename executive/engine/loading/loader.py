"""From files to missions that can be built, or to every fault in one pass."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from executive.core.errors import DocumentError, Fault, InputError
from executive.core.registry import Registry
from executive.core.skill import Skill
from executive.engine.language.document import CellDocument, MissionDocument, StubsDocument
from executive.engine.language.node_models import SubtreeNode
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.sources import Source
from executive.engine.language.stubs import Skillset
from executive.engine.loading.checks import check_tree
from executive.engine.loading.library import Library, Shelf, kind_of_document, search_folders

MAX_DEPTH = 200
"""How deep a tree may be: a tick goes through all of it in nested calls."""


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """A tree with all trees that it uses, checked.

    Attributes:
        tree: The tree or mission itself.
        subtrees: The trees that it uses, by name.
        skills: The skills that they were checked against, the stubs that they use among them.
        sources: Every file that was read, the one that was asked for first.
    """

    tree: TreeSpec
    subtrees: MappingProxyType[str, TreeSpec]
    skills: Registry[type[Skill]]
    sources: tuple[Source, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Mission(Program):
    """A checked mission with the cell that it runs on.

    Attributes:
        document: What the mission file says.
        cell: What the file of its cell says.
        cell_file: That file.
    """

    document: MissionDocument
    cell: CellDocument
    cell_file: Path

    @property
    def name(self) -> str:
        """Name of the mission."""
        return self.document.mission


@dataclass(frozen=True, slots=True)
class Checked:
    """What a check of one file came to.

    Attributes:
        file: Path as the user gave it.
        kind: `tree`, `mission`, `cell` or `stubs`; empty where that cannot be told.
        name: Name of the document, empty where it has none.
        nodes: Number of nodes with those of its subtrees.
    """

    file: str
    kind: str
    name: str
    nodes: int


def load_mission(
    path_or_name: str | Path,
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
    search_paths: Sequence[Path] = (),
) -> Mission:
    """Load a mission with everything that it names.

    Args:
        path_or_name: A file, or the name of a mission in the search paths or the package.
        skills: Skills by name.
        types: Types that ports may have, by name.
        search_paths: Folders to search before the package.

    Raises:
        DocumentError: All that is wrong with it.
        InputError: No such mission, or a file that is none.
    """
    loading = _Loading(path_or_name, "mission", skills, Shelf(types), search_paths)
    document = loading.library.document(loading.file)
    if document is not None and not isinstance(document, MissionDocument):
        given = f"the {kind_of_document(document)} {document.name!r}"
        raise InputError(f"{loading.file}: expected a mission; got {given}")
    program, cell = loading.program(), loading.cell()
    if loading.faults or program is None or cell is None or document is None:
        raise DocumentError(loading.faults)
    return Mission(
        program.tree,
        program.subtrees,
        program.skills,
        loading.library.sources,
        document,
        cell,
        loading.library.find(document.cell, "cell"),
    )


def load_program(
    path_or_name: str | Path,
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
    search_paths: Sequence[Path] = (),
) -> Program:
    """Load a tree or a mission with all trees that it uses, but without a cell.

    Args:
        path_or_name: A file, or the name of a tree or mission.
        skills: Skills by name.
        types: Types that ports may have, by name.
        search_paths: Folders to search before the package.

    Raises:
        DocumentError: All that is wrong with it.
        InputError: No such tree, or a file that is none.
    """
    loading = _Loading(path_or_name, "tree", skills, Shelf(types), search_paths)
    document = loading.library.document(loading.file)
    if isinstance(document, CellDocument | StubsDocument):
        kind = kind_of_document(document)
        raise InputError(f"{loading.file}: expected a tree or a mission, got a {kind} document")
    program = loading.program()
    if loading.faults or program is None:
        raise DocumentError(loading.faults)
    return program


def check_files(
    files: Iterable[Path],
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
    search_paths: Sequence[Path] = (),
) -> tuple[list[Checked], list[Fault]]:
    """Check files of any kind, and everything that they name.

    Returns:
        What each file is, and every fault once, in the order of file and line.

    Raises:
        InputError: A file cannot be read.
    """
    checked, faults, shelf = [], set(), Shelf(types)
    for file in files:
        loading = _Loading(file, "tree", skills, shelf, search_paths)
        checked.append(loading.check())
        faults |= set(loading.faults)
    return checked, sorted(faults)


def load_programs(
    files: Iterable[Path],
    *,
    skills: Registry[type[Skill]],
    types: Registry[type],
    search_paths: Sequence[Path] = (),
) -> tuple[list[Program], list[Fault]]:
    """Load the trees and missions among some files.

    Returns:
        Those without faults, and every fault of all files once, cells included.

    Raises:
        InputError: A file cannot be read.
    """
    programs, faults, shelf = [], set(), Shelf(types)
    for file in files:
        loading = _Loading(file, "tree", skills, shelf, search_paths)
        program = loading.program()
        loading.cell()
        faults |= set(loading.faults)
        if program is not None and not loading.faults:
            programs.append(program)
    return programs, sorted(faults)


class _Loading:
    """One file, and everything that is reached from it."""

    def __init__(
        self,
        path_or_name: str | Path,
        kind: str,
        skills: Registry[type[Skill]],
        shelf: Shelf,
        search_paths: Sequence[Path],
    ) -> None:
        beside = Path(path_or_name)
        is_path = isinstance(path_or_name, Path) or beside.suffix != "" or beside.is_file()
        folders = search_folders(beside if is_path else None, search_paths)
        self._skills = Skillset(skills)
        self.library = Library(shelf, folders)
        self.file = beside if is_path else self.library.find(str(path_or_name), kind)
        self._subtrees: dict[str, TreeSpec | None] = {}
        self._faults: list[Fault] = []

    @property
    def faults(self) -> list[Fault]:
        """Everything found so far."""
        return self.library.faults + self._faults

    def check(self) -> Checked:
        """Check the file, whatever kind it is."""
        document = self.library.document(self.file)
        if document is None:
            return Checked(str(self.file), "", "", 0)
        program = self.program()
        if isinstance(document, MissionDocument):
            self.cell()
        kind = kind_of_document(document)
        count = self._count(program.tree) if program and not self.faults else 0
        return Checked(str(self.file), kind, document.name, count)

    def program(self) -> Program | None:
        """Return the tree with its subtrees, None where the file holds none or has faults."""
        tree = self.library.tree(self.file)
        if tree is None:
            return None
        self._reach(tree, (tree.name,))
        for spec in (tree, *self._subtrees.values()):
            if spec is not None:
                skills = self._skills.of(spec, self.library, self._faults)
                self._faults += check_tree(spec, skills, self._subtrees)
        if not self.faults and (depth := self._depth(tree.root)) > MAX_DEPTH:
            self._faults.append(
                tree.root.fault(f"{depth} nodes deep; expected {MAX_DEPTH} at most")
            )
        subtrees = {name: spec for name, spec in self._subtrees.items() if spec is not None}
        skills = self._skills.used
        return Program(tree, MappingProxyType(subtrees), skills, self.library.sources)

    def cell(self) -> CellDocument | None:
        """Return the cell of the mission in the file, None where there are faults."""
        mission = self.library.document(self.file)
        if not isinstance(mission, MissionDocument):
            return None
        try:
            found = self.library.document(self.library.find(mission.cell, "cell"))
        except InputError as error:
            self._fault_at("cell", str(error))
            return None
        if found is not None and not isinstance(found, CellDocument):
            self._fault_at("cell", f"{mission.cell!r} is no cell")
            return None
        return found

    def _fault_at(self, key: str, message: str) -> None:
        source = self.library.sources[0]
        line, column = source.value_mark((key,))
        self._faults.append(Fault(source.file, line, column, "", message))

    def _reach(self, tree: TreeSpec, above: tuple[str, ...]) -> None:
        """Load every tree that is used below, and refuse one that uses itself."""
        for node in tree.root.walk():
            if not isinstance(node.model, SubtreeNode):
                continue
            name = node.model.subtree
            if name in above:
                chain = " > ".join((*above[above.index(name) :], name))
                self._faults.append(
                    node.fault(f"tree {name!r} would contain itself: {chain}", "subtree")
                )
            elif name not in self._subtrees:
                try:
                    spec = self.library.tree(self.library.find(name, "tree"))
                except InputError as error:
                    self._faults.append(node.fault(str(error), "subtree"))
                    continue
                self._subtrees[name] = spec
                if spec is not None:
                    self._reach(spec, (*above, name))

    def _count(self, tree: TreeSpec) -> int:
        """Return how many nodes a tree has when its subtrees are put in."""
        inside = [self._inside(node) for node in tree.root.walk()]
        return sum(1 if inner is None else self._count(inner) for inner in inside)

    def _depth(self, node: NodeSpec) -> int:
        """Return how deep a tree is when its subtrees are put in."""
        inner = self._inside(node)
        if inner is not None:
            return self._depth(inner.root)
        return 1 + max((self._depth(child) for child in node.children), default=0)

    def _inside(self, node: NodeSpec) -> TreeSpec | None:
        """Return the tree that stands in the place of a node, if any."""
        if not isinstance(node.model, SubtreeNode):
            return None
        return self._subtrees.get(node.model.subtree)
