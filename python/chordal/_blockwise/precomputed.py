"""Meshes of labels for Neuroglancer: a fragment for each label and block, and a list of fragments for each label.

Source: Neuroglancer, *Precomputed mesh format*, the legacy single-resolution one.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from chordal import _chordal
from chordal._blockwise.folder import KeptFolder, left_over, refuse_finished, written
from chordal._blockwise.packing import packed, unpacked
from chordal._blockwise.tasks import ROUNDING, Block, Surface, label_named, labelled, named
from chordal._bound import Bound
from chordal._errors import Refused

if TYPE_CHECKING:
    from chordal._blockwise.workers import Task, Workers

#: Nanometres, the unit of Neuroglancer's meshes, in a metre.
NANOMETRES = 1e9
#: The content of a complete folder, in messages.
HOLDS = "meshes or samples"
#: The subfolder of results until all are done.
_PARTS = "parts"


def write_fragments(
    folder: str | os.PathLike[str],
    plan: Mapping[str, Any],
    tasks: tuple[Surface, list[Block], frozenset[int] | None, float | None],
    array: Any,
    metres: float,
    workers: Workers,
    tell: Callable[[str, int, int], object] | None,
) -> dict[int, Bound]:
    """Writes all fragments, then the list of each label, and finally `info`, which marks the folder as meshes. Returns the bound
    of each label.
    """
    target = os.fspath(folder)
    document = os.path.join(target, "info")
    surface, blocks, only, tolerance = tasks
    done: dict[int, Any] = {}
    refuse_finished(document, HOLDS)
    with KeptFolder(os.path.join(target, _PARTS), plan, is_alone=True) as kept:
        refuse_finished(document, HOLDS)
        waiting: list[Task[int]] = []
        shared = workers.shared(array)
        # `Workers.run` begins with the last task of the list.
        for k in reversed(range(len(blocks))):
            kept_result = kept.read(f"block_{k}")
            if kept_result is None:
                waiting.append((k, named(blocks[k]), (shared, blocks[k])))
            else:
                done[k] = unpacked(kept_result)[0]["labels"]
        call = partial(_fragments, surface, only, tolerance, metres * NANOMETRES)
        for k, result in workers.run(waiting, call):
            facts, fragments = unpacked(result)
            for (label, _), fragment in zip(facts["labels"], fragments, strict=True):
                written(os.path.join(target, _fragment(label, blocks[k])), fragment)
            # After the fragments: it marks the block as done.
            kept.write(f"block_{k}", packed({"labels": facts["labels"]}, []))
            done[k] = facts["labels"]
            if tell is not None:
                tell("blocks", len(done), len(blocks))
        names: dict[int, list[str]] = {}
        most: dict[int, float] = {}
        for k, block in enumerate(blocks):
            for label, at_most in done[k]:
                names.setdefault(label, []).append(_fragment(label, block))
                most[label] = max(most.get(label, 0.0), at_most)
        for label, listed in names.items():
            written(os.path.join(target, f"{label}:0"), json.dumps({"fragments": listed}).encode())
        if names:
            written(document, json.dumps({"@type": "neuroglancer_legacy_mesh"}).encode())
        for path in left_over(target):
            os.unlink(path)
        kept.remove()
        if not names:
            raise Refused("empty", "no block has a label")
    return {label: Bound(0.0, most[label], "proved", "hausdorff", "trilinear interpolant") for label in sorted(names)}


def _fragment(label: int, block: Block) -> str:
    return f"{label}:0:{'_'.join(map(str, block.low))}"


def _fragments(
    surface: Surface, only: frozenset[int] | None, tolerance: float | None, scale: float, array: Any, block: Block
) -> bytes:
    """The result of a worker for a block: a fragment for each label, and its bound, which includes the rounding of coordinates."""
    arguments = surface.arguments(block, block.low)
    labels: list[tuple[int, float]] = []
    fragments: list[bytes] = []
    rounding = ROUNDING * surface.farthest()
    samples, names = labelled(array, block)
    for rank, part in _chordal.label_parts(samples, arguments, surface.place(block)):
        label = label_named(rank, names)
        if only is not None and label not in only:
            continue
        room = 0.0 if tolerance is None else tolerance - part.at_most - 2 * rounding
        if room > 0.0:
            part = part.simplified(room)
        # A rounded sum may be too small for a bound, its next number is not.
        labels.append((label, math.nextafter(part.at_most + rounding, math.inf)))
        fragments.append(part.fragment(scale))
    return packed({"labels": labels}, fragments)
