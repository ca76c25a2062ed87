import numpy as np
import pytest
from scipy.ndimage import center_of_mass, label, map_coordinates

from simulation.overhead_camera import overhead_camera_model
from simulation.render.primitives import Material, capsules, join
from simulation.render.renderer import Renderer
from simulation.render.sensor import SensorParameters, expose, measure_depth
from simulation.render.shapes import cable_shapes, smooth_line
from simulation.table_cell_config import CameraConfig

RADIUS_M = 0.0033
TABLE_M = (1.0, 0.75)
CAMERA = overhead_camera_model(CameraConfig())


@pytest.fixture(scope="module")
def renderer():
    return Renderer(CAMERA, TABLE_M, np.random.default_rng(0))


def plug_poses(nodes_m):
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[:, :3, 3] = nodes_m[[0, -1]]
    return poses


def cable(nodes_m):
    return cable_shapes(nodes_m, RADIUS_M, plug_poses(nodes_m))


def wave(amplitude_m=0.1, height_m=RADIUS_M):
    x = np.linspace(-0.4, 0.4, 161)
    return np.column_stack([x, amplitude_m * np.sin(9.0 * x), np.full_like(x, height_m)])


def crossing(upper_angle_rad, lower_angle_rad):
    """Two straight strands of one cable that cross at the origin, joined far outside."""
    s = np.linspace(-0.2, 0.2, 81)

    def strand(angle, height_m):
        return np.column_stack([s * np.cos(angle), s * np.sin(angle), np.full_like(s, height_m)])

    return strand(upper_angle_rad, 3 * RADIUS_M), strand(lower_angle_rad, RADIUS_M)


def strands(*lines):
    return join([cable(line) for line in lines])


def test_the_camera_covers_the_table_at_about_a_millimetre_a_pixel():
    corners = CAMERA.project(np.array([[-0.5, 0.375, 0.0], [0.5, -0.375, 0.0]]))
    assert (corners > 0).all()
    assert (corners < [CAMERA.width_px - 1, CAMERA.height_px - 1]).all()
    assert np.diff(corners, axis=0)[0] == pytest.approx([980.4, 735.3], abs=0.1)


@pytest.mark.parametrize("height_m", [RADIUS_M, 0.1])
def test_the_drawn_cable_lies_where_the_camera_model_projects_it(renderer, height_m):
    nodes_m = wave(height_m=height_m)
    image = expose(renderer.render(cable(nodes_m)), SensorParameters(), np.random.default_rng(1))
    bright = image > 110
    projected = CAMERA.project(nodes_m)
    for u, v in projected[20:-20]:
        column = round(u)
        centre_v = np.interp(column, projected[:, 0], projected[:, 1])
        window = slice(round(v) - 12, round(v) + 13)
        rows = np.flatnonzero(bright[window, column]) + window.start
        assert abs(rows.mean() - centre_v) < 1.0


def test_the_upper_strand_hides_the_lower_one(renderer):
    upper, lower = crossing(0.3, 2.0)
    both = renderer.render(strands(upper, lower)).depth_m
    alone = renderer.render(strands(upper)).depth_m
    centre = (386, slice(510, 522))
    assert both[centre] == pytest.approx(alone[centre])


@pytest.mark.parametrize(("upper", "lower"), [(0.2, 1.8), (1.8, 0.2), (-0.7, 0.8), (0.8, -0.7)])
def test_at_a_crossing_only_the_lower_strand_is_interrupted(renderer, upper, lower):
    rendering = renderer.render(strands(*crossing(upper, lower)))
    image = expose(rendering, SensorParameters(), np.random.default_rng(0)).astype(float)
    steps_m = np.linspace(-0.008, 0.008, 33)
    darkest = {}
    for angle, height_m in ((upper, 3 * RADIUS_M), (lower, RADIUS_M)):
        line = np.column_stack(
            [steps_m * np.cos(angle), steps_m * np.sin(angle), np.full_like(steps_m, height_m)]
        )
        u, v = CAMERA.project(line).T
        darkest[angle] = map_coordinates(image, [v, u], order=1).min()
    assert darkest[upper] > 1.2 * darkest[lower]


def pixels_of(nodes_m):
    return np.round(CAMERA.project(nodes_m)).astype(int).T[::-1]


