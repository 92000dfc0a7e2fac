"""Fields as volumes that nobody holds: the samples of their blocks, and blocks that are passed over."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chordal
from chordal._blockwise.sampled import FieldSamples, crossed

SHAPES = chordal.shapes
BALL_IN_BOX = SHAPES.union(SHAPES.sphere(1), SHAPES.box(1.5, 0.4, 0.4))


def samples_of(volume: chordal.BlockVolume) -> FieldSamples:
    found: Any = volume._array
    assert isinstance(found, FieldSamples)
    return found


def in_memory(volume: chordal.BlockVolume) -> chordal.Volume:
    samples = samples_of(volume)
    i, j, k = (slice(0, n) for n in samples.shape)
    return chordal.volume(samples[i, j, k], spacing=samples.steps, origin=samples.origin)


@pytest.mark.parametrize("block", [7, 16, (5, 9, 40)])
@pytest.mark.parametrize("border", ["capped", "open"])
@pytest.mark.parametrize(
    ("field", "iso", "inside"),
    [
        (BALL_IN_BOX, 0.0, "low"),
        (BALL_IN_BOX, 0.1, "low"),
        # It fills the lattice up to its end, where it is closed.
        (SHAPES.sphere(1).within((-0.8, -0.7, -2), (0.6, 2, 0.3)), 0.0, "low"),
        (SHAPES.sphere(1).within((-0.8, -0.7, -2), (0.6, 2, 0.3)), 0.0, "high"),
        (SHAPES.box(9, 9, 0.7).within((-1, -1, -1), (1, 1, 1)), -0.1, "low"),
    ],
)
def test_blocks_that_are_passed_over_change_no_bit(field: Any, iso: float, inside: Any, border: Any, block: Any) -> None:
    volume = chordal.block_volume(field, spacing=(0.07, 0.05, 0.06))
    whole = in_memory(volume).mesh(iso=iso, inside=inside, border=border)
    mesh = volume.mesh(iso=iso, inside=inside, border=border, block=block)
    assert np.array_equal(mesh.vertices, whole.vertices) and np.array_equal(mesh.faces, whole.faces)


def test_most_blocks_of_a_ball_are_passed_over_and_only_where_that_is_proved() -> None:
    ball = SHAPES.sphere(1)
    volume = chordal.block_volume(ball, spacing=0.02)
    blocks = list(volume.blocks(8))
    surface = volume._surface(0, None, "capped")
    assert len(crossed(samples_of(volume), blocks, surface)) < len(blocks) / 3
    # Somebody's word is in no bound of what is made, so nothing is passed over for it.
    called = chordal.field(lambda p: np.linalg.norm(p, axis=1) - 1, bounds=((-1, -1, -1), (1, 1, 1)), lipschitz=1)
    all_of_them = chordal.block_volume(called, spacing=0.1)
    assert len(crossed(samples_of(all_of_them), list(all_of_them.blocks(8)), surface)) == len(list(all_of_them.blocks(8)))


def test_a_lattice_of_a_million_millions_costs_what_its_surface_costs(tmp_path: Path) -> None:
    grains = [SHAPES.sphere(0.02).move(place) for place in ((1, 9, 3), (5.0007, 5, 5), (9.5, 0.5, 9.9))]
    volume = chordal.block_volume(SHAPES.union(*grains).within((0, 0, 0), (10, 10, 10)), spacing=0.001)
    assert volume.shape == (10_001, 10_001, 10_001)
    told: list[tuple[int, int]] = []
    tiles = volume.tileset(tmp_path, iso=0, tol=0.001, block=64, progress=lambda _, done, total: told.append((done, total)))
    assert tiles.bound.evidence == "proved" and (tiles.bound.at_most or 0) <= 0.001 and tiles.triangles > 100
    # All others count as done.
    assert len(told) < 200 and told[-1][0] == told[-1][1] > 4_000_000


def test_tiles_of_a_field_are_the_same_in_other_processes(tmp_path: Path) -> None:
    volume = chordal.block_volume(BALL_IN_BOX, spacing=0.05)
    here = volume.tileset(tmp_path / "here", iso=0, tol=0.02, block=16)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        there = volume.tileset(tmp_path / "there", iso=0, tol=0.02, block=16, executor=pool)
    assert (here.bound, here.tiles, here.triangles) == (there.bound, there.tiles, there.triangles)
    made = [sorted((tmp_path / name).rglob("*.glb")) for name in ("here", "there")]
    assert [path.read_bytes() for path in made[0]] == [path.read_bytes() for path in made[1]]


def test_where_there_is_nothing_it_is_said(tmp_path: Path) -> None:
    nothing = SHAPES.sphere(1).within((3, 3, 3), (4, 4, 4))
    volume = chordal.block_volume(nothing, spacing=0.01)
    with pytest.raises(chordal.Refused):
        volume.tileset(tmp_path, iso=0, block=32)
    with pytest.raises(chordal.Refused):
        volume.mesh(iso=0, block=32)


@pytest.mark.parametrize(
    ("call", "error", "told"),
    [
        (lambda: chordal.block_volume(BALL_IN_BOX), TypeError, "spacing: the step"),
        (lambda: chordal.block_volume(BALL_IN_BOX, affine=np.eye(4)), TypeError, "spacing: the step"),
        (lambda: chordal.block_volume(BALL_IN_BOX, spacing=-1), ValueError, "steps above 0"),
        (lambda: chordal.block_volume(chordal.field(SHAPES.x), spacing=1), ValueError, "field.within"),
    ],
)
def test_what_cannot_be_sampled_is_said(call: Any, error: type[Exception], told: str) -> None:
    with pytest.raises(error, match=told):
        call()


@pytest.mark.parametrize("step", [0.3, 0.1, 0.07])
@pytest.mark.parametrize("size", [1.0, 2.1])
def test_a_field_that_is_cut_off_goes_nowhere_beyond_its_box(step: float, size: float) -> None:
    cut = SHAPES.sphere(5).within((0, 0, 0), (size, size, size))
    low, high = chordal.block_volume(cut, spacing=step).mesh(iso=0, block=4).bounds
    assert np.all(low == 0) and np.all(high <= size * (1 + 1e-12)) and np.all(high > size - step * (1 + 1e-9))


@pytest.mark.parametrize(("origin", "told"), [((-2, 0, 0), "in the box"), ((3, 0, 0), "below the highest")])
def test_an_origin_outside_of_the_box_is_refused(origin: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        chordal.block_volume(SHAPES.sphere(5).within((0, 0, 0), (1, 1, 1)), spacing=0.1, origin=origin)


def test_last_digits_that_depend_on_how_many_points_are_asked_for_do_not_part_blocks() -> None:
    def ball(points: Any) -> Any:
        return np.linalg.norm(points, axis=1) - 0.8 + 1e-7 * np.sin(1e6 * points[:, 0] + len(points))

    volume = chordal.block_volume(chordal.field(ball, bounds=((-1, -1, -1), (1, 1, 1))), spacing=0.05)
    assert volume.mesh(iso=0, block=8).is_watertight and volume.mesh(iso=0.1, block=8, tol=0.05).is_watertight
