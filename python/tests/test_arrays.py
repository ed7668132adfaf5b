"""What boxes, points and ids can be, and the errors of those that are wrong."""

import ctypes
import re
import sys

import halfspace as hs
import numpy as np
import pytest

from conftest import overlaps, random_boxes

BOXES = random_boxes(np.random.default_rng(2), 300, 3)


def swapped(a):
    return a.astype(a.dtype.newbyteorder())


def misaligned(a):
    data = np.empty(a.nbytes + 1, np.uint8)[1:]
    copy = data.view(a.dtype).reshape(a.shape)
    copy[:] = a
    assert not copy.flags.aligned
    return copy


def in_wide_rows(a):
    wide = np.zeros((len(a), 2 * a.shape[1] + 1), a.dtype)
    wide[:, 1:-1:2] = a
    return wide[:, 1:-1:2]


def in_records(a):
    """A stride that is no multiple of the size of a number."""
    records = np.zeros(len(a), [("box", a.dtype, 6), ("byte", np.uint8)])
    records["box"] = a
    return records["box"]


def read_only(a):
    a = a.copy()
    a.flags.writeable = False
    return a


class Interface:
    def __init__(self, a):
        self.array = a
        self.__array_interface__ = a.__array_interface__


LAYOUTS = {
    "rows": lambda a: a,
    "columns": np.asfortranarray,
    "every second row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "wide rows": in_wide_rows,
    "records": in_records,
    "misaligned": misaligned,
    "swapped bytes": swapped,
    "read only": read_only,
    "backwards": lambda a: a[::-1].copy()[::-1],
    "columns backwards": lambda a: a[:, ::-1].copy()[:, ::-1],
    "float64": lambda a: a.astype(np.float64),
    "a list": lambda a: a.tolist(),
    "an interface": Interface,
    "a tuple of interfaces": lambda a: tuple(Interface(c.copy()) for c in a.T),
    "a pair": lambda a: (a[:, :3], a[:, 3:]),
    "a pair of copies": lambda a: [a[:, :3].copy(), a[:, 3:].copy()],
    "a pair of two strides": lambda a: (a[:, :3], a[:, 3:].copy()),
    "a pair of two types": lambda a: (a[:, :3], a[:, 3:].astype(float)),
    "a tuple of columns": lambda a: tuple(a.T),
    "a tuple of copies": lambda a: tuple(c.copy() for c in a.T),
    "Arrow": lambda a: [ArrowColumn(c.copy()) for c in a.T],
    "Arrow doubles": lambda a: [ArrowColumn(c.astype(float)) for c in a.T],
    "Arrow with an offset": lambda a: tuple(ArrowColumn(c.copy(), 7) for c in a.T),
    "Arrow without nulls": lambda a: [ArrowColumn(c.copy(), 3, [-1]) for c in a.T],
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout):
    value = LAYOUTS[layout](BOXES)
    expected = bytes(hs.BVH(BOXES).blob())
    assert bytes(hs.BVH(value).blob()) == expected
    found = hs.BVH(BOXES).query(value)
    assert (found == hs.BVH(BOXES).query(BOXES)).all()
    assert (hs.Scan(value).mask(value) == overlaps(BOXES, BOXES)).all()


@pytest.mark.parametrize(
    "dtype", [np.float16, np.int8, np.uint16, np.int32, np.uint64, np.int64]
)
def test_types(dtype):
    boxes = np.array([[0, 0, 1, 1], [2, 2, 4, 4]], dtype)
    tree = hs.BVH(boxes)
    assert tree.query(np.array([1, 1, 2, 2], dtype)).tolist() == [0, 1]
    assert tree.query(np.array([5, 5, 6, 6], dtype)).tolist() == []


def test_integers_are_rounded_outward():
    edge = 2**24 + 1  # not a float
    tree = hs.BVH(np.array([[0, 0, edge, edge]]))
    assert tree.query(np.array([edge, 0, edge + 2, 1])).tolist() == [0]


@pytest.mark.parametrize("value", [BOXES, BOXES.astype(np.float64)])
def test_arrays_are_read_in_place(value):
    from halfspace import _arrays

    for boxes in (value, np.asfortranarray(value), (value[:, :3], value[:, 3:])):
        for a in _arrays.boxes(boxes, "boxes").arrays:
            assert np.shares_memory(a, value) or not a.flags.c_contiguous


