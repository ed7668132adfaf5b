#!/usr/bin/env python3
"""Measures halfspace.dask on two worker processes of this machine against one process,
and computes by a model what 1000 workers and 10^11 boxes would cost.

    python/bench/scale.py [--objects N] [--repetitions R] [--out FILE.json]

Needs the module `halfspace`, and python3-distributed. docs/scale.md explains the model.
"""

import os
import sys
import tempfile
import time

import dask.array
import distributed
import numpy as np

import halfspace as hs
import halfspace.dask as hd
import report
from halfspace.dask import _run
from report import seconds

WORKERS = 2
PARTITIONS = 2 * WORKERS
CHUNKS = 8
ROW_BYTES = 6 * 4 + 8  # a box and its row


def uniform(chunk, rows, side):
    rng = np.random.default_rng(chunk)
    low = rng.random((rows, 3), np.float32)
    return np.hstack([low, low + np.float32(side) * rng.random((rows, 3), np.float32)])


def skewed(chunk, rows, side):
    """90 % of the boxes in 1 % of the volume."""
    boxes = uniform(chunk, rows, side)
    dense = boxes[:rows * 9 // 10]
    dense *= np.float32(0.01 ** (1 / 3))
    return boxes


def collection(world, rows, side, first):
    """A dask array that workers make themselves, as they would read files."""
    each = rows // CHUNKS
    parts = [dask.array.from_delayed(dask.delayed(world)(first + chunk, each, side),
                                     (each, 6), np.float32) for chunk in range(CHUNKS)]
    return dask.array.concatenate(parts)


def incoming(client):
    """Bytes that workers have received from workers."""
    return sum(client.run(
        lambda dask_worker: sum(entry["total"] for entry in
                                dask_worker.transfer_incoming_log)).values())


def built(source):
    tree = hd.BVH(source, PARTITIONS).persist()
    distributed.wait(tree)
    return tree


def drain(batches):
    """Returns the seconds to the first batch, and the number of pairs."""
    begin = time.perf_counter()
    first = None
    count = 0
    for rows, _ in batches:
        first = first or time.perf_counter() - begin
        count += len(rows)
    return first, count


def chunks(world, rows, side, first, some=range(CHUNKS)):
    return [world(first + chunk, rows // CHUNKS, side) for chunk in some]


def whole(world, objects, side):
    return hs.BVH(np.concatenate(chunks(world, objects, side, 0)))


def write(tree, world, probes, side, some, directory):
    for i, chunk in zip(some, chunks(world, probes, side, 1000, some)):
        np.save(os.path.join(directory, f"{i}.npy"), tree.query(chunk))


def one_process(world, objects, probes, side):
    """One process that makes the same chunks, and joins them chunk by chunk."""
    build, tree = seconds(lambda: whole(world, objects, side))
    join, count = seconds(lambda: sum(len(tree.query(chunk)[0])
                                      for chunk in chunks(world, probes, side, 1000)))
    with tempfile.TemporaryDirectory() as directory:
        files, _ = seconds(lambda: write(tree, world, probes, side, range(CHUNKS), directory))
    return build, join, files, count


def each_alone(client, world, objects, probes, side):
    """The most that two processes of this machine reach: each has a tree of all objects,
    and joins half of the chunks in one task, without routing."""
    workers = list(client.scheduler_info()["workers"])
    trees = [client.submit(whole, world, objects, side, workers=[worker], pure=False)
             for worker in workers]
    distributed.wait(trees)
    with tempfile.TemporaryDirectory() as directory:
        files, _ = seconds(lambda: client.gather(
            [client.submit(write, tree, world, probes, side, range(CHUNKS)[first::WORKERS],
                           directory, workers=[worker], pure=False)
             for first, (tree, worker) in enumerate(zip(trees, workers))]))
    return files


def task_seconds(client):
    """What the scheduler takes for a task that does nothing."""
    tasks = 2000
    took, _ = seconds(lambda: client.gather(
        client.map(lambda i: None, range(tasks), pure=False)))
    return took / tasks


def bytes_a_second(client):
    """From one worker to another."""
    size = 1 << 28
    workers = list(client.scheduler_info()["workers"])
    found = []
    for _ in range(3):
        data = client.submit(np.ones, size, np.uint8, workers=workers[:1], pure=False)
        distributed.wait(data)
        took, _ = seconds(lambda: client.submit(len, data, workers=workers[1:2],
                                                pure=False).result())
        found.append(size / took)
    return report.median(found)


def sends(chunks, partitions):
    """The tasks that send rows of chunks to partitions."""
    if partitions <= _run.ONE_STAGE:
        return chunks * partitions
    step = _run.group_size(partitions)
    groups, blocks = -(-partitions // step), -(-chunks // step)
    return groups * (chunks + blocks) + blocks * partitions


def model(run, objects, probes, task, bandwidth):
    """The parts of the time of a build and a join to files, for this cluster and for a
    large one. Workers compute as one process does, send and receive at the same time as
    each other, and the scheduler takes one task after another."""
    build = report.median(run["build 1"]) / objects
    query = report.median(run["files 1"]) / probes
    measured_objects = objects

    def parts(objects, probes, workers, partitions, chunks, bandwidth, task):
        stay = 1 / workers  # the share of rows that stay on their worker
        # Read, sample and distribute; pieces; build and its description.
        build_tasks = 3 * chunks + sends(chunks, partitions) + 2 * partitions
        # A chunk of probes is read, routed and sent, and what is found comes back.
        join_tasks = 3 * chunks + 2 * sends(chunks, partitions)
        grown = np.log(objects / partitions) / np.log(measured_objects / PARTITIONS)
        return {
            "build": {
                "scheduler": build_tasks * task,
                "workers": objects / workers * build * grown,
                "network": objects / workers * ROW_BYTES * (1 - stay) / bandwidth},
            "join": {
                "scheduler": join_tasks * task,
                "workers": probes / workers * query * grown,
                "network": probes / workers * ROW_BYTES * (1 - stay) / bandwidth},
            "tasks": (build_tasks, join_tasks)}

    here = parts(objects, probes, WORKERS, PARTITIONS, CHUNKS, bandwidth, task)
    column = report.column
    check = report.table(
        "scale: model", "What the model says of this cluster, without contention",
        [column("step", key=True), column("scheduler", "s", 3), column("workers", "s", 3),
         column("network", "s", 3), column("sum", "s", 3), column("measured", "s", 3),
         column("measured over sum", digits=2), column("MB moved, model", digits=0),
         column("MB moved, measured", digits=0)],
        [[step, *(round(t, 5) for t in here[step].values()),
          round(sum(here[step].values()), 5), report.spread(run[f"{measured} 2"]),
          round(report.median(run[f"{measured} 2"]) / sum(here[step].values()), 4),
          round(rows * ROW_BYTES * (1 - 1 / WORKERS) / 1e6, 1),
          round(report.median(run[f"moved {step}"]) / 1e6, 1)]
         for step, measured, rows in (("build", "build", objects), ("join", "files", probes))])

    big, big_probes, workers, partitions, chunks = 10**11, 25 * 10**9, 1000, 1000, 1000
    there = parts(big, big_probes, workers, partitions, chunks, 1.25e9, task)
    large = report.table(
        "scale: paper", "1000 workers of one thread with 10 Gbit/s, 10^11 boxes, 2.5 * 10^10 "
        "probes: what each part takes alone",
        [column("plan", key=True), column("step", key=True), column("tasks", digits=0),
         column("scheduler", "s", 0), column("workers", "s", 0), column("network", "s", 0)],
        [[f"{partitions} partitions, {chunks} chunks", step, tasks,
          *(round(t, 1) for t in there[step].values())]
         for step, tasks in zip(("build", "join"), there["tasks"])])
    return [check, large]


def measure(client, name, world, objects, probes, side, repetitions):
    runs = []
    for repetition in range(repetitions):
        report.progress(f"{name}: {repetition + 1} of {repetitions}")
        build1, join1, files1, count1 = one_process(world, objects, probes, side)
        source = collection(world, objects, side, 0)
        before = incoming(client)
        build2, spread_tree = seconds(lambda: built(source))
        moved_build = incoming(client) - before
        probe_source = collection(world, probes, side, 1000)
        join2, (first, count2) = seconds(lambda: drain(spread_tree.query_batches(probe_source)))
        moved_join = incoming(client) - before - moved_build
        with tempfile.TemporaryDirectory() as directory:
            files2, paths = seconds(lambda: spread_tree.query_batches(probe_source, to=directory))
            count3 = sum(np.load(path, mmap_mode="r").shape[1] for path in paths)
        if not count1 == count2 == count3:
            sys.exit(f"{name}: {count1} pairs in one process, {count2} streamed and {count3} "
                     "in files on the cluster")
        sizes = spread_tree.sizes.compute()
        del spread_tree
        alone = each_alone(client, world, objects, probes, side)
        runs.append({"build 1": build1, "build 2": build2, "join 1": join1, "join 2": join2,
                     "files 1": files1, "files 2": files2, "first": first, "pairs": count1,
                     "moved build": moved_build, "moved join": moved_join,
                     "alone 2": alone, "most": sizes.max() / sizes.mean()})
    return {key: [run[key] for run in runs] for key in runs[0]}


def main():
    parser = report.parser(__doc__)
    parser.add_argument("--objects", type=int, default=8_000_000)
    parser.add_argument("--repetitions", type=int, default=5)
    arguments = parser.parse_args()
    objects = arguments.objects // CHUNKS * CHUNKS
    probes = objects // 4 // CHUNKS * CHUNKS

    with distributed.LocalCluster(n_workers=WORKERS, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster, \
            distributed.Client(cluster) as client:
        # A process that imports us has the functions of the sources.
        client.run(sys.path.insert, 0, os.path.dirname(os.path.abspath(__file__)))
        # As many pairs for each probe in both worlds: about 10.
        worlds = {"uniform": (uniform, (10 / objects) ** (1 / 3)),
                  "90 % in 1 %": (skewed, (10 / objects * 0.01 ** (-1 / 3)) ** (1 / 3))}
        found = {name: measure(client, name, world, objects, probes, side,
                               arguments.repetitions)
                 for name, (world, side) in worlds.items()}
        task = report.median([task_seconds(client) for _ in range(3)])
        bandwidth = bytes_a_second(client)

    column = report.column
    measured = report.table(
        "scale", f"{objects:,} boxes joined with {probes:,}".replace(",", " ")
        + f", on {WORKERS} workers and in one process",
        [column("world", key=True), column("step", key=True), column("one process", "s", 3),
         column("cluster", "s", 3), column("efficiency", digits=2, better="higher"),
         column("moved", "MB", 0)],
        [[name, step, report.spread(run[f"{part} 1"]), report.spread(run[f"{cluster} 2"]),
          report.ratios(run[f"{part} 1"], [WORKERS * t for t in run[f"{cluster} 2"]]),
          round(report.median(run[moved]) / 1e6, 1) if moved else None]
         for name, run in found.items()
         for step, part, cluster, moved in (("build", "build", "build", "moved build"),
                                            ("join, pairs to the client", "join", "join",
                                             "moved join"),
                                            ("join, pairs to files", "files", "files", None),
                                            ("the same, each worker with the whole tree",
                                             "files", "alone", None))],
        [f"{name}: {report.median(run['pairs']):,} pairs; first batch after "
         f"{report.median(run['first']):.2f} s; the largest partition has "
         f"{report.median(run['most']):.2f} times the mean number of objects."
         .replace(",", " ") for name, run in found.items()]
        + [f"The scheduler takes {task * 1e3:.2f} ms for a task.",
           "Efficiency: the time of one process over that of the cluster and over its "
           f"{WORKERS} workers.",
           f"A worker receives {bandwidth / 1e9:.2f} GB/s."])
    tables = [measured, *model(found["uniform"], objects, probes, task, bandwidth)]
    report.show(tables, arguments.out, 0, arguments.repetitions)


if __name__ == "__main__":
    main()
