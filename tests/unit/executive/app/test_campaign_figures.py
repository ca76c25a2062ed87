"""Figures of campaigns and their comparison, by what holds for any of them."""

import numpy as np
import pytest

from executive.app.campaigns.comparing import compare
from executive.app.campaigns.figures import figures
from executive.app.campaigns.jobs import RunRecord


def run(seed, level, variant=0, ok=True, **settings):
    return RunRecord(
        name=f"v{variant}_s{seed}",
        variant=variant,
        seed=seed,
        settings=settings,
        outcome="success" if ok else "failure",
        sim_s=level,
        measures={"claim.sure": level, "truth.right": ok},
    )


def by_name(found):
    return {one.name: one for one in found}


def test_intervals_hold_what_they_say():
    rng = np.random.default_rng(1)
    held = {"success": 0, "sim_s": 0}
    for _ in range(200):
        some = [run(i, float(rng.normal(3.0)), ok=rng.random() < 0.8) for i in range(30)]
        found = by_name(figures(some))
        held["success"] += found["success"].low <= 0.8 <= found["success"].high
        held["sim_s"] += found["sim_s"].low <= 3.0 <= found["sim_s"].high
    assert all(176 <= count <= 199 for count in held.values()), held


def test_one_run_and_all_alike_have_honest_intervals():
    (one,) = [one for one in figures([run(0, 1.0)]) if one.name == "sim_s"]
    assert (one.low, one.high) == (-np.inf, np.inf)
    share = by_name(figures([run(i, 1.0) for i in range(10)]))["success"]
    assert share.value == 1.0
    assert share.low < 0.75


def test_a_set_compared_with_itself_differs_nowhere():
    some = [run(i, float(i)) for i in range(20)]
    found = compare(some, some)
    assert found.paired
    assert found.pairs == 20
    assert not any(one.beyond_noise for one in found.differences)
    assert all(one.low == one.high == 0.0 for one in found.differences if one.name == "sim_s")


def test_pairs_find_what_groups_cannot():
    rng = np.random.default_rng(2)
    hard = rng.normal(0.0, 10.0, 30)
    a = [run(i, float(hard[i])) for i in range(30)]
    b = [run(i, float(hard[i] + 1.0 + 0.2 * rng.normal())) for i in range(30)]
    paired = by_name(compare(a, b).differences)["sim_s"]
    assert paired.beyond_noise
    assert paired.low < 1.0 < paired.high
    apart = [one.model_copy(update={"seed": one.seed + 100}) for one in b]
    groups = compare(a, apart)
    assert not groups.paired
    assert not by_name(groups.differences)["sim_s"].beyond_noise


def test_noise_is_seldom_taken_for_a_difference():
    rng = np.random.default_rng(3)
    wrong = 0
    for _ in range(15):
        a, b = ([run(i, float(rng.normal())) for i in range(12)] for _ in range(2))
        wrong += any(one.beyond_noise for one in compare(a, b).differences)
    assert wrong <= 3


def test_variants_are_compared_by_seed():
    a = [run(i, 1.0 * i, variant=0, way=0.1) for i in range(20)]
    b = [run(i, 1.0 * i, variant=1, ok=i % 3 == 0, way=0.2) for i in range(20)]
    found = compare(a, b)
    assert (found.paired, found.pairs, found.left_out) == (True, 20, 0)
    success = by_name(found.differences)["success"]
    assert success.beyond_noise
    assert (success.a, success.b) == (1.0, pytest.approx(7 / 20))
    assert not by_name(found.differences)["sim_s"].beyond_noise


def test_runs_of_one_seed_are_no_independent_samples():
    settings = [{"k": k} for k in range(50)]
    a = [run(0, 1.0 + k / 100, variant=k, **settings[k]) for k in range(50)]
    b = [run(0, 2.0 + k / 100, variant=k, **settings[k]) for k in range(50)]
    found = by_name(compare(a, b).differences)["sim_s"]
    assert found.n == 1
    assert not found.beyond_noise


def test_what_has_no_partner_is_told():
    a, b = [run(i, 1.0) for i in range(10)], [run(i, 1.0) for i in range(5, 12)]
    found = compare(a, b)
    assert (found.pairs, found.left_out) == (5, 7)
