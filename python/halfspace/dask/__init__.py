"""Joins, box queries and k nearest on Dask, over more boxes than one machine holds.

    import halfspace.dask as hd

    tree = hd.BVH(boxes)                         # a lazy Dask collection
    tree = tree.persist()                        # builds it
    pairs = tree.query(probes)                   # a dask DataFrame: "id" by "row"
    near = tree.nearest(points, k=8)             # "id" and "distance" by "row"
    own = tree.pairs()                           # "i" and "j"
    cities = hd.sjoin(cities, countries, predicate="within")    # frames of geometries

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

# Each file imports only those after it: _run (tasks in graphs, or submitted), _tasks (what
# they do), _partitions (of space, and which rows go to them), _source (rows in chunks).

from __future__ import annotations

import itertools
import math
import operator

import dask
import dask.blockwise
import dask.core
import dask.graph_manipulation
import dask.threaded
import numpy as np
from dask.delayed import Delayed
from dask.highlevelgraph import HighLevelGraph

import halfspace as hs
from halfspace import _arrays
from halfspace._bvh import _extents
from halfspace.dask import _tasks
from halfspace.dask._frames import sjoin
from halfspace.dask._partitions import Top
from halfspace.dask._run import Placed, Runner, Tasks, cluster
from halfspace.dask._source import Lazy, Source, again, delayed, source_of, unique

__all__ = ["BVH", "join", "join_batches", "scan", "scan_batches", "sjoin"]

MAX_RESULTS = 10_000_000

# Boxes in the sample for each partition: the number of objects of a partition is then
# right within about a twentieth.
_SAMPLE_PER_PARTITION = 400
# A tree of boxes in 3 dimensions, and the row of each object.
_BYTES_PER_OBJECT = 56


class BVH(Lazy, dask.base.DaskMethodsMixin):
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

    query_extents  those of a typical query, as of `halfspace.BVH`

    `persist()` builds it on the cluster, and returns a tree that refers to the built
    partitions. Without it, each computation builds them again. `compute()` returns one
    `halfspace.BVH` of all boxes, which `dask.delayed` functions also receive. A task can
    receive the tree itself: `client.submit(function, tree)`.

    A build reads `boxes` twice, or once if they fit into a quarter of the workers' memory.
    """

    def __init__(self, boxes, partitions: int | None = None, *, balance: str = "pairs",
                 mapped: bool | None = None, query_extents=None):
        if balance not in ("pairs", "objects"):
            raise ValueError(f"balance must be 'pairs' or 'objects', not {balance!r}")
        if mapped not in (True, False, None):
            raise ValueError(f"mapped must be True, False or None, not {mapped!r}")
        threads, memory = cluster()
        count = _arrays.positive(2 * threads if partitions is None else partitions,
                                 "partitions")
        source = source_of(boxes, "boxes", (4, 6))
        self._width = source.width
        if query_extents is not None:
            dims = len(query_extents) if source.width is None else source.width // 2
            query_extents = _extents(query_extents, dims).tolist()
        self._size = None if source.sizes is None else sum(source.sizes)
        is_small = memory == 0
        if self._size is not None:
            count = max(1, min(count, self._size))
            is_small |= 32 * 6 * self._size < memory
            if mapped is None:
                mapped = 0 < memory < 2 * _BYTES_PER_OBJECT * self._size
        samples = source if is_small else source_of(again(boxes), "boxes", (4, 6))
        self._partitions = count

        tasks = Tasks("bvh")
        most = -(-_SAMPLE_PER_PARTITION * count // len(source.keys))
        plan = tasks.add(_tasks.plan_of, tasks.each_chunk(samples, _tasks.sample, most), count,
                         balance == "pairs", query_extents)
        sent = tasks.each_chunk(source, _tasks.distribute, plan)
        for p, pieces in enumerate(zip(*tasks.send(sent, count))):
            tasks[tasks.name, p] = (_tasks.build, list(pieces), bool(mapped), query_extents)
        tasks[tasks.name, count] = (
            Top.of, [tasks.add(_tasks.about, (tasks.name, p)) for p in range(count)])
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
        return _tasks.whole, ()

    def __dask_postpersist__(self):
        return self._persisted, ()

    def _persisted(self, tasks, *, rename=None) -> BVH:
        tree = BVH.__new__(BVH)
        tree.__dict__.update(self.__getstate__())
        name = (rename or {}).get(self._name, self._name)
        if isinstance(tasks, HighLevelGraph):
            tree._name, tree._graph = name, tasks
        else:
            Lazy.__init__(tree, name, dict(tasks))
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
        return delayed(Lazy(unique("top"), graph), self._keys.top)

    @property
    def _keys(self) -> Placed:
        *partitions, top = self.__dask_keys__()
        return Placed(partitions, top)

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
        tasks = Tasks("query")
        routed = tasks.each_chunk(source, _tasks.route, self._keys.top)
        found = tasks.search(zip(routed), self._keys, _tasks.pairs_in)
        return self._frame_by_row(tasks, source, found, _tasks.frame_of_query, {"id": np.int64})

    def pairs(self):
        """Finds each pair of overlapping objects once, as "i" and "j" with i < j.

        Returns a dask DataFrame with a partition for each partition of the tree, in no
        order. Pairs of partitions are joined once, by the objects of one that overlap the
        bounds of the other.
        """
        return _join(self, self, _tasks.frame_of_pairs)

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
        k = _arrays.neighbours(k)
        max_distance = _arrays.not_negative(max_distance, "max_distance")
        source = self._probes(points, "points", 1, 2)
        tasks = Tasks("nearest")
        found = tasks.nearest(source, self._keys, k, max_distance)
        return self._frame_by_row(tasks, source, found, _tasks.frame_of_nearest,
                                  {"id": np.int64, "distance": np.float32}, k)

    def _probes(self, source, name: str, *of_width) -> Source:
        dims = (self._width // 2,) if self._width else (2, 3)
        return source_of(source, name, tuple(n * d for n in of_width for d in dims))

    def _frame_by_row(self, tasks: Tasks, source: Source, items: list, frame_of,
                      columns: dict, *arguments):
        """The frame of one search of each chunk, or of two."""
        lengths = [(len, its[0]) for its in items]
        found: list = [sum(its[1::2], []) for its in items]
        frames = tasks.frames_of_chunks(source, lengths, frame_of, found, *arguments)
        return tasks.frame([self, *source.collections], frames, columns, True,
                           source.divisions)

    # At once, on a cluster.

    def _place(self, run: Runner) -> Placed:
        """The partitions as futures. Builds them in the first call, if persist() did not,
        and after they were cancelled."""
        placed = self.__dict__.get("_on_cluster")
        if placed is None or placed.client is not run.client or placed.is_lost():
            # Under other names than those of futures that were cancelled.
            tree = self if placed is None else dask.graph_manipulation.clone(self)
            built = run.client.persist(tree)
            graph = dict(built.__dask_graph__())
            *partitions, top = (graph[key] for key in built.__dask_keys__())
            placed = self._on_cluster = Placed(partitions, top, run.client, top.result())
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
        run, source = Runner(), self._probes(boxes, "boxes", 2)
        placed = self._place(run)
        routed = run.each_chunk(source, _tasks.route, placed.top)
        return run.pairs(run.joins(_tasks.pairs_in, routed, placed), max_results, to)

    def pairs_batches(self, *, max_results: int = MAX_RESULTS, to=None):
        """Finds each pair of overlapping objects once, as (i, j) with i < j.

        Returns what query_batches() does.
        """
        run = Runner()
        placed = self._place(run)
        own = ((_tasks.own_pairs_in, partition, None) for partition in placed.partitions)
        border = run.joins(_tasks.border_pairs_in, run.borders(placed, placed, True), placed, False)
        return run.pairs(itertools.chain(own, border), max_results, to)

    def nearest_batches(self, points, k: int = 1, max_distance: float = math.inf):
        """Finds the k objects that are nearest to each point or box, as `nearest`.

        Returns an iterator of (rows, ids, distances), one for each chunk of points: the
        rows of the points, and ids and distances of the shape (rows, k), with k as in
        `halfspace.BVH`. Where fewer than k objects are within `max_distance`, ids are -1
        and distances infinite.
        """
        k = _arrays.neighbours(k)
        max_distance = _arrays.not_negative(max_distance, "max_distance")
        run, source = Runner(), self._probes(points, "points", 1, 2)
        placed = self._place(run)
        found = run.nearest(source, placed, k, max_distance)
        merged = run.each(
            found, lambda its: run.add(_tasks.merge, its[0], placed.top, k, its[1] + its[3]))
        return ((first + np.arange(len(ids)), ids, distances)
                for first, ids, distances in run.by_row(zip(merged)))


def _join(a: BVH, b: BVH, frame_of):
    """The frames of the partitions of `a`, and what those of `b` send to them."""
    tasks, its, others = Tasks("join"), a._keys, b._keys
    are_own = frame_of is _tasks.frame_of_pairs
    borders = tasks.borders(others, its, are_own)
    # Of two trees, all objects can be at the border.
    pieces = (tasks.exchange(borders, a.npartitions) if are_own
              else zip(*tasks.send(borders, a.npartitions)))
    frames = [tasks.add(frame_of, partition, list(some))
              for partition, some in zip(its.partitions, pieces)]
    return tasks.frame([a, b], frames, {"i": np.int64, "j": np.int64})


def _check_trees(a: BVH, b: BVH) -> None:
    for name, tree in (("a", a), ("b", b)):
        if not isinstance(tree, BVH):
            raise TypeError(f"{name}: expected a halfspace.dask.BVH, got {type(tree).__name__}")
    if a._width and b._width:
        _tasks.check_widths(a._width, b._width)


def join(a: BVH, b: BVH):
    """Finds the pairs of an object of `a` and an object of `b` that overlap.

    Returns a dask DataFrame with the columns "i" and "j", rows of `a` and of `b`, and a
    partition for each of `a`. To join boxes that are in no BVH with a BVH, query it with
    them.
    """
    _check_trees(a, b)
    return _join(a, b, _tasks.frame_of_join)


def join_batches(a: BVH, b: BVH, *, max_results: int = MAX_RESULTS, to=None):
    """Finds the pairs of `join` at once, and returns what BVH.query_batches() does."""
    _check_trees(a, b)
    run = Runner()
    its, other = a._place(run), b._place(run)
    _tasks.check_widths(its.known.bounds.shape[1], other.known.bounds.shape[1])
    joins = run.joins(_tasks.join_in, run.borders(other, its, False), its, False)
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
    tasks = Tasks("scan")
    its_queries = f"{tasks.name}-queries"
    tasks[its_queries] = queries
    found = tasks.each_chunk(source, _tasks.scan, its_queries, quantized)
    lengths = [(operator.getitem, key, 2) for key in found]
    frames = tasks.frames_of_chunks(source, lengths, _tasks.frame_of_scan, found)
    return tasks.frame(source.collections, frames, {"row": np.int64, "id": np.int64})


def scan_batches(boxes, queries, *, quantized: bool = False):
    """Finds what `scan` does at once, and returns an iterator of (rows, ids): two int64
    arrays for each chunk of boxes."""
    run = Runner()
    source, queries = _source_of_scan(boxes, queries)
    found = run.by_row(zip(run.each_chunk(source, _tasks.scan, queries, quantized)))
    return ((rows, ids + first) for first, rows, ids in found)


def _source_of_scan(boxes, queries):
    source = source_of(boxes, "boxes", (4, 6))
    queries = _arrays.numbers(queries, "queries")
    source_of(queries, "queries", (source.width,) if source.width else (4, 6))
    hs.BVH(queries)  # an error of a query is none of a chunk
    return source, queries
