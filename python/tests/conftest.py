import numpy as np
import pytest


def random_boxes(rng, n, dims, side=0.1, dtype=np.float32):
    low = rng.random((n, dims)).astype(dtype)
    size = (side * rng.random((n, dims))).astype(dtype)
    return np.concatenate([low, low + size], axis=1)


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


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture(params=[2, 3])
def dims(request):
    return request.param
