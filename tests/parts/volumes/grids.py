"""Grids and lattices: the volume of each part of that name."""

from __future__ import annotations

from .solids import (
    area_of,
    ball,
    ball_cap,
    box,
    capsule,
    circle,
    disc,
    lens,
    linear,
    move,
    polar,
    rectangle,
    regular,
    rotate_x,
    tube,
    union,
    volume_of,
)


def vent() -> float:
    return (60 * 40 - 9 * 2 * 30) * 3


def crossed_bars() -> float:
    return 2 * 60 * 8 * 6


def tee() -> float:
    return 10**3 + 4 * 20 * 4


def honeycomb() -> float:
    return (70 * 56 - 40 * regular(6, 4)) * 4


def flat_grid() -> float:
    return 12 * 60 * 2 * 2 - 36 * 8


def perforated_plate() -> float:
    return (54 * 42 - 48 * disc(2)) * 1.5


def cube_frame() -> float:
    # At each of 27 nodes three struts share a cube of 2.
    return 27 * 42 * 4 - 2 * 27 * 8


def rod_lattice() -> float:
    # Rods count from where they leave a ball; a cap of it is in them there.
    # There are 27 rods of 24 in all, and each runs through three nodes, two of them at its ends.
    high = 3**0.5
    return 27 * ball(2) + 27 * disc(1) * (24 - 4 * high) - 108 * ball_cap(2, 2 - high)


def sponge_one() -> float:
    return 20 * 9**3


def sponge_two() -> float:
    return 27**3 * (20 / 27) ** 2


def louvres() -> float:
    slats = linear(move(rotate_x(box(56, 14, 1.5), 30), 0, 0, -21), 7, 0, 0, 7)
    return volume_of((box(60, 12, 60) - box(52, 40, 52)) | (slats & box(56, 12, 56)))


def speaker_grille() -> float:
    return (disc(24) - 37 * disc(1.5)) * 2


def fan_guard() -> float:
    rings = union([circle(r + 1) - circle(r - 1) for r in (8, 16, 24, 32)])
    spokes = polar(move(rectangle(34, 2), 17, 0) | move(rectangle(8, 2), 35, 0), 8)
    frame = rectangle(80, 80) - circle(36)
    holes = union([move(circle(2), x, y) for x in (-36, 36) for y in (-36, 36)])
    return area_of((rings | spokes | frame) - holes) * 3


def truss() -> float:
    rods = [capsule([10, 0, 17], [70, 0, 17], 1.5)]
    for k in range(4):
        rods.append(tube([[20 * k, 0, 0], [20 * k + 20, 0, 0], [20 * k + 10, 0, 17], [20 * k, 0, 0]], 1.5))
    return volume_of(union(rods))


def gyroid_cube() -> float:
    return 20**3 / 2


def schwarz_cube() -> float:
    return 24**3 / 2


def drain_cover() -> float:
    return (disc(30) - 8 * (12 * 3 + disc(1.5)) - disc(3)) * 4


def scalloped_slot() -> float:
    return (60 * 20 - 12 * disc(3) + 11 * lens(3, 3, 4)) * 4


def overlapping_copies() -> float:
    return area_of(polar(rectangle(40, 4), 6) | polar(move(rectangle(20, 4), 10, 0), 12)) * 5


def thirty_degrees() -> float:
    return 20 * 20 * 20


def egg_crate() -> float:
    return 6 * (60 * 1.5 * 20 - 3 * 1.5 * 1.7 * 10)
