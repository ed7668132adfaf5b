"""Joins, box queries and k nearest on Dask, over more boxes than one machine holds.

    from distributed import Client
    import halfspace.dask as hd

    client = Client("scheduler:8786")
    tree = hd.BVH(boxes)                         # a dask array (n, 6) or (n, 4)
    for rows, ids in tree.query(probes): ...     # pairs, one batch after another
    paths = tree.query(probes, to="out")         # or files, written by the workers
    for i, j in tree.pairs(): ...
    for rows, ids, distances in tree.nearest(points, k=8): ...

Boxes and points are a dask array of rows, a numpy array, or a list of paths of `.npy`
files that every worker can read. The id of an object is its row in the whole
collection, an int64. Boxes mean what they mean in `halfspace.BVH`: boxes that touch
overlap, and boxes of doubles are rounded outward to floats.

How it works: a sample of the boxes is split at medians, one split for each further
partition. Each object belongs to the one partition that has its center, so no pair is
found twice. A partition is a `halfspace.BVH` in the memory of one worker. The bounds of
the partitions form one more BVH, which every task gets. A probe goes to each partition
that it overlaps. docs/scale.md has a picture, measurements and a model of the cost.

A lost worker costs time only: Dask makes its partitions again from the source. So the
source must stay readable, and must return the same boxes when it is read again.

Thread safety: calls may run at the same time.
"""

from __future__ import annotations

import collections
import dataclasses
import functools
import itertools
import math
import os
import tempfile
import typing
import uuid

import dask
import dask.array
import dask.sizeof
import distributed
import numpy as np

import halfspace as hs
from halfspace import _arrays, _files

__all__ = ["BVH", "join", "scan"]

MAX_RESULTS = 10_000_000

# Rows of one task, where the source has no chunks of its own.
_CHUNK_ROWS = 1_000_000
# Boxes in the sample for each partition: the number of objects of a partition is then
# right within about a tenth.
_SAMPLE_PER_PARTITION = 100
# A tree of boxes in 3 dimensions, and the row of each object.
_BYTES_PER_OBJECT = 56
# More than the rounding of distances (halfspace/bvh_nearest.h: 2^-20 and 2^-73).
_FAR = 1 + 2.0**-18
_FARTHER = 2.0**-70


# The source: rows in chunks.


@dataclasses.dataclass(frozen=True)
class _Chunk:
    first: int  # the row where it begins
    rows: int
    data: typing.Any  # a Delayed of the rows


def _read(path: str, begin: int, end: int) -> np.ndarray:
    return np.array(np.load(path, mmap_mode="r")[begin:end])


def _chunks(source, name: str, widths: tuple[int, ...]) -> tuple[list[_Chunk], int]:
    """Returns the chunks of a collection, and the width of its rows."""
    wanted = " or ".join(f"(n, {width})" for width in widths)
    parts: list[tuple[int, typing.Any]] = []  # rows, and their Delayed
    width = 0

    def check(shape, what: str) -> None:
        nonlocal width
        if len(shape) != 2 or shape[1] not in ((width,) if width else widths):
            raise ValueError(f"{name} must have the shape {wanted}, and {what} has "
                             f"{tuple(shape)}")
        width = shape[1]

    if isinstance(source, (str, os.PathLike)):
        source = [source]
    if isinstance(source, dask.array.Array):
        check(source.shape, "the dask array")
        if any(math.isnan(rows) for rows in source.chunks[0]):
            raise ValueError(f"{name} must have chunks of known sizes: call its "
                             "compute_chunk_sizes() first")
        source = source.rechunk({1: -1})
        parts = list(zip(source.chunks[0], source.to_delayed()[:, 0]))
    elif isinstance(source, (list, tuple)) and source and all(
            isinstance(path, (str, os.PathLike)) for path in source):
        for path in (os.path.abspath(os.fsdecode(path)) for path in source):
            shape = np.load(path, mmap_mode="r").shape
            check(shape, path)
            for begin in range(0, shape[0], _CHUNK_ROWS):
                end = min(begin + _CHUNK_ROWS, shape[0])
                parts.append((end - begin, dask.delayed(_read)(path, begin, end)))
    else:
        array = _arrays.numbers(source, name)
        check(array.shape, "the array")
        for begin in range(0, len(array), _CHUNK_ROWS):
            rows = array[begin:begin + _CHUNK_ROWS]
            parts.append((len(rows), dask.delayed(rows)))
    firsts = itertools.accumulate((rows for rows, _ in parts), initial=0)
    return [_Chunk(first, rows, data)
            for first, (rows, data) in zip(firsts, parts) if rows > 0], width


