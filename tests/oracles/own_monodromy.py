"""Spectral radii of many driven chains at once, with equations written here and Runge and Kutta's method.

A chain is a list of kinds with arrays of numbers, one of each line. Points turn by a(τ) without vibration and by r(τ)δ
with the rotation δ of the first point of their group; to second order by ½hδ² more, h = r′/a₁′ of that first point.
Lagrange's equations of group i are then, with derivatives by time and twist x = δ_far − r δ_near of each spring,

    Σ J r (rδ)¨ + J ä h δ + M h δ + r M′ (rδ)˙   (its points; M(a˙) their loads)
    + [k x + c ẋ] at the far end, − r[k x + c ẋ] − T h δ at the near end.

Derivatives of r and a by the angle are those of their Fourier series, not those of the joints' laws.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

import trunnion as tn

Array = NDArray[np.float64]
SAMPLES = 128
"""Of a turn of the input: joints' harmonics up to the 60th."""


@dataclass
class Part:
    """``kind`` "shaft", "disk", "hooke", "tripod" or "ratio", and its numbers, each (lines,) or one for all. A shaft
    with a ``knot`` [rad] has its stiffness beyond that, and ``inner`` times it within."""

    kind: str
    numbers: dict[str, Any] = field(default_factory=dict)

    def element(self, line: int) -> tn.Element:
        """The package's own element of one line."""
        own = {key: float(np.broadcast_to(value, (line + 1,) if np.ndim(value) == 0 else np.shape(value))[line])
               for key, value in self.numbers.items()}  # fmt: skip
        kinds = {"shaft": tn.Shaft, "disk": tn.Disk, "hooke": tn.HookeJoint, "tripod": tn.TripodJoint}
        if "knot" in own:
            inner, knot = own.pop("inner"), own.pop("knot")
            outer = own.pop("stiffness")
            return tn.PiecewiseShaft.symmetric([(inner * outer, knot), (outer, None)], **own)
        if self.kind == "ratio":
            teeth = Fraction(own["ratio"]).limit_denominator(100)
            return tn.Ratio(teeth_in=12 * teeth.denominator, teeth_out=12 * teeth.numerator)
        return kinds[self.kind](**own)


@dataclass
class _Group:
    """J r², …; of one unknown: (samples, lines)."""

    mass: Any = 0.0
    damping: Any = 0.0
    stiffness: Any = 0.0


def _in_stage(stiffness: Array, torque: Array, inner: Any, knot: Any) -> tuple[Array, Array]:
    """Stiffness under a torque, and what the twist has beside torque over stiffness."""
    outside = np.abs(torque) > inner * stiffness * knot
    return (
        np.where(outside, stiffness, inner * stiffness),
        np.where(outside, np.sign(torque) * knot * (1 - inner), 0.0),
    )


