"""Holds against each other what the children of a parallel claim, before anything runs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from executive.core.errors import Fault
from executive.core.registry import Registry
from executive.core.skill import Skill
from executive.engine.language.block_models import ParallelBody
from executive.engine.language.node_models import SkillNode, SubtreeNode
from executive.engine.language.outline import NodeSpec, TreeSpec


@dataclass(frozen=True, slots=True)
class _Claim:
    """A skill that claims something, and where.

    Attributes:
        resources: What it claims.
        node: Its node, or the node of this tree whose subtree it is in.
        path: Its path below the root of this tree.
        place: File and line of the skill itself.
    """

    resources: frozenset[str]
    node: NodeSpec
    path: str
    place: str


def claim_faults(
    tree: TreeSpec,
    skills: Registry[type[Skill]],
    subtrees: Mapping[str, TreeSpec | None],
) -> Iterator[Fault]:
    """Yield skills that may run at the same time and claim the same thing.

    Args:
        tree: The tree.
        skills: Skills by name.
        subtrees: Trees by name, those that its subtrees use included; None for a broken one.
    """
    finder = _Finder(skills, subtrees)
    for node in tree.root.walk():
        if isinstance(node.model, ParallelBody):
            claims = [list(finder.below(child, child, child.path, ())) for child in node.children]
            for earlier, later in combinations(claims, 2):
                yield from _conflicts(node, earlier, later)


def _conflicts(parallel: NodeSpec, earlier: list[_Claim], later: list[_Claim]) -> Iterator[Fault]:
    for claim in later:
        for other in earlier:
            shared = sorted(claim.resources & other.resources)
            if shared:
                where = "" if claim.path == claim.node.path else f"{claim.path} ({claim.place}): "
                yield claim.node.fault(
                    f"{where}claims {', '.join(shared)}, and so does {other.path} "
                    f"({other.place}), which runs at the same time in {parallel.path}; "
                    "try a sequence"
                )
                break


class _Finder:
    def __init__(
        self, skills: Registry[type[Skill]], subtrees: Mapping[str, TreeSpec | None]
    ) -> None:
        self._skills, self._subtrees = skills, subtrees

    def below(
        self, node: NodeSpec, outer: NodeSpec, path: str, inside: tuple[str, ...]
    ) -> Iterator[_Claim]:
        """Yield what skills at and below a node claim.

        Args:
            node: The node.
            outer: The node of the tree that is checked; another one in a subtree.
            path: Path of the node below the root of that tree.
            inside: Names of the subtrees that it stands in.
        """
        model = node.model
        if isinstance(model, SkillNode) and model.skill in self._skills:
            claims = self._skills.get(model.skill).CLAIMS
            if claims:
                place = f"{node.source.file}:{node.mark[0]}"
                yield _Claim(claims, outer, path, place)
        if isinstance(model, SubtreeNode) and model.subtree not in inside:
            tree = self._subtrees.get(model.subtree)
            if tree is not None:
                yield from self.below(tree.root, outer, path, (*inside, model.subtree))
        for child in node.children:
            further = child if outer is node else outer
            yield from self.below(child, further, f"{path}/{child.name}", inside)
