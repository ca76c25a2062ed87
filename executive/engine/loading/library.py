"""Finds documents by name and reads each file once.

A tree, mission, cell or set of stubs NAME is the file `NAME.yaml` in one of the folders
`trees`, `subtrees`, `missions`, `cells` or `stubs`, or in the folder of the document that
names it. Folders are searched in a fixed order: next to the file that was asked for, the
search paths that were given, and what ships with the package; the first file wins.
"""

import importlib.util
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.core.errors import Fault, InputError
from executive.core.registry import Registry, closest
from executive.core.skill import REQUIRED, Port, Skill
from executive.engine.language.document import (
    DOCUMENTS,
    Document,
    InPort,
    MissionDocument,
    OutPort,
    StubsDocument,
    TreeDocument,
)
from executive.engine.language.fitting import fit
from executive.engine.language.outline import TreeSpec, outline
from executive.engine.language.porttypes import parse_type
from executive.engine.language.sources import Source, read_source
from executive.engine.language.stubs import stub_skills
from executive.engine.loading.packages import package_folders, user_folders
from executive.engine.loading.validation import validate

FOLDERS = ("subtrees", "missions", "cells", "stubs")


def packaged_trees() -> Path:
    """Return the folder of the trees that ship with the package."""
    spec = importlib.util.find_spec("trees")
    if spec is None or spec.origin is None:
        raise InputError("the package 'trees' is not installed; try pip install of this project")
    return Path(spec.origin).parent


