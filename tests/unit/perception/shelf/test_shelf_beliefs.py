"""What is read, tracked and believed, look by look and move by move."""

from dataclasses import replace

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.rgbd import RgbdFrame
from perception.shelf.affinity import Origin, affinity_from_scores, even_rows
from perception.shelf.colour_codes import ColourCodeDetector
from perception.shelf.detections import Detections, entropy_bits
from perception.shelf.interfaces import ShelfReasoning, object_of
from perception.shelf.planning.contacts import contact_beside, contact_of
from perception.shelf.planning.moves import Place, Push
from perception.shelf.planning.room import Reach
from perception.shelf.reasoner import SearchReasoner
from perception.shelf.refining import refined
from perception.shelf.stock import Product, Stock
from perception.shelf.tracking import unique_names
from perception.shelf.types import NOTHING, Box, Shelf
from simulation.shelf.cameras import front_camera, viewpoint_cameras
from simulation.shelf.picturing import SensorNoise, ShelfPicturer
from simulation.shelf.scenes import SceneRules, draw_scene
from simulation.shelf.stocking import stock_of
from simulation.shelf.taxonomy import shipped_domain

SHELF = Shelf()
FRONT = front_camera(SHELF)
COLOURS = {"tea": (220, 40, 40), "salt": (40, 200, 60), "rice": (50, 60, 220)}
SIZES = {"tea": (0.2, 0.06, 0.15), "salt": (0.06, 0.06, 0.1), "rice": (0.1, 0.08, 0.14)}
STOCK = Stock(
    "", SHELF, tuple(Product(name, SIZES[name], COLOURS[name]) for name in COLOURS), "salt"
)
BOXES = {"tea": Box(0.4, 0.1, SIZES["tea"]), "salt": Box(0.4, 0.25, SIZES["salt"]),
         "rice": Box(0.65, 0.2, SIZES["rice"])}  # fmt: skip


def frame(boxes, noise=SensorNoise(), camera=FRONT, seed=0):  # noqa: B008 - frozen
    picturer = ShelfPicturer(SHELF, COLOURS, noise, np.random.default_rng(seed))
    return picturer.picture(boxes, camera, 0.0, "centre")


def reasoner(stock=STOCK):
    even = affinity_from_scores(stock.names, even_rows(len(stock.names)), Origin("even"))
    return SearchReasoner(stock, even, Reach(), FRONT)


def after_look(search, belief, boxes, **how):
    look = frame(boxes, **how)
    return search.see(belief, look, ColourCodeDetector(STOCK).detect(look))


@pytest.fixture(scope="module")
def search():
    return reasoner()


@pytest.fixture(scope="module")
def looked(search):
    return after_look(search, search.begin("salt"), BOXES)


def test_boxes_are_found_and_named_by_their_colours():
    found = ColourCodeDetector(STOCK).detect(frame(BOXES))
    names = [STOCK.names[row.argmax()] for row in found.probabilities]
    assert sorted(names) == ["rice", "tea"]
    assert (found.probabilities.max(axis=1) > 0.9).all()


def test_a_box_of_a_colour_that_nobody_knows_has_no_name():
    colours = {**COLOURS, "tea": (200, 200, 40)}
    picturer = ShelfPicturer(SHELF, colours, SensorNoise(), np.random.default_rng(0))
    found = ColourCodeDetector(STOCK).detect(picturer.picture(BOXES, FRONT, 0.0, ""))
    strange = found.probabilities.sum(axis=1) < 0.3
    assert strange.sum() == 1


def test_few_pixels_are_read_with_more_doubt():
    small = front_camera(SHELF, width_px=40)
    rows = [
        ColourCodeDetector(STOCK).detect(frame(BOXES, camera=camera)).probabilities
        for camera in (FRONT, small)
    ]
    assert entropy_bits(rows[1]).max() > entropy_bits(rows[0]).max()


def test_no_two_objects_have_one_name():
    rows = np.array([[0.6, 0.3], [0.9, 0.05], [0.5, 0.4]])
    assert sorted(unique_names(rows, ("tea", "salt")))[:1] == ["salt"]
    assert len(set(unique_names(rows, ("tea", "salt")))) == 3


