"""One Hooke's joint: unevenness, acceleration, compound angles."""

from __future__ import annotations

import numpy as np
from published.printed_numbers import Batch, Source

import trunnion as tn

SOURCES = {
    "Spicer": Source("Spicer (Dana), operating-angle worksheet", "the example of a compound angle"),
    "Elbe": Source("Elbe, catalogue of cardan shafts", "the guideline of unevenness and the angle that it stands for"),
    "Maker": Source("A maker of cardan shafts, example of a speed fluctuation", "angle, speed, and the two extremes"),
    "SDP/SI D200": Source(
        "SDP/SI, handbook D200, T62, after Baranyi, Design News, 1 September 1969",
        "the example at sdp-si.com: coefficient, acceleration and torque",
    ),
}


def one_joint(degrees: float, speed: float) -> tn.Kinetostatics:  # type: ignore[name-defined]
    """One joint with a disk behind it."""
    line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=tn.deg(degrees)), tn.Disk(inertia=1.0)])
    return tn.kinetostatics(line, speed=speed)


def _extremes() -> list[float]:
    speed = one_joint(16.42, tn.rpm(1200)).output_speed / tn.rpm(1)
    return [float(speed.min()), float(speed.max())]


def _acceleration() -> list[float]:
    peak = float(one_joint(10.0, tn.rpm(250)).peak_acceleration)
    return [peak / tn.rpm(250) ** 2]


BATCHES = (
    Batch(
        "Spicer", "worksheet", "deg", {"2.15° and 2.50° in two views": "3.3"},
        lambda: [float(np.degrees(tn.combined_angle("2.15 deg", "2.50 deg")[0]))],
    ),
    Batch("Elbe", "guideline", "", {"U of 2.98°": "0.0027"}, lambda: [float(one_joint(2.98, 1.0).irregularity)]),
    Batch("Maker", "example", "rpm", {"lowest at 16.42° and 1200 rpm": "1151", "highest": "1251"}, _extremes),
    Batch("SDP/SI D200", "T62, 10° at 250 rpm", "", {"acceleration over ω²": "0.0306"}, _acceleration),
    Batch(
        "SDP/SI D200", "T62, 10° at 250 rpm", "rad/s²", {"acceleration": "21.0"},
        lambda: [float(one_joint(10.0, tn.rpm(250)).peak_acceleration)],
    ),
    Batch(
        "SDP/SI D200", "T62, on 0.0233 in lb s²", "in lb", {"torque": "0.489"},
        lambda: [float(one_joint(10.0, tn.rpm(250)).peak_acceleration) * 0.0233],
    ),
)  # fmt: skip
