"""What a line would show at the channels of a measurement: orders of rotations, torques, accelerations and speeds."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import lcm

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.inertia_torque import accelerating, not_accelerated
from trunnion.equations.steady_base import has_periodic_base
from trunnion.errors import InputError
from trunnion.measured.measured_run import measured_run
from trunnion.measured.tracking.places import even_places, speed_ratios
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.response.orders.response import steady_states_of
from trunnion.steady.orders.amplitudes import OrderSpectrum
from trunnion.steady.orders.forced_response import shaft_names
from trunnion.steady.orders.spectrum import order_spectrum
from trunnion.waiting import keep_time

NEAR_ENOUGH = 1e-6
"""Orders that are the same."""
MOST_TURNS = 60
"""Turns after which orders are taken to repeat at the latest."""


@dataclass(frozen=True)
class PredictedChannels:
    """Where the channels of a measurement stand in the responses of a line.

    columns : of the measurement, those of places of the line, by their kind. even : whether a place turns evenly.
    senses : −1 of disks that turn against the input, whose motion a pickup shows in their own sense. acceleration : of
    the input [rad/s²] in the run that was measured, 0 where it goes up and down.
    """

    assembly: Assembly
    data: MeasuredOrders
    columns: tuple[int, ...]
    places: tuple[int, ...]
    even: tuple[bool, ...]
    senses: tuple[float, ...]
    acceleration: float

    def at(self, table: Array) -> Complex:
        """Amplitudes (case, order, channel) of rows of packed numbers (case, column), each at its own speed.

        Steady ones, under the torques that accelerate the line in the run, where it can carry these.
        """
        carrying = accelerating(self.assembly, table, self.acceleration)
        if carrying is not table:
            try:
                return self._steady(carrying)
            except InputError:
                pass  # a spring goes into its free play, say, or a machine is asked for more than it has
        return self._steady(table)

    @property
    def uncounted(self) -> str:
        """Why the torques that accelerate the line are not counted, as a clause; empty where they are."""
        if not self.acceleration:
            return ""
        table = self.assembly.table(len(self.data.speed), self.data.speed)
        if why := not_accelerated(self.assembly, table):
            return why
        try:
            self._steady(accelerating(self.assembly, table, self.acceleration))
        except InputError as error:
            return str(error).splitlines()[0]
        return ""

    def _steady(self, table: Array) -> Complex:
        if not has_periodic_base(self.assembly):
            return self.of(order_spectrum(self.assembly, table[:, 0], table=table))
        # Each line moves about a periodic motion of its own, which is found at all its speeds.
        made = np.zeros((len(table), len(self.data.order), len(self.columns)), dtype=complex)
        lines, of_line = np.unique(table[:, 1:], axis=0, return_inverse=True)
        for number, row in enumerate(lines):
            keep_time()
            own = np.flatnonzero(of_line.ravel() == number)
            assembly = assemble(self.assembly.packed.line_at(np.concatenate([table[own[:1], 0], row])))
            speeds, back = np.unique(table[own, 0], return_inverse=True)
            found = order_spectrum(assembly, speeds, motions=steady_states_of(assembly))
            made[own] = self.of(found)[back.ravel()]
        return made

    def of(self, found: OrderSpectrum) -> Complex:
        """Amplitudes (case, order, channel) that a spectrum holds."""
        rows = self._rows(found)
        made = np.zeros((len(found.speed), len(self.data.order), len(self.columns)), dtype=complex)
        turned = 1j * np.multiply.outer(found.speed, self.data.order)
        point = found.amplitude[..., found.channels.point] + found.base
        torque = found.amplitude[..., found.channels.torque]
        for k, (column, place, even, sense) in enumerate(
            zip(self.columns, self.places, self.even, self.senses, strict=True)
        ):
            if even:
                continue
            kind = self.data.kinds[column]
            values = (torque if kind == "torque" else point)[..., place]
            there = rows >= 0
            made[:, there, k] = values[:, rows[there]]
            made[:, :, k] *= sense * {"acceleration": turned**2, "speed": turned}.get(kind, 1.0)
        return made

    def _rows(self, found: OrderSpectrum) -> Array:
        """Columns of the spectrum of the orders that were measured, −1 of those that nothing excites."""
        apart = np.abs(found.order_numbers[None, :] - self.data.order[:, None]) + 1e9 * (found.frequency != 0)
        if not apart.shape[1]:
            return np.full(len(self.data.order), -1)
        return np.where(apart.min(axis=1) < NEAR_ENOUGH, apart.argmin(axis=1), -1)


def predicted_channels(assembly: Assembly, data: MeasuredOrders) -> PredictedChannels:
    """The channels of a measurement that stand at places of a line.

    Raises
    ------
    InputError : a place that the line does not have; no channel at any place that moves.
    """
    topo = assembly.topology
    points, springs = [name for _, name in topo.points], list(shaft_names(assembly))
    held = even_places(assembly)
    columns, places, even = [], [], []
    for column, (place, kind, name) in enumerate(zip(data.places, data.kinds, data.channels, strict=True)):
        if not place or kind == "other":
            continue
        known = springs if kind == "torque" else points
        if kind != "torque" and place in held:
            columns.append(column)
            places.append(-1)
            even.append(True)
            continue
        if place not in known:
            what = "is not a spring of the line" if kind == "torque" else "is not a disk of the line"
            raise InputError(what, element=name, key="at", value=place, remedy=nearest(place, known))
        columns.append(column)
        places.append(known.index(place))
        even.append(False)
    if all(even):
        raise InputError(
            "shows no place of the line that moves", key="data", remedy='name places in its channels: at = "hub"'
        )
    turns, run = speed_ratios(assembly), measured_run(data)
    senses = [1.0 if data.kinds[c] == "torque" else float(np.sign(turns[data.places[c]])) or 1.0 for c in columns]
    acceleration = run.acceleration if run is not None and run.one_way else 0.0
    return PredictedChannels(assembly, data, tuple(columns), tuple(places), tuple(even), tuple(senses), acceleration)


def turned(values: Complex, orders: Array, angle: float) -> Complex:
    """Amplitudes (…, order, channel) as they read where the input begins at ``angle`` [rad]."""
    return np.asarray(values * np.exp(1j * orders * angle)[:, None])


def best_angle(measured: Complex, predicted: Complex, weight: Array, orders: Array) -> float:
    """The angle [rad] at which the measurement begins: where ``predicted`` (window, order, channel) fits best.

    weight : of the square of each difference; 0 of what is not known.
    """
    # |m − p e^{ikα}|² depends on α by −2 Re Σ w m* p e^{ikα}: a sum of cosines, searched finely and then refined.
    known = np.where(weight > 0, weight * np.nan_to_num(measured).conj() * predicted, 0.0).sum(axis=(0, 2))
    grid = np.linspace(0.0, period(orders), 64 * turns(orders) * max(4, int(np.ceil(orders.max()))), endpoint=False)
    angle = float(grid[(np.exp(1j * np.multiply.outer(grid, orders)) @ known).real.argmax()])
    for _ in range(20):
        wave = known * np.exp(1j * orders * angle)
        slope, bend = float((1j * orders * wave).real.sum()), float((-(orders**2) * wave).real.sum())
        if bend >= 0:
            break
        angle -= slope / bend
    return float(angle % period(orders))


def turns(orders: Array) -> int:
    """Turns of the input after which all ``orders`` repeat: two of half orders."""
    return min(lcm(*(Fraction(one).limit_denominator(MOST_TURNS).denominator for one in orders.tolist())), MOST_TURNS)


def period(orders: Array) -> float:
    """The same as an angle [rad]."""
    return 2 * np.pi * turns(orders)


def usable(data: MeasuredOrders, columns: tuple[int, ...]) -> Flags:
    """Which amplitudes (window, order, channel) are known."""
    part = data.amplitude[:, :, list(columns)]
    return np.asarray(np.isfinite(part) & np.isfinite(data.deviation[:, :, list(columns)]))
