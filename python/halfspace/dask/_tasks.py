"""Tasks: what a process does with the rows of a chunk and one partition. Tasks of a chunk
get its rows, and (chunk << BITS) as the number of the first."""

from __future__ import annotations

import collections
import os
import tempfile
import uuid

import distributed
import numpy as np

import halfspace as hs
from halfspace import _arrays
from halfspace.dask._partitions import (Partition, Routed, Top, centers_of, concatenate,
                                        split_rows, split_sample)
from halfspace.dask._source import BITS, of_chunk, of_collection, sum_up

# More than the rounding of distances (halfspace/bvh_nearest.h: 2^-20 and 2^-73).
_FAR = 1 + 2.0**-18
_FARTHER = 2.0**-70


def pandas_frame(columns: dict, rows=None):
    import pandas  # type: ignore

    index = None if rows is None else pandas.Index(rows, name="row")
    return pandas.DataFrame(columns, index=index)


# Tasks of a build.


@of_chunk("boxes")
def sample(boxes, first: int, most: int):
    """Returns random boxes, for each how many objects it stands for, and the number of
    rows."""
    count = min(len(boxes), most)
    rows = np.random.default_rng(first >> BITS).choice(len(boxes), count, replace=False)
    return boxes[np.sort(rows)], np.full(count, len(boxes) / max(1, count)), len(boxes)


def plan_of(samples: list, partitions: int, by_pairs: bool, query_extents=None) -> tuple:
    """Returns how to split rows, and the first row of each chunk."""
    boxes, stands_for, lengths = zip(*samples)
    width = boxes[0].shape[1]
    for chunk, some in enumerate(boxes):
        if some.shape[1] != width:
            raise ValueError(f"in chunk {chunk}: boxes have the shape (n, {some.shape[1]}), "
                             f"and those in chunk 0 (n, {width})")
    return split_sample(np.concatenate(boxes), np.concatenate(stands_for), partitions,
                        by_pairs, query_extents), sum_up(lengths)


@of_chunk("boxes")
def distribute(boxes, first: int, plan: tuple) -> Routed:
    splits, firsts = plan
    partitions, rows = zip(*split_rows(splits, centers_of(boxes), np.arange(len(boxes))))
    return Routed(boxes, firsts[first >> BITS], np.concatenate(rows), np.array(partitions),
                  np.array(sum_up(map(len, rows))))


def build(pieces, mapped: bool, query_extents=None) -> Partition:
    boxes, rows = concatenate(pieces)
    try:
        tree = hs.BVH(boxes, query_extents=query_extents)
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
    return Partition(tree, rows, mapped)


def whole(results: list) -> hs.BVH:
    """All partitions as one tree, in which ids are rows."""
    *partitions, top = results
    boxes = np.empty((top.sizes.sum(), top.bounds.shape[1]), np.float32)
    for partition in partitions:
        boxes[partition.rows] = partition.tree.boxes()
    return hs.BVH(boxes)


def about(partition: Partition):
    return partition.tree.bounds, len(partition.tree), partition.tree.nbytes


# Tasks of pairs. Functions of kind `pairs_in` return the pairs of some rows of a piece
# and the objects of a partition, of shape (2, n).


@of_chunk("boxes")
def route(boxes, first: int, top: Top) -> Routed:
    rows, partitions = top.tree.query(boxes)
    return Routed.to(partitions, rows, boxes, first)


def route_border(partition: Partition, top: Top, after: int) -> Routed:
    """Sends objects to the partitions whose bounds they overlap, after one."""
    check_widths(top.bounds.shape[1], len(partition.tree.bounds))
    others = top.tree.query(partition.tree.bounds)
    others = others[others > after]
    found, ids = partition.tree.query(top.bounds[others])
    rows, places = np.unique(ids, return_inverse=True)
    return Routed.to(others[found], places, partition.tree.boxes(rows),
                      partition.rows[rows])


def check_widths(a: int, b: int) -> None:
    if a != b:
        raise ValueError(f"a and b must have the same dimensions; they have {a // 2} and "
                         f"{b // 2}")


def frame_of_query(found: list, first: int):
    rows, ids = concatenate(found)
    order = np.lexsort((ids, rows))
    return pandas_frame({"id": ids[order]}, of_collection(rows[order], first))


def frame_of_pairs(partition: Partition, pieces: list):
    i, j = np.concatenate([partition.rows[partition.tree.pairs()]] + [
        pairs_in(partition, piece) for piece in pieces], axis=1)
    return pandas_frame({"i": np.minimum(i, j), "j": np.maximum(i, j)})


def frame_of_join(partition: Partition, pieces: list):
    j, i = concatenate([pairs_in(partition, piece) for piece in pieces])
    return pandas_frame({"i": i, "j": j})


