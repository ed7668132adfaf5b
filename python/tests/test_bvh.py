"""Results of the BVH, compared with NumPy."""

import copy
import pickle

import halfspace as hs
import numpy as np
import pytest

from conftest import as_matrix, near_boxes, overlaps, random_boxes


@pytest.fixture
def queries(rng, dims):
    return random_boxes(rng, 1500, dims)


def bodies_of(boxes):
    bodies = hs.BroadPhase(boxes.shape[1] // 2)
    bodies.insert(np.arange(len(boxes)), boxes)
    return bodies


@pytest.fixture(params=[hs.BVH, bodies_of])
def tree_of(request):
    return request.param


KINDS = {"tree": hs.BVH, "fast tree": lambda boxes: hs.BVH(boxes, quality="fast"),
         "exact tree": lambda boxes: hs.BVH(boxes, exact=True),
         "exact tree, float queries": lambda boxes: hs.BVH(boxes, exact=True), "bodies": bodies_of,
         "scan": hs.Scan, "quantized scan": lambda boxes: hs.Scan(boxes, quantized=True)}


def test_query_extents(rng):
    points = rng.random((20000, 3)) * [1, 1, 10000]
    line = [0.02, 0.02, np.inf]
    for quality in "high", "fast":
        with pytest.warns(UserWarning, match="does not limit axis 2.*query_extents"):
            blind = hs.BVH((points, points), quality=quality)
        told = hs.BVH((points, points), quality=quality, query_extents=line)
        assert told.expected_leaves(line) < 8 < 80 < blind.expected_leaves(line)
        boxes = np.hstack([points[:50] - 0.01, points[:50] + 0.01])
        boxes[:, [2, 5]] = -np.inf, np.inf
        blindly, knowingly = (as_matrix(tree.query(boxes), (50, 20000)) for tree in (blind, told))
        assert (blindly == knowingly).all() and blindly.sum() >= 50
        blind.rebuild(query_extents=line)
        assert blind.expected_leaves(line) < 8
        blind.rebuild()
        assert blind.expected_leaves(line) < 8
    for wrong in [1, 2], [1, 1, -1], [1, 1, np.nan], "abc":
        with pytest.raises(ValueError, match="query_extents"):
            hs.BVH((points[:5], points[:5]), query_extents=wrong)


# More than 4095 queries are joined with a tree.
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n, queried",
                         [(0, 9), (1, 9), (64, 9), (65, 9), (2000, 1500), (2000, 5000)])
def test_query(rng, dims, kind, n, queried):
    cells = {2: 60, 3: 24}[dims]
    boxes, queries = (near_boxes(rng, count, dims, cells) for count in (n, queried))
    with np.errstate(over="ignore"):
        if kind != "exact tree":
            queries = np.float32(queries)
        if not kind.startswith("exact"):
            boxes = np.float32(boxes)
            # The query of everything can find the empty box, and vice versa.
            queries[:2] = queries[-2:]
    its = KINDS[kind](boxes)
    assert len(its) == n and its.dims == dims
    is_scan = isinstance(its, hs.Scan)
    masks = 1 << np.arange(n) % 4
    if kind == "bodies":
        its.set_masks(np.arange(n), masks, 0)
    elif not is_scan:
        its.set_masks(masks)
    everything = overlaps(queries, boxes)
    for how in ({},) if is_scan else ({}, {"mask": 12}):
        expected = everything & (masks & 12 != 0) if how else everything
        for threads in (1, 2):
            found = its.query(queries, threads=threads, **how)
            assert found.dtype == np.int64
            assert (as_matrix(found, expected.shape) == expected).all()
            assert (np.diff(found[0]) >= 0).all()
            counts = its.count(queries, threads=threads, **how)
            assert counts.dtype == np.int64 and (counts == expected.sum(axis=1)).all()
            assert (its.any(queries, threads=threads, **how) == expected.any(axis=1)).all()
        for query, row in zip(queries[:9], expected):
            for one in (query, query.astype(float), query.tolist()):
                assert sorted(its.query(one, **how)) == np.flatnonzero(row).tolist()
                assert its.count(one, **how) == row.sum()
                assert its.any(one, **how) is bool(row.any())
        if is_scan:
            assert (np.lexsort(found[::-1]) == np.arange(found.shape[1])).all()
            assert (its.mask(queries, threads=2) == expected).all()
            assert (its.mask(queries[0]) == expected[0]).all()
    assert its.query(queries[:0]).shape == (2, 0)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("exact")])
