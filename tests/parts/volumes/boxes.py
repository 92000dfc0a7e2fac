"""Boxes with lids: the volume of each part of that name."""

from __future__ import annotations

from .solids import PI, ball, ball_cap, disc, frustum, lathe, regular, round_box, round_rectangle


def lidded_box() -> float:
    rim = 45.6 * 25.6 * 3 - 43.6 * 23.6 * 3
    return 50 * 30 * 20 - 46 * 26 * 18 + 50 * 30 * 2 + rim


def stacked_slabs() -> float:
    return 5 * (20**2 + 14**2 + 8**2)


def tray() -> float:
    return 80 * 60 * 12 - 4 * 37 * 27 * 10


def round_tin() -> float:
    return disc(25) * 30 - disc(23) * 28 + disc(25) * 2 + (disc(22.8) - disc(21)) * 3


def sliding_lid() -> float:
    # The groove is 57 long within the box and reaches over the 34 of the space for 54 of them.
    within = (37 + 33.6) / 2 * 2.5 * 57
    hollow = 54 * (34 * 2.5 - (17 - 16.8) ** 2 * 2.5 / (18.5 - 16.8))
    return 60 * 40 * 24 - 54 * 34 * 21 - (within - hollow) + (36.6 + 33.4) / 2 * 2.3 * 58


def gridfinity_bin() -> float:
    feet = 2 * (round_rectangle(37.2, 37.2, 1.6) * 2.6 + round_rectangle(41.5, 41.5, 3.75) * 2.2)
    return feet + round_rectangle(83.5, 41.5, 3.75) * 37 - round_rectangle(81.1, 39.1, 2.55) * 34.8


def card_box() -> float:
    return 68 * 24 * 95 - 64 * 20 * 93 - 2 * 2 * disc(12) / 2


def soap_dish() -> float:
    return (round_box(90, 60, 40, 10) - round_box(84, 54, 34, 7)) / 2 - 4 * disc(3) * 3


def pcb_case() -> float:
    return 70 * 50 * 22 - 66 * 46 * 20 + 4 * 49 * 8 - 4 * disc(1.25) * 7


def parts_tray() -> float:
    space = 116 * 76 * 18
    return 120 * 80 * 20 - space + (3 * 2 * 76 + 116 * 2 - 3 * 2 * 2) * 18


def hex_box() -> float:
    body = regular(6, 30) * 25 - regular(6, 27) * 23
    return body + regular(6, 30) * 2 + (regular(6, 26.7) - regular(6, 24.5)) * 4


def chest() -> float:
    return 60 * 36 * 24 + disc(18) / 2 * 60 - 54 * 30 * 21 - disc(15) / 2 * 54


def mint_tin() -> float:
    # A slice moved in by d has the area A - P d + π d², since its corners are round; along a quarter circle of radius r
    # the integral of d is r² (1 - π / 4) and that of d² is r³ (5 / 3 - π / 2).
    around = 2 * (60 + 40) - (8 - 2 * PI) * 8
    return round_rectangle(60, 40, 8) * 15 - 2 * (around * 4 * (1 - PI / 4) - PI * 8 * (5 / 3 - PI / 2))


def drawer() -> float:
    # The ball's centre is 3 before the end of the rod, whose round end is within the ball.
    deep = 6 - 27**0.5
    rod = disc(3) * (43 - 34 - 27**0.5)
    return 80 * 60 * 30 - 76 * 56 * 28 + 86 * 4 * 36 + ball(6) + rod - ball_cap(6, deep)


def dovetail_drawer() -> float:
    # The slot is cut off at z = 0, where it is a sixth of its slope wider.
    low = 6.2 + 3.4 / 6.2
    return 50 * 40 * 20 - 46 * 36 * 18 + 15 * 5 * 40 + 40 * 40 * 10 - (low + 9.6) * 5.2 * 40


def pill_box() -> float:
    return 148 * 26 * 16 - 7 * 19 * 22 * 14


def watch_case() -> float:
    return disc(20) * 6 + 2 * frustum(20, 18.5, 1.5) - disc(16.5) * 7


def snap_lid() -> float:
    return lathe([[0, 0], [31, 0], [31, 10], [29, 10], [29, 8.5], [28.4, 7.75], [29, 7], [29, 2], [0, 2]])


def shelled_block() -> float:
    return round_box(32, 22, 12, 1) - 28 * 18 * 8


def castle_box() -> float:
    return 60 * 60 * 40 - 52 * 52 * 36 - 12 * 8 * 4 * 7


def egg_tray() -> float:
    return 130 * 88 * 22 - 6 * ball(18) / 2


def nested_boxes() -> float:
    return sum(size**3 - (size - 3) ** 2 * (size - 1.5) for size in (40, 34, 28))


def thin_walled_box() -> float:
    return 20**3 - 19.86**2 * 19.93


def stack_of_thirty() -> float:
    return sum(2 * (20 + k % 3) * (20 - k % 2) for k in range(30))


def lid_that_grips() -> float:
    # A slice moved in by d has (45 - 2 d) (35 - 2 d), of which 1 is lost with d from 0 to 1 at either end; the space cuts
    # the upper bevel nowhere, since it is smaller than 43 by 33.
    ends = 45 * 35 - 80 + 4 / 3
    return 40 * 30 * 20 - 36 * 26 * 18 + 45 * 35 * 6 + 2 * ends - 40.4 * 30.4 * 6
