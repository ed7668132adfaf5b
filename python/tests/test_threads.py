"""Threads, Ctrl-C and progress."""

import contextlib
import functools
import os
import pickle
import signal
import threading
import time

import halfspace as hs
import numpy as np
import pytest

from conftest import random_boxes, repeated

RNG = np.random.default_rng(3)
BOXES = random_boxes(RNG, 1_000_000, 3, 0.05)
TREE = hs.BVH(BOXES, quality="fast")

# Each takes tenths of a second at least.
LONG_CALLS = {
    "build": lambda **k: hs.BVH(BOXES.repeat(2, axis=0), **k),
    "count": lambda **k: TREE.count(BOXES, **k),
    "any": lambda **k: TREE.any(BOXES.repeat(6, axis=0), **k),
    "query": lambda **k: TREE.query(BOXES, **k),
    "query one after another": lambda **k: hs.BVH(
        BOXES.repeat(4, axis=0), quality="fast"
    ).query(BOXES[:200_000], **k),
    "nearest": lambda **k: TREE.nearest(BOXES, 10, **k),
    "raycast": lambda **k: TREE.raycast(BOXES[:, :3], [1, 1, 1], **k),
    "pairs": lambda **k: TREE.pairs(**k),
    "join": lambda **k: hs.join(TREE, TREE, **k),
    "scan": lambda **k: hs.Scan(BOXES).count(BOXES[:20_000], **k),
}


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("call", LONG_CALLS)
def test_ctrl_c(call, threads):
    def interrupt():
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.1, interrupt)
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        LONG_CALLS[call](threads=threads)
        # The call ended too early, or did not see the signal.
        timer.cancel()
        pytest.fail("the call did not end early")
    timer.join()
    # The tree is not locked.
    TREE.erase(TREE.insert([0, 0, 0, 1, 1, 1]))


def test_progress(rng):
    boxes = random_boxes(rng, 500_000, 3, 0.01)
    some = boxes[:300_000]
    tree = hs.BVH(boxes)
    calls = []

    def progress(done, total):
        assert threading.current_thread() is threading.main_thread()
        calls.append((done, total))

    on_two_threads = functools.partial(hs.BVH, threads=2)
    for call, its in (
        *((build, boxes) for build in (hs.BVH, on_two_threads, tree.refit)),
        *((search, some) for search in (tree.query, tree.count, tree.any, tree.nearest)),
    ):
        calls.clear()
        call(its, progress=progress)
        done, totals = zip(*calls)
        assert list(done) == sorted(done) and done[-1] == len(its) and set(totals) == {len(its)}
    calls.clear()
    hs.BVH(boxes[:0], progress=progress).pairs(progress=progress)
    assert calls == []


def own(tree):
    with tree.changing():
        pass


BOX = [0, 0, 0, 1, 1, 1]


@pytest.mark.parametrize(
    "outer, inner, message",
    [("query", lambda tree: tree.insert(BOX), "another call is using this BVH"),
     ("query", lambda tree: tree.erase(0), "another call is using this BVH"),
     ("query", lambda tree: tree.refit(BOX, 1), "another call is using this BVH"),
     ("query", own, "inside of a call"),
     ("refit", lambda tree: tree.query(BOX), "another call is changing this BVH"),
     ("refit", own, "inside of a call")],
)
def test_a_call_within_a_call(rng, outer, inner, message):
    boxes = random_boxes(rng, 1000, 3)
    tree = hs.BVH(boxes)
    calls = []

    def progress(done, total):
        with pytest.raises(RuntimeError, match=message):
            inner(tree)
        calls.append(done)

    getattr(tree, outer)(boxes, progress=progress)
    assert calls
    inner(tree)