def test_doubles_are_rounded_outward(kind):
    its = KINDS[kind](np.array([[0, 0, 1 - 1e-12, 1], [0, 3, 1, 4]]))
    assert its.query([1, 0, 2, 1]).tolist() == [0]
    assert its.query(np.array([1 + 1e-12, 3, 2, 3])).tolist() == [1]


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("most", [1, 7, 100, 10**7])
def test_query_batches(rng, dims, most, exact):
    boxes, queries = near_boxes(rng, 2000, dims)[6:], near_boxes(rng, 1500, dims)[6:]
    tree = hs.BVH(boxes, exact=exact)
    expected = in_order(tree.query(queries))
    rest = tree.query_batches(queries, most)
    first = next(rest)
    with pytest.raises(ValueError):
        tree.erase([9999])  # a failed change is no change
    batches = [first, *rest]
    assert all(0 < batch.shape[1] <= most for batch in batches)
    if most >= 100:  # which no row has alone
        assert len(batches) < 2 * expected.shape[1] / most + 2
    assert (in_order(np.concatenate(batches, axis=1)) == expected).all()


def in_order(found):
    """Results with the ids of each row in ascending order."""
    assert (np.diff(found[0]) >= 0).all()
    return found[:, np.lexsort(found[::-1])]


CHANGES = {"one": lambda tree: tree.erase(0), "all": lambda tree: tree.erase(np.arange(len(tree))),
           "moved": lambda tree: tree.refit(tree.boxes() + 5000),
           "more": lambda tree: tree.insert([9] * 2 * tree.dims)}


@pytest.mark.parametrize("most", [1, 10, 10**7])
@pytest.mark.parametrize("change", CHANGES)
def test_query_batches_of_a_tree_that_changes(boxes, queries, change, most):
    tree = hs.BVH(boxes)
    batches = tree.query_batches(queries, most)
    next(batches)
    CHANGES[change](tree)
    with pytest.raises(RuntimeError, match="changed during query_batches"):
        list(batches)
    batches = tree.query_batches(queries, most)  # none was taken yet
    tree.insert(boxes[0])
    with pytest.raises(RuntimeError, match="changed during query_batches"):
        list(batches)


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("call", ["count", "query"])
def test_query_batches_of_a_tree_that_another_thread_changes(boxes, queries, call, change):
    """The change is between two steps of one batch."""
    tree = hs.BVH(boxes)

    class Changing:
        def __getattr__(self, name):
            def changing(*arguments):
                found = getattr(inner, call)(*arguments)
                CHANGES[change](hs.BVH._of(inner))
                return found

            return changing if name == call else getattr(inner, name)

    inner, tree._tree = tree._tree, Changing()
    with pytest.raises(RuntimeError, match="changed during query_batches"):
        list(tree.query_batches(queries))


def distances_of(points, boxes):
    """Between all points, or boxes, and all boxes, as doubles."""
    dims = boxes.shape[1] // 2
    a, b = np.float64(points)[:, None], np.float64(boxes)[None]
    gap = np.maximum(b[..., :dims] - a[..., -dims:], a[..., :dims] - b[..., dims:])
    return np.linalg.norm(np.maximum(gap, 0), axis=2)


def far_and_huge(dims):
    """Boxes on a grid, many of them equal, and empty, infinite and huge ones."""
    corners = np.random.default_rng(5).integers(0, 6, (2000, dims)).astype(float)
    boxes = np.hstack([corners, corners + 1])
    inf = [np.inf] * dims
    boxes[:4] = [inf + [-np.inf] * dims, [-1e30] * dims + [-9e29] * dims,
                 [9e38] * 2 * dims, [50] * dims + inf]
    return boxes


