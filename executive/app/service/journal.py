"""The missions of a cell in a file, so that a service that was killed knows them again."""

import os
from collections.abc import Iterable
from pathlib import Path

from pydantic import ValidationError

from executive.app.service.messages import MissionView
from executive.core.errors import InputError

KEPT = 1000
"""Missions that a service knows; older ones are in its recordings alone."""


class Journal:
    """A line a change of a mission; the last one of each counts."""

    def __init__(self, file: Path) -> None:
        """Name the file.

        Raises:
            InputError: Its folder cannot be made.
        """
        self._file = file
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{file.parent}: cannot be made; got {error.strerror}") from None

    def read(self) -> list[MissionView]:
        """Return the missions that were known, the oldest first; damaged lines are left out."""
        found: dict[int, MissionView] = {}
        try:
            with self._file.open("rb") as lines:
                for line in lines:
                    try:
                        view = MissionView.model_validate_json(line)
                    except ValidationError:
                        continue
                    found[view.id] = view
        except FileNotFoundError:
            return []
        return sorted(found.values(), key=lambda view: view.id)[-KEPT:]

    def begin(self, views: Iterable[MissionView]) -> None:
        """Write the file anew with these missions."""
        new = self._file.with_name(f"{self._file.name}.new")
        with new.open("wb") as file:
            file.writelines(_line(view) for view in views)
            file.flush()
            os.fsync(file.fileno())
        new.replace(self._file)

    def add(self, view: MissionView) -> None:
        """Keep a change.

        Raises:
            InputError: It cannot be written.
        """
        try:
            with self._file.open("ab", buffering=0) as file:
                begun, line = file.tell(), _line(view)
                if file.write(line) != len(line):
                    os.truncate(self._file, begun)
                    raise OSError(0, "no space for a whole line")
        except OSError as error:
            raise InputError(
                f"{self._file}: cannot be written; got {error.strerror}; try making room"
            ) from None


def _line(view: MissionView) -> bytes:
    return view.model_dump_json().encode() + b"\n"
