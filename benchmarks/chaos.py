"""How fast: the spectrum of Ueda's oscillator, against the same algorithm on scipy's DOP853, and a map of exponents.

    python benchmarks/chaos.py [periods] [points]

The comparison is at equal error: scipy's tolerances are chosen so that the sum of its exponents, whose exact value is
known, is off by as much as here or more.
"""

from __future__ import annotations

import os
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.systems.reference import ueda

PERIOD = 2 * np.pi
SCIPY_PERIODS = 100


def by_scipy(periods: int, rtol: float) -> tuple[float, float]:
    """Seconds, and the error of the sum: variational equations, QR once a period."""

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v, a, b, c, d = y
        k = -3 * x * x
        return [v, -0.05 * v - x * x * x + 7.5 * np.cos(t), b, k * a - 0.05 * b, d, k * c - 0.05 * d]

    y, total = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), 0.0
    begin = time.perf_counter()
    for _ in range(periods):
        y = solve_ivp(rate, (0, PERIOD), y, method="DOP853", rtol=rtol, atol=rtol).y[:, -1]
        q, r = np.linalg.qr(y[2:].reshape(2, 2).T)
        total += float(np.log(np.abs(np.diag(r))).sum())
        y = np.concatenate([y[:2], q.T.ravel()])
    return time.perf_counter() - begin, abs(total / (periods * PERIOD) + 0.05)


def main(periods: int = 10_000, points: int = 100) -> None:
    """Print the figures."""
    tn.lyapunov_spectrum(ueda(), 100, starts=1)
    begin = time.perf_counter()
    found = tn.lyapunov_spectrum(ueda(), periods, starts=1, transient=0, tolerance=1e-10)
    ours = time.perf_counter() - begin
    print(f"Ueda, {periods} periods, tolerance 1e-10: {ours:.2f} s, sum off by {found.sum_error:.1e} 1/s")
    for rtol in (1e-9, 1e-10, 1e-11, 1e-12):
        seconds, error = by_scipy(SCIPY_PERIODS, rtol)
        whole = seconds * periods / SCIPY_PERIODS
        print(f"  scipy, rtol {rtol:g}: {whole:.0f} s ({SCIPY_PERIODS} periods measured), off by {error:.1e}, "
              f"{whole / ours:.0f} times slower")  # fmt: skip
        if error <= found.sum_error:
            break
    begin = time.perf_counter()
    map_ = tn.lyapunov_map(
        ueda(), ("force", 1.0, 13.0, points), ("damping", 0.02, 0.4, points), periods=500, transient=100
    )
    seconds = time.perf_counter() - begin
    print(
        f"largest exponent, {points} × {points} points, 500 + 100 periods each, 1e-8 per step: {seconds:.1f} s with "
        f"{map_.threads} threads of {os.cpu_count()} processors"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