def test_an_unsure_reading_leans_to_what_its_neighbour_goes_with():
    scores = np.array([[0.0, 9.0, 1.0], [9.0, 0.0, 1.0], [1.0, 1.0, 0.0]])
    affinity = affinity_from_scores(("tea", "salt", "rice"), scores, Origin("made up"))
    segments = np.full((10, 20), NOTHING, dtype=np.int16)
    segments[2:8, 2:6], segments[2:8, 8:12] = 0, 1
    rows = np.array([[0.98, 0.01, 0.01], [0.02, 0.49, 0.49]])
    sharper = refined(Detections(segments, ("tea", "salt", "rice"), rows), affinity)
    assert np.allclose(sharper.probabilities[0], rows[0])
    assert sharper.probabilities[1, 1] > 0.6
    assert sharper.probabilities[1].sum() == pytest.approx(rows[1].sum())


def test_it_is_a_reasoner(search):
    assert isinstance(search, ShelfReasoning)
    with pytest.raises(InputError, match="salt"):
        search.begin("sallt")


def test_a_look_finds_objects_and_leaves_the_target_where_it_stands(looked):
    assert {one.label for one in looked.objects} == {"tea", "rice"}
    for one in looked.objects:
        assert one.box.x_m == pytest.approx(BOXES[one.label].x_m, abs=0.015)
        assert one.box.y_m == pytest.approx(BOXES[one.label].y_m, abs=0.015)
    assert looked.weights.sum() == pytest.approx(1.0)
    behind = np.abs(looked.places_m - (0.4, 0.25)).max(axis=1) < 0.03
    before = looked.places_m[:, 1] < 0.1
    assert looked.weights[behind].sum() > 10.0 * looked.weights[before].sum()


@pytest.mark.parametrize("seed", range(5))
def test_looks_from_all_sides_never_rule_out_where_a_hidden_target_stands(seed):
    scene = draw_scene(
        shipped_domain("kitchen"), SceneRules(count=12), np.random.default_rng(40 + seed)
    )
    stock = stock_of(shipped_domain("kitchen"), scene)
    search = reasoner(stock)
    belief = search.begin(scene.target)
    boxes = dict(zip(scene.names, scene.boxes, strict=True))
    colours = {product.name: product.colour for product in stock.products}
    picturer = ShelfPicturer(SHELF, colours, SensorNoise(), np.random.default_rng(seed))
    true = boxes[scene.target]
    for name, camera in viewpoint_cameras(SHELF, FRONT).items():
        if picturer.visible_share(boxes, scene.target, camera) == 0.0:
            look = picturer.picture(boxes, camera, 0.0, name)
            belief = search.see(belief, look, ColourCodeDetector(stock).detect(look))
    here = np.abs(belief.places_m - (true.x_m, true.y_m)).sum(axis=1).argmin()
    assert belief.plausible[here] > 0.1


def test_the_target_in_view_is_found(search, looked):
    moved = {**BOXES, "tea": BOXES["tea"].at(0.2, 0.1)}
    belief = search.moved(looked, "tea", moved["tea"], np.zeros((0, 4)))
    belief = after_look(search, belief, moved)
    assert belief.found is not None
    assert belief.found.box.x_m == pytest.approx(0.4, abs=0.015)
    assert object_of(belief, "tea").first.x_m == pytest.approx(0.4, abs=0.015)
    assert search.removed(belief, "salt").found is None


def test_what_is_out_of_view_is_remembered_until_its_place_is_seen_to_be_free(search, looked):
    behind = {**BOXES, "rice": BOXES["rice"].at(0.4, 0.3)}
    hidden = replace(looked, objects=tuple(
        replace(one, box=behind["rice"], sure=behind["rice"]) if one.label == "rice" else one
        for one in looked.objects))  # fmt: skip
    assert object_of(after_look(search, hidden, behind), "rice") is not None
    gone = {name: box for name, box in BOXES.items() if name != "rice"}
    assert object_of(after_look(search, looked, gone), "rice") is None


def test_where_an_object_was_pushed_along_the_target_is_not(search, looked):
    rice = object_of(looked, "rice").box
    pushed = search.moved(looked, "rice", rice.at(rice.x_m - 0.1, rice.y_m), np.zeros((0, 4)))
    way = np.abs(looked.places_m - (rice.x_m - 0.05, rice.y_m)).max(axis=1) < 0.01
    assert (pushed.plausible[way] < 0.01).all()


def test_what_a_push_has_met_is_remembered_until_that_is_seen(search, looked):
    rice = object_of(looked, "rice")
    beside = contact_beside(rice.box, -1)
    met = search.moved(looked, "rice", rice.box, beside[None])
    for _ in range(6):
        met = search.moved(met, "tea", BOXES["tea"], np.zeros((0, 4)))
    assert len(met.met) == 1
    # A look that shows free floor there.
    assert len(after_look(search, met, BOXES).met) == 0
    # What stands behind other things stays, until something is known to begin there.
    behind = replace(met, met=contact_beside(Box(0.4, 0.25, (0.02, 0.02, 0.1)), 1)[None])
    assert len(after_look(search, behind, BOXES).met) == 1


