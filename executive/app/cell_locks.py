"""Who may use a cell: one service alone, or runs that were started by hand.

Runs beside each other are let in, since each has a simulated world of its own. None of them is let
in beside a service, which stands for the cell: what it says of the cell's state is to be true.
"""

import hashlib
import os
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from executive.core.locks import FileLock
from executive.engine.loading.loader import Mission
from executive.engine.running.remote import runtime_folder

HELD_VARIABLE = "CELLWRIGHT_CELL_HELD"
"""Names the lock that whoever started this process holds for it."""


def lock_of(cell: str, file: Path) -> Path:
    """Return the file that whoever uses a cell holds.

    Args:
        cell: Its name.
        file: Its document: cells of two projects may have one name.
    """
    mark = hashlib.sha256(str(file.resolve()).encode()).hexdigest()[:12]
    return runtime_folder() / f"cell-{cell}-{mark}.lock"


def serving(cell: str, lock: Path) -> FileLock:
    """Return what keeps everybody else from a cell while it lasts."""
    return FileLock(lock, f"the cell {cell!r}", "cellwright serve")


def running(mission: Mission) -> AbstractContextManager[object]:
    """Return what keeps services from a mission's cell while it lasts.

    The missions of a service run on the cell that the service holds.
    """
    cell = mission.cell.name
    lock = lock_of(cell, mission.cell_file)
    if os.environ.get(HELD_VARIABLE) == str(lock):
        return nullcontext()
    return FileLock(lock, f"the cell {cell!r}", f"cellwright run {mission.name}", shared=True)
