"""What a recording says of the faults that were injected into its run."""

from executive.engine.recording.messages import InjectedReport
from executive.engine.recording.reader import Recording

_PLACES = 3


def injected_lines(recording: Recording) -> tuple[str, ...]:
    """Return what came of each fault, or what was to be injected where a run was killed."""
    if recording.result is None:
        return recording.header.faults
    return tuple(injected_line(report) for report in recording.result.injected)


def injected_line(report: InjectedReport) -> str:
    """Return what came of a fault, in one line."""
    if not report.times:
        return f"{report.fault} - never happened"
    often = "" if report.times == 1 else f", {report.times} times"
    more = len(report.places) - _PLACES
    places = ", ".join(report.places[:_PLACES]) + (f" and {more} more" if more > 0 else "")
    return f"{report.fault} - {places}{often}, first @{report.first_tick}"
