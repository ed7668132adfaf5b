"""Joins, box queries and k nearest on Dask, over more boxes than one machine holds.

    import halfspace.dask as hd

    tree = hd.BVH(boxes)                         # a lazy Dask collection
    tree = tree.persist()                        # builds it
    pairs = tree.query(probes)                   # a dask DataFrame: "id" by "row"
    near = tree.nearest(points, k=8)             # "id" and "distance" by "row"
    own = tree.pairs()                           # "i" and "j"

Boxes and points are rows of a dask array, also one of unknown chunk sizes, of delayed
arrays, of a data frame (dask's, pandas', geopandas' or dask-geopandas'), of an array, or
of files, as a list of paths of `.npy` or `.parquet` files that every worker can read. A
frame has the columns `minx, miny, maxx, maxy` or `xmin, ymin, xmax, ymax`, the column
`bbox` of GeoParquet, geometries, or only columns of numbers. If it also has the columns
of z, or `bbox` has them, boxes have 3 dimensions. A null geometry or `bbox` is an empty
box.

The id of an object is its row in the whole collection, an int64. Boxes mean what they
mean in `halfspace.BVH`: boxes that touch overlap, and boxes of doubles are rounded
outward to floats.

Calls that end in `_batches` need a `distributed.Client`. They run at once, and return
iterators of arrays, or write files. They make only the tasks that find something, and
hold few results at a time. In a task they secede from the worker's thread pool:

    for rows, ids in tree.query_batches(probes): ...
    paths = tree.query_batches(probes, to="out")

How it works: each object belongs to the one partition that has its center, which is a
`halfspace.BVH` in the memory of one worker. A probe goes to each partition that it
overlaps. docs/scale.md has a picture, the steps, measurements and a model of the cost.

A lost worker costs time only: Dask makes its partitions again from the source. So the
source must stay readable, and must return the same boxes when it is read again. A lazy
tree has views of NumPy arrays, not copies: do not change them before it is computed.

Thread safety: calls may run at the same time.
"""

from __future__ import annotations

import collections
import contextlib
import dataclasses
import functools
import glob
import itertools
import math
import operator
import os
import tempfile
import typing
import uuid

import dask
import dask.array
import dask.blockwise
import dask.core
import dask.graph_manipulation
import dask.sizeof
import dask.system
import dask.threaded
import distributed
import numpy as np
from dask.delayed import Delayed
from dask.highlevelgraph import HighLevelGraph

import halfspace as hs
from halfspace import _arrays

__all__ = ["BVH", "join", "join_batches", "scan", "scan_batches"]

MAX_RESULTS = 10_000_000

# Rows of one task, where the source has no chunks of its own.
_CHUNK_ROWS = 1_000_000
# Boxes in the sample for each partition: the number of objects of a partition is then
# right within about a twentieth.
_SAMPLE_PER_PARTITION = 400
# A tree of boxes in 3 dimensions, and the row of each object.
_BYTES_PER_OBJECT = 56
# More than the rounding of distances (halfspace/bvh_nearest.h: 2^-20 and 2^-73).
_FAR = 1 + 2.0**-18
_FARTHER = 2.0**-70
# With more partitions, rows go to them in two stages.
_ONE_STAGE = 16
# A row of a chunk, until it is known where the chunk begins: (chunk << _BITS) + row.
_BITS = 32


# Graphs.


class _Lazy:
    """A graph, whose last layer has the name."""

    def __init__(self, name: str, tasks: dict, dependencies=()):
        self._name = name
        self._graph = HighLevelGraph.from_collections(name, tasks, dependencies)

    def __dask_graph__(self):
        return self._graph

    def __dask_layers__(self):
        return (self._name,)


def _delayed(lazy, key) -> Delayed:
    return Delayed(key, lazy.__dask_graph__(), layer=lazy.__dask_layers__()[0])


# The source: rows in chunks.


@dataclasses.dataclass(frozen=True)
class _Source:
    """The chunks `keys` of the graphs of `collections`. `sizes` are their numbers of
    rows, and `width` is that of a row: None if it is unknown."""

    collections: list
    keys: list
    sizes: typing.Any  # a list
    width: int | None

    @functools.cached_property
    def firsts(self) -> list:
        return _sum_up(self.sizes)

    def where(self, chunk: int) -> str:
        """What an error says of a chunk."""
        if self.sizes is None:
            return f"in chunk {chunk}"
        return f"in the chunk that begins at row {self.firsts[chunk]}"


def _read(path: str, begin: int, end: int) -> np.ndarray:
    return np.array(np.load(path, mmap_mode="r")[begin:end])


def _read_parquet(path: str):
    import pandas  # type: ignore

    return pandas.read_parquet(path)


_BOUNDS = [names.split() for names in (
    "minx miny minz maxx maxy maxz", "xmin ymin zmin xmax ymax zmax",
    "minx miny maxx maxy", "xmin ymin xmax ymax")]


def _empty_if_null(boxes: np.ndarray) -> np.ndarray:
    dims = boxes.shape[1] // 2
    boxes[np.isnan(boxes).any(axis=1)] = [np.inf] * dims + [-np.inf] * dims
    return boxes


def _without_names(chunk):
    """The boxes of a frame. Any other chunk as it is."""
    if hasattr(chunk, "geom_type"):  # of geometries
        return _empty_if_null(chunk.bounds.to_numpy())
    if not hasattr(chunk, "columns"):
        return chunk
    if "bbox" in chunk.columns:
        is_there = chunk["bbox"].notna().to_numpy()
        boxes = list(chunk["bbox"][is_there])
        names = _BOUNDS[1 if boxes and "zmin" in boxes[0] and "zmax" in boxes[0] else 3]
        result = np.full((len(chunk), len(names)), np.nan)
        if boxes:
            result[is_there] = [[box[name] for name in names] for box in boxes]
        return _empty_if_null(result)
    for names in _BOUNDS:
        if set(names) <= set(chunk.columns):
            return _numbers(chunk[names])
    if hasattr(type(chunk), "geom_type"):
        raise ValueError("a GeoDataFrame has no active geometry: call set_geometry() first")
    return _numbers(chunk)


def _numbers(frame) -> np.ndarray:
    array = frame.to_numpy()
    # pandas returns objects for columns that can have missing values.
    if array.dtype.kind == "O" and all(kind.kind in "iuf" for kind in frame.dtypes):
        array = frame.to_numpy(np.float64)
    return array


def _shapes(widths) -> str:
    return " or ".join(f"(n, {width})" for width in widths)