def test_a_lifted_strand_throws_its_shadow_on_the_side_away_from_the_lamp(renderer):
    line = np.column_stack([np.zeros(81), np.linspace(-0.3, 0.3, 81), np.full(81, 0.05)])
    elsewhere = line + np.array([0.45, 0.0, 0.0])
    empty, lifted = (renderer.render(cable(nodes)).brightness for nodes in (elsewhere, line))
    columns = np.flatnonzero(lifted[386, :800] < 0.8 * empty[386, :800])
    strand = CAMERA.project(line[40:41])[0, 0]
    shadow = columns[np.abs(columns - strand) > 4.0]
    # Similar triangles: the lamp is 0.35 m aside and 1.10 m above the strand.
    assert shadow.mean() - strand == pytest.approx(0.05 * 0.35 / 1.10 / 0.00102, abs=1.5)


def test_an_end_that_hangs_over_the_edge_is_hidden_by_the_table(renderer):
    down = np.linspace(0.0, -0.5, 51)
    hanging = np.column_stack([np.full(51, 0.52), np.zeros(51), down])
    depth_m = renderer.render(cable(hanging)).depth_m
    edge = int(CAMERA.project(np.array([[0.5, 0.0, 0.0]]))[0, 0])
    assert depth_m[376:397, 60 : edge - 4] == pytest.approx(1.15)
    lowest = CAMERA.project(hanging[-1:])[0, 0]
    assert lowest < edge - 40
    assert depth_m[386, edge + 5 : edge + 20].min() < 1.7


def test_what_lies_in_a_shadow_has_no_depth(renderer):
    line = np.column_stack([np.zeros(81), np.linspace(-0.3, 0.3, 81), np.full(81, 0.05)])
    depth_m = renderer.render(cable(line)).depth_m
    missing, count = label(np.isnan(depth_m))
    assert count >= 1
    largest = 1 + np.argmax(np.bincount(missing.ravel())[1:])
    _, column = center_of_mass(missing == largest)
    assert column > CAMERA.project(line[40:41])[0, 0]


def test_depth_is_exact_but_for_its_noise(renderer):
    rendering = renderer.render(cable(wave()))
    assert rendering.depth_m[386, 100] == pytest.approx(1.15)
    top = capsules(
        np.array([[0.3, 0.25, 0.1]]), np.array([[0.35, 0.25, 0.1]]), np.array([0.02]), 0.8,
        Material.PLASTIC,
    )  # fmt: skip
    depth_m = renderer.render(join([cable(wave()), top])).depth_m
    u, v = np.round(CAMERA.project(np.array([[0.325, 0.25, 0.1]]))[0]).astype(int)
    assert depth_m[v, u] == pytest.approx(1.15 - 0.12, abs=2e-3)
    noisy = measure_depth(
        rendering, SensorParameters(depth_noise_m=0.001), np.random.default_rng(0)
    )
    spread = np.nanstd(noisy - rendering.depth_m)
    assert spread == pytest.approx(0.001, rel=0.02)


def test_noise_is_seeded_and_as_strong_as_asked_for(renderer):
    rendering = renderer.render(cable(wave()))
    first, again, other = (
        expose(rendering, SensorParameters(), np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    assert np.array_equal(first, again)
    patch = (slice(600, 700), slice(400, 600))
    spread = (first[patch].astype(float) - other[patch]).std() / np.sqrt(2.0)
    assert 2.0 < spread < 6.0
    quiet = SensorParameters(read_noise=0.0, speckle=0.0)
    assert np.array_equal(
        expose(rendering, quiet, np.random.default_rng(1)),
        expose(rendering, quiet, np.random.default_rng(2)),
    )


def test_cloth_is_dark_and_cable_is_white(renderer):
    nodes_m = wave()
    image = expose(renderer.render(cable(nodes_m)), SensorParameters(), np.random.default_rng(1))
    assert 40 < np.median(image[100:200, 300:700]) < 75
    assert np.median(image[tuple(pixels_of(nodes_m[20:-20]))]) > 150


def test_a_smooth_line_passes_through_its_nodes_without_corners():
    nodes_m = wave()
    line = smooth_line(nodes_m, pieces=4)
    assert line[::4] == pytest.approx(nodes_m)

    def sharpest(points):
        steps = np.diff(points, axis=0)
        steps /= np.linalg.norm(steps, axis=1)[:, None]
        return np.arccos(np.clip((steps[1:] * steps[:-1]).sum(axis=1), -1.0, 1.0)).max()

    assert sharpest(line) < 0.6 * sharpest(nodes_m)
