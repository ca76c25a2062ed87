"""Trees put together at random, of every kind of node, and what can be done to spoil them."""

import copy
import json
from typing import Any

from hypothesis import strategies as st

from executive.engine.language.block_models import KINDS

Node = dict[str, Any]

PORTS = {
    "n": {"type": "int", "default": 2},
    "word": {"type": "'a' | 'b'", "default": "a"},
    "parts": {"type": "list[float]", "default": [1, 2], "unit": "m"},
}
INNER = """format: 1
tree: inner
in: {n: {type: int}}
out: {m: {type: int}}
keep: {tries: 0}
root:
  sequence:
    - {set: {tries: tries + 1}}
    - {set: {m: n + tries}}
"""
"""A subtree that the random trees use, in the file `inner.yaml` beside them."""

_LEAVES: list[Node] = [
    {"when": "1 < 2"},
    {"when": "n > 1 and word in ['a', 'b']"},
    {"set": {"k": "n + 1", "j": "k * 2"}},
    {"skill": "find"},
    {"skill": "work", "in": {"label": "a"}},
    {"skill": "work", "in": {"label": "b", "ticks": 2, "fails": 1}},
    {"skill": "work", "in": {"label": "c", "ticks": "$n + 1"}},
    {"subtree": "inner", "in": {"n": "$n"}, "out": {"m": "$m"}},
    {"subtree": "inner", "in": {"n": 3}},
    {"wait": 0.15},
    {"wait": "$n / 10"},
    {"wait": "forever"},
    {"wait_for": "n > 0"},
    {"fail": "part.missing", "text": "no part"},
    {"chance": 0.5},
    {"chance": "$n / 4"},
    {"sequence": [{"set": {"u": 1}}, {"unset": "u"}, {"when": "not written(u)"}]},
]
_EXTRAS: list[Node] = [
    {},
    {},
    {"if": "n < 3"},
    {"unless": "n > 5"},
    {"while": "n > 0"},
    {"on_start": {"busy": True}, "finally": {"busy": False}},
    {"on_success": {"last": "n"}, "on_failure": {"last": -1}, "on_halt": {"last": 0}},
    {"about": "Something: with a # and 'quotes'"},
]
_BLOCKS: list[tuple[str, Node]] = [
    ("sequence", {}),
    ("reactive_sequence", {}),
    ("selector", {}),
    ("reactive_selector", {}),
    ("parallel", {}),
    ("parallel", {"succeed": "any", "on_done": "wait"}),
    ("parallel", {"succeed": 1, "fail": 1}),
]
_DECORATORS: list[tuple[str, Node]] = [
    ("retry", {"times": 2, "delay_s": 0.1, "backoff": 2.0}),
    ("retry", {"times": "forever"}),
    ("repeat", {"times": "$n", "delay_s": "$n / 20"}),
    ("timeout", {"seconds": "$n / 5"}),
    ("cooldown", {"seconds": 0.3}),
    ("for_each", {"item": "$i", "in": [1, None]}),
    ("for_each", {"item": "$p", "in": "$parts"}),
    ("run_once", {}),
    ("run_once", {"until": "success"}),
    ("observe", {"status": "$status", "counts": "$counts"}),
    *((kind, {}) for kind in ("inverter", "force_success", "force_failure")),
    *((kind, {}) for kind in ("running_is_success", "running_is_failure")),
]

Strategy = st.SearchStrategy[Node]


def _under(kind: str, own: Node, extra: Node, **below: object) -> Node:
    return {kind: {**own, **extra, **below}}


