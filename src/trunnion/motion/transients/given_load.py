"""Excitations by the torque that a disk is given: cylinders whose gas torque goes with the load of a tip-in, say.

What is given over time by straight lines or steps makes amplitudes that go straight over time, between points of the
excitation's table: of each stretch one formula, which acts from one known instant to the next. What is given over the
speed by straight lines makes a table over the speed. A share goes with any formula of the torque.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.applied_torque import AppliedTorque
from trunnion.driveline.elements import Disk, Rotor
from trunnion.driveline.excitation import Excitation
from trunnion.equations.amplitudes import BEYOND
from trunnion.equations.harmonics import cylinders
from trunnion.errors import InputError
from trunnion.laws.formula import LONGEST
from trunnion.laws.torque_curve import PowerCurve
from trunnion.motion.transients.torque_text import lines, phase_text, torque_text

TOGETHER = 16
"""Harmonics in one formula."""


class Stretch(NamedTuple):
    """From ``since`` to ``until`` [s], None without an end, a torque goes straight from ``first`` to ``last`` [N m]."""

    since: float | None
    until: float | None
    first: float
    last: float


Numbered = tuple[int, Excitation]
"""An excitation and its number on its disk, from 1."""


def by_given(
    name: str, rotor: Rotor, laws: Sequence[Numbered], given: Sequence[AppliedTorque]
) -> tuple[AppliedTorque, ...]:
    """Torques for the ``laws`` by its load of a rotor that is ``given`` torques.

    Raises
    ------
    InputError : a load beyond a table; torques that no amplitude can be made by.
    """
    own = _own_load(rotor)
    if any(one.corner_frequency is not None for one in given):
        raise _refused(name, laws[0], "a torque that lags")
    if own is not None and all(_over_time(one) for one in given):
        return tuple(_along_time(name, rotor, laws, given, own))
    if own is not None and len(given) == 1 and _over_speed(given[0]):
        return tuple(_along_speed(name, rotor, law, given[0], own) for law in laws)
    table = next((law for law in laws if law[1].share is None), None)
    if table is not None:
        what = "a torque over time beside others" if len(given) > 1 else "such a torque"
        raise _refused(name, table, what)
    return tuple(_by_share(name, rotor, law, given) for law in laws)


def _refused(name: str, law: Numbered, what: str) -> InputError:
    return InputError(
        f"goes by the load of its disk, which {what} gives", element=name, key=f"excitation {law[0]}",
        remedy="give the torque over time or over speed by straight lines, at once; or write an amplitude",
    )  # fmt: skip


def _own_load(rotor: Rotor) -> float | None:
    """What it resists with beside what it is given [N m], where that is constant; nothing counts at cylinders, whose
    gas torque is what they are given."""
    if isinstance(rotor, Disk) and (rotor.firing_angles or rotor.part_of is not None):
        return 0.0
    load = rotor.load
    return float(load.constant) if isinstance(load, PowerCurve) and not (load.viscous or load.quadratic) else None


def _over_time(one: AppliedTorque) -> bool:
    plain = not (one.by_program or one.is_motor or one.power is not None or one.table)
    return plain and one.variables == ("time",) and one.between in ("lines", "steps")


def _over_speed(one: AppliedTorque) -> bool:
    plain = not (one.by_program or one.is_motor or one.power is not None or one.table)
    return plain and one.variables == ("speed",) and one.between == "lines"


# Over time.


def _along_time(
    name: str, rotor: Rotor, laws: Sequence[Numbered], given: Sequence[AppliedTorque], own: float
) -> Iterator[AppliedTorque]:
    points = tuple(dict.fromkeys(law.torques for _, law in laws))
    for table in points:
        alike = [one for one in laws if one[1].torques == table]
        for stretch in stretches(given, own, table or (0.0,)):
            terms = [term for one in alike for term in _terms(name, rotor, one, stretch)]
            for k in range(0, len(terms), TOGETHER):
                said = " + ".join(terms[k : k + TOGETHER])
                yield AppliedTorque(on=name, formula=said, since=stretch.since, until=stretch.until)


def stretches(given: Sequence[AppliedTorque], own: float, points: Sequence[float]) -> Iterator[Stretch]:
    """The stretches of the sum of torques over time less ``own``, which begin and end at their knots and where the sum
    comes to one of ``points``."""
    knots = sorted({float(t) for one in given for t in one.time})
    if knots[0] > 0:
        yield Stretch(None, knots[0], *[sum(_side(one, knots[0], -1) for one in given) - own] * 2)
    for since, until in zip(knots, knots[1:], strict=False):
        first, last = (sum(_side(one, t, side) for one in given) - own for t, side in ((since, 1), (until, -1)))
        inside = sorted((p for p in points if min(first, last) < p < max(first, last)), reverse=last < first)
        values = [first, *map(float, inside), last]
        times = [since, *(since + (until - since) * (p - first) / (last - first) for p in inside), until]
        for k in range(len(values) - 1):
            yield Stretch(times[k], times[k + 1], values[k], values[k + 1])
    yield Stretch(knots[-1], None, *[sum(_side(one, knots[-1], 1) for one in given) - own] * 2)


def _side(one: AppliedTorque, time: float, side: int) -> float:
    """A torque just before (−1) or behind (1) a time; its ends last."""
    times, torques = np.array(one.time), np.array(one.torque)
    if one.between == "steps":
        place = int(np.searchsorted(times, time, side="right" if side > 0 else "left")) - 1
        return float(torques[place]) if place >= 0 else 0.0
    here = np.flatnonzero(times == time)
    if len(here):
        return float(torques[here[-1 if side > 0 else 0]])
    return float(np.interp(time, times, torques))


def _terms(name: str, rotor: Rotor, law: Numbered, stretch: Stretch) -> Iterator[str]:
    """A harmonic along a stretch, as parts of a formula."""
    ends = _amplitudes(name, rotor, law, np.array([stretch.first, stretch.last]))
    turned = phase_text(law[1], float(law[1].phase))
    for part, wave, sign in ((ends.real, "cos", 1.0), (ends.imag, "sin", -1.0)):
        first, last = (sign * float(one) for one in part)
        if first == last == 0.0:
            continue
        size = f"({first!r})"
        if last != first:
            assert stretch.since is not None and stretch.until is not None
            slope = (last - first) / (stretch.until - stretch.since)
            size = f"({first!r} + ({slope!r})*(t - ({stretch.since!r})))"
        yield f"{size}*{wave}({turned})"


def _amplitudes(name: str, rotor: Rotor, law: Numbered, torque: Array) -> Complex:
    """A e^{iφ} of all cylinders together at driving torques (m,) [N m].

    Raises
    ------
    InputError : a torque beyond the table.
    """
    number, one = law
    together = cylinders(rotor, one)
    if one.share is not None:
        return np.asarray(one.share * np.abs(torque) * together, dtype=complex)
    points = np.array(one.torques)
    slack = BEYOND * float(np.abs(points).max())
    if np.any(off := (torque < points[0] - slack) | (torque > points[-1] + slack)):
        problem = one.does_not_cover("torques", float(torque[off][0]))
        raise InputError(problem, element=name, key=f"excitation {number}", remedy="extend the table")
    phases = np.array(one.phases) if one.phases else np.zeros(len(points))
    values = np.array(one.amplitudes) * np.exp(1j * phases)
    found = np.interp(torque, points, values.real) + 1j * np.interp(torque, points, values.imag)
    return np.asarray(found * together)


# Over speed.


def _along_speed(name: str, rotor: Rotor, law: Numbered, given: AppliedTorque, own: float) -> AppliedTorque:
    speeds, torques = np.array(given.speed), np.array(given.torque) - own
    points, more = law[1].torques or (0.0,), list[float]()
    for a, b, first, last in zip(speeds, speeds[1:], torques, torques[1:], strict=False):
        more += [float(a + (b - a) * (p - first) / (last - first)) for p in points if (p - first) * (p - last) < 0]
    every = np.unique(np.concatenate([speeds, more]))
    values = _amplitudes(name, rotor, law, np.interp(every, speeds, torques))
    within = f"min(max(speed, {float(every[0])!r}), {float(every[-1])!r})" if given.hold else "speed"
    turned = phase_text(law[1], float(law[1].phase))
    waves = ((values.real, "cos"), (-values.imag, "sin"))
    terms = [f"({lines(every, part, within)})*{wave}({turned})" for part, wave in waves if part.any()]
    return _formula(name, law, " + ".join(terms) or "0")


# By a share.


def _by_share(name: str, rotor: Rotor, law: Numbered, given: Sequence[AppliedTorque]) -> AppliedTorque:
    texts = [torque_text(one) for one in given]
    load = rotor.load
    alone = isinstance(rotor, Disk) and (rotor.firing_angles or rotor.part_of is not None)
    if any(text is None for text in texts) or not (alone or isinstance(load, PowerCurve)):
        raise _refused(name, law, "such a torque")
    drives = " + ".join(f"({text})" for text in texts)
    if not alone:
        assert isinstance(load, PowerCurve)
        constant, viscous, quadratic = (float(part) for part in (load.constant, load.viscous, load.quadratic))
        drives += f" - (({constant!r}) + (({viscous!r}) + ({quadratic!r})*abs(speed))*speed)"
    return of_share(name, rotor, law, drives)


def of_share(name: str, rotor: Rotor, law: Numbered, drives: str) -> AppliedTorque:
    """A share of the size of what a formula says that a rotor drives with."""
    together = cylinders(rotor, law[1])
    factor, phase = abs(together) * float(law[1].share or 0), float(law[1].phase + np.angle(together))
    return _formula(name, law, f"({factor!r})*abs({drives})*cos({phase_text(law[1], phase)})")


def _formula(name: str, law: Numbered, said: str) -> AppliedTorque:
    if len(said) > LONGEST:
        problem = "goes by a torque of too many points to be followed"
        raise InputError(problem, element=name, key=f"excitation {law[0]}", remedy="give the torque by fewer points")
    return AppliedTorque(on=name, formula=said)
