"""Prints docs/skills.md from what `cellwright skills --json` says (`make pages`)."""

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

_INTRODUCTION = """\
# Skills

Every skill that ships, with its ports, the codes it can fail with and the devices it needs. This
page is written by `make pages` from the skills themselves; `cellwright skills` prints the same.
"""


def page() -> str:
    """Return the page as Markdown."""
    command = [Path(sys.executable).with_name("cellwright"), "skills", "--json"]
    listing = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return "\n".join([_INTRODUCTION, *(_section(skill) for skill in json.loads(listing))])


def _section(skill: Mapping[str, Any]) -> str:
    parts = [f"## {skill['skill']}", skill["about"]]
    if skill["in"] or skill["out"]:
        parts.append(_table(skill["in"], skill["out"]))
    facts = [
        "Moves something in the cell." if skill["acts"] else "",
        f"Fails with {_codes(skill['reasons'])}." if skill["reasons"] else "Never fails.",
        f"Needs {_codes(f'{name}: {kind}' for name, kind in skill['devices'].items())}."
        if skill["devices"]
        else "",
    ]
    parts.append(" ".join(fact for fact in facts if fact))
    return "\n\n".join(parts) + "\n"


def _table(inputs: Sequence[Mapping[str, Any]], outputs: Sequence[Mapping[str, Any]]) -> str:
    rows = ["| port | type | unit | default | about |", "|---|---|---|---|---|"]
    rows += [_row("in", port) for port in inputs] + [_row("out", port) for port in outputs]
    return "\n".join(rows)


def _row(direction: str, port: Mapping[str, Any]) -> str:
    default = f"`{port['default']}`" if "default" in port else ""
    kind = port["type"].replace("|", "\\|")
    name, about = f"{direction} `{port['name']}`", port["about"]
    return f"| {name} | `{kind}` | {port['unit']} | {default} | {about} |"


def _codes(names: Any) -> str:
    return ", ".join(f"`{name}`" for name in names)


if __name__ == "__main__":
    sys.stdout.write(page())
