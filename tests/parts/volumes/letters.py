"""Letters and badges: the volume of each part of that name."""

from __future__ import annotations

import math

import numpy as np

from .solids import (
    PI,
    Solid,
    area_of,
    ball_cap,
    box,
    circle,
    disc,
    lens,
    move,
    polygon,
    round_box,
    round_rectangle,
    shoelace,
    volume_of,
)

#: The letters of block.ttf, in units of which its em has 1,000: bars of 150, and 700 high.
GLYPHS = {"H": 255_000, "E": 262_500, "L": 157_500, "T": 157_500, "I": 105_000, "O": 300_000}


def letters(text: str, em: float) -> float:
    """The area of a text."""
    return sum(GLYPHS[letter] for letter in text) * em * em / 1e6


def dice() -> float:
    return round_box(16, 16, 16, 2) - 3 * ball_cap(1.6, 1.2)


def name_plate() -> float:
    return round_rectangle(80, 30, 5) * 3 + letters("HELLO", 20) * 2


def engraved_tag() -> float:
    return (round_rectangle(60, 24, 4) - disc(2.5)) * 3 - letters("TOOL", 16) * 0.6


def dog_tag() -> float:
    # The rim stands out by half on either side, the letters above.
    rim = 24 * 28 + disc(14) - 24 * 25.6 - disc(12.8)
    return (24 * 28 + disc(14) - disc(2)) * 2 + rim * 1 + letters("TILL", 12) * 1


def key_fob() -> float:
    return area_of((circle(16) | move(circle(6), 0, 19)) - move(circle(3), 0, 20)) * 3 - letters("H", 20) * 3


def stencil() -> float:
    return 70 * 30 - letters("LOT", 24)


def house_number() -> float:
    half = [[0, 16.5], [9, 16.5], [9, 0], [18, 0], [18, 42], [9, 42], [9, 25.5], [0, 25.5]]
    flat = polygon(half + [[-x, y] for x, y in reversed(half[1:-1])])
    bevelled = lambda x, y, z: np.maximum(flat.value(x, y, z) + np.maximum(abs(z) - 3.5, 0), abs(z) - 5)
    return volume_of(Solid(bevelled, [-18, 0, -5], [18, 42, 5]) | move(box(60, 6, 16), 0, -2))


def star_badge() -> float:
    return disc(24) * 2 + 10 * 20 * 8 * math.sin(PI / 5) / 2 * 2


def heart() -> float:
    return (400 + disc(10)) * 5


def shield() -> float:
    # A slice moved in by d: A - P d + d² Σ cot(angle / 2); of the 6, all but two slices of 1 are whole.
    points = [[-20, 24], [-20, -4], [0, -26], [20, -4], [20, 24]]
    around = 40 + 2 * 28 + 2 * math.hypot(20, 22)
    tip = 2 * math.atan2(20, 22)
    side = PI - tip / 2
    corners = 2 + 2 / math.tan(side / 2) + 1 / math.tan(tip / 2)
    return shoelace(points) * 6 - 2 * (around / 2 - corners / 3) - (6 * 30 + 18 * 6) * 1


def medal() -> float:
    return disc(20) * 3 - disc(17.5) * 0.8 + 12 * 12 * 5 * math.sin(PI / 6) / 2 * 0.8 - disc(1.5) * 2.2


def arrow_sign() -> float:
    return 60 * 30 * 3 + (24 * 8 + 20 * 16 / 2) * 2


def reeded_coin() -> float:
    return (disc(12) - 80 * lens(12, 0.25, 12)) * 2


def braille_sign() -> float:
    return 30 * 14 * 2 + 9 * ball_cap(1, 0.6)


def domino() -> float:
    return round_rectangle(48, 24, 3) * 7 - 20 * 1 - 7 * ball_cap(2, 1.5)


def cookie_cutter() -> float:
    points = [[r * math.cos(PI * k / 6), r * math.sin(PI * k / 6)] for k in range(12) for r in [14 if k % 2 else 30]]
    star = polygon(points)
    wide = lambda d: area_of(Solid(lambda x, y, z: star.value(x, y, z) - d, [-35, -35, 0], [35, 35, 1]) - star)
    return wide(1.2) * 14 + wide(4.0) * 2


def moon() -> float:
    return (disc(20) - lens(20, 17, 9)) * 4


def bevelled_t() -> float:
    # Moved in by d the area is A - P d + (6 - 2 · π / 4) d²: six corners lose a
    # square twice, and at the two that point inwards a quarter of a disc is lost.
    area, around = 24 * 6 + 6 * 24, 2 * (24 + 30)
    return area * 8 - 2 * (around / 2 - (6 - PI / 2) / 3)


def smiley() -> float:
    return (disc(20) - (disc(12) - disc(9)) / 2 - 2 * disc(2.5)) * 3


def drawn_leaf() -> float:
    outer = [[0, 0], [10, 4], [18, 14], [20, 30], [10, 26], [2, 14]]
    return (shoelace(outer) - shoelace([[8, 10], [13, 17], [8, 17]])) * 3