def search_folders(beside: Path | None, search_paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return every folder that is searched, in order.

    Args:
        beside: A file that was asked for by its path.
        search_paths: Folders that the user gave.
    """
    roots = [beside.parent, beside.parent.parent] if beside else []
    roots += [*search_paths, *user_folders(), packaged_trees(), *package_folders()]
    folders = (folder for root in roots for folder in (root, *(root / name for name in FOLDERS)))
    return tuple(dict.fromkeys(folders))


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """What was read from one file.

    Attributes:
        source: The file as it was read.
        document: What it says, None where it has faults.
        tree: The tree or mission in it, None where it has faults or is neither.
        stubs: The scripted skills that it declares.
        faults: What is wrong with the file by itself.
    """

    source: Source
    document: Document | None
    tree: TreeSpec | None
    stubs: Mapping[str, type[Skill]]
    faults: tuple[Fault, ...]


class Shelf:
    """Files that were read: several questions that share a shelf read each of them once."""

    def __init__(self, types: Registry[type]) -> None:
        """Know the types that ports may have."""
        self._types = types
        self._entries: dict[Path, Entry] = {}

    def entry(self, file: Path) -> Entry:
        """Return what is in a file.

        Raises:
            InputError: The file cannot be read.
        """
        key = file.resolve()
        if key not in self._entries:
            self._entries[key] = _read(file, self._types)
        return self._entries[key]


class Library:
    """The documents behind one question of the user, and everything wrong with them."""

    def __init__(self, shelf: Shelf, folders: Sequence[Path]) -> None:
        """Know the files that were read before, and where to look."""
        self._shelf = shelf
        self._folders = tuple(folders)
        self._used: dict[Entry, None] = {}

    @property
    def sources(self) -> tuple[Source, ...]:
        """Every file that was read, in order."""
        return tuple(entry.source for entry in self._used)

    @property
    def faults(self) -> list[Fault]:
        """What is wrong with these files by themselves."""
        return [fault for entry in self._used for fault in entry.faults]

    def find(self, name: str, kind: str) -> Path:
        """Return the file of a document.

        Args:
            name: Its name.
            kind: `tree`, `mission`, `cell` or `stubs`, for the message.

        Raises:
            InputError: There is none.
        """
        for folder in self._folders:
            if (folder / f"{name}.yaml").is_file():
                return folder / f"{name}.yaml"
        files = (file for folder in self._folders for file in folder.glob("*.yaml"))
        known = {file.stem for file in files if _says(file, kind)}
        raise InputError(f"unknown {kind} {name!r}; {closest(name, sorted(known))}")

    def document(self, file: Path) -> Document | None:
        """Return the document in a file, None where it has faults.

        Raises:
            InputError: The file cannot be read.
        """
        return self._entry(file).document

    def tree(self, file: Path) -> TreeSpec | None:
        """Return the tree or mission in a file, None where it has faults or is neither.

        Raises:
            InputError: The file cannot be read.
        """
        return self._entry(file).tree

    def stubs(self, file: Path) -> Mapping[str, type[Skill]]:
        """Return the scripted skills that a file declares, none where it has faults.

        Raises:
            InputError: The file cannot be read, or holds something else.
        """
        entry = self._entry(file)
        if entry.document is not None and not isinstance(entry.document, StubsDocument):
            kind = kind_of_document(entry.document)
            raise InputError(f"{entry.document.name!r} is a {kind}; expected stubs")
        return entry.stubs

    def _entry(self, file: Path) -> Entry:
        entry = self._shelf.entry(file)
        self._used[entry] = None
        return entry


def _read(file: Path, types: Registry[type]) -> Entry:
    source = _source(file)
    document, faults = validate(source)
    tree: TreeSpec | None = None
    stubs: Mapping[str, type[Skill]] = {}
    if document is not None:
        faults += _misnamed(document, source)
    if isinstance(document, (TreeDocument, MissionDocument)):
        tree = _tree(document, source, types, faults)
    if isinstance(document, StubsDocument):
        stubs, more = stub_skills(document, source, types)
        faults += more
    return Entry(source, document, tree, stubs, tuple(faults))


def _tree(
    document: TreeDocument | MissionDocument,
    source: Source,
    types: Registry[type],
    faults: list[Fault],
) -> TreeSpec:
    inputs = {
        name: _port(port, source, ("in", name), types, faults)
        for name, port in document.in_.items()
    }
    outputs = {
        name: _port(port, source, ("out", name), types, faults)
        for name, port in document.out.items()
    }
    for name in sorted(inputs.keys() & outputs.keys()):
        line, column = source.key_mark(("out", name))
        message = f"{name!r} is an input and an output; try a second name"
        faults.append(Fault(source.file, line, column, "", message))
    return TreeSpec(document, source, outline(document, source), inputs, outputs)


def _port(
    port: OutPort,
    source: Source,
    at: tuple[str, str],
    types: Registry[type],
    faults: list[Fault],
) -> Port:
    kind: Any = Any
    default: object = REQUIRED
    where: tuple[str, ...] = (*at, "type")
    try:
        kind = parse_type(port.type, types)
        if isinstance(port, InPort) and port.has_default:
            where = (*at, "default")
            default = fit(port.default, kind)
    except (InputError, ValueError) as error:
        line, column = source.value_mark(where)
        faults.append(Fault(source.file, line, column, "", f"{'/'.join(at)}: {error}"))
    return Port(kind, port.about, port.unit, default)


def _source(file: Path) -> Source:
    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from None
    try:
        return read_source(str(file), data.decode("utf-8"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        column = error.start - data.rfind(b"\n", 0, error.start)
        message = f"not UTF-8 text: byte 0x{data[error.start]:02x}; try to save it as UTF-8"
        return Source(str(file), "", None, {}, {}, (Fault(str(file), line, column, "", message),))


def kind_of_document(document: Document) -> str:
    """Return the key by which a document says what it is."""
    return next(kind for kind, model in DOCUMENTS.items() if isinstance(document, model))


def _misnamed(document: Document, source: Source) -> list[Fault]:
    """Say so when a file does not have the name of what is in it: nobody would find it."""
    stem = Path(source.file).stem
    if stem == document.name:
        return []
    kind = kind_of_document(document)
    line, column = source.value_mark((kind,))
    message = f"{kind} {document.name!r} is in a file named {stem!r}; expected the same name"
    return [Fault(source.file, line, column, "", message)]


def _says(file: Path, kind: str) -> bool:
    """Return whether a file looks like a document of a kind; for messages, so without parsing."""
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    keys = {line.partition(":")[0] for line in lines}
    # A mission names its cell, a campaign its mission.
    named_elsewhere = {"cell": "mission", "mission": "campaign"}
    return kind in keys and named_elsewhere.get(kind) not in keys
