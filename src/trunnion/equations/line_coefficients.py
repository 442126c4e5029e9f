"""The numbers that the equations of a line hold, one row per case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Complex, Places
from trunnion.driveline.dampers import ViscousDamper
from trunnion.laws.harmonic import Harmonic
from trunnion.laws.joint import JointLaw


@dataclass(frozen=True)
class MeshWave:
    """A mesh's stiffness over its mean, as a factor of one compliance's: 1 + its ``harmonics`` (case,), whose
    amplitudes are shares of the mean."""

    compliance: int
    harmonics: tuple[Harmonic, ...]

    def at(self, tau: Array) -> Array:
        """The factor (case, time) at input angles ``tau`` (time,) or (case, time) [rad]."""
        return np.asarray(1 + sum(one.at(np.asarray(tau)) for one in self.harmonics))


@dataclass(frozen=True)
class TorqueLag:
    """A part of the slope of the torque at a ``station`` that follows the speed with a lag: at a frequency ν
    slope/(1 + iν/corner), ``slope`` (case,) [N m s/rad] and ``corner`` (case,) [rad/s]."""

    station: int
    slope: Array
    corner: Array

    def added(self, frequency: Array) -> Complex:
        """What it adds (…, case) [N m/rad] to iν slope at ``frequency`` (…, case) [rad/s]."""
        turned = 1j * frequency / self.corner
        return np.asarray(-1j * frequency * self.slope * turned / (1 + turned))


@dataclass(frozen=True)
class OilLink:
    """Oil in a ``compliance`` by its complex stiffness; ``temperature``, and the ``stiffness`` and ``damping`` that
    stand for it in equations in time (case,)."""

    compliance: int
    damper: ViscousDamper
    temperature: Array
    stiffness: Array
    damping: Array

    def added(self, frequency: Array) -> Complex:
        """What it has beyond those [N m/rad] at ``frequency`` (…, case) [rad/s] of either sign; nothing at rest.

        Raises
        ------
        InputError : a frequency beyond its points.
        """
        found = np.zeros(frequency.shape, dtype=complex)
        moves = frequency != 0
        at, temperature, k, c = (
            np.broadcast_to(one, frequency.shape)[moves]
            for one in (frequency, self.temperature, self.stiffness, self.damping)
        )
        found[moves] = self.damper.complex_stiffness(at, temperature) - (k + 1j * at * c)
        return found

    def take(self, rows: Places | slice) -> OilLink:
        """At some of its cases."""
        if len(self.temperature) == 1:
            return self
        return replace(
            self, temperature=self.temperature[rows], stiffness=self.stiffness[rows], damping=self.damping[rows]
        )


def oil_in_turn(links: Sequence[OilLink], cases: Sequence[int]) -> OilLink:
    """One damper's oil at so many cases of each."""

    def along(key: str) -> Array:
        return np.concatenate([np.broadcast_to(getattr(one, key), n) for one, n in zip(links, cases, strict=True)])

    return replace(links[0], temperature=along("temperature"), stiffness=along("stiffness"), damping=along("damping"))


@dataclass(frozen=True)
class CrossDamping:
    """Torque that resists at station ``on`` by ``slope`` (case,) [N m s/rad] times the speed of station ``by``; where
    the torque of a ``compliance`` is asked for, it counts there."""

    on: int
    by: int
    slope: Array
    compliance: int | None = None


@dataclass(frozen=True)
class LineCoefficients:
    """What the equations of a line need, one row per case (axes: case, then as named).

    speed [rad/s]; stiffness [N m/rad], damping [N m s/rad], torque and twist of the static state [N m, rad] per
    compliance; inertia [kg m²] per station; load [N m], viscous [N m s/rad] and quadratic [N m s²/rad²] per
    station: its outer torque is load + viscous ω + quadratic ω|ω| against the mean sense of rotation, what a
    drive_share carries included in ``load``; not_carried [N m] per station: its mean where the line is taken
    untwisted, a base state in which no torque acts (0 otherwise); ``joints``: the law of each joint, its numbers
    (case, 1); ``shift`` [rad] per station: what a shaft adds to the angle at its far end (fork offset and static
    twist), and what a joint subtracts from its input angle to measure it from its own plane. ``loss`` [N m/rad] per
    compliance is ηk where a loss factor holds at all frequencies: the stiffness is then k + i·loss·sgn(frequency).
    ``waves``: meshes whose stiffness varies about the one given here. ``lags``: of the slopes in ``viscous``, those
    that lag; only forced responses of straight lines have them. ``across``: of torque converters, what their links do
    not have. ``oils``: dampers whose oil forced responses of straight lines have at their own frequency.
    """

    speed: Array
    stiffness: Array
    damping: Array
    torque: Array
    twist: Array
    inertia: Array
    load: Array
    viscous: Array
    quadratic: Array
    not_carried: Array
    joints: tuple[JointLaw, ...]
    shift: Array
    loss: Array
    waves: tuple[MeshWave, ...] = ()
    lags: tuple[TorqueLag, ...] = ()
    across: tuple[CrossDamping, ...] = ()
    oils: tuple[OilLink, ...] = ()

    @property
    def fed(self) -> bool:
        """Whether anything may feed energy into small motions in any case: negative damping, a torque that grows with
        the speed and what only a torque that lags makes up for, a converter. A line of which nothing varies grows by
        nothing else."""
        slopes = self.viscous.copy()
        for one in self.lags:  # at high frequencies it damps no more
            slopes[:, one.station] -= np.maximum(one.slope, 0.0)
        return bool(self.across) or any(bool(np.any(part < 0)) for part in (self.damping, slopes, self.quadratic))

    @property
    def straight(self) -> LineCoefficients:
        """The same without any bend."""
        return replace(self, joints=tuple(law.straight() for law in self.joints))
