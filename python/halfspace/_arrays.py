"""Reads boxes, points and ids from the objects that callers pass."""

from __future__ import annotations

import itertools
import math
import operator
import os
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import _arrow, _halfspace

# A BVH has fewer objects than this.
MOST_OBJECTS = 2**31
MOST_THREADS = 4096
ALL_MASKS = 2**32 - 1
MOST_SIZE = 2**64 - 1


class Table(NamedTuple):
    """Rows of numbers, as the compiled part reads them.

    `arrays` are two-dimensional arrays of one type (float32 or float64), one
    length and one stride, whose columns follow each other. `single` says that
    the caller passed one row and not a list of rows.
    """

    arrays: Tuple[np.ndarray, ...]
    length: int
    single: bool

    @property
    def columns(self) -> int:
        return sum(a.shape[1] for a in self.arrays)

    def rows(self, begin: int, end: int) -> "Table":
        arrays = tuple(a[begin:end] for a in self.arrays)
        return Table(arrays, arrays[0].shape[0], False)

    def minus(self, origin: np.ndarray) -> "Table":
        """The rows less one row of float64."""
        return self._replace(arrays=(np.concatenate(self.arrays, axis=1) - origin,))


def boxes(value: Any, name: str, dims: Optional[int] = None, most: Optional[int] = None,
          axes: Optional[int] = None) -> Table:
    """Boxes as 2 * d columns: the minima, then the maxima. With `axes`, also bounds as
    2 * axes columns."""
    arrays, single = _box_arrays(value, name)
    allowed = (6, 4) if dims is None else (2 * dims, 2 * (axes or dims))
    if arrays[0].ndim != 2 or sum(a.shape[1] for a in arrays) not in allowed:
        each = dict.fromkeys(allowed)
        shapes = " or ".join(f"(n, {columns}) or ({columns},)" for columns in each)
        halves = " or ".join(f"(n, {columns // 2})" for columns in each)
        where = "" if dims is None else f", for a tree of {dims} dimensions"
        got = [a.shape for a in arrays] if len(arrays) > 1 else [np.shape(value)]
        raise ValueError(
            f"{name}: expected boxes of shape {shapes}, or two arrays (minima, maxima) "
            f"of shape {halves}{where}, got shape {' and '.join(map(str, got))}"
        )
    table = _table(arrays, single, name, most)
    bad = _halfspace.first_bad_box(table.arrays, False)
    if bad >= 0:
        _raise_bad_box(table, name, bad)
    return table


def points(value: Any, name: str, dims: int, others: str = "") -> Table:
    """Points, or directions, as d columns. An error names `others`, too."""
    array = numbers(value, name)
    is_right = array.ndim in (1, 2) and array.shape[-1] == dims
    expected = f"points of shape (n, {dims}) or ({dims},){others}"
    _check_shape(is_right, array, name, expected)
    return _without_nan(array, name)


def directions(value: Any, name: str, dims: int) -> Table:
    """As points(). A double must not become 0 or infinite as a float: its ray would
    go elsewhere."""
    array = numbers(value, name)
    if array.dtype == np.float64 and array.ndim in (1, 2):
        with np.errstate(over="ignore"):
            rounded = array.astype(np.float32)
        bad = np.isfinite(array) & ((rounded == 0) & (array != 0) | np.isinf(rounded))
        if bad.any():
            row = np.argwhere(bad)[0].tolist()
            raise ValueError(
                f"{name}{row}: expected a number that float32 can hold, got "
                f"{array[tuple(row)]}: scale the direction and max_t"
            )
    return points(value, name, dims)


Arrays = Tuple[np.ndarray, ...]


def casts(starts: Table, name: str, ways: Any, max_t: Any,
          dims: int) -> Tuple[Arrays, Arrays, bool]:
    """The arrays of starts, those of directions and limits, and whether it is one
    cast. The record of a ray has all. Boxes are rounded outward later."""
    motions = directions(ways, "directions", dims)
    single = starts.single and motions.single
    count = motions.length if starts.single else starts.length
    starts, motions = _repeat(starts, count), _repeat(motions, count)
    if starts.length != motions.length:
        raise ValueError(
            f"directions: expected as many rows as {name}, got "
            f"{motions.length} and {starts.length}"
        )
    limits = per_row(max_t, "max_t", count)
    ways = floats((*motions.arrays, limits))
    if starts.columns == dims:
        return floats(starts.arrays + ways), ways, single
    is_box = starts.columns == 2 * dims
    return starts.arrays if is_box else floats(starts.arrays), ways, single


def floats(arrays: Arrays) -> Arrays:
    """The columns of all arrays as one array of the nearest float32."""
    array = np.concatenate(arrays, axis=1)
    if array.dtype != np.float32:
        with np.errstate(over="ignore"):
            array = array.astype(np.float32)
    return (array,)


