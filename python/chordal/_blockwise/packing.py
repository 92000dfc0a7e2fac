"""Results of tasks as bytes, which are sent between processes and kept in the files of a folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from chordal import _chordal
from chordal._errors import Error

#: The lower and upper end of a bound, infinity if it has no upper end, and the place where it is worst.
BoundState = tuple[float, float, list[float] | None]
#: An entry of a tileset: the name of the tile, the box of its content (low, then high), its bound, its number of triangles,
#: and the names of its children.
TileEntry = tuple[str, list[float], BoundState, int, list[str]]

#: The bytes of the number in front of the facts, which is their length.
_LENGTH = 8


def packed(facts: Mapping[str, Any], arrays: Sequence[bytes]) -> bytes:
    """Packs facts and arrays: the length of the facts, the facts and the lengths of the arrays as JSON, and the arrays."""
    header = {**facts, "version": _chordal.VERSION, "lengths": [len(array) for array in arrays]}
    text = json.dumps(header).encode()
    return b"".join([len(text).to_bytes(_LENGTH, "little"), text, *arrays])


def unpacked(content: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """Unpacks facts and arrays. Those of another version are refused, since blocks of two versions may not fit together."""
    start = _LENGTH + int.from_bytes(content[:_LENGTH], "little")
    facts: dict[str, Any] = json.loads(content[_LENGTH:start])
    if facts["version"] != _chordal.VERSION:
        raise Error(f"a block was made by version {facts['version']}, and this is {_chordal.VERSION}: blocks of both may not fit")
    arrays = []
    for length in facts["lengths"]:
        arrays.append(content[start : start + length])
        start += length
    return facts, arrays
