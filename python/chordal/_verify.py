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

# The exit codes with which the command prints a report with a verdict.
_JUDGED = (0, 1, 6)


@keywords_hinted
def verify(
    path: str | os.PathLike[str] | Shape,
    against: str | os.PathLike[str] | Shape | Iterable[str | os.PathLike[str] | Shape | Any] = (),
    *,
    certificate: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    options: Mapping[str, str] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Prove the certificate of a file again, against everything that it was computed from: files, shapes, and meshes of other
    libraries.

    A file that carries its shape script is proved without `against`: the script is run again. `certificate` is a report, or
    the file of one, for formats that cannot store it. The verdict is "re-proved", "not re-proved" or "refuted"; every claim
    has its own verdict. For a mesh that was moved, joined or put in a scene, `against`
    has the mesh before that, and its own inputs. If all inputs are files, the command verifies them in its own process;
    `options` are further options of the command by name, as in `{"surface": "catmull-clark"}`, and `{"effort": "best"}`
    carries every check to its end. `progress` is as for `Shape.mesh`.

    Raises `ReadError` if there is no certificate.

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
    inputs: list[Any] = [against] if is_one else list(against)  # type: ignore[arg-type]
    if isinstance(path, Shape) or any(not isinstance(item, (str, os.PathLike)) for item in inputs):
        if options:
            raise TypeError("options: they are of the command, which judges files alone: load says how a file is read")
        # Files are read last, so that a wrong argument is reported before any file is opened.
        shapes = [item if isinstance(item, (str, os.PathLike)) else shaped("against", item) for item in inputs]
        sources = [shaped("against", shape)._source for shape in shapes]
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
            return _by_command((path, inputs, name), options, tell)
    return _by_command((path, inputs, certificate), options, tell)


def _text_of(certificate: str | os.PathLike[str] | Mapping[str, Any] | None) -> str | None:
    if certificate is None or isinstance(certificate, Mapping):
        return None if certificate is None else json.dumps(certificate)
    with open(certificate, encoding="utf-8") as file:
        return file.read()


#: A file, the files that it is verified against, and the file of its certificate unless it has one itself.
_Files = tuple[str | os.PathLike[str], list[Any], str | os.PathLike[str] | None]
#: The seconds after which progress is reported again, as the compiled part does.
_SILENCE = 1.0


def _by_command(files: _Files, options: Mapping[str, str] | None, tell: Progress | None) -> Report:
    path, against, certificate = files
    words = [sys.executable, "-m", "chordal", "verify", os.fspath(path), "--json"]
    words += [f"--{name}={value}" for name, value in (options or {}).items()]
    if certificate is not None:
        words += ["--certificate", os.fspath(certificate)]
    words += ["--against", *(os.fspath(file) for file in against)] if against else []
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8") as process:
        try:
            out, error = _output_of(process, tell)
        except BaseException:
            process.kill()
            raise
    if process.returncode not in _JUDGED:
        raise ReadError("unverifiable", None, error.strip().removeprefix("chordal: "))
    return Report(json.loads(out))


def _output_of(process: subprocess.Popen[str], tell: Progress | None) -> tuple[str, str]:
    """The output and the errors of a command; progress is reported while it runs."""
    if tell is None:
        return process.communicate()
    tell("verify", 0, 1)
    while True:
        try:
            output = process.communicate(timeout=_SILENCE)
        except subprocess.TimeoutExpired:
            tell("verify", 0, 1)
        else:
            tell("verify", 1, 1)
            return output
