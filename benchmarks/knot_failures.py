"""Draw what a system believes about the scenes of `benchmarks.knots` that it gets wrong.

`python -m benchmarks.knot_failures --out FOLDER` writes one picture for each wrong answer. White
rings are where the first knot begins, as seen from either end.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.knot_judging import Failure, judged
from benchmarks.knot_scenes import TIERS, KnotScene, drawn, settled
from benchmarks.knots import DRAWN, SETTLED, systems
from perception.cable.draw import draw_scene
from perception.cable.types import CableScene

SOURCES = {"drawn": (drawn, DRAWN), "settled": (settled, SETTLED)}
WHITE = (255, 255, 255)


def main() -> None:
    """Look at scenes, and draw the wrong answers."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.knot_failures", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder for the pictures")
    parser.add_argument("--system", default="", help="end of its row's name; ours by default")
    parser.add_argument("--source", choices=SOURCES, default="drawn")
    parser.add_argument("--tiers", nargs="+", choices=TIERS, default=TIERS)
    parser.add_argument("--count", type=int, help="scenes a tier")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    known = systems()
    if chosen.system not in known:
        parser.error(f"--system: got {chosen.system!r}; known: {', '.join(known)}")
    system = known[chosen.system]
    source, usual = SOURCES[chosen.source]
    for tier in chosen.tiers:
        for number in range(chosen.count or usual):
            scene = source(tier, number, chosen.seed)
            seen = system(scene.image)
            failure = judged(scene, seen)
            name = f"{tier}_{number:02}_{scene.knot}"
            print(f"{name}: {_told(failure)}, P(knotted) {seen.knotted_probability:.3f}")
            if failure is not None:
                path = chosen.out / f"{name}_{failure.cause.name.lower()}.png"
                cv2.imwrite(str(path), picture(scene, seen, _told(failure)))


def _told(failure: Failure | None) -> str:
    return "right" if failure is None else f"{failure.wrong}, by {failure.cause}"


def picture(scene: KnotScene, seen: CableScene, title: str) -> NDArray[np.uint8]:
    """Return a scene as it was seen, in BGR, with the truth and a title."""
    canvas = cv2.cvtColor(draw_scene(scene.image, seen), cv2.COLOR_RGB2BGR)
    scale = canvas.shape[0] / scene.image.shape[0]
    for end_px in scene.nodes_px[[0, -1], :2]:
        for place_px in scene.undercrossings_from(end_px):
            x, y = np.rint(place_px * scale).astype(int).tolist()
            cv2.circle(canvas, (x, y), round(1.5 * scene.width_px * scale), WHITE, 2, cv2.LINE_AA)
    corner = (round(12 * scale), canvas.shape[0] - round(12 * scale))
    cv2.putText(canvas, title, corner, cv2.FONT_HERSHEY_SIMPLEX, 0.6 * scale, WHITE, 2, cv2.LINE_AA)
    return np.asarray(canvas, np.uint8)


if __name__ == "__main__":
    main()
