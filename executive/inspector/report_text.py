"""Mission reports as text and as Markdown."""

from collections import Counter
from collections.abc import Iterator, Sequence
from statistics import median

from executive.inspector.report import CONDITION, Line, MissionReport

_FAILURES = 8
Row = Sequence[str]


def report_text(report: MissionReport) -> str:
    """Return a report for a terminal: how it ended first, one screen."""
    parts = [*report.chain, "", *_facts(report)]
    for title, rows in _tables(report):
        parts += ["", *_columns([(title, *rows[0][1:]), *rows[1:]])]
    return "\n".join(parts)


def report_markdown(report: MissionReport) -> str:
    """Return a report as Markdown."""
    parts = [f"# {report.mission}, seed {report.seed}: {report.outcome}", ""]
    parts += ["```text", *report.chain, "```", ""]
    parts += [f"- {fact}" for fact in _facts(report)]
    for title, rows in _tables(report):
        parts += ["", *_markdown_table([(title, *rows[0][1:]), *rows[1:]])]
    return "\n".join(parts)


def summary_text(reports: Sequence[MissionReport]) -> str:
    """Return a summary over several runs for a terminal."""
    return "\n".join([*_summary(reports), "", *_columns(_runs(reports))])


def summary_markdown(reports: Sequence[MissionReport]) -> str:
    """Return a summary over several runs as Markdown."""
    first, *rest = _summary(reports)
    parts = [f"# {first}", "", *(f"- {line}" for line in rest)]
    return "\n".join([*parts, "", *_markdown_table(_runs(reports))])


def _facts(report: MissionReport) -> list[str]:
    here = "" if report.wall_s is None else f", {report.wall_s:.1f} s here"
    share = report.recovery.total_s / report.cycle_s if report.cycle_s > 0.0 else 0.0
    rate, again = report.rate, report.recovery
    lines = [
        f"cycle time   {report.cycle_s:.1f} s on the cell's clock{here}, {report.ticks} ticks",
        f"in recovery  {again.total_s:.1f} s ({share:.0%}): {again.retries_s:.1f} s after a failed "
        f"attempt, {again.fallbacks_s:.1f} s in fallbacks, overlap counted once",
    ]
    for retry in report.retries:
        allowed = "" if retry.allowed is None else f" of {retry.allowed} allowed"
        often = "" if retry.activations == 1 else f" at most, {retry.attempts} in all"
        lines.append(f"retries      {retry.name}: {retry.most} attempts{allowed}{often}")
    lines.append(
        f"tick rate    {rate.achieved_hz:.2f} Hz of {rate.wanted_hz:g} Hz, p99 of a tick "
        f"{rate.p99_s * 1e3:.0f} ms, {rate.slow} slow ticks (over {1e3 / rate.wanted_hz:.0f} ms)"
    )
    for slow in rate.slowest:
        asked = ", ".join(slow.asked) or "no skill"
        lines.append(f"slow tick    @{slow.tick} took {slow.duration_s * 1e3:.0f} ms in {asked}")
    lines += [f"injected     {line}" for line in report.injected]
    return [*lines, *_failed(report)]


def _failed(report: MissionReport) -> list[str]:
    failures = [failure for failure in report.failures if failure.code != CONDITION]
    lines = []
    for failure in failures[:_FAILURES]:
        said = f": {failure.text}" if failure.text else ""
        lines.append(f"failed       {failure.count} x {failure.name} {failure.code}{said}")
    if len(failures) > _FAILURES:
        lines.append(f"failed       in {len(failures) - _FAILURES} other ways")
    conditions = [failure for failure in report.failures if failure.code == CONDITION]
    if conditions:
        names = ", ".join(f"{failure.count} x {failure.name}" for failure in conditions)
        lines.append(f"false        {names}")
    return lines


def _tables(report: MissionReport) -> Iterator[tuple[str, list[Row]]]:
    head = ("", "started", "ok", "failed", "halted", "time s", "own s", "compute s", "where")
    groups = (
        ("station", report.stations),
        ("most time of its own", report.longest()),
        ("most computing", report.busiest()),
    )
    for title, lines in groups:
        if lines:
            yield title, [head, *(_cells(line) for line in lines)]


def _cells(line: Line) -> Row:
    times = line.times
    counts = (times.started, times.succeeded, times.failed, times.halted)
    spans_s = (times.running_s, times.own_s, times.compute_s)
    what = "" if line.what in (line.name, line.name.rpartition("/")[2]) else f" ({line.what})"
    name = f"{line.name}{what}"
    return (name, *map(str, counts), *(f"{span_s:.1f}" for span_s in spans_s), line.where)


def _summary(reports: Sequence[MissionReport]) -> list[str]:
    count = len(reports)
    outcomes = Counter(report.outcome for report in reports)
    cycles_s = [report.cycle_s for report in reports]
    ways = ", ".join(f"{number} {outcome}" for outcome, number in outcomes.most_common())
    lines = [
        f"{outcomes['success']} of {count} runs succeeded ({ways})",
        f"cycle time   median {median(cycles_s):.1f} s, "
        f"{min(cycles_s):.1f} to {max(cycles_s):.1f} s",
        f"in recovery  median {median(r.recovery.total_s for r in reports):.1f} s",
    ]
    failures: Counter[tuple[str, str]] = Counter()
    for failure in (failure for report in reports for failure in report.failures):
        if failure.code != CONDITION:
            failures[failure.name, failure.code] += failure.count
    for (name, code), number in failures.most_common(_FAILURES):
        lines.append(f"failed       {number} x {name} {code}")
    return lines


def _runs(reports: Sequence[MissionReport]) -> list[Row]:
    head = ("run", "seed", "outcome", "cycle s", "recovery s", "attempts", "p99 ms", "why")
    return [head, *(_run(report) for report in reports)]


def _run(report: MissionReport) -> Row:
    attempts = sum(retry.attempts for retry in report.retries)
    return (
        report.file,
        str(report.seed),
        report.outcome,
        f"{report.cycle_s:.1f}",
        f"{report.recovery.total_s:.1f}",
        str(attempts),
        f"{report.rate.p99_s * 1e3:.0f}",
        report.reason,
    )


def _columns(rows: Sequence[Row]) -> list[str]:
    """Return rows as columns: texts to the left, numbers to the right."""
    widths = [max(len(row[place]) for row in rows) for place in range(len(rows[0]))]
    numbers = [all(_is_number(row[place]) for row in rows[1:]) for place in range(len(widths))]
    return [
        "  ".join(
            cell.rjust(width) if number else cell.ljust(width)
            for cell, width, number in zip(row, widths, numbers, strict=True)
        ).rstrip()
        for row in rows
    ]


def _is_number(cell: str) -> bool:
    return cell.replace(".", "", 1).isdecimal()


def _markdown_table(rows: Sequence[Row]) -> list[str]:
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return [lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]
