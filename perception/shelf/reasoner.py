"""What a search believes after each look and move, and what it does next."""

from collections import OrderedDict
from dataclasses import replace

import numpy as np

from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.affinity import AffinityMatrix
from perception.shelf.beliefs import OUT_OF_VIEW, Refusal, SeenObject, ShelfBelief
from perception.shelf.casting import BoxCaster
from perception.shelf.coarsening import coarser, coarser_camera
from perception.shelf.detections import Detections
from perception.shelf.drawing import drawn_belief
from perception.shelf.hidden_poses import HiddenPoses, PoseRules
from perception.shelf.interfaces import object_of
from perception.shelf.meeting import MISTAKEN, meeting, rescaled, still_refused, unexplained
from perception.shelf.organisation import organisation_of
from perception.shelf.planning.choosing import best_plan
from perception.shelf.planning.contacts import contact_of, push_sign
from perception.shelf.planning.exploring import RULES, THING_M
from perception.shelf.planning.free_floor import CELL_M, covered_cells, free_cells
from perception.shelf.planning.lifting import slip_chance
from perception.shelf.planning.looking_ahead import (
    ANYHOW,
    BY_CUP,
    BY_PUSH,
    FIXED,
    LEAST_FOUND,
    UNSEEN,
    Situation,
    look_ahead,
)
from perception.shelf.planning.moves import Move, Plan, moved_box
from perception.shelf.planning.outlook import COARSE, shares_shown
from perception.shelf.planning.room import WIDER_M, Reach, footprints
from perception.shelf.planning.tidying import tidying_move
from perception.shelf.planning.ways_out import freeing_move
from perception.shelf.refining import refined
from perception.shelf.semantic import floor_semantics
from perception.shelf.stock import Stock
from perception.shelf.tracking import Look, tracked
from perception.shelf.types import Bools, Box, Floats, ShelfView, Sighting, Size, stands_on

# So many cameras' rays and silhouettes are kept: they cost more than everything else.
KEPT = 16
# What comes off the cup with this probability is not asked of it.
TOO_HEAVY = 0.9
# How well the place is known of a target that was seen from another side, and only partly.
GLIMPSE_M = 0.02
# Distance of the places that are tried of a target of which a part shows.
PLACE_M = 0.01
# What is the target with this probability is worth moves that show more of it.
WORTH_A_MOVE = 0.2
# Of places that are less likely by this than the likeliest it is not asked what should show.
UNLIKELY = 1e-3
# However much of a target should have shown: it does when so much more does than this share.
BELIED = 0.6
# After these failures an object is not where it was, and must be looked for.
GONE = ("push.nothing_there", "suction.lost")
# After these the cup does not hold it: it is too heavy, or its face is not flat.
UNHELD = ("suction.missed", "suction.lost")
# After this one something stands beside it.
BLOCKED = "push.blocked"
# After these it cannot be moved that way from where it stands.
STUCK = (BLOCKED, "push.no_room_for_blade", "suction.obstructed")


