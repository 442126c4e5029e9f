"""Linear steady response of a line at every speed to every excitation order.

Excited by the harmonic torques of its disks (by order of their rotation, in time, or both), by the transmission errors
of its meshes, and by its angled joints. A straight line is one complex system per order and speed; in a line with bent
joints an order k couples to k ± 2mR, R the speed ratio of the joint, and is solved with its side orders.

Orders are taken at the angle that their disk has in the base motion (joints' lead and static twist included). How far
it swings about that is said: a torque T e^{ikφ} has the slope ikT e^{ikφ}, whose product with the motion is of second
order, as all that linear theory leaves out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Codes, Complex, Places
from trunnion.driveline.arguments import numbers, speeds_of
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.operating_speed import settled_speeds, speed_unit
from trunnion.driveline.shafts import Shaft
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import disk_torques, line_harmonics
from trunnion.equations.loads import load_slope, station_loads
from trunnion.equations.steady_base import has_joint_angles, has_periodic_base
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.stability.stable_speeds import verdicts_at
from trunnion.response.orders.result import WORTH_SHOWING, OrderResponse
from trunnion.results.finding import Finding, Gravity
from trunnion.results.units import figures
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.steady.orders.amplitudes import OrderSpectrum, joined
from trunnion.steady.orders.forced_response import shaft_names
from trunnion.steady.orders.spectrum import order_spectrum

if TYPE_CHECKING:
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

TORQUE_LIMITS = ("vibratory_torque", "transient_vibratory_torque", "max_torque")
NEAR_ENOUGH, ROUNDING = 1e-9, 1e-12
"""Orders asked for are found within this."""


def order_response(
    line: Driveline | Assembly,
    speeds: ArrayLike,
    orders: Iterable[float] | None = None,
    load_case: str | None = None,
    *,
    statically_twisted: bool = True,
    progress: Callable[[float], None] | None = None,
) -> OrderResponse:
    """Torque, twist and rotation by order at each of ``speeds`` [rad/s]; see ``sweep_speeds`` for a grid.

    Parameters
    ----------
    line : the driveline.
    speeds : input speed or speeds [rad/s].
    orders : cycles per turn of the input to list; default all that reach a millionth of the largest torque. The sums
        over the cycle hold every order whatever is listed.
    load_case : name of one of the line's load cases.
    statically_twisted : joint phases include the twist under the mean torque.
    progress : called as progress(share done).

    Raises
    ------
    InputError : speeds or orders that are not positive; a line without steady base motion or with too long a period.
    ComputationError : a free–free line with joint angles has no periodic motion at a speed, or several.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> line = tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)])
    >>> r = tn.order_response(line, [100.0])
    >>> print(r.order, round(float(r.vibratory_torque[0, 0]), 3))
    [2.] 221.04
    """
    assembly = assemble(line, load_case)
    remedy = "np.linspace(tn.rpm(300), tn.rpm(3000), 301)"
    speed = settled_speeds(assembly.line, _positive(speeds_of(speeds, remedy), "speeds", remedy))
    wanted = _listed(orders)
    twisted, motions = statically_twisted, one_motion_each(assembly, speed, steady_states_of(assembly))
    spectrum = order_spectrum(assembly, speed, statically_twisted=twisted, motions=motions, progress=progress)
    judged = partial(verdicts_at, assembly, speed, statically_twisted=twisted, motions=motions)
    return _result(assembly, spectrum, judged, wanted)


def completed_response(
    assembly: Assembly,
    known: OrderSpectrum,
    speeds: Array,
    orders: Iterable[float] | None = None,
    *,
    motions: SteadyStatesBySpeed | None = None,
    progress: Callable[[float], None] | None = None,
) -> OrderResponse:
    """As ``order_response`` at rising ``speeds``, of which those of ``known`` are not solved again."""
    speed = settled_speeds(assembly.line, speeds)
    place = np.flatnonzero(np.isin(known.speed, speed) & (np.diff(known.speed, prepend=-np.inf) > 0))
    missing = np.setdiff1d(speed, known.speed)
    parts = [known if len(place) == len(known.speed) else known.take(place)]
    if len(missing):
        parts.append(order_spectrum(assembly, missing, motions=motions, progress=progress))
    del known
    return _result(assembly, joined(parts)[0], partial(verdicts_at, assembly, speed, motions=motions), _listed(orders))


def steady_states_of(assembly: Assembly) -> SteadyStatesBySpeed | None:
    """For the motions that a free–free line with joint angles is taken about, each solved once; None for other
    lines."""
    if not has_periodic_base(assembly):
        return None
    # Loaded for lines that need it: it brings the compiler and the orbits with it.
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

    return SteadyStatesBySpeed(assembly.line)


def one_motion_each(
    assembly: Assembly, speeds: Array, motions: SteadyStatesBySpeed | None, *, between: bool = False
) -> SteadyStatesBySpeed | None:
    """``motions``, of which no speed (speed,) [rad/s] has several, none ``between`` them either where they stand for
    a range; see ``steady.free.several_motions``.

    Raises
    ------
    ComputationError : the motions fold back, and several have one of the speeds.
    """
    if motions is None or motions.obstacle:
        return motions
    table = assembly.table(1)
    table[:, 0] = speeds[0]
    if not assembly.coefficients(table, any_frequency=True).loss.any():  # with a loss factor about rigid shafts
        from trunnion.steady.free.several_motions import require_one_motion_each

        require_one_motion_each(motions, assembly.line, speeds, between=between)
    return motions


def response_about(
    assembly: Assembly, speeds: Array, motions: SteadyStatesBySpeed | None = None, *, rough: bool = False
) -> OrderResponse:
    """As ``order_response``, its verdicts not judged, about ``motions`` that may be known already.

    ``rough`` : to look around, right to first order in what joints and varying meshes force, a fraction of the time.

    Raises
    ------
    InputError : as of ``order_response``.
    """
    return response_of_spectrum(assembly, order_spectrum(assembly, speeds, rough=rough, motions=motions))


def response_of_table(assembly: Assembly, table: Array) -> OrderResponse:
    """The response of one case a row of packed numbers ``table`` (case, column), each at its own speed.

    Stresses are NaN, as diameters may differ from row to row, and verdicts are not judged.

    Raises
    ------
    InputError : see ``order_spectrum``.
    """
    found = response_of_spectrum(assembly, order_spectrum(assembly, table[:, 0], table=table))
    return replace(found, stress_factor=np.full_like(found.stress_factor, np.nan))


def response_of_spectrum(assembly: Assembly, spectrum: OrderSpectrum, *, remarked: bool = True) -> OrderResponse:
    """The response that holds a ``spectrum``; its verdicts are not judged. Not ``remarked``: its numbers alone, for
    searches that ask for hundreds."""
    failed = np.full(len(spectrum.speed), Verdict.FAILED, dtype=np.int8)
    return _result(assembly, spectrum, lambda: failed, None, remarked=remarked)


def _positive(values: Any, key: str, remedy: str) -> Array:
    found = numbers(values, key, remedy)
    if not (np.all(np.isfinite(found)) and np.all(found > 0)):
        raise InputError("must be positive and finite", key=key, remedy=remedy)
    return found


def _listed(orders: Iterable[float] | None) -> Array | None:
    if orders is None:
        return None
    given = list(orders) if isinstance(orders, Iterable) and not isinstance(orders, str) else orders
    return np.unique(_positive(given, "orders", "orders=[0.5, 1, 2], say"))


def _result(
    assembly: Assembly,
    spectrum: OrderSpectrum,
    judged: Callable[[], Codes],
    wanted: Array | None,
    *,
    remarked: bool = True,
) -> OrderResponse:
    places, topo = spectrum.channels, assembly.topology
    size = np.abs(spectrum.amplitude[..., places.torque])
    if wanted is None:
        with np.errstate(invalid="ignore"):
            listed = np.any(~(size < WORTH_SHOWING * np.nanmax(size, initial=0.0)) & (size != 0), axis=(0, 2))
        picked = np.flatnonzero(listed)
        order, frequency = spectrum.order_numbers[picked], spectrum.frequency[picked]
    else:
        order, frequency = wanted, np.zeros(len(wanted))
        apart = np.abs(spectrum.order_numbers - wanted[:, None]) + np.where(spectrum.frequency != 0, np.inf, 0.0)
        nearest = apart.argmin(axis=1) if apart.shape[1] else np.zeros(len(wanted), dtype=int)
        missing = apart.min(axis=1, initial=np.inf) > NEAR_ENOUGH
        picked = np.where(missing, -1, nearest)
    amplitude, base = _picked(spectrum.amplitude, picked), _picked(spectrum.base, picked)
    unexcited = order[picked < 0] if wanted is not None else np.zeros(0)
    return OrderResponse(
        speed=spectrum.speed,
        order=order,
        frequency=frequency,
        torque=amplitude[..., places.torque],
        twist=amplitude[..., places.twist],
        rotation=amplitude[..., places.point] + base,
        mean_torque=spectrum.mean[:, places.torque],
        mean_twist=spectrum.mean[:, places.twist],
        springs=shaft_names(assembly),
        inertias=tuple(name for _, name in topo.points),
        joints=tuple(assembly.line.names[topo.stations[j].element] for j in topo.joints),
        stress_factor=assembly.derived(_stress_factor),
        spectrum=spectrum,
        judged=judged,
        remarks=tuple(_remarks(assembly, spectrum, unexcited)) if remarked else (),
        unit=speed_unit(assembly.line),
        limits=assembly.derived(_limits),
        rated=tuple(has_rating(assembly, c) for c in range(len(topo.compliances))),
    )


def _limits(assembly: Assembly) -> dict[str, dict[str, float]]:
    """Limits of torque by spring and name; of shafts in series the smallest."""
    names, found = assembly.line.names, {}
    for spring, compliance in zip(shaft_names(assembly), assembly.topology.compliances, strict=True):
        own: dict[str, float] = {}
        members = [names[i] for i in compliance.shafts]
        for one in assembly.line.limits_by_element:
            if one.element in members and one.key in TORQUE_LIMITS:
                key = one.key.replace("_", " ")
                own[key] = min(own.get(key, float("inf")), float(one.value))
        found[spring] = own
    return found


def has_rating(assembly: Assembly, spring: int) -> bool:
    """Whether a spring holds a coupling that states T_KW."""
    members = [assembly.line.elements[i] for i in assembly.topology.compliances[spring].shafts]
    return any(isinstance(one, Coupling) and one.vibratory_torque is not None for one in members)


def _picked(values: Complex, places: Places) -> Complex:
    """The columns at ``places``, zeros where one is −1."""
    found = np.zeros((len(values), len(places), values.shape[2]), dtype=complex)
    there = places >= 0
    found[:, there] = values[:, places[there]]
    return found


def _stress_factor(assembly: Assembly) -> Array:
    """r_o/J_p (spring,) [1/m³] of the most stressed tube of each spring; NaN where none has a diameter."""
    factors = []
    for compliance in assembly.topology.compliances:
        found = []
        for i in compliance.shafts:
            shaft = assembly.line.elements[i]
            if isinstance(shaft, Shaft) and shaft.outer_diameter:
                found.append(tube_stress(shaft.outer_diameter, shaft.inner_diameter or 0.0))
        factors.append(max(found, default=np.nan))
    return np.array(factors)


def _remarks(assembly: Assembly, spectrum: OrderSpectrum, unexcited: Array) -> Iterator[Finding]:
    if not any(one.acts for one in line_harmonics(assembly)):
        joints = " but its joints" if has_joint_angles(assembly) else ""
        yield Finding(Gravity.NOTE, f"Nothing excites this line{joints}.")
    for order in unexcited:
        yield Finding(Gravity.NOTE, f"Nothing excites order {order:g}.")
    if has_periodic_base(assembly) and spectrum.loss.any():
        yield Finding(
            Gravity.NOTE,
            "A loss factor without a frequency has no motion in time: this free–free line with joint angles is taken "
            "about the motion of its rigid shafts, right to first order in what joints and excitations force.",
        )
    yield from _many_side_orders(spectrum)
    yield from _falls_away(assembly, spectrum)
    yield from _wound_up(assembly, spectrum.speed)
    yield from _nominal_angle(assembly, spectrum)
    yield from _swing_of_clutches(assembly, spectrum)
    yield from assembly.derived(_left_out)


def _many_side_orders(spectrum: OrderSpectrum) -> Iterator[Finding]:
    """How many side orders steep joints ask for, and whether those taken suffice."""
    left = float(np.nanmax(spectrum.cut_off, initial=0.0))
    if spectrum.side_orders < MANY_SIDE_ORDERS and left <= ENOUGH:
        return
    taken = f"{spectrum.side_orders} side orders on either side of every excitation are solved for"
    yield Finding(
        Gravity.NOTE if left <= ENOUGH else Gravity.CAUTION,
        f"Joint angles or varying meshes make slowly falling side orders: {taken}, of which the outermost have "
        f"{figures(left, 2)} of the largest torque{'' if left <= ENOUGH else ', the error of what is left out'}.",
    )


def _left_out(assembly: Assembly) -> tuple[Finding, ...]:
    return left_out("order_response", assembly.line)


def _falls_away(assembly: Assembly, spectrum: OrderSpectrum) -> Iterator[Finding]:
    """A free–free line whose torques drive away what turns faster than the mean speed."""
    topo = assembly.topology
    if not topo.free or topo.graph:
        return
    loads = station_loads(topo, assembly.packed.column, assembly.table(len(spectrum.speed), spectrum.speed))
    slope = load_slope(topo, loads.viscous, loads.quadratic, spectrum.speed) * topo.mean_speeds**2
    total = slope.sum(axis=1)
    worst = int(total.argmin())
    if total[worst] < -ROUNDING * np.abs(slope).max():
        names = [name for (s, _), (name, _) in zip(topo.disks, topo.rotors, strict=True) if slope[worst, s] < 0]
        yield Finding(
            Gravity.CAUTION,
            f"Nothing keeps the mean speed, at {Words(speed_unit(assembly.line)).speed(float(spectrum.speed[worst]))} "
            f"least: what resists falls with it by {-total[worst]:.4g} N m s/rad at the input "
            f"({', '.join(dict.fromkeys(names))}). Give the drive a torque that falls more steeply: the gain of a "
            "controller, a smaller slip.",
        )


def _wound_up(assembly: Assembly, speed: Array) -> Iterator[Finding]:
    """What ratios of a loop that do not come out do, where something slips."""
    torque, topo = assembly.wind_up(assembly.table(len(speed), speed)), assembly.topology
    if not torque.any():
        return
    e = int(np.argmax(np.abs(topo.apart)))
    near = float(topo.speed_ratio[topo.compliances[e].near])
    most = np.abs(torque).max(axis=0)
    yield Finding(
        Gravity.CAUTION,
        f"Both ways round to the far end of {assembly.line.names[topo.compliances[e].shafts[0]]} have ratios "
        f"{100 * abs(topo.apart[e] / near):.3g} % apart: its slip winds the line up by {most.max():.4g} N m, most in "
        f"{shaft_names(assembly)[int(most.argmax())]}, whatever the load; mean torques count it.",
    )


def _swing_of_clutches(assembly: Assembly, spectrum: OrderSpectrum) -> Iterator[Finding]:
    """Clutches that swing otherwise in the response than where their mean was taken."""
    swing = np.abs(spectrum.amplitude[..., spectrum.channels.twist]).sum(axis=1)
    for place, element in enumerate(assembly.line.elements):
        if not isinstance(element, Clutch) or element.linear_amplitude is None:
            continue
        own = next(e for e, c in enumerate(assembly.topology.compliances) if place in c.shafts)
        reached, stated = float(np.nanmax(swing[:, own], initial=0.0)), element.linear_amplitude
        if not stated / ALIKE_SWING <= reached <= stated * ALIKE_SWING:
            yield Finding(
                Gravity.CAUTION,
                f"{assembly.line.names[place]} swings by up to ± {np.rad2deg(reached):.3g} deg in this response, but "
                f"counts by its mean over ± {np.rad2deg(stated):.3g} deg: give linear_amplitude = "
                f'"{np.rad2deg(reached):.2g} deg" and ask again.',
            )


def swing_of_torques(assembly: Assembly, spectrum: OrderSpectrum) -> tuple[float, str]:
    """How far the disk swings, times its order [rad], whose torque that shifts most to other orders, as its angle is
    taken at the mean; and its name."""
    topo, worst = assembly.topology, (0.0, "")
    swing = np.abs(spectrum.amplitude[..., spectrum.channels.deviation]).sum(axis=1)
    for torque in disk_torques(assembly):
        if torque.acts and torque.order:
            i = topo.unknown_of[torque.station]
            worst = max(worst, (abs(torque.own_order) * float(np.nanmax(swing[:, i], initial=0.0)), torque.name))
    return worst


def _nominal_angle(assembly: Assembly, spectrum: OrderSpectrum) -> Iterator[Finding]:
    """How far the disks swing whose orders are taken at their mean angle."""
    worst = swing_of_torques(assembly, spectrum)
    if worst[0] > 0:
        grave = worst[0] > LARGEST_SWING
        check = " Run linearity-check." if grave else ""
        yield Finding(
            Gravity.CAUTION if grave else Gravity.NOTE,
            f"Torque is applied at the mean angle of {worst[1]}; its swing can shift up to "
            f"{figures(100 * worst[0], 2)} % of it to other orders.{check}",
        )


MANY_SIDE_ORDERS = 40
"""Side orders from which their number is said: a Hooke's joint at some 70°."""
ENOUGH = 1e-6
"""Share of the largest torque up to which outermost side orders are no error worth a word."""
ALIKE_SWING = 1.5
"""Factor by which a clutch may swing more or less than where its mean was taken, before that is said."""
LARGEST_SWING = 0.1
"""Order times swing of its disk [rad] from which the mean angle is no longer good enough."""