def _source(source, name: str, widths: tuple[int, ...]) -> _Source:
    """Returns the chunks of a collection."""
    width = 0

    def check(shape, what: str) -> None:
        nonlocal width
        if len(shape) != 2 or shape[1] not in ((width,) if width else widths):
            raise ValueError(f"{name} must have the shape {_shapes(widths)}, and {what} has "
                             f"{tuple(shape)}")
        width = shape[1]

    if isinstance(source, dask.array.Array):
        check(source.shape, "the dask array")
        if source.numblocks[1] > 1:
            source = source.rechunk({1: -1})
        is_known = not any(map(math.isnan, source.chunks[0]))
        keys = [key for key, in source.__dask_keys__()]
        return _Source([source], keys, list(source.chunks[0]) if is_known else None, width)
    if _are_all(source, Delayed):
        return _Source(list(source), [part.key for part in source], None, None)
    if isinstance(source, BVH):
        raise TypeError(f"{name}: expected boxes, got a halfspace.dask.BVH")
    if dask.is_dask_collection(source):  # a frame, or a delayed array
        keys = list(dask.core.flatten(source.__dask_keys__()))
        return _Source([source], keys, None, None)
    if isinstance(source, (str, os.PathLike)):
        source = [source]
    sizes: list = []
    tasks: list = []
    if _are_all(source, (str, os.PathLike)):
        paths = [os.path.abspath(os.fsdecode(path)) for path in source]
        if any(path.endswith(".parquet") for path in paths):
            tasks = [(_read_parquet, path) for path in paths]
        else:
            for path in paths:
                shape = np.load(path, mmap_mode="r").shape
                check(shape, path)
                for begin in range(0, max(1, shape[0]), _CHUNK_ROWS):
                    end = min(begin + _CHUNK_ROWS, shape[0])
                    sizes.append(end - begin)
                    tasks.append((_read, path, begin, end))
    else:
        array = _arrays.numbers(_in_chunk(name, lambda: _without_names(source)), name)
        check(array.shape, "the array")
        tasks = [array[begin:begin + _CHUNK_ROWS]
                 for begin in range(0, max(1, len(array)), _CHUNK_ROWS)]
        sizes = list(map(len, tasks))
    layer = _Tasks("source")
    keys = [(layer.name, chunk) for chunk in range(len(tasks))]
    layer.update(zip(keys, tasks))
    return _Source([_Lazy(layer.name, layer)], keys, sizes or None, width or None)


def _again(source):
    """The same collection, which Dask computes by itself."""
    if _are_all(source, Delayed):
        return [dask.graph_manipulation.clone(part) for part in source]
    return dask.graph_manipulation.clone(source) if dask.is_dask_collection(source) else source


def _are_all(values, kind) -> bool:
    return isinstance(values, (list, tuple)) and len(values) > 0 and all(
        isinstance(value, kind) for value in values)


def _in_chunk(where: str, call):
    """Returns call(). An error of it says where."""
    try:
        return call()
    except (ValueError, TypeError) as error:
        raise type(error)(f"{where}: {error}") from None


def _rows(chunk, name: str, where: str) -> np.ndarray:
    """The rows of a chunk as a plain array of two dimensions."""
    def read():
        rows = _arrays.numbers(_without_names(chunk), name)
        widths = (4, 6) if name == "boxes" else (2, 3, 4, 6)
        if rows.ndim != 2 or rows.shape[1] not in widths:
            raise ValueError(f"{name} must have the shape {_shapes(widths)}, not {rows.shape}")
        return rows
    return _in_chunk(where, read)


# Partitions.


def _split_rows(splits, centers: np.ndarray, rows: np.ndarray):
    """Returns the partitions, ascending, each with its rows. Splits are the number of a
    partition, or a tuple: rows whose center is below `value` on `axis` go to the splits
    `low`, and the others to `high`."""
    if not isinstance(splits, tuple):
        return [(splits, rows)]
    axis, value, low, high = splits
    is_low = centers[axis].take(rows) < value
    return (_split_rows(low, centers, rows.compress(is_low)) +
            _split_rows(high, centers, rows.compress(~is_low)))


def _centers(boxes: np.ndarray) -> np.ndarray:
    """Centers in double, an array for each axis. That of an infinite box may be a NaN,
    which has a partition, too."""
    low, high = np.split(boxes.T, 2)
    with np.errstate(invalid="ignore"):
        return (np.multiply(low, 0.5, dtype=np.float64, order="C") +
                np.multiply(high, 0.5, dtype=np.float64, order="C"))


def _split_sample(boxes, stands_for, partitions: int, by_pairs: bool):
    """Splits a sample into partitions of about equal work. By pairs, half of the weight
    of a box is for the objects that it stands for, and half for their pairs. So no
    partition has more than twice its share of either, as far as the sample tells."""
    dims = boxes.shape[1] // 2
    if partitions == 1:
        return 0
    # Not empty boxes. Those with a NaN are errors, which the build reports.
    some = (boxes[:, :dims] <= boxes[:, dims:]).all(axis=1)
    boxes, stands_for = boxes[some], stands_for[some]
    weights = stands_for / max(1, stands_for.sum())
    if by_pairs and len(boxes):
        pairs = _estimate_pairs(boxes, stands_for.sum() / len(boxes)) * stands_for
        weights = weights / 2 + pairs / max(1, pairs.sum()) / 2
    centers = _centers(boxes)
    some = np.isfinite(centers).all(axis=0)
    return _split_at_medians(centers[:, some].T, weights[some], 0, partitions)


def _estimate_pairs(boxes, stands_for: float) -> np.ndarray:
    """How many objects overlap each box of a sample, if each stands for so many.

    A small count is mostly chance. So where a box overlaps fewer than 16 of the sample, all
    are enlarged first: half as many boxes of twice the volume have as many pairs each. Boxes
    without a volume grow too little, so their pairs are underestimated."""
    low, high = np.split(boxes.astype(np.float64), 2, axis=1)
    with np.errstate(invalid="ignore", over="ignore"):
        more = (high - low) / 2 * (stands_for ** (1 / low.shape[1]) - 1)
        more[~np.isfinite(more)] = 0
        enlarged = np.hstack([low - more, high + more])
    found, near = (hs.BVH(some).count(some) - 1 for some in (boxes, enlarged))
    return np.where(found < 16, near, found * stands_for)


