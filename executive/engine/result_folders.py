"""Folders of many runs: what was asked for, and each result as soon as it is there."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import BaseModel, ValidationError

from executive.core.errors import InputError

PLAN, RESULTS = "campaign.json", "results.jsonl"

Result = TypeVar("Result", bound=BaseModel)


def begin_folder(folder: Path, plan: BaseModel, inside: str = "") -> None:
    """Make a folder, and one inside it; write its plan in one go.

    Raises:
        InputError: It holds a campaign already, or cannot be made.
    """
    if (folder / PLAN).exists():
        raise InputError(f"{folder}: holds a campaign already; try --resume, or another --out")
    try:
        (folder / inside).mkdir(parents=True, exist_ok=True)
        file = folder / f"{PLAN}.new"
        file.write_text(plan.model_dump_json(indent=1, by_alias=True), encoding="utf-8")
        file.replace(folder / PLAN)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror}") from None


class ResultLines(Generic[Result]):
    """Results as lines of JSON that a kill cannot take back."""

    def __init__(self, folder: Path, model: type[Result]) -> None:
        """Name the folder; nothing is read or written yet."""
        self._file, self._model = folder / RESULTS, model

    def add(self, result: Result) -> None:
        """Keep a result: it is with the operating system when this returns.

        Raises:
            InputError: It cannot be written; the run is repeated when the campaign goes on.
        """
        line = result.model_dump_json().encode() + b"\n"
        try:
            with self._file.open("ab", buffering=0) as lines:
                begun = lines.tell()
                if lines.write(line) != len(line):
                    os.truncate(self._file, begun)
                    raise OSError(0, "no space for a whole line")
        except OSError as error:
            raise InputError(
                f"{self._file}: cannot be written; got {error.strerror}; "
                "make room, and go on with --resume"
            ) from None

    def __iter__(self) -> Iterator[Result]:
        """Yield the results so far; a line that was cut off or damaged is left out."""
        if not self._file.exists():
            return
        with self._file.open("rb") as lines:
            for line in lines:
                try:
                    yield self._model.model_validate_json(line)
                except ValidationError:
                    continue

    def end_last_line(self) -> None:
        """End a line that was cut off by a kill, so that the next result has its own."""
        if not self._file.exists() or not self._file.stat().st_size:
            return
        with self._file.open("rb+") as lines:
            lines.seek(-1, os.SEEK_END)
            if lines.read() != b"\n":
                lines.write(b"\n")
