"""Rays and closest points on triangles."""

from __future__ import annotations

from typing import Any, Optional, Tuple, Union

import numpy as np

from . import _arrays, _halfspace
from ._searches import Progress


class TriangleMesh:
    """Triangles that do not move: the first hits of rays, and closest points.

    The id of a triangle is its row in `faces`. The mesh copies its vertices. A
    triangle with an infinity is never found.

    Coordinates of float64 are rounded to the nearest float32. On an axis where the
    middle of the mesh is farther from 0 than 1.5 times its longest side, the mesh
    subtracts the middle first, from vertices, origins and points: they are off by up to
    2^-24 of the distance from it. Vertices of float32 then lose nothing. On other axes,
    they are off by up to 2^-24 of themselves. Directions are rounded to the nearest
    float32.

    Parameters
    ----------
    vertices : array_like, shape (v, 3)
    faces : array_like, shape (n, 3)
        The indices of the three vertices of each triangle.

    Examples
    --------
    >>> import halfspace as hs
    >>> mesh = hs.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh.raycast([0.2, 0.2, 2], [0, 0, -1])
    (0, 2.0)
    >>> mesh.closest_point([0, 0, 1])
    (0, 1.0, array([0., 0., 0.]))
    """

    def __init__(self, vertices: Any, faces: Any) -> None:
        points = _arrays.points(vertices, "vertices", 3)
        indices = _arrays.faces(faces, "faces", points.length)
        (array,) = points.arrays
        self._origin = np.zeros(3)
        if points.length:
            low, high = array.min(axis=0).astype(float), array.max(axis=0).astype(float)
            with np.errstate(invalid="ignore"):
                is_far = abs(low + high) > 3 * (high - low).max()
                # A float32 that is so near subtracts exactly from one.
                middle = ((low + high) / 2).astype(np.float32)
            self._origin[is_far] = middle[is_far]
        self._mesh = _halfspace.Mesh(self._near(points).arrays, indices)

    def raycast(self, origins: Any, directions: Any, max_t: Any = float("inf"), *,
                all_hits: bool = False, threads: Optional[int] = 1,
                progress: Optional[Progress] = None) -> Tuple[Any, Any]:
        """Finds the first triangle that each ray hits, from either side, or all.

        The arguments and results are those of `BVH.raycast`. Whether a ray hits a
        triangle is exact: the edges and corners belong to it, so no ray passes between
        two triangles that share an edge. A ray through the edge hits both, so the parity
        of the hits does not say whether a point is inside of a closed mesh. A triangle
        without an area, or in whose plane the ray lies, is not hit. `t` is within one
        float32 of the exact value. Of triangles with the same `t`, the first is the one
        with the least id.
        """
        rays, single = self._rays(origins, directions, max_t)
        ids, t = self._mesh.cast(rays, bool(all_hits), _arrays.threads(threads), progress)
        if all_hits:
            return (ids[1] if single else ids), t
        return (int(ids[0, 0]), float(t[0, 0])) if single else (ids[:, 0], t[:, 0])

    def occluded(self, origins: Any, directions: Any, max_t: Any = float("inf"), *,
                 threads: Optional[int] = 1,
                 progress: Optional[Progress] = None) -> Union[np.ndarray, bool]:
        """Whether each ray hits any triangle.

        Arguments are those of `raycast`. Returns an array of bool, or one bool.
        """
        rays, single = self._rays(origins, directions, max_t)
        hits = self._mesh.occluded(rays, _arrays.threads(threads), progress)
        return bool(hits[0, 0]) if single else hits[:, 0] != 0

    def closest_point(self, points: Any, *, max_distance: float = float("inf"),
                      threads: Optional[int] = 1,
                      progress: Optional[Progress] = None) -> Tuple[Any, Any, np.ndarray]:
        """Finds the point of the mesh that is closest to each point.

        `points` have the shape (m, 3) or (3,). Returns `ids, distances, closest`: the
        closest triangle of each point, the distance and the point of the triangle, of
        shape (m,), (m,) and (m, 3). Of triangles at the same distance, the one with the
        least id. If none is within `max_distance`, they are -1, inf and NaN. Distances
        are computed in float64 and rounded to float32.
        """
        table = _arrays.points(points, "points", 3)
        ids, distances, closest = self._mesh.closest_points(
            self._near(table).arrays,
            _arrays.not_negative(max_distance, "max_distance"),
            _arrays.threads(threads),
            progress,
        )
        closest = closest + self._origin
        if table.single:
            return int(ids[0, 0]), float(distances[0, 0]), closest[0]
        return ids[:, 0], distances[:, 0], closest

    def __len__(self) -> int:
        """The number of triangles."""
        return int(self._mesh.size)

    def __repr__(self) -> str:
        return f"<halfspace.TriangleMesh: {len(self)} triangles>"

    def _near(self, points: _arrays.Table) -> _arrays.Table:
        """The points less the origin, as float32."""
        if self._origin.any():
            points = points.minus(self._origin)
        return points._replace(arrays=_arrays.floats(points.arrays))

    def _rays(self, origins: Any, directions: Any, max_t: Any) -> Tuple[_arrays.Arrays, bool]:
        starts = self._near(_arrays.points(origins, "origins", 3))
        rays, _, single = _arrays.casts(starts, "origins", directions, max_t, 3)
        return rays, single
