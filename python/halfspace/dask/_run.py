"""Running tasks: lazily, as layers of graphs, or at once, on a cluster."""

from __future__ import annotations

import collections
import contextlib
import dataclasses
import glob
import itertools
import math
import operator
import os
import typing
import uuid

import dask.system
import distributed
import numpy as np

from halfspace import _arrays
from halfspace.dask._partitions import (about_routed, block_of, concatenate, found_of_chunk,
                                        gather, piece_of, rows_to)
from halfspace.dask._source import BITS, Lazy, Source, delayed, sum_up, unique
from halfspace.dask._tasks import (nearest_in, pandas_frame, route_border, send_home, send_on,
                                   some_pairs, write_pairs)

# With more partitions, rows go to them in two stages.
ONE_STAGE = 16


def group_size(partitions: int) -> int:
    """The number of partitions in a group, and of chunks in a block, of two stages."""
    return math.isqrt(partitions - 1) + 1


def cluster() -> tuple[int, int]:
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


@dataclasses.dataclass
class Placed:
    """The partitions, and what tasks know of all of them: keys, or futures of a client."""

    partitions: list
    top: typing.Any
    client: distributed.Client | None = None
    known: typing.Any = None  # the result of `top`

    def is_lost(self) -> bool:
        return any(future.status in ("cancelled", "lost", "error")
                   for future in (*self.partitions, self.top))


class _Steps:
    """The steps of searches. A subclass has add(function, *arguments), which makes a task,
    and each(items, start), which returns start(item) of each item."""

    def each_chunk(self, source, function, *arguments):
        """Makes a task for each chunk: function(chunk, where, chunk << BITS, ...)."""
        return self.each(range(len(source.keys)), lambda chunk: self.add(
            function, self.rows_of(source, chunk), source.where(chunk), chunk << BITS,
            *arguments))

    def borders(self, of, to, are_own):
        """Makes a task for each partition of a tree. It sends objects to the partitions of
        another tree, or for pairs of one tree to the partitions after it."""
        return self.each(enumerate(of.partitions), lambda its: self.add(
            route_border, its[1], to.top, its[0] if are_own else -1))

    def nearest(self, source, placed, k, max_distance):
        """Returns for each chunk what was sent to its nearest partitions, what these found,
        what was sent on, and what the other partitions found."""
        homes = zip(self.each_chunk(source, send_home, placed.top, k))
        found = self.search(homes, placed, nearest_in, k, max_distance)
        sent_on = self.each(found, lambda its: (
            *its, self.add(send_on, *its, placed.top, k, max_distance)))
        return self.search(sent_on, placed, nearest_in, k, max_distance)


