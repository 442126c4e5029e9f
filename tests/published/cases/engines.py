"""Gas torques of a measured engine."""

from __future__ import annotations

from published.printed_numbers import Batch, Source

import trunnion as tn

SOURCES = {
    "Carella": Source(
        "Carella, engine-vibration-notebook, a notebook in a public repository",
        "two drawings: the pressure over the crank angle, averaged over measured cycles of a four-stroke engine at "
        "1500 rpm, and the harmonics of its tangential pressure; crank radius and ratio, bore and formulas from cells",
    ),
}
READ = """
    2.1 20.37, 6.4 20.73, 10.7 20.07, 15 18.72, 19.3 16.98, 23.6 15.1, 27.9 13.08, 32.2 11.15, 36.5 9.48, 40.8 8.06,
    45.1 6.89, 49.4 5.97, 53.7 5.19, 58 4.54, 62.3 3.99, 66.6 3.57, 70.9 3.22, 75.2 2.91, 79.5 2.66, 83.8 2.44,
    88.1 2.26, 92.4 2.09, 96.7 1.96, 101 1.84, 105.3 1.73, 109.6 1.64, 131.1 1.34, 156.9 1.09, 182.7 0.77,
    208.5 0.47, 234.3 0.32, 260.1 0.29, 285.9 0.31, 311.6 0.33, 337.4 0.33, 363.2 0.29, 389 0.22, 414.8 0.24,
    440.6 0.24, 466.4 0.25, 492.2 0.28, 518 0.29, 543.8 0.3, 569.6 0.33, 595.3 0.42, 621.1 0.61, 634 0.79,
    638.3 0.89, 642.6 0.99, 646.9 1.11, 651.2 1.26, 655.5 1.45, 659.8 1.68, 664.1 1.96, 668.4 2.32, 672.7 2.77,
    677 3.34, 681.3 4.06, 685.6 4.98, 689.9 6.19, 694.2 7.58, 698.5 9.28, 702.8 11.25, 707.1 13.51, 711.4 15.97,
    715.7 18.35
"""
"""Crank angle [deg] and pressure [MPa], pair by pair, as read off the drawing."""
HARMONICS = {
    "0.5": "0.95",
    "1": "1.44",
    "1.5": "1.22",
    "2": "1.13",
    "2.5": "0.93",
    "3": "0.79",
    "3.5": "0.66",
    "4": "0.52",
    "4.5": "0.42",
    "5": "0.34",
    "5.5": "0.27",
    "6": "0.22",
    "6.5": "0.17",
    "7": "0.13",
    "7.5": "0.10",
    "8": "0.08",
    "8.5": "0.06",
}
"""Amplitude of the tangential pressure [MPa] by order, as read off the drawing."""
BORE, RADIUS, ROD = 0.170, 0.1075, 0.1075 / 0.274


def tangential_pressures() -> list[float]:
    """Amplitudes [MPa] of the torque of one cylinder over piston area and crank radius, nothing behind the piston."""
    angles, pressures = zip(*(map(float, pair.split()) for pair in READ.split(",")), strict=True)
    curve = tn.PressureCurve(angles=[f"{a} deg" for a in angles], pressures=[f"{p} MPa" for p in pressures])
    engine = tn.Engine(
        firing_order=[1], throw_inertia=1.0, bore=BORE, stroke=2 * RADIUS, rod_length=ROD, pressure=[curve], orders=8.5,
        crankcase_pressure=1.0,
    )  # fmt: skip
    lever = 3.141592653589793 / 4 * BORE**2 * RADIUS
    found = {e.order: float(e.amplitude or 0) / lever / 1e6 for e in engine.made_of("engine")[0].excitation}
    return [found[float(order)] for order in HARMONICS]


BATCHES = (
    Batch(
        "Carella", "harmonics of the tangential pressure", "MPa",
        {f"order {order}": text for order, text in HARMONICS.items()}, tangential_pressures,
        absolute=0.03,
        precision="read off two drawings, to 0.1 and 0.01 MPa; the lever there has cos² under the root",
    ),
)  # fmt: skip
