"""Order responses behind angled joints by two other routes, written here once more: the monodromy matrix for viscous
lines, and Hill's matrix assembled entry by entry for loss factors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

K, J = (3e3, 5e3), (0.3, 0.4)
BETA, TORQUE, PHASE = 0.35, 25.0, 0.6


def line(order: float, **damping: Any) -> tn.Driveline:
    """A drive, two shafts with a joint between them, its front half shaken by one order."""
    shaken = [{"order": order, "amplitude": TORQUE, "phase": PHASE}]
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=K[0], **damping), tn.Disk(inertia=J[0], excitation=shaken),
            tn.HookeJoint(angle=BETA), tn.Shaft(stiffness=K[1], **damping), tn.Disk(inertia=J[1]),
        ]
    )  # fmt: skip


def ratio(tau: Any) -> Any:
    """η = cos β/(1 − sin²β cos²τ), the output speed of a joint over that of its input."""
    return np.cos(BETA) / (1 - np.sin(BETA) ** 2 * np.cos(tau) ** 2)


def ratio_slope(tau: Any) -> Any:
    return -(ratio(tau) ** 2) / np.cos(BETA) * np.sin(BETA) ** 2 * np.sin(2 * tau)


def forced_part(order: float, speed: float, c: float) -> dict[int, complex]:
    """Torque of the second shaft by harmonic m, of Re Σ c_m e^{i(order + 2m)τ}, to the order alone.

    Unknowns x₁, x₂ in time; q₂ = x₂ − η x₁. The joint's own forcing is left out, being another order.
    """
    omega, period = order * speed, np.pi / speed

    def slope(t: float, y: Any) -> Any:
        x1, x2, v1, v2 = y.reshape(4, -1)
        e, e1 = ratio(speed * t), ratio_slope(speed * t) * speed
        t2 = K[1] * (x2 - e * x1) + c * (v2 - e * v1 - e1 * x1)
        a1 = (-K[0] * x1 - c * v1 + e * t2) / J[0]
        a1[-1] += TORQUE * np.exp(1j * (omega * t + PHASE)) / J[0]
        return np.concatenate([v1, v2, a1, -t2 / J[1]])

    start = np.hstack([np.eye(4), np.zeros((4, 1))]).astype(complex)
    times = np.arange(129) * period / 128
    run = solve_ivp(slope, (0, period), start.ravel(), "DOP853", times, rtol=1e-12, atol=1e-15)
    every = run.y.T.reshape(-1, 4, 5)
    z, forced = every[-1, :, :4], every[-1, :, 4]
    y0 = np.linalg.solve(np.exp(1j * omega * period) * np.eye(4) - z, forced)
    x1, x2, v1, v2 = (every[:-1] @ np.append(y0, 1)).T
    e, e1 = ratio(speed * times[:-1]), ratio_slope(speed * times[:-1]) * speed
    torque = K[1] * (x2 - e * x1) + c * (v2 - e * v1 - e1 * x1)
    harmonics = np.fft.fft(torque * np.exp(-1j * omega * times[:-1])) / 128
    return {m: complex(harmonics[m]) for m in range(-12, 13)}


def folded(parts: dict[int, complex], order: float) -> dict[float, complex]:
    """One-sided amplitudes: negative orders by their conjugates."""
    found: dict[float, complex] = {}
    for m, value in parts.items():
        at = order + 2 * m
        found[abs(at)] = found.get(abs(at), 0) + (value if at > 0 else np.conj(value))
    return found


def external(order: float, speed: float, **damping: Any) -> tuple[Any, Any]:
    """Orders of the excited line without what the joint forces by itself."""
    whole = line(order, **damping)
    wanted = sorted({abs(order + 2 * m) for m in range(-3, 4)} - {0.0})
    still = whole.replace("Disk 1", excitation=None)
    both = [tn.order_response(each, [speed], orders=wanted).torque[0, :, 1] for each in (whole, still)]
    return wanted, both[0] - both[1]


@pytest.mark.parametrize("order", [0.5, 1.0, 1.5, 3.0, 2.0])
@pytest.mark.parametrize("speed", [18.0, 55.0])
def test_viscous_lines_by_the_monodromy_matrix(order: float, speed: float) -> None:
    """Order 3 gives orders 1 and −1, which are one; order 2 has a mean, which is not an order."""
    wanted, found = external(order, speed, damping=4.0)
    parts = folded(forced_part(order, speed, 4.0), order)
    expected = np.array([parts[k] for k in wanted])
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("order", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("speed", [18.0, 55.0])
def test_loss_factors_by_hills_matrix_entry_by_entry(order: float, speed: float) -> None:
    """K_e(1 + iη sgn ν) at every harmonic of each spring's own twist; sidebands of negative frequency turn the sign."""
    eta, reach, cycle = 0.12, 10, np.arange(256) * np.pi / 256
    e = np.fft.fft(ratio(cycle)) / 256  # of e^{2imτ}
    m = np.arange(-reach, reach + 1)
    nu, size = (order + 2 * m) * speed, len(m)
    transfer = np.array([[e[i - j] for j in range(size)] for i in range(size)])
    stiff = [np.diag(k * (1 + 1j * eta * np.sign(nu))) for k in K]
    a = np.zeros((2 * size, 2 * size), dtype=complex)
    a[:size, :size] = stiff[0] + transfer.T.conj() @ stiff[1] @ transfer - np.diag(nu**2 * J[0])
    a[:size, size:], a[size:, :size] = -transfer.T.conj() @ stiff[1], -stiff[1] @ transfer
    a[size:, size:] = stiff[1] - np.diag(nu**2 * J[1])
    right = np.zeros(2 * size, dtype=complex)
    right[reach] = TORQUE * np.exp(1j * PHASE)
    x = np.linalg.solve(a, right)
    torque = stiff[1] @ (x[size:] - transfer @ x[:size])
    parts = folded(dict(zip(m.tolist(), torque, strict=True)), order)
    wanted, found = external(order, speed, loss_factor=eta)
    expected = np.array([parts[k] for k in wanted])
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
