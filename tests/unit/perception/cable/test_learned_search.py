import cv2
import numpy as np
import pytest

from perception.cable.tracers.modes import find_modes
from perception.cable.tracers.paths import Ends, Path, checked, distances, repeats
from perception.cable.tracers.rivals import RivalConfig, meeting, reduced
from perception.cable.tracers.search import Search, SearchConfig
from perception.cable.tracers.steps import Outlook
from perception.cable.types import TraceEnd
from perception.models.frames import ScaledImage, cut, scale_image, turned_frame
from perception.models.tracer_crop import CELL, HERE, SIZE, STEP, WIDTH

NO_ENDS = Ends(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))
IMAGE = ScaledImage(np.zeros((400, 400), np.uint8), 1.0, 0.0)


def _path(points, log=-0.1):
    points = np.asarray(points, dtype=float)
    return Path(points, log * np.arange(len(points)))


def _line(start, step, count):
    return np.asarray(start, dtype=float) + np.arange(count)[:, None] * np.asarray(step)


def _straight_on(path):
    """Return the outlook of a network that is sure that the cable goes straight on."""
    cells = np.zeros((SIZE // CELL, SIZE // CELL))
    row, column = round(HERE[1] / CELL), round((HERE[0] + STEP) / CELL)
    cells[row, column] = 1.0
    frame = turned_frame(path.points[-1], path.heading, HERE)
    crop = np.zeros((3, SIZE, SIZE), np.float32)
    return Outlook(frame, crop, cells, 0.0, np.zeros((2, *cells.shape)), clear=True)


def test_modes_share_the_belief():
    cells = np.zeros((32, 32))
    cells[10, 12], cells[10, 13], cells[20, 5] = 0.4, 0.2, 0.3
    first, second = find_modes(cells, least=0.05, most=4)
    assert (first.probability, second.probability) == pytest.approx((0.6, 0.3))
    assert first.point_crop == pytest.approx([2 * (12 + 1 / 3) + 0.5, 20.5], abs=1e-4)
    assert second.point_crop == pytest.approx([10.5, 40.5])


def test_modes_at_the_border_of_the_map():
    cells = np.zeros((32, 32))
    cells[0, 31] = 1.0
    (mode,) = find_modes(cells, least=0.05, most=4)
    assert mode.point_crop == pytest.approx([62.5, 0.5])


def test_frames_go_there_and_back():
    frame = turned_frame(np.array([40.0, 60.0]), np.array([0.6, 0.8]), HERE)
    points = np.random.default_rng(0).normal(size=(5, 2))
    assert frame.back(frame.into(points)) == pytest.approx(points)
    assert frame.into(np.array([[40.0, 60.0]]))[0] == pytest.approx(HERE)
    assert frame.into(np.array([[40.6, 60.8]]))[0] == pytest.approx((HERE[0] + 1.0, HERE[1]))


def test_a_zoomed_crop_shows_the_same_place():
    rows, columns = np.mgrid[:80, :90].astype(np.float32)
    picture = (60.0 + 90.0 * np.sin(0.2 * columns) * np.cos(0.17 * rows)).clip(0, 255)
    image = picture.astype(np.uint8)
    frame = turned_frame(np.array([45.0, 40.0]), np.array([0.8, 0.6]), HERE)
    plain, fine = (cut(scale_image(image, 4.0, 4.0, zoom), frame, 48) for zoom in (1.0, 1.5))
    assert fine.shape == (72, 72)
    shrunk = cv2.resize(fine, plain.shape, interpolation=cv2.INTER_AREA)
    inside = plain[8:40, 8:40]
    assert np.abs(shrunk[8:40, 8:40] - inside).mean() < 0.05 * float(np.ptp(inside))


def test_scaled_points_come_back():
    scaled = scale_image(np.zeros((60, 90), np.uint8), 7.0, 4.5, 1.5)
    points = np.array([[0.0, 0.0], [40.0, 25.0]])
    assert scaled.back(scaled.into(points)) == pytest.approx(points)
    assert scaled.holds(scaled.into(np.array([89.0, 59.0])))
    assert not scaled.holds(scaled.into(np.array([95.0, 30.0])))


def test_distances_to_a_polyline():
    line = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    assert distances(np.array([[5.0, 2.0], [13.0, 14.0]]), line) == pytest.approx([2.0, 5.0])


def test_a_path_ends_at_the_border_and_at_known_ends():
    out = _path(_line((353.0, 200.0), (STEP, 0.0), 6))
    assert checked(out, IMAGE, NO_ENDS).end is TraceEnd.EDGE
    inside = _path(_line((100.0, 200.0), (STEP, 0.0), 6))
    assert checked(inside, IMAGE, NO_ENDS).end is None
    end = inside.points[-1] + (WIDTH, 0.5 * WIDTH)
    facing, passing = (
        Ends(end[None], np.array([way]), np.ones(1)) for way in ((-1.0, 0.0), (0.0, 1.0))
    )
    # The end of a cable that lies across is none of this one's.
    assert checked(inside, IMAGE, passing).end is None
    ended = checked(inside, IMAGE, facing)
    assert ended.end is TraceEnd.ENDPOINT
    assert ended.points[-1] == pytest.approx(end)


def test_at_an_end_that_is_doubted_a_path_may_go_on():
    path = _path(_line((100.0, 200.0), (STEP, 0.0), 6))
    end = path.points[-1] + (WIDTH, 0.0)
    ends = Ends(end[None], np.array([[-1.0, 0.0]]), np.array([0.6]))
    assert checked(path, IMAGE, ends).end is None
    search = Search([path], ends, SearchConfig(leaps=False))
    search.advance(IMAGE, [_straight_on(path)])
    # Belief is divided between the end and the cable that goes on.
    (ended,) = [each for each in search.found() if each.end is TraceEnd.ENDPOINT]
    (alive,) = search.alive
    assert np.exp(ended.log_probability - path.log_probability) == pytest.approx(0.6)
    assert np.exp(alive.log_probability - path.log_probability) == pytest.approx(0.4)
    assert ends.doubtful(alive) is None


def test_going_back_over_oneself_is_noticed_and_crossing_is_not():
    there = _line((100.0, 100.0), (STEP, 0.0), 15)
    bend = there[-1] + np.array([[STEP, 4.0], [STEP, 12.0], [0.0, 14.0]])
    back = _line(there[-1] + (0.0, 1.0), (-STEP, 0.0), 10)
    across = _line((150.0, 60.0), (0.0, STEP), 10)
    assert repeats(np.vstack([there, bend, back]))
    assert not repeats(np.vstack([there, bend, across]))


def test_of_two_ways_that_meet_the_likelier_stays():
    shared = _line((50.0, 100.0), (STEP, 0.0), 5)
    straight = _line(shared[-1] + (STEP, 0.0), (STEP, 0.0), 12)
    bow = straight[:6] + np.array([[0.0, 1.0]]) * np.array([4.0, 8, 4, 1, 0, 0.0])[:, None]
    likely, unlikely = (
        _path(np.vstack([shared, straight]), -0.1),
        _path(np.vstack([shared, bow]), -0.3),
    )
    assert meeting(unlikely, likely) == 10
    (kept,) = reduced([unlikely, likely], RivalConfig(gain=0.0))
    assert np.array_equal(kept.points, likely.points)
    assert kept.logs == pytest.approx(likely.logs)


def test_a_loop_that_only_one_way_explains_counts_for_it():
    shared = _line((50.0, 200.0), (STEP, 0.0), 5)
    straight = _line(shared[-1] + (STEP, 0.0), (STEP, 0.0), 8)
    turns = np.linspace(0.5 * np.pi, -1.5 * np.pi, 16)[1:-1]
    loop = shared[-1] + (STEP, -24.0) + 24.0 * np.column_stack([np.cos(turns), np.sin(turns)])
    round_ = np.vstack([shared, loop, straight[:4]])
    short, long = _path(np.vstack([shared, straight]), -0.05), _path(round_, -0.15)
    (kept,) = reduced([short, long], RivalConfig(gain=0.0))
    assert len(kept.points) == 13
    (kept,) = reduced([short, long], RivalConfig(gain=0.5, most=4.0))
    assert len(kept.points) == len(round_) + 4
    # The loser's share goes to the winner; both ways together stay as likely as they were.
    both = np.logaddexp(long.logs[-1], short.logs[8])
    assert long.logs[-1] < kept.logs[len(round_) - 1] < both
