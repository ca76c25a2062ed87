"""`cellwright lint`: what is legal in a tree but surely wrong."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from executive.app.catalogue import port_types, skills
from executive.cli.files import TREES, yaml_files
from executive.engine.lint.linter import LintReport, lint_files
from executive.engine.lint.rules import RULES, WAIVER_ABOUT, WAIVER_CODE, WAIVER_RULE


def lint(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="YAML files, folders of them, or names.  [default: trees]"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document on stdout.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Let no waiver count: show what they allow, too.")
    ] = False,
    halts: Annotated[
        bool, typer.Option("--halts", help="Say who can halt each leaf, instead of findings.")
    ] = False,
    rules: Annotated[bool, typer.Option("--rules", help="List the rules and exit.")] = False,
) -> None:
    """Find what is legal but surely wrong; exit 1 with findings, 2 when a file has faults."""
    if rules:
        typer.echo(_rules())
        return
    report = lint_files(yaml_files(files or TREES), skills=skills(), types=port_types())
    if halts:
        typer.echo(_halts(report, as_json=as_json))
        raise typer.Exit(2 if report.faults else 0)
    findings = sorted([*report.findings, *(one for one, _ in report.waived if strict)])
    if as_json:
        typer.echo(_as_json(report, strict=strict))
    else:
        for line in [*report.faults, *findings]:
            typer.echo(str(line))
        typer.echo(_summary(report, len(findings), strict=strict), err=bool(findings))
    if report.faults or findings:
        raise typer.Exit(2 if report.faults else 1)


def _halts(report: LintReport, *, as_json: bool) -> str:
    if as_json:
        trees = {name: [asdict(one) for one in leaves] for name, leaves in report.halts().items()}
        return json.dumps(trees, indent=2)
    lines = [str(fault) for fault in report.faults]
    for leaves in report.halts().values():
        for leaf in leaves:
            by = leaf.by or ("nobody but a stop of the run",)
            lines += [leaf.node, *(f"  {one}" for one in by)]
    return "\n".join(lines)


def _rules() -> str:
    lines = [f"{rule.code} {rule.name}: {rule.about}" for rule in RULES]
    return "\n".join([*lines, f"{WAIVER_CODE} {WAIVER_RULE}: {WAIVER_ABOUT}"])


def _as_json(report: LintReport, *, strict: bool) -> str:
    waived = [{**asdict(one), "reason": reason} for one, reason in report.waived]
    document = {
        "ok": not (report.findings or report.faults or (strict and waived)),
        "files": len(report.programs),
        "findings": [asdict(one) for one in report.findings],
        "waived": waived,
        "faults": [asdict(fault) for fault in report.faults],
    }
    return json.dumps(document, indent=2)


def _summary(report: LintReport, count: int, *, strict: bool) -> str:
    parts = [
        f"{len(report.programs)} tree{'' if len(report.programs) == 1 else 's'}",
        f"{count} finding{'' if count == 1 else 's'}",
    ]
    if report.waived and not strict:
        parts.append(f"{len(report.waived)} waived")
    if report.faults:
        parts.append(f"{len(report.faults)} fault{'' if len(report.faults) == 1 else 's'}")
    return ", ".join(parts)
