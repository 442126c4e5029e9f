"""Integration of a line from switch to switch, where torques bend or jump and where dry friction sticks and lets go.

A free–free line is followed from a rotation that goes with it: before each piece the reference turns as the whole line
does at that moment, Σ Jρφ/Σ Jρ² with its speed and acceleration, so that deviations and their errors stay small
whatever turns are made, from standstill and through it.

Dry friction on a disk is T_c against its rotation while it turns. Where it comes to rest the disk stands while what
acts on it stays within the friction at rest, and then sets off the way it is pulled. What stands and what sticks is
judged anew where a piece begins, for a torque may have jumped there, and along every piece it is checked that it bears
what it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.quantities import SPEED
from trunnion.driveline.scenarios import LevelCrossing
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.applied_torques import PlacedFriction, PlacedTorque, TorqueAxis, disk_station, time_knots
from trunnion.equations.line_regimes import LineRegimes, line_kernel, released_kernel, watch_kernel
from trunnion.equations.line_system import LineSystem
from trunnion.equations.prepared_line import ANGLE_SCALE
from trunnion.laws.stages import SLIPS_BACK, SLIPS_ON, STICKS
from trunnion.motion.simulation.converter_ends import converter_end
from trunnion.motion.transients.lagging import held_lags, with_lags
from trunnion.motion.transients.place import LOCATED, Found, Piece, Place
from trunnion.motion.transients.together import Bonds, bonds_of
from trunnion.motion.transients.watched import WatchedValue
from trunnion.numerics.integration.integration import IntegrationEnd, Trajectory, Watch, integrate, kernel
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import about_speed
from trunnion.steady.shooting.integration_outcomes import outcome_of
from trunnion.waiting import time_is_up

FURTHEST = 0.2
"""Mean deviation [rad] from the rotation that goes with the line, for which the length of pieces is chosen; a piece
that comes to ten times as much is made again, shorter."""
FIRST_PIECE = 0.01
"""Of the run."""
LEAST = 1e-9
"""Share of a run that is left to no piece of its own."""
LOOKED_AT = 0.05
"""Share of a run with a prescribed speed after which it is looked whether it is to go on."""
BESIDE = 1e-9
"""Share of a piece of a table by which a speed goes beyond its end before the next one is taken: so that a switch
begins on its own side."""
EQUAL = 1e-12
"""Share of what friction at rest bears within which it is asked for just that: whether it then lets go tells how both
change."""
LATER = 1e-9
"""Share of the same by which a group is let go later, so that the switch begins on its own side."""
SHORT = 1e-3
"""Of a piece, and of 1 over the highest natural frequency: the time over which that change is taken."""
CHECKS, EXCESS = 16, 1e-6
"""Stretches of a piece at whose ends it is checked what sticks, and the share beyond what it bears that is an error."""
SIDE = 1e-3
"""Share of its change in a short time below which what a kink switches by counts as zero."""
LONGEST_FORMULA = 100
"""Characters that a sentence shows of a formula."""


class Stepper:
    """One line under given torques."""

    def __init__(
        self,
        line: LineSystem,
        torques: Sequence[PlacedTorque],
        frictions: Sequence[PlacedFriction],
        crossings: Sequence[LevelCrossing],
        *,
        tolerance: float,
        most_steps: int,
        unit: str,
        mean_speed: float | None = None,
    ) -> None:
        """``mean_speed`` [rad/s]: the run ends where the whole line has it, Σ Jρφ/Σ Jρ²."""
        self.mean_speed = mean_speed
        self.line, self.torques, self.frictions = line, tuple(torques), tuple(frictions)
        self.crossings, self.tolerance, self.most_steps, self.unit = tuple(crossings), tolerance, most_steps, unit
        self.core, self.topo = line_kernel(), line.assembly.topology
        row = line.assembly.table(1, line.speed)[0]
        co = line.untwisted(row[None])
        self.free = self.topo.free
        self.share = line.shares(co.inertia[0]) if self.free else np.zeros(self.topo.size)
        self.turning = rigid_rotation(self.topo)
        count = len(self.torques) + len(self.frictions)
        programs = [one.program for one in self.torques]
        self.lagging = [one for one in self.torques if one.lags]
        nothing = np.zeros((count, self.core.PER_APPLIED))
        nothing[:, self.core.DENOMINATOR] = 1.0
        put = np.concatenate([[], *programs])
        self.numbers = line.numbers(row, known=co, applied=nothing, programs=put, lags=len(self.lagging))
        self.applied_at = int(self.numbers[self.core.APPLIED_AT])
        behind = self.applied_at + count * self.core.PER_APPLIED
        self.programs = [behind + sum(map(len, programs[:k])) for k in range(len(programs))]
        for one, place in zip(programs, self.programs, strict=True):
            self.numbers[place : place + len(one)] = one
        felt, twist = self.topo.on_unknowns(co.inertia[0]), self.topo.elongations
        stiff = twist.T @ (co.stiffness[0][:, None] * twist)
        root = np.sqrt(felt)
        frequencies = np.sqrt(np.maximum(np.linalg.eigvalsh(stiff / np.outer(root, root)), 0.0))
        self.fastest = float(frequencies.max(initial=0.0))
        elastic = frequencies[frequencies > 1e-6 * max(float(frequencies.max()), 1e-30)]
        self.usual = usual = max(float(elastic.min()) if len(elastic) else 0.0, abs(line.speed), 1e-3)
        n, reach = self.topo.size, [slider.reach for slider in line.sliders]
        pushed = [ANGLE_SCALE * usual**2 * float(felt[self.topo.unknown_of[one.station]]) for one in self.lagging]
        weight = np.concatenate([np.full(n, ANGLE_SCALE), np.full(n, ANGLE_SCALE * usual), reach, pushed])
        self.equations = replace(line.system.equations, numbers=self.numbers, weight=weight, size=len(weight))
        self.called = [one.called for one in self.torques if one.called is not None]
        self.groups = {one.first: [f for f in self.frictions if f.first == one.first] for one in self.frictions}

    def run(self, place: Place, duration: float, progress: Callable[[float], None] | None = None) -> Found:
        """From ``place`` on for ``duration`` [s]; ``progress`` is told the share of it that is done."""
        begin, end = place.time, place.time + duration
        clamping = [t for e in self.line.assembly.line.elements if isinstance(e, SlipClutch) for t in e.clamping_times]
        knots = np.union1d(time_knots(self.torques, self.frictions), clamping)
        self.cells = [[self._piece(axis, one, place) for axis in one.axes] for one in self.torques]
        place = self.with_lags(place)
        place = replace(place, regime=self._regime(place))
        chunk = FIRST_PIECE * duration if self.free else LOOKED_AT * duration
        pieces: list[Piece] = []
        crossed: list[tuple[float, str]] = []
        steps, guess, carried = 0, 0.0, np.zeros(0)
        while True:
            if beyond := self._beyond(place):
                return Found(pieces, place, beyond, crossed)
            if place.time >= end:
                return Found(pieces, place, Outcome(True, "reached", f"reached t = {place.time:.6g} s"), crossed)
            if progress is not None:
                progress((place.time - begin) / duration)
            if why := time_is_up():
                kept = "what was computed is kept" if pieces else "nothing was computed"
                words = f"{why.replace('the search', 'the run')} at t = {place.time:.6g} s; {kept}"
                return Found(pieces, place, Outcome(False, "out of time", words), crossed)
            ahead = knots[knots > place.time]
            soon = place.time + chunk if place.time + chunk < end - LEAST * duration else end
            until = min(soon, float(ahead[0]) if len(ahead) else np.inf)
            place = self._following(self._settled(place, SHORT * (until - place.time)))
            self._take_sides(place, SHORT * (until - place.time))
            passed = [one for one in self.crossings if self._jumped(one, place, carried)]
            crossed += [(place.time, one.label) for one in passed]
            if ending := next((one for one in passed if one.ends), None):
                words = f"stopped at t = {place.time:.6g} s, where the {ending.label}"
                return Found(pieces, place, Outcome(True, "crossed", words), crossed)
            watched = self._watched(place)
            trajectory = integrate(
                replace(self.equations, numbers=self.numbers), place.time, until, place.state, regime=place.regime,
                tolerance=self.tolerance, most_steps=self.most_steps - steps, watch=self._watch(watched),
                first_step=guess, partly=True,
            )  # fmt: skip
            for called in self.called:
                if called.error is not None:
                    raise called.error
            off = float(self.share @ trajectory.final[0][: self.topo.size])
            if abs(off) > 10 * FURTHEST and until == soon:
                chunk = 0.25 * min(chunk, until - place.time)
                continue
            steps += trajectory.steps
            guess = min(trajectory.next_step, until - place.time)
            if not trajectory.steps and trajectory.end not in (IntegrationEnd.REACHED, IntegrationEnd.STOPPED):
                return Found(pieces, place, self._failed(place, trajectory, watched), crossed)
            pieces.append(Piece(self.line, trajectory, self.numbers.copy(), self.torques, self.frictions))
            if wrong := self._overloaded(place, trajectory):
                return Found(pieces, self._after(place, trajectory), wrong, crossed)
            own = self.equations.transitions.shape[1]
            for at, which in zip(trajectory.event_time, trajectory.event_which, strict=True):
                if which >= own and watched[which - own].label:
                    crossed.append((float(at), watched[which - own].label))
            if self.free:
                chunk *= float(np.clip((FURTHEST / max(abs(off), 1e-9)) ** (1 / 3), 0.3, 3.0))
            place = self._after(place, trajectory)
            carried = self._spring_torques(replace(place, regime=int(trajectory.regime[-1])))
            if trajectory.end is IntegrationEnd.REACHED:
                for k, one in enumerate(self.torques):
                    for i, axis in enumerate(one.axes):
                        if axis.variable == "time":
                            self.cells[k][i] = axis.piece(place.time)
                continue
            if trajectory.end is not IntegrationEnd.STOPPED:
                return Found(pieces, place, self._failed(place, trajectory, watched), crossed)
            hit = watched[int(trajectory.event_which[-1]) - own]
            if hit.act is None:
                words = f"stopped at t = {place.time:.6g} s, where the {hit.label}"
                return Found(pieces, place, Outcome(True, "crossed", words), crossed)
            place = hit.act(place)

    def _failed(self, place: Place, trajectory: Trajectory, watched: Sequence[WatchedValue]) -> Outcome:
        """The outcome of a run whose integration ended at ``place``, and what of its torques is not a number there."""
        if trajectory.end is IntegrationEnd.NOT_FINITE and (wrong := self._no_number(place)):
            return wrong
        guards = (*(regimes.guards if (regimes := self.line.system.regimes) else ()), *(w.label for w in watched))
        found = outcome_of(self.line.system, trajectory, self.tolerance, guards)
        return converter_end(self.line, place.time, place.state, self.numbers, found)

    def _no_number(self, place: Place) -> Outcome | None:
        """The outcome of a run in which a formula or a function gives no number at ``place``, or just behind it."""
        self._write_course(place)
        soon = LATER * max(abs(place.time), 1 / max(self.fastest, self.usual))
        for one, cell in zip(self.torques, self.cells, strict=True):
            if not (one.stated.by_program and one.acts(cell)):
                continue
            angle, speed = (one.sense * value for value in self._of_station(place, one.station))
            found = [one.value(place.time + later, speed, angle + later * speed) for later in (0.0, soon)]
            if np.isfinite(found).all():
                continue
            written = str(one.stated.formula)
            short = written if len(written) <= LONGEST_FORMULA else f"{written[:LONGEST_FORMULA]}..."
            said = "its function" if one.stated.formula is None else f"the formula {short!r}"
            words = (
                f"stopped at t = {place.time:.6g} s, where {said} of the torque on {one.stated.on} gives no finite "
                f"number (its speed is {about_speed(speed, self.unit)}, its angle {angle:.6g} rad); look for roots, "
                "logarithms and quotients there"
            )
            return Outcome(False, "no number", words)
        return None

    def with_lags(self, place: Place) -> Place:
        """The same place with a state for every torque that lags."""
        self._write_course(place)
        return with_lags(place, self.lagging, self._of_station)

    def _regime(self, place: Place) -> int:
        if place.regime != LOCATED:
            return place.regime
        self._write(place)
        own, lags = np.split(place.state, [len(place.state) - len(self.lagging)])
        return self.line.system.reading(held_lags(self.numbers, self.torques, lags)).regime_at(place.time, own)

    def _piece(self, axis: TorqueAxis, one: PlacedTorque, place: Place) -> int:
        if axis.variable == "time":
            return axis.piece(place.time)
        self._write_course(place)
        angle, speed = self._of_station(place, one.station)
        value = one.sense * (speed if axis.variable == "speed" else angle)
        inner = axis.inner(axis.piece(value))
        if not axis.hold and len(axis.knots) > 1 and abs(value - axis.knots[-1]) <= 1e-3 * self._beside(axis, inner):
            return inner  # begins at the upper end; where it goes beyond is watched
        return axis.piece(value)

    def _beside(self, axis: TorqueAxis, piece: int) -> float:
        return float(BESIDE * (axis.knots[piece + 1] - axis.knots[piece]))

    def _of_station(self, place: Place, station: int) -> tuple[float, float]:
        """Angle [rad] and speed [rad/s] of a station."""
        motion, speed = self.line.moving(np.array([place.time]), place.state[None], self.numbers)
        mean = self.topo.mean_speeds[station]
        return float(mean * place.angle + motion.rotation[0, station]), float(speed[0, station])

    def _beyond(self, place: Place) -> Outcome | None:
        """The outcome of a run in which a torque comes to where it says nothing."""
        for one, cell in zip(self.torques, self.cells, strict=True):
            for axis, piece in zip(one.axes, cell, strict=True):
                if axis.variable != "time" and axis.beyond(piece):
                    low, high = float(axis.knots[0]), float(axis.knots[-1])
                    if axis.variable == "speed":
                        span = f"{about_speed(low, self.unit)} to {about_speed(high, self.unit)}"
                    else:
                        span = f"{low:.6g} to {high:.6g} rad"
                    words = (
                        f"stopped at t = {place.time:.6g} s: the {axis.variable} of {one.stated.on} leaves its table "
                        f"of torques or amplitudes, which goes from {span}; extend it, or write hold = true"
                    )
                    return Outcome(False, "beyond the table", words)
        return None

    # The rotation that goes with the line.

    def _following(self, place: Place) -> Place:
        """The same place, observed from a rotation that goes with the line."""
        if not self.free:
            return place
        n = self.topo.size
        angle, rate = (float(self.share @ part) for part in (place.state[:n], place.state[n : 2 * n]))
        state = place.state.copy()
        state[:n] -= self.turning * angle
        state[n : 2 * n] -= self.turning * rate
        place = replace(place, state=state, angle=place.angle + angle, speed=place.speed + rate, acceleration=0.0)
        self._write(place)
        gained = self._rates(place)[n : 2 * n]
        return replace(place, acceleration=float(self.share @ gained))

    def _after(self, place: Place, trajectory: Trajectory) -> Place:
        since = trajectory.time - place.time
        return replace(
            place,
            time=trajectory.time,
            state=trajectory.final[0].copy(),
            angle=place.angle + (place.speed + place.acceleration * since / 2) * since,
            speed=place.speed + place.acceleration * since,
            regime=trajectory.final_regime,
        )

    def _rates(self, place: Place) -> Array:
        """Rates of all states; what the right-hand side leaves in its room to work in stays in the numbers."""
        out = np.empty(len(place.state))
        kernel().call_rate(self.equations.rate, place.time, place.state, self.numbers, 0, place.regime, out)
        return out

    def _write_course(self, place: Place) -> None:
        core = self.core
        self.numbers[[core.THETA, core.OMEGA, core.ALPHA, core.SINCE]] = (
            place.angle, place.speed, place.acceleration, place.time,
        )  # fmt: skip

    def _write(self, place: Place) -> None:
        """What the right-hand side reads from ``place`` on."""
        core, at, per = self.core, self.applied_at, self.core.PER_APPLIED
        self._write_course(place)
        for one, cell, program in zip(self.torques, self.cells, self.programs, strict=True):
            self.numbers[at : at + per] = one.row(cell, program)
            at += per
        for friction in self.frictions:
            self.numbers[at : at + per] = friction.row(place.time, place.senses.get(friction.first, 0.0))
            at += per
        for first in self.groups:
            stands = place.senses.get(first, 1.0) == 0.0
            self.numbers[core.HEAD + first * core.PER_STATION + core.STANDS] = float(stands)

    # On which side of their kinks formulas are.

    def _take_sides(self, place: Place, soon: float) -> None:
        """Write what is read from ``place`` on, with the side of every kink that lasts until it is switched.

        Where what a kink switches by is zero, its side is that of a short time later, ``soon`` [s] at most.
        """
        for program, one in zip(self.programs, self.torques, strict=True):
            if one.formula is not None:
                first = program + self.core.SIDES
                self.numbers[first : first + one.formula.kinks] = 0.0
        self._write(place)
        if not any(one.formula is not None and one.formula.kinks for one in self.torques):
            return
        here = self._switches(place)
        if self.fastest:
            soon = min(soon, SHORT / self.fastest)
        state = place.state + soon * self._rates(place)
        angle = place.angle + soon * (place.speed + place.acceleration * soon / 2)
        later = self._switches(replace(place, time=place.time + soon, angle=angle, state=state))
        for program, now, then in zip(self.programs, here, later, strict=True):
            plain = np.abs(now) > SIDE * np.abs(then - now)
            sides = np.where(np.where(plain, now, then) < 0, -1.0, 1.0)
            first = program + self.core.SIDES
            self.numbers[first : first + len(sides)] = sides

    def _switches(self, place: Place) -> list[Array]:
        """What every kink of every torque switches by (kink,), none where it does not act."""
        found = []
        for one, cell, program in zip(self.torques, self.cells, self.programs, strict=True):
            if one.formula is None or not one.acts(cell):
                found.append(np.zeros(0))
                continue
            angle, speed = (one.sense * value for value in self._of_station(place, one.station))
            values = [
                self.core.formula(self.numbers, program, place.time, speed, angle, kink)[1]
                for kink in range(one.formula.kinks)
            ]
            found.append(np.array(values))
        return found

    # What stands or sticks.

    def _settled(self, place: Place, soon: float) -> Place:
        """The same place, where it is judged anew what stands and what sticks; ``soon`` [s] is a short time."""
        if self.fastest:
            soon = min(soon, SHORT / self.fastest)
        place = replace(place, senses={first: way for first, way in place.senses.items() if first in self.groups})
        self._write_course(place)
        if self.line.clutches and self.groups:
            return self._jointly(place)
        place = self._groups_settled(place, soon)
        return self._slipping(place, soon) if self.line.clutches else place

    def _jointly(self, place: Place) -> Place:
        """The same place, where groups at rest and clutches without slip are judged together (``together``)."""
        place = self._senses_known(place)
        standing = [first for first, sense in place.senses.items() if sense == 0.0]
        for first in standing:
            place = self._at_rest(place, first)
        place = self._stuck_without_slip(place)
        sticking = self._sticking(place)
        if self._all_hold(place, standing, sticking):
            return place
        way, torque = self._bonds(place, standing, sticking).judged()
        first, per = len(standing), released_kernel().PER_CLUTCH
        clutches = released_kernel().clutches(self.numbers, int(self.core.places(self.numbers)[3]))[1]
        for c, goes, held in zip(sticking, way[first:], torque[first:], strict=True):
            self.numbers[clutches + c * per + released_kernel().HELD] = held
            place = replace(place, regime=place.regime + int(goes) * self._regimes.clutches[c].stride)
        return replace(place, senses={**place.senses, **dict(zip(standing, way.tolist(), strict=False))})

    def _bonds(self, place: Place, standing: Sequence[int], sticking: Sequence[int]) -> Bonds:
        """What groups at rest and clutches that stick are asked for."""
        loose = replace(place, senses={f: sense for f, sense in place.senses.items() if f not in standing})
        self._write(loose)
        bears = [self._pull(loose, first)[1][0] for first in standing]
        rubs = [self._bears(first, loose.time, rest=False)[0] for first in standing]
        carries = [self._carried(loose, c)[1] for c in sticking]
        limits = np.array([*bears, *carries]), np.array([*rubs, *carries])
        return bonds_of(self.line, self.numbers, standing, sticking, *limits)

    def _stuck_without_slip(self, place: Place) -> Place:
        """The same place, where clutches stick whose sides turn alike, whatever they did before."""
        self._write(place)
        for c, clutch in enumerate(self._regimes.clutches):
            stage = clutch.stage(place.regime)
            if stage != STICKS and abs(self._slip(place, c)) <= EQUAL * max(self.usual, abs(place.speed)):
                place = replace(place, regime=place.regime + (STICKS - stage) * clutch.stride)
        return place

    def _all_hold(self, place: Place, standing: Sequence[int], sticking: Sequence[int]) -> bool:
        """Whether groups at rest and clutches that stick bear what they are asked for, as they are."""
        self._write(place)
        pulls = [(pulled, most[0]) for pulled, most in (self._pull(place, first) for first in standing)]
        pulls += [self._carried(place, c) for c in sticking]
        return all(abs(torque) <= most * (1 + EQUAL) for torque, most in pulls)

    def _slip(self, place: Place, clutch: int) -> float:
        """Slip [rad/s] of a clutch."""
        self._rates(place)
        core, (first, _, _, scratch) = self.core, map(int, self.core.places(self.numbers))
        at = first + self.line.clutches[clutch].compliance * core.PER_COMPLIANCE
        near, far = (scratch + len(self.topo.stations) + int(self.numbers[at + end]) for end in (core.NEAR, core.FAR))
        return float(self.numbers[far] - self.numbers[near])

    def _senses_known(self, place: Place) -> Place:
        """The same place, with the sense of every group that something rubs on, 0 where it is at rest."""
        senses = dict(place.senses)
        for first, several in self.groups.items():
            if not any(one.stated.at_rest and any(one.share(place.time)) for one in several):
                senses.pop(first, None)  # nothing rubs yet
                continue
            least = EQUAL * max(self.usual, abs(place.speed))
            if first not in senses:
                speed = self._of_station(place, first)[1]
                senses[first] = float(np.sign(speed)) if abs(speed) > least else 0.0
            elif senses[first] and senses[first] * self._group_speed(place, first) <= least:
                senses[first] *= not self._comes_to_rest(place, first)
        return replace(place, senses=senses)

    def _group_speed(self, place: Place, first: int, later: float = 0.0) -> float:
        """Speed [rad/s] of a group in a state that is told from the rotation that goes with the line, begun ``later``
        [s] before."""
        turning = place.speed + place.acceleration * later
        return float(
            place.state[self.topo.size + int(self.topo.unknown_of[first])] + self.topo.mean_speeds[first] * turning
        )

    def _comes_to_rest(self, place: Place, first: int) -> bool:
        """Whether a group without speed in the sense it had loses more of it: where a formula bends at standstill, the
        piece may end for that and not for the friction."""
        self._write(place)
        gained = self._rates(place)[self.topo.size + int(self.topo.unknown_of[first])]
        return bool(place.senses[first] * (gained + self.topo.mean_speeds[first] * place.acceleration) <= 0)

    def _at_rest(self, place: Place, first: int) -> Place:
        """The same place, where a group has no speed at all."""
        state = place.state.copy()
        state[self.topo.size + int(self.topo.unknown_of[first])] = -self.topo.mean_speeds[first] * place.speed
        return replace(place, state=state, senses={**place.senses, first: 0.0})

    def _groups_settled(self, place: Place, soon: float) -> Place:
        """The same place, where groups with friction stand or set off, each by itself."""
        place = self._senses_known(place)
        for first, sense in place.senses.items():
            if sense == 0.0:
                place = self._settle(place, first, soon)
        return place

    def _settle(self, place: Place, first: int, soon: float) -> Place:
        """A group at rest: it stands, or sets off the way it is pulled."""
        place = self._at_rest(place, first)
        self._write(place)

        def asked(at: Place) -> tuple[float, float]:
            pulled, most = self._pull(at, first)
            return pulled, most[0]

        way = self._lets_go(place, asked, soon)
        return replace(place, senses={**place.senses, first: way})

    def _slipping(self, place: Place, soon: float) -> Place:
        """The same place, where clutches that stick slip if they cannot carry their torque, that furthest beyond its
        capacity first."""
        for _ in self.line.clutches:
            self._write(place)
            gone: list[tuple[float, int, float]] = []
            for c in self._sticking(place):
                carried, most = self._carried(place, c)
                if way := self._lets_go(place, partial(self._carried, clutch=c), soon):
                    gone.append((abs(carried) - most, c, way))
            if not gone:
                break
            _, worst, way = max(gone)
            stride = self._regimes.clutches[worst].stride
            place = replace(place, regime=place.regime + ((SLIPS_ON if way > 0 else SLIPS_BACK) - STICKS) * stride)
        return place

    @property
    def _regimes(self) -> LineRegimes:
        found = self.line.system.regimes
        assert isinstance(found, LineRegimes)
        return found

    def _sticking(self, place: Place) -> list[int]:
        """The slip clutches that stick, by their numbers."""
        if not self.line.clutches:
            return []
        return [int(c) for c in np.flatnonzero(self._regimes.clutches_stick(np.array([place.regime]))[0])]

    def _lets_go(self, place: Place, asked: Callable[[Place], tuple[float, float]], soon: float) -> float:
        """The sense in which what sticks lets go, 0 where it does not. ``asked``: what it is asked for there, and what
        it bears. Where both are equal it lets go if the first grows more than the second."""
        torque, most = asked(place)
        over = abs(torque) - most
        if abs(over) > EQUAL * most:
            return float(np.sign(torque)) if over > 0 else 0.0
        state = place.state + soon * self._rates(place)
        torque, most = asked(replace(place, time=place.time + soon, state=state))
        return float(np.sign(torque)) if abs(torque) - most > over + EQUAL * most else 0.0

    def _carried(self, place: Place, clutch: int) -> tuple[float, float]:
        """Torque [N m] of a slip clutch, and its capacity at rest as it is clamped."""
        self._rates(place)
        one, count = self.line.clutches[clutch], len(self.topo.stations)
        torques = int(self.core.places(self.numbers)[3]) + 5 * count + 7 * self.topo.size
        share = float(np.interp(place.time, *one.table.T)) if len(one.table) else 1.0
        return float(self.numbers[torques + one.compliance]), one.holds * share

    def _overloaded(self, place: Place, trajectory: Trajectory) -> Outcome | None:
        """The outcome of a run in which something stood or stuck beyond what it bears, or was driven by its friction,
        in the piece that began at ``place``."""
        standing = [first for first, sense in place.senses.items() if sense == 0.0]
        if not (place.senses or self.line.clutches) or not trajectory.steps:
            return None
        full = max([c.holds for c in self.line.clutches] + [f.stated.at_rest for f in self.frictions])
        times = np.linspace(place.time, trajectory.time, CHECKS + 1)
        regime = trajectory.regime[np.searchsorted(trajectory.start[1:], times[:-1], side="right")]
        # The end counts to the step before it.
        for time, state, now in zip(times, trajectory.at(times), [*regime, trajectory.regime[-1]], strict=True):
            at = replace(place, time=float(time), state=state, regime=int(now))
            sticks = self._sticking(at)
            pulls = [(first, *self._pull(at, first)) for first in standing]
            found = [(f"the disk {self.groups[f][0].stated.on} stands", pulled, most[0]) for f, pulled, most in pulls]
            found += [(f"{self.line.clutches[c].name} sticks", *self._carried(at, int(c))) for c in sticks]
            for first, sense in place.senses.items():
                if sense * self._group_speed(at, first, float(time) - place.time) < -EXCESS * max(
                    self.usual, abs(place.speed)
                ):
                    words = (
                        f"stopped at t = {time:.6g} s: the friction on {self.groups[first][0].stated.on} drives it; "
                        f"what lies behind t = {place.time:.6g} s is not right"
                    )
                    return Outcome(False, "friction exceeded", words)
            for what, torque, most in found:
                if abs(torque) > most + EXCESS * max(most, full):
                    words = (
                        f"stopped at t = {time:.6g} s: {what} under {abs(torque):.6g} N m, though its friction bears "
                        f"{most:.6g} N m; what lies behind t = {place.time:.6g} s is not right"
                    )
                    return Outcome(False, "friction exceeded", words)
        return None

    def _pull(self, place: Place, first: int) -> tuple[float, tuple[float, float]]:
        """Torque [N m] on a group that stands, friction aside; what friction at rest bears and its slope [N m/s]."""
        self._rates(place)
        count, scratch = len(self.topo.stations), int(self.core.places(self.numbers)[3])
        pulled = self.numbers[scratch + 5 * count + 3 * self.topo.size + int(self.topo.unknown_of[first])]
        return float(pulled), self._bears(first, place.time)

    def _bears(self, first: int, time: float, *, rest: bool = True) -> tuple[float, float]:
        """What friction on a group bears at rest or resists with in motion, and its slope [N m/s], after ``_rates``."""
        reach, bears = int(self.core.places(self.numbers)[3]) + 2 * len(self.topo.stations), [0.0, 0.0]
        for one in self.groups[first]:
            size = abs(self.numbers[reach + one.station]) * (one.stated.at_rest if rest else one.stated.torque)
            for k, part in enumerate(one.share(time)):
                bears[k] += size * part
        return bears[0], bears[1]

    # What is watched.

    def _watched(self, place: Place) -> list[WatchedValue]:
        core, found = watch_kernel(), list[WatchedValue]()
        for k, one in enumerate(self.torques):
            for i, axis in enumerate(one.axes):
                if axis.variable == "time":
                    continue
                kind = core.STATION_SPEED if axis.variable == "speed" else core.STATION_ANGLE
                low, high = axis.ends(self.cells[k][i])
                inner = axis.inner(self.cells[k][i])
                beside = self._beside(axis, inner)
                for end, step in ((low, -1), (high, 1)):
                    if np.isfinite(end):
                        level = (0.0, end + step * beside, 0.0, 0.0, 0.0)
                        found.append(
                            WatchedValue(kind, one.station, one.sense, level, step, True, self._stepped(k, i, step))
                        )
        found += self._kinks()
        for first, sense in place.senses.items():
            if sense:
                stopped = self._stopped(first)
                found.append(WatchedValue(core.STATION_SPEED, first, sense, (0.0,) * 5, -1, True, stopped))
                continue
            _, (bears, slope) = self._pull(place, first)
            level = (place.time, bears * (1 + LATER), slope, 0.0, 0.0)
            unknown = int(self.topo.unknown_of[first])
            for way in (1.0, -1.0):
                found.append(WatchedValue(core.ON_UNKNOWN, unknown, way, level, 1, True, self._let_go(first, way)))
        if self.mean_speed is not None:
            level = (0.0, self.mean_speed, 0.0, 0.0, 0.0)
            found.append(WatchedValue(core.MEAN_SPEED, 0, 1.0, level, 2, True, None, "line has the speed asked for"))
        return found + [self._asked(one) for one in self.crossings]

    def _kinks(self) -> list[WatchedValue]:
        """Where formulas bend or jump: a new piece begins there, on the other side."""
        core, found, at = watch_kernel(), list[WatchedValue](), self.applied_at
        for one, cell, program in zip(self.torques, self.cells, self.programs, strict=True):
            if one.formula is not None and one.acts(cell):
                for kink in range(one.formula.kinks):
                    side = self.numbers[program + self.core.SIDES + kink]
                    level = (float(kink), 0.0, 0.0, 0.0, 0.0)
                    found.append(
                        WatchedValue(core.KINK, at, 1.0, level, -1 if side > 0 else 1, True, lambda place: place)
                    )
            at += self.core.PER_APPLIED
        return found

    def _stepped(self, torque: int, axis: int, step: int) -> Callable[[Place], Place]:
        """A torque comes to the next piece of its table."""

        def act(place: Place) -> Place:
            self.cells[torque][axis] += step
            return place

        return act

    def _stopped(self, first: int) -> Callable[[Place], Place]:
        """A group comes to rest."""
        return lambda place: replace(place, senses={**place.senses, first: 0.0})

    def _let_go(self, first: int, way: float) -> Callable[[Place], Place]:
        """A group that stood sets off."""
        return lambda place: replace(place, senses={**place.senses, first: way})

    def _asked(self, one: LevelCrossing) -> WatchedValue:
        core, way = watch_kernel(), {"rising": 1, "falling": -1, "either": 2}[one.direction]
        level = (0.0, one.level, 0.0, 0.0, 0.0)
        if one.key in ("speed", "angle"):
            station = disk_station(self.line.assembly, one.of, "crossing")
            kind = core.STATION_SPEED if one.key == "speed" else core.STATION_ANGLE
            sense = float(np.sign(self.topo.mean_speeds[station]))
            return WatchedValue(kind, station, sense, level, way, one.ends, None, self._said(one))
        place = self.line.assembly.line.index(one.of)
        spring = next(e for e, c in enumerate(self.topo.compliances) if place in c.shafts)
        kind = {"torque": core.TORQUE, "twist": core.TWIST, "slip": core.TWIST_RATE}[one.key]
        return WatchedValue(kind, spring, 1.0, level, way, one.ends, None, self._said(one))

    def _spring_torques(self, place: Place) -> Array:
        """Torque [N m] of every spring as the numbers stand."""
        self._rates(place)
        first = int(self.core.places(self.numbers)[3]) + 5 * len(self.topo.stations) + 7 * self.topo.size
        return self.numbers[first : first + len(self.topo.compliances)].copy()

    def _jumped(self, one: LevelCrossing, place: Place, before: Array) -> bool:
        """Whether a torque jumps over its level between two pieces, as that of a slip clutch does."""
        if one.key != "torque" or not len(before):
            return False
        spring = self._asked(one).of
        old, new = before[spring] - one.level, self._spring_torques(place)[spring] - one.level
        ways = {"rising": old < 0 < new, "falling": old > 0 > new, "either": old * new < 0}
        return bool(ways[one.direction]) and abs(new - old) > LATER * (abs(one.level) + abs(new))

    def _said(self, one: LevelCrossing) -> str:
        """The label, speeds in the unit of the line."""
        if LevelCrossing.quantity_of(one.key) is not SPEED:
            return one.label
        return one.label.replace(f"{one.level:.6g} rad/s", about_speed(one.level, self.unit))

    def _watch(self, watched: list[WatchedValue]) -> Watch | None:
        if not watched:
            return None
        core = watch_kernel()
        called = any(one.kind in (core.TORQUE, core.ON_UNKNOWN) for one in watched)
        rows = [[one.kind, one.of, one.factor, *one.level] for one in watched]
        first = core.FRONT + core.PER_WATCHED * len(rows)
        head = [len(rows), self.equations.rate, float(called), first]
        room = np.zeros(2 * self.equations.size + 2 * len(rows))
        return Watch(
            core.line_watch.address,
            np.concatenate([head, np.ravel(rows), self.numbers, room]),
            np.array([one.direction for one in watched], dtype=np.int64),
            np.array([int(one.stops) for one in watched], dtype=np.int64),
        )
