import numpy as np
import pytest

from simulation.render.primitives import Material, boxes, capsules, join
from simulation.render.raycast import View, cast, image_point, pixel_ray, surface_normal

SIZE = (120, 160)


def straight_down(height_m=1.0, focal_px=150.0):
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = height_m
    return View(pose, focal_px, 0.5 * (SIZE[1] - 1), 0.5 * (SIZE[0] - 1))


def look(primitives, view):
    depth, owner = np.zeros(SIZE, np.float32), np.zeros(SIZE, np.int32)
    cast(primitives, view, 2, depth, owner)
    return depth, owner


def hit_points(depth, owner, index, view):
    for v, u in np.argwhere(owner == index):
        yield np.array(view.pose[:3, 3]) + depth[v, u] * np.array(pixel_ray(view, u, v))


def some_capsules(count, rng, material=Material.PLASTIC):
    starts, ends = rng.uniform(-0.3, 0.3, (2, count, 3))
    return capsules(starts, ends, rng.uniform(0.01, 0.08, count), 0.8, material)


def some_boxes(count, rng):
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = np.linalg.qr(rng.standard_normal((count, 3, 3)))[0]
    poses[:, :3, 3] = rng.uniform(-0.3, 0.3, (count, 3))
    return boxes(poses, rng.uniform(0.02, 0.1, (count, 3)), 0.8, Material.PLASTIC)


def test_rays_and_image_points_are_inverse_to_each_other():
    view = straight_down()
    for u, v in ((0.0, 0.0), (12.3, 99.0), (159.0, 60.5)):
        point = np.array(view.pose[:3, 3]) + 0.7 * np.array(pixel_ray(view, u, v))
        assert image_point(view, tuple(point)) == pytest.approx((u, v, 0.7))


def test_what_hits_a_capsule_lies_at_its_radius_from_its_axis():
    view = straight_down()
    shapes = some_capsules(6, np.random.default_rng(1))
    depth, owner = look(shapes, view)
    for index in set(owner[owner >= 0]):
        start, end, radius = (
            shapes.shape[index][:3], shapes.shape[index][3:6], shapes.shape[index][6],
        )  # fmt: skip
        for point in hit_points(depth, owner, index, view):
            axis = end - start
            share = np.clip((point - start) @ axis / (axis @ axis), 0.0, 1.0)
            assert np.linalg.norm(point - start - share * axis) == pytest.approx(radius, abs=1e-6)


def test_what_hits_a_box_lies_on_one_of_its_faces():
    view = straight_down()
    shapes = some_boxes(6, np.random.default_rng(2))
    depth, owner = look(shapes, view)
    for index in set(owner[owner >= 0]):
        shape = shapes.shape[index]
        for point in hit_points(depth, owner, index, view):
            local = np.abs(shape[:9].reshape(3, 3) @ (point - shape[9:12])) - shape[12:15]
            assert local.max() == pytest.approx(0.0, abs=1e-6)


def test_normals_are_unit_vectors_that_face_the_viewer():
    view = straight_down()
    rng = np.random.default_rng(3)
    shapes = join([some_capsules(4, rng), some_boxes(4, rng)])
    depth, owner = look(shapes, view)
    for index in set(owner[owner >= 0]):
        for point in hit_points(depth, owner, index, view):
            outward = surface_normal(shapes.kind[index], shapes.shape[index], tuple(point))
            assert np.linalg.norm(outward) == pytest.approx(1.0)
            assert np.dot(outward, point - view.pose[:3, 3]) < 1e-6


def test_the_nearest_shape_wins_whatever_the_order():
    view = straight_down()
    shapes = some_capsules(8, np.random.default_rng(4))
    depth, owner = look(shapes, view)
    order = np.random.default_rng(5).permutation(8)
    mixed = type(shapes)(*(column[order] for column in shapes))
    mixed_depth, mixed_owner = look(mixed, view)
    assert np.array_equal(depth, mixed_depth)
    assert np.array_equal(owner, np.where(mixed_owner >= 0, order[mixed_owner], -1))


def test_a_window_cuts_nothing_off():
    # A camera whose principal point lies far aside sees the same shapes at other pixels.
    shapes = some_capsules(8, np.random.default_rng(6))
    view = straight_down()
    _, owner = look(shapes, view)
    _, moved = look(shapes, view._replace(cx=view.cx + 40.0))
    assert np.array_equal(owner[:, :-40], moved[:, 40:])


def test_shapes_behind_or_around_the_camera_are_not_drawn():
    above = capsules(
        np.array([[0.0, 0.0, 1.2], [0.0, 0.0, 0.5]]), np.array([[0.1, 0.0, 1.3], [0.0, 0.0, 2.0]]),
        np.array([0.05, 0.05]), 0.8, Material.PAINT,
    )  # fmt: skip
    _, owner = look(above, straight_down())
    assert (owner == -1).all()


def test_one_ray_a_block_moves_edges_of_painted_bodies_by_less_than_a_block():
    fine = some_capsules(5, np.random.default_rng(7))
    _, fine_owner = look(fine, straight_down())
    painted = fine._replace(material=np.full(5, Material.PAINT, np.int32))
    _, coarse_owner = look(painted, straight_down())
    blocks = coarse_owner.reshape(SIZE[0] // 2, 2, SIZE[1] // 2, 2).transpose(0, 2, 1, 3)
    assert (blocks == blocks[:, :, :1, :1]).all()
    inner = (slice(1, -1), slice(1, -1))
    differs = (fine_owner != coarse_owner)[inner]
    shifted = [
        np.roll(fine_owner, shift, (0, 1))[inner] == coarse_owner[inner]
        for shift in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    assert (~differs | np.any(shifted, axis=0)).all()
