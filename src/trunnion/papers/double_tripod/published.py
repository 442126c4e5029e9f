"""S4: the double tripod industrial driveshaft (Bugaru and Vasile, Appl. Sci. 12, 2022, 6182).

Its two outer elements, each a bell (B) and an axle (A), twist against a fixed end; J_B, J_A are the "axial geometric
moments of inertia" of its Appendix A, I = ρ(J_B L_B + J_A L_A), k = G J_A J_B/(J_A L_B + J_B L_A). Then, exactly,

    k/I = Ω² g(φ),   g = (1 + c₁ cos 2φ)/((1 + c₂ cos 2φ)(1 + χ_n cos 2φ)),   Ω of equations (22), (23).

What the paper prints and what is so, each an option here:
- χ_n: 0.0026 and 0.0027 in its section 6 ("printed"); its own Appendix B gives 3.85e-4 and 4.22e-4 ("derived").
- Ī: in c₁…c₄ and M̄/Ī it takes the inertias of the straight shaft (``mean_inertia="straight"``), in Ω those at the
  angle; the identity above needs the latter ("bent").
- The Steiner terms of (A2), (A4) lack sin²β: at β = 0 the axle's J is 180 times its polar moment. The printed
  geometry gives the printed frequencies (``steiner="printed"``); with sin²β they are a third lower ("mended").
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType

import numpy as np

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.laws import tripod
from trunnion.numerics.compiled import kernel_file
from trunnion.systems.system import System
from trunnion.systems.user_functions import CFunction, from_kernel

DENSITY, SHEAR_MODULUS = 7850.0, 77.3e9
"""ρ [kg/m³] and G [Pa] of Tables 1 and 2."""
MIDSHAFT_LENGTH = 0.940
"""L_DM2 [m], Table 1."""
WAVE_SPEED = float(np.sqrt(SHEAR_MODULUS / DENSITY))
WORST_ANGLE = float(np.deg2rad(9.0))
_PHASES = ("given", "own", "turning")
_OPTIONS = {
    "nonuniformity": ("printed", "derived"),
    "mean_inertia": ("bent", "straight"),
    "steiner": ("printed", "mended"),
}


@dataclass(frozen=True)
class OuterElement:
    """One outer element, in the paper's letters: lengths [m], S_B [m²], half_sum = ½(J₁ + J₂) [m⁴], χ_nB.

    torque [N m] and torque_nonuniformity: M̄ and χ of Table 4; mill: driven by the mill, else by the motor.
    """

    name: str
    L_B: float
    L_A: float
    R: float
    d_A: float
    d_C: float
    S_B: float
    half_sum: float
    chi_B: float
    chi_printed: float
    torque: float
    torque_nonuniformity: float
    mill: bool
    steiner: str = "printed"

    def bell(self, angle: float, phi: float | Array | None = None) -> float | Array:
        """J_B(φ) of (A2), (A9) [m⁴]; its φ-mean without ``phi``."""
        s2, steiner = np.sin(angle) ** 2, self.S_B * self.d_C**2
        swing = 0.0 if phi is None else self.chi_B * np.cos(2 * np.asarray(phi)) * s2
        found = self.half_sum * (1 + np.cos(angle) ** 2 + swing) + steiner * self._steiner(s2)
        return float(found) if phi is None else np.asarray(found)

    def axle(self, angle: float) -> float:
        """J_A of (A4), (A11) [m⁴]."""
        own = np.pi * self.d_A**4 / 64 * (1 + np.cos(angle) ** 2)
        steiner = np.pi * self.d_A**2 / 4 * (self.L_B + 0.5 * self.L_A) ** 2
        return float(own + steiner * self._steiner(np.sin(angle) ** 2))

    def _steiner(self, square: float) -> float:
        return square if self.steiner == "mended" else 1.0

    def inertia(self, angle: float, phi: float | Array | None = None) -> float | Array:
        """I(φ) of (A5), (A12) [kg m²]; its φ-mean Ī without ``phi``."""
        return DENSITY * (self.bell(angle, phi) * self.L_B + self.axle(angle) * self.L_A)

    def stiffness(self, angle: float, phi: float | Array | None = None) -> float | Array:
        """k(φ) of (1), (5) [N m/rad]."""
        J_B, J_A = self.bell(angle, phi), self.axle(angle)
        return SHEAR_MODULUS * J_A * J_B / (J_A * self.L_B + J_B * self.L_A)

    def share(self, angle: float) -> float:
        """a = ρ L_A J_A/Ī: the axle's share of the inertia."""
        return float(DENSITY * self.L_A * self.axle(angle) / self.inertia(angle))

    def natural_frequency(self, angle: float) -> float:
        """Ω [rad/s] of (22), (23) at a joint angle [rad]: Figures 9 and 10."""
        a, ratio = self.share(angle), (self.L_A / self.L_B) ** 2
        return float(WAVE_SPEED / self.L_B * np.sqrt((1 - a) / (1 + ratio * (1 / a - 1))))

    def nonuniformity(self, angle: float) -> float:
        """χ_n of (A14), (A15), with the χ_nB that makes I = Ī(1 + χ_n cos 2φ) exact."""
        swing = self.half_sum * self.chi_B * DENSITY * self.L_B * np.sin(angle) ** 2
        return float(swing / self.inertia(angle))

    def joint_amplitude(self, angle: float) -> float:
        """A of (13), (14): amplitude of the tripod's third harmonic [rad]."""
        return float(tripod.amplitude(angle, self.R / MIDSHAFT_LENGTH))


