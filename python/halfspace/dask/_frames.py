"""Joins of frames whose partitions are GeoDataFrames."""

from __future__ import annotations

import typing

import dask
import numpy as np
from dask.delayed import Delayed

import halfspace as hs
from halfspace.dask._source import empty_if_null


def sjoin(left_df, right_df, how: str = "inner", predicate: str | None = "intersects",
          lsuffix: str = "left", rsuffix: str = "right", distance=None,
          on_attribute=None):
    """Joins two frames where a predicate of their geometries holds.

    A frame is one of dask-geopandas, a dask DataFrame whose partitions are GeoDataFrames, or
    a GeoDataFrame. `how` is "inner" or "left", and `distance` is one number. All other
    arguments and the columns are those of `halfspace.geo.sjoin`.

    Returns a frame as dask makes it of GeoDataFrames: one of dask-geopandas, if that is
    imported. It has a partition for each of `left_df`, with its divisions, its geometries
    and its index. A task joins one partition of `left_df` with all those of `right_df` whose
    bounds overlap it. So few partitions should overlap: see `spatial_shuffle` of
    dask-geopandas.

    The call computes the bounds of the partitions of frames without `spatial_partitions`.
    """
    import dask.dataframe

    from halfspace import geo

    if how not in ("inner", "left"):
        raise ValueError(f'how: expected "inner" or "left", got {how!r}')
    if np.ndim(distance) > 0:
        raise ValueError("distance: expected one number for all rows")
    left, right = _parts_of(left_df, "left_df"), _parts_of(right_df, "right_df")
    options = {"how": how, "predicate": predicate, "lsuffix": lsuffix, "rsuffix": rsuffix,
               "distance": distance, "on_attribute": on_attribute}
    meta = geo.sjoin(left.meta, right.meta, **options)
    boxes, its_boxes = (empty_if_null(np.array(bounds, np.float64))
                        for bounds in dask.compute(left.bounds, right.bounds))
    rows, ids = hs.BVH(its_boxes).query(boxes, within=distance and max(distance, 0))
    join = dask.delayed(_join, pure=False)
    frames = [join(part, [right.parts[j] for j in ids[rows == i]], right.meta, options)
              for i, part in enumerate(left.parts)]
    return dask.dataframe.from_delayed(frames, meta=meta, divisions=left.divisions,
                                       prefix="halfspace-sjoin", verify_meta=False)


class _Parts(typing.NamedTuple):
    parts: list[Delayed]
    meta: typing.Any  # an empty frame
    bounds: typing.Any  # of each part, or what returns them
    divisions: tuple | None


def _parts_of(frame, name: str) -> _Parts:
    is_lazy = dask.is_dask_collection(frame)
    meta = getattr(frame, "_meta", None) if is_lazy else frame[:0]
    if not hasattr(meta, "total_bounds"):
        raise TypeError(f"{name}: expected a GeoDataFrame, or partitions that are GeoDataFrames")
    if not is_lazy:
        return _Parts([dask.delayed(frame)], meta, [frame.total_bounds], None)
    parts = frame.to_delayed()
    known = getattr(frame, "spatial_partitions", None)
    bounds = ([dask.delayed(_bounds_of)(part) for part in parts] if known is None
              else known.bounds.to_numpy())
    return _Parts(parts, meta, bounds, frame.divisions if frame.known_divisions else None)


def _bounds_of(frame) -> np.ndarray:
    return frame.total_bounds


def _join(left, rights: list, meta, options: dict):
    import pandas  # type: ignore

    from halfspace import geo

    return geo.sjoin(left, pandas.concat(rights) if rights else meta, **options)
