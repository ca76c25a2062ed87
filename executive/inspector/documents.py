"""What a recording says, as JSON for other programs."""

from executive.engine.recording.reader import Recording
from executive.inspector.changes import Change


def tick_document(recording: Recording, number: int, nodes: frozenset[int]) -> dict[str, object]:
    """Return the state after a tick: nodes with status and reason, and the blackboard."""
    tick, statuses = recording.tick(number), recording.statuses(number)
    reasons, table = recording.reasons(number), recording.header.nodes
    shown = [
        {
            "path": table[node].path,
            "kind": table[node].kind,
            "type": table[node].type,
            "file": table[node].file,
            "line": table[node].line,
            "status": statuses[node].value,
            "visited": node in tick.visited,
            "reason": str(reasons[node]) if node in reasons else None,
        }
        for node in sorted(nodes)
    ]
    return {
        "mission": recording.header.mission,
        "seed": recording.header.seed,
        "outcome": None if recording.result is None else recording.result.report.outcome,
        "complete": recording.complete,
        "ticks": len(recording),
        "tick": number,
        "time_s": tick.time_s,
        "nodes": shown,
        "faults": [f"{fault.path}: {fault.message}" for fault in tick.faults],
        "blackboard": {
            key: {"value": state.value, "writer": state.writer, "tick": state.tick}
            for key, state in recording.blackboard(number).items()
        },
    }


def change_document(change: Change) -> dict[str, object]:
    """Return one change of status."""
    return {
        "tick": change.tick,
        "time_s": change.time_s,
        "path": change.path,
        "old": change.old.value,
        "new": change.new.value,
        "reason": change.reason or None,
    }
