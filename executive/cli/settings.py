"""`--set key=value`: what a run changes of its mission."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.language.sources import read_source


@dataclass(frozen=True, slots=True)
class Settings:
    """What a mission runs with.

    Attributes:
        inputs: Values of its inputs.
        scenario: What is set up in its cell.
    """

    inputs: Mapping[str, object]
    scenario: Mapping[str, object]


def apply_settings(
    assignments: Sequence[str], declared: Sequence[str], scenario: Mapping[str, object]
) -> Settings:
    """Read `key=value` assignments, values as YAML.

    A key that begins with a declared input sets that input; any other one sets a place in
    the scenario, `cable.knot` being `knot` under `cable`.

    Args:
        assignments: As given on the command line; a later one wins.
        declared: Names of the mission's inputs.
        scenario: The scenario as the mission has it.

    Raises:
        InputError: No `=`, a value that is not YAML, or a key that is neither.
    """
    inputs: dict[str, object] = {}
    changed: dict[str, object] = dict(scenario)
    for assignment in assignments:
        key, value = _parsed(assignment)
        first, *rest = key.split(".")
        if first in declared and not rest:
            inputs[first] = value
        elif first in scenario or (not scenario and rest):
            changed = _with(changed, (first, *rest), value, assignment)
        else:
            known = [*declared, *scenario]
            raise InputError(f"--set {assignment}: unknown key {key!r}; {closest(first, known)}")
    return Settings(inputs, changed)


def _parsed(assignment: str) -> tuple[str, object]:
    key, equals, text = assignment.partition("=")
    if not equals or not key.strip(". "):
        raise InputError(
            f"--set {assignment}: expected key=value; try --set confidence=0.9 or "
            "--set cable.knot=figure_8"
        )
    source = read_source(f"--set {key}", text)
    if source.faults:
        raise InputError("\n".join(str(fault) for fault in source.faults))
    return key.strip(), source.data


def _with(
    tree: Mapping[str, object], keys: Sequence[str], value: object, assignment: str
) -> dict[str, object]:
    """Return a copy of nested mappings with one place set."""
    first, *rest = keys
    if not rest:
        return {**tree, first: value}
    below = tree.get(first, {})
    if not isinstance(below, Mapping):
        raise InputError(
            f"--set {assignment}: {first!r} holds {below!r}; expected a mapping with "
            f"{rest[0]!r} in it; try --set {first}=VALUE"
        )
    return {**tree, first: _with(below, rest, value, assignment)}
