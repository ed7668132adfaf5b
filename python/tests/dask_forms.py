"""What tests of halfspace.dask share. Lazy calls are computed in this process, and calls in
batches on a cluster of two processes: two forms of the same calls."""

import types

import numpy as np
import pytest

distributed = pytest.importorskip("distributed")
pd = pytest.importorskip("pandas")

import dask.array  # noqa: E402

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


def unknown_sizes(boxes):
    return chunked(boxes)[dask.array.from_array(np.ones(len(boxes), bool), chunks=700)]


def pairs_of(batches):
    """The sorted rows of a result in batches."""
    found = np.concatenate([np.empty((0, 2), np.int64), *(np.stack(b, 1) for b in batches)])
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def table(frame, *columns):
    """The sorted rows of a lazy result."""
    return pairs_of([frame.compute().reset_index()[list(columns)].to_numpy().T])


@pytest.fixture
def no_client(monkeypatch):
    """As in a program that never made a client."""
    def fail(*_):
        raise ValueError("No clients found")

    monkeypatch.setattr(distributed, "get_client", fail)
    with dask.config.set(scheduler="sync"):
        yield


def columns_of_nearest(frame):
    """The rows, ids and distances of a lazy result."""
    found = frame.compute()
    return found.index.to_numpy(), found["id"].to_numpy(), found["distance"].to_numpy()


def found_nearest(batches):
    """The same of a result in batches, which has all rows and k columns."""
    rows, ids, distances = map(np.concatenate, zip(*batches))
    np.testing.assert_array_equal(rows, np.arange(len(rows)))
    np.testing.assert_array_equal(ids < 0, np.isinf(distances))
    return np.nonzero(ids >= 0)[0], ids[ids >= 0], distances[ids >= 0]


LAZY = types.SimpleNamespace(
    client="no_client",
    query=lambda tree, boxes: table(tree.query(boxes), "row", "id"),
    pairs=lambda tree: table(tree.pairs(), "i", "j"),
    join=lambda a, b: table(hd.join(a, b), "i", "j"),
    scan=lambda boxes, queries: table(hd.scan(boxes, queries), "row", "id"),
    nearest=lambda tree, *arguments: columns_of_nearest(tree.nearest(*arguments)))
BATCHES = types.SimpleNamespace(
    client="client",
    query=lambda tree, boxes: pairs_of(tree.query_batches(boxes)),
    pairs=lambda tree: pairs_of(tree.pairs_batches()),
    join=lambda a, b: pairs_of(hd.join_batches(a, b)),
    scan=lambda boxes, queries: pairs_of(hd.scan_batches(boxes, queries)),
    nearest=lambda tree, *arguments: found_nearest(tree.nearest_batches(*arguments)))


@pytest.fixture(params=[LAZY, BATCHES], ids=["lazy", "batches"])
def form(request):
    request.getfixturevalue(request.param.client)
    return request.param
