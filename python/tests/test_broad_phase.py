"""The broad phase, compared with NumPy."""

import copy
import functools
import pickle
import time
from fractions import Fraction

import halfspace as hs
import numpy as np
import pytest

from conftest import as_matrix, overlaps, random_boxes, repeated

ALL = 2**32 - 1
BOX = [0, 0, 1, 1]


def as_set(pairs):
    assert pairs.shape == (len(pairs), 2) and pairs.dtype == np.int64
    return set(map(tuple, pairs.tolist()))


@pytest.mark.parametrize("kind", ["aabb", "aabo"])
def test_a_history(rng, dims, kind):
    n = 1200
    bodies = hs.BroadPhase(dims, kind)
    queries = random_boxes(rng, 700, dims, 0.2)
    # What the bodies should have.
    has = np.zeros(n, bool)
    boxes = np.zeros((n, 2 * dims), np.float32)
    categories, collides_with = masks = np.full((2, n), ALL, np.uint32)
    before = set()

    def check():
        assert len(bodies) == has.sum() and bodies.validate()
        expected = overlaps(queries, boxes) & has
        for threads in (1, 2):
            found = bodies.query(queries, threads=threads)
            assert (as_matrix(found, expected.shape) == expected).all()
            assert (np.diff(found[0]) >= 0).all()
        expected &= categories & np.uint32(6) != 0
        found = bodies.query(queries, mask=6)
        assert (as_matrix(found, expected.shape) == expected).all()
        assert (bodies.count(queries, mask=6, threads=2) == expected.sum(axis=1)).all()
        assert (bodies.any(queries, mask=6) == expected.any(axis=1)).all()

        alive = np.flatnonzero(has)
        its_boxes = boxes[alive]
        tree = hs.BVH(its_boxes)
        rays = queries[:, :dims], queries[:, dims:] - 0.5, 2
        assert np.allclose(bodies.raycast(*rays)[1], tree.raycast(*rays)[1])
        near, distances = bodies.nearest(queries[:100], 7, max_distance=0.5)
        assert (distances == tree.nearest(queries[:100], 7, max_distance=0.5)[1]).all()
        assert has[near[near >= 0]].all()

        nonlocal before
        began, ended = bodies.update_pairs(threads=2)
        collide = categories[:, None] & collides_with != 0
        collide &= collide.T & overlaps(boxes, boxes) & has & has[:, None]
        now = set(map(tuple, np.argwhere(np.triu(collide, 1)).tolist()))
        assert as_set(began) == now - before and as_set(ended) == before - now
        assert began.tolist() == sorted(began.tolist())
        assert as_set(bodies.pairs()) == now and len(bodies.pairs()) == len(now)
        before = now
        columns = [*range(dims), *range(-len(bodies.bounds) // 2, 0)][: 2 * dims]
        around = np.concatenate([its_boxes[:, :dims].min(axis=0), its_boxes[:, dims:].max(axis=0)])
        assert (bodies.bounds[columns] == around).all()
        assert (bodies.get(alive)[:, columns] == its_boxes).all()
        assert (np.array(bodies.masks(alive)) == masks[:, alive]).all()
        assert alive[-1] < bodies.id_limit

    def change(call, ids, **masks):
        has[ids] = True
        boxes[ids] = random_boxes(rng, len(ids), dims, 0.05)
        call(ids, boxes[ids], **masks)

    ids = rng.permutation(n)
    categories[ids[:500]] = 1 << np.arange(500, dtype=np.uint32) % 5
    change(bodies.insert, ids[:500], categories=categories[ids[:500]])
    check()
    change(bodies.move, ids[100:300])
    bodies.erase(ids[:50])
    has[ids[:50]] = False
    check()
    bodies.update()
    change(bodies.insert, ids[500:600])
    categories[ids[40:60]] = 1
    change(bodies.insert, ids[40:50], categories=1)
    collides_with[ids[60:80]] = 2
    bodies.set_masks(ids[60:80], categories[ids[60:80]], 2)
    bodies.set_masks(ids[50:60], 1, ALL)
    categories[ids[80:90]] = ALL
    bodies.set_masks(ids[80:90], None, None)
    check()
    bodies.rebuild(threads=2)
    bodies.update(0)
    check()


def test_pairs_by_masks_of_the_call():
    bodies = hs.BroadPhase(2)
    bodies.insert(range(4), [BOX] * 4, [1, 2, 4, 4], collides_with=0)
    assert len(bodies.pairs_of([0, 1])) == 5
    assert as_set(bodies.pairs_of([0, 1], wanted=4)) == {(0, 2), (0, 3), (1, 2), (1, 3)}
    assert as_set(bodies.pairs_of([0, 1], wanted=[2, 0])) == {(0, 1)}
    assert as_set(bodies.pairs_of([0], mask=5)) == {(0, 2), (0, 3)}
    assert as_set(bodies.pairs_of([3])) == {(3, 0), (3, 1), (3, 2)}
    assert as_set(bodies.pairs_of([], wanted=1)) == set()
    with pytest.raises(ValueError, match="wanted: expected one integer or an array"):
        bodies.pairs_of([0, 1], wanted=[1, 2, 3])


@pytest.mark.parametrize("margin", [0.7, np.float32(0.7), 2**53 + 1, 1 + Fraction(1, 10**30),
                                    np.longdouble(1) + np.finfo(np.longdouble).eps, 1e-46])
def test_a_margin_is_rounded_up(margin):
    from halfspace import _arrays

    up = np.float32(_arrays.margin(margin))
    below = np.nextafter(up, np.float32(0))
    assert Fraction(float(below)) < Fraction(*margin.as_integer_ratio()) <= Fraction(float(up))
    bodies = hs.BroadPhase(2)
    bodies.insert([0, 1], np.array([[-1, 0, 0, 1], [up, 0, 2 * up + 1, 1]]))
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


def test_moves_wait_for_an_update():
    bodies = hs.BroadPhase(2)
    bodies.insert([3], [BOX])
    bodies.move([3], [[5, 5, 6, 6]])
    assert bodies.query(BOX).tolist() == [3]
    assert bodies.get(3).tolist() == [[5, 5, 6, 6]]
    bodies.update()
    assert bodies.query(BOX).tolist() == []
    bodies = hs.BroadPhase(2, moves_are_seen_at_once=True)
    bodies.insert([3], [BOX])
    bodies.move([3], [[5, 5, 6, 6]])
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
    copies = [bodies.copy(), copy.copy(bodies), copy.deepcopy(bodies),
              pickle.loads(pickle.dumps(bodies)), pickle.loads(pickle.dumps(bodies, 2)), loaded]
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


def test_threads_move_and_query(dims):
    """Bodies that move inside of a box are always found there."""
    n = 3000
    bodies = hs.BroadPhase(dims)
    ids = np.arange(n)
    bodies.insert(ids, random_boxes(np.random.default_rng(7), n, dims))

    def move(own, rng):
        bodies.move(own, random_boxes(rng, len(own), dims))

    def query():
        assert sorted(bodies.query([0] * dims + [2] * dims)) == ids.tolist()

    def update():
        bodies.update()
        for pairs in (*bodies.update_pairs(), bodies.pairs()):
            assert (pairs[:, 0] < pairs[:, 1]).all() and (pairs < n).all()

    def save():
        other = bodies.copy()
        other.load(bodies.save())
        assert len(other) == n and other.validate()

    moves = [
        functools.partial(move, own, np.random.default_rng(len(own)))
        for own in (ids[:1400], ids[1400:])
    ]
    with repeated(*moves, query, query, update, update, save):
        time.sleep(0.5)
    bodies.update()
    assert bodies.validate()
    bodies.update_pairs()
    assert all(len(pairs) == 0 for pairs in bodies.update_pairs())