def points_or_boxes(value: Any, name: str, dims: int) -> Table:
    if len(_parts_of(value)) != 2:
        value = numbers(value, name)
        if value.ndim not in (1, 2) or value.shape[-1] != 2 * dims:
            others = f", or boxes of shape (n, {2 * dims}) or ({2 * dims},)"
            return points(value, name, dims, others)
    return boxes(value, name, dims)


def per_row(value: Any, name: str, count: int) -> np.ndarray:
    """A column of one number for each row, or of the same for all, rounded up to
    float32."""
    array = numbers(value, name)
    is_right = array.shape in ((), (count,))
    _check_shape(is_right, array, name, f"one number or an array of shape ({count},)")
    exact: np.ndarray = array.astype(_float_type(array, name))
    if not (exact >= 0).all():
        raise ValueError(f"{name}: expected numbers that are not negative and not NaN")
    column: np.ndarray = np.empty((count, 1), np.float32)
    column[:, 0] = _rounded_up(exact)
    return column


def _rounded_up(exact: np.ndarray) -> np.ndarray:
    with np.errstate(over="ignore"):
        up = np.array(exact, np.float32)
        np.nextafter(up, np.float32(np.inf), out=up, where=up < exact)
    return up


def ids(value: Any, name: str, end: int = MOST_OBJECTS) -> np.ndarray:
    """Ids of objects below `end` as uint32."""
    array = _array(value, name)
    expected = "an integer or a one-dimensional array of integers"
    _check_shape(array.ndim <= 1, array, name, expected)
    return _unsigned(array, name, end, "the id of an object")


def masks(value: Any, name: str, count: int) -> np.ndarray:
    """A mask for each row, as uint32."""
    array = _array(value, name)
    is_right = array.shape in ((), (count,))
    _check_shape(is_right, array, name, f"one integer or an array of shape ({count},)")
    limit = "an integer from 0 to 2^32 - 1"
    return np.full(count, _unsigned(array, name, 2**32, limit))


def margin(value: Any, name: str = "margin") -> float:
    """A finite float32 that is not negative and not below a number."""
    distance = not_negative(value, name)
    if math.isinf(distance):
        raise ValueError(f"{name}: expected a finite float32, got {value}")
    return distance


def pair_distance(margin_of_call: Any, within: Any) -> Tuple[float, bool]:
    """The distance of pairs, and whether it is Euclidean."""
    if within is None:
        return margin(margin_of_call), False
    if margin(margin_of_call) > 0:
        raise ValueError("within: expected no margin next to it")
    return margin(within, "within"), True


def mask(value: Optional[int]) -> int:
    """32 bits. None means all."""
    return ALL_MASKS if value is None else _integer(value, "mask", 0, ALL_MASKS)


def spheres(centers: Any, radii: Any, dims: int) -> Table:
    """Spheres as d + 1 columns: floats that enclose those of doubles."""
    table = points(centers, "centers", dims)
    limits = per_row(radii, "radii", table.length)
    (exact,) = table.arrays
    if exact.dtype == np.float64:
        with np.errstate(over="ignore", invalid="ignore"):
            rounded = exact.astype(np.float32)
            # A cast is not limited on an axis where the float is infinite.
            ways = np.where(np.isinf(rounded), 0, exact - rounded)
            apart = np.linalg.norm(ways, axis=1, keepdims=True)
            limits = _rounded_up(limits + 1.000001 * apart)
        exact = rounded
    return table._replace(arrays=(np.concatenate([exact, limits], axis=1),))


def query_spheres(centers: Any, radii: Any, dims: int) -> Table:
    """Spheres as spheres(), or as rounded_boxes() if a center is so far away that
    its sphere would be a query of everything."""
    table = points(centers, "centers", dims)
    if (np.abs(table.arrays[0]) < 2.0**120).all():
        return spheres(centers, radii, dims)
    return rounded_boxes(table._replace(arrays=2 * table.arrays), radii, "radii")


def rounded_boxes(boxes: Table, within: Any, name: str = "within") -> Table:
    """Boxes and the distance from each as 2 * d + 1 columns: floats that enclose those
    of doubles."""
    limits = per_row(within, name, boxes.length)
    low, high = np.split(np.concatenate(boxes.arrays, axis=1), 2, axis=1)
    enclosing = (-_rounded_up(-low), _rounded_up(high), limits)
    return boxes._replace(arrays=(np.concatenate(enclosing, axis=1),))


def vertices(value: Any, name: str) -> np.ndarray:
    """A contiguous array of points without NaN, in 2 or 3 dimensions."""
    array = numbers(value, name)
    is_right = array.ndim == 2 and array.shape[1] in (2, 3)
    _check_shape(is_right, array, name, "points of shape (n, 3) or (n, 2)")
    table = _without_nan(np.require(array, _float_type(array, name), ["C", "A"]), name)
    return table.arrays[0]


