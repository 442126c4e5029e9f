"""Reference problems of the literature."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.numerics.compiled import kernel_file
from trunnion.systems.periodic_linear import PeriodicLinearSystem, from_matrices
from trunnion.systems.regimes import Regimes, Switch
from trunnion.systems.system import Period, System
from trunnion.systems.user_functions import CFunction, from_kernel


def mathieu(a: float, q: float, damping: float = 0.0) -> PeriodicLinearSystem:
    """Damped Mathieu oscillator y″ + 2ζy′ + (a − 2q cos 2x) y = 0, period π; ``damping`` is ζ."""
    return from_matrices(
        np.eye(1),
        np.array([[2.0 * damping]]),
        lambda x: (a - 2 * q * np.cos(2 * x))[:, None, None],
        period=np.pi,
        names=("y",),
    )


def mathieu_oscillator(a: float = 1.0, q: float = 0.2, damping: float = 0.0) -> System:
    """The same oscillator as a ``System``, to be integrated: states y and y′."""
    return _system(
        "mathieu", ("y", "rate"), np.pi, [1.0, 0.0], divergence=lambda p: -2 * p["damping"], a=a, q=q, damping=damping
    )  # fmt: skip


def duffing(
    damping: float = 0.05,
    stiffness: float = 1.0,
    cubic: float = 0.1,
    mean_force: float = 0.0,
    force: float = 0.18,
    frequency: float = 1.2,
) -> System:
    """Duffing's oscillator x″ + c x′ + k₁x + k₃x³ = B₀ + B₁ cos ωt."""
    return _oscillator(
        "duffing", damping=damping, stiffness=stiffness, cubic=cubic, mean_force=mean_force, force=force,
        frequency=frequency,
    )  # fmt: skip


def linear_oscillator(
    damping: float = 0.1, stiffness: float = 1.0, force: float = 1.0, frequency: float = 1.0
) -> System:
    """x″ + c x′ + kx = B cos ωt."""
    return _oscillator(
        "duffing", "linear-oscillator", damping=damping, stiffness=stiffness, cubic=0.0, mean_force=0.0, force=force,
        frequency=frequency,
    )  # fmt: skip


def ueda(damping: float = 0.05, force: float = 7.5, frequency: float = 1.0) -> System:
    """Ueda's oscillator x″ + c x′ + x³ = B cos ωt, chaotic as it stands (Ueda, J. Stat. Phys. 20, 1979)."""
    return _oscillator(
        "duffing", "ueda", damping=damping, stiffness=0.0, cubic=1.0, mean_force=0.0, force=force, frequency=frequency
    )  # fmt: skip


def driven_pendulum(damping: float = 0.1, force: float = 2.5, frequency: float = 1.0) -> System:
    """x″ + c x′ + sin x = B sin ωt; chaotic as it stands."""
    return _oscillator("pendulum", "driven-pendulum", damping=damping, force=force, frequency=frequency)


def dead_zone_oscillator(
    damping: float = 0.1,
    stiffness: float = 1.0,
    inside: float = 0.0,
    half_gap: float = 1.0,
    mean_force: float = 0.1,
    force: float = 0.05,
    frequency: float = 0.6,
) -> System:
    """x″ + c x′ + g(x) = B₀ + B₁ cos ωt, with slope αk of g within ±b and k outside; ``inside`` is α."""
    regimes = Regimes(
        names=("gap", "upper contact", "lower contact"),
        guards=("upper end", "lower end"),
        guard=_function("dead_zone_ends"),
        switches=(
            Switch("gap", "upper end", +1, "upper contact"),
            Switch("upper contact", "upper end", -1, "gap"),
            Switch("gap", "lower end", -1, "lower contact"),
            Switch("lower contact", "lower end", +1, "gap"),
        ),
        locate=_contact,
    )
    return _oscillator(
        "dead_zone", "dead-zone-oscillator", regimes, damping=damping, stiffness=stiffness, inside=inside,
        half_gap=half_gap, mean_force=mean_force, force=force, frequency=frequency,
    )  # fmt: skip


def lorenz(sigma: float = 10.0, rho: float = 28.0, beta: float = 8.0 / 3.0) -> System:
    """Lorenz's equations (J. Atmos. Sci. 20, 1963)."""
    return _system(
        "lorenz", ("x", "y", "z"), None, [1.0, 1.0, 20.0], divergence=lambda p: -p["sigma"] - 1 - p["beta"],
        sigma=sigma, rho=rho, beta=beta,
    )  # fmt: skip


def rossler(a: float = 0.2, b: float = 0.2, c: float = 5.7) -> System:
    """Rössler's equations (Phys. Lett. A 57, 1976)."""
    return _system("rossler", ("x", "y", "z"), None, [1.0, 1.0, 1.0], a=a, b=b, c=c)


SYSTEMS: Mapping[str, Callable[..., System]] = {
    "mathieu": mathieu_oscillator,
    "duffing": duffing,
    "linear-oscillator": linear_oscillator,
    "driven-pendulum": driven_pendulum,
    "ueda": ueda,
    "dead-zone-oscillator": dead_zone_oscillator,
    "lorenz": lorenz,
    "rossler": rossler,
}


def reference_system(name: str, **parameters: float) -> System:
    """A system of the literature by name: duffing, ueda, lorenz, rossler, driven-pendulum, mathieu and others.

    Parameters
    ----------
    name : one of ``trunnion.systems.reference.SYSTEMS``; an unknown name is refused with the list of them.
    **parameters : new values of some of its parameters, in its own units; those left out keep the values of the source.

    Raises
    ------
    InputError : no such system, or not one of its parameters.

    Examples
    --------
    >>> import trunnion as tn
    >>> system = tn.reference_system("duffing", force=0.3)
    >>> system.states, system.parameters["force"], round(system.forcing_period, 4)
    (('x', 'v'), 0.3, 5.236)
    """
    if name not in SYSTEMS:
        raise InputError(
            "is not a reference system", key="system", value=name, remedy=f"known are: {', '.join(SYSTEMS)}"
        )
    return SYSTEMS[name]().with_parameters(parameters)


def _contact(time: float, state: Array, p: Any) -> int:
    return 1 if state[0] > p.half_gap else 2 if state[0] < -p.half_gap else 0


def _kernel() -> ModuleType:
    return kernel_file(str(Path(__file__).with_name("reference_kernel.py")))


def _function(name: str) -> CFunction:
    return from_kernel(_kernel, name)


def _forcing_period(p: Mapping[str, float]) -> float:
    return 2 * np.pi / p["frequency"] if p["frequency"] > 0 else np.nan


def _oscillator(rate: str, name: str = "", regimes: Regimes | None = None, **values: float) -> System:
    start = [0.0, 0.0]
    return _system(rate, ("x", "v"), _forcing_period, start, name, regimes, lambda p: -p["damping"], **values)


def _system(
    rate: str,
    states: tuple[str, ...],
    period: Period,
    start: list[float],
    name: str = "",
    regimes: Regimes | None = None,
    divergence: Callable[[Mapping[str, float]], float] | None = None,
    **values: float,
) -> System:
    return System(
        name=name or rate,
        states=states,
        rate=_function(rate),
        parameters={k: float(v) for k, v in values.items()},
        period=period,
        start=np.array(start),
        regimes=regimes,
        divergence=divergence,
    )
