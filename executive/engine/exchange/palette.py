"""What editors of BehaviorTree.CPP show of our skills and trees: `TreeNodesModel`, with ports."""

import inspect
from collections.abc import Mapping

from executive.core.errors import InputError
from executive.core.skill import Port, Skill, input_ports
from executive.engine.exchange.attributes import comment_text, literal_text
from executive.engine.exchange.cpptypes import cpp_type
from executive.engine.exchange.xmltext import XmlElement, printable
from executive.engine.language.outline import TreeSpec
from executive.engine.language.porttypes import type_name
from executive.engine.language.stubs import ScriptedSkill


def foreign_id(name: str, skill: type[Skill]) -> str:
    """Return what a skill is called there: what its stub stands for, or its own name."""
    stands_for = skill.STANDS_FOR if issubclass(skill, ScriptedSkill) else ""
    return stands_for or name


def skill_model(name: str, skill: type[Skill]) -> XmlElement:
    """Return the model of a skill, by its name there."""
    about = (inspect.getdoc(skill) or "").partition("\n")[0]
    ports = _port_models(input_ports(skill), skill.OUT)
    return XmlElement("Action", {"ID": name}, ports, comment=comment_text(about))


def tree_model(tree: TreeSpec) -> XmlElement:
    """Return the model of a tree."""
    return XmlElement("SubTree", {"ID": tree.name}, _port_models(tree.inputs, tree.outputs))


def _port_models(inputs: Mapping[str, Port], outputs: Mapping[str, Port]) -> list[XmlElement]:
    found = []
    for tag, ports in (("input_port", inputs), ("output_port", outputs)):
        for name, port in ports.items():
            attributes = {"name": name}
            if kind := cpp_type(type_name(port.type)):
                attributes["type"] = kind
            if not port.required and tag == "input_port" and port.default is not None:
                attributes["default"] = _default_text(port)
            unit = f" [{port.unit}]" if port.unit else ""
            found.append(XmlElement(tag, attributes, text=printable(f"{port.about}{unit}".strip())))
    return found


def _default_text(port: Port) -> str:
    """Return a default for the palette of an editor, in words where it is no plain value."""
    try:
        return literal_text(port.default, port)
    except InputError:
        return printable(str(port.default))