class SearchReasoner:
    """`ShelfReasoning` on exact geometry, affinities and looking ahead.

    It keeps nothing but what follows from a camera's pose and a target's size.
    """

    def __init__(
        self,
        stock: Stock,
        affinity: AffinityMatrix,
        reach: Reach,
        camera: CameraModel,
        enough: float = 0.0,
    ) -> None:
        """Take what stays the same.

        Args:
            stock: The shelf and its products.
            affinity: Affinities between them.
            reach: What the tool needs.
            camera: The one at the viewpoint from which the search looks between moves.
            enough: The share of the target that is to show; by default it is enough to see it.
        """
        self._stock, self._affinity, self._reach = stock, affinity, reach
        self._camera, self._enough = coarser_camera(camera), enough
        self._casters: OrderedDict[bytes, BoxCaster] = OrderedDict()
        self._poses: OrderedDict[tuple[bytes, str], HiddenPoses] = OrderedDict()

    def share(self, target: str, poses: HiddenPoses) -> None:
        """Take poses of a target that were laid out before, for the camera that they were cast by.

        Args:
            target: Name of the target.
            poses: Its poses.
        """
        key = _key(poses.caster.camera)
        self._casters[key], self._poses[key, target] = poses.caster, poses

    def begin(self, target: str) -> ShelfBelief:
        """See `ShelfReasoning`."""
        size_m = self._stock.product(target).size_m
        self._affinity.row(target)
        places_m = self._hidden(self._camera, target).places_m
        shelf, count = self._stock.shelf, len(places_m)
        cells = free_cells_shape(shelf.width_m, shelf.depth_m)
        return ShelfBelief(
            target=target,
            target_m=size_m,
            objects=(),
            places_m=places_m,
            plausible=np.ones(count),
            weights=np.full(count, 1.0 / count),
            belied=np.zeros(count),
            organisation=0.5,
            unseen=np.ones(self._things(self._camera).count, dtype=bool),
            floor=np.zeros(cells, dtype=bool),
            met=np.zeros((0, 4)),
            been=(),
            refusals=(),
            picture=np.zeros((self._camera.height_px, self._camera.width_px, 3), dtype=np.uint8),
            looks=0,
        )

    def refine(self, detections: Detections) -> Detections:
        """See `ShelfReasoning`."""
        return refined(detections, self._affinity)

    def see(self, belief: ShelfBelief, frame: RgbdFrame, detections: Detections) -> ShelfBelief:
        """See `ShelfReasoning`."""
        frame, detections = coarser(frame, detections)
        caster = self._caster(frame.camera)
        numbers = tuple(f"{number}" for number in range(detections.count))
        view = ShelfView(frame.depth_m, detections.segments, numbers, frame.camera)
        objects = tracked(Look(view, detections, caster), belief.objects, self._stock)
        poses = self._hidden(frame.camera, belief.target)
        others = _others(objects, detections, belief.target)
        possible = poses.feasible(view, others)
        plausible = np.where(possible, belief.plausible, belief.plausible * MISTAKEN)
        seen = replace(
            belief,
            objects=objects,
            plausible=np.maximum(plausible, MISTAKEN**2),
            unseen=belief.unseen & self._things(frame.camera).feasible(view, others),
            floor=self._floor(belief, view, caster, objects),
            looks=belief.looks + 1,
        )
        seen = self._weighted(replace(seen, met=unexplained(seen)), possible)
        seen = replace(seen, belied=np.maximum(seen.belied, _belied(seen, frame.camera)))
        heat = poses.heat(seen.weights)
        picture = drawn_belief(frame.colour, detections.segments, heat, seen.objects, belief.target)
        return replace(seen, picture=picture)

    def choose(self, belief: ShelfBelief) -> Plan | None:
        """See `ShelfReasoning`."""
        # Something that was taken for the target may be something else that hides it.
        situation = self._situation(self.removed(belief, belief.target))
        return self._nearer_look(belief) or best_plan(situation, enough=self._enough)

    def clear_way(self, belief: ShelfBelief, label: str, wider_m: float = WIDER_M) -> Move | None:
        """See `ShelfReasoning`."""
        return freeing_move(self._situation(belief, staying=label), label, wider_m)

    def restore(self, belief: ShelfBelief) -> Move | None:
        """See `ShelfReasoning`."""
        return tidying_move(self._situation(belief), belief.first)

    def moved(self, belief: ShelfBelief, label: str, box: Box, met: Floats) -> ShelfBelief:
        """See `ShelfReasoning`."""
        before = object_of(belief, label)
        if before is None:
            return meeting(belief, met, felt=True)
        objects = _after_move(belief.objects, before, box)
        moved = replace(
            belief,
            objects=objects,
            been=(*belief.been, (label, before.box)),
            refusals=still_refused(belief.refusals, before.box, box),
        )
        if before.box.y_m == box.y_m:
            moved = self._swept(moved, before.box, box)
        return meeting(moved, met, felt=True)

    def refused(self, belief: ShelfBelief, move: Move, failure: str) -> ShelfBelief:
        """See `ShelfReasoning`."""
        thing = object_of(belief, move.label)
        if thing is None:
            return belief
        if failure in UNHELD + STUCK:
            refusal = Refusal(move.label, thing.box, push_sign(move), failure in UNHELD)
            belief = replace(belief, refusals=(*belief.refusals, refusal))
        if failure in GONE:
            return self.removed(belief, move.label)
        tried = (move.label, moved_box(move, thing.box))
        belief = replace(belief, been=(*belief.been, tried))
        if failure in UNHELD:
            return belief
        met = contact_of(move, thing.box, failure)[None]
        return meeting(belief, met, felt=failure == BLOCKED)

    def removed(self, belief: ShelfBelief, label: str) -> ShelfBelief:
        """See `ShelfReasoning`."""
        return replace(belief, objects=tuple(one for one in belief.objects if one.label != label))

    def _nearer_look(self, belief: ShelfBelief) -> Plan | None:
        """Return what shows more of a thing that may be the target; None where there is none."""
        found = belief.found
        if found is None or found.certainty < WORTH_A_MOVE:
            return None
        plan = self._uncovering(belief, found)
        if plan is not None:
            return plan
        move = self.clear_way(belief, belief.target)
        if move is None:
            return None
        return Plan((move,), found.certainty, 1.0 / found.certainty, found.certainty)

    def _uncovering(self, belief: ShelfBelief, found: SeenObject) -> Plan | None:
        """Return what shows enough of a thing that is seen; None where nothing short does."""
        others = self._situation(self.removed(belief, belief.target))
        places_m = _may_stand(found)
        situation = replace(
            others,
            met=np.vstack([others.met, footprints([found.sure])]),
            target_m=found.box.size_m,
            places_m=places_m,
            weights=np.full(len(places_m), 1.0 / len(places_m)),
            belied=np.zeros(0),
        )
        plan = look_ahead(situation, grain=COARSE.showing(self._enough))
        return plan if plan is not None and plan.finds > LEAST_FOUND else None

    def _swept(self, belief: ShelfBelief, start: Box, end: Box) -> ShelfBelief:
        """Return what is believed after a push: what was pushed through holds nothing."""
        width_m, depth_m, height_m = start.size_m
        middle_m, wide_m = 0.5 * (start.x_m + end.x_m), abs(end.x_m - start.x_m)
        swept = Box(middle_m, start.y_m, (width_m + wide_m, depth_m, height_m))
        taken = self._hidden(self._camera, belief.target).overlaps(swept)
        return replace(
            belief,
            plausible=rescaled(np.where(taken, MISTAKEN, 1.0) * belief.plausible),
            unseen=belief.unseen & ~self._things(self._camera).overlaps(swept),
        )

    def _situation(self, belief: ShelfBelief, staying: str = "") -> Situation:
        fixed = {belief.target, staying}
        return Situation(
            shelf=self._stock.shelf,
            reach=self._reach,
            camera=self._camera,
            labels=tuple(one.label for one in belief.objects),
            boxes=tuple(one.box for one in belief.objects),
            movable=np.array(
                [
                    FIXED if one.label in fixed else self._movable(belief, one)
                    for one in belief.objects
                ],
                dtype=np.int64,
            ),
            met=belief.met,
            floor=belief.floor,
            cell_m=CELL_M,
            target_m=belief.target_m,
            places_m=belief.places_m,
            weights=belief.weights,
            belied=belief.belied,
            been=belief.been,
            before=belief.been,
            unseen_m=self._things(self._camera).places_m[belief.unseen],
            barred=tuple((one.label, one.sign) for one in belief.refusals if one.sign),
        )

    def _movable(self, belief: ShelfBelief, one: SeenObject) -> int:
        if self._reach.by_sight and one.number == OUT_OF_VIEW:
            return UNSEEN
        unheld = any(each.label == one.label and not each.sign for each in belief.refusals)
        heavy = slip_chance(one.box.size_m, self._reach) > TOO_HEAVY
        if one.box.bottom_m > 0.0:
            return FIXED if unheld or heavy else BY_CUP
        return BY_PUSH if unheld or heavy else ANYHOW

    def _weighted(self, belief: ShelfBelief, possible: Bools) -> ShelfBelief:
        """Weigh the poses that are possible now by semantics, as far as the shelf is in order."""
        first = belief.first
        organisation = organisation_of(first, self._affinity)
        mixed = self._affinity.mixed(organisation)
        weights = belief.plausible * np.where(possible, 1.0, MISTAKEN**2)
        weights = (
            weights
            * _glimpsed(belief)
            * floor_semantics(belief.places_m, first, mixed, belief.target)
        )
        return replace(belief, weights=weights / weights.sum(), organisation=organisation)

    def _floor(
        self,
        belief: ShelfBelief,
        view: ShelfView,
        caster: BoxCaster,
        objects: tuple[SeenObject, ...],
    ) -> Bools:
        """Return which cells of the floor are known to be free, by this look or an earlier one."""
        free = belief.floor | free_cells(view, self._stock.shelf, caster)
        for row in footprints([one.box for one in objects]):
            free = free & ~covered_cells(row, self._stock.shelf)
        return free

    def _caster(self, camera: CameraModel) -> BoxCaster:
        key = _key(camera)
        if key not in self._casters:
            self._casters[key] = BoxCaster(camera)
            if len(self._casters) > KEPT:
                self._casters.popitem(last=False)
        return self._casters[key]

    def _hidden(self, camera: CameraModel, target: str) -> HiddenPoses:
        return self._laid_out(camera, target, self._stock.product(target).size_m)

    def _things(self, camera: CameraModel) -> HiddenPoses:
        """Return the poses of a small thing that may be anywhere."""
        return self._laid_out(camera, "", THING_M, RULES)

    def _laid_out(
        self, camera: CameraModel, name: str, size_m: Size, rules: PoseRules | None = None
    ) -> HiddenPoses:
        key = (_key(camera), name)
        if key not in self._poses:
            caster = self._caster(camera)
            self._poses[key] = HiddenPoses(size_m, self._stock.shelf, caster, rules)
            if len(self._poses) > KEPT:
                self._poses.popitem(last=False)
        return self._poses[key]


