"""How few moves a search could have made that knows where everything stands.

It looks ahead as ours does, deeper and over more sequences, on the truth: what fails here has
hardly a way at all. It is a bound from above on the fewest moves, since beams are no proof.
"""

import numpy as np

from benchmarks.searching import SHOWN, Trial
from perception.shelf.planning.choosing import best_plan
from perception.shelf.planning.free_floor import CELL_M
from perception.shelf.planning.looking_ahead import ANYHOW, UNSEEN, Depth, Situation
from perception.shelf.planning.room import Reach, footprints
from perception.shelf.types import Box
from simulation.shelf.scenes import Scene
from simulation.shelf.world import ShelfWorld

DEEP = Depth(moves=5, beam=24)
MORE = (0.0, 0.1, 0.2)


def least_moves(scene: Scene, reach: Reach, enough: float = SHOWN) -> Trial:
    """Uncover so much of the target, knowing everything."""
    world = ShelfWorld(scene, np.random.default_rng(0), reach=reach)
    been: list[tuple[str, Box]] = []
    limit = 2 * len(scene.names)
    for actions in range(limit + 1):
        if world.visible_share(scene.target) >= enough:
            return Trial(True, actions)
        if actions == limit:
            break
        situation = _situation(world, scene, reach, been)
        # What is thought to show enough may fall short by some pixels.
        plans = (best_plan(situation, DEEP, enough + more) for more in MORE)
        plan = next((plan for plan in plans if plan is not None), None)
        if plan is None:
            return Trial(False, actions, stuck=True)
        move = plan.moves[0]
        been.append((move.label, world.boxes[move.label]))
        world.act(move)
    return Trial(False, limit)


def _situation(
    world: ShelfWorld, scene: Scene, reach: Reach, been: list[tuple[str, Box]]
) -> Situation:
    labels = tuple(name for name in scene.names if name != scene.target)
    target, seen = world.boxes[scene.target], set(world.look().labels)
    shelf = scene.shelf
    cells = (round(shelf.width_m / CELL_M), round(shelf.depth_m / CELL_M))
    return Situation(
        shelf=shelf,
        reach=reach,
        camera=world.camera,
        labels=labels,
        boxes=tuple(world.boxes[name] for name in labels),
        movable=np.array([ANYHOW if name in seen else UNSEEN for name in labels]),
        met=footprints([target]),
        floor=np.ones(cells, dtype=bool),
        cell_m=CELL_M,
        target_m=target.size_m,
        places_m=np.array([[target.x_m, target.y_m]]),
        weights=np.ones(1),
        been=been,
        before=been,
    )