def faces(value: Any, name: str, count: int) -> np.ndarray:
    """Triples of indices below `count`, as a contiguous array of uint32."""
    array = _array(value, name)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    _check_shape(array.shape[1:] == (3,), array, name, "shape (n, 3)")
    return _unsigned(array, name, count, f"indices from 0 to {count - 1}")


def _unsigned(array: np.ndarray, name: str, end: int, expected: str) -> np.ndarray:
    """A contiguous array of uint32. Its integers must be below `end`."""
    array = np.atleast_1d(array)
    if array.size == 0:
        return np.empty(array.shape, np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got {array.dtype}")
    bad = np.argwhere((array < 0) | (array >= end))
    if len(bad):
        i = int(bad[0, 0])
        raise ValueError(f"{name}[{i}]: expected {expected}, got {array[i].tolist()}")
    return np.require(array, np.uint32, ["C", "A"])


def _check_shape(is_right: bool, array: np.ndarray, name: str, expected: str) -> None:
    if not is_right:
        raise ValueError(f"{name}: expected {expected}, got shape {array.shape}")


def threads(value: Optional[int]) -> int:
    """The number of threads. None means all CPUs of this process."""
    if value is None:
        if hasattr(os, "sched_getaffinity"):
            return len(os.sched_getaffinity(0))
        return os.cpu_count() or 1
    return positive(value, "threads", MOST_THREADS)


How = Tuple[int, int, Any]


def how(mask_of_call: Optional[int], threads_of_call: Optional[int], progress: Any) -> How:
    """The last argument of a search."""
    return mask(mask_of_call), threads(threads_of_call), progress


def not_negative(value: Any, name: str) -> float:
    """A number from 0 to infinity, rounded up to float32."""
    _refuse_masked(value, name)
    try:
        number = float(value)
        if number < value:  # an integer, a fraction or a long double
            number = math.nextafter(number, math.inf)
    except TypeError:
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}") from None
    if not number >= 0:
        raise ValueError(f"{name}: expected a number that is not negative, got {number}")
    return float(_rounded_up(np.array(number)))


def positive(value: Any, name: str, most: int = 2**31 - 1, hint: str = "") -> int:
    """An integer from 1 to `most`. An error ends with the hint."""
    return _integer(value, name, 1, most, hint)


def neighbours(k: Any) -> int:
    return positive(k, "k", hint=": len(tree) or more finds all objects")


def budget(value: Optional[int]) -> int:
    """An integer from 0 to 2^64 - 1. None means no limit of the caller's."""
    return MOST_SIZE if value is None else _integer(value, "budget", 0, MOST_SIZE)


def _integer(value: Any, name: str, least: int, most: int, hint: str = "") -> int:
    if type(value) is int and least <= value <= most:
        return value  # without the 0.4 us of the checks below
    _refuse_masked(value, name)
    expected = f"{name}: expected an integer from {least} to {most}, got"
    try:
        number = operator.index(value)
    except TypeError:
        its = f" {value}" if isinstance(value, (float, np.floating)) else ""
        raise TypeError(f"{expected} {type(value).__name__}{its}{hint}") from None
    if not least <= number <= most:
        raise ValueError(f"{expected} {number}{hint}")
    return number


def _repeat(table: Table, count: int) -> Table:
    if not table.single or count == 1:
        return table
    arrays = tuple(np.repeat(a, count, axis=0) for a in table.arrays)
    return Table(arrays, count, False)


def _box_arrays(value: Any, name: str) -> Tuple[List[np.ndarray], bool]:
    """The arrays of boxes, and whether they are one box."""
    parts = _parts_of(value)
    if not parts:
        array = numbers(value, name)
        return [array.reshape(1, -1) if array.ndim == 1 else array], array.ndim == 1
    arrays = [_part(v, f"{name}[{i}]") for i, v in enumerate(parts)]
    shapes = [a.shape for a in arrays]
    if len(set(shapes)) != 1:
        raise ValueError(f"{name}: expected arrays of the same shape, got {shapes}")
    if len(parts) > 2 and len(arrays[0]) == len(parts):
        raise ValueError(
            f"{name}: a tuple of {len(parts)} arrays of length {len(parts)} can be "
            "rows or columns: pass a list of rows, or numpy.column_stack(columns)"
        )
    return arrays, False


