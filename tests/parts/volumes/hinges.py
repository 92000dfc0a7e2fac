"""Hinges and snaps: the volume of each part of that name."""

from __future__ import annotations

from .solids import (
    area_of,
    ball,
    ball_cap,
    box,
    circle,
    cone,
    cylinder,
    disc,
    frustum,
    lathe,
    linear,
    move,
    polygon,
    rectangle,
    ring_torus,
    rotate_x,
    rotate_y,
    rotate_z,
    round_rectangle,
    shoelace,
    sphere,
    torus,
    tube,
    volume_of,
)


def ball_joint() -> float:
    # The rod is from 6 to 26; from where the ball is as thin as the rod, it is the rod alone.
    high = 55**0.5
    return ball(8) - ball_cap(8, 8 - high) + disc(3) * (26 - high)


def clip() -> float:
    return 5 / 6 * (disc(10) - disc(8)) * 12


def printed_hinge() -> float:
    leaf = move(box(20, 4, 40), 12, -2)
    left = move(box(20, 4, 40), -12, -2) | linear(move(cylinder(4, 7.6), 0, 0, -16), 3, 0, 0, 16)
    right = leaf | linear(move(cylinder(4, 7.6), 0, 0, -8), 2, 0, 0, 16)
    left = (left - linear(move(cylinder(4.4, 8.4), 0, 0, -8), 2, 0, 0, 16)) | cylinder(2, 40)
    return volume_of(left) + volume_of(right - linear(move(cylinder(4.4, 8.4), 0, 0, -16), 3, 0, 0, 16) - cylinder(2.3, 60))


def ball_socket() -> float:
    slot = move(box(24, 1.5, 10), 0, 0, 5)
    return volume_of(move(cylinder(10, 14), 0, 0, 1) - sphere(7.2) - slot - rotate_z(slot, 90))


def cantilever_snap() -> float:
    return shoelace([[0, 0], [3, 0], [2.2, 18], [4, 18], [4, 19], [1.5, 24], [0, 24]]) * 8


def annular_snap() -> float:
    return lathe([[8, 0], [14, 0], [14, 2], [10, 2], [10, 8], [10.6, 9], [10.6, 10], [9.4, 13], [8, 13]])


def living_hinge() -> float:
    return 2 * 30 * 40 * 3 + 2 * 40 * 0.4


def clevis() -> float:
    # The slot reaches from -15 to the round end, and the cheeks beside it are 4 thick.
    return (30 * 16 + disc(8) / 2) * 8 + 15 * 16 * 8 - disc(3) * 8


def retaining_ring() -> float:
    ring = circle(15) - move(circle(12.5), 0, 0.5)
    eyes = move(circle(3), 5, 13.5) | move(circle(3), -5, 13.5)
    holes = move(circle(1), 5, 14) | move(circle(1), -5, 14)
    return area_of((ring | eyes) - move(rectangle(6, 12), 0, 14) - holes) * 1.5


def strap_buckle() -> float:
    return 3 * (round_rectangle(34, 30, 5) - 2 * round_rectangle(26, 8, 2))


def barrel_leaf() -> float:
    return area_of((circle(4) | move(rectangle(24, 3), 12, -2.5)) - circle(1.5)) * 30


def gate_latch() -> float:
    bar = circle(10) | polygon([[0, -8], [60, -5], [60, 5], [0, 8]])
    return area_of((bar | polygon([[50, -5], [60, -5], [60, -18], [54, -14]])) - circle(3.2)) * 6


def chain_link() -> float:
    return ring_torus(8, 2) + 2 * disc(2) * 12


def push_pins() -> float:
    return 26 * 26 * 4 + 4 * (disc(2.4) * 6 + frustum(2.4, 1.6, 1))


def pin_sockets() -> float:
    return 26 * 26 * 8 - 4 * (disc(2.5) * 7 + frustum(2.5, 3.5, 1))


def dovetail_joint() -> float:
    tail = 20 * 12 + (8 + 13) / 2 * 8
    return (tail + 20 * 13.8 - (8.2 + 13.2) / 2 * 8) * 20


def universal_joint() -> float:
    fork = move(cylinder(9, 32), 0, 0, 10) - box(13, 40, 30) - rotate_y(cylinder(2.6, 40), 90)
    cross = rotate_y(cylinder(2.5, 18), 90) | rotate_x(cylinder(2.5, 18), 90) | box(7, 7, 7)
    return 2 * volume_of(fork) + volume_of(cross)


def wire_spring() -> float:
    corners = [[8 if k % 2 else -8, 0, 4 * k] for k in range(7)]
    return volume_of(tube(corners, 1.5) | move(box(24, 10, 3), 0, 0, -2) | move(box(24, 10, 3), 0, 0, 26))


def hinge_pin() -> float:
    return lathe([[0, 0], [6, 0], [6, 3], [3, 3], [3, 38], [2.4, 38], [2.4, 39.5], [3, 39.5], [3, 41], [2, 42], [0, 42]])


def collet() -> float:
    slot = move(box(60, 1.2, 24), 0, 0, 6)
    return volume_of(cone(8, 13, 30) - cylinder(5, 60) - slot - rotate_z(slot, 90))


def eye_bolt() -> float:
    return volume_of(rotate_x(torus(10, 3), 90) | move(cylinder(3, 30), 0, 0, -26))


def cable_tie_mount() -> float:
    # The hole is in the bridge alone, so it ends on the base, which fills the tunnel's place up to 3.
    return 20 * 20 * 3 + 8 * 14 * 5 - 8 * 7 * 3 - disc(1.5) * 2
