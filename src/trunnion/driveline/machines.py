"""Machines at the ends of a line: motors and generators with their torque over speed, fans, pumps and propellers.

A machine turns with the shaft it hangs on and has one inertia. Its mean torque is a curve over its own speed
(``trunnion.laws.torque_curve``), whose slope damps, or where it has the other sign drives, what swings about the mean.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.curve_points import POINTS, Curve, table_curve
from trunnion.driveline.elements import Doubt, Rotor, not_negative, positive
from trunnion.driveline.excitation import Excitations
from trunnion.driveline.quantities import (
    Damping,
    Dimensionless,
    Frequency,
    Inertia,
    Maybe,
    Power,
    QuadraticLoad,
    Speed,
    Torque,
    optional,
)
from trunnion.driveline.record import WholeNumber
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.parts import Numbers
    from trunnion.laws.torque_curve import TableCurve, TorqueCurve

KLOSS = ("breakdown_torque", "breakdown_slip", "synchronous_speed")
"""Numbers of Kloss's formula."""

NOTHING = 1e-15
"""Times its torque: none of a machine that idles."""


class Machine(Rotor):
    """What machines have in common.

    Parameters
    ----------
    inertia : of all that turns with its shaft [kg m²].
    curve : points of its torque over its speed, each a speed [rad/s] and a torque [N m], two or more, rising in speed
        from 0 or above; in a file also the name of a CSV table beside it, see ``read_curve``. Between the points
        follows a monotone cubic; beyond them it is refused.
    excitation : harmonic torques besides, see ``Excitation``; ``share`` gives one by the mean torque.
    """

    ways: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """The keys of each way to state its torque, of which one is stated."""
    beside: ClassVar[tuple[str, ...]] = ()
    """A way by itself that may also go beside others, ``curve`` aside."""
    torque_keys: ClassVar[tuple[str, ...]] = ()
    """Numbers that all of its torque is proportional to, ``curve`` aside."""

    inertia: Inertia = Field(description="of all that turns with its shaft")
    curve: Curve = optional(default=(), description="points of its torque over its speed")
    excitation: Excitations = optional(default=(), description="harmonic torques, in time or in its rotation")

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """As stated."""
        return (number("inertia"),)

    @model_validator(mode="after")
    def _one_torque(self) -> Self:
        positive(self, "inertia")
        begun = [keys for keys in self.ways if any(self._states(key) for key in keys)]
        if not begun:
            raise InputError("is missing", key=self.ways[0][0], remedy=f"write {self.example}, or {POINTS}")
        alone = [keys for keys in begun if keys != self.beside]
        begun = alone if alone and alone != [("curve",)] else begun
        first = next(key for key in begun[0] if self._states(key))
        if len(begun) > 1:
            other = next(key for key in begun[1] if self._states(key))
            raise InputError(f"conflicts with {first}", key=other, remedy=f"leave out {other} or {first}")
        missing = next((key for key in self._needed(begun[0]) if not self._states(key)), None)
        if missing:
            needed = ", ".join(self._needed(begun[0]))
            raise InputError(f"is needed with {first}", key=missing, remedy=f"needed are {needed}")
        return self

    def _states(self, key: str) -> bool:
        return getattr(self, key) != type(self).model_fields[key].default

    def _needed(self, keys: tuple[str, ...]) -> tuple[str, ...]:
        """Those of a way that must be stated."""
        return keys

    @cached_property
    def table(self) -> TableCurve:
        """The curve through its points."""
        return table_curve(self.curve)

    def with_torque_times(self, factor: float) -> Self:
        """The same with ``factor`` times its torque at every speed; with 0 what is left of it is below rounding, as a
        machine has a torque of its own kind."""
        factor = factor or NOTHING
        changes: dict[str, Any] = {key: factor * getattr(self, key) for key in self.torque_keys if getattr(self, key)}
        if self.curve:
            changes["curve"] = [one.but(torque=factor * one.torque) for one in self.curve]
        return self.but(**changes)


