import numpy as np
import pytest

from benchmarks.knot_judging import Cause, Failure, Wrong
from benchmarks.knot_scenes import KnotScene
from benchmarks.knots import Trial, calibration, failures, tried
from perception.cable.types import CableScene


def _rows(trials):
    return {row.name: row for row in calibration(trials, np.random.default_rng(0))}


def test_beliefs_that_always_hold_are_calibrated():
    rows = _rows([Trial(1.0, True, None), Trial(0.0, False, None)] * 30)
    assert rows["knotted_calibration_error"].value == 0.0
    assert rows["knotted_error_of_surest_80"].value == 0.0


def test_certain_beliefs_that_never_hold_are_as_wrong_as_can_be():
    rows = _rows([Trial(0.0, True, None), Trial(1.0, False, None)] * 30)
    # One of 15 bins holds answers of both kinds.
    assert rows["knotted_calibration_error"].value > 1.0 - 1.5 / 15.0
    assert rows["knotted_error_of_surest_80"].value == 1.0


def test_few_scenes_show_a_gap_even_where_beliefs_hold():
    few, many = (
        _rows([Trial(0.3, k % 10 < 3, None) for k in range(count)])[
            "knotted_calibration_error_by_chance"
        ].value
        for count in (60, 3000)
    )
    assert 0.1 < few < 0.3
    assert many < 0.04


def test_what_counts_as_even_holds_where_both_kinds_weigh_as_much():
    # Of what is not read two of three cables are knotted, as of all; half is said of it.
    trials = [Trial(0.5, k % 3 < 2, None) for k in range(3000)]
    rows = _rows(trials)
    assert rows["knotted_calibration_error"].value > 0.15
    assert rows["knotted_calibration_error_even"].value < 0.12
    only = _rows([Trial(0.9, True, None)] * 20)
    assert "knotted_calibration_error_even" not in only


def test_who_abstains_where_unsure_makes_no_errors():
    sure = [Trial(0.99, True, None)] * 40 + [Trial(0.01, False, None)] * 40
    unsure = [Trial(0.55, False, None)] * 20
    rows = _rows(sure + unsure)
    assert rows["knotted_error_of_surest_80"].value == 0.0
    assert rows["knotted_calibration_error"].value == pytest.approx(0.118, abs=0.01)


def test_every_wrong_answer_counts_once_by_how_and_once_by_why():
    missed = Trial(0.2, True, Failure(Wrong.MISSED, Cause.CROSSING))
    elsewhere = Trial(0.9, True, Failure(Wrong.PLACE, Cause.TRACING))
    trials = [missed, missed, elsewhere, Trial(0.9, True, None)]
    shares = {row.name: row.value for row in failures("A1", trials) if row.value}
    assert shares == {
        "A1_missed": 0.5,
        "A1_place": 0.25,
        "A1_by_crossing": 0.5,
        "A1_by_tracing": 0.25,
    }


def test_wrong_answers_are_told_with_their_cause(capsys):
    line = np.column_stack([np.linspace(0.0, 90.0, 50), np.full(50, 20.0), np.zeros(50)])
    scene = KnotScene("A3", "bowline", np.zeros((40, 100), np.uint8), 5.0, line, (10.0, 30.0))
    nothing = CableScene((), (), (), (), 0.5, 0.0)
    trial = tried(lambda _: nothing, scene, "A3_tusk 7")
    assert trial == Trial(0.5, False, Failure(Wrong.UNSEEN, Cause.ENDS))
    assert capsys.readouterr().err.startswith("A3_tusk 7 bowline: says no knot")
