"""Columns of the Arrow C data interface, which
https://arrow.apache.org/docs/format/CDataInterface.html describes."""

from __future__ import annotations

import ctypes
import struct
from typing import Any, Tuple

import numpy as np

# The members of struct ArrowSchema, of struct ArrowArray, and of its buffers.
_SCHEMA = struct.Struct("@3P2q4P")
_ARRAY = struct.Struct("@5q5P")
_BUFFERS = struct.Struct("@2P")

# A prototype of its own, as other users of ctypes.pythonapi set other types.
_pointer_of = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi)
)

_TYPES = {b"f": np.dtype(np.float32), b"g": np.dtype(np.float64)}


def _members(layout: struct.Struct, address: int) -> Tuple[Any, ...]:
    return layout.unpack(ctypes.string_at(address, layout.size))


def _memory(address: int, dtype: np.dtype, length: int, owner: Any) -> np.ndarray:
    """The memory at an address, as an array that keeps its owner alive."""
    memory: Any = (ctypes.c_char * (length * dtype.itemsize)).from_address(address)
    memory.owner = owner
    return np.frombuffer(memory, dtype)


def column(value: Any, name: str) -> np.ndarray:
    """The memory of an object with __arrow_c_array__, as an array. No nulls."""
    made = value.__arrow_c_array__()
    if not isinstance(made, tuple) or len(made) != 2:
        raise TypeError(f"{name}: expected __arrow_c_array__() to return two capsules")
    schema = _members(_SCHEMA, _pointer_of(made[0], b"arrow_schema"))
    array = _members(_ARRAY, _pointer_of(made[1], b"arrow_array"))
    if not schema[7] or not array[8]:
        raise ValueError(f"{name}: expected an Arrow array, got one that was released")
    letters = ctypes.string_at(schema[0]) if schema[0] else b""
    dtype: Any = _TYPES.get(letters)
    if dtype is None:
        raise TypeError(
            f"{name}: expected an Arrow array of float or double, got the Arrow format "
            f'"{letters.decode()}"'
        )
    length, null_count, offset, n_buffers, _, buffers = array[:6]
    if n_buffers != 2 or not buffers or length < 0 or offset < 0:
        raise ValueError(f"{name}: expected an Arrow array with 2 buffers, got a malformed one")
    bitmap, values = _members(_BUFFERS, buffers)
    if null_count != 0 and bitmap and length > 0:
        size = (offset + length + 7) // 8
        bits = _memory(bitmap, np.dtype(np.uint8), size, made[1])
        present = np.unpackbits(bits, bitorder="little")[offset : offset + length]
        if not present.all():
            row = int(present.argmin())
            raise ValueError(f"{name}: expected numbers, got a null in row {row}")
    if length == 0 or not values:
        return np.empty(0, dtype)
    address = values + offset * dtype.itemsize
    return _memory(address, dtype, length, made[1])
