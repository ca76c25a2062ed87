"""Scenes to search, and affinities that nobody has asked for yet."""

import numpy as np

from perception.shelf.affinity import Origin, affinity_from_scores
from simulation.shelf.scenes import draw_scene
from simulation.shelf.taxonomy import shipped_domain, taxonomy_affinity


def drawn_scenes(domain_name, rules, seeds):
    domain = shipped_domain(domain_name)
    return [draw_scene(domain, rules, np.random.default_rng(seed)) for seed in seeds]


def guessed_affinity(domain, rng, right=0.7, spread=0.6):
    """A flawed oracle: the taxonomy's categories blurred, and each pair wrong by a random factor.

    It stands for a language model that nobody has asked yet: `right` of each row is on the object's
    category, the rest on all others alike, and each logarithm is off by `spread`.
    """
    count = len(domain.names)
    true = taxonomy_affinity(domain)
    np.fill_diagonal(true, 0.0)
    true = true / np.maximum(true.sum(axis=1, keepdims=True), 1e-9)
    scores = right * true + (1.0 - right) / count
    scores = scores * np.exp(spread * rng.standard_normal(scores.shape))
    return affinity_from_scores(domain.names, scores, Origin("blurred taxonomy"))
