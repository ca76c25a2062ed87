import numpy as np
import pytest

from perception.cable.bundles import longest_overlap_px, separateness


def there_and_back(apart_px: float, together_px: float) -> np.ndarray:
    """A path that comes back beside itself over a stretch, from a wide turn."""
    x = np.arange(0.0, 600.0, 2.0)
    bump = 60.0 * np.clip(np.abs(x - 300.0) / (together_px / 2.0) - 1.0, 0.0, 1.0)
    out, back = np.column_stack([x, 0.0 * x]), np.column_stack([x, apart_px + bump])[::-1]
    turn = np.linspace(out[-1], back[0], 30)[1:-1] + np.array([80.0, 0.0])
    return np.vstack([out, turn, back])


def test_strands_side_by_side_do_not_overlap():
    assert longest_overlap_px(there_and_back(7.0, 200.0)) == 0.0


def test_strands_upon_each_other_overlap_as_long_as_they_do():
    assert longest_overlap_px(there_and_back(1.0, 100.0)) == pytest.approx(100.0, abs=12.0)
    assert separateness(there_and_back(1.0, 100.0)) == 0.0


@pytest.mark.parametrize("degrees", [90.0, 45.0, 20.0])
def test_a_plain_crossing_stays_believed(degrees):
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    first = np.column_stack([np.arange(-200.0, 200.0, 2.0), np.zeros(200)])
    second = np.outer(np.arange(200.0, -200.0, -2.0), way)
    path = np.vstack([first, [[300.0, 150.0]], second])
    assert separateness(path) == 1.0
