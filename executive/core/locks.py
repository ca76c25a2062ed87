"""A file that only one process can hold: of a cell, or of a folder that somebody writes to."""

import fcntl
import os
from pathlib import Path
from types import TracebackType
from typing import Self

from executive.core.errors import InputError


class FileLock:
    """Held while the block lasts; the system lets go of it when the process dies.

    The file stays, with the process that had it last: to remove it would let two in.
    """

    def __init__(self, file: Path, what: str) -> None:
        """Name the file and what it stands for, as in `the cell 'yumi_table'`."""
        self._file, self._what = file, what
        self._descriptor = -1

    def __enter__(self) -> Self:
        """Take it.

        Raises:
            InputError: Another process has it, or the file cannot be written.
        """
        try:
            self._descriptor = os.open(self._file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise InputError(f"{self._file}: cannot be locked; got {error.strerror}") from None
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            holder = os.read(self._descriptor, 64).decode(errors="replace").strip()
            self._let_go()
            raise InputError(
                f"{self._what} is held by another process ({holder or 'unknown'}); "
                "expected to be the only one; try again when that one has ended"
            ) from None
        os.truncate(self._descriptor, 0)
        os.pwrite(self._descriptor, f"process {os.getpid()}\n".encode(), 0)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Let go of it."""
        self._let_go()

    def _let_go(self) -> None:
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1
