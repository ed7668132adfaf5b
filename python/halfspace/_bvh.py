"""The BVH, and the boxes of meshes."""

from __future__ import annotations

import mmap
import os
import pickle
import warnings
from typing import (Any, Callable, Iterable, Iterator, Literal, Optional, Tuple, Type, Union,
                    overload)

import numpy as np

from . import _arrays, _halfspace
from ._searches import Box, Boxes, Progress, Searches

Path = Union[str, "os.PathLike[str]"]


class BVH(Searches):
    """A bounding volume hierarchy of axis-aligned boxes in 2 or 3 dimensions.

    The id of a box is its row in `boxes`. Boxes that touch overlap. The tree is
    built at once. It changes only by `insert`, `insert_as`, `erase`, `refit`,
    `rebuild` and `set_masks`.

    Parameters
    ----------
    boxes : array_like, shape (n, 6) or (n, 4)
        The minima of all axes, then the maxima: `x_min, y_min, z_min, x_max,
        y_max, z_max`. It can also be a pair `(minima, maxima)` of arrays of
        shape (n, 3) or (n, 2), or a tuple of 6 or 4 columns. A column is a
        one-dimensional array, or an object with `__arrow_c_array__`. One box
        has the shape (6,) or (4,).
    quality : "high" or "fast"
        "fast" builds in about a third of the time. Queries then take up to 1.4
        times as long if the boxes are spread evenly, and up to 3 times in uneven
        worlds. Results are the same.
    query_extents : array_like, shape (d,), optional
        The extents of a typical query on each axis, not negative: 0 for points, inf
        where queries do not limit an axis. They decide which axis is cut, so queries
        of another form read more. Give them if the axes have unlike units (degrees and
        meters, positions and time), if the boxes are points in a world that is much
        longer on one axis than on another, or if queries are long on some axes. Without
        them, queries are taken to be about as large as the boxes. `rebuild` keeps them.
    exact : bool
        Keeps the boxes as float64 next to the tree, and compares them: see Notes.
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
    apart can be reported as overlapping. With `exact=True` the results of `query`,
    `query_batches`, `count`, `any`, `pairs`, `pairs_of` and `join` are those of the
    float64 boxes. All other searches, and `within`, use the rounded boxes. An exact
    tree takes 8 more bytes for each value of a box. It can be pickled, but it has no
    `blob` and no file.

    A NaN, or a box with min > max, raises ValueError. The exception is the empty
    box, with minima of inf and maxima of -inf: only a query without limits can
    find it. Infinite boxes are allowed. Masked values of a masked array, in any
    argument, raise TypeError.

    Every call releases the interpreter's lock, so threads can query one tree at
    the same time. A change while another thread uses the tree raises
    RuntimeError, except in `with tree.changing():`. Ctrl-C ends a long build,
    rebuild, refit, query or join. It does not end `insert`, `insert_as`, `erase`,
    `save` or the check of a blob.
    """

    __slots__ = ("_tree", "__weakref__")

    def __init__(self, boxes: Any, *, quality: str = "high", query_extents: Any = None,
                 exact: bool = False, threads: Optional[int] = 1,
                 progress: Optional[Progress] = None) -> None:
        is_fast = _is_fast(quality)
        table = _arrays.boxes(boxes, "boxes", most=_arrays.MOST_OBJECTS)
        how = is_fast, _extents(query_extents, table.columns // 2)
        self._tree = _halfspace.Tree(table.arrays, how, bool(exact), _arrays.threads(threads),
                                     progress)
        if query_extents is None and len(self) >= 4096:
            self._warn_of_long_axes()

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
    def from_chunks(cls, path: Path, chunks: Iterable[Any], *, quality: str = "high",
                    query_extents: Any = None, memory: int = 1 << 28) -> "BVH":
        """Writes a tree of more boxes than fit into memory to a file, and maps it.

        `chunks` is a list or an iterator of arrays, each as `boxes` of `BVH`, all in
        the same dimensions. A million rows each is a good size. The id of a box is its
        row when all chunks are stacked. The boxes are sorted in runs
        that take `memory` bytes, and written to temporary files in the folder of `path`,
        which take up to 5 times the bytes of the boxes as float32. The tree replaces
        `path` when it is complete. Beyond `memory` and a chunk, the call uses pages of
        files, which the system can evict.

        The tree has the given quality if all boxes fit into one run, and otherwise it is
        "fast". `query_extents` are those of `BVH`. The call uses one thread. Ctrl-C ends
        it between two chunks, but not while it sorts after the last one. Raises OSError
        if a file cannot be written.
        """
        if isinstance(chunks, np.ndarray):
            raise TypeError("chunks: expected a list or an iterator of arrays, got one array")
        where = os.path.abspath(path)
        is_fast = _is_fast(quality)
        memory = _arrays.positive(memory, "memory", _arrays.MOST_SIZE)
        builder = None
        dims = None
        try:
            for i, chunk in enumerate(chunks):
                table = _arrays.boxes(chunk, f"chunks[{i}]", dims)
                if builder is None:
                    dims = table.columns // 2
                    how = is_fast, _extents(query_extents, dims)
                    builder = _halfspace.FileBuilder(os.fsencode(where), dims, how, memory)
                builder.push(table.arrays)
            if builder is None:
                raise ValueError("chunks: expected at least one array, got none")
            builder.finish()
        finally:
            del builder  # and its file, which a traceback would keep
        return cls.map(where)

    @classmethod
    def _of(cls, tree: _halfspace.Tree) -> "BVH":
        bvh = cls.__new__(cls)
        bvh._tree = tree
        return bvh

    def blob(self) -> memoryview:
        """Returns the tree as bytes, without a copy, to store or to send.

        The tree cannot change while the memoryview exists. The first call after
        a change computes a checksum. It has the masks. Raises TypeError for an
        exact tree, whose float64 boxes are not stored either.
        """
        self._check_is_not_exact()
        return memoryview(self._tree.blob(False))

    def _check_is_not_exact(self) -> None:
        if self._tree.is_exact:
            raise TypeError("expected a tree that is not exact: pickle an exact one")

    def save(self, path: Path) -> None:
        """Writes the tree to a file for `map`.

        The file appears at `path` when it is complete and on the disk: a failure
        leaves an older file as it was. Raises OSError with the reason, also if `path` is
        something other than a regular file, such as a device.
        """
        self._check_is_not_exact()
        self._tree.save(os.fsencode(path))

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        # Out of band if the pickler has a buffer_callback, and in band if not.
        blob = memoryview(self._tree.blob(True))
        data = pickle.PickleBuffer(blob) if protocol >= 5 else bytes(blob)
        doubles = (self._tree.doubles(),) if self._tree.is_exact else ()
        return _unpickle, (type(self), data, *doubles), getattr(self, "__dict__", None)

    def _query(self, table: _arrays.Table, how: _arrays.How) -> np.ndarray:
        if (
            table.length >= 4096
            and table.columns == 2 * self.dims
            and self._is_join_faster(table, how[0])
        ):
            return self._tree.query_by_join(table.arrays, how)
        return super()._query(table, how)

    def _is_join_faster(self, table: _arrays.Table, mask: int) -> bool:
        # As measured with 64 to 10^6 objects and 4096 to 2 * 10^6 queries. With fewer
        # queries the leaves of their tree are too large, more so in 3 dimensions, and
        # a join reads more: it takes up to 5 times as long. With fewer than 128 objects
        # or with many results it takes up to twice as long, because it sorts the
        # queries and the results.
        size = len(self)
        least = size // (10 if self.dims == 2 else 4)
        if size < 128 or not least <= table.length < _arrays.MOST_OBJECTS:
            return False
        step = table.length // 64
        sample = tuple(a[: 64 * step : step] for a in table.arrays)
        # In a large tree, queries in turn also miss the cache.
        many_results = 64 * (8 if size < 2**18 else 16)
        return bool(self._tree.count(sample, (mask, 1, None)).sum() < many_results)

    def query_batches(self, boxes: Any, max_results: int = 10_000_000, *,
                      mask: Optional[int] = None,
                      threads: Optional[int] = 1) -> Iterator[np.ndarray]:
        """Yields the results of `query` in batches of at most `max_results`.

        A batch is `rows, ids`, an array of int64 with the shape (2, n). All
        batches together are the result of `query`, except that the ids of one
        row can be in another order. A row with more results than `max_results`
        continues in the next batch. Raises RuntimeError if the tree changes
        before the iterator ends. Do not change `boxes` before that, either.
        """
        table = self._boxes(boxes)
        most = _arrays.positive(max_results, "max_results")
        batches = self._unchecked_batches(table, most, _arrays.how(mask, threads, None))
        return self._checked(batches, self._tree.changes)

    def _checked(self, batches: Iterator[np.ndarray], changes: int) -> Iterator[np.ndarray]:
        for batch in batches:
            if self._tree.changes != changes:
                raise RuntimeError("the tree changed during query_batches")
            if batch.shape[1]:
                yield batch

    def _unchecked_batches(self, table: _arrays.Table, most: int,
                           how: _arrays.How) -> Iterator[np.ndarray]:
        step = 1 << 16  # boxes that are counted at a time
        for first in range(0, table.length, step):
            block = table.rows(first, min(first + step, table.length))
            ends = np.cumsum(self._tree.count(block.arrays, how))
            begin, found = 0, 0
            while begin < block.length:
                # As many rows as have at most so many results, or one.
                end = int(np.searchsorted(ends, found + most, "right"))
                if end > begin:
                    batch = self._query(block.rows(begin, end), how)
                    batch[0] += first + begin
                    yield batch
                else:
                    end = begin + 1
                    arrays = block.rows(begin, end).arrays
                    skip, total = 0, 1
                    while skip < total:
                        ids, total = self._tree.query_some(arrays, how[0], skip, most)
                        yield np.stack([np.full(len(ids), first + begin, np.int64), ids])
                        skip += most
                begin, found = end, int(ends[end - 1])
        yield np.empty((2, 0), np.int64)  # a change after the last batch is seen, too

    def pairs(self, *, margin: float = 0.0, within: Optional[float] = None,
              mask: Optional[int] = None, threads: Optional[int] = 1,
              progress: Optional[Progress] = None) -> np.ndarray:
        """Finds all pairs of objects that overlap each other.

        With `margin`, also those that are at most `margin` apart on each axis, or with
        `within` those whose Euclidean distance is at most `within`. Both are rounded up
        to float32. With `mask`, the masks of both objects have one of its bits.
        `threads` and `progress` are those of `BVH`.

        Returns `i, j`, an array of int64 with the shape (2, n), with `i < j`.
        Each pair is found once. The order of the pairs is unspecified, but
        equal calls return the same order.
        """
        how = _arrays.how(mask, threads, progress)
        return self._tree.pairs(None, *_arrays.pair_distance(margin, within), how)

    @overload
    def insert(self, boxes: Box) -> int: ...

    @overload
    def insert(self, boxes: Boxes) -> np.ndarray: ...

    @overload
    def insert(self, boxes: Any) -> Any: ...

    def insert(self, boxes: Any) -> Any:
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
        """
        self._tree.insert_as(*self._rows(ids, boxes))

    def erase(self, ids: Any) -> None:
        """Removes objects. The ids of the other objects stay.

        Raises ValueError, and changes nothing, if an id is not that of an
        object.
        """
        self._tree.erase(_arrays.ids(ids, "ids"))

    def refit(self, boxes: Any, ids: Any = None, *, threads: Optional[int] = 1,
              progress: Optional[Progress] = None) -> None:
        """Moves objects: gives them new boxes.

        Without `ids`, row i of `boxes` is the new box of object i, and there
        must be a row for every id up to the greatest. With `ids`, row i is the
        new box of object `ids[i]`. The tree keeps its order, so queries become
        slower when objects have moved far: see `cost_ratio`.

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

    def rebuild(self, *, quality: str = "high", query_extents: Any = None,
                threads: Optional[int] = 1) -> None:
        """Sorts all objects again, and frees memory. Ids stay.

        The arguments are those of `BVH`. Without `query_extents`, the last ones stay.
        """
        how = _is_fast(quality), _extents(query_extents, self.dims)
        self._tree.rebuild(how, _arrays.threads(threads))

    def expected_leaves(self, query_extents: Any) -> float:
        """How many leaves of 64 boxes a query of these extents reads on average, if it can
        be anywhere within `bounds`: inf where it does not limit an axis.

        If it is many more than the results need, pass `query_extents` to `BVH` or
        `rebuild`. Takes O(n / 64).

        Examples
        --------
        >>> import numpy as np, halfspace as hs
        >>> rng = np.random.default_rng(0)
        >>> points = rng.random((20000, 3)) * [1, 1, 10000]
        >>> query = [0.02, 0.02, np.inf]
        >>> tree = hs.BVH((points, points), query_extents=query)
        >>> tree.expected_leaves(query) < 5
        True
        """
        return self._tree.expected_leaves(_extents(query_extents, self.dims))

    def _warn_of_long_axes(self) -> None:
        leaves = -(-len(self) // 64)
        lines = np.where(np.eye(self.dims, dtype=bool), np.inf, 0)
        expected = [self.expected_leaves(line) for line in lines]
        axis = int(np.argmax(expected))
        if expected[axis] < 12 * leaves ** (1 / self.dims):
            return
        # Points say nothing about their queries. Those of float64 are rounded outward.
        some = self.boxes(np.linspace(0, len(self) - 1, 64).astype(np.int64))
        low, high = np.split(some, 2, axis=1)
        with np.errstate(all="ignore"):
            if np.any(np.median(high - low > 2.0**-21 * np.maximum(-low, high), axis=0)):
                return
        warnings.warn(
            f"BVH: a query that does not limit axis {axis} reads about "
            f"{expected[axis]:.0f} of {leaves} leaves. The boxes are points, which do not "
            "say what their queries are like. Pass query_extents=, the extents of a typical "
            "query",
            stacklevel=3,
        )

    @property
    def cost_ratio(self) -> float:
        """How much the order has decayed: 1 as sorted, and 2 if queries visit up to
        twice as many leaves. `rebuild` makes it 1. inf if more than 64 objects were
        never sorted. Takes a pass over the leaves.
        """
        return self._tree.cost_ratio()

    def set_masks(self, masks: Any, ids: Any = None) -> None:
        """Sets the masks of objects, for the `mask` of searches.

        Element i of `masks` is the mask of object i, for every id up to the
        greatest, or with `ids` that of object `ids[i]`. One integer is the mask of
        all of them. Masks have 32 bits, and new objects have all.
        """
        wanted = np.empty(0, np.uint32) if ids is None else _arrays.ids(ids, "ids")
        count = self._tree.id_limit() if ids is None else len(wanted)
        if count:
            self._tree.set_masks(wanted, _arrays.masks(masks, "masks", count))

    def changing(self) -> _halfspace.Changing:
        """Changes the tree while other threads use it: `with tree.changing():`.

        Waits until no other thread reads or changes the tree. From then on to the
        end of the block, the calls of other threads wait. Those of this thread do
        not. Blocks of one thread can be nested. Calls that waited go before the
        next block. Raises RuntimeError in a `progress` function of the same tree.

        It also waits for pickles that other threads write, and for the buffers that
        these gave to a `buffer_callback`: do not keep such buffers in this thread.
        BufferError of a change means that somebody keeps a `blob`.

        In the block, do not wait for another thread that uses the tree. Threads
        that need the blocks of two trees, also for a `join` in a block, take them
        in the same order. A process that is forked by another thread during a
        block cannot use the tree: its calls would wait forever.
        """
        return self._tree.changing()

    @property
    def nbytes(self) -> int:
        """The size of the tree in memory, with the float64 boxes of an exact tree.

        A file that `save` writes has the same size.
        """
        return self._tree.nbytes()

    @property
    def bounds(self) -> np.ndarray:
        """The box around all objects: float32, shape (2 d,)."""
        return self._tree.bounds()

    def boxes(self, ids: Any = None) -> np.ndarray:
        """Returns the stored boxes of all ids, or of some, in the shape (n, 2 d).

        They are float32, which encloses boxes of float64, or the float64 boxes of
        an exact tree. Row i is the box of object i, or of object `ids[i]`. The box
        of an id without an object is empty: minima of inf, maxima of -inf. Takes a
        pass over all objects.
        """
        boxes = self._tree.boxes()
        if self._tree.is_exact:
            doubles = self._tree.doubles()[: boxes.size].reshape(boxes.shape)
            is_there = boxes[:, :1] <= boxes[:, self.dims, None]
            boxes = np.where(is_there, doubles, boxes)
        return boxes if ids is None else boxes[_arrays.ids(ids, "ids", len(boxes))]

    def __repr__(self) -> str:
        return f"<halfspace.BVH: {len(self)} boxes in {self.dims} dimensions>"


def join(a: BVH, b: BVH, *, margin: float = 0.0, within: Optional[float] = None,
         mask: Optional[int] = None, threads: Optional[int] = 1,
         progress: Optional[Progress] = None) -> np.ndarray:
    """Finds all pairs of an object of `a` and an object of `b` that overlap.

    Returns `i, j`, an array of int64 with the shape (2, n): object `i[k]` of `a`
    overlaps object `j[k]` of `b`. Their order, and the other arguments, are as in
    `BVH.pairs`. If one of the trees is exact, the join compares float64 boxes. The
    boxes of the other tree are the float32 boxes that it stores. To group the pairs
    by `i`, call `b.query` with the boxes of `a`.
    """
    for name, tree in (("a", a), ("b", b)):
        if not isinstance(tree, BVH):
            raise TypeError(f"{name}: expected a BVH, got {type(tree).__name__}")
    if a.dims != b.dims:
        raise ValueError(f"b: expected a BVH of {a.dims} dimensions, as a, got {b.dims} dimensions")
    how = _arrays.how(mask, threads, progress)
    return a._tree.pairs(b._tree, *_arrays.pair_distance(margin, within), how)


def bounds_of_triangles(vertices: Any, faces: Any) -> np.ndarray:
    """Returns the box of each triangle of a mesh.

    `vertices` has the shape (v, 3) or (v, 2), and `faces` the shape (n, 3): row i has
    the indices of the three vertices of triangle i. Returns an array of float32 with
    the shape (n, 6) or (n, 4), the minima and then the maxima, as `BVH` reads them.
    float64 is rounded outward.
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


def _is_fast(quality: Any) -> bool:
    # An array compares element by element.
    if not isinstance(quality, str) or quality not in ("high", "fast"):
        raise ValueError(f'quality: expected "high" or "fast", got {quality!r}')
    return quality == "fast"


def _extents(query_extents: Any, dims: int) -> np.ndarray:
    if query_extents is None:
        return np.empty(0, np.float32)
    try:
        extents = np.asarray(query_extents, np.float64)
    except (TypeError, ValueError):
        extents = np.empty(0)
    if extents.shape != (dims,) or not (extents >= 0).all():
        raise ValueError(
            f"query_extents: expected {dims} numbers that are not negative, got {query_extents!r}"
        )
    with np.errstate(over="ignore"):
        return extents.astype(np.float32)


def _load(blob: Any, name: str, verify: bool,
          doubles: Optional[np.ndarray] = None) -> _halfspace.Tree:
    data = np.frombuffer(blob, np.uint8)
    its = np.empty(0) if doubles is None else doubles
    try:
        return _halfspace.Tree.from_blob(data, bool(verify), doubles is not None, its)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _unpickle(cls: Type[BVH], blob: Any, doubles: Optional[np.ndarray] = None) -> BVH:
    return cls._of(_load(blob, "pickle of a halfspace.BVH", False, doubles))
