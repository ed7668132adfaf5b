"""The broad phase."""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple, Type

import numpy as np

from . import _arrays, _halfspace
from ._searches import Searches


class BroadPhase(Searches):
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
    moves_are_seen_at_once : bool
        By default, queries see moves from the next `update`, `update_pairs`,
        `rebuild`, `save` or `copy` on. If True, a query sees each `move` that
        returned before it began, and is slower while other threads move bodies.

    Notes
    -----
    Boxes are arrays as in `BVH`, with the same rounding and errors. Methods that
    change bodies raise ValueError with the row of a wrong id, and change nothing
    then. Memory grows with the greatest id.

    The searches are those of `BVH`. With `mask`, they find only the bodies whose
    category has one of its bits.

    Every call releases the interpreter's lock. Threads can query and move
    bodies at the same time, without any other lock. Two calls that change the
    same body must not run at the same time. `insert`, `erase`, `set_masks`,
    `update`, `rebuild`, `update_pairs`, `save`, `load`, `copy` and `statistics`
    wait until no query runs.

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

    __slots__ = ("_tree", "_axes", "_at_once", "__weakref__")

    def __init__(self, dimensions: int = 3, kind: str = "aabb", *,
                 moves_are_seen_at_once: bool = False) -> None:
        if dimensions not in (2, 3):
            raise ValueError(f"dimensions: expected 2 or 3, got {dimensions!r}")
        if kind not in ("aabb", "aabo"):
            raise ValueError(f'kind: expected "aabb" or "aabo", got {kind!r}')
        self._axes = int(dimensions) + (kind == "aabo")
        self._at_once = bool(moves_are_seen_at_once)
        self._tree = _halfspace.BroadPhase(int(dimensions), kind == "aabo", self._at_once)

    def insert(self, ids: Any, boxes: Any, categories: Any = None,
               collides_with: Any = None) -> None:
        """Adds bodies. Box i is that of body `ids[i]`.

        `categories` and `collides_with` are masks of 32 bits: one integer, or
        one for each id. Without them they have all bits. Insert many bodies by
        one call. Until the next `update_pairs`, a new body under the id of an
        erased one continues its pairs.
        """
        arrays, wanted = self._rows(ids, boxes)
        masks = _masks(categories, collides_with, len(wanted))
        self._tree.insert(wanted, arrays, masks)

    def erase(self, ids: Any) -> None:
        """Removes bodies. An id that is given twice is removed once."""
        self._tree.erase(_arrays.ids(ids, "ids"))

    def move(self, ids: Any, boxes: Any) -> None:
        """Changes the boxes of bodies. If an id is given twice, the last counts."""
        arrays, wanted = self._rows(ids, boxes)
        self._tree.move(wanted, arrays)

    def set_masks(self, ids: Any, categories: Any, collides_with: Any) -> None:
        """Changes the masks of bodies, which are those of `insert`."""
        wanted = _arrays.ids(ids, "ids")
        masks = _masks(categories, collides_with, len(wanted))
        self._tree.set_masks(wanted, masks)

    def update(self, budget: Optional[int] = None, *, threads: Optional[int] = 1) -> None:
        """Updates the tree. Call it once per frame.

        Copies the boxes that moved into the tree, and sorts bodies again where
        the order has decayed. It changes no result. `budget` is about how many
        bodies are sorted again. 0 sorts none. None is a 16th of all, or all if
        bodies are so fast that parts do not keep up.
        """
        self._tree.update(_arrays.budget(budget), _arrays.threads(threads))

    def rebuild(self, *, threads: Optional[int] = 1) -> None:
        """As `update`, but sorts all bodies again."""
        self._tree.rebuild(0, _arrays.threads(threads))

    def update_pairs(self, *, threads: Optional[int] = 1) -> Tuple[np.ndarray, np.ndarray]:
        """Finds all pairs, and returns what has changed since the last call.

        Returns `began, ended`: the pairs that are new, and those that are none any
        more, as arrays of int64 with the shape (n, 2), with `a < b`, and sorted. The
        bodies of a pair overlap, and the category of each has a bit of the other's
        `collides_with`.
        """
        return self._tree.update_pairs(_arrays.threads(threads))

    def pairs(self) -> np.ndarray:
        """Returns all pairs of the last `update_pairs`, in any order."""
        return self._tree.pairs()

    def copy(self) -> "BroadPhase":
        """Returns a copy, which gives the same results after the same calls."""
        copy = type(self).__new__(type(self))
        copy._axes, copy._at_once = self._axes, self._at_once
        copy._tree = self._tree.copy()
        return copy

    __copy__ = copy

    def save(self) -> bytes:
        """Returns all bodies, masks and pairs as bytes, for `load`."""
        return self._tree.save()

    def load(self, data: Any) -> None:
        """Replaces the bodies, masks and pairs by those of `save`.

        From then on, results and pairs are those that the saved broad phase
        would have given, in the same order. Raises ValueError, and changes
        nothing, if the bytes are of another kind, or were cut.
        """
        self._tree.load(np.frombuffer(data, np.uint8))

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        kind = "aabo" if self._axes > self.dims else "aabb"
        arguments = (type(self), self.dims, kind, self._at_once, self.save())
        return _unpickle, arguments, getattr(self, "__dict__", None)

    def get(self, ids: Any) -> np.ndarray:
        """Returns the boxes of bodies: float32, shape (n, 2 d).

        With the kind "aabo" they are octahedra, of shape (n, 2 d + 2).
        """
        return self._tree.get(_arrays.ids(ids, "ids"), False)[0]

    def masks(self, ids: Any) -> Tuple[np.ndarray, np.ndarray]:
        """Returns `categories, collides_with` of bodies: uint32, shape (n,)."""
        masks = self._tree.get(_arrays.ids(ids, "ids"), True)[1]
        return masks[:, 0], masks[:, 1]

    def statistics(self) -> Dict[str, Any]:
        """Returns numbers about the tree and its memory.

        `bodies`; `pairs` of the last `update_pairs`; all `bytes`; and
        `cost_ratio`, 1 as sorted, and 2 if queries visit up to twice as many
        leaves.
        """
        return self._tree.statistics()

    def validate(self) -> bool:
        """Returns whether the tree has every body once, with its box.

        For tests and bug reports. It must not run at the same time as `move`.
        """
        return bool(self._tree.validate())

    def __contains__(self, id: Any) -> bool:
        """Whether a body has this id."""
        return 0 <= id < 2**31 and id == int(id) and self._tree.has(int(id))

    @property
    def id_limit(self) -> int:
        """The length of an array by id."""
        return self._tree.id_limit()

    @property
    def bounds(self) -> np.ndarray:
        """The box around all bodies: float32, shape (2 d,).

        With the kind "aabo" it is an octahedron.
        """
        return self._tree.bounds()

    def __repr__(self) -> str:
        return f"<halfspace.BroadPhase: {len(self)} bodies in {self.dims} dimensions>"

    def _boxes(self, value: Any) -> _arrays.Table:
        table = _arrays.boxes(value, "boxes", self.dims, axes=self._axes)
        if table.columns == 2 * self._axes:
            return table
        return table._replace(arrays=(self._tree.octahedra(table.arrays),))


def _masks(categories: Any, collides_with: Any, count: int) -> np.ndarray:
    table: np.ndarray = np.full((count, 2), _arrays.ALL_MASKS, np.uint32)
    if categories is not None:
        table[:, 0] = _arrays.masks(categories, "categories", count)
    if collides_with is not None:
        table[:, 1] = _arrays.masks(collides_with, "collides_with", count)
    return table


def _unpickle(cls: Type[BroadPhase], dims: int, kind: str, at_once: bool,
              data: bytes) -> BroadPhase:
    bodies = cls.__new__(cls)
    BroadPhase.__init__(bodies, dims, kind, moves_are_seen_at_once=at_once)
    bodies.load(data)
    return bodies
