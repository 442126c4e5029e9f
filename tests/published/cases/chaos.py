"""Lyapunov exponents of flows of the literature. Runs are long: the site prints them from a file with its date."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from published.printed_numbers import Batch, Source, Verdict

import trunnion as tn
from trunnion.systems.reference import lorenz, rossler, ueda

SOURCES = {
    "Sprott 2003": Source(
        "Sprott, Chaos and Time-Series Analysis (2003)", "the spectra of its appendix, p. 437 for the jerk flow"
    ),
    "ChaosTools run": Source(
        "A public run of ChaosTools over a time of 10 000 (discourse.julialang.org, 116523)",
        "its spectra of Rössler's flow; their third exponents miss the mean divergence and are left out",
    ),
    "DynamicalSystems.jl": Source(
        "DynamicalSystems.jl, documentation of Lyapunov exponents (docs/src/chaos/lyapunovs.md)",
        "the spectrum of Lorenz's flow at ρ = 32 and the largest exponent of Rössler's at (0.1, 0.1, 14)",
    ),
    "Ueda, elsewhere": Source("Ueda's oscillator, another spectrum in print", "0.0999, −0.1499, with the same sum"),
}


def sprott_jerk() -> tn.System:
    """x‴ + A x″ − x′² + x = 0 with A = 2.017 (Sprott, Phys. Lett. A 228, 1997)."""

    def rate(t: Any, x: Any, p: Any) -> Any:
        return x[1], x[2], -x[0] + x[1] * x[1] - p.a * x[2]

    return tn.System.from_function(rate, ["x", "y", "z"], parameters={"a": 2.017}, start=[0.02, 0.0, 0.0], name="jerk")


RUNS: dict[str, Callable[[], Any]] = {
    "jerk": lambda: tn.lyapunov_spectrum(sprott_jerk(), duration=8000.0, starts=1, tolerance=1e-8),
    "rossler": lambda: tn.lyapunov_spectrum(rossler(b=0.2), duration=10_000.0, start=[6.0, 6.0, 6.0], starts=1),
    "regular rossler": lambda: tn.lyapunov_spectrum(rossler(b=1.2), duration=10_000.0, start=[6.0, 6.0, 6.0], starts=1),
    "lorenz": lambda: tn.lyapunov_spectrum(lorenz(rho=32.0), duration=2000.0, starts=1),
    "ueda": lambda: tn.lyapunov_spectrum(ueda(), periods=20_000),
}


@cache
def spectrum(name: str) -> Any:
    """One run, computed once."""
    return RUNS[name]()


SHORT = "the interval of the run computed here"
BATCHES = (
    Batch(
        "Sprott 2003", "p. 437, jerk flow, A = 2.017", "1/s",
        {"largest": "0.0551", "second": "0", "third": "-2.0721"},
        lambda: spectrum("jerk").exponents,
        absolute=4e-3, precision=SHORT, slow=True,
    ),
    Batch(
        "ChaosTools run", "Rössler (0.2, 0.2, 5.7)", "1/s", {"largest": "0.0729", "second": "0.0"},
        lambda: spectrum("rossler").exponents[:2],
        absolute=4e-3, precision=SHORT, slow=True,
    ),
    Batch(
        "ChaosTools run", "Rössler (0.2, 1.2, 5.7)", "1/s", {"largest": "0.0", "second": "-0.1155"},
        lambda: spectrum("regular rossler").exponents[:2],
        absolute=1e-3, precision=SHORT, slow=True,
    ),
    Batch(
        "DynamicalSystems.jl", "Lorenz, ρ = 32", "1/s", {"largest": "0.985688", "third": "-14.6551"},
        lambda: spectrum("lorenz").exponents[[0, 2]],
        absolute=2e-2, precision="its run of 1 000 time units and ours of 2 000", slow=True,
    ),
    Batch(
        "Sprott 2003", "Ueda's oscillator", "1/s", {"largest": "0.1034", "second": "-0.1534"},
        lambda: spectrum("ueda").exponents,
        absolute=1.5e-3, precision=SHORT, slow=True,
    ),
    Batch(
        "Ueda, elsewhere", "Ueda's oscillator", "1/s", {"largest": "0.0999", "second": "-0.1499"},
        lambda: spectrum("ueda").exponents,
        judged=dict.fromkeys(
            ("largest", "second"),
            (Verdict.DISPUTED, "the same sum as Sprott's 0.1034, −0.1534; a long run excludes this one"),
        ),
        slow=True,
    ),
)  # fmt: skip
