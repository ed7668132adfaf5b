"""The calls of halfspace.geo against every pair of geometries by shapely."""

import pickle

import numpy as np
import pytest

pytest.importorskip("shapely", reason="needs python3-shapely")

from shapely.errors import ShapelyError
from shapely.geometry import (GeometryCollection, LineString, MultiPoint, MultiPolygon, Point,
                              Polygon, box)

from conftest import overlaps
from halfspace import geo


def some(count, seed):
    """Geometries of all kinds that share corners and edges, some None or empty."""
    random = np.random.default_rng(seed)
    result = []
    for i in range(count):
        x, y, w, h = random.integers(0, 12, 2).tolist() + random.integers(1, 4, 2).tolist()
        result.append(
            [
                lambda: box(x, y, x + w, y + h),
                lambda: Polygon([(x, y), (x + w, y), (x, y + h)]),
                lambda: LineString([(x, y), (x + w, y + h)]),
                lambda: Point(x, y),
                lambda: MultiPoint([(x, y), (x + w, y + h)]),
                lambda: Point(x + 0.1, y).buffer(w / 3),
                lambda: None,
                lambda: GeometryCollection(),
            ][random.choice(8, p=[0.2, 0.2, 0.2, 0.15, 0.1, 0.1, 0.03, 0.02])]()
        )
    return result


GEOMETRIES = some(150, 1)
GIVEN = some(60, 2)
TREE = geo.STRtree(GEOMETRIES)


def is_there(geometry):
    return geometry is not None and not geometry.is_empty


def all_pairs(holds, given=GIVEN, geometries=GEOMETRIES):
    return [(i, j) for i, a in enumerate(given) for j, b in enumerate(geometries)
            if is_there(a) and is_there(b) and holds(a, b)]


def boxes_overlap(a, b):
    return overlaps(np.array([a.bounds]), np.array([b.bounds])).all()


def as_pairs(found):
    return [tuple(pair) for pair in found.T.tolist()]


@pytest.mark.parametrize("predicate", [None, *geo._PREDICATES])
def test_query(predicate):
    holds, options = boxes_overlap, {}
    if predicate == "dwithin":
        options = {"distance": np.arange(len(GIVEN)) % 5 * 0.5 - 0.5}
        distance_of = {id(g): d for g, d in zip(GIVEN, options["distance"])}
        holds = lambda a, b: a.distance(b) <= distance_of[id(a)]
    elif predicate == "contains_properly":
        holds = lambda a, b: a.relate_pattern(b, "T**FF*FF*")
    elif predicate is not None:
        holds = lambda a, b: getattr(a, predicate)(b)
    expected = all_pairs(holds)
    assert len(expected) > 4
    found = TREE.query(GIVEN, predicate, **options)
    assert found.dtype == np.int64
    assert as_pairs(found) == expected
    for i, a in enumerate(GIVEN[:20]):
        its = {"distance": options["distance"][i]} if options else {}
        assert TREE.query(a, predicate, **its).tolist() == [j for k, j in expected if k == i]


# More pairs and geometries than one part has. Of collections, GEOS 3.11 cannot decide most predicates: the
# error names the first pair.
@pytest.mark.parametrize("predicate", ["nearest", *geo._PREDICATES])
def test_threads_find_the_same(predicate):
    holed = [Polygon(box(i, 0, i + 4, 4).exterior, [box(i + 1, 1, i + 3, 3).exterior])
             for i in range(9)]
    many = [*some(300, 8), *holed, *(MultiPolygon([g, box(20, 20, 21, 21)]) for g in holed)]

    def found(its, threads):
        try:
            if predicate == "nearest":
                both = tree.query_nearest(its, None, True, True, threads=threads)
                return [each.tolist() for each in both]
            distance = 0.5 if predicate == "dwithin" else None
            return tree.query(its, predicate, distance, threads=threads).tolist()
        except ShapelyError as error:
            return str(error)

    for its in (many, many + [GeometryCollection([g, Point(7, 7)]) for g in holed]):
        tree = geo.STRtree(its)
        assert len(tree.query(its)[0]) > 3 * 4096 and len(its) > 256
        assert found(its, 1) == found(its, 2) == found(its, 4)