class ElectricMachine(Machine):
    """A motor or a generator; its torque is stated in one of these ways.

    Parameters
    ----------
    breakdown_torque, breakdown_slip, synchronous_speed : of an asynchronous machine on its mains by Kloss's formula
        [N m, 1, rad/s].
    gain, set_speed, torque_limit : of a converter that controls the speed: gain · (set_speed − speed), at most the
        limit of either sign [N m s/rad, rad/s, N m].
    corner_frequency : first-order lag of the torque behind the speed: torques at a frequency ν follow by
        1/(1 + iν/ν_c) [rad/s]; of a converter the bandwidth of its inner (torque or current) loop. By default that of
        Kloss's machine where ``pole_pairs`` are stated, s_b times the angular frequency of its supply, else no lag.
    pole_pairs : of an asynchronous machine: its supply has pole_pairs times the synchronous speed.
    """

    breakdown_torque: Maybe[Torque] = optional(default=None, description="largest torque, at the breakdown slip")
    breakdown_slip: Maybe[Dimensionless] = optional(default=None, description="slip at the largest torque")
    synchronous_speed: Maybe[Speed] = optional(default=None, description="speed without slip")
    pole_pairs: WholeNumber = Field(default=None, description="of an asynchronous machine, which give its lag")
    gain: Maybe[Damping] = optional(default=None, description="of a speed controller, torque over speed")
    set_speed: Maybe[Speed] = optional(default=None, description="that the controller aims at")
    torque_limit: Maybe[Torque] = optional(default=None, description="of the converter, of either sign")
    corner_frequency: Maybe[Frequency] = optional(
        default=None, description="above which the torque lags behind the speed, of the inner loop of a converter"
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        positive(self, "breakdown_torque", "synchronous_speed", "gain", "set_speed", "torque_limit", "corner_frequency")
        slip = self.breakdown_slip
        if slip is not None and not 0 < slip < 1:
            remedy = "write 0.15, say: slip over the synchronous speed"
            raise InputError("must lie between 0 and 1", key="breakdown_slip", value=slip, remedy=remedy)
        if self.pole_pairs is not None and not 1 <= self.pole_pairs <= 1000:
            raise InputError("must be 1 or more", key="pole_pairs", value=self.pole_pairs, remedy="write 2, say")
        if self.pole_pairs is not None and self.breakdown_torque is None:
            remedy = "leave it out, or write breakdown_torque, breakdown_slip and synchronous_speed"
            raise InputError("belongs to Kloss's formula", key="pole_pairs", value=self.pole_pairs, remedy=remedy)
        return self

    def _drives(self, number: Numbers) -> TorqueCurve:
        """What it drives with over its speed."""
        from trunnion.laws.torque_curve import ClippedLine, KlossCurve

        if self.curve:
            return self.table
        if self.breakdown_torque is not None:
            return KlossCurve(*(number(key) for key in KLOSS))
        limit = number("torque_limit") if self.torque_limit is not None else float("inf")
        return ClippedLine(number("gain"), number("set_speed"), limit)

    def corner(self, number: Numbers) -> Any:
        """Frequency [rad/s] above which its torque lags; None where it never does."""
        if self.corner_frequency is not None:
            return number("corner_frequency")
        if self.pole_pairs is None:
            return None
        return number("breakdown_slip") * number("synchronous_speed") * self.pole_pairs

    @property
    def lag_frequency(self) -> float | None:
        """The same as described."""
        found = self.corner(lambda key: getattr(self, key))
        return None if found is None else float(found)


class Motor(ElectricMachine):
    """A motor: by points of its torque over speed, by Kloss's formula, or on a converter that controls its speed.

    It drives by its curve, so that a free–free line turns at a balance of torques (``mean_speed``). With a
    ``drive_share`` a converter sets it to any speed asked for. It moves Kloss's curve along the speed until the motor
    carries its share of the loads (voltage and frequency in proportion), or a controller's set speed likewise. More
    than the breakdown torque or the torque limit is refused. Linear analyses have the slope there.

    Parameters
    ----------
    inertia, curve, excitation : as of a ``Machine``; torques of the curve are positive where it drives. Ripple orders
        are excitations; a torque at n times the slip frequency of p pole pairs has order −n p and frequency n times
        that of the supply (n = 2 at the start of a synchronous motor).
    breakdown_torque, breakdown_slip, synchronous_speed, pole_pairs : as of an ``ElectricMachine``.
    gain, set_speed, torque_limit, corner_frequency : likewise.
    drive_share : share of the power that balances the loads at the mean speed asked for, relative to other drives'.

    >>> motor = Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    >>> round(float(motor.load.value(motor.synchronous_speed * 0.8)), 9)  # resists by
    -500.0
    """

    example: ClassVar[str] = 'breakdown_torque = "500 N*m", breakdown_slip = 0.2 and synchronous_speed = "1500 rpm"'
    ways: ClassVar[tuple[tuple[str, ...], ...]] = (KLOSS, ("curve",), ("gain", "set_speed", "torque_limit"))

    drive_share: Dimensionless = optional(
        default=0.0, description="share of the power that balances the loads, where a converter sets its speed"
    )

    @model_validator(mode="after")
    def _one_speed(self) -> Self:
        not_negative(self, "drive_share")
        if self.drive_share and self.curve:
            remedy = "leave it out: the line turns where its curve balances the loads"
            raise InputError("conflicts with curve", key="drive_share", value=self.drive_share, remedy=remedy)
        if self.drive_share and self.set_speed is not None:
            remedy = "leave out set_speed, which then follows the speed asked for, or drive_share"
            raise InputError("conflicts with set_speed", key="drive_share", value=self.drive_share, remedy=remedy)
        return self

    def _needed(self, keys: tuple[str, ...]) -> tuple[str, ...]:
        return ("gain",) if keys[0] == "gain" and self.drive_share else keys[:2] if keys[0] == "gain" else keys

    @property
    def set(self) -> bool:
        """Whether a converter sets it to the speed asked for."""
        return self.drive_share > 0

    def load_of(self, number: Numbers) -> TorqueCurve:
        """Minus what it drives with; nothing where its speed is set, for its share comes from the balance."""
        from trunnion.laws.torque_curve import Opposite, PowerCurve

        return PowerCurve() if self.set else Opposite(self._drives(number))

    def set_slope(self, number: Numbers, torque: Any) -> Any:
        """Slope [N m s/rad] of its load where a converter sets it to drive with ``torque`` [N m], one or many; NaN
        beyond what it can."""
        import numpy as np

        from trunnion.laws.torque_curve import KlossCurve

        if self.breakdown_torque is not None:
            return -KlossCurve(*(number(key) for key in KLOSS)).slope_at_torque(torque)
        within = np.abs(torque) <= (number("torque_limit") if self.torque_limit is not None else np.inf)
        return np.where(within, number("gain"), np.nan)

    @property
    def most(self) -> tuple[str, float] | None:
        """Key and value [N m] of the largest torque that a converter can set it to."""
        key = "breakdown_torque" if self.breakdown_torque is not None else "torque_limit"
        limit = getattr(self, key)
        return None if limit is None else (key, float(limit))

    @property
    def tangent(self) -> bool:
        """Always: also the slope of one whose speed is set."""
        return True


class Generator(ElectricMachine):
    """A generator: by points of its torque over speed, by Kloss's formula above its synchronous speed, at constant
    power, or on a converter.

    Parameters
    ----------
    inertia, curve, excitation : as of a ``Machine``; torques of the curve are positive where it resists.
    breakdown_torque, breakdown_slip, synchronous_speed, pole_pairs : as of an ``ElectricMachine``.
    gain, set_speed, torque_limit, corner_frequency : likewise; the controller resists by gain · (speed − set_speed).
    power : that its converter takes at any speed [W]: the torque P/ω falls with the speed, which drives what swings.

    >>> generator = Generator(inertia=0.4, power="30 kW")
    >>> round(float(generator.load.slope(150.0)), 6)
    -1.333333
    """

    example: ClassVar[str] = 'power = "30 kW"'
    ways: ClassVar[tuple[tuple[str, ...], ...]] = (("power",), ("curve",), KLOSS, ("gain", "set_speed", "torque_limit"))

    torque_keys: ClassVar[tuple[str, ...]] = ("power", "breakdown_torque", "gain", "torque_limit")

    power: Maybe[Power] = optional(default=None, description="taken at any speed by its converter")

    @model_validator(mode="after")
    def _some_power(self) -> Self:
        positive(self, "power")
        return self

    def _needed(self, keys: tuple[str, ...]) -> tuple[str, ...]:
        return keys[:2] if keys[0] == "gain" else keys

    def load_of(self, number: Numbers) -> TorqueCurve:
        """What it resists with."""
        from trunnion.laws.torque_curve import Opposite, PowerLimit

        if self.power is not None:
            return PowerLimit(number("power"))
        return self.table if self.curve else Opposite(self._drives(number))


class Consumer(Machine):
    """A machine that a line drives: its torque resists, by powers of its speed or by points.

    Parameters
    ----------
    rated_power, rated_speed : the torque goes with the square of the speed and takes this power at that speed [W,
        rad/s], a constant ``load_torque`` included; or else
    load_torque, viscous_load, quadratic_load : constant torque [N m], torque over speed [N m s/rad] and over its square
        [N m s²/rad²].
    """

    example: ClassVar[str] = 'rated_power = "30 kW" and rated_speed = "1480 rpm"'
    beside: ClassVar[tuple[str, ...]] = ("load_torque",)
    torque_keys: ClassVar[tuple[str, ...]] = ("rated_power", "load_torque", "viscous_load", "quadratic_load")
    ways: ClassVar[tuple[tuple[str, ...], ...]] = (
        ("rated_power", "rated_speed"), ("quadratic_load", "viscous_load"), ("load_torque",), ("curve",)
    )  # fmt: skip

    rated_power: Maybe[Power] = optional(default=None, description="taken at the rated speed")
    rated_speed: Maybe[Speed] = optional(default=None, description="at which it takes the rated power")
    load_torque: Torque = optional(default=0.0, description="constant part of its torque")
    viscous_load: Damping = optional(default=0.0, description="torque per speed")
    quadratic_load: QuadraticLoad = optional(default=0.0, description="torque per square of the speed")

    @model_validator(mode="after")
    def _possible(self) -> Self:
        positive(self, "rated_power", "rated_speed")
        not_negative(self, "load_torque", "viscous_load", "quadratic_load")
        if self.rated_power is not None and self.rated_speed is not None and self.load_torque:
            most = self.rated_power / self.rated_speed
            if self.load_torque > most:
                problem = f"is more than the {most:.6g} N m that rated_power and rated_speed make"
                remedy = "check the units"
                raise InputError(problem, key="load_torque", value=self.load_torque, remedy=remedy)
        return self

    def _needed(self, keys: tuple[str, ...]) -> tuple[str, ...]:
        return keys if keys[0] == "rated_power" else ()

    def load_of(self, number: Numbers) -> TorqueCurve:
        """What it resists with."""
        from trunnion.laws.torque_curve import PowerCurve

        if self.curve:
            return self.table
        return PowerCurve(number("load_torque"), number("viscous_load"), self._quadratic(number))

    def _quadratic(self, number: Numbers) -> Any:
        """c₂ [N m s²/rad²]."""
        if self.rated_power is None:
            return number("quadratic_load")
        speed = number("rated_speed")
        return (number("rated_power") / speed - number("load_torque")) / speed**2


class Fan(Consumer):
    """A fan or blower; its blades are an excitation by order, ``{ order = 8, share = 0.03 }`` of the mean torque, say.

    Parameters
    ----------
    inertia, curve, excitation : as of a ``Machine``; torques of the curve are positive and resist.
    rated_power, rated_speed, load_torque, viscous_load, quadratic_load : as of a ``Consumer``; load_torque is that of
        its bearings.

    >>> fan = Fan(inertia=3.0, rated_power="30 kW", rated_speed="1480 rpm")
    >>> round(float(fan.load.value(fan.rated_speed)), 4)
    193.5668
    """


class Pump(Consumer):
    """A pump: centrifugal by the square of the speed, displacement by a constant torque; its vanes or pistons are an
    excitation by order.

    Parameters
    ----------
    inertia, curve, excitation : as of a ``Machine``; torques of the curve are positive and resist.
    rated_power, rated_speed, load_torque, viscous_load, quadratic_load : as of a ``Consumer``; load_torque is pressure
        times displacement per radian.

    >>> pump = Pump(inertia=0.3, load_torque="120 N*m", viscous_load=0.2)
    >>> print(float(pump.load.value(50.0)))
    130.0
    """


class Propeller(Consumer):
    """A ship's propeller: torque by the square of the speed, entrained water, and its own damping.

    About a mean speed the ship does not follow: with Q = K_Q(J) ρ n² D⁵ and J = V/(nD) at constant speed of advance V,
    as open-water diagrams define K_Q and J,

        dQ/dω = a Q/ω,   a = 2 − J K_Q′(J)/K_Q(J),

    more than 2, as K_Q falls with J. Without a number from the diagram it is 2, the slope of the square itself. This is
    quasi-steady: the flow is taken to follow the blades at once.

    Parameters
    ----------
    inertia, curve, excitation : as of a ``Machine``, the inertia of the propeller dry. Blade orders are
        ``{ order = 4, share = 0.08 }``, say: a share of the mean torque.
    rated_power, rated_speed, load_torque, viscous_load, quadratic_load : as of a ``Consumer``.
    entrained_inertia : of the water that turns with it [kg m²], added to its own.
    damping_factor : a of the formula; by default 2.

    >>> propeller = Propeller(inertia=60.0, entrained_inertia=15.0, quadratic_load=20.0, damping_factor=3.0)
    >>> propeller.moment_of_inertia, float(propeller.load.value(10.0)), float(propeller.load.slope(10.0))
    (75.0, 2000.0, 600.0)
    """

    example: ClassVar[str] = 'rated_power = "900 kW" and rated_speed = "300 rpm"'

    entrained_inertia: Inertia = optional(default=0.0, description="of the water that turns with it")
    damping_factor: Maybe[Dimensionless] = optional(
        default=None, description="a of the slope a T/ω at constant speed of advance; 2 by default"
    )

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        not_negative(self, "entrained_inertia")
        positive(self, "damping_factor")
        linear = next((key for key in ("curve", "load_torque", "viscous_load") if getattr(self, key)), None)
        if self.damping_factor is not None and linear:
            remedy = (
                f"leave out one of the two: it multiplies a torque by the square of the speed, and {linear} is none"
            )
            value = self.damping_factor
            raise InputError(f"conflicts with {linear}", key="damping_factor", value=value, remedy=remedy)
        return self

    def doubts(self) -> Iterator[Doubt]:
        yield from super().doubts()
        if self.damping_factor is not None and self.damping_factor < 2:
            problem = "is less than 2, as if the torque coefficient rose with the speed of advance"
            yield "damping_factor", problem, "check a = 2 - J K_Q'(J)/K_Q(J) of the open-water diagram"

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of itself and the water."""
        return (number("inertia") + number("entrained_inertia"),)

    def load_of(self, number: Numbers) -> TorqueCurve:
        """What it resists with."""
        from trunnion.laws.torque_curve import FlowCurve

        if self.damping_factor is None:
            return super().load_of(number)
        return FlowCurve(self._quadratic(number), number("damping_factor"))


def lagging(parts: Iterable[tuple[str, object]]) -> list[str]:
    """Names of the machines among named ``parts`` whose torque lags behind the speed."""
    return [name for name, one in parts if isinstance(one, ElectricMachine) and one.lag_frequency is not None]
