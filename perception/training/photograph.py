"""What a camera makes of a picture: light, lens, sensor, processing, compression."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.camera import GreyImage
from perception.training.looks import Lens, Light

Picture = NDArray[np.float32]


def light_up(rng: np.random.Generator, picture: Picture, light: Light) -> Picture:
    """Return a picture in uneven light, and in the hard shadow of an arm above the table."""
    rows, columns = picture.shape
    y = np.linspace(-1.0, 1.0, rows, dtype=np.float32)[:, None]
    x = np.linspace(-1.0, 1.0, columns, dtype=np.float32)
    if light.vignette > 0.0:
        picture = picture * (1.0 - np.float32(0.5 * light.vignette) * (x * x + y * y))
    if light.gradient > 0.0:
        turn = rng.uniform(0.0, 2.0 * np.pi)
        along = np.float32(np.cos(turn)) * x + np.float32(np.sin(turn)) * y
        picture = picture * (1.0 - np.float32(0.35 * light.gradient) * (along + np.float32(1.4142)))
    if light.arm > 0.0:
        picture = picture * (1.0 - np.float32(light.arm) * _arm(rng, picture.shape))
    return picture


def _arm(rng: np.random.Generator, size_px: tuple[int, ...]) -> Picture:
    """Return 1 in the shadow of an arm that reaches in from outside, bent once, 0 elsewhere."""
    shape, side = np.array(size_px[::-1], float), float(max(size_px))
    elbow = rng.uniform(0.1, 0.9, 2) * shape
    outside = elbow + (elbow - shape / 2.0) * 8.0 + rng.normal(0.0, 0.5 * side, 2)
    points = np.array([outside, elbow, elbow + rng.normal(0.0, 0.3 * side, 2)])
    shadow = np.zeros(size_px[:2], np.uint8)
    for first, last in ((0, 1), (1, 2)):
        ends = np.round(points[[first, last]]).astype(int)
        thickness = max(round(rng.uniform(0.03, 0.14) * side), 1)
        cv2.line(shadow, tuple(map(int, ends[0])), tuple(map(int, ends[1])), 255, thickness)
    if rng.random() < 0.5:
        shadow = cv2.blur(shadow, (5, 5)).astype(np.uint8)
    return shadow.astype(np.float32) / np.float32(255.0)


def photograph(
    rng: np.random.Generator, picture: Picture, width_px: float, lens: Lens
) -> GreyImage:
    """Return the image that a lens and a sensor make of a picture with cables `width_px` wide."""
    seen = _through_lens(rng, picture, width_px, lens)
    noisy = _sensed(rng, seen, lens)
    image: GreyImage = np.clip(noisy, 0.0, 255.0).astype(np.uint8)
    if lens.levels < 256:
        step = 255.0 / (lens.levels - 1)
        image = (np.round(image / step) * step).astype(np.uint8)
    if lens.jpeg_quality is not None:
        _, packed = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, lens.jpeg_quality])
        image = np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
    return image


def _through_lens(rng: np.random.Generator, scene: Picture, width_px: float, lens: Lens) -> Picture:
    picture: cv2.typing.MatLike = scene
    size = picture.shape[::-1]
    if lens.glow > 0.0:
        bright = np.maximum(picture - 150.0, 0.0)
        picture = picture + lens.glow * cv2.blur(bright, (2 * int(width_px) + 1,) * 2)
    if lens.gamma != 1.0:
        whole = np.clip(picture, 0.0, 255.0) / np.float32(255.0)
        picture = np.float32(255.0) * whole ** np.float32(lens.gamma)
    if lens.blur_px > 0.0:
        picture = cv2.GaussianBlur(picture, (0, 0), lens.blur_px)
    if lens.defocus * width_px > 0.7:
        picture = cv2.filter2D(picture, -1, _disc(lens.defocus * width_px))
    if lens.motion * width_px > 1.5:
        picture = cv2.filter2D(picture, -1, _way(rng, lens.motion * width_px))
    # A cable that was once under three pixels wide cannot be followed any more.
    shrink = max(lens.shrink, min(3.0 / width_px, 1.0))
    if shrink < 1.0:
        small = cv2.resize(picture, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
        back = (cv2.INTER_NEAREST, cv2.INTER_LINEAR, cv2.INTER_CUBIC)[int(rng.integers(3))]
        picture = cv2.resize(small, size, interpolation=back)
    return np.asarray(picture, np.float32)


def _disc(radius_px: float) -> Picture:
    reach = int(np.ceil(radius_px))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    disc = np.clip(radius_px + 0.5 - np.hypot(x, y), 0.0, 1.0)
    return (disc / disc.sum()).astype(np.float32)


def _way(rng: np.random.Generator, length_px: float) -> Picture:
    reach, turn = int(np.ceil(length_px / 2.0)), rng.uniform(0.0, np.pi)
    along = np.linspace(-0.5, 0.5, 4 * reach + 1) * length_px
    kernel = np.zeros((2 * reach + 1,) * 2)
    rows = np.round(along * np.sin(turn)).astype(int) + reach
    columns = np.round(along * np.cos(turn)).astype(int) + reach
    np.add.at(kernel, (rows, columns), 1.0)
    return (kernel / kernel.sum()).astype(np.float32)


def _sensed(rng: np.random.Generator, picture: Picture, lens: Lens) -> Picture:
    if lens.noise > 0.0:
        noise = rng.standard_normal(picture.shape, dtype=np.float32) * np.float32(lens.noise)
        if rng.random() < 0.3:
            noise = 2.0 * cv2.GaussianBlur(noise, (0, 0), 0.7).astype(np.float32)
        picture = picture + noise
    if lens.banding > 0.0:
        rows = rng.normal(0.0, lens.banding, (picture.shape[0], 1)).astype(np.float32)
        columns = rng.normal(0.0, lens.banding, (1, picture.shape[1])).astype(np.float32)
        picture = picture + (rows if rng.random() < 0.5 else columns)
    if lens.sharpen > 0.0:
        soft = cv2.GaussianBlur(picture, (0, 0), 1.2).astype(np.float32)
        picture = picture + np.float32(lens.sharpen) * (picture - soft)
    if lens.salt > 0.0:
        count = int(lens.salt * picture.size)
        places = rng.integers(0, picture.size, count)
        picture.ravel()[places] = rng.choice([0.0, 255.0], count)
    return picture
