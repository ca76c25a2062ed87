"""How much an image tells of over and under, and looks that are drawn for it."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.crossing_cues import cues, cues_of, noise_of, swapped
from benchmarks.knot_scenes import as_in_thesis
from perception.training.looks import Lens, draw_look
from perception.training.render import render
from perception.training.scenes import Laid, SceneConfig, lay, seen_lines, shoot


def _laid(seed: int) -> tuple[np.random.Generator, Laid]:
    rng, config = np.random.default_rng([77, seed]), SceneConfig(family="random", cables=1)
    return rng, lay(rng, seen_lines(rng, config), config)


def test_swapped_strands_have_changed_places_at_their_crossing():
    rng, laid = _laid(3)
    crossing = shoot(deepcopy(rng), laid)[0].crossings[0]
    nodes, number = swapped(laid, crossing).nodes, np.arange(len(laid.nodes))
    upper, lower = crossing.over[1], crossing.under[1]
    before = np.interp([upper, lower], number, laid.nodes[:, 2])
    assert np.interp([lower, upper], number, nodes[:, 2]) == pytest.approx(before, abs=0.05)
    assert (nodes[:, :2] == laid.nodes[:, :2]).all()


def test_flat_strands_of_one_grey_tell_nothing_and_others_do():
    rng, laid = _laid(3)
    flat = draw_look(np.random.default_rng(1), 1, style="plain")
    cable = replace(flat.cables[0], flank=0.0, outline=0.0, stripe=1.0)
    told = []
    for seen in (cable, replace(cable, outline=0.8)):
        look = replace(flat, cables=(seen,), connectors=False)
        plain = replace(laid, look=look)
        told.append(max(cues_of(rng, plain)))
    assert told[0] == 0.0
    assert told[1] > 10.0


def test_noise_is_what_the_camera_adds():
    _, laid = _laid(4)
    quiet, loud = (
        replace(laid, look=replace(laid.look, lens=Lens(noise=noise))) for noise in (0.0, 6.0)
    )
    assert noise_of(quiet) < 0.5
    assert noise_of(loud) == pytest.approx(6.0, rel=0.1) or noise_of(loud) > 6.0


def test_cues_are_the_same_each_time():
    assert list(cues(7, 2)) == list(cues(7, 2))


def test_the_thesis_s_look_is_one_white_cable_on_dark_cloth():
    scene = as_in_thesis("A1", 0, 41)
    columns, rows = np.rint(scene.nodes_px[20:-20, :2]).astype(int).T
    assert np.median(scene.image[rows, columns]) > 150.0
    assert np.median(scene.image) < 90.0
    assert (as_in_thesis("A1", 0, 41).image == scene.image).all()


def test_faceted_cables_are_brighter_where_they_face_the_light():
    rng = np.random.default_rng(0)
    look = draw_look(rng, 1, bright=True, style="faceted", alike=True)
    cable = replace(look.cables[0], brightness=200.0, facing=0.7, facets=0, gloss=0.0, bead=0.0)
    cable = replace(cable, stripe=1.0)
    table = replace(look.table, level=20.0, cable=200.0, chequered=False, clutter=0)
    light = replace(look.light, light_rad=0.0, slant=1.5, shadow=0.0)
    look = replace(look, cables=(cable,), table=table, light=light, lens=Lens(), connectors=False)
    strand = np.column_stack([np.full(60, 60.0), np.linspace(10.0, 110.0, 60), np.full(60, 10.0)])
    image = render(rng, [strand], 20.0, (120, 120), look)[0][0].astype(float)
    # Shadows would fall towards +x, so the light comes from -x.
    assert image[60, 53:57].mean() > image[60, 64:68].mean() + 20.0
