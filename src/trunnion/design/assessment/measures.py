"""What checks of the response look at over speed: a value, what it must not exceed, and the orders that make it up.

The search over the range and the check read the same measure, so that what is judged is what was looked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import inf

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.gears import GearPair
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.limits import SHIP_SHAFTS, OneLimit
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.coefficients import Assembly, shaft_stiffness
from trunnion.response.orders.clutch_torque import clutch_torque
from trunnion.response.orders.result import OrderResponse
from trunnion.response.peaks.peak_limits import required_of, service_factors, springs_of
from trunnion.response.ranges.largest import SearchedQuantity

OF_LIMITS = (
    *("max_torque", "vibratory_torque", "transient_vibratory_torque", "max_stress", "max_twist"),
    *("max_speed_fluctuation", "max_acceleration"),
)
OF_DISKS = ("max_speed_fluctuation", "max_acceleration")
HIGHEST, NO_BAR, STEADY = 1.05, 0.8, 0.9
"""λ up to which the rule for ship shafts goes, from which no range may be barred, from which its limit is constant."""
ROUNDING, EDGE = 1e-9, 1e-12
"""By how much λ may lie above the highest and count as it, and how far beside a jump of a limit its two sides are
taken, as a share."""
ALLOYED = ("42CrMo4", "34CrNiMo6")

Values = Callable[[OrderResponse], Array]
Parts = Callable[[OrderResponse], Complex]


@dataclass(frozen=True)
class Measure:
    """One value of an ``element`` over speed.

    name: of the check. values: response → (speed,) in SI; limit: response → (speed,); parts: response → amplitudes by
    order (speed, order) of what varies, in the unit of the values, ``squared`` where these are sums of their squares;
    margin: the share of the limit that must stay free; bars: whether the speeds count at which that is exceeded; cuts:
    speeds [rad/s] at which the limit has a jump or a kink.
    """

    name: str
    element: str
    values: Values
    limit: Values
    parts: Parts
    squared: bool = False
    margin: float = 0.0
    bars: bool = False
    cuts: tuple[float, ...] = ()

    def shares(self, response: OrderResponse) -> Array:
        """Values over their limits (speed,); infinite where there is no steady state."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = self.values(response) / self.limit(response)
        return np.where(np.isfinite(share), share, np.where(np.isinf(self.limit(response)), 0.0, np.inf))

    @property
    def quantity(self) -> SearchedQuantity:
        """What the search looks for: the largest share of the limit."""

        def parts(response: OrderResponse) -> Complex:
            limit = self.limit(response)[:, None]
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.asarray(self.parts(response) / (np.sqrt(limit) if self.squared else limit))

        level = 1 - self.margin if self.bars else inf
        return SearchedQuantity(self.shares, parts, self.squared, level, self._alike)

    @property
    def _alike(self) -> tuple[int, float] | None:
        """The spring whose torque by order makes up the shares, and the factor; None where more goes into them."""
        of, limit = self.parts, self.limit
        if self.squared or not isinstance(of, _TorqueParts) or not isinstance(limit, _Constant):
            return None
        return (of.spring, of.scale / limit.value) if 0 < limit.value < inf and of.scale > 0 else None


def measures(assembly: Assembly) -> Iterator[Measure]:
    """All that the checks of a line look at."""
    for limit in assembly.line.limits_by_element:
        if limit.key in OF_LIMITS and (found := of_limit(assembly, limit)):
            yield found
        elif limit.key == "ship_shaft":
            yield from of_ship_shaft(assembly, limit.element, limit.value)
    for name, element in assembly.line.parts:
        for key in element.ratings:
            if getattr(element, key) is not None:
                yield of_rating(assembly, name, key, getattr(element, key))
        if isinstance(element, GearPair):
            yield of_hammer(assembly, name)
        if isinstance(element, SlipClutch) and (carried := of_slip_clutch(assembly, name)):
            yield carried