class Tasks(_Steps, dict):
    """The lazy tasks of a layer by key."""

    def __init__(self, what: str):
        super().__init__()
        self.name = unique(what)

    def add(self, function, *arguments):
        """Adds a task, and returns its key."""
        key = f"{self.name}-{function.__name__}", len(self)
        self[key] = (function, *arguments)
        return key

    @staticmethod
    def each(items, start) -> list:
        return list(map(start, items))

    @staticmethod
    def rows_of(source: Source, chunk: int):
        return source.keys[chunk]

    def send(self, routed: list, partitions: int) -> list:
        """Adds tasks that send rows to partitions. Returns for each block of chunks the
        keys of its pieces, one for each partition. A block is one chunk, or with many
        partitions several: then a chunk has two tasks for each group of partitions, and
        a block has one for each partition."""
        blocks = [[key] * partitions for key in routed]
        if partitions > ONE_STAGE:
            step = group_size(partitions)
            blocks = []
            for first in range(0, len(routed), step):
                blocks.append([])
                for begin in range(0, partitions, step):
                    end = min(begin + step, partitions)
                    parts = [self.add(rows_to, key, begin, end)
                             for key in routed[first:first + step]]
                    blocks[-1] += [self.add(block_of, parts)] * (end - begin)
        return [[self.add(piece_of, key, p) for p, key in enumerate(keys)] for keys in blocks]

    def exchange(self, routed: list, partitions: int) -> list:
        """Adds tasks that send rows to partitions, as send(), in a few for each partition.
        For few rows: a task gathers all of a block. Returns the keys of the pieces of each
        partition."""
        if partitions <= ONE_STAGE:
            return list(zip(*self.send(routed, partitions)))
        step = group_size(partitions)
        blocks = [self.add(gather, routed[first:first + step])
                  for first in range(0, len(routed), step)]
        groups = [self.add(block_of, [self.add(rows_to, block, begin, begin + step)
                                      for block in blocks])
                  for begin in range(0, partitions, step)]
        return [[self.add(piece_of, groups[p // step], p)] for p in range(partitions)]

    def search(self, items, placed: Placed, search, *arguments) -> list:
        """Adds the tasks search(partition, piece, *arguments). The last element of an item
        is the key of what is routed. Returns the items with one more element: the keys of
        what is found. Results come back to their chunks as the rows were sent."""
        items, partitions = list(items), len(placed.partitions)
        found = [[self.add(search, partition, piece, *arguments)
                  for partition, piece in zip(placed.partitions, pieces)]
                 for pieces in self.send([its[-1] for its in items], partitions)]
        if partitions > ONE_STAGE:
            step, blocks = group_size(partitions), found
            found = []
            for keys in blocks:
                sums = [self.add(concatenate, keys[begin:begin + step])
                        for begin in range(0, partitions, step)]
                found += [[self.add(found_of_chunk, its_sum, chunk) for its_sum in sums]
                          for chunk in range(len(found), min(len(found) + step, len(items)))]
        return [(*its, keys) for its, keys in zip(items, found)]

    def frame(self, dependencies, keys, columns: dict, by_row=False, divisions=None):
        """A dask DataFrame of the frames of some tasks, whose index may be "row"."""
        import dask.dataframe

        lazy = Lazy(self.name, self, dependencies)
        meta = pandas_frame({column: np.empty(0, kind) for column, kind in columns.items()},
                            np.empty(0, np.int64) if by_row else None)
        return dask.dataframe.from_delayed([delayed(lazy, key) for key in keys], meta=meta,
                                           divisions=divisions, prefix=self.name,
                                           verify_meta=False)

    def frames_of_chunks(self, source: Source, lengths: list, frame_of, found, *arguments):
        """Adds tasks that make a frame of what was found of each chunk, with numbers of
        rows in the whole collection. `lengths` are tasks that return numbers of rows, to
        be added if these are not known."""
        if source.sizes is not None:
            firsts = source.firsts
        else:
            its = self.add(sum_up, [self.add(*length) for length in lengths])
            firsts = [(operator.getitem, its, chunk) for chunk in range(len(lengths))]
        return [self.add(frame_of, its_found, first, *arguments)
                for its_found, first in zip(found, firsts)]


class Runner(_Steps):
    """Submits tasks, and yields their results with a bound on how many wait."""

    def __init__(self):
        self.client = distributed.get_client()
        self.threads, _ = cluster()
        # A task that waits for others must not keep them from a thread.
        with contextlib.suppress(ValueError, AttributeError, KeyError):  # no task, or not again
            distributed.secede()

    def add(self, function, *arguments) -> distributed.Future:
        # Not pure: a file that changed between two calls must be read again.
        return self.client.submit(function, *arguments, pure=False)

    def rows_of(self, source: Source, chunk: int) -> distributed.Future:
        lazy = Lazy(unique("chunk"), {}, source.collections)
        return self.client.compute(delayed(lazy, source.keys[chunk]))

    def search(self, items, placed: Placed, search, *arguments):
        """The same with futures, for the partitions that get rows."""
        def start(its):
            *_, routed = its
            partitions, _ = self.add(about_routed, routed).result()
            return *its, [self.add(search, placed.partitions[p], self.add(piece_of, routed, p),
                                   *arguments) for p in partitions]

        return self.each(items, start)

    def joins(self, pairs_in, routed, placed: Placed, are_chunks: bool = True):
        """Yields the joins of pairs(), one for each partition that gets rows."""
        sent = self.each(routed, lambda one: (one, self.add(about_routed, one)))
        for first, one, partitions in self.by_row(sent):
            for p in partitions:
                yield pairs_in, placed.partitions[p], self.add(
                    piece_of, one, p, first if are_chunks else None)

    @staticmethod
    def by_row(items):
        """Yields for each chunk with rows the number of the first, its item, and its results.
        The last element of an item is a future, whose last result is the number of rows."""
        first = 0
        for *its, future in items:
            *found, length = future.result()
            if length > 0:
                yield first, *its, *found
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
            found = self.stream(some_pairs, joins, most, running)
            return (tuple(pairs) for pairs in found if pairs.size)
        to = os.path.abspath(to)
        os.makedirs(to, exist_ok=True)
        # A second call writes other files, and a task that runs twice the same.
        name = os.path.join(to, uuid.uuid4().hex)
        joins = ((*join, f"{name}-{n:09}") for n, join in enumerate(joins))
        try:
            return sorted(itertools.chain.from_iterable(
                self.stream(write_pairs, joins, most, running)))
        except Exception:
            distributed.wait(list(running))  # they write, too
            for path in glob.iglob(glob.escape(name) + "*"):
                os.unlink(path)
            raise
