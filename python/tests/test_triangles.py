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


BAD = [
    ([[0, 0, 0, 0]], [[0, 0, 0]], ValueError, "vertices: expected points of shape (n"),
    ([[0, 0, np.nan]], [[0, 0, 0]], ValueError, "vertices[0]: expected numbers, got Na"),
    ([[0, 0, np.inf]], [[0, 0, 0]], ValueError, "vertices: expected finite coordinates"),
    ([[0, 0]], [0, 0, 0], ValueError, "faces: expected shape (n, 3), got shape (3,)"),
    ([[0, 0]], [[0, 0, 0], [0, 1, 0]], ValueError, "faces[1]: expected indices from 0"),
    ([[0, 0]], [[0, 0, -1]], ValueError, "faces[0]: expected indices from 0 to 0, got"),
    ([[0, 0]], [[0, 0, 0.5]], TypeError, "faces: expected integers, got float64"),
]


@pytest.mark.parametrize("vertices, faces, error, message", BAD)
def test_bad_meshes(vertices, faces, error, message):
    with pytest.raises(error) as raised:
        hs.bounds_of_triangles(vertices, faces)
    assert str(raised.value).startswith(message)


def test_targets():
    names = hs.targets()
    assert names and all(isinstance(name, str) for name in names)
    for name in names[-1:] + ["NONE"]:
        code = "import halfspace as hs; print(hs.BVH([[0,0,1,1]]).query([1,1,2,2]))"
        run = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "HALFSPACE_TARGET": name},
            capture_output=True,
            text=True,
        )
        if name == "NONE":
            assert "ValueError: HALFSPACE_TARGET: " in run.stderr and "NONE" in run.stderr
        else:
            assert run.stdout == "[0]\n"


def test_rays_hit_what_they_hit_one_by_one(rng):
    triangles = rng.random((2000, 1, 3)) + 0.3 * rng.random((2000, 3, 3))
    tree = hs.BVH(np.hstack([triangles.min(axis=1), triangles.max(axis=1)]))
    origins, directions = rng.random((2, 300, 3))
    directions -= 0.5
    ids, t = tree.raycast(origins, directions, 0.8, triangles=triangles, threads=2)
    (rows, hits), far = tree.raycast(origins, directions, 0.8, triangles=triangles,
                                     all_hits=True)
    p, q, r = triangles[:, None].transpose(2, 0, 1, 3)
    normal = np.cross(q - p, r - p)
    with np.errstate(divide="ignore", invalid="ignore"):
        when = (normal * (p - origins)).sum(axis=2) / (normal * directions).sum(axis=2)
    at = origins + when[..., None] * directions
    inside = (when >= 0) & (when <= 0.8)
    for a, b in ((p, q), (q, r), (r, p)):
        inside &= (np.cross(b - a, at - a) * normal).sum(axis=2) >= 0
    # Those of float64 can differ for hits next to an edge.
    expected = np.where(inside, when, np.inf).T
    found = np.full(expected.shape, np.inf)
    found[rows, hits] = far
    differs = np.isinf(found) != np.isinf(expected)
    assert differs.sum() <= 2 and np.isfinite(found).sum() > 300
    both = np.isfinite(found) & ~differs
    np.testing.assert_allclose(found[both], expected[both], rtol=1e-3, atol=1e-5)
    assert (np.lexsort((far, rows)) == np.arange(len(rows))).all()
    np.testing.assert_array_equal(t, found.min(axis=1).astype(np.float32))
    assert (found[np.arange(300), ids][ids >= 0] == t[ids >= 0]).all()
    for i in range(20):
        assert tree.raycast(origins[i], directions[i], 0.8,
                            triangles=triangles) == (ids[i], t[i])
    assert (tree.raycast(origins, directions, triangles=triangles, mask=0)[0] == -1).all()


def test_closest_points(rng):
    triangles = rng.random((1500, 1, 3)) + 0.1 * rng.random((1500, 3, 3))
    tree = hs.BVH(np.hstack([triangles.min(axis=1), triangles.max(axis=1)]))
    points = rng.random((200, 3)) * 1.4 - 0.2
    ids, distances, closest = tree.closest_point(points, triangles, threads=2)
    np.testing.assert_allclose(np.linalg.norm(closest - points, axis=1), distances, atol=1e-6)
    # Each point of a dense grid of each triangle is at least as far.
    u, v = (w.ravel() for w in np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12)))
    u, v = u[u + v <= 1], v[u + v <= 1]
    grid = np.einsum("wk,nkd->nwd", np.stack([1 - u - v, u, v], axis=1), triangles)
    for i in range(len(points)):
        far = np.linalg.norm(grid - points[i], axis=2)
        assert distances[i] <= far.min() + 1e-6 and far.min() < distances[i] + 0.02
        assert far[ids[i]].min() < distances[i] + 0.02
        assert abs(distances[i] - tree.closest_point(points[i], triangles)[1]) == 0
    # Triangles are rounded to the nearest floats.
    assert (tree.closest_point(triangles[:, 0].astype(np.float32), triangles)[1] == 0).all()
    near = tree.closest_point(points, triangles, max_distance=0.05)
    np.testing.assert_array_equal(near[0], np.where(distances <= np.float32(0.05), ids, -1))
    assert np.isnan(near[2][near[0] < 0]).all() and np.isinf(near[1][near[0] < 0]).all()


def test_bad_triangles():
    tree = hs.BVH(np.tile([0, 0, 0, 1, 1, 1.0], (3, 1)))
    good = np.ones((3, 3, 3))
    flat = hs.BVH([[0, 0, 1, 1]])
    bad = np.where(np.arange(27).reshape(3, 3, 3) == 12, np.nan, 1)
    closest = lambda *its, **how: tree.closest_point([0, 0, 0], *its, **how)
    for call, text in (
        (lambda: closest(np.ones((3, 9))), r"triangles: expected shape \(n, 3, 3\), got"),
        (lambda: closest(good[:2]), "one for each of the ids up to 2, got 2"),
        (lambda: closest(bad), "triangles.1.: expected numbers, got NaN"),
        (lambda: flat.raycast([0, 0], [1, 0], triangles=good), "3 dimensions, not of 2"),
        (lambda: closest(good, max_distance=-1), "max_distance"),
    ):
        with pytest.raises(ValueError, match=text):
            call()
    assert tree.raycast([0, 0, 0], [1, 1, 1], triangles=good)[0] == -1
    assert closest(good)[0] == 0


def test_many_queries_of_a_large_mesh(rng):
    """They are sorted first. Fewer are not, and find the same."""
    corners = rng.random((200_000, 1, 3)) + 0.02 * rng.random((200_000, 3, 3))
    corners = corners.astype(np.float32)
    tree = hs.BVH(np.hstack([corners.min(axis=1), corners.max(axis=1)]), quality="fast")
    points, ways = rng.random((9000, 3)), rng.normal(size=(9000, 3))
    few = [slice(0, 5000), slice(5000, 9000)]
    for call in [
        lambda some: tree.closest_point(points[some], corners),
        lambda some: tree.raycast(points[some], ways[some], triangles=corners),
        lambda some: (
            tree.raycast(points[some], ways[some], triangles=corners, all_hits=True)[1],
        ),
    ]:
        for whole, *found in zip(call(slice(None)), *map(call, few)):
            assert np.array_equal(whole, np.concatenate(found))
