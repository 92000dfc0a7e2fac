"""`Picture`: a rendered image of a shape."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat

from chordal import _chordal, _files
from chordal._arguments import function, whole
from chordal._arrays import as_asked
from chordal._budget import Length
from chordal._hints import Guessed, keywords_hinted
from chordal._option_tables import PICTURE
from chordal._options import options
from chordal._registry import registered
from chordal._report import Report
from chordal._sourced import Sourced
from chordal._view import View, words_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chordal._shape import Progress, Shape

    _Style = Literal["shaded", "flat", "wire", "normals", "zebra", "overshade", "deviation", "comb"]


#: The state of a picture for another process: columns and rows, pixels, and facts about them.
PictureState = tuple[tuple[int, int], bytes, list[tuple[str, str]], str, str, float | None]


class Picture(Guessed):
    """A picture of a shape, with the bound of the triangles that it shows. `Shape.render` returns it; notebooks display it.

    >>> import chordal
    >>> picture = chordal.shapes.sphere(1).render(size=(64, 48))
    >>> picture.array.dtype.name, picture.to_bytes("png")[1:4]
    ('uint8', b'PNG')
    """

    __slots__ = ("_picture",)

    def __init__(self, picture: _chordal.Picture) -> None:
        self._picture: Final = picture

    @property
    def array(self) -> NDArray[np.uint8]:
        """Red, green, blue and alpha: height × width × 4, from the top left. Not copied, read-only."""
        import numpy as np

        array: NDArray[np.uint8] = np.asarray(self._picture.array())
        return array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return as_asked(self.array, dtype, copy)

    @property
    def view(self) -> View:
        """The view of the picture, with which it can be rendered again."""
        return View(self._picture.view)

    @property
    def darkest(self) -> float | None:
        """The distance that the darkest colour stands for, if distances are shown."""
        return self._picture.darkest

    @property
    def report(self) -> Report:
        """The report of `chordal render --json`."""
        return Report(json.loads(self._picture.report))

    def to_bytes(self, format: Literal["png", "jpg", "webp"] = "png") -> bytes:
        """The picture as a file, which includes the certificate."""
        return self._picture.write(format)

    def export(self, path: str | os.PathLike[str]) -> Report:
        """Write the picture as PNG, JPEG or WebP, by the extension of the name, and return the report."""
        extension = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
        content = self._picture.write(extension)
        _files.replace(path, content)
        report = self.report
        report["run"].update(output=_files.shown(path), bytes=len(content))
        return report

    def __copy__(self) -> Picture:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Picture:
        return self

    def __reduce__(self) -> Any:
        return _again, (self._picture.state(),)

    def _repr_png_(self) -> bytes:
        return self.to_bytes("png")

    def __repr__(self) -> str:
        height, width, _ = self.array.shape
        return f"<Picture: {width} × {height} pixels>"


def _again(state: PictureState) -> Picture:
    """Restores a pickled picture."""
    return Picture(_chordal.Picture.of_state(state))


class Pictured(Sourced):
    """Shapes that can be rendered: those with a surface, and drawings."""

    __slots__ = ()

    @keywords_hinted
    def render(
        self,
        *,
        show: _Style = "shaded",
        size: tuple[int, int] = (1280, 960),
        view: str | View | None = None,
        cull: Literal["none", "back", "front"] = "none",
        against: Shape | Any | None = None,
        darkest: Length | None = None,
        pixels: SupportsFloat | None = None,
        tol: Length | None = None,
        progress: Progress | None = None,
    ) -> Picture:
        """A ray-traced picture. Smooth shapes are meshed within half a pixel, or within `pixels` or `tol`; fields are traced
        directly.

        `show` is the style: "shaded", "flat" (no smooth normals), "wire" (edges), "normals", "zebra" (reflected stripes),
        "overshade" (how often a graphics processor shades each pixel), "comb" (the curvature of a drawing), or "deviation"
        from the shape `against`; its darkest colour is for the distance `darkest`, by default the largest. `view` is the
        camera, as in "1280x960 fov=30 eye=4,-6,3 target=0,0,1"; by default it frames the shape, in a `size` in pixels.

        Raises as `Shape.mesh`.

        >>> import chordal
        >>> picture = chordal.shapes.sphere(1).render(size=(64, 48))
        >>> picture.array.shape
        (48, 64, 4)
        """
        if not isinstance(size, Sequence) or isinstance(size, str) or len(size) != 2:
            raise TypeError(f"size: columns and rows, as in (1280, 960), not {size!r}")
        columns, rows = (whole("size", side) for side in size)
        if (show == "deviation") != (against is not None):
            raise ValueError("against: for show='deviation', which needs it")
        if pixels is not None and tol is not None:
            raise ValueError("pixels, tol: give one of them")
        given = options(
            PICTURE,
            show=show,
            cull=cull,
            size=f"{columns}x{rows}",
            view=None if view is None else words_of(view),
            pixels=pixels,
            tol=tol,
            darkest=darkest,
        )
        other = None if against is None else registered.shaped("against", against)._source
        return Picture(_chordal.picture(self._source, other, given, function("progress", progress)))
