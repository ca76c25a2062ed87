"""What a run changes of its mission: values by key, each an input or a place in the scenario."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from executive.core.errors import InputError
from executive.core.registry import closest


@dataclass(frozen=True, slots=True)
class Settings:
    """What a mission runs with.

    Attributes:
        inputs: Values of its inputs.
        scenario: What is set up in its cell.
    """

    inputs: Mapping[str, object]
    scenario: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Setting:
    """A value for one key.

    Attributes:
        key: An input, or a place in the scenario, `cable.knot` being `knot` under `cable`.
        value: The value.
        where: What the user wrote, for messages.
    """

    key: str
    value: object
    where: str


def settled(
    settings: Iterable[Setting], declared: Sequence[str], scenario: Mapping[str, object]
) -> Settings:
    """Sort settings into inputs and scenario; a later one wins.

    Args:
        settings: What is set.
        declared: Names of the mission's inputs.
        scenario: The scenario as the mission has it.

    Raises:
        InputError: A key is neither.
    """
    inputs: dict[str, object] = {}
    changed: dict[str, object] = dict(scenario)
    for one in settings:
        first, *rest = one.key.split(".")
        if first in declared and not rest:
            inputs[first] = one.value
        elif first in scenario or (not scenario and rest):
            changed = _with(changed, (first, *rest), one)
        else:
            known = [*declared, *scenario]
            raise InputError(f"{one.where}: unknown key {one.key!r}; {closest(first, known)}")
    return Settings(inputs, changed)


def _with(tree: Mapping[str, object], keys: Sequence[str], setting: Setting) -> dict[str, object]:
    """Return a copy of nested mappings with one place set."""
    first, *rest = keys
    if not rest:
        return {**tree, first: setting.value}
    below = tree.get(first, {})
    if not isinstance(below, Mapping):
        raise InputError(
            f"{setting.where}: {first!r} holds {below!r}; expected a mapping with "
            f"{rest[0]!r} in it; try --set {first}=VALUE"
        )
    return {**tree, first: _with(below, rest, setting)}
