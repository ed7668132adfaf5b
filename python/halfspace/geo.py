"""Geometries in a BVH, by the calls of `shapely.STRtree` 2 and of geopandas.

    from halfspace.geo import STRtree, sjoin

    tree = STRtree(polygons)
    rows, ids = tree.query(lines, predicate="intersects")
    cities = sjoin(cities, countries, predicate="within")    # GeoDataFrames

Works with shapely 1.8 and 2. Shapely 1.8 makes exact tests one by one, and shapely 2
makes them in one call.
"""

import contextlib
import ctypes
import math
import warnings
from typing import Any, Callable, Iterable, List, Optional, Tuple, Union

import numpy as np
import shapely  # type: ignore
from shapely.errors import ShapelyError  # type: ignore
from shapely.geometry.base import BaseGeometry  # type: ignore
from shapely.prepared import prep  # type: ignore

from ._arrays import ALL_MASKS
from ._bvh import BVH

__all__ = ["STRtree", "sjoin", "sjoin_nearest"]

_PREDICATES = tuple(
    "intersects within contains overlaps crosses touches covers covered_by contains_properly "
    "dwithin".split()
)
# The predicates of the swapped pair, as far as prepared geometries decide them faster.
_INVERSE = {"intersects": "intersects", "within": "contains", "covered_by": "covers"}
_IS_VECTORISED = hasattr(shapely, "STRtree") and hasattr(shapely, "bounds")


