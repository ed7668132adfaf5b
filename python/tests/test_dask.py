"""halfspace.dask on a cluster of two processes: results are those of one process."""

import os
import signal

import numpy as np
import pytest

distributed = pytest.importorskip("distributed")

import dask.array  # noqa: E402
import dask.sizeof  # noqa: E402

import halfspace as hs  # noqa: E402
import halfspace.dask as hd  # noqa: E402


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def uniform(rng, n, dims=3, size=0.02):
    low = rng.random((n, dims))
    return np.hstack([low, low + rng.random((n, dims)) * size])


def skewed(rng, n, dims=3):
    """90 % of the objects in 1 % of the volume, and one box that has everything."""
    side = 0.01 ** (1 / dims)
    boxes = uniform(rng, n, dims, 0.002)
    some = boxes[:n * 9 // 10]
    some[:, :dims] *= side
    some[:, dims:] = some[:, :dims] + 0.002 * rng.random((len(some), dims))
    boxes[-1] = [0] * dims + [1] * dims
    return rng.permutation(boxes)


def special(rng, n, dims=3):
    """Empty, infinite and equal boxes among others."""
    boxes = uniform(rng, n, dims)
    boxes[::7] = [np.inf] * dims + [-np.inf] * dims
    boxes[3] = [-np.inf] * dims + [np.inf] * dims
    boxes[5, 0] = -np.inf
    boxes[100:200] = boxes[100]
    return boxes


def chunked(boxes, chunk=700):
    return dask.array.from_array(boxes, chunks=(chunk, -1))


def pairs_of(batches, key=lambda i, j: (i, j)):
    found = [np.stack(batch, 1) for batch in batches]
    found = np.concatenate([np.empty((0, 2), np.int64), *found])
    return found[np.lexsort((found[:, 1], found[:, 0]))]


WORLDS = [uniform, skewed, special]


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("world", WORLDS)
def test_answers_are_those_of_one_process(client, world, dims):
    rng = np.random.default_rng(1)
    boxes = world(rng, 5000, dims)
    probes = world(rng, 2100, dims)
    tree = hd.BVH(chunked(boxes), partitions=5)
    one = hs.BVH(boxes)
    assert len(tree) == 5000
    assert tree.sizes.sum() == 5000

    np.testing.assert_array_equal(pairs_of(tree.query(chunked(probes))),
                                  pairs_of([one.query(probes)]))
    i, j = one.pairs()
    np.testing.assert_array_equal(pairs_of(tree.pairs()),
                                  pairs_of([(np.minimum(i, j), np.maximum(i, j))]))
    other = hd.BVH(probes, partitions=3)
    np.testing.assert_array_equal(pairs_of(hd.join(tree, other)),
                                  pairs_of([hs.join(one, hs.BVH(probes))]))
    np.testing.assert_array_equal(pairs_of(hd.scan(chunked(boxes), probes[:10])),
                                  pairs_of([one.query(probes[:10])]))


@pytest.mark.parametrize("k, max_distance", [(1, np.inf), (8, np.inf), (8, 0.02),
                                             (1500, np.inf), (3, 0)])
@pytest.mark.parametrize("world", WORLDS)
def test_nearest_is_that_of_one_process(client, world, k, max_distance):
    rng = np.random.default_rng(2)
    boxes = world(rng, 2000)
    points = rng.random((900, 3)) * 1.4 - 0.2
    tree = hd.BVH(boxes, partitions=6)
    ids, distances = hs.BVH(boxes).nearest(points, k=k, max_distance=max_distance)
    distances = distances.reshape(len(points), k)
    seen = np.zeros(len(points), bool)
    for rows, found, far in tree.nearest(chunked(points, 250), k, max_distance):
        seen[rows] = True
        np.testing.assert_array_equal(far, distances[rows])
        assert ((found < 0) == np.isinf(far)).all()
        for row, of_row, far_of_row in zip(rows[:20], found, far):
            real = of_row[of_row >= 0]
            assert len(np.unique(real)) == len(real)
            low = np.maximum(boxes[real, :3] - points[row], points[row] - boxes[real, 3:])
            exact = np.linalg.norm(np.maximum(low, 0), axis=1)
            np.testing.assert_allclose(exact, far_of_row[:len(real)], rtol=1e-4, atol=1e-6)
    assert seen.all()


def test_partitions_share_skewed_work(client):
    rng = np.random.default_rng(3)
    boxes = skewed(rng, 20000)
    for balance in ("objects", "pairs"):
        sizes = hd.BVH(chunked(boxes, 5000), partitions=8, balance=balance).sizes
        assert sizes.max() < 1.5 * 20000 / 8 * (2 if balance == "pairs" else 1)
    # A dense knot has nearly all pairs: it becomes more partitions by pairs.
    knot = uniform(rng, 20000, size=0.001)
    knot[:2000] = uniform(rng, 2000, size=0.2) * 0.1
    def most_pairs(balance):
        tree = hd.BVH(chunked(knot, 5000), partitions=8, balance=balance)
        return max(hs.BVH(knot[:2000]).count(bounds[None])[0] for bounds in tree.bounds)
    assert most_pairs("pairs") < 0.7 * most_pairs("objects")


def test_batches_are_bounded(client):
    rng = np.random.default_rng(4)
    boxes = uniform(rng, 3000, size=0.2)
    boxes[0] = [-1, -1, -1, 2, 2, 2]  # a row with more pairs than a batch
    one = hs.BVH(boxes)
    expected = pairs_of([one.query(boxes)])
    most_of_row = one.count(boxes).max()
    assert most_of_row == 3000
    tree = hd.BVH(boxes, partitions=2)
    batches = list(tree.query(boxes, max_results=500))
    assert all(len(rows) <= 500 or (rows == rows[0]).all() for rows, _ in batches)
    np.testing.assert_array_equal(pairs_of(batches), expected)


def test_few_batches_wait(client):
    """A range of rows is searched when a batch before it was taken."""
    rng = np.random.default_rng(10)
    boxes = uniform(rng, 2000, size=0.3)
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    tree = hd.BVH(boxes, partitions=1)
    submitted = []
    submit = tree._run.submit

    def count(function, *arguments):
        submitted.append(function)
        return submit(function, *arguments)

    tree._run.submit = count
    batches = tree.query(boxes, max_results=2000)
    found = []
    for batch in batches:
        found.append(batch)
        # Two tasks for each thread run or wait.
        assert submitted.count(hd._some_pairs) < len(found) + 2 * tree._run.threads
    assert len(found) > 50
    np.testing.assert_array_equal(pairs_of(found), expected)


def test_many_small_results():
    """A stream has one job after another, and not one inside another."""
    class Future:
        status = "finished"

        def result(self):
            return 1

    class Completed(list):
        add = list.append
        __next__ = list.pop

    run = hd._Runner.__new__(hd._Runner)
    run.threads = 1
    real, distributed.as_completed = distributed.as_completed, Completed
    try:
        jobs = ((Future(), lambda result: (result, [])) for _ in range(100_000))
        assert sum(run.stream(jobs)) == 100_000
    finally:
        distributed.as_completed = real


def test_workers_write_files(client, tmp_path):
    rng = np.random.default_rng(5)
    boxes = uniform(rng, 3000, size=0.1)
    tree = hd.BVH(boxes, partitions=3)
    others = tree.query(boxes[:1], to=tmp_path / "pairs")
    paths = tree.pairs(max_results=1000, to=tmp_path / "pairs")
    assert len(os.listdir(tmp_path / "pairs")) == len(paths) + len(others)
    for path in others:
        os.unlink(path)
    assert len(paths) > 3 and sorted(os.listdir(tmp_path / "pairs")) == [
        os.path.basename(path) for path in paths]
    i, j = hs.BVH(boxes).pairs()
    np.testing.assert_array_equal(pairs_of(map(np.load, paths)),
                                  pairs_of([(np.minimum(i, j), np.maximum(i, j))]))


def test_sources(client, tmp_path):
    rng = np.random.default_rng(6)
    boxes = uniform(rng, 3000).astype(np.float32)
    expected = pairs_of([hs.BVH(boxes).query(boxes[:50])])
    paths = []
    for n, begin in enumerate((0, 1000, 1000)):
        paths.append(tmp_path / f"{n}.npy")
        np.save(paths[-1], boxes[begin:] if n == 2 else boxes[begin:begin + 1000 * (n == 0)])
    np.save(tmp_path / "all.npy", boxes)
    for source in (boxes, boxes.tolist(), paths, tmp_path / "all.npy", dask.array.from_array(boxes, (800, 2))):
        found = hd.BVH(source, partitions=4).query(boxes[:50])
        np.testing.assert_array_equal(pairs_of(found), expected)


def test_mapped_partitions(client):
    rng = np.random.default_rng(7)
    boxes = uniform(rng, 3000)
    tree = hd.BVH(boxes, partitions=3, mapped=True)
    sizes = client.run(lambda dask_worker: [dask.sizeof.sizeof(value)
                                            for value in dask_worker.data.values()
                                            if isinstance(value, hd._Partition)])
    sizes = sum(sizes.values(), [])
    assert len(sizes) == 3 and max(sizes) < 3000 * 8 < tree.nbytes
    # A copy is in memory.
    copy = tree._partitions[0].result()
    assert dask.sizeof.sizeof(copy) == copy.tree.nbytes + copy.rows.nbytes
    np.testing.assert_array_equal(pairs_of(tree.query(boxes)),
                                  pairs_of([hs.BVH(boxes).query(boxes)]))


def test_few_objects(client):
    nothing = np.empty((0, 6))
    tree = hd.BVH(nothing)
    assert len(tree) == 0
    assert list(tree.query(np.ones((3, 6)))) == [] and list(tree.pairs()) == []
    (rows, ids, distances), = tree.nearest(np.zeros((2, 3)), k=2)
    assert rows.tolist() == [0, 1]
    assert (ids == -1).all() and np.isinf(distances).all()
    # Equal boxes are in one partition, and the others are empty.
    same = hd.BVH(np.tile([0, 0, 0, 1, 1, 1.0], (5, 1)), partitions=3)
    (rows, ids, distances), = same.nearest([[0, 0, 0], [np.inf, 0, 0]], k=10)
    assert ids.tolist() == [[0, 1, 2, 3, 4] + [-1] * 5, [-1] * 10]
    tree = hd.BVH(np.ones((2, 6)), partitions=8)
    assert pairs_of(tree.pairs()).tolist() == [[0, 1]]
    assert list(tree.query(nothing)) == []


def test_a_killed_worker_loses_nothing(client):
    rng = np.random.default_rng(8)
    boxes = uniform(rng, 30000)
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    tree = hd.BVH(chunked(boxes, 5000), partitions=6)
    batches = tree.query(chunked(boxes, 1000), max_results=1000)
    found = list(batches.__next__() for _ in range(3))
    workers = client.run(os.getpid)
    os.kill(next(iter(workers.values())), signal.SIGKILL)
    found += batches
    assert client.run(os.getpid) != workers
    np.testing.assert_array_equal(pairs_of(found), expected)


def test_a_tree_is_accounted_with_its_bytes():
    tree = hs.BVH(np.random.default_rng(9).random((10000, 3)).repeat(2, 1)[:, [0, 2, 4] * 2])
    assert dask.sizeof.sizeof(tree) == tree.nbytes > 10000 * 24


MASKED = np.ma.array(np.ones((2, 6)), mask=np.ones((2, 6)))


@pytest.mark.parametrize("call", [
    lambda: hd.BVH(MASKED),
    lambda: hd.BVH(dask.array.from_array(MASKED, asarray=False), partitions=1),
    lambda: hd.BVH(dask.array.from_array(MASKED, asarray=False), partitions=2),
    lambda: list(hd.BVH(np.ones((3, 6))).query(MASKED)),
    lambda: list(hd.BVH(np.ones((3, 6))).query(
        dask.array.from_array(MASKED, asarray=False))),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest(MASKED[:, :3])),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest(
        dask.array.from_array(MASKED[:, :3], asarray=False))),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest(np.ones((3, 3)), k=np.ma.array(1, mask=1))),
    lambda: list(hd.scan(np.ones((3, 6)), MASKED)),
    lambda: list(hd.scan(MASKED, np.ones((3, 6)))),
    lambda: list(hd.scan(dask.array.from_array(MASKED, asarray=False), np.ones((3, 6)))),
])
def test_masked_values_are_refused(client, call):
    with pytest.raises(TypeError, match="expected no masked values"):
        call()


