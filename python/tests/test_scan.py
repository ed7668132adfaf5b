"""Results of the flat scan, compared with NumPy."""

import halfspace as hs
import numpy as np
import pytest

from conftest import as_matrix, overlaps, random_boxes


@pytest.mark.parametrize("quantized", [False, True])
@pytest.mark.parametrize("n", [0, 1, 5000])
def test_scan(rng, dims, quantized, n):
    boxes = random_boxes(rng, n, dims)
    if n > 2:
        boxes[1] = [-np.inf] * dims + [np.inf] * dims
        boxes[2] = [np.inf] * dims + [-np.inf] * dims
    queries = random_boxes(rng, 100, dims)
    scan = hs.Scan(boxes, quantized=quantized)
    assert len(scan) == n and scan.dims == dims
    expected = overlaps(queries, boxes)
    for threads in (1, 2):
        found = scan.query(queries, threads=threads)
        assert (as_matrix(found, expected.shape) == expected).all()
        assert (np.lexsort(found[::-1]) == np.arange(found.shape[1])).all()
        assert (scan.mask(queries, threads=threads) == expected).all()
        assert (scan.count(queries, threads=threads) == expected.sum(1)).all()
        assert (scan.any(queries, threads=threads) == expected.any(1)).all()
    assert scan.query(queries[0]).tolist() == np.flatnonzero(expected[0]).tolist()
    assert (scan.mask(queries[0]) == expected[0]).all()
    assert scan.count(queries[0]) == expected[0].sum()
    assert scan.any(queries[0]) is bool(expected[0].any())


def test_doubles_are_rounded_outward():
    scan = hs.Scan(np.array([[0, 0, 1 - 1e-12, 1]]))
    assert scan.query([1, 0, 2, 1]).tolist() == [0]
