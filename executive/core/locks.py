"""A file that one process can hold, or some that share it: of a cell, or of a folder of results."""

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

    def __init__(self, file: Path, what: str, holder: str = "", *, shared: bool = False) -> None:
        """Prepare.

        Args:
            file: The file; made where there is none.
            what: What it stands for, as in `the cell 'yumi_table'`.
            holder: Who will hold it, for those that are refused.
            shared: Whether others that share it may hold it as well.
        """
        self._file, self._what, self._holder = file, what, holder
        self._way = fcntl.LOCK_SH if shared else fcntl.LOCK_EX
        self._descriptor = -1

    def __enter__(self) -> Self:
        """Take it.

        Raises:
            InputError: Another process has it and does not share it, or the file cannot be written.
        """
        try:
            self._descriptor = os.open(self._file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise InputError(f"{self._file}: cannot be locked; got {error.strerror}") from None
        try:
            fcntl.flock(self._descriptor, self._way | fcntl.LOCK_NB)
        except OSError:
            holder = os.read(self._descriptor, 256).decode(errors="replace").strip()
            self._let_go()
            raise InputError(
                f"{self._what} is held by another process ({holder or 'unknown'}); "
                "expected to be the only one; try again when that one has ended"
            ) from None
        os.truncate(self._descriptor, 0)
        held_by = ", ".join(filter(None, (f"process {os.getpid()}", self._holder)))
        os.pwrite(self._descriptor, f"{held_by}\n".encode(), 0)
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
