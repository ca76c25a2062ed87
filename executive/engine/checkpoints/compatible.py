"""Whether a mission is still the one that was recorded."""

import difflib
from collections.abc import Iterator, Mapping, Sequence

from executive.core.errors import InputError
from executive.engine.loading.loader import Mission
from executive.engine.recording.messages import MissionHeader, RecordedNode

_LINES_SHOWN = 4
_OURS = "cellwright"


def require_same_sources(header: MissionHeader, mission: Mission, *, anyway: bool) -> None:
    """Refuse a mission whose files are not as they were.

    Args:
        header: Of the recording.
        mission: As it is now.
        anyway: Whether that is accepted as long as the nodes are the same.

    Raises:
        InputError: They are not; says which lines.
    """
    changes = [*_source_changes(header, mission)]
    if changes and not anyway:
        raise InputError(
            "the mission is not the one that was recorded:\n"
            + "\n".join(f"  {change}" for change in changes)
            + "\ntry the files as they were, or --anyway when no node was added, removed or moved"
        )


def require_same_nodes(recorded: Sequence[RecordedNode], now: Sequence[RecordedNode]) -> None:
    """Refuse a tree with other nodes: what was recorded of a node must find it.

    Raises:
        InputError: A node is another one.
    """
    before, after = [[_identity(node) for node in nodes] for nodes in (recorded, now)]
    if before == after:
        return
    gone = [path for path, *_ in before if path not in {path for path, *_ in after}]
    new = [path for path, *_ in after if path not in {path for path, *_ in before}]
    told = [f"{path} is gone" for path in gone] + [f"{path} is new" for path in new]
    told = told or [
        f"{old[0]}: was {old[2]}, is {there[2]}"
        for old, there in zip(before, after, strict=True)
        if old != there
    ]
    raise InputError(
        f"the tree has other nodes than the recorded one: {'; '.join(told[:_LINES_SHOWN])}; "
        "what was recorded of them cannot be given back; start the mission anew"
    )


def changed_versions(recorded: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    """Yield every package whose version is another one: from here on a run may go another way.

    Raises:
        InputError: It is this package itself, which may write other checkpoints.
    """
    for name in sorted(recorded.keys() | now.keys()):
        was, is_now = recorded.get(name, "none"), now.get(name, "none")
        if was == is_now:
            continue
        if name == _OURS:
            raise InputError(
                f"recorded by {_OURS} {was}, this is {is_now}; checkpoints of another version "
                f"are not taken up; try {_OURS} {was}"
            )
        yield f"{name} {was} is now {is_now}"


def _identity(node: RecordedNode) -> tuple[str, str, str]:
    return node.path, node.kind, node.type


def _source_changes(header: MissionHeader, mission: Mission) -> Iterator[str]:
    now = {source.file: source for source in mission.sources}
    before = {source.file: source for source in header.sources}
    yield from (f"{file}: is no longer used" for file in sorted(before.keys() - now.keys()))
    yield from (f"{file}: was not used" for file in sorted(now.keys() - before.keys()))
    for file in sorted(before.keys() & now.keys()):
        if before[file].sha256 != now[file].sha256:
            yield from _line_changes(file, before[file].text, now[file].text)


def _line_changes(file: str, before: str, now: str) -> Iterator[str]:
    old, new = before.splitlines(), now.splitlines()
    matcher = difflib.SequenceMatcher(a=old, b=new, autojunk=False)
    changes = [each for each in matcher.get_opcodes() if each[0] != "equal"]
    for _, i, i_end, j, j_end in changes[:_LINES_SHOWN]:
        was = " ".join(line.strip() for line in old[i:i_end]) or "nothing"
        is_now = " ".join(line.strip() for line in new[j:j_end]) or "nothing"
        yield f"{file}:{j + 1}: was {was[:80]!r}, is {is_now[:80]!r}"
    if len(changes) > _LINES_SHOWN:
        yield f"{file}: and {len(changes) - _LINES_SHOWN} other changes"
    if not changes:
        yield f"{file}: line ends or the like have changed"
