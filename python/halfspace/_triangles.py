"""Boxes of meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _halfspace


def bounds_of_triangles(vertices: Any, faces: Any) -> np.ndarray:
    """Returns the box of each triangle of a mesh.

    Parameters
    ----------
    vertices : array_like, shape (v, 3) or (v, 2)
    faces : array_like of integers, shape (n, 3)
        Row i has the indices of the three vertices of triangle i.

    Returns
    -------
    ndarray of float32, shape (n, 6) or (n, 4)
        The minima, then the maxima, as `BVH` reads them. float64 is rounded
        outward.

    Examples
    --------
    >>> import halfspace as hs
    >>> hs.bounds_of_triangles([[0, 0], [2, 1], [1, 3]], [[0, 1, 2]])
    array([[0., 0., 2., 3.]], dtype=float32)
    """
    corners = _arrays.vertices(vertices, "vertices")
    indices = _arrays.faces(faces, "faces", len(corners))
    boxes, bad = _halfspace.bounds_of_triangles(corners, indices)
    if bad:
        # Boxes of everything.
        row = int((boxes[:, 0] == np.finfo(np.float32).min).argmax())
        raise ValueError(
            f"vertices: expected finite coordinates below 2^125, got "
            f"{corners[indices[row]].tolist()} in triangle {row}"
        )
    return boxes
