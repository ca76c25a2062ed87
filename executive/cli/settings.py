"""`--set key=value`: what a run changes of its mission."""

from collections.abc import Mapping, Sequence

from executive.app.settings import Setting, Settings, settled
from executive.core.errors import InputError
from executive.engine.language.sources import read_source


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
    return settled(map(_parsed, assignments), declared, scenario)


def _parsed(assignment: str) -> Setting:
    key, equals, text = assignment.partition("=")
    if not equals or not key.strip(". "):
        raise InputError(
            f"--set {assignment}: expected key=value; try --set confidence=0.9 or "
            "--set cable.knot=figure_8"
        )
    source = read_source(f"--set {key}", text)
    if source.faults:
        raise InputError("\n".join(str(fault) for fault in source.faults))
    return Setting(key.strip(), source.data, f"--set {assignment}")