@pytest.mark.parametrize("exclusive", [False, True])
@pytest.mark.parametrize("max_distance", [None, 0.5])
def test_query_nearest(exclusive, max_distance):
    limit = np.inf if max_distance is None else max_distance
    given = GIVEN + GEOMETRIES[:40]
    is_near = lambda a, b: a.distance(b) <= limit and not (exclusive and a.equals(b))
    near = [(i, j, given[i].distance(GEOMETRIES[j])) for i, j in all_pairs(is_near, given)]
    least = {i: d for d, i in sorted(((d, i) for i, _, d in near), reverse=True)}
    expected = [(i, j, d) for i, j, d in near if d == least[i]]
    found, its = TREE.query_nearest(given, max_distance, True, exclusive)
    assert [(i, j, d) for (i, j), d in zip(as_pairs(found), its)] == expected
    first = TREE.query_nearest(given, max_distance, exclusive=exclusive, all_matches=False)
    assert as_pairs(first) == list({i: (i, j) for i, j, _ in reversed(expected)}.values())[::-1]


def test_nearest():
    given = [g for g in GIVEN if is_there(g)]
    found = TREE.nearest(given)
    least = [min(a.distance(b) for b in GEOMETRIES if is_there(b)) for a in given]
    assert [a.distance(GEOMETRIES[j]) for a, j in zip(given, found)] == least
    assert [TREE.nearest(a) for a in given] == found.tolist()
    assert geo.STRtree([]).nearest(given[0]) is None
    with pytest.raises(ValueError, match="expected geometries that are not None"):
        TREE.nearest([None])


# As floats, both points are in one place.
def test_boxes_are_compared_as_doubles():
    near, far = Point(500000.03, 0), Point(500000.035, 0)
    tree = geo.STRtree([near, far])
    assert tree.query(near).tolist() == [0]
    assert tree.query(near, "dwithin", 0.004).tolist() == [0]
    assert tree.query(near, "dwithin", 0.006).tolist() == [0, 1]
    assert tree.query_nearest(near, exclusive=True).tolist() == [1]


# A distance is rounded, and the box that is larger by it is, too.
def test_rounded_distances():
    assert geo.STRtree([Point(6.1e-17, 0)]).nearest(Point(-1, 0)) == 0
    random = np.random.default_rng(3)
    for a, b in np.round(random.uniform(-9, 9, (500, 2, 2)), 1) + 0.7:
        a, b = Point(*a), Point(*b)
        tree = geo.STRtree([b, Point(2 * a.x - b.x, b.y)])
        assert 0 in tree.query(a, "dwithin", a.distance(b))
        nearest = tree.query_nearest(a).tolist()
        distances = [a.distance(c) for c in tree.geometries]
        assert nearest == [i for i in (0, 1) if distances[i] == min(distances)]


def test_a_geometry_without_a_box_is_left_out():
    bad = [Point(0, np.nan), Point(np.nan, 0)]
    assert len(geo.STRtree([*bad, Point(1, 1)])) == 1
    assert TREE.query(bad).shape == TREE.query_nearest(bad).shape == (2, 0)
    for one in bad:
        assert TREE.query(one).shape == TREE.query(one, "intersects").shape == (0,)


# Distances whose squares are no float32, and many boxes at the distance 0.
def test_nearest_of_boxes_that_are_far_or_many():
    tree = geo.STRtree([Point(0, 0), Point(2.0**66, 0), Point(2.0**67, 0)])
    assert [tree.nearest(Point(x, 0)) for x in (-(2.0**70), 2.0**70)] == [0, 2]
    assert tree.query_nearest([Point(2.0**70, 0), Point(1, 0)]).tolist() == [[0, 1], [2, 0]]
    tree = geo.STRtree([LineString([(-i, -i), (i, -i), (i, i)]) for i in range(20, 0, -1)])
    assert tree.nearest(Point(-0.5, 0.5)) == 19
    assert tree.query_nearest([Point(-0.5, 0.5)], all_matches=False).tolist() == [[0], [19]]


# Boxes decide about points and rectangles, and about no other polygons of five corners.
@pytest.mark.parametrize("predicate", ["intersects", "within", "contains", "covers", "covered_by"])
def test_rectangles_and_points(predicate):
    inner = [box(2, 2, 4, 4), box(2, 2, 2.5, 2.5), box(2, 2, 5, 3)]
    holed = Polygon(box(1, 1, 5, 5).exterior, [box(2, 2, 4, 4).exterior])
    its = [*inner, holed, Polygon([(2, 1), (3, 2), (2, 3), (1, 2)]), box(4, 2, 5, 4),
           Polygon([(2, 2), (4, 2), (4, 4), (3, 2.5)]), Polygon([(2, 2), (2, 4), (4, 4), (4, 2)]),
           *(Point(x, y) for x in (2, 3, 4, 4.5) for y in (2, 3)), Point(3, 3, 7)]
    found = geo.STRtree(its).query(its, predicate)
    assert as_pairs(found) == all_pairs(lambda a, b: getattr(a, predicate)(b), its, its)


