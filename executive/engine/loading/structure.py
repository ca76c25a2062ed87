"""What a tree says about its nodes themselves: skills, names, policies."""

from collections import Counter
from collections.abc import Iterator

from executive.core.errors import Fault
from executive.core.registry import Registry, closest
from executive.core.skill import Skill
from executive.engine.language.block_models import BlockBody, CasesBody, ObserveBody, ParallelBody
from executive.engine.language.node_models import SkillNode, UnsetNode
from executive.engine.language.outline import NodeSpec, TreeSpec


def structural_faults(tree: TreeSpec, skills: Registry[type[Skill]]) -> Iterator[Fault]:
    """Yield what is wrong with the nodes of a tree, whatever they read and write."""
    root = tree.root
    if root.model.name not in (None, tree.name):
        message = f"the root is named after its tree, {tree.name!r}; drop the name"
        yield root.fault(message, "name")
    yield from _keep_faults(tree)
    for node in root.walk():
        model = node.model
        if isinstance(model, SkillNode) and model.skill not in skills:
            message = f"unknown skill {model.skill!r}; {closest(model.skill, [*skills])}"
            yield node.fault(message, "skill")
        if isinstance(model, UnsetNode):
            yield from _unset_faults(node, model, tree)
        if isinstance(model, (BlockBody, CasesBody)):
            yield from _sibling_faults(node)
        if isinstance(model, ObserveBody) and not (model.status or model.counts):
            yield node.fault("observe needs a key for status, counts or both")
        if isinstance(model, ParallelBody):
            yield from _policy_faults(node, model)


def _keep_faults(tree: TreeSpec) -> Iterator[Fault]:
    for key, value in tree.document.keep.items():
        if key in tree.inputs or key in tree.outputs:
            message = f"{key!r} is a port of the tree, which has its value from outside"
        elif isinstance(value, str) and value.startswith("$"):
            message = f"{key!r} needs a first value that is written out; got {value!r}"
        else:
            continue
        line, column = tree.source.value_mark(("keep", key))
        yield Fault(tree.source.file, line, column, tree.name, f"keep: {message}")


def _unset_faults(node: NodeSpec, model: UnsetNode, tree: TreeSpec) -> Iterator[Fault]:
    for key in model.keys:
        if key in tree.inputs:
            message = f"{key!r} is an input of the tree, which keeps its value; try another key"
            yield node.fault(message, "unset")


def _sibling_faults(node: NodeSpec) -> Iterator[Fault]:
    counts = Counter(child.name for child in node.children)
    for child in node.children:
        if counts[child.name] > 1:
            message = f"another child of {node.name!r} is named {child.name!r} too"
            yield child.fault(message, "name")


def _policy_faults(node: NodeSpec, model: ParallelBody) -> Iterator[Fault]:
    names = [child.name for child in node.children]
    for policy, value in (("succeed", model.succeed), ("fail", model.fail)):
        if isinstance(value, int) and value > len(names):
            message = f"{policy}: expected at most {len(names)}, the number of children"
            yield node.fault(f"{message}; got {value}", policy)
    for name in model.succeed if isinstance(model.succeed, tuple) else ():
        if name not in names:
            message = f"succeed: no child is named {name!r}; {closest(name, names)}"
            yield node.fault(message, "succeed")