def spring_of(assembly: Assembly, element: str) -> int:
    """The first of them, of most elements the only one."""
    return springs_of(assembly, element)[0]


def name_of(limit: OneLimit) -> str:
    """ "max torque of Shaft 2"."""
    return f"{limit.key.replace('_', ' ')} of {limit.element}"


@dataclass(frozen=True)
class _Constant:
    """The same limit at all speeds."""

    value: float

    def __call__(self, response: OrderResponse) -> Array:
        return np.full(len(response.speed), self.value)


@dataclass(frozen=True)
class _TorqueParts:
    """Amplitudes by order of the torque of a ``spring``, or of what is in proportion to it."""

    spring: int
    scale: float = 1.0

    def __call__(self, response: OrderResponse) -> Complex:
        return np.asarray(response.torque[:, :, self.spring] * self.scale)


def of_limit(assembly: Assembly, limit: OneLimit, table: Array | None = None) -> Measure | None:
    """Of a limit of the description; None where a ConstantSpeed holds the element. ``table`` (1 or speed, column): the
    packed numbers that responses are computed with, where they differ from the description's."""
    values, parts = limited(assembly, limit, assembly.table(1) if table is None else table)
    if limit.key in OF_DISKS and limit.element not in {name for _, name in assembly.topology.points}:
        return None
    bars = limit.key == "vibratory_torque"
    return Measure(
        name_of(limit), limit.element, values, _Constant(limit.value), parts, margin=limit.margin, bars=bars
    )  # fmt: skip


def limited(assembly: Assembly, limit: OneLimit, table: Array) -> tuple[Values, Parts]:
    """Values and amplitudes by order of what is limited."""
    if limit.key in OF_DISKS:
        return _of_disk(limit)
    c, *others = springs_of(assembly, limit.element)
    if limit.key in ("vibratory_torque", "transient_vibratory_torque", "max_torque"):
        of = _peak if limit.key == "max_torque" else _vibratory
        return _of_either((c, *others), of) if others else (partial(of, c=c), _TorqueParts(c))
    if limit.key == "max_stress":
        factor = _stress_factors(assembly, table, limit.element)
        return (
            lambda response: response.peak_torque[:, c] * factor,
            lambda response: response.torque[:, :, c] * factor[:, None],
        )
    share = _share(assembly, table, limit.element, c)
    return (
        lambda response: response.twist_range.largest[:, c] * share,
        lambda response: response.twist[:, :, c] * share[:, None],
    )


def _of_either(springs: tuple[int, ...], of: Callable[..., Array]) -> tuple[Values, Parts]:
    """The larger of the springs of one element, at each speed."""

    def each(response: OrderResponse) -> Array:
        return np.stack([of(response, c=c) for c in springs])

    def parts(response: OrderResponse) -> Complex:
        larger = each(response).argmax(axis=0)
        torque = response.torque[:, :, list(springs)]
        return np.asarray(np.take_along_axis(torque, larger[:, None, None], axis=2)[..., 0])

    return lambda response: np.asarray(each(response).max(axis=0)), parts


def _of_disk(limit: OneLimit) -> tuple[Values, Parts]:
    rates = 1 if limit.key == "max_speed_fluctuation" else 2

    def column(response: OrderResponse) -> int:
        return response.inertias.index(limit.element)

    def values(response: OrderResponse) -> Array:
        found = response.speed_fluctuation if rates == 1 else response.acceleration
        return np.asarray(found[:, column(response)])

    def parts(response: OrderResponse) -> Complex:
        turns = np.abs(response.angular_frequency) ** rates
        return np.asarray(response.rotation[:, :, column(response)] * turns)

    return values, parts


def _stress_factors(assembly: Assembly, table: Array, element: str) -> Array:
    """τ/T [1/m³] at the outside of a tube, (row,), at the rows of ``table``."""
    place = assembly.line.index(element)
    outer = table[:, assembly.packed.column(place, "outer_diameter")]
    bore = assembly.packed.column(place, "inner_diameter")
    inner = table[:, bore] if bore >= 0 else np.zeros(len(table))
    return tube_stress(outer, inner)