def _parts_of(value: Any) -> Sequence[Any]:
    """The minima and maxima, if `value` is a pair of two-dimensional arrays, or the
    columns, if it is a tuple of 4 or 6 one-dimensional arrays."""
    if not isinstance(value, (tuple, list)) or len(value) not in (2, 4, 6):
        return ()
    if len(value) > 2 and all(hasattr(v, "__arrow_c_array__") for v in value):
        return value
    ndim = 2 if len(value) == 2 else 1
    is_right = isinstance(value, tuple) or ndim == 2
    return value if is_right and all(_ndim(v) == ndim for v in value) else ()


def _ndim(value: Any) -> Optional[int]:
    """The number of dimensions of an array, and None of a list or a number."""
    if hasattr(value, "ndim"):
        return int(value.ndim)
    if hasattr(value, "__array_interface__") or hasattr(value, "__array__"):
        return np.asarray(value).ndim
    return None


def _part(value: Any, name: str) -> np.ndarray:
    if hasattr(value, "__arrow_c_array__") and not hasattr(value, "__array_interface__"):
        array = _arrow.column(value, name)
    else:
        array = numbers(value, name)
    return array.reshape(-1, 1) if array.ndim == 1 else array


def _array(value: Any, name: str) -> np.ndarray:
    """Any array of the caller's becomes a plain array here, which has no mask."""
    _refuse_masked(value, name)
    try:
        array = np.asanyarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected an array of numbers: {error}") from None
    _refuse_masked(array, name)  # of an object that NumPy made a masked array of
    return np.asarray(array)


def _refuse_masked(value: Any, name: str) -> None:
    if _has_masked(value):
        raise TypeError(f"{name}: expected no masked values")


def _has_masked(value: Any) -> bool:
    if not isinstance(value, (list, tuple)):
        return isinstance(value, np.ma.MaskedArray) and bool(np.ma.is_masked(value))
    level: List[Any] = list(value)
    while level:  # the items of lists, then the items of these, and so on
        kinds = set(map(type, level))
        if any(issubclass(k, np.ma.MaskedArray) for k in kinds):
            if any(map(np.ma.is_masked, level)):
                return True
        if not any(issubclass(k, (list, tuple)) for k in kinds):
            return False
        lists = (v for v in level if isinstance(v, (list, tuple)))
        level = list(itertools.chain.from_iterable(lists))
    return False


def numbers(value: Any, name: str) -> np.ndarray:
    array = _array(value, name)
    if array.dtype.kind == "O":
        raise TypeError(
            f"{name}: expected an array of numbers, got {type(value).__name__} that "
            "NumPy reads as an array of objects"
        )
    return array


def _float_type(array: np.ndarray, name: str) -> type:
    """The type to read an array as: float32 or float64, without a loss."""
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "f" and size <= 8:
        return np.float64 if size == 8 else np.float32
    if kind in "iu":
        if size == 8 and array.size:
            low, high = int(array.min()), int(array.max())
            if low < -(2**53) or high > 2**53:
                raise ValueError(
                    f"{name}: expected integers between -2^53 and 2^53, which float64 "
                    f"represents exactly, got {low} to {high}"
                )
        return np.float64
    raise TypeError(f"{name}: expected float32, float64 or integers, got {array.dtype}")


def _table(arrays: Sequence[np.ndarray], single: bool, name: str, most: Optional[int]) -> Table:
    count = arrays[0].shape[0]
    # First of all, because a copy of so many objects can take all memory.
    if most is not None and count >= most:
        raise ValueError(
            f"{name}: expected fewer than 2^31 boxes, got {count}: build several trees"
        )
    types = {_float_type(a, name) for a in arrays}
    if not _halfspace.can_read(tuple(arrays)):
        dtype = np.float32 if types == {np.float32} else np.float64
        arrays = [np.concatenate([a.astype(dtype) for a in arrays], axis=1)]
    return Table(tuple(arrays), count, single)


def _without_nan(array: np.ndarray, name: str) -> Table:
    single = array.ndim == 1
    table = _table([array.reshape(1, -1) if single else array], single, name, None)
    bad = _halfspace.first_bad_box(table.arrays, True)
    if bad >= 0:
        where = name if single else f"{name}[{bad}]"
        raise ValueError(f"{where}: expected numbers, got NaN")
    return table


def _raise_bad_box(table: Table, name: str, row: int) -> None:
    box = np.concatenate([a[row] for a in table.arrays])
    where = name if table.single else f"{name}[{row}]"
    values = box.tolist()
    if np.isnan(box).any():
        raise ValueError(
            f"{where}: expected numbers, got NaN in {values}. An object without an "
            "extent is the empty box, with minima of inf and maxima of -inf"
        )
    low, high = np.split(box, 2)
    axis = int((low > high).argmax())
    raise ValueError(
        f"{where}: expected min <= max, got min {low[axis]} > max {high[axis]} on axis "
        f"{axis} of {values}. The columns are the minima of all axes, then the maxima"
    )
