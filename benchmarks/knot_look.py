"""The look that the thesis measured on: one white cable of 3 m on dark cloth, seen from above."""

import numpy as np

from perception.training.looks import CableLook, Lens, Light, Look, Table


def thesis_look(rng: np.random.Generator) -> Look:
    """Draw a look as the thesis's pictures have it: bright, sharp, in soft light."""
    level, cable = rng.uniform(20.0, 60.0), rng.uniform(215.0, 250.0)
    return Look(
        "photograph",
        Table(level, cable, texture=rng.uniform(0.0, 0.08), folds=True),
        (
            CableLook(
                cable,
                braid_amplitude=rng.uniform(0.0, 0.1),
                braid_period=rng.uniform(0.5, 1.5),
                flank=rng.uniform(0.2, 0.5),
            ),
        ),
        Light(
            rng.uniform(0.0, 2.0 * np.pi),
            slant=rng.uniform(0.2, 0.9),
            shadow=rng.uniform(0.2, 0.5),
            softness=rng.uniform(0.1, 0.4),
            vignette=rng.uniform(0.0, 0.2),
        ),
        Lens(blur_px=rng.uniform(0.4, 0.9), noise=rng.uniform(1.0, 4.0)),
        connectors=True,
    )
