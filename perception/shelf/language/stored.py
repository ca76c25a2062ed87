"""Scores that ship with the package, so that no mission needs a language model when it runs."""

from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Final

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.shelf.affinity import AffinityMatrix
from perception.shelf.language.recipes import RECIPES, Recipe, affinity_of
from perception.shelf.language.scores import PairScores, load_scores

FOLDER: Final = Path(str(files("perception.shelf"))) / "matrices"
DEFAULT_MODELS: Final = "smollm2+minilm"
"""The best of those under the Apache licence."""
BEST_MODELS: Final = "gemma3"
"""The best of all; Gemma has terms of its own."""
DEFAULT_RECIPE: Final = "symmetric"


def stored_affinity(
    domain: str, models: str = DEFAULT_MODELS, recipe: str = DEFAULT_RECIPE
) -> AffinityMatrix:
    """Return the affinities of a domain that ships with the package.

    Args:
        domain: `pharmacy`, `kitchen` or `office`.
        models: Names of models that have scored it, with `+` between them.
        recipe: Name of a recipe.

    Raises:
        InputError: The domain, a model or the recipe is unknown.
    """
    parts = [stored_scores(domain, model) for model in models.split("+")]
    return affinity_of(parts, recipe_of(recipe))


def stored_scores(domain: str, model: str) -> PairScores:
    """Return what one model has said of a domain.

    Raises:
        InputError: The domain or the model is unknown.
    """
    known = stored_models()
    if domain not in known:
        raise InputError(f"affinity: no stored domain {domain!r}; {closest(domain, [*known])}")
    if model not in known[domain]:
        raise InputError(
            f"affinity: no stored scores of {domain} by {model!r}; "
            f"{closest(model, list(known[domain]))}"
        )
    return _loaded(FOLDER / f"{domain}.{model}.json")


def stored_models() -> dict[str, tuple[str, ...]]:
    """Return which models have scored which domain."""
    found: dict[str, tuple[str, ...]] = {}
    for path in sorted(FOLDER.glob("*.json")):
        domain, model = path.stem.split(".")
        found[domain] = (*found.get(domain, ()), model)
    return found


def recipe_of(name: str) -> Recipe:
    """Return a recipe by its name.

    Raises:
        InputError: There is none of that name.
    """
    if name not in RECIPES:
        raise InputError(f"affinity: no recipe {name!r}; {closest(name, [*RECIPES])}")
    return RECIPES[name]


@cache
def _loaded(path: Path) -> PairScores:
    scores = load_scores(path)
    scores.scores.setflags(write=False)
    return scores