def _after_move(
    objects: tuple[SeenObject, ...], moved: SeenObject, box: Box
) -> tuple[SeenObject, ...]:
    """Return objects after a move of one of them: what stands on it goes along."""
    x_m, y_m = box.x_m - moved.box.x_m, box.y_m - moved.box.y_m
    return tuple(
        _stood(one, box) if one.label == moved.label
        else _stood(one, one.box.at(one.box.x_m + x_m, one.box.y_m + y_m))
        if stands_on(one.box, moved.box)
        else one
        for one in objects
    )  # fmt: skip


def _stood(one: SeenObject, box: Box) -> SeenObject:
    """Return an object where it stands after a move; what is sure of it has moved as far."""
    x_m, y_m = one.sure.x_m + box.x_m - one.box.x_m, one.sure.y_m + box.y_m - one.box.y_m
    sure = replace(one.sure, x_m=x_m, y_m=y_m, bottom_m=box.bottom_m)
    return replace(one, box=box, sure=sure)


def _may_stand(found: SeenObject) -> Floats:
    """Return places of a thing, shape (K, 2): as far as its box is loose by the part that shows."""
    spans_m = [
        middle_m + np.linspace(-loose_m, loose_m, 1 + round(2.0 * loose_m / PLACE_M))
        if loose_m > PLACE_M
        else np.array([middle_m])
        for middle_m, loose_m in zip((found.box.x_m, found.box.y_m), found.loose_m, strict=True)
    ]
    return np.stack(np.meshgrid(*spans_m, indexing="ij"), axis=-1).reshape(-1, 2)


