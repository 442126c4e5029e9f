"""Chains of shafts, disks, joints and gears in twist coordinates, to any precision.

Disk i turns by φ_i, shaft i + 1 twists by θ_{i+1} = φ_{i+1} − (law of the joint and gear behind disk i)(φ_i),
with speed ratio g = η/ρ. To first order about the base motion, ′ = d/dτ,

    δ_{i+1} = g_i δ_i + θ_{i+1},   δ_1 = θ_1,
    J_i Ω² δ_i″ = −f_i + g_i f_{i+1} + (dg_i/dχ) T̄_{i+1} δ_i,   f_i = k_i θ_i + Ω c_i θ_i′,
    θ_{i+1}″ = δ_{i+1}″ − g_i δ_i″ − 2 g_i′ δ_i′ − g_i″ δ_i.

For two and three shafts these are the matrices E, P of S1 and S3 (Soltan Rezaee and Ghazavi 2014 and its
three-shaft sequel) without their misprints. The joint's law is written as those papers do, from the fork
square to the joint plane: x = χ − 90°, D = 1 − sin²β sin²x.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
QUARTER = np.pi / 2


@dataclass(frozen=True)
class Chain:
    """n shafts, each ending in a disk; behind disk i < n a joint (angle 0: none) and a gear (1, 1: none).

    Angles in rad, the rest in any coherent units; fork_offset per shaft, plane per joint, load per disk.
    """

    speed: float
    stiffness: list[float]
    damping: list[float]
    inertia: list[float]
    angle: list[float]
    fork_offset: list[float]
    plane: list[float]
    teeth: list[list[int]] = field(default_factory=list)
    load: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        n = len(self.stiffness)
        if not self.teeth:
            object.__setattr__(self, "teeth", [[1, 1]] * (n - 1))
        if not self.load:
            object.__setattr__(self, "load", [0.0] * n)

    @property
    def size(self) -> int:
        """Number of shafts, and of disks."""
        return len(self.stiffness)

    @property
    def gears(self) -> list[Fraction]:
        """Input over output speed behind each disk but the last."""
        return [Fraction(out, into) for into, out in self.teeth]

    @property
    def period(self) -> float:
        """Input angle after which all joints are back in phase [rad], by trial of whole half-turns."""
        rates, ratio = [Fraction(1)], Fraction(1)
        for gear, angle in zip(self.gears, self.angle, strict=True):
            if angle:
                rates.append(ratio)
            ratio /= gear
        half_turns = next(k for k in range(1, 1000) if all((k * r).denominator == 1 for r in rates[1:] or rates))
        return half_turns * np.pi

    def torque(self) -> list[float]:
        """Mean torque in each shaft [N m], negative because power flows to the loads."""
        found, beyond = [0.0] * self.size, 0.0
        for i in reversed(range(self.size)):
            found[i] = -self.load[i] + beyond
            if i:
                beyond = found[i] / float(self.gears[i - 1])
        return found

    def as_dict(self) -> dict[str, Any]:
        """For a JSON file; ``Chain(**that)`` gives it back."""
        return asdict(self)

    def line(self) -> tn.Driveline:
        """The same chain as the package's user would describe it."""
        elements: list[Any] = [tn.ConstantSpeed()]
        for i in range(self.size):
            elements.append(
                tn.Shaft(stiffness=self.stiffness[i], damping=self.damping[i], fork_offset=self.fork_offset[i])
            )
            elements.append(tn.Disk(inertia=self.inertia[i], load_torque=self.load[i]))
            if i < self.size - 1:
                if self.angle[i]:
                    elements.append(tn.HookeJoint(angle=self.angle[i], plane=self.plane[i]))
                if self.teeth[i][0] != self.teeth[i][1]:
                    elements.append(tn.Ratio(teeth_in=self.teeth[i][0], teeth_out=self.teeth[i][1]))
        return tn.Driveline(elements)


