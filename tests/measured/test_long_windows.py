"""Windows in which amplitudes bend: what they show, how far the middle is off, and numbers identified from few."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from edges import write_edges

import trunnion as tn
from trunnion.measured.tracking.within import middle_weights

FIRST, LAST, LENGTH, ACCELERATION = 90.0, 190.0, 3.0, 100.0 / 3.0
"""Speeds [rad/s] at both ends of a run-up, its length [s], its acceleration [rad/s²]."""


def curve(speed: np.ndarray) -> np.ndarray:
    """A resonance [rad] that a window of 24 turns holds as a whole."""
    return 2e-3 * np.exp(0.4j) / (1 - (speed / 115.0) ** 2 + 0.2j * speed / 115.0)


def swinging(orders: dict[int, object], teeth: int = 48) -> tn.PulseTrain:
    """Edges of a wheel that turns by φ(t) + Σ Re Y(Ω) e^{ikφ}, by Newton's method."""
    number = np.arange(int((FIRST + LAST) / 2 * LENGTH / (2 * np.pi) * teeth))
    target = 2 * np.pi * number / teeth
    time = np.linspace(0.0, LENGTH, len(target))
    for _ in range(60):
        speed = FIRST + ACCELERATION * time
        phi = FIRST * time + ACCELERATION * time**2 / 2
        swing = sum((y(speed) * np.exp(1j * k * phi)).real for k, y in orders.items())
        time = np.clip(time - (phi + swing - target) / speed, 0.0, LENGTH)
    return tn.PulseTrain(time, teeth, name="hub" if orders else "in", pitch_error=0.0)


def middle_of_nearest_quadratic(value: np.ndarray, speed: np.ndarray, s: np.ndarray) -> complex:
    """By numpy's polynomial of a dense row of samples, which stand as densely as teeth pass."""
    weight = np.sqrt(speed)
    return complex(*(np.polynomial.polynomial.polyfit(s, part, 2, w=weight)[0] for part in (value.real, value.imag)))


def test_weights_of_a_window() -> None:
    s, step = np.polynomial.legendre.leggauss(10)
    even = middle_weights(2, np.ones((10, 1)), 10)[:, 0]
    assert np.allclose(even, step * (9 - 15 * s**2) / 8, atol=1e-14)
    assert middle_weights(0, np.ones((10, 1)), 10)[:, 0] == pytest.approx(step / 2)
    sloped = middle_weights(2, (3 + s)[:, None], 10)[:, 0]
    # A quadratic passes as it is, of a quartic the middle of the nearest quadratic.
    assert [float(sloped @ s**k) for k in range(3)] == pytest.approx([1, 0, 0], abs=1e-14)
    dense = np.linspace(-1, 1, 20001)
    assert float(sloped @ s**4) == pytest.approx(
        middle_of_nearest_quadratic(dense**4 + 0j, 3 + dense, dense).real, abs=1e-4
    )


@pytest.mark.parametrize("turns", [8, 12, 24, 48])
def test_a_window_shows_a_mean_and_says_how_far_it_is_off(turns: int) -> None:
    found = tn.track_orders(tn.Measurement([swinging({}), swinging({2: curve})]), [2], window=turns, reference="in")
    hub = found.column("hub")
    for k, window in enumerate(found.rotation.windows):
        s = np.linspace(-1, 1, 4001)
        speed = FIRST + ACCELERATION * (window.middle + s * window.half)
        true, shown = curve(speed), found.amplitude[k, 0, hub]
        noise = np.sqrt(found.deviation[k, 0, hub] ** 2 - found.curvature[k, 0, hub] ** 2)
        assert abs(shown - middle_of_nearest_quadratic(true, speed, s)) < 2 * noise + 1e-7
        assert abs(shown - true[2000]) < 1.96 * found.deviation[k, 0, hub] + 1e-7
    assert ("are long for a resonance of hub" in " ".join(map(str, found.findings))) == (turns > 8)


def test_one_narrow_resonance_in_a_long_row_of_windows_is_uncertain() -> None:
    """It rises and falls within one window of many: its neighbours do not tell."""
    narrow = lambda speed: 2e-3 * np.exp(-(((speed - 140.0) / 2.5) ** 2)) + 0j  # noqa: E731
    found = tn.track_orders(tn.Measurement([swinging({}), swinging({2: narrow})]), [2], window=6, reference="in")
    hub = found.column("hub")
    off = np.abs(found.amplitude[:, 0, hub] - narrow(found.speed))
    assert len(found.speed) > 8 and off.max() > 2e-4
    assert np.all(off < 1.96 * found.deviation[:, 0, hub] + 1e-6)
    # Where nothing bends the interval stays that of the noise.
    assert found.curvature[0, 0, hub] < 1e-6 and found.curvature[-1, 0, hub] < 1e-6


def bench(angle: float = 12.0, damping: float = 25.0) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="input"),
            tn.HookeJoint(angle=f"{angle} deg", name="joint"),
            tn.Shaft(stiffness=2e4, damping=damping, name="tube"),
            tn.Disk(inertia=0.5, name="hub"),
        ],
        operation=tn.Operation(speed="1500 rpm"),
    )


def read(folder: Path, angle: float, rpm: tuple[float, float], seconds: float, damping: float = 25.0) -> tn.Measurement:
    """A short run-up as a file of edges holds it: no reference run, pitch errors as they are usually."""
    speeds = (tn.rpm(rpm[0]), tn.rpm(rpm[1]))
    run = tn.measure(
        bench(angle, damping), speeds, seconds, {"input": 30, "hub": 30}, jitter=1e-7, pitch_error=0.0, seed=7
    )
    write_edges(run, folder / "run.csv")
    return tn.read_measurement(folder / "run.csv")


@pytest.mark.parametrize(
    ("angle", "rpm", "seconds", "turns"),
    [
        (12.0, (900, 1800), 3.0, 24),
        (12.0, (900, 1800), 3.0, 60),
        (7.0, (1300, 700), 2.2, 30),
        pytest.param(12.0, (900, 1800), 3.0, 16, marks=pytest.mark.slow),
        pytest.param(4.0, (800, 1100), 1.5, 20, marks=pytest.mark.slow),
    ],
)
def test_few_long_windows_tell_the_angle(
    tmp_path: Path, angle: float, rpm: tuple[float, float], seconds: float, turns: int
) -> None:
    line = bench(angle)
    data = tn.track_orders(read(tmp_path, angle, rpm, seconds), [2], line=line, window=turns)
    assert len(data.speed) < 5
    found = tn.identify(line, data, {"joint.angle": ("-20 deg", "20 deg")})
    ends = np.sort(np.abs(np.rad2deg([found.low[0], found.high[0]])))
    assert ends[0] < angle < ends[1] and ends[1] - ends[0] < 0.5 * angle
    assert found.twins  # the sign does not show


def test_windows_too_long_for_a_sharp_resonance_are_refused(tmp_path: Path) -> None:
    data = tn.track_orders(read(tmp_path, 2.0, (900, 1000), 3.0), [2], line=bench(2.0), window=40)
    with pytest.raises(tn.InputError) as caught:
        tn.identify(bench(2.0, damping=0.05), data, {"joint.angle": ("0.5 deg", "5 deg")})
    assert str(caught.value) == (
        "window = 40: is too long for resonances as sharp as this line's; track the orders in windows of 10 turns"
    )
