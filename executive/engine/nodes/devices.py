"""Binds the devices of a cell to the skills that ask for them, by name and type."""

import inspect
from collections.abc import Mapping

from executive.core.registry import closest
from executive.core.skill import Skill, device_types
from executive.engine.language.fitting import check
from executive.engine.language.porttypes import type_name


def bind(skill: type[Skill], devices: Mapping[str, object]) -> tuple[dict[str, object], list[str]]:
    """Return the devices for a skill's constructor, and what keeps it from being built.

    Args:
        skill: The skill.
        devices: Devices of the cell, by name.
    """
    bound: dict[str, object] = {}
    problems: list[str] = []
    parameters = inspect.signature(skill).parameters
    for name, kind in device_types(skill).items():
        if name in devices:
            bound[name] = devices[name]
            problem = _misfit(devices[name], kind)
            problems += [f"device {name!r}: {problem}"] if problem else []
        elif parameters[name].default is inspect.Parameter.empty:
            known = closest(name, [*devices])
            problems.append(f"the cell has no device {name!r} ({type_name(kind)}); {known}")
    return bound, problems


def _misfit(device: object, kind: object) -> str:
    try:
        check(device, kind)
    except ValueError as error:
        return str(error)
    except TypeError:  # a protocol that cannot be checked at run time
        return ""
    return ""
