"""The README's picture: first and last camera image of a run, with what is believed drawn over.

python -m benchmarks.picture runs/demo.mcap docs/images/untangle.png
"""

import io
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from executive.app.compose import ROWS_OF_ARMS_AT_HOME, cable_vision
from executive.engine.recording.reader import Recording
from perception.cable.draw import draw_scene

SCALE = 0.6
GAP_PX = 8


def main() -> None:
    """Read the recording that is named first, write the picture that is named second."""
    recording, target = Path(sys.argv[1]), Path(sys.argv[2])
    images = list(Recording.open(recording).images())
    sides = [_drawn(images[number].png) for number in (0, -1)]
    gap = np.full((sides[0].shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    picture = Image.fromarray(np.hstack([sides[0], gap, sides[1]]))
    target.parent.mkdir(parents=True, exist_ok=True)
    picture.save(target, optimize=True)
    print(f"{target}: {target.stat().st_size / 1e3:.0f} kB, {len(images)} looks in {recording}")


def _drawn(png: bytes) -> NDArray[np.uint8]:
    image = np.asarray(Image.open(io.BytesIO(png)).convert("L"))
    scene = cable_vision(hidden_rows=ROWS_OF_ARMS_AT_HOME).scene(image)
    drawn = Image.fromarray(draw_scene(image, scene))
    size = (round(drawn.width * SCALE), round(drawn.height * SCALE))
    return np.asarray(drawn.resize(size, Image.Resampling.LANCZOS))


if __name__ == "__main__":
    main()
