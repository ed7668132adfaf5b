"""What boxes, points and ids can be, and the errors of those that are wrong."""

import ctypes
import re
import sys

import halfspace as hs
import numpy as np
import pytest

from conftest import overlaps, random_boxes

BOXES = random_boxes(np.random.default_rng(2), 300, 3)


def in_records(a):
    """A stride that is no multiple of the size of a number."""
    records = np.zeros(len(a), [("box", a.dtype, 6), ("byte", np.uint8)])
    records["box"] = a
    return records["box"]


class Interface:
    def __init__(self, a):
        self.array = a
        self.__array_interface__ = a.__array_interface__


LAYOUTS = {
    "rows": lambda a: a,
    "columns": np.asfortranarray,
    "every second row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "wide rows": lambda a: np.repeat(a, 2, axis=1)[:, 1::2],
    "records": in_records,
    "misaligned": lambda a: np.frombuffer(b"." + a.tobytes(), a.dtype, -1, 1).reshape(a.shape),
    "swapped bytes": lambda a: a.astype(a.dtype.newbyteorder()),
    "read only": lambda a: np.frombuffer(a.tobytes(), a.dtype).reshape(a.shape),
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
    "Arrow without nulls": lambda a: [ArrowColumn(c.copy(), 3, []) for c in a.T],
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout):
    value = LAYOUTS[layout](BOXES)
    expected = bytes(hs.BVH(BOXES).blob())
    assert bytes(hs.BVH(value).blob()) == expected
    found = hs.BVH(BOXES).query(value)
    assert (found == hs.BVH(BOXES).query(BOXES)).all()
    assert (hs.Scan(value).mask(value) == overlaps(BOXES, BOXES)).all()


@pytest.mark.parametrize("dtype", [np.float16, np.int8, np.uint16, np.int32, np.uint64, np.int64])
def test_types(dtype):
    boxes = np.array([[0, 0, 1, 1], [2, 2, 4, 4]], dtype)
    tree = hs.BVH(boxes)
    assert tree.query(np.array([1, 1, 2, 2], dtype)).tolist() == [0, 1]
    assert tree.query(np.array([5, 5, 6, 6], dtype)).tolist() == []


def test_a_tuple_of_points_is_no_tuple_of_columns():
    tree = hs.BVH([[0, 0, 1, 1], [5, 5, 6, 6]])
    assert tree.nearest(tuple(np.eye(4, 2) * 9))[0].shape == (4, 1)


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


new_capsule = ctypes.pythonapi.PyCapsule_New
new_capsule.restype = ctypes.py_object
new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


class ArrowColumn:
    """A producer of the Arrow C data interface. `nulls` are rows that are null. With a
    list, there is a bitmap."""

    def __init__(self, values, offset=0, nulls=None, format=None):
        self.format = format or {4: b"f", 8: b"g"}[values.itemsize]
        self.values = np.concatenate([values[:1].repeat(offset), values])
        present = np.ones(len(self.values) + 8, bool)
        present[[offset + row for row in nulls or []]] = False
        self.bitmap = None if nulls is None else np.packbits(present, bitorder="little")
        self.length, self.offset = len(values), offset
        self.is_released = False
        self.is_malformed = ()  # which pointers are null

    def __arrow_c_array__(self, requested_schema=None):
        assert requested_schema is None
        has_nulls = self.bitmap is not None
        self.buffers = words(self.bitmap.ctypes.data if has_nulls else 0, self.values.ctypes.data)
        self.text = ctypes.create_string_buffer(self.format)
        release = 0 if self.is_released else 1
        # The members of struct ArrowSchema and of struct ArrowArray.
        self.structs = (
            words(0 if "format" in self.is_malformed else ctypes.addressof(self.text), 0, 0, 0, 0, 0, 0, 1, 0),
            words(self.length, -1 if has_nulls else 0, self.offset, 2, 0,
                  0 if "buffers" in self.is_malformed else self.buffers.ctypes.data, 0, 0,
                  release, 0),
        )
        self.capsules = tuple(new_capsule(its.ctypes.data, name, None)
                              for its, name in zip(self.structs, (b"arrow_schema", b"arrow_array")))
        return self.capsules


