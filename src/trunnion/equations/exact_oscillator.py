"""Two inertias and one spring with stages as one equation, whose motion is then exact stage by stage.

Of a gear pair the unknown is u = r₁φ₁ − r₂φ₂ − e, the deflection along the line of action, after Rezaee and
Farshidianfar, equations (2) to (8): with driving torques M on either side

    I u″ + c u′ + k f(u) = I (M₁r₁/I₁ − M₂r₂/I₂ − e″),   1/I = r₁²/I₁ + r₂²/I₂.

Of a shaft with stages it is the twist q = φ₂ − φ₁, the same with r₁ = r₂ = −1 and no e. A ConstantSpeed is an infinite
inertia. The mean rotation drops out: it follows from the sum of the torques.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from trunnion.driveline.arguments import one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk
from trunnion.driveline.gears import GearPair
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import assemble
from trunnion.equations.harmonic_torques import cylinders
from trunnion.equations.sliders import NOT_FOLLOWED, refuse_friction
from trunnion.equations.stage_laws import has_stages, spring_damping, stage_law
from trunnion.errors import InputError
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

MOST_ORDER = 200
"""Highest harmonic of the common frequency of all torques and errors."""
Parts = list[tuple[float, complex]]
"""Harmonic forces by frequency [rad/s]: Re(amplitude · e^{iωt})."""


def exact_oscillator(line: Driveline, speed: float | str | None = None) -> PiecewiseOscillator:
    """The oscillator of a line [Disk or ConstantSpeed, GearPair or PiecewiseShaft, Disk].

    Parameters
    ----------
    speed : mean input speed [rad/s], by which mesh phases and orders turn into frequencies; by default that of the
        line's operation.

    Returns
    -------
    PiecewiseOscillator with x = u [m] and inertia I [kg] of a gear pair, x = twist [rad] and inertia [kg m²] of a
    shaft; its frequency is the common one of all that excites it, or 1 rad/s where nothing does. Torques by order and
    mesh phases are taken at the mean rotation.

    Raises
    ------
    InputError : another kind of line, loads that depend on the speed, a mesh stiffness that varies, impact damping,
        harmonics without a common frequency, no speed where one is needed.
    """
    front, spring, back = _three(line)
    near, far = (np.inf if isinstance(e, ConstantSpeed) else e.moment_of_inertia for e in (front, back))
    r1, r2 = spring.radii if isinstance(spring, GearPair) else (-1.0, -1.0)
    inertia = 1 / (r1**2 / near + r2**2 / far)
    turning = Turning(line, speed)
    mean, parts = 0.0, Parts()
    gearing = 1 / spring.speed_ratio if isinstance(spring, GearPair) else 1.0
    for disk, lever, rate in ((front, r1 / near, 1.0), (back, -r2 / far, gearing)):
        if isinstance(disk, Disk):
            mean -= inertia * lever * disk.load_torque
            for h in disk.excitation:
                if h.amplitude is None:
                    raise InputError(
                        "has an amplitude that depends on the speed or the load", element="driveline",
                        key="excitation", remedy="use tn.periodic_response or tn.order_response",
                    )  # fmt: skip
                frequency = h.frequency if h.frequency is not None else (h.order or 0.0) * rate * turning.speed(h)
                parts.append((frequency, inertia * lever * h.amplitude * np.exp(1j * h.phase) * cylinders(disk, h)))
    if isinstance(spring, GearPair):
        for e in spring.transmission_error:
            frequency = e.order * (spring.teeth_in or 0) * turning.speed(e)
            # −I e″
            parts.append((frequency, inertia * frequency**2 * e.amplitude * np.exp(1j * e.phase)))
    return _oscillator(line, spring, inertia, mean, parts)


def _three(line: Driveline) -> tuple[Disk | ConstantSpeed, GearPair | PiecewiseShaft, Disk]:
    elements = line.elements
    if (
        len(elements) != 3
        or not isinstance(elements[0], Disk | ConstantSpeed)
        or not has_stages(elements[1])
        or not isinstance(elements[2], Disk)
        or line.parents != (None, 0, 1)
    ):
        raise InputError(
            "is not one spring with stages between two inertias", element="driveline",
            remedy="write [Disk or ConstantSpeed, GearPair or PiecewiseShaft, Disk]; longer lines take "
            "tn.exact_motion, tn.piecewise_orbit and tn.simulate",
        )  # fmt: skip
    refuse_friction(line, NOT_FOLLOWED, "use tn.exact_motion, tn.piecewise_orbit or tn.sweep of the line itself")
    front, spring, back = elements
    assert isinstance(front, Disk | ConstantSpeed) and isinstance(back, Disk)
    assert isinstance(spring, GearPair | PiecewiseShaft)
    for place in (0, 2):
        for key in ("viscous_load", "quadratic_load"):
            if getattr(elements[place], key, 0.0):
                raise InputError(
                    "depends on the speed, which the one equation does not have", element=line.names[place], key=key,
                    value=getattr(elements[place], key), remedy="write its mean as load_torque",
                )  # fmt: skip
    if isinstance(spring, GearPair) and spring.stiffness_variation:
        raise InputError(
            "makes the stages vary in time, so that no motion is exact", element=line.names[1],
            key="stiffness_variation", remedy="use tn.periodic_branch or tn.harmonic_balance",
        )  # fmt: skip
    if isinstance(spring, GearPair) and spring.impact_damping:
        raise InputError(
            "goes with the depth of contact, so that no stage is linear", element=line.names[1], key="impact_damping",
            value=spring.impact_damping, remedy="use tn.periodic_branch or tn.harmonic_balance",
        )  # fmt: skip
    return front, spring, back


class Turning:
    """The mean input speed, asked for only where something depends on it."""

    def __init__(self, line: Driveline, speed: float | str | None) -> None:
        own = line.operation.speed if line.operation else None
        self.given = own if speed is None else one_speed(speed, "speed")

    def speed(self, needed_by: object) -> float:
        if self.given is None or not (np.isfinite(self.given) and self.given > 0):
            raise InputError(
                f"is needed by the {type(needed_by).__name__}, which turns with the gears", key="speed",
                value=self.given, remedy="give speed=tn.rpm(1500), say",
            )  # fmt: skip
        return self.given


def _oscillator(
    line: Driveline, spring: GearPair | PiecewiseShaft, inertia: float, mean: float, parts: Parts
) -> PiecewiseOscillator:
    assembly = assemble(line)
    table, column = assembly.table(1), assembly.packed.column
    law = stage_law(line, 1, column, table)
    if line.damping_ratio is not None:
        damping = float(assembly.common_damping(table, law.slopes.max(axis=1))[0])
    else:
        damping = float(spring_damping(spring, 1, column, table)[0])
    knots, slopes = law.knots[0], law.slopes[0]
    if isinstance(spring, GearPair):
        # From torque over twist of the output gear to force over deflection, which point against each other.
        out = spring.radii[1]
        knots, slopes, damping = -out * knots[::-1], slopes[::-1] / out**2, damping / out**2
    base = common_frequency(sorted({frequency for frequency, _ in parts}))
    first, harmonics = 0.0, []
    for frequency, amplitude in parts:
        order = round(frequency / base)
        if order == 1:
            first += amplitude.real
            harmonics.append((1, 0.0, -amplitude.imag))
        else:
            harmonics.append((order, amplitude.real, -amplitude.imag))
    return PiecewiseOscillator(
        tuple(map(float, knots)), tuple(map(float, slopes)), damping, mean, first, base,
        inertia=inertia, damping_law=spring.damping_law if len(knots) else "always",
        harmonics=tuple(h for h in harmonics if h[1] or h[2]), name=line.name or line.names[1],
        speed_unit=speed_unit(line),
    )  # fmt: skip


def common_frequency(frequencies: list[float]) -> float:
    """The frequency [rad/s] that all are multiples of; 1 where there is none.

    Raises
    ------
    InputError : none of usable size.
    """
    if not frequencies:
        return 1.0
    ratios = [Fraction(f / frequencies[0]).limit_denominator(MOST_ORDER) for f in frequencies]
    steps = np.lcm.reduce([r.denominator for r in ratios])
    base = frequencies[0] / float(steps)
    if any(abs(f / base - round(f / base)) > 1e-9 * f / base or f / base > MOST_ORDER for f in frequencies):
        raise InputError(
            "have no common period of usable length", element="driveline", key="excitation",
            value=[float(f) for f in frequencies], remedy="round the frequencies to a common step",
        )  # fmt: skip
    return base