@pytest.mark.parametrize("k", [1, 5, 5000])  # 5000 are more than the results of a part
@pytest.mark.parametrize("exclusive", [False, True])
def test_all_ties(rng, dims, tree_of, k, exclusive):
    boxes = far_and_huge(dims)
    tree = tree_of(boxes)
    points = np.vstack([rng.integers(-2, 9, (60, dims)), [[80] * dims], [[1e25] * dims]])
    queries = np.hstack([points, points + 1.0])
    queries[-1] = [np.inf] * dims + [-np.inf] * dims
    for given in (points, queries):
        (rows, ids), distances = tree.nearest(
            given, k, max_distance=2, all_ties=True, exclusive=exclusive
        )
        exact = distances_of(np.float32(given), np.float32(boxes).clip(-1e38, np.inf))
        exact[np.isnan(exact) | (exact > 2)] = np.inf
        if exclusive:
            its = np.hstack([given, given]) if given is points else given
            exact[(its[:, None] == boxes[None]).all(axis=2)] = np.inf
        by_distance = np.sort(np.pad(exact, ((0, 0), (0, k)), constant_values=np.inf), axis=1)
        expected = np.isfinite(exact) & (exact <= by_distance[:, k - 1, None])
        assert (as_matrix(np.stack([rows, ids]), expected.shape) == expected).all()
        assert (distances == np.float32(exact[rows, ids])).all()
        assert (np.diff(rows) >= 0).all() and len(ids) > 1000
        near, far = tree.nearest(given, k, max_distance=2, exclusive=exclusive, threads=2)
        assert far.shape == (len(given), min(k, len(boxes)))
        assert (far == np.float32(by_distance[:, : far.shape[1]])).all()
        its_rows, rank = np.nonzero(near >= 0)
        assert len(rank) == np.isfinite(far).sum()
        its = near[its_rows, rank]
        assert (np.float32(exact[its_rows, its]) == far[its_rows, rank]).all()
        one, of_one = tree.nearest(given[3], k, max_distance=2, all_ties=True, exclusive=exclusive)
        assert (one == ids[rows == 3]).all() and (of_one == distances[rows == 3]).all()
    assert tree.nearest(points[:0], all_ties=True)[0].shape == (2, 0)
    assert tree_of(boxes[:3]).nearest(points[0], 2**31 - 1)[0].shape == (3,)
    assert tree_of(boxes[:0]).nearest(points[0], 2**31 - 1)[0].tolist() == [-1]


@pytest.mark.parametrize("call", ["raycast", "boxcast", "spherecast"])
def test_casts(rng, dims, tree_of, call):
    """Compared with the slabs. No cast meets an edge, and the spheres have no size."""
    boxes = far_and_huge(dims)
    tree = tree_of(boxes)
    low = np.float32(rng.random((700, dims)) * 8 - 1)
    high = low + np.float32(0.5 if call == "boxcast" else 0)
    starts = np.hstack([low, high]) if call == "boxcast" else low.astype(float)
    ways = np.float32(rng.random((700, dims)) - 0.5).astype(float)
    with np.errstate(invalid="ignore", over="ignore"):
        a = (boxes[None, :, :dims] - high[:, None]) / ways[:, None]
        b = (boxes[None, :, dims:] - low[:, None]) / ways[:, None]
    enter = np.minimum(a, b).max(axis=2).clip(0)
    expected = enter <= np.maximum(a, b).min(axis=2).clip(None, 9)
    expected[:, 0] = False  # empty

    def cast(rows, ways, **how):
        radii = [0] if call == "spherecast" else []
        return getattr(tree, call)(starts[rows], *radii, ways, 9, **how)

    for threads in (1, 2):
        (rows, ids), t = cast(slice(None), ways, all_hits=True, threads=threads)
        assert (as_matrix(np.stack([rows, ids]), expected.shape) == expected).mean() > 0.9999
        assert np.allclose(t, enter[rows, ids], 1e-4, 1e-4) and (t <= enter[rows, ids]).all()
        assert (np.lexsort((ids, t, rows)) == np.arange(len(t))).all()
        first, its_t = cast(slice(None), ways, threads=threads)
        begins = np.flatnonzero(np.diff(rows, prepend=-1))
        assert (first >= 0).sum() == len(begins)
        assert (first[rows[begins]] == ids[begins]).all()
        assert (its_t[rows[begins]] == t[begins]).all()
    assert (cast(slice(None), ways, mask=0)[0] == -1).all()
    assert np.array_equal(cast(5, ways), cast([5] * 700, ways))
    one, of_one = cast(5, ways[5], all_hits=True)
    assert (one == ids[rows == 5]).all() and (of_one == t[rows == 5]).all()
    assert cast(slice(0), ways[:0], all_hits=True)[0].shape == (2, 0)


