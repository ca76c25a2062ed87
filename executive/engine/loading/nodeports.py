"""The ports of whatever a leaf can run: skills, and other trees."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType

from executive.core.registry import Registry
from executive.core.skill import Port, Skill, input_ports
from executive.engine.language.node_models import SkillNode, SubtreeNode
from executive.engine.language.outline import NodeSpec, TreeSpec


@dataclass(frozen=True, slots=True)
class NodePorts:
    """Input and output ports by name."""

    inputs: Mapping[str, Port] = field(default_factory=lambda: MappingProxyType({}))
    outputs: Mapping[str, Port] = field(default_factory=lambda: MappingProxyType({}))


class PortTable:
    """Answers for the ports of leaves; signatures are read once."""

    def __init__(
        self, skills: Registry[type[Skill]], subtrees: Mapping[str, TreeSpec | None]
    ) -> None:
        """Know the skills, and the trees that could be loaded."""
        self._skills = skills
        self._subtrees = subtrees

    def of(self, node: NodeSpec) -> NodePorts | None:
        """Return the ports of a leaf, None where it runs something unknown."""
        if isinstance(node.model, SubtreeNode):
            tree = self._subtrees.get(node.model.subtree)
            return NodePorts(tree.inputs, tree.outputs) if tree else None
        if isinstance(node.model, SkillNode):
            return self._skill(node.model.skill)
        return NodePorts()

    def _skill(self, name: str) -> NodePorts | None:
        if name not in self._skills:
            return None
        return _ports_of(self._skills.get(name))


@lru_cache(maxsize=1024)  # resolving annotations is what takes longest in a check
def _ports_of(skill: type[Skill]) -> NodePorts:
    return NodePorts(MappingProxyType(input_ports(skill)), skill.OUT)
