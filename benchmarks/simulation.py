"""A three-shaft line over 1 000 turns at 1e-9: the package against scipy's DOP853 with a numpy right-hand side.

    python benchmarks/simulation.py [--turns 1000]

Both integrate the same equations of the same line from the same start. The error is the largest deviation of a
rotation, at every turn, from a run at 1e-14; each side takes the loosest tolerance, in factors of √10 from 1e-8, that
keeps its error below 1e-9 rad. Also: the integration error against a Taylor integrator at three tolerances.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import median
from time import perf_counter

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "nonlinear"))

import numpy as np
from jointed_lines import three_shafts
from oracles.taylor import end_state
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.line_system import line_system

SPEED, WANTED = 60.0, 1e-9
SYSTEMS = {
    "duffing": (40.0, [0.5, 0.0]),
    "driven-pendulum": (15.0, [0.3, 0.1]),
    "ueda": (8.0, [2.5, 0.0]),
    "lorenz": (5.0, [1.0, 1.0, 20.0]),
    "rossler": (20.0, [1.0, 1.0, 1.0]),
    "mathieu": (30.0, [1.0, 0.0]),
}


def numpy_rate(load: float, damping: float):
    """The equations of ``lines.three_shafts`` in numpy, in deviations from uniform rotation."""
    inertia, stiffness = np.array([0.3, 0.5, 1.1]), np.array([1.5e4, 1.1e4, 0.9e4])
    angle, shift = np.array([tn.deg(20), tn.deg(15)]), np.array([0.3, 0.3 + 1.0 + np.pi / 2 - 0.4])
    size, cosine, square = np.tan(angle / 2) ** 2, np.cos(angle), np.sin(angle) ** 2

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        d, v = y[:3], SPEED + y[3:]
        chi = SPEED * t + d[:2] + shift
        c, s = np.cos(2 * chi), np.sin(2 * chi)
        lead = np.arctan2(size * s, 1 - size * c)
        eta = cosine / (1 - square * (1 + c) / 2)
        twist, twist_rate = d.copy(), v - SPEED
        twist[1:] -= d[:2] + lead
        twist_rate[1:] = v[1:] - eta * v[:2]
        f = stiffness * twist + damping * twist_rate
        push = -f
        push[:2] += eta * f[1:]
        push[2] -= load
        return np.concatenate([y[3:], push / inertia])

    return rate


def errors(states: np.ndarray, exact: np.ndarray) -> float:
    return float(np.abs(states - exact)[:, :3].max())


def timed(function, repeats: int) -> tuple[float, object]:
    """Median time of a call [s], and what it returned."""
    times, value = [], None
    for _ in range(repeats):
        start = perf_counter()
        value = function()
        times.append(perf_counter() - start)
    return median(times), value


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--turns", type=int, default=1000)
    turns = parser.parse_args().turns
    line, load, damping = three_shafts(load=50.0), 50.0, 4.0
    prepared = line_system(line, SPEED)
    rate = numpy_rate(load, damping)
    state = np.random.default_rng(1).normal(size=6) * 0.01
    apart = np.abs(rate(0.3, state) - prepared.system.rate_at(0.3, state)).max()
    print(f"the two right-hand sides differ by {apart:.1e} rad/s² of {np.abs(rate(0.3, state)).max():.3g}")

    duration = turns * 2 * np.pi / SPEED
    times = np.linspace(0, duration, turns + 1)
    start = prepared.rest()
    exact = tn.simulate(line, speed=SPEED, duration=duration, tolerance=1e-14).at(times)

    for tolerance in 10.0 ** np.arange(-8.0, -13.1, -0.5):
        run = tn.simulate(line, speed=SPEED, duration=duration, tolerance=tolerance)
        if errors(run.at(times), exact) < WANTED:
            break
    own, _ = timed(lambda: tn.simulate(line, speed=SPEED, duration=duration, tolerance=tolerance), 5)
    print(f"trunnion: tolerance {tolerance:.1e}, error {errors(run.at(times), exact):.1e} rad, "
          f"{run.steps} steps, {own:.3f} s ({1e6 * own / run.steps:.2f} µs a step)")  # fmt: skip

    short, some = duration / 20, times[: turns // 20 + 1]
    for scipy_tolerance in 10.0 ** np.arange(-8.0, -13.1, -0.5):
        found = solve_ivp(
            rate, (0, short), start, "DOP853", t_eval=some, rtol=scipy_tolerance, atol=scipy_tolerance / 100
        )
        if errors(found.y.T, exact[: len(some)]) < WANTED:
            break

    def by_scipy():
        return solve_ivp(
            rate, (0, duration), start, "DOP853", t_eval=times, rtol=scipy_tolerance, atol=scipy_tolerance / 100
        )

    other, found = timed(by_scipy, 1)
    print(f"scipy: rtol {scipy_tolerance:.1e}, error {errors(found.y.T, exact):.1e} rad, "
          f"{found.nfev} right-hand sides, {other:.1f} s")  # fmt: skip
    print(f"ratio {other / own:.0f}")

    print("\nerror at the end against a Taylor integrator, tolerance 1e-6, 1e-9, 1e-12")
    for name, (length, begun) in SYSTEMS.items():
        system = tn.reference_system(name)
        truth = end_state(name, system.parameters, begun, length)
        row = [
            np.abs(tn.simulate(system, length, start=begun, tolerance=t).final - truth).max()
            for t in (1e-6, 1e-9, 1e-12)
        ]
        print(f"  {name:16}" + "".join(f"  {e:.1e}" for e in row))


if __name__ == "__main__":
    main()
