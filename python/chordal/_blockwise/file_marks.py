"""What tells the files of samples from files that were written in their place later."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from typing import Final

#: So many pieces of a file are read, each of so many bytes. Chosen: a megabyte, some milliseconds, of whatever file.
_PIECES: Final = 64
_PIECE_BYTES: Final = 16_384


def known_of_files(path: str) -> str:
    """Of a file its size, when it was written, and a digest of its first and last bytes and of some between; of a folder the
    sizes and times of all files in it. Of an address nothing is known but itself.

    The time alone would not do: a file system may keep seconds, and a copy keeps that of what it replaces.
    """
    if os.path.isfile(path):
        found = os.stat(path)
        return f"{found.st_size} {found.st_mtime_ns} {_digest_of_pieces(path, found.st_size)}"
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
        for start in sorted({last * k // (_PIECES - 1) for k in range(_PIECES)}):
            file.seek(start)
            digest.update(file.read(_PIECE_BYTES))
    return digest.hexdigest()


def _below(folder: str) -> Iterator[tuple[str, int, int]]:
    for place, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(place, name)
            found = os.stat(path)
            yield os.path.relpath(path, folder), found.st_size, found.st_mtime_ns
