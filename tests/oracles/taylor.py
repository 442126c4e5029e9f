"""Ends of motions by Taylor series: heyoka where it is installed, otherwise mpmath."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def end_state(name: str, p: Mapping[str, float], start: Sequence[float], duration: float) -> NDArray[np.float64]:
    """State after ``duration`` of a reference system, good to about 1e-13."""
    try:
        import heyoka
    except ImportError:
        return _by_mpmath(name, p, start, duration)
    x = heyoka.make_vars(*"xyz"[: len(start)])
    rates = equations(name, heyoka, heyoka.time, x, p)
    integrator = heyoka.taylor_adaptive(list(zip(x, rates, strict=True)), list(start), tol=1e-18, high_accuracy=True)
    integrator.propagate_until(duration)
    return np.array(integrator.state)


def _by_mpmath(name: str, p: Mapping[str, float], start: Sequence[float], duration: float) -> NDArray[np.float64]:
    import mpmath

    with mpmath.workdps(20):
        solution = mpmath.odefun(
            lambda t, x: [mpmath.mpmathify(r) for r in equations(name, mpmath, t, x, p)],
            0,
            [mpmath.mpf(v) for v in start],
        )
        return np.array([float(v) for v in solution(duration)])


def equations(name: str, lib: Any, t: Any, x: Any, p: Mapping[str, float]) -> list[Any]:
    """Rates of the reference systems, written out a second time."""
    if name in ("duffing", "ueda", "linear-oscillator"):
        force = p["mean_force"] + p["force"] * lib.cos(p["frequency"] * t)
        return [x[1], force - p["damping"] * x[1] - p["stiffness"] * x[0] - p["cubic"] * x[0] ** 3]
    if name == "driven-pendulum":
        return [x[1], p["force"] * lib.sin(p["frequency"] * t) - p["damping"] * x[1] - lib.sin(x[0])]
    if name == "mathieu":
        return [x[1], -2 * p["damping"] * x[1] - (p["a"] - 2 * p["q"] * lib.cos(2.0 * t)) * x[0]]
    if name == "lorenz":
        return [p["sigma"] * (x[1] - x[0]), x[0] * (p["rho"] - x[2]) - x[1], x[0] * x[1] - p["beta"] * x[2]]
    assert name == "rossler"
    return [-x[1] - x[2], x[0] + p["a"] * x[1], p["b"] + x[2] * (x[0] - p["c"])]
