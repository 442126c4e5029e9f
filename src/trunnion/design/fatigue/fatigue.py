"""``fatigue``: how long shafts, couplings and meshes last under what the line does in its life."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.design.fatigue.counted import counted, spectrum
from trunnion.design.fatigue.damage import cycles_to_failure
from trunnion.design.fatigue.duty_histories import duty_histories, recurring, report
from trunnion.design.fatigue.load_history import LoadHistory, TorqueHistory, torque_history
from trunnion.design.fatigue.result import CycleSpectrum, FatigueLife
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.duty import ROUNDING
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import TIME, parse
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.sn_curves import SNCurve
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.steady.orders.forced_response import shaft_names
from trunnion.waiting import keeps_time

FEW_CYCLES = 1e3
"""Cycles to failure below which a curve of stress over life says nothing: the material flows."""


@keeps_time
def fatigue(
    line: Driveline | Assembly,
    histories: Sequence[LoadHistory] | None = None,
    *,
    life: float | str | None = None,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> FatigueLife:
    """Damage and life of every element with an S–N curve.

    Torques become cycles by rainflow counting (ASTM E1049-85), cycles become damage by the curve of the element,
    D = Σ n/N (Palmgren, Miner), their means counted as the curve states. Every history is taken as one that begins
    again where it ended: an event that comes so often an hour has come back in between.

    Parameters
    ----------
    line : the driveline, with its ``sn_curves``.
    histories : what it does; by default the duty of the description, each at the steady motion of its speed, its
        passages, each a ``run_up``, and those of its scenarios that say how many an hour has.
    life : operating time that it is to last [s], or as "20000 h"; by default the description's.
    within : seconds that it may take; what is not reached by then is not counted, and says so.
    progress : called as progress(share of the histories done).

    Returns
    -------
    FatigueLife: Miner's sum and life of each element, by history, and the cycles.

    Raises
    ------
    InputError : no S–N curve, no duty and no histories, shares that do not add up to 1, a history without the torque of
        an element, one that is too short.

    Examples
    --------
    >>> import trunnion as tn
    >>> curve = tn.SNCurve(of="shaft", torque_amplitude=400.0, cycles=1e6, slope=5)
    >>> parts = [tn.Disk(inertia=0.2), tn.Shaft(stiffness=1e4, name="shaft"), tn.Disk(inertia=0.8)]
    >>> line = tn.Driveline(parts, sn_curves=[curve])
    >>> start = tn.LoadHistory({"shaft": [0.0, 800.0, -800.0, 0.0]}, per_hour=2)
    >>> found = tn.fatigue(line, [start], life="1000 h")
    >>> print(round(float(found.damage[0]), 6), found.sentence(0))
    0.064 Miner's sum 0.064 of 1 after 1000 h, lasts 15600 h, most by history 1 (100 %)
    """
    assembly = assemble(line)
    line, operation = assembly.line, assembly.line.operation or Operation()
    if not line.sn_curves_by_element:
        raise InputError(
            "is not stated for any element", element=line.name or "driveline", key="sn_curve",
            remedy=f"write [[sn_curve]] with {SNCurve.example}",
        )  # fmt: skip
    if histories is None:
        found = duty_histories(line, operation, progress)
    else:
        _check_shares(histories)
        found = []
        for place, one in enumerate(histories, start=1):
            found.append(torque_history(one, place))
            report(progress, place / len(histories))
    wanted = operation.life if life is None else parse(life, TIME)
    if wanted is not None and not wanted > 0:
        raise InputError("must be positive", key="life", value=life, remedy='"20000 h", say')
    return _life(assembly, found, wanted, of_duty=histories is None)


def _check_shares(histories: Sequence[LoadHistory]) -> None:
    if not histories:
        raise InputError("is empty", key="histories", remedy="give one tn.LoadHistory or more")
    shares = [one.share for one in histories if one.share is not None]
    if shares and abs(sum(shares) - 1) > ROUNDING:
        problem = f"have shares that add up to {sum(shares):.6g}, not to 1"
        raise InputError(
            problem, key="histories", remedy="give every share of the operating time, those at rest left out"
        )


def _life(
    assembly: Assembly, histories: Sequence[TorqueHistory], wanted: float | None, *, of_duty: bool
) -> FatigueLife:
    curves, springs = assembly.line.sn_curves_by_element, shaft_names(assembly)
    shape = len(curves), len(histories)
    rate, error, peak = np.full(shape, np.nan), np.zeros(shape[0]), np.full(shape, np.nan)
    spectra: list[CycleSpectrum] = []
    for i, (element, curve) in enumerate(curves.items()):
        factor, own = _per_torque(assembly, element, curve), (element, springs[spring_of(assembly, element)])
        found = [counted(curve, factor, j, one, own) for j, one in enumerate(histories) if not one.without]
        for part in found:
            rate[i, part.number], peak[i, part.number] = part.damage.sum(), part.peak
        error[i] = sum(part.error for part in found)
        spectra.append(spectrum(curve, found))
    names = tuple(history.name for history in histories)
    uncounted = tuple(f"{history.name}: {history.without}" for history in histories if history.without)
    said = dict.fromkeys(finding for one in histories for finding in one.findings)
    findings = [*said, *_findings(assembly, tuple(curves), spectra, peak, uncounted)]
    if of_duty:
        findings += _of_duty(assembly.line.operation or Operation(), bool(recurring(assembly.line)))
    return FatigueLife(
        elements=tuple(curves), histories=names, damage_rate=rate, error_rate=error,
        allowed=np.array([curve.damage_sum for curve in curves.values()]), peak=peak, operating_life=wanted,
        spectra=tuple(spectra), uncounted=uncounted, findings=by_gravity(findings), unit=speed_unit(assembly.line),
    )  # fmt: skip


def spring_of(assembly: Assembly, element: str) -> int:
    """The spring that an element is part of."""
    place = assembly.line.index(element)
    return next(c for c, ends in enumerate(assembly.topology.compliances) if place in ends.shafts)


def _per_torque(assembly: Assembly, element: str, curve: SNCurve) -> float:
    """Stress over torque [1/m³] of a curve of stress, 1 of one of torque."""
    shaft = assembly.line.elements[assembly.line.index(element)]
    if not curve.of_stress:
        return 1.0
    assert isinstance(shaft, Shaft) and shaft.outer_diameter
    return tube_stress(shaft.outer_diameter, shaft.inner_diameter or 0.0)


def _findings(
    assembly: Assembly,
    elements: tuple[str, ...],
    spectra: Sequence[CycleSpectrum],
    peak: Array,
    uncounted: tuple[str, ...],
) -> Iterator[Finding]:
    yield from (Finding(Gravity.DANGER, f"Not counted, so that no life is known: {one}.") for one in uncounted)
    for element, found, largest in zip(elements, spectra, peak, strict=True):
        top = float(np.nanmax(largest, initial=0.0))
        if found.curve.ultimate is not None and top >= found.curve.ultimate:
            against = f"{found.shown(top)} against {found.shown(found.curve.ultimate)}"
            yield Finding(Gravity.DANGER, f"{element} reaches what breaks it at once: {against}.")
        elif len(found.amplitude) and cycles_to_failure(found.curve, found.reversed).min() < FEW_CYCLES:
            said = f"{element} would bear its largest cycle fewer than {FEW_CYCLES:g} times: it flows, and an S–N curve"
            yield Finding(Gravity.CAUTION, f"{said} says little there.")
    silent = [
        element
        for element, found in zip(elements, spectra, strict=True)
        if found.curve.ultimate is None and found.curve.mean_sensitivity is None and np.any(found.mean)
    ]
    if silent:
        which = "ultimate_stress or ultimate_torque (Goodman) or mean_sensitivity (FKM)"
        yield Finding(Gravity.CAUTION, f"Means do not count in {', '.join(silent)}: its curve states no {which}.")
    members = [assembly.line.names[i] for c in assembly.topology.compliances for i in c.shafts]
    members += [name for name, one in assembly.line.parts if isinstance(one, SlipClutch)]
    without = [name for name in members if name not in elements]
    if without:
        yield Finding(Gravity.NOTE, f"Without an S–N curve, and not judged: {', '.join(without)}.")
    yield from left_out("fatigue", assembly.line)


def _of_duty(operation: Operation, scenarios: bool) -> Iterator[Finding]:
    """What a description of a life leaves out."""
    if not operation.passages and not scenarios:
        said = "No passages are stated: starts, stops and changes from one speed or load to the other count no cycle."
        yield Finding(Gravity.CAUTION, said)
    elif not operation.duty:
        yield Finding(Gravity.CAUTION, "No duty is stated: running at constant speeds counts no cycle.")
