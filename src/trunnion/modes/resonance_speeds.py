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
can lead to instability: their modes have opposite Krein signatures. Difference tongues of the papers come from
mis-linearised equations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import as_it_operates, left_out
from trunnion.laws.harmonic import common_rate
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.results.fields import attribute, computed, internal, labelled, members, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import figures

MOST_READABLE = 4
"""Largest multiple of a frequency that is read at a glance, "3ω₁/2"; others, behind gears, are written "ω₄/0.475"."""
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@labelled
class Resonance:
    """A resonance speed.

    A mesh excites as a Hooke's joint at half its teeth per turn of the input would, a tripod as one at 3/2 R.
    What ``stability`` calls a divergence, one mode pushed aside without oscillating, has neither speed (nan) nor order.
    """

    speed: float = variable("", "rad/s", "of the input")
    kind: str = variable(words="harmonic, subharmonic, sum or difference")
    modes: tuple[int, ...] = internal("numbered from 1")
    order: int = variable(words="k")
    rate: Fraction = internal("speed ratio |R| of what excites", default=Fraction(1))
    mesh: str = variable(words="gear mesh that excites; empty for joints", default="")

    @property
    @computed(variable(words="unloaded line can be unstable there"))
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

    @property
    def name(self) -> str:
        """ "sum (ω₁+ω₂)/2"."""
        return f"{self.kind} {self.label}"

    def __str__(self) -> str:
        return self.name


@labelled
class ResonanceSpeeds(Result):
    """Resonances by ascending speed."""

    resonances: tuple[Resonance, ...] = members(Resonance, "resonance", name="name")
    orders: int = attribute("up to which they are named")
    findings: tuple[Finding, ...] = internal("what of the line is left out", default=())
    unit: str = internal("of printed speeds", default="rad/s")

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter(self.resonances)

    def __len__(self) -> int:
        return len(self.resonances)

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row per resonance, speeds in ``unit``, by default that of the line's description."""
        words = self.in_unit(unit).words
        return [
            {
                f"speed [{words.unit}]": r.speed * words.factor,
                "kind": r.kind,
                "formula": r.label,
                "instability can begin": "yes" if r.opens else "no",
            }
            for r in self.resonances
        ]

    def within(self, low: float, high: float) -> ResonanceSpeeds:
        """Those between two input speeds [rad/s]."""
        return replace(self, resonances=tuple(r for r in self.resonances if low <= r.speed <= high))

    def _lines(self) -> Iterator[str]:
        if not self.resonances:
            yield "no parametric resonance speeds: the line has no angled joint or varying mesh, or no elastic mode"
            return
        yield f"{len(self)} resonance speeds up to order {self.orders}"
        for one in self:
            yield f"  {self.words.speed(one.speed)}  {one}{'' if one.opens else ' (cannot open unloaded)'}"


def resonance_speeds(line: Driveline | Assembly, orders: int = 2) -> ResonanceSpeeds:
    """Named parametric resonance speeds of ``line`` up to order k = ``orders``, ascending; of joints and meshes.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    orders : highest order k [-].

    Raises
    ------
    InputError : ``orders`` is not a positive whole number.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> print(tn.resonance_speeds(line, 1))
    2 resonance speeds up to order 1
      55.9017 rad/s  harmonic ω₁/2
      111.803 rad/s  subharmonic ω₁
    """
    if isinstance(orders, bool) or not isinstance(orders, int) or orders < 1:
        raise InputError("must be a whole number, 1 or more", key="orders", value=orders)
    assembly = assemble(line)
    modes = natural_frequencies(assembly).undamped_frequency
    found = [r for source in sources(assembly) for r in _excited(modes, orders, source)]
    said = left_out("resonance_speeds", assembly.line) + as_it_operates(assembly.line)
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
