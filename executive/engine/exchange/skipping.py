"""Which nodes of a foreign tree may be SKIPPED."""

from executive.engine.exchange.dataflow import node_id, subtree_of
from executive.engine.exchange.foreign import ForeignTrees
from executive.engine.exchange.markup import Element
from executive.engine.exchange.vocabulary import FALLBACKS, LOOPS, SEQUENCES, SWITCHES

_ALL = SEQUENCES | FALLBACKS | {"Parallel", "ParallelAll"}
_NEVER = frozenset({"KeepRunningUntilFailure"})


def may_skip(element: Element, trees: ForeignTrees, above: tuple[str, ...] = ()) -> bool:
    """Return whether a node may answer SKIPPED."""
    if "_skipIf" in element.attributes or "_while" in element.attributes:
        return True
    name = node_id(element)
    if name == "RunOnce" and element.attributes.get("then_skip", "true").strip() != "false":
        return True
    if name in LOOPS:
        return element.attributes.get("if_empty", "").strip() == "SKIPPED"
    if name == "Precondition" and element.attributes.get("else", "").strip() == "SKIPPED":
        return True
    tree = subtree_of(element, trees)
    if tree is not None:
        known = tree in trees.trees and tree not in above
        return known and may_skip(trees.trees[tree].children[0], trees, (*above, tree))
    children = [may_skip(child, trees, above) for child in element.children]
    if not children or name in _NEVER:
        return False
    if name in _ALL:
        return all(children)
    if name in ("IfThenElse", "WhileDoElse"):
        return any(children[1:])
    return any(children) if name in SWITCHES else children[0]