def derivative(values: Array) -> Array:
    """By the input angle, of samples over a turn (samples, lines)."""
    order = np.fft.fftfreq(len(values)) * len(values)
    order[len(values) // 2] = 0.0
    return np.fft.ifft(1j * order[:, None] * np.fft.fft(values, axis=0), axis=0).real


class Chains:
    """The equations of many chains of the same kinds at ``speed`` (lines,) [rad/s]."""

    def __init__(self, parts: list[Part], speed: Array) -> None:
        self.parts, self.speed = parts, np.asarray(speed, dtype=float)
        self.tau = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
        self.m, self.c, self.k = self._equations()

    def torques(self) -> list[Array]:
        """Mean torque in each shaft: loads behind it, at mean speeds."""
        found, mean, speeds, loads = [], np.ones_like(self.speed), [], []
        for part in self.parts:
            if part.kind == "ratio":
                mean = mean / part.numbers["ratio"]
            if part.kind == "shaft":
                speeds.append(mean)
            if part.kind == "disk":
                own = part.numbers.get("load_torque", 0.0) + part.numbers.get("viscous_load", 0.0) * mean * self.speed
                loads.append((len(speeds), own * mean))
        for e, own in enumerate(speeds):
            found.append(-sum((power for behind, power in loads if behind > e), np.zeros_like(self.speed)) / own)
        return found

    def _equations(self) -> tuple[Array, Array, Array]:
        """M, C, K (samples, lines, n, n)."""
        shape, omega = (SAMPLES, len(self.speed)), self.speed
        periodic = np.zeros(shape)  # a − (mean speed) τ
        mean, r, h = np.ones_like(omega), np.ones(shape), np.zeros(shape)
        n = sum(part.kind == "shaft" for part in self.parts)
        m, c, k = np.zeros((3, *shape, n, n))
        unknown, torques, first = -1, iter(self.torques()), np.ones(shape)

        def a_rate() -> Array:
            return mean + derivative(periodic)

        for part in self.parts:
            get = part.numbers.get
            if part.kind == "shaft":
                torque = next(torques)
                stiff, damp = (np.broadcast_to(part.numbers[key], omega.shape) for key in ("stiffness", "damping"))
                stiff, beyond = _in_stage(stiff, torque, get("inner", 1.0), get("knot", 0.0))
                near, unknown = unknown, unknown + 1
                c[..., unknown, unknown] += damp
                k[..., unknown, unknown] += stiff
                if near >= 0:
                    r_dot = derivative(r) * omega
                    c[..., near, near] += damp * r**2
                    k[..., near, near] += stiff * r**2 + damp * r * r_dot - torque * h
                    c[..., unknown, near] -= damp * r
                    k[..., unknown, near] -= stiff * r + damp * r_dot
                    c[..., near, unknown] -= damp * r
                    k[..., near, unknown] -= stiff * r
                periodic = periodic + get("fork_offset", 0.0) + torque / stiff + beyond
                r, h, first = np.ones(shape), np.zeros(shape), a_rate()
            elif part.kind in ("hooke", "tripod"):
                chi = mean * self.tau[:, None] + periodic - get("plane", 0.0)
                beta = part.numbers["angle"]
                if part.kind == "hooke":
                    turns = np.exp(1j * chi)
                    out = np.angle((turns.real * np.cos(beta) + 1j * turns.imag) / turns) + np.pi / 2
                    eta = np.cos(beta) / (1 - np.sin(beta) ** 2 * np.cos(chi) ** 2)
                else:
                    size = part.numbers["radius"] / (2 * part.numbers["length"]) * np.tan(beta) * np.tan(beta / 2) ** 2
                    out, eta = size * np.sin(3 * chi), 1 + 3 * size * np.cos(3 * chi)
                periodic = periodic - get("plane", 0.0) + out
                r = r * eta
                h = derivative(r) / first
            elif part.kind == "ratio":
                periodic, mean, r, h = (x / part.numbers["ratio"] for x in (periodic, mean, r, h))
            elif unknown >= 0:
                inertia, rate = get("inertia", 0.0), a_rate() * omega
                load, viscous = get("load_torque", 0.0), get("viscous_load", 0.0)
                r_dot, r_ddot = derivative(r) * omega, derivative(derivative(r)) * omega**2
                m[..., unknown, unknown] += inertia * r**2
                c[..., unknown, unknown] += 2 * inertia * r * r_dot + viscous * r**2
                k[..., unknown, unknown] += inertia * r * r_ddot + inertia * derivative(rate) * omega * h
                k[..., unknown, unknown] += (load + viscous * rate) * h + viscous * r * r_dot
        return m, c, k

    def radii(self, cycles: int = 40) -> Array:
        """Largest modulus of the multipliers over a turn (lines,), with ``cycles`` steps to a cycle of the fastest
        mode or a harmonic, at least."""
        n = self.m.shape[-1]
        a = np.zeros((SAMPLES, len(self.speed), 2 * n, 2 * n))
        a[..., :n, n:] = np.eye(n)
        over = 1 / np.einsum("tlii->tli", self.m)
        a[..., n:, :n], a[..., n:, n:] = -self.k * over[..., None], -self.c * over[..., None]
        a = a / self.speed[:, None, None]
        fastest = np.sqrt(np.abs(self.k * over[..., None]).sum(axis=-1).max()) / self.speed.min()
        rates = np.abs(a[..., n:, n:]).sum(axis=-1).max()
        steps = 2 * SAMPLES * int(np.ceil(max(cycles * fastest, 8 * rates, 6 * SAMPLES) / (2 * SAMPLES)))
        fine = _finer(a, 2 * steps)
        h, z = 2 * np.pi / steps, np.broadcast_to(np.eye(2 * n), a.shape[1:]).copy()
        for s in range(steps):
            first, middle, last = fine(2 * s), fine(2 * s + 1), fine((2 * s + 2) % (2 * steps))
            k1 = first @ z
            k2 = middle @ (z + h / 2 * k1)
            k3 = middle @ (z + h / 2 * k2)
            z = z + h / 6 * (k1 + 2 * k2 + 2 * k3 + last @ (z + h * k3))
        return np.asarray(np.abs(np.linalg.eigvals(z)).max(axis=-1))


def _finer(a: Array, count: int):  # type: ignore[no-untyped-def]
    """Samples of a turn at ``count`` even angles, by Fourier series."""
    spread = np.fft.fft(a, axis=0)
    whole = np.zeros((count, *a.shape[1:]), dtype=complex)
    half = SAMPLES // 2
    whole[:half], whole[-half + 1 :] = spread[:half], spread[-half + 1 :]
    values = np.fft.ifft(whole, axis=0).real * (count / SAMPLES)
    return lambda s: values[s]
