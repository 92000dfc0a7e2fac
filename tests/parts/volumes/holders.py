"""Holders and brackets: the volume of each part of that name."""

from __future__ import annotations

from .solids import (
    PI,
    area_of,
    ball,
    box,
    circle,
    cone,
    cylinder,
    disc,
    frustum,
    move,
    polygon,
    rectangle,
    regular,
    ring_torus,
    rotate_x,
    round_rectangle,
    shoelace,
    tube,
    volume_of,
)


def hook() -> float:
    # Half of a ring, a rod that stands on its end, and half of a ball on the other end.
    return ring_torus(12, 3) / 2 + disc(3) * 30 + ball(3) / 2


def shelf_bracket() -> float:
    return 40 * 4 * 26 + 40 * 30 * 4 - 4 * disc(2.25) * 4


def pegboard() -> float:
    return 70 * 70 * 4 + 16 * disc(2) * 10


def table() -> float:
    return 60 * 40 * 3 + 4 * 4 * 4 * 30


def ramp() -> float:
    return 30 * 12 / 2 * 20


def cable_clip() -> float:
    ring = circle(6) - circle(4) - polygon([[0, 0], [-8, 12], [8, 12]])
    return area_of(ring | move(rectangle(16, 3), 0, -6.5)) * 10


def phone_stand() -> float:
    outline = [[0, 0], [70, 0], [70, 5], [14, 5], [14, 12], [9, 12], [9, 5], [5, 5], [30, 80], [25, 82], [0, 7]]
    return shoelace(outline) * 60 - area_of(polygon(outline) & move(rectangle(12, 20), 11.5, 8.5)) * 6


def tool_rack() -> float:
    return 180 * 4 * 40 + 180 * 30 * 8 - 8 * disc(5) * 8


def filleted_bracket() -> float:
    return 40 * 44 * 4 + 40 * 4 * 36 + 40 * 25 * (1 - PI / 4) - 4 * disc(2.5) * 4


def corner_brace() -> float:
    return 30 * 60 * 3 + 30 * 3 * 57 + 42 * 42 / 2 * 4


def pen_cup() -> float:
    return disc(40) * 100 - disc(37) * 97


def test_tube_rack() -> float:
    return 140 * 50 * 40 - 12 * (disc(8) * 30 + ball(8) / 2)


def pipe_saddle() -> float:
    half = (circle(14) - circle(10)) & move(rectangle(40, 20), 0, 10)
    return area_of(half | move(rectangle(12, 4), 19, 2) | move(rectangle(12, 4), -19, 2)) * 16 - 2 * disc(2) * 4


def shelf_pin() -> float:
    return disc(2.5) * 9 + disc(4.5) * 1.5 + 6 * 2 * 8


def coat_hook() -> float:
    hole = rotate_x(cylinder(2.2, 20) | move(cone(2.2, 4.4, 2.2), 0, 0, 0.91), -90)
    plate = box(30, 4, 60) - move(hole, 0, 0, 22) - move(hole, 0, 0, -24)
    return volume_of(plate | tube([[0, 0, -10], [0, 30, -10], [0, 42, 6]], 4))


def countersunk_plate() -> float:
    return 60 * 40 * 5 - 4 * (disc(2) * 5 + frustum(2, 3.99, 1.99) - disc(2) * 1.99)


def micron_countersink() -> float:
    return 30 * 30 * 8 - disc(3) * (8 - 2.999) - frustum(3, 5.999, 2.999)


def monitor_riser() -> float:
    return 400 * 220 * 12 + 4 * 900 * 80 * (1 + 0.6 + 0.36) / 3


def headphone_hook() -> float:
    tip = move((circle(10) - circle(5)) & move(rectangle(30, 20), 15, 0), 29, -12.5)
    return area_of(rectangle(5, 60) | move(rectangle(30, 5), 15, -20) | tip) * 25


def battery_tray() -> float:
    return 68 * 56 * 10 - 4 * disc(7.25) * 50 / 2


def magnet_holder() -> float:
    return regular(6, 10) * 6 - disc(5.1) * 3


def mirror_clips() -> float:
    return 2 * 12 * (20 * 4 + 4 * 6)


def laptop_wedge() -> float:
    return 40 * 90 * 30 / 2 - disc(8) * 40


def spool_holder() -> float:
    return 100 * 60 * 4 + 2 * 5 * 40 * 60 - 2 * 5 * 16 * 16 / 2


def cup_arm() -> float:
    outline = (circle(42) - circle(38)) | (move(rectangle(40, 16), 58, 0) - circle(38)) | move(rectangle(6, 50), 80, 0)
    return area_of(outline) * 8 - 2 * disc(2) * 6


def vesa_plate() -> float:
    return 3 * (round_rectangle(120, 120, 8) - round_rectangle(70, 70, 5) - 4 * disc(2.25))