def _share(assembly: Assembly, table: Array, element: str, compliance: int) -> Array:
    """Share (row,) of the twist of shafts in series that falls on one of them: the softest twists most."""
    names = assembly.line.names
    shafts = assembly.topology.compliances[compliance].shafts
    torque = assembly.static_torque(table)[:, compliance]
    soft = {names[i]: 1 / shaft_stiffness(assembly, table, i, torque=torque) for i in shafts}
    return np.asarray(soft[element] / sum(soft.values()))


def of_rating(assembly: Assembly, name: str, key: str, rating: float) -> Measure:
    """Of a rating of a coupling, service factors included: those of the rated torque lower its limit."""
    c = spring_of(assembly, name)
    temperature, starting = service_factors(assembly, name)
    element = assembly.line.elements[assembly.line.index(name)]
    arm = element.arm if isinstance(element, CentrifugalPendulum) else 1.0
    reads: dict[str, tuple[Values, Parts]] = {
        "nominal_torque": (lambda r: np.abs(r.mean_torque[:, c]) * temperature, lambda r: 0 * r.torque[:, :, c]),
        "maximum_torque": (
            lambda r: r.peak_torque[:, c] * (temperature * starting),
            _TorqueParts(c, temperature * starting),
        ),
        "vibratory_torque": (
            lambda r: r.rated_torque[:, c],
            lambda r: r.torque[:, :, c] * r.frequency_factor,
        ),
        "largest_travel": (lambda r: r.twist_range.largest[:, c] * arm, lambda r: r.twist[:, :, c] * arm),
        "heat_rating": (lambda r: r.heat[:, c] * temperature, lambda r: r.heat_parts(c) * np.sqrt(temperature)),
    }
    return Measure(
        rating_name(name, key), name, *_with_limit(reads[key], allowed_by(rating, key, temperature)),
        squared=key == "heat_rating",
        margin=required_of(assembly, name),
    )  # fmt: skip


def allowed_by(rating: float, key: str, temperature: float) -> float:
    """What a rating leaves for the number it is compared with: T_KW is lowered by S_t, so that a rated torque is the
    same number wherever it is printed; others are compared as they are."""
    return rating / temperature if key == "vibratory_torque" else rating


def rating_name(name: str, key: str) -> str:
    """ "rated torque of coupling", "maximum torque rating of coupling": told from "max torque of coupling", a limit."""
    return f"{rating_words(key)}{' rating' if key in ('nominal_torque', 'maximum_torque') else ''} of {name}"


def rating_words(key: str) -> str:
    """What a rating is compared with: of T_KW the rated torque, S_f included, which no vibratory torque is."""
    return "rated torque" if key == "vibratory_torque" else key.replace("_", " ")


def _with_limit(read: tuple[Values, Parts], limit: float) -> tuple[Values, Values, Parts]:
    return read[0], _Constant(limit), read[1]


def of_hammer(assembly: Assembly, name: str) -> Measure:
    """Vibratory against mean torque of a mesh."""
    c = spring_of(assembly, name)
    return Measure(
        f"gear hammer in {name}", name,
        partial(_vibratory, c=c), lambda response: np.abs(response.mean_torque[:, c]),
        _TorqueParts(c), margin=required_of(assembly, name), bars=True,
    )  # fmt: skip


def of_slip_clutch(assembly: Assembly, name: str) -> Measure | None:
    """Torque of a slip clutch against its capacity; None where neither of its sides tells it."""
    found = clutch_torque(assembly, name)
    if found is None:
        return None
    margin = required_of(assembly, name)
    return Measure(f"capacity of {name}", name, found.peak, _Constant(found.holds), found.parts, margin=margin)


