"""A font of two letters: "A" is a bar of 500 × 700 thousandths of the em, and the space is nothing."""

from __future__ import annotations

import struct
from itertools import pairwise


def words(*numbers: int) -> bytes:
    return b"".join(struct.pack(">H", number & 0xFFFF) for number in numbers)


def bar_font() -> bytes:
    """The bytes of the font."""
    corners = [(0, 0), (0, 700), (500, 700), (500, 0)]
    outline = words(1, 0, 0, 500, 700, 3, 0) + bytes([1] * 4)
    for axis in range(2):
        values = [corner[axis] for corner in corners]
        outline += words(*(b - a for a, b in pairwise([0, *values])))
    outline += bytes(-len(outline) % 4)
    groups = struct.pack(">9I", *(32, 32, 1, 65, 65, 2), 0, 0, 0)[:24]
    cmap = words(0, 1, 3, 10, 0, 12, 12, 0) + struct.pack(">3I", 16 + 24, 0, 2) + groups
    tables = {
        b"cmap": cmap,
        b"glyf": outline,
        b"head": words(1, 0, 1, 0, 0, 0, 0x5F0F, 0x3CF5, 3, 1000) + bytes(16) + words(0, 0, 500, 700, 0, 8, 2, 1, 0),
        b"hhea": words(1, 0, 800, -200, 100, 600, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 3),
        b"hmtx": words(500, 0, 300, 0, 600, 0),
        b"loca": struct.pack(">4I", 0, 0, 0, len(outline)),
        b"maxp": words(1, 0, 3, 4, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0),
    }
    head, body = words(1, 0, len(tables), 64, 2, 48), b""
    start = 12 + 16 * len(tables)
    for name, content in tables.items():
        head += name + struct.pack(">3I", 0, start + len(body), len(content))
        body += content + bytes(-len(content) % 4)
    return head + body
