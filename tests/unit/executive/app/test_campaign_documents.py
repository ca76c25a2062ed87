"""Which runs the document of a campaign asks for, and what is said of one that has faults."""

import math

import pytest
from toy_campaigns import write_campaign

from executive.app.campaigns.document import read_campaign
from executive.app.campaigns.variants import jobs, variants
from executive.core.errors import DocumentError, InputError


def document(folder, text):
    return read_campaign(write_campaign(folder, text))[0]


def test_every_combination_is_run_once_with_every_seed(tmp_path):
    found = document(
        tmp_path,
        "seeds: {first: 5, count: 3}\nset: {a: 1}\n"
        "grid: {b: [1, 2], c: [x, y, z]}\nlist: [{d: 1}, {d: 2, a: 7}]\n",
    )
    wanted = list(jobs(found))
    assert len(wanted) == len({one.name for one in wanted}) == 2 * 3 * 2 * 3
    assert {one.seed for one in wanted} == {5, 6, 7}
    assert [one.seed for one in wanted[:12]] == [5] * 12  # every variant before the next seed
    seen = {tuple(sorted(one.settings.items())) for one in wanted}
    assert len(seen) == 12
    assert {(one.settings["a"], one.settings["d"]) for one in wanted} == {(1, 1), (7, 2)}


def test_a_document_with_nothing_to_vary_is_one_run(tmp_path):
    (job,) = jobs(document(tmp_path, ""))
    assert (job.seed, job.settings) == (0, {})
    assert document(tmp_path, "seeds: [7, 3, 7]\n").all_seeds == (7, 3)


def test_draws_keep_to_their_bounds_and_to_their_own_stream(tmp_path):
    of = "u: {uniform: [1.0, 2.0]}, l: {log_uniform: [0.01, 100.0]}, i: {integers: [3, 5]}"
    text = f"sample: {{count: 300, seed: 4, of: {{{of}, c: {{choice: [p, q]}}}}}}\n"
    drawn = [one.settings for one in variants(document(tmp_path, text))]
    assert all(1.0 <= one["u"] <= 2.0 for one in drawn)
    assert {one["i"] for one in drawn} == {3, 4, 5}
    assert {one["c"] for one in drawn} == {"p", "q"}
    below = sum(math.log(one["l"]) < 0.0 for one in drawn)
    assert 100 < below < 200
    alone = "sample: {count: 300, seed: 4, of: {i: {integers: [3, 5]}}}\n"
    again = [one.settings for one in variants(document(tmp_path, alone))]
    assert [one["i"] for one in again] == [one["i"] for one in drawn]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("seed: 3\n", "campaign.yaml:4:1: unknown key 'seed'; did you mean 'seeds'?"),
        ("seeds: {count: 0}\n", "campaign.yaml:4:9: seeds.count: expected greater than"),
        ("seeds: {cont: 3}\n", "campaign.yaml:4:9: unknown key 'cont'; did you mean 'count'?"),
        ("seeds: 3\n", "campaign.yaml:4:1: seeds: expected a list"),
        ("seeds: []\n", "campaign.yaml:4:1: seeds: expected at least one"),
        ("limits: {wall: 3}\n", "unknown key 'wall'; did you mean 'wall_s'?"),
        ("limits: {wall_s: -1.0}\n", "wall_s: expected greater than 0"),
        ("limits: {walls: 1.0}\n", "unknown key 'walls'"),
        ("sample: {count: 2, of: {a: {uniform: [2, 1]}}}\n", "the lowest comes first"),
        ("sample: {count: 2, of: {a: {log_uniform: [0, 1]}}}\n", "bounds above 0"),
        ("sample: {count: 2, of: {a: {}}}\n", "expected one of uniform"),
        ("grid: {a: []}\n", "at least one"),
        ("grid: {a: [1]\n", "campaign.yaml:"),
        ("keep: some\n", "'failed', 'all' or 'none'"),
    ],
)
def test_faults_are_told_with_their_place(tmp_path, text, said):
    with pytest.raises(DocumentError) as error:
        document(tmp_path, text)
    assert said in str(error.value)


def test_a_file_that_is_no_document_is_refused(tmp_path):
    with pytest.raises(InputError, match="no campaign can be read from it"):
        read_campaign(tmp_path)
    (tmp_path / "odd.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError):
        read_campaign(tmp_path / "odd.yaml")
    (tmp_path / "list.yaml").write_text("[1, 2]\n")
    with pytest.raises(DocumentError):
        read_campaign(tmp_path / "list.yaml")
