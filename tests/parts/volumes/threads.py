"""Threads and knobs: the volume of each part of that name."""

from __future__ import annotations

import math

from .solids import (
    area_of,
    ball,
    box,
    circle,
    cone,
    cylinder,
    disc,
    extrude,
    fillet_ring,
    frustum,
    lathe,
    lens,
    metric,
    move,
    polar,
    polygon,
    rectangle,
    regular,
    rotate_x,
    rotate_y,
    rotate_z,
    torus,
    volume_of,
)


def hex_nut() -> float:
    return (regular(6, 10) - disc(4)) * 6


def washer() -> float:
    return (disc(10) - disc(4)) * 2


def funnel() -> float:
    return frustum(20, 6, 30) - frustum(18, 4, 30)


def knob() -> float:
    return (disc(15) - 8 * lens(15, 3, 15)) * 10 - disc(3) * 7


def bolt_m6() -> float:
    return regular(6, 5.77) * 4 + metric(6, 1) * 20


def nut_m8() -> float:
    return (regular(6, 7.5) - metric(8, 1.25, -0.1)) * 6.5


def jar_neck() -> float:
    return (metric(30, 3.5) - disc(11)) * 14 + (disc(18) - disc(11)) * 3


def round_thread_rod() -> float:
    return disc(4) * 30


def wing_nut() -> float:
    wing = rotate_x(extrude(polygon([[4, -3], [8, -3], [17, 8], [14, 10], [6, 3]]), 2.5), 90)
    return volume_of((cone(8, 6, 8) | wing | rotate_z(wing, 180)) - cylinder(3, 40))


def knurled_knob() -> float:
    groove = move(rotate_z(rectangle(2, 2), 45), 14.4, 0)
    return area_of(circle(14) - polar(groove, 24)) * 10 + disc(3) * 12


def star_knob() -> float:
    return area_of(circle(15) | polar(move(circle(6), 14, 0), 6)) * 12 - disc(2.5) * 12


def pointer_knob() -> float:
    shaft = cylinder(3, 20) & move(box(20, 20, 20), 0, 9.5, 0)
    return volume_of((cone(10, 8, 14) | move(box(9, 2.5, 14), 8, 0, 0)) - move(shaft, 0, 0, -6))


def hex_standoff() -> float:
    return regular(6, 3.2) * 12 + disc(1.5) * 6 - disc(1.25) * 8


def flange_nut() -> float:
    return regular(6, 8) * 5.5 + disc(9) * 1.5 - disc(4) * 7


def socket_screw() -> float:
    return disc(5) * 6 - regular(6, 2.9) * 3 + disc(3) * 18 + frustum(2.2, 3, 1)


def grub_screw() -> float:
    return disc(3) * 10 + disc(3) * 3 / 3 - regular(6, 1.7) * 3


def bushing() -> float:
    return lathe([[4, 0], [9, 0], [9.5, 0.5], [9.5, 2.5], [6, 2.5], [6, 14.5], [5.5, 15], [4.5, 15], [4, 14.5]])


def acorn_nut() -> float:
    radius = 6.5 * math.cos(math.radians(30))
    return regular(6, 6.5) * 5 + ball(radius) / 2 - disc(2.5) * 7


def bottle_cap() -> float:
    return area_of(circle(15) | polar(move(circle(0.6), 15, 0), 40)) * 14 - disc(13.5) * 12.5


def boss_with_fillet() -> float:
    return disc(20) * 5 + disc(8) * 15 + fillet_ring(8, 3) - disc(4) * 20


def countersunk_screw() -> float:
    head = move(cone(3, 6, 3), 0, 0, 1.5)
    return volume_of((head | move(cylinder(3, 15), 0, 0, -7.5)) - move(box(20, 1.4, 3), 0, 0, 3))


def valve_wheel() -> float:
    spokes = polar(move(rotate_y(cylinder(2.5, 30), 90), 15, 0, 0), 5)
    return volume_of((torus(30, 4) | spokes | cylinder(8, 10)) - box(7, 7, 30))


def tangent_bore() -> float:
    return (30 * 20 - disc(6)) * 12
