"""The gear pair of Rezaee and Farshidianfar: its response curve, and its sweeps, against integration in time.

    python benchmarks/rattle.py

1. The exact response curve with stability (and by harmonic balance) against the same curve by sweeps in time: up and
   down over as many frequencies as the curve has stable points, each step run for as many periods as the exact sweep
   needs to settle to the accuracy given, once with scipy's solve_ivp stopped at the ends of the gap, once with the
   package's own integrator of systems. Sweeps give no unstable motion and no multiplier; that is not counted.
2. The exact sweep against the same sweep by scipy, at an error per 20 periods that scipy reaches.
3. A line of four inertias with two gaps: its exact motion against scipy's solve_ivp, stopped at every change of stage,
   and against the package's own integrator; how far they end from each other, in 1 mrad and 1 rad/s.

The cost of a period is measured over some periods of the motion at several frequencies and multiplied by their number.
"""

from __future__ import annotations

from statistics import median
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.staged_line import staged_line
from trunnion.numerics.integration.integration import integrate
from trunnion.numerics.piecewise_linear.piecewise import move
from trunnion.numerics.piecewise_linear.staged_flow import StagedFlow, stages_of
from trunnion.numerics.piecewise_linear.staged_flow import move as move_line

LOW, HIGH, ACCURACY = 0.3, 1.3, 1e-6
PAIR = tn.catalogue("gear-rattle")
B = PAIR.breakpoints[1]
TRIED = (0.4, 0.6, 0.8, 1.0)
LONGEST = 1e-4
"""Longest step of scipy on the line [s]: with three times as much it overlooks a short contact and loses the motion."""


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


def gear_line() -> tn.Driveline:
    """Four inertias behind a drive, a mesh with backlash and error and a clutch damper among them."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=8e3, damping=4.0),
            tn.Disk(inertia=0.05),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness="2e7 N/m", mesh_damping=900, backlash="0.1 mm",
                damping_law="in contact", transmission_error=[{"amplitude": "20 um"}],
            ),
            tn.Disk(inertia=0.05),
            tn.PiecewiseShaft.symmetric([(200.0, "0.5 deg"), (4000.0, None)], damping=2.0),
            tn.Disk(inertia=0.1),
            tn.Shaft(stiffness=3e3, damping=1.0),
            tn.Disk(inertia=0.2, load_torque=3.0, excitation=[{"amplitude": 30.0, "frequency": 90.0}]),
        ]
    )  # fmt: skip


def scipy_line(flow: StagedFlow, state: np.ndarray, end: float, tolerance: float) -> np.ndarray:
    """DOP853 on the same equations with constant matrices per stage, restarted at every change of stage."""
    m, t, z, stages = flow.size, 0.0, np.array(state), stages_of(flow, state)
    size = np.repeat([1e-3, 1.0], m)
    while t < end:
        pieces = flow.pieces[np.arange(m), stages]
        matrix = np.hstack([-flow.inverse * pieces[:, 1], -flow.inverse * pieces[:, 0] - flow.drag])
        constant = flow.constant - flow.inverse @ pieces[:, 2]

        def rate(t: float, z: np.ndarray, matrix=matrix, constant=constant) -> np.ndarray:
            push = (np.exp(1j * flow.frequencies * t) @ flow.force).real
            return np.concatenate([z[m:], matrix @ z + constant + push])

        watched = [(e, i) for e in range(m) for i in range(3) if flow.then[e, stages[e], i] >= 0]
        events = []
        for e, i in watched:
            a, h, r, direction = flow.guards[e, stages[e], i]
            events.append(lambda t, z, e=e, a=a, h=h, r=r: a * z[e] + h * z[m + e] - r)
            events[-1].terminal, events[-1].direction = True, direction
        run = solve_ivp(
            rate, (t, end), z, events=events, rtol=tolerance, atol=tolerance * size, method="DOP853",
            max_step=LONGEST,
        )  # fmt: skip
        t, z = float(run.t[-1]), run.y[:, -1]
        for (e, i), times in zip(watched, run.t_events, strict=True):
            if len(times):
                stages[e] = flow.then[e, stages[e], i]
    return z


def compare_lines() -> None:
    """Print the third comparison."""
    line, end = gear_line(), 0.5
    prepared = staged_line(line, 40.0)
    flow, start, size = prepared.flow(), prepared.rest(), np.repeat([1e-3, 1.0], 4)
    move_line(flow, start, 0.0, end)  # compiles
    exact, run = best_of(20, lambda: move_line(flow, start, 0.0, end))
    slow, other = best_of(2, lambda: scipy_line(flow, start, end, 1e-10))
    own, there = best_of(5, lambda: tn.simulate(line, end, speed=40.0, tolerance=1e-11, dense=False))
    last = prepared.from_rotations(there.final, end)  # type: ignore[attr-defined]
    off, beside = (float(np.abs((z - run.state) / size).max()) for z in (other, last))  # type: ignore[attr-defined]
    print(f"line of 4 inertias and 2 gaps over {end} s, {len(run.events)} changes of stage")  # type: ignore[attr-defined]
    print(f"  exact pieces           {1e3 * exact:8.2f} ms")
    print(f"  scipy at 1e-10         {1e3 * slow:8.0f} ms, off by {off:.1e}: {slow / exact:.0f} times")
    print(f"  package integrator     {1e3 * own:8.1f} ms, off by {beside:.1e} at 1e-11: {own / exact:.0f} times")


def best_of(times: int, work: object) -> tuple[float, object]:
    """Shortest time and the last result."""
    spent = []
    for _ in range(times):
        began = perf_counter()
        result = work()  # type: ignore[operator]
        spent.append(perf_counter() - began)
    return min(spent), result


def main() -> None:
    """Print all comparisons."""
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
    compare_lines()


if __name__ == "__main__":
    main()