def _split_at_medians(points, weights, first: int, count: int):
    """Splits points into the partitions from `first` on, of about equal weight, at the
    weighted median of the widest axis. Its width is that between the 5th and the 95th
    percentile: a few objects far away choose no axis."""
    if count == 1:
        return first
    axis, value = 0, 0.0
    if len(points):
        low, high = np.percentile(points, (5, 95), axis=0)
        axis = int(np.argmax(high - low))
        order = np.argsort(points[:, axis], kind="stable")
        points, weights = points[order], weights[order]
        sums = np.cumsum(weights)
        middle = np.searchsorted(sums, sums[-1] * (count // 2) / count)
        value = float(points[min(middle + 1, len(points) - 1), axis])
    is_low = points[:, axis] < value
    half = count // 2
    return (axis, value, _split_at_medians(points[is_low], weights[is_low], first, half),
            _split_at_medians(points[~is_low], weights[~is_low], first + half, count - half))


@dataclasses.dataclass(frozen=True)
class _Partition:
    tree: hs.BVH
    rows: np.ndarray  # of the objects, by id of the tree
    mapped: bool = False

    def __sizeof__(self):
        # Dask writes what fills the memory to disk. A mapped tree is there already.
        return self.rows.nbytes + (0 if self.mapped else self.tree.nbytes)

    def __reduce__(self):
        # A copy of a mapped tree is in memory.
        return _Partition, (self.tree, self.rows)


@dataclasses.dataclass(frozen=True)
class _Top:
    """What tasks know of all partitions."""

    bounds: np.ndarray
    sizes: np.ndarray  # numbers of objects
    nbytes: int
    tree: hs.BVH  # of the bounds

    @staticmethod
    def of(partitions: list) -> _Top:
        bounds = np.array([bounds for bounds, _, _ in partitions])
        sizes = np.array([size for _, size, _ in partitions], np.int64)
        return _Top(bounds, sizes, sum(size for _, _, size in partitions), hs.BVH(bounds))


@dataclasses.dataclass(frozen=True)
class _Routed:
    """Which rows of a chunk go to which partition: each to none, one or several."""

    data: np.ndarray
    first: typing.Any  # the number of the first row, or those of all rows
    rows: np.ndarray  # in `data`, grouped by partition
    partitions: np.ndarray  # ascending
    begins: np.ndarray  # of each group, and the end

    def __len__(self):
        return len(self.data)

    def __sizeof__(self):
        return self.data.nbytes + self.rows.nbytes

    @staticmethod
    def to(partitions, rows, data, first) -> _Routed:
        # NumPy sorts numbers of 16 bits five times as fast as of 64.
        small = partitions.astype(np.min_scalar_type(partitions.max(initial=0)))
        order = np.argsort(small, kind="stable")
        counts = np.bincount(partitions)
        numbers = np.flatnonzero(counts)
        begins = np.append(0, np.cumsum(counts[numbers]))
        return _Routed(data, first, rows[order], numbers, begins)


def _rows_to(routed: _Routed, begin: int, end: int):
    """What goes to the partitions from `begin` to `end`: the data of the rows, their
    numbers and their partitions."""
    i, j = np.searchsorted(routed.partitions, (begin, end))
    rows = routed.rows[routed.begins[i]:routed.begins[j]]
    sizes = np.diff(routed.begins[i:j + 1])
    numbers = rows + routed.first if np.ndim(routed.first) == 0 else routed.first[rows]
    return routed.data[rows], numbers, np.repeat(routed.partitions[i:j], sizes)


@dask.sizeof.sizeof.register(hs.BVH)
def _size_of_tree(tree: hs.BVH) -> int:
    return tree.nbytes


def _about_routed(routed: _Routed):
    return len(routed), routed.partitions


def _piece(routed: _Routed, partition: int, offset: int = 0):
    """The rows that go to one partition: what is sent to its worker. `offset` is added to
    their numbers."""
    data, numbers, _ = _rows_to(routed, partition, partition + 1)
    return data, numbers + offset


def _block(parts: list) -> _Routed:
    """What several chunks send to some partitions."""
    data, numbers, partitions = map(np.concatenate, zip(*parts))
    return _Routed.to(partitions, np.arange(len(data)), data, numbers)


def _step(partitions: int) -> int:
    return math.isqrt(partitions - 1) + 1


def _concatenate(found: list) -> tuple:
    return tuple(map(np.concatenate, zip(*found)))


def _of_chunk(found: tuple, chunk: int) -> tuple:
    some = found[0] >> _BITS == chunk
    return tuple(column[some] for column in found)


def _sum_up(lengths: typing.Iterable) -> list:
    return list(itertools.accumulate(lengths, initial=0))


def _offsets(lengths: list) -> list:
    """What makes (chunk << _BITS) + row the row of the whole collection."""
    return [first - (chunk << _BITS) for chunk, first in enumerate(_sum_up(lengths)[:-1])]


def _divisions(source: _Source):
    """The rows at which the chunks begin, and the last one, if they are known."""
    if not source.sizes or 0 in source.sizes:
        return None
    return (*source.firsts[:-1], source.firsts[-1] - 1)


def _pandas(index, rows, columns: dict):
    import pandas  # type: ignore

    if index is None:
        return pandas.DataFrame(columns)
    return pandas.DataFrame(columns, index=pandas.Index(rows, name=index))


# Tasks of a build.


def _sample(boxes, first: int, where: str, most: int):
    """Returns random boxes, for each how many objects it stands for, and the number of
    rows."""
    boxes = _rows(boxes, "boxes", where)
    count = min(len(boxes), most)
    rows = np.random.default_rng(first >> _BITS).choice(len(boxes), count, replace=False)
    return boxes[np.sort(rows)], np.full(count, len(boxes) / max(1, count)), len(boxes)


@dataclasses.dataclass(frozen=True)
class _Plan:
    splits: typing.Any
    offsets: list  # of rows

    @staticmethod
    def of(samples: list, partitions: int, by_pairs: bool) -> _Plan:
        boxes, stands_for, lengths = zip(*samples)
        width = boxes[0].shape[1]
        for chunk, some in enumerate(boxes):
            if some.shape[1] != width:
                raise ValueError(f"in chunk {chunk}: boxes have the shape (n, {some.shape[1]}), "
                                 f"and those in chunk 0 (n, {width})")
        return _Plan(_split_sample(np.concatenate(boxes), np.concatenate(stands_for),
                                   partitions, by_pairs), _offsets(lengths))


def _distribute(boxes, first: int, where: str, plan: _Plan) -> _Routed:
    boxes = _rows(boxes, "boxes", where)
    partitions, rows = zip(*_split_rows(plan.splits, _centers(boxes), np.arange(len(boxes))))
    return _Routed(boxes, first + plan.offsets[first >> _BITS], np.concatenate(rows),
                   np.array(partitions), np.array(_sum_up(map(len, rows))))


def _build(pieces, mapped: bool) -> _Partition:
    boxes = np.concatenate([boxes for boxes, _ in pieces])
    rows = np.concatenate([rows for _, rows in pieces])
    try:
        tree = hs.BVH(boxes)
    except ValueError:
        for box, row in zip(boxes, rows):  # by its row in the source, not in its partition
            _arrays.boxes(box, f"row {row} of boxes")
        raise
    if mapped:
        try:
            directory = distributed.get_worker().local_directory
        except ValueError:  # another scheduler
            directory = None
        with tempfile.TemporaryDirectory(dir=directory) as scratch:
            path = os.path.join(scratch, "tree")
            with open(path, "wb") as file:
                file.write(tree.blob())
            tree = hs.BVH.map(path)  # keeps the file's content
    return _Partition(tree, rows, mapped)


def _whole(results: list) -> hs.BVH:
    """All partitions as one tree, in which ids are rows."""
    *partitions, top = results
    boxes = np.empty((top.sizes.sum(), top.bounds.shape[1]), np.float32)
    for partition in partitions:
        boxes[partition.rows] = partition.tree.boxes()
    return hs.BVH(boxes)


def _about(partition: _Partition):
    return partition.tree.bounds, len(partition.tree), partition.tree.nbytes


# Tasks of pairs. Functions of kind `_pairs_in` return the pairs of some rows of a piece
# and the objects of a partition, of shape (2, n).


def _route(boxes, first: int, where: str, top: _Top) -> _Routed:
    boxes = _rows(boxes, "boxes", where)
    rows, partitions = _in_chunk(where, lambda: top.tree.query(boxes))
    return _Routed.to(partitions, rows, boxes, first)


def _route_border(partition: _Partition, top: _Top, after: int) -> _Routed:
    """Sends objects to the partitions whose bounds they overlap, after one."""
    _check_widths(top.bounds.shape[1], len(partition.tree.bounds))
    others = top.tree.query(partition.tree.bounds)
    others = others[others > after]
    found, ids = partition.tree.query(top.bounds[others])
    rows, places = np.unique(ids, return_inverse=True)
    return _Routed.to(others[found], places, partition.tree.boxes(rows),
                      partition.rows[rows])


def _all_pairs_in(partition: _Partition, piece):
    return _pairs_in(partition, piece, 0, len(piece[0]))


def _frame_of_query(found: list, offset: int):
    rows, ids = _concatenate(found)
    order = np.lexsort((ids, rows))
    return _pandas("row", rows[order] + offset, {"id": ids[order]})


def _frame_of_pairs(partition: _Partition, pieces: list):
    i, j = np.concatenate([partition.rows[partition.tree.pairs()]] + [
        _all_pairs_in(partition, piece) for piece in pieces], axis=1)
    return _pandas(None, None, {"i": np.minimum(i, j), "j": np.maximum(i, j)})


def _frame_of_join(partition: _Partition, pieces: list):
    j, i = _concatenate([_all_pairs_in(partition, piece) for piece in pieces])
    return _pandas(None, None, {"i": i, "j": j})


def _pairs_in(partition: _Partition, piece, begin: int, end: int):
    boxes, rows = piece
    pairs = partition.tree.query(boxes[begin:end])
    # In place, because each new array costs a worker page faults: the output is also the
    # indices, each of which is read before it is written. With this mode NumPy makes no copy.
    for numbers, row in ((rows[begin:end], pairs[0]), (partition.rows, pairs[1])):
        numbers.take(row, out=row, mode="clip")
    return pairs


def _own_pairs_in(partition: _Partition, piece, begin: int, end: int):
    pairs = _pairs_in(partition, piece, begin, end)
    return pairs.compress(pairs[0] < pairs[1], axis=1)


def _border_pairs_in(partition: _Partition, piece, begin: int, end: int):
    pairs = _pairs_in(partition, piece, begin, end)
    return np.stack([pairs.min(axis=0), pairs.max(axis=0)])


def _join_in(partition: _Partition, piece, begin: int, end: int):
    return _pairs_in(partition, piece, begin, end)[::-1]


def _ranges(partition: _Partition, piece, most: int) -> list[tuple[int, int]]:
    """Ranges of rows with about half of `most` pairs each, as every 64th row tells."""
    step = 64
    sums = np.cumsum(step * partition.tree.count(piece[0][::step]))
    ranges = []
    begin = done = 0
    while begin < len(sums):
        end = max(begin + 1, int(np.searchsorted(sums, done + most / 2, "right")))
        ranges.append((begin * step, min(end * step, len(piece[0]))))
        begin, done = end, sums[end - 1]
    return ranges


def _batches(pairs_in, partition: _Partition, piece, most: int, ranges):
    """Yields (pairs, begin, ranges that are left): at most `most` pairs, or those of
    one row. Without `piece`, it is all objects of the partition."""
    if piece is None:
        piece = partition.tree.boxes(), partition.rows
    left = collections.deque(_ranges(partition, piece, most) if ranges is None else ranges)
    while left:
        begin, end = left.popleft()
        pairs = pairs_in(partition, piece, begin, end)
        if pairs.shape[1] > most and end - begin > 1:
            middle = (begin + end) // 2
            left.extendleft([(middle, end), (begin, middle)])
        elif pairs.size:
            yield pairs, begin, left


def _some_pairs(pairs_in, partition: _Partition, piece, most: int, ranges):
    """Returns the first batch, and the ranges that are left."""
    for pairs, _, left in _batches(pairs_in, partition, piece, most, ranges):
        return pairs, list(left)
    return np.empty((2, 0), np.int64), []


def _write_pairs(pairs_in, partition: _Partition, piece, prefix: str, most: int, ranges):
    """Writes all pairs, a file for each batch, and returns the paths, and that no ranges
    are left. If the task runs again, it writes the same files."""
    paths: list = []
    for pairs, begin, _ in _batches(pairs_in, partition, piece, most, ranges):
        path = f"{prefix}-{begin:09}.npy"
        pairs = np.ascontiguousarray(pairs)  # which NumPy writes in one piece
        temporary = f"{path}.{uuid.uuid4().hex[:8]}.tmp"
        try:
            with open(temporary, "wb") as file:
                np.save(file, pairs)
            os.replace(temporary, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
        paths.append(path)
    return paths, []


# Tasks of k nearest.


def _nearest_in(partition: _Partition, piece, k: int, max_distance: float):
    """The rows of points, ids and distances, nearest first for each row."""
    points, rows = piece
    k = max(1, min(k, len(partition.tree)))
    ids, distances = partition.tree.nearest(points, k=k, max_distance=max_distance)
    some = ids >= 0
    return np.repeat(rows, some.sum(axis=1)), partition.rows[ids[some]], distances[some]


def _send_home(points, first: int, where: str, top: _Top, k: int) -> _Routed:
    """Sends each point to the nearest of the partitions that have k objects."""
    points = _rows(points, "points", where)
    numbers = np.flatnonzero(top.sizes >= k)
    if len(numbers) == 0:
        numbers = np.flatnonzero(top.sizes > 0)
    rows = np.arange(len(points) if len(numbers) else 0)
    nearest = rows
    if len(rows):
        homes = hs.BVH(top.bounds[numbers])
        nearest = _in_chunk(where, lambda: homes.nearest(points, k=1))[0][:, 0]
        nearest = numbers[np.maximum(nearest, 0)]
    return _Routed.to(nearest, rows, points, first)


def _send_on(home: _Routed, found: list, top: _Top, k: int, max_distance: float) -> _Routed:
    """Sends each point to the other partitions within the distance of its k-th."""
    points, dims = home.data, top.bounds.shape[1] // 2
    radius = np.full((len(points), 1), max_distance)
    home_of = np.full(len(points), -1)
    home_of[home.rows] = np.repeat(home.partitions, np.diff(home.begins))
    for rows, _, distances in found:
        rows, begins, counts = np.unique(rows, return_index=True, return_counts=True)
        some = counts == k
        radius[rows[some] - home.first, 0] = distances[begins[some] + k - 1]
    radius = radius * _FAR + _FARTHER
    # From the box of floats around a point or a box, as trees measure distances.
    with np.errstate(over="ignore"):
        near = points.astype(np.float32)
    low = np.where(near > points, np.nextafter(near, -np.float32(np.inf)), near)[:, :dims]
    high = np.where(near < points, np.nextafter(near, np.float32(np.inf)), near)[:, -dims:]
    with np.errstate(invalid="ignore"):
        low, high = low - radius, high + radius
    # The difference of infinities.
    low[np.isnan(low)], high[np.isnan(high)] = -np.inf, np.inf
    rows, partitions = top.tree.query(np.hstack([low, high]))
    is_other = partitions != home_of[rows]
    return _Routed.to(partitions[is_other], rows[is_other], points, home.first)


def _best(found: list, k: int):
    """The k nearest to each point, of all that partitions found: the rows of the points,
    ranks, ids and distances."""
    rows, ids, distances = _concatenate(found)
    order = np.lexsort((ids, distances, rows))
    rows, ids, distances = rows[order], ids[order], distances[order]
    rank = np.arange(len(rows)) - np.searchsorted(rows, rows)
    some = rank < k
    return rows[some], rank[some], ids[some], distances[some]


def _merge(home: _Routed, k: int, found: list):
    """All ids and distances of a chunk, and its number of rows."""
    count = len(home.data)
    all_ids = np.full((count, k), -1, np.int64)
    all_distances = np.full((count, k), np.inf, np.float32)
    if found:
        rows, rank, ids, distances = _best(found, k)
        all_ids[rows - home.first, rank] = ids
        all_distances[rows - home.first, rank] = distances
    return all_ids, all_distances, count


def _frame_of_nearest(found: list, offset: int, k: int):
    rows, _, ids, distances = _best(found, k)
    return _pandas("row", rows + offset, {"id": ids, "distance": distances})


# Running tasks.


def _cluster() -> tuple[int, int]:
    """The threads of the cluster, or of this process, and its memory. This is 0 if it has
    no limit."""
    try:
        workers = distributed.get_client().scheduler_info()["workers"].values()
    except ValueError:
        return dask.system.CPU_COUNT, 0
    if not workers:
        raise RuntimeError("the cluster has no workers: wait for one with "
                           "client.wait_for_workers(1)")
    limits = [worker["memory_limit"] or 0 for worker in workers]
    return (sum(worker["nthreads"] for worker in workers),
            sum(limits) if all(limits) else 0)


class _Steps:
    """The steps of searches. A subclass has add(function, *arguments), which makes a task,
    and each(items, start), which returns start(item) of each item."""

    def each_chunk(self, source, function, *arguments):
        """Makes a task for each chunk: function(rows, chunk << _BITS, where, ...)."""
        return self.each(range(len(source.keys)), lambda chunk: self.add(
            function, self.rows_of(source, chunk), chunk << _BITS, source.where(chunk),
            *arguments))

    def borders(self, of, to, are_own):
        """Makes a task for each partition of a tree. It sends objects to the partitions of
        another tree, or for pairs of one tree to the partitions after it."""
        return self.each(enumerate(of.partitions), lambda its: self.add(
            _route_border, its[1], to.top, its[0] if are_own else -1))

    def nearest(self, source, placed, k, max_distance):
        """Returns for each chunk what was sent to its nearest partitions, what these found,
        what was sent on, and what the other partitions found."""
        def send_on(its):
            return *its, self.add(_send_on, *its, placed.top, k, max_distance)

        homes = zip(self.each_chunk(source, _send_home, placed.top, k))
        found = self.search(homes, placed, _nearest_in, k, max_distance)
        return self.search(self.each(found, send_on), placed, _nearest_in, k, max_distance)


class _Tasks(_Steps, dict):
    """The lazy tasks of a layer by key."""

    def __init__(self, what: str):
        super().__init__()
        # Not of the arguments: a file that changed between two calls must be read again.
        self.name = f"halfspace-{what}-{uuid.uuid4().hex}"

    def add(self, function, *arguments):
        """Adds a task, and returns its key."""
        key = f"{self.name}-{function.__name__}", len(self)
        self[key] = (function, *arguments)
        return key

    @staticmethod
    def each(items, start) -> list:
        return list(map(start, items))

    @staticmethod
    def rows_of(source: _Source, chunk: int):
        return source.keys[chunk]

    def send(self, routed: list, partitions: int) -> list:
        """Adds tasks that send rows to partitions. Returns for each block of chunks the
        keys of its pieces, one for each partition. A block is one chunk, or with many
        partitions several: then a chunk has two tasks for each group of partitions, and
        a block has one for each partition."""
        blocks = [[key] * partitions for key in routed]
        if partitions > _ONE_STAGE:
            step = _step(partitions)
            blocks = []
            for first in range(0, len(routed), step):
                blocks.append([])
                for begin in range(0, partitions, step):
                    end = min(begin + step, partitions)
                    parts = [self.add(_rows_to, key, begin, end)
                             for key in routed[first:first + step]]
                    blocks[-1] += [self.add(_block, parts)] * (end - begin)
        return [[self.add(_piece, key, p) for p, key in enumerate(keys)] for keys in blocks]

    def search(self, items, placed: _Placed, search, *arguments) -> list:
        """Adds the tasks search(partition, piece, *arguments). The last element of an item
        is the key of what is routed. Returns the items with one more element: the keys of
        what is found. Results come back to their chunks as the rows were sent."""
        items, partitions = list(items), len(placed.partitions)
        found = [[self.add(search, partition, piece, *arguments)
                  for partition, piece in zip(placed.partitions, pieces)]
                 for pieces in self.send([its[-1] for its in items], partitions)]
        if partitions > _ONE_STAGE:
            step, blocks = _step(partitions), found
            found = []
            for keys in blocks:
                sums = [self.add(_concatenate, keys[begin:begin + step])
                        for begin in range(0, partitions, step)]
                found += [[self.add(_of_chunk, its_sum, chunk) for its_sum in sums]
                          for chunk in range(len(found), min(len(found) + step, len(items)))]
        return [(*its, keys) for its, keys in zip(items, found)]

    def frame(self, dependencies, keys, columns: dict, index=None, divisions=None):
        """A dask DataFrame of the frames of some tasks."""
        import dask.dataframe

        lazy = _Lazy(self.name, self, dependencies)
        meta = _pandas(index, np.empty(0, np.int64),
                       {column: np.empty(0, kind) for column, kind in columns.items()})
        return dask.dataframe.from_delayed([_delayed(lazy, key) for key in keys], meta=meta,
                                           divisions=divisions, prefix=self.name,
                                           verify_meta=False)

    def frames_of_chunks(self, source: _Source, lengths: list, frame_of, found, *arguments):
        """Adds tasks that make a frame of what was found of each chunk, with numbers of
        rows in the whole collection. `lengths` are tasks that return numbers of rows, to
        be added if these are not known."""
        if source.sizes is not None:
            offsets = _offsets(source.sizes)
        else:
            its = self.add(_offsets, [self.add(*length) for length in lengths])
            offsets = [(operator.getitem, its, chunk) for chunk in range(len(lengths))]
        return [self.add(frame_of, its_found, offset, *arguments)
                for its_found, offset in zip(found, offsets)]


class _Runner(_Steps):
    """Submits tasks, and yields their results with a bound on how many wait."""

    def __init__(self):
        self.client = distributed.get_client()
        self.threads, _ = _cluster()
        # A task that waits for others must not keep them from a thread.
        with contextlib.suppress(ValueError, AttributeError, KeyError):  # no task, or not again
            distributed.secede()

    def add(self, function, *arguments) -> distributed.Future:
        # Not pure: a file that changed between two calls must be read again.
        return self.client.submit(function, *arguments, pure=False)

    def rows_of(self, source: _Source, chunk: int) -> distributed.Future:
        lazy = _Lazy(_Tasks("chunk").name, {}, source.collections)
        return self.client.compute(_delayed(lazy, source.keys[chunk]))

    def search(self, items, placed: _Placed, search, *arguments):
        """The same with futures, for the partitions that get rows."""
        def start(its):
            *_, routed = its
            _, partitions = self.add(_about_routed, routed).result()
            return *its, [self.add(search, placed.partitions[p], self.add(_piece, routed, p),
                                   *arguments) for p in partitions]

        return self.each(items, start)

    def joins(self, pairs_in, routed, placed: _Placed, are_chunks: bool = True):
        """Yields the joins of pairs(), one for each partition that gets rows."""
        def about(one):
            return one, self.add(_about_routed, one)

        first = 0
        for chunk, (one, its) in enumerate(self.each(routed, about)):
            length, partitions = its.result()
            offset = first - (chunk << _BITS) if are_chunks else 0
            for p in partitions:
                yield pairs_in, placed.partitions[p], self.add(_piece, one, p, offset)
            first += length

    @staticmethod
    def by_row(futures):
        """Yields the number of the first row of each chunk, and its results. The last
        result of a future is the number of rows."""
        first = 0
        for future in futures:
            *found, length = future.result()
            if length > 0:
                yield first, *found
            first += length

    def each(self, items, start):
        """Yields start(item) of each item, of which a few were started before."""
        window: collections.deque = collections.deque()
        for item in items:
            window.append(start(item))
            if len(window) > 2 * self.threads:
                yield window.popleft()
        yield from window

    def stream(self, task, joins, most: int, running: dict):
        """Yields the results of task(*join, most, ranges), as they arrive. A task returns
        what to yield, and the ranges of rows that are left, which are jobs like others.
        Two tasks for each thread run, or wait with their results. `running` has their
        futures."""
        waiting: collections.deque = collections.deque([((join, None) for join in joins)])
        arriving = distributed.as_completed()
        while True:
            while waiting and len(running) < 2 * self.threads:
                job = next(waiting[0], None)
                if job is None:
                    waiting.popleft()
                    continue
                join, ranges = job
                future = self.add(task, *join, most, ranges)
                running[future] = join
                arriving.add(future)
            if not running:
                return
            future = next(arriving)
            join = running.pop(future)
            result, left = future.result()
            del future  # its result may leave the workers
            waiting.appendleft(zip(itertools.repeat(join), ([some] for some in left)))
            yield result

    def pairs(self, joins, most: int, to):
        """Streams the pairs of (pairs_in, partition, piece), or writes them."""
        most = _arrays.positive(most, "max_results", 2**63 - 1)
        running: dict = {}
        if to is None:
            found = self.stream(_some_pairs, joins, most, running)
            return (tuple(pairs) for pairs in found if pairs.size)
        to = os.path.abspath(to)
        os.makedirs(to, exist_ok=True)
        # A second call writes other files, and a task that runs twice the same.
        name = os.path.join(to, uuid.uuid4().hex)
        joins = ((*join, f"{name}-{n:09}") for n, join in enumerate(joins))
        try:
            return sorted(itertools.chain.from_iterable(
                self.stream(_write_pairs, joins, most, running)))
        except Exception:
            distributed.wait(list(running))  # they write, too
            for path in glob.iglob(glob.escape(name) + "*"):
                os.unlink(path)
            raise


# The interface.


@dataclasses.dataclass
class _Placed:
    """The partitions, and what tasks know of all of them: keys, or futures of a client."""

    partitions: list
    top: typing.Any
    client: distributed.Client | None = None
    known: typing.Any = None  # the result of `top`

    def is_lost(self) -> bool:
        return any(future.status in ("cancelled", "lost", "error")
                   for future in (*self.partitions, self.top))


class BVH(_Lazy, dask.base.DaskMethodsMixin):
    """A BVH over the workers of a Dask cluster: partitions of the objects, each a
    `halfspace.BVH`. It is a lazy Dask collection, with any of Dask's schedulers.

    boxes       what the module describes, of 2 or 3 dimensions
    partitions  their number; by default 2 for each thread of the cluster. Each must fit
                into the memory of its worker. More partitions share uneven work better,
                and take more tasks
    balance     "pairs": partitions have about equal numbers of objects, and of pairs
                that these are in, as a sample tells; or "objects"
    mapped      whether workers keep trees in files that they map: True, False, or by
                default None: if all trees need more than half of the workers' memory

    `persist()` builds it on the cluster, and returns a tree that refers to the built
    partitions. Without it, each computation builds them again. `compute()` returns one
    `halfspace.BVH` of all boxes, which `dask.delayed` functions also receive. A task can
    receive the tree itself: `client.submit(function, tree)`.

    A build reads `boxes` twice, or once if they fit into a quarter of the workers' memory.
    """

    def __init__(self, boxes, partitions: int | None = None, *, balance: str = "pairs",
                 mapped: bool | None = None):
        if balance not in ("pairs", "objects"):
            raise ValueError(f"balance must be 'pairs' or 'objects', not {balance!r}")
        if mapped not in (True, False, None):
            raise ValueError(f"mapped must be True, False or None, not {mapped!r}")
        threads, memory = _cluster()
        count = _arrays.positive(2 * threads if partitions is None else partitions,
                                 "partitions")
        source = _source(boxes, "boxes", (4, 6))
        self._width = source.width
        self._size = None if source.sizes is None else sum(source.sizes)
        is_small = memory == 0
        if self._size is not None:
            count = max(1, min(count, self._size))
            is_small |= 32 * 6 * self._size < memory
            if mapped is None:
                mapped = 0 < memory < 2 * _BYTES_PER_OBJECT * self._size
        samples = source if is_small else _source(_again(boxes), "boxes", (4, 6))
        self._partitions = count

        tasks = _Tasks("bvh")
        most = -(-_SAMPLE_PER_PARTITION * count // len(source.keys))
        plan = tasks.add(_Plan.of, tasks.each_chunk(samples, _sample, most), count,
                         balance == "pairs")
        sent = tasks.each_chunk(source, _distribute, plan)
        for p, pieces in enumerate(zip(*tasks.send(sent, count))):
            tasks[tasks.name, p] = (_build, list(pieces), bool(mapped))
        tasks[tasks.name, count] = (
            _Top.of, [tasks.add(_about, (tasks.name, p)) for p in range(count)])
        super().__init__(tasks.name, tasks, source.collections + samples.collections)

    __dask_scheduler__ = staticmethod(dask.threaded.get)

    def __dask_keys__(self) -> list:
        return [(self._name, p) for p in range(self._partitions + 1)]

    def __dask_tokenize__(self):
        return self._name

    @staticmethod
    def __dask_optimize__(graph, keys, **_):
        # Without the names of layers: Dask merges what it needs of collections of several
        # kinds, and of two layers of one name it keeps one.
        keys = list(dask.core.flatten(keys))
        return dask.blockwise.optimize_blockwise(graph, keys=keys).cull(set(keys)).to_dict()

    def __dask_postcompute__(self):
        return _whole, ()

    def __dask_postpersist__(self):
        return self._persisted, ()

    def _persisted(self, tasks, *, rename=None) -> BVH:
        tree = BVH.__new__(BVH)
        tree.__dict__.update(self.__getstate__())
        name = (rename or {}).get(self._name, self._name)
        if isinstance(tasks, HighLevelGraph):
            tree._name, tree._graph = name, tasks
        else:
            _Lazy.__init__(tree, name, dict(tasks))
        return tree

    def __getstate__(self) -> dict:
        return {key: value for key, value in self.__dict__.items() if key != "_on_cluster"}

    @property
    def npartitions(self) -> int:
        """The number of partitions."""
        return self._partitions

    def __len__(self) -> int:
        """The number of objects. If the sizes of chunks are unknown, this computes them."""
        if self._size is None:
            return int(self.sizes.compute().sum())
        return self._size

    def __bool__(self) -> bool:
        # As of a dask DataFrame. By default, it would compute the length.
        raise ValueError("the truth value of a halfspace.dask.BVH is ambiguous: use len()")

    def __repr__(self) -> str:
        size = "" if self._size is None else f"{self._size} boxes in "
        return f"<halfspace.dask.BVH: {size}{self._partitions} partitions>"

    def _top(self) -> Delayed:
        graph = self.__dask_optimize__(self._graph, [self._keys.top])
        return _delayed(_Lazy(_Tasks("top").name, graph), self._keys.top)

    @property
    def _keys(self) -> _Placed:
        *partitions, top = self.__dask_keys__()
        return _Placed(partitions, top)

    @property
    def nbytes(self) -> Delayed:
        """Bytes of all trees, in memory or mapped."""
        return self._top().nbytes

    @property
    def bounds(self) -> Delayed:
        """The bounds of each partition: (partitions, 6) or (partitions, 4)."""
        return self._top().bounds

    @property
    def sizes(self) -> Delayed:
        """The number of objects of each partition."""
        return self._top().sizes

    def query(self, boxes):
        """Finds all pairs of a given box and an object that overlap.

        Returns a dask DataFrame with the column "id" of the objects. Its index "row" has
        the rows of `boxes`. It has a partition for each chunk of `boxes`, sorted by row,
        and divisions if the sizes of chunks are known.
        """
        source = self._probes(boxes, "boxes", 2)
        tasks = _Tasks("query")
        routed = tasks.each_chunk(source, _route, self._keys.top)
        found = tasks.search(zip(routed), self._keys, _all_pairs_in)
        return self._frame_by_row(tasks, source, found, _frame_of_query, {"id": np.int64})

    def pairs(self):
        """Finds each pair of overlapping objects once, as "i" and "j" with i < j.

        Returns a dask DataFrame with a partition for each partition of the tree, in no
        order. Pairs of partitions are joined once, by the objects of one that overlap the
        bounds of the other.
        """
        return _join(self, self, _frame_of_pairs)

    def nearest(self, points, k: int = 1, max_distance: float = math.inf):
        """Finds the k objects that are nearest to each point or box, as `halfspace.BVH`.

        Returns a dask DataFrame with the columns "id" and "distance", and the rows of
        `points` as its index "row": up to k results of a row, nearest first and then by
        id. Where fewer than k objects are within `max_distance`, a row has fewer. Of
        objects at the same distance as the k-th, any can be the k-th. Partitions and
        divisions are those of `query`.

        The nearest partition with k objects gives each point a radius. Then all other
        partitions within it are searched.
        """
        k = _arrays.positive(k, "k")
        max_distance = _arrays.not_negative(max_distance, "max_distance")
        source = self._probes(points, "points", 1, 2)
        tasks = _Tasks("nearest")
        found = tasks.nearest(source, self._keys, k, max_distance)
        return self._frame_by_row(tasks, source, found, _frame_of_nearest,
                                  {"id": np.int64, "distance": np.float32}, k)

    def _probes(self, source, name: str, *of_width) -> _Source:
        dims = (self._width // 2,) if self._width else (2, 3)
        return _source(source, name, tuple(n * d for n in of_width for d in dims))

    def _frame_by_row(self, tasks: _Tasks, source: _Source, items: list, frame_of,
                      columns: dict, *arguments):
        """The frame of one search of each chunk, or of two."""
        lengths = [(len, its[0]) for its in items]
        found: list = [sum(its[1::2], []) for its in items]
        frames = tasks.frames_of_chunks(source, lengths, frame_of, found, *arguments)
        return tasks.frame([self, *source.collections], frames, columns, "row",
                           _divisions(source))

    # At once, on a cluster.

    def _place(self, run: _Runner) -> _Placed:
        """The partitions as futures. Builds them in the first call, if persist() did not,
        and after they were cancelled."""
        placed = self.__dict__.get("_on_cluster")
        if placed is None or placed.client is not run.client or placed.is_lost():
            # Under other names than those of futures that were cancelled.
            tree = self if placed is None else dask.graph_manipulation.clone(self)
            built = run.client.persist(tree)
            graph = dict(built.__dask_graph__())
            *partitions, top = (graph[key] for key in built.__dask_keys__())
            placed = self._on_cluster = _Placed(partitions, top, run.client, top.result())
        return placed

    def query_batches(self, boxes, *, max_results: int = MAX_RESULTS, to=None):
        """Finds all pairs of a given box and an object that overlap, at once.

        Returns an iterator of (rows, ids), two int64 arrays with at most `max_results`
        pairs, or with all of one row. Batches come as workers finish them.

        With `to`, the workers write the batches to that directory, as .npy files of the
        shape (2, pairs), and the call returns the paths. All workers must share the
        directory. It is created if it does not exist, and files in it stay. A call that
        fails deletes its files. A worker's memory then has one batch for each of its threads.
        """
        run, source = _Runner(), self._probes(boxes, "boxes", 2)
        placed = self._place(run)
        routed = run.each_chunk(source, _route, placed.top)
        return run.pairs(run.joins(_pairs_in, routed, placed), max_results, to)

    def pairs_batches(self, *, max_results: int = MAX_RESULTS, to=None):
        """Finds each pair of overlapping objects once, as (i, j) with i < j.

        Returns what query_batches() does.
        """
        run = _Runner()
        placed = self._place(run)
        own = ((_own_pairs_in, partition, None) for partition in placed.partitions)
        border = run.joins(_border_pairs_in, run.borders(placed, placed, True), placed, False)
        return run.pairs(itertools.chain(own, border), max_results, to)

    def nearest_batches(self, points, k: int = 1, max_distance: float = math.inf):
        """Finds the k objects that are nearest to each point or box, as `nearest`.

        Returns an iterator of (rows, ids, distances), one for each chunk of points: the
        rows of the points, and ids and distances of the shape (rows, k). Where fewer than
        k objects are within `max_distance`, ids are -1 and distances infinite.
        """
        k = _arrays.positive(k, "k")
        max_distance = _arrays.not_negative(max_distance, "max_distance")
        run, source = _Runner(), self._probes(points, "points", 1, 2)
        found = run.nearest(source, self._place(run), k, max_distance)
        merged = run.each(found, lambda its: run.add(_merge, its[0], k, its[1] + its[3]))
        return ((first + np.arange(len(ids)), ids, distances)
                for first, ids, distances in run.by_row(merged))


def _join(a: BVH, b: BVH, frame_of):
    """The frames of the partitions of `a`, and what those of `b` send to them."""
    tasks, its, others = _Tasks("join"), a._keys, b._keys
    borders = tasks.borders(others, its, frame_of is _frame_of_pairs)
    pieces = zip(*tasks.send(borders, a.npartitions))
    frames = [tasks.add(frame_of, partition, list(some))
              for partition, some in zip(its.partitions, pieces)]
    return tasks.frame([a, b], frames, {"i": np.int64, "j": np.int64})


def _check_trees(a: BVH, b: BVH) -> None:
    for name, tree in (("a", a), ("b", b)):
        if not isinstance(tree, BVH):
            raise TypeError(f"{name}: expected a halfspace.dask.BVH, got {type(tree).__name__}")
    if a._width and b._width:
        _check_widths(a._width, b._width)


def _check_widths(a: int, b: int) -> None:
    if a != b:
        raise ValueError(f"a and b must have the same dimensions; they have {a // 2} and "
                         f"{b // 2}")


def join(a: BVH, b: BVH):
    """Finds the pairs of an object of `a` and an object of `b` that overlap.

    Returns a dask DataFrame with the columns "i" and "j", rows of `a` and of `b`, and a
    partition for each of `a`. To join boxes that are in no BVH with a BVH, query it with
    them.
    """
    _check_trees(a, b)
    return _join(a, b, _frame_of_join)


def join_batches(a: BVH, b: BVH, *, max_results: int = MAX_RESULTS, to=None):
    """Finds the pairs of `join` at once, and returns what BVH.query_batches() does."""
    _check_trees(a, b)
    run = _Runner()
    its, other = a._place(run), b._place(run)
    _check_widths(its.known.bounds.shape[1], other.known.bounds.shape[1])
    joins = run.joins(_join_in, run.borders(other, its, False), its, False)
    return run.pairs(joins, max_results, to)


def scan(boxes, queries, *, quantized: bool = False):
    """Tests every box against every query, without a BVH: for few queries of boxes that
    are read once.

    boxes    as for BVH
    queries  (n, 6) or (n, 4): an array

    Returns a dask DataFrame with the columns "row" and "id", rows of `queries` and of
    `boxes`, and a partition for each chunk of boxes.
    """
    source, queries = _source_of_scan(boxes, queries)
    tasks = _Tasks("scan")
    its_queries = f"{tasks.name}-queries"
    tasks[its_queries] = queries
    found = tasks.each_chunk(source, _scan, its_queries, quantized)
    lengths = [(operator.getitem, key, 2) for key in found]
    frames = tasks.frames_of_chunks(source, lengths, _frame_of_scan, found)
    return tasks.frame(source.collections, frames, {"row": np.int64, "id": np.int64})


def scan_batches(boxes, queries, *, quantized: bool = False):
    """Finds what `scan` does at once, and returns an iterator of (rows, ids): two int64
    arrays for each chunk of boxes."""
    run = _Runner()
    source, queries = _source_of_scan(boxes, queries)
    found = run.by_row(run.each_chunk(source, _scan, queries, quantized))
    return ((rows, (ids & (1 << _BITS) - 1) + first) for first, rows, ids in found)


def _source_of_scan(boxes, queries):
    source = _source(boxes, "boxes", (4, 6))
    queries = _arrays.numbers(queries, "queries")
    _source(queries, "queries", (source.width,) if source.width else (4, 6))
    hs.BVH(queries)  # an error of a query is none of a chunk
    return source, queries


def _scan(boxes, first: int, where: str, queries, quantized: bool):
    boxes = _rows(boxes, "boxes", where)
    rows, ids = _in_chunk(
        where, lambda: hs.Scan(boxes, quantized=quantized).query(queries))
    return rows, ids + first, len(boxes)


def _frame_of_scan(found: tuple, offset: int):
    return _pandas(None, None, {"row": found[0], "id": found[1] + offset})
