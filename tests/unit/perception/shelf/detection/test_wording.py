"""Names in what was read: whole, half hidden, misread, or of nothing that is known."""

import numpy as np
import pytest

from perception.shelf.detection.wording import TextModel, Wording, agreeing_letters

NAMES = ("tylenol", "advil", "body wash", "face wash", "hand cream", "COQ10")
WORDINGS = [
    Wording("tylenol", "Tylenol"), Wording("advil", "Advil"), Wording("body wash", "Lumea"),
    Wording("face wash", "Puro"), Wording("hand cream", "Velveta"), Wording("COQ10", "Solvita"),
]  # fmt: skip


@pytest.fixture
def model():
    return TextModel(WORDINGS)


def best(row):
    return (*NAMES, "unknown")[int(row.argmax())]


@pytest.mark.parametrize("name", NAMES)
def test_a_whole_name_counts_its_letters_whatever_stands_around_it(name):
    letters = len(name.replace(" ", ""))
    for text in (name, name.upper(), f"new {name.title()} 200 ml"):
        assert agreeing_letters(text, [name])[0] == letters


def test_a_letter_that_is_wrong_costs_two_and_one_that_is_missing_costs_two():
    # It agrees no more, and costs one.
    assert agreeing_letters("tylemol", ["tylenol"])[0] == 5
    assert agreeing_letters("tylnol", ["tylenol"])[0] == 5
    # What is cut off costs nothing but itself.
    assert agreeing_letters("tyle", ["tylenol"])[0] == 4
    assert agreeing_letters("", ["tylenol"])[0] == 0


def test_letters_and_digits_that_look_alike_are_one():
    assert agreeing_letters("C0Ql0", ["COQ10"])[0] == 5


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Tylenol 60 tablets", "tylenol"),
        ("lenol", "tylenol"),
        ("FACE WASH dermatologically tested", "face wash"),
        ("wash Lumea", "body wash"),
        ("Velveta", "hand cream"),
        ("BRILLO MAR sponges", "unknown"),
    ],
)
def test_products_are_told_by_name_brand_or_both(model, text, name):
    assert best(model.probabilities(text)) == name


def test_readings_are_distributions(model):
    for text in ("", "x", "tylenol advil", "body wash Lumea"):
        row = model.probabilities(text)
        assert row.shape == (7,)
        assert row.sum() == pytest.approx(1.0)
        assert row.min() > 0.0


def test_no_text_tells_nothing(model):
    row = model.probabilities("")
    assert np.ptp(row[:-1]) == pytest.approx(0.0)


def test_a_word_that_two_share_leaves_both(model):
    row = model.probabilities("wash")
    assert row[2] == pytest.approx(row[3])
    assert row[2] > 3 * row[0]


def test_small_print_makes_nothing_unknown(model):
    print_only = model.probabilities("keep out of reach of children", title="")
    assert print_only[-1] < model.probabilities("keep out of reach of children")[-1]
