"""Pictures of labelled packages on a shelf: colour, depth and what each pixel shows.

Fronts are warped into the image; sides and tops have the package's own colour. Light falls off into
the shelf, and glare lies on some fronts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from perception.camera import CameraModel
from perception.rgbd import RgbdFrame
from perception.shelf.casting import BoxCaster
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import NOTHING, Bools, Box, Floats, Segments, Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.packages import Package
from simulation.shelf.picturing import FACE_M, SIDE, TOP, WALLS, SensorNoise

# Nothing on a shelf of packages is taller.
TALLEST_M = 0.22


@dataclass(frozen=True, slots=True)
class Looks:
    """What makes pictures hard to read.

    Attributes:
        glare: Share of fronts with glare on them.
        glare_strength: How white it is in its middle, in [0, 1].
        dimming: How much darker the back of the shelf is, in [0, 1].
        blur_px: Standard deviation of the lens's blur.
        noise: What the sensor adds.
    """

    glare: float = 0.25
    glare_strength: float = 0.85
    dimming: float = 0.35
    blur_px: float = 0.5
    noise: SensorNoise = field(default_factory=SensorNoise)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A frame, and the truth about it.

    Attributes:
        frame: What a camera gives.
        segments: Which box each pixel shows, by number, or `NOTHING`.
    """

    frame: RgbdFrame
    segments: Segments


@dataclass(frozen=True, slots=True, eq=False)
class Glare:
    """A bright ellipse on a front: its middle and radii as shares of the front, and its angle."""

    x: float
    y: float
    long: float
    short: float
    angle_rad: float


