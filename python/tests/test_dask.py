"""halfspace.dask: results are those of one process. Lazy calls are computed in this process,
and calls in batches on a cluster of two processes."""

import math
import os
import pickle
import signal

import numpy as np
import pytest

distributed = pytest.importorskip("distributed")
pd = pytest.importorskip("pandas")

import dask.array  # noqa: E402
import dask.core  # noqa: E402
import dask.dataframe  # noqa: E402
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
    assert tree.sizes.compute().sum() == 5000

    np.testing.assert_array_equal(pairs_of(tree.query_batches(chunked(probes))),
                                  pairs_of([one.query(probes)]))
    i, j = one.pairs()
    np.testing.assert_array_equal(pairs_of(tree.pairs_batches()),
                                  pairs_of([(np.minimum(i, j), np.maximum(i, j))]))
    other = hd.BVH(probes, partitions=3)
    np.testing.assert_array_equal(pairs_of(hd.join_batches(tree, other)),
                                  pairs_of([hs.join(one, hs.BVH(probes))]))
    np.testing.assert_array_equal(pairs_of(hd.scan_batches(chunked(boxes), probes[:10])),
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
    for rows, found, far in tree.nearest_batches(chunked(points, 250), k, max_distance):
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


def table(frame, *columns):
    """The sorted rows of a lazy result."""
    found = frame.compute().reset_index()[list(columns)].to_numpy()
    return found[np.lexsort((found[:, 1], found[:, 0]))]


@pytest.fixture
def no_client(monkeypatch):
    """As in a program that never made a client."""
    def fail(*_):
        raise ValueError("No clients found")

    monkeypatch.setattr(distributed, "get_client", fail)
    with dask.config.set(scheduler="sync"):
        yield


@pytest.mark.parametrize("partitions", [1, 5, 40])
@pytest.mark.parametrize("world", WORLDS)
def test_lazy_answers_are_those_of_one_process(no_client, world, partitions):
    rng = np.random.default_rng(11)
    boxes, probes = world(rng, 3000, 2), world(rng, 2100, 2)
    one = hs.BVH(boxes)
    tree = hd.BVH(chunked(boxes, 400), partitions)
    assert dask.is_dask_collection(tree) and len(tree) == 3000
    assert tree.npartitions == partitions
    assert tree.sizes.compute().sum() == 3000
    tree = tree.persist()
    found = tree.query(chunked(probes, 300))
    assert found.divisions == (*range(0, 2100, 300), 2099)
    np.testing.assert_array_equal(table(found, "row", "id"),
                                  pairs_of([one.query(probes)]))
    some = found.loc[900:1000].compute()
    assert len(some) == one.count(probes[900:1001]).sum()
    np.testing.assert_array_equal(table(tree.pairs(), "i", "j"), pairs_of([one.pairs()]))
    other = hd.BVH(probes, partitions // 2 + 1)
    np.testing.assert_array_equal(table(hd.join(tree, other), "i", "j"),
                                  pairs_of([hs.join(one, hs.BVH(probes))]))
    np.testing.assert_array_equal(table(hd.join(tree, tree), "i", "j"),
                                  pairs_of([hs.join(one, one)]))
    np.testing.assert_array_equal(table(hd.scan(chunked(boxes), probes[:10]), "row", "id"),
                                  pairs_of([one.query(probes[:10])]))
    # All of them again, as one tree.
    np.testing.assert_array_equal(tree.compute().boxes(), one.boxes())


@pytest.mark.parametrize("k, max_distance", [(1, np.inf), (8, 0.02), (300, np.inf)])
@pytest.mark.parametrize("are_points", [True, False])
def test_lazy_nearest_is_that_of_one_process(no_client, k, max_distance, are_points):
    rng = np.random.default_rng(12)
    boxes = special(rng, 1500)
    points = rng.random((900, 3)) * 1.4 - 0.2
    if not are_points:
        points = np.hstack([points, points + 0.01])
    one = hs.BVH(boxes)
    ids, distances = one.nearest(points, k=k, max_distance=max_distance)
    for partitions in (4, 20):
        found = hd.BVH(boxes, partitions).nearest(chunked(points, 250), k, max_distance)
        assert found.divisions == (0, 250, 500, 750, 899)
        found = found.compute()
        np.testing.assert_array_equal(found.index, np.nonzero(ids >= 0)[0])
        np.testing.assert_array_equal(found["distance"], distances[ids >= 0])
        # Ties may be others.
        rows, near = found.index.to_numpy(), found["id"].to_numpy()
        assert len(np.unique(rows * 2000 + near)) == len(rows)
        gaps = np.maximum(boxes[near, :3] - points[rows, -3:], points[rows, :3] - boxes[near, 3:])
        exact = np.linalg.norm(np.maximum(gaps, 0), axis=1)
        np.testing.assert_allclose(exact, found["distance"], rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("partitions", [4, 20])
def test_nearest_has_no_rows_beyond_the_objects(no_client, monkeypatch, partitions):
    rng = np.random.default_rng(19)
    boxes, points, search = uniform(rng, 200), rng.random((200, 3)), hd._nearest_in
    searched = []

    def nearest_in(partition, piece, *arguments):
        found = search(partition, piece, *arguments)
        searched.append(len(piece[0]) * len(partition.tree))
        assert {len(column) for column in found} == {searched[-1]}
        return found

    monkeypatch.setattr(hd, "_nearest_in", nearest_in)
    found = hd.BVH(boxes, partitions).nearest(points, k=3000).compute()
    assert len(found) == sum(searched) == 40_000
    monkeypatch.undo()
    assert len(hd.BVH(boxes, partitions).nearest(points + 9, 5, 1).compute(scheduler="sync")) == 0


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


def frame_of(boxes, names):
    return pd.DataFrame(boxes, columns=names.split())


BBOX = "xmin ymin xmax ymax"
SOURCES = {
    "unknown chunk sizes": lambda boxes, tmp: chunked(boxes)[dask.array.from_array(
        np.ones(len(boxes), bool), chunks=700)],
    "delayed arrays": lambda boxes, tmp: [dask.delayed(part) for part in
                                          np.array_split(boxes, 4)],
    "a delayed array": lambda boxes, tmp: dask.delayed(boxes),
    "a frame of dask": lambda boxes, tmp: dask.dataframe.from_pandas(
        frame_of(boxes[:, [2, 0, 3, 1]], "maxx minx maxy miny"), npartitions=3),
    "a frame of pandas": lambda boxes, tmp: frame_of(boxes, BBOX).assign(name="x"),
    "nullable columns": lambda boxes, tmp: frame_of(boxes, BBOX).astype("Float64"),
    "columns without these names": lambda boxes, tmp: frame_of(boxes, "a b c d"),
    "GeoParquet": lambda boxes, tmp: [tmp / "a.parquet", tmp / "b.parquet"],
}


@pytest.mark.parametrize("partitions", [1, 3, 17])
@pytest.mark.parametrize("source", SOURCES)
def test_lazy_sources(no_client, tmp_path, monkeypatch, source, partitions):
    def read_parquet(path):
        half = boxes[:500] if path.endswith("a.parquet") else boxes[500:]
        bbox = [dict(zip(BBOX.split(), map(float, box))) for box in half]
        return pd.DataFrame({"name": "x", "bbox": bbox})

    # Debian 12 has no package that reads Parquet.
    monkeypatch.setattr(pd, "read_parquet", read_parquet)
    rng = np.random.default_rng(14)
    boxes = uniform(rng, 2000, 2)
    # x_min < y_min, ..., so that swapped columns have other answers.
    boxes[:, 1::2] += 3
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    its = SOURCES[source](boxes, tmp_path)
    tree = hd.BVH(its, partitions)
    for probes in (boxes, its):
        np.testing.assert_array_equal(table(tree.query(probes), "row", "id"), expected)
    np.testing.assert_array_equal(table(hd.scan(its, boxes[:9]), "row", "id"),
                                  pairs_of([hs.BVH(boxes).query(boxes[:9])]))
    assert len(tree) == 2000


AXES = "xmin ymin zmin xmax ymax zmax"


@pytest.mark.parametrize("frame", [
    lambda boxes: frame_of(boxes, AXES),
    lambda boxes: frame_of(boxes, "minx miny minz maxx maxy maxz").assign(a=1),
    lambda boxes: frame_of(boxes[:, ::-1], "maxz maxy maxx minz miny minx"),
    lambda boxes: pd.DataFrame({"bbox": [dict(zip(AXES.split(), box)) for box in boxes]}),
])
def test_columns_of_three_dimensions(no_client, frame):
    boxes = uniform(np.random.default_rng(16), 50)
    tree = hd.BVH(frame(boxes), partitions=2).compute()
    np.testing.assert_array_equal(tree.boxes(), hs.BVH(boxes).boxes())


def test_a_null_bbox_is_empty(no_client):
    boxes = [None, *({"xmin": x, "ymin": 0.0, "xmax": x + 1, "ymax": 1.0} for x in range(3)),
             dict.fromkeys(BBOX.split())]
    for some, ids in ((boxes, [1, 2]), (boxes[1:], [0, 1]), (boxes[:1], [])):
        tree = hd.BVH(dask.delayed(pd.DataFrame({"bbox": some})), partitions=2)
        assert tree.query([[0, 0, 1, 1.0]]).compute()["id"].to_list() == ids
        assert len(tree) == len(some)


def test_geometries(client):
    """Frames of geopandas, and by their interface those of dask-geopandas."""
    geopandas = pytest.importorskip("geopandas")
    from shapely.geometry import Polygon, box

    rng = np.random.default_rng(15)
    boxes = uniform(rng, 300, 2)
    frame = geopandas.GeoDataFrame(
        {"name": range(302)}, geometry=[*(box(*b) for b in boxes), None, Polygon()])
    parts = [dask.delayed(frame[:200]), dask.delayed(frame[200:])]
    probes = uniform(rng, 50, 2)
    expected = pairs_of([hs.BVH(boxes).query(probes)])
    for source in (frame, frame.geometry, parts):
        found = hd.BVH(source, partitions=3)
        np.testing.assert_array_equal(table(found.query(probes), "row", "id"), expected)
        np.testing.assert_array_equal(pairs_of(found.query_batches(probes)), expected)


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
    for result, trips in ((tree, 1), (query, 3), (tree.nearest(boxes), 5), (tree.pairs(), 2)):
        tasks = len(result.__dask_graph__())
        assert tasks < 2_000_000
        assert tasks / many < (2 * trips + 1) * math.sqrt(many) + 20
    assert ready[0] <= len(query.__dask_graph__())


def test_partitions_share_skewed_work(client):
    rng = np.random.default_rng(3)
    boxes = skewed(rng, 20000)
    for balance in ("objects", "pairs"):
        sizes = hd.BVH(chunked(boxes, 5000), partitions=8, balance=balance).sizes.compute()
        assert sizes.max() < 1.5 * 20000 / 8 * (2 if balance == "pairs" else 1)
    # A dense knot has nearly all pairs: it becomes more partitions by pairs.
    knot = uniform(rng, 20000, size=0.001)
    knot[:2000] = uniform(rng, 2000, size=0.2) * 0.1
    def most_pairs(balance):
        tree = hd.BVH(chunked(knot, 5000), partitions=8, balance=balance)
        return max(hs.BVH(knot[:2000]).count(bounds[None])[0] for bounds in tree.bounds.compute())
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
    batches = list(tree.query_batches(boxes, max_results=500))
    assert all(len(rows) <= 500 or (rows == rows[0]).all() for rows, _ in batches)
    np.testing.assert_array_equal(pairs_of(batches), expected)


def test_few_batches_wait(client, monkeypatch):
    """A range of rows is searched when a batch before it was taken."""
    rng = np.random.default_rng(10)
    boxes = uniform(rng, 2000, size=0.3)
    expected = pairs_of([hs.BVH(boxes).query(boxes)])
    tree = hd.BVH(boxes, partitions=1)
    submitted = []
    submit = hd._Runner.submit

    def count(run, function, *arguments):
        submitted.append(function)
        return submit(run, function, *arguments)

    monkeypatch.setattr(hd._Runner, "submit", count)
    batches = tree.query_batches(boxes, max_results=2000)
    found = []
    for batch in batches:
        found.append(batch)
        # Two tasks for each thread run or wait.
        assert submitted.count(hd._some_pairs) < len(found) + 2 * 2
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
        found = hd.BVH(source, partitions=4).query_batches(boxes[:50])
        np.testing.assert_array_equal(pairs_of(found), expected)


def test_mapped_partitions(client):
    rng = np.random.default_rng(7)
    boxes = uniform(rng, 3000)
    tree = hd.BVH(boxes, partitions=3, mapped=True).persist()
    distributed.wait(tree)
    name = tree._name  # Partitions of other tests can still be there.
    sizes = client.run(lambda dask_worker: [dask.sizeof.sizeof(value)
                                            for key, value in dask_worker.data.items()
                                            if isinstance(value, hd._Partition) and name in str(key)])
    sizes = sum(sizes.values(), [])
    assert len(sizes) == 3 and max(sizes) < 3000 * 8 < tree.nbytes.compute()
    # A copy is in memory.
    copy = distributed.futures_of(tree)[0].result()
    assert isinstance(copy, hd._Partition)
    assert dask.sizeof.sizeof(copy) == copy.tree.nbytes + copy.rows.nbytes
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
    (rows, ids, distances), = same.nearest_batches([[0, 0, 0], [np.inf, 0, 0]], k=10)
    assert ids.tolist() == [[0, 1, 2, 3, 4] + [-1] * 5, [-1] * 10]
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


def test_a_tree_is_accounted_with_its_bytes():
    tree = hs.BVH(np.random.default_rng(9).random((10000, 3)).repeat(2, 1)[:, [0, 2, 4] * 2])
    assert dask.sizeof.sizeof(tree) == tree.nbytes > 10000 * 24


MASKED = np.ma.array(np.ones((2, 6)), mask=np.ones((2, 6)))


@pytest.mark.parametrize("call", [
    lambda: hd.BVH(MASKED),
    lambda: hd.BVH(dask.array.from_array(MASKED, asarray=False), partitions=1).compute(),
    lambda: hd.BVH(dask.array.from_array(MASKED, asarray=False), partitions=2).persist().compute(),
    lambda: list(hd.BVH(np.ones((3, 6))).query_batches(MASKED)),
    lambda: list(hd.BVH(np.ones((3, 6))).query_batches(
        dask.array.from_array(MASKED, asarray=False))),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest_batches(MASKED[:, :3])),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest_batches(
        dask.array.from_array(MASKED[:, :3], asarray=False))),
    lambda: list(hd.BVH(np.ones((3, 6))).nearest_batches(np.ones((3, 3)), k=np.ma.array(1, mask=1))),
    lambda: list(hd.scan_batches(np.ones((3, 6)), MASKED)),
    lambda: list(hd.scan_batches(MASKED, np.ones((3, 6)))),
    lambda: list(hd.scan_batches(dask.array.from_array(MASKED, asarray=False), np.ones((3, 6)))),
])
def test_masked_values_are_refused(client, call):
    with pytest.raises(TypeError, match="expected no masked values"):
        call()


def delayed(*widths):
    """A tree of chunks of these widths, which are known when it is computed."""
    return hd.BVH([dask.delayed(np.ones((2, width))) for width in widths], partitions=2)


@pytest.mark.parametrize("call, message", [
    (lambda: hd.BVH(np.ones((3, 5))), r"boxes must have the shape \(n, 4\) or \(n, 6\)"),
    (lambda: hd.BVH(np.ones((3, 6)), balance="fair"), "balance must be"),
    (lambda: hd.BVH(np.ones((3, 6)), partitions=0), "partitions: expected an integer from 1"),
    (lambda: hd.scan_batches(np.ones((3, 6)), np.full((1, 6), np.nan)), "boxes.0.: .*NaN"),
    (lambda: hd.BVH(np.ones((3, 6))).query_batches(np.ones((3, 4))), "boxes must have the shape"),
    (lambda: hd.BVH(np.ones((3, 6))).query_batches(np.ones((3, 6)), max_results=0), "max_results"),
    (lambda: list(hd.BVH(np.ones((3, 6))).nearest_batches(np.ones((3, 3)), k=0)), "k: expected an integer from 1"),
    (lambda: list(hd.BVH(np.ones((3, 6))).nearest_batches(np.ones((3, 3)), max_distance=-1)),
     "max_distance"),
    (lambda: hd.join_batches(hd.BVH(np.ones((3, 6))), hd.BVH(np.ones((3, 4)))), "same dimensions"),
    (lambda: list(hd.BVH(np.ones((3, 6))).query_batches(
        chunked(np.array([[1.0] * 6, [np.nan] * 6]), 1))), "chunk that begins at row 1"),
    (lambda: hd.BVH(chunked(np.array([[1.0] * 6] * 3 + [[np.nan] * 6]), 2), partitions=2).compute(),
     "row 3 of boxes: .*NaN"),
    (lambda: delayed(4, 6).compute(), "in chunk 1: boxes have the shape .n, 6., and those in chunk 0 .n, 4."),
    (lambda: delayed(5).compute(), r"in chunk 0: boxes must have the shape \(n, 4\) or \(n, 6\)"),
    (lambda: hd.join(delayed(4), delayed(6)).compute(), "must have the same dimensions"),
    (lambda: hd.join_batches(delayed(4), delayed(6)), "must have the same dimensions"),
    (lambda: hd.scan([dask.delayed(np.ones((2, 4)))], np.ones((2, 6))).compute(), "in chunk 0: "),
    (lambda: hd.join(delayed(4), np.ones((3, 4))), "b: expected a halfspace.dask.BVH, got ndarray"),
    (lambda: hd.join_batches(hs.BVH(np.ones((3, 4))), delayed(4)), "a: expected a halfspace.dask.BVH"),
    (lambda: hd.BVH(delayed(4)), "boxes: expected boxes, got a halfspace.dask.BVH"),
    (lambda: hd.BVH(np.ones((3, 6)), mapped="no"), "mapped must be True, False or None, not 'no'"),
    (lambda: bool(delayed(4)), "truth value"),
    (lambda: hd.BVH(frame_of(np.ones((2, 4)), BBOX).astype("Float64").shift(1)), "boxes: .*missing values"),
    (lambda: hd.BVH(pytest.importorskip("geopandas").GeoDataFrame({"a": [1]})), "boxes: .*set_geometry"),
])
def test_bad_input(client, call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()
