#!/usr/bin/env python3
"""Compares the calls of the module halfspace with those of other Python packages and with
GEOS called from C, on one thread. Each answer is checked before it is timed.

    python/bench/compare.py [--quick] [--repetitions R] [--out FILE.json]

Needs the module halfspace with what builds it, and Debian's python3-shapely (1.8),
python3-rtree, python3-geopandas, python3-scipy and libgeos-dev. --quick takes a hundredth of
the objects and one repetition.
"""

import ctypes
import gc
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import time
import warnings

os.environ["USE_PYGEOS"] = "0"  # geopandas warns if it is unset

import geopandas
import numpy as np
import rtree
import scipy
import scipy.spatial
import shapely
import shapely.geometry
import shapely.prepared
import shapely.strtree

import halfspace as hs
import halfspace.geo
import report

SEED = 1
CLUSTERS = 1000
# Half the side of the squares in joins of points, and a distance: exact on the grid of `points`.
SQUARE = 2.0 ** -10

# Worlds: boxes as rows of min x, min y, max x, max y. All values are floats, in arrays of
# doubles: every library gets the same numbers, and halfspace rounds none of them.


def as_floats(boxes):
    return boxes.astype(np.float32).astype(np.float64)


def uniform(rng, count, side):
    """Boxes of a mean side."""
    low = rng.random((count, 2))
    return as_floats(np.hstack([low, low + 2 * side * rng.random((count, 2))]))


def skewed(rng, count, side):
    """Clusters of three decades of extent, boxes of four decades of size."""
    # The same clusters for objects and probes.
    clusters = np.random.default_rng(SEED)
    centers = clusters.random((CLUSTERS, 2))
    extents = 10 ** clusters.uniform(-4, -1, (CLUSTERS, 1))
    which = rng.integers(CLUSTERS, size=count)
    low = centers[which] + extents[which] * rng.standard_normal((count, 2))
    sides = side * 10 ** rng.uniform(-4, 0, (count, 1)) * rng.random((count, 2))
    return as_floats(np.hstack([low, low + sides]))


def mesh(rng, count, side):
    """The triangles of a bent grid seen from above, in the order of the grid. Its side is
    `side`, and that of the world is 1."""
    n = int(np.sqrt(count / 2))
    v, u = np.mgrid[:n + 1, :n + 1] / n - 0.5
    turn = rng.uniform(0.2, 1)
    x = side * (u * np.cos(turn) - v * np.sin(turn) + 0.02 * np.sin(9 * v))
    y = side * (u * np.sin(turn) + v * np.cos(turn) + 0.02 * np.sin(7 * u))
    corners = as_floats(np.stack([x, y], -1))
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, :-1], corners[1:, 1:]
    # Two triangles in each cell of the grid.
    triangles = np.stack([np.stack([a, b, c], -2), np.stack([b, d, c], -2)], -3).reshape(-1, 3, 2)
    return np.hstack([triangles.min(1), triangles.max(1)])


def points(rng, count, side=0):
    """Boxes of no size, or squares of two `side`: on a grid, so that floats are exact."""
    centers = rng.integers(1 << 20, size=(count, 2)) / (1 << 20)
    return np.hstack([centers - side, centers + side])


def geos_module(directory):
    """GEOS from C (geos_tree.cc)."""
    source = pathlib.Path(__file__).with_name("geos_tree.cc")
    subprocess.run([os.environ.get("CXX", "c++"), "-std=c++17", "-O3", "-shared", "-fPIC",
                    "-fvisibility=hidden", f"-I{sysconfig.get_path('include')}", source,
                    "-o", f"{directory}/geos_tree.so", "-lgeos_c"], check=True)
    sys.path.insert(0, directory)
    import geos_tree
    geos_tree.name = f"GEOS {geos_tree.version().split('-')[0]} in C"
    return geos_tree


def rectangles(boxes):
    return [shapely.geometry.box(*box) for box in boxes.tolist()]


def build_shapely(geometries):
    tree = shapely.strtree.STRtree(geometries)
    tree.query_items(geometries[0])  # the first query builds it
    return tree


def build_rtree(boxes):
    # A stream, which is its bulk load.
    return rtree.index.Index((i, box, None) for i, box in enumerate(boxes))


