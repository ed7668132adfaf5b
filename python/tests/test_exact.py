"""Trees that keep doubles: results are those of the doubles."""

import copy
import pickle

import halfspace as hs
import numpy as np
import pytest

from conftest import as_matrix, near_boxes, overlaps


@pytest.fixture
def boxes(rng, dims):
    return near_boxes(rng, 3000, dims)


def test_pairs(rng, dims, boxes):
    queries = near_boxes(rng, 2000, dims)
    tree, exact = hs.BVH(boxes, exact=True), hs.BVH(queries, exact=True)
    floats = hs.BVH(queries)
    expected = np.triu(overlaps(boxes, boxes), 1)
    assert (as_matrix(tree.pairs(threads=2), expected.shape) == expected).all()
    assert hs.BVH(boxes).pairs().shape[1] > 1.1 * expected.sum()
    some = tree.pairs_of(np.arange(50))
    either = expected.copy()
    either[50:] = False
    assert (as_matrix(np.sort(some).T, expected.shape) == either).all()
    for other, its in ((exact, queries), (floats, floats.boxes().astype(float))):
        expected = overlaps(its, boxes)
        assert (as_matrix(hs.join(other, tree), expected.shape) == expected).all()
        assert (as_matrix(hs.join(tree, other), expected.T.shape) == expected.T).all()
    margin = 0.125
    below = boxes[:, None, :dims] <= queries[None, :, dims:] + margin
    above = queries[None, :, :dims] <= boxes[:, None, dims:] + margin
    expected = (below & above).all(axis=2)
    found = hs.join(tree, exact, margin=margin)
    assert (as_matrix(found, expected.shape) == expected).all()


def test_pickle_with_other_doubles(boxes):
    make, (cls, blob, doubles) = hs.BVH(boxes, exact=True).__reduce_ex__(5)[:2]
    for size in (0, len(doubles) - 1, len(doubles) - boxes.shape[1], len(doubles) + 1):
        with pytest.raises(ValueError, match="^pickle of a halfspace.BVH: expected .*float64"):
            make(cls, blob, np.resize(doubles, size))


@pytest.mark.parametrize("exact", [True, False])
def test_changes(rng, dims, boxes, exact):
    if not exact:
        boxes = hs.BVH(boxes).boxes()
    tree = hs.BVH(boxes[:2000], exact=exact)

    def check(its, erased=()):
        expected = overlaps(boxes, its)
        expected[:, erased] = False
        found = tree.query(boxes)
        assert (as_matrix(found, expected.shape) == expected).all()
        np.testing.assert_array_equal(tree.boxes(), its)

    check(boxes[:2000])
    assert tree.insert(boxes[2000:2500]).tolist() == list(range(2000, 2500))
    tree.insert_as(np.arange(2500, 3000)[::-1], boxes[2500:][::-1])
    check(boxes)
    moved = boxes.copy()
    moved[7:100] = hs.BVH(near_boxes(rng, 93, dims), exact=exact).boxes()
    tree.refit(moved[7:100], np.arange(7, 100))
    check(moved)
    tree.erase([8, 2999])
    assert len(tree) == 2998
    tree.rebuild()
    moved = moved[:2999]
    moved[8] = boxes[0]
    check(moved, [8])
    tree.refit(boxes[:2999])
    moved = boxes[:2999].copy()
    moved[8] = boxes[0]
    check(moved, [8])
    for wrong, text in (
        ([7000, 7000], "ids: expected ids that no object has"),
        ([7000, 7], r"ids\[1\]: expected ids that no object has"),
        ([7000], "ids: expected one id for each of 2 boxes, got 1"),
        ([-1, 2], r"ids\[0\]: expected the id of an object, got -1"),
    ):
        with pytest.raises(ValueError, match=text):
            tree.insert_as(wrong, boxes[:2])
    check(moved, [8])
    if not exact:
        return
    pickles = [pickle.loads(pickle.dumps(tree, protocol)) for protocol in (2, 5)]
    for same in (copy.copy(tree), *pickles):
        assert (same.query(boxes) == tree.query(boxes)).all() and same.insert(boxes[9]) >= 0
        assert same.nbytes > hs.BVH(moved).nbytes + moved.nbytes
    for call in (tree.blob, lambda: tree.save("x")):
        with pytest.raises(TypeError, match="pickle an exact one"):
            call()
    assert tree.boxes([9, 8, 9]).tolist() == boxes[[9, 0, 9]].tolist()