def _inner_nodes(node: Strategy) -> Strategy:
    extra = st.sampled_from(_EXTRAS)
    some = st.lists(node, min_size=1, max_size=3)
    branches = st.lists(node, min_size=2, max_size=3)
    choices = st.sampled_from(["if_then_else", "while_do_else"])
    switches = st.sampled_from(["switch", "reactive_switch"])
    return st.one_of(
        st.builds(
            lambda of, e, c: _under(of[0], of[1], e, children=c),
            st.sampled_from(_BLOCKS),
            extra,
            some,
        ),
        st.builds(
            lambda of, e, c: _under(of[0], of[1], e, child=c),
            *(st.sampled_from(_DECORATORS), extra, node),
        ),
        st.builds(lambda kind, e, c: _under(kind, {}, e, children=c), choices, extra, branches),
        st.builds(
            lambda kind, e, a, b: _under(kind, {"on": "word"}, e, cases={"a": a}, default=b),
            *(switches, extra, node, node),
        ),
        st.builds(
            lambda kind, a, b: _under(kind, {"on": "n"}, {}, cases={"2": a, "3": b}),
            *(switches, node, node),
        ),
    )


def _leaf(leaf: Node, extra: Node) -> Node:
    return leaf if "sequence" in leaf else {**leaf, **extra}


ROOTS: Strategy = st.recursive(
    st.builds(_leaf, st.sampled_from(_LEAVES), st.sampled_from(_EXTRAS)),
    _inner_nodes,
    max_leaves=8,
)
"""Roots of valid trees."""

WORDS = st.sampled_from(
    [
        *(*KINDS, "name", "in", "out", "child", "children", "cases", "default", "on", "keep"),
        *("times", "seconds", "item", "if", "while", "unless", "on_success", "finally", "part"),
        *("label", "find", "weigh", "work", "inner", "root", "format", "tree", "type", "float"),
        *("x > 1", "written(p)", "$p.mass_kg", "$n +", "succeed", "all", "3", "$n", "$", "$$", "p"),
    ]
)
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 3) | st.floats(allow_nan=False) | WORDS,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, min_size=1, max_size=3)
    ),
    max_leaves=8,
)
"""Values that make no sense, in words that the language knows."""

MUTATIONS = ("value", "missing", "extra", "renamed", "moved", "truncated", "text", "garbage")


def document(root: Node) -> Node:
    """Return a tree with a root."""
    return {"format": 1, "tree": "t", "in": PORTS, "root": root}


@st.composite
def spoiled(draw: st.DrawFn) -> str:
    """Return the text of a valid tree after something was done to it."""
    whole = document(draw(ROOTS))
    how = draw(st.sampled_from(MUTATIONS))
    if how == "garbage":
        return draw(st.text(max_size=60))
    if how in ("truncated", "text"):
        text = json.dumps(whole)
        at = draw(st.integers(0, len(text) - 1))
        return text[:at] + (draw(st.text(max_size=3)) + text[at + 1 :] if how == "text" else "")
    return json.dumps(_changed(draw, copy.deepcopy(whole), how))


def _changed(draw: st.DrawFn, whole: Node, how: str) -> Node:
    """Change one place of a document."""
    places = list(_mappings(whole))
    target = draw(st.sampled_from(places))
    key = draw(st.sampled_from(sorted(target)))
    if how == "value":
        target[key] = draw(ANYTHING)
    elif how == "extra":
        target[draw(WORDS)] = draw(ANYTHING)
    elif how == "missing":
        del target[key]
    elif how == "renamed":
        target[draw(WORDS)] = target.pop(key)
    else:
        draw(st.sampled_from(places))[draw(WORDS)] = target.pop(key)
    return json.loads(json.dumps(whole, default=str)) if _is_finite(whole) else {"root": None}


def _mappings(value: object) -> Any:
    """Yield every mapping of a document that holds something."""
    if isinstance(value, dict):
        if value:
            yield value
        for item in value.values():
            yield from _mappings(item)
    elif isinstance(value, list):
        for item in value:
            yield from _mappings(item)


def _is_finite(value: object, depth: int = 0) -> bool:
    """Return whether a document does not contain itself, as one may after a move."""
    if depth > 100:
        return False
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return all(_is_finite(item, depth + 1) for item in items)
