"""Pictures of the results page and the README: `python -m benchmarks.pictures [NAME ...]`.

Each shows what a benchmark measures: a run, or scenes with what is believed about them drawn
over. `python -m benchmarks report` puts those of the page beside their tables.
"""

import argparse
import io
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

IMAGES = Path(__file__).parent.parent / "docs" / "images"
GAP_PX, SHEET_PX, TILE_PX = 8, 1280, 480
UNTANGLE_SEED, SEARCH_SEED = 2, 3

ColourImage = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Picture:
    """One picture.

    Attributes:
        file: Its name in `docs/images`.
        about: What is seen there.
        draw: Draws it as RGB, shape (H, W, 3), uint8, with a folder for files in between.
    """

    file: str
    about: str
    draw: Callable[[Path], ColourImage]


def _first_and_last(folder: Path) -> ColourImage:
    """Return the first and the last look of an untangling run, side by side."""
    from executive.app.compose import ROWS_OF_ARMS_AT_HOME
    from executive.engine.recording.reader import Recording

    images = list(Recording.open(_recorded(folder, "untangle", UNTANGLE_SEED)).images())
    sides = [_believed(_grey(images[i].png), ROWS_OF_ARMS_AT_HOME) for i in (0, -1)]
    return _beside(sides, width_px=619)


def _untangle(folder: Path) -> ColourImage:
    return _sheet(_recorded(folder, "untangle", UNTANGLE_SEED))


def _search(folder: Path) -> ColourImage:
    return _sheet(_recorded(folder, "search", SEARCH_SEED))


def _search_strip(folder: Path) -> ColourImage:
    """Return a search in four looks: before and after the first belief, when found, when out."""
    from executive.engine.recording.reader import Recording
    from perception.shelf.drawing import TARGET

    images = Recording.open(_recorded(folder, "search", SEARCH_SEED)).images()
    looks = [np.asarray(Image.open(io.BytesIO(image.png)).convert("RGB")) for image in images]
    found = next(i for i, look in enumerate(looks) if (look == TARGET).all(axis=2).any())
    top, bottom = (round(share * len(looks[1])) for share in (0.45, 0.9))
    chosen = [looks[i][top:bottom] for i in (1, 2, found, found + 1)]
    return np.hstack([look.repeat(2, axis=0).repeat(2, axis=1) for look in chosen])


def _search_kinova(folder: Path) -> ColourImage:
    return _sheet(_recorded(folder, "search_kinova", SEARCH_SEED))


def _knots(_: Path) -> ColourImage:
    """Return the first scene of each tier, drawn above and settled below."""
    from benchmarks.knot_scenes import TIERS, drawn, settled

    rows = [
        _beside([_believed(scene(tier, 0, 0).image) for tier in TIERS], width_px=TILE_PX)
        for scene in (drawn, settled)
    ]
    return _below(rows)


PICTURES = {
    "readme": Picture(
        "untangle.png",
        "The first and the last camera image of a run, with what is believed drawn over.",
        _first_and_last,
    ),
    "readme-search": Picture(
        "search.png",
        "A search in four looks: where the product may be (red), what shows of it (green).",
        _search_strip,
    ),
    "knots": Picture(
        "results_knots.webp",
        "The first scene of A1, A2 and A3, drawn (above) and settled (below), with what our "
        "system believes of it.",
        _knots,
    ),
    "untangle": Picture(
        "results_untangle.webp",
        f"All looks of the mission with seed {UNTANGLE_SEED}: the trace, its crossings, where "
        "hands take hold.",
        _untangle,
    ),
    "search": Picture(
        "results_search.webp",
        f"All looks of the mission with seed {SEARCH_SEED}, and what was believed after each: "
        "where the product may be (red), what shows of it (green). The first is from before any "
        "look.",
        _search,
    ),
    "shelf-cell": Picture(
        "results_shelf_cell.webp",
        f"All looks of the mission `search_kinova` with seed {SEARCH_SEED}, through the camera on "
        "the tool.",
        _search_kinova,
    ),
}


def _recorded(folder: Path, mission: str, seed: int) -> Path:
    """Return the recording of a mission, which is run for the first that asks."""
    recording = folder / f"{mission}.mcap"
    if not recording.exists():
        cellwright = str(Path(sys.executable).with_name("cellwright"))
        words = ["run", mission, "--seed", str(seed), "--record", str(recording)]
        subprocess.run([cellwright, *words], check=True, stdout=sys.stderr)
    return recording


def _sheet(recording: Path) -> ColourImage:
    from executive.inspector.sheet import write_sheet

    file = recording.with_suffix(".png")
    write_sheet(recording, file)
    return _scaled(np.asarray(Image.open(file).convert("RGB")), SHEET_PX)


def _grey(png: bytes) -> ColourImage:
    return np.asarray(Image.open(io.BytesIO(png)).convert("L"))


def _believed(image: ColourImage, hidden_rows: int = 0) -> ColourImage:
    """Return a grey image as RGB, with what our system believes of it drawn over."""
    from executive.app.compose import cable_vision
    from perception.cable.draw import draw_scene

    return draw_scene(image, cable_vision(hidden_rows).scene(image))


def _beside(images: Sequence[ColourImage], width_px: int) -> ColourImage:
    """Return images side by side, each as wide as asked for."""
    scaled = [_scaled(image, width_px) for image in images]
    height_px = max(len(image) for image in scaled)
    gap: ColourImage = np.full((height_px, GAP_PX, 3), 255, np.uint8)
    parts = [part for image in scaled for part in (_padded(image, height_px), gap)]
    return np.hstack(parts[:-1])


def _below(rows: Sequence[ColourImage]) -> ColourImage:
    gap: ColourImage = np.full((GAP_PX, rows[0].shape[1], 3), 255, np.uint8)
    return np.vstack([part for row in rows for part in (row, gap)][:-1])


def _padded(image: ColourImage, height_px: int) -> ColourImage:
    return np.pad(image, ((0, height_px - len(image)), (0, 0), (0, 0)), constant_values=255)


def _scaled(image: ColourImage, width_px: int) -> ColourImage:
    """Return an image as wide as asked for; one that is narrower stays as it is."""
    height, width = image.shape[:2]
    if width <= width_px:
        return image
    size = (width_px, round(height * width_px / width))
    return np.asarray(Image.fromarray(image).resize(size, Image.Resampling.LANCZOS))


def main() -> None:
    """Draw the pictures that are named, or all of them."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.pictures", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PICTURES))
    parser.add_argument("--runs", type=Path, help="folder of recordings; those there are used")
    chosen = parser.parse_args()
    names = chosen.names or [*PICTURES]
    unknown = [name for name in names if name not in PICTURES]
    if unknown:
        parser.error(f"no picture {unknown[0]!r}; known: {', '.join(PICTURES)}")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            target = IMAGES / PICTURES[name].file
            image = Image.fromarray(PICTURES[name].draw(chosen.runs or Path(folder)))
            image.save(target, optimize=True, quality=82)
            print(f"{target}: {target.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