def pairs_in(partition: Partition, piece, begin: int = 0, end: int | None = None):
    boxes, rows = piece
    pairs = partition.tree.query(boxes[begin:end])
    # In place, because each new array costs a worker page faults: the output is also the
    # indices, each of which is read before it is written. With this mode NumPy makes no copy.
    for numbers, row in ((rows[begin:end], pairs[0]), (partition.rows, pairs[1])):
        numbers.take(row, out=row, mode="clip")
    return pairs


def own_pairs_in(partition: Partition, piece, begin: int, end: int):
    pairs = pairs_in(partition, piece, begin, end)
    return pairs.compress(pairs[0] < pairs[1], axis=1)


def border_pairs_in(partition: Partition, piece, begin: int, end: int):
    pairs = pairs_in(partition, piece, begin, end)
    return np.stack([pairs.min(axis=0), pairs.max(axis=0)])


def join_in(partition: Partition, piece, begin: int, end: int):
    return pairs_in(partition, piece, begin, end)[::-1]


def _ranges(partition: Partition, piece, most: int) -> list[tuple[int, int]]:
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


def _batches(pairs_in, partition: Partition, piece, most: int, ranges):
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


def some_pairs(pairs_in, partition: Partition, piece, most: int, ranges):
    """Returns the first batch, and the ranges that are left."""
    for pairs, _, left in _batches(pairs_in, partition, piece, most, ranges):
        return pairs, list(left)
    return np.empty((2, 0), np.int64), []


def write_pairs(pairs_in, partition: Partition, piece, prefix: str, most: int, ranges):
    """Writes all pairs, a file for each batch, and returns the paths, and that no ranges
    are left. If the task runs again, it writes the same files. If it fails, the call
    deletes all of them."""
    paths: list = []
    for pairs, begin, _ in _batches(pairs_in, partition, piece, most, ranges):
        path = f"{prefix}-{begin:09}.npy"
        pairs = np.ascontiguousarray(pairs)  # which NumPy writes in one piece
        temporary = f"{path}.{uuid.uuid4().hex[:8]}.tmp"
        with open(temporary, "wb") as file:
            np.save(file, pairs)
        os.replace(temporary, path)
        paths.append(path)
    return paths, []


# Tasks of k nearest.


def nearest_in(partition: Partition, piece, k: int, max_distance: float):
    """The rows of points, ids and distances, nearest first for each row."""
    points, rows = piece
    k = max(1, min(k, len(partition.tree)))
    ids, distances = partition.tree.nearest(points, k=k, max_distance=max_distance)
    some = ids >= 0
    return np.repeat(rows, some.sum(axis=1)), partition.rows[ids[some]], distances[some]


@of_chunk("points")
def send_home(points, first: int, top: Top, k: int) -> Routed:
    """Sends each point to the nearest of the partitions that have k objects, or of all if
    none has so many."""
    numbers = np.flatnonzero(top.sizes >= k)
    if len(numbers) == 0:
        numbers = np.arange(len(top.sizes))
    nearest, _ = hs.BVH(top.bounds[numbers]).nearest(points, k=1)
    homes = numbers[np.maximum(nearest[:, 0], 0)]
    return Routed.to(homes, np.arange(len(points)), points, first)


def send_on(home: Routed, found: list, top: Top, k: int, max_distance: float) -> Routed:
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
    return Routed.to(partitions[is_other], rows[is_other], points, home.first)


def _best(found: list, k: int):
    """The k nearest to each point, of all that partitions found: the rows of the points,
    ranks, ids and distances."""
    rows, ids, distances = concatenate(found)
    order = np.lexsort((ids, distances, rows))
    rows, ids, distances = rows[order], ids[order], distances[order]
    rank = np.arange(len(rows)) - np.searchsorted(rows, rows)
    some = rank < k
    return rows[some], rank[some], ids[some], distances[some]


def merge(home: Routed, top: Top, k: int, found: list):
    """All ids and distances of a chunk, and its number of rows."""
    count, k = len(home.data), max(1, min(k, int(top.sizes.sum())))
    all_ids = np.full((count, k), -1, np.int64)
    all_distances = np.full((count, k), np.inf, np.float32)
    if found:
        rows, rank, ids, distances = _best(found, k)
        all_ids[rows - home.first, rank] = ids
        all_distances[rows - home.first, rank] = distances
    return all_ids, all_distances, count


def frame_of_nearest(found: list, first: int, k: int):
    rows, _, ids, distances = _best(found, k)
    return pandas_frame({"id": ids, "distance": distances}, of_collection(rows, first))


# Tasks of scans.


@of_chunk("boxes")
def scan(boxes, _, queries, quantized: bool):
    """Returns pairs of a query and a row of the chunk, and its number of rows."""
    rows, ids = hs.Scan(boxes, quantized=quantized).query(queries)
    return rows, ids, len(boxes)


def frame_of_scan(found: tuple, first: int):
    return pandas_frame({"row": found[0], "id": found[1] + first})
