"""`verify`: the certificate of a written file, proved again."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from typing import Any

from chordal import _chordal
from chordal._arguments import function
from chordal._errors import ReadError, Refused
from chordal._hints import keywords_hinted
from chordal._report import Report
from chordal._shape import Progress, Shape
from chordal._verbs import shaped

__all__ = ["verify"]

# The exit codes of the command with a verdict in its report.
_JUDGED = (0, 1, 6)


@keywords_hinted
def verify(
    path: str | os.PathLike[str] | Shape,
    against: str | os.PathLike[str] | Shape | Iterable[str | os.PathLike[str] | Shape | Any],
    *,
    certificate: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    options: Mapping[str, str] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Prove the certificate of a file again, from all that it was made of: files, shapes, and meshes of other libraries.

    `certificate` is a report, or the file of one, for formats that hold none. The verdict is "re-proved", "not re-proved" or
    "refuted"; every claim has one of its own. Of a mesh that was moved, joined or put in a scene, `against` is the mesh as it
    was before, and what that was made of. Files alone are judged by the command in a process of its own; `options` are more
    options of it by their names, as in `{"surface": "catmull-clark"}`; `{"effort": "best"}` goes on with every look to its end.
    `progress` is as for `Shape.mesh`.

    Raises `ReadError` where there is no certificate.

    >>> import chordal, tempfile, os
    >>> ball = chordal.shapes.sphere(1)
    >>> mesh = ball.mesh(tol=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     name = os.path.join(folder, "far.glb")
    ...     report = mesh.translate(20, 0, 0).export(name)
    ...     verdict = chordal.verify(name, [mesh, ball])["verdict"]
    >>> verdict, report["certificate"]["history"]["total"]["reference"]
    ('re-proved', 'field')
    """
    is_one = isinstance(against, (str, bytes, os.PathLike, Shape)) or not isinstance(against, Iterable)
    tell = function("progress", progress)
    given: list[Any] = [against] if is_one else list(against)  # type: ignore[arg-type]
    if isinstance(path, Shape) or any(not isinstance(one, (str, os.PathLike)) for one in given):
        if options:
            raise TypeError("options: they are of the command, which judges files alone: load says how a file is read")
        # Files last: what is none of all this is said before any is opened.
        shapes = [one if isinstance(one, (str, os.PathLike)) else shaped("against", one) for one in given]
        sources = [shaped("against", one)._source for one in shapes]
        try:
            text = _chordal.verified(shaped("path", path)._source, _text_of(certificate), sources, tell)
            return Report(json.loads(text))
        except Refused as refused:
            raise ReadError("unverifiable", None, str(refused)) from None
    if isinstance(certificate, Mapping):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "report.json")
            with open(name, "w", encoding="utf-8") as file:
                json.dump(certificate, file)
            return _by_command((path, given, name), options, tell)
    return _by_command((path, given, certificate), options, tell)


def _text_of(certificate: str | os.PathLike[str] | Mapping[str, Any] | None) -> str | None:
    if certificate is None or isinstance(certificate, Mapping):
        return None if certificate is None else json.dumps(certificate)
    with open(certificate, encoding="utf-8") as file:
        return file.read()


#: A file, what it is judged against, and where its certificate is, if not in it.
_Files = tuple[str | os.PathLike[str], list[Any], str | os.PathLike[str] | None]
#: After so many seconds without a word progress is told again, as by the compiled part.
_SILENCE = 1.0


def _by_command(files: _Files, options: Mapping[str, str] | None, tell: Progress | None) -> Report:
    path, against, certificate = files
    words = [sys.executable, "-m", "chordal", "verify", os.fspath(path), "--json"]
    words += [f"--{name}={value}" for name, value in (options or {}).items()]
    if certificate is not None:
        words += ["--certificate", os.fspath(certificate)]
    words += ["--against", *(os.fspath(file) for file in against)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            out, error = _heard(running, tell)
        except BaseException:
            running.kill()
            raise
    if running.returncode not in _JUDGED:
        raise ReadError("unverifiable", None, error.strip().removeprefix("chordal: "))
    return Report(json.loads(out))


def _heard(running: subprocess.Popen[str], tell: Progress | None) -> tuple[str, str]:
    """What a command says, and progress meanwhile."""
    if tell is None:
        return running.communicate()
    tell("verify", 0, 1)
    while True:
        try:
            said = running.communicate(timeout=_SILENCE)
        except subprocess.TimeoutExpired:
            tell("verify", 0, 1)
        else:
            tell("verify", 1, 1)
            return said
