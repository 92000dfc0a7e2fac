"""Identities of files of samples, which tell whether a file was replaced by another one."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from typing import Final

#: The pieces of a file that are read, and the bytes of each. Chosen: a megabyte in total, some milliseconds for any file.
_PIECES: Final = 64
_PIECE_BYTES: Final = 16_384


def known_of_files(path: str) -> str:
    """The identity of a file: its size, its modification time, and a digest of its first and last bytes and of some between.
    For a folder it has the sizes and times of all files; for an address it is empty.

    The time alone is not enough: a file system may store whole seconds, and a copy may keep the time of the original.
    """
    if os.path.isfile(path):
        status = os.stat(path)
        return f"{status.st_size} {status.st_mtime_ns} {_digest_of_pieces(path, status.st_size)}"
    if not os.path.isdir(path):
        return ""
    digest = hashlib.sha256()
    for name, size, written in sorted(_below(path)):
        digest.update(f"{name}\0{size}\0{written}\n".encode(errors="surrogateescape"))
    return digest.hexdigest()


def _digest_of_pieces(path: str, size: int) -> str:
    digest = hashlib.sha256()
    last = max(size - _PIECE_BYTES, 0)
    with open(path, "rb") as file:
        # The pieces of a small file overlap, and those that begin at the same byte are read once.
        for start in sorted({last * k // (_PIECES - 1) for k in range(_PIECES)}):
            file.seek(start)
            digest.update(file.read(_PIECE_BYTES))
    return digest.hexdigest()


def _below(folder: str) -> Iterator[tuple[str, int, int]]:
    """The name, size and modification time of each file below a folder."""
    for directory, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(directory, name)
            status = os.stat(path)
            yield os.path.relpath(path, folder), status.st_size, status.st_mtime_ns
