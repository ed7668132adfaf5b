#!/usr/bin/env python3
"""Measures BVH.from_chunks: a build of more boxes than memory holds, in a process whose
memory, with its pages of files, is limited.

    python/bench/out_of_core.py [--objects N] [--memory GB] [--out FILE.json]

Needs the module `halfspace`, root and cgroups of memory (version 1 or 2) for the limit, and
70 bytes on the disk for each box. The files are in the current folder.
"""

import concurrent.futures
import multiprocessing
import os
import pathlib
import resource
import sys
import tempfile

import numpy as np

import halfspace as hs
import report
from report import seconds

CHUNK = 1 << 20
QUERIES = 20_000
FROM_DISK = 1000
CHECKED = 5
IN_MEMORY = 10_000_000


def boxes_of(chunk, rows, objects):
    """Squares, of which a query of the same size finds about one."""
    rng = np.random.default_rng(chunk)
    low = rng.random((rows, 2), np.float32)
    side = np.float32(1 / np.sqrt(objects)) * rng.random((rows, 1), np.float32)
    return np.hstack([low, low + side])


def chunks_of(objects):
    for first in range(0, objects, CHUNK):
        report.progress(f"{first / objects:.0%}")
        yield boxes_of(first, min(CHUNK, objects - first), objects)


def query_times(tree, queries):
    """Microseconds of one query: one a call, and all in one call."""
    calls = lambda: [tree.query(box) for box in queries], lambda: tree.query(queries)
    return [seconds(call)[0] / len(queries) * 1e6 for call in calls]


def check(tree, queries, objects):
    found = [set() for _ in range(CHECKED)]
    for i, chunk in enumerate(chunks_of(objects)):
        for box, ids in zip(queries, found):
            hits = ((chunk[:, :2] <= box[2:]) & (chunk[:, 2:] >= box[:2])).all(axis=1)
            ids.update((np.flatnonzero(hits) + i * CHUNK).tolist())
    for box, ids in zip(queries, found):
        if set(tree.query(box).tolist()) != ids:
            sys.exit(f"the tree finds other boxes than {len(ids)} of {box}")


def measure(objects, memory, folder):
    """In the process whose memory is limited."""
    queries = boxes_of(objects, FROM_DISK, objects)
    path = os.path.join(folder, "boxes.bvh")
    make, _ = seconds(lambda: [None for _ in chunks_of(objects)])
    build, tree = seconds(lambda: hs.BVH.from_chunks(path, chunks_of(objects),
                                                     memory=memory))
    check(tree, queries, objects)
    query, _ = query_times(tree, queries)
    return {"make": make, "build": build, "query": query, "bytes": os.path.getsize(path),
            "rss": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}


def limited(objects, memory):
    """Runs measure() in a process in a cgroup of its own, and returns its result."""
    for folder, file in (("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
                         ("/sys/fs/cgroup", "memory.max")):
        group = pathlib.Path(folder, f"halfspace-{os.getpid()}")
        try:
            group.mkdir()
            (group / file).write_text(str(memory))
        except OSError:
            if group.is_dir():
                group.rmdir()
            continue
        try:
            # Here, because a process that runs out of memory removes no folder.
            with tempfile.TemporaryDirectory(dir=".") as folder, \
                    concurrent.futures.ProcessPoolExecutor(
                        1, multiprocessing.get_context("fork"),
                        lambda: (group / "cgroup.procs").write_text(str(os.getpid()))) as pool:
                return pool.submit(measure, objects, memory // 4, folder).result()
        finally:
            group.rmdir()
    sys.exit("the memory cannot be limited: run this as root, with cgroups of memory")


def in_memory(objects, repetitions=5):
    """Of boxes that fit: trees of chunks and trees in memory, in turns."""
    boxes = np.concatenate(list(chunks_of(objects)))
    queries = boxes_of(objects, QUERIES, objects)
    rows = []
    with tempfile.TemporaryDirectory(dir=".") as folder:
        path = os.path.join(folder, "boxes.bvh")
        parts = [boxes[i:i + CHUNK] for i in range(0, objects, CHUNK)]
        builds = {"chunks": lambda: hs.BVH.from_chunks(path, parts, memory=1 << 26),
                  "fast": lambda: hs.BVH(boxes, quality="fast"),
                  "high": lambda: hs.BVH(boxes)}
        times = {name: [] for name in builds}
        trees = {}
        for repetition in range(repetitions):
            for name, build in builds.items():
                report.progress(f"in memory: {repetition + 1} of {repetitions}, {name}")
                took, trees[name] = seconds(build)
                query_times(trees[name], queries)  # maps the pages
                times[name].append((took, *query_times(trees[name], queries)))
        answers = [np.sort(tree.query(queries)[1]).tolist() for tree in trees.values()]
        if answers != answers[:1] * 3:
            sys.exit("trees of the same boxes find different ones")
        for name in ("fast", "high"):
            over, under = np.array(times["chunks"]), np.array(times[name])
            rows.append([name, *(report.ratios(over[:, i], under[:, i]) for i in range(3))])
    return rows


def main():
    parser = report.parser(__doc__)
    parser.add_argument("--objects", type=int, default=100_000_000)
    parser.add_argument("--memory", type=float, default=1, help="in GB of 2^30 bytes")
    arguments = parser.parse_args()
    objects = arguments.objects
    memory = int(arguments.memory * (1 << 30))
    found = limited(objects, memory)
    rows = in_memory(min(objects, IN_MEMORY))
    column = report.column
    text = f"{objects:,}".replace(",", " ")
    tables = [
        report.table("out of core", f"{text} boxes in 2D, with {arguments.memory:g} GB of memory",
                     [column("step", key=True), column("time", digits=2), column("unit")],
                     [["make the chunks", found["make"], "s"],
                      ["make the chunks and build", found["build"], "s"],
                      ["query", found["query"], "us"]],
                     [f"The file has {found['bytes'] / 1e9:.2f} GB. The pages of the process, "
                      f"with those of files, had at most {found['rss'] / 1e9:.2f} GB. {FROM_DISK} "
                      f"different queries, of which {CHECKED} were compared with all boxes."]),
        report.table("out of core: in memory",
                     f"{min(objects, IN_MEMORY):,} boxes: time of chunks in runs of 64 MiB over "
                     "that of a tree in memory".replace(",", " "),
                     [column("quality", key=True), column("build"), column("query, one a call"),
                      column("query, all in one call")], rows)]
    report.show(tables, arguments.out, 0, 5)


if __name__ == "__main__":
    main()
