"""`cellwright affinity`: matrices built over a socket, shown, drawn and compared."""

import json
import sys
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from executive.cli import main
from executive.core.errors import InputError
from perception.shelf.affinity import load_affinity
from perception.shelf.language.scores import load_scores

sys.path.append(str(Path(__file__).parents[1] / "perception" / "shelf" / "language"))
from completions_server import completions_server

DOMAIN = """
format: 1
domain: larder
about: For tests.
scale: 0.7
objects:
  - {name: tea, brand: A, category: [drinks], width_m: [0.1, 0.1], depth_m: [0.1, 0.1], height_m: [0.1, 0.1]}
  - {name: coffee, brand: A, category: [drinks], width_m: [0.1, 0.1], depth_m: [0.1, 0.1], height_m: [0.1, 0.1]}
  - {name: soap, brand: B, category: [], width_m: [0.1, 0.1], depth_m: [0.1, 0.1], height_m: [0.1, 0.1]}
"""  # noqa: E501 - as the domains of the package have it


def affinity(*arguments):
    result = CliRunner().invoke(main.app, ["affinity", *map(str, arguments)])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


@pytest.fixture
def domain(tmp_path):
    path = tmp_path / "larder.yaml"
    path.write_text(DOMAIN)
    return path


@pytest.fixture
def matrix(domain, tmp_path):
    out = tmp_path / "larder.json"
    with completions_server() as (address, _):
        affinity(
            "build", domain, "--model", address, "--served-model", "toy", "--prompt", "{X} and",
            "--scores", tmp_path / "scores", "--out", out,
        )  # fmt: skip
    return out


def test_a_matrix_is_built_over_a_socket_and_says_who_made_it(matrix, tmp_path):
    built = load_affinity(matrix)
    assert built.names == ("tea", "coffee", "soap")
    assert (built.origin.model, built.origin.prompt) == ("toy", "{X} and")
    assert built.origin.version.startswith("http://127.0.0.1:")
    assert load_scores(tmp_path / "scores" / "larder.toy.json").scores.shape == (1, 3, 3)


def test_a_built_matrix_is_shown_in_order(matrix):
    told = json.loads(affinity("show", matrix, "tea", "--json").stdout)
    shares = [*told["affinities"]["tea"].values()]
    assert len(shares) == 2
    assert shares == sorted(shares, reverse=True)
    lines = affinity("show", matrix).stdout.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["tea", "coffee", "soap"]


def test_temperature_evens_out(matrix):
    warm = json.loads(affinity("show", matrix, "--temperature", 1e6, "--json").stdout)
    assert list(warm["affinities"]["tea"].values()) == pytest.approx([0.5, 0.5], abs=1e-4)


def test_a_heat_map_has_a_cell_for_every_pair(matrix, tmp_path):
    affinity("show", matrix, "--out", tmp_path / "heat.png")
    affinity("show", "pharmacy", "--out", tmp_path / "large.png")
    with Image.open(tmp_path / "heat.png") as small, Image.open(tmp_path / "large.png") as large:
        assert large.height - small.height >= (27 - 3) * 20


def test_own_matrices_are_compared_with_the_stored_ones(matrix, domain):
    rows = json.loads(affinity("compare", domain, matrix, "--json").stdout)
    assert [row["name"] for row in rows] == ["uniform", str(matrix)]
    stored = json.loads(affinity("compare", "pharmacy", "--json").stdout)
    figures = {row["name"]: row["with_diagonal"] for row in stored}
    # The thesis's Table 7.1 has 0.65 for even affinities.
    assert round(figures["uniform"], 2) == 0.65
    assert figures["smollm2+minilm"] < 0.30


def test_a_matrix_is_a_provider_too(matrix, domain, tmp_path):
    again = tmp_path / "again.json"
    affinity("build", domain, "--model", matrix, "--recipe", "prompts", "--out", again)
    order = [load_affinity(path).rows.argmax(axis=1).tolist() for path in (matrix, again)]
    assert order[0] == order[1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("show", "pharmcy"), "no stored domain 'pharmcy'; did you mean 'pharmacy'"),
        (("show", "pharmacy", "tylenl"), "unknown object 'tylenl'; did you mean 'tylenol'"),
        (("show", "pharmacy", "--models", "bert"), "no stored scores of pharmacy by 'bert'"),
        (("show", "pharmacy", "--recipe", "thsis"), "no recipe 'thsis'; did you mean 'thesis'"),
        (("show", "pharmacy", "--temperature", "0"), "temperature: got 0"),
        (("show", "none.json"), "none.json: cannot be read"),
        (("compare", "garage"), "unknown domain 'garage'"),
        (("build", "pharmacy", "--out", "/none/m.json"), "expected a file in a folder that exists"),
        (("build", "pharmacy", "--prompt", "beside", "--out", "m.json"), "expected {X} where"),
    ],
)
def test_wrong_input_is_told_of(arguments, words):
    with pytest.raises(InputError) as error:
        affinity(*arguments)
    assert words in str(error.value)
