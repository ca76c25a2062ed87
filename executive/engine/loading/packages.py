"""Trees, skills and port types of other people: from folders that the user names, and packages.

Folders come from the environment variable `CELLWRIGHT_PATH`. An installed package offers its
own by entry points, which its `pyproject.toml` declares:

    [project.entry-points."cellwright.trees"]
    packing = "packing.trees"                      # a package whose folder holds YAML files

    [project.entry-points."cellwright.skills"]
    close_box = "packing.skills.close_box:CloseBox"  # a Skill, or a py_trees leaf with ports

    [project.entry-points."cellwright.types"]
    Box = "packing.types:Box"
"""

import importlib.util
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from executive.core.errors import InputError
from executive.core.registry import Registry
from executive.core.skill import Skill

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

PATH_VARIABLE: Final = "CELLWRIGHT_PATH"
TREES, SKILLS, TYPES = "cellwright.trees", "cellwright.skills", "cellwright.types"

T = TypeVar("T")


def user_folders(environment: Mapping[str, str] = os.environ) -> tuple[Path, ...]:
    """Return the folders that the user has named, in order.

    Raises:
        InputError: One of them is no folder.
    """
    texts = [text for text in environment.get(PATH_VARIABLE, "").split(os.pathsep) if text]
    for text in texts:
        if not Path(text).is_dir():
            raise InputError(f"{PATH_VARIABLE}: {text!r} is no folder")
    return tuple(Path(text) for text in texts)


def put_first(folders: Sequence[Path]) -> None:
    """Name folders of the user for the rest of this process, before those named already."""
    before = os.environ.get(PATH_VARIABLE)
    texts = [*(str(folder) for folder in folders), *([before] if before else [])]
    os.environ[PATH_VARIABLE] = os.pathsep.join(texts)


def package_folders() -> tuple[Path, ...]:
    """Return the folders of trees that installed packages offer; none of them is imported.

    Raises:
        InputError: What a package declares is not there.
    """
    return tuple(_folder(point) for point in _points(TREES))


def add_packaged_skills(registry: Registry[type[Skill]]) -> Registry[type[Skill]]:
    """Add the skills that installed packages offer, and return the registry.

    Raises:
        InputError: One cannot be imported, is no skill, or has the name of another.
    """
    for point in _points(SKILLS):
        _add(registry, point, _as_skill(point, _loaded(point)))
    return registry


def add_packaged_types(registry: Registry[type]) -> Registry[type]:
    """Add the port types that installed packages offer, and return the registry.

    Raises:
        InputError: One cannot be imported, is no class, or has the name of another.
    """
    for point in _points(TYPES):
        kind = _loaded(point)
        if not isinstance(kind, type):
            raise InputError(f"{_origin(point)}: expected a class, got {kind!r}")
        _add(registry, point, kind)
    return registry


def _points(group: str) -> Iterator["EntryPoint"]:
    """Yield the entry points of a group, in an order that is the same every time."""
    if not _declares_any(tuple(sys.path)):
        return
    from importlib.metadata import entry_points  # slow to import, and to ask

    found = {(point.name, point.value): point for point in entry_points(group=group)}
    yield from (found[key] for key in sorted(found))


@cache
def _declares_any(search_path: tuple[str, ...]) -> bool:
    """Return whether any package mentions us; most have nothing to do with robot cells."""
    for entry in search_path:
        for file in Path(entry or ".").glob("*-info/entry_points.txt"):
            if b"[cellwright." in file.read_bytes():
                return True
    return False


def _folder(point: "EntryPoint") -> Path:
    try:
        spec = importlib.util.find_spec(point.value)
    except ImportError:
        spec = None
    folders = list(spec.submodule_search_locations or ()) if spec else []
    if not folders:
        raise InputError(f"{_origin(point)}: there is no package {point.value!r}")
    return Path(folders[0])


def _loaded(point: "EntryPoint") -> Any:
    try:
        return point.load()
    except Exception as error:  # whatever the module of somebody else raises
        what = f"{type(error).__name__}: {error}"
        raise InputError(f"{_origin(point)}: cannot be imported: {what}") from error


def _as_skill(point: "EntryPoint", thing: Any) -> type[Skill]:
    if isinstance(thing, type) and issubclass(thing, Skill):
        return thing
    from executive.engine.nodes.foreign import skill_from_behaviour  # brings py_trees with it

    try:
        return skill_from_behaviour(thing)
    except TypeError:
        raise InputError(
            f"{_origin(point)}: expected a Skill or a py_trees leaf with ports, got {thing!r}"
        ) from None


def _add(registry: Registry[T], point: "EntryPoint", thing: T) -> None:
    try:
        registry.add(point.name, thing)
    except ValueError as error:
        raise InputError(f"{_origin(point)}: {error}; try another name") from None


def _origin(point: "EntryPoint") -> str:
    """Return who declares an entry point, for messages."""
    package = point.dist.name if point.dist else "a package"
    return f"{package}: entry point {point.name!r} of {point.group} ({point.value})"
