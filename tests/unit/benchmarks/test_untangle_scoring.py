"""Scoring of untangling runs: knots left, kinds of failure, and going on after a kill."""

import numpy as np
import pytest

from benchmarks import untangle
from benchmarks.untangle import rows, run_all
from benchmarks.untangle_trial import Trial, Wanted, left_to_run, read_trials
from benchmarks.untangle_truth import (
    CableMoments,
    Failure,
    broken_limits,
    failure_of,
    knots_left,
    undone_s,
)
from executive.engine.recording.messages import ActionReport, RunReport
from robots.limits import yumi_limits
from robots.placement import HOME_RAD
from simulation.cable.tiers import tier_cable


def straight():
    return np.column_stack([np.linspace(-0.4, 0.4, 81), np.zeros(81), np.full(81, 0.003)])


@pytest.fixture(scope="module")
def two_knots():
    return tier_cable("C3", np.random.default_rng(1), leaves_view=False).nodes_m


@pytest.fixture(scope="module")
def one_knot():
    return tier_cable("C2", np.random.default_rng(1), leaves_view=False).nodes_m


def report(claimed=False, reasons=(), name="dilate_knot"):
    actions = tuple(
        ActionReport(name=name, start_s=0.0, duration_s=1.0, status="failure", reason=reason)
        for reason in reasons
    )
    claim = {"untangled": claimed, "knotted_probability": 0.5}
    return RunReport(
        mission="untangle", seed=0, outcome="timeout", reason="", claim=claim, sim_s=900.0,
        wall_s=1.0, ticks=1, actions=actions, recording=None,
    )  # fmt: skip


def moments(*lines):
    return CableMoments(np.arange(len(lines), dtype=float), lines)


def test_knots_in_series_are_counted_and_one_involved_knot_is_one(two_knots, one_knot):
    assert [knots_left(line, 2) for line in (two_knots, one_knot, straight())] == [2, 1, 0]


def test_a_knot_counts_as_undone_when_it_stays_so(two_knots, one_knot):
    lines = (two_knots, one_knot, two_knots, one_knot, one_knot, straight())
    assert undone_s(moments(*lines), 2) == (3.0, 5.0)
    assert undone_s(moments(two_knots, one_knot), 2) == (1.0,)
    assert undone_s(moments(one_knot, one_knot), 1) == ()


def lifted(line):
    return line + np.array([0.0, 0.0, 0.2])


@pytest.mark.parametrize(
    ("claimed", "reasons", "end", "expected"),
    [
        (True, (), "knot", Failure.FALSE_CLAIM),
        (False, (), "fallen", Failure.FELL_OFF),
        (False, (), "lifted", Failure.DRAPED),
        (False, ("grasp.missed: nothing",) * 3, "knot", Failure.MISSED_GRASP),
        (False, ("motion.no_path: none", "grasp.unreachable: no"), "knot", Failure.MANIPULATION),
        (False, ("", "", "grasp.missed: nothing"), "knot", Failure.TIMEOUT),
    ],
)
def test_failures_are_told_apart(one_knot, claimed, reasons, end, expected):
    last = {"knot": one_knot, "fallen": one_knot - (0, 0, 0.5), "lifted": lifted(one_knot)}[end]
    assert failure_of(report(claimed, reasons), False, moments(one_knot, last)) is expected


def test_a_knot_more_than_at_first_is_a_complex_one(one_knot, two_knots):
    assert failure_of(report(), False, moments(one_knot, two_knots)) is Failure.COMPLEX_KNOT
    assert failure_of(report(), True, moments(one_knot, straight())) is None


def moved(times_s, speed):
    """Positions and velocities of a joint that is sampled at these times."""
    velocities = np.zeros((len(times_s), 14))
    velocities[:, 3] = speed(times_s)
    return times_s, np.zeros_like(velocities) + HOME_RAD, velocities


def test_limits_hold_however_uneven_the_samples_are_and_no_jump_is_missed():
    limits = yumi_limits()
    times_s = np.array([0.0, 1.25, 1.3, 1.35, 1.4, 1.6, 1.65, 1.7])
    jerk = 0.9 * float(limits.jerk[3])
    begins_s = 1.22

    def speed(at_s):
        run_s = np.clip(at_s - begins_s, 0.0, 0.1)
        return 0.5 * jerk * run_s**2

    assert not broken_limits(limits, *moved(times_s, speed))[:4].any()
    jumps = broken_limits(limits, *moved(times_s, lambda at_s: 1.5 * (at_s > 1.38)))
    assert jumps.any()
    fast = 1.1 * float(limits.velocity[3])
    assert broken_limits(limits, *moved(times_s, lambda at_s: np.full(len(at_s), fast))).all()


def trial(seed, cable="C1", untangled=True, failure=None):
    return Trial(
        wanted=Wanted(cable=cable, seed=seed), outcome="success", reason="", claimed=untangled,
        untangled=untangled, undone_s=(60.0,) if untangled else (), sim_s=120.0, wall_s=60.0,
        seeing_s=5.0, thinking_s=5.0, acting_s=10.0, actions=4, failure=failure, samples=100,
        broken=0, touching=0,
    )  # fmt: skip


def test_a_benchmark_that_was_killed_goes_on_with_what_is_not_there(tmp_path, monkeypatch):
    asked = []

    def tried(wanted, folder):
        asked.append(wanted.seed)
        return trial(wanted.seed)

    monkeypatch.setattr(untangle, "tried", tried)
    wanted = [Wanted(cable="C1", seed=seed) for seed in range(4)]
    run_all(wanted[:2], tmp_path, 1)
    with (tmp_path / "trials.jsonl").open("a") as file:
        file.write('{"wanted": {"cable": "C1", "se')  # the kill
    found = run_all(wanted, tmp_path, 1)
    assert sorted(asked) == [0, 1, 2, 3]
    assert sorted(one.wanted.seed for one in found) == [0, 1, 2, 3]
    assert left_to_run(wanted, read_trials(tmp_path / "trials.jsonl")) == []


def test_rows_follow_the_table_of_the_thesis():
    failed = trial(2, untangled=False, failure=Failure.TIMEOUT)
    found = {row.name: row for row in rows([trial(0), trial(1), failed])}
    assert found["C1_knot_1"].value == pytest.approx(2 / 3)
    assert found["C1_verified"].value == 1.0
    assert found["C1_verified_min"].value == 2.0
    assert found["C1_failure_7"].value == pytest.approx(1 / 3)
    assert found["false_claims"].value == 0.0
    assert found["physics_and_opening_s"].value == 40.0
    assert "robot_over_cpu" not in found
    timed = rows([trial(0), trial(1).model_copy(update={"cpu_s": 60.0})])
    ratio = next(row for row in timed if row.name == "robot_over_cpu")
    assert (ratio.value, ratio.n) == (2.0, 1)


def test_no_run_is_started_when_the_time_is_over(tmp_path):
    assert run_all([Wanted(cable="C1", seed=1)], tmp_path, 1, longest_s=0.0) == []


def test_what_one_policy_claims_is_not_counted_for_another():
    ours, other = trial(0), trial(1)
    wrong = other.model_copy(
        update={
            "wanted": Wanted(cable="C1", seed=1, policy="tusk"),
            "claimed": True,
            "untangled": False,
        }
    )
    found = {row.name: row for row in rows([ours, wrong])}
    assert found["false_claims"].value == 0.0
    assert found["tusk_false_claims"].value == 1.0
    assert found["false_claims"].n == 1
