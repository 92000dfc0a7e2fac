"""Files: reads only regular files, as a whole, and replaces files atomically."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import stat
from typing import Protocol

from chordal import _chordal
from chordal._errors import ReadError

Path = str | os.PathLike[str]


class Readable(Protocol):
    """A file that is open in binary mode, or something like it."""

    def read(self, size: int = ..., /) -> bytes: ...


def shown(path: Path) -> str:
    """The name of a file in messages and reports."""
    return os.fsencode(path).decode("utf-8", "replace")


def read(path: Path) -> bytes:
    """All bytes of a file. Anything but a regular file is refused before it is opened: a pipe would wait for its other end."""
    _refuse_irregular(os.stat(path), path)
    # The path may be another file by now; opening a pipe must not wait for its other end.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(os.open(path, flags), "rb") as file:
        before = os.fstat(file.fileno())
        _refuse_irregular(before, path)
        if before.st_size > _chordal.MOST_BYTES:
            sizes = f"{before.st_size:,} bytes are over the limit of {_chordal.MOST_BYTES:,}"
            raise ReadError("too-large", None, sizes, shown(path))
        content = file.read()
        after = os.fstat(file.fileno())
    if (before.st_size, before.st_mtime_ns) != (after.st_size, after.st_mtime_ns):
        raise ReadError("changed", None, "the file changed while it was read", shown(path))
    return content


def read_open(file: Readable) -> tuple[str | None, bytes]:
    """The remaining bytes of an open binary file, and its name, if it has one."""
    # One byte more than the limit tells a file that is too large.
    content = file.read(_chordal.MOST_BYTES + 1)
    if not isinstance(content, (bytes, bytearray, memoryview)):
        kind = type(content).__name__
        raise TypeError(f"source: a file that is open in binary mode, as in open(path, 'rb'); this one reads {kind}")
    name = getattr(file, "name", None)
    title = shown(name) if isinstance(name, (str, os.PathLike)) and os.fspath(name) else None
    if len(content) > _chordal.MOST_BYTES:
        raise ReadError("too-large", None, f"there are more bytes than the limit of {_chordal.MOST_BYTES:,}", title)
    return title, bytes(content)


def slices_of(folder: Path) -> tuple[str, bytes]:
    """The list of files in a folder with slices of DICOM, as the content of a file that stands for them, and a name for it. The
    command does the same.
    """
    names = [entry.name for entry in os.scandir(folder) if entry.is_file() and not entry.name.startswith(".")]
    path = os.fspath(folder)
    if not any(_is_slice(os.path.join(path, name)) for name in names):
        message = f"{os.strerror(errno.EISDIR)}: of folders those with slices of DICOM are read, and this has none"
        raise IsADirectoryError(errno.EISDIR, message, shown(folder))
    # The first line is defined by `dicom::slice_list`.
    # The list has a name a line, so names with line breaks are left out.
    lines = ["#dicom-slices", *sorted(name for name in names if "\n" not in name and "\r" not in name), ""]
    return shown(os.path.join(path, "slices")), "\n".join(lines).encode()


def _is_slice(path: str) -> bool:
    # The magic number of DICOM is at byte 128 (DICOM PS3.10, 2024).
    try:
        with open(path, "rb") as file:
            return file.read(132)[128:] == b"DICM"
    except OSError:
        return False


def _refuse_irregular(status: os.stat_result, path: Path) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), shown(path))
    if not stat.S_ISREG(status.st_mode):
        raise ReadError("not-a-file", None, "this is a device, pipe or socket, not a file", shown(path))


def refuse_irregular_target(target: str, path: Path) -> None:
    """Raise `OSError` if the path of a file to be written is a folder or a device."""
    if os.path.lexists(target) and not os.path.isfile(target):
        kind = errno.EISDIR if os.path.isdir(target) else errno.EINVAL
        raise OSError(kind, os.strerror(kind), shown(path))


def replace(path: Path, content: bytes) -> None:
    """Replace a file atomically: the content is written to a temporary file, synced and renamed, so that no reader sees a part."""
    # A link stays, and the file that it leads to is replaced.
    target = os.path.realpath(path)
    refuse_irregular_target(target, path)
    folder = os.path.dirname(target)
    if not os.path.isdir(folder):
        raise FileNotFoundError(errno.ENOENT, "there is no such folder to write into", shown(folder))
    # In the same folder, since renaming is atomic only within a file system.
    aside = os.path.join(os.path.dirname(target), f".chordal-{secrets.token_hex(8)}.tmp")
    try:
        with open(aside, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        with contextlib.suppress(OSError):
            # Keep the permissions of the old file.
            os.chmod(aside, stat.S_IMODE(os.stat(target).st_mode))
        os.replace(aside, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(aside)
        raise
