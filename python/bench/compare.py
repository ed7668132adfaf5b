#!/usr/bin/env python3
"""Compares the module halfspace with other Python packages and with GEOS called from C,
on one thread, after it has checked that all answers are the same.

    python/bench/compare.py [--quick] [--repetitions R] [--out FILE.json]

Needs the module halfspace, a C compiler, and Debian's python3-shapely (1.8), python3-rtree,
python3-geopandas, python3-scipy and libgeos-dev. --quick takes a hundredth of
the objects and one repetition.
"""

import argparse
import ctypes
import os
import pathlib
import subprocess
import sys
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
import shapely.strtree

import halfspace as hs
import report

SEED = 1
CLUSTERS = 1000

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
    corners = np.stack([x, y], -1)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, :-1], corners[1:, 1:]
    triangles = np.stack([np.stack([a, b, c], -2), np.stack([b, d, c], -2)], -3)
    triangles = triangles.reshape(-1, 3, 2)
    return as_floats(np.hstack([triangles.min(1), triangles.max(1)]))


def points(rng, count, side):
    """Boxes of no size, or squares of two `side`: on a grid, so that floats are exact."""
    centers = rng.integers(1 << 20, size=(count, 2)) / (1 << 20)
    return np.hstack([centers - side, centers + side])


# Half the side of the squares in the join of points: exact on the grid of `points`.
SQUARE = 2.0 ** -10

libc_free = ctypes.CDLL(None).free
libc_free.argtypes = [ctypes.c_void_p]
libc_free.restype = None


# Libraries. `given` and `points` make what a caller of the library has before any call, which is
# not timed: arrays, or geometries. `join` returns pairs in the form that is fastest for the
# library, and `pairs` makes rows and ids of it, which is not timed either. `each` asks one query
# a call.


class Halfspace:
    name = "halfspace"
    given = staticmethod(lambda boxes: boxes)
    build = staticmethod(hs.BVH)
    join = staticmethod(hs.BVH.query)
    pairs = staticmethod(lambda found: found)
    each = staticmethod(lambda tree, boxes: [tree.query(box) for box in boxes])

    @staticmethod
    def points(boxes):
        return np.ascontiguousarray(boxes[:, :2])

    @staticmethod
    def nearest(tree, points, k):
        return tree.nearest(points, k=k)[0]


class Scan(Halfspace):
    name = "halfspace.Scan"
    build = staticmethod(hs.Scan)


def flat(lists):
    rows = np.repeat(np.arange(len(lists)), [len(ids) for ids in lists])
    return rows, np.array([i for ids in lists for i in ids], np.int64)


class Shapely:
    name = f"shapely {shapely.__version__}"
    given = staticmethod(lambda boxes: [shapely.geometry.box(*box) for box in boxes.tolist()])
    each = staticmethod(lambda tree, boxes: [tree.query_items(box) for box in boxes])
    join = each
    pairs = staticmethod(flat)

    @staticmethod
    def build(geometries):
        tree = shapely.strtree.STRtree(geometries)
        tree.query_items(geometries[0])  # the first query builds it
        return tree

    @staticmethod
    def points(boxes):
        return [shapely.geometry.Point(box[:2]) for box in boxes.tolist()]

    @staticmethod
    def nearest(tree, points, k):
        return np.array([[tree.nearest_item(point)] for point in points])


class Rtree:
    name = f"rtree {rtree.__version__}"
    given = points = staticmethod(lambda boxes: boxes.tolist())
    each = staticmethod(lambda tree, boxes: [list(tree.intersection(box)) for box in boxes])
    join = each
    pairs = staticmethod(flat)

    @staticmethod
    def build(boxes):
        # A stream, which is its bulk load.
        return rtree.index.Index((i, box, None) for i, box in enumerate(boxes))

    @staticmethod
    def nearest(tree, points, k):
        # More than k if some are equally far; the nearest are first.
        return np.array([list(tree.nearest(point, k))[:k] for point in points])


class Geopandas:
    name = f"geopandas {geopandas.__version__}"
    join = staticmethod(lambda frame, probes: geopandas.sjoin(probes, frame))

    @staticmethod
    def given(boxes):
        return geopandas.GeoDataFrame(geometry=Shapely.given(boxes))

    @staticmethod
    def build(frame):
        frame = frame.copy()  # without the index of the last time
        frame.sindex
        return frame

    @staticmethod
    def pairs(frame):
        return frame.index.to_numpy(), frame["index_right"].to_numpy()


