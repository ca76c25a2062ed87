"""`cellwright campaign FILE`, `show` and `compare`, as a user calls them."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.cli.main import app
from executive.core.errors import InputError

MISSION = """
format: 1
mission: toss
cell: dry
in: {p: {type: float, default: 0.5}}
root: {chance: $p}
"""
CAMPAIGN = """
campaign: tosses
format: 1
mission: toss
seeds: {count: 12}
grid: {p: [0.1, 0.9]}
"""


def cellwright(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def refused(*arguments):
    """Return what is said of input that cannot be used."""
    error = cellwright(*arguments).exception
    assert isinstance(error, InputError)
    return str(error)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("toss.yaml").write_text(MISSION)
    Path("tosses.yaml").write_text(CAMPAIGN)
    return tmp_path


def test_a_campaign_is_run_shown_and_compared(folder):
    import pyarrow.parquet

    run = cellwright("campaign", "tosses.yaml", "--out", "out", "--json")
    assert run.exit_code == 0, run.output
    document = json.loads(run.stdout)
    assert document["runs"] == 24
    assert [one["settings"] for one in document["variants"]] == [{"p": 0.1}, {"p": 0.9}]
    shares = [one["figures"][0]["value"] for one in document["variants"]]
    assert shares[0] < 0.5 < shares[1]
    table = pyarrow.parquet.read_table("out/results.parquet").to_pylist()
    assert len(table) == 24
    assert all(Path("out", row["recording"]).exists() for row in table if row["recording"])
    assert {row["set.p"] for row in table if row["outcome"] == "failure"} <= {0.1, 0.9}
    Path("out/results.parquet").unlink()
    shown = json.loads(cellwright("campaign", "show", "out", "--json").stdout)
    assert shown == document
    assert Path("out/results.parquet").exists()
    same = cellwright("campaign", "compare", "out", "out")
    assert (same.exit_code, "nothing differs beyond noise" in same.stdout) == (0, True)
    other = cellwright("campaign", "compare", "out:0", "out:v001", "--json")
    assert other.exit_code == 1
    assert json.loads(other.stdout)["differences"][0]["beyond_noise"]
    again = cellwright("campaign", "run", "tosses.yaml", "--out", "out", "--resume")
    assert again.exit_code == 0
    assert "24 runs: " in again.stdout


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("nothing.yaml",), "nothing.yaml: no such file; expected the document of a campaign"),
        (("shwo", "out"), "shwo: no such file; expected the document of a campaign, or one of"),
        (("tosses.yaml", "--resume"), "--resume: which campaign?"),
        (("tosses.yaml", "--resume", "--out", "nowhere"), "holds no campaign"),
        (("show", "nowhere"), "nowhere: holds no campaign"),
        (("compare", "nowhere", "nowhere:1"), "nowhere: holds no campaign"),
        (("compare", "nowhere", "nowhere:b"), "holds no campaign"),
    ],
)
def test_bad_input_is_answered(folder, options, said):
    assert said in refused("campaign", *options)
    assert not Path("runs").exists()


def test_a_scheduler_that_does_not_answer_is_told(folder):
    said = refused("campaign", "tosses.yaml", "--out", "out", "--scheduler", "tcp://127.0.0.1:9")
    assert "no Dask scheduler answers there" in said
