"""Which keys a node has surely written when it succeeds, and when it fails.

Of an answer that cannot come nothing is known and everything holds, written `None`.
"""

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from executive.engine.language.block_models import ObserveBody, ParallelBody
from executive.engine.language.node_models import SubtreeNode
from executive.engine.language.outline import NodeSpec

if TYPE_CHECKING:
    from executive.engine.lint.subject import Subject

Keys = frozenset[str] | None
Ends = tuple[Keys, Keys]
"""Keys after a success, and after a failure."""

_NONE: Final[Keys] = frozenset()


def _both(parts: Iterable[Keys]) -> Keys:
    """Return the keys that are written when all parts happen."""
    keys: set[str] = set()
    for part in parts:
        if part is None:
            return None
        keys |= part
    return frozenset(keys)


def _either(parts: Iterable[Keys]) -> Keys:
    """Return the keys that are written whichever of the parts happens."""
    possible = [part for part in parts if part is not None]
    return frozenset.intersection(*possible) if possible else None


def _in_turn(ends: list[Ends]) -> Ends:
    """Return what holds when all have succeeded, and when one of them failed."""
    failed = [
        _both([*(success for success, _ in ends[:i]), failure])
        for i, (_, failure) in enumerate(ends)
    ]
    return _both(success for success, _ in ends), _either(failed)


def _sequence(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return _in_turn(ends)


def _selector(_node: NodeSpec, ends: list[Ends]) -> Ends:
    failure, success = _in_turn([(failure, success) for success, failure in ends])
    return success, failure


def _parallel(node: NodeSpec, ends: list[Ends]) -> Ends:
    model = node.model
    succeed = model.succeed if isinstance(model, ParallelBody) else "all"
    if succeed == "all":
        return _both(success for success, _ in ends), _NONE
    if isinstance(succeed, tuple):
        named = zip(node.children, ends, strict=True)
        return _both(end[0] for child, end in named if child.name in succeed), _NONE
    return _either(success for success, _ in ends), _NONE


def _if_then_else(_node: NodeSpec, ends: list[Ends]) -> Ends:
    condition, then = ends[:2]
    success = _both([condition[0], then[0]])
    if len(ends) == 2:
        return success, _either([_both([condition[0], then[1]]), condition[1]])
    otherwise = ends[2]
    return (
        _either([success, _both([condition[1], otherwise[0]])]),
        _either([_both([condition[0], then[1]]), _both([condition[1], otherwise[1]])]),
    )


def _one_of(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return _either(success for success, _ in ends), _NONE


def _early_success(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return _either([ends[0][0], _NONE]), ends[0][1]


def _same(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return ends[0]


def _may_fail_early(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return ends[0][0], _NONE


def _may_skip(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return _NONE, ends[0][1]


def _inverted(_node: NodeSpec, ends: list[Ends]) -> Ends:
    success, failure = ends[0]
    return failure, success


def _forced_success(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return _either(ends[0]), None


def _forced_failure(_node: NodeSpec, ends: list[Ends]) -> Ends:
    return None, _either(ends[0])


COMBINED: Final[Mapping[str, Callable[[NodeSpec, list[Ends]], Ends]]] = MappingProxyType(
    {
        "sequence": _sequence,
        "reactive_sequence": _sequence,
        "selector": _selector,
        "reactive_selector": _selector,
        "parallel": _parallel,
        "if_then_else": _if_then_else,
        "while_do_else": _if_then_else,
        "switch": _one_of,
        "reactive_switch": _one_of,
        "retry": _same,
        "repeat": _same,
        "timeout": _may_fail_early,
        "cooldown": _may_fail_early,
        "for_each": _may_skip,
        "run_once": _same,
        "inverter": _inverted,
        "force_success": _forced_success,
        "force_failure": _forced_failure,
        "running_is_success": _early_success,
        "running_is_failure": _may_fail_early,
        "observe": _same,
    }
)
"""Every kind with children; a test holds it against the language."""


class Certain:
    """Answers for the nodes of one tree."""

    def __init__(self, subject: "Subject") -> None:
        """Ask about a tree."""
        self._subject = subject
        self._known: dict[NodeSpec, Ends] = {}

    def on_success(self, node: NodeSpec, key: str) -> bool:
        """Return whether a key has surely been written when a node succeeds."""
        success, _ = self._ends(node)
        return success is None or key in success

    def gap(self, node: NodeSpec, key: str) -> NodeSpec:
        """Return the innermost node that can succeed without the key having been written."""
        for child in node.children:
            if len(node.children) > 1 and COMBINED.get(node.model.kind) is _sequence:
                break  # none of its children has to write it, all together have
            if not self.on_success(child, key):
                return self.gap(child, key)
        return node

    def _ends(self, node: NodeSpec) -> Ends:
        if node not in self._known:
            self._known[node] = self._guarded(node, self._bare(node))
        return self._known[node]

    def _bare(self, node: NodeSpec) -> Ends:
        may = self._subject.outcomes.may(node)
        if node.children:
            unknown: Ends = (_NONE, _NONE)
            combine = COMBINED.get(node.model.kind)
            ends = [self._ends(child) for child in node.children]
            success, failure = combine(node, ends) if combine else unknown
            if isinstance(node.model, ObserveBody):
                own = frozenset(gives.key for gives in self._subject.wirings[node].ends)
                return _both([success, own]), _both([failure, own])
            return success, failure
        given = frozenset(gives.key for gives in self._subject.wirings[node].gives)
        if isinstance(node.model, SubtreeNode):
            given = self._given(node.model)
        return given if may.succeed else None, _NONE if may.fail else None

    def _given(self, model: SubtreeNode) -> frozenset[str]:
        """Return the outer keys of those outputs that the inner tree surely writes."""
        inner = self._subject.inner(model.subtree)
        if inner is None:
            return frozenset()
        certain = inner.certain
        root = inner.tree.root
        pairs = model.out.items()
        return frozenset(
            key.removeprefix("$") for port, key in pairs if certain.on_success(root, port)
        )

    def _guarded(self, node: NodeSpec, ends: Ends) -> Ends:
        success, failure = ends
        model = node.model
        if model.unless is not None:
            success = _either([success, _NONE])
        if model.if_ is not None or model.while_ is not None:
            failure = _either([failure, _NONE])
        always = frozenset((model.on_start or {}) | (model.finally_ or {}))
        return (
            _both([success, always, frozenset(model.on_success or ())]),
            _both([failure, always, frozenset(model.on_failure or ())]),
        )