def random_chain(rng: np.random.Generator, *, shafts: int | None = None, plain: bool = False) -> Chain:
    """A chain of 2 to 8 disks; unless ``plain``, some have loads and some a gear."""
    n = int(rng.integers(2, 9)) if shafts is None else shafts
    stiffness = np.exp(rng.uniform(np.log(0.4), np.log(2.5), n))
    inertia = np.exp(rng.uniform(np.log(0.3), np.log(3.0), n))
    loss = np.exp(rng.uniform(np.log(1e-4), np.log(0.05))) * rng.uniform(0.3, 2.0, n)
    bent = rng.random(n - 1) < 0.75
    bent[rng.integers(n - 1)] = True
    teeth = [[1, 1] for _ in range(n - 1)]
    load = np.zeros(n)
    if not plain:
        if rng.random() < 0.15:
            teeth[int(rng.integers(n - 1))] = [[1, 2], [2, 1], [2, 3], [3, 2]][int(rng.integers(4))]
        if rng.random() < 0.35:
            load = rng.uniform(-0.02, 0.1, n) * stiffness.min() / n
    return Chain(
        speed=float(np.exp(rng.uniform(np.log(0.15), np.log(3.0)))),
        stiffness=stiffness.tolist(),
        damping=(2 * loss * np.sqrt(stiffness * inertia)).tolist(),
        inertia=inertia.tolist(),
        angle=np.where(bent, rng.uniform(0.02, 1.1, n - 1), 0.0).tolist(),
        fork_offset=rng.uniform(-np.pi, np.pi, n).tolist(),
        plane=np.where(bent, rng.uniform(-np.pi, np.pi, n - 1), 0.0).tolist(),
        teeth=teeth,
        load=load.tolist(),
    )


def joint_law(functions: Any, chi: Any, cosine: Any) -> tuple[Any, Any, Any, Any]:
    """ψ, η, dη/dχ, d²η/dχ² in the form of S1 (x = χ − 90°), ψ behind the joint measured from its own fork."""
    x = chi - QUARTER
    sine2 = 1 - cosine * cosine
    s = functions.sin(x)
    double_sine, double_cosine = functions.sin(2 * x), functions.cos(2 * x)
    d = 1 - sine2 * s * s
    t = (1 - cosine) / (1 + cosine)
    psi = chi - functions.atan(t * double_sine / (1 + t * double_cosine))
    eta = cosine / d
    slope = cosine * sine2 * double_sine / (d * d)
    curve = cosine * sine2 * (2 * double_cosine / (d * d) + 2 * sine2 * double_sine * double_sine / (d * d * d))
    return psi, eta, slope, curve


class Numpy:
    sin, cos, atan = staticmethod(np.sin), staticmethod(np.cos), staticmethod(np.arctan)


def twist_slopes(functions: Any, numbers: dict[str, list[Any]], tau: Any, theta: Any, rate: Any) -> list[Any]:
    """θ″ of the chain in twist coordinates; ``numbers`` as ``twist_numbers`` gives them."""
    n = len(theta)
    a, w, w1 = tau + numbers["phase"][0], 1, 0
    gain, gain1, gain2, by_angle = [], [], [], []
    for i in range(n - 1):
        psi, eta, slope, curve = joint_law(functions, a - numbers["plane"][i], numbers["cosine"][i])
        over = numbers["over_gear"][i]
        gain.append(eta * over)
        by_angle.append(slope * over)
        gain1.append(slope * over * w)
        gain2.append((curve * w * w + slope * w1) * over)
        w, w1 = eta * over * w, (slope * w * w + eta * w1) * over
        # The output fork stands a quarter turn from the input fork; a line without this joint has none.
        a = (psi + numbers["quarter"][i]) * over + numbers["phase"][i + 1]
    torque = [numbers["kappa"][i] * theta[i] + numbers["loss"][i] * rate[i] for i in range(n)]
    delta, delta1 = [theta[0]], [rate[0]]
    for i in range(n - 1):
        delta.append(gain[i] * delta[i] + theta[i + 1])
        delta1.append(gain[i] * delta1[i] + gain1[i] * delta[i] + rate[i + 1])
    delta2 = []
    for i in range(n):
        push = -torque[i]
        if i < n - 1:
            push = push + gain[i] * torque[i + 1] + by_angle[i] * numbers["mean"][i + 1] * delta[i]
        delta2.append(push * numbers["over_inertia"][i])
    out = [delta2[0]]
    for i in range(n - 1):
        out.append(delta2[i + 1] - gain[i] * delta2[i] - 2 * gain1[i] * delta1[i] - gain2[i] * delta[i])
    return out


def twist_numbers(
    chain: Chain, *, phase_shift: bool = True, torque_term: bool = True, number: Any = float
) -> dict[str, list[Any]]:
    """Numbers of ``twist_slopes``; the two effects of a static torque can be left out one by one."""
    speed = number(chain.speed)
    mean = [number(t) for t in chain.torque()]
    twist = [m / number(k) if phase_shift else number(0) for m, k in zip(mean, chain.stiffness, strict=True)]
    bent = [bool(a) for a in chain.angle]
    return {
        "kappa": [number(k) / speed**2 for k in chain.stiffness],
        "loss": [number(c) / speed for c in chain.damping],
        "over_inertia": [1 / number(j) for j in chain.inertia],
        "mean": [m / speed**2 if torque_term else number(0) for m in mean],
        "phase": [number(f) + t for f, t in zip(chain.fork_offset, twist, strict=True)],
        "plane": [number(p) for p in chain.plane],
        "cosine": [np.cos(number(b)) for b in chain.angle],
        "over_gear": [number(g.denominator) / number(g.numerator) for g in chain.gears],
        "quarter": [number(QUARTER) if b else number(0) for b in bent],
    }