def test_casts_of_spheres(dims, tree_of):
    boxes = np.array([[4] * dims + [5] * dims, [8] * dims + [9] * dims])
    tree = tree_of(boxes)
    up = [1] + [0] * (dims - 1)
    middle = [0] + [4.5] * (dims - 1)
    assert tree.spherecast(middle, 0.5, up) == (0, pytest.approx(3.5, abs=1e-4))
    assert tree.spherecast(middle, 0, up) == tree.raycast(middle, up)
    assert tree.spherecast(middle, 0.5, up, 3.4) == (-1, np.inf)
    # Beside the edge at Y = 4: a box of the sphere's size would touch at 3.
    beside = [0, 3.5] + [4.5] * (dims - 2)
    ids, t = tree.spherecast([beside, middle], [1, 0.25], up)
    assert ids.tolist() == [0, 0]
    assert t == pytest.approx([4 - 0.75**0.5, 3.75], abs=1e-4)


def are_within(a, b, distance):
    a, b = a.astype(float)[:, None], b.astype(float)
    dims = b.shape[1] // 2
    with np.errstate(invalid="ignore", over="ignore"):
        gaps = np.fmax(a[..., :dims] - b[:, dims:], b[:, :dims] - a[..., dims:])
        return (np.fmax(gaps, 0) ** 2).sum(axis=2) <= distance**2


