"""One number for what a run decided, to tell whether two runs went the same way."""

import hashlib
import json

from executive.engine.recording.reader import Recording


def status_fingerprint(recording: Recording) -> str:
    """Return a hash of all that the ticks decided: equal for equal seeds on one machine.

    Times of the cell's clock, visits, statuses, halts, outcomes and the codes of reasons go
    in; wall-clock times and values do not.
    """
    digest = hashlib.sha256()
    for tick in recording.ticks():
        ends = [
            (end.node, end.status, end.reason.code if end.reason else "") for end in tick.outcomes
        ]
        halts = [(halt.node, halt.by) for halt in tick.halts]
        decided = (tick.number, round(tick.time_s, 6), tick.visited, tick.changes, halts, ends)
        digest.update(json.dumps(decided).encode())
    return digest.hexdigest()
