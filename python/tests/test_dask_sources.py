"""halfspace.dask: all kinds of sources, and errors."""

import numpy as np
import pytest
from dask_forms import (BATCHES, LAZY, chunked, client, form, no_client, pairs_of,  # noqa: F401
                        pd, uniform, unknown_sizes)

import dask.array
import dask.dataframe

import halfspace as hs
import halfspace.dask as hd


def frame_of(boxes, names):
    return pd.DataFrame(boxes, columns=names.split())


BBOX = "xmin ymin xmax ymax"


def files(boxes, tmp, chunks):
    paths = [tmp / f"{n}.npy" for n in range(len(chunks))]
    for path, chunk in zip(paths, chunks):
        np.save(path, boxes[slice(*chunk)])
    return paths


SOURCES = {
    "an array": lambda boxes, tmp: boxes,
    "a list": lambda boxes, tmp: boxes.tolist(),
    "chunks of columns": lambda boxes, tmp: dask.array.from_array(boxes, (800, 2)),
    "unknown chunk sizes": lambda boxes, tmp: unknown_sizes(boxes),
    "delayed arrays": lambda boxes, tmp: [dask.delayed(part) for part in
                                          np.array_split(boxes, 4)],
    "a delayed array": lambda boxes, tmp: dask.delayed(boxes),
    "a frame of dask": lambda boxes, tmp: dask.dataframe.from_pandas(
        frame_of(boxes[:, [2, 0, 3, 1]], "maxx minx maxy miny"), npartitions=3),
    "a frame of pandas": lambda boxes, tmp: frame_of(boxes, BBOX).assign(name="x"),
    "nullable columns": lambda boxes, tmp: frame_of(boxes, BBOX).astype("Float64"),
    "columns without these names": lambda boxes, tmp: frame_of(boxes, "a b c d"),
    "a file": lambda boxes, tmp: files(boxes, tmp, [(2000,)])[0],
    "files, one of them empty": lambda boxes, tmp: files(
        boxes, tmp, [(1000,), (1000, 1000), (1000, 2000)]),
}


@pytest.mark.parametrize("form, partitions", [(LAZY, 1), (LAZY, 17), (BATCHES, 3)],
                         indirect=["form"], ids=["lazy-1", "lazy-17", "batches-3"])
@pytest.mark.parametrize("source", SOURCES)
def test_sources(form, tmp_path, source, partitions):
    rng = np.random.default_rng(14)
    boxes = uniform(rng, 2000, 2)
    # x_min < y_min, ..., so that swapped columns have other answers.
    boxes[:, 1::2] += 3
    its = SOURCES[source](boxes, tmp_path)
    tree, one = hd.BVH(its, partitions), hs.BVH(boxes)
    expected = pairs_of([one.query(boxes)])
    for probes in (boxes, its):
        np.testing.assert_array_equal(form.query(tree, probes), expected)
    np.testing.assert_array_equal(form.scan(its, boxes[:9]), pairs_of([one.query(boxes[:9])]))
    rows, _, distances = form.nearest(tree, its, 2)
    np.testing.assert_array_equal(rows, np.arange(2000).repeat(2))
    np.testing.assert_array_equal(distances, one.nearest(boxes, 2)[1].ravel())
    assert len(tree) == 2000


@pytest.mark.parametrize("partitions", [1, 17])
def test_geoparquet(no_client, monkeypatch, partitions):
    """Debian 12 has no package that reads Parquet."""
    boxes = uniform(np.random.default_rng(14), 1000, 2)

    def read_parquet(path):
        half = boxes[:500] if path.endswith("a.parquet") else boxes[500:]
        bbox = [dict(zip(BBOX.split(), map(float, box))) for box in half]
        return pd.DataFrame({"name": "x", "bbox": bbox})

    monkeypatch.setattr(pd, "read_parquet", read_parquet)
    paths = ["/a.parquet", "/b.parquet"]
    found = LAZY.query(hd.BVH(paths, partitions), paths)
    np.testing.assert_array_equal(found, pairs_of([hs.BVH(boxes).query(boxes)]))


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


def test_geometries(form):
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
        found = form.query(hd.BVH(source, partitions=3), probes)
        np.testing.assert_array_equal(found, expected)


MASKED = np.ma.array(np.ones((2, 6)), mask=np.ones((2, 6)))
IN_CHUNKS = dask.array.from_array(MASKED, asarray=False)
ONES = np.ones((3, 6))


@pytest.mark.parametrize("call", [
    lambda: hd.BVH(MASKED),
    lambda: hd.BVH(IN_CHUNKS, partitions=2).compute(),
    lambda: hd.BVH(ONES).query_batches(MASKED),
    lambda: hd.BVH(ONES).query(IN_CHUNKS).compute(),
    lambda: list(hd.BVH(ONES).nearest_batches(IN_CHUNKS[:, :3])),
    lambda: hd.BVH(ONES).nearest(np.ones((3, 3)), k=np.ma.array(1, mask=1)),
    lambda: hd.scan(ONES, MASKED),
    lambda: list(hd.scan_batches(IN_CHUNKS, ONES)),
])
def test_masked_values_are_refused(client, call):
    with pytest.raises(TypeError, match="expected no masked values"):
        call()


def delayed(*widths):
    """A tree of chunks of these widths, which are known when it is computed."""
    return hd.BVH([dask.delayed(np.ones((2, width))) for width in widths], partitions=2)


@pytest.mark.parametrize("call, message", [
    (lambda: hd.BVH(np.ones((3, 5))), r"boxes must have the shape \(n, 4\) or \(n, 6\)"),
    (lambda: hd.BVH(ONES, balance="fair"), "balance must be"),
    (lambda: hd.BVH(ONES, partitions=0), "partitions: expected an integer from 1"),
    (lambda: hd.scan_batches(ONES, np.full((1, 6), np.nan)), "boxes.0.: .*NaN"),
    (lambda: hd.BVH(ONES).query_batches(np.ones((3, 4))), "boxes must have the shape"),
    (lambda: hd.BVH(ONES).query_batches(ONES, max_results=0), "max_results"),
    (lambda: list(hd.BVH(ONES).nearest_batches(np.ones((3, 3)), k=0)), "k: expected an integer from 1"),
    (lambda: list(hd.BVH(ONES).nearest_batches(np.ones((3, 3)), max_distance=-1)),
     "max_distance"),
    (lambda: hd.join_batches(hd.BVH(ONES), hd.BVH(np.ones((3, 4)))), "same dimensions"),
    (lambda: list(hd.BVH(ONES).query_batches(
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
    (lambda: hd.BVH(ONES, mapped="no"), "mapped must be True, False or None, not 'no'"),
    (lambda: bool(delayed(4)), "truth value"),
    (lambda: hd.BVH(frame_of(np.ones((2, 4)), BBOX).astype("Float64").shift(1)), "boxes: .*missing values"),
    (lambda: hd.BVH(pytest.importorskip("geopandas").GeoDataFrame({"a": [1]})), "boxes: .*set_geometry"),
])
def test_bad_input(client, call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()