def words(*values):
    return np.array(values, np.int64)


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
    column = BOXES[:, 2].copy()
    released = ArrowColumn(column)
    released.is_released = True
    without_format, without_buffers = ArrowColumn(column), ArrowColumn(column)
    without_format.is_malformed = ("format",)
    without_buffers.is_malformed = ("buffers",)
    for bad, error, message in (
        (ArrowColumn(column, 5, [3]), ValueError,
         "boxes[2]: expected numbers, got a null in row 3"),
        (ArrowColumn(column, format=b"i"), TypeError,
         'boxes[2]: expected an Arrow array of float or double, got the Arrow format "i"'),
        (ArrowColumn(column[1:]), ValueError,
         "boxes: expected arrays of the same shape, got [(300, 1), (300, 1), (299,"),
        (released, ValueError, "boxes[2]: expected an Arrow array, got one that was rel"),
        (without_format, TypeError, 'boxes[2]: expected an Arrow array of float or double, got'),
        (without_buffers, ValueError, "boxes[2]: expected an Arrow array with 2 buffers, got"),
    ):
        with pytest.raises(error, match=re.escape(message)):
            hs.BVH(good[:2] + [bad] + good[3:])
        check_released(bad)
        check_released(good[0])


NAN = float("nan")
INF = float("inf")
SHAPE = "boxes: expected boxes of shape (n, 6) or (6,) or (n, 4) or (4,)"
BAD_BOXES = [
    ([[0, 0, NAN, 1]], "boxes[0]: expected numbers, got NaN in [0.0, 0.0,"),
    (np.array([[0, 0, 1, 1], [0, 2, 1, 1]], np.float32),
     "boxes[1]: expected min <= max, got min 2.0 > max 1.0 on axis 1 of [0.0, 2.0,"),
    ([0, 0, -1, 1], "boxes: expected min <= max, got min 0.0 > max -1.0 on"),
    # Empty on one axis alone.
    ([[INF, 0, -INF, 1]], "boxes[0]: expected min <= max, got min inf >"),
    ([[0, 0, 1]], SHAPE),
    ([], SHAPE),
    (np.zeros((2, 2, 6)), SHAPE),
    (3, SHAPE),
    ((np.zeros((2, 4)),) * 2, SHAPE),
    ([[0, 0, 1, 1], [0, 0, 1]], "boxes: expected an array of numbers"),
    ([[2**60, 0, 2**60, 1]], "boxes: expected integers between -2^53 and"),
    ((np.zeros((2, 3)), np.zeros((3, 3))), "boxes: expected arrays of the same shape, got [(2,"),
    (np.broadcast_to(np.float32(0), (2**31, 6)),
     "boxes: expected fewer than 2^31 boxes, got 2147483648"),
]
BOXES_OF_BAD_TYPES = [
    (np.zeros((1, 4), complex), "boxes: expected float32, float64 or integers"),
    (np.zeros((1, 4), bool), "boxes: expected float32, float64 or integers"),
    (np.zeros((1, 4), np.longdouble), "boxes: expected float32, float64 or integers"),
    (None, "boxes: expected an array of numbers, got NoneType"),
]
BOX = [0, 0, 1, 1]
TREE = hs.BVH([BOX, [2, 2, 3, 3]])
BODIES = hs.BroadPhase(2)
BODIES.insert([0, 1], [BOX] * 2)
FACE, MESH = [[0, 0, 0]], hs.TriangleMesh(np.ones((3, 3)), [[0, 1, 2]])
BAD_CALLS = [
    (lambda: TREE.query(np.zeros((5, 6))),
     "boxes: expected boxes of shape (n, 4) or (4,), or two arrays (minima, maxima) "
     "of shape (n, 2), for a tree of 2 dimensions, got shape (5, 6)"),
    (lambda: TREE.count([NAN, 0, 1, 1]), "boxes: expected numbers, got NaN"),
    (lambda: TREE.any([[1, 0, 0, 1]]), "boxes[0]: expected min <= max"),
    (lambda: TREE.query_batches(BOX, 0), "max_results: expected an"),
    (lambda: TREE.query(BOX, within=-1), "within: expected numbers"),
    (lambda: TREE.query(BOX, within=[1, 2]), "within: expected one number or an array"),
    (lambda: TREE.query_sphere([0, 0, 1], 1), "centers: expected points of shape (n, 2)"),
    (lambda: TREE.query(BOX, threads=0), "threads: expected an integer from 1"),
    (lambda: hs.BVH([BOX], quality="x"), 'quality: expected "high"'),
    (lambda: hs.BVH([BOX], quality=np.array(["fast"])), 'quality: expected "high"'),
    (lambda: TREE.nearest([0, 0, 0]), "points: expected points of shape (n, 2)"),
    (lambda: TREE.nearest([0, NAN]), "points: expected numbers, got NaN"),
    (lambda: TREE.nearest([1, 1, 0, 0]), "points: expected min <= max, got"),
    (lambda: TREE.nearest([0, 0], 0), "k: expected an integer from 1 to"),
    (lambda: TREE.nearest([0, 0], max_distance=-1),
     "max_distance: expected a number that is not negative, got -1.0"),
    (lambda: TREE.raycast([[0, 0]] * 3, [[0, 1]] * 2),
     "directions: expected as many rows as origins, got 2 and 3"),
    (lambda: TREE.raycast([0, NAN], [0, 1]), "origins: expected numbers, got NaN"),
    (lambda: TREE.raycast([0, 0], [1e-50, 1]), "directions[0]: expected a number that float32"),
    (lambda: TREE.raycast([0, 0], [0, 1], NAN), "max_t: expected numbers that are not"),
    (lambda: TREE.erase(5), "ids[0]: expected the id of an object, got 5"),
    (lambda: TREE.erase([0, -1]), "ids[1]: expected the id of an object, got -1"),
    (lambda: TREE.refit([BOX]), "boxes: expected 2 boxes, one for each id of the tree, got 1"),
    (lambda: TREE.refit([BOX], [0, 1]), "ids: expected one id for each of 1 boxes, got 2"),
    (lambda: hs.BVH(tuple(np.zeros((4, 4)))), "boxes: a tuple of 4 arrays of length 4"),
    (lambda: TREE.boxes([10**6]), "ids[0]: expected the id of an object, got 1000000"),
    (lambda: TREE.set_masks([1, 2, 3]), "masks: expected one integer or an array of shape (2,)"),
    (lambda: TREE.set_masks(1, [2]), "ids[0]: expected the id of an object, got 2"),
    (lambda: TREE.query(BOX, mask=2**32), "mask: expected an integer from 0 to 4294967295"),
    (lambda: TREE.pairs(margin=INF), "margin: expected a finite float32, got inf"),
    (lambda: TREE.pairs(within=INF), "within: expected a finite float32, got inf"),
    (lambda: hs.join(TREE, TREE, margin=1, within=1), "within: expected no margin next to it"),
    (lambda: TREE.pairs(margin=1e39), "margin: expected a finite float32, got 1e+39"),
    (lambda: hs.join(TREE, TREE, margin=NAN), "margin: expected a number that is not neg"),
    (lambda: hs.join(TREE, hs.BVH(BOXES)), "b: expected a BVH of 2 dimension"),
    (lambda: BODIES.move([1, 5], [BOX] * 2), "ids[1]: expected the id of a body, got 5"),
    (lambda: BODIES.erase([1, 6]), "ids[1]: expected the id of a body, got 6"),
    (lambda: BODIES.get([7]), "ids[0]: expected the id of a body, got 7"),
    (lambda: BODIES.pairs_of([9]), "ids[0]: expected the id of a body, got 9"),
    (lambda: BODIES.insert([1], [BOX]), "ids[0]: expected an id that no body has, once in the"),
    (lambda: BODIES.query(np.array([2.0, 0, 1, 1])), "boxes: expected min <= max"),
    (lambda: BODIES.insert([2, 3], [BOX] * 2, [1, -2]),
     "categories[1]: expected an integer from 0 to 2^32 - 1, got -2"),
    (lambda: BODIES.set_masks([1], 1, 2**32),
     "collides_with[0]: expected an integer from 0 to 2^32 - 1, got 4294967296"),
    (lambda: hs.BroadPhase(4), "dimensions: expected 2 or 3, got 4"),
    (lambda: hs.BroadPhase(kind="box"), 'kind: expected "aabb" or "aabo"'),
    (lambda: BODIES.update(-1), "budget: expected an integer from 0 to"),
    (lambda: BODIES.load(b""), "data: expected"),
    (lambda: BODIES.load(hs.BroadPhase(3).save()), "data: expected"),
    (lambda: BODIES.spherecast(TWO, 1, [[1, 0]] * 3),
     "directions: expected as many rows as centers"),
    (lambda: hs.bounds_of_triangles([[0] * 4], FACE), "vertices: expected points of shape (n"),
    (lambda: hs.bounds_of_triangles([[0, 0, NAN]], FACE), "vertices[0]: expected numbers, got Na"),
    (lambda: hs.bounds_of_triangles([[0, 0, INF]], FACE), "vertices: expected finite coordinates"),
    (lambda: hs.bounds_of_triangles([[0, 0]], FACE[0]), "faces: expected shape (n, 3), got shape (3,)"),
    (lambda: hs.bounds_of_triangles([[0, 0]], FACE + [[0, 1, 0]]), "faces[1]: expected indices from 0"),
    (lambda: hs.bounds_of_triangles([[0, 0]], [[0, 0, -1]]), "faces[0]: expected indices from 0 to 0, got"),
    (lambda: hs.TriangleMesh([[0, 0]], FACE), "vertices: expected points of shape (n, 3)"),
    (lambda: hs.TriangleMesh([[0, 0, NAN]], FACE), "vertices[0]: expected numbers, got NaN"),
    (lambda: hs.TriangleMesh([[0, 0, 0]], [[0, 0, 1]]), "faces[0]: expected indices from 0 to 0"),
    (lambda: MESH.raycast([0, 0], [1, 0]), "origins: expected points of shape (n, 3)"),
    (lambda: MESH.occluded([0, 0, 0], [1, 0, 0], -1), "max_t"),
    (lambda: MESH.closest_point([0, 0, 0], max_distance=-1), "max_distance"),
]
BAD_TYPES = [
    (lambda: hs.bounds_of_triangles([[0, 0]], [[0, 0, 0.5]]), "faces: expected integers, got float64"),
    (lambda: TREE.query(BOX, threads=1.5), "threads: expected an integer from 1 to 4096, got float 1.5"),
    (lambda: TREE.nearest([0, 0], "2"), "k: expected an integer from 1 to 2147483647, got str"),
    (lambda: TREE.nearest([0, 0], np.inf), "k: expected an integer from 1 to 2147483647, got float inf: len(tree) or more finds all objects"),
    (lambda: BODIES.nearest([0, 0], 2.0), "k: expected an integer from 1 to 2147483647, got float"),
    (lambda: TREE.nearest([0, 0], max_distance=None), "max_distance: expected a number"),
    (lambda: TREE.erase([0.5]), "ids: expected integers, got float64"),
    (lambda: hs.join(TREE, [BOX]), "b: expected a BVH, got list"),
    (lambda: BODIES.insert([2], [BOX], 1.5), "categories: expected integers, got"),
    (lambda: BODIES.insert([2], [BOX], [2**70]), "categories: expected integers, got"),
]