INPUT = OuterElement(
    name="DIE1", L_B=0.190, L_A=0.130, R=0.070, d_A=0.054, d_C=0.098, S_B=0.0076, half_sum=1.4645e-5, chi_B=0.22,
    chi_printed=0.0026, torque=2550.0, torque_nonuniformity=0.05, mill=False,
)  # fmt: skip
"""Table 1 and 4: the driven input element at the motor."""
OUTPUT = OuterElement(
    name="DOE3", L_B=0.209, L_A=0.143, R=0.077, d_A=0.059, d_C=0.108, S_B=0.0092, half_sum=2.1442e-5, chi_B=0.24,
    chi_printed=0.0027, torque=2100.0, torque_nonuniformity=0.15, mill=True,
)  # fmt: skip
"""Table 2 and 4: the driven output element at the mill."""
_ELEMENTS = {"input": INPUT, "output": OUTPUT}


@dataclass(frozen=True)
class DoubleTripod:
    """The paper's driveshaft, as ``tn.catalogue("double-tripod")``.

    Parameters
    ----------
    angle : joint angle of both joints [rad], 9° by default.
    damping_ratio : ζ [1], 0.0016 to 0.0318.
    nonuniformity : χ_n "printed" or "derived" (see the module); a number sets it for both elements.
    mean_inertia : Ī and J_A in c₁…c₄ at the angle ("bent") or of the straight shaft ("straight", as the paper).
    steiner : "printed" or "mended".
    motor_order : n of Ω_AEM = 100nπ; motor_frequency [rad/s] sets another value.

    >>> shaft = DoubleTripod()
    >>> round(shaft.element("input").natural_frequency(shaft.angle), 1)
    9633.7
    """

    angle: float = WORST_ANGLE
    damping_ratio: float = 0.0016
    nonuniformity: str | float = "printed"
    mean_inertia: str = "bent"
    steiner: str = "printed"
    motor_order: int = 6
    motor_frequency: float | None = None
    elements: Mapping[str, OuterElement] = field(default_factory=lambda: dict(_ELEMENTS), repr=False)

    def __post_init__(self) -> None:
        if not 0 <= self.angle < np.pi / 2:
            raise InputError(
                "must lie between 0 and 90 degrees", element="double-tripod", key="angle", value=self.angle
            )
        if not (np.isfinite(self.damping_ratio) and self.damping_ratio >= 0):
            raise InputError(
                "must not be negative", element="double-tripod", key="damping_ratio", value=self.damping_ratio
            )
        for key, known in _OPTIONS.items():
            value = getattr(self, key)
            number = key == "nonuniformity" and isinstance(value, int | float) and 0 <= value < 1
            if not number and value not in known:
                remedy = f"write {' or '.join(map(repr, known))}" + (
                    ", or a number from 0 to 1" if key == "nonuniformity" else ""
                )
                raise InputError("is not an option", element="double-tripod", key=key, value=value, remedy=remedy)
        if not self.motor > 0:
            raise InputError("must be positive", element="double-tripod", key="motor_frequency", value=self.motor)

    @property
    def motor(self) -> float:
        """Ω_AEM [rad/s], equation (7)."""
        return self.motor_frequency if self.motor_frequency is not None else 100 * self.motor_order * float(np.pi)

    @property
    def _mean_angle(self) -> float:
        return 0.0 if self.mean_inertia == "straight" else self.angle

    def element(self, which: str) -> OuterElement:
        """The "input" or the "output" element.

        Raises
        ------
        InputError : another word.
        """
        if which not in self.elements:
            raise InputError(
                "is not an element", element="double-tripod", key="element", value=which,
                remedy='write "input" or "output"',
            )  # fmt: skip
        return replace(self.elements[which], steiner=self.steiner)

    def chi(self, which: str) -> float:
        """χ_n of an element as chosen."""
        part = self.element(which)
        if isinstance(self.nonuniformity, str):
            return part.chi_printed if self.nonuniformity == "printed" else part.nonuniformity(self.angle)
        return float(self.nonuniformity)

    def coefficients(self, which: str) -> tuple[float, float]:
        """c₁, c₂ (or c₃, c₄) of Appendix B."""
        part, chi = self.element(which), self.chi(which)
        a = part.share(self._mean_angle)
        ratio = (part.L_A / part.L_B) ** 2
        return chi / (1 - a), ratio * (chi / a) / (1 + ratio * (1 / a - 1))

    def depth(self, which: str) -> float:
        """ε = c₁ − c₂ − χ_n, to first order the depth of g: the principal parametric resonance needs ε > 4ζ."""
        c1, c2 = self.coefficients(which)
        return c1 - c2 - self.chi(which)

    def midshaft_frequencies(self, count: int = 5) -> Array:
        """ν_k = k c_s/(2L) [Hz] of the midshaft (24), Table 3."""
        return np.asarray(np.arange(1, count + 1) * WAVE_SPEED / (2 * MIDSHAFT_LENGTH), dtype=float)

    def system(self, which: str = "input", *, phase: str = "given", excitation: float | None = None) -> System:
        """The equations of one element as a ``System``.

        Parameters
        ----------
        which : "input" (25), (29) or "output" (26), (30).
        phase : "given" for (29), (30), states rotation, phase, rate, with the phase running at ``excitation``
            [rad/s], by default 2Ω; "own" for (25), (26), states rotation and rate; "turning" as "given", with half the
            phase for the rotation in every cosine and sine, as (27) and (28) have it.

        The forcing period is that of Ω_AEM; the output element has none. Parameters: damping_ratio, excitation,
        torque, nonuniformity and those of the module; a change of one leaves the others as they are.
        """
        if phase not in _PHASES:
            raise InputError(
                "is not a phase", element="double-tripod", key="phase", value=phase,
                remedy=f"write {' or '.join(map(repr, _PHASES))}",
            )  # fmt: skip
        part = self.element(which)
        omega = part.natural_frequency(self.angle)
        c1, c2 = self.coefficients(which)
        sign = -1.0 if part.mill else 1.0
        acceleration = sign * part.torque / float(part.inertia(self._mean_angle))
        values = {
            "damping_ratio": self.damping_ratio, "natural_frequency": omega, "stiffness_nonuniformity": c1,
            "series_nonuniformity": c2, "inertia_nonuniformity": self.chi(which), "torque_over_inertia": acceleration,
            "torque_nonuniformity": part.torque_nonuniformity, "motor_frequency": self.motor,
            "joint_amplitude": part.joint_amplitude(self.angle), "mill": float(part.mill),
            "excitation": 2 * omega if excitation is None else float(excitation),
        }  # fmt: skip
        size = abs(acceleration) / omega**2
        given = phase != "own"
        scale = [size, 1.0, size * omega] if given else [size, size * omega]
        start = np.zeros(3 if given else 2)
        return System(
            name=f"double tripod, {which} element, {phase} phase",
            states=("rotation", "phase", "rate") if given else ("rotation", "rate"),
            units=("rad", "rad", "rad/s") if given else ("rad", "rad/s"),
            rate=_function(f"{phase}_phase"),
            parameters=values,
            parameter_units={"natural_frequency": "rad/s", "motor_frequency": "rad/s", "excitation": "rad/s"},
            period=None if part.mill else _motor_period,
            start=start,
            scale=np.array(scale),
        )

    def __str__(self) -> str:
        lines = [f"double tripod driveshaft at {np.rad2deg(self.angle):.4g}°, ζ = {self.damping_ratio:g}"]
        for which in self.elements:
            part = self.element(which)
            omega = part.natural_frequency(self.angle)
            lines.append(
                f"  {which} element {part.name}: natural frequency {omega:.6g} rad/s, excited at "
                f"{omega / np.pi:.6g} Hz, χ_n = {self.chi(which):.4g}, parametric depth {self.depth(which):.3g} "
                f"(opens the resonance below ζ = {self.depth(which) / 4:.2g})"
            )
        return "\n".join(lines)


def double_tripod(**changes: object) -> DoubleTripod:
    """The paper's driveshaft; keyword arguments as of ``DoubleTripod``."""
    return DoubleTripod(**changes)  # type: ignore[arg-type]


def _motor_period(p: Mapping[str, float]) -> float:
    return 2 * np.pi / p["motor_frequency"] if p["motor_frequency"] > 0 else np.nan


def _kernel() -> ModuleType:
    return kernel_file(str(Path(__file__).with_name("double_tripod_kernel.py")))


def _function(name: str) -> CFunction:
    return from_kernel(_kernel, name)
