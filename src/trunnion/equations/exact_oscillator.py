"""Two inertias and one spring with stages as one equation, whose motion is then exact stage by stage.

Of a gear pair the unknown is u = r₁φ₁ − r₂φ₂ − e, the deflection along the line of action, after Rezaee and
Farshidianfar, equations (2) to (8): with driving torques M on either side

    I u″ + c u′ + k f(u) = I (M₁r₁/I₁ − M₂r₂/I₂ − e″),   1/I = r₁²/I₁ + r₂²/I₂.

Of a shaft with stages it is the twist q = φ₂ − φ₁, the same with r₁ = r₂ = −1 and no e. A ConstantSpeed is an infinite
inertia. The mean rotation drops out: it follows from the sum of the torques.
"""

from __future__ import annotations

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk
from trunnion.driveline.gears import GearPair
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_regimes import staged_damping
from trunnion.equations.sliders import NOT_FOLLOWED, refuse_friction
from trunnion.equations.stage_laws import has_stages, stage_law
from trunnion.equations.staged_line import common_frequency, staged_line
from trunnion.errors import InputError
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def exact_oscillator(line: Driveline, speed: float | str | None = None) -> PiecewiseOscillator:
    """The oscillator of a line [Disk or ConstantSpeed, GearPair or PiecewiseShaft, Disk].

    Parameters
    ----------
    line : of these three elements.
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

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseShaft(stiffnesses=[1e4, 0.0, 1e4], breakpoints=[-0.01, 0.01], damping=2.0)
    >>> one = tn.exact_oscillator(tn.Driveline([tn.ConstantSpeed(), gap, tn.Disk(inertia=0.5, load_torque=10.0)]))
    >>> one.inertia, one.breakpoints, one.mean_force
    (0.5, (-0.01, 0.01), -10.0)
    """
    spring = _three(line)
    exact, assembly = staged_line(line, speed), assemble(line)
    # From the twist of the output gear to the deflection, which point against each other.
    over = -spring.radii[1] if isinstance(spring, GearPair) else 1.0
    inertia = float(1 / (over**2 * exact.inverse[0, 0]))
    law = stage_law(line, 1, assembly.packed.column, assembly.table(1))
    damping = staged_damping(assembly, assembly.packed.values, 1, law) / over**2
    knots, slopes = over * law.knots[0], law.slopes[0] / over**2
    if over < 0:
        knots, slopes = knots[::-1], slopes[::-1]
    flow = exact.flow()
    mean, parts = inertia * over * float(flow.constant[0]), []
    for frequency, force in zip(flow.frequencies, inertia * over * flow.force[:, 0], strict=True):
        if frequency:
            parts.append((abs(float(frequency)), complex(force if frequency > 0 else force.conjugate())))
        else:
            mean += float(force.real)
    base = common_frequency(sorted({frequency for frequency, _ in parts})) if parts else 1.0
    first = sum(force.real for frequency, force in parts if round(frequency / base) == 1)
    orders = [(round(frequency / base), force) for frequency, force in parts]
    harmonics = [(order, force.real if order > 1 else 0.0, -force.imag) for order, force in orders]
    return PiecewiseOscillator(
        tuple(map(float, knots)), tuple(map(float, slopes)), damping, mean, first, base,
        inertia=inertia, damping_law=spring.damping_law if len(knots) else "always",
        harmonics=tuple(h for h in harmonics if h[1] or h[2]), name=line.name or line.names[1],
        speed_unit=speed_unit(line),
    )  # fmt: skip


def _three(line: Driveline) -> GearPair | PiecewiseShaft:
    """The spring between two inertias.

    Raises
    ------
    InputError : another kind of line.
    """
    elements = line.elements
    if (
        len(elements) != 3
        or not isinstance(elements[0], Disk | ConstantSpeed)
        or not has_stages(elements[1])
        or elements[1].inertia_values
        or not isinstance(elements[2], Disk)
        or line.parents != (None, 0, 1)
    ):
        raise InputError(
            "is not one spring with stages between two inertias", element="driveline",
            remedy="write [Disk or ConstantSpeed, GearPair or PiecewiseShaft, Disk]; longer lines take "
            "tn.exact_motion, tn.piecewise_orbit and tn.simulate",
        )  # fmt: skip
    refuse_friction(line, NOT_FOLLOWED, "use tn.exact_motion, tn.piecewise_orbit or tn.sweep of the line itself")
    for place in (0, 2):
        if load := getattr(elements[place], "viscous_load", 0.0):
            raise InputError(
                "depends on the speed, which the one equation does not have", element=line.names[place],
                key="viscous_load", value=load, remedy="write its mean as load_torque",
            )  # fmt: skip
    assert isinstance(elements[1], GearPair | PiecewiseShaft)
    return elements[1]
