"""Reads what a question changes: `--at 41 --set width=4 --force grasp=failure`."""

import dataclasses
from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any

from executive.core.errors import InputError
from executive.core.outcome import Status as Answer
from executive.core.registry import closest
from executive.engine.language.fitting import fit
from executive.engine.language.sources import read_source
from executive.inspector.past import PastRun
from executive.inspector.retick.standins import Setting, WhatIf


def what_if(run: PastRun, at: str, values: Sequence[str], forced: Sequence[str]) -> WhatIf:
    """Return a question to a run.

    Args:
        run: The run.
        at: The tick, as people name it.
        values: `KEY=VALUE` or `KEY.FIELD=VALUE`, values as YAML.
        forced: `NODE=STATUS`.

    Raises:
        InputError: There is no such tick, key or node, or the node was not asked in the tick.
    """
    tick = run.names.tick(at)
    if tick > run.index.last_tick:
        raise InputError(
            f"tick {tick}: nothing was asked in it; the last was {run.index.last_tick}"
        )
    answers = dict(_forced(run, tick, text) for text in forced)
    if not values:
        _require_asked(run, tick, [*answers])
    return WhatIf(tick, answers, tuple(_setting(run, text) for text in values))


def _forced(run: PastRun, tick: int, text: str) -> tuple[int, Answer]:
    name, equals, word = text.rpartition("=")
    if not equals or not name:
        raise InputError(f"--force {text}: expected NODE=STATUS; try --force {text}=failure")
    if word.upper() not in Answer.__members__:
        known = [answer.lower() for answer in Answer]
        raise InputError(f"--force {text}: unknown status {word!r}; {closest(word.lower(), known)}")
    return run.names.node(name, tick), Answer[word.upper()]


def _require_asked(run: PastRun, tick: int, nodes: Sequence[int]) -> None:
    for node in nodes:
        asked = run.index.answers[:, node].nonzero()[0]
        if tick in asked:
            continue
        later = asked[asked > tick]
        when = f"next in tick {later[0]}" if len(later) else "never after it"
        raise InputError(
            f"{run.names.short(node)} was not asked in tick {tick}, so there is no answer to "
            f"force; it was asked {when}"
        )


def _setting(run: PastRun, text: str) -> Setting:
    name, equals, raw = text.partition("=")
    if not equals or not name.strip():
        raise InputError(f"--set {text}: expected KEY=VALUE; try --set {text}=0.5")
    source = read_source(f"--set {name}", raw)
    if source.faults:
        raise InputError("\n".join(str(fault) for fault in source.faults))
    key, fields = _key(run, name.strip())
    return Setting(key, fields, source.data)


def _key(run: PastRun, name: str) -> tuple[str, tuple[str, ...]]:
    """Return the key that a name begins with, and the fields that follow."""
    first, *fields = name.split(".")
    while True:
        try:
            return run.names.key(first), tuple(fields)
        except InputError:
            if not fields or first in (key.rpartition(":")[2] for key in run.index.writes):
                raise
            first = f"{first}.{fields.pop(0)}"


def changed(value: object, setting: Setting, fields: Sequence[str]) -> object:
    """Return a value of the blackboard as a question wants it.

    Raises:
        InputError: It has no such field, or is of another type.
    """
    if not fields:
        return _fitted(value, setting)
    first, *rest = fields
    if isinstance(value, Mapping):
        return {**value, first: changed(value.get(first), setting, rest)}
    known = set(getattr(value, "__dataclass_fields__", ()))
    if first not in known:
        raise InputError(
            f"--set {setting}: no field {first!r} in {type(value).__name__}; "
            f"{closest(first, sorted(known))}"
        )
    inner = changed(getattr(value, first), setting, rest)
    whole: Any = value
    return dataclasses.replace(whole, **{first: inner})


def _fitted(value: object, setting: Setting) -> object:
    kind = type(value)
    if isinstance(value, tuple) and isinstance(setting.value, list):
        return tuple(setting.value)
    if not isinstance(value, bool | int | float | str | Enum) or setting.value is None:
        return setting.value
    if kind is int and isinstance(setting.value, float):
        return setting.value  # a key may hold either
    try:
        return fit(setting.value, kind)
    except ValueError as error:
        raise InputError(f"--set {setting}: {error}") from None
