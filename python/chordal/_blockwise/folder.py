"""`KeptFolder`: what is done, in a folder, so that a later call goes on where one ended."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from typing import IO, Any, Final

from chordal import _files
from chordal._errors import Error

#: The bytes of a digest of SHA-256.
_DIGEST_BYTES = 32


class KeptFolder:
    """A file for each result, with the digest of what is in it, under a plan that says of what. Several programs may be at
    work in it, since each file is whole and the same whoever wrote it; where one `is_alone`, others are refused."""

    def __init__(self, folder: str | os.PathLike[str], plan: Mapping[str, Any], is_alone: bool = False) -> None:
        self._folder: Final = os.fspath(folder)
        content = json.dumps(plan).encode()
        os.makedirs(self._folder, exist_ok=True)
        path = os.path.join(self._folder, "plan.json")
        if os.path.exists(path):
            if _files.read(path) != content:
                raise Error(f"{_files.shown(path)}: this folder holds blocks of another volume, level or version; choose another")
        else:
            _files.replace(path, content)
        self._lock: Final = _locked(path) if is_alone else None

    def __enter__(self) -> KeptFolder:
        return self

    def __exit__(self, *error: object) -> None:
        if self._lock is not None:
            self._lock.close()

    def _path(self, name: str) -> str:
        return os.path.join(self._folder, f"{name}.chordal")

    def write(self, name: str, made: bytes) -> None:
        """Keeps a result: the file is whole or not there."""
        written(self._path(name), _digest(made) + made)

    def read(self, name: str) -> bytes | None:
        """A result that was kept; None where there is none, or where it is damaged."""
        try:
            content = _files.read(self._path(name))
        except FileNotFoundError:
            return None
        made = content[_DIGEST_BYTES:]
        return made if _digest(made) == content[:_DIGEST_BYTES] else None

    def forget(self, name: str) -> None:
        """Removes a result that is part of another one by now."""
        with suppress(FileNotFoundError):
            os.unlink(self._path(name))


def _locked(path: str) -> IO[bytes]:
    """An open file that no other program has locked; the lock ends with the program, however that ends."""
    file = open(path, "rb+")
    try:
        import fcntl
    except ImportError:
        # Windows: nothing keeps two programs apart there, and each writes whole files of the same content.
        return file
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        file.close()
        raise Error(f"{_files.shown(path)}: another program is at work in this folder") from error
    return file


def written(path: str, content: bytes) -> None:
    """Writes a file whole; the error of a disk that is full says which file it was."""
    try:
        _files.replace(path, content)
    except OSError as error:
        # A full disk has no name of its own.
        raise OSError(error.errno, error.strerror, path) from error


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).digest()
