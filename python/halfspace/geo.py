"""Geometries in a BVH, by the calls of `shapely.STRtree` 2 and of geopandas.

    from halfspace.geo import STRtree, sjoin

    tree = STRtree(polygons)
    rows, ids = tree.query(lines, predicate="intersects")
    cities = sjoin(cities, countries, predicate="within")    # GeoDataFrames

Works with shapely 1.8 and 2, on Linux and macOS. All exact tests of a call run in C++,
without the interpreter's lock, by the functions of the GEOS that shapely has loaded.
"""

import ctypes
import warnings
from typing import Any, Iterable, Literal, Optional, Tuple, Union, overload

import numpy as np
import shapely  # type: ignore
from shapely.errors import TopologicalError  # type: ignore
from shapely.geometry.base import BaseGeometry  # type: ignore

from . import _arrays, _halfspace
from ._bvh import BVH

__all__ = ["STRtree", "sjoin", "sjoin_nearest"]

_PREDICATES = tuple(
    "intersects within contains overlaps crosses touches covers covered_by contains_properly "
    "dwithin".split()
)


def _use_geos() -> None:
    """Gives the extension module the GEOS that shapely has loaded."""
    if hasattr(shapely, "lib"):
        # The functions of the libraries that it needs, too.
        library: Any = ctypes.PyDLL(shapely.lib.__file__)
        api, error = shapely.lib._C_API, shapely.lib.GEOSException
    else:
        from shapely.geos import lgeos  # type: ignore

        library, api, error = lgeos._lgeos, None, TopologicalError

    def address_of(name: str) -> Optional[int]:
        return ctypes.cast(library[name], ctypes.c_void_p).value

    _halfspace.use_geos(address_of, api, BaseGeometry, error)


_use_geos()


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
    """

    # How errors name the geometries of a call, and those of the tree.
    _names = ("geometry", "geoms")

    def __init__(self, geoms: Iterable[Any], node_capacity: int = 10):
        self._its = _halfspace.Geometries(geoms, "geoms")
        self._geometries = self._its.array()
        boxes = self._its.bounds.copy()
        missing = np.flatnonzero(np.isnan(boxes).any(axis=1))
        boxes[missing] = [np.inf, np.inf, -np.inf, -np.inf]
        self._tree = BVH(boxes, exact=True)
        self._tree.erase(missing)

    def __len__(self) -> int:
        return len(self._tree)

    def __reduce__(self) -> Tuple[Any, ...]:
        return STRtree, (self._geometries,)

    @property
    def geometries(self) -> np.ndarray:
        """The geometries, in the order of the indices that calls return."""
        return self._geometries

    def query(self, geometry: Any, predicate: Optional[str] = None, distance: Any = None, *,
              threads: Optional[int] = 1) -> np.ndarray:
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
        threads : int or None
            The number of threads for boxes and predicates, as in `BVH`. Geometries of
            shapely 1.8 must not change during a call.

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
        given = _halfspace.Geometries(geometry, "geometry")
        boxes = given.bounds
        if predicate == "dwithin":
            limits = _limits(distance, len(given))
            boxes = _grown(boxes, np.where(limits >= 0, limits, np.nan))
        count = _arrays.threads(threads)
        rows, ids = self._overlaps(boxes, count)
        if predicate is not None:
            if predicate == "dwithin":
                far = given.distances(rows, self._its, ids, self._names, count)
                is_kept = far <= limits[rows]
            else:
                is_kept = given.hold(predicate, rows, self._its, ids, self._names, count)
            rows, ids = rows[is_kept], ids[is_kept]
        return ids if given.is_one else np.stack([rows, ids])

    def nearest(self, geometry: Any, *,
                threads: Optional[int] = 1) -> Union[None, int, np.ndarray]:
        """Returns the index of a nearest geometry of each given one.

        None if the tree has no geometry. Raises ValueError if a given one is None or
        empty.
        """
        if len(self) == 0:
            return None
        given = _halfspace.Geometries(geometry, "geometry")
        if np.isnan(given.bounds).any():
            raise ValueError("geometry: expected geometries that are not None and not empty")
        ids = self._nearest(given, np.inf, False, False, threads)[0][1]
        return ids[0] if given.is_one else ids

    @overload
    def query_nearest(self, geometry: Any, max_distance: Optional[float] = ...,
                      return_distance: Literal[False] = ..., exclusive: bool = ...,
                      all_matches: bool = ..., *, threads: Optional[int] = ...) -> np.ndarray: ...

    @overload
    def query_nearest(self, geometry: Any, max_distance: Optional[float] = ..., *,
                      return_distance: Literal[True], exclusive: bool = ..., all_matches: bool = ...,
                      threads: Optional[int] = ...) -> Tuple[np.ndarray, np.ndarray]: ...

    def query_nearest(self, geometry: Any, max_distance: Optional[float] = None,
                      return_distance: bool = False, exclusive: bool = False,
                      all_matches: bool = True, *, threads: Optional[int] = 1) -> Any:
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
        threads : int or None
            As in `query`. `nearest` has it, too.

        Returns indices as `query` does.
        """
        limit = _max_distance(max_distance)
        _check_flag(exclusive, "exclusive")
        _check_flag(all_matches, "all_matches")
        given = _halfspace.Geometries(geometry, "geometry")
        found, distances = self._nearest(given, limit, exclusive, all_matches, threads)
        result = found[1] if given.is_one else found
        return (result, distances) if return_distance else result

    def _overlaps(self, boxes: np.ndarray, threads: int) -> Tuple[np.ndarray, np.ndarray]:
        """The rows, and the geometries whose boxes overlap theirs. Both ascend."""
        if len(boxes) == 1:
            ids = self._tree._tree.query_one(boxes[0], _arrays.ALL_MASKS, True)
            if ids is None:  # of NaN
                ids = np.empty(0, np.int64)
            return np.zeros(len(ids), np.int64), ids
        used = np.flatnonzero(~np.isnan(boxes).any(axis=1))
        rows, ids = self._tree.query(boxes[used], threads=threads)
        # Both are below 2^31. A quarter of the time of np.lexsort().
        ordered = rows << 32 | ids
        ordered.sort()
        return used[rows], ordered & (2**32 - 1)

    def _nearest(self, given: Any, limit: float, exclusive: bool, all_matches: bool,
                 threads: Optional[int]) -> Tuple[np.ndarray, np.ndarray]:
        """The rows and the nearest geometries up to the limit, and their distances."""
        return given.nearest(self._tree._tree, self._its, limit, exclusive, all_matches,
                             self._names, _arrays.threads(threads))


