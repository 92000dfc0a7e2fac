"""What a task made, as bytes: they go between processes, and into the files of a folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from chordal import _chordal
from chordal._errors import Error

#: The ends of a bound and where it is worst; infinity where it has no upper end.
BoundState = tuple[float, float, list[float] | None]
#: What a tileset says of a tile: its name, the box of its content (low, then high), its bound, its triangles, and the
#: names of its children.
TileEntry = tuple[str, list[float], BoundState, int, list[str]]

#: Bytes of the length of the facts, in front of them.
_LENGTH = 8


def packed(facts: Mapping[str, Any], arrays: Sequence[bytes]) -> bytes:
    """Facts and arrays: how long the facts are as JSON, these with the lengths of the arrays, the arrays."""
    said = {**facts, "version": _chordal.VERSION, "lengths": [len(array) for array in arrays]}
    text = json.dumps(said).encode()
    return b"".join([len(text).to_bytes(_LENGTH, "little"), text, *arrays])


def unpacked(content: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """The facts and the arrays again. Those of another version are refused: blocks of both may not fit."""
    start = _LENGTH + int.from_bytes(content[:_LENGTH], "little")
    facts: dict[str, Any] = json.loads(content[_LENGTH:start])
    if facts["version"] != _chordal.VERSION:
        raise Error(f"a block was made by version {facts['version']}, and this is {_chordal.VERSION}: blocks of both may not fit")
    arrays = []
    for length in facts["lengths"]:
        arrays.append(content[start : start + length])
        start += length
    return facts, arrays
