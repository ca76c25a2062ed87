"""The thesis's Table 4.2 out of a campaign: `python -m benchmarks.untangle_campaign FOLDER`.

A campaign such as `campaigns/untangle_tiers.yaml` runs on as many cores and machines as there are.
Its recordings, which it has to keep, are scored here as those of `python -m benchmarks untangle`.
"""

import argparse
from pathlib import Path

from benchmarks.harness import hand_over
from benchmarks.untangle import rows
from benchmarks.untangle_trial import Trial, Wanted, trial_of
from executive.app.campaigns.folder import CampaignFolder
from executive.app.campaigns.jobs import RunRecord
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording

_OF_CABLE = ("cable.tier", "cable.knot")
_OWN = ("policy", "vision")


def main() -> None:
    """Parse, score, print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.untangle_campaign")
    parser.add_argument("folder", type=Path, help="folder of the campaign")
    parser.add_argument("--json", type=Path, help="also write the result document here")
    chosen = parser.parse_args()
    try:
        trials = trials_of(chosen.folder)
    except InputError as error:
        parser.exit(2, f"{error}\n")
    first = min(trial.wanted.seed for trial in trials)
    hand_over("untangle", first, False, rows(trials), chosen.json)


def trials_of(folder: Path) -> list[Trial]:
    """Return the runs of a campaign, held against the truth.

    Raises:
        InputError: There are none, or some cannot be scored; says which.
    """
    records = list(CampaignFolder(folder).records())
    if not records:
        raise InputError(f"{folder}: holds no results of a campaign")
    return [_trial(record, folder) for record in records]


def _trial(record: RunRecord, folder: Path) -> Trial:
    wanted = wanted_of(record)
    if not record.recording:
        raise InputError(
            f"{folder}: {record.name}: has no recording; expected one of every run; "
            "try keep: all in the campaign"
        )
    recording = Recording.open(folder / record.recording)
    if recording.result is None:
        raise InputError(
            f"{folder}: {record.name}: {record.outcome}; expected a run that came to its end; "
            "try cellwright campaign FILE --resume --again"
        )
    return trial_of(wanted, recording.result.report, recording)


def wanted_of(record: RunRecord) -> Wanted:
    """Return what a run of a campaign is in the benchmark.

    Raises:
        InputError: It does not say which cable it was.
    """
    settings = {key: str(value) for key, value in record.settings.items()}
    cables = [settings[key] for key in _OF_CABLE if key in settings]
    if not cables:
        known = " or ".join(_OF_CABLE)
        raise InputError(f"{record.name}: got no {known}; expected a campaign over one of them")
    others = [key for key in settings if key not in (*_OF_CABLE, *_OWN)]
    return Wanted(
        cable=cables[0],
        seed=record.seed,
        policy=settings.get("policy", "default"),
        vision=settings.get("vision", "default"),
        options=tuple(f"{key}={settings[key]}" for key in sorted(others)),
    )


if __name__ == "__main__":
    main()