def twist_monodromy(chain: Chain, rtol: float = 1e-13, atol: float = 1e-15, **options: bool) -> Array:
    """Z of the chain in twist coordinates by scipy's DOP853."""
    n = chain.size
    numbers = twist_numbers(chain, **options)

    def slopes(tau: float, flat: Array) -> Array:
        state = flat.reshape(2 * n, 2 * n)
        return np.concatenate([state[n:], twist_slopes(Numpy, numbers, tau, state[:n], state[n:])]).ravel()

    run = solve_ivp(slopes, (0.0, chain.period), np.eye(2 * n).ravel(), method="DOP853", rtol=rtol, atol=atol)
    return run.y[:, -1].reshape(2 * n, 2 * n)


class ExtendedPrecision:
    """Z of chains by heyoka's Taylor integrator in 80-bit arithmetic; compiled once per number of shafts."""

    def __init__(self) -> None:
        self._compiled: dict[int, Any] = {}

    def monodromy(self, chain: Chain) -> NDArray[np.longdouble]:
        """Z (2n, 2n), good to about 1e-17 of its largest entry."""
        n = chain.size
        integrator = self._integrator(n)
        numbers = twist_numbers(chain, number=np.longdouble)
        # The last joint's quarter turn drives nothing, so the compiled system ends before it.
        integrator.pars[:] = np.concatenate([numbers[key] for key in self._keys(n)])[: len(integrator.pars)]
        turns = np.longdouble(round(chain.period / np.pi))
        end = turns * np.arctan(np.longdouble(1)) * 4
        out = np.empty((2 * n, 2 * n), dtype=np.longdouble)
        for column in range(2 * n):
            integrator.time = np.longdouble(0)
            integrator.state[:] = 0
            integrator.state[column] = 1
            integrator.propagate_until(end)
            out[:, column] = integrator.state
        return out

    @staticmethod
    def _keys(n: int) -> dict[str, int]:
        between = dict.fromkeys(("plane", "cosine", "over_gear", "quarter"), n - 1)
        return {**dict.fromkeys(("kappa", "loss", "over_inertia", "mean", "phase"), n), **between}

    def _integrator(self, n: int) -> Any:
        if n not in self._compiled:
            import heyoka as hy

            numbers, place = {}, 0
            for key, count in self._keys(n).items():
                numbers[key] = [hy.par[place + i] for i in range(count)]
                place += count
            theta = hy.make_vars(*(f"theta{i}" for i in range(n)))
            rate = hy.make_vars(*(f"rate{i}" for i in range(n)))
            slopes = twist_slopes(hy, numbers, hy.time, list(theta), list(rate))
            system = [*zip(theta, rate, strict=True), *zip(rate, slopes, strict=True)]
            self._compiled[n] = hy.taylor_adaptive(
                system,
                np.zeros(2 * n, dtype=np.longdouble),
                fp_type=np.longdouble,
                compact_mode=True,
            )
        return self._compiled[n]


def precise_multipliers(matrix: NDArray[np.longdouble], digits: int = 30) -> Complex:
    """Eigenvalues of an extended-precision matrix without the rounding of double precision."""
    import mpmath

    with mpmath.workdps(digits):
        exact = mpmath.matrix(
            [[mpmath.mpf(float(v)) + mpmath.mpf(float(v - np.longdouble(float(v)))) for v in row] for row in matrix]
        )
        values = mpmath.eig(exact, left=False, right=False)
        return np.array([complex(v) for v in values])


def log_det_expected(chain: Chain) -> float:
    """ln det Z by Liouville: −Σ over disks of ∫ (c_i + ⟨g_i²⟩ c_{i+1})/(J_i Ω) dτ, the mean by quadrature."""
    tau = chain.period * np.arange(4096 * 3) / (4096 * 3)
    numbers = twist_numbers(chain)
    a, total = tau + numbers["phase"][0], 0.0
    for i in range(chain.size):
        total += chain.damping[i] / chain.inertia[i]
        if i < chain.size - 1:
            psi, eta, _, _ = joint_law(Numpy, a - numbers["plane"][i], numbers["cosine"][i])
            over = numbers["over_gear"][i]
            total += chain.damping[i + 1] * float(np.mean(eta**2)) * over**2 / chain.inertia[i]
            a = (psi + numbers["quarter"][i]) * over + numbers["phase"][i + 1]
    return -chain.period * total / chain.speed