class CkdTree:
    name = f"scipy {scipy.__version__} cKDTree"
    given = staticmethod(lambda boxes: (boxes[:, :2] + boxes[:, 2:]) / 2)
    build = staticmethod(lambda centers: scipy.spatial.cKDTree(centers))
    pairs = staticmethod(flat)

    @staticmethod
    def points(boxes):
        return boxes[:, :2]

    @staticmethod
    def nearest(tree, points, k):
        return tree.query(points, k=k)[1].reshape(-1, k)

    @staticmethod
    def join(tree, centers):
        return tree.query_ball_point(centers, SQUARE, p=np.inf, return_sorted=False)


class Geos:
    """GEOS from C (geos_tree.c)."""

    def __init__(self, directory):
        source = pathlib.Path(__file__).with_name("geos_tree.c")
        library = pathlib.Path(directory) / "geos_tree.so"
        subprocess.run([os.environ.get("CC", "cc"), "-O3", "-shared", "-fPIC", source, "-o",
                        library, "-lgeos_c", "-lm"], check=True)
        self.c = ctypes.CDLL(str(library))
        pointer, integer, size = ctypes.c_void_p, ctypes.c_int64, ctypes.c_size_t
        for name, returned, arguments in (
                ("geos_version", ctypes.c_char_p, ()),
                ("geos_rectangles", pointer, (pointer, size)),
                ("geos_rectangles_free", None, (pointer,)),
                ("geos_tree", pointer, (pointer,)),
                ("geos_tree_free", None, (pointer, pointer)),
                ("geos_join", integer, (pointer, pointer, pointer, pointer)),
                ("geos_nearest", integer, (pointer, pointer, pointer, pointer))):
            function = getattr(self.c, name)
            function.restype = returned
            function.argtypes = arguments
        self.name = f"GEOS {self.c.geos_version().decode().split('-')[0]} in C"

    class Owned:
        def __init__(self, pointer, free, *keep):
            if not pointer:
                raise MemoryError("GEOS made nothing")
            self.pointer = pointer
            self.free = free
            self.keep = keep

        def __del__(self):
            self.free(self.pointer)

    def given(self, boxes):
        boxes = np.ascontiguousarray(boxes)
        return self.Owned(self.c.geos_rectangles(boxes.ctypes.data, len(boxes)),
                          self.c.geos_rectangles_free, boxes)

    def build(self, rectangles):
        return self.Owned(self.c.geos_tree(rectangles.pointer),
                          lambda tree: self.c.geos_tree_free(tree, rectangles.pointer),
                          rectangles)

    def join(self, tree, probes):
        rows, ids = ctypes.c_void_p(), ctypes.c_void_p()
        count = self.c.geos_join(tree.pointer, probes.pointer, ctypes.byref(rows),
                                 ctypes.byref(ids))
        if count < 0:
            raise MemoryError("no memory for the pairs that GEOS finds")
        return (self.Owned(rows.value, libc_free), self.Owned(ids.value, libc_free), count)

    points = given
    each = join

    @staticmethod
    def pairs(found):
        rows, ids, count = found
        return tuple(np.ctypeslib.as_array(
            ctypes.cast(some.pointer, ctypes.POINTER(ctypes.c_int64)), (count,)).copy()
            for some in (rows, ids))

    def nearest(self, tree, probes, k):
        ids = np.empty((len(probes.keep[0]), k), np.int64)
        if self.c.geos_nearest(tree.pointer, tree.keep[0].pointer, probes.pointer,
                               ids.ctypes.data) != 0:
            raise RuntimeError("GEOS found no nearest object")
        return ids


libc_free = ctypes.CDLL(None).free
libc_free.argtypes = [ctypes.c_void_p]
libc_free.restype = None

def spaced(number):
    return f"{number:,}".replace(",", " ")


def seconds(call):
    """CPU time: other programs disturb it less, and no library gains by threads."""
    begin = time.process_time()
    result = call()
    return time.process_time() - begin, result


def in_turns(calls, repetitions, times=None):
    """{name: seconds of its runs}. A slow call runs less often."""
    times = times or {name: [] for name in calls}
    patience = 3.0
    while any(len(some) < repetitions and sum(some) < patience for some in times.values()):
        for name, call in calls.items():
            if len(times[name]) < repetitions and sum(times[name]) < patience:
                times[name].append(seconds(call)[0])
    return times


