"""Domains: what ships is what the thesis counts, and what cannot be read is refused."""

import numpy as np
import pytest

from executive.core.errors import InputError
from simulation.shelf.taxonomy import (
    DOMAINS,
    known_domains,
    read_domain,
    shipped_domain,
    taxonomy_affinity,
)

# Section 7.1 of the thesis.
PHARMACY = {
    "supplements": "vitamins, fish oil, omega-3, calcium, probiotics, protein powder, COQ10, "
    "anthocyanin",
    "hair care": "shampoo, conditioner",
    "oral care": "toothpaste, toothbrush, dental floss",
    "cosmetics": "face wash, sunscreen, lotion, hand cream, body wash",
    "medication": "aspirin, tylenol, ibuprofen, advil, pain relief",
    "": "shaving cream, eye drops, deodorant, band-aid",
}
# Section 7.2 counts them.
COUNTS = {"pharmacy": 27, "kitchen": 24, "office": 40}


def test_the_pharmacy_is_the_thesis_s():
    found = {}
    for thing in shipped_domain("pharmacy").objects:
        found.setdefault("".join(thing.category), []).append(thing.name)
    assert {key: ", ".join(names) for key, names in found.items()} == PHARMACY


def test_all_domains_have_the_thesis_s_counts():
    assert {name: len(shipped_domain(name).objects) for name in known_domains()} == COUNTS


@pytest.mark.parametrize("name", COUNTS)
def test_sizes_come_from_the_ranges_and_fit_into_the_shelf(name):
    domain, rng = shipped_domain(name), np.random.default_rng(0)
    for thing in domain.objects:
        drawn = np.array([thing.draw_size(domain.scale, rng) for _ in range(20)])
        ranges = domain.scale * np.array([thing.width_m, thing.depth_m, thing.height_m])
        assert (drawn >= ranges[:, 0]).all()
        assert (drawn <= ranges[:, 1]).all()
        # Section 5.2 bounds sizes by 5 and 25 cm; scaled as in section 7.2 the lower one shrinks.
        assert (drawn <= 0.25).all()
        assert (drawn >= 0.034).all()


def test_the_even_matrix_is_as_far_from_the_taxonomy_as_the_thesis_prints():
    """Table 7.1 has 0.65: the divergence in bits, diagonal kept, outliers on themselves."""
    true = taxonomy_affinity(shipped_domain("pharmacy"))
    even = np.full_like(true, 1.0 / len(true))
    middle = 0.5 * (true + even)

    def relative(p, q):
        return np.where(p > 0.0, p * np.log2(np.maximum(p, 1e-300) / q), 0.0).sum(axis=1)

    divergence = 0.5 * relative(true, middle) + 0.5 * relative(even, middle)
    assert round(float(divergence.mean()), 2) == 0.65


@pytest.mark.parametrize("name", COUNTS)
def test_taxonomy_affinities_are_even_within_blocks(name):
    rows = taxonomy_affinity(shipped_domain(name))
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    np.testing.assert_allclose(rows, rows.T)
    np.testing.assert_allclose(rows @ rows, rows, atol=1e-12)


OBJECT = "{name: a, width_m: [0.1, 0.2], depth_m: [0.1, 0.2], height_m: [0.1, 0.2]}"


@pytest.mark.parametrize(
    ("objects", "words"),
    [
        (f"[{OBJECT}, {OBJECT}]", "got a twice"),
        (f"[{OBJECT}]", "at least 2"),
        (f"[{OBJECT}, {OBJECT.replace('a,', 'b,').replace('[0.1', '[0.3', 1)}]", "low <= high"),
        (f"[{OBJECT}, {OBJECT.replace('a,', 'b, weight_kg: 1,')}]", "weight_kg"),
        ("[", "not a domain"),
    ],
)
def test_what_is_no_domain_is_refused(tmp_path, objects, words):
    path = tmp_path / "shed.yaml"
    path.write_text(f"format: 1\ndomain: shed\nabout: x\nscale: 0.5\nobjects: {objects}\n")
    with pytest.raises(InputError, match=words):
        read_domain(path)


def test_an_unknown_domain_is_answered_with_the_closest():
    with pytest.raises(InputError, match="did you mean 'pharmacy'"):
        shipped_domain("farmacy")
    with pytest.raises(InputError, match="cannot be read"):
        read_domain(DOMAINS / "none.yaml")
