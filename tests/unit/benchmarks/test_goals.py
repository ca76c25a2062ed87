import pytest

from benchmarks.goals import parse_goal


@pytest.mark.parametrize(
    ("text", "figure", "met"),
    [
        (">= 5", 5.0, True),
        (">= 5", 4.999, False),
        ("<= 0.30", 0.2967, True),
        ("< 2", 2.0, False),
        ("> -0.25", -0.3, False),
        ("= 0", 0.0, True),
        ("= 0", 0.0015, False),
        ("= 1", 0.97, False),
        ("= 0.65", 0.6534, True),
        ("= 0.65", 0.66, False),
    ],
)
def test_a_figure_meets_its_goal_or_does_not(text, figure, met):
    goal = parse_goal(text)
    assert goal is not None
    assert goal.is_met(figure) is met


def test_no_text_is_no_goal_and_other_text_is_refused():
    assert parse_goal("") is None
    with pytest.raises(ValueError, match=r"got 'soon'; expected a sign and a number"):
        parse_goal("soon")