SHAPELY = f"shapely {shapely.__version__}"
RTREE = f"rtree {rtree.__version__}"
GEOPANDAS = f"geopandas {geopandas.__version__}"
SCIPY = f"scipy {scipy.__version__} cKDTree"

# Answers, which make what two libraries return equal.


def rows_and_ids(found):
    """Those of an array of rows and ids, or of the ids of each query."""
    if len(found) == 2:
        return np.asarray(found, np.int64)
    found = [np.atleast_1d(ids) for ids in found]
    return np.array([np.repeat(np.arange(len(found)), [len(ids) for ids in found]),
                     np.concatenate(found)], np.int64)


def as_pairs(found):
    """A number for each pair, in ascending order."""
    rows, ids = rows_and_ids(found)
    return np.sort(rows << 32 | ids)


def gaps(boxes, probes, rows, ids):
    """The distances of pairs of boxes."""
    a, b = probes[rows], boxes[ids]
    apart = np.maximum(b[:, :2] - a[:, 2:], a[:, :2] - b[:, 2:]).clip(0)
    return np.hypot(apart[:, 0], apart[:, 1])


def distances(boxes, probes):
    """Those of each row in order, and whether they are the same."""
    def answer(found):
        rows, ids = rows_and_ids(found)
        far = gaps(boxes, probes, rows, ids)
        return far[np.lexsort((far, rows))]

    # halfspace compares distances as floats: of two that are so near, either can be first.
    return answer, lambda a, b: a.shape == b.shape and np.allclose(a, b, rtol=1e-6, atol=1e-12)


def pairs_within(boxes, probes, limit):
    """Pairs, and whether they are the same, except for those so near the limit that floats
    decide otherwise."""
    def same(a, b):
        pairs = np.setxor1d(a, b)
        return np.allclose(gaps(boxes, probes, pairs >> 32, pairs & 0xffffffff), limit, 1e-5)
    return as_pairs, same


# The table.


def bytes_of(build):
    """The result of a build, and by how much the memory of the process has grown."""
    def resident():
        gc.collect()
        ctypes.CDLL(None).malloc_trim(0)
        pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    before = resident()
    built = build()
    return built, resident() - before


def row_of(repetitions, objects, count, call, peer, ours, theirs, answer=as_pairs,
           same=np.array_equal, sizes=(None, None)):
    """`ours` and `theirs` are calls of `count` queries, which are timed, and `answer` makes
    their results equal. A slow call runs less often."""
    report.progress(f"{call}, {objects}: {peer}")
    answers = [answer(run()) for run in (ours, theirs)]
    if not same(*answers):
        sys.exit(f"{call}, {objects}: halfspace and {peer} disagree. The comparison needs "
                 "equal answers, so this is a bug in one of them")
    times = [], []
    while len(times[0]) < repetitions and sum(times[1]) < 1:
        for run, some in zip((ours, theirs), times):
            # CPU time: other programs disturb it less, and no library gains by threads.
            some.append(report.seconds(run, time.process_time)[0])
    return [call, objects, peer, round(np.size(answers[0]) / count, 2) or None,
            report.spread([t / count * 1e6 for t in times[0]]), report.ratios(times[1], times[0]),
            *sizes]


# Each of these functions yields the arguments of row_of(), which runs before the next one.


def builds(objects, boxes, *peers):
    """Returns the trees of halfspace and of the peers, which are names, what a caller has
    before any call, and functions."""
    count = len(boxes)
    tree, our_size = bytes_of(lambda: hs.BVH(boxes))
    trees = [tree]
    for name, given, build in peers:
        built, size = bytes_of(lambda: build(given))
        trees.append(built)
        yield (objects, count, "BVH(boxes)", name, lambda: hs.BVH(boxes), lambda: build(given),
               lambda _: (), np.array_equal, [our_size / count, size / count])
    return trees


