"""Whether a trace can be the whole cable: nothing of it may be left over."""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.coverage import explained_share
from perception.cable.observation import Observation
from perception.cable.types import Points

# A trace that explains less than the first share is not the whole cable, from the second on it
# may be: pixels in the shade of a bundle are not always near its centre lines.
SHARES = (0.86, 0.94)


def wholeness(observation: Observation, path_px: Points) -> float:
    """Return the belief that a trace leaves none of its cable out, in [0, 1].

    Connectors count as explained. As long as no more than two are in view, all that is seen is
    one cable; else only what hangs together with the trace is known to be the same.

    Args:
        observation: What is seen.
        path_px: Centre line of the trace, shape (N, 2).
    """
    graph, cable = observation.graph, observation.mask.cable
    plugs = [graph.edges[number].points_px for number in sorted(graph.plugs)]
    if len(plugs) not in (1, 2):
        cable = _pieces_along(cable, path_px)
    low, high = SHARES
    share = explained_share(cable, np.concatenate([path_px, *plugs]))
    return float(np.clip((share - low) / (high - low), 0.0, 1.0))


def _pieces_along(cable: NDArray[np.bool_], path_px: Points) -> NDArray[np.bool_]:
    """Return the connected pieces of the mask that a path runs over."""
    labels = np.asarray(cv2.connectedComponents(cable.astype(np.uint8))[1])
    limits = np.array([cable.shape[1], cable.shape[0]]) - 1
    columns, rows = np.rint(path_px).astype(int).clip(0, limits).T
    return np.isin(labels, np.unique(labels[rows, columns])) & cable