def _in_chunk(first: int, call):
    """Returns call(). An error of it says where the chunk begins."""
    try:
        return call()
    except (ValueError, TypeError) as error:
        raise type(error)(f"in the chunk that begins at row {first}: {error}") from None


def _rows(chunk, name: str, first: int) -> np.ndarray:
    """The rows of a chunk as a plain array."""
    return _in_chunk(first, lambda: _arrays.numbers(chunk, name))


# Partitions.


@dataclasses.dataclass(frozen=True)
class _Splits:
    """A k-d tree. Points below `value` on `axis` go to `low`, the others to `high`: a
    node, or if it is negative the partition -1 - child."""

    nodes: list

    def partitions_of(self, points: np.ndarray) -> np.ndarray:
        partitions = np.zeros(len(points), np.int64)
        work = [(0, np.arange(len(points)))] if self.nodes else []
        while work:
            node, rows = work.pop()
            axis, value, low, high = self.nodes[node]
            is_low = points[rows, axis] < value
            for child, some in ((low, rows[is_low]), (high, rows[~is_low])):
                if child < 0:
                    partitions[some] = -1 - child
                elif len(some):
                    work.append((child, some))
        return partitions


def _centers(boxes: np.ndarray) -> np.ndarray:
    """Centers in double. That of an infinite box may be a NaN, which has a partition,
    too."""
    boxes = np.asarray(boxes, np.float64)
    dims = boxes.shape[1] // 2
    with np.errstate(invalid="ignore"):
        return boxes[:, :dims] / 2 + boxes[:, dims:] / 2


def _split_sample(boxes, stands_for, partitions: int, by_pairs: bool) -> _Splits:
    """Splits a sample into partitions of about equal work. By pairs, half of the weight
    of a box is for the objects that it stands for, and half for their pairs. So no
    partition has more than twice its share of either, as far as the sample tells."""
    dims = boxes.shape[1] // 2
    # Not empty boxes. Those with a NaN are errors, which the build reports.
    some = (boxes[:, :dims] <= boxes[:, dims:]).all(axis=1)
    boxes, stands_for = boxes[some], stands_for[some]
    weights = stands_for / max(1, stands_for.sum())
    if by_pairs:
        pairs = (hs.BVH(boxes).count(boxes) - 1) * stands_for
        weights = weights / 2 + pairs / max(1, pairs.sum()) / 2
    return _split_at_medians(_centers(boxes), weights, partitions)


