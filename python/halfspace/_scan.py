"""The flat scan."""

from __future__ import annotations

from typing import Any, Optional, overload

import numpy as np

from . import _arrays, _halfspace
from ._searches import Box, Boxes


class Scan:
    """Boxes that every query tests one after another, with SIMD.

    For a few hundred boxes, for boxes of which a query finds a large part, and
    for masks. For one query over more boxes `BVH` is faster. The results are the
    same, except for their order.

    Parameters
    ----------
    boxes : array_like, shape (n, 6) or (n, 4)
        As in `BVH`.
    quantized : bool
        Tests 8 bits per value first, and the floats of the boxes that these
        keep. Results are the same. Faster from about 1000 boxes on, and takes
        25 % more memory.
    """

    __slots__ = ("_scan", "__weakref__")

    def __init__(self, boxes: Any, *, quantized: bool = False) -> None:
        table = _arrays.boxes(boxes, "boxes", most=_arrays.MOST_OBJECTS)
        self._scan = _halfspace.Scan(table.arrays, bool(quantized))

    def query(self, boxes: Any, *, threads: Optional[int] = 1) -> np.ndarray:
        """Finds the objects that overlap boxes.

        As `BVH.query`, but the ids of a row ascend.
        """
        table = self._boxes(boxes)
        found = self._scan.query(table.arrays, _arrays.threads(threads))
        return found[1] if table.single else found

    @overload
    def count(self, boxes: Box, *, threads: Optional[int] = ...) -> int: ...

    @overload
    def count(self, boxes: Boxes, *, threads: Optional[int] = ...) -> np.ndarray: ...

    @overload
    def count(self, boxes: Any, *, threads: Optional[int] = ...) -> Any: ...

    def count(self, boxes: Any, *, threads: Optional[int] = 1) -> Any:
        """Counts the objects that overlap each box, as `BVH.count`."""
        table = self._boxes(boxes)
        counts = self._scan.count(table.arrays, _arrays.threads(threads))
        return int(counts[0, 0]) if table.single else counts[:, 0]

    @overload
    def any(self, boxes: Box, *, threads: Optional[int] = ...) -> bool: ...

    @overload
    def any(self, boxes: Boxes, *, threads: Optional[int] = ...) -> np.ndarray: ...

    @overload
    def any(self, boxes: Any, *, threads: Optional[int] = ...) -> Any: ...

    def any(self, boxes: Any, *, threads: Optional[int] = 1) -> Any:
        """Returns for each box whether an object overlaps it, as `BVH.any`."""
        table = self._boxes(boxes)
        ids = self._scan.any(table.arrays, _arrays.threads(threads))
        return int(ids[0, 0]) >= 0 if table.single else ids[:, 0] >= 0

    def mask(self, boxes: Any, *, threads: Optional[int] = 1) -> np.ndarray:
        """Returns for each box and each object whether they overlap.

        Returns an array of bool with the shape (m, n), or (n,) for one box.

        >>> import halfspace as hs
        >>> hs.Scan([[0, 0, 1, 1], [2, 2, 3, 3]]).mask([[0, 0, 1, 1], [1, 1, 2, 2]])
        array([[ True, False],
               [ True,  True]])
        """
        table = self._boxes(boxes)
        mask = self._scan.mask(table.arrays, _arrays.threads(threads))
        return mask[0] if table.single else mask

    def __len__(self) -> int:
        """The number of objects."""
        return self._scan.size()

    @property
    def dims(self) -> int:
        """The number of dimensions, 2 or 3."""
        return self._scan.dims

    def __repr__(self) -> str:
        return f"<halfspace.Scan: {len(self)} boxes in {self.dims} dimensions>"

    def _boxes(self, value: Any) -> _arrays.Table:
        return _arrays.boxes(value, "boxes", self.dims)
