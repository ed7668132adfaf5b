"""The source: what calls take, as rows in chunks of lazy graphs."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import itertools
import os
import typing
import uuid

import dask
import dask.array
import dask.core
import dask.graph_manipulation
import numpy as np
from dask.delayed import Delayed
from dask.highlevelgraph import HighLevelGraph

from halfspace import _arrays

# Rows of one task, where the source has no chunks of its own.
_CHUNK_ROWS = 1_000_000
# A row of a chunk, until it is known where the chunk begins: (chunk << BITS) + row.
BITS = 32


def unique(what: str) -> str:
    # Not of the arguments: a file that changed between two calls must be read again.
    return f"halfspace-{what}-{uuid.uuid4().hex}"


class Lazy:
    """A graph, whose last layer has the name."""

    def __init__(self, name: str, tasks: dict, dependencies=()):
        self._name = name
        self._graph = HighLevelGraph.from_collections(name, tasks, dependencies)

    def __dask_graph__(self):
        return self._graph

    def __dask_layers__(self):
        return (self._name,)


def delayed(lazy, key) -> Delayed:
    return Delayed(key, lazy.__dask_graph__(), layer=lazy.__dask_layers__()[0])


@dataclasses.dataclass(frozen=True)
class Source:
    """The chunks `keys` of the graphs of `collections`. `sizes` are their numbers of
    rows, and `width` is that of a row: None if it is unknown."""

    collections: list
    keys: list
    sizes: typing.Any  # a list
    width: int | None

    @functools.cached_property
    def firsts(self) -> list:
        return sum_up(self.sizes)

    @property
    def divisions(self):
        """The rows at which the chunks begin, and the last one, if they are known."""
        if not self.sizes or 0 in self.sizes:
            return None
        return (*self.firsts[:-1], self.firsts[-1] - 1)

    def where(self, chunk: int) -> str:
        """What an error says of a chunk."""
        if self.sizes is None:
            return f"in chunk {chunk}"
        return f"in the chunk that begins at row {self.firsts[chunk]}"


def sum_up(lengths: typing.Iterable) -> list:
    return list(itertools.accumulate(lengths, initial=0))


def of_collection(rows, first: int):
    """Rows (chunk << BITS) + row of a chunk that begins at row `first` of the collection,
    as rows of the collection."""
    return (rows & (1 << BITS) - 1) + first


def source_of(source, name: str, widths: tuple[int, ...]) -> Source:
    """Returns the chunks of a collection."""
    if isinstance(source, Lazy):
        raise TypeError(f"{name}: expected boxes, got a halfspace.dask.BVH")
    if _are_all(source, Delayed):
        return Source(list(source), [part.key for part in source], None, None)
    sizes: list = []
    if dask.is_dask_collection(source):  # an array, a frame, or a delayed array
        width = None
        if isinstance(source, dask.array.Array):
            width = _width(source.shape, widths, name, "the dask array")
            source = source.rechunk({1: -1})
            sizes = [] if np.isnan(source.chunks[0]).any() else list(source.chunks[0])
        keys = list(dask.core.flatten(source.__dask_keys__()))
        return Source([source], keys, sizes or None, width)
    if isinstance(source, (str, os.PathLike)):
        source = [source]
    tasks: list = []
    if _are_all(source, (str, os.PathLike)):
        paths = [os.path.abspath(os.fsdecode(path)) for path in source]
        if any(path.endswith(".parquet") for path in paths):
            tasks = [(_read_parquet, path) for path in paths]
        else:
            for path in paths:
                shape = np.load(path, mmap_mode="r").shape
                widths = (_width(shape, widths, name, path),)
                for begin in range(0, max(1, shape[0]), _CHUNK_ROWS):
                    end = min(begin + _CHUNK_ROWS, shape[0])
                    sizes.append(end - begin)
                    tasks.append((_read, path, begin, end))
    else:
        with errors_of(name):
            source = _without_names(source)
        array = _arrays.numbers(source, name)
        widths = (_width(array.shape, widths, name, "the array"),)
        tasks = [array[begin:begin + _CHUNK_ROWS]
                 for begin in range(0, max(1, len(array)), _CHUNK_ROWS)]
        sizes = list(map(len, tasks))
    lazy = unique("source")
    keys = [(lazy, chunk) for chunk in range(len(tasks))]
    return Source([Lazy(lazy, dict(zip(keys, tasks)))], keys, sizes or None,
                  widths[0] if sizes else None)


def again(source):
    """The same collection, which Dask computes by itself."""
    if _are_all(source, Delayed):
        return [dask.graph_manipulation.clone(part) for part in source]
    return dask.graph_manipulation.clone(source) if dask.is_dask_collection(source) else source


def _are_all(values, kind) -> bool:
    return isinstance(values, (list, tuple)) and len(values) > 0 and all(
        isinstance(value, kind) for value in values)


def _width(shape, widths, name: str, what: str) -> int:
    if len(shape) != 2 or shape[1] not in widths:
        expected = " or ".join(f"(n, {width})" for width in widths)
        raise ValueError(f"{name} must have the shape {expected}, and {what} has "
                         f"{tuple(shape)}")
    return shape[1]


# In tasks.


@contextlib.contextmanager
def errors_of(where: str):
    """Errors say where they happened."""
    try:
        yield
    except (ValueError, TypeError) as error:
        raise type(error)(f"{where}: {error}") from None


def of_chunk(name: str):
    """A decorator: function(rows, ...) becomes a task of (chunk, where, ...), whose errors say
    where. The rows are a plain array of two dimensions, which errors call `name`."""
    widths = (4, 6) if name == "boxes" else (2, 3, 4, 6)

    def decorate(function):
        @functools.wraps(function)
        def task(chunk, where: str, *arguments):
            with errors_of(where):
                rows = _arrays.numbers(_without_names(chunk), name)
                _width(rows.shape, widths, name, "the chunk")
                return function(rows, *arguments)
        return task
    return decorate


def _read(path: str, begin: int, end: int) -> np.ndarray:
    return np.array(np.load(path, mmap_mode="r")[begin:end])


def _read_parquet(path: str):
    import pandas  # type: ignore

    return pandas.read_parquet(path)


_BOUNDS = [names.split() for names in (
    "minx miny minz maxx maxy maxz", "xmin ymin zmin xmax ymax zmax",
    "minx miny maxx maxy", "xmin ymin xmax ymax")]


def _without_names(chunk):
    """The boxes of a frame. Any other chunk as it is."""
    if hasattr(chunk, "geom_type"):  # of geometries
        return empty_if_null(chunk.bounds.to_numpy())
    if not hasattr(chunk, "columns"):
        return chunk
    if "bbox" in chunk.columns:
        is_there = chunk["bbox"].notna().to_numpy()
        boxes = list(chunk["bbox"][is_there])
        names = _BOUNDS[1 if boxes and "zmin" in boxes[0] and "zmax" in boxes[0] else 3]
        result = np.full((len(chunk), len(names)), np.nan)
        if boxes:
            result[is_there] = [[box[name] for name in names] for box in boxes]
        return empty_if_null(result)
    for names in _BOUNDS:
        if set(names) <= set(chunk.columns):
            return _numbers(chunk[names])
    if hasattr(type(chunk), "geom_type"):
        raise ValueError("a GeoDataFrame has no active geometry: call set_geometry() first")
    return _numbers(chunk)


def empty_if_null(boxes: np.ndarray) -> np.ndarray:
    dims = boxes.shape[1] // 2
    boxes[np.isnan(boxes).any(axis=1)] = [np.inf] * dims + [-np.inf] * dims
    return boxes


def _numbers(frame) -> np.ndarray:
    array = frame.to_numpy()
    # pandas returns objects for columns that can have missing values.
    if array.dtype.kind == "O" and all(kind.kind in "iuf" for kind in frame.dtypes):
        array = frame.to_numpy(np.float64)
    return array
