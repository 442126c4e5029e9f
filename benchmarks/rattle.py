"""The gear pair of Rezaee and Farshidianfar: its response curve, and its sweeps, against integration in time.

    python benchmarks/rattle.py

1. The exact response curve with stability (and by harmonic balance) against the same curve by sweeps in time: up and
   down over as many frequencies as the curve has stable points, each step run for as many periods as the exact sweep
   needs to settle to the accuracy given, once with scipy's solve_ivp stopped at the ends of the gap, once with the
   package's own integrator of systems. Sweeps give no unstable motion and no multiplier; that is not counted.
2. The exact sweep against the same sweep by scipy, at an error per 20 periods that scipy reaches.

The cost of a period is measured over some periods of the motion at several frequencies and multiplied by their number.
"""

from __future__ import annotations

from statistics import median
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.numerics.integration import integrate
from trunnion.numerics.piecewise import move

LOW, HIGH, ACCURACY = 0.3, 1.3, 1e-6
PAIR = tn.catalogue("gear-rattle")
B = PAIR.breakpoints[1]
TRIED = (0.4, 0.6, 0.8, 1.0)


def scipy_run(frequency: float, state: np.ndarray, periods: int, tolerance: float) -> np.ndarray:
    """DOP853, restarted at every end of the gap, period by period."""

    def rate(t: float, y: np.ndarray, piece: int) -> list[float]:
        force = 0.05 + 0.03 * np.cos(frequency * t)
        slope, offset = (1.0, 0.75 * B) if piece < 0 else (1.0, -0.75 * B) if piece > 0 else (0.25, 0.0)
        return [y[1], force - 0.05 * y[1] - slope * y[0] - offset]

    def upper(t: float, y: np.ndarray, piece: int) -> float:
        return y[0] - B

    def lower(t: float, y: np.ndarray, piece: int) -> float:
        return y[0] + B

    upper.terminal = lower.terminal = True  # type: ignore[attr-defined]
    length = 2 * np.pi / frequency
    y = np.array(state)
    for _ in range(periods):
        t, piece = 0.0, int(y[0] > B) - int(y[0] < -B)
        while t < length:
            upper.direction, lower.direction = (1, -1) if piece == 0 else (-1, 1)  # type: ignore[attr-defined]
            run = solve_ivp(
                rate, (t, length), y, args=(piece,), events=(upper, lower), rtol=tolerance, atol=tolerance,
                method="DOP853",
            )  # fmt: skip
            t, y = float(run.t[-1]), run.y[:, -1]
            if run.status == 1:
                piece = (1 if len(run.t_events[0]) else -1) if piece == 0 else 0
    return y


def seconds_per_period(run: object) -> float:
    """Median over frequencies of the time of a period; ``run(frequency, state, periods)``."""
    times = []
    for frequency in TRIED:
        start = tn.piecewise_orbit(PAIR.but(frequency=frequency)).start
        run(frequency, start, 1)  # type: ignore[operator]
        began = perf_counter()
        run(frequency, start, 5)  # type: ignore[operator]
        times.append((perf_counter() - began) / 5)
    return median(times)


def package_run(frequency: float, state: np.ndarray, periods: int) -> np.ndarray:
    """The package's integrator, which locates the ends of the gap."""
    system = PAIR.as_system().but(frequency=frequency)
    y = np.array(state)
    for _ in range(periods):
        run = integrate(
            system.equations, 0.0, 2 * np.pi / frequency, y, regime=system.regime_at(0.0, y), tolerance=1e-7,
            dense=False,
        )  # fmt: skip
        y = run.final[0]
    return y


def best_of(times: int, work: object) -> tuple[float, object]:
    """Shortest time and the last result."""
    spent = []
    for _ in range(times):
        began = perf_counter()
        result = work()  # type: ignore[operator]
        spent.append(perf_counter() - began)
    return min(spent), result


def main() -> None:
    """Print both comparisons."""
    tn.frequency_response(PAIR, LOW, HIGH)  # compiles
    exact, curve = best_of(5, lambda: tn.frequency_response(PAIR, LOW, HIGH))
    balance, by_balance = best_of(
        3, lambda: tn.frequency_response(PAIR, LOW, HIGH, method="harmonic balance", harmonics=20)
    )
    points = int(curve.stable.sum())  # type: ignore[attr-defined]
    grid = np.linspace(LOW, HIGH, points // 2)
    swept, ways = best_of(3, lambda: [tn.sweep(PAIR, g, same=ACCURACY, most=400) for g in (grid, grid[::-1])])
    periods = sum(int(way.periods.sum()) for way in ways)  # type: ignore[attr-defined]
    slow = seconds_per_period(lambda f, y, n: scipy_run(f, y, n, 1e-7))
    own = seconds_per_period(package_run)
    print(f"response curve, {len(curve.frequency)} points with stability, {points} stable")  # type: ignore[attr-defined]
    print(f"  exact branch           {exact:8.3f} s")
    print(f"  harmonic balance, 20   {balance:8.3f} s, {len(by_balance.frequency)} points")  # type: ignore[attr-defined]
    print(f"  sweeps in time: {points} frequencies, {periods} periods to settle to {ACCURACY:g}")
    print(f"    scipy at 1e-7        {slow * periods:8.1f} s  {slow * periods / exact:7.0f} times the exact branch, "
          f"{slow * periods / balance:.0f} times harmonic balance")  # fmt: skip
    print(f"    package integrator   {own * periods:8.1f} s  {own * periods / exact:7.0f} times the exact branch")
    print(f"    exact pieces         {swept:8.3f} s")

    state, errors = np.array([0.4, 0.1]), {}
    true = np.array(state)
    for _ in range(20):
        true = move(PAIR.regimes, PAIR.coefficients, 0.8, true, 0.0, 2 * np.pi / 0.8, tangents=False).state
    for tolerance in (1e-8, 1e-9, 1e-10, 1e-11, 1e-12):
        errors[tolerance] = float(np.abs(scipy_run(0.8, state, 20, tolerance) - true).max())
    tolerance = max((t for t in errors if errors[t] < 1e-9), default=min(errors))
    each = seconds_per_period(lambda f, y, n: scipy_run(f, y, n, tolerance))
    fine, both = best_of(3, lambda: [tn.sweep(PAIR, g) for g in (grid, grid[::-1])])
    count = sum(int(way.periods.sum()) + len(grid) for way in both)  # type: ignore[attr-defined]
    print(
        f"sweep up and down, {count} periods; error of scipy over 20 periods {errors[tolerance]:.1e} at {tolerance:g}"
    )
    print(f"  exact pieces {fine:.3f} s ({1e6 * fine / count:.1f} µs a period), scipy {each * count:.0f} s "
          f"({1e3 * each:.1f} ms a period): {each * count / fine:.0f} times")  # fmt: skip


if __name__ == "__main__":
    main()