class STRtree:
    """Finds geometries by their bounding boxes, and by exact predicates.

    Parameters
    ----------
    geoms : sequence of geometries
        No call returns those that are None or empty.
    node_capacity : int
        The tree ignores it: its nodes have 64 children.

    Notes
    -----
    Calls return what those of `shapely.STRtree` of shapely 2 return, and can run on
    several threads. Boxes are compared as doubles. Z is ignored. If GEOS cannot decide
    about a pair, because a geometry is invalid, the error names the geometry.

    In shapely 2 a predicate prepares the given geometries, as `shapely.prepare`, so do not
    pass the same objects to calls of two threads. Where it is less work, it prepares copies
    of those that it finds instead.
    """

    # How errors name the geometries of a call, and those of the tree.
    _names = ("geometry", "geoms")

    def __init__(self, geoms: Iterable[Any], node_capacity: int = 10):
        self._geometries = _array_of(geoms, "geoms")
        bounds = _bounds_of(self._geometries)
        # The index of each geometry that has a box.
        self._index = np.flatnonzero(~np.isnan(bounds).any(axis=1))
        self._tree = BVH(bounds[self._index], exact=True)

    def __len__(self) -> int:
        return len(self._index)

    def __reduce__(self) -> Tuple[Any, ...]:
        return STRtree, (self._geometries,)

    @property
    def geometries(self) -> np.ndarray:
        """The geometries, in the order of the indices that calls return."""
        return self._geometries

    def query(
        self, geometry: Any, predicate: Optional[str] = None, distance: Any = None
    ) -> np.ndarray:
        """Finds the geometries whose boxes overlap those of the given ones.

        Parameters
        ----------
        geometry : geometry or sequence of geometries
            None and empty ones find nothing.
        predicate : str, optional
            "intersects", "within", "contains", "overlaps", "crosses", "touches",
            "covers", "covered_by", "contains_properly" or "dwithin". Keeps only the
            geometries for which `predicate(geometry, its geometry)` holds.
        distance : float or sequence of floats, one for each geometry
            Of "dwithin", and only of this: finds what is at most so far away.

        Returns
        -------
        ndarray of int64, shape (2, n) or (n,)
            The indices of the given geometries and of those that were found, both
            of which ascend. For one geometry it has only the indices that were found.
        """
        if predicate is not None and predicate not in _PREDICATES:
            raise ValueError(
                f"predicate: {predicate!r} is not a valid option; expected None or "
                f"one of {', '.join(_PREDICATES)}"
            )
        if predicate != "dwithin" and distance is not None:
            raise ValueError('distance: only the predicate "dwithin" has one')
        given, is_one = _given(geometry)
        boxes = _bounds_of(given)
        if is_one and predicate != "dwithin" and _IS_VECTORISED:
            try:
                return self._query_one(given, boxes, predicate)
            except ShapelyError:
                pass  # the lines below name the invalid geometry
        if predicate == "dwithin":
            limits = _limits(distance, len(given))
            boxes = _grown(boxes, np.where(limits >= 0, limits, np.nan))
        rows, ids = self._overlaps(boxes)
        if predicate is not None:
            if predicate == "dwithin":
                is_kept = self._ask("distance", given, rows, ids) <= limits[rows]
            else:
                is_kept = self._hold(predicate, given, rows, ids)
            rows, ids = rows if is_one else rows[is_kept], ids[is_kept]
        return ids if is_one else np.stack([rows, ids])

    def nearest(self, geometry: Any) -> Union[None, int, np.ndarray]:
        """Returns the index of a nearest geometry of each given one.

        None if the tree has no geometry. Raises ValueError if a given one is None or
        empty.
        """
        if len(self) == 0:
            return None
        given, is_one = _given(geometry)
        boxes = _bounds_of(given)
        if np.isnan(boxes).any():
            raise ValueError("geometry: expected geometries that are not None and not empty")
        if is_one and _IS_VECTORISED:
            return self._nearest_one(given, boxes)
        found = self._nearest(given, np.inf, exclusive=False, all_matches=False)[1]
        return found[0] if is_one else found

    def query_nearest(
        self,
        geometry: Any,
        max_distance: Optional[float] = None,
        return_distance: bool = False,
        exclusive: bool = False,
        all_matches: bool = True,
    ) -> Union[np.ndarray, Tuple[np.ndarray, np.ndarray]]:
        """Finds the geometries that are nearest to each given one.

        Parameters
        ----------
        geometry : geometry or sequence of geometries
            None and empty ones find nothing.
        max_distance : float, optional
            Must be above 0. Finds nothing that is farther away.
        return_distance : bool
            Also returns the distances, of shape (n,).
        exclusive : bool
            Leaves out geometries that are equal to the given one. So are, as in
            shapely 2, invalid ones with its box that GEOS cannot compare with it.
        all_matches : bool
            Returns all that are equally near, and not only the first of them.

        Returns indices as `query` does.
        """
        limit = _max_distance(max_distance)
        _check_flag(exclusive, "exclusive")
        _check_flag(all_matches, "all_matches")
        given, is_one = _given(geometry)
        rows, ids, distances = self._nearest(given, limit, exclusive, all_matches)
        result = ids if is_one else np.stack([rows, ids])
        return (result, distances) if return_distance else result

    # One geometry of shapely 2, by less than a third of the calls for many. Raises
    # ShapelyError if one is invalid.

    def _query_one(
        self, given: np.ndarray, box: np.ndarray, predicate: Optional[str]
    ) -> np.ndarray:
        found = self._tree._tree.query_one(box[0], ALL_MASKS)
        if found is None:  # of NaN
            return self._index[:0]
        ids = self._index[found]
        ids.sort()
        if predicate is None or len(ids) == 0:
            return ids
        shapely.lib.prepare(given)  # a copy takes as long as the test
        return ids[getattr(shapely.lib, predicate)(given, self._geometries[ids])]

    def _nearest_one(self, given: np.ndarray, box: np.ndarray) -> Any:
        tree, k = self._tree._tree, min(4, len(self))
        near, far = tree.nearest((box,), k, math.inf, False, False, (ALL_MASKS, 1, None))
        ids = self._index[near[0]]
        distances = shapely.lib.distance(given, self._geometries[ids])
        best = distances.min()
        if _can_be_others(box, best, far[0, -1], k < len(self)):
            ids = self._index[tree.query_one(_grown(box, best)[0], ALL_MASKS)]
            distances = shapely.lib.distance(given, self._geometries[ids])
        return ids[distances == distances.min()].min()

    def _overlaps(self, boxes: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """The rows, and the geometries whose boxes overlap theirs. Both ascend."""
        used = np.flatnonzero(~np.isnan(boxes).any(axis=1))
        rows, ids = self._tree.query(boxes[used])
        # Both are below 2^31. A quarter of the time of np.lexsort().
        ordered = rows << 32 | self._index[ids]
        ordered.sort()
        return used[rows], ordered & (2**32 - 1)

    def _nearest(
        self, given: np.ndarray, limit: float, exclusive: bool, all_matches: bool
    ) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The rows, the nearest geometries up to the limit, and their distances."""

        def measured(rows: np.ndarray, ids: np.ndarray) -> List[np.ndarray]:
            distances = self._ask("distance", given, rows, ids)
            if exclusive:
                distances[self._are_equal(given, rows, ids, distances)] = np.inf
            return [rows, ids, distances]

        boxes = _bounds_of(given)
        left, k, size = np.flatnonzero(~np.isnan(boxes).any(axis=1)), 0, len(self)
        none: np.ndarray = np.empty(0, np.int64)
        found = [[none, none, np.empty(0)]]
        while len(left) and k < size:
            k = min(8 * k or 4, size)
            near, far = self._tree.nearest(boxes[left], k)
            some = measured(np.repeat(left, k), self._index[near.ravel()])
            best = some[2].reshape(-1, k).min(axis=1)
            is_open = _can_be_others(boxes[left], best, far[:, -1], k < size)
            if not is_open.any():
                found.append(some)
                break
            is_closed = np.repeat(~is_open, k)
            found.append([values[is_closed] for values in some])
            is_near = is_open & (best < np.inf)
            wide = left[is_near]
            rows, ids = self._overlaps(_grown(boxes[wide], best[is_near]))
            found.append(measured(wide[rows], ids))
            left = left[is_open & ~is_near]
        rows, ids, distances = (np.concatenate(values) for values in zip(*found))
        is_kept = (distances <= limit) & (distances < np.inf)
        rows, ids, distances = rows[is_kept], ids[is_kept], distances[is_kept]
        # By distance, then by index, for each row.
        order = np.lexsort((ids, distances, rows))
        rows, ids, distances = rows[order], ids[order], distances[order]
        is_first = np.diff(rows, prepend=-1) != 0
        if all_matches:
            first = np.flatnonzero(is_first)
            least = np.repeat(distances[first], np.diff(first, append=len(rows)))
            is_first = distances == least
        return rows[is_first], ids[is_first], distances[is_first]

    def _are_equal(
        self, given: np.ndarray, rows: np.ndarray, ids: np.ndarray, distances: np.ndarray
    ) -> np.ndarray:
        """Which pairs are equal, or cannot be compared. GEOS compares their boxes first."""
        are_equal = distances == 0
        rows, ids = rows[are_equal], ids[are_equal]
        are_equal[are_equal] = self._ask("equals", given, rows, ids, on_error=True)
        return are_equal

    def _ask(
        self,
        call: str,
        given: np.ndarray,
        rows: np.ndarray,
        ids: np.ndarray,
        on_error: Optional[bool] = None,
    ) -> np.ndarray:
        """What a call of shapely returns for pairs of geometries."""
        if _IS_VECTORISED:
            try:
                return getattr(shapely.lib, call)(given[rows], self._geometries[ids])
            except ShapelyError:
                pass  # one by one, to find its pair
        one = lambda a, b: getattr(a, call)(b)
        dtype = float if call == "distance" else bool
        return np.array(self._each(one, given, rows, ids, on_error), dtype)

    def _each(
        self,
        call: Callable[[Any, Any], Any],
        given: np.ndarray,
        rows: np.ndarray,
        ids: np.ndarray,
        on_error: Optional[bool] = None,
    ) -> List[Any]:
        """The results of call(given, its) for each pair, or `on_error`. Without it, an
        error of shapely names the invalid geometries of its pair, or both."""
        results = []
        for row, index in zip(rows.tolist(), ids.tolist()):
            pair = given[row], self._geometries[index]
            try:
                result = call(*pair)
            except ShapelyError as error:
                if on_error is None:
                    names = [f"{name}[{i}]" for name, i in zip(self._names, (row, index))]
                    bad = [name for name, its in zip(names, pair) if not its.is_valid]
                    raise type(error)(f"{' and '.join(bad or names)}: {error}") from error
                result = on_error
            results.append(result)
        return results

    def _test(
        self, predicate: str, given: np.ndarray, rows: np.ndarray, ids: np.ndarray
    ) -> np.ndarray:
        """The tests of pairs in one call of shapely 2, by prepared geometries of one side."""
        swaps = predicate in _INVERSE
        if predicate == "intersects" and len(rows):
            # To prepare a geometry reads its vertices, and a test those of the other side.
            step, count = len(rows) // 1024 + 1, shapely.lib.get_num_coordinates
            a, b = count(given[rows[::step]]).mean(), count(self._geometries[ids[::step]]).mean()
            its_rows, its_ids = 1 + np.count_nonzero(np.diff(rows)), min(len(ids), len(self))
            swaps = b * its_ids + a * len(rows) < a * its_rows + b * len(rows)
        sides = (given, rows), (self._geometries, ids)
        (first, keys), (second, others) = sides[::-1] if swaps else sides
        test = getattr(shapely.lib, _INVERSE[predicate] if swaps else predicate)
        # The tests of a prepared geometry follow each other, and its memory is used again by
        # the next ones, so that all is in the cache.
        order = np.argsort(keys, kind="stable")
        holds = np.empty(len(keys), bool)
        for begin in range(0, len(keys), 4096):
            some = order[begin : begin + 4096]
            its = keys[some]
            is_new = np.diff(its, prepend=-1) != 0
            used = first[its[is_new]]
            if swaps:
                # Another thread can use the tree, and GEOS makes the index of a prepared
                # geometry during a test, without a lock.
                used = shapely.lib.set_srid(used, np.intc(0))  # a copy
            shapely.lib.prepare(used)
            holds[some] = test(used[np.cumsum(is_new) - 1], second[others[some]])
        return holds

    def _hold(
        self, predicate: str, given: np.ndarray, rows: np.ndarray, ids: np.ndarray
    ) -> np.ndarray:
        if _IS_VECTORISED:
            with contextlib.suppress(ShapelyError):  # one by one, to find its pair
                return self._test(predicate, given, rows, ids)
            return self._ask(predicate, given, rows, ids)
        last, test = None, None

        def holds(a: Any, b: Any) -> Any:
            nonlocal last, test
            if predicate == "covered_by":
                return b.covers(a)
            if a is not last:
                last, test = a, getattr(prep(a), predicate)
            try:
                return test(b)  # type: ignore
            except AttributeError:  # shapely asks the prepared geometry whether it is valid
                return getattr(a, predicate)(b)

        return np.array(self._each(holds, given, rows, ids), bool)


def sjoin(
    left_df: Any,
    right_df: Any,
    how: str = "inner",
    predicate: Optional[str] = "intersects",
    lsuffix: str = "left",
    rsuffix: str = "right",
    distance: Any = None,
    on_attribute: Any = None,
) -> Any:
    """Joins two GeoDataFrames where a predicate of their geometries holds.

    Parameters
    ----------
    left_df, right_df : GeoDataFrame
    how : "inner", "left" or "right"
        "left" also keeps the rows of `left_df` that join with none, and "right" those
        of `right_df`. Their missing values are NaN or None. The result has the
        geometries and the index of `left_df`, or with "right" of `right_df`.
    predicate, distance
        As in `STRtree.query`, of the left and the right geometry.
    lsuffix, rsuffix : str
        Columns that both frames have become `name_left` and `name_right`. The index
        of the other frame becomes the column `index_right` or `index_left`, or for a
        MultiIndex the columns `index_right0`, `index_right1` and so on. With geopandas 1
        a level that has a name keeps it, and so does the column of geometries.
    on_attribute : str or sequence of str, optional
        Columns of both frames. Joins only rows that have equal values there, which
        are not NaN. The result has the columns of `left_df`.

    Returns a GeoDataFrame with the columns of `geopandas.sjoin` in geopandas 0.12 or 1.0,
    whichever is installed. The rows are in the order of the frame whose index it has, then
    of the other frame.
    """
    _check_frames(left_df, right_df, how, lsuffix, rsuffix)
    if predicate == "within":
        # The same pairs, with fewer prepared geometries.
        tree = STRtree(left_df.geometry)
        tree._names = ("right_df.geometry.iloc", "left_df.geometry.iloc")
        right, left = tree.query(right_df.geometry, "contains", distance)
    else:
        tree = STRtree(right_df.geometry)
        tree._names = ("left_df.geometry.iloc", "right_df.geometry.iloc")
        left, right = tree.query(left_df.geometry, predicate, distance)
    if on_attribute is not None:
        names = [on_attribute] if isinstance(on_attribute, str) else list(on_attribute)
        for name in names:
            for frame_name, frame in (("left_df", left_df), ("right_df", right_df)):
                if name not in frame.columns or name == frame.geometry.name:
                    raise ValueError(f"on_attribute: {frame_name} has no column {name!r} of values")
            equal = left_df[name].to_numpy()[left] == right_df[name].to_numpy()[right]
            left, right = left[equal], right[equal]
        right_df = right_df.drop(columns=names)
    return _joined(left_df, right_df, left, right, how, lsuffix, rsuffix)


def sjoin_nearest(
    left_df: Any,
    right_df: Any,
    how: str = "inner",
    max_distance: Optional[float] = None,
    lsuffix: str = "left",
    rsuffix: str = "right",
    distance_col: Optional[str] = None,
    exclusive: bool = False,
) -> Any:
    """Joins each row of a GeoDataFrame with the nearest rows of another.

    Finds the nearest right rows of each left row, or with how="right" the nearest left
    rows of each right row. All rows at the same distance are found. `max_distance` and
    `exclusive` are those of `STRtree.query_nearest`. The column `distance_col`, if it is
    not None, gets the distances. Everything else is as in `sjoin`.
    """
    _check_frames(left_df, right_df, how, lsuffix, rsuffix)
    its, other = (right_df, left_df) if how == "right" else (left_df, right_df)
    (rows, ids), distances = STRtree(other.geometry).query_nearest(
        its.geometry, max_distance, return_distance=True, exclusive=exclusive
    )
    left, right = (ids, rows) if how == "right" else (rows, ids)
    return _joined(left_df, right_df, left, right, how, lsuffix, rsuffix, distances, distance_col)


def _check_frames(left_df: Any, right_df: Any, how: str, lsuffix: str, rsuffix: str) -> None:
    from geopandas import GeoDataFrame  # type: ignore

    if how not in ("inner", "left", "right"):
        raise ValueError(f'how: expected "inner", "left" or "right", got {how!r}')
    for name, frame in (("left_df", left_df), ("right_df", right_df)):
        if not isinstance(frame, GeoDataFrame):
            raise ValueError(f"{name}: expected a GeoDataFrame, got {type(frame).__name__}")
        for column in (f"index_{lsuffix}", f"index_{rsuffix}"):
            if column in frame.columns:
                raise ValueError(
                    f"{name}: expected no column {column!r}, which the result can have"
                )
    if left_df.crs != right_df.crs:
        warnings.warn(
            f"left_df has the CRS {left_df.crs}, and right_df {right_df.crs}: convert one of "
            "them with to_crs()",
            UserWarning,
            stacklevel=3,
        )


def _joined(
    left_df: Any,
    right_df: Any,
    left: np.ndarray,
    right: np.ndarray,
    how: str,
    lsuffix: str,
    rsuffix: str,
    distances: Optional[np.ndarray] = None,
    distance_col: Optional[str] = None,
) -> Any:
    """The frame of pairs of rows, and with `distance_col` the column of distances."""
    import geopandas
    import pandas  # type: ignore

    is_new = not geopandas.__version__.startswith("0.")
    is_right = how == "right"
    its, other = (right_df, left_df) if is_right else (left_df, right_df)
    rows, ids = (right, left) if is_right else (left, right)
    values = np.zeros(len(rows)) if distances is None else distances
    if how != "inner":
        alone = np.setdiff1d(np.arange(len(its)), rows)
        rows = np.concatenate([rows, alone])
        ids = np.concatenate([ids, np.full(len(alone), -1)])
        values = np.concatenate([values, np.full(len(alone), np.nan)])
    order = np.lexsort((ids, rows))
    result = pandas.DataFrame(its.iloc[rows[order]])
    added = pandas.DataFrame(other.drop(columns=other.geometry.name))
    name = f"index_{lsuffix if is_right else rsuffix}"
    levels = added.index.nlevels
    labels = [name] if levels == 1 else [f"{name}{i}" for i in range(levels)]
    if is_new:
        labels = [new if own is None else own for new, own in zip(labels, added.index.names)]
    # A renamed copy, as the index is the caller's.
    added.index = added.index.set_names(labels)
    # No row has the number -1.
    added = added.reset_index().reindex(ids[order])
    added.index = result.index
    both = result.columns.intersection(added.columns)
    its_both = both.drop(its.geometry.name, errors="ignore") if is_new else both
    index_both = added.columns.intersection(result.index.names) if is_new else both[:0]
    were_twice = np.concatenate([result.columns.duplicated(), added.columns.duplicated()])
    its_suffix, other_suffix = (rsuffix, lsuffix) if is_right else (lsuffix, rsuffix)
    geometry = its.geometry.name
    if geometry in its_both:
        geometry = f"{geometry}_{its_suffix}"
    result = result.rename(columns={column: f"{column}_{its_suffix}" for column in its_both})
    both = both.union(index_both)
    added = added.rename(columns={column: f"{column}_{other_suffix}" for column in both})
    result.index = added.index = result.index.set_names(
        [f"{own}_{its_suffix}" if own in index_both else own for own in result.index.names]
    )
    parts = [added, result] if is_right else [result, added]
    names = result.columns.append(added.columns)
    if distance_col is not None:
        names = names.append(pandas.Index([distance_col]))
    twice = names.duplicated()
    twice[:len(were_twice)] &= ~were_twice
    if twice.any():
        raise ValueError(f"the result would have two columns {names[twice][0]!r}")
    joined = type(its)(pandas.concat(parts, axis=1), geometry=geometry, crs=its.crs)
    if distance_col is not None:
        joined[distance_col] = values[order]
    return joined


def _array_of(geometries: Iterable[Any], name: str) -> np.ndarray:
    """An array of one dimension, which asks no geometry for its parts."""
    if getattr(geometries, "ndim", 1) != 1:
        raise TypeError(f"{name}: expected one dimension, got {geometries.ndim}")  # type: ignore
    items = list(geometries)
    array = np.empty(len(items), object)
    for i, item in enumerate(items):
        if item is not None and not isinstance(item, BaseGeometry):
            raise TypeError(f"{name}[{i}]: expected a geometry or None, got {item!r}")
        array[i] = item
    return array


def _given(geometry: Any) -> Tuple[np.ndarray, bool]:
    """The geometries of a call, and whether it is one."""
    if isinstance(geometry, BaseGeometry):
        one = np.empty(1, object)
        one[0] = geometry
        return one, True
    is_one = geometry is None or isinstance(geometry, str)
    return _array_of([geometry] if is_one else geometry, "geometry"), is_one


def _bounds_of(geometries: np.ndarray) -> np.ndarray:
    """The boxes, of shape (n, 4). NaN of None and of empty geometries."""
    if _IS_VECTORISED:
        boxes = np.empty((len(geometries), 4))
        shapely.lib.bounds(geometries, boxes)
        return boxes
    bounds = np.full((len(geometries), 4), np.nan)
    write, at = _writer_of_bounds(), bounds.ctypes.data
    for geometry in geometries:
        if geometry is not None and geometry._geom:
            write(geometry._geom, at)
        at += 32
    return bounds


def _writer_of_bounds() -> Callable[[int, int], Any]:
    """Returns what writes the box of a geometry of GEOS to an address, if it is not empty.

    For shapely 1.8, whose `geometry.bounds` takes 5 to 17 microseconds. GEOS takes half of
    one, and one before 3.11.
    """
    from shapely.geos import lgeos  # type: ignore

    handle = lgeos.geos_handle
    library = ctypes.PyDLL(lgeos._lgeos._name, handle=lgeos._lgeos._handle)

    def call(name: str, outputs: int) -> Any:
        function = library[name]
        function.argtypes = [ctypes.c_void_p] * (2 + outputs)
        return function

    if hasattr(library, "GEOSGeom_getExtent_r"):
        extent = call("GEOSGeom_getExtent_r", 4)
        return lambda geometry, at: extent(handle, geometry, at, at + 8, at + 16, at + 24)
    x, y, x_max, y_max = (
        call(f"GEOSGeom_get{side}_r", 1) for side in ("XMin", "YMin", "XMax", "YMax")
    )
    return lambda geometry, at: (
        x(handle, geometry, at),
        y(handle, geometry, at + 8),
        x_max(handle, geometry, at + 16),
        y_max(handle, geometry, at + 24),
    )


def _reach(boxes: np.ndarray, margins: np.ndarray) -> np.ndarray:
    """The margins, and the error of distances as doubles."""
    return margins + 2.0**-48 * (margins + np.abs(boxes).max(axis=1, initial=0))


def _grown(boxes: np.ndarray, margins: np.ndarray) -> np.ndarray:
    """The boxes, larger by at least the margins and the error of distances."""
    margins = _reach(boxes, margins)[:, np.newaxis]
    return np.hstack([boxes[:, :2] - margins, boxes[:, 2:] + margins])


def _can_be_others(boxes: np.ndarray, best: Any, far: Any, has_others: bool) -> Any:
    """Whether there can be nearer ones than the best of the k whose boxes are nearest.

    The others are farther than `far`, whose error is 2^-20. It is inf if boxes are so far
    away that their distance is no float32.
    """
    is_far = np.isinf(far)
    return is_far | (far * (1 - 2.0**-18) <= _reach(boxes, best)) if has_others else is_far


def _limits(distance: Any, count: int) -> np.ndarray:
    if distance is None:
        raise ValueError('distance: expected a number, as "dwithin" needs one')
    try:
        return np.broadcast_to(np.asarray(distance, np.float64), (count,))
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"distance: expected a number, or {count} numbers, got {distance!r}: {error}"
        ) from None


def _max_distance(value: Any) -> float:
    if value is None:
        return np.inf
    if not isinstance(value, (int, float, np.number)) or not value > 0:
        raise ValueError(f"max_distance: expected a number greater than 0, got {value!r}")
    return float(value)


def _check_flag(value: Any, name: str) -> None:
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name}: expected a bool, got {value!r}")
