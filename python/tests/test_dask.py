"""halfspace.dask: results are those of one process."""

import math
import os
import pickle
import signal

import numpy as np
import pytest
from dask_forms import (chunked, client, distributed, form, no_client, pairs_of,  # noqa: F401
                        pd, skewed, special, table, uniform, unknown_sizes)

import dask.core
import dask.dataframe
import dask.sizeof

import halfspace as hs
import halfspace.dask as hd
from halfspace.dask import _partitions, _run, _tasks


WORLDS = [uniform, skewed, special]


@pytest.mark.parametrize("partitions, dims", [(1, 2), (5, 3), (18, 2)])
@pytest.mark.parametrize("world", WORLDS)
def test_answers_are_those_of_one_process(form, world, partitions, dims):
    rng = np.random.default_rng(11)
    boxes, probes = world(rng, 3000, dims), world(rng, 2100, dims)
    one, of_probes = hs.BVH(boxes), hs.BVH(probes)
    tree = hd.BVH(chunked(boxes, 400), partitions)
    other = hd.BVH(probes, partitions // 2 + 1)
    assert dask.is_dask_collection(tree) and len(tree) == 3000
    assert tree.npartitions == partitions
    assert tree.sizes.compute().sum() == 3000
    same = np.testing.assert_array_equal
    same(form.query(tree, chunked(probes, 300)), pairs_of([one.query(probes)]))
    same(form.pairs(tree), pairs_of([one.pairs()]))
    same(form.join(tree, other), pairs_of([hs.join(one, of_probes)]))
    same(form.join(tree, tree), pairs_of([hs.join(one, one)]))
    same(form.scan(chunked(boxes), probes[:10]), pairs_of([one.query(probes[:10])]))
    # All of them again, as one tree.
    same(tree.compute().boxes(), one.boxes())


@pytest.mark.parametrize("world, are_points, partitions, k, max_distance", [
    (special, True, 4, 1, np.inf), (special, True, 4, 300, np.inf),
    (special, True, 20, 8, 0.02), (special, False, 20, 8, np.inf),
    (skewed, True, 6, 8, np.inf), (skewed, False, 6, 3, 0), (uniform, True, 6, 8, 0.02)])
def test_nearest_is_that_of_one_process(form, world, are_points, partitions, k, max_distance):
    rng = np.random.default_rng(12)
    boxes = world(rng, 1500)
    points = rng.random((900, 3)) * 1.4 - 0.2
    if not are_points:
        points = np.hstack([points, points + 0.01])
    ids, distances = hs.BVH(boxes).nearest(points, k=k, max_distance=max_distance)
    tree = hd.BVH(boxes, partitions)
    rows, near, far = form.nearest(tree, chunked(points, 250), k, max_distance)
    np.testing.assert_array_equal(rows, np.nonzero(ids >= 0)[0])
    np.testing.assert_array_equal(far, distances[ids >= 0])
    # Ties may be others.
    assert len(np.unique(rows * 2000 + near)) == len(rows)
    gaps = np.maximum(boxes[near, :3] - points[rows, -3:], points[rows, :3] - boxes[near, 3:])
    exact = np.linalg.norm(np.maximum(gaps, 0), axis=1)
    np.testing.assert_allclose(exact, far, rtol=1e-4, atol=1e-6)


def test_divisions_are_rows(no_client):
    boxes = uniform(np.random.default_rng(2), 2000)
    tree, one = hd.BVH(boxes, 3).persist(), hs.BVH(boxes)
    for found in (tree.query(chunked(boxes, 300)), tree.nearest(chunked(boxes, 300), 7)):
        assert found.divisions == (*range(0, 2000, 300), 1999)
    assert len(found.loc[900:1000].compute()) == 7 * 101
    some = tree.query(chunked(boxes, 300)).loc[900:1000].compute()
    assert len(some) == one.count(boxes[900:1001]).sum()


def test_nearest_has_no_rows_beyond_the_objects(no_client):
    boxes = uniform(np.random.default_rng(19), 200)
    partition = _partitions.Partition(hs.BVH(boxes), np.arange(200))
    found = _tasks.nearest_in(partition, (boxes, np.arange(200)), 3000, np.inf)
    assert {len(column) for column in found} == {40_000}
    tree = hd.BVH(boxes, 20)
    assert len(tree.nearest(boxes, k=3000).compute()) == 40_000
    assert len(tree.nearest(boxes + 9, 5, 1).compute()) == 0


@pytest.mark.filterwarnings("error:overflow")
def test_nearest_beyond_the_floats(no_client):
    boxes = uniform(np.random.default_rng(20), 20)
    points = np.array([[1e300, 0, 0], [0, -1e300, 0]])
    found = hd.BVH(boxes, 2).nearest(points, 20).compute()
    assert len(found) == (hs.BVH(boxes).nearest(points, 20)[0] >= 0).sum()


def test_a_tree_is_a_collection(client):
    rng = np.random.default_rng(13)
    boxes, probes = uniform(rng, 3000), uniform(rng, 500)
    one = hs.BVH(boxes)
    expected = pairs_of([one.query(probes)])
    lazy = hd.BVH(chunked(boxes), partitions=4)
    assert dask.base.tokenize(lazy) != dask.base.tokenize(hd.BVH(boxes, 4))
    tree = lazy.persist()
    assert isinstance(tree, hd.BVH) and len(tree.__dask_graph__().to_dict()) == 5
    assert len(distributed.futures_of(tree)) == 5
    for its in (lazy, tree, pickle.loads(pickle.dumps(lazy)), dask.optimize(lazy)[0],
                dask.graph_manipulation.clone(lazy)):
        np.testing.assert_array_equal(
            table(its.query(probes), "row", "id"), expected)
    # A function of dask.delayed gets one tree, and a task the collection.
    count = dask.delayed(lambda tree, boxes: tree.count(boxes).sum())
    assert count(tree, probes).compute() == len(expected)
    assert client.submit(lambda tree: len(tree.query(probes).compute()),
                         tree).result() == len(expected)
    both = dask.compute(tree.query(probes), tree.nbytes, tree.bounds)
    assert len(both[0]) == len(expected) and both[2].shape == (4, 6)
    # Files of the frame's partitions, by the workers.
    assert tree.query(chunked(probes, 100)).map_partitions(len).compute().sum() == len(expected)


def test_as_many_tasks_as_threads_wait_for_batches(client):
    boxes = uniform(np.random.default_rng(17), 1000)
    tree = hd.BVH(chunked(boxes), partitions=3)

    def count(tree, number):
        # The second call is of a thread that has left the pool.
        return [sum(len(rows) for rows, _ in tree.query_batches(boxes)) for _ in range(2)]

    futures = [client.submit(count, tree, number) for number in range(2)]
    expected = hs.BVH(boxes).count(boxes).sum()
    distributed.wait(futures, timeout=60)
    assert client.gather(futures) == [[expected] * 2] * 2


def test_cancelled_partitions_are_built_again(client):
    boxes = uniform(np.random.default_rng(18), 500)
    tree = hd.BVH(boxes, partitions=3)
    expected = pairs_of(tree.query_batches(boxes))
    for some in (slice(1, 2), slice(0, 3)):
        client.cancel(tree._on_cluster.partitions[some])
        np.testing.assert_array_equal(pairs_of(tree.query_batches(boxes)), expected)


def test_a_task_needs_one_partition_or_one_chunk(no_client):
    """Others would gather all of them in one worker."""
    boxes = uniform(np.random.default_rng(17), 5000)
    chunks = unknown_sizes(boxes)
    tree = hd.BVH(chunks, partitions=4)
    large = {(tree._name, p) for p in range(4)}
    for found in (tree, tree.query(chunks), tree.nearest(chunks), tree.pairs(),
                  hd.join(tree, tree), hd.scan(chunks, boxes[:9])):
        graph = dict(found.__dask_graph__())
        ofs = ("-distribute", "-route", "-route_border", "-send_home", "-send_on", "-scan")
        large |= {key for key in graph if key[0].endswith(ofs)}
        for key in graph:
            needs = dask.core.get_dependencies(graph, key) & large
            assert len({need for need in needs if need[0] == tree._name}) <= 1
            assert len(needs) <= 2


def test_large_joins_have_few_tasks(no_client):
    """A scheduler without work: every result is an empty frame."""
    many = 1000
    boxes = dask.array.zeros((many, 6), chunks=(1, 6))
    ready = []

    def get(graph, keys, **_):
        graph = dict(graph)
        done = dask.core.toposort(graph)  # raises if there is a cycle
        assert len(done) == len(graph)
        ready.append(len(done))
        empty = pd.DataFrame({"id": np.empty(0, np.int64)})
        return [[empty for _ in its] for its in keys]

    tree = hd.BVH(boxes, partitions=many)
    query = tree.query(boxes)
    query.compute(scheduler=get)
    # With the tasks of the build. Trips are those to all partitions, and back.
    for result, trips in ((tree, 1), (query, 3), (tree.nearest(boxes), 5)):
        tasks = len(result.__dask_graph__())
        assert tasks < 2_000_000
        assert tasks / many < (2 * trips + 1) * math.sqrt(many) + 20
    assert len(tree.pairs().__dask_graph__()) < len(tree.__dask_graph__()) + 6 * many
    assert ready[0] <= len(query.__dask_graph__())


@pytest.mark.parametrize("how", ["inner", "left"])
def test_sjoin_is_that_of_one_process(no_client, how):
    geopandas = pytest.importorskip("geopandas")
    from shapely.geometry import Point, Polygon, box
    from halfspace import geo

    rng = np.random.default_rng(22)
    left = geopandas.GeoDataFrame({"a": range(90)}, geometry=[
        None if i % 11 == 0 else Point(*place) for i, place in enumerate(rng.random((90, 2)))])
    left.loc[30:44, "geometry"] = Polygon()
    right = geopandas.GeoDataFrame({"b": range(40)}, geometry=[
        box(x, y, x + 0.1, y + 0.1) for x, y in rng.random((40, 2))], index=range(40, 0, -1))

    def parts_of(frame, size, divisions=None):
        parts = [dask.delayed(frame[i:i + size]) for i in range(0, len(frame), size)]
        return dask.dataframe.from_delayed(parts, meta=frame[:0], divisions=divisions,
                                           verify_meta=False)

    its = parts_of(left, 15, (*range(0, 90, 15), 89))
    for other, predicate, distance in (
            (parts_of(right, 9), "within", None), (right, "dwithin", 0.05), (right[:0], None, None)):
        found = hd.sjoin(its, other, how, predicate, distance=distance)
        assert found.npartitions == 6 and found.divisions == its.divisions
        expected = geo.sjoin(left, right if len(other) else other, how, predicate,
                             distance=distance)
        assert len(expected) > 9 or len(other) == 0
        pd.testing.assert_frame_equal(found.compute().sort_values(["a", "index_right"]),
                                      expected.sort_values(["a", "index_right"]))
    assert hd.sjoin(left, right, how).compute().equals(geo.sjoin(left, right, how))
    with pytest.raises(TypeError, match="right_df: expected a GeoDataFrame, or partitions"):
        hd.sjoin(its, dask.dataframe.from_pandas(pd.DataFrame({"a": [1]}), npartitions=1))
    for options, text in (({"how": "right"}, "how: "), ({"distance": [1]}, "distance: ")):
        with pytest.raises(ValueError, match=text):
            hd.sjoin(its, right, **options)


def test_partitions_share_skewed_work(client):
    rng = np.random.default_rng(3)
    boxes = skewed(rng, 20000)
    for balance in ("objects", "pairs"):
        sizes = hd.BVH(chunked(boxes, 5000), partitions=8, balance=balance).sizes.compute()
        assert sizes.max() < 1.5 * 20000 / 8 * (2 if balance == "pairs" else 1)
    # Each box overlaps about 8 others, and hardly two boxes of a sample overlap.
    even = uniform(rng, 100000, size=0.04)
    sizes = hd.BVH(chunked(even, 25000), partitions=4).sizes.compute()
    assert sizes.max() < 1.2 * 100000 / 4
    # A dense knot has nearly all pairs: it becomes more partitions by pairs.
    knot = uniform(rng, 20000, size=0.001)
    knot[:2000] = uniform(rng, 2000, size=0.2) * 0.1
    def most_pairs(balance):
        tree = hd.BVH(chunked(knot, 5000), partitions=8, balance=balance)
        return max(hs.BVH(knot[:2000]).count(bounds[None])[0] for bounds in tree.bounds.compute())
    assert most_pairs("pairs") < 0.7 * most_pairs("objects")


def test_few_batches_wait(client, monkeypatch):
    """Batches are bounded, and a range of rows is searched when a batch before it was taken."""
    boxes = uniform(np.random.default_rng(10), 3000, size=0.25)
    boxes[0] = [-1, -1, -1, 2, 2, 2]  # a row with more pairs than a batch
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    submitted = []
    add = _run.Runner.add

    def count(run, function, *arguments):
        submitted.append(function)
        return add(run, function, *arguments)

    monkeypatch.setattr(_run.Runner, "add", count)
    found = []
    for rows, ids in hd.BVH(boxes, partitions=1).query_batches(boxes, max_results=2000):
        found.append((rows, ids))
        assert len(rows) <= 2000 or (rows == rows[0]).all()
        # Two tasks for each thread run or wait.
        assert submitted.count(_tasks.some_pairs) < len(found) + 2 * 2
    assert len(found) > 50 and max(len(rows) for rows, _ in found) == 3000
    np.testing.assert_array_equal(pairs_of(found), expected)


def test_many_small_results():
    """A stream has one job after another, and not one inside another."""
    class Future:
        status = "finished"

        def result(self):
            return 1, []

    class Completed(list):
        add = list.append
        __next__ = list.pop

    run = _run.Runner.__new__(_run.Runner)
    run.threads = 1
    run.add = lambda *_: Future()
    real, distributed.as_completed = distributed.as_completed, Completed
    try:
        assert sum(run.stream(None, [()] * 100_000, 1, {})) == 100_000
    finally:
        distributed.as_completed = real


def test_workers_write_files(client, tmp_path):
    rng = np.random.default_rng(5)
    boxes = uniform(rng, 3000, size=0.1)
    tree = hd.BVH(boxes, partitions=3)
    others = tree.query_batches(boxes[:1], to=tmp_path / "pairs")
    paths = tree.pairs_batches(max_results=1000, to=tmp_path / "pairs")
    assert len(os.listdir(tmp_path / "pairs")) == len(paths) + len(others)
    for path in others:
        os.unlink(path)
    assert len(paths) > 3 and sorted(os.listdir(tmp_path / "pairs")) == [
        os.path.basename(path) for path in paths]
    i, j = hs.BVH(boxes).pairs()
    np.testing.assert_array_equal(pairs_of(map(np.load, paths)),
                                  pairs_of([(np.minimum(i, j), np.maximum(i, j))]))


def test_a_call_that_fails_leaves_no_files(client, tmp_path):
    boxes = uniform(np.random.default_rng(21), 4000, size=0.1)
    bad = boxes.copy()
    bad[-1, 0] = np.nan
    tree = hd.BVH(boxes, partitions=3)
    others = tree.query_batches(boxes[:1], to=tmp_path)
    with pytest.raises(ValueError, match="chunk that begins at row 3900: .*NaN"):
        tree.query_batches(chunked(bad, 100), max_results=1000, to=tmp_path)
    assert sorted(map(str, tmp_path.iterdir())) == others


def test_mapped_partitions(client):
    rng = np.random.default_rng(7)
    boxes = uniform(rng, 3000)
    tree = hd.BVH(boxes, partitions=3, mapped=True).persist()
    distributed.wait(tree)
    name = tree._name  # Partitions of other tests can still be there.
    sizes = client.run(lambda dask_worker: [dask.sizeof.sizeof(value)
                                            for key, value in dask_worker.data.items()
                                            if isinstance(value, _partitions.Partition) and name in str(key)])
    sizes = sum(sizes.values(), [])
    assert len(sizes) == 3 and max(sizes) < 3000 * 8 < tree.nbytes.compute()
    assert dask.sizeof.sizeof(hs.BVH(boxes)) > 3000 * 24
    # A copy is in memory.
    copy = distributed.futures_of(tree)[0].result()
    assert isinstance(copy, _partitions.Partition)
    assert dask.sizeof.sizeof(copy) > copy.tree.nbytes > 3000 * 8
    np.testing.assert_array_equal(pairs_of(tree.query_batches(boxes)),
                                  pairs_of([hs.BVH(boxes).query(boxes)]))


def test_few_objects(client):
    nothing = np.empty((0, 6))
    tree = hd.BVH(nothing)
    assert len(tree) == 0
    assert list(tree.query_batches(np.ones((3, 6)))) == [] and list(tree.pairs_batches()) == []
    (rows, ids, distances), = tree.nearest_batches(np.zeros((2, 3)), k=2)
    assert rows.tolist() == [0, 1]
    assert (ids == -1).all() and np.isinf(distances).all()
    # Equal boxes are in one partition, and the others are empty.
    same = hd.BVH(np.tile([0, 0, 0, 1, 1, 1.0], (5, 1)), partitions=3)
    (rows, ids, distances), = same.nearest_batches([[0, 0, 0], [np.inf, 0, 0]], k=2**31 - 1)
    assert ids.tolist() == [[0, 1, 2, 3, 4], [-1] * 5]
    tree = hd.BVH(np.ones((2, 6)), partitions=8)
    assert pairs_of(tree.pairs_batches()).tolist() == [[0, 1]]
    assert list(tree.query_batches(nothing)) == []


def test_a_killed_worker_loses_nothing(client):
    rng = np.random.default_rng(8)
    boxes = uniform(rng, 30000)
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    tree = hd.BVH(chunked(boxes, 5000), partitions=6)
    batches = tree.query_batches(chunked(boxes, 1000), max_results=1000)
    found = list(batches.__next__() for _ in range(3))
    workers = client.run(os.getpid)
    os.kill(next(iter(workers.values())), signal.SIGKILL)
    found += batches
    assert client.run(os.getpid) != workers
    np.testing.assert_array_equal(pairs_of(found), expected)
