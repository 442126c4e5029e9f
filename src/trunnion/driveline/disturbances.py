"""What happens to drivelines, by name: short circuits, starts of synchronous motors, bites, impacts, tip-ins, brakes.

Each is written out as torques and friction on one disk; what its formula needs is the user's, and there are no default
amplitudes. Where the torques of electrical faults come from, resistance and saliency left out (constant flux linkage):
the flux of the short-circuited stator stays where it is, the rotor turns on by θ = ωt, and is pulled back with

    three phases   T = (E²/x″) sin ωt
    two phases     T = (E²/x″)(sin ωt − ½ sin 2ωt)      at the worst instant,

over the rated torque, with E the voltage and x″ the subtransient reactance per unit. Resistance damps all components
and adds a unidirectional one (C. Concordia, "Electrical torque of turbine generators under short-circuit or
synchronizing conditions", names these three: unidirectional, at line frequency, at twice of that, all of them damped).

A synchronous motor that starts pulsates at twice the slip frequency: over time and its own angle φ, with p pole pairs
and a supply of ω, as cos(2(ωt − pφ)).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.quantities import Angle, Frequency, Maybe, Several, Speed, Time, Torque, optional
from trunnion.driveline.record import Record, WholeNumber, as_tuple, one_of
from trunnion.errors import InputError

Kind = Literal[
    "three-phase short circuit", "two-phase short circuit", "reclosure", "synchronous start", "bite and tail-out",
    "impacts", "tip-in", "back-out", "emergency brake",
]  # fmt: skip
_SHORT = ("frequency", "amplitude", "decay")
_MEAN = ("mean", "mean_decay", "lost", "until")
_TWICE = ("twice_amplitude", "twice_decay")
CASES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "three-phase short circuit": (_SHORT, _MEAN),
    "two-phase short circuit": ((*_SHORT, "twice_amplitude"), ("twice_decay", *_MEAN)),
    "reclosure": (
        (*_SHORT, "cleared", "reclosed", "reclosing_amplitude"), (*_TWICE, "lost", "reclosing_twice_amplitude"),
    ),
    "synchronous start": (("frequency", "pole_pairs", "speeds", "amplitudes"), ("phase", "until")),
    "bite and tail-out": (("torque", "rise", "until", "fall"), ()),
    "impacts": (("peaks", "width", "spacing"), ("angle",)),
    "tip-in": (("first", "last", "rise"), ()),
    "back-out": (("first", "last", "rise"), ()),
    "emergency brake": (("torque", "rise"), ("static",)),
}  # fmt: skip
"""What each case needs, and what it takes besides ``on`` and ``since``."""
TOGETHER = 16
"""Impacts in one formula."""
_TORQUES = as_tuple("torques", 'write peaks = ["900 N*m", "700 N*m"], say')
_SPEEDS = as_tuple("speeds", 'write speeds = ["0 rpm", "1450 rpm"], say')


class Disturbance(Record):
    """What happens to a disk, by its name.

    Parameters
    ----------
    on : name of the disk.
    case : "three-phase short circuit", "two-phase short circuit", "reclosure", "synchronous start",
        "bite and tail-out", "impacts", "tip-in", "back-out" or "emergency brake".
    since : [s] when it begins.
    frequency : of the supply [rad/s], ``"50 Hz"``.
    amplitude, decay : of the component at line frequency [N m], which resists first, and its time constant [s].
    twice_amplitude, twice_decay : of that at twice the line frequency; its time constant is ``decay`` by default.
    mean, mean_decay : of the unidirectional component [N m], positive where it resists, likewise.
    lost : torque [N m] of the machine that ends with the fault, positive where it resisted.
    until : [s] when a fault or a start ends; of a pass, when its fall begins.
    cleared, reclosed : [s] when a fault ends, and when the line is closed again.
    reclosing_amplitude, reclosing_twice_amplitude : of the components from then on [N m].
    pole_pairs, phase : of a synchronous motor, and of its pulsation at t = 0 and angle 0 [rad].
    speeds, amplitudes : of its pulsation over its own speed [rad/s, N m], straight between the points and even beyond.
    torque, rise, fall : of a pass [N m, s]: what it takes, positive where it resists, and how long it rises and falls;
        of a brake, its friction and how long it rises.
    static : of a brake, up to which it keeps the disk at rest [N m]; by default the same.
    first, last : of a tip-in or a back-out: the torque before and behind [N m], positive where it drives.
    peaks, width, spacing, angle : of impacts by the disk's own angle: torques [N m], positive where they resist, each a
        half-sine so wide [rad], from one to the next [rad], the first from ``angle`` on.

    Raises
    ------
    InputError : a key that its case needs is missing, or one that it has no use for is there; times that do not rise.

    Examples
    --------
    >>> import trunnion as tn
    >>> fault = tn.Disturbance(
    ...     on="generator", case="three-phase short circuit", frequency="50 Hz", amplitude="9 kN*m", decay="0.2 s"
    ... )
    >>> print(fault.torques[0].formula)
    -9000.0*exp(-t/0.2)*sin(314.1592653589793*t)
    """

    what: ClassVar[str] = "disturbance"
    example: ClassVar[str] = 'on = "mill" and case = "bite and tail-out"'

    on: str = Field(description="name of the disk that it acts on")
    case: Annotated[Kind, BeforeValidator(one_of(tuple(CASES), "is not a case", 'write "tip-in", say', near=True))] = (
        Field(description="what happens")
    )
    since: Time = optional(default=0.0, description="when it begins")
    frequency: Maybe[Frequency] = optional(default=None, description="of the supply")
    amplitude: Maybe[Torque] = optional(default=None, description="at line frequency, which resists first")
    decay: Maybe[Time] = optional(default=None, description="time constant of that")
    twice_amplitude: Maybe[Torque] = optional(default=None, description="at twice the line frequency")
    twice_decay: Maybe[Time] = optional(default=None, description="time constant of that")
    mean: Maybe[Torque] = optional(default=None, description="unidirectional component, positive where it resists")
    mean_decay: Maybe[Time] = optional(default=None, description="time constant of that")
    lost: Maybe[Torque] = optional(default=None, description="of the machine, which ends with the fault")
    until: Maybe[Time] = optional(default=None, description="when it ends, or begins to fall")
    cleared: Maybe[Time] = optional(default=None, description="when the fault ends")
    reclosed: Maybe[Time] = optional(default=None, description="when the line is closed again")
    reclosing_amplitude: Maybe[Torque] = optional(default=None, description="at line frequency from then on")
    reclosing_twice_amplitude: Maybe[Torque] = optional(default=None, description="at twice that from then on")
    pole_pairs: WholeNumber = Field(default=None, description="of a synchronous motor")
    phase: Angle = optional(default=0.0, description="of its pulsation at t = 0 and angle 0")
    speeds: Annotated[Several[Speed], BeforeValidator(_SPEEDS)] = optional(
        default=(), description="of the motor, at which amplitudes are stated"
    )
    amplitudes: Annotated[Several[Torque], BeforeValidator(_TORQUES)] = optional(
        default=(), description="of its pulsation at these speeds"
    )
    torque: Maybe[Torque] = optional(default=None, description="of a pass, or of a brake; positive resists")
    rise: Maybe[Time] = optional(default=None, description="how long it rises")
    fall: Maybe[Time] = optional(default=None, description="how long it falls")
    static: Maybe[Torque] = optional(default=None, description="up to which a brake keeps the disk at rest")
    first: Maybe[Torque] = optional(default=None, description="before; positive drives")
    last: Maybe[Torque] = optional(default=None, description="behind; positive drives")
    peaks: Annotated[Several[Torque], BeforeValidator(_TORQUES)] = optional(
        default=(), description="of the impacts; positive resists"
    )
    width: Maybe[Angle] = optional(default=None, description="of an impact, by the disk's own angle")
    spacing: Maybe[Angle] = optional(default=None, description="from one impact to the next")
    angle: Angle = optional(default=0.0, description="of the disk where the first impact begins")

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and where it acts."""
        if not isinstance(data.get("on"), str):
            return cls.what
        return f"{data['case']} on {data['on']}" if data.get("case") in tuple(CASES) else f"{cls.what} on {data['on']}"

    @model_validator(mode="after")
    def _whole(self) -> Disturbance:
        needed, taken = CASES[self.case]
        for key in needed:
            if getattr(self, key) in (None, ()):
                raise InputError("is missing", key=key, remedy=f"needed are {', '.join(needed)}")
        known = {"on", "case", *(() if self.case == "impacts" else ("since",)), *needed, *taken}
        fields = type(self).model_fields
        stray = next((key for key in fields if key not in known and getattr(self, key) != fields[key].default), None)
        if stray:
            remedy = f"it takes {', '.join((*needed, *taken))}"
            raise InputError("belongs to another case", key=stray, value=getattr(self, stray), remedy=remedy)
        self._check_signs()
        self._check_times()
        self._check_tables()
        return self

    def _check_signs(self) -> None:
        for key in ("frequency", "decay", "twice_decay", "mean_decay", "width", "spacing", "pole_pairs"):
            value = getattr(self, key)
            if value is not None and not value > 0:
                raise InputError("must be positive", key=key, value=value)
        for key in ("since", "rise", "fall", "torque" if self.case == "emergency brake" else "since"):
            value = getattr(self, key)
            if value is not None and value < 0:
                raise InputError("must not be negative", key=key, value=value)

    def _check_times(self) -> None:
        before, known = self.since + (self.rise or 0.0), "since" if self.rise is None else "since and rise"
        for key in ("cleared", "reclosed", "until"):
            value = getattr(self, key)
            if value is None:
                continue
            if not (value > before or (key == "until" and (self.rise or self.fall) and value == before)):
                raise InputError(f"must lie behind {known}", key=key, value=value, remedy="times count from t = 0")
            before, known = value, key

    def _check_tables(self) -> None:
        if len(self.speeds) != len(self.amplitudes):
            problem = f"must have one value for each of {len(self.speeds)} speeds, and has {len(self.amplitudes)}"
            raise InputError(problem, key="amplitudes", remedy="give one for each speed")
        for i, (a, b) in enumerate(zip(self.speeds, self.speeds[1:], strict=False)):
            if not b > a:
                raise InputError(
                    f"does not rise at point {i + 2}", key="speeds", value=b, remedy="put the lowest first"
                )
        if len(self.speeds) > TOGETHER:
            raise InputError(
                f"are more than {TOGETHER}", key="speeds", value=len(self.speeds), remedy="give fewer points"
            )
        if self.width is not None and self.spacing is not None and self.spacing < self.width:
            raise InputError("is less than width", key="spacing", value=self.spacing, remedy="impacts must not overlap")

    @property
    def torques(self) -> tuple[AppliedTorque, ...]:
        """It as torques on its disk."""
        match self.case:
            case "three-phase short circuit" | "two-phase short circuit":
                return self._fault(self.amplitude, self.twice_amplitude, self.mean, self.since, self.until, self.lost)
            case "reclosure":
                fault = self._fault(self.amplitude, self.twice_amplitude, None, self.since, self.cleared, None)
                again, twice = self.reclosing_amplitude, self.reclosing_twice_amplitude
                assert self.reclosed is not None
                gone = self._between(self.lost, self.since, self.reclosed)
                return (*fault, *gone, *self._fault(again, twice, None, self.reclosed, None, None))
            case "synchronous start":
                return (self._pulsation(),)
            case "impacts":
                return tuple(self._impacts())
            case "bite and tail-out":
                return (self._pass(),)
            case "tip-in" | "back-out":
                return (self._change(),)
        return ()

    @property
    def frictions(self) -> tuple[FrictionTorque, ...]:
        """It as dry friction on its disk."""
        if self.case != "emergency brake":
            return ()
        assert self.torque is not None and self.rise is not None
        return (
            FrictionTorque(on=self.on, torque=self.torque, static=self.static, since=self.since, rise=self.rise),
        )  # fmt: skip

    def _fault(
        self, amplitude: float | None, twice: float | None, mean: float | None, since: float, until: float | None,
        lost: float | None,
    ) -> tuple[AppliedTorque, ...]:  # fmt: skip
        """Decaying components from ``since`` on."""
        assert amplitude is not None and self.decay is not None and self.frequency is not None
        t = "t" if since == 0 else f"(t-{since!r})"
        parts = [f"-{_said(amplitude)}*exp(-{t}/{self.decay!r})*sin({self.frequency!r}*{t})"]
        if twice is not None:
            decay = self.twice_decay or self.decay
            parts.append(f"+{_said(twice)}*exp(-{t}/{decay!r})*sin({2 * self.frequency!r}*{t})")
        if mean is not None:
            parts.append(f"-{_said(mean)}*exp(-{t}/{self.mean_decay or self.decay!r})")
        own = AppliedTorque(on=self.on, formula="".join(parts), since=since or None, until=until)
        return (own, *self._between(lost, since, until))

    def _between(self, torque: float | None, since: float, until: float | None) -> tuple[AppliedTorque, ...]:
        """What drives more where a torque that resisted has ended."""
        if not torque:
            return ()
        times, torques = ([since, until], [torque, 0.0]) if until is not None else ([since], [torque])
        return (AppliedTorque(on=self.on, time=times, torque=torques, between="steps"),)

    def _pulsation(self) -> AppliedTorque:
        assert self.frequency is not None and self.pole_pairs is not None
        size, slopes = _said(self.amplitudes[0]), [0.0, *_slopes(self.speeds, self.amplitudes), 0.0]
        for speed, before, behind in zip(self.speeds, slopes, slopes[1:], strict=False):
            if behind != before:
                size += f"+{_said(behind - before)}*max(0,speed-{_said(speed)})"
        wave = f"cos(2*({self.frequency!r}*t-{self.pole_pairs}*angle)+{_said(self.phase)})"
        return AppliedTorque(on=self.on, formula=f"({size})*{wave}", since=self.since or None, until=self.until)

    def _impacts(self) -> Iterator[AppliedTorque]:
        assert self.width is not None and self.spacing is not None
        parts = [
            f"-{_said(peak)}*sin({pi / self.width!r}*{one})*step{one}*step({begin + self.width!r}-angle)"
            for k, peak in enumerate(self.peaks)
            for begin in (self.angle + k * self.spacing,)
            for one in (f"(angle-{_said(begin)})",)
        ]
        for k in range(0, len(parts), TOGETHER):
            yield AppliedTorque(on=self.on, formula="".join(parts[k : k + TOGETHER]))

    def _pass(self) -> AppliedTorque:
        assert None not in (self.torque, self.rise, self.until, self.fall)
        torque, until = -float(self.torque or 0.0), float(self.until or 0.0)
        full, over = self.since + float(self.rise or 0.0), until + float(self.fall or 0.0)
        points = [(self.since, 0.0), (full, torque), (until, torque), (over, 0.0)]
        return _over_time(self.on, points)

    def _change(self) -> AppliedTorque:
        assert self.first is not None and self.last is not None and self.rise is not None
        return _over_time(self.on, [(self.since, self.first), (self.since + self.rise, self.last)])


def _said(number: float) -> str:
    return repr(float(number)) if number >= 0 else f"({float(number)!r})"


def _slopes(points: Sequence[float], values: Sequence[float]) -> list[float]:
    pairs = zip(points, points[1:], values, values[1:], strict=False)
    return [(d - c) / (b - a) for a, b, c, d in pairs]


def _over_time(on: str, points: Sequence[tuple[float, float]]) -> AppliedTorque:
    """Straight between times and torques, the ends lasting; a point that repeats another is left out."""
    kept = [one for k, one in enumerate(points) if k == 0 or one != points[k - 1]]
    return AppliedTorque(on=on, time=[time for time, _ in kept], torque=[torque for _, torque in kept], hold=True)