class ArrowSchema(ctypes.Structure):
    _fields_ = [
        ("format", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("metadata", ctypes.c_char_p),
        ("flags", ctypes.c_int64),
        ("n_children", ctypes.c_int64),
        ("children", ctypes.c_void_p),
        ("dictionary", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        ("private_data", ctypes.c_void_p),
    ]


class ArrowArray(ctypes.Structure):
    _fields_ = [
        ("length", ctypes.c_int64),
        ("null_count", ctypes.c_int64),
        ("offset", ctypes.c_int64),
        ("n_buffers", ctypes.c_int64),
        ("n_children", ctypes.c_int64),
        ("buffers", ctypes.POINTER(ctypes.c_void_p)),
        ("children", ctypes.c_void_p),
        ("dictionary", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        ("private_data", ctypes.c_void_p),
    ]


new_capsule = ctypes.pythonapi.PyCapsule_New
new_capsule.restype = ctypes.py_object
new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


class ArrowColumn:
    """A producer of the Arrow C data interface.

    `nulls` are rows that are null. -1 stands for none, with a bitmap.
    """

    def __init__(self, values, offset=0, nulls=(), format=None):
        self.format = format or {4: b"f", 8: b"g"}[values.itemsize]
        self.values = np.concatenate([values[:1].repeat(offset), values])
        present = np.ones(len(self.values) + 8, bool)
        for row in nulls:
            if row >= 0:
                present[offset + row] = False
        self.bitmap = np.packbits(present, bitorder="little") if nulls else None
        self.length, self.offset = len(values), offset
        self.is_released = False

    def __arrow_c_array__(self, requested_schema=None):
        assert requested_schema is None
        self.schema = ArrowSchema(format=self.format, release=1)
        self.buffers = (ctypes.c_void_p * 2)(
            None if self.bitmap is None else self.bitmap.ctypes.data,
            self.values.ctypes.data,
        )
        self.array = ArrowArray(
            length=self.length,
            null_count=0 if self.bitmap is None else -1,
            offset=self.offset,
            n_buffers=2,
            buffers=self.buffers,
            release=0 if self.is_released else 1,
        )

        self.capsules = (
            new_capsule(ctypes.addressof(self.schema), b"arrow_schema", None),
            new_capsule(ctypes.addressof(self.array), b"arrow_array", None),
        )
        return self.capsules


def check_released(column):
    """The tree holds none of the capsules that the column made."""
    for capsule in column.capsules:
        # The tuple's, the loop's and the argument's.
        assert sys.getrefcount(capsule) == 3


def test_arrow_arrays_are_released():
    columns = [ArrowColumn(c.copy()) for c in BOXES.T]
    tree = hs.BVH(columns)
    for column in columns:
        check_released(column)
    assert len(tree) == len(BOXES)


def test_arrow_errors():
    good = [ArrowColumn(c.copy()) for c in BOXES.T]

    def check(bad, error, message):
        with pytest.raises(error, match=re.escape(message)):
            hs.BVH(good[:2] + [bad] + good[3:])
        check_released(bad)
        check_released(good[0])

    column = BOXES[:, 2].copy()
    check(
        ArrowColumn(column, 5, [3]),
        ValueError,
        "boxes[2]: expected numbers, got a null in row 3",
    )
    check(
        ArrowColumn(column, format=b"i"),
        TypeError,
        'boxes[2]: expected an Arrow array of float or double, got the Arrow format "i"',
    )
    check(
        ArrowColumn(column[1:]),
        ValueError,
        "boxes: expected columns of the same length, got lengths [300, 300, 299",
    )
    released = ArrowColumn(column)
    released.is_released = True
    check(released, ValueError, "boxes[2]: expected an Arrow array, got one that was rel")


NAN = float("nan")
INF = float("inf")
BAD_BOXES = [
    ([[0, 0, NAN, 1]], ValueError, "boxes[0]: expected numbers, got NaN in [0.0, 0.0,"),
    (
        np.array([[0, 0, 1, 1], [0, 2, 1, 1]], np.float32),
        ValueError,
        "boxes[1]: expected min <= max, got min 2.0 > max 1.0 on axis 1 of [0.0, 2.0,",
    ),
    ([0, 0, -1, 1], ValueError, "boxes: expected min <= max, got min 0.0 > max -1.0 on"),
    # Empty on one axis alone.
    ([[INF, 0, -INF, 1]], ValueError, "boxes[0]: expected min <= max, got min inf >"),
    ([[0, 0, 1]], ValueError, "boxes: expected boxes of shape (n, 6), (n, 4)"),
    ([], ValueError, "boxes: expected boxes of shape (n, 6), (n, 4)"),
    (np.zeros((2, 2, 6)), ValueError, "boxes: expected boxes of shape (n, 6), (n, 4)"),
    (3, ValueError, "boxes: expected boxes of shape (n, 6), (n, 4)"),
    ([[0, 0, 1, 1], [0, 0, 1]], ValueError, "boxes: expected an array of numbers"),
    (np.zeros((1, 4), complex), TypeError, "boxes: expected float32, float64 or integ"),
    (np.zeros((1, 4), bool), TypeError, "boxes: expected float32, float64 or integers"),
    (np.zeros((1, 4), np.longdouble), TypeError, "boxes: expected float32, float64 or"),
    ("text", (TypeError, ValueError), "boxes: expected"),
    (None, TypeError, "boxes: expected an array of numbers, got NoneType"),
    ([[2**60, 0, 2**60, 1]], ValueError, "boxes: expected integers between -2^53 and"),
    (
        (np.zeros((2, 3)), np.zeros((3, 3))),
        ValueError,
        "boxes: expected minima and maxima of the same shape, got (2, 3) and (3, 3)",
    ),
    ((np.zeros((2, 4)), np.zeros((2, 4))), ValueError, "boxes: expected boxes of shape"),
    (
        np.broadcast_to(np.float32(0), (2**31, 6)),
        ValueError,
        "boxes: expected fewer than 2^31 boxes, got 2147483648",
    ),
]


@pytest.mark.parametrize("value, error, message", BAD_BOXES)
@pytest.mark.parametrize("kind", [hs.BVH, hs.Scan])
def test_bad_boxes(kind, value, error, message):
    with pytest.raises(error) as raised:
        kind(value)
    assert str(raised.value).startswith(message)


TREE = hs.BVH([[0, 0, 1, 1], [2, 2, 3, 3]])
BAD_CALLS = [
    (
        lambda: TREE.query(np.zeros((5, 6))),
        ValueError,
        "boxes: expected boxes of shape (n, 4) or (4,), or two arrays (minima, maxima) "
        "of shape (n, 2), for a tree of 2 dimensions, got shape (5, 6)",
    ),
    (lambda: TREE.count([NAN, 0, 1, 1]), ValueError, "boxes: expected numbers, got NaN"),
    (lambda: TREE.any([[1, 0, 0, 1]]), ValueError, "boxes[0]: expected min <= max"),
    (lambda: TREE.query_batches([0, 0, 1, 1], 0), ValueError, "max_results: expected an"),
    (lambda: TREE.query([0, 0, 1, 1], within=-1), ValueError, "within: expected numbers"),
    (lambda: TREE.query([0, 0, 1, 1], within=NAN), ValueError, "within: expected numbers"),
    (lambda: TREE.query([0, 0, 1, 1], within=[1, 2]), ValueError, "within: expected one nu"),
    (lambda: TREE.query_sphere([0, 0, 1], 1), ValueError, "centers: expected points of sh"),
    (lambda: TREE.query_sphere([0, 0], -1), ValueError, "radii: expected numbers"),
    (lambda: TREE.query([0, 0, 1, 1], threads=0), ValueError, "threads: expected an int"),
    (lambda: TREE.query([0, 0, 1, 1], threads=1.5), TypeError, "threads: expected an in"),
    (lambda: hs.BVH([[0, 0, 1, 1]], quality="x"), ValueError, 'quality: expected "high"'),
    (
        lambda: hs.BVH([[0, 0, 1, 1]], quality=np.array(["fast"])),
        ValueError,
        'quality: expected "high"',
    ),
    (lambda: TREE.nearest([0, 0, 0]), ValueError, "points: expected points of shape (n,"),
    (lambda: TREE.nearest([0, NAN]), ValueError, "points: expected numbers, got NaN"),
    (lambda: TREE.nearest([1, 1, 0, 0]), ValueError, "points: expected min <= max, got"),
    (lambda: TREE.nearest([0, 0], 0), ValueError, "k: expected an integer from 1 to"),
    (lambda: TREE.nearest([0, 0], "2"), TypeError, "k: expected an integer, got str"),
    (
        lambda: TREE.nearest([0, 0], max_distance=-1),
        ValueError,
        "max_distance: expected a number that is not negative, got -1.0",
    ),
    (
        lambda: TREE.raycast([[0, 0]] * 3, [[0, 1]] * 2),
        ValueError,
        "directions: expected as many rows as origins, got 2 and 3",
    ),
    (lambda: TREE.raycast([0, NAN], [0, 1]), ValueError, "origins: expected numbers, got"),
    (lambda: TREE.raycast([0, 0], [[NAN, 1]]), ValueError, "directions[0]: expected num"),
    (lambda: TREE.raycast([0, 0], [0, 1], NAN), ValueError, "max_t: expected numbers th"),
    (lambda: TREE.raycast([0, 0], [0, 1], [1, 1]), ValueError, "max_t: expected one numb"),
    (lambda: TREE.erase(5), ValueError, "ids[0]: expected the id of an object, got 5"),
    (lambda: TREE.erase([0, -1]), ValueError, "ids[1]: expected the id of an object, got -1"),
    (lambda: TREE.erase([0.5]), TypeError, "ids: expected an integer or a one-dimensio"),
    (
        lambda: TREE.refit([[0, 0, 1, 1]]),
        ValueError,
        "boxes: expected 2 boxes, one for each id of the tree, got 1",
    ),
    (lambda: TREE.refit([[0, 0, 1, 1]], [0, 1]), ValueError, "ids: expected one id for"),
    (lambda: TREE.insert([[0, 0, 1, NAN]]), ValueError, "boxes[0]: expected numbers, got"),
    (lambda: hs.BVH(tuple(np.zeros((4, 4)))), ValueError, "boxes: a tuple of 4 arrays of length 4"),
    (lambda: TREE.nearest([0, 0], max_distance=None), TypeError, "max_distance: expected a number"),
    (lambda: TREE.boxes([10**6]), ValueError, "ids: expected ids below"),
    (lambda: hs.join(TREE, [[0, 0, 1, 1]]), TypeError, "b: expected a BVH, got list"),
    (lambda: hs.join(TREE, hs.BVH(BOXES)), ValueError, "b: expected a BVH of 2 dimension"),
]


@pytest.mark.parametrize("call, error, message", BAD_CALLS)
def test_bad_calls(call, error, message):
    before = bytes(TREE.blob())
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert bytes(TREE.blob()) == before


def masked(values):
    return np.ma.array(values, mask=np.ma.ones(np.shape(values)))


class MaskedVariable:
    """Returns a masked array when NumPy asks for an array, as netCDF4 does."""

    def __init__(self, values):
        self.values = masked(values)

    def __array__(self, dtype=None, copy=None):
        return self.values


BODIES = hs.BroadPhase(2)
BODIES.insert([0, 1], [[0, 0, 1, 1]] * 2)
BOX = [0, 0, 1, 1]
TWO = [[0, 0], [1, 1]]
# The argument that is masked, and a call with it.
MASKED = [
    ("boxes", lambda: hs.BVH(masked([BOX]))),
    ("boxes", lambda: hs.BVH(masked(BOX))),
    ("boxes", lambda: hs.BVH((masked(TWO), np.array(TWO)))),
    ("boxes", lambda: hs.BVH((np.array(TWO), masked(TWO)))),
    ("boxes", lambda: hs.BVH([np.array(BOX), masked(BOX)])),
    ("boxes", lambda: hs.BVH([BOX, [0, 0, 1, masked(1)]])),
    ("boxes", lambda: hs.BVH(MaskedVariable([BOX]))),
    ("boxes", lambda: hs.BVH((MaskedVariable(TWO), np.array(TWO)))),
    ("boxes[3]", lambda: hs.BVH((*np.zeros((3, 2)), masked([1, 1])))),
    ("boxes", lambda: hs.Scan(masked([BOX]))),
    ("boxes", lambda: hs.Scan([BOX]).mask(masked(BOX))),
    ("boxes", lambda: TREE.query(masked(BOX))),
    ("boxes", lambda: TREE.query_batches(masked(BOX))),
    ("boxes", lambda: TREE.count(masked(BOX))),
    ("boxes", lambda: TREE.any(masked(BOX))),
    ("boxes", lambda: TREE.insert(masked(BOX))),
    ("boxes", lambda: TREE.refit(masked([BOX] * 2))),
    ("ids", lambda: TREE.refit([BOX], masked([1]))),
    ("ids", lambda: TREE.erase(masked([0, 1]))),
    ("ids", lambda: TREE.erase(np.ma.array([0, 1], mask=[0, 1]))),
    ("ids", lambda: TREE.erase(masked(0))),
    ("ids", lambda: TREE.boxes(masked([0]))),
    ("points", lambda: TREE.nearest(masked([0, 0]))),
    ("points", lambda: TREE.nearest((masked(TWO), np.array(TWO)))),
    ("k", lambda: TREE.nearest([0, 0], masked(1))),
    ("max_distance", lambda: TREE.nearest([0, 0], max_distance=masked(1.0))),
    ("threads", lambda: TREE.pairs(threads=masked(1))),
    ("origins", lambda: TREE.raycast(masked([0, 0]), [1, 0])),
    ("directions", lambda: TREE.raycast([0, 0], masked([1, 0]))),
    ("max_t", lambda: TREE.raycast([0, 0], [1, 0], masked(1))),
    ("ids", lambda: BODIES.insert(masked([2]), [BOX])),
    ("boxes", lambda: BODIES.insert([2], masked([BOX]))),
    ("categories", lambda: BODIES.insert([2], [BOX], masked([1]))),
    ("collides_with", lambda: BODIES.insert([2], [BOX], 1, masked(1))),
    ("ids", lambda: BODIES.erase(masked([0]))),
    ("ids", lambda: BODIES.move(masked([0]), [BOX])),
    ("boxes", lambda: BODIES.move([0], masked([BOX]))),
    ("ids", lambda: BODIES.set_masks(masked([0]), 1, 1)),
    ("categories", lambda: BODIES.set_masks([0], masked([1]), 1)),
    ("budget", lambda: BODIES.update(masked(1))),
    ("boxes", lambda: BODIES.query(masked(BOX))),
    ("mask", lambda: BODIES.query(BOX, mask=masked(1))),
    ("mask", lambda: BODIES.query(np.array(BOX), mask=masked(1))),
    ("centers", lambda: BODIES.query_sphere(masked([0, 0]), 1)),
    ("radii", lambda: BODIES.query_sphere([0, 0], masked(1))),
    ("ids", lambda: BODIES.pairs_of(masked([0]))),
    ("margin", lambda: BODIES.pairs_of([0], margin=masked(1.0))),
    ("mask", lambda: BODIES.pairs_of([0], mask=masked(1))),
    ("wanted", lambda: BODIES.pairs_of([0], wanted=masked([1]))),
    ("ids", lambda: BODIES.get(masked([0]))),
    ("ids", lambda: BODIES.masks(masked([0]))),
    ("vertices", lambda: hs.bounds_of_triangles(masked(TWO), [[0, 0, 1]])),
    ("faces", lambda: hs.bounds_of_triangles(TWO, masked([[0, 0, 1]]))),
]


@pytest.mark.parametrize("row", range(len(MASKED)))
def test_masked_values_are_refused(row):
    name, call = MASKED[row]
    before = bytes(TREE.blob()), BODIES.get([0, 1]).tolist()
    with pytest.raises(TypeError) as raised:
        call()
    assert str(raised.value) == f"{name}: expected no masked values"
    assert (bytes(TREE.blob()), BODIES.get([0, 1]).tolist()) == before
    assert len(BODIES) == 2


def test_a_mask_that_hides_nothing():
    tree = hs.BVH(np.ma.array([BOX, BOX], mask=False))
    tree.erase(np.ma.array([0], mask=[False]))
    assert tree.query([np.ma.array(BOX)]).tolist() == [[0], [1]]
