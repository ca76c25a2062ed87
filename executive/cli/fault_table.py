"""What a fault campaign came to, as text."""

from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from executive.engine.faults.store import FaultRun, Verdict

STYLES: dict[Verdict, str] = {
    "survived": "green",
    "ended": "yellow",
    "wrong": "bold red",
    "not reached": "bright_black",
}
_HEAD = ("", "fault", "outcome", "time s", "answered by", "left running", "reason")


def shown_fault(fault: str, names: dict[str, str]) -> str:
    """Return a fault with the short name of its node, and the bare name of its key."""
    target, _, what = fault.rpartition(": ")
    if target.startswith("key "):
        return f"key {target.rpartition(':')[2]}: {what}"
    return f"{names.get(target, target)}: {what}"


def table(runs: Sequence[FaultRun], names: dict[str, str]) -> list[Text]:
    """Return the table of a campaign, one line a run.

    Args:
        runs: Its runs.
        names: Short names of nodes by path.
    """
    rows = [_row(run, names) for run in runs]
    widths = [max(len(row[place]) for row in (_HEAD, *rows)) for place in range(len(_HEAD))]
    lines = [Text(_line(_HEAD, widths), "bright_black")]
    for run, row in zip(runs, rows, strict=True):
        text = Text(_line(row, widths))
        text.stylize(STYLES[run.verdict], 0, len(run.verdict))
        lines.append(text)
    return lines


def summary(runs: Sequence[FaultRun]) -> str:
    """Return how many runs went how, in one line."""
    counts = Counter(run.verdict for run in runs)
    tried = len(runs) - counts["not reached"]
    words = [
        f"{counts['survived']} survived ({survived_percent(runs):.0f} %)",
        f"{counts['ended']} ended with a reason",
        f"{counts['wrong']} ended wrongly",
    ]
    left = f"; {counts['not reached']} not reached" if counts["not reached"] else ""
    return f"{tried} faults: {', '.join(words)}{left}"


def survived_percent(runs: Sequence[FaultRun]) -> float:
    """Return the share of the faults that happened which the mission survived [%]."""
    tried = [run for run in runs if run.verdict != "not reached"]
    survived = sum(run.verdict == "survived" for run in tried)
    return 100.0 * survived / len(tried) if tried else 100.0


def print_progress(
    console: Console, run: FaultRun, place: int, count: int, names: dict[str, str]
) -> None:
    """Say that one more run is over."""
    width = len(str(count))
    console.print(
        Text.assemble(
            (f"[{place:{width}d}/{count}] ", "bright_black"),
            (f"{run.verdict:<11} ", STYLES[run.verdict]),
            f"{shown_fault(run.fault, names)}  ",
            (f"{run.outcome}, {run.wall_s:.1f} s here", "bright_black"),
        ),
        soft_wrap=True,
    )


def _row(run: FaultRun, names: dict[str, str]) -> tuple[str, ...]:
    by = f"{run.answered_by} ({run.answer})" if run.answered_by else "-"
    reason = run.wrong or run.reason
    for path, name in names.items():
        reason = reason.replace(f"{path}:", f"{name}:").replace(f"{path} ", f"{name} ")
    return (
        run.verdict,
        shown_fault(run.fault, names),
        run.outcome,
        f"{run.sim_s:.1f}",
        "" if run.verdict == "not reached" else by,
        ", ".join(names.get(path, path) for path in run.left_running) or "-",
        reason,
    )


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
    cells[3] = row[3].rjust(widths[3])
    return "  ".join(cells).rstrip()
