"""The broad phase."""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple

import numpy as np

from . import _arrays, _halfspace


class BroadPhase:
    """The boxes of the moving bodies of a simulation.

    Ids are the caller's numbers below `max_ids`, such as the row of a body in
    an array. Boxes that touch overlap. Results are exact, whatever the margin
    and the history are.

    Parameters
    ----------
    max_ids : int
        Memory for all ids is allocated at once: 46 bytes each in 3 dimensions.
    dimensions : 2 or 3
    kind : "aabb" or "aabo"
        "aabo" bounds bodies by octahedra (8-DOPs), which have one more axis, `D
        = -(x + y + z)`. A bound has the minima of all axes, then the maxima.
        Boxes are allowed as well.
    margin : float
        The boxes in the tree are larger by this on each side. A body that moves
        less between two calls of `update` costs only a comparison. A tenth of
        the size of a body is usual.

    Notes
    -----
    Boxes are arrays as in `BVH`: float32, or float64, which is rounded outward.
    A NaN, or a minimum above a maximum, raises ValueError, and masked values raise
    TypeError. Methods that change bodies raise ValueError with the row of a wrong
    id, and change nothing then.

    Every call releases the interpreter's lock. Threads can query and move
    bodies at the same time, without any other lock. Two calls that change the
    same body must not run at the same time. `insert`, `erase`, `update`,
    `rebuild` and `update_pairs` wait for each other, and not for queries or
    moves. A query sees each body with a box that it had during the query.

    Examples
    --------
    >>> import halfspace as hs
    >>> bodies = hs.BroadPhase(100, dimensions=2)
    >>> bodies.insert([7, 8, 9], [[0, 0, 1, 1], [1, 0, 2, 1], [5, 5, 6, 6]])
    >>> began, ended = bodies.update_pairs()
    >>> began
    array([[7, 8]])
    >>> bodies.move([8], [[5, 4, 6, 5]])
    >>> bodies.update()
    >>> began, ended = bodies.update_pairs()
    >>> began, ended
    (array([[8, 9]]), array([[7, 8]]))
    """

    __slots__ = ("_bodies", "_dims", "_axes", "_max_ids", "__weakref__")

    def __init__(
        self,
        max_ids: int,
        dimensions: int = 3,
        kind: str = "aabb",
        margin: float = 0.0,
    ) -> None:
        if dimensions not in (2, 3):
            raise ValueError(f"dimensions: expected 2 or 3, got {dimensions!r}")
        if kind not in ("aabb", "aabo"):
            raise ValueError(f'kind: expected "aabb" or "aabo", got {kind!r}')
        self._dims = int(dimensions)
        self._axes = self._dims + (kind == "aabo")
        self._max_ids = _arrays.positive(max_ids, "max_ids", 2**29)
        self._bodies = _halfspace.BroadPhase(
            self._max_ids, self._dims, kind == "aabo", _margin(margin)
        )

    def insert(
        self, ids: Any, boxes: Any, categories: Any = None, collides_with: Any = None
    ) -> None:
        """Adds bodies. Box i is that of body `ids[i]`.

        `categories` and `collides_with` are masks of 64 bits: one integer, or
        one for each id. Without them the category is 1, and a body collides
        with all categories. Insert many bodies by one call.
        """
        table, wanted = self._rows(ids, boxes)
        masks = _arrays.masks(categories, collides_with, len(wanted))
        self._bodies.insert(wanted, table.arrays, masks)

    def erase(self, ids: Any) -> None:
        """Removes bodies. An id that is given twice is removed once."""
        self._bodies.erase(_arrays.ids(ids, "ids"))

    def move(self, ids: Any, boxes: Any) -> None:
        """Changes the boxes of bodies. If an id is given twice, the last counts."""
        table, wanted = self._rows(ids, boxes)
        self._bodies.move(wanted, table.arrays)

    def set_masks(self, ids: Any, categories: Any, collides_with: Any) -> None:
        """Changes the masks of bodies, which are those of `insert`."""
        wanted = _arrays.ids(ids, "ids")
        masks = _arrays.masks(categories, collides_with, len(wanted))
        self._bodies.set_masks(wanted, masks)

    def update(
        self, budget: Optional[int] = None, *, threads: Optional[int] = 1
    ) -> None:
        """Updates the tree. Call it once per frame.

        Puts new bodies into the tree, removes those that were erased, makes the
        boxes of bodies that moved tight, and sorts again what has decayed. It
        changes no result. `budget` is about how many bodies are sorted again at
        most, and at least 4096. 0 sorts none. None is a 16th of all.
        """
        self._bodies.update(_arrays.budget(budget), _arrays.threads(threads))

    def rebuild(self, *, threads: Optional[int] = 1) -> None:
        """As `update`, but sorts all bodies again."""
        self._bodies.rebuild(0, _arrays.threads(threads))

    def query(
        self, boxes: Any, mask: Optional[int] = None, *, threads: Optional[int] = 1
    ) -> np.ndarray:
        """Finds the bodies that overlap boxes.

        Returns `rows, ids` as `BVH.query`, or the ids for one box. With `mask`,
        finds only the bodies whose category has one of its bits.

        >>> import halfspace as hs
        >>> bodies = hs.BroadPhase(10, dimensions=2)
        >>> bodies.insert([3, 4], [[0, 0, 1, 1], [2, 2, 3, 3]], categories=[1, 2])
        >>> sorted(bodies.query([0, 0, 2, 2]).tolist())
        [3, 4]
        >>> bodies.query([0, 0, 2, 2], mask=2)
        array([4])
        """
        if type(boxes) is np.ndarray and boxes.ndim == 1:
            ids = self._bodies.query_one(boxes, _arrays.mask(mask))
            if ids is not None:
                return ids
        return self._query(self._boxes(boxes), mask, threads)

    def query_sphere(
        self,
        centers: Any,
        radii: Any,
        mask: Optional[int] = None,
        *,
        threads: Optional[int] = 1,
    ) -> np.ndarray:
        """Finds the bodies that spheres touch.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or
        one for each center. float64 spheres are enclosed. Results are those of
        `query`.
        """
        return self._query(_arrays.spheres(centers, radii, self.dims), mask, threads)

    def raycast(
        self,
        origins: Any,
        directions: Any,
        max_t: Any = float("inf"),
        mask: Optional[int] = None,
        *,
        threads: Optional[int] = 1,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each ray enters.

        Arguments and results are those of `BVH.raycast`, and `mask` is that of
        `query`.
        """
        starts = _arrays.points(origins, "origins", self.dims)
        return self._cast(starts, "origins", directions, max_t, mask, threads)

    def boxcast(
        self,
        boxes: Any,
        directions: Any,
        max_t: Any = float("inf"),
        mask: Optional[int] = None,
        *,
        threads: Optional[int] = 1,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each box touches on its way.

        A box moves by t times its direction. The rest is as in `raycast`.

        >>> import halfspace as hs
        >>> bodies = hs.BroadPhase(10, dimensions=2)
        >>> bodies.insert([3, 4], [[5, 1, 6, 2], [8, 0, 9, 1]])
        >>> bodies.boxcast([0, 0, 1, 1.5], [1, 0])
        (3, 4.0)
        """
        starts = _arrays.boxes(boxes, "boxes", self.dims)
        return self._cast(starts, "boxes", directions, max_t, mask, threads)

    def spherecast(
        self,
        centers: Any,
        radii: Any,
        directions: Any,
        max_t: Any = float("inf"),
        mask: Optional[int] = None,
        *,
        threads: Optional[int] = 1,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each sphere touches on its way.

        Spheres are those of `query_sphere`. The rest is as in `boxcast`.
        """
        starts = _arrays.spheres(centers, radii, self.dims)
        return self._cast(starts, "centers", directions, max_t, mask, threads)

    def pairs_of(
        self, ids: Any, margin: float = 0.0, masks: Any = None
    ) -> np.ndarray:
        """Finds the pairs of a body of the set and any other body.

        Returns an array of int64 with the shape (n, 2), whose first column is
        of the set. The boxes of a pair are at most `margin` apart on each axis,
        and the category of each has a bit of the other's `collides_with`. A
        pair of two bodies of the set is found once. A margin that is no float32
        is rounded up.

        `masks` replaces the rule of categories. It is one integer, or one for
        each id: a body of the set is paired with the bodies whose category has
        a bit of its mask. If both are in the set, the mask of either is enough.
        """
        wanted = _arrays.ids(ids, "ids")
        pairs = self._bodies.pairs_of(
            wanted, _margin(margin), _arrays.masks_of_each(masks, len(wanted))
        )
        return pairs.astype(np.int64)

    def update_pairs(
        self, *, threads: Optional[int] = 1
    ) -> Tuple[np.ndarray, np.ndarray]:
        """Finds all pairs, and returns what has changed since the last call.

        Returns
        -------
        began, ended : ndarray of int64, shape (n, 2)
            The pairs that are new, and those that are none any more, with `a <
            b`, and sorted. The bodies of a pair overlap, and the category of
            each has a bit of the other's `collides_with`.
        """
        began, ended = self._bodies.update_pairs(_arrays.threads(threads))
        return began.astype(np.int64), ended.astype(np.int64)

    def get(self, ids: Any) -> np.ndarray:
        """Returns the boxes of bodies: float32, shape (n, 2 d).

        With the kind "aabo" they are octahedra, of shape (n, 2 d + 2).
        """
        return self._bodies.get(_arrays.ids(ids, "ids"), False)[0]

    def masks(self, ids: Any) -> Tuple[np.ndarray, np.ndarray]:
        """Returns `categories, collides_with` of bodies: uint64, shape (n,)."""
        masks = self._bodies.get(_arrays.ids(ids, "ids"), True)[1]
        return masks[:, 0], masks[:, 1]

    def statistics(self) -> Dict[str, Any]:
        """Returns numbers about the tree and its memory.

        `bodies`; `pending`, those that are not in the tree yet; `pairs` of the
        last `update_pairs`; `trees` in memory; all `bytes`; and `cost_ratio`, 1
        as sorted, and 2 if queries visit up to twice as many leaves.
        """
        return self._bodies.statistics()

    def validate(self) -> bool:
        """Returns whether the tree has every body once and encloses it.

        For tests and bug reports. It must not run at the same time as `move`.
        """
        return bool(self._bodies.validate())

    def __len__(self) -> int:
        """The number of bodies."""
        return self._bodies.size()

    def __contains__(self, id: Any) -> bool:
        """Whether a body has this id."""
        return 0 <= id < self._max_ids and id == int(id) and self._bodies.has(int(id))

    @property
    def dims(self) -> int:
        """The number of dimensions, 2 or 3."""
        return self._dims

    @property
    def max_ids(self) -> int:
        """Ids are below this."""
        return self._max_ids

    @property
    def bounds(self) -> np.ndarray:
        """A box around all bodies: float32, shape (2 d,).

        It is larger by the margin or more, and encloses where bodies were since the
        last `update`. With the kind "aabo" it is an octahedron.
        """
        return self._bodies.bounds()

    def __repr__(self) -> str:
        return f"<halfspace.BroadPhase: {len(self)} bodies in {self.dims} dimensions>"

    def _query(
        self, table: _arrays.Table, mask: Optional[int], threads: Optional[int]
    ) -> np.ndarray:
        found = self._bodies.query(
            table.arrays, _arrays.mask(mask), _arrays.threads(threads)
        )
        return found[1] if table.single else found

    def _cast(
        self,
        starts: _arrays.Table,
        name: str,
        directions: Any,
        max_t: Any,
        mask: Optional[int],
        threads: Optional[int],
    ) -> Tuple[Any, Any]:
        arrays, motions, single = _arrays.casts(
            starts, name, directions, max_t, self.dims
        )
        if starts.columns != 2 * self.dims:  # boxes are rounded outward later
            arrays = _arrays.floats(arrays)
        ids, t = self._bodies.cast(
            arrays, _arrays.floats(motions), _arrays.mask(mask), _arrays.threads(threads)
        )
        return (int(ids[0, 0]), float(t[0, 0])) if single else (ids[:, 0], t[:, 0])

    def _boxes(self, value: Any) -> _arrays.Table:
        table = _arrays.boxes(value, "boxes", self.dims, axes=self._axes)
        if table.columns == 2 * self._axes:
            return table
        return table._replace(arrays=(self._bodies.octahedra(table.arrays),))

    def _rows(self, ids: Any, boxes: Any) -> Tuple[_arrays.Table, np.ndarray]:
        table, wanted = self._boxes(boxes), _arrays.ids(ids, "ids")
        if len(wanted) != table.length:
            raise ValueError(
                f"ids: expected one id for each of {table.length} boxes, got {len(wanted)}"
            )
        return table, wanted


def _margin(value: Any) -> float:
    margin = _arrays.not_negative(value, "margin")
    if margin > _arrays.MOST_FLOAT:
        raise ValueError(f"margin: expected a finite float32, got {margin}")
    return _arrays.round_up(margin)