def boxes_of(geos, scale, rng):
    objects, count, grow = 1_000_000 // scale, 100_000 // scale, scale ** 0.5
    for name, make, side, queries in (
            ("skewed boxes", skewed, 0.0002 * grow, {"small": 0.00025, "large": 0.0022}),
            ("mesh, in order", mesh, 1, {"another mesh": 0.3 / grow}),
            ("uniform boxes", uniform, 0.0005 * grow, {"small": 0.0005, "large": 0.00266})):
        boxes = make(rng, objects, side)
        tree, of_geos = yield from builds(name, boxes,
                                          (geos.name, geos.Rectangles(boxes), geos.Tree))
        for size, its_side in queries.items():
            probes = make(rng, count, its_side * grow)
            given = geos.Rectangles(probes)
            yield (name, len(probes), f"query(boxes), {size}", geos.name,
                   lambda: tree.query(probes), lambda: of_geos.join(given))
    # The last world, and its large queries.
    yield (name, count, "query(boxes, within=)", geos.name,
           lambda: tree.query(probes, within=SQUARE), lambda: of_geos.join(given, SQUARE),
           *pairs_within(boxes, probes, SQUARE))
    yield (name, count, "nearest(boxes)", geos.name, lambda: tree.nearest(probes)[0],
           lambda: of_geos.nearest(given), *distances(boxes, probes))
    # No floats: the maxima are less than a step of floats above those of `boxes`.
    doubles = boxes * [1, 1, 1 + 1e-12, 1 + 1e-12]
    exact, size = bytes_of(lambda: hs.BVH(doubles, exact=True))
    its = geos.Rectangles(doubles)
    of_geos, its_size = bytes_of(lambda: geos.Tree(its))
    yield (name, count, "BVH(boxes, exact=True).query", geos.name, lambda: exact.query(probes),
           lambda: of_geos.join(given), as_pairs, np.array_equal,
           [size / objects, its_size / objects])