@pytest.mark.parametrize("exact", [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("n", [0, 1, 64, 65, 2000])
def test_pairs_and_join(rng, dims, n, exact):
    """Of two trees, one of which can be exact. Then the join is, too."""
    skip = 0 if any(exact) else 2  # the box of everything can find the empty box
    tree, other = (hs.BVH(near_boxes(rng, count + skip, dims)[skip:], exact=its)
                   for count, its in zip((n, 1500), exact))
    boxes, others = tree.boxes(), other.boxes()
    # Results do not depend on the number of threads.
    on_two_threads = hs.BVH(boxes, exact=exact[0], threads=2)
    assert pickle.dumps(on_two_threads) == pickle.dumps(tree)
    assert np.array_equal(tree.pairs(), tree.pairs(threads=2))
    for margin in (0, 0.125) if any(exact) else (0,):
        wide = boxes + np.repeat([-margin, margin], dims)
        expected = np.triu(overlaps(wide, boxes), 1)
        found = tree.pairs(margin=margin, threads=None)
        assert (as_matrix(found, expected.shape) == expected).all()
        expected[50:] = False
        found = np.sort(tree.pairs_of(np.arange(min(n, 50)), margin=margin)).T
        assert (as_matrix(found, expected.shape) == expected).all()
        expected = overlaps(wide, others)
        for found in (hs.join(tree, other, margin=margin),
                      hs.join(other, tree, margin=margin, threads=2)[::-1]):
            assert (as_matrix(found, expected.shape) == expected).all()
    expected = are_within(boxes, others, 0.125)
    for found in (hs.join(tree, other, within=0.125),
                  hs.join(other, tree, within=0.125, threads=2)[::-1]):
        assert (as_matrix(found, expected.shape) == expected).all()
    expected = np.triu(are_within(boxes, boxes, 0.125), 1)
    assert (as_matrix(tree.pairs(within=0.125), expected.shape) == expected).all()
    assert pickle.loads(pickle.dumps(tree)).dims == dims
    assert (tree.nearest([5e5] * dims)[0] >= 0) == (n > 0)
    tree.insert(others[6:])
    assert tree.any(others[6:]).all() and len(tree) == len(boxes) + 1494


@pytest.mark.parametrize("exact", [False, True])
def test_many_queries_of_a_small_tree(rng, dims, exact):
    """More than one tree of queries holds. Fewer than 4096 have none."""
    tree = hs.BVH(random_boxes(rng, 300, dims, 0.1, np.float64), exact=exact)
    queries = random_boxes(rng, 2**18 + 5000, dims, 0.01, np.float64)
    done = []
    rows, ids = tree.query(queries, threads=2, progress=lambda *its: done.append(its))
    assert done == sorted(done) and done[-1] == (len(queries), len(queries))
    for some in (slice(0, 4000), slice(2**18 - 2000, 2**18 + 2000), slice(2**18 + 1001, None)):
        its = (some.start <= rows) & (rows < (some.stop or len(queries)))
        found = np.array([rows[its] - some.start, ids[its]])
        assert (in_order(found) == in_order(tree.query(queries[some]))).all()


@pytest.mark.parametrize("exact", [False, True])
def test_many_queries_of_a_large_tree(rng, dims, exact):
    """They are sorted first. Fewer are not, and find the same."""
    size = 1_000_000 if dims == 2 else 200_000
    side = 2 * size ** (-1 / dims)
    boxes = random_boxes(rng, size, dims, side, np.float64)
    boxes[:100] *= 1e6
    tree = hs.BVH(boxes, quality="fast", exact=exact)
    queries = random_boxes(rng, 9000, dims, side, np.float64)
    queries[::1000] = boxes[:9]
    queries[5] = [np.inf] * dims + [-np.inf] * dims
    queries[7] = [-np.inf] * dims + [-1e6] * dims
    points = queries[:, :dims].copy()
    points[[5, 7]] = 0
    radii = rng.random(9000) * side
    ways = rng.normal(size=(9000, dims))
    calls = [lambda some: tree.query(queries[some]),
             lambda some: tree.query(queries[some].astype(np.float32), threads=2),
             lambda some: tree.query(queries[some], within=radii[some]),
             lambda some: tree.query_sphere(points[some], radii[some]),
             lambda some: tree.nearest(points[some], 3, all_ties=True)[0],
             lambda some: tree.raycast(points[some], ways[some], 0.1, all_hits=True)[0]]
    few = [slice(0, 5000), slice(5000, 9000)]
    for call in calls:
        found = [call(some) for some in few]
        found[1][0] += 5000
        assert found[0].size
        whole = call(slice(None))
        assert (in_order(whole) == in_order(np.concatenate(found, axis=1))).all()
    for call in [
        lambda some: [tree.count(queries[some], threads=2)],
        lambda some: [tree.any(queries[some])],
        lambda some: tree.nearest(points[some], 3, threads=2),
        lambda some: tree.raycast(points[some], ways[some], threads=2),
        lambda some: tree.spherecast(points[some], radii[some], ways[some], 0.1),
        lambda some: tree.boxcast(np.hstack([points, points + 0.01])[some], ways[some], 0.1),
    ]:
        for whole, *found in zip(call(slice(None)), *map(call, few)):
            assert np.array_equal(whole, np.concatenate(found))
    many = np.resize(queries, (2**20 + 100, 2 * dims))  # sorted in parts
    assert (tree.count(many) == np.resize(tree.count(queries), len(many))).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("each", [False, True])
def test_what_is_within_a_distance(rng, dims, tree_of, dtype, each):
    """On a grid, so that floats are exact."""
    corners = rng.integers(0, 40, (1500, dims)).astype(dtype)
    boxes, centers = np.hstack([corners, corners + 1]), corners[::-1]
    queries = np.hstack([centers, centers + 2])
    tree = tree_of(boxes)
    within = np.arange(len(queries)) % 8 / 2 if each else 2.5
    limits = np.broadcast_to(within, len(queries))
    for call, its in ((lambda some, limit: tree.query(queries[some], within=limit), queries),
                      (lambda some, limit: tree.query_sphere(centers[some], limit), centers)):
        expected = distances_of(its, boxes) <= limits[:, np.newaxis]
        found = call(slice(None), within)
        assert (as_matrix(found, expected.shape) == expected).all()
        assert (np.diff(found[0]) >= 0).all()
        assert sorted(call(3, limits[3])) == np.flatnonzero(expected[3]).tolist()


def test_limits_and_distances_of_doubles_are_rounded_outward(tree_of):
    tree = tree_of(np.array([[0, 0, 1, 1], [5, 7, 6, 8]]))
    # Boxes whose nearest floats are farther away.
    assert tree.query([1 + 0.75 * 2**-23, 0, 2, 1], within=0.75 * 2**-23).tolist() == [0]
    assert tree.query([4, 7, 5 - 0.75 * 2**-21, 8], within=0.75 * 2**-21).tolist() == [1]
    just_above = np.nextafter(1.25, 2)
    box = np.array([just_above, 0, 2, 1])
    assert tree.query(box, within=just_above - 1).tolist() == [0]
    assert tree.query(box, within=0.25).tolist() == [0]
    assert tree.query(box, within=0.2499).tolist() == []
    assert tree.query_sphere([just_above, 0.5], 0.25).tolist() == [0]
    far = tree_of(np.array([[5e5, 0, 5e5 + 1, 1]]))
    assert far.query_sphere([5e5 + 1.02, 0.5], 0.021).tolist() == [0]
    assert tree.query_sphere([3.001, 0.5], 2.0).tolist() == []
    # 0.1 is no float, nor is 1e300: they are rounded up, and an object at the limit is found.
    assert tree.nearest([1.1, 0], max_distance=1.1 - 1)[0].tolist() == [0]
    away = tree_of(np.array([[0.1, 0, 1, 1]]))
    assert away.raycast([0, 0], [1, 0], 0.1)[0] == away.raycast([0, 0], [1, 0], 1e300)[0] == 0
    assert away.raycast([0, 0], [1, 0], 0.09) == (-1, np.inf)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_infinite_spheres_are_boxes_with_a_distance(dims, tree_of, dtype):
    inf, rest = np.inf, [0.5] * (dims - 1)
    sides = np.array([(0, 1), (-inf, 1), (0, inf), (-inf, inf), (2.0**121, 2.0**122)])
    boxes = np.zeros((len(sides), 2 * dims))
    boxes[:, [0, dims]], boxes[:, dims + 1 :] = sides, 1
    tree = tree_of(boxes)
    for x, expected in ((inf, [2, 3]), (-inf, [1, 3]), (2.0**121, [2, 3, 4]), (0.5, [0, 1, 2, 3])):
        center = np.array([x] + rest, dtype)
        assert sorted(tree.query_sphere(center, 1)) == expected
        assert sorted(tree.query_sphere([center, rest + [0.5]], 1)[1][: len(expected)]) == expected
        for radius in (1, 1e30, inf) if abs(x) > 1 else (1,):
            found = tree.query_sphere(center, radius)
            assert sorted(found) == sorted(tree.query([*center, *center], within=radius))
        assert sorted(tree.query_sphere(center, inf)) == [0, 1, 2, 3, 4]
    assert tree.query_sphere([inf] * dims, 1).tolist() == []


def test_masks_margins_and_order(rng, dims, boxes, queries):
    masks = (1 << rng.integers(0, 4, len(boxes))).astype(np.uint32)
    tree, other = hs.BVH(boxes), hs.BVH(queries)
    tree.set_masks(masks)
    expected = overlaps(queries, boxes) & ((masks & 6) != 0)
    batches = np.hstack(list(tree.query_batches(queries, 50, mask=6)))
    assert (as_matrix(batches, expected.shape) == expected).all()
    ids, _ = tree.nearest(queries, 2, mask=8)
    assert (masks[ids] == 8).all()
    assert set(masks[tree.query_sphere([0.5] * dims, 0.4, mask=8)]) == {8}
    ids, _ = tree.raycast(queries[:, :dims], [1] * dims, mask=8)
    assert (masks[ids[ids >= 0]] == 8).all() and (ids >= 0).any()

    margin = 0.1  # no float32
    wide = boxes.astype(float)
    wide[:, :dims] -= np.float32(margin)
    wide[:, dims:] += np.float32(margin)
    in_mask = (masks & 6) != 0
    expected = np.triu(overlaps(wide, boxes.astype(float)), 1)
    found = as_matrix(tree.pairs(margin=margin, threads=2), expected.shape)
    assert (found == expected).mean() > 0.9999 and found[np.triu(overlaps(boxes, boxes), 1)].all()
    found &= in_mask & in_mask[:, None]
    assert (as_matrix(tree.pairs(margin=margin, mask=6), expected.shape) == found).all()
    expected = overlaps(queries.astype(float), wide) & in_mask
    found = hs.join(other, tree, margin=margin, mask=6)
    assert (as_matrix(found, expected.shape) == expected).mean() > 0.9999
    assert len(tree.pairs_of(np.arange(len(boxes)))) == tree.pairs().shape[1]

    tree.set_masks(16, [3, 5])
    tree.set_masks([32, 64], ids=[4, 6])
    everything = [-9] * dims + [9] * dims
    assert sorted(tree.query(everything, mask=16)) == [3, 5]
    assert sorted(tree.query(everything, mask=96)) == [4, 6]
    assert tree.cost_ratio == 1
    tree.refit(rng.permutation(boxes))
    before = tree.cost_ratio
    assert before > 1.5
    tree.erase([0])
    tree.rebuild(quality="fast", threads=2)
    assert tree.cost_ratio == 1 and len(tree) == len(boxes) - 1
    assert sorted(tree.query(everything, mask=96)) == [4, 6]


@pytest.mark.parametrize("exact", [True, False])
def test_changes(rng, dims, exact):
    boxes = near_boxes(rng, 3000, dims)
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
    for wrong, text in (([7000, 7000], "ids: expected ids that no object has"),
                        ([7000, 7], r"ids\[1\]: expected ids that no object has"),
                        ([7000], "ids: expected one id for each of 2 boxes, got 1"),
                        ([-1, 2], r"ids\[0\]: expected the id of an object, got -1")):
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