class Join:
    """Pairs of an object and a probe. `method`: join, or each."""

    def __init__(self, boxes, method="join"):
        self.count = len(boxes)
        self.method = method

    def call(self, library, tree, probes):
        given = library.given(probes)
        return lambda: getattr(library, self.method)(tree, given)

    def answer(self, library, result, probes):
        """A number for each pair, in ascending order."""
        if self.method == "each" and not isinstance(library, Geos):
            rows, ids = flat(result)
        else:
            rows, ids = library.pairs(result)
        return np.sort(rows * self.count + ids)

    same = staticmethod(np.array_equal)


class Nearest:
    """The k objects that are nearest to points."""

    def __init__(self, boxes, k):
        self.boxes = boxes
        self.k = k

    def call(self, library, tree, probes):
        given = library.points(probes)
        return lambda: library.nearest(tree, given, self.k)

    def answer(self, library, ids, probes):
        """Their distances."""
        near, points = self.boxes[ids], probes[:, None, :2]
        gaps = np.maximum(near[..., :2] - points, points - near[..., 2:]).clip(0)
        return np.sort(np.hypot(gaps[..., 0], gaps[..., 1]), 1)

    @staticmethod
    def same(a, b):
        # halfspace compares distances as floats: of two that are so near, either can be first.
        return np.allclose(a, b, rtol=1e-6, atol=1e-12)


class World:
    """Objects, and their trees in several libraries."""

    def __init__(self, name, boxes, libraries, repetitions):
        self.name = name
        self.boxes = boxes
        self.repetitions = repetitions
        self.trees = {}
        given, times = {}, {}
        for library in libraries:
            report.progress(f"{name}: {library.name} builds")
            given[library] = library.given(boxes)
            took, self.trees[library] = seconds(lambda: library.build(given[library]))
            times[library] = [took]
        self.builds = in_turns({library: lambda library=library: library.build(given[library])
                                for library in libraries}, repetitions, times)

    def build_cell(self, library):
        times = self.builds.get(library, [None])
        return report.spread(times) if len(times) > 1 else times[0]

    def contest(self, case, question, probes, limits):
        """The beginning of a row, and for each library how many times as long it takes as
        halfspace for the same probes. `limits`: the probes of each library, None for all."""
        limits = {library: min(limit or len(probes), len(probes))
                  for library, limit in limits.items()}
        whole = Halfspace, len(probes)
        keys = dict.fromkeys([whole, *((some, limit) for library, limit in limits.items()
                                       for some in (Halfspace, library))])
        calls, answers = {}, {}
        for library, limit in keys:
            report.progress(f"{self.name}, {case}: {library.name}")
            some = probes[:limit]
            calls[library, limit] = question.call(library, self.trees[library], some)
            answers[library, limit] = question.answer(library, calls[library, limit](), some)
        for library, limit in keys:
            if not question.same(answers[Halfspace, limit], answers[library, limit]):
                sys.exit(f"{self.name}, {case}: halfspace and {library.name} disagree. The "
                         "comparison needs equal answers, so this is a bug in one of them")
        times = in_turns(calls, self.repetitions)
        row = [self.name, case, round(answers[whole].size / len(probes), 2),
               report.spread([t / len(probes) * 1e6 for t in times[whole]])]
        return row, {library: report.ratios(times[library, limit], times[Halfspace, limit])
                     for library, limit in limits.items()}


def table(name, title, libraries, contests, notes):
    column = report.column
    rows = [[*row, *map(ratios.get, libraries)] for row, ratios in contests]
    return report.table(
        f"compare: {name}", title,
        [column("objects", key=True), column("query", key=True), column("results a probe"),
         column("halfspace", "us a probe", 3, better="lower"),
         *(column(f"{library.name}, times", digits=1) for library in libraries)], rows,
        ["times: how many times as long the library takes as halfspace.", *notes])


