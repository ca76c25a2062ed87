import cv2
import numpy as np

from perception.cable.separation import separate


def _two_cables():
    """Two alike cables that cross once, the second one on top; returns image and truth."""
    lines = np.array([[[20, 60], [420, 240]], [[40, 250], [400, 50]]])
    image, truth = np.full((300, 440), 40, np.uint8), np.zeros((300, 440), np.uint8)
    for number, line in enumerate(lines, start=1):
        for width_px, grey in ((9, 70), (7, 180)):
            # The darker border is what shows which one lies on top.
            cv2.line(image, *map(tuple, line.tolist()), grey, width_px, cv2.LINE_AA)
        cv2.line(truth, *map(tuple, line.tolist()), number, 8)
    noise = np.random.default_rng(0).normal(0.0, 2.0, image.shape)
    return (image + noise).clip(0, 255).astype(np.uint8), truth


def test_two_alike_cables_are_told_apart():
    image, truth = _two_cables()
    traces, labels = separate(image)
    assert len(traces) == 2
    overlaps = [
        [2.0 * ((truth == a) & (labels == b)).sum() / ((truth == a).sum() + (labels == b).sum())
         for b in (1, 2)]
        for a in (1, 2)
    ]  # fmt: skip
    assert max(overlaps[0][0] + overlaps[1][1], overlaps[0][1] + overlaps[1][0]) / 2.0 > 0.9


def test_an_empty_table_shows_no_cables():
    traces, labels = separate(np.full((100, 120), 60, np.uint8))
    assert traces == ()
    assert not labels.any()
