"""The trees of a recording, loaded again with skills that have ports and do nothing.

Nothing but the recording is needed: a skill has the ports that the trees wire. So a run is
ticked again where its skills, or the devices that they ask for, are not installed.
"""

import inspect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from executive.core.errors import DocumentError, InputError
from executive.core.registry import Registry, closest
from executive.core.skill import Port, Skill
from executive.engine.language.document import Document, MissionDocument, TreeDocument
from executive.engine.language.node_models import SkillNode, SubtreeNode
from executive.engine.language.outline import NodeSpec, TreeSpec
from executive.engine.language.sources import read_source
from executive.engine.loading.library import Library, Shelf, search_folders
from executive.engine.loading.loader import Program, load_mission, load_program
from executive.engine.loading.validation import validate
from executive.engine.recording.messages import MissionHeader, SourceFile


@dataclass(frozen=True, slots=True, eq=False)
class ReloadedProgram:
    """The trees of a recording, some of them edited perhaps.

    Attributes:
        program: What can be built without any device.
        sources: Its files.
    """

    program: Program
    sources: tuple[SourceFile, ...]


def reload_program(
    header: MissionHeader, types: Registry[type], edited: Sequence[Path] = ()
) -> ReloadedProgram:
    """Load what a recording was run from.

    Args:
        header: Of the recording.
        types: Types that ports may have, by name.
        edited: Files that take the place of recorded ones with the same tree or mission.

    Raises:
        InputError: The recording holds no sources, or a file is none of its trees.
        DocumentError: All that is wrong with the trees.
    """
    if not header.sources:
        raise InputError(
            f"{header.mission}: the recording holds no sources; expected one that cellwright run "
            "has written"
        )
    with TemporaryDirectory() as name:
        folder = Path(name)
        origins = dict(_laid_out(header, edited, folder))
        root = folder / f"{Path(header.sources[0].file).stem}.yaml"
        try:
            program = _loaded(root, types, edited)
        except DocumentError as error:
            faults = [
                replace(fault, file=origins.get(fault.file, fault.file)) for fault in error.faults
            ]
            raise DocumentError(faults) from None
    _require_used(edited, origins, program)
    sources = tuple(
        SourceFile(
            file=origins.get(source.file, source.file), sha256=source.sha256, text=source.text
        )
        for source in program.sources
    )
    return ReloadedProgram(program, sources)


def _laid_out(
    header: MissionHeader, edited: Sequence[Path], folder: Path
) -> Iterator[tuple[str, str]]:
    """Write every file once into a folder; yield where it is there, and where it was."""
    for source in header.sources:
        file = folder / Path(source.file).name
        file.write_text(source.text, encoding="utf-8")
        yield str(file), source.file
    for path in edited:
        text = _text(path)
        document = _document(path, text)
        if isinstance(document, MissionDocument) and document.name != header.mission:
            raise InputError(
                f"{path}: mission {document.name!r}; expected {header.mission!r}, as recorded"
            )
        file = folder / f"{document.name}.yaml"
        file.write_text(text, encoding="utf-8")
        yield str(file), str(path)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is no UTF-8 text: {error}") from None


def _document(path: Path, text: str) -> Document:
    document, faults = validate(read_source(str(path), text))
    if document is None:
        raise DocumentError(faults)
    return document


def _loaded(root: Path, types: Registry[type], edited: Sequence[Path]) -> Program:
    search_paths = [folder for path in edited for folder in (path.parent, path.parent.parent)]
    shelf = Shelf(types)
    library = Library(shelf, search_folders(root, search_paths))
    load = load_mission if isinstance(library.document(root), MissionDocument) else load_program
    skills = _wired_skills(library, root)
    return load(root, skills=skills, types=types, search_paths=search_paths)


def _require_used(edited: Sequence[Path], origins: Mapping[str, str], program: Program) -> None:
    used = {origins.get(source.file, source.file) for source in program.sources}
    for path in edited:
        if str(path) not in used:
            known = sorted({program.tree.name, *program.subtrees})
            raise InputError(
                f"{path}: nothing that was recorded uses it; {closest(path.stem, known)}"
            )


def _wired_skills(library: Library, root: Path) -> Registry[type[Skill]]:
    """Return a skill for every name that a tree runs, with all ports that trees wire."""
    inputs: dict[str, dict[str, None]] = {}
    outputs: dict[str, dict[str, None]] = {}
    stubs: set[str] = set()
    for tree in _reached(library, root):
        stubs.update(_stubs(library, tree.document))
        for spec in tree.root.walk():
            if isinstance(spec.model, SkillNode):
                inputs.setdefault(spec.model.skill, {}).update(dict.fromkeys(spec.model.in_))
                outputs.setdefault(spec.model.skill, {}).update(dict.fromkeys(spec.model.out))
    registry: Registry[type[Skill]] = Registry("skill")
    for name in inputs.keys() - stubs:
        registry.add(name, _stand_in(name, tuple(inputs[name]), tuple(outputs[name])))
    return registry


def _reached(library: Library, root: Path) -> Iterator[TreeSpec]:
    """Yield a tree and every tree that it uses; what is missing or faulty is told later."""
    names, files = set(), [root]
    while files:
        tree = library.tree(files.pop())
        if tree is None:
            continue
        yield tree
        for name in _subtrees(tree.root):
            if name not in names:
                names.add(name)
                try:
                    files.append(library.find(name, "tree"))
                except InputError:
                    continue


def _subtrees(root: NodeSpec) -> Iterator[str]:
    return (spec.model.subtree for spec in root.walk() if isinstance(spec.model, SubtreeNode))


def _stubs(library: Library, document: MissionDocument | TreeDocument) -> Iterator[str]:
    for name in document.uses:
        try:
            yield from library.stubs(library.find(name, "stubs"))
        except InputError:
            continue


def _stand_in(name: str, inputs: Sequence[str], outputs: Sequence[str]) -> type[Skill]:
    def run(self: Skill, **_: object) -> Any:
        raise AssertionError(f"{self}: stands for a skill, and is never stepped")

    run.__annotations__ = dict.fromkeys(inputs, Any)
    keyword = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter(port, keyword, default=None) for port in inputs]
    this = inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    run.__signature__ = inspect.Signature([this, *parameters])  # type: ignore[attr-defined]  # as inspect reads it
    return type(name, (Skill,), {"run": run, "OUT": {port: Port(Any) for port in outputs}})
