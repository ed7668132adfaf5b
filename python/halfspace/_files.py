"""Writes files that are complete or not there."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
from typing import BinaryIO, Callable


def replace(
    path: str, write: Callable[[BinaryIO], object], is_synced: bool = True
) -> None:
    """Writes a file by `write(file)`, and then gives it the name `path`.

    A failure leaves an older file as it was, and so does a crash of the machine
    if the file is synced. Only a regular file is replaced.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        # The numbers of the C library.
        number = errno.EISDIR if os.path.isdir(path) else errno.ENODEV
        raise OSError(number, "Not a regular file", path)
    # As short as in the C library, because the longest name can have 255 bytes.
    temporary = f"{path}.{secrets.token_hex(4)}.tmp"
    try:
        file = open(temporary, "xb")
        try:
            with file:
                write(file)
                file.flush()
                if is_synced:  # the bytes are on the disk before the new name is
                    os.fsync(file.fileno())
            os.replace(temporary, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
    except OSError as error:
        if error.errno is None:  # as of a short write in NumPy
            raise
        raise type(error)(error.errno, error.strerror, path) from None