# All are nearer than the one that is not equal.
def test_exclusive_looks_behind_many_equal_ones():
    tree = geo.STRtree([Point(0, 0)] * 100 + [Point(1, 0)])
    assert tree.query_nearest(Point(0, 0), exclusive=True).tolist() == [100]
    assert geo.STRtree([Point(0, 0)] * 9).query_nearest(Point(0, 0), exclusive=True).size == 0


def test_an_empty_tree_finds_nothing():
    for tree in (geo.STRtree([]), geo.STRtree([None, Point()])):
        assert len(tree) == 0
        assert tree.query(GIVEN).shape == tree.query_nearest(GIVEN).shape == (2, 0)
        assert tree.query(None).shape == tree.query_nearest(GIVEN[0]).shape == (0,)


def test_is_pickled():
    again = pickle.loads(pickle.dumps(TREE))
    assert len(again) == len(TREE) < len(TREE.geometries)
    assert as_pairs(again.query(GIVEN)) == as_pairs(TREE.query(GIVEN))


@pytest.mark.parametrize(
    "call, error, message",
    [(lambda: geo.STRtree(["x"]), TypeError, r"geoms\[0\]: expected a geometry or None"),
     (lambda: TREE.query("x"), TypeError, r"geometry\[0\]: expected a geometry"),
     (lambda: TREE.query([GIVEN[0], 3]), TypeError, r"geometry\[1\]: expected a geometry"),
     (lambda: TREE.query(np.empty((1, 1), object)), TypeError, "expected one dimension"),
     (lambda: TREE.query(GIVEN, "disjoint"), ValueError, "is not a valid option"),
     (lambda: TREE.query(GIVEN, "dwithin"), ValueError, "distance: expected a number"),
     (lambda: TREE.query(GIVEN, "dwithin", "x"), ValueError, "distance: expected a number"),
     (lambda: TREE.query(GIVEN, "dwithin", [1, 2]), ValueError, "or 60 numbers"),
     (lambda: TREE.query(GIVEN, "dwithin", [[1]]), ValueError, "expected a number, or 60 numbers"),
     (lambda: TREE.query(GIVEN, distance=1), ValueError, 'only the predicate "dwithin"'),
     (lambda: TREE.query(GIVEN, threads=0), ValueError, "threads: expected"),
     (lambda: TREE.query_nearest(GIVEN, 0), ValueError, "max_distance: expected a number"),
     (lambda: TREE.query_nearest(GIVEN, np.nan), ValueError, "max_distance: expected"),
     (lambda: TREE.query_nearest(GIVEN, [1]), ValueError, "max_distance: expected a number"),
     (lambda: TREE.query_nearest(GIVEN, exclusive=1), ValueError, "exclusive: expected a bool"),
     (lambda: TREE.query_nearest(GIVEN, all_matches=[]), ValueError, "all_matches: expected")],
)
def test_errors(call, error, message):
    with pytest.raises(error, match=message):
        call()


BOW = Polygon([(0, 0), (2, 2), (2, 0), (0, 2)])


# Prepared geometries of shapely 1.8 fail to raise the error.
def test_an_error_of_geos_names_the_invalid_geometry():
    given, its = [Point(9, 9), BOW], [None, box(0, 0, 1, 1), Point(9, 9)]
    for call, name in ((lambda: geo.STRtree(its).query(BOW, "touches"), "geometry[0]"),
                       (lambda: geo.STRtree(its).query(given, "overlaps"), "geometry[1]"),
                       (lambda: geo.STRtree(given).query(its, "touches"), "geoms[1]")):
        with pytest.raises(ShapelyError) as raised:
            call()
        assert str(raised.value).startswith(f"{name}: ")
        assert ("invalidity" in str(raised.value)) or ("TopologyException" in str(raised.value))


