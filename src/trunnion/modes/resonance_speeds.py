"""Input speeds at which joints and gear meshes can excite parametric resonance, and their names.

A Hooke's joint whose shaft turns at R times the input excites with 2|R|Ω and its multiples m. Modes i and j
respond where m · 2|R|Ω = ω_i ± ω_j:

    harmonic     Ω = ω_i / (2k|R|)          multiplier real positive
    subharmonic  Ω = ω_i / ((2k−1)|R|)      multiplier real negative
    sum          Ω = (ω_i + ω_j) / (2k|R|)  complex pair
    difference   Ω = (ω_i − ω_j) / (2k|R|)  complex pair

(S1 equations 23–24, S3 equations 15–16.) Another joint excites with its own orders: a tripod, three times a turn,
counts as a Hooke's joint of 3R/2. A mesh of varying stiffness excites with its teeth per turn of the input, z,
and counts as a joint of R = z/2. While the stiffness stays positive definite only the first three
can open: their modes have opposite Krein signatures. Difference tongues of the papers come from
mis-linearised equations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.laws.harmonic import common_rate
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.results.declared import Described, Held, axis, members_over, over, remark
from trunnion.results.finding import Finding
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.units import figures

MOST_READABLE = 4
"""Largest multiple of a frequency that is read at a glance, "3ω₁/2"; others, behind gears, are written "ω₄/0.475"."""
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@dataclass(frozen=True)
class Resonance:
    """A resonance speed [rad/s], its kind, modes (numbered from 1), order k and exciting speed ratio |R|.

    A mesh excites as a Hooke's joint at half its teeth per turn of the input would, a tripod as one at 3/2 R;
    ``mesh`` is the name of the mesh, empty for joints.
    What ``stability`` calls a divergence, one mode pushed aside without oscillating, has neither speed (nan) nor order.
    """

    speed: float
    kind: str
    modes: tuple[int, ...]
    order: int
    rate: Fraction = Fraction(1)
    mesh: str = ""

    @property
    def opens(self) -> bool:
        """Whether an unloaded line can be unstable there at all."""
        return self.kind != "difference"

    @property
    def formula(self) -> str:
        """``(ω₁+ω₂)/2``, the resonance speed in terms of the natural frequencies."""
        first, *second = (f"ω{m}".translate(_SUBSCRIPT) for m in self.modes)
        if self.kind == "divergence":
            return first
        pairs = {"sum": f"({'+'.join([first, *second])})", "difference": f"({'−'.join([*second, first])})"}
        top = pairs.get(self.kind, first)
        below = 2 * self.order - (self.kind == "subharmonic")
        under = below * self.rate
        if under.denominator > MOST_READABLE:
            return f"{top}/{figures(float(under))}"
        over = "" if under.denominator == 1 else f"{under.denominator}"
        return f"{over}{top}" if under.numerator == 1 else f"{over}{top}/{under.numerator}"

    @property
    def label(self) -> str:
        """The formula, and the mesh that excites where it is one."""
        return f"{self.formula} (mesh of {self.mesh})" if self.mesh else self.formula

    @property
    def in_words(self) -> str:
        """For a sentence: ``sum resonance (ω₁+ω₂)/2``, ``divergence of the mode at ω₁``."""
        if self.kind == "divergence":
            return f"divergence of the mode at {self.formula}, which grows without oscillating"
        return f"{self.kind} resonance {self.label}"

    def __str__(self) -> str:
        return f"{self.kind} {self.label}"


@dataclass(frozen=True, repr=False)
class ResonanceSpeeds(Described):
    """Resonances by ascending speed; ``findings`` say what of the line is left out; unit: that of printed speeds."""

    resonances: tuple[Resonance, ...]
    orders: int
    findings: tuple[Finding, ...] = ()
    unit: str = "rad/s"

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter(self.resonances)

    def __len__(self) -> int:
        return len(self.resonances)

    def declared(self) -> Iterator[Held]:
        """Speed, kind, order, exciting mesh of every resonance, and whether it can open."""
        rows = self.resonances
        yield axis("resonance", [str(r) for r in rows])
        yield from members_over("resonance", rows, speed="rad/s", kind="", order="")
        yield over("resonance", "mesh", [r.mesh for r in rows], about="gear mesh that excites; empty for joints")
        opens = np.array([r.opens for r in rows], dtype=np.int8)
        yield over("resonance", "opens", opens, about="unloaded line can be unstable there")
        yield remark("orders", self.orders)

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row per resonance, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        factor = speed_factor(unit)
        return [
            {
                f"speed [{unit}]": r.speed * factor,
                "kind": r.kind,
                "formula": r.label,
                "can open": "yes" if r.opens else "no",
            }
            for r in self.resonances
        ]

    def within(self, low: float, high: float) -> ResonanceSpeeds:
        """Those between two input speeds [rad/s]."""
        return replace(self, resonances=tuple(r for r in self.resonances if low <= r.speed <= high))

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit, said = unit or self.unit, [f"  {finding}" for finding in self.findings]
        if not self.resonances:
            none = "no parametric resonance speeds: the line has no bent joint or varying mesh, or no elastic mode"
            return "\n".join([none, *said])
        rows = [f"  {show_speed(r.speed, unit)}  {r}{'' if r.opens else ' (cannot open unloaded)'}" for r in self]
        return "\n".join([f"{len(rows)} resonance speeds up to order {self.orders}", *rows, *said])


def resonance_speeds(line: Driveline | Assembly, orders: int = 2) -> ResonanceSpeeds:
    """Named parametric resonance speeds of ``line`` up to order k = ``orders``, ascending; of joints and meshes.

    Raises
    ------
    InputError : ``orders`` is not a positive whole number.
    """
    if isinstance(orders, bool) or not isinstance(orders, int) or orders < 1:
        raise InputError("must be a whole number, 1 or more", key="orders", value=orders)
    assembly = assemble(line)
    modes = natural_frequencies(assembly).undamped_frequency
    found = [r for source in sources(assembly) for r in _excited(modes, orders, source)]
    said = left_out("resonance_speeds", assembly.line)
    return ResonanceSpeeds(tuple(sorted(found, key=lambda r: r.speed)), orders, said, speed_unit(assembly.line))


@dataclass(frozen=True)
class Source:
    """What excites with 2 ``rate`` cycles per turn of the input: joints, or the ``mesh`` of that name."""

    rate: Fraction
    mesh: str = ""


def sources(assembly: Assembly) -> tuple[Source, ...]:
    """Everything that makes the linear coefficients of a line vary: joints by their speed ratio, then meshes."""
    topo = assembly.topology
    joints = [Source(rate) for rate in sorted({common_rate(topo.joint_rates(j)) / 2 for j in topo.joints})]
    names = assembly.line.names
    meshes = [Source(common_rate(m.stiffness_rates) / 2, names[m.element]) for m in topo.meshes if m.stiffness]
    return (*joints, *meshes)


def _excited(modes: Array, orders: int, source: Source) -> Iterator[Resonance]:
    elastic = [(i, w) for i, w in enumerate(map(float, modes), start=1) if w > 0]
    rate = float(source.rate)

    def named(frequency: float, kind: str, among: tuple[int, ...], below: int) -> Resonance:
        return Resonance(frequency / (below * rate), kind, among, (below + 1) // 2, source.rate, source.mesh)

    for k in range(1, orders + 1):
        for i, w in elastic:
            yield named(w, "harmonic", (i,), 2 * k)
            yield named(w, "subharmonic", (i,), 2 * k - 1)
        for (i, low), (j, high) in combinations(elastic, 2):
            yield named(high + low, "sum", (i, j), 2 * k)
            if high > low * (1 + 1e-12):
                yield named(high - low, "difference", (i, j), 2 * k)
