"""How the stations of a line turn: the one walk from the input, through the laws of all joints.

A station follows the one before it: shifted by a fork offset and a twist, passed on by a joint's law, or divided by a
ratio. The output fork of a Hooke's joint stands a quarter turn from its input fork. Rotations are jets
(``numerics.jets``), so that speeds and accelerations come with them.

The base motion of the linearisation is that of a line of which no shaft vibrates. With τ the input angle, each station
s has an angle a_s(τ) (fork phases and static twist included), a speed w = da/dτ and an acceleration w′ = d²a/dτ².
Within its group it follows the group's first station by r = da_s/da_ref, with r₁ = dr/da_ref and r₂ = dr₁/da_ref. A
joint multiplies, by its law,

    w → ηw,  w′ → η_χ w² + ηw′,  r → ηr,  r₁ → ηr₁ + η_χ r²,  r₂ → ηr₂ + 3η_χ r r₁ + η_χχ r³;

a ratio ρ divides all of them by ρ.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Topology
from trunnion.laws.joint import JointLaw, through

Jet = Sequence[Array]


class StationKinematics(NamedTuple):
    """How a station follows the one ``before`` it.

    ``shift`` [rad]: the first coefficients of the jet that is added; then the joint's ``law``; then the division by
    ``ratio``. With ``of`` it turns by the sum of the shares of several stations instead.
    """

    before: int
    shift: Sequence[Array] = ()
    law: JointLaw | None = None
    ratio: float = 1.0
    of: Sequence[tuple[int, float]] = ()


@dataclass(frozen=True)
class Rotations:
    """Jets of rotation [rad] by station; at those behind a joint the jet ``chi`` of its input angle from its own plane
    and what its law ``passed`` on there: ψ and its derivatives by χ."""

    angle: list[Jet]
    chi: dict[int, Jet]
    passed: dict[int, tuple[Array, ...]]

    def jet(self, station: int) -> Array:
        """That of one station as one array (order + 1, …)."""
        return np.stack(self.angle[station])


def walk(
    places: Iterable[StationKinematics],
    drive: Jet,
    stood: Array | None = None,
    given: Mapping[int, Jet] | None = None,
) -> Rotations:
    """Rotation of all stations, of which the first has the jet ``drive``, at most of order 4.

    Parameters
    ----------
    places : the stations behind the first, in an order in which every one comes after the one before it.
    stood : (…, station) where joints find the stations in front of them [rad]; by default where the walk leads.
    given : the jets of stations that turn by themselves.
    """
    given = given or {}
    found = Rotations([given.get(0, drive)], {}, {})
    for s, (before, shift, law, ratio, of) in enumerate(places, start=1):
        if s in given:
            found.angle.append(given[s])
            continue
        if of:
            parts = [[share * a for a in found.angle[one]] for one, share in of]
            found.angle.append([np.sum(together, axis=0) for together in zip(*parts, strict=True)])
            continue
        jet = found.angle[before] if stood is None or law is None else [stood[..., before]]
        if shift:
            jet = [*(a + b for a, b in zip(jet, shift, strict=False)), *jet[len(shift) :]]
        if law is not None:
            passed: tuple[Array, ...] = law.at(jet[0])
            if len(jet) > len(passed):
                passed = (*passed, law.third(jet[0]))
            found.chi[s], found.passed[s] = jet, passed
            jet = through(passed, jet)
            jet[0] = jet[0] + law.turned
        if ratio != 1.0:
            jet = [a / ratio for a in jet]
        found.angle.append(jet)
    return found


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
    topo: Topology,
    coefficients: LineCoefficients,
    tau: Array,
    *,
    stood: Array | None = None,
    given: GivenRotation | None = None,
) -> BaseMotion:
    """Walk the stations from the input, at input angles ``tau`` [rad] of shape (time,) or (case, time).

    ``stood`` (case, time, station) : where stations stand that shafts let twist [rad]; ``relative`` is then that of
    the joints there. By default where the walk leads them.
    ``given`` : how the unknowns turn, in place of rigid shafts.
    """
    stations, laws = topo.stations[1:], iter(coefficients.joints)
    places = [
        StationKinematics(
            station.before,
            [shift[:, None]] if station.link in (LinkKind.SHAFT, LinkKind.JOINT) else (),
            next(laws) if station.link is LinkKind.JOINT else None,
            ratio,
            [(one, float(share)) for one, share in station.of],
        )
        for station, shift, ratio in zip(stations, coefficients.shift.T[1:], topo.ratio_values[1:], strict=True)
    ]
    own = _given(topo, coefficients, tau, given) if given else {}
    tau = np.broadcast_to(tau, (len(coefficients.speed), np.shape(tau)[-1]))
    turning = walk(places, [tau], stood, {s: jet[:1] for s, jet in own.items()})
    # Each station lies in one piece over time, which is how it is filled.
    a = np.moveaxis(np.array([angle for (angle,) in turning.angle]), 0, -1)
    if not (turning.passed or own):
        return _even_motion(topo, places, a)
    w, w1, r, r1, r2 = (np.moveaxis(np.zeros((len(topo.stations), *tau.shape)), 0, -1) for _ in range(5))
    w[..., 0], r[..., 0] = 1.0, 1.0
    for s, (_, speed, acceleration) in own.items():
        w[..., s], w1[..., s], r[..., s] = speed, acceleration, 1.0
    for s, (station, place) in enumerate(zip(stations, places, strict=True), start=1):
        b = place.before
        if s in own:
            continue
        if station.link is LinkKind.SUM:
            for quantity in (w, w1):
                quantity[..., s] = sum(share * quantity[..., one] for one, share in place.of)
            r[..., s] = 1.0
        elif station.link in (LinkKind.SHAFT, LinkKind.LOOSE):
            w[..., s], w1[..., s], r[..., s] = w[..., b] / place.ratio, w1[..., b] / place.ratio, 1.0
        elif station.link is LinkKind.JOINT:
            _, eta, slope, curvature = turning.passed[s]
            rb, rb1, rb2, wb, wb1 = r[..., b], r1[..., b], r2[..., b], w[..., b], w1[..., b]
            w[..., s], w1[..., s] = eta * wb, slope * wb**2 + eta * wb1
            r[..., s], r1[..., s] = eta * rb, eta * rb1 + slope * rb**2
            r2[..., s] = eta * rb2 + 3 * slope * rb * rb1 + curvature * rb**3
        else:
            for quantity in (w, w1, r, r1, r2):
                quantity[..., s] = quantity[..., b] / place.ratio
    return BaseMotion(a, w, w1, r, r1, r2)


def _even_motion(topo: Topology, places: Sequence[StationKinematics], angle: Array) -> BaseMotion:
    """Of a line without joints, whose stations keep their speeds."""
    speed, relative = [1.0], [1.0]
    for station, place in zip(topo.stations[1:], places, strict=True):
        if station.link is LinkKind.SUM:
            speed.append(sum(share * speed[one] for one, share in place.of))
        else:
            speed.append(speed[place.before] / place.ratio)
        tied = station.link not in (LinkKind.SUM, LinkKind.SHAFT, LinkKind.LOOSE)
        relative.append(relative[place.before] / place.ratio if tied else 1.0)
    w, r, still = np.empty_like(angle), np.empty_like(angle), np.zeros_like(angle)
    w[:], r[:] = speed, relative
    return BaseMotion(angle, w, still, r, still, still)


def _given(
    topo: Topology, coefficients: LineCoefficients, tau: Array, given: GivenRotation
) -> dict[int, tuple[Array, Array, Array]]:
    """Angle, speed and acceleration by the input's (case, time) of the first station of each unknown."""
    even, (angle, speed, acceleration) = even_angles(topo, coefficients, tau)[..., topo.firsts], given.at(tau)
    mean = topo.mean_speeds[topo.firsts]
    return {
        s: (even[..., i] + angle[..., i], mean[i] + speed[..., i], acceleration[..., i])
        for i, s in enumerate(topo.firsts)
    }


def even_angles(topo: Topology, coefficients: LineCoefficients, tau: Array) -> Array:
    """Angles of all stations (case, time, station) [rad] in even rotation, joints straight: what deviations count
    from."""
    return base_motion(topo, coefficients.straight, tau).angle