def test_sjoin_names_the_row_of_an_error():
    geopandas = pytest.importorskip("geopandas")
    left = geopandas.GeoDataFrame(geometry=[Point(9, 9), BOW], index=[7, 8])
    right = geopandas.GeoDataFrame(geometry=[box(0, 0, 1, 1)])
    with pytest.raises(ShapelyError, match=r"^left_df\.geometry\.iloc\[1\]: "):
        geo.sjoin(left, right, predicate="touches")
    with pytest.raises(ShapelyError, match=r"^right_df\.geometry\.iloc\[1\]: "):
        geo.sjoin(right, left, predicate="overlaps")


# The second one has the box of the first, and GEOS cannot compare them. The result is that
# of shapely 2.0.7.
def test_exclusive_with_invalid_polygons():
    notched = Polygon([(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)])
    geometries = [BOW, notched, box(0, 0, 1, 1), box(0, 0, 2, 2), Point(9, 9)]
    with pytest.raises(ShapelyError):
        BOW.equals(notched)
    found = geo.STRtree(geometries).query_nearest(geometries, exclusive=True)
    of_each = [[0, 2, 3], [2, 3], [0, 1, 3], [0, 1, 2], [0, 1, 3]]
    assert as_pairs(found) == [(i, j) for i, its in enumerate(of_each) for j in its]
    geopandas = pytest.importorskip("geopandas")
    frame = geopandas.GeoDataFrame(geometry=geometries)
    joined = geo.sjoin_nearest(frame, frame, exclusive=True)
    assert list(zip(joined.index, joined["index_right"])) == as_pairs(found)


def frame_of(count, seed, names, index=None):
    geopandas = pytest.importorskip("geopandas")
    random = np.random.default_rng(seed)
    columns = {name: random.integers(0, 100, count) for name in names}
    return geopandas.GeoDataFrame(columns, geometry=some(count, seed), index=index)


def frames():
    """Pairs of frames: with a common column, a name of the index, a MultiIndex, other
    names of geometries, and no row."""
    pandas = pytest.importorskip("pandas")
    left = frame_of(60, 3, ["a", "both"], np.arange(60)[::-1] * 3)
    right = frame_of(80, 4, ["both", "c"])
    letters = right.set_index(pandas.Index([f"r{i % 30}" for i in range(80)], name="of"))
    two = left.set_index(pandas.MultiIndex.from_arrays([range(60), ["x"] * 60], names=["p", "q"]))
    shapes = right.rename_geometry("shape")
    return [(left, right), (left, letters), (two, letters), (left, shapes), (shapes, two),
            (left, right[:0]), (left[:0], right)]


def same(found, expected):
    """Whether the frames are equal, up to the order of rows."""
    pandas = pytest.importorskip("pandas")
    assert type(found) is type(expected)
    assert found.geometry.name == expected.geometry.name and found.crs == expected.crs
    assert list(found.columns) == list(expected.columns)
    assert found.index.names == expected.index.names
    rows = []
    for frame in (found, expected):
        table = pandas.DataFrame(frame).reset_index()
        table[frame.geometry.name] = [g and g.wkt for g in frame.geometry]
        table = table.astype(object).where(table.notna(), None).astype(str)
        rows.append(sorted(v.replace(".0", "") for v in table.agg("|".join, axis=1))
                    if len(table) else [])
    assert rows[0] == rows[1]


@pytest.mark.parametrize("how", ["inner", "left", "right"])
@pytest.mark.parametrize("number", range(7))
def test_sjoin_is_that_of_geopandas(how, number):
    geopandas = pytest.importorskip("geopandas")
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("rtree")
    left, right = frames()[number]
    copies = pickle.loads(pickle.dumps((left, right)))
    for predicate in ("intersects", "within", "contains", "touches", "covers"):
        options = {"how": how, "predicate": predicate, "lsuffix": "l", "rsuffix": "r"}
        found = geo.sjoin(left, right, **options)
        same(found, geopandas.sjoin(left, right, **options))
        kept = right if how == "right" else left
        places = {key: row for row, key in reversed(list(enumerate(kept.index)))}
        if kept.index.is_unique:
            rows = [places[key] for key in found.index]
            assert rows == sorted(rows)
    same(geo.sjoin(left, right), geopandas.sjoin(left, right))
    # The join changed neither.
    for frame, copy in zip((left, right), copies):
        pandas.testing.assert_frame_equal(frame, copy)
        assert frame.index.names == copy.index.names