def _split_at_medians(points, weights, partitions: int) -> _Splits:
    """Splits points into partitions of about equal weight, at the weighted median of
    the widest axis. Its width is that between the 5th and the 95th percentile: a few
    objects far away choose no axis."""
    nodes: list = []
    numbers = itertools.count()

    def split(rows: np.ndarray, count: int) -> int:
        if count == 1:
            return -1 - next(numbers)
        node = len(nodes)
        nodes.append(None)
        axis, value = 0, 0.0
        if len(rows):
            low, high = np.percentile(points[rows], (5, 95), axis=0)
            axis = int(np.argmax(high - low))
            rows = rows[np.argsort(points[rows, axis], kind="stable")]
            sums = np.cumsum(weights[rows])
            middle = np.searchsorted(sums, sums[-1] * (count // 2) / count)
            value = float(points[rows[min(middle + 1, len(rows) - 1)], axis])
        is_low = points[rows, axis] < value
        low_child = split(rows[is_low], count // 2)
        nodes[node] = (axis, value, low_child, split(rows[~is_low], count - count // 2))
        return node

    split(np.flatnonzero(np.isfinite(points).all(axis=1)), partitions)
    return _Splits(nodes)


@dataclasses.dataclass(frozen=True)
class _Partition:
    tree: hs.BVH
    rows: np.ndarray  # of the objects, by id of the tree
    mapped: bool = False

    def __reduce__(self):
        # A copy of a mapped tree is in memory.
        return _Partition, (self.tree, self.rows)


@dataclasses.dataclass(frozen=True)
class _Routed:
    """Which rows of a chunk go to which partition: each to none, one or several."""

    data: np.ndarray
    first: int  # the chunk's first row
    rows: np.ndarray  # in `data`, grouped by partition
    partitions: np.ndarray  # ascending
    begins: np.ndarray  # of each group, and the end

    @staticmethod
    def to(partitions, rows, data, first: int) -> _Routed:
        order = np.argsort(partitions, kind="stable")
        numbers, begins = np.unique(partitions[order], return_index=True)
        return _Routed(data, first, rows[order], numbers, np.append(begins, len(order)))


@dask.sizeof.sizeof.register(hs.BVH)
def _size_of_tree(tree: hs.BVH) -> int:
    return tree.nbytes


@dask.sizeof.sizeof.register(_Partition)
def _size_of_partition(partition: _Partition) -> int:
    # Dask writes what fills the memory to disk. A mapped tree is there already.
    tree = 0 if partition.mapped else partition.tree.nbytes
    return tree + partition.rows.nbytes


@dask.sizeof.sizeof.register(_Routed)
def _size_of_routed(routed: _Routed) -> int:
    return int(routed.data.nbytes + routed.rows.nbytes)


def _targets(routed: _Routed) -> np.ndarray:
    return routed.partitions


def _piece(routed: _Routed, partition: int):
    """The rows that go to one partition: what is sent to its worker."""
    at = np.searchsorted(routed.partitions, partition)
    if at == len(routed.partitions) or routed.partitions[at] != partition:
        return routed.data[:0].copy(), np.empty(0, np.int64)
    rows = routed.rows[routed.begins[at]:routed.begins[at + 1]]
    return routed.data[rows], rows + routed.first


# Tasks of a build.


def _sample(boxes, first: int, share: float):
    """Returns random boxes, and for each how many objects it stands for."""
    boxes = _rows(boxes, "boxes", first)
    count = max(1, math.ceil(len(boxes) * share))
    rows = np.random.default_rng(first).choice(len(boxes), count, replace=False)
    return boxes[np.sort(rows)], np.full(count, len(boxes) / count)


def _distribute(boxes, first: int, splits: _Splits) -> _Routed:
    boxes = _rows(boxes, "boxes", first)
    partitions = splits.partitions_of(_centers(boxes))
    return _Routed.to(partitions, np.arange(len(boxes)), boxes, first)


def _build(pieces, mapped: bool) -> _Partition:
    boxes = np.concatenate([boxes for boxes, _ in pieces])
    rows = np.concatenate([rows for _, rows in pieces])
    try:
        tree = hs.BVH(boxes)
    except ValueError as error:
        raise _error_of_row(boxes, rows) or error from None
    if mapped:
        directory = distributed.get_worker().local_directory
        with tempfile.TemporaryDirectory(dir=directory) as scratch:
            path = os.path.join(scratch, "tree")
            with open(path, "wb") as file:
                file.write(tree.blob())
            tree = hs.BVH.map(path)  # keeps the file's content
    return _Partition(tree, rows, mapped)


def _error_of_row(boxes, rows) -> ValueError | None:
    """The error of one box, by its row in the source and not in its partition."""
    for box, row in zip(boxes, rows):
        try:
            _arrays.boxes(box, f"row {row} of boxes")
        except ValueError as error:
            return error
    return None


def _about(partition: _Partition):
    return partition.tree.bounds, len(partition.tree), partition.tree.nbytes


# Tasks of pairs. Functions of kind `_pairs_in` return the pairs of some rows of a piece
# and the objects of a partition.


def _route(boxes, first: int, top: hs.BVH) -> _Routed:
    boxes = _rows(boxes, "boxes", first)
    rows, partitions = _in_chunk(first, lambda: top.query(boxes))
    return _Routed.to(partitions, rows, boxes, first)


def _border(partition: _Partition, bounds: np.ndarray):
    """The objects of a partition that overlap the bounds of another."""
    ids = partition.tree.query(bounds)
    return partition.tree.boxes(ids), partition.rows[ids]


def _pairs_in(partition: _Partition, piece, begin: int, end: int):
    boxes, rows = piece
    some, ids = partition.tree.query(boxes[begin:end])
    return rows[begin + some], partition.rows[ids]


def _own_pairs_in(partition: _Partition, piece, begin: int, end: int):
    i, j = _pairs_in(partition, piece, begin, end)
    return i[i < j], j[i < j]


def _border_pairs_in(partition: _Partition, piece, begin: int, end: int):
    i, j = _pairs_in(partition, piece, begin, end)
    return np.minimum(i, j), np.maximum(i, j)


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


def _batches(pairs_in, partition: _Partition, piece, most: int, ranges=None):
    """Yields (pairs, begin, ranges that are left): at most `most` pairs, or those of
    one row. Without `piece`, it is all objects of the partition."""
    if piece is None:
        piece = partition.tree.boxes(), partition.rows
    left = collections.deque(_ranges(partition, piece, most) if ranges is None else ranges)
    while left:
        begin, end = left.popleft()
        pairs = pairs_in(partition, piece, begin, end)
        if len(pairs[0]) > most and end - begin > 1:
            middle = (begin + end) // 2
            left.extendleft([(middle, end), (begin, middle)])
        elif len(pairs[0]):
            yield pairs, begin, left


def _some_pairs(pairs_in, partition: _Partition, piece, most: int, ranges=None):
    """Returns the first batch, and the ranges that are left."""
    for pairs, _, left in _batches(pairs_in, partition, piece, most, ranges):
        return pairs, list(left)
    return (np.empty(0, np.int64), np.empty(0, np.int64)), []


def _write_pairs(pairs_in, partition: _Partition, piece, most: int, prefix: str):
    """Writes all pairs, a file for each batch, and returns the paths. If the task runs
    again, it writes the same files."""
    paths = []
    for pairs, begin, _ in _batches(pairs_in, partition, piece, most):
        path = f"{prefix}-{begin:09}.npy"
        _files.replace(path, lambda file: np.save(file, np.stack(pairs)))
        paths.append(path)
    return paths


# Tasks of k nearest. Where fewer are found, an id is -1 and a distance infinite.


def _nearest_in(partition: _Partition, piece, k: int, max_distance: float):
    points, rows = piece
    ids, distances = partition.tree.nearest(points, k=k, max_distance=max_distance)
    return rows, np.append(partition.rows, -1)[ids], distances


def _send_home(points, first: int, homes: hs.BVH, numbers: np.ndarray) -> _Routed:
    """Sends each point to the nearest of some partitions."""
    points = _rows(points, "points", first)
    nearest, _ = _in_chunk(first, lambda: homes.nearest(points, k=1))
    partitions = numbers[np.maximum(nearest[:, 0], 0)]
    return _Routed.to(partitions, np.arange(len(points)), points, first)


def _send_on(points, first: int, home: _Routed, found: list, top: hs.BVH,
             max_distance: float) -> _Routed:
    """Sends each point to the other partitions within the distance of its k-th."""
    points = _rows(points, "points", first)
    radius = np.full((len(points), 1), max_distance)
    home_of = np.empty(len(points), np.int64)
    home_of[home.rows] = np.repeat(home.partitions, np.diff(home.begins))
    for rows, _, distances in found:
        radius[rows - first] = np.minimum(max_distance, distances[:, -1:])
    radius = radius * _FAR + _FARTHER
    # From the box of floats around a point, as trees measure distances.
    near = points.astype(np.float32)
    low = np.where(near > points, np.nextafter(near, -np.float32(np.inf)), near)
    high = np.where(near < points, np.nextafter(near, np.float32(np.inf)), near)
    with np.errstate(invalid="ignore"):
        low, high = low - radius, high + radius
    # The difference of infinities.
    low[np.isnan(low)], high[np.isnan(high)] = -np.inf, np.inf
    rows, partitions = top.query(np.hstack([low, high]))
    is_other = partitions != home_of[rows]
    return _Routed.to(partitions[is_other], rows[is_other], points, first)


def _merge(first: int, count: int, k: int, found: list):
    """The k nearest to each point of a chunk, of all that partitions found."""
    rows = np.concatenate([np.repeat(rows - first, k) for rows, _, _ in found])
    ids = np.concatenate([ids.reshape(-1) for _, ids, _ in found])
    distances = np.concatenate([distances.reshape(-1) for _, _, distances in found])
    order = np.lexsort((ids, distances, rows))
    rows, ids, distances = rows[order], ids[order], distances[order]
    rank = np.arange(len(rows)) - np.searchsorted(rows, rows)
    some = (rank < k) & (ids >= 0)
    all_ids = np.full((count, k), -1, np.int64)
    all_distances = np.full((count, k), np.inf, np.float32)
    all_ids[rows[some], rank[some]] = ids[some]
    all_distances[rows[some], rank[some]] = distances[some]
    return np.arange(first, first + count), all_ids, all_distances


# Running tasks.


class _Runner:
    """Submits tasks, and yields their results with a bound on how many wait."""

    def __init__(self, client: distributed.Client | None):
        self.client = client or distributed.get_client()
        self.threads = sum(self.client.nthreads().values())
        if self.threads == 0:
            raise RuntimeError("the cluster has no workers: wait for one with "
                               "client.wait_for_workers(1)")

    def submit(self, function, *arguments) -> distributed.Future:
        # Not pure: a file that changed between two calls must be read again.
        return self.client.submit(function, *arguments, pure=False)

    def memory(self) -> int:
        """The memory of all workers, or 0 if one of them has no limit."""
        limits = self.client.run(
            lambda dask_worker: dask_worker.memory_manager.memory_limit).values()
        return sum(limits) if all(limits) else 0

    def source(self, chunk: _Chunk) -> distributed.Future:
        return self.client.compute(chunk.data)

    def ahead(self, items, start):
        """Yields start(item) of each item, of which a few were started before."""
        window: collections.deque = collections.deque()
        for item in items:
            window.append(start(item))
            if len(window) > 2 * self.threads:
                yield window.popleft()
        yield from window

    def stream(self, jobs):
        """Yields the results of jobs as they arrive. A job is a future, and None or a
        function of the result that returns what to yield, and an iterable of more jobs.
        A task is submitted when its job is taken from its iterable, so at most two for
        each thread run, or wait with their results."""
        waiting: collections.deque = collections.deque([iter(jobs)])
        running = distributed.as_completed()
        follow: dict = {}
        while True:
            while waiting and len(follow) < 2 * self.threads:
                job = next(waiting[0], None)
                if job is None:
                    waiting.popleft()
                    continue
                follow[job[0]] = job[1]
                running.add(job[0])
            if not follow:
                return
            job = None
            future = next(running)
            function = follow.pop(future)
            result = future.result()
            del future  # its result may leave the workers
            if function is not None:
                result, more = function(result)
                waiting.appendleft(iter(more))
            yield result

    def pairs(self, joins, most: int, to):
        """Streams the pairs of (pairs_in, partition, piece), or writes them."""
        most = _arrays.positive(most, "max_results", 2**63 - 1)
        if to is None:
            return self._stream_pairs(joins, most)
        to = os.path.abspath(to)
        os.makedirs(to, exist_ok=True)
        # A second call writes other files, and a task that runs twice the same.
        name = os.path.join(to, uuid.uuid4().hex)
        jobs = ((self.submit(_write_pairs, *join, most, f"{name}-{n:09}"), None)
                for n, join in enumerate(joins))
        return sorted(itertools.chain.from_iterable(self.stream(jobs)))

    def _stream_pairs(self, joins, most: int):
        def job(join, ranges=None):
            return (self.submit(_some_pairs, *join, most, ranges),
                    functools.partial(follow, join))

        def follow(join, result):
            pairs, left = result
            return pairs, (job(join, [some]) for some in left)

        return (pairs for pairs in self.stream(map(job, joins)) if len(pairs[0]))


# The interface.


class BVH:
    """A BVH over the workers of a Dask cluster: partitions of the objects, each a
    `halfspace.BVH`.

    boxes       (n, 6) or (n, 4): a dask array, an array, or a list of .npy paths
    partitions  their number; by default 2 for each thread of the cluster. Each must fit
                into the memory of its worker. More partitions share uneven work better,
                and take more tasks: one for each partition and chunk of `boxes`
    balance     "pairs": partitions have about equal numbers of objects, and of pairs
                that these are in, as a sample tells; or "objects"
    mapped      whether workers keep trees in files that they map: True, False, or by
                default None: if all trees need more than half of the workers' memory
    client      a `distributed.Client`; by default the current one

    The constructor returns when all partitions exist: building is not lazy. It reads
    `boxes` twice, or once if they fit into a quarter of the workers' memory.
    """

    def __init__(self, boxes, partitions: int | None = None, *, balance: str = "pairs",
                 mapped: bool | None = None,
                 client: distributed.Client | None = None):
        if balance not in ("pairs", "objects"):
            raise ValueError(f"balance must be 'pairs' or 'objects', not {balance!r}")
        self._run = run = _Runner(client)
        if partitions is None:
            partitions = 2 * run.threads
        partitions = _arrays.positive(partitions, "partitions")
        chunks, self._width = _chunks(boxes, "boxes", (4, 6))
        self._size = sum(chunk.rows for chunk in chunks)
        partitions = min(partitions, self._size)
        memory = run.memory()
        if mapped is None:
            mapped = 0 < memory < 2 * _BYTES_PER_OBJECT * self._size

        # Read once if everything fits into a quarter of the memory.
        is_small = memory == 0 or 32 * self._width * self._size < memory
        sources = [run.source(chunk) for chunk in chunks] if is_small else []

        def source(i: int) -> distributed.Future:
            return sources[i] if sources else run.source(chunks[i])

        splits = _Splits([])
        if partitions > 1:
            share = min(1.0, _SAMPLE_PER_PARTITION * partitions / self._size)
            samples = run.client.gather(
                [run.submit(_sample, source(i), chunk.first, share)
                 for i, chunk in enumerate(chunks)])
            sample, stands_for = map(np.concatenate, zip(*samples))
            splits = _split_sample(sample, stands_for, partitions, balance == "pairs")
        routed = [run.submit(_distribute, source(i), chunk.first, splits)
                  for i, chunk in enumerate(chunks)]
        sources.clear()
        self._partitions = [
            run.submit(_build, [run.submit(_piece, one, p) for one in routed], mapped)
            for p in range(partitions)]
        del routed
        about = run.client.gather([run.submit(_about, one) for one in self._partitions])
        self._bounds = np.array([bounds for bounds, _, _ in about],
                                np.float32).reshape(-1, self._width)
        self._sizes = np.array([size for _, size, _ in about], np.int64)
        self._bytes = sum(size for _, _, size in about)
        self._top = hs.BVH(self._bounds)
        # A task that makes it, and not a copy that a lost worker takes along.
        self._top_task = run.submit(hs.BVH, self._bounds)

    def __len__(self) -> int:
        return self._size

    def __repr__(self) -> str:
        return (f"<halfspace.dask.BVH: {self._size} boxes in {self._width // 2} "
                f"dimensions, {len(self._partitions)} partitions>")

    @property
    def nbytes(self) -> int:
        """Bytes of all trees, in memory or mapped."""
        return self._bytes

    @property
    def bounds(self) -> np.ndarray:
        """The bounds of each partition: (partitions, 6) or (partitions, 4)."""
        return self._bounds.copy()

    @property
    def sizes(self) -> np.ndarray:
        """The number of objects of each partition."""
        return self._sizes.copy()

    def query(self, boxes, *, max_results: int = MAX_RESULTS, to=None):
        """Finds all pairs of a given box and an object that overlap.

        Returns an iterator of (rows, ids), two int64 arrays with at most `max_results`
        pairs, or with all of one row. Batches come as workers finish them.

        With `to`, the workers write the batches to that directory, as .npy files of the
        shape (2, pairs), and the call returns the paths. All workers must share the
        directory. It is created if it does not exist, and files in it stay. A worker's
        memory then has one batch for each of its threads.
        """
        chunks, _ = _chunks(boxes, "boxes", (self._width,))
        routed = self._run.ahead(chunks, lambda chunk: self._run.submit(
            _route, self._run.source(chunk), chunk.first, self._top_task))
        joins = ((_pairs_in, self._partitions[p], self._run.submit(_piece, one, p))
                 for one in routed
                 for p in self._run.submit(_targets, one).result())
        return self._run.pairs(joins, max_results, to)

    def pairs(self, *, max_results: int = MAX_RESULTS, to=None):
        """Finds each pair of overlapping objects once, as (i, j) with i < j.

        Returns what query() does. Pairs of partitions are joined once, by the objects
        of one that overlap the bounds of the other.
        """
        own = ((_own_pairs_in, partition, None) for partition in self._partitions)
        numbers = zip(*self._top.pairs())
        border = ((_border_pairs_in, self._partitions[p], self._border(q, self._bounds[p]))
                  for p, q in numbers)
        return self._run.pairs(itertools.chain(own, border), max_results, to)

    def nearest(self, points, k: int = 1, max_distance: float = math.inf):
        """Finds the k objects that are nearest to each point, as `halfspace.BVH`.

        points  (n, 3) or (n, 2), as `boxes`

        Returns an iterator of (rows, ids, distances), one for each chunk of points: the
        rows of the points, and ids and distances of the shape (rows, k), nearest first
        and then by id. Where fewer than k objects are within `max_distance`, ids are -1
        and distances infinite. Of objects at the same distance as the k-th, any can be
        the k-th.

        The nearest partition with k objects gives each point a radius. Then all other
        partitions within it are searched.
        """
        k = _arrays.positive(k, "k")
        max_distance = _arrays.not_negative(max_distance, "max_distance")
        chunks, _ = _chunks(points, "points", (self._width // 2,))
        return self._run.stream((future, None)
                                for future in self._nearest(chunks, k, max_distance))

    def _border(self, partition: int, bounds: np.ndarray) -> distributed.Future:
        return self._run.submit(_border, self._partitions[partition], bounds)

    def _nearest(self, chunks, k: int, max_distance: float):
        run = self._run
        numbers = np.flatnonzero(self._sizes >= k)
        if len(numbers) == 0:
            numbers = np.flatnonzero(self._sizes > 0)
        homes = run.submit(hs.BVH, self._bounds[numbers])

        def search(routed):
            return [run.submit(_nearest_in, self._partitions[p], run.submit(_piece, routed, p),
                               k, max_distance)
                    for p in run.submit(_targets, routed).result()]

        def send_home(chunk):
            return chunk, run.submit(_send_home, run.source(chunk), chunk.first, homes,
                                     numbers)

        def send_on(chunk, home):
            found = search(home)
            return chunk, found, run.submit(_send_on, run.source(chunk), chunk.first, home,
                                            found, self._top_task, max_distance)

        if len(numbers) == 0:
            nothing = [(np.empty(0, np.int64), np.empty((0, k), np.int64),
                        np.empty((0, k), np.float32))]
            for chunk in chunks:
                yield run.submit(_merge, chunk.first, chunk.rows, k, nothing)
            return
        sent_home = run.ahead(chunks, send_home)
        sent_on = run.ahead(sent_home, lambda sent: send_on(*sent))
        for chunk, found, on in sent_on:
            yield run.submit(_merge, chunk.first, chunk.rows, k, found + search(on))


def join(a: BVH, b: BVH, *, max_results: int = MAX_RESULTS, to=None):
    """Finds the pairs of an object of `a` and an object of `b` that overlap.

    Returns what BVH.query() does, as (i, j): rows of `a` and of `b`. To join boxes that
    are in no BVH with a BVH, query it with them.
    """
    if a._width != b._width:
        raise ValueError(f"a and b must have the same dimensions; they have "
                         f"{a._width // 2} and {b._width // 2}")
    joins = ((_join_in, a._partitions[p], b._border(q, a._bounds[p]))
             for p, q in zip(*hs.join(a._top, b._top)))
    return a._run.pairs(joins, max_results, to)


def scan(boxes, queries, *, quantized: bool = False,
         client: distributed.Client | None = None):
    """Tests every box against every query, without a BVH: for few queries of boxes that
    are read once.

    boxes    as for BVH
    queries  (n, 6) or (n, 4): an array

    Returns an iterator of (rows, ids), two int64 arrays: rows of `queries` and of
    `boxes`. There is one for each chunk of boxes.
    """
    run = _Runner(client)
    chunks, width = _chunks(boxes, "boxes", (4, 6))
    queries = _arrays.numbers(queries, "queries")
    _chunks(queries, "queries", (width,))
    hs.BVH(queries)  # an error of a query is none of a chunk
    return run.stream((run.submit(_scan, run.source(chunk), chunk.first, queries,
                                  quantized), None) for chunk in chunks)


def _scan(boxes, first: int, queries, quantized: bool):
    boxes = _rows(boxes, "boxes", first)
    scan = _in_chunk(first, lambda: hs.Scan(boxes, quantized=quantized))
    rows, ids = scan.query(queries)
    return rows, ids + first
