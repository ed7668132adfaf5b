"""Boxes of meshes, and the instruction sets."""

import os
import subprocess
import sys

import halfspace as hs
import numpy as np
import pytest


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
def test_bounds_of_triangles(rng, dims, dtype):
    vertices = (100 * rng.random((50, dims))).astype(dtype)
    faces = rng.integers(0, 50, (200, 3))
    boxes = hs.bounds_of_triangles(vertices, faces)
    corners = vertices[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    assert boxes.dtype == np.float32 and boxes.shape == (200, 2 * dims)
    assert (boxes[:, :dims] <= low).all() and (boxes[:, dims:] >= high).all()
    assert (np.nextafter(boxes[:, :dims], np.float32(np.inf)) > low).all()
    assert (np.nextafter(boxes[:, dims:], np.float32(-np.inf)) < high).all()
    assert len(hs.BVH(boxes)) == 200
    assert hs.bounds_of_triangles(vertices, []).shape == (0, 2 * dims)


def test_targets():
    names = hs.targets()
    assert names and all(isinstance(name, str) for name in names)
    run = subprocess.run([sys.executable, "-c", "import halfspace as hs; hs.BVH([[0, 0, 1, 1]])"],
                         env={**os.environ, "HALFSPACE_TARGET": "NONE"}, capture_output=True,
                         text=True)
    assert "ValueError: HALFSPACE_TARGET: " in run.stderr and "NONE" in run.stderr


# More than 8191 queries of a large tree are sorted first.
@pytest.fixture(params=[(3000, 3000), (200_000, 9000)])
def scene(request, rng):
    """Triangles beside each other, of which triangle i has Z = i, and places in some."""
    count, places = request.param
    order, z = rng.permutation(count).astype(float), np.arange(count)
    x = np.stack([3 * order, 3 * order + 2, 3 * order], axis=1)
    triangles = np.stack([x, np.tile([0, 0, 2], (count, 1)), z[:, None].repeat(3, axis=1)], axis=2)
    some = rng.choice(count, places, replace=False)
    return triangles, some, np.stack([x[some, 0] + 0.5, np.full(places, 0.5), some], axis=1)


def mesh_of(triangles):
    return hs.TriangleMesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


def test_rays_hit_triangles(rng, scene):
    triangles, _, places = scene
    both = np.concatenate([triangles, triangles - [0, 0, 10]])
    mesh, down = mesh_of(both), [0, 0, -2]
    beside = places + [1, 1, 5]  # in the box, and not in the triangle
    starts = rng.permutation(np.concatenate([places + [0, 0, 5], beside]))
    its = starts[:, 2].astype(int) - 5
    is_hit = starts[:, 1] < 1
    ids, t = mesh.raycast(starts, down, 9, threads=2)
    np.testing.assert_array_equal(ids, np.where(is_hit, its, -1))
    np.testing.assert_array_equal(t, np.where(is_hit, 2.5, np.inf))
    (rows, ids), t = mesh.raycast(starts, down, 9, all_hits=True)
    np.testing.assert_array_equal(rows, np.flatnonzero(is_hit).repeat(2))
    np.testing.assert_array_equal(ids.reshape(-1, 2), its[is_hit, None] + [0, len(triangles)])
    np.testing.assert_array_equal(t.reshape(-1, 2), [[2.5, 7.5]] * len(places))
    assert mesh.raycast(starts[0], down) == tuple(
        column[0] for column in mesh.raycast(starts[:1], down))
    np.testing.assert_array_equal(mesh.occluded(starts, down, 9, threads=2), is_hit)
    assert mesh.occluded(starts[0], down) is bool(is_hit[0])
    assert len(mesh) == len(both) and repr(mesh) == f"<halfspace.TriangleMesh: {len(both)} triangles>"


def test_closest_points(scene):
    triangles, rows, places = scene
    mesh, points = mesh_of(triangles), places + [0, 0, 0.25]
    points[::2, 1] = -1  # an edge is closest
    ids, distances, closest = mesh.closest_point(points, threads=2)
    np.testing.assert_array_equal(ids, rows)
    exact = np.where(np.arange(len(rows)) % 2, 0.25, np.hypot(1, 0.25)).astype(np.float32)
    np.testing.assert_array_equal(distances, exact)
    np.testing.assert_array_equal(closest, np.stack(
        [points[:, 0], points[:, 1].clip(0), rows], axis=1))
    one = mesh.closest_point(points[5])
    assert one[:2] == (ids[5], distances[5]) and one[2].tolist() == closest[5].tolist()
    # Triangles are rounded to the nearest floats.
    some = 0.1 * triangles[:3000]
    assert (mesh_of(some).closest_point(np.float32(some[:, 0]))[1] == 0).all()
    near = mesh.closest_point(points, max_distance=0.25)
    np.testing.assert_array_equal(near[0], np.where(exact <= 0.25, rows, -1))
    assert np.isnan(near[2][::2]).all() and np.isinf(near[1][::2]).all()


def wall(corner, rows=19, side=30):
    """722 triangles, which are 10 high, and the way out of the wall."""
    along, up = (side * grid[..., None] for grid in np.mgrid[: rows + 1, : rows + 1] / rows)
    way, up = np.array([np.cos(0.3), np.sin(0.3), 0]), up / 3 * [0, 0, 1]
    places = corner + along * way + up
    a, b, c, d = places[:-1, :-1], places[1:, :-1], places[1:, 1:], places[:-1, 1:]
    triangles = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    return triangles, np.array([-way[1], way[0], 0])


# A step of float32 is 6 cm here. Without an origin, nearly all are wrong.
@pytest.mark.parametrize("dtypes", [(np.float64, np.float64), (np.float32, np.float64)])
def test_a_millimetre_in_national_coordinates(dtypes):
    triangles, out = wall([528_980.25, 183_526.73, 12.1])
    triangles = triangles.astype(dtypes[0])
    everyone, middles = np.arange(len(triangles)), triangles.astype(float).mean(axis=1)
    if dtypes[0] == np.float32:  # now crooked
        out = np.cross(*(triangles[:, 1:] - triangles[:, :1]).astype(float).transpose(1, 0, 2))
        out /= -np.linalg.norm(out, axis=1, keepdims=True)
    mesh = mesh_of(triangles)
    assert len(triangles) == 722
    for side in (0.001, -0.001):
        starts = (middles + side * out).astype(dtypes[1])
        step = 15 * 2.0**-24  # of the distance from the middle
        ids, t = mesh.raycast(starts, -np.sign(side) * out)
        np.testing.assert_array_equal(ids, everyone)
        np.testing.assert_allclose(t, 0.001, rtol=0, atol=4 * step)
        ids, _ = mesh.raycast(starts, np.sign(side) * out, 5)
        assert dtypes[0] == np.float32 or (ids == -1).all()
        (rows, ids), _ = mesh.raycast(
            starts, -np.sign(side) * out, 0.002, all_hits=True, threads=2)
        np.testing.assert_array_equal([rows, ids], [everyone, everyone])
        ids, distances, closest = mesh.closest_point(starts)
        np.testing.assert_array_equal(ids, everyone)
        np.testing.assert_allclose(distances, 0.001, rtol=0, atol=4 * step)
        assert closest.dtype == np.float64
        np.testing.assert_allclose(closest, middles, rtol=0, atol=4 * step)


def test_an_origin_changes_no_other_answer(scene):
    triangles, some, places = scene
    triangles, places = triangles + [2.0**24, 0, 0], places + [2.0**24, 0, 0.25]
    mesh = mesh_of(triangles)
    for got in (mesh.raycast(places, [0, 0, -1], 1, threads=2),
                mesh.closest_point(places, max_distance=0.3, threads=2)):
        np.testing.assert_array_equal(got[0], some)
        np.testing.assert_array_equal(got[1], 0.25)
    np.testing.assert_array_equal(mesh.occluded(places, [0, 0, -1], 0.2), False)
    empty = mesh_of(np.empty((0, 3, 3)))
    assert empty.raycast([0, 0, 0.1], [1, 0, 0]) == (-1, np.inf)
    point = mesh_of(np.ones((3, 3, 3)))
    assert point.raycast([0, 0, 0], [1, 1, 1])[0] == -1 and point.closest_point([0, 0, 0])[0] == 0
    infinite = mesh_of(np.array([[[np.inf, 0, 0]] * 3, [[1.0, 0, 0]] * 3]))
    assert infinite.closest_point([1, 0, 2])[:2] == (1, 2)
