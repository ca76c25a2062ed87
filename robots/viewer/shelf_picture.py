"""A picture of a shelf from above: what a tool reaches of it, and from where the camera looks."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from robots.interfaces import Floats
from robots.shelf_arm.layout import ShelfReport
from robots.shelf_arm.scene import BOARD_M, ShelfSize, arm_placement

_PX_M = 700
_MARGIN_PX = 60
_LEGEND_PX = 110
_BEFORE_M = 1.0
_PAPER, _INK, _WOOD, _NONE, _GRID = "#ffffff", "#222222", "#b9a68a", "#3a3a3c", "#5a5a5e"
_LOW, _HIGH, _BOTH, _CAMERA, _ROBOT = "#d9822b", "#3b82c4", "#4f9d5d", "#d0342c", "#8a8a8e"
_ROBOT_HALF_M, _SIGHT_M = 0.09, 0.25


def save_shelf(
    report: ShelfReport,
    shelf: ShelfSize,
    viewpoints: Mapping[str, Floats],
    title: str,
    file: Path,
    *,
    with_arm: bool,
) -> None:
    """Write the picture as PNG.

    Args:
        report: What was measured.
        shelf: The shelf; it is open at the bottom of the picture.
        viewpoints: T_shelf_camera by name, shape (4, 4).
        title: Written above.
        file: The picture; its folder is made.
        with_arm: Whether an arm stands before the shelf.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    sheet = _Sheet(shelf)
    sheet.shelf(report)
    if with_arm:
        sheet.robot()
    for name, T_shelf_camera in viewpoints.items():
        sheet.camera(name, T_shelf_camera, reached=report.viewpoints[name])
    sheet.words(report, title)
    sheet.image.save(file, format="PNG")


class _Sheet:
    """The paper, and where places of the shelf are on it."""

    def __init__(self, shelf: ShelfSize) -> None:
        self._shelf = shelf
        width = round((shelf.width_m + 2 * BOARD_M) * _PX_M) + 2 * _MARGIN_PX
        height = round((shelf.depth_m + BOARD_M + _BEFORE_M) * _PX_M) + 2 * _MARGIN_PX + _LEGEND_PX
        self.image = Image.new("RGB", (width, height), _PAPER)
        self._draw = ImageDraw.Draw(self.image)

    def shelf(self, report: ShelfReport) -> None:
        width, depth = self._shelf.width_m, self._shelf.depth_m
        self._box(-BOARD_M, 0.0, width + BOARD_M, depth + BOARD_M, _WOOD)
        self._box(0.0, 0.0, width, depth, _NONE)
        half_x, half_y = (0.48 * float(np.diff(axis).min()) for axis in (report.x_m, report.y_m))
        for row, column in np.ndindex(report.low.shape):
            x, y = float(report.x_m[column]), float(report.y_m[row])
            low, high = report.low[row, column], report.high[row, column]
            if low or high:
                colour = _BOTH if low and high else _LOW if low else _HIGH
                x0, x1 = np.clip([x - half_x, x + half_x], 0.0, width).tolist()
                y0, y1 = np.clip([y - half_y, y + half_y], 0.0, depth).tolist()
                self._box(x0, y0, x1, y1, colour)
            if not report.seen[row, column]:
                self._draw.text(self._at(x - 0.008, y + 0.015), "x", _PAPER, font_size=20)

    def robot(self) -> None:
        x, y, _ = arm_placement(self._shelf).position_m
        half = _ROBOT_HALF_M
        corners = (*self._at(x - half, y + half), *self._at(x + half, y - half))
        self._draw.ellipse(corners, fill=_ROBOT, outline=_INK, width=2)
        self._draw.text(self._at(x - 0.03, y + 0.015), "arm", _INK, font_size=18)

    def camera(self, name: str, T_shelf_camera: Floats, *, reached: bool) -> None:
        at_m = T_shelf_camera[:2, 3]
        ahead_m = at_m + _SIGHT_M * T_shelf_camera[:2, 2]
        self._draw.line((*self._at(*at_m), *self._at(*ahead_m)), fill=_CAMERA, width=3)
        x, y = self._at(*at_m)
        self._draw.ellipse((x - 7, y - 7, x + 7, y + 7), fill=_CAMERA if reached else _PAPER,
                           outline=_CAMERA, width=3)  # fmt: skip
        self._draw.text((x + 12, y), name, _INK, font_size=16)

    def words(self, report: ShelfReport, title: str) -> None:
        self._draw.text((_MARGIN_PX, 20), title, _INK, font_size=20)
        entries = [
            (_BOTH, "reached low and high"),
            (_LOW, "low only"),
            (_HIGH, "high only"),
            (_CAMERA, "camera; hollow: not reached"),
        ]
        if not report.seen.all():
            entries.append((_NONE, "x: floor not seen"))
        top = self.image.height - _LEGEND_PX
        for number, (colour, text) in enumerate(entries):
            x, y = _MARGIN_PX + 210 * (number % 3), top + 40 * (number // 3)
            self._draw.rectangle((x, y, x + 24, y + 24), fill=colour)
            self._draw.text((x + 34, y), text, _INK, font_size=15)

    def _at(self, x_m: float, y_m: float) -> tuple[float, float]:
        return (
            _MARGIN_PX + (x_m + BOARD_M) * _PX_M,
            _MARGIN_PX + (self._shelf.depth_m + BOARD_M - y_m) * _PX_M,
        )

    def _box(self, x0: float, y0: float, x1: float, y1: float, fill: str) -> None:
        self._draw.rectangle((*self._at(x0, y1), *self._at(x1, y0)), fill=fill, outline=_GRID)
