"""Organic blends: the volume of each part of that name."""

from __future__ import annotations

import numpy as np

from .solids import (
    PI,
    Solid,
    ball,
    ball_cap,
    box,
    capsule,
    cone,
    cylinder,
    disc,
    lathe,
    move,
    polar,
    revolve,
    ring_torus,
    rotate_x,
    rotate_y,
    round_box,
    smooth_difference,
    smooth_union,
    sphere,
    torus,
    tube,
    union,
    volume_of,
)


def dumbbell() -> float:
    balls = smooth_union(move(sphere(8), -16, 0, 0), move(sphere(8), 16, 0, 0), 2)
    return volume_of(smooth_union(balls, rotate_y(cylinder(3, 32), 90), 3))


def peanut() -> float:
    return volume_of(smooth_union(move(sphere(9), -9, 0, 0), move(sphere(7), 8, 0, 0), 8))


def pebble() -> float:
    return 4 / 3 * PI * 14 * 10 * 6


def mushroom() -> float:
    top = lambda x, y, z: 18 - z
    cap = move(sphere(14), 0, 0, 18) & Solid(top, [-14, -14, 18], [14, 14, 32])
    return volume_of(cap | smooth_union(move(cylinder(5, 22), 0, 0, 10), move(sphere(7), 0, 0, 1), 3))


def bowl() -> float:
    half = sphere(30) - sphere(27)
    half = half & Solid(lambda x, y, z: z, [-30, -30, -30], [30, 30, 0])
    return volume_of(half | (move(cylinder(12, 6), 0, 0, -29) - sphere(27)))


def egg() -> float:
    return ball(10) * (1 + 1.4) / 2


def turned_vase() -> float:
    return lathe([[0, 0], [14, 0], [22, 20], [12, 44], [16, 56], [14, 56], [10, 44], [20, 20], [12.5, 2], [0, 2]])


def snowman() -> float:
    def shared(a, b, distance):
        x = (distance * distance + a * a - b * b) / (2 * distance)
        return ball_cap(a, a - x) + ball_cap(b, b - distance + x)

    return ball(12) + ball(9) + ball(6) - shared(12, 9, 17) - shared(9, 6, 13)


def mug() -> float:
    handle = move(rotate_x(torus(24, 5), 90), 40, 0, 46)
    return volume_of((move(cylinder(38, 90), 0, 0, 45) | handle) - move(cylinder(34, 90), 0, 0, 49))


def starfish() -> float:
    arm = move(rotate_y(cone(6, 2, 26), 90), 13, 0, 0) | move(sphere(2), 26, 0, 0)
    return volume_of(polar(arm, 5) | sphere(8))


def cactus() -> float:
    trunk = capsule([0, 0, 0], [0, 0, 50], 8)
    arms = tube([[-4, 0, 20], [-18, 0, 22], [-18, 0, 38]], 4) | tube([[4, 0, 28], [18, 0, 30], [18, 0, 46]], 4)
    return volume_of(smooth_union(trunk, arms, 5))


def banana() -> float:
    return ring_torus(30, 6) / 2 + ball(6)


def bone() -> float:
    ends = union([move(sphere(6), x, y, 0) for x in (-24, 24) for y in (-5, 5)])
    return volume_of(smooth_union(capsule([-22, 0, 0], [22, 0, 0], 4), ends, 4))


def jelly_bean() -> float:
    # Volume, area · r, π r² times the sum of edges times angles between faces over 2 π, and a ball.
    slope = 16 * 2**0.5
    area = 2 * 128 + (32 + slope) * 6
    bent = (12 * PI + 2 * (32 + slope) * PI / 2) / 2
    return 128 * 6 + area * 4 + bent * 16 + ball(4)


def pipe_elbow() -> float:
    return (disc(8) - disc(6)) * (24 * PI / 2 + 40)


def droplet() -> float:
    # The cone with its tip at 12 touches the ball of radius 6 at a height of 3, where it is 6 · √3 / 2 wide.
    return ball(6) - ball_cap(6, 3) + disc(6) * 0.75 * 9 / 3


def napkin_ring() -> float:
    return PI * 24**3 / 6


def bumpy_ball() -> float:
    wavy = lambda x, y, z: np.sqrt(x * x + y * y + z * z) - 12 + 0.6 * np.sin(x) * np.sin(y) * np.sin(z)
    return volume_of(Solid(wavy, [-12.6] * 3, [12.6] * 3))


def scooped_block() -> float:
    return volume_of(smooth_difference(box(30, 30, 14), move(sphere(11), 0, 0, 9), 3))


def chess_pawn() -> float:
    foot = revolve([[0, 0], [9, 0], [9, 3], [7, 5], [4, 9], [3, 18], [0, 18]])
    return volume_of(foot | move(cylinder(5, 1.5), 0, 0, 17.5) | move(sphere(5), 0, 0, 22))


def soft_block() -> float:
    return round_box(24, 18, 10, 2)


def ball_in_box() -> float:
    return 20**3 - ball(10)
