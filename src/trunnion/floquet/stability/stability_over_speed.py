"""Floquet stability at many speeds at once: what the verdicts along a running range stand on.

All speeds share the work. Up to ``LARGEST_DENSE`` unknowns the monodromy matrices come from exponentials in plain
NumPy, so that nothing is compiled and stiff lines cost no more than soft ones; beyond that from the compiled chain
kernel, and of lines of ``LONG`` unknowns and more from the modes along the tree.
Free–free lines with joint angles are taken about their own periodic motions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Codes, Complex, Flags, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.first_order import (
    LARGEST_DENSE,
    LineRates,
    first_order,
    period_of,
    scales,
)
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import line_matrices, rigid_motions
from trunnion.equations.steady_base import has_periodic_base, require_balance
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.floquet.propagation.tree_modes import floquet_modes
from trunnion.numerics.chain.exponential_monodromy import exponential_monodromies
from trunnion.numerics.spectrum import spectral_radius, without
from trunnion.results.verdict import Verdict, verdicts
from trunnion.waiting import keep_time

if TYPE_CHECKING:
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

TOLERANCE = 1e-7
CLOSELY = 1e-10
"""Of radii of which differences are taken."""
UNDAMPED = 1e-12
LONG = 40
"""Unknowns from which on modes by Hill's blocks cost no more than the chain kernel, and are known far better."""
OVER_SPEED = ("speed", "radius", "error", "critical", "verdict", "growth_rate")


class SpeedBySpeedError(InputError):
    """A line is judged about its own motion and has stages or play: ``stability`` judges it speed by speed."""


@dataclass(frozen=True)
class StabilityOverSpeed:
    """speed [rad/s], radius, error (its estimate), critical (the largest multiplier), verdict (code), growth_rate of
    the fastest disturbance [1/s], negative where it decays, each (speed,); period [rad of input angle]."""

    speed: Array
    radius: Array
    error: Array
    critical: Complex
    verdict: Codes
    growth_rate: Array
    period: float

    def of(self, which: Flags | Places) -> StabilityOverSpeed:
        """At some of the speeds, in the order named."""
        return _of_parts({key: getattr(self, key)[which] for key in OVER_SPEED}, self.period)

    def beside(self, other: StabilityOverSpeed) -> StabilityOverSpeed:
        """Both, by rising speed."""
        both = {key: np.concatenate([getattr(self, key), getattr(other, key)]) for key in OVER_SPEED}
        return _of_parts(both, self.period).of(np.argsort(both["speed"], kind="stable"))


def _of_parts(parts: dict[str, Any], period: float) -> StabilityOverSpeed:
    return StabilityOverSpeed(**parts, period=period)


def _along(
    speed: Array, radius: Array, error: Array, critical: Complex, verdict: Codes, period: float
) -> StabilityOverSpeed:
    with np.errstate(divide="ignore"):
        growth = np.log(radius) * speed / period
    return StabilityOverSpeed(speed, radius, error, critical, verdict, np.asarray(growth), period)


def stability_along(
    assembly: Assembly,
    speeds: ArrayLike,
    *,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
    motions: SteadyStatesBySpeed | None = None,
    table: Array | None = None,
    closely: bool = False,
) -> StabilityOverSpeed:
    """Spectral radius and verdict at every one of ``speeds`` [rad/s], of a line with angled joints or varying meshes.

    ``about_steady_state`` : as in ``stability``; ``motions`` : periodic steady states that are known already; ``table``
    (speed, column): packed numbers at every speed, where they follow it; ``closely`` : about periodic steady states,
    radii as close as differences need them.

    Raises
    ------
    InputError : no period; torques that do not balance. NoSharedMotion is one.
    """
    speed = np.asarray(speeds, dtype=float)
    if about_steady_state or has_periodic_base(assembly):
        return _about_steady_states(assembly, speed, motions, closely)
    table = assembly.table(len(speed), speed) if table is None else table
    co = assembly.coefficients(table, statically_twisted=statically_twisted)
    if assembly.topology.size >= LONG:
        return _by_modes(assembly, table, statically_twisted)
    if assembly.topology.size <= LARGEST_DENSE or assembly.topology.graph:
        return _by_exponentials(assembly, table, statically_twisted)
    return _by_kernel(assembly, co)


def straight_decay(assembly: Assembly, speed: float, row: Array | None = None) -> float:
    """Decay [1/s] of the slowest disturbance of the line at ``speed`` with its joints straight and its meshes even;
    ``row`` (column,): its packed numbers there, where they follow the speed.

    What is not a disturbance is left out: a turn of the whole free–free line, its speed where no torque depends on
    it. What rounding cannot tell from no decay is 0.
    """
    topo, table = assembly.topology, assembly.table(1, speed) if row is None else row[None]
    co = replace(assembly.coefficients(table, any_frequency=True).straight, waves=())
    m = line_matrices(topo, co, np.zeros(1))
    root, unit = scales(m, co.speed)
    slopes = first_order(m, co.speed, root, unit)[0, 0]
    aside = rigid_motions(topo, co) * np.concatenate([root[0], root[0] / unit[0]])[:, None]
    left = without(slopes, aside)[0] if aside.shape[1] else slopes
    decay = float(-np.linalg.eigvals(left).real.max(initial=-np.inf))
    rounding = len(left) * np.finfo(float).eps * float(np.linalg.norm(left))
    return decay * speed if abs(decay) > rounding else 0.0


