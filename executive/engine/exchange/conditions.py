"""Pre- and postconditions of BehaviorTree.CPP around a node, as guards and endings of ours.

There, a node that starts asks `_failureIf`, `_successIf`, `_skipIf` and `_while` in this order,
and `_while` again in every tick. A node that is skipped answers SKIPPED, which its parent passes
over: a Sequence as if it had succeeded, a Fallback as if it had failed. Here it answers that.
"""

from collections.abc import Mapping
from typing import Final

from executive.core.errors import InputError
from executive.engine.exchange.draft import (
    Draft,
    Skip,
    all_of,
    any_of,
    block,
    leaf,
    none_of,
)
from executive.engine.exchange.markup import Element
from executive.engine.exchange.scripts import Statement, Vocabulary, read_condition, read_script
from executive.engine.exchange.vocabulary import CONDITIONS

_ENDS: Final[Mapping[str, str]] = {
    "_onSuccess": "on_success",
    "_onFailure": "on_failure",
    "_onHalted": "on_halt",
}
NO_SKIPPING: Final = (
    "may be SKIPPED, which our nodes cannot answer; here its parent makes neither a success nor "
    "a failure of it, try it in a Sequence or a Fallback of its own"
)


def assignments(statements: list[Statement]) -> list[dict[str, str]]:
    """Return the assignments of a script, in as few mappings as keep their order."""
    found: list[dict[str, str]] = []
    for statement in statements:
        if not statement.key:
            continue
        if not found or statement.key in found[-1]:
            found.append({})
        found[-1][statement.key] = statement.text
    return found


def with_conditions(draft: Draft, element: Element, words: Vocabulary, skip: Skip | None) -> Draft:
    """Return a node with the conditions and endings that its element has.

    Args:
        draft: The node.
        element: Its element.
        words: What the names in scripts stand for.
        skip: What its parent makes of SKIPPED.

    Raises:
        InputError: A script cannot be said, or SKIPPED means neither success nor failure.
    """
    asked = {
        keyword: read_condition(element.attributes[keyword], words).text
        for keyword in CONDITIONS
        if keyword in element.attributes
    }
    endings = _endings(element, words)
    if skip is None and ("_skipIf" in asked or "_while" in asked):
        raise InputError(NO_SKIPPING)
    draft = _guardable(draft)
    draft.body.update(endings)
    answers = bool(endings.keys() - {"on_halt"})
    if "_while" in asked and (answers or skip == "success"):
        return _while_around(draft, asked, skip)
    if "_skipIf" in asked and answers:
        return _skip_around(draft, asked, skip)
    _guard(draft, asked, skip)
    return draft


def _guardable(draft: Draft) -> Draft:
    """Put a node that has guards of its own already into a sequence that takes more."""
    taken = {"if", "unless", "while", "on_success", "on_failure", "on_halt", "finally"}
    return block("sequence", draft) if taken & draft.body.keys() else draft


def _endings(element: Element, words: Vocabulary) -> dict[str, object]:
    found: dict[str, object] = {}
    for keyword, ours in (*_ENDS.items(), ("_post", "")):
        if keyword not in element.attributes:
            continue
        sets = assignments(read_script(element.attributes[keyword], words))
        if len(sets) > 1:
            raise InputError(f"{keyword} sets a key twice; try one expression for it")
        for each in sets:
            for end in (ours,) if ours else ("on_success", "on_failure"):
                texts = found.setdefault(end, {})
                assert isinstance(texts, dict)
                if texts.keys() & each.keys():
                    raise InputError(f"{keyword} sets a key that {end} sets already")
                texts.update(each)
    return found


def _guard(draft: Draft, asked: Mapping[str, str], skip: Skip | None) -> None:
    """Write the conditions as guards of the node itself."""
    fails, succeeds = asked.get("_failureIf"), asked.get("_successIf")
    skips = asked.get("_skipIf")
    starts = [none_of(fails)] if fails else []
    unless = [succeeds] if succeeds else []
    if skips and skip == "success":
        unless.append(skips)
    elif skips:
        starts.append(any_of([succeeds, none_of(skips)]) if succeeds else none_of(skips))
    if starts:
        draft.body["if"] = all_of(starts)
    if unless:
        draft.body["unless"] = any_of(unless)
    if "_while" in asked:
        draft.body["while"] = asked["_while"]


def _skip_around(draft: Draft, asked: Mapping[str, str], skip: Skip | None) -> Draft:
    """Ask `_skipIf` outside of the node, whose endings a skipped node does not reach."""
    rest = {keyword: text for keyword, text in asked.items() if keyword != "_skipIf"}
    _guard(draft, rest, skip)
    earlier = [text for keyword, text in rest.items() if keyword != "_while"]
    skips = asked["_skipIf"]
    if skip == "success":
        asks = all_of([skips, *(none_of(text) for text in earlier)])
        return block("selector", leaf("when", asks), draft)
    asks = any_of([none_of(skips), *earlier])
    return block("sequence", leaf("when", asks), draft)


def _while_around(draft: Draft, asked: Mapping[str, str], skip: Skip | None) -> Draft:
    """Ask `_while` outside of the node: when it no longer holds, the node is passed over."""
    rest = {keyword: text for keyword, text in asked.items() if keyword != "_while"}
    if "_failureIf" in rest or "_successIf" in rest:
        raise InputError(
            "_while together with _failureIf or _successIf, which is asked before it; try the "
            "latter on a Sequence around the node"
        )
    if "_skipIf" in rest and draft.body.keys() & {"on_success", "on_failure"}:
        draft = _skip_around(draft, rest, skip)
    else:
        _guard(draft, rest, skip)
    holds = asked["_while"]
    if skip == "success":
        return block("reactive_selector", leaf("when", none_of(holds)), draft)
    return block("reactive_sequence", leaf("when", holds), draft)
