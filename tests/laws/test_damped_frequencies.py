"""Frequencies and damping of the damped line as it stands, against matrices written down here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eig
from scipy.optimize import linear_sum_assignment

import trunnion as tn
from trunnion.results.speeds import show_speed

Springs = list[tuple[int, int, float, float]]
"""From inertia, to inertia (−1 the ground), stiffness, damping."""

CLAMPED: Springs = [(-1, 0, 1e4, 2.0), (0, 1, 3e4, 1.0), (1, 2, 2e4, 0.5)]
FREE: Springs = [(0, 1, 1e4, 2.0), (1, 2, 3e4, 1.0), (2, 3, 2e4, 0.5)]


def scaled(springs: Springs, stiffness: float = 1.0, damping: float = 1.0, only: int | None = None) -> Springs:
    """The same springs, damped otherwise: all, or one of them."""
    return [(i, j, stiffness * k, damping * c if only in (None, n) else c) for n, (i, j, k, c) in enumerate(springs)]


RING: Springs = [(0, 1, 6e6, 0.0), (0, 2, 1.0, 6000.0)]
LINES: dict[str, tuple[list[float], Springs, list[float]]] = {
    "clamped, undamped": ([0.4, 0.9, 0.2], scaled(CLAMPED, damping=0.0), [0.0] * 3),
    "clamped, light": ([0.4, 0.9, 0.2], CLAMPED, [0.0] * 3),
    "clamped, heavy": ([0.4, 0.9, 0.2], scaled(CLAMPED, damping=40.0), [0.0] * 3),
    "clamped, all overdamped": ([0.4, 0.9, 0.2], scaled(CLAMPED, damping=4000.0), [0.0] * 3),
    "clamped, one damper locks": ([0.4, 0.9, 0.2], scaled(CLAMPED, damping=1e5, only=1), [0.0] * 3),
    "clamped, one mass, critical but for 1 %": ([0.5], [(-1, 0, 200.0, 20.2)], [0.0]),
    "free, undamped": ([0.4, 0.9, 0.2, 0.1], scaled(FREE, damping=0.0), [0.0] * 4),
    "free, light": ([0.4, 0.9, 0.2, 0.1], FREE, [0.0] * 4),
    "free, heavy": ([0.4, 0.9, 0.2, 0.1], scaled(FREE, damping=60.0), [0.0] * 4),
    "free, all overdamped": ([0.4, 0.9, 0.2, 0.1], scaled(FREE, damping=5000.0), [0.0] * 4),
    "free, ring held by a damper": ([30.0, 120.0, 20.0], RING, [0.0] * 3),
    "free, braked by a load": ([0.4, 0.9, 0.2, 0.1], FREE, [0.0, 0.0, 0.0, 3.0]),
    "clamped, braked by loads": ([0.4, 0.9, 0.2], CLAMPED, [5.0, 0.0, 70.0]),
}


def described(inertias: list[float], springs: Springs, viscous: list[float]) -> tn.Driveline:
    loads = zip(inertias, viscous, strict=True)
    disks = [tn.Disk(name=f"J{i}", inertia=j, viscous_load=c) for i, (j, c) in enumerate(loads)]
    elements: list[Any] = [tn.ConstantSpeed(name="J-1")] if springs[0][0] < 0 else [disks.pop(0)]
    for i, _, k, c in springs:
        elements += [tn.Shaft(stiffness=k, damping=c, after=f"J{i}"), disks.pop(0)]
    return tn.Driveline(elements)


def eigenvalues(inertias: list[float], springs: Springs, viscous: list[float]) -> np.ndarray:
    """All 2n of λ²M + λC + K, by a pencil that is not the package's: A x = λ B x."""
    n = len(inertias)
    mass, zero = np.diag(inertias), np.zeros((n, n))
    damping, stiffness = np.diag(viscous).astype(float), zero.copy()
    for i, j, k, c in springs:
        twist = np.zeros(n)
        twist[j] = 1.0
        if i >= 0:
            twist[i] = -1.0
        stiffness += k * np.outer(twist, twist)
        damping += c * np.outer(twist, twist)
    a = np.block([[-damping, -stiffness], [np.eye(n), zero]])
    return np.asarray(eig(a, np.block([[mass, zero], [zero, np.eye(n)]]), right=False))


