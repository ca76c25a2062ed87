"""`cellwright skills`: what the leaves of a tree can run."""

import inspect
import json
from collections.abc import Mapping
from typing import Annotated

import typer

from executive.app.catalogue import skills as shipped_skills
from executive.core.skill import Port, Skill, device_types, input_ports
from executive.engine.language.porttypes import type_name


def skills(
    names: Annotated[
        list[str] | None, typer.Argument(help="Only these skills; all without any.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document on stdout.")
    ] = False,
) -> None:
    """List the skills with their ports, units and reasons to fail."""
    registry = shipped_skills()
    chosen = {name: registry.get(name) for name in names or registry}
    if as_json:
        described = [_described(name, skill) for name, skill in chosen.items()]
        typer.echo(json.dumps(described, indent=2))
    else:
        typer.echo("\n\n".join(_page(name, skill) for name, skill in chosen.items()))


def _described(name: str, skill: type[Skill]) -> dict[str, object]:
    return {
        "skill": name,
        "about": _first_line(skill),
        "acts": skill.ACTS,
        "in": [_port(port_name, port) for port_name, port in input_ports(skill).items()],
        "out": [_port(port_name, port) for port_name, port in skill.OUT.items()],
        "reasons": sorted(skill.REASONS),
        "devices": {device: type_name(kind) for device, kind in device_types(skill).items()},
    }


def _port(name: str, port: Port) -> dict[str, object]:
    described: dict[str, object] = {
        "name": name,
        "type": type_name(port.type),
        "unit": port.unit,
        "about": port.about,
        "required": port.required,
    }
    return described if port.required else {**described, "default": repr(port.default)}


def _page(name: str, skill: type[Skill]) -> str:
    lines = [f"{name}{' (acts)' if skill.ACTS else ''}: {_first_line(skill)}"]
    lines += _ports("in", input_ports(skill))
    lines += _ports("out", skill.OUT)
    if skill.REASONS:
        lines.append(f"  fails with {', '.join(sorted(skill.REASONS))}")
    devices = ", ".join(f"{key}: {type_name(kind)}" for key, kind in device_types(skill).items())
    return "\n".join([*lines, f"  needs {devices}"] if devices else lines)


def _ports(direction: str, ports: Mapping[str, Port]) -> list[str]:
    return [f"  {direction:<3} {port_line(name, port)}" for name, port in ports.items()]


def port_line(name: str, port: Port) -> str:
    """Return one port as one line: name, type, unit, default and what it is about."""
    unit = f" [{port.unit}]" if port.unit else ""
    default = "" if port.required else f" = {port.default!r}"
    about = f"  {port.about}" if port.about else ""
    return f"{name}: {type_name(port.type)}{unit}{default}{about}"


def _first_line(skill: type[Skill]) -> str:
    return (inspect.getdoc(skill) or "").partition("\n")[0]
