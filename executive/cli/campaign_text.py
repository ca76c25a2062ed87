"""What campaigns come to, as text."""

import json
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar
from rich.text import Text

from executive.app.campaigns.comparing import Comparison, Difference
from executive.app.campaigns.figures import Figure, figures
from executive.app.campaigns.jobs import RunRecord
from executive.app.campaigns.table import TABLE

_FIRST = ("success", "sim_s", "ticks", "actions", "wall_s")
_SHOWN_FAILURES = 5


class Progress:
    """How far a campaign is, while it runs; what is no terminal gets a line a failure."""

    def __init__(self, console: Console, total: int, done: int) -> None:
        """Begin with those runs that are over already."""
        self._console, self._counts = console, Counter[str]()
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=console,
        )
        self._task: TaskID = self._bar.add_task("starting", total=total, completed=done)

    def __enter__(self) -> Self:
        """Show it."""
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave it as it is."""
        self._bar.stop()

    def tell(self, record: RunRecord) -> None:
        """Say that one more run is over."""
        self._counts[record.outcome] += 1
        words = ", ".join(f"{count} {name}" for name, count in self._counts.most_common())
        self._bar.update(self._task, advance=1, description=words)
        if record.outcome not in ("success", "failure", "timeout"):
            said = f"{record.name}: {record.outcome}: {record.reason}"
            self._console.print(Text(said, "yellow"), soft_wrap=True)


def summary_lines(records: Sequence[RunRecord], folder: Path) -> Iterator[Text]:
    """Yield what a campaign came to: a table of its variants, and what went wrong."""
    by_variant = _by_variant(records)
    for number, found in by_variant.items():
        settings = ", ".join(f"{k}={json.dumps(v)}" for k, v in found[0].settings.items())
        yield Text(f"v{number:03d}  {settings or 'as the mission has it'}", "bold")
        width = max(len(one.name) for one in figures(found))
        for one in figures(found):
            yield Text(f"  {one.name:<{width}}  {figure_text(one)}")
    counts = Counter(record.outcome for record in records)
    words = ", ".join(f"{count} {name}" for name, count in counts.most_common())
    yield Text(f"{len(records)} runs: {words or 'none has ended'}")
    yield from _failures(records, folder)
    yield Text(f"table: {folder / TABLE}")


def _by_variant(records: Sequence[RunRecord]) -> dict[int, list[RunRecord]]:
    found: dict[int, list[RunRecord]] = {}
    for record in sorted(records, key=lambda one: (one.variant, one.seed)):
        found.setdefault(record.variant, []).append(record)
    return found


def _failures(records: Sequence[RunRecord], folder: Path) -> Iterator[Text]:
    # In the order in which they were begun: they end in any.
    records = sorted(records, key=lambda one: (one.seed, one.variant))
    failed = [one for one in records if one.outcome != "success"]
    for one in failed[:_SHOWN_FAILURES]:
        where = f"  {folder / one.recording}" if one.recording else ""
        yield Text(f"  {one.name}: {one.outcome}: {one.reason}{where}", "bright_black")
    if len(failed) > _SHOWN_FAILURES:
        yield Text(f"  and {len(failed) - _SHOWN_FAILURES} more, in the table", "bright_black")


def figure_text(one: Figure) -> str:
    """Return a figure with its interval."""
    if one.share:
        low, high = 100 * one.low, 100 * one.high
        return f"{100 * one.value:5.1f} %  [{low:.1f} .. {high:.1f}]  n={one.n}"
    if not math.isfinite(one.low):
        return f"{one.value:7.4g}  n={one.n}"
    return f"{one.value:7.4g}  [{one.low:.4g} .. {one.high:.4g}]  n={one.n}"


def summary_document(records: Sequence[RunRecord]) -> dict[str, object]:
    """Return what a campaign came to, for JSON."""
    return {
        "runs": len(records),
        "outcomes": dict(Counter(record.outcome for record in records)),
        "variants": [
            {
                "variant": number,
                "settings": found[0].settings,
                "figures": [_finite(asdict(one)) for one in figures(found)],
            }
            for number, found in _by_variant(records).items()
        ],
    }


def _finite(document: dict[str, object]) -> dict[str, object]:
    """Write null where JSON has no word for a number."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in document.items()
    }


def comparison_lines(found: Comparison, a: str, b: str) -> Iterator[Text]:
    """Yield what differs beyond noise, then what does not."""
    how = "in pairs: same settings, same seed" if found.paired else "as two groups: none in common"
    yield Text(f"A {a}\nB {b}\n{found.pairs} runs each, compared {how}")
    if found.left_out:
        yield Text(f"{found.left_out} runs have no partner and are left out", "yellow")
    beyond = [one for one in found.differences if one.beyond_noise]
    within = [one for one in found.differences if not one.beyond_noise]
    yield Text("differs beyond noise:" if beyond else "nothing differs beyond noise", "bold")
    width = max((len(one.name) for one in found.differences), default=0)
    for one in beyond:
        yield Text(f"  {_difference(one, width)}", "bold")
    if within:
        yield Text("within noise:")
    for one in within:
        yield Text(f"  {_difference(one, width)}", "bright_black")


def _difference(one: Difference, width: int) -> str:
    change = f"{one.b - one.a:+.4g} [{one.low:+.4g} .. {one.high:+.4g}]"
    return f"{one.name:<{width}}  {one.a:.4g} -> {one.b:.4g}  {change}  p={one.p:.2g} n={one.n}"