def sjoin(left_df: Any, right_df: Any, how: str = "inner", predicate: Optional[str] = "intersects",
          lsuffix: str = "left", rsuffix: str = "right", distance: Any = None,
          on_attribute: Any = None, threads: Optional[int] = 1) -> Any:
    """Joins two GeoDataFrames where a predicate of their geometries holds.

    Parameters
    ----------
    left_df, right_df : GeoDataFrame
    how : "inner", "left" or "right"
        "left" also keeps the rows of `left_df` that join with none, and "right" those
        of `right_df`. Their missing values are NaN or None. The result has the
        geometries and the index of `left_df`, or with "right" of `right_df`.
    predicate, distance, threads
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
        right, left = tree.query(right_df.geometry, "contains", distance, threads=threads)
    else:
        tree = STRtree(right_df.geometry)
        tree._names = ("left_df.geometry.iloc", "right_df.geometry.iloc")
        left, right = tree.query(left_df.geometry, predicate, distance, threads=threads)
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


def sjoin_nearest(left_df: Any, right_df: Any, how: str = "inner",
                  max_distance: Optional[float] = None, lsuffix: str = "left",
                  rsuffix: str = "right", distance_col: Optional[str] = None,
                  exclusive: bool = False, threads: Optional[int] = 1) -> Any:
    """Joins each row of a GeoDataFrame with the nearest rows of another.

    Finds the nearest right rows of each left row, or with how="right" the nearest left
    rows of each right row. All rows at the same distance are found. `max_distance`,
    `exclusive` and `threads` are those of `STRtree.query_nearest`. The column
    `distance_col`, if it is not None, gets the distances. Everything else is as in `sjoin`.
    """
    _check_frames(left_df, right_df, how, lsuffix, rsuffix)
    its, other = (right_df, left_df) if how == "right" else (left_df, right_df)
    (rows, ids), distances = STRtree(other.geometry).query_nearest(
        its.geometry, max_distance, return_distance=True, exclusive=exclusive, threads=threads
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


def _joined(left_df: Any, right_df: Any, left: np.ndarray, right: np.ndarray, how: str,
            lsuffix: str, rsuffix: str, distances: Optional[np.ndarray] = None,
            distance_col: Optional[str] = None) -> Any:
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


def _grown(boxes: np.ndarray, margins: np.ndarray) -> np.ndarray:
    """The boxes, larger by at least the margins and the error of distances."""
    margins = margins + 2.0**-48 * (margins + np.abs(boxes).max(axis=1, initial=0))
    return np.hstack([boxes[:, :2] - margins[:, np.newaxis], boxes[:, 2:] + margins[:, np.newaxis]])


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
