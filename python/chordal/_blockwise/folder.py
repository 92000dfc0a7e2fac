"""`KeptFolder`: finished results in a folder, from which a later call resumes."""

from __future__ import annotations

import errno
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import IO, Any, Final

from chordal import _files
from chordal._errors import Error

#: The bytes of a digest of SHA-256.
_DIGEST_BYTES = 32
_PLAN, _LOCK, _KEPT = "plan.json", "lock", ".chordal"


def refuse_finished(document: str, holds: str) -> None:
    """Raises `Error` for a folder that is complete: its document, the last file to be written, exists."""
    if os.path.exists(document):
        raise Error(f"{_files.shown(document)}: this folder holds {holds}; choose another, or remove it")


class KeptFolder:
    """A file for each result, with a digest of its content, and a plan that describes the computation. Several programs may
    work in it at once, since every file is written atomically and is the same for each writer; `is_alone` refuses others."""

    def __init__(self, folder: str | os.PathLike[str], plan: Mapping[str, Any], is_alone: bool = False) -> None:
        self._folder: Final = os.fspath(folder)
        os.makedirs(self._folder, exist_ok=True)
        path = os.path.join(self._folder, _PLAN)
        foreign = [name for name in sorted(os.listdir(self._folder)) if not _is_own(name)]
        if foreign:
            raise Error(f"{_files.shown(self._folder)}: this folder holds other files, as {foreign[0]}; choose another")
        self._lock: Final = _locked(os.path.join(self._folder, _LOCK)) if is_alone else None
        try:
            content = json.dumps(plan).encode()
            if os.path.exists(path):
                if _files.read(path) != content:
                    where = _files.shown(path)
                    raise Error(f"{where}: this folder holds blocks of another volume, level or version; choose another")
            else:
                _files.replace(path, content)
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self) -> KeptFolder:
        return self

    def __exit__(self, *error: object) -> None:
        if self._lock is not None:
            self._lock.close()

    def _path(self, name: str) -> str:
        return os.path.join(self._folder, f"{name}{_KEPT}")

    def write(self, name: str, result: bytes) -> None:
        """Keeps a result. The file is either complete or missing."""
        written(self._path(name), _digest(result) + result)

    def read(self, name: str) -> bytes | None:
        """A result that was kept; None if it is missing or damaged."""
        try:
            content = _files.read(self._path(name))
        except FileNotFoundError:
            return None
        result = content[_DIGEST_BYTES:]
        return result if _digest(result) == content[:_DIGEST_BYTES] else None

    def whole(self, name: str, title: str) -> bytes:
        """A result that has to exist; raises `Error` otherwise. `title` names its block in the message."""
        content = self.read(name)
        if content is None:
            raise Error(f"what was kept of {title} is damaged or gone: the same call again does that part anew")
        return content

    def forget(self, name: str) -> None:
        """Removes a result that is now contained in another one."""
        with suppress(FileNotFoundError):
            os.unlink(self._path(name))

    def remove(self) -> None:
        """Removes all results, and the folder."""
        for name in os.listdir(self._folder):
            if _is_own(name) and name != _LOCK:
                with suppress(FileNotFoundError):
                    os.unlink(os.path.join(self._folder, name))
        # The lock is the last. It stays on systems that cannot remove an open file.
        with suppress(OSError):
            os.unlink(os.path.join(self._folder, _LOCK))
            os.rmdir(self._folder)


def _is_own(name: str) -> bool:
    return name in (_PLAN, _LOCK) or name.endswith(_KEPT) or is_left_over(name)


def is_left_over(name: str) -> bool:
    """Whether a file is the rest of an interrupted write."""
    return name.startswith(".chordal-") and name.endswith(".tmp")


def left_over(folder: str) -> Iterator[str]:
    """The paths of such files below a folder."""
    for directory, _, names in os.walk(folder):
        yield from (os.path.join(directory, name) for name in names if is_left_over(name))


def _locked(path: str) -> IO[bytes]:
    """An open file that no other program has locked. The lock is released when the program ends, however it ends."""
    file = open(os.open(path, os.O_RDWR | os.O_CREAT, 0o666), "rb+")
    try:
        import fcntl
    except ImportError:
        # Windows has no such lock: there the user has to make sure that only one program works in the folder.
        return file
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # Another program may have finished meanwhile and removed the file.
        is_there = os.path.exists(path) and os.path.samestat(os.fstat(file.fileno()), os.stat(path))
        if not is_there:
            raise BlockingIOError(errno.EAGAIN, "the lock was removed")
    except BlockingIOError as error:
        file.close()
        raise Error(f"{_files.shown(os.path.dirname(path))}: another program is at work in this folder") from error
    except OSError as error:
        # A file system without locks.
        if error.errno not in (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP):
            file.close()
            raise
    return file


def written(path: str, content: bytes) -> None:
    """Writes a file atomically. The error of a full disk names the file."""
    try:
        _files.replace(path, content)
    except OSError as error:
        # Errors of a write, unlike those of opening a file, carry no name.
        raise OSError(error.errno, error.strerror, path) from error


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).digest()