def _glimpsed(belief: ShelfBelief) -> Floats:
    """Return how likely each place is by a sight of the target from another side, shape (K,)."""
    found = belief.found
    if found is None:
        return np.ones(len(belief.places_m))
    apart_m = np.linalg.norm(belief.places_m - (found.box.x_m, found.box.y_m), axis=1)
    near = np.exp(-0.5 * (apart_m / GLIMPSE_M) ** 2)
    mixed: Floats = found.certainty * near + (1.0 - found.certainty) * MISTAKEN
    return mixed


def _belied(belief: ShelfBelief, camera: CameraModel) -> Floats:
    """Return the share of its face that a target in each cell should show, and does not."""
    shares, found = np.zeros(len(belief.places_m)), belief.found
    if found is not None and found.number != OUT_OF_VIEW:
        return shares
    likely = belief.weights > UNLIKELY * belief.weights.max()
    boxes = [one.box for one in belief.objects if one.label != belief.target]
    shares[likely] = shares_shown(belief.places_m[likely], belief.target_m, boxes, camera)
    return np.minimum(shares, BELIED)


def free_cells_shape(width_m: float, depth_m: float) -> tuple[int, int]:
    """Return how many cells of the floor there are along x and y."""
    return (
        len(np.arange(0.5 * CELL_M, width_m, CELL_M)),
        len(np.arange(0.5 * CELL_M, depth_m, CELL_M)),
    )


def _others(
    objects: tuple[SeenObject, ...], detections: Detections, target: str
) -> tuple[Sighting, ...]:
    """Return what is known to stand where the target can then not be."""
    nothing = np.zeros(detections.segments.shape, dtype=bool)
    return tuple(
        Sighting(one.label, nothing, one.box, one.sure) for one in objects if one.label != target
    )


def _key(camera: CameraModel) -> bytes:
    numbers = [camera.width_px, camera.height_px, camera.focal_px, *camera.centre_px]
    return np.concatenate([np.array(numbers), camera.T_world_camera.ravel()]).tobytes()
