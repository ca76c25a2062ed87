"""Which files a command means that takes files and folders."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from executive.core.errors import InputError
from executive.engine.loading.library import search_folders

TREES: Final = (Path("trees"),)
"""What is meant where no file is named."""


def yaml_files(paths: Sequence[Path]) -> list[Path]:
    """Return the files among some paths, and all YAML files in the folders among them.

    Raises:
        InputError: There is nothing of such a name, or no file in all of them.
    """
    found: dict[Path, None] = {}
    for path in paths:
        there = path if path.exists() else _by_name(path)
        found |= dict.fromkeys(sorted(there.rglob("*.yaml")) if there.is_dir() else [there])
    if not found:
        where = ", ".join(map(str, paths))
        raise InputError(f"no YAML files in {where}; expected some that end with .yaml")
    return [*found]


def _by_name(name: Path) -> Path:
    """Return the document of that name where trees are looked for, as `run` does."""
    for folder in search_folders(None, ()):
        if (folder / f"{name}.yaml").is_file():
            return folder / f"{name}.yaml"
    raise InputError(
        f"{name}: no such file or folder; try the name of a YAML file, or of a mission"
    )
