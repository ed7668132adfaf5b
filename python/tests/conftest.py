import contextlib
import threading

import numpy as np
import pytest


def random_boxes(rng, n, dims, side=0.1, dtype=np.float32):
    low = rng.random((n, dims)).astype(dtype)
    size = (side * rng.random((n, dims))).astype(dtype)
    return np.concatenate([low, low + size], axis=1)


def near_boxes(rng, n, dims, cells=30):
    """Boxes on a grid that doubles hold only about, so that many touch or nearly do, and
    empty, infinite and huge ones."""
    corners = rng.integers(0, cells, (n, dims)) * 0.1 + 500_000
    corners += rng.integers(-1, 2, (n, dims)) * 2.0**-34
    boxes = np.hstack([corners, corners + 0.1])
    if n > 9:
        inf, high = [np.inf] * dims, [1e300] * dims
        boxes[:6] = [inf + [-np.inf] * dims, [-np.inf] * dims + inf, high + inf, high + high,
                     [5e-324] * 2 * dims, inf + inf]
    return boxes


def overlaps(a, b):
    """Which boxes of `a` (rows) overlap which boxes of `b` (columns)."""
    dims = a.shape[1] // 2
    below = a[:, None, :dims] <= b[None, :, dims:]
    above = b[None, :, :dims] <= a[:, None, dims:]
    return (below & above).all(axis=2)


def as_matrix(pairs, shape):
    """The pairs of ids as a matrix of bools. Each pair must be there once."""
    matrix = np.zeros(shape, bool)
    matrix[pairs[0], pairs[1]] = True
    assert matrix.sum() == pairs.shape[1]
    return matrix


@contextlib.contextmanager
def repeated(*calls):
    """Repeats each call on a thread of its own during the block."""
    stop = threading.Event()
    errors = []

    def run(call):
        try:
            while not stop.is_set():
                call()
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=run, args=[call], daemon=True) for call in calls]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        stop.set()
        for thread in threads:
            thread.join(60)
    assert not errors, errors[0]
    assert not any(thread.is_alive() for thread in threads)


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture(params=[2, 3])
def dims(request):
    return request.param


@pytest.fixture
def boxes(rng, dims):
    return random_boxes(rng, 2000, dims)
