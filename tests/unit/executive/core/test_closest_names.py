"""Answers to unknown names: short enough to be read, however many are known."""

from executive.core.registry import closest


def test_a_few_known_names_are_all_listed():
    names = [f"skill_{number}" for number in range(20)]
    assert closest("skil_3", names).count("skill_") == 21
    assert closest("zzz", []) == "known: none"


def test_of_many_known_names_the_nearest_are_listed_and_the_others_counted():
    names = [f"node_{number}" for number in range(300)] + ["grasp"]
    answer = closest("grsp", names)
    assert answer.startswith("did you mean 'grasp'? (known: ")
    assert "grasp" in answer.partition("known: ")[2]
    listed = answer.partition("known: ")[2].partition(" and ")[0].split(", ")
    assert f"and {len(names) - len(listed)} more" in answer
    assert len(answer) < 200


def test_of_many_names_some_are_listed_where_none_is_near():
    answer = closest("§", [f"node_{number}" for number in range(300)])
    assert answer.startswith("known: node_0, ")
    assert answer.endswith(" and 292 more")