@pytest.mark.parametrize("name", LINES)
def test_eigenvalues_are_those_of_the_damped_line(name: str) -> None:
    modes = tn.natural_frequencies(described(*LINES[name]))
    expected, found = eigenvalues(*LINES[name]), modes.eigenvalue.ravel()
    rows, columns = linear_sum_assignment(np.abs(expected[:, None] - found))
    scale = np.abs(expected).max()
    rigid = np.sort(np.abs(expected))[1] < 1e-6 * scale  # the double zero of a line that turns freely is known as such
    near = np.where(np.abs(expected[rows]) < 1e-6 * scale, 1e-6, 1e-11) * scale
    assert np.all(np.abs(expected[rows] - found[columns]) <= near)
    if rigid:
        assert modes.rigid_body and np.all(modes.eigenvalue[0] == 0)
    oscillating = modes.eigenvalue[:, 0].imag > 0
    first = modes.eigenvalue[oscillating, 0]
    assert modes.frequency[oscillating] == pytest.approx(first.imag, rel=1e-15)
    assert modes.damping_ratio[oscillating] == pytest.approx(-first.real / np.abs(first), abs=1e-15)
    assert np.isnan(modes.frequency[modes.overdamped]).all() and np.isnan(modes.damping_ratio[modes.overdamped]).all()
    assert modes.overdamped.sum() + oscillating.sum() + modes.rigid_body == len(modes.names)


def test_a_ring_held_by_a_damper() -> None:
    """|λ|/2π = 73.09 Hz, ζ = 0.106 where the undamped mode stands at 79.58 Hz; the ring itself is overdamped."""
    line = described(*LINES["free, ring held by a damper"])
    modes = tn.natural_frequencies(line)
    assert np.abs(modes.eigenvalue[2]) / (2 * np.pi) == pytest.approx(73.09, abs=0.005)
    assert modes.damping_ratio[2] == pytest.approx(0.106, abs=5e-4)
    assert modes.undamped_frequency[2] / (2 * np.pi) == pytest.approx(79.58, abs=0.005)
    assert modes.overdamped.tolist() == [False, True, False]
    assert "mode 2: overdamped, decays at 0.0001667 and 403 1/s; undamped" in str(modes)
    assert "714" not in str(modes) + str(modes.table())


def test_one_line_has_one_frequency_wherever_it_is_printed(run, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    line = described(*LINES["free, ring held by a damper"])
    Path("ring.toml").write_text(tn.dumps(line), encoding="utf-8")
    modes = tn.natural_frequencies(line)
    campbell = tn.campbell_diagram(line, [10.0, 20.0])
    assert campbell.frequency[0] == pytest.approx(modes.frequency[1:], rel=1e-12, nan_ok=True)
    assert campbell.damping_ratio[0] == pytest.approx(modes.damping_ratio[1:], rel=1e-12, nan_ok=True)
    assert "mode 2: overdamped" in str(campbell)
    changed = tn.compare(line, line.replace("J2", inertia=25.0))
    assert changed.difference("natural frequency of mode 3").before == modes.frequency[2]
    assert changed.difference("damping ratio of mode 3").before == modes.damping_ratio[2]
    printed = run("natural-frequencies", "ring.toml", "--unit", "Hz", "--json")
    rows = json.loads(printed.stdout)["modes"]
    assert rows[2]["frequency"] == pytest.approx(modes.hertz[2]) and rows[1]["frequency"] is None
    assert rows[1]["decay_rates"] == pytest.approx(modes.decay_rate[1])
    assert show_speed(modes.frequency[2], "Hz") in str(modes)
    slope = tn.sensitivity(line, parameters=["Shaft 2.damping"], of=["frequencies"])
    assert {q.name: q.value for q in slope.quantities}["natural frequency of mode 3"] == modes.frequency[2]