def of_points(geos, scale, rng):
    objects, count = 1_000_000 // scale, 100_000 // scale
    boxes, probes = points(rng, objects), points(rng, count)
    ours, theirs = boxes[:, :2].copy(), probes[:, :2].copy()
    tree, of_scipy = yield from builds("points", boxes, (SCIPY, ours, scipy.spatial.cKDTree))
    for k in (1, 8):
        yield ("points", count, f"nearest(points, {k})", SCIPY, lambda: tree.nearest(theirs, k)[0],
               lambda: of_scipy.query(theirs, k)[1], *distances(boxes, probes))
    squares = probes + [-SQUARE, -SQUARE, SQUARE, SQUARE]
    within = lambda **how: of_scipy.query_ball_point(theirs, SQUARE, return_sorted=False, **how)
    yield ("points", count, "query(boxes), squares", SCIPY, lambda: tree.query(squares),
           lambda: within(p=np.inf))
    yield ("points", count, "query_sphere(points, r)", SCIPY,
           lambda: tree.query_sphere(theirs, SQUARE), within, *pairs_within(boxes, probes, SQUARE))
    yield ("points", count, "query(boxes, within=)", SCIPY,
           lambda: tree.query(probes, within=SQUARE), within, *pairs_within(boxes, probes, SQUARE))
    # Of a coarse grid, and between its points, so that many are equally near.
    side = int((objects / 10) ** 0.5)
    boxes, probes = np.floor(boxes[:objects // 5] * side), np.floor(probes * side) + 0.5
    given = geos.Rectangles(probes)
    tree, of_geos = yield from builds("points of a grid", boxes,
                                      (geos.name, geos.Rectangles(boxes), geos.Tree))
    yield ("points of a grid", count, "nearest(boxes, all_ties=True)", geos.name,
           lambda: tree.nearest(probes, all_ties=True)[0],
           lambda: of_geos.nearest(given, with_ties=True))


def packages(geos, scale, rng):
    """Packages that take long to build, with fewer boxes."""
    objects, count, grow = 200_000 // scale, 20_000 // scale, (5 * scale) ** 0.5
    boxes, probes = (uniform(rng, n, 0.0005 * grow) for n in (objects, count))
    geometries, rows = rectangles(probes), probes.tolist()
    frame, its_frame = (geopandas.GeoDataFrame(geometry=some)
                        for some in (rectangles(boxes), geometries))
    name = "fewer uniform boxes"
    tree, of_shapely, of_rtree = yield from builds(
        name, boxes, (SHAPELY, list(frame.geometry), build_shapely),
        (RTREE, boxes.tolist(), build_rtree))
    for peer, ask in (
            (SHAPELY, lambda: [of_shapely.query_items(box) for box in geometries]),
            (RTREE, lambda: [list(of_rtree.intersection(row)) for row in rows])):
        yield name, count, "query(boxes)", peer, lambda: tree.query(probes), ask
        yield (name, count, "query(box), one a call", peer,
               lambda: [tree.query(box) for box in probes], ask)
    few = probes[:count // 10]
    yield (name, len(few), "nearest(boxes)", RTREE, lambda: tree.nearest(few)[0],
           lambda: [next(of_rtree.nearest(row)) for row in rows[:len(few)]],
           *distances(boxes, few))
    yield name, count, *joins_of(its_frame, frame)


def joins_of(left, right):
    return ("geo.sjoin(frame, frame)", GEOPANDAS, lambda: halfspace.geo.sjoin(left, right),
            lambda: geopandas.sjoin(left, right.copy()),  # without the index of the last time
            lambda frame: as_pairs((frame.index, frame["index_right"])))


def geometries(geos, scale, rng):
    """Discs, and lines or points that are joined with them."""
    objects, count, grow = 20_000 // scale, 20_000 // scale, scale ** 0.5
    discs = [shapely.geometry.Point(*place).buffer(radius * grow)
             for *place, radius in rng.uniform([0, 0, 1e-3], [1, 1, 9e-3], (objects, 3))]
    starts = rng.random((count, 2))
    lines = [shapely.geometry.LineString(some) for some in
             np.stack([starts, starts + rng.uniform(-0.02, 0.02, (count, 2)) * grow], 1)]
    places = [shapely.geometry.Point(*place) for place in starts]
    yield ("discs", objects, "geo.STRtree(geometries)", SHAPELY,
           lambda: halfspace.geo.STRtree(discs), lambda: build_shapely(discs), lambda _: ())
    tree, of_shapely = halfspace.geo.STRtree(discs), build_shapely(discs)

    def intersects():
        found = []
        for line in lines:
            prepared = shapely.prepared.prep(line)
            found.append([i for i in of_shapely.query_items(line)
                          if prepared.intersects(discs[i])])
        return found

    yield ("discs", count, 'geo.STRtree.query(..., "intersects")', SHAPELY,
           lambda: tree.query(lines, "intersects"), intersects)
    yield ("discs", count, "geo.STRtree.nearest", SHAPELY, lambda: tree.nearest(places),
           lambda: [of_shapely.nearest_item(place) for place in places],
           lambda found: np.array([a.distance(discs[i]) for a, i in zip(places, found)]))
    frames = (geopandas.GeoDataFrame(geometry=some) for some in (places, discs))
    yield "discs", count, *joins_of(*frames)


def table_of(rows):
    column = report.column
    return report.table(
        "compare", "Calls of halfspace and of other packages, on one thread",
        [column("call", key=True), column("objects", key=True), column("package", key=True),
         column("results a query"), column("halfspace", "us a query", 3, better="lower"),
         column("times", digits=1), column("halfspace, bytes an object", digits=0),
         column("package, bytes an object", digits=0)], rows,
        ["times: how many times as long the package takes as halfspace. A query of a build is "
         "an object.",
         "bytes an object: of the tree, without what the caller has before. For some packages "
         "this has other objects of Python.",
         "Shapely 2 calls the tree of GEOS from C for a whole array, so GEOS in C is the best "
         "that its query, dwithin and query_nearest can reach. shapely 1.8 is called once for "
         f"each query. {GEOPANDAS} uses rtree, and has no sjoin_nearest with it."])


def main():
    parser = report.parser(__doc__)
    parser.add_argument("--quick", action="store_true",
                        help="a hundredth of the objects, one repetition")
    parser.add_argument("--repetitions", type=int, default=7,
                        help="of calls that take less than a seventh of a second (7)")
    arguments = parser.parse_args()
    if not shapely.__version__.startswith("1.8"):
        sys.exit(f"compare.py needs Shapely 1.8, as in Debian 12: this is {shapely.__version__}")
    if arguments.repetitions < 1:
        sys.exit("--repetitions must be at least 1")
    scale = 100 if arguments.quick else 1
    warnings.simplefilter("ignore", shapely.errors.ShapelyDeprecationWarning)
    rng = np.random.default_rng(SEED)
    repetitions = 1 if arguments.quick else arguments.repetitions
    with tempfile.TemporaryDirectory() as directory:
        geos = geos_module(directory)
        rows = [row_of(repetitions, *row)
                for world in (boxes_of, of_points, packages, geometries)
                for row in world(geos, scale, rng)]
    report.show([table_of(rows)], arguments.out, SEED, repetitions)


if __name__ == "__main__":
    main()
