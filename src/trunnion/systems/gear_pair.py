"""A gear pair with backlash as one equation for the deflection along the line of action.

With φ₁, φ₂ turning against each other, base radii r₁, r₂, inertias I₁, I₂, driving torque M₁ and resisting torque M₂,
u = r₁φ₁ − r₂φ₂ − e(t) and the mesh force k f(u) + c u̇:

    I₁φ̈₁ = M₁ − r₁ (k f + c u̇),   I₂φ̈₂ = −M₂ + r₂ (k f + c u̇)

give  ü + (c/I) u̇ + (k/I) f(u) = M₁r₁/I₁ + M₂r₂/I₂ − ë,   I = I₁I₂/(I₁r₂² + I₂r₁²).

The reduction of Rezaee and Farshidianfar, equations (2) to (8).
"""

from __future__ import annotations

from math import cos, radians
from typing import Any

import numpy as np

from trunnion.errors import InputError
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

PRESSURE_ANGLE = radians(20.0)


def base_radius(teeth: int, module: float, pressure_angle: float = PRESSURE_ANGLE) -> float:
    """Base radius of a spur gear [m]: half the module times the teeth times the cosine of the pressure angle.

    Parameters
    ----------
    teeth : number of teeth.
    module : pitch diameter over the number of teeth [m].
    pressure_angle : between the line of action and the common tangent of the pitch circles [rad]; by default 20°.

    Raises
    ------
    InputError : no teeth, a module that is not positive.

    Examples
    --------
    >>> import trunnion as tn
    >>> round(tn.base_radius(20, 0.004), 6)
    0.037588
    """
    if teeth < 1 or not module > 0:
        raise InputError("must be positive", element="gear", key="teeth, module", value=[teeth, module])
    return 0.5 * module * teeth * cos(pressure_angle)


def gear_pair(
    *,
    radii: tuple[float, float],
    inertias: tuple[float, float],
    stiffness: float,
    half_backlash: float | None = None,
    backlash_angle: float | None = None,
    inside: float = 0.0,
    damping: float = 0.0,
    torques: tuple[float, float] = (0.0, 0.0),
    torque_amplitudes: tuple[float, float] = (0.0, 0.0),
    transmission_error: tuple[tuple[int, float, float], ...] = (),
    frequency: float = 1.0,
    **more: Any,
) -> PiecewiseOscillator:
    """A gear pair with backlash as an oscillator: x is the deflection u [m] along the line of action.

    Its inertia is I [kg], that of both gears along this line.

    Parameters
    ----------
    radii : base radii (driving, driven) [m]; see ``base_radius``.
    inertias : of the driving and the driven gear [kg m²].
    stiffness : of the mesh along the line of action [N/m].
    half_backlash : half the backlash along the line of action [m]; or
    backlash_angle : the whole turn of the driven gear while the driving one is held [rad].
    inside : stiffness within the gap over ``stiffness`` [-].
    damping : of the mesh along the line of action [N s/m].
    torques : mean M₁ that drives and M₂ that resists [N m].
    torque_amplitudes : of M₁ and M₂ at ``frequency`` [N m], in phase.
    transmission_error : harmonics (k, p_k, q_k) of e = Σ p_k cos kωt + q_k sin kωt [m].
    frequency : ω of torques and error [rad/s], the mesh frequency if the error is that of the teeth.
    **more : ``name`` and ``damping_law`` of ``PiecewiseOscillator``.

    Raises
    ------
    InputError : radii, inertias or stiffness that are not positive, no backlash given or both, and what
        ``PiecewiseOscillator`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> pair = tn.gear_pair(radii=(0.04, 0.06), inertias=(1e-3, 4e-3), stiffness=1e8, half_backlash=5e-5)
    >>> round(pair.inertia, 6), pair.breakpoints
    (0.4, (-5e-05, 5e-05))
    """
    name = more.pop("name", "gear pair")
    for key, values in (("radii", radii), ("inertias", inertias), ("stiffness", (stiffness,))):
        if not all(np.isfinite(v) and v > 0 for v in values):
            raise InputError("must be positive", element=name, key=key, value=values)
    if (half_backlash is None) == (backlash_angle is None):
        raise InputError(
            "must be given in one way", element=name, key="half_backlash, backlash_angle",
            value=[half_backlash, backlash_angle], remedy="write half_backlash = 0 for none",
        )  # fmt: skip
    (r1, r2), (i1, i2) = radii, inertias
    gap = half_backlash if half_backlash is not None else 0.5 * r2 * float(backlash_angle or 0.0)
    inertia = i1 * i2 / (i1 * r2**2 + i2 * r1**2)

    def force(pair: tuple[float, float]) -> float:
        return inertia * (pair[0] * r1 / i1 + pair[1] * r2 / i2)

    # −I ë
    error = tuple(
        (k, inertia * (k * frequency) ** 2 * p, inertia * (k * frequency) ** 2 * q) for k, p, q in transmission_error
    )
    return PiecewiseOscillator.gap(
        gap, stiffness, inside, damping, force(torques), force(torque_amplitudes), frequency, inertia=inertia,
        harmonics=error, name=name, **more,
    )  # fmt: skip