def test_what_may_be_the_target_is_uncovered_first(search, looked):
    half_open = {**BOXES, "tea": BOXES["tea"].at(0.52, 0.1)}
    belief = search.moved(looked, "tea", half_open["tea"], np.zeros((0, 4)))
    belief = after_look(search, belief, half_open)
    unsure = replace(belief, objects=tuple(
        replace(one, certainty=0.5) if one.label == "salt" else one for one in belief.objects
    ))  # fmt: skip
    plan = search.choose(unsure)
    assert plan.moves[0].label == "tea"
    assert plan.shows == 0.5


def test_a_sliver_does_not_move_what_was_seen_whole(search, looked):
    before = {**BOXES, "rice": BOXES["rice"].at(0.4, 0.03), "tea": BOXES["tea"].at(0.4, 0.2)}
    whole = {**before, "rice": BOXES["rice"].at(0.7, 0.03)}
    belief = after_look(search, search.begin("salt"), whole)
    tea = object_of(belief, "tea")
    for x_m in (0.4, 0.34, 0.46):
        hidden = {**before, "rice": Box(x_m, 0.03, (0.22, 0.08, 0.25))}
        belief = after_look(search, belief, hidden)
        assert object_of(belief, "tea").box.x_m == pytest.approx(tea.box.x_m, abs=0.01)
        assert object_of(belief, "tea").box.y_m == pytest.approx(tea.box.y_m, abs=0.01)


def test_a_move_that_failed_is_not_chosen_again(search, looked):
    first = search.choose(looked).moves[0]
    failure = "push.blocked" if isinstance(first, Push) else "suction.no_place"
    assert search.choose(search.refused(looked, first, failure)).moves[0] != first
    assert object_of(search.refused(looked, first, "suction.lost"), first.label) is None


def test_what_the_cup_has_let_go_of_is_pushed(search, looked):
    missed = search.refused(looked, Place("tea", 0.15, 0.1), "suction.missed")
    for _ in range(4):
        move = search.choose(missed).moves[0]
        assert isinstance(move, Push) or move.label != "tea"
        missed = search.refused(missed, move, "motion.no_path")


def test_a_push_without_room_is_tried_again_when_a_neighbour_has_moved(search, looked):
    refused = search.refused(looked, Push("tea", 0.1), "push.no_room_for_blade")
    assert [(one.label, one.sign) for one in refused.refusals] == [("tea", 1)]
    rice = looked.boxes["rice"]
    far = search.moved(refused, "rice", rice.at(rice.x_m + 0.02, rice.y_m), np.zeros((0, 4)))
    assert far.refusals == refused.refusals
    near = search.moved(refused, "rice", rice.at(0.56, rice.y_m), np.zeros((0, 4)))
    assert not near.refusals


def test_order_is_restored_by_the_way_back(search, looked):
    tea = object_of(looked, "tea")
    away = search.moved(looked, "tea", tea.box.at(0.2, tea.box.y_m), np.zeros((0, 4)))
    move = search.restore(away)
    assert move.label == "tea"
    assert isinstance(move, Place) or move.shift_m == pytest.approx(0.2, abs=0.01)
    assert search.restore(looked) is None


def test_contacts_lie_where_moves_failed():
    box = BOXES["rice"]
    right, left = 0.7, 0.6
    assert contact_of(Push("rice", 0.1), box, "push.blocked")[0] == pytest.approx(right)
    assert contact_of(Push("rice", 0.1), box, "push.no_room_for_blade")[2] == pytest.approx(left)
    assert contact_of(Place("rice", 0.2, 0.2), box, "suction.no_place")[0] == pytest.approx(0.15)
    assert contact_of(Place("rice", 0.2, 0.2), box, "suction.missed")[3] == pytest.approx(0.16)


def test_a_frame_without_depth_rules_nothing_out(search):
    blind = frame(BOXES, SensorNoise(lost_share=1.0))
    nothing = Detections(
        np.full(blind.depth_m.shape, NOTHING, dtype=np.int16), STOCK.names, np.zeros((0, 3))
    )
    dark = RgbdFrame(blind.colour, blind.depth_m, 0.0, FRONT)
    assert (search.see(search.begin("salt"), dark, nothing).plausible == 1.0).all()
