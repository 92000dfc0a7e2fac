"""Gears: the volume of each part of that name."""

from __future__ import annotations

import math

from .solids import (
    PI,
    area_of,
    circle,
    disc,
    lathe,
    lens,
    move,
    polar,
    polygon,
    rectangle,
    rotate_z,
    shoelace,
)


def stepped_pulley() -> float:
    return 5 * (disc(20) + disc(15) + disc(10)) - disc(3) * 15


def spur_gear() -> float:
    tooth = polygon([[18, -2.4], [22, -1.2], [22, 1.2], [18, 2.4]])
    return area_of((circle(19) | polar(tooth, 20)) - circle(3)) * 6


def involute_gear() -> float:
    base, half = 18 * math.cos(PI / 9), PI / 24 + math.tan(PI / 9) - PI / 9
    side = [(14.5, half)] + [(base * math.hypot(1, 0.144 * k), half - 0.144 * k + math.atan(0.144 * k)) for k in range(6)]
    points = []
    for tooth in range(12):
        for r, angle in [(r, -h) for r, h in side] + [(r, h) for r, h in reversed(side)]:
            points.append([r * math.cos(PI * tooth / 6 + angle), r * math.sin(PI * tooth / 6 + angle)])
    return (shoelace(points) - disc(4)) * 8


def rack() -> float:
    return (72 * 6 + 12 * (3.6 + 1.2) / 2 * 4) * 8


def ratchet() -> float:
    # Between a tip and the next root lie 24 degrees, and from the root to the next tip none.
    return (15 * 20 * 16 * math.sin(math.radians(24)) / 2 - 36) * 5


def sprocket() -> float:
    return (disc(33) - 16 * lens(33, 4, 33) - disc(6)) * 3


def v_pulley() -> float:
    return lathe([[4, -7], [25, -7], [25, -5], [17, -1.5], [17, 1.5], [25, 5], [25, 7], [4, 7]])


def timing_pulley() -> float:
    return (disc(6.4) - 20 * lens(6.4, 0.8, 6.4)) * 7 + disc(8) * 2 - disc(2.5) * 9


def bevel_gear() -> float:
    corners = [(18, -8), (21, -4), (21, 4), (18, 8)]
    angles = [(r, math.radians(22.5 * k + a)) for k in range(16) for r, a in corners]
    area = shoelace([[r * math.cos(a), r * math.sin(a)] for r, a in angles])
    return area * 8 * (1 + 0.6 + 0.36) / 3 - disc(3) * 8


def helical_gear() -> float:
    corners = [(11, -9), (14, -4), (14, 4), (11, 9)]
    angles = [(r, math.radians(30 * k + a)) for k in range(12) for r, a in corners]
    return (shoelace([[r * math.cos(a), r * math.sin(a)] for r, a in angles]) - disc(3)) * 8


def herringbone_gear() -> float:
    return 10 * 9 * 13 * math.sin(math.radians(18)) * 10


def ring_gear() -> float:
    corners = [(24, -4), (27, -2), (27, 2), (24, 4)]
    angles = [(r, math.radians(20 * k + a)) for k in range(18) for r, a in corners]
    return (disc(32) - shoelace([[r * math.cos(a), r * math.sin(a)] for r, a in angles])) * 7


def crown_gear() -> float:
    return (disc(20) - disc(12)) * 4 + 12 * 6 * 3 * 4


def worm() -> float:
    return area_of(move(rectangle(9, 5), 2, 0) | circle(4)) * 36


def keyed_hub_gear() -> float:
    outline = (circle(20) | polar(move(rectangle(8, 4), 22, 0), 24)) - polar(move(circle(3), 13, 0), 6)
    bore = circle(4) | move(rectangle(2, 3), 0, 4.5)
    return area_of((outline | circle(8)) - bore) * 6 + area_of(circle(8) - bore) * 4


def egg_cam() -> float:
    # Tangents touch where the cosine is (12 - 6) / 18; beyond them the arcs are whole.
    s = 8**0.5 / 3
    angle = math.acos(1 / 3)
    large, small = 144 * (PI - angle), 36 * angle
    return (large + small + 18 * s * (12 + 6) - disc(4)) * 7


def geneva_wheel() -> float:
    slots = polar(move(rectangle(16, 4), 23, 0) | move(circle(2), 15, 0), 6)
    return area_of(circle(30) - slots - rotate_z(polar(move(circle(9), 30, 0), 6), 30) - circle(3)) * 4


def lantern_pinion() -> float:
    return 2 * (disc(15) - disc(3)) * 3 + 8 * disc(2) * 14


def planet_carrier() -> float:
    # A triangle of side 24 √3, grown by 6.
    side = 24 * 3**0.5
    plate = side * side * 3**0.5 / 4 + 3 * side * 6 + disc(6)
    return (plate - disc(5)) * 4 + 3 * disc(3) * 10


def spline_shaft() -> float:
    outline = circle(8) | polar(move(rectangle(6, 4), 7.5, 0), 6)
    return area_of(outline) * 38 + disc(7) * 2
