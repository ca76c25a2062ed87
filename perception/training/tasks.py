"""What can be trained, by name; a task's module is imported when it is asked for."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

from executive.core.errors import InputError
from executive.core.registry import closest

if TYPE_CHECKING:
    from perception.training.loop import Task

# Takes a command line: the folder of a version, and options.
Step = Callable[[Sequence[str]], None]

TASKS: Mapping[str, str] = MappingProxyType(
    {
        "tracer": "tracer:TracerTask",
        "crossing": "crossing:CrossingTask",
        "sight": "sight:SightTask",
        "thesis-crossing": "thesis_crossing:ThesisCrossingTask",
        "thesis-spatial": "thesis_spatial:ThesisSpatialTask",
    }
)

# What usually comes after the training of a task.
AFTER: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "tracer": ("calibrate", "trace-posterior"),
        "crossing": ("calibrate",),
        "sight": ("sight-calibration",),
        "thesis-crossing": ("calibrate",),
        "thesis-spatial": ("spatial-measure",),
    }
)

STEPS: Mapping[str, str] = MappingProxyType(
    {
        "calibrate": "calibrate:main",
        "sight-calibration": "sight_calibration:main",
        "spatial-measure": "spatial_measure:main",
        "trace-posterior": "trace_posterior:main",
    }
)


def load_task(name: str) -> "Task":
    """Return a task.

    Raises:
        InputError: There is none of that name.
    """
    return cast("Task", _named("task", name, TASKS)())


def task_name(task: "Task") -> str:
    """Return the name that a task is known by."""
    return next(name for name, path in TASKS.items() if path.endswith(f":{type(task).__name__}"))


def load_step(name: str) -> Step:
    """Return what is done to a version after its training.

    Raises:
        InputError: There is none of that name.
    """
    return cast("Step", _named("step", name, STEPS))


def _named(kind: str, name: str, known: Mapping[str, str]) -> Callable[..., object]:
    if name not in known:
        raise InputError(f"{kind}: unknown; got {name!r}; {closest(name, [*known])}")
    module, attribute = known[name].split(":")
    found: Callable[..., object] = getattr(
        import_module(f"perception.training.{module}"), attribute
    )
    return found
