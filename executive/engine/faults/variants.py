"""Every single fault that a mission may be tried with, from what a run without any has done."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.engine.faults.grammar import Kind

CAMPAIGN_KINDS = (Kind.FAIL, Kind.HANG, Kind.RAISE, Kind.STALE, Kind.DROP)
"""Kinds that need nothing but their name."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What a run without faults has done.

    Attributes:
        skills: How often each node that runs a skill has started, by path.
        keys: How often each key has been written, by its full name.
    """

    skills: Mapping[str, int]
    keys: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Variant:
    """One fault to try.

    Attributes:
        fault: As `--inject` takes it.
        kind: What it does.
        target: Path of the node, or full name of the key.
        reached: Whether the run without faults comes to where it happens; if not, a run with it
            would be the same run again.
    """

    fault: str
    kind: Kind
    target: str
    reached: bool


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which faults a campaign is to try.

    Attributes:
        kinds: What is to go wrong.
        at: Activation or write, counted from 1; a key is stale in the second at the earliest.
        only: Globs of names of nodes and keys with `|` between; empty for all.
    """

    kinds: tuple[Kind, ...]
    at: int = 1
    only: str = ""


def variants(seen: Seen, wanted: Wanted) -> list[Variant]:
    """Return the faults of a campaign: nodes in the order of the tree, then keys.

    Args:
        seen: The run without faults.
        wanted: Which ones.

    Raises:
        InputError: `only` means nothing.
    """
    only = wanted.only
    found = [
        one
        for one in _all(seen, wanted.kinds, wanted.at)
        if not only or _is_meant(one.target, only)
    ]
    if not found:
        names = sorted({_name(target) for target in (*seen.skills, *seen.keys)})
        raise InputError(f"--only {only!r} leaves nothing; {closest(only, names)}")
    return found


def _all(seen: Seen, kinds: Sequence[Kind], at: int) -> Iterator[Variant]:
    for path, starts in seen.skills.items():
        for kind in kinds:
            if kind in (Kind.FAIL, Kind.HANG, Kind.RAISE):
                yield Variant(f"{path}: {kind}@{at}", kind, path, starts >= at)
    for key, writes in seen.keys.items():
        for kind in kinds:
            if kind in (Kind.STALE, Kind.DROP):
                number = max(at, 2) if kind is Kind.STALE else at
                yield Variant(f"key {key}: {kind}@{number}", kind, key, writes >= number)


def _is_meant(target: str, only: str) -> bool:
    return any(
        fnmatchcase(target, glob) or fnmatchcase(target, f"*[/:]{glob}")
        for glob in re.split(r"\s*\|\s*", only.strip())
    )


def _name(target: str) -> str:
    return re.split("[/:]", target)[-1]


def parse_kinds(text: str) -> tuple[Kind, ...]:
    """Read kinds with commas between.

    Raises:
        InputError: One is none that a campaign can try.
    """
    known = [kind.value for kind in CAMPAIGN_KINDS]
    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in known:
            raise InputError(f"--kinds: {name!r} is none; {closest(name, known)}")
    if not names:
        raise InputError(f"--kinds: got nothing; expected some of {', '.join(known)}")
    return tuple(Kind(name) for name in dict.fromkeys(names))
