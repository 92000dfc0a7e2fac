"""Writing shapes in file formats."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable
from typing import Literal, Protocol

from chordal import _chordal, _files
from chordal._arguments import function
from chordal._budget import Length, Share, length_argument
from chordal._hints import keywords_hinted
from chordal._made import Form
from chordal._option_tables import OUTPUT
from chordal._options import options
from chordal._report import Report
from chordal._sourced import Sourced


class Written(Protocol):
    """A file that is ready to be written: meshed within a budget, or converted."""

    @property
    def report(self) -> str: ...
    @property
    def names_files(self) -> bool: ...
    def write(self) -> bytes: ...
    def write_files(self, stem: str) -> tuple[bytes, list[tuple[str, bytes]]]: ...


class Convertible(Sourced):
    """Shapes that can be written to files."""

    __slots__ = ()

    @keywords_hinted
    def export(
        self,
        path: str | os.PathLike[str],
        *,
        quantize: bool = False,
        compress: Literal["meshopt"] | None = None,
        no_source: bool = False,
        tol: Length | None = None,
        rel: Share | None = None,
        progress: Callable[[str, int, int], object] | None = None,
    ) -> Report:
        """Write a file in the format that its extension names, and return the report on its content.

        The shape is written as it is: triangles, polygons, samples, straight lines. `report["certificate"]["notes"]` lists
        data that the format cannot store, and the bound includes the rounding of its numbers. An existing file is replaced
        atomically, at the end. A shape that the format could only store as a mesh is `Refused`: `mesh` it first.

        An OBJ with materials gets a material library and images next to it, whose names begin like its own; existing files
        with these names are replaced, too. For GLB and glTF, `quantize` rounds positions to 16 bits and attributes to 8 or 16
        bits, and `compress="meshopt"` compresses the result without loss. GLB, glTF and 3MF carry the shape script that they
        were made from, with its parameters, unless `no_source` is set. For SVG, arcs and rational curves become cubics within
        `tol` or `rel`. A result of a budget may be computed again for the precision of a format; `progress` is as for
        `Shape.mesh`.

        >>> import chordal, tempfile, os
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     name = os.path.join(folder, "one.stl")
        ...     report = chordal.Mesh([(0, 0, 0), (1, 0, 0), (0, 0.1, 0)], [(0, 1, 2)]).export(name)
        >>> 0 < report["certificate"]["bound"]["at_most"] < 1e-8  # 0.1 in single precision
        True
        """
        extension = extension_of(path, self)
        packing = options(OUTPUT, quantize=quantize, compress=compress, no_source=no_source)
        form = Form(extension, packing, function("progress", progress))
        return write(self._written(form, tol, rel), path)

    @keywords_hinted
    def to_bytes(
        self,
        format: str,
        *,
        quantize: bool = False,
        compress: Literal["meshopt"] | None = None,
        no_source: bool = False,
        tol: Length | None = None,
        rel: Share | None = None,
    ) -> bytes:
        """The file in a format, as `export` writes it.

        Warns with a `UserWarning` if `export` would write further files next to it, as for the materials of an OBJ.
        """
        packing = options(OUTPUT, quantize=quantize, compress=compress, no_source=no_source)
        written = self._written(Form(format, packing), tol, rel)
        if written.names_files:
            warnings.warn("materials stand in files beside it, which export writes", stacklevel=2)
        return written.write()

    def _written(self, form: Form, tol: Length | None, rel: Share | None) -> Written:
        distance = length_argument(tol, rel)
        refuse_unknown(self, form.format)
        return _chordal.convert(self._source, form.format, form.options, distance, form.progress)


def extension_of(path: str | os.PathLike[str], shape: Sourced) -> str:
    """The extension that names the format."""
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path: the name of a file, not {type(path).__name__}; to_bytes(format) gives the bytes")
    extension = os.path.splitext(os.fspath(path))[1]
    if not extension.lstrip("."):
        names = ", ".join(shape._source.written)
        raise ValueError(f"path: the name does not say the format, one of {names}: {_files.shown(path)}")
    if extension.lower() == ".gz":
        names, kinds = ", ".join(shape._source.written), shape._source.kinds
        raise ValueError(f"path: nothing is compressed as .gz; {kinds} are written as {names}: {_files.shown(path)}")
    return extension.lstrip(".")


def refuse_unknown(shape: Sourced, format: str) -> None:
    """Raises `ValueError` for an unknown format, and lists those that this shape can be written in."""
    if not _chordal.Source.is_format(format):
        source = shape._source
        raise ValueError(f"format: {format!r} is no format; {source.kinds} are written as {', '.join(source.written)}")


def write(written: Written, path: str | os.PathLike[str]) -> Report:
    """Write a file, after the files next to it that it refers to, and return its report."""
    if written.names_files:
        target = os.path.realpath(path)
        _files.refuse_irregular_target(target, path)
        folder, name = os.path.split(target)
        content, beside = written.write_files(os.path.splitext(name)[0])
        for file_name, file_content in beside:
            _files.replace(os.path.join(folder, file_name), file_content)
    else:
        content = written.write()
    _files.replace(path, content)
    report = Report(json.loads(written.report))
    report["run"].update(output=_files.shown(path), bytes=len(content))
    return report