class LabelledShelf:
    """A shelf with packages that can be photographed from anywhere."""

    def __init__(
        self,
        shelf: Shelf,
        boxes: Sequence[Box],
        packages: Sequence[Package],
        looks: Looks,
        rng: np.random.Generator,
        glares: Sequence[Glare | None] | None = None,
    ) -> None:
        """Set it up; glare is drawn here, since lamps do not move with the camera.

        Args:
            shelf: The shelf.
            boxes: Where packages stand.
            packages: How they look.
            looks: What makes pictures hard.
            rng: Source of chance.
            glares: Glare on each front; None to draw it.
        """
        self._shelf, self._boxes, self._packages = shelf, tuple(boxes), tuple(packages)
        self._looks, self._rng = looks, rng
        self._glares = tuple([draw_glare(looks, rng) for _ in boxes] if glares is None else glares)

    def photograph(self, camera: CameraModel, viewpoint: str = "") -> Picture:
        """Take a picture."""
        caster = BoxCaster(camera)
        renderer = ShelfRenderer(caster, self._shelf)
        depth_m, segments = renderer.render(self._boxes)
        colour = self._plain(caster, depth_m, segments)
        fronts = self._fronts(caster, depth_m, segments)
        for number in np.unique(segments[fronts]).tolist():
            self._label(colour, number, fronts & (segments == number), camera)
        return Picture(self._sensed(colour, depth_m, camera, viewpoint), segments)

    @property
    def glaring(self) -> tuple[bool, ...]:
        """Which packages have glare on their fronts."""
        return tuple(glare is not None for glare in self._glares)

    def letters_px(self, number: int, camera: CameraModel) -> float:
        """Return the height of a package's name in an image [px]; 0 beside the image."""
        box = self._boxes[number]
        middle_m = np.array([box.x_m, box.low_m[1], box.bottom_m + 0.5 * box.size_m[2]])
        x_px, y_px = camera.project(middle_m[None])[0]
        if not (0.0 <= x_px < camera.width_px and 0.0 <= y_px < camera.height_px):
            return 0.0
        distance_m = middle_m[1] - camera.T_world_camera[1, 3]
        return float(self._packages[number].name_height_m * camera.focal_px / distance_m)

    def visible_shares(self, camera: CameraModel) -> Floats:
        """Return how much of each package's silhouette is seen, in [0, 1]."""
        return ShelfRenderer(BoxCaster(camera), self._shelf).visible_shares(self._boxes)

    def _plain(self, caster: BoxCaster, depth_m: Floats, segments: Segments) -> Floats:
        """Return boxes in their own colours, without labels, shape (height, width, 3)."""
        points_m = caster.origin_m + np.nan_to_num(depth_m)[..., None] * caster.rays
        paint = np.array([*(package.base for package in self._packages), WALLS], np.float64)
        tops = np.array([*(box.high_m[2] for box in self._boxes), np.inf])
        light = np.where(points_m[..., 2] > tops[segments] - FACE_M, TOP, SIDE)
        light = np.where(segments == NOTHING, 1.0, light) * self._daylight(points_m[..., 1])
        plain: Floats = paint[segments] * light[..., None]
        return plain

    def _daylight(self, y_m: Floats | float) -> Floats:
        """Return the share of light that reaches a depth of the shelf."""
        return np.clip(1.0 - self._looks.dimming * np.asarray(y_m) / self._shelf.depth_m, 0.1, 1.0)

    def _fronts(self, caster: BoxCaster, depth_m: Floats, segments: Segments) -> Bools:
        """Say which pixels show the front of a box."""
        y_m = caster.origin_m[1] + np.nan_to_num(depth_m) * caster.rays[..., 1]
        near = np.array([*(box.low_m[1] for box in self._boxes), np.inf])
        return np.asarray((segments != NOTHING) & (np.abs(y_m - near[segments]) < FACE_M))

    def _label(self, colour: Floats, number: int, mask: Bools, camera: CameraModel) -> None:
        """Put the label of a box where its front is seen."""
        box = self._boxes[number]
        (left, front, low), (right, _, high) = box.low_m, box.high_m
        corners_m = np.array(
            [(left, front, high), (right, front, high), (right, front, low), (left, front, low)]
        )
        corners_px = camera.project(corners_m).astype(np.float32)
        size_px = np.maximum(np.ptp(corners_px, axis=0).round().astype(int), 2)
        label = self._lit(number, (int(size_px[0]), int(size_px[1])), front)
        ends = np.array([[0, 0], [size_px[0], 0], size_px, [0, size_px[1]]], np.float32) - 0.5
        onto = cv2.getPerspectiveTransform(ends, corners_px)
        rows, columns = np.nonzero(mask)
        (top, first), (bottom, last) = (rows.min(), columns.min()), (rows.max(), columns.max())
        shift = np.array([[1.0, 0.0, -first], [0.0, 1.0, -top], [0.0, 0.0, 1.0]])
        wanted = (int(last - first + 1), int(bottom - top + 1))
        warped = cv2.warpPerspective(
            label, shift @ onto, wanted, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        colour[rows, columns] = warped[rows - top, columns - first]

    def _lit(self, number: int, size_px: tuple[int, int], front_m: float) -> Floats:
        """Return a label as large as it is seen, in the shelf's light."""
        label = cv2.resize(self._packages[number].front, size_px, interpolation=cv2.INTER_AREA)
        lit: Floats = np.asarray(label, np.float64) * float(self._daylight(front_m))
        glare = self._glares[number]
        if glare is None:
            return lit
        white = self._looks.glare_strength * _glare_image(glare, size_px)[..., None]
        shining: Floats = lit * (1.0 - white) + 255.0 * white
        return shining

    def _sensed(
        self, colour: Floats, depth_m: Floats, camera: CameraModel, viewpoint: str
    ) -> RgbdFrame:
        noise = self._looks.noise
        if self._looks.blur_px > 0.0:
            colour = np.asarray(cv2.GaussianBlur(colour, (0, 0), self._looks.blur_px), np.float64)
        colour = colour + self._rng.normal(0.0, noise.colour, colour.shape)
        depth_m = depth_m + self._rng.normal(0.0, noise.depth_m, depth_m.shape)
        lost = self._rng.random(depth_m.shape) < noise.lost_share
        measured = np.where(lost, np.nan, depth_m).astype(np.float32)
        seen = np.clip(np.round(colour), 0, 255).astype(np.uint8)
        return RgbdFrame(seen, measured, 0.0, camera, viewpoint)


def overview_camera(shelf: Shelf, width_px: int) -> CameraModel:
    """Return a camera that sees the whole width of a shelf, up to what stands on its floor."""
    return _trimmed(front_camera(shelf, width_px), TALLEST_M)


def near_cameras(shelf: Shelf, width_px: int) -> dict[str, CameraModel]:
    """Return three level cameras close before a shelf that share its width, by viewpoint.

    Args:
        shelf: What to look into; its frame is the world.
        width_px: Width of the images.
    """
    distance_m, height_m = 0.5 * shelf.width_m, 0.5 * TALLEST_M
    focal_px = width_px * distance_m / (0.42 * shelf.width_m)
    middle = front_camera(shelf, width_px, distance_m, height_m)
    cameras = {}
    for name, share in (("near left", 1 / 6), ("near", 1 / 2), ("near right", 5 / 6)):
        T_world_camera = middle.T_world_camera.copy()
        T_world_camera[0, 3] = share * shelf.width_m
        whole = CameraModel(
            middle.width_px, middle.height_px, focal_px, middle.centre_px, T_world_camera
        )
        cameras[name] = _trimmed(whole, TALLEST_M)
    return cameras


def _trimmed(camera: CameraModel, tallest_m: float) -> CameraModel:
    """Return a level camera that reads only the rows that can show packages."""
    distance_m, height_m = -camera.T_world_camera[1, 3], camera.T_world_camera[2, 3]
    scale = camera.focal_px / distance_m
    top = max(0, round(camera.centre_px[1] - scale * max(tallest_m - height_m, 0.0)) - 8)
    bottom = min(camera.height_px, round(camera.centre_px[1] + scale * height_m) + 8)
    centre_px = (camera.centre_px[0], camera.centre_px[1] - top)
    return CameraModel(
        camera.width_px, bottom - top, camera.focal_px, centre_px, camera.T_world_camera
    )


def draw_glare(looks: Looks, rng: np.random.Generator) -> Glare | None:
    """Draw the glare on a front; None for none."""
    if rng.random() >= looks.glare:
        return None
    return Glare(
        rng.uniform(0.2, 0.8),
        rng.uniform(0.15, 0.75),
        rng.uniform(0.25, 0.6),
        rng.uniform(0.06, 0.16),
        rng.uniform(0.0, np.pi),
    )


def _glare_image(glare: Glare, size_px: tuple[int, int]) -> Floats:
    """Return how white a front is, shape (height, width), in [0, 1]."""
    x, y = np.meshgrid(np.arange(size_px[0]) / size_px[0], np.arange(size_px[1]) / size_px[1])
    along = (x - glare.x) * np.cos(glare.angle_rad) + (y - glare.y) * np.sin(glare.angle_rad)
    across = (y - glare.y) * np.cos(glare.angle_rad) - (x - glare.x) * np.sin(glare.angle_rad)
    white: Floats = np.exp(-0.5 * ((along / glare.long) ** 2 + (across / glare.short) ** 4))
    return white
