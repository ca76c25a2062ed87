"""Going home when something stops the arms on their way."""

import pytest
from cell_fakes import ArrivingArms, Move, finished

from executive.core.work import InlineWorker
from skills.motion.go_home import MOST_TRIES, GoHome


class StoppedOnTheWay(ArrivingArms):
    """Arms that need so many motions to get home."""

    def __init__(self, stops):
        super().__init__()
        self.stops = stops

    def plan_home(self):
        return Move({}, duration_s=0.0 if self.stops < 0 else 1.5)

    def start(self, move):
        super().start(move)
        self.stops -= 1


@pytest.mark.parametrize("stops", [0, 1, 2])
def test_arms_that_were_stopped_set_out_again(stops):
    arms = StoppedOnTheWay(stops)
    outcome, _ = finished(GoHome(arms, InlineWorker()), {})
    assert outcome.status == "SUCCESS"
    assert len([entry for entry in arms.log if entry[0] == "move"]) == stops + 1


def test_arms_that_never_arrive_are_said_not_to():
    outcome, _ = finished(GoHome(StoppedOnTheWay(99), InlineWorker()), {})
    assert outcome.reason.code == "motion.stopped"
    assert f"{MOST_TRIES} times" in outcome.reason.text
