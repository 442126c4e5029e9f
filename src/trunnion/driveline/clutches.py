"""A clutch or torsional damper: springs, with stages or not, and dry friction beside them."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import positive
from trunnion.driveline.quantities import (
    ANGLE,
    FREQUENCY,
    TORQUE,
    Angle,
    Frequency,
    Maybe,
    QuantityKind,
    Several,
    Stiffness,
    TableList,
    Torque,
    optional,
    parse,
)
from trunnion.driveline.record import Record, listed
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.stages import PiecewiseShaft, quantities
from trunnion.errors import InputError

MOST_SLIDERS = 8


class Slider(Record):
    """A Jenkins element: a spring in series with a slider that slips where it would carry more than its torque.

    Parameters
    ----------
    torque : T that the slider holds [N m].
    stiffness : k of its spring [N m/rad].

    >>> Slider(torque="6 N*m", stiffness=4000.0).torque
    6.0
    """

    what: ClassVar[str] = "friction"
    example: ClassVar[str] = 'torque = "15 N*m" and stiffness = "5 kN*m/rad"'

    torque: Torque = Field(description="friction torque, at which it slips")
    stiffness: Stiffness = Field(description="of the spring in series with the slider")

    @model_validator(mode="after")
    def _positive(self) -> Self:
        for key, example in (("torque", "15 N*m"), ("stiffness", "5 kN*m/rad")):
            if not getattr(self, key) > 0:
                raise InputError(
                    "must be positive", key=key, value=getattr(self, key), remedy=f'write "{example}", say'
                )
        return self


READ_SLIDERS = listed(Slider, "slider")


def _sliders(value: object) -> tuple[Slider, ...]:
    made = READ_SLIDERS(value)
    if not 1 <= len(made) <= MOST_SLIDERS:
        remedy = 'write friction = [{ torque = "15 N*m", stiffness = "5 kN*m/rad" }]'
        raise InputError(f"must be from 1 to {MOST_SLIDERS} sliders", value=len(made), remedy=remedy)
    return made


class Clutch(PiecewiseShaft):
    """A spring with dry friction beside it: the disk of a clutch, a torsional damper, a hose of steel wire.

    Its torque is that of the spring, one slope or stage by stage as in a ``PiecewiseShaft``, and that of all sliders:
    what it carries depends on where it has been (hysteresis).

    Parameters
    ----------
    friction : the sliders in parallel, each a ``Slider`` of torque and stiffness; those that slip one after the other
        round the loop.
    stiffnesses : of the spring [N m/rad]: one, or below, between and above the breakpoints; 0 for none.
    breakpoints : twists at which its stiffness changes [rad], rising; none by default.
    damping, damping_law, fork_offset : as of a ``PiecewiseShaft``.
    linear_amplitude, linear_frequency : the motion [rad], [rad/s] at which linear analyses take its mean stiffness and
        loss (see ``linear``); without them they refuse it.

    >>> disk = Clutch(stiffnesses=[800.0], friction=[{"torque": 6.0, "stiffness": 4000.0}])
    >>> print(round(disk.lost_per_cycle("1 deg"), 4))
    0.3829
    """

    example: ClassVar[str] = (
        'stiffnesses = ["800 N*m/rad"] and friction = [{ torque = "6 N*m", stiffness = "4 kN*m/rad" }]'
    )
    fewest_breakpoints: ClassVar[int] = 0
    slack: ClassVar[bool] = True

    breakpoints: Annotated[Several[Angle], BeforeValidator(quantities)] = optional(
        default=(), description="twists at which the stiffness of the spring changes, rising; none by default"
    )
    friction: Annotated[TableList[Slider], BeforeValidator(_sliders)] = Field(
        description="sliders in parallel with the spring, each with a spring of its own"
    )
    linear_amplitude: Maybe[Angle] = optional(
        default=None, description="swing at which linear analyses take its mean stiffness and loss"
    )
    linear_frequency: Maybe[Frequency] = optional(default=None, description="of that swing")

    @model_validator(mode="after")
    def _linear_at_one_motion(self) -> Self:
        positive(self, "linear_amplitude", "linear_frequency")
        for key, other, example in (
            ("linear_amplitude", "linear_frequency", "1 deg"),
            ("linear_frequency", "linear_amplitude", "30 Hz"),
        ):
            if getattr(self, key) is None and getattr(self, other) is not None:
                raise InputError(f"is needed with {other}", key=key, remedy=f'write {key} = "{example}", say')
        return self

    def lost_per_cycle(self, amplitude: float | str) -> float:
        """Energy [J] that its friction takes in a cycle of the twist between ± ``amplitude`` [rad]."""
        from trunnion.laws import friction

        size = _positive(amplitude, ANGLE, "amplitude")
        return sum(float(friction.lost_per_cycle(s.torque, s.stiffness, size)) for s in self.friction)

    def linear(
        self, amplitude: float | str | None = None, frequency: float | str | None = None, torque: float | str = 0.0
    ) -> Shaft:
        """A Shaft with the stiffness and damping that the clutch has on average at one motion, for linear analyses."""
        stiffness, damping, offset = self.mean(amplitude, frequency, torque)
        return Shaft(stiffness=stiffness, damping=damping, fork_offset=offset, name=self.name, after=self.after)

    def mean(
        self, amplitude: float | str | None = None, frequency: float | str | None = None, torque: float | str = 0.0
    ) -> tuple[float, float, float]:
        """Stiffness [N m/rad], damping [N m s/rad] and fork offset [rad] of what it is on average at one motion.

        Harmonic linearisation about the twist at which the spring carries ``torque`` [N m] on average: the torque in
        phase with a swing of ± ``amplitude`` [rad] over it, and the damping that takes as much energy at ``frequency``
        [rad/s]; by default those that it states, ``linear_amplitude`` and ``linear_frequency``. It holds at that
        motion; the linear analyses do not know how large their motion is, so compare (``tn.linearity_check``).
        """
        import numpy as np

        from trunnion.laws import friction
        from trunnion.laws.spring import StageSpring

        amplitude = self.linear_amplitude if amplitude is None else amplitude
        frequency = self.linear_frequency if frequency is None else frequency
        if amplitude is None or frequency is None:
            remedy = 'write clutch.linear(amplitude="1 deg", frequency="30 Hz")'
            raise InputError("is not stated", element=self.kind, key="linear_amplitude", remedy=remedy)
        size, rate = _positive(amplitude, ANGLE, "amplitude"), _positive(frequency, FREQUENCY, "frequency")
        mean = parse(torque, TORQUE)
        spring = StageSpring(np.array(self.breakpoints), np.array(self.stiffnesses))
        middle = friction.middle_under(spring, mean, size)
        if np.isnan(middle):
            raise InputError(
                f"has no stage that carries {mean:g} N m: it slips", element=self.name or self.kind, key="stiffnesses",
                remedy="raise the torque at which it slips, or ask for a smaller one",
            )  # fmt: skip
        stiffness = float(friction.over_a_cycle(spring, middle, size)[1])
        stiffness += sum(float(friction.mean_stiffness(s.torque, s.stiffness, size)) for s in self.friction)
        viscous = self.damping
        if self.damping_law == "in contact":
            stages = np.arange(len(self.stiffnesses)) != int(np.argmin(self.stiffnesses))
            viscous *= float(friction.damped_share(spring, stages, middle, np.array(size)))
        damping = viscous + self.lost_per_cycle(size) / (np.pi * size**2 * rate)
        return stiffness, damping, self.fork_offset + float(middle) - mean / stiffness


def _positive(value: float | str, kind: QuantityKind, key: str) -> float:
    found = parse(value, kind)
    if not found > 0:
        raise InputError("must be positive", element="Clutch", key=key, value=value, remedy=f'write "{kind.example}"')
    return found
