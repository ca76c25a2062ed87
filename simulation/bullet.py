"""PyBullet, imported where it is needed and without the greeting that it writes."""

import os
import sys
from typing import Any


def import_pybullet() -> Any:
    """Import PyBullet without the greeting that it writes to standard error."""
    sys.stderr.flush()
    stderr, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        import pybullet
    finally:
        os.dup2(stderr, 2)
        os.close(stderr)
        os.close(nowhere)
    return pybullet
