"""Which files a command means that takes files and folders."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from executive.core.errors import InputError

TREES: Final = (Path("trees"),)
"""What is meant where no file is named."""


def yaml_files(paths: Sequence[Path]) -> list[Path]:
    """Return the files among some paths, and all YAML files in the folders among them.

    Raises:
        InputError: There is nothing of such a name, or no file in all of them.
    """
    found: dict[Path, None] = {}
    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: no such file or folder; try the name of a YAML file")
        found |= dict.fromkeys(sorted(path.rglob("*.yaml")) if path.is_dir() else [path])
    if not found:
        raise InputError(f"no YAML files in {', '.join(map(str, paths))}")
    return [*found]
