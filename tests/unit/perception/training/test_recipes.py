import pytest

from executive.core.errors import InputError
from perception.training.recipes import (
    AfterStep,
    Recipe,
    VersionRecipe,
    newest_recipes,
    read_recipe,
    read_recipes,
    write_recipe,
)
from perception.training.tasks import AFTER, STEPS, TASKS

EVERY = read_recipes()


@pytest.mark.parametrize("name", sorted(EVERY))
def test_recipes_of_versions_can_be_executed(name):
    recipe = EVERY[name]
    assert recipe.task in TASKS
    assert all(step.step in STEPS for step in recipe.after)
    assert not recipe.stages[0].goes_on


def test_every_task_has_what_comes_after_it():
    assert set(AFTER) == set(TASKS)
    assert {step for steps in AFTER.values() for step in steps} <= set(STEPS)


def test_a_recipe_is_read_as_it_was_written(tmp_path):
    stages = (Recipe(seed=3, hours=0.5), Recipe(samples=500, stop=200, start="previous"))
    recipe = VersionRecipe(task="tracer", stages=stages, after=(AfterStep(step="calibrate"),))
    write_recipe(tmp_path / "recipe.yaml", recipe)
    assert read_recipe(tmp_path / "recipe.yaml") == recipe


def test_less_work_is_less_of_all():
    recipe = VersionRecipe(
        task="tracer",
        stages=(Recipe(samples=1000, stop=600, hours=2.0, held_out_batches=20),),
        after=(AfterStep(step="calibrate", batches=50),),
    )
    stage, step = recipe.scaled(0.1).stages[0], recipe.scaled(0.1).after[0]
    assert (stage.samples, stage.stop, stage.hours, stage.held_out_batches) == (100, 60, 0.2, 2)
    assert step.batches == 5
    assert recipe.scaled(1.0) == recipe
    assert recipe.scaled(1e-9).stages[0].samples == 1


def test_the_newest_version_of_each_task_has_the_highest_number():
    made = {
        name: VersionRecipe(task=name.rpartition("_")[0], stages=(Recipe(),))
        for name in ("tracer_v2", "tracer_v10", "sight_v1")
    }
    assert set(newest_recipes(made)) == {"tracer_v10", "sight_v1"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("task: tracer\nstages: []\n", r"stages: .*got \[\]"),
        ("task: tracer\nstages: [{sed: 3}]\n", r"stages/0/sed: .*got 3"),
        ("task: tracer\nstages: [{samples: 0}]\n", r"stages/0/samples: .*got 0"),
        ("stages: [\n", "no YAML"),
    ],
)
def test_what_is_no_recipe_is_said(tmp_path, text, message):
    path = tmp_path / "recipe.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_recipe(path)


def test_folders_without_recipes_are_said(tmp_path):
    with pytest.raises(InputError, match=r"no recipe\.yaml in it"):
        read_recipes(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read_recipe(tmp_path / "recipe.yaml")
