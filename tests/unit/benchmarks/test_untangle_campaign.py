"""Runs of a campaign as trials of the benchmark."""

import pytest

from benchmarks.untangle_campaign import trials_of, wanted_of
from executive.app.campaigns.jobs import RunRecord
from executive.core.errors import InputError
from executive.engine.result_folders import RESULTS


def record(**settings):
    named = {key.replace("__", "."): value for key, value in settings.items()}
    return RunRecord(name="v000_s7", variant=0, seed=7, settings=named, outcome="success")


def test_settings_of_a_run_say_what_it_is_in_the_table():
    wanted = wanted_of(record(cable__tier="C2", policy="tusk", arms__slip_rate=0.3))
    assert (wanted.cable, wanted.seed, wanted.policy) == ("C2", 7, "tusk")
    assert wanted.options == ("arms.slip_rate=0.3",)
    assert wanted_of(record(cable__knot="bowline")).cable == "bowline"


def test_what_cannot_be_scored_is_refused_with_the_reason(tmp_path):
    with pytest.raises(InputError, match=r"got no cable\.tier or cable\.knot"):
        wanted_of(record(policy="tusk"))
    with pytest.raises(InputError, match="holds no results"):
        trials_of(tmp_path)
    (tmp_path / RESULTS).write_text(record(cable__tier="C1").model_dump_json() + "\n")
    with pytest.raises(InputError, match=r"v000_s7: has no recording; .* try keep: all"):
        trials_of(tmp_path)