@pytest.mark.parametrize("call, message", [
    (lambda: hd.BVH(np.ones((3, 5))), r"boxes must have the shape \(n, 4\) or \(n, 6\)"),
    (lambda: hd.BVH(np.ones((3, 6)), balance="fair"), "balance must be"),
    (lambda: hd.BVH(np.ones((3, 6)), partitions=0), "partitions: expected an integer from 1"),
    (lambda: hd.scan(np.ones((3, 6)), np.full((1, 6), np.nan)), "boxes.0.: .*NaN"),
    (lambda: hd.BVH(np.ones((3, 6))).query(np.ones((3, 4))), "boxes must have the shape"),
    (lambda: hd.BVH(np.ones((3, 6))).query(np.ones((3, 6)), max_results=0), "max_results"),
    (lambda: list(hd.BVH(np.ones((3, 6))).nearest(np.ones((3, 3)), k=0)), "k: expected an integer from 1"),
    (lambda: list(hd.BVH(np.ones((3, 6))).nearest(np.ones((3, 3)), max_distance=-1)),
     "max_distance"),
    (lambda: hd.join(hd.BVH(np.ones((3, 6))), hd.BVH(np.ones((3, 4)))), "same dimensions"),
    (lambda: list(hd.BVH(np.ones((3, 6))).query(
        chunked(np.array([[1.0] * 6, [np.nan] * 6]), 1))), "chunk that begins at row 1"),
    (lambda: hd.BVH(chunked(np.array([[1.0] * 6] * 3 + [[np.nan] * 6]), 2), partitions=2),
     "row 3 of boxes: .*NaN"),
])
def test_bad_input(client, call, message):
    with pytest.raises(ValueError, match=message):
        call()
