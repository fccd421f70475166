#!/usr/bin/env python3
"""Writes out_and_back.tum.txt: a target that flies from 4.2 m to 40 m in front of a rig and back.

Origin and axes: the rig, east (along its optical axis), north, up. The path weaves as much as a
22 x 12.8 degree view allows with both boxes whole, and starts and turns at rest. Attitude: nose
towards the rig, tilted as a multirotor must be to accelerate so.
tests/scenarios/shipped_scenarios_test.cc checks the view and the accelerations.
"""
import math
import pathlib

PERIOD_S, RATE_HZ, END_S = 20.0, 20.0, 21.0
NEAREST_M, FARTHEST_M, GRAVITY_MPS2 = 4.2, 40.0, 9.81


def position_m(t):
    away = (FARTHEST_M - NEAREST_M) / 2 * (1 - math.cos(2 * math.pi * t / PERIOD_S))
    north = 0.11 * away * math.sin(2 * math.pi * 0.10 * t)
    up = 0.05 * away * math.sin(2 * math.pi * 0.15 * t + 1)
    return NEAREST_M + away, north, up


def acceleration_mps2(t, h=1e-3):
    before, now, after = position_m(t - h), position_m(t), position_m(t + h)
    return [(a - 2 * b + c) / h**2 for a, b, c in zip(before, now, after)]


def attitude(t):
    """R_WB as (x, y, z, w): B's z along the thrust, B's x towards the rig (west)."""
    thrust = acceleration_mps2(t)
    thrust[2] += GRAVITY_MPS2
    norm = math.hypot(*thrust)
    up = [c / norm for c in thrust]
    # The shortest turn from W's z to the thrust, after half a turn about W's z.
    w = math.sqrt((1 + up[2]) / 2)
    x, y = -up[1] / (2 * w), up[0] / (2 * w)
    return y, -x, w, 0.0  # (x, y, 0, w) * (0, 0, 1, 0)


def main():
    lines = ["# t_s x_m y_m z_m qx qy qz qw; made by make_out_and_back.py"]
    for i in range(round(END_S * RATE_HZ) + 1):
        t = i / RATE_HZ
        values = [t, *position_m(t), *attitude(t)]
        lines.append(" ".join(f"{v:.6f}" for v in values))
    path = pathlib.Path(__file__).with_name("out_and_back.tum.txt")
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
