"""How every station of a line turns when no shaft vibrates: the base motion of the linearisation.

With τ the input angle, each station s has an angle a_s(τ) (fork phases and static twist included), a speed
w = da/dτ and an acceleration w′ = d²a/dτ². Within its group it follows the group's first station by
r = da_s/da_ref, with r₁ = dr/da_ref and r₂ = dr₁/da_ref. A joint with input angle χ multiplies, by its law,

    w → ηw,  w′ → η_χ w² + ηw′,  r → ηr,  r₁ → ηr₁ + η_χ r²,  r₂ → ηr₂ + 3η_χ r r₁ + η_χχ r³;

a ratio ρ divides all of them by ρ. The output fork of a Hooke's joint stands a quarter turn from its input fork.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Link, Topology


@dataclass(frozen=True)
class BaseMotion:
    """Base motion at the input angles asked for; each array has shape (case, time, station)."""

    angle: Array
    speed: Array
    acceleration: Array
    relative: Array
    relative_slope: Array
    relative_curvature: Array


def base_motion(
    topo: Topology, coefficients: LineCoefficients, tau: Array, *, stood: Array | None = None
) -> BaseMotion:
    """Walk the stations from the input, at input angles ``tau`` [rad] of shape (time,) or (case, time).

    ``stood`` (case, time, station) : where stations stand that shafts let twist [rad]; ``relative`` is then that of
    the joints there. By default where the walk leads them.
    """
    cases = len(coefficients.speed)
    tau = np.broadcast_to(tau, (cases, np.shape(tau)[-1]))
    # Each station lies in one piece over time, which is how it is filled.
    a, w, w1, r, r1, r2 = (np.moveaxis(np.zeros((len(topo.stations), *tau.shape)), 0, -1) for _ in range(6))
    laws, stood = list(coefficients.joints), a if stood is None else stood
    for s, station in enumerate(topo.stations):
        b = station.before
        shift = coefficients.shift[:, s, None]
        if station.link is Link.ROOT:
            a[..., s], w[..., s], r[..., s] = tau, 1.0, 1.0
        elif station.link is Link.SHAFT:
            a[..., s], w[..., s], w1[..., s] = a[..., b] + shift, w[..., b], w1[..., b]
            r[..., s] = 1.0
        elif station.link is Link.JOINT:
            law = laws.pop(0)
            output, eta, slope, curvature = law.at(stood[..., b] + shift)
            rb, rb1, rb2, wb, wb1 = r[..., b], r1[..., b], r2[..., b], w[..., b], w1[..., b]
            a[..., s] = output + law.turned
            w[..., s], w1[..., s] = eta * wb, slope * wb**2 + eta * wb1
            r[..., s], r1[..., s] = eta * rb, eta * rb1 + slope * rb**2
            r2[..., s] = eta * rb2 + 3 * slope * rb * rb1 + curvature * rb**3
        else:
            for quantity in (a, w, w1, r, r1, r2):
                quantity[..., s] = quantity[..., b] / topo.ratio_values[s]
    return BaseMotion(a, w, w1, r, r1, r2)