def joins(scale, geos, repetitions, rng):
    objects, probes = 1_000_000 // scale, 100_000 // scale
    grow = scale ** 0.5
    limits = {geos: None, Shapely: None, Rtree: None, Geopandas: probes // 10}
    cases = [
        ("uniform", uniform, 0.0005 * grow, {"small boxes": 0.0005, "large boxes": 0.00266}),
        ("skewed", skewed, 0.0002 * grow, {"small boxes": 0.00025, "large boxes": 0.0022}),
        ("mesh, in order", mesh, 1, {"another mesh": 0.3})]
    rows, builds = [], []
    for name, make, side, queries in cases:
        # Geometries in geopandas take longest to build: it sits out one world.
        asked = {library: limit for library, limit in limits.items()
                 if library is not Geopandas or make is not mesh}
        world = World(name, make(rng, objects, side), [Halfspace, *asked], repetitions)
        for case, probe_side in queries.items():
            boxes = make(rng, probes, probe_side * (1 if make is mesh else grow))
            rows.append(world.contest(case, Join(world.boxes), boxes, asked))
        builds.append([name, *(world.build_cell(library) for library in [Halfspace, *limits])])
    column = report.column
    return [
        table("join", f"{spaced(objects)} boxes joined with {spaced(probes)}, on one thread",
              list(limits), rows,
              [f"{Geopandas.name} uses rtree, and tests the geometries exactly. It runs on the "
               f"first {spaced(limits[Geopandas])} probes, and is compared with halfspace on them."]),
        report.table(
            "compare: build", f"Building a tree of {spaced(objects)} boxes, on one thread",
            [column("objects", key=True), column("halfspace", "s", 3, better="lower"),
             *(column(library.name, "s", 2) for library in limits)], builds,
            ["Geometries exist before the build."])]


def small(geos, repetitions, rng):
    limits = {Scan: None, geos: None, Shapely: None, Rtree: None}
    world = World("1 000 uniform boxes", uniform(rng, 1000, 0.0005 * 1000 ** 0.5),
                  [Halfspace, *limits], repetitions)
    rows = [world.contest("one a call", Join(world.boxes, "each"),
                          uniform(rng, 20_000, 0.0005 * 1000 ** 0.5), limits)]
    return table("small", "20 000 different queries of 1 000 boxes, one query a call",
                 list(limits), rows,
                 [f"{geos.name} is called from C, so that it has no cost of a call from Python."])


def nearest(scale, geos, repetitions, rng):
    objects, probes = 1_000_000 // scale, 100_000 // scale
    few = probes // 20
    rows = []
    world = World("points", points(rng, objects, 0), [Halfspace, CkdTree, Rtree], repetitions)
    for k in (1, 8):
        rows.append(world.contest(f"{k} nearest", Nearest(world.boxes, k),
                                  points(rng, probes, 0), {CkdTree: None, Rtree: few}))
    rows.append(world.contest("squares", Join(world.boxes), points(rng, probes, SQUARE),
                              {CkdTree: None, Rtree: None}))
    world = World("uniform boxes", uniform(rng, objects, 0.0005 * scale ** 0.5),
                  [Halfspace, Rtree, geos, Shapely], repetitions)
    for k, libraries in ((1, {Rtree: few, geos: None, Shapely: few}), (8, {Rtree: few})):
        rows.append(world.contest(f"{k} nearest", Nearest(world.boxes, k),
                                  uniform(rng, probes, 0), libraries))
    return table(
        "nearest", f"{spaced(objects)} objects, {spaced(probes)} points as probes, on one thread",
        [CkdTree, Rtree, geos, Shapely], rows,
        [f"squares: a join with squares of one size. {CkdTree.name} has query_ball_point for it.",
         f"{Rtree.name} and {Shapely.name} look for the nearest of the first {spaced(few)} probes, "
         "and are compared with halfspace on them."])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true",
                        help="a hundredth of the objects, one repetition")
    parser.add_argument("--repetitions", type=int, default=7,
                        help="of calls that take less than a second (7)")
    parser.add_argument("--out", help="also write the tables here, as JSON")
    arguments = parser.parse_args()
    if not shapely.__version__.startswith("1.8"):
        sys.exit(f"compare.py needs Shapely 1.8, as in Debian 12: this is {shapely.__version__}")
    if arguments.repetitions < 1:
        sys.exit("--repetitions must be at least 1")
    scale = 100 if arguments.quick else 1
    repetitions = 1 if arguments.quick else arguments.repetitions
    warnings.simplefilter("ignore", shapely.errors.ShapelyDeprecationWarning)
    rng = np.random.default_rng(SEED)
    with tempfile.TemporaryDirectory() as directory:
        geos = Geos(directory)
        tables = [*joins(scale, geos, repetitions, rng), small(geos, repetitions, rng),
                  nearest(scale, geos, repetitions, rng)]
    report.progress("")
    report.show(tables)
    if arguments.out:
        report.write(arguments.out, tables, SEED, repetitions)


if __name__ == "__main__":
    main()
