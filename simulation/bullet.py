"""PyBullet, imported where it is needed and without the greeting that it writes."""

from typing import Any

from executive.core.descriptors import standard_error_dropped


def import_pybullet() -> Any:
    """Import PyBullet without the greeting that it writes to standard error."""
    with standard_error_dropped():
        import pybullet
    return pybullet