@dataclass(frozen=True)
class ShipShaft:
    """The numbers that the rule for ship shafts takes of one shaft: σ_B as it counts [MPa], d [mm], C_K, τ/T [1/m³],
    and the rated speed [rad/s]."""

    strength: float
    diameter: float
    factor: float
    per_torque: float
    rated: float

    def continuous(self, speed: Array) -> Array:
        """±τ_C (speed,) [Pa]; no limit beyond the rule's scope."""
        ratio = speed / self.rated
        allowed = [permissible_stress(self.strength, self.diameter, self.factor, float(one)) for one in ratio]
        return np.where(ratio <= HIGHEST + ROUNDING, 1e6 * np.array(allowed), inf)

    def transient(self, speed: Array) -> Array:
        """±τ_T (speed,) [Pa], where no bar is allowed ±τ_C."""
        allowed = self.continuous(speed)
        return np.where(speed / self.rated < NO_BAR, 1.7 * allowed / np.sqrt(self.factor), allowed)


def ship_shaft(assembly: Assembly, name: str, feature: str) -> ShipShaft | None:
    """Of a shaft with a design feature; None without a rated speed."""
    shaft, operation = assembly.line.elements[assembly.line.index(name)], assembly.line.operation
    if operation is None or operation.speed is None:
        return None
    assert isinstance(shaft, Shaft) and shaft.outer_diameter and shaft.tensile_strength
    alloyed = shaft.material in ALLOYED and not feature.startswith("propeller")
    return ShipShaft(
        min(shaft.tensile_strength / 1e6, 800 if alloyed else 600),
        shaft.outer_diameter * 1e3,
        SHIP_SHAFTS[feature],
        tube_stress(shaft.outer_diameter, shaft.inner_diameter or 0.0),
        operation.speed,
    )


def permissible_stress(strength: float, diameter: float, feature: float, ratio: float) -> float:
    """±τ_C [MPa] of σ_B [MPa] (as it counts), diameter [mm], C_K and λ."""
    size = 0.35 + 0.93 * diameter**-0.2
    return (strength + 160) / 18 * feature * size * (3 - 2 * ratio**2 if ratio < STEADY else 1.38)


def of_ship_shaft(assembly: Assembly, name: str, feature: str) -> Iterator[Measure]:
    """Continuous and transient stress of a ship's shaft; nothing without a rated speed."""
    numbers = ship_shaft(assembly, name, feature)
    if numbers is None:
        return
    jumps = (NO_BAR, STEADY, HIGHEST + ROUNDING)
    c, cuts = spring_of(assembly, name), tuple(n * numbers.rated * (1 + s * EDGE) for n in jumps for s in (-1, 1))
    title, stress = ship_name(name), partial(_vibratory, c=c, scale=numbers.per_torque)
    for end, limit, bars in (("", numbers.continuous, True), (", passing", numbers.transient, False)):
        yield Measure(
            title + end, name, stress, partial(_by_speed, limit), _TorqueParts(c, numbers.per_torque),
            margin=required_of(assembly, name), bars=bars, cuts=cuts,
        )  # fmt: skip


def _vibratory(response: OrderResponse, c: int, scale: float = 1.0) -> Array:
    return np.asarray(response.vibratory_torque[:, c] * scale)


def _peak(response: OrderResponse, c: int) -> Array:
    return np.asarray(response.peak_torque[:, c])


def _by_speed(limit: Callable[[Array], Array], response: OrderResponse) -> Array:
    return limit(response.speed)


def ship_name(name: str) -> str:
    """ "IACS UR M68 of Shaft 2"."""
    return f"IACS UR M68 of {name}"


def torque_measures(assembly: Assembly, asked: tuple[tuple[str, int], ...]) -> Iterator[Measure]:
    """The "peak" or "vibratory" torque of springs by their numbers, without a limit."""
    for word, c in asked:
        values = partial(_peak if word == "peak" else _vibratory, c=c)
        yield Measure(torque_name(word, c), "", values, _Constant(1.0), _TorqueParts(c))


def torque_name(word: str, spring: int) -> str:
    """Of a measure of ``torque_measures``."""
    return f"{word} torque of spring {spring}"