def masked(values):
    return np.ma.array(values, mask=np.ma.ones(np.shape(values)))


class MaskedVariable:
    """Returns a masked array when NumPy asks for an array, as netCDF4 does."""

    def __init__(self, values):
        self.values = masked(values)

    def __array__(self, dtype=None, copy=None):
        return self.values


TWO = [[0, 0], [1, 1]]
# The argument that is masked, and a call with it.
MASKED = [
    ("boxes", lambda: hs.BVH(masked([BOX]))),
    ("boxes", lambda: hs.BVH(masked(BOX))),
    ("boxes[0]", lambda: hs.BVH((masked(TWO), np.array(TWO)))),
    ("boxes", lambda: hs.BVH([np.array(BOX), masked(BOX)])),
    ("boxes", lambda: hs.BVH([BOX, [0, 0, 1, masked(1)]])),
    ("boxes", lambda: hs.BVH(MaskedVariable([BOX]))),
    ("boxes[0]", lambda: hs.BVH((MaskedVariable(TWO), np.array(TWO)))),
    ("boxes[3]", lambda: hs.BVH((*np.zeros((3, 2)), masked([1, 1])))),
    ("boxes", lambda: hs.Scan(masked([BOX]))),
    ("boxes", lambda: TREE.query(masked(BOX))),
    ("boxes", lambda: TREE.count(masked(BOX))),
    ("boxes", lambda: TREE.any(masked(BOX))),
    ("ids", lambda: TREE.erase(masked([0, 1]))),
    ("ids", lambda: TREE.erase(np.ma.array([0, 1], mask=[0, 1]))),
    ("points", lambda: TREE.nearest(masked([0, 0]))),
    ("points[0]", lambda: TREE.nearest((masked(TWO), np.array(TWO)))),
    ("k", lambda: TREE.nearest([0, 0], masked(1))),
    ("max_distance", lambda: TREE.nearest([0, 0], max_distance=masked(1.0))),
    ("threads", lambda: TREE.pairs(threads=masked(1))),
    ("origins", lambda: TREE.raycast(masked([0, 0]), [1, 0])),
    ("directions", lambda: TREE.raycast([0, 0], masked([1, 0]))),
    ("max_t", lambda: TREE.raycast([0, 0], [1, 0], masked(1))),
    ("categories", lambda: BODIES.insert([2], [BOX], masked([1]))),
    ("collides_with", lambda: BODIES.insert([2], [BOX], 1, masked(1))),
    ("budget", lambda: BODIES.update(masked(1))),
    ("boxes", lambda: BODIES.query(masked(BOX))),
    ("mask", lambda: BODIES.query(np.array(BOX), mask=masked(1))),
    ("centers", lambda: BODIES.query_sphere(masked([0, 0]), 1)),
    ("radii", lambda: BODIES.query_sphere([0, 0], masked(1))),
    ("margin", lambda: BODIES.pairs_of([0], margin=masked(1.0))),
    ("wanted", lambda: BODIES.pairs_of([0], wanted=masked([1]))),
    ("vertices", lambda: hs.bounds_of_triangles(masked(TWO), [[0, 0, 1]])),
    ("faces", lambda: hs.bounds_of_triangles(TWO, masked([[0, 0, 1]]))),
]


def made_of(rows):
    return [(lambda kind=kind, value=value: kind(value), text)
            for value, text in rows for kind in (hs.BVH, hs.Scan)]


BAD = [(ValueError, *row) for row in made_of(BAD_BOXES) + BAD_CALLS] + [
    (TypeError, *row) for row in made_of(BOXES_OF_BAD_TYPES) + BAD_TYPES] + [
    (TypeError, call, f"{name}: expected no masked values") for name, call in MASKED]


@pytest.mark.parametrize("error, call, message", BAD)
def test_bad_calls(error, call, message):
    before = state()
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert state() == before


def state():
    return bytes(TREE.blob()), BODIES.save()


def test_a_mask_that_hides_nothing():
    tree = hs.BVH(np.ma.array([BOX, BOX], mask=False))
    tree.erase(np.ma.array([0], mask=[False]))
    assert tree.query([np.ma.array(BOX)]).tolist() == [[0], [1]]
