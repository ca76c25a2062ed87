"""Which node of an edited tree is which node of the recording."""

from collections import Counter
from collections.abc import Mapping, Sequence

from executive.engine.nodes.builder import NodeInfo
from executive.inspector.brief import brief
from executive.inspector.index import RunIndex
from executive.inspector.rebuilt import Rebuilt, WrittenNode

_SKILL = "skill"
_NOT_OWN = {"children", "child", "cases", "default", "name", "about"}


def matched(
    nodes: Sequence[NodeInfo], index: RunIndex, before: Rebuilt, now: Rebuilt
) -> tuple[int | None, ...]:
    """Return the index in the recording of each node, None where it has none.

    A node is the recorded one of its path. A leaf that is at another path, or has another name,
    is the recorded one that says the same, where there is one such leaf only on either side.
    """
    found = [_at_path(node, index) for node in nodes]
    taken = {old for old in found if old is not None}
    gone = {
        old: _identity(before.nodes.get(node.path))
        for old, node in enumerate(index.nodes)
        if old not in taken and not index.children[old]
    }
    new = {
        place: _identity(now.nodes.get(node.path))
        for place, node in enumerate(nodes)
        if found[place] is None and not node.behaviour.children
    }
    times_gone, times_new = Counter(gone.values()), Counter(new.values())
    places = {identity: old for old, identity in gone.items() if times_gone[identity] == 1}
    for place, identity in new.items():
        if identity and times_new[identity] == 1:
            found[place] = places.get(identity)
    return tuple(found)


def _at_path(node: NodeInfo, index: RunIndex) -> int | None:
    old = index.indices.get(node.path)
    if old is None or (index.nodes[old].kind == _SKILL) != (node.kind == _SKILL):
        return None
    return old


def _identity(node: WrittenNode | None) -> str:
    """Return all that a node says but its name; empty where that is not known."""
    return "" if node is None or node.is_guard else repr(own_words(node))


def own_words(node: WrittenNode) -> Mapping[str, str]:
    """Return what a file says about a node itself, by key."""
    model = node.spec.model
    if node.is_guard:
        endings = {
            f"{when}/{key}": text
            for when, texts in model.endings.items()
            for key, text in texts.items()
        }
        return {**model.guards, **endings}
    own = model.model_dump(mode="json", by_alias=True, exclude_unset=True, exclude=_NOT_OWN)
    guards = {*model.guards, *model.endings}
    words = {key: brief(value) for key, value in own.items() if key not in guards}
    return {"kind": model.kind, **words}