def _by_exponentials(assembly: Assembly, table: Array, twisted: bool) -> StabilityOverSpeed:
    rates = LineRates.of(assembly, table, twisted)
    rest = rates.rest()
    judged = None if rest is None else lambda which, z: rest[which].transpose(0, 2, 1) @ z @ rest[which]
    size = assembly.topology.size
    found = exponential_monodromies(
        rates, len(table), 2 * size, rates.period, least_steps=rates.steps, aside=judged
    )  # fmt: skip
    code = verdicts(found.radius, found.error, np.abs(rates.trace) < UNDAMPED * size)
    return _along(table[:, 0], found.radius, found.error, found.critical, code, rates.period)


def _about_steady_states(
    assembly: Assembly, speed: Array, solved: SteadyStatesBySpeed | None, closely: bool
) -> StabilityOverSpeed:
    from trunnion.floquet.propagation.about_steady_states import multipliers_about
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed, steady_state_slopes

    require_balance(assembly, assembly.table(len(speed), speed))
    solved = solved or SteadyStatesBySpeed(assembly.line)
    if assembly.topology.size >= LONG and not solved.obstacle and solved.balance.along_tree:
        return _by_modes_of_the_motion(solved, speed)
    motions = steady_state_slopes(assembly.line, speed, solved)
    if motions is None:
        free = "is free–free and " if assembly.topology.free else ""
        raise SpeedBySpeedError(
            f"{free}has stages or play, so that each speed takes its periodic steady state",
            element="driveline",
            remedy="ask stability at single speeds",
        )
    found = multipliers_about(motions, tolerance=CLOSELY, share=0.0) if closely else None
    if found is None or not np.isfinite(found.radius[motions.found]).all():  # rounding may be larger than that
        found = multipliers_about(motions)
    return _along(speed, found.radius, found.error, found.critical, found.verdict, motions.period)


def _by_modes_of_the_motion(solved: SteadyStatesBySpeed, speed: Array) -> StabilityOverSpeed:
    """Of a long line; FAILED where no motion is known, or its modes are known less well than the tolerance."""
    from trunnion.floquet.propagation.periodic_motion_modes import periodic_motion_modes_along

    nothing = np.nan, np.nan, complex(np.nan), Verdict.FAILED
    found = [
        (one.radius, one.error, complex(one.modes.multiplier[one.critical]), one.verdict) if one else nothing
        for one in periodic_motion_modes_along(solved, speed, TOLERANCE)
    ]
    radius, error, critical, verdict = (np.array(part) for part in zip(*found, strict=True))
    return _along(speed, radius, error, critical, verdict.astype(np.int8), solved.balance.period)


def _by_modes(assembly: Assembly, table: Array, twisted: bool) -> StabilityOverSpeed:
    """Speed by speed; where that leaves more than the tolerance, from a whole period."""
    topo, period = assembly.topology, period_of(assembly)
    turns = require_period(assembly.line, topo)
    parts = []
    for row in table:
        keep_time()
        co = assembly.coefficients(row[None], statically_twisted=twisted)
        modes = floquet_modes(topo, co, turns)
        if modes is None or modes.off > TOLERANCE:
            parts.append(_by_exponentials(assembly, row[None], twisted) if topo.graph else _by_kernel(assembly, co))
            continue
        radius, error = (part[None] for part in spectral_radius(modes.multiplier, modes.error))
        undamped = np.array([abs(modes.trace) < UNDAMPED * topo.size])
        verdict = verdicts(radius, error, undamped).astype(np.int8)
        parts.append(_along(row[:1], radius, error, modes.multiplier[:1], verdict, period))
    return _of_parts({key: np.concatenate([getattr(part, key) for part in parts]) for key in OVER_SPEED}, period)


def _by_kernel(assembly: Assembly, co: LineCoefficients) -> StabilityOverSpeed:
    # Loaded here, as they bring the compiler with them, which lines of up to ``LARGEST_DENSE`` unknowns do without.
    from trunnion.equations.chain_batch import chain_batch, chain_program, loaded_by_speed
    from trunnion.floquet.charts.chart_families import quantities
    from trunnion.floquet.charts.chart_pixels import judge, judge_matrices
    from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy

    topo, by_speed = assembly.topology, loaded_by_speed(assembly.topology, co)
    period = period_of(assembly)
    batch = chain_batch(topo, co, by_speed)
    program = chain_program(topo, co, by_speed)
    matrix, error, trace = chain_monodromy(program, batch, Window(0.0, period, False), TOLERANCE)
    if topo.still:
        values, bounds = quantities(matrix, error, trace)
        found = judge(values.T.copy(), bounds.T.copy(), topo.size, rigid_motions(topo, co).shape[1])
    else:
        found = judge_matrices(matrix, error, trace)
    return _along(co.speed, found.radius, found.error, found.critical, found.verdict, period)
