"""Trees as bytes: pickles, files and buffers."""

import mmap
import os
import pickle

import halfspace as hs
import numpy as np
import pytest


@pytest.fixture
def tree(boxes):
    return hs.BVH(boxes)


class Subclass(hs.BVH):
    """A class of the caller's."""


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_pickle(tree, boxes, protocol):
    copy = pickle.loads(pickle.dumps(Subclass(boxes), protocol))
    assert type(copy) is Subclass and bytes(copy.blob()) == bytes(tree.blob())
    assert (copy.query(boxes) == tree.query(boxes)).all()


def test_pickle_out_of_band(tree, boxes):
    buffers = []
    data = pickle.dumps(tree, 5, buffer_callback=buffers.append)
    assert len(data) < 200
    assert len(buffers) == 1
    copy = pickle.loads(data, buffers=buffers)
    assert copy.blob().nbytes == tree.nbytes
    # It is the same memory.
    assert address(copy) == address(tree)
    del buffers
    assert (copy.query(boxes) == tree.query(boxes)).all()


def address(tree):
    return np.frombuffer(tree.blob(), np.uint8).ctypes.data


def test_file(tree, boxes, tmp_path):
    path = tmp_path / "tree"
    tree.save(path)
    assert path.stat().st_size == tree.nbytes
    assert list(tmp_path.iterdir()) == [path]
    for verify in (False, True):
        mapped = hs.BVH.map(path, verify=verify)
        assert (mapped.query(boxes) == tree.query(boxes)).all()
    # A change copies, and the file stays.
    mapped.erase(0)
    assert len(mapped) == len(boxes) - 1
    assert path.read_bytes() == bytes(tree.blob())


def test_in_place_and_copied(tree, boxes):
    page = np.frombuffer(mmap.mmap(-1, tree.nbytes + 1), np.uint8)
    in_place, shifted = page[:-1], page[1:]
    in_place[:] = tree.blob()
    assert address(hs.BVH.from_blob(in_place)) == page.ctypes.data
    shifted[:] = tree.blob()
    copied = hs.BVH.from_blob(shifted)
    shifted[:] = 0
    assert (copied.query(boxes) == tree.query(boxes)).all()


def test_a_blob_in_use_forbids_changes(tree):
    blob = tree.blob()
    with pytest.raises(BufferError, match="release it before you change"):
        tree.erase(0)
    assert len(tree) == 2000
    blob.release()
    tree.erase(0)
    assert len(tree) == 1999


def test_other_bytes(tree, tmp_path):
    data = bytes(tree.blob())
    other = bytes([data[0] ^ 1]) + data[1:]
    newer = data[:8] + bytes([data[8] + 1]) + data[9:]
    pickled = pickle.dumps(tree).replace(data[:12], newer[:12])
    empty, part = tmp_path / "empty", tmp_path / "part"
    empty.touch()
    part.write_bytes(data[:-1])
    with open(empty) as file:
        for call, its, error, text in (
            (hs.BVH.from_blob, b"", ValueError, "blob: the blob is empty"),
            (hs.BVH.map, empty, ValueError, f"^{empty}: the file is empty"),
            (hs.BVH.from_blob, data[:63], ValueError, "^blob: expected .*bytes"),
            (hs.BVH.map, part, ValueError, f"^{part}: expected .*bytes"),
            (hs.BVH.map, tmp_path / "none", FileNotFoundError, "none"),
            (hs.BVH.map, file.fileno(), TypeError, "not int"),
            (hs.BVH.from_blob, "text", TypeError, "bytes-like"),
            (hs.BVH.from_blob, other, ValueError, "expected the bytes of a stored BVH"),
            (hs.BVH.from_blob, newer, ValueError, "which is newer; use a newer version"),
            (pickle.loads, pickled, ValueError, "^pickle of a halfspace.BVH: expected .*newer"),
        ):
            with pytest.raises(error, match=text):
                call(its)
        os.fstat(file.fileno())  # no call has closed it


def test_an_altered_body(tree, boxes, tmp_path):
    data = bytearray(tree.blob())
    data[len(data) // 2] ^= 0x10
    with pytest.raises(ValueError, match="altered: its checksum"):
        hs.BVH.from_blob(data, verify=True)
    # Other results, but no crash.
    hs.BVH.from_blob(data).query(boxes)


def test_files_that_cannot_be_written(tree, tmp_path):
    missing = tmp_path / "no" / "tree"
    for path, error in ((tmp_path, IsADirectoryError), (missing, FileNotFoundError)):
        with pytest.raises(error, match=str(path)):
            tree.save(path)
    with pytest.raises(ValueError, match="path: embedded null byte"):
        tree.save(f"{tmp_path}/tree\0more")
    assert os.listdir(tmp_path) == []
    tree.erase(0)  # the error keeps no blob


@pytest.mark.parametrize("memory", [1, 10_000, 1 << 28])
def test_chunks_in_runs(boxes, tmp_path, memory):
    path = tmp_path / "tree ä.bvh"
    chunks = (boxes[first:first + 999] for first in range(0, len(boxes), 999))
    tree = hs.BVH.from_chunks(path, chunks, memory=memory)
    expected = hs.BVH(boxes, quality="fast" if memory < 1 << 20 else "high")
    assert bytes(tree.blob()) == bytes(expected.blob())
    assert os.listdir(tmp_path) == [path.name]


def test_chunks_that_are_none(boxes, tree, tmp_path):
    def interrupted():
        yield boxes
        raise KeyboardInterrupt

    other = np.zeros((1, 10 - boxes.shape[1]))
    path = tmp_path / "tree"
    tree.save(path)
    kept = []  # with their tracebacks
    for name, chunks, error, text in (
        (path, [], ValueError, "chunks: expected at least one array, got none"),
        (path, [boxes, other], ValueError, r"chunks\[1\]: expected boxes of shape"),
        (path, [boxes, boxes * np.nan], ValueError, r"chunks\[1\]"),
        (path, interrupted(), KeyboardInterrupt, ""),
        (path, boxes, TypeError, "chunks: expected a list or an iterator"),
        (f"{path}\0more", [boxes], ValueError, "path: embedded null byte"),
        (tmp_path / "no folder" / "tree", [boxes], FileNotFoundError, "cannot be created"),
        (tmp_path, [boxes], OSError, "cannot be written"),
    ):
        with pytest.raises(error, match=text) as raised:
            hs.BVH.from_chunks(name, chunks)
        kept.append(raised)
        assert os.listdir(tmp_path) == ["tree"]
    with pytest.raises(ValueError, match="memory: expected an integer from 1"):
        hs.BVH.from_chunks(path, [boxes], memory=0)
    assert bytes(hs.BVH.map(path).blob()) == bytes(tree.blob())


def test_pickle_with_other_doubles(boxes):
    make, (cls, blob, doubles) = hs.BVH(boxes, exact=True).__reduce_ex__(5)[:2]
    for size in (0, len(doubles) - 1, len(doubles) - boxes.shape[1], len(doubles) + 1):
        with pytest.raises(ValueError, match="^pickle of a halfspace.BVH: expected .*float64"):
            make(cls, blob, np.resize(doubles, size))


def test_pickle_of_a_tree_that_lost_its_objects(tree):
    tree.erase(np.arange(len(tree)))
    tree.rebuild()
    assert pickle.loads(pickle.dumps(tree)).dims == tree.dims
