"""The broad phase, compared with NumPy."""

import copy
import pickle
import threading
from fractions import Fraction

import halfspace as hs
import numpy as np
import pytest

from conftest import as_matrix, overlaps, random_boxes

ALL = 2**32 - 1


class Model:
    """What a broad phase should have."""

    def __init__(self, n, dims):
        self.has = np.zeros(n, bool)
        self.boxes = np.full((n, 2 * dims), np.inf, np.float32)
        self.boxes[:, dims:] = -np.inf
        self.categories = np.full(n, ALL, np.uint32)
        self.collides_with = np.full(n, ALL, np.uint32)

    def near(self, margin):
        grown = self.boxes.astype(float)
        half = grown.shape[1] // 2
        grown[:, :half] -= margin
        grown[:, half:] += margin
        found = overlaps(grown, self.boxes) & self.has[:, None] & self.has[None, :]
        return np.triu(found, 1)

    def pairs(self):
        masks = (self.categories[:, None] & self.collides_with[None, :]) != 0
        return self.near(0) & masks & masks.T


def as_set(pairs):
    assert pairs.shape == (len(pairs), 2) and pairs.dtype == np.int64
    return set(map(tuple, pairs.tolist()))


@pytest.mark.parametrize("kind", ["aabb", "aabo"])
def test_a_history(rng, dims, kind):
    n = 1200
    model = Model(n, dims)
    bodies = hs.BroadPhase(dims, kind)
    queries = random_boxes(rng, 700, dims, 0.2)
    before = set()

    def check():
        assert len(bodies) == model.has.sum() and bodies.validate()
        expected = overlaps(queries, model.boxes) & model.has
        for threads in (1, 2):
            found = bodies.query(queries, threads=threads)
            assert (as_matrix(found, expected.shape) == expected).all()
            assert (np.diff(found[0]) >= 0).all()
        in_mask = (model.categories & np.uint32(6)) != 0
        for query, row in zip(queries[:40], expected):
            for one in (query, query.astype(float), query.tolist()):
                assert sorted(bodies.query(one)) == np.flatnonzero(row).tolist()
                assert (
                    sorted(bodies.query(one, mask=6)) == np.flatnonzero(row & in_mask).tolist()
                )
        found = bodies.query(queries, mask=6)
        masked = expected & in_mask
        assert (as_matrix(found, expected.shape) == masked).all()
        counts = bodies.count(queries, mask=6, threads=2)
        assert counts.dtype == np.int64 and (counts == masked.sum(axis=1)).all()
        assert (bodies.any(queries, mask=6) == masked.any(axis=1)).all()
        assert bodies.count(queries[0]) == expected[0].sum()
        assert bodies.any(queries[0]) == expected[0].any()

        alive = np.flatnonzero(model.has)
        tree = hs.BVH(model.boxes[alive])
        ids, t = bodies.raycast(queries[:, :dims], queries[:, dims:] - 0.5, 2)
        if kind == "aabb":
            expected_ids, expected_t = tree.raycast(
                queries[:, :dims], queries[:, dims:] - 0.5, 2
            )
            assert (ids == np.where(expected_ids < 0, -1, alive[expected_ids])).all()
            assert (t == expected_t).all()
        assert (ids >= 0).any()
        for points in (queries[:100, :dims], queries[:100]):
            _, distances = tree.nearest(points, 7, max_distance=0.5)
            ids_near, found_distances = bodies.nearest(points, 7, max_distance=0.5)
            assert (found_distances == distances).all()
            assert model.has[ids_near[ids_near >= 0]].all()
        assert (bodies.nearest(points[0], 7)[0] == bodies.nearest(points[:1], 7)[0][0]).all()
        assert bodies.raycast(queries[3, :dims], queries[3, dims:] - 0.5, 2)[0] == ids[3]

        nonlocal before
        began, ended = bodies.update_pairs(threads=2)
        now = set(map(tuple, np.argwhere(model.pairs()).tolist()))
        assert as_set(began) == now - before and as_set(ended) == before - now
        assert began.tolist() == sorted(began.tolist())
        assert as_set(bodies.pairs()) == now and len(bodies.pairs()) == len(now)
        before = now
        chosen = alive[::3]
        found = as_set(bodies.pairs_of(chosen, margin=0.01))
        assert {a for a, _ in found} <= set(chosen.tolist())
        wide = model.near(0.01)
        in_set = np.isin(np.arange(n), chosen)
        wide &= in_set[:, None] | in_set[None, :]
        if kind == "aabb":
            assert {(min(p), max(p)) for p in found} == set(
                map(tuple, np.argwhere(wide).tolist())
            )
        low, high = bodies.bounds[:dims], bodies.bounds[-len(bodies.bounds) // 2 :][:dims]
        assert (low == model.boxes[alive, :dims].min(axis=0)).all()
        assert (high == model.boxes[alive, dims:].max(axis=0)).all()
        assert alive[-1] < bodies.id_limit
        values = bodies.get(alive)
        half = values.shape[1] // 2
        assert (values[:, :dims] == model.boxes[alive, :dims]).all()
        assert (values[:, half : half + dims] == model.boxes[alive, dims:]).all()
        categories, collides_with = bodies.masks(alive)
        assert (categories == model.categories[alive]).all()
        assert (collides_with == model.collides_with[alive]).all()

    def change(call, ids, **masks):
        boxes = random_boxes(rng, len(ids), dims, 0.05)
        model.has[ids] = True
        model.boxes[ids] = boxes
        call(ids, boxes, **masks)

    ids = rng.permutation(n)
    model.categories[ids[:500]] = 1 << np.arange(500, dtype=np.uint32) % 5
    change(bodies.insert, ids[:500], categories=model.categories[ids[:500]])
    check()
    change(bodies.move, ids[100:300])
    bodies.erase(ids[:50])
    model.has[ids[:50]] = False
    check()
    bodies.update()
    change(bodies.insert, ids[500:600])
    model.categories[ids[40:60]] = 1
    change(bodies.insert, ids[40:50], categories=1)
    model.collides_with[ids[60:80]] = 2
    bodies.set_masks(ids[60:80], model.categories[ids[60:80]], 2)
    bodies.set_masks(ids[50:60], 1, ALL)
    check()
    bodies.rebuild(threads=2)
    bodies.update(0)
    check()


def test_casts_of_boxes(rng, dims):
    """The first t is that of the slabs: about, and never after it."""
    boxes = random_boxes(rng, 300, dims, 0.1)
    moving = random_boxes(rng, 100, dims, 0.1)
    ways = rng.random((100, dims)).astype(np.float32) - 0.5
    bodies = hs.BroadPhase(dims)
    bodies.insert(np.arange(300), boxes, categories=1 << np.arange(300) % 2)
    low, high = np.split(boxes.astype(float), 2, axis=1)
    first, last = np.split(moving.astype(float)[:, None], 2, axis=2)
    a, b = (low - last) / ways[:, None], (high - first) / ways[:, None]
    enter = np.minimum(a, b).max(axis=2).clip(0)
    exact = np.where(enter <= np.maximum(a, b).min(axis=2), enter, np.inf)
    for max_t, mask in ((np.inf, None), (0.3, 2)):
        hit = np.where(exact <= max_t, exact, np.inf)
        if mask:
            hit[:, ::2] = np.inf
        ids, t = bodies.boxcast(moving, ways, max_t, mask=mask, threads=2)
        least = hit.min(axis=1)
        assert ((ids >= 0) == np.isfinite(least)).all()
        found = ids >= 0
        assert found.any()
        assert (t[found] <= least[found]).all()
        assert np.allclose(t[found], least[found], rtol=1e-5, atol=1e-4)
        assert np.allclose(hit[found, ids[found]], t[found], rtol=1e-5, atol=1e-4)
    tree = hs.BVH(boxes)
    for cast in (bodies.boxcast, tree.boxcast):
        ids, t = cast(moving, ways)
        assert (t <= exact.min(axis=1)).all()
        assert (ids == bodies.boxcast(moving, ways)[0]).all()
    one, each = bodies.boxcast(moving[3], ways), bodies.boxcast(moving[[3] * 100], ways)
    assert (one[0] == each[0]).all() and (one[1] == each[1]).all()


@pytest.mark.parametrize("is_tree", [False, True])
def test_casts_of_spheres(dims, is_tree):
    boxes = [[4] * dims + [5] * dims, [8] * dims + [9] * dims]
    bodies = hs.BVH(boxes) if is_tree else hs.BroadPhase(dims)
    if not is_tree:
        bodies.insert([0, 1], boxes)
    up = [1] + [0] * (dims - 1)
    middle = [0] + [4.5] * (dims - 1)
    assert bodies.spherecast(middle, 0.5, up) == (0, pytest.approx(3.5, abs=1e-4))
    assert bodies.spherecast(middle, 0, up) == bodies.raycast(middle, up)
    assert bodies.spherecast(middle, 0.5, up, 3.4) == (-1, np.inf)
    # Beside the edge at Y = 4: a box of the sphere's size would touch at 3.
    beside = [0, 3.5] + [4.5] * (dims - 2)
    ids, t = bodies.spherecast([beside, middle], [1, 0.25], up)
    assert ids.tolist() == [0, 0]
    assert t == pytest.approx([4 - 0.75**0.5, 3.75], abs=1e-4)


def test_pairs_by_masks_of_the_call():
    bodies = hs.BroadPhase(2)
    bodies.insert(range(4), [BOX] * 4, [1, 2, 4, 4], collides_with=0)
    assert len(bodies.pairs_of([0, 1])) == 5
    assert as_set(bodies.pairs_of([0, 1], wanted=4)) == {(0, 2), (0, 3), (1, 2), (1, 3)}
    assert as_set(bodies.pairs_of([0, 1], wanted=[2, 0])) == {(0, 1)}
    assert as_set(bodies.pairs_of([0], mask=5)) == {(0, 2), (0, 3)}
    assert as_set(bodies.pairs_of([], wanted=1)) == set()
    with pytest.raises(ValueError, match="wanted: expected one integer or an array"):
        bodies.pairs_of([0, 1], wanted=[1, 2, 3])


@pytest.mark.parametrize(
    "margin",
    [
        0.7,
        np.float32(0.7),
        2**53 + 1,
        1 + Fraction(1, 10**30),
        np.longdouble(1) + np.finfo(np.longdouble).eps,
        1e-46,
    ],
)
def test_a_margin_is_rounded_up(margin):
    """Two floats are apart by more than the float below the margin."""
    exact = Fraction(*margin.as_integer_ratio())

    def float_below(number):
        below = np.float32(float(number))
        return below if float(below) <= number else np.nextafter(below, np.float32(0))

    low = float_below(exact)
    high = -float_below(exact - Fraction(float(low)))
    assert Fraction(float(low)) - Fraction(float(high)) <= exact
    bodies = hs.BroadPhase(2)
    boxes = np.array([[high - 1, 0, high, 1], [low, 0, low + 1, 1]], np.float32)
    bodies.insert([0, 1], boxes)
    assert as_set(bodies.pairs_of([0], margin=margin)) == {(0, 1)}


def test_octahedra():
    """Bounds that only the axis D separates."""
    bodies = hs.BroadPhase(2, "aabo")
    bodies.insert([0], [[0, 0, -1, 1, 1, 0]])  # the triangle below x + y = 1
    assert bodies.query([0.8, 0.8, 1, 1]).tolist() == []
    assert bodies.query([0.5, 0.5, 1, 1]).tolist() == [0]
    assert bodies.query(np.array([0.8, 0.8, -3, 1, 1, -0.9])).tolist() == [0]
    assert bodies.get(0).tolist() == [[0, 0, -1, 1, 1, 0]]


def test_size_and_contents():
    bodies = hs.BroadPhase(dimensions=2)
    assert len(bodies) == 0 and 3 not in bodies
    assert bodies.id_limit == 0 and bodies.dims == 2
    bodies.insert(3, [0, 0, 1, 1])
    assert 3 in bodies and 4 not in bodies and -1 not in bodies and 2**40 not in bodies
    assert 3.0 in bodies and 3.5 not in bodies and np.nan not in bodies
    assert repr(bodies) == "<halfspace.BroadPhase: 1 bodies in 2 dimensions>"
    statistics = bodies.statistics()
    assert statistics["bodies"] == 1 and statistics["pairs"] == 0
    assert statistics["bytes"] > 0 and statistics["cost_ratio"] == 1
    bodies.insert([], np.empty((0, 4)))
    bodies.update()
    assert bodies.bounds.tolist() == BOX and bodies.id_limit == 4


def test_moves_that_wait():
    bodies = hs.BroadPhase(2, moves_wait_for_update=True)
    bodies.insert([3], [BOX])
    bodies.move([3], [[5, 5, 6, 6]])
    assert bodies.query(BOX).tolist() == [3]
    assert bodies.get(3).tolist() == [[5, 5, 6, 6]]
    bodies.update()
    assert bodies.query(BOX).tolist() == []


class Marked(hs.BroadPhase):
    """A class of the caller's."""


@pytest.mark.parametrize("kind", ["aabb", "aabo"])
def test_copies_go_on_as_the_original(rng, dims, kind):
    n = 700
    bodies = Marked(dims, kind)
    bodies.mark = 5
    bodies.insert(np.arange(n), random_boxes(rng, n, dims), categories=1 << np.arange(n) % 3)
    bodies.update_pairs()
    bodies.move(np.arange(100), random_boxes(rng, 100, dims))
    loaded = Marked(dims, kind)
    loaded.insert([3], [[0] * dims + [1] * dims])
    loaded.load(bodies.save())
    copies = [
        bodies.copy(),
        copy.copy(bodies),
        copy.deepcopy(bodies),
        pickle.loads(pickle.dumps(bodies)),
        pickle.loads(pickle.dumps(bodies, 2)),
        loaded,
    ]
    moving, boxes = np.arange(0, n, 2), random_boxes(rng, (n + 1) // 2, dims)
    queries = random_boxes(rng, 50, dims)

    def go_on(its):
        before = its.pairs().tolist()
        its.move(moving, boxes)
        its.erase([5, 6])
        its.update()
        found = its.query(queries, mask=3).tolist()
        return [before, found, *(pairs.tolist() for pairs in its.update_pairs())]

    expected = go_on(bodies)
    assert all(expected)
    for other in copies:
        assert type(other) is Marked and len(other) == n
        assert go_on(other) == expected
    assert copies[3].mark == 5


def test_bytes_that_were_not_saved():
    bodies = hs.BroadPhase(2)
    bodies.insert(1, BOX)
    state = bodies.save()
    flat = hs.BroadPhase(3)
    for other, data in ((bodies, state[:-1]), (bodies, b""), (flat, state)):
        with pytest.raises(ValueError, match="expected"):
            other.load(data)
    assert len(bodies) == 1 and len(flat) == 0
    assert bodies.query(BOX).tolist() == [1]


BOX = [0, 0, 1, 1]
ERRORS = {
    "ids[1]: expected the id of a body, got 5": lambda b: b.move([1, 5], [BOX, BOX]),
    "ids[1]: expected the id of a body, got 6": lambda b: b.erase([1, 6]),
    "ids[0]: expected the id of a body, got 7": lambda b: b.get([7]),
    "ids[0]: expected the id of a body, got 8": lambda b: b.masks([8]),
    "ids[0]: expected the id of a body, got 9": lambda b: b.pairs_of([9]),
    "ids[0]: expected an id that no body has, once in the list, got 1": lambda b: b.insert(
        [1], [BOX]
    ),
    "ids[1]: expected the id of an object, got -1": lambda b: b.insert([2, -1], [BOX] * 2),
    "ids: expected one id for each of 1 boxes, got 2": lambda b: b.insert([2, 3], [BOX]),
    "boxes[1]: expected numbers, got NaN": lambda b: b.insert([2, 3], [BOX, [0, 0, 1, np.nan]]),
    "boxes[0]: expected min <= max": lambda b: b.move([1], [[2, 0, 1, 1]]),
    "boxes: expected min <= max": lambda b: b.query(np.array([2.0, 0, 1, 1])),
    "boxes: expected boxes of shape (n, 4)": lambda b: b.query([0, 0, 0, 1, 1, 1]),
    "categories[1]: expected an integer from 0 to 2^32 - 1, got -2": lambda b: b.insert(
        [2, 3], [BOX] * 2, categories=[1, -2]
    ),
    "categories: expected one integer or an array of shape (1,)": lambda b: b.set_masks(
        [1], [1, 2], 1
    ),
    "collides_with[0]: expected an integer from 0 to 2^32 - 1, got 4294967296": (
        lambda b: b.set_masks([1], 1, 2**32)
    ),
    "dimensions: expected 2 or 3, got 4": lambda b: hs.BroadPhase(4),
    'kind: expected "aabb" or "aabo"': lambda b: hs.BroadPhase(kind="box"),
    "budget: expected at least 0, got -1": lambda b: b.update(-1),
    "directions: expected as many rows as centers": lambda b: b.spherecast(
        [[0, 0]] * 2, 1, [[1, 0]] * 3
    ),
    "boxes: expected boxes of shape (n, 4) or (4,)": lambda b: b.boxcast([0, 0], [1, 0]),
}


@pytest.mark.parametrize("message", ERRORS)
def test_errors(message):
    bodies = hs.BroadPhase(2)
    bodies.insert(1, BOX)
    with pytest.raises(ValueError) as error:
        ERRORS[message](bodies)
    assert str(error.value).startswith(message)
    assert len(bodies) == 1 and bodies.get(1).tolist() == [BOX]


def test_masks_must_be_integers():
    bodies = hs.BroadPhase(2)
    for categories in (1.5, [2**70]):
        with pytest.raises(TypeError, match="categories: expected integers of 32 bits"):
            bodies.insert([1], [BOX], categories=categories)


def test_threads_move_and_query(dims):
    """Bodies at rest are always found, and those that move inside a cell stay in it."""
    n, cells = 3000, 3
    bodies = hs.BroadPhase(dims)
    rng = np.random.default_rng(7)
    cell = np.arange(n) % cells

    def boxes(ids, rng):
        low = 0.8 * rng.random((len(ids), dims))
        low[:, 0] += cell[ids] * 10
        return np.hstack([low, low + 0.1]).astype(np.float32)

    ids = np.arange(n)
    bodies.insert(ids, boxes(ids, rng))
    stop = threading.Event()
    errors = []

    def guard(work, seed):
        rng = np.random.default_rng(seed)
        try:
            while not stop.is_set():
                work(rng)
        except BaseException as error:
            errors.append(error)

    def move(own):
        def work(rng):
            bodies.move(own, boxes(own, rng))

        return work

    def query(rng):
        low = np.zeros((cells, dims))
        low[:, 0] = 10 * np.arange(cells)
        wanted = np.hstack([low, low + 1])
        rows, found = bodies.query(wanted)
        assert len(found) == n and (cell[found] == rows).all()

    def update(rng):
        bodies.update()
        for pairs in (*bodies.update_pairs(), bodies.pairs()):
            assert (pairs[:, 0] < pairs[:, 1]).all() and (pairs < n).all()

    def save(rng):
        other = bodies.copy()
        other.load(bodies.save())
        assert len(other) == n and other.validate()

    works = [move(ids[: n // 2]), move(ids[n // 2 :]), query, query, update, update, save]
    threads = [
        threading.Thread(target=guard, args=(work, seed)) for seed, work in enumerate(works)
    ]
    for thread in threads:
        thread.start()
    stop.wait(0.5)
    stop.set()
    for thread in threads:
        thread.join()
    assert not errors, errors[0]
    bodies.update()
    assert bodies.validate()
    bodies.update_pairs()
    assert all(len(pairs) == 0 for pairs in bodies.update_pairs())
