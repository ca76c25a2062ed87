"""Mission reports as JUnit XML, which every CI shows: one test case a run."""

from collections.abc import Sequence
from xml.etree import ElementTree

from executive.inspector.report import MissionReport

# Outcomes that say something about the executive or the cell, and not about the task.
_ERRORS = ("error", "aborted", "unfinished")


def junit(reports: Sequence[MissionReport]) -> str:
    """Return JUnit XML; a run that did not succeed says why, from the root down."""
    failed = sum(report.outcome in ("failure", "timeout") for report in reports)
    errors = sum(report.outcome in _ERRORS for report in reports)
    counts = {"tests": len(reports), "failures": failed, "errors": errors}
    total_s = sum(report.cycle_s for report in reports)
    attributes = {name: str(count) for name, count in counts.items()} | {"time": f"{total_s:.3f}"}
    suites = ElementTree.Element("testsuites", {"name": "cellwright", **attributes})
    suite = ElementTree.SubElement(suites, "testsuite", {"name": "missions", **attributes})
    for report in reports:
        _case(suite, report)
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, encoding="unicode", xml_declaration=True)


def _case(suite: ElementTree.Element, report: MissionReport) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        {
            "classname": report.mission,
            "name": f"seed {report.seed} ({report.file})",
            "time": f"{report.cycle_s:.3f}",
        },
    )
    chain = _printable("\n".join(report.chain))
    if report.outcome != "success":
        kind = "error" if report.outcome in _ERRORS else "failure"
        about = {"type": report.outcome, "message": _printable(report.reason)}
        ElementTree.SubElement(case, kind, about).text = chain
    ElementTree.SubElement(case, "system-out").text = chain


def _printable(text: str) -> str:
    """Leave out what XML cannot hold: control characters of somebody's message."""
    return "".join(letter for letter in text if letter.isprintable() or letter in "\n\t")
