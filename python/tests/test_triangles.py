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


def test_no_triangles():
    assert hs.bounds_of_triangles([[0, 0, 0]], []).shape == (0, 6)


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
