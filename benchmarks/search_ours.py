"""Searches by the mission's own reasoner, without a tree; detection is perfect.

Names are told by the world, and the target counts as found when 1 % of it shows, as in
`benchmarks.searching`.
"""

import numpy as np

from benchmarks.searching import SHORT_M, SHOWN, SearchedShelf, Trial, search
from perception.rgbd import RgbdFrame
from perception.shelf.affinity import AffinityMatrix, Origin, affinity_from_scores, even_rows
from perception.shelf.detections import Detections
from perception.shelf.hidden_poses import HiddenPoses
from perception.shelf.planning.contacts import contact_beside, push_sign
from perception.shelf.planning.moves import Move, Place
from perception.shelf.planning.room import Reach
from perception.shelf.reasoner import SearchReasoner
from perception.shelf.stock import Product, Stock
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import MoveResult
from simulation.shelf.scenes import Scene
from simulation.shelf.world import ShelfWorld


class OurSearcher:
    """Ours: the mission's own reasoner, told by the world what each pixel shows."""

    def __init__(
        self,
        scene: Scene,
        affinity: AffinityMatrix | None,
        reach: Reach,
        world: SearchedShelf | None = None,
        poses: HiddenPoses | None = None,
        enough: float = SHOWN,
    ) -> None:
        """Begin before the first look.

        Args:
            scene: What is searched.
            affinity: Semantics, or None for none.
            reach: What the tool can do.
            world: What is looked into and acted on; None for one without physics.
            poses: Of the scene's target, which searches may share.
            enough: The share of the target that has to show.
        """
        self.target, self.enough = scene.target, enough
        self.world = world or ShelfWorld(scene, np.random.default_rng(0), reach=reach)
        camera = front_camera(scene.shelf)
        boxes = zip(scene.names, scene.boxes, strict=True)
        products = tuple(Product(name, box.size_m, (0, 0, 0)) for name, box in boxes)
        stock = Stock("", scene.shelf, products)
        affinity = affinity or affinity_from_scores(
            scene.names, even_rows(len(scene.names)), Origin("even")
        )
        self.reasoner = SearchReasoner(stock, affinity, reach, camera, enough)
        if poses is not None:
            self.reasoner.share(scene.target, poses)
        self.belief = self.reasoner.begin(scene.target)
        self._black = np.zeros((camera.height_px, camera.width_px, 3), dtype=np.uint8)
        self._names = scene.names

    def shows(self) -> bool:
        """Ask the world whether the target counts as found."""
        return self.world.visible_share(self.target) >= self.enough

    def look(self) -> None:
        """Look, and take in what is seen."""
        view, names = self.world.look(), self._names
        frame = RgbdFrame(self._black, view.depth_m, 0.0, view.camera)
        rows = np.array([[float(name == label) for name in names] for label in view.labels])
        detections = Detections(view.segments, names, rows.reshape(-1, len(names)))
        self.belief = self.reasoner.see(self.belief, frame, detections)

    def choose(self) -> Move | None:
        """Choose the next move."""
        plan = self.reasoner.choose(self.belief)
        return None if plan is None else plan.moves[0]

    def act(self, move: Move) -> MoveResult:
        """Act, and take in what was felt."""
        result, box = self.world.act(move), self.belief.boxes[move.label]
        if result.failure is not None:
            self.belief = self.reasoner.refused(self.belief, move, result.failure.value)
            return result
        sign, met = push_sign(move), np.zeros((0, 4))
        after = box.at(box.x_m + sign * result.moved_m, box.y_m)
        if isinstance(move, Place):
            after = box.on_floor(move.x_m, move.y_m)
        elif result.short_m > SHORT_M:
            met = contact_beside(after, sign)[None]
        self.belief = self.reasoner.moved(self.belief, move.label, after, met)
        return result


def search_ours(
    scene: Scene,
    affinity: AffinityMatrix | None,
    reach: Reach,
    poses: HiddenPoses | None = None,
) -> Trial:
    """Search with at most 2 N actions (thesis, section 5.2)."""
    return search(OurSearcher(scene, affinity, reach, poses=poses), 2 * len(scene.names))
