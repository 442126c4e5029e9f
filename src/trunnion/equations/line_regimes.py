"""Stages of gear meshes and of shafts with stages as regimes of a line, one number for all of them together.

A spring with s stages counts them 0 … s − 1; the regime of the line is Σ stage · stride, the strides being products of
the numbers of stages before. Each has the guards that ``laws.stages`` numbers. Sliders of clutches are parts of three
stages.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import prod
from pathlib import Path
from types import ModuleType

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.driveline.gears import GearPair
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import Assembly, mesh_harmonics
from trunnion.equations.harmonics import mesh_errors
from trunnion.equations.sliders import beyond_capacity, sliders
from trunnion.equations.slip_clutches import placed_clutches
from trunnion.equations.stage_laws import StageLaw, has_stages, impact_damping, spring_damping, stage_law
from trunnion.errors import InputError
from trunnion.laws.harmonic import Harmonic
from trunnion.laws.stages import GUARDS, HELD, SLIDER_STAGES, STICKS, Stages, clutch_stages, stages_of
from trunnion.numerics.compiled import kernel_file
from trunnion.systems.regimes import SLACK, Regimes
from trunnion.systems.user_functions import from_kernel

MOST_REGIMES = 400


@cache
def line_kernel() -> ModuleType:
    """The compiled right-hand side of lines and what observes their motion."""
    return kernel_file(str(Path(__file__).with_name("line_kernel.py")))


def guards_kernel() -> ModuleType:
    """The compiled switching functions and jumps of lines."""
    here = Path(__file__)
    return kernel_file(str(here.with_name("line_guards_kernel.py")), str(here.with_name("line_kernel.py")))


@cache
def watch_kernel() -> ModuleType:
    """The compiled function of what can be watched along a motion."""
    here = Path(__file__)
    integration = here.parents[1] / "numerics" / "integration" / "integration_kernel.py"
    return kernel_file(
        str(here.with_name("line_watch_kernel.py")), str(integration), str(here.with_name("line_kernel.py"))
    )


@cache
def passage_kernel() -> ModuleType:
    """The compiled stretches of passages, of which nothing is kept but where the line stands."""
    here = Path(__file__)
    integration = here.parents[1] / "numerics" / "integration" / "integration_kernel.py"
    return kernel_file(
        str(here.with_name("passage_kernel.py")), str(integration), str(here.with_name("line_kernel.py"))
    )


def released_kernel() -> ModuleType:
    """The compiled right-hand side of lines with slip clutches and pendulums, what switches there, and what observes
    them."""
    names = ("released_kernel.py", "line_kernel.py", "line_guards_kernel.py")
    return kernel_file(*(str(Path(__file__).with_name(name)) for name in names))


@dataclass(frozen=True)
class StagedSpring:
    """One spring's numbers as ``line_kernel`` reads them.

    law: its stages; error, wave: harmonics by turns of the input of a mesh's transmission error, as a twist [rad], and
    of its stiffness over the mean.
    """

    name: str
    stride: int
    law: Stages
    error: tuple[Harmonic, ...] = ()
    wave: tuple[Harmonic, ...] = ()

    @property
    def stages(self) -> int:
        """How many."""
        return len(self.law.pieces)

    @property
    def side(self) -> Integers:
        """Of every stage (stages,): −1 below the softest one, +1 above, 0 in it."""
        return self.law.side

    @property
    def numbers(self) -> Array:
        """All of them in a row."""
        guards = self.law.guards.reshape(self.stages, -1)
        table = np.concatenate([self.law.pieces, guards, self.law.impact], axis=1)
        harmonics = [[float(part) for part in (h.amplitude, h.order, h.phase)] for h in (*self.error, *self.wave)]
        return np.concatenate([table.ravel(), np.ravel(harmonics)])


def staged_springs(assembly: Assembly, row: Array) -> dict[int, StagedSpring]:
    """The springs with stages by the place of their compliance, at one row of packed numbers."""
    found, stride = {}, 1
    for e, compliance in enumerate(assembly.topology.compliances):
        place = compliance.shafts[0]
        if has_stages(assembly.line.elements[place]):
            found[e] = _spring(assembly, row, place, stride)
            stride *= found[e].stages
    return found


def staged_damping(assembly: Assembly, row: Array, place: int, law: StageLaw) -> float:
    """Damping [N m s/rad] of the element at ``place`` where it acts: a common ratio refers to the stiffest stage."""
    if assembly.line.damping_ratio is not None:
        return float(assembly.common_damping(row[None], law.slopes.max(axis=1))[0])
    return float(spring_damping(assembly.line.elements[place], place, assembly.packed.column, row[None])[0])


def _spring(assembly: Assembly, row: Array, place: int, stride: int) -> StagedSpring:
    element, column = assembly.line.elements[place], assembly.packed.column
    law = stage_law(assembly.line, place, column, row[None])
    damping = staged_damping(assembly, row, place, law)
    kind = element.damping_law if law.knots.size and isinstance(element, GearPair | PiecewiseShaft) else "always"
    impact = float(impact_damping(element, place, column, row[None])[0])
    spring = StagedSpring(assembly.line.names[place], stride, stages_of(law.first, damping, kind, impact))
    mesh = next((mesh for mesh in assembly.topology.meshes if mesh.element == place), None)
    if mesh is None:
        return spring
    error, wave = mesh_errors(assembly, mesh, row), mesh_harmonics(assembly.packed, mesh, "stiffness_variation", row)
    return replace(spring, error=error, wave=wave)


@dataclass(frozen=True)
class _Part:
    """What a regime is made of: one spring or slider with stages.

    ``along``: numbers of the parts, itself among them, that come to stick together where they slip together.
    """

    name: str
    stride: int
    law: Stages
    words: tuple[str, ...]
    along: tuple[int, ...] = ()

    def stage(self, regime: int) -> int:
        """Its stage in a regime of the line."""
        return regime // self.stride % len(self.law.pieces)


@dataclass(frozen=True)
class LineRegimes(Regimes):
    """Regimes of a line; transitions and directions (regimes, guards) as the integrator takes them."""

    transitions: Integers | None = None
    directions: Integers | None = None
    sliders: tuple[_Part, ...] = ()
    clutches: tuple[_Part, ...] = ()

    def tables(self) -> tuple[Integers, Integers]:
        assert self.transitions is not None and self.directions is not None
        return self.transitions, self.directions

    @property
    def slider_names(self) -> tuple[str, ...]:
        return tuple(slider.name for slider in self.sliders)

    def limits(self, numbers: Array) -> Array | None:
        if not self.sliders:
            return None
        free = np.full(2 * int(numbers[self._core.UNKNOWNS]), np.inf)
        return np.concatenate([free, self._numbers(numbers)[:, self._core.REACH]])

    def refusal(self, state: Array, numbers: Array) -> tuple[str, str] | None:
        table = self._numbers(numbers)
        deflection = state[len(state) - len(table) :]
        for slider, x, row in zip(self.sliders, deflection, table, strict=True):
            spring, reach = row[self._core.SPRING], row[self._core.REACH]
            if abs(x) > (1 + SLACK) * reach:
                return beyond_capacity(slider.name, spring * x, spring * reach, reach)
        return None

    def stuck(self, regime: Integers, length: Array, most: float) -> Integers:
        stages = regime[:, None] // np.array([s.stride for s in self.sliders], dtype=np.int64) % SLIDER_STAGES
        slips = length @ (stages != STICKS)
        return np.flatnonzero(slips <= most * length.sum())

    def clutches_stick(self, regime: Integers) -> Array:
        """Whether each slip clutch sticks (m, clutch) in regimes (m,)."""
        stages = regime[:, None] // np.array([c.stride for c in self.clutches], dtype=np.int64) % SLIDER_STAGES
        return np.asarray(stages == STICKS)

    def conserved(self, which: Integers, slopes: Array) -> Array:
        # A twist depends on the rotations as its rate does on their rates, and that is the last guard of a slider.
        count, n = len(self.sliders), slopes.shape[1] - 1
        unknowns = (n - count) // 2
        own = slopes[len(self.guards) - GUARDS * count :][GUARDS - 1 :: GUARDS][which]
        found = np.zeros((len(which), n))
        found[:, :unknowns] = -own[:, unknowns : 2 * unknowns]
        found[np.arange(len(which)), 2 * unknowns + which] = 1.0
        return found

    def holding(self, which: Integers, numbers: Array) -> Array:
        more = numbers.copy()
        self._numbers(more)[which, self._core.REACH] *= HELD
        return more

    @property
    def _core(self) -> ModuleType:
        return line_kernel()

    def _numbers(self, numbers: Array) -> Array:
        """The rows (slider, PER_SLIDER) of the sliders among the numbers of a line, a view."""
        first, per = int(self._core.places(numbers)[2]), self._core.PER_SLIDER
        return numbers[first : first + per * len(self.sliders)].reshape(-1, per)

    def at(self, time: float, state: Array, parameters: Mapping[str, float], numbers: Array) -> int:
        at, x = float(time), np.ascontiguousarray(state, dtype=float)
        found = int(self._core.locate(at, x, numbers))
        if not self.clutches:
            return found
        core = released_kernel()
        return int(core.located(core.released_line.address, at, x, numbers.copy(), found))


def slider_strides(springs: dict[int, StagedSpring], count: int) -> list[int]:
    """Strides of the stages of ``count`` sliders and slip clutches, which come after those of the springs, the clutches
    last."""
    first = prod(spring.stages for spring in springs.values())
    return [first * SLIDER_STAGES**i for i in range(count)]


def line_regimes(assembly: Assembly) -> LineRegimes | None:
    """The regimes of a line; None where all springs are linear and nothing rubs.

    Raises
    ------
    InputError : more stages together than are told apart.
    """
    parts = _parts(assembly)
    if not parts:
        return None
    count = prod(len(part.law.pieces) for part in parts)
    if count > MOST_REGIMES:
        raise InputError(
            f"have {count} combinations of stages, more than the {MOST_REGIMES} that are told apart",
            element=", ".join(p.name for p in parts), remedy="take some of the gaps out, or stages together",
        )  # fmt: skip
    transitions = np.full((count, GUARDS * len(parts)), -1, dtype=np.int64)
    directions = np.zeros_like(transitions)
    for regime in range(count):
        for i, part in enumerate(parts):
            stage, law = part.stage(regime), part.law
            for guard in range(GUARDS):
                then = law.then[stage, guard]
                at_rest = law.moves[stage] == 0 and law.guards[stage, guard, 0] != 0
                if then >= 0 and not at_rest:
                    same = [parts[j].stride for j in part.along if parts[j].stage(regime) == stage]
                    step = sum(same) if same and stage != STICKS else part.stride
                    transitions[regime, GUARDS * i + guard] = regime + (then - stage) * step
                    directions[regime, GUARDS * i + guard] = int(law.guards[stage, guard, 3])
    names = tuple(", ".join(f"{p.name} {p.words[p.stage(r)]}" for p in parts) for r in range(count))
    guards = tuple(f"{p.name} guard {side}" for p in parts for side in range(1, GUARDS + 1))
    slips = placed_clutches(assembly, assembly.table(1)[0])
    jump = from_kernel(released_kernel, "released_jump") if slips else from_kernel(guards_kernel, "line_jump")
    return LineRegimes(
        names,
        guards,
        from_kernel(released_kernel, "released_guards") if slips else from_kernel(guards_kernel, "line_guards"),
        (),
        lambda t, x, p: 0,
        jump if any(part.along for part in parts) else None,
        transitions=transitions,
        directions=directions,
        sliders=tuple(part for part in parts if part.along),
        clutches=tuple(parts[len(parts) - len(slips) :]),
    )


def _parts(assembly: Assembly) -> list[_Part]:
    row = assembly.table(1)[0]
    springs = staged_springs(assembly, row)
    found = [
        _Part(s.name, s.stride, s.law, tuple(f"stage {i + 1}" for i in range(s.stages)))
        for s in springs.values()
        if s.stages > 1
    ]
    friction_sliders = sliders(assembly.packed, assembly.topology, row)
    first, words = len(found), ("slips back", "sticks", "slips on")
    clutches = placed_clutches(assembly, row)
    strides = slider_strides(springs, len(friction_sliders) + len(clutches))
    for slider, stride in zip(friction_sliders, strides, strict=False):
        # All that slip on one twist stick together: it turns for them at the same instant.
        along = tuple(first + j for j, other in enumerate(friction_sliders) if other.compliance == slider.compliance)
        found.append(_Part(slider.name, stride, slider.stages, words, along))
    for clutch, stride in zip(clutches, strides[len(friction_sliders) :], strict=True):
        found.append(_Part(clutch.name, stride, clutch_stages(), words))
    return found
