"""The broad phase."""

from __future__ import annotations

from typing import Any, Callable, Dict, Optional, Tuple, Type, Union

import numpy as np

from . import _arrays, _halfspace

Progress = Callable[[int, int], object]


class BroadPhase:
    """The boxes of the moving bodies of a simulation.

    Ids are the caller's numbers below 2^31, such as the row of a body in an
    array. Boxes that touch overlap. Results are exact.

    Parameters
    ----------
    dimensions : 2 or 3
    kind : "aabb" or "aabo"
        "aabo" bounds bodies by octahedra (8-DOPs), which have one more axis, `D
        = -(x + y + z)`. A bound has the minima of all axes, then the maxima.
        Boxes are allowed as well.
    moves_wait_for_update : bool
        By default, a query sees each `move` that returned before the query
        began. If True, queries see moves from the next `update`,
        `update_pairs`, `rebuild`, `save` or `copy` on. They are then faster
        while other threads move bodies.

    Notes
    -----
    Boxes are arrays as in `BVH`: float32, or float64, which is rounded outward.
    A NaN, or a minimum above a maximum, raises ValueError, and masked values raise
    TypeError. Methods that change bodies raise ValueError with the row of a wrong
    id, and change nothing then. Memory grows with the greatest id.

    `query`, `count`, `any`, `nearest` and `raycast` have the arguments and the
    results of those of `BVH`, and `mask`: with it, they find only the bodies
    whose category has one of its bits.

    Every call releases the interpreter's lock. Threads can query and move
    bodies at the same time, without any other lock. Two calls that change the
    same body must not run at the same time. A query sees each body with a box
    that it had during the query. `insert`, `erase`, `set_masks`, `update`,
    `rebuild`, `update_pairs`, `save`, `load`, `copy` and `statistics` wait until
    no query runs.

    Examples
    --------
    >>> import halfspace as hs
    >>> bodies = hs.BroadPhase(dimensions=2)
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

    __slots__ = ("_bodies", "_dims", "_axes", "_waits", "__weakref__")

    def __init__(
        self,
        dimensions: int = 3,
        kind: str = "aabb",
        *,
        moves_wait_for_update: bool = False,
    ) -> None:
        if dimensions not in (2, 3):
            raise ValueError(f"dimensions: expected 2 or 3, got {dimensions!r}")
        if kind not in ("aabb", "aabo"):
            raise ValueError(f'kind: expected "aabb" or "aabo", got {kind!r}')
        self._dims = int(dimensions)
        self._axes = self._dims + (kind == "aabo")
        self._waits = bool(moves_wait_for_update)
        self._bodies = _halfspace.BroadPhase(self._dims, kind == "aabo", self._waits)

    def insert(
        self, ids: Any, boxes: Any, categories: Any = None, collides_with: Any = None
    ) -> None:
        """Adds bodies. Box i is that of body `ids[i]`.

        `categories` and `collides_with` are masks of 32 bits: one integer, or
        one for each id. Without them they have all bits. Insert many bodies by
        one call. Until the next `update_pairs`, a new body under the id of an
        erased one continues its pairs.
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

        Copies the boxes that moved into the tree, and sorts bodies again where
        the order has decayed. It changes no result. `budget` is about how many
        bodies are sorted again. 0 sorts none. None is a 16th of all.
        """
        self._bodies.update(_arrays.budget(budget), _arrays.threads(threads))

    def rebuild(self, *, threads: Optional[int] = 1) -> None:
        """As `update`, but sorts all bodies again."""
        self._bodies.rebuild(0, _arrays.threads(threads))

    def query(
        self,
        boxes: Any,
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> np.ndarray:
        """Finds the bodies that overlap boxes.

        Returns `rows, ids` as `BVH.query`, or the ids for one box.

        >>> import halfspace as hs
        >>> bodies = hs.BroadPhase(dimensions=2)
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
        return self._query(self._boxes(boxes), mask, threads, progress)

    def query_sphere(
        self,
        centers: Any,
        radii: Any,
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> np.ndarray:
        """Finds the bodies that spheres touch.

        `centers` has the shape (m, d) or (d,), and `radii` is one number, or
        one for each center. float64 spheres are enclosed. Results are those of
        `query`.
        """
        spheres = _arrays.spheres(centers, radii, self.dims)
        return self._query(spheres, mask, threads, progress)

    def count(
        self,
        boxes: Any,
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Union[np.ndarray, int]:
        """Counts the bodies that overlap each box, as `BVH.count`."""
        table = self._boxes(boxes)
        counts = self._bodies.count(
            table.arrays, _arrays.mask(mask), _arrays.threads(threads), progress
        )
        return int(counts[0, 0]) if table.single else counts[:, 0].astype(np.int64)

    def any(
        self,
        boxes: Any,
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Union[np.ndarray, bool]:
        """Returns for each box whether a body overlaps it, as `BVH.any`."""
        table = self._boxes(boxes)
        ids = self._bodies.any(
            table.arrays, _arrays.mask(mask), _arrays.threads(threads), progress
        )
        if table.single:
            return int(ids[0, 0]) != _arrays.NO_ID
        return ids[:, 0] != _arrays.NO_ID

    def nearest(
        self,
        points: Any,
        k: int = 1,
        *,
        max_distance: float = float("inf"),
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[np.ndarray, np.ndarray]:
        """Finds the k bodies that are nearest to each point or box.

        Arguments and results are those of `BVH.nearest`. Call `update` before
        it where other threads move bodies and query: otherwise each search can
        copy the tree.
        """
        table = _arrays.points_or_boxes(points, "points", self.dims)
        count = _arrays.positive(k, "k")
        limit = _arrays.round_up(_arrays.not_negative(max_distance, "max_distance"))
        ids, distances = self._bodies.nearest(
            table.arrays, count, limit, _arrays.mask(mask), _arrays.threads(threads), progress
        )
        return (ids[0], distances[0]) if table.single else (ids, distances)

    def raycast(
        self,
        origins: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each ray enters, as `BVH.raycast`."""
        starts = _arrays.points(origins, "origins", self.dims)
        return self._cast(starts, "origins", directions, max_t, mask, threads, progress)

    def boxcast(
        self,
        boxes: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each box touches on its way.

        A box moves by t times its direction. The rest is as in `raycast`.

        >>> import halfspace as hs
        >>> bodies = hs.BroadPhase(dimensions=2)
        >>> bodies.insert([3, 4], [[5, 1, 6, 2], [8, 0, 9, 1]])
        >>> bodies.boxcast([0, 0, 1, 1.5], [1, 0])
        (3, 4.0)
        """
        starts = _arrays.boxes(boxes, "boxes", self.dims)
        return self._cast(starts, "boxes", directions, max_t, mask, threads, progress)

    def spherecast(
        self,
        centers: Any,
        radii: Any,
        directions: Any,
        max_t: Any = float("inf"),
        *,
        mask: Optional[int] = None,
        threads: Optional[int] = 1,
        progress: Optional[Progress] = None,
    ) -> Tuple[Any, Any]:
        """Finds the first body that each sphere touches on its way.

        Spheres are those of `query_sphere`. The rest is as in `boxcast`.
        """
        starts = _arrays.spheres(centers, radii, self.dims)
        return self._cast(starts, "centers", directions, max_t, mask, threads, progress)

    def pairs_of(
        self,
        ids: Any,
        *,
        margin: float = 0.0,
        mask: Optional[int] = None,
        wanted: Any = None,
    ) -> np.ndarray:
        """Finds the pairs of a body of the set and any other body.

        Returns an array of int64 with the shape (n, 2), whose first column is
        of the set. The boxes of a pair are at most `margin` apart on each axis.
        A pair of two bodies of the set is found once. A margin that is no
        float32 is rounded up. `collides_with` is not read.

        With `mask`, the categories of both bodies have one of its bits.
        `wanted` is a mask, or one for each id: a body of the set is paired with
        the bodies whose category has a bit of it. If both are in the set, the
        mask of either is enough.
        """
        chosen = _arrays.ids(ids, "ids")
        distance = _arrays.not_negative(margin, "margin")
        if distance > _arrays.MOST_FLOAT:
            raise ValueError(f"margin: expected a finite float32, got {distance}")
        return self._bodies.pairs_of(
            chosen,
            _arrays.round_up(distance),
            _arrays.mask(mask),
            _arrays.masks_of_each(wanted, "wanted", len(chosen)),
        )

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
        return self._bodies.update_pairs(_arrays.threads(threads))

    def pairs(self) -> np.ndarray:
        """Returns all pairs of the last `update_pairs`, in any order."""
        return self._bodies.pairs()

    def copy(self) -> "BroadPhase":
        """Returns a copy, which gives the same results after the same calls."""
        copy = type(self).__new__(type(self))
        copy._dims, copy._axes, copy._waits = self._dims, self._axes, self._waits
        copy._bodies = self._bodies.copy()
        return copy

    __copy__ = copy

    def save(self) -> bytes:
        """Returns all bodies, masks and pairs as bytes, for `load`.

        >>> import halfspace as hs
        >>> bodies = hs.BroadPhase(dimensions=2)
        >>> bodies.insert([3, 4], [[0, 0, 1, 1], [2, 2, 3, 3]])
        >>> state = bodies.save()
        >>> bodies.erase(3)
        >>> bodies.load(state)
        >>> 3 in bodies
        True
        """
        return self._bodies.save()

    def load(self, data: Any) -> None:
        """Replaces the bodies, masks and pairs by those of `save`.

        From then on, results and pairs are those that the saved broad phase
        would have given, in the same order. Raises ValueError, and changes
        nothing, if the bytes are of another kind, or were cut.
        """
        self._bodies.load(np.frombuffer(data, np.uint8))

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        kind = "aabo" if self._axes > self._dims else "aabb"
        arguments = (type(self), self._dims, kind, self._waits, self.save())
        return _unpickle, arguments, getattr(self, "__dict__", None)

    def get(self, ids: Any) -> np.ndarray:
        """Returns the boxes of bodies: float32, shape (n, 2 d).

        With the kind "aabo" they are octahedra, of shape (n, 2 d + 2).
        """
        return self._bodies.get(_arrays.ids(ids, "ids"), False)[0]

    def masks(self, ids: Any) -> Tuple[np.ndarray, np.ndarray]:
        """Returns `categories, collides_with` of bodies: uint32, shape (n,)."""
        masks = self._bodies.get(_arrays.ids(ids, "ids"), True)[1]
        return masks[:, 0], masks[:, 1]

    def statistics(self) -> Dict[str, Any]:
        """Returns numbers about the tree and its memory.

        `bodies`; `pairs` of the last `update_pairs`; all `bytes`; and
        `cost_ratio`, 1 as sorted, and 2 if queries visit up to twice as many
        leaves.
        """
        return self._bodies.statistics()

    def validate(self) -> bool:
        """Returns whether the tree has every body once, with its box.

        For tests and bug reports. It must not run at the same time as `move`.
        """
        return bool(self._bodies.validate())

    def __len__(self) -> int:
        """The number of bodies."""
        return self._bodies.size()

    def __contains__(self, id: Any) -> bool:
        """Whether a body has this id."""
        return 0 <= id < 2**31 and id == int(id) and self._bodies.has(int(id))

    @property
    def dims(self) -> int:
        """The number of dimensions, 2 or 3."""
        return self._dims

    @property
    def id_limit(self) -> int:
        """The length of an array by id."""
        return self._bodies.id_limit()

    @property
    def bounds(self) -> np.ndarray:
        """The box around all bodies: float32, shape (2 d,).

        With the kind "aabo" it is an octahedron.
        """
        return self._bodies.bounds()

    def __repr__(self) -> str:
        return f"<halfspace.BroadPhase: {len(self)} bodies in {self.dims} dimensions>"

    def _query(
        self,
        table: _arrays.Table,
        mask: Optional[int],
        threads: Optional[int],
        progress: Optional[Progress],
    ) -> np.ndarray:
        found = self._bodies.query(
            table.arrays, _arrays.mask(mask), _arrays.threads(threads), progress
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
        progress: Optional[Progress],
    ) -> Tuple[Any, Any]:
        arrays, motions, single = _arrays.casts(
            starts, name, directions, max_t, self.dims
        )
        ids, t = self._bodies.cast(
            arrays, motions, _arrays.mask(mask), _arrays.threads(threads), progress
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


def _unpickle(
    cls: Type[BroadPhase], dims: int, kind: str, waits: bool, data: bytes
) -> BroadPhase:
    bodies = cls.__new__(cls)
    BroadPhase.__init__(bodies, dims, kind, moves_wait_for_update=waits)
    bodies.load(data)
    return bodies
