"""The searches of BVH and BroadPhase."""

from __future__ import annotations

from typing import Any, Callable, Literal, Optional, Sequence, Tuple, overload

import numpy as np

from . import _arrays

Progress = Callable[[int, int], object]
# One box, and several. An array can be either.
Box = Sequence[float]
Boxes = Sequence[Sequence[float]]


class Searches:
    """The searches that `BVH` and `BroadPhase` share. The objects of the second are
    its bodies, whose masks are their categories."""

    __slots__ = ()

    _tree: Any  # the compiled part

    def query(self, boxes: Any, *, within: Any = None, mask: Optional[int] = None,
              threads: Optional[int] = 1, progress: Optional[Progress] = None) -> np.ndarray:
        """Finds the objects that overlap boxes, or that are near them.

        Parameters
        ----------
        boxes : array_like, shape (m, 2 d) or (2 d,)
            As in `BVH`, in the dimensions of the tree.
        within : float or array_like, shape (m,), optional
            Finds the objects whose distance from the box is at most `within`.
        mask : int, optional
            Finds only the objects whose mask has one of these 32 bits.
        threads, progress
            As in `BVH`.

        Returns
        -------
        ndarray of int64, shape (2, n) or (n,)
            `rows, ids`: object `ids[i]` overlaps box `rows[i]`. `rows` ascend.
            The ids of one row are in no particular order, but equal calls
            return the same order. For one box of shape (2 d,) only the ids, of
            shape (n,).

        Notes
        -----
        The results take 16 bytes per pair, and 8 more during the call. If that
        is too much, use `BVH.query_batches`. Ids are int64 because NumPy converts
        any other index to it.

        Examples
        --------
        >>> import halfspace as hs
        >>> tree = hs.BVH([[0, 0, 1, 1], [2, 2, 3, 3]])
        >>> rows, ids = tree.query([[0, 0, 2, 2], [5, 5, 6, 6], [1, 0, 2, 1]])
        >>> rows
        array([0, 0, 2])
        >>> tree.query([3, 3, 4, 4])
        array([1])
        >>> tree.set_masks([1, 2])
        >>> tree.query([0, 0, 2, 2], mask=2)
        array([1])
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1 and within is None:
            ids = self._tree.query_one(boxes, _arrays.mask(mask), False)
            if ids is not None:
                return ids
        if within is None:
            table = self._boxes(boxes)
        else:
            table = _arrays.boxes(boxes, "boxes", self.dims)
            table = _arrays.rounded_boxes(table, within)
        return self._query(table, _arrays.how(mask, threads, progress))

    def query_sphere(self, centers: Any, radii: Any, *, mask: Optional[int] = None,
                     threads: Optional[int] = 1, progress: Optional[Progress] = None) -> np.ndarray:
        """Finds the objects that spheres touch: those at most `radii` from `centers`.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or
        one for each center. float64 spheres are enclosed. Results are those of
        `query`. A center can be infinite: a finite radius then touches only boxes
        that reach as far, and an infinite one all boxes, as in `query(within=)`.
        """
        spheres = _arrays.query_spheres(centers, radii, self.dims)
        return self._query(spheres, _arrays.how(mask, threads, progress))

    def _query(self, table: _arrays.Table, how: _arrays.How) -> np.ndarray:
        found = self._tree.query(table.arrays, how)
        return found[1] if table.single else found

    @overload
    def count(self, boxes: Box, *, mask: Optional[int] = ...,
              threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> int: ...

    @overload
    def count(self, boxes: Boxes, *, mask: Optional[int] = ...,
              threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> np.ndarray: ...

    @overload
    def count(self, boxes: Any, *, mask: Optional[int] = ...,
              threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> Any: ...

    def count(self, boxes: Any, *, mask: Optional[int] = None, threads: Optional[int] = 1,
              progress: Optional[Progress] = None) -> Any:
        """Counts the objects that overlap each box.

        Returns an array of int64 with the shape (m,), or an int for one box.
        Arguments are those of `query`.
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1:
            count = self._tree.count_one(boxes, _arrays.mask(mask))
            if count is not None:
                return count
        table = self._boxes(boxes)
        counts = self._tree.count(table.arrays, _arrays.how(mask, threads, progress))
        return int(counts[0, 0]) if table.single else counts[:, 0]

    @overload
    def any(self, boxes: Box, *, mask: Optional[int] = ...,
            threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> bool: ...

    @overload
    def any(self, boxes: Boxes, *, mask: Optional[int] = ...,
            threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> np.ndarray: ...

    @overload
    def any(self, boxes: Any, *, mask: Optional[int] = ...,
            threads: Optional[int] = ..., progress: Optional[Progress] = ...) -> Any: ...

    def any(self, boxes: Any, *, mask: Optional[int] = None, threads: Optional[int] = 1,
            progress: Optional[Progress] = None) -> Any:
        """Returns for each box whether an object overlaps it.

        Returns an array of bool with the shape (m,), or a bool for one box.
        Arguments are those of `query`.
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1:
            found = self._tree.any_one(boxes, _arrays.mask(mask))
            if found is not None:
                return found >= 0
        if self._tree.is_exact:
            return self.count(boxes, mask=mask, threads=threads, progress=progress) > 0
        table = self._boxes(boxes)
        ids = self._tree.any(table.arrays, _arrays.how(mask, threads, progress))
        return int(ids[0, 0]) >= 0 if table.single else ids[:, 0] >= 0

    def nearest(self, points: Any, k: int = 1, *, max_distance: float = float("inf"),
                exclusive: bool = False, all_ties: bool = False, mask: Optional[int] = None,
                threads: Optional[int] = 1,
                progress: Optional[Progress] = None) -> Tuple[np.ndarray, np.ndarray]:
        """Finds the k objects that are nearest to each point or box.

        Parameters
        ----------
        points : array_like, shape (m, d), (d,), (m, 2 d) or (2 d,)
            Points, or boxes as in `query`.
        k : int
            At least 1. If it is above the number of objects, `max(len(tree), 1)` takes
            its place.
        max_distance : float
            Objects that are farther away are not found.
        exclusive : bool
            Leaves out the objects whose box is equal to the query as float32,
            such as the query itself if the tree has it. Not with octahedra.
        all_ties : bool
            Also finds all objects that are as far as the last of the k.
        mask, threads, progress
            As in `query`.

        Returns
        -------
        ids : ndarray of int64, shape (m, k) or (k,)
            The nearest object first. -1 if there are fewer than k within
            `max_distance`, or within about 2^64, the largest distance whose
            square is a float32. With `all_ties` it is `rows, ids`, of shape (2, n)
            or (n,), as `query` returns, and without -1.
        distances : ndarray of float32, shape (m, k) or (k,)
            The Euclidean distances of the boxes, within 2^-20 (relative), and 0
            for boxes that touch. inf if there are fewer than k. For a point of
            float64 it is the distance of the box of floats around the point. With
            `all_ties` it has the shape (n,).

        Notes
        -----
        Call `BroadPhase.update` before it where other threads move bodies and query:
        otherwise each search can copy the tree.

        Examples
        --------
        >>> import halfspace as hs
        >>> tree = hs.BVH([[0, 0, 1, 1], [4, 0, 5, 1]])
        >>> tree.nearest([2, 0], k=2)
        (array([0, 1]), array([1., 2.], dtype=float32))
        >>> (rows, ids), distances = tree.nearest([[2.5, 0], [9, 0]], all_ties=True)
        >>> rows, ids, distances
        (array([0, 0, 1]), array([0, 1, 1]), array([1.5, 1.5, 4. ], dtype=float32))
        """
        table = _arrays.points_or_boxes(points, "points", self.dims)
        ids, distances = self._tree.nearest(
            table.arrays,
            _arrays.neighbours(k),
            _arrays.not_negative(max_distance, "max_distance"),
            bool(exclusive),
            bool(all_ties),
            _arrays.how(mask, threads, progress),
        )
        if not table.single:
            return ids, distances
        return (ids[1], distances) if all_ties else (ids[0], distances[0])

    @overload
    def raycast(self, origins: Any, directions: Any, max_t: Any = ..., *,
                all_hits: Literal[True], mask: Optional[int] = ...,
                threads: Optional[int] = ..., progress: Optional[Progress] = ...
                ) -> Tuple[np.ndarray, np.ndarray]: ...

    @overload
    def raycast(self, origins: Any, directions: Any, max_t: Any = ..., *,
                all_hits: bool = ..., mask: Optional[int] = ...,
                threads: Optional[int] = ..., progress: Optional[Progress] = ...
                ) -> Tuple[Any, Any]: ...

    def raycast(self, origins: Any, directions: Any, max_t: Any = float("inf"), *,
                all_hits: bool = False, mask: Optional[int] = None, threads: Optional[int] = 1,
                progress: Optional[Progress] = None) -> Tuple[Any, Any]:
        """Finds the first box that each ray enters, or all.

        A ray has the points `origin + t * direction` with `0 <= t <= max_t`.

        Parameters
        ----------
        origins, directions : array_like, shape (m, d) or (d,)
            One of the two can have the shape (d,) for all rays. float64 is
            rounded to the nearest float32, so a ray can miss a box that it
            only touches: at 500 000 it is off by up to 0.016. A finite
            direction, not 0, that float32 rounds to 0 or infinity is an error.
            An infinite coordinate of an origin limits nothing on its axis.
        max_t : float or array_like of shape (m,)
            In multiples of the direction.
        all_hits : bool
            Finds all boxes that each ray enters.
        mask, threads, progress
            As in `query`.

        Returns
        -------
        ids : ndarray of int64, shape (m,)
            -1 if the ray enters no box. Of boxes with equal t, the least id.
            With `all_hits` it is `rows, ids`, of shape (2, n), and those of a row
            are in the order of t, then of the ids.
        t : ndarray of float32, shape (m,)
            At most the exact value, and less by at most 2^-18 (relative) plus
            the rounding of the ray. 0 if the origin is inside, and inf if the
            ray enters no box. With `all_hits` it has the shape (n,).

        For one ray `ids` and `t` are numbers, or with `all_hits` arrays of shape
        (n,).

        Examples
        --------
        >>> import halfspace as hs
        >>> tree = hs.BVH([[1, 0, 2, 1], [4, 0, 5, 1]])
        >>> ids, t = tree.raycast([[0, 0.5], [3, 0.5]], [1, 0])
        >>> ids
        array([0, 1])
        >>> ids, t = tree.raycast([0, 0.5], [1, 0], all_hits=True)
        >>> ids, t.round(4)
        (array([0, 1]), array([1., 4.], dtype=float32))
        """
        starts = _arrays.points(origins, "origins", self.dims)
        how = _arrays.how(mask, threads, progress)
        return self._cast(starts, "origins", directions, max_t, all_hits, how)

    @overload
    def boxcast(self, boxes: Any, directions: Any, max_t: Any = ..., *,
                all_hits: Literal[True], mask: Optional[int] = ...,
                threads: Optional[int] = ..., progress: Optional[Progress] = ...
                ) -> Tuple[np.ndarray, np.ndarray]: ...

    @overload
    def boxcast(self, boxes: Any, directions: Any, max_t: Any = ..., *,
                all_hits: bool = ..., mask: Optional[int] = ...,
                threads: Optional[int] = ..., progress: Optional[Progress] = ...
                ) -> Tuple[Any, Any]: ...

    def boxcast(self, boxes: Any, directions: Any, max_t: Any = float("inf"), *,
                all_hits: bool = False, mask: Optional[int] = None, threads: Optional[int] = 1,
                progress: Optional[Progress] = None) -> Tuple[Any, Any]:
        """Finds the first box of the tree that each box touches on its way, or all.

        A box moves by t times its direction. float64 boxes are enclosed. The
        rest is as in `raycast`.
        """
        starts = _arrays.boxes(boxes, "boxes", self.dims)
        how = _arrays.how(mask, threads, progress)
        return self._cast(starts, "boxes", directions, max_t, all_hits, how)

    @overload
    def spherecast(self, centers: Any, radii: Any, directions: Any, max_t: Any = ..., *,
                   all_hits: Literal[True], mask: Optional[int] = ...,
                   threads: Optional[int] = ..., progress: Optional[Progress] = ...
                   ) -> Tuple[np.ndarray, np.ndarray]: ...

    @overload
    def spherecast(self, centers: Any, radii: Any, directions: Any, max_t: Any = ..., *,
                   all_hits: bool = ..., mask: Optional[int] = ...,
                   threads: Optional[int] = ..., progress: Optional[Progress] = ...
                   ) -> Tuple[Any, Any]: ...

    def spherecast(self, centers: Any, radii: Any, directions: Any, max_t: Any = float("inf"), *,
                   all_hits: bool = False, mask: Optional[int] = None, threads: Optional[int] = 1,
                   progress: Optional[Progress] = None) -> Tuple[Any, Any]:
        """Finds the first box that each sphere touches on its way, or all.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or one for
        each center. float64 spheres are enclosed. The rest is as in `boxcast`.
        """
        starts = _arrays.spheres(centers, radii, self.dims)
        how = _arrays.how(mask, threads, progress)
        return self._cast(starts, "centers", directions, max_t, all_hits, how)

    def _cast(self, starts: _arrays.Table, name: str, directions: Any, max_t: Any, all_hits: bool,
              how: _arrays.How) -> Tuple[Any, Any]:
        arrays, motions, single = _arrays.casts(starts, name, directions, max_t, self.dims)
        ids, t = self._tree.cast(arrays, motions, bool(all_hits), how)
        if all_hits:
            return (ids[1] if single else ids), t
        return (int(ids[0, 0]), float(t[0, 0])) if single else (ids[:, 0], t[:, 0])

    def pairs_of(self, ids: Any, *, margin: float = 0.0, mask: Optional[int] = None,
                 wanted: Any = None) -> np.ndarray:
        """Finds the pairs of an object of the set `ids` and any other object.

        Returns an array of int64 with the shape (n, 2), whose first column is
        of the set. The boxes of a pair are at most `margin` apart on each axis.
        A pair of two objects of the set is found once. A margin that is no
        float32 is rounded up. `collides_with` of a body is not read.

        With `mask`, the masks of both objects have one of its bits.
        `wanted` is a mask, or one for each id: an object of the set is paired with
        the objects whose mask has a bit of it. If both are in the set, the
        mask of either is enough.
        """
        chosen, none = _arrays.ids(ids, "ids"), np.empty(0, np.uint32)
        return self._tree.pairs_of(
            chosen,
            _arrays.margin(margin),
            _arrays.mask(mask),
            none if wanted is None else _arrays.masks(wanted, "wanted", len(chosen)),
        )

    @property
    def dims(self) -> int:
        """The number of dimensions, 2 or 3."""
        return self._tree.dims

    def __len__(self) -> int:
        """The number of objects."""
        return self._tree.size()

    def _boxes(self, value: Any) -> _arrays.Table:
        return _arrays.boxes(value, "boxes", self.dims)

    def _rows(self, ids: Any, boxes: Any) -> Tuple[_arrays.Arrays, np.ndarray]:
        table, wanted = self._boxes(boxes), _arrays.ids(ids, "ids")
        if len(wanted) != table.length:
            raise ValueError(
                f"ids: expected one id for each of {table.length} boxes, got {len(wanted)}"
            )
        return table.arrays, wanted
