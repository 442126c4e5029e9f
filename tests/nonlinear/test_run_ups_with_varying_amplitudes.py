"""Run-ups and schedules of speed under excitations whose amplitude goes with the speed or the load.

The oracle has equations of its own, in deviations from the rotation asked for, with the torque of the excited disk from
its crank, its table or its pressures at the momentary mean speed, and is integrated by SciPy's DOP853.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

INERTIA = np.array([0.9, 0.35, 1.6])
STIFFNESS, DAMPING = np.array([9e3, 6e3]), np.array([9.0, 7.0])
QUADRATIC = 0.06
"""Of the load of the last disk [N m s²/rad²]."""
FIRST, LAST, ACCELERATION = 40.0, 100.0, 25.0
Torque = Callable[[float, float], float]
"""Of the excited disk by its own angle and the momentary mean speed of its own."""

SPEEDS = (35.0, 52.0, 61.0, 110.0)
AMPLITUDES, PHASES = np.array([5.0, 60.0, 20.0, 90.0]), np.array([0.3, -0.8, 1.4, 0.0])
LOADS = (90.0, 130.0, 250.0, 700.0)
BOTH = ((38.0, 71.0, 120.0), (80.0, 200.0, 650.0))
GRID = np.array([[10.0, 40.0, 25.0], [70.0, 30.0, 90.0], [20.0, 110.0, 60.0]])
"""Amplitudes over speed (column) and load (row)."""
BORE, CRANK, ROD, MASS, CRANKCASE = 0.15, 0.08, 0.28, 1.1, 1e5
ANGLES = np.deg2rad(np.arange(-360.0, 360.0, 2.0))
HIGHEST = (4e5, 25e5, 80e5)


def linear(at: float, points: Any, values: Any) -> complex:
    return complex(np.interp(at, points, np.real(values)), np.interp(at, points, np.imag(values)))


def propeller(speed: float) -> float:
    return QUADRATIC * speed**2


def masses() -> tuple[dict[str, Any], Torque]:
    """Of a piston on its crank: −m x′x″Ω² with x(φ) of the exact mechanism."""

    def torque(angle: float, speed: float) -> float:
        c, s = np.cos(angle), np.sin(angle)
        rod = np.sqrt(ROD**2 - CRANK**2 * s**2)
        x1 = -CRANK * s - CRANK**2 * s * c / rod
        x2 = -CRANK * c - CRANK**2 * (c**2 - s**2) / rod - CRANK**4 * s**2 * c**2 / rod**3
        return float(-MASS * x1 * x2 * speed**2)

    return {"excitation": tn.reciprocating_mass(MASS, CRANK, ROD, orders=24)[0]}, torque


def harmonic(order: float, amplitude: Callable[[float], complex]) -> Torque:
    return lambda angle, speed: float((amplitude(speed) * np.exp(1j * order * angle)).real)


def over_speed() -> tuple[dict[str, Any], Torque]:
    one = {"order": 1.5, "phase": 0.2, "speeds": SPEEDS, "amplitudes": AMPLITUDES.tolist(), "phases": PHASES.tolist()}
    values = AMPLITUDES * np.exp(1j * (PHASES + 0.2))
    return {"excitation": [one]}, harmonic(1.5, lambda speed: linear(speed, SPEEDS, values))


def over_load() -> tuple[dict[str, Any], Torque]:
    one = {"order": 1.5, "torques": LOADS, "amplitudes": AMPLITUDES.tolist(), "phases": PHASES.tolist()}
    values = AMPLITUDES * np.exp(1j * PHASES)
    return {"excitation": [one]}, harmonic(1.5, lambda speed: linear(propeller(speed), LOADS, values))


def over_both() -> tuple[dict[str, Any], Torque]:
    one = {"order": 2, "speeds": BOTH[0], "torques": BOTH[1], "amplitudes": GRID.ravel().tolist()}

    def amplitude(speed: float) -> complex:
        return linear(propeller(speed), BOTH[1], [np.interp(speed, BOTH[0], row) for row in GRID])

    return {"excitation": [one]}, harmonic(2, amplitude)


def by_share() -> tuple[dict[str, Any], Torque]:
    one = {"order": 3, "share": 0.2, "phase": -0.4}
    return {"excitation": [one]}, harmonic(3, lambda speed: 0.2 * propeller(speed) * np.exp(-0.4j))


CASES = {one.__name__: one for one in (masses, over_speed, over_load, over_both, by_share)}


@dataclass(frozen=True)
class Oracle:
    """Disks in a row; the first is excited and carries the drive, the last the load. ``drive``: what the drive gives
    beyond the load at the speed asked for [N m]; ``driven``: the input turns as asked, by the first shaft, in front of
    the last two disks, of which the one behind is excited and loaded; ``until``: when the last speed is asked for [s],
    behind which that stays."""

    torque: Torque
    driven: bool = False
    drive: float = 0.0
    first: float = FIRST
    acceleration: float = ACCELERATION
    until: float = np.inf
    quadratic: float = QUADRATIC
    damping: np.ndarray = field(default_factory=lambda: DAMPING)

    def rate(self, t: float, y: np.ndarray) -> np.ndarray:
        since = min(t, self.until)
        asked = self.first + self.acceleration * since
        angle = self.first * t + self.acceleration * since * (t - since / 2)
        n = len(y) // 2
        d, v, push = y[:n], y[n:], np.zeros(n)
        twist = np.diff(d, prepend=0.0) if self.driven else np.diff(d)
        slip = np.diff(v, prepend=0.0) if self.driven else np.diff(v)
        shaft = STIFFNESS * twist + self.damping * slip
        if self.driven:
            inertia = INERTIA[1:]
            push -= shaft
            push[:-1] += shaft[1:]
            mean, excited = asked, n - 1
        else:
            inertia = INERTIA
            push[:-1] += shaft
            push[1:] -= shaft
            mean, excited = asked + inertia @ v / inertia.sum(), 0
            push[0] += self.quadratic * asked**2 + self.drive
        push[excited] += self.torque(angle + d[excited], mean)
        push[-1] -= self.quadratic * abs(asked + v[-1]) * (asked + v[-1])
        return np.concatenate([v, push / inertia - (self.acceleration if t < self.until else 0.0)])

    def shafts(self, times: np.ndarray, start: np.ndarray) -> np.ndarray:
        """Torques of both shafts (time, shaft)."""
        n, y = len(start) // 2, self.motion(times, start)
        d, v = y[:n], y[n:]
        if self.driven:
            d, v = np.vstack([np.zeros(d.shape[1]), d]), np.vstack([np.zeros(d.shape[1]), v])
        return np.asarray((STIFFNESS[:, None] * np.diff(d, axis=0) + self.damping[:, None] * np.diff(v, axis=0)).T)

    def motion(self, times: np.ndarray, start: np.ndarray) -> np.ndarray:
        """Deviations from the rotation asked for and their rates (state, time), cut where the schedule ends."""
        cut = np.searchsorted(times, self.until)
        parts, begin = [], (0.0, start)
        for some, end in ((times[:cut], min(self.until, times[-1])), (times[cut:], times[-1])):
            if end > begin[0]:
                at = np.append(some[some < end], end)
                y = solve_ivp(
                    self.rate, (begin[0], end), begin[1], "DOP853", at, rtol=1e-11, atol=1e-12, max_step=0.02
                ).y
                parts.append(y[:, : len(some)])
                begin = end, y[:, -1]
        return np.concatenate(parts, axis=1)


def shaft(i: int) -> tn.Shaft:
    return tn.Shaft(stiffness=STIFFNESS[i], damping=DAMPING[i])


def free_line(more: dict[str, Any]) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.Disk(inertia=INERTIA[0], drive_share=1, name="engine", **more),
            shaft(0), tn.Disk(inertia=INERTIA[1]),
            shaft(1), tn.Disk(inertia=INERTIA[2], quadratic_load=QUADRATIC, name="propeller"),
        ]
    )  # fmt: skip


def driven_line(more: dict[str, Any]) -> tn.Driveline:
    """The disk that is loaded is excited too: what it drives with is less than nothing."""
    (one,) = more["excitation"] if len(more["excitation"]) == 1 else (None,)
    if isinstance(one, dict) and "torques" in one:  # by what resists, in the order in which that rises
        turned = [-torque for torque in reversed(one["torques"])]
        rows = np.reshape(one["amplitudes"], (len(turned), -1))[::-1].ravel().tolist()
        one = {**one, "torques": turned, "amplitudes": rows}
        if "phases" in one:
            one["phases"] = one["phases"][::-1]
        more = {"excitation": [one]}
    return tn.Driveline(
        [
            tn.ConstantSpeed(), shaft(0), tn.Disk(inertia=INERTIA[1]), shaft(1),
            tn.Disk(inertia=INERTIA[2], quadratic_load=QUADRATIC, name="pump", **more),
        ]
    )  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_driven_run_up(name: str) -> None:
    more, torque = CASES[name]()
    run = tn.run_up(driven_line(more), FIRST, LAST, acceleration=ACCELERATION, ramp=0.0, steady=0)
    times = np.linspace(0.0, run.simulation.end, 3001)
    expected = Oracle(torque, driven=True).shafts(times, run.simulation.at(times[:1])[0])
    np.testing.assert_allclose(run.simulation.torque_at(times), expected, rtol=0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("name", CASES)
def test_free_run_up(name: str) -> None:
    """Its drives give what holds the first speed, which its vibration takes too, and what accelerates the line."""
    more, torque = CASES[name]()
    run = tn.run_up(free_line(more), FIRST, LAST, acceleration=ACCELERATION, ramp=0.0, steady=0)
    assert run.outcome.kind == "reached" and run.ending is not None
    drive = run.ending.drive - propeller(LAST)
    assert drive == pytest.approx(ACCELERATION * INERTIA.sum(), rel=0.05)
    times = np.linspace(0.0, (LAST - FIRST) / ACCELERATION, 3001)
    expected = Oracle(torque, drive=drive).shafts(times, run.simulation.at(times[:1])[0])
    np.testing.assert_allclose(run.simulation.torque_at(times), expected, rtol=0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(("size", "kind"), [(0.01, "reached"), (0.03, "captured")])
def test_a_resonance_that_holds_an_engine(size: float, kind: str) -> None:
    """By torques with the square of the speed at which the line hangs, and not of the speed asked for."""
    first, acceleration, load, damping = 60.0, 2.0, 0.002, 2.0
    line = free_line({"excitation": [{"order": 1, "quadratic_amplitude": size}]})
    line = line.replace("propeller", quadratic_load=load)
    line = line.replace("Shaft 1", damping=damping).replace("Shaft 2", damping=damping)
    run = tn.run_up(line, first, LAST, acceleration=acceleration, ramp=0.0, steady=0)
    assert run.outcome.kind == kind and run.ending is not None
    assert run.ending.hanging is not None and run.ending.hanging.speed == pytest.approx(77.0, rel=0.03)
    until = (LAST - first) / acceleration
    oracle = Oracle(
        harmonic(1, lambda speed: size * speed**2), drive=run.ending.drive - load * LAST**2, first=first,
        acceleration=acceleration, until=until, quadratic=load, damping=np.full(2, damping),
    )  # fmt: skip
    times = np.linspace(0.0, run.simulation.end, 2001)
    turned = INERTIA @ oracle.motion(times, run.simulation.at(np.zeros(1))[0])[:3] / INERTIA.sum()
    since = np.minimum(times, until)
    asked = first * times + acceleration * since * (times - since / 2)
    np.testing.assert_allclose(run.simulation.whole.angle(times), asked + turned - turned[0], rtol=0, atol=1e-4)
    if kind == "captured":
        assert (asked + turned)[-1] - (asked + turned)[-101] < 0.8 * LAST * (times[-1] - times[-101])


def indicated(load: int) -> np.ndarray:
    """Absolute pressures [Pa] over ``ANGLES``, as rounded as one is."""
    return 1.2e5 + HIGHEST[load] * np.exp(np.where(ANGLES < 0, -((ANGLES / 0.5) ** 2), -ANGLES / 0.9))


def gas(pressure: np.ndarray, orders: int) -> tuple[float, np.ndarray]:
    """Mean torque of a cylinder and A e^{iφ} of its orders ½ to ``orders``, from a curve linear between its points,
    over the exact mechanism, by sums over a fine grid."""
    angle = np.linspace(-2 * np.pi, 2 * np.pi, 720 * 64, endpoint=False)
    p = np.interp(angle, np.append(ANGLES, -ANGLES[0]), np.append(pressure, pressure[0])) - CRANKCASE
    s, c, ratio = np.sin(angle), np.cos(angle), CRANK / ROD
    torque = p * np.pi / 4 * BORE**2 * CRANK * (s + ratio * s * c / np.sqrt(1 - ratio**2 * s**2))
    k = np.arange(1, 2 * orders + 1) / 2
    return float(torque.mean()), 2 * np.exp(-1j * np.outer(k, angle)) @ torque / len(angle)


def test_pressures_over_load() -> None:
    """Of two cylinders on one crank, which carry the propeller between them."""
    orders, fires = 6, (0.0, 2 * np.pi)
    curves = [gas(indicated(load), orders) for load in range(3)]
    loads, values = [mean for mean, _ in curves], np.array([found for _, found in curves])
    assert loads[0] < propeller(FIRST) / 2 < loads[1] < propeller(LAST) / 2 < loads[2]
    k = np.arange(1, 2 * orders + 1) / 2

    def torque(angle: float, speed: float) -> float:
        load = propeller(speed) / 2
        i = int(np.clip(np.searchsorted(loads, load), 1, 2))
        now = values[i - 1] + (load - loads[i - 1]) / (loads[i] - loads[i - 1]) * (values[i] - values[i - 1])
        return float(sum((now * np.exp(1j * k * (angle - at))).sum().real for at in fires))

    curve = [tn.PressureCurve(angles=ANGLES.tolist(), pressures=indicated(load).tolist()) for load in range(3)]
    engine = tn.Engine(
        firing_order="1-2", throw_inertia=INERTIA[0] / 2, rigid=True, bore=BORE, stroke=2 * CRANK, rod_length=ROD,
        pressure=curve, crankcase_pressure=CRANKCASE, orders=orders, drive_share=1, name="engine",
    )  # fmt: skip
    line = tn.Driveline([engine, *free_line({}).elements[1:]])
    run = tn.run_up(line, FIRST, LAST, acceleration=ACCELERATION, ramp=0.0, steady=0)
    assert run.ending is not None
    times = np.linspace(0.0, (LAST - FIRST) / ACCELERATION, 2001)
    oracle = Oracle(torque, drive=run.ending.drive - propeller(LAST))
    expected = oracle.shafts(times, run.simulation.at(times[:1])[0])
    np.testing.assert_allclose(run.simulation.torque_at(times), expected, rtol=0, atol=2e-5 * np.abs(expected).max())


@pytest.mark.parametrize("line", [driven_line, free_line])
def test_a_slow_run_comes_to_the_steady_response(line: Callable[[dict[str, Any]], tn.Driveline]) -> None:
    """At every speed: what it misses goes down with the acceleration."""
    one = {"order": 1.5, "speeds": SPEEDS, "amplitudes": (0.05 * AMPLITUDES).tolist(), "phases": PHASES.tolist()}
    made = line({"excitation": [one]})
    off = []
    for acceleration in (1.0, 0.25):
        run = tn.run_up(made, FIRST, LAST, acceleration=acceleration, steady=0)
        within = slice(4, -4)
        steady = tn.order_response(made, run.speed[within]).vibratory_torque
        off.append(np.abs(run.swing[within] - steady).max(axis=0) / steady.max(axis=0))
    assert np.all(off[1] < 0.02) and np.all(off[1] < 0.5 * off[0])


@pytest.mark.parametrize("line", [driven_line, free_line])
def test_the_steady_response_beside_it_is_that_of_order_response(
    line: Callable[[dict[str, Any]], tn.Driveline],
) -> None:
    made = line(over_speed()[0])
    run = tn.run_up(made, FIRST, LAST, acceleration=ACCELERATION, steady=21)
    found = run.steady
    assert found is not None and len(found.speed) >= 21
    expected = tn.order_response(made, found.speed)
    np.testing.assert_allclose(found.largest, expected.peak_torque)
    np.testing.assert_allclose(found.swing, expected.vibratory_torque)
    np.testing.assert_array_equal(found.verdict, tn.speed_sweep(made, found.speed).verdict)
    assert "the steady response is linear: the swing of" in str(run)


@pytest.mark.parametrize("name", ["masses", "over_speed"])
def test_schedule_of_speed(name: str) -> None:
    """Up, and on at the last speed: there it is the motion that the line makes at that speed."""
    more, _ = CASES[name]()
    line = driven_line(more)
    profile = tn.SpeedProfile([0.0, 1.0, 2.0], [50.0, 75.0, 75.0])
    run = tn.simulate(line, 9.0, speed=profile)
    orbit = tn.periodic_response(line, 75.0, compare=False)
    last = run.torque[run.time > 9.0 - 2 * 2 * np.pi / 75.0]
    np.testing.assert_allclose(np.ptp(last, axis=0), orbit.torque_peak_to_peak, rtol=1e-3)


def test_a_line_that_leaves_its_speed() -> None:
    """Of constant drive and a load by the square it runs up by itself, from 40 to 100 rad/s."""
    more, torque = masses()
    push = propeller(LAST)
    free = free_line(more).replace("engine", drive_share=0.0, load_torque=-push)

    class Pushed(Oracle):
        def rate(self, t: float, y: np.ndarray) -> np.ndarray:
            d, v = y[:3], y[3:]
            shaft = STIFFNESS * np.diff(d) + DAMPING * np.diff(v)
            mean = FIRST + INERTIA @ v / INERTIA.sum()
            out = np.array([push + self.torque(FIRST * t + d[0], mean) + shaft[0], shaft[1] - shaft[0], -shaft[1]])
            out[2] -= QUADRATIC * (FIRST + v[2]) ** 2
            return np.concatenate([v, out / INERTIA])

    times = np.linspace(0.0, 1.5, 1501)
    expected = Pushed(torque).shafts(times, np.zeros(6))
    for run in (tn.simulate(free, 1.5, speed=FIRST), tn.simulate(free, turns=15, speed=FIRST)):
        within = times <= run.end
        found = run.torque_at(times[within])
        np.testing.assert_allclose(found, expected[within], rtol=0, atol=1e-6 * np.abs(expected).max())


def test_a_line_that_leaves_a_table_says_so() -> None:
    """Its drive fails to hold the first speed, at which the table begins; the amplitude is held."""
    one = {"order": 2, "speeds": [FIRST, LAST], "amplitudes": [3.0, 9.0]}
    free = free_line({"excitation": [one]}).replace("engine", drive_share=0.0, load_torque=-0.5 * propeller(FIRST))
    run = tn.simulate(free, 2.0, speed=FIRST)
    assert run.whole.last_turn()[1] < 0.95 * FIRST
    assert "the line left the table of engine.excitation 1, whose amplitude is held beyond its ends" in str(run)
    assert "left the table" in run.data.attrs["beyond_table"]
    held = free.replace("engine", excitation=[{"order": 2, "amplitude": 3.0}])
    same = tn.simulate(held, 2.0, speed=FIRST)
    np.testing.assert_allclose(run.torque, same.torque, rtol=0, atol=1e-6 * np.abs(same.torque).max())
    assert not tn.simulate(free_line({"excitation": [one]}), 1.0, speed=FIRST).beyond_table


def short(**table: Any) -> dict[str, Any]:
    return {"excitation": [{"order": 2, "amplitudes": [1.0, 2.0], **table}]}


REFUSED = [
    (
        free_line(short(speeds=[30.0, 90.0])),
        "engine.excitation 1: is a table from 286.479 rpm to 859.437 rpm, which does",
    ),
    (driven_line(short(speeds=[45.0, 190.0])), "pump.excitation 1: is a table from 429.718 rpm to"),
    (free_line(short(torques=[10.0, 300.0])), "engine.excitation 1: is a table from 10 N m to 300 N m, which does"),
]


@pytest.mark.parametrize(("line", "words"), REFUSED, ids=["too short", "begins too late", "too little load"])
def test_tables_that_do_not_cover_the_way(line: tn.Driveline, words: str) -> None:
    for call in (
        lambda: tn.run_up(line, FIRST, LAST, acceleration=ACCELERATION, steady=0),
        lambda: tn.simulate(line, 2.0, speed=tn.SpeedProfile([0.0, 2.0], [FIRST, LAST])),
        lambda: tn.safe_accelerations(line, FIRST, LAST, limit=1e4, accelerations=(20.0, 40.0), points=2),
        lambda: [tn.periodic_response(line, speed, compare=False) for speed in (FIRST, LAST)],
    ):
        with pytest.raises(tn.InputError, match=words):
            call()


def test_where_parts_may_slip() -> None:
    clutch = tn.SlipClutch(torque=400.0)
    line = free_line(masses()[0])
    slips = tn.Driveline([*line.elements[:3], clutch, tn.Disk(inertia=0.1), *line.elements[3:]])
    with pytest.raises(tn.InputError, match="engine.excitation: has an amplitude by its mean speed, which is not that"):
        tn.run_up(slips, FIRST, LAST, acceleration=ACCELERATION, steady=0)
