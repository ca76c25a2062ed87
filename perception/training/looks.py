"""How scenes look: drawn wide on purpose, as networks shall know no renderer and no camera.

Three styles are mixed. `photograph` is cloth, light and lens of a real table; `shaded` is what
simulators of robots draw, round cables on bare or chequered ground; `plain` is flat colour as
plots and simple renderers have it, with borders that may be jagged. `faceted` is only drawn where
it is asked for: pieces with flat sides, each as bright as it faces the light.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

STYLES = {"photograph": 0.64, "shaded": 0.18, "plain": 0.18, "faceted": 0.0}
# Cables and tables differ at least this much [grey values], after gamma and gradients, too.
LEAST_CONTRAST = 22.0


@dataclass(frozen=True, slots=True)
class CableLook:
    """How a cable looks; grey values in [0, 255], lengths in cable widths.

    Attributes:
        brightness: Grey value of its middle.
        width: Its width over that of the scene's cables.
        braid_amplitude: How much the braid changes its brightness.
        braid_period: Length of the braid's pattern.
        braid_slope: How far it runs askew.
        flank: How much darker its sides are.
        gloss: Highlight along it.
        gloss_sharpness: How narrow that is.
        uneven: How much its brightness changes along it, slowly.
        dimming: Brightness it gains or loses a width of height.
        stripe: Brightness of stripes over its own, 1 for none.
        stripe_period: Length from stripe to stripe.
        stripe_slope: How far stripes wind round it.
        stripe_share: Share of the length that they take.
        outline: How much darker its border is.
        bead: How much darker the joints of its pieces are, as simulated chains have them.
        bead_period: Length of a piece.
        facing: Share of its brightness that sides lose as they turn away from the light.
        facets: How many flat sides half of it has, 0 for a round one.
    """

    brightness: float
    width: float = 1.0
    braid_amplitude: float = 0.0
    braid_period: float = 1.0
    braid_slope: float = 1.0
    flank: float = 0.0
    gloss: float = 0.0
    gloss_sharpness: float = 8.0
    uneven: float = 0.0
    dimming: float = 0.0
    stripe: float = 1.0
    stripe_period: float = 4.0
    stripe_slope: float = 0.0
    stripe_share: float = 0.3
    outline: float = 0.0
    bead: float = 0.0
    bead_period: float = 1.5
    facing: float = 0.0
    facets: int = 0


@dataclass(frozen=True, slots=True)
class Light:
    """What light does.

    Attributes:
        light_rad: Direction that shadows fall in.
        slant: Length of a shadow over the height of what casts it.
        shadow: Share of light that a shadow takes away.
        softness: Standard deviation of the shadow's border [cable widths], 0 for a hard one.
        spread: Width of the shadow over that of the cable.
        gradient: Share of light lost from one side of the image to the other.
        arm: Share of light that the hard shadow of something above the table takes away.
        vignette: Loss of light in the corners.
    """

    light_rad: float = 0.0
    slant: float = 0.0
    shadow: float = 0.0
    softness: float = 0.0
    spread: float = 1.0
    gradient: float = 0.0
    arm: float = 0.0
    vignette: float = 0.0


@dataclass(frozen=True, slots=True)
class Lens:
    """What a camera does; lengths in pixels unless a name says otherwise.

    Attributes:
        smooth: Whether the borders of strands are drawn smooth.
        blur_px: Standard deviation of the lens's blur.
        defocus: Radius of its disc out of focus [cable widths].
        motion: Length of the camera's way while it looked [cable widths].
        shrink: Share of its size that the image once had.
        glow: How much bright places shine over their borders.
        gamma: Exponent of brightness.
        sharpen: Strength of unsharp masking.
        noise: Standard deviation of the sensor's noise.
        salt: Share of pixels that are white or black.
        banding: Standard deviation of whole rows or columns.
        levels: How many grey values there are.
        jpeg_quality: Quality of compression, None for none.
    """

    smooth: bool = True
    blur_px: float = 0.0
    defocus: float = 0.0
    motion: float = 0.0
    shrink: float = 1.0
    glow: float = 0.0
    gamma: float = 1.0
    sharpen: float = 0.0
    noise: float = 0.0
    salt: float = 0.0
    banding: float = 0.0
    levels: int = 256
    jpeg_quality: int | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """What lies below.

    Attributes:
        level: Grey value.
        cable: Grey value of the first cable; nothing of the table's own comes near it.
        texture: How strong the table's texture is, as a share of the contrast.
        chequered: Whether it is chequered, as simulated floors are.
        folds: Whether soft lines, borders of cloth and uneven light may lie on it.
        clutter: How many things lie about.
    """

    level: float
    cable: float
    texture: float = 0.0
    chequered: bool = False
    folds: bool = False
    clutter: int = 0

    @property
    def contrast(self) -> float:
        """How far cables are from the table."""
        return abs(self.cable - self.level)


@dataclass(frozen=True, slots=True)
class Look:
    """How a scene looks.

    Attributes:
        style: One of `STYLES`.
        table: What lies below the cables.
        cables: One look a cable; often the same for all.
        light: Where it comes from.
        lens: What the camera makes of it.
        connectors: Whether cables carry connectors.
    """

    style: str
    table: Table
    cables: tuple[CableLook, ...]
    light: Light
    lens: Lens
    connectors: bool


def draw_look(
    rng: np.random.Generator,
    cables: int,
    bright: bool | None = None,
    style: str | None = None,
    alike: bool | None = None,
) -> Look:
    """Draw a look of a scene.

    Args:
        rng: Source of all randomness.
        cables: How many cables there are.
        bright: Whether cables are brighter than the table; None for three fifths of all.
        style: One of `STYLES`; None for any.
        alike: Whether all cables look the same; None for half of all.
    """
    style = style or str(rng.choice(list(STYLES), p=list(STYLES.values())))
    contrast = rng.uniform(25.0, 60.0) if _chance(rng, 0.25) else rng.uniform(45.0, 195.0)
    dark = rng.uniform(4.0, 250.0 - contrast)
    drawn_bright = _chance(rng, 0.6)
    above = drawn_bright if bright is None else bright
    level, cable = (dark, dark + contrast) if above else (dark + contrast, dark)
    looks = _cable_looks(rng, style, cable, level, cables, alike)
    return Look(
        style,
        _table(rng, style, level, cable),
        looks,
        _light(rng, style),
        _lens(rng, style, contrast, (level, *_levels(looks))),
        connectors=_chance(rng, 0.7),
    )


def _levels(cables: Sequence[CableLook]) -> list[float]:
    """Return the grey values of cables, stripes included."""
    return [
        min(cable.brightness * share, 255.0) for cable in cables for share in (1.0, cable.stripe)
    ]


def _chance(rng: np.random.Generator, probability: float) -> bool:
    return bool(rng.random() < probability)


def _some(rng: np.random.Generator, probability: float, low: float, high: float) -> float:
    """Return a value of a range with a probability, else 0."""
    value = rng.uniform(low, high)
    return float(value) if _chance(rng, probability) else 0.0


def _table(rng: np.random.Generator, style: str, level: float, cable: float) -> Table:
    clutter = int(rng.integers(1, 9)) if _chance(rng, 0.4) else 0
    if style == "photograph":
        return Table(level, cable, _some(rng, 0.75, 0.03, 0.3), False, True, clutter)
    if style == "shaded":
        texture, chequered = _some(rng, 0.35, 0.03, 0.2), _chance(rng, 0.3)
        return Table(level, cable, texture, chequered, False, clutter)
    if style == "faceted":
        return Table(level, cable, chequered=_chance(rng, 0.3))
    return Table(level, cable, clutter=clutter if _chance(rng, 0.4) else 0)


def _light(rng: np.random.Generator, style: str) -> Light:
    light_rad, soft = rng.uniform(0.0, 2.0 * np.pi), _some(rng, 0.5, 0.15, 1.1)
    if style == "plain":
        return Light(light_rad, gradient=_some(rng, 0.2, 0.05, 0.3))
    if style == "faceted":
        slant = abs(rng.normal(0.0, 0.8))
        return Light(light_rad, slant=slant, shadow=_some(rng, 0.5, 0.2, 0.7))
    photograph = style == "photograph"
    return Light(
        light_rad,
        slant=rng.uniform(0.0, 1.3) if _chance(rng, 0.75) else rng.uniform(1.3, 2.6),
        shadow=_some(rng, 0.8 if photograph else 0.5, 0.1, 0.65),
        softness=soft if photograph else 0.0,
        spread=1.0 + _some(rng, 0.3, 0.1, 0.8),
        gradient=_some(rng, 0.4, 0.05, 0.5),
        arm=_some(rng, 0.15 if photograph else 0.08, 0.15, 0.55),
        vignette=rng.uniform(0.0, 0.35) if photograph else 0.0,
    )


def _lens(rng: np.random.Generator, style: str, contrast: float, levels: tuple[float, ...]) -> Lens:
    if style == "plain":
        smooth = _chance(rng, 0.5)
        return Lens(
            smooth=smooth,
            blur_px=_some(rng, 0.6 if smooth else 0.2, 0.2, 0.7),
            noise=_some(rng, 0.25, 0.5, min(5.0, 0.1 * contrast)),
            shrink=1.0 - _some(rng, 0.15, 0.2, 0.5),
            jpeg_quality=int(rng.integers(30, 95)) if _chance(rng, 0.2) else None,
        )
    if style == "faceted":
        return Lens(
            smooth=_chance(rng, 0.25),
            blur_px=_some(rng, 0.2, 0.2, 0.6),
            noise=_some(rng, 0.2, 0.5, 2.0),
            shrink=1.0 - _some(rng, 0.15, 0.2, 0.5),
        )
    photograph = style == "photograph"
    most_noise = min(14.0, 0.16 * contrast)
    return Lens(
        smooth=photograph or _chance(rng, 0.6),
        blur_px=rng.uniform(0.2, 1.3) if photograph else _some(rng, 0.6, 0.2, 0.8),
        defocus=_some(rng, 0.12, 0.1, 0.35),
        motion=_some(rng, 0.1, 0.2, 0.9),
        shrink=1.0 - _some(rng, 0.18, 0.2, 0.6),
        glow=_some(rng, 0.12, 0.1, 0.6),
        gamma=_gamma(rng, levels),
        sharpen=_some(rng, 0.35, 0.2, 1.4),
        noise=_some(rng, 0.9 if photograph else 0.4, 0.5, most_noise),
        salt=_some(rng, 0.08, 0.0005, 0.012),
        banding=_some(rng, 0.1, 0.3, min(4.0, 0.06 * contrast)),
        levels=int(rng.integers(12, 48)) if _chance(rng, 0.06) and contrast > 60.0 else 256,
        jpeg_quality=int(rng.integers(25, 95)) if _chance(rng, 0.3) else None,
    )


def _gamma(rng: np.random.Generator, levels: tuple[float, ...]) -> float:
    """Return an exponent that leaves the cables in sight."""
    gamma = float(np.exp(rng.uniform(-0.7, 0.7)))
    table, *cables = (255.0 * (level / 255.0) ** gamma for level in levels)
    seen = all(abs(cable - table) >= LEAST_CONTRAST for cable in cables)
    return gamma if seen and _chance(rng, 0.5) else 1.0


def _cable_looks(
    rng: np.random.Generator,
    style: str,
    brightness: float,
    table: float,
    cables: int,
    alike: bool | None,
) -> tuple[CableLook, ...]:
    draw = _CABLES[style]
    first = _striped(rng, draw(rng, brightness, abs(brightness - table)), table)
    one_colour, one_width = (alike is not False and _chance(rng, p) for p in (0.55, 0.7))
    looks = []
    for _ in range(cables):
        look = first
        if not (alike or one_colour):
            other = _other_brightness(rng, brightness, table)
            look = draw(rng, other, abs(other - table)) if _chance(rng, 0.5) else look
            look = _striped(rng, replace(look, brightness=other, stripe=1.0), table)
        if not (alike or one_width):
            look = replace(look, width=float(np.exp(np.clip(rng.normal(0, 0.16), -0.35, 0.35))))
        looks.append(look)
    return tuple(looks)


def _other_brightness(rng: np.random.Generator, brightness: float, table: float) -> float:
    """Return the brightness of a cable that differs from the first, on any side of the table."""
    if _chance(rng, 0.8):
        other = brightness + rng.normal(0.0, 0.15) * abs(brightness - table)
    else:
        other = rng.uniform(4.0, 252.0)
    seen = abs(other - table) >= LEAST_CONTRAST + 3.0
    return float(np.clip(other if seen else brightness, 0.0, 255.0))


def _striped(rng: np.random.Generator, look: CableLook, table: float) -> CableLook:
    """Return a cable of two colours, now and then; both of them can be told from the table."""
    if not _chance(rng, 0.14):
        return look
    second = rng.uniform(5.0, 250.0)
    if abs(second - table) < LEAST_CONTRAST + 3.0:
        return look
    return replace(
        look,
        stripe=second / max(look.brightness, 4.0),
        stripe_period=rng.uniform(0.8, 9.0),
        stripe_slope=rng.choice([0.0, 1.0]) * rng.uniform(0.5, 4.0),
        stripe_share=rng.uniform(0.15, 0.5),
    )


def _photographed(rng: np.random.Generator, brightness: float, contrast: float) -> CableLook:
    # Dark flanks take away what little sets a bright cable off.
    most_flank = min(0.75, 0.15 + 1.5 * contrast / max(brightness, 1.0))
    return CableLook(
        brightness,
        braid_amplitude=_some(rng, 0.55, 0.05, 0.45),
        braid_period=rng.uniform(0.35, 1.6),
        braid_slope=rng.uniform(0.5, 4.0),
        flank=rng.uniform(0.0, most_flank),
        gloss=_some(rng, 0.5, 5.0, 110.0),
        gloss_sharpness=rng.uniform(4.0, 40.0),
        uneven=_some(rng, 0.5, 0.02, 0.15),
        dimming=_some(rng, 0.5, -0.05, 0.05),
    )


def _shaded(rng: np.random.Generator, brightness: float, contrast: float) -> CableLook:
    return CableLook(
        brightness,
        flank=rng.uniform(0.0, min(0.9, 0.2 + 1.5 * contrast / max(brightness, 1.0))),
        gloss=_some(rng, 0.4, 10.0, 90.0),
        gloss_sharpness=rng.uniform(8.0, 60.0),
        bead=_some(rng, 0.35, 0.05, 0.4),
        bead_period=rng.uniform(0.5, 3.0),
    )


def _flat(rng: np.random.Generator, brightness: float, contrast: float) -> CableLook:
    return CableLook(
        brightness,
        flank=_some(rng, 0.2, 0.0, min(0.3, contrast / 255.0)),
        outline=_some(rng, 0.4, 0.2, 1.0),
    )


def _faceted(rng: np.random.Generator, brightness: float, contrast: float) -> CableLook:
    # What lies in the shade keeps half of what sets the cable off.
    return CableLook(
        brightness,
        gloss=_some(rng, 0.4, 5.0, 70.0),
        gloss_sharpness=rng.uniform(4.0, 30.0),
        bead=_some(rng, 0.2, 0.03, 0.2),
        bead_period=rng.uniform(0.5, 3.0),
        facing=rng.uniform(0.2, min(0.75, 0.2 + 0.5 * contrast / max(brightness, 1.0))),
        facets=int(rng.choice([0, 3, 4, 6, 8])),
    )


_CABLES: dict[str, Callable[[np.random.Generator, float, float], CableLook]] = {
    "photograph": _photographed,
    "shaded": _shaded,
    "plain": _flat,
    "faceted": _faceted,
}
