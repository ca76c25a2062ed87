"""Missions and cells of this installation: loaded with its skills, settings held against them."""

from collections.abc import Mapping
from pathlib import Path

from executive.app.settings import Setting, Settings, settled
from executive.core.errors import DocumentError, InputError
from executive.engine.language.document import CellDocument
from executive.engine.loading.library import Library, Shelf, search_folders
from executive.engine.loading.loader import Mission, load_mission


def load(mission: str | Path) -> Mission:
    """Load a mission with the skills and types of this installation.

    Raises:
        InputError: What is wrong with it.
    """
    from executive.app.catalogue import port_types, skills

    return load_mission(mission, skills=skills(), types=port_types())


def load_cell(named: str) -> tuple[CellDocument, Path]:
    """Load the document of a cell; return it with its file.

    Args:
        named: Its file, or its name.

    Raises:
        InputError: There is none, or it has faults.
    """
    from executive.app.catalogue import port_types

    beside = Path(named)
    library = Library(Shelf(port_types()), search_folders(beside if beside.is_file() else None, ()))
    file = beside if beside.is_file() else library.find(named, "cell")
    document = library.document(file)
    if library.faults:
        raise DocumentError(library.faults)
    if not isinstance(document, CellDocument):
        raise InputError(f"{file}: is no cell; expected a document with the key cell")
    return document, file.resolve()


def settings_of(mission: Mission, values: Mapping[str, object]) -> Settings:
    """Sort values by key into inputs and scenario of a mission.

    Raises:
        InputError: A key is neither.
    """
    where = f"{mission.name}: set"
    settings = [Setting(key, value, where) for key, value in values.items()]
    return settled(settings, tuple(mission.document.in_), mission.document.scenario)
