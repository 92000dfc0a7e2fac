"""Results in notebooks: tables as HTML, without colours, so that they are readable in light and dark themes, and small images."""

from __future__ import annotations

import html
import struct
import zlib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: The most samples along the longer side of an image; of larger layers some are skipped. Chosen: about 20 kB.
MOST_SAMPLES: Final = 160


def table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """A table of titled texts, under a common title."""
    head = f'<caption style="caption-side:top;text-align:left;font-weight:bold;color:inherit">{html.escape(title)}</caption>'
    cells = "".join(f"<tr>{_heading(name, 'row')}{_cell(text)}</tr>" for name, text in rows)
    return f"<table>{head}<tbody>{cells}</tbody></table>"


def columns(title: str, names: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of rows, under the names of the columns."""
    head = f'<caption style="caption-side:top;text-align:left;font-weight:bold;color:inherit">{html.escape(title)}</caption>'
    first = "".join(_heading(name, "col") for name in names)
    cells = "".join("<tr>" + "".join(_cell(text) for text in row) + "</tr>" for row in rows)
    return f"<table>{head}<thead><tr>{first}</tr></thead><tbody>{cells}</tbody></table>"


def _heading(text: str, scope: str) -> str:
    return f'<th scope="{scope}" style="text-align:left">{html.escape(text)}</th>'


def _cell(text: str) -> str:
    return f'<td style="text-align:left">{html.escape(text)}</td>'



def slice_to_png(samples: NDArray[Any]) -> bytes:
    """A layer of samples as an image, with x to the right and y up, from the lowest value in black to the highest in white."""
    import numpy as np

    # Rounded up: at most MOST_SAMPLES along either side.
    step = -(-max(samples.shape) // MOST_SAMPLES)
    # An image has its rows from the top down, each along x; the array has x first.
    layer: NDArray[np.float64] = np.nan_to_num(samples[::step, ::step].T[::-1].astype(np.float64), posinf=0.0, neginf=0.0)
    low, high = float(layer.min()), float(layer.max())
    # Computed with halves, since the difference of the largest doubles overflows.
    span = high / 2 - low / 2
    grey = np.zeros(layer.shape) if span == 0 else (layer / 2 - low / 2) * (255 / span)
    # Each row begins with the number of its filter, 0 for none (PNG, third edition, 2025, clause 9).
    rows = np.pad(np.rint(grey).astype(np.uint8), ((0, 0), (1, 0)))
    height, width = layer.shape
    # Eight bits of grey, no interlace.
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes())), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, content) for kind, content in chunks)


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