@pytest.mark.parametrize("how", ["inner", "left", "right"])
@pytest.mark.parametrize("max_distance", [None, 0.5])
def test_sjoin_nearest(how, max_distance):
    pandas = pytest.importorskip("pandas")
    left, right = frame_of(40, 5, ["a"]), frame_of(30, 6, ["c"])
    its, other = (right, left) if how == "right" else (left, right)
    expected = []
    for i, a in enumerate(its.geometry):
        near = [a.distance(b) if is_there(a) and is_there(b) else np.inf for b in other.geometry]
        least = min(near)
        if least < np.inf and least <= (max_distance or np.inf):
            expected += [(i, j, least) for j, d in enumerate(near) if d == least]
        elif how != "inner":
            expected.append((i, -1, -1.0))
    found = geo.sjoin_nearest(left, right, how, max_distance, distance_col="far")
    assert list(found.columns) == (["index_left", "a", "c", "geometry", "far"] if how == "right"
                                   else ["a", "geometry", "index_right", "c", "far"])
    ids = found["index_left" if how == "right" else "index_right"].fillna(-1).astype(int)
    assert list(zip(found.index, ids, found["far"].fillna(-1))) == expected
    pandas.testing.assert_frame_equal(
        geo.sjoin_nearest(left, right, how, max_distance), found.drop(columns="far"))


def test_sjoin_on_attribute():
    left, right = frame_of(60, 3, ["a", "b"]), frame_of(80, 4, ["a", "b"])
    left["a"], right["a"] = left["a"] % 3.0, right["a"] % 3.0
    left.loc[::5, "a"] = right.loc[::5, "a"] = np.nan
    for how in ("inner", "left", "right"):
        joined = geo.sjoin(left, right, how, on_attribute="a")
        expected = geo.sjoin(left, right).query("a_left == a_right")
        found = joined[joined["index_left" if how == "right" else "index_right"].notna()]
        assert len(found) == len(expected) > 9
        assert sorted(found["a"]) == sorted(expected["a_left"])
        assert "a_left" not in joined.columns and "b_left" in joined.columns
        assert len(joined) == len(found) + (0 if how == "inner" else len(
            set((right if how == "right" else left).index) - set(found.index)))
    for name in ("c", "geometry"):
        with pytest.raises(ValueError, match=f"on_attribute: left_df has no column '{name}'"):
            geo.sjoin(left, right, on_attribute=["a", name])


def test_sjoin_errors():
    frame = frame_of(3, 7, ["a"])
    for left, right, options, text in (
        (frame, frame, {"how": "outer"}, "how: expected"),
        (frame, np.ones(3), {}, "right_df: expected a GeoDataFrame, got ndarray"),
        (frame.assign(index_right=1), frame, {}, "left_df: expected no column 'index_right'"),
        (frame, frame, {"predicate": "near"}, "predicate: 'near'"),
    ):
        with pytest.raises(ValueError, match=text):
            geo.sjoin(left, right, **options)
    with pytest.warns(UserWarning, match="left_df has the CRS None, and right_df EPSG:4326"):
        geo.sjoin(frame, frame.set_crs("EPSG:4326"))
    for call, name in [
        (lambda: geo.sjoin(frame.assign(index=1), frame.assign(index=1)), "index_right"),
        (lambda: geo.sjoin(frame, frame, "right", lsuffix="x", rsuffix="x"), "a_x"),
        (lambda: geo.sjoin(frame.assign(a_left=1), frame), "a_left"),
        (lambda: geo.sjoin_nearest(frame, frame, distance_col="a_left"), "a_left"),
        (lambda: geo.sjoin_nearest(frame, frame, distance_col="geometry"), "geometry"),
    ]:
        with pytest.raises(ValueError, match=f"the result would have two columns '{name}'"):
            call()
    # Two columns of one name in a frame are the caller's.
    twice = frame_of(3, 7, ["b", "c"]).rename(columns={"c": "b"})
    assert list(geo.sjoin(twice, frame).columns) == ["b", "b", "geometry", "index_right", "a"]
    shapes = frame.rename_geometry("shape").assign(geometry=1)
    import geopandas
    name = "geometry_left" if geopandas.__version__.startswith("0.") else "geometry"
    assert geo.sjoin(frame, shapes).geometry.name == name
    near = geo.sjoin(frame, frame, predicate="dwithin", distance=100)
    there = sum(map(is_there, frame.geometry))
    assert len(near) == there**2