def test_changing_waits_and_makes_wait(rng):
    """Readers see the tree before a change or after it, and no call fails."""
    low = rng.random((20_000, 3))
    tree, other = hs.BVH(np.hstack([low, low])), hs.BVH([[0] * 3 + [9] * 3])
    counts = set()
    everything = np.array([-1.0] * 3 + [9] * 3)
    calls = [lambda: tree.count(everything), lambda: len(tree.query(everything)),
             lambda: len(hs.join(tree, other)[0]), lambda: len(hs.join(other, tree)[0]),
             lambda: len(tree)]

    def change():
        with tree.changing():
            with tree.changing():
                ids = tree.insert(np.hstack([low[:50], low[:50]]))
            tree.refit(tree.boxes(ids) + 1, ids)
            assert tree.count(everything) == 20_050
            tree.erase(ids)

    readers = [lambda i=i: counts.update(call() for call in calls[i:]) for i in range(3)]
    with repeated(change, *readers):
        for _ in range(20):
            change()
    assert counts == {20_000}


@pytest.mark.parametrize("exact", [False, True])
def test_changing_waits_for_pickles(rng, exact):
    low = rng.random((20_000, 3))
    tree = hs.BVH(np.hstack([low, low]), exact=exact)
    sizes = set()

    def change():
        with tree.changing():
            tree.erase(tree.insert(tree.boxes([0, 1])))

    with repeated(lambda: sizes.add(len(pickle.loads(pickle.dumps(tree, 5))))):
        for _ in range(50):
            change()
    assert sizes == {20_000}
    # The bytes are in use until the pickler has passed them on.
    events, is_pickling = [], threading.Event()

    def slowly(buffer):
        is_pickling.set()
        time.sleep(0.2)
        events.append("pickled")

    thread = threading.Thread(target=lambda: pickle.dumps(tree, 5, buffer_callback=slowly))
    thread.start()
    is_pickling.wait()
    change()
    events.append("changed")
    thread.join()
    assert events[-1] == "changed"


def test_changing_does_not_wait_for_buffers_of_its_own_thread(rng):
    tree, buffers = hs.BVH(random_boxes(rng, 100, 3)), []
    pickle.dumps(tree, 5, buffer_callback=buffers.append)
    with pytest.raises(BufferError, match="release it before you change"):
        with tree.changing():
            pass
    with pytest.raises(BufferError, match="release it before you change"):
        tree.erase(0)
    buffers.clear()
    blob = tree.blob()
    with tree.changing(), pytest.raises(BufferError, match="release it before you change"):
        tree.erase(0)
    blob.release()
    own(tree)


def test_an_exception_of_a_signal_leaves_no_tree_locked():
    class Alarm(Exception):
        pass

    def raises(*_):
        raise Alarm

    tree = hs.BVH([[0, 0, 1, 1]])
    before = signal.signal(signal.SIGALRM, raises)
    try:
        for i in range(100):
            with contextlib.suppress(Alarm):
                signal.setitimer(signal.ITIMER_REAL, 1e-3 + 1e-5 * i)
                while True:
                    with tree.changing():
                        pass
    finally:
        signal.signal(signal.SIGALRM, before)
    with pytest.raises(KeyError), tree.changing():
        raise KeyError
    sizes = []
    thread = threading.Thread(target=lambda: sizes.append(len(tree)), daemon=True)
    thread.start()
    thread.join(60)
    assert sizes == [1]


def test_an_interrupted_refit_must_be_repeated(rng):
    # So many that a refit takes several times the 50 ms after which progress is called.
    boxes = random_boxes(rng, 4_000_000, 3, 0.01)
    doubles = boxes.astype(float)
    tree = hs.BVH(boxes, quality="fast")

    def stop(done, total):
        if done < total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        while True:
            tree.refit(doubles, threads=2, progress=stop)
    for call in (lambda: tree.query(boxes[:1]), lambda: tree.query(boxes[0]), tree.blob,
                 lambda: tree.erase([0])):
        with pytest.raises(RuntimeError, match=r"call refit\(\) with all boxes again"):
            call()
    tree.refit(boxes)
    assert 7 in tree.query(boxes[7])


def test_queries_run_at_the_same_time():
    """Another thread runs while a call works."""
    ticks, seen = [], []

    def tick():
        ticks.append(0)
        time.sleep(0.001)

    def watch(done, total):
        seen.append(len(ticks))
        if len(seen) == 4:
            raise KeyboardInterrupt

    with repeated(tick), pytest.raises(KeyboardInterrupt):
        TREE.pairs(progress=watch)
    assert seen[-1] - seen[0] > 5
