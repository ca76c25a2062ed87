"""`cellwright report`: what one run came to, or several."""

import dataclasses
import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from executive.cli.recordings import RunsArgument
from executive.core.errors import InputError
from executive.inspector.junit import junit
from executive.inspector.past import PastRun
from executive.inspector.report import MissionReport, mission_report
from executive.inspector.report_text import (
    report_markdown,
    report_text,
    summary_markdown,
    summary_text,
)


class Format(StrEnum):
    """Forms of a report."""

    TEXT = "text"
    MARKDOWN = "md"
    JSON = "json"
    JUNIT = "junit"


def report(
    recordings: RunsArgument,
    form: Annotated[Format, typer.Option("--format", help="Form of the report.")] = Format.TEXT,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Write it to a file.")
    ] = None,
) -> None:
    """Report how runs ended and why, how long they took where, and what they had to retry."""
    reports = [mission_report(PastRun.open(path)) for path in recordings]
    text = _written(reports, form)
    if output is None:
        typer.echo(text)
        return
    try:
        output.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{output}: cannot be written: {error.strerror}") from None


def _written(reports: list[MissionReport], form: Format) -> str:
    if form is Format.JUNIT:
        return junit(reports)
    if form is Format.JSON:
        documents = [dataclasses.asdict(report) for report in reports]
        return json.dumps(documents[0] if len(documents) == 1 else documents)
    if len(reports) == 1:
        return report_text(reports[0]) if form is Format.TEXT else report_markdown(reports[0])
    return summary_text(reports) if form is Format.TEXT else summary_markdown(reports)
