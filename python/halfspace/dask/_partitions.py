"""Partitions: how a sample splits space into them, and how rows are sent to them."""

from __future__ import annotations

import dataclasses
import typing

import dask.sizeof
import numpy as np

import halfspace as hs
from halfspace.dask._source import BITS, of_collection


def split_rows(splits, centers: np.ndarray, rows: np.ndarray):
    """Returns the partitions, ascending, each with its rows. Splits are the number of a
    partition, or a tuple: rows whose center is below `value` on `axis` go to the splits
    `low`, and the others to `high`."""
    if not isinstance(splits, tuple):
        return [(splits, rows)]
    axis, value, low, high = splits
    is_low = centers[axis].take(rows) < value
    return (split_rows(low, centers, rows.compress(is_low)) +
            split_rows(high, centers, rows.compress(~is_low)))


def centers_of(boxes: np.ndarray) -> np.ndarray:
    """Centers in double, an array for each axis. That of an infinite box may be a NaN,
    which has a partition, too."""
    low, high = np.split(boxes.T, 2)
    with np.errstate(invalid="ignore"):
        return (np.multiply(low, 0.5, dtype=np.float64, order="C") +
                np.multiply(high, 0.5, dtype=np.float64, order="C"))


def split_sample(boxes, stands_for, partitions: int, by_pairs: bool, query_extents=None):
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
    centers = centers_of(boxes)
    some = np.isfinite(centers).all(axis=0)
    points = centers[:, some].T
    units = _units(points, boxes[some], query_extents)
    return _split_at_medians(points, weights[some], 0, partitions, units)


def _units(points, boxes, query_extents) -> np.ndarray:
    """What the width of a partition on each axis is divided by: the extent of a typical
    query and box, as `halfspace.BVH` has them."""
    low, high = np.split(boxes.astype(np.float64), 2, axis=1)
    if not len(points):
        return np.ones(low.shape[1])
    extents = np.median(high - low, axis=0)
    width = np.ptp(np.percentile(points, (5, 95), axis=0), axis=0)
    if query_extents is not None:
        units = extents + np.asarray(query_extents, np.float64)
    else:
        some = (extents > 0) & (width > 0)
        share = (extents[some] / np.sqrt(width[some])).min() if some.any() else 1
        units = extents + share * np.sqrt(width)
    units = np.maximum(units, width * 2.0**-20)
    return np.where(units > 0, units, 1)


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


def _split_at_medians(points, weights, first: int, count: int, units):
    """Splits points into the partitions from `first` on, of about equal weight, at the
    weighted median of the axis that is widest in its unit. Its width is that between the
    5th and the 95th percentile: a few objects far away choose no axis."""
    if count == 1:
        return first
    axis, value = 0, 0.0
    if len(points):
        low, high = np.percentile(points, (5, 95), axis=0)
        axis = int(np.argmax((high - low) / units))
        order = np.argsort(points[:, axis], kind="stable")
        points, weights = points[order], weights[order]
        sums = np.cumsum(weights)
        middle = np.searchsorted(sums, sums[-1] * (count // 2) / count)
        value = float(points[min(middle + 1, len(points) - 1), axis])
    is_low = points[:, axis] < value
    half = count // 2
    return (axis, value, _split_at_medians(points[is_low], weights[is_low], first, half, units),
            _split_at_medians(points[~is_low], weights[~is_low], first + half, count - half,
                              units))


@dataclasses.dataclass(frozen=True)
class Partition:
    tree: hs.BVH
    rows: np.ndarray  # of the objects, by id of the tree
    mapped: bool = False

    def __sizeof__(self):
        # Dask writes what fills the memory to disk. A mapped tree is there already.
        return self.rows.nbytes + (0 if self.mapped else self.tree.nbytes)

    def __reduce__(self):
        # A copy of a mapped tree is in memory.
        return Partition, (self.tree, self.rows)


@dataclasses.dataclass(frozen=True)
class Top:
    """What tasks know of all partitions."""

    bounds: np.ndarray
    sizes: np.ndarray  # numbers of objects
    nbytes: int
    tree: hs.BVH  # of the bounds

    @staticmethod
    def of(partitions: list) -> Top:
        bounds = np.array([bounds for bounds, _, _ in partitions])
        sizes = np.array([size for _, size, _ in partitions], np.int64)
        return Top(bounds, sizes, sum(size for _, _, size in partitions), hs.BVH(bounds))


@dask.sizeof.sizeof.register(hs.BVH)
def _size_of_tree(tree: hs.BVH) -> int:
    return tree.nbytes


# Sending rows.


@dataclasses.dataclass(frozen=True)
class Routed:
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
    def to(partitions, rows, data, first) -> Routed:
        # NumPy sorts numbers of 16 bits five times as fast as of 64.
        small = partitions.astype(np.min_scalar_type(partitions.max(initial=0)))
        order = np.argsort(small, kind="stable")
        counts = np.bincount(partitions)
        numbers = np.flatnonzero(counts)
        begins = np.append(0, np.cumsum(counts[numbers]))
        return Routed(data, first, rows[order], numbers, begins)


def rows_to(routed: Routed, begin: int, end: int):
    """What goes to the partitions from `begin` to `end`: the data of the rows, their
    numbers and their partitions."""
    i, j = np.searchsorted(routed.partitions, (begin, end))
    rows = routed.rows[routed.begins[i]:routed.begins[j]]
    sizes = np.diff(routed.begins[i:j + 1])
    numbers = rows + routed.first if np.ndim(routed.first) == 0 else routed.first[rows]
    return routed.data[rows], numbers, np.repeat(routed.partitions[i:j], sizes)


def about_routed(routed: Routed):
    return routed.partitions, len(routed)


def piece_of(routed: Routed, partition: int, first: int | None = None):
    """The rows that go to one partition: what is sent to its worker. If they are of a chunk
    that begins at row `first` of the collection, their numbers become rows of that."""
    data, numbers, _ = rows_to(routed, partition, partition + 1)
    return data, numbers if first is None else of_collection(numbers, first)


def block_of(parts: list) -> Routed:
    """What several chunks send to some partitions."""
    data, numbers, partitions = concatenate(parts)
    return Routed.to(partitions, np.arange(len(data)), data, numbers)


def gather(parts: list) -> Routed:
    """What several chunks send to all partitions."""
    return block_of([rows_to(routed, 0, int(routed.partitions.max(initial=0)) + 1) for routed in parts])


def concatenate(found: list) -> tuple:
    return tuple(map(np.concatenate, zip(*found)))


def found_of_chunk(found: tuple, chunk: int) -> tuple:
    """What was found of one chunk, of what was found of a block."""
    some = found[0] >> BITS == chunk
    return tuple(column[some] for column in found)
