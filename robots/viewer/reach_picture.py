"""A picture of a table from above: which arm grasps where, and what the camera sees."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from robots.layout import LayoutReport
from robots.placement import REACH_OF_ONE, TABLE_SIZE_M, Placement, Rectangle

_PX_M = 700
_MARGIN_PX = 60
_LEGEND_PX = 130
_PAPER, _INK, _TABLE, _GRID = "#ffffff", "#222222", "#3a3a3c", "#5a5a5e"
_COLOURS = {"left": "#3b82c4", "right": "#d9822b", "both": "#4f9d5d"}
_CAMERA, _WORK, _ROBOT = "#d0342c", "#f4d35e", "#8a8a8e"
# How far the body stands behind and beside its frame.
_BODY_BACK_M, _BODY_HALF_M = 0.36, 0.20
_HALF_TABLE_M = 0.5 * np.array(TABLE_SIZE_M)


def draw_reach(report: LayoutReport, placement: Placement, title: str) -> Image.Image:
    """Return the picture; y, away from the robot, points up.

    Args:
        report: What was measured.
        placement: Where the robot stands.
        title: Written above.
    """
    return _Sheet(placement).drawn(report, title)


def save_reach(report: LayoutReport, placement: Placement, title: str, file: Path) -> None:
    """Write the picture as PNG."""
    file.parent.mkdir(parents=True, exist_ok=True)
    draw_reach(report, placement, title).save(file, format="PNG")


class _Sheet:
    """The paper, and where places of the world are on it."""

    def __init__(self, placement: Placement) -> None:
        self._placement = placement
        half_x, half_y = (0.5 * size for size in TABLE_SIZE_M)
        self._left_m, self._top_m = -half_x, half_y
        behind_m = min(-half_y, placement.position_m[1] - _BODY_BACK_M)
        width = round(2 * half_x * _PX_M) + 2 * _MARGIN_PX
        height = round((half_y - behind_m) * _PX_M) + 2 * _MARGIN_PX + _LEGEND_PX
        self._image = Image.new("RGB", (width, height), _PAPER)
        self._draw = ImageDraw.Draw(self._image)

    def drawn(self, report: LayoutReport, title: str) -> Image.Image:
        half_x, half_y = (0.5 * size for size in TABLE_SIZE_M)
        self._robot()
        self._box(Rectangle((-half_x, -half_y), (half_x, half_y)), _TABLE, None)
        self._cells(report)
        self._box(REACH_OF_ONE, None, _WORK)
        self._box(report.seen, None, _CAMERA)
        self._draw.text((_MARGIN_PX, 20), title, _INK, font_size=20)
        self._legend(report)
        return self._image

    def _at(self, x_m: float, y_m: float) -> tuple[float, float]:
        return (
            _MARGIN_PX + (x_m - self._left_m) * _PX_M,
            _MARGIN_PX + (self._top_m - y_m) * _PX_M,
        )

    def _box(self, rectangle: Rectangle, fill: str | None, outline: str | None) -> None:
        (x0, y0), (x1, y1) = rectangle.low_m, rectangle.high_m
        corners = (*self._at(x0, y1), *self._at(x1, y0))
        self._draw.rectangle(corners, fill=fill, outline=outline, width=3)

    def _robot(self) -> None:
        x, y, _ = self._placement.position_m
        low, high = (x - _BODY_HALF_M, y - _BODY_BACK_M), (x + _BODY_HALF_M, y)
        self._box(Rectangle(low, high), _ROBOT, _INK)
        self._draw.text(self._at(x - 0.04, y - 0.15), "robot", _INK, font_size=18)

    def _cells(self, report: LayoutReport) -> None:
        reach = report.reach
        half_m = 0.46 * float(np.min(np.diff(reach.x_m)))
        masks = reach.reached()
        for row, column in np.ndindex(masks["left"].shape):
            arms = [arm for arm, mask in masks.items() if mask[row, column]]
            x, y = float(reach.x_m[column]), float(reach.y_m[row])
            edges = [(x - half_m, y - half_m), (x + half_m, y + half_m)]
            low, high = np.clip(edges, -_HALF_TABLE_M, _HALF_TABLE_M).tolist()
            cell = Rectangle(tuple(low), tuple(high))
            colour = _COLOURS["both" if len(arms) == 2 else arms[0]] if arms else _GRID
            self._box(cell, colour if arms else None, _GRID)

    def _legend(self, report: LayoutReport) -> None:
        shares = report.shares()
        entries = [
            (_COLOURS["left"], f"left arm {100 * shares['left']:.0f} %"),
            (_COLOURS["right"], f"right arm {100 * shares['right']:.0f} %"),
            (_COLOURS["both"], f"both {100 * shares['both']:.0f} %"),
            (_CAMERA, "camera"),
            (_WORK, "work area"),
        ]
        top = self._image.height - _LEGEND_PX
        for number, (colour, text) in enumerate(entries):
            x, y = _MARGIN_PX + 240 * (number % 3), top + 40 * (number // 3)
            self._draw.rectangle((x, y, x + 24, y + 24), fill=colour)
            self._draw.text((x + 34, y), text, _INK, font_size=18)
