"""The BVH."""

from __future__ import annotations

import contextlib
import mmap
import os
import pickle
from typing import Any, Callable, Iterator, Optional, Tuple, Type, Union

import numpy as np

from . import _arrays, _files, _halfspace

Progress = Callable[[int, int], object]
Path = Union[str, "os.PathLike[str]"]


class BVH:
    """A bounding volume hierarchy of axis-aligned boxes in 2 or 3 dimensions.

    The id of a box is its row in `boxes`. Boxes that touch overlap. The tree is
    built at once, and changes only by `insert`, `insert_as`, `erase` and `refit`.

    Parameters
    ----------
    boxes : array_like, shape (n, 6) or (n, 4)
        The minima of all axes, then the maxima: `x_min, y_min, z_min, x_max,
        y_max, z_max`. It can also be a pair `(minima, maxima)` of arrays of
        shape (n, 3) or (n, 2), or a tuple of 6 or 4 columns. A column is a
        one-dimensional array, or an object with `__arrow_c_array__`. One box
        has the shape (6,) or (4,).
    quality : "high" or "fast"
        "fast" builds in about a fifth of the time. Queries then take up to 1.4
        times as long. Results are the same.
    threads : int or None
        The number of threads, or None for all CPUs of this process. Results do
        not depend on it.
    progress : callable, optional
        `progress(done, total)` is called up to 20 times a second by the calling
        thread, and once at the end. The two are numbers of boxes or queries, and
        `total` is not 0. An exception in it ends the call. On a terminal:
        `lambda done, total: print(f"\\r{done / total:.0%}", end="")`.

    Notes
    -----
    The tree stores float32. Columns of float32 are read in place, and so are
    columns of float64, whose values are rounded outward: minima down, maxima
    up. So no overlap is missed, and boxes that are less than one float32 step
    apart can be reported as overlapping. To get the exact pairs of float64
    boxes, test the candidates again:

    >>> import numpy as np, halfspace as hs
    >>> a = np.array([[0, 0, 1, 1], [2, 2, 3, 3]], float)
    >>> b = np.array([[1, 1, 2 - 1e-12, 2 - 1e-12]])
    >>> rows, ids = hs.BVH(a).query(b)
    >>> sorted(ids.tolist())
    [0, 1]
    >>> exact = ((b[rows, :2] <= a[ids, 2:]) & (a[ids, :2] <= b[rows, 2:])).all(axis=1)
    >>> rows[exact], ids[exact]
    (array([0]), array([0]))

    A NaN, or a box with min > max, raises ValueError. The exception is the empty
    box, with minima of inf and maxima of -inf: only a query without limits can
    find it. Infinite boxes are allowed. Masked values of a masked array, in any
    argument, raise TypeError.

    Every call releases the interpreter's lock, so threads can query one tree at
    the same time. A change while another thread uses the tree raises
    RuntimeError, except in `with tree.changing():`. Ctrl-C ends a long build,
    refit, query or join. It does not end `insert`, `insert_as`, `erase`, `save` or
    the check of a blob.
    """

    __slots__ = ("_tree", "__weakref__")

    def __init__(
        self,
        boxes: Any,
        *,
        quality: str = "high",
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> None:
        # An array compares element by element.
        if not isinstance(quality, str) or quality not in ("high", "fast"):
            raise ValueError(f'quality: expected "high" or "fast", got {quality!r}')
        table = _arrays.boxes(boxes, "boxes", most=_arrays.MOST_OBJECTS)
        self._tree = _halfspace.Tree(
            table.arrays, quality == "fast", _arrays.threads(threads), progress
        )

    @classmethod
    def from_blob(cls, blob: Any, *, verify: bool = False) -> "BVH":
        """Returns the tree of a blob: bytes, a memoryview, or another buffer.

        The tree refers to the buffer and keeps it alive. It copies the bytes
        only if they are not aligned to 64 bytes. Do not change the bytes while
        the tree lives.

        Raises ValueError if the blob was cut, or has another format. An altered
        blob can change results, but no call reads or writes outside of it.
        `verify=True` compares the checksum, which takes a pass over the bytes.
        """
        return cls._of(_load(blob, "blob", verify))

    @classmethod
    def map(cls, path: Path, *, verify: bool = False) -> "BVH":
        """Returns the tree of a file that `save` wrote, without reading it.

        The file is mapped into memory, so the tree can be used at once, and
        processes that map the same file share its memory. Do not change the
        file while the tree lives. Replace it by `save`, which writes another
        file and renames it.

        Errors and `verify` are those of `from_blob`.
        """
        name = os.fsdecode(path)  # open() would take the number of a file, and close it
        with open(name, "rb") as file:
            if os.fstat(file.fileno()).st_size == 0:
                raise ValueError(f"{name}: the file is empty")
            mapped = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        return cls._of(_load(mapped, name, verify))

    @classmethod
    def _of(cls, tree: _halfspace.Tree) -> "BVH":
        bvh = cls.__new__(cls)
        bvh._tree = tree
        return bvh

    def blob(self) -> memoryview:
        """Returns the tree as bytes, without a copy, to store or to send.

        The tree cannot change while the memoryview exists. The first call after
        a change computes a checksum.
        """
        blob: Any = self._tree.blob()  # a buffer
        return memoryview(blob)

    def save(self, path: Path) -> None:
        """Writes the tree to a file for `map`.

        The file appears at `path` when it is complete and on the disk: a failure
        leaves an older file as it was. Raises OSError if `path` is something other
        than a regular file, such as a device.
        """
        with self.blob() as blob:
            _files.replace(os.fsdecode(path), lambda file: file.write(blob))

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        # Out of band if the pickler has a buffer_callback, and in band if not.
        blob = self.blob()
        data = pickle.PickleBuffer(blob) if protocol >= 5 else bytes(blob)
        return _unpickle, (type(self), data), getattr(self, "__dict__", None)

    def query(
        self,
        boxes: Any,
        *,
        within: Any = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> np.ndarray:
        """Finds the objects that overlap boxes, or that are near them.

        Parameters
        ----------
        boxes : array_like, shape (m, 2 d) or (2 d,)
            As in `BVH`, in the dimensions of the tree.
        within : float or array_like, shape (m,), optional
            Finds the objects whose distance from the box is at most `within`.
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
        is too much, use `query_batches`. Ids are int64 because NumPy converts
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
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1 and within is None:
            ids = self._tree.query_one(boxes)
            if ids is not None:
                return ids
        table = self._boxes(boxes)
        if within is not None:
            table = _arrays.rounded_boxes(table, within)
        return self._query(table, _arrays.threads(threads), progress)

    def query_sphere(
        self,
        centers: Any,
        radii: Any,
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> np.ndarray:
        """Finds the objects that spheres touch: those at most `radii` from `centers`.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or
        one for each center. float64 spheres are enclosed. Results are those of
        `query`.
        """
        spheres = _arrays.spheres(centers, radii, self.dims)
        return self._query(spheres, _arrays.threads(threads), progress)

    def _query(
        self, table: _arrays.Table, threads: int, progress: Optional[Progress]
    ) -> np.ndarray:
        by_join = (
            table.length >= 4096
            and table.columns == 2 * self.dims
            and self._is_join_faster(table)
        )
        found = self._tree.query(table.arrays, by_join, threads, progress)
        return found[1] if table.single else found

    def _is_join_faster(self, table: _arrays.Table) -> bool:
        # As measured with 10^3 to 10^6 objects and 10^4 to 10^6 queries. With fewer
        # queries the leaves of their tree are too large, more so in 3 dimensions, and
        # a join reads more: it takes up to 5 times as long. With many results it takes
        # up to twice as long, because it sorts them. The row of a query is an id in
        # their tree.
        size = len(self)
        least = size // (10 if self.dims == 2 else 4)
        if not least <= table.length < _arrays.MOST_OBJECTS:
            return False
        step = table.length // 64
        sample = tuple(a[: 64 * step : step] for a in table.arrays)
        # In a large tree, queries in turn also miss the cache.
        many_results = 64 * (8 if size < 2**18 else 16)
        return bool(self._tree.count(sample, 1, None).sum() < many_results)

    def query_batches(
        self,
        boxes: Any,
        max_results: int = 10_000_000,
        *,
        threads: Optional[int] = 1,
    ) -> Iterator[np.ndarray]:
        """Yields the results of `query` in batches of at most `max_results`.

        A batch is `rows, ids`, an array of int64 with the shape (2, n). All
        batches together are the result of `query`, except that the ids of one
        row can be in another order. A row with more results than `max_results`
        continues in the next batch. Raises RuntimeError if the tree changes
        before the iterator ends. Do not change `boxes` before that, either.
        """
        table = self._boxes(boxes)
        most = _arrays.positive(max_results, "max_results")
        return self._batches(table, most, _arrays.threads(threads))

    def _batches(
        self, table: _arrays.Table, most: int, threads: int
    ) -> Iterator[np.ndarray]:
        changes = self._tree.changes
        step = 1 << 16  # boxes that are counted at a time
        for first in range(0, table.length, step):
            block = table.rows(first, min(first + step, table.length))
            ends = np.cumsum(self._tree.count(block.arrays, threads, None), dtype=np.int64)
            begin, found = 0, 0
            while begin < block.length:
                # As many rows as have at most so many results, or one.
                end = int(np.searchsorted(ends, found + most, "right"))
                for batch in self._batch(block, begin, end, most, threads):
                    self._check_unchanged(changes)
                    batch[0] += first
                    yield batch
                # Also if the change left no results.
                self._check_unchanged(changes)
                begin = max(end, begin + 1)
                found = int(ends[begin - 1])

    def _check_unchanged(self, changes: int) -> None:
        if self._tree.changes != changes:
            raise RuntimeError("the tree changed during query_batches")

    def _batch(
        self, block: _arrays.Table, begin: int, end: int, most: int, threads: int
    ) -> Iterator[np.ndarray]:
        if end > begin:
            batch = self._query(block.rows(begin, end), threads, None)
            batch[0] += begin
            if batch.shape[1]:
                yield batch
            return
        arrays = block.rows(begin, begin + 1).arrays
        skip = 0
        while True:
            found, total = self._tree.query_some(arrays, skip, most)
            ids = found[: max(0, total - skip)]
            if not len(ids):
                return
            skip += len(ids)
            yield np.stack([np.full(len(ids), begin, np.int64), ids])

    def count(
        self,
        boxes: Any,
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Union[np.ndarray, int]:
        """Counts the objects that overlap each box.

        Returns an array of int64 with the shape (m,), or an int for one box.
        Arguments are those of `query`.
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1:
            count = self._tree.count_one(boxes)
            if count is not None:
                return count
        table = self._boxes(boxes)
        counts = self._tree.count(table.arrays, _arrays.threads(threads), progress)
        return int(counts[0, 0]) if table.single else counts[:, 0].astype(np.int64)

    def any(
        self,
        boxes: Any,
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Union[np.ndarray, bool]:
        """Returns for each box whether an object overlaps it.

        Returns an array of bool with the shape (m,), or a bool for one box.
        Arguments are those of `query`.
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1:
            found = self._tree.any_one(boxes)
            if found is not None:
                return found != _arrays.NO_ID
        table = self._boxes(boxes)
        ids = self._tree.any(table.arrays, _arrays.threads(threads), progress)
        if table.single:
            return int(ids[0, 0]) != _arrays.NO_ID
        return ids[:, 0] != _arrays.NO_ID

    def nearest(
        self,
        points: Any,
        k: int = 1,
        *,
        max_distance: float = float("inf"),
        exclusive: bool = False,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[np.ndarray, np.ndarray]:
        """Finds the k objects that are nearest to each point or box.

        Parameters
        ----------
        points : array_like, shape (m, d), (d,), (m, 2 d) or (2 d,)
            Points, or boxes as in `query`.
        k : int
            At least 1.
        max_distance : float
            Objects that are farther away are not found.
        exclusive : bool
            Leaves out the objects whose box is equal to the query as float32,
            such as the query itself if the tree has it.
        threads, progress
            As in `BVH`.

        Returns
        -------
        ids : ndarray of int64, shape (m, k) or (k,)
            The nearest object first. -1 if there are fewer than k within
            `max_distance`, or within about 2^64, the largest distance whose
            square is a float32.
        distances : ndarray of float32, shape (m, k) or (k,)
            The Euclidean distances of the boxes, within 2^-20 (relative), and 0
            for boxes that touch. inf if there are fewer than k. For a point of
            float64 it is the distance of the box of floats around the point.

        Examples
        --------
        >>> import halfspace as hs
        >>> tree = hs.BVH([[0, 0, 1, 1], [4, 0, 5, 1]])
        >>> tree.nearest([2, 0], k=3)
        (array([ 0,  1, -1]), array([ 1.,  2., inf], dtype=float32))
        """
        table = _arrays.points_or_boxes(points, "points", self.dims)
        count = _arrays.positive(k, "k")
        limit = _arrays.round_up(_arrays.not_negative(max_distance, "max_distance"))
        ids, distances = self._tree.nearest(
            table.arrays, count, limit, bool(exclusive), _arrays.threads(threads), progress
        )
        return (ids[0], distances[0]) if table.single else (ids, distances)

    def raycast(
        self,
        origins: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first box that each ray enters.

        A ray has the points `origin + t * direction` with `0 <= t <= max_t`.

        Parameters
        ----------
        origins, directions : array_like, shape (m, d) or (d,)
            One of the two can have the shape (d,) for all rays. float64 is
            rounded to the nearest float32, so a ray can miss a box that it
            only touches. A finite direction, not 0, that float32 rounds to 0
            or infinity is an error.
        max_t : float or array_like of shape (m,)
            In multiples of the direction.
        threads, progress
            As in `BVH`.

        Returns
        -------
        ids : ndarray of int64, shape (m,)
            -1 if the ray enters no box. Of boxes with equal t, the least id.
        t : ndarray of float32, shape (m,)
            At most the exact value, and less by at most 2^-18 (relative) plus
            the rounding of the ray. 0 if the origin is inside, and inf if the
            ray enters no box.

        For one ray `ids` and `t` are numbers.

        Examples
        --------
        >>> import halfspace as hs
        >>> tree = hs.BVH([[1, 0, 2, 1], [4, 0, 5, 1]])
        >>> ids, t = tree.raycast([[0, 0.5], [3, 0.5]], [1, 0])
        >>> ids
        array([0, 1])
        """
        starts = _arrays.points(origins, "origins", self.dims)
        return self._cast(starts, "origins", directions, max_t, threads, progress)

    def boxcast(
        self,
        boxes: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first box of the tree that each box touches on its way.

        A box moves by t times its direction. float64 boxes are enclosed. The
        rest is as in `raycast`.

        >>> import halfspace as hs
        >>> tree = hs.BVH([[5, 1, 6, 2], [8, 0, 9, 1]])
        >>> tree.boxcast([0, 0, 1, 1.5], [1, 0])
        (0, 4.0)
        """
        starts = self._boxes(boxes)
        return self._cast(starts, "boxes", directions, max_t, threads, progress)

    def spherecast(
        self,
        centers: Any,
        radii: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first box that each sphere touches on its way.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or
        one for each center. float64 spheres are enclosed. The rest is as in
        `boxcast`.
        """
        starts = _arrays.spheres(centers, radii, self.dims)
        return self._cast(starts, "centers", directions, max_t, threads, progress)

    def _cast(
        self,
        starts: _arrays.Table,
        name: str,
        directions: Any,
        max_t: Any,
        threads: Optional[int],
        progress: Optional[Progress],
    ) -> Tuple[Any, Any]:
        arrays, motions, single = _arrays.casts(
            starts, name, directions, max_t, self.dims
        )
        ids, t = self._tree.cast(arrays, motions, _arrays.threads(threads), progress)
        return (int(ids[0, 0]), float(t[0, 0])) if single else (ids[:, 0], t[:, 0])

    def pairs(
        self, *, threads: Optional[int] = 1, progress: Optional[Progress] = None
    ) -> np.ndarray:
        """Finds all pairs of objects that overlap each other.

        Returns `i, j`, an array of int64 with the shape (2, n), with `i < j`.
        Each pair is found once. The order of the pairs is unspecified, but
        equal calls return the same order.
        """
        return self._tree.pairs(None, _arrays.threads(threads), progress)

    def insert(self, boxes: Any) -> Union[np.ndarray, int]:
        """Adds objects and returns their ids.

        Ids are those of erased objects, or follow the greatest id. Returns an
        array of int64 with the shape (m,), or an int for one box.
        """
        table = _arrays.boxes(boxes, "boxes", self.dims, _arrays.MOST_OBJECTS)
        ids = self._tree.insert(table.arrays)
        return int(ids[0]) if table.single else ids.astype(np.int64)

    def insert_as(self, ids: Any, boxes: Any) -> None:
        """Adds objects under ids that you choose. Box i is that of object `ids[i]`.

        Raises ValueError, and changes nothing, if an object has such an id, or if
        an id is in `ids` twice. Memory grows with the greatest id, by about 4
        bytes for each.

        >>> import halfspace as hs
        >>> tree = hs.BVH([[0, 0, 1, 1]])
        >>> tree.insert_as([7], [[2, 2, 3, 3]])
        >>> tree.query([2, 2, 3, 3])
        array([7])
        """
        self._tree.insert_as(*self._rows(ids, boxes))

    def erase(self, ids: Any) -> None:
        """Removes objects. The ids of the other objects stay.

        Raises ValueError, and changes nothing, if an id is not that of an
        object.
        """
        self._tree.erase(_arrays.ids(ids, "ids"))

    def refit(
        self,
        boxes: Any,
        ids: Any = None,
        *,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> None:
        """Moves objects: gives them new boxes.

        Without `ids`, row i of `boxes` is the new box of object i, and there
        must be a row for every id up to the greatest. With `ids`, row i is the
        new box of object `ids[i]`. The tree keeps its order, so queries become
        slower when objects have moved far. Then build a new tree.

        If an exception of `progress` or Ctrl-C ends the call, call `refit`
        again before the next query.
        """
        if ids is not None:
            self._tree.refit_some(*self._rows(ids, boxes))
            return
        table = self._boxes(boxes)
        if table.length != self._tree.id_limit():
            raise ValueError(
                f"boxes: expected {self._tree.id_limit()} boxes, one for each id of "
                f"the tree, got {table.length}"
            )
        self._tree.refit(table.arrays, _arrays.threads(threads), progress)

    @contextlib.contextmanager
    def changing(self) -> Iterator[None]:
        """Changes the tree while other threads use it: `with tree.changing():`.

        Waits until no other thread reads or changes the tree. From then on to the
        end of the block, the calls of other threads wait. Those of this thread do
        not. Blocks of one thread can be nested. Raises RuntimeError in a `progress`
        function of the same tree.

        >>> import halfspace as hs
        >>> tree = hs.BVH([[0, 0, 1, 1], [2, 2, 3, 3]])
        >>> with tree.changing():
        ...     tree.erase(0)
        ...     tree.refit([5, 5, 6, 6], 1)
        """
        self._tree.own()
        try:
            yield
        finally:
            self._tree.disown()

    def __len__(self) -> int:
        """The number of objects."""
        return self._tree.size()

    @property
    def dims(self) -> int:
        """The number of dimensions, 2 or 3."""
        return self._tree.dims

    @property
    def nbytes(self) -> int:
        """The size of the tree in memory, and of a file that `save` writes."""
        return self._tree.nbytes()

    @property
    def bounds(self) -> np.ndarray:
        """The box around all objects: float32, shape (2 d,)."""
        return self._tree.bounds()

    def boxes(self, ids: Any = None) -> np.ndarray:
        """Returns the stored boxes of all ids, or of some: float32, shape (n, 2 d).

        Boxes of float64 were rounded outward. Row i is the box of object i, or of
        object `ids[i]`. The box of an id without an object is empty: minima of inf,
        maxima of -inf. Takes a pass over all objects.
        """
        boxes = self._tree.boxes()
        if ids is None:
            return boxes
        wanted = _arrays.ids(ids, "ids")
        if len(wanted) and wanted.max() >= len(boxes):
            raise ValueError(
                f"ids: expected ids below {len(boxes)}, got {wanted.max()}"
            )
        return boxes[wanted]

    def __repr__(self) -> str:
        return f"<halfspace.BVH: {len(self)} boxes in {self.dims} dimensions>"

    def _boxes(self, value: Any) -> _arrays.Table:
        return _arrays.boxes(value, "boxes", self.dims)

    def _rows(self, ids: Any, boxes: Any) -> Tuple[_arrays.Arrays, np.ndarray]:
        table, wanted = self._boxes(boxes), _arrays.ids(ids, "ids")
        if len(wanted) != table.length:
            raise ValueError(
                f"ids: expected one id for each of {table.length} boxes, got {len(wanted)}"
            )
        return table.arrays, wanted


def join(
    a: BVH,
    b: BVH,
    *,
    threads: Optional[int] = 1,
    progress: Optional[Progress] = None,
) -> np.ndarray:
    """Finds all pairs of an object of `a` and an object of `b` that overlap.

    Returns `i, j`, an array of int64 with the shape (2, n): object `i[k]` of `a`
    overlaps object `j[k]` of `b`. The order of the pairs is unspecified, but
    equal calls return the same order. `threads` and `progress` are those of
    `BVH`. To group the pairs by `i`, call `b.query` with the boxes of `a`.

    >>> import halfspace as hs
    >>> a = hs.BVH([[0, 0, 1, 1], [2, 2, 3, 3]])
    >>> i, j = hs.join(a, hs.BVH([[1, 1, 2, 2]]))
    >>> sorted(zip(i.tolist(), j.tolist()))
    [(0, 0), (1, 0)]
    """
    for name, tree in (("a", a), ("b", b)):
        if not isinstance(tree, BVH):
            raise TypeError(f"{name}: expected a BVH, got {type(tree).__name__}")
    if a.dims != b.dims:
        raise ValueError(
            f"b: expected a BVH of {a.dims} dimensions, as a, got {b.dims} dimensions"
        )
    return a._tree.pairs(b._tree, _arrays.threads(threads), progress)


def _load(blob: Any, name: str, verify: bool) -> _halfspace.Tree:
    data = np.frombuffer(blob, np.uint8)
    try:
        return _halfspace.Tree.from_blob(data, bool(verify))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _unpickle(cls: Type[BVH], blob: Any) -> BVH:
    return cls._of(_load(blob, "pickle of a halfspace.BVH", False))
