"""Every analysis that counts an excitation counts it by value: by turns, in time and by both, against closed forms.

``CHECKS`` has one function for each analysis that ``trunnion.features`` says to count it: what the analysis finds, and
what the closed form of ``oracles.harmonic_lines`` has instead. A part of the angle that is dropped anywhere fails.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.harmonic_lines import AMPLITUDES, ANGLES, BY_TORQUE, DAMPING, NEAR, STIFFNESS, STRUCTURES, Shaken

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.features import TABLE, Treatment
from trunnion.floquet.ranges.resonances import resonances
from trunnion.floquet.ranges.span import Span

SPEED = 100.0
RANGE = (100.0, 104.0)
LIMIT = 1.0
FEATURES = ("excitation by order", "excitation in time", "excitation by order and frequency")
Pair = tuple[Any, Any]
"""What an analysis finds, and what is so."""


def forward(shaken: Shaken) -> tuple[float, float, int]:
    """Order and frequency as results name them, and the sense in which the description turns to that."""
    order, frequency = shaken.order * abs(shaken.ratio), shaken.in_time
    sense = -1 if frequency < 0 or (not frequency and order < 0) else 1
    return sense * order, sense * frequency, sense


def period(shaken: Shaken, speed: float = SPEED) -> float:
    return float(2 * np.pi / abs(shaken.turning(speed)))


def limited(shaken: Shaken) -> tn.Driveline:
    return shaken.line(limits=[tn.Limit(of="shaft", max_torque=LIMIT)])


def scheduled(shaken: Shaken) -> tn.Driveline:
    """With a schedule of the load of a disk, which none of the answers depends on."""
    schedule = tn.Schedule(name="travel", travel=[0.0, 0.1], loads={"shaken": [0.0, 0.0]})
    return limited(shaken).model_copy(update={"operation": tn.Operation(schedules=[schedule])})


def largest(shaken: Shaken, low: float, high: float) -> float:
    """Largest torque of the shaft [N m] over a range, on a grid that is fine about every resonance."""
    grid = [np.linspace(low, high, 20001)]
    for speed in shaken.meetings(low, high):
        grid.append(np.clip(speed * (1 + np.linspace(-0.02, 0.02, 20001)), low, high))
    return float(shaken.swing(np.concatenate(grid)).max())


def order_response(shaken: Shaken) -> Iterator[Pair]:
    speeds = np.array([40.0, 100.0, 180.0])
    found, (order, frequency, sense) = tn.order_response(shaken.line(), speeds), forward(shaken)
    torque = shaken.torque(speeds)
    yield (found.order, found.frequency), ([order], [frequency])
    yield found.torque[:, 0, 0], torque if sense > 0 else np.conj(torque)
    yield found.vibratory_torque[:, 0], np.abs(torque)
    yield found.vibratory_twist[:, 0], np.abs(shaken.twist(speeds))
    yield found.heat[:, 0], shaken.damping / 2 * np.abs(shaken.turning(speeds) * shaken.twist(speeds)) ** 2
    factor = np.sqrt(np.maximum(np.abs(shaken.turning(speeds)) / (2 * np.pi * 10), 1.0))
    yield found.rated_torque[:, 0], factor * np.abs(torque)
    wave = found.wave(SPEED)
    turned = shaken.torque(SPEED) * np.exp(1j * shaken.turning(SPEED) * wave.time)
    yield wave.torque[:, 0] - found.mean_torque[1, 0], turned.real
    yield wave.time[-1], period(shaken)
    if shaken.structure != "free":
        yield found.acceleration[:, 0], np.abs(shaken.turning(speeds) ** 2 * shaken.twist(speeds))


def speed_sweep(shaken: Shaken) -> Iterator[Pair]:
    found = tn.speed_sweep(shaken.line(), [40.0, 180.0])
    yield found.torque_amplitude[:, 0], shaken.swing([40.0, 180.0])
    yield found.twist_amplitude[:, 0], np.abs(shaken.twist([40.0, 180.0]))


def certify_peaks(shaken: Shaken) -> Iterator[Pair]:
    found = tn.certify_peaks(shaken.line(), {}, (SPEED, SPEED * (1 + 1e-9)))
    yield found.vibratory_torque[0], shaken.swing(SPEED)
    yield found.vibratory_twist[0], np.abs(shaken.twist(SPEED))
    bound = found.vibratory_torque_bound[0] / shaken.swing(SPEED)
    yield 1.0 <= bound < 1.006, True


def stability(shaken: Shaken) -> Iterator[Pair]:
    found = tn.stability(shaken.line(), SPEED).response
    assert found is not None
    yield found.torque_amplitude[0], shaken.swing(SPEED)
    turned = shaken.torque(SPEED) * np.exp(1j * shaken.turning(SPEED) * found.tau / SPEED)
    yield found.torque[:, 0] - found.torque_mean[0], turned.real


def campbell_diagram(shaken: Shaken) -> Iterator[Pair]:
    speeds = np.linspace(20.0, 340.0, 41)
    found = tn.campbell_diagram(shaken.line(), speeds)
    (one,) = found.lines
    yield (one.order, one.frequency), forward(shaken)[:2]
    yield one.at(speeds), np.abs(shaken.turning(speeds))
    yield one.torque, np.abs(shaken.amplitude(speeds)).max()
    meet = shaken.meetings(20.0, 340.0)
    yield [c.speed for c in found.crossings], meet
    yield [c.frequency for c in found.crossings], [shaken.mode.imag] * len(meet)


def assess(shaken: Shaken) -> Iterator[Pair]:
    low, high = 20.0, 340.0
    found = tn.assess(limited(shaken), (low, high))
    (check,) = (one for one in found.checks if one.name == "max torque of shaft")
    yield check.value, largest(shaken, low, high) + STIFFNESS * shaken.ahead
    assert check.cause is not None
    order, frequency, _ = forward(shaken)
    yield sorted(map(abs, (check.cause.order, check.cause.frequency))), sorted(map(abs, (order, frequency)))
    yield abs(check.cause.order * check.speed + check.cause.frequency), abs(shaken.turning(check.speed))
    separation = [one for one in found.checks if one.name.startswith("separation of mode")]
    apart = np.abs(np.abs(shaken.turning(np.linspace(low, high, 4001))) / shaken.mode.imag - 1).min()
    yield separation[0].value, 0.0 if shaken.meetings(low, high) else apart


def envelope(shaken: Shaken) -> Iterator[Pair]:
    found = tn.envelope(scheduled(shaken), (SPEED, SPEED), points=2)
    (check,) = (one for one in found.checks if one.name == "max torque of shaft")
    yield check.value, shaken.swing(SPEED) + STIFFNESS * shaken.ahead


def fatigue(shaken: Shaken) -> Iterator[Pair]:
    curve = tn.SNCurve(of="shaft", torque_amplitude=LIMIT, cycles=1e6, slope=3)
    duty = tn.Operation(duty=[tn.Duty(share=1.0, speed=SPEED)])
    found = tn.fatigue(shaken.line(sn_curves=[curve], operation=duty))
    yield found.spectra[0].amplitude.max(), shaken.swing(SPEED)
    yield found.damage_rate[0, 0], (shaken.swing(SPEED) / LIMIT) ** 3 / 1e6 / period(shaken)


def compare(shaken: Shaken) -> Iterator[Pair]:
    other = replace(shaken, inertia=1.1 * shaken.inertia)
    found = tn.compare(limited(shaken), limited(other), (SPEED, SPEED)).data
    row = list(found["quantity"].values).index("vibratory torque of shaft")
    yield found["before"][row], shaken.swing(SPEED)
    yield found["after"][row], other.swing(SPEED)


def inertia_of(shaken: Shaken) -> str:
    """The path of ``shaken.inertia``."""
    return "gear.inertia" if shaken.structure == "geared" else "shaken.inertia"


def sensitivity(shaken: Shaken) -> Iterator[Pair]:
    found = tn.sensitivity(shaken.line(), SPEED, [inertia_of(shaken)], of=["torques"]).data
    row = next(i for i, one in enumerate(found["quantity"].values) if one.startswith("vibratory torque of shaft"))
    step = 1e-4 * shaken.inertia
    before, behind = (replace(shaken, inertia=shaken.inertia + side * step).swing(SPEED) for side in (-1, 1))
    yield found["value"][row], shaken.swing(SPEED)
    yield found["derivative"][row, 0], (behind - before) / (2 * step)


def optimise(shaken: Shaken) -> Iterator[Pair]:
    free = {inertia_of(shaken): (0.9 * NEAR, 1.1 * NEAR)}
    found = tn.optimise(shaken.line(), free, "vibratory torque of shaft", (SPEED, SPEED), checks=False, designs=20).data
    yield found["aim_before"][0], shaken.swing(SPEED)
    yield found["aim_value"][0], replace(shaken, inertia=float(found["value"][0])).swing(SPEED)


def simulate(shaken: Shaken) -> Iterator[Pair]:
    if shaken.structure == "free":
        found = tn.simulate(shaken.line(), 0.1, speed=SPEED, start=shaken.start(SPEED), tolerance=1e-11)
        turned = shaken.torque(SPEED) * np.exp(1j * shaken.turning(SPEED) * found.time)
        yield found.torque[:, 0], turned.real
        return
    found = tn.simulate(shaken.line(), 0.05, speed=SPEED, tolerance=1e-11)
    x, v = shaken.motion(found.time, lambda t: SPEED * t, lambda t: SPEED, 0.0, [0.0, 0.0])
    yield found.torque[:, 0], STIFFNESS * x + shaken.damping * v


def passed(shaken: Shaken, run: Any) -> Iterator[Pair]:
    """The torque on a run along the profile of another course, from its own start."""
    since, until = 0.0, min(0.1, run.end)
    (first, course) = run.profile.courses(until)[0]
    time = np.linspace(since, min(until, first), 101)

    def angle(t: float) -> float:
        return course.angle + (course.speed + course.acceleration * t / 2) * t

    speed = lambda t: course.speed + course.acceleration * t  # noqa: E731
    x, v = shaken.motion(time, angle, speed, course.acceleration, run.at(time[:1])[0])
    yield run.torque_at(time)[:, 0], STIFFNESS * x + shaken.damping * v


def run_up(shaken: Shaken) -> Iterator[Pair]:
    found = tn.run_up(shaken.line(), 100.0, 104.0, acceleration=50.0, ramp=0.0, steady=3)
    yield from passed(shaken, found.simulation)
    assert found.steady is not None
    yield found.steady.swing[:, 0], shaken.swing(found.steady.speed)


def transient(shaken: Shaken) -> Iterator[Pair]:
    found = tn.transient(shaken.line(), 0.05, speed=SPEED, start=[0.0, 0.0], tolerance=1e-11)
    time = np.linspace(0.0, found.end, 101)
    x, v = shaken.motion(time, lambda t: SPEED * t, lambda t: SPEED, 0.0, [0.0, 0.0])
    yield found.torque_at(time)[:, 0], STIFFNESS * x + shaken.damping * v


def safe_accelerations(shaken: Shaken) -> Iterator[Pair]:
    found = tn.safe_accelerations(shaken.line(), 100, 104, limit=LIMIT, accelerations=(50.0, 100.0), points=2)
    for trial in found.trials:
        run = tn.run_up(shaken.line(), 100, 104, acceleration=trial.acceleration, steady=0)
        yield trial.share, max(abs(run.upper).max(), abs(run.lower).max()) / LIMIT
        yield from passed(shaken, run.simulation)


def swings(shaken: Shaken, found: Any) -> Iterator[Pair]:
    """Of the points of a branch over speed."""
    yield found.peak_to_peak[:, 0] / 2, shaken.swing(found.parameter)
    yield found.period, [period(shaken, float(speed)) for speed in found.parameter]
    assert found.outcome.ok and found.parameter[[0, -1]] == pytest.approx(RANGE)


def periodic_response(shaken: Shaken) -> Iterator[Pair]:
    found = tn.periodic_response(shaken.line(), SPEED)
    yield found.period, period(shaken)
    yield found.torque_peak_to_peak[0] / 2, shaken.swing(SPEED)


def linearity_check(shaken: Shaken) -> Iterator[Pair]:
    found = tn.linearity_check(shaken.line(), SPEED)
    order = abs(shaken.turning(SPEED)) / SPEED
    turned = shaken.torque(SPEED) if shaken.turning(SPEED) > 0 else np.conj(shaken.torque(SPEED))
    place = int(np.argmin(np.abs(found.order - order)))
    yield found.order[place], order
    yield found.linear_torque[place, 0], turned
    yield found.nonlinear_torque[place, 0], turned


def periodic_branch(shaken: Shaken) -> Iterator[Pair]:
    yield from swings(shaken, tn.periodic_branch(shaken.line(), "speed", *RANGE, longest_step=0.5))


def harmonic_balance(shaken: Shaken) -> Iterator[Pair]:
    yield from swings(shaken, tn.harmonic_balance(shaken.line(), "speed", *RANGE, longest_step=0.5).branch)


def frequency_response(shaken: Shaken) -> Iterator[Pair]:
    for method in ("harmonic balance", "shooting", "exact"):
        if method == "exact" and (shaken.law != "constant" or shaken.by == "in time"):
            continue  # refused, and over the frequency: see piecewise_branch
        found = tn.frequency_response(shaken.line(), *RANGE, method=method, longest_step=0.5)
        yield found.half_peak_to_peak, shaken.swing(found.frequency)


def settled(shaken: Shaken, points: Any) -> Iterator[Pair]:
    """States at whole forcing periods."""
    w, x, mean = shaken.turning(SPEED), complex(shaken.twist(SPEED)), shaken.ahead
    yield points, np.broadcast_to([x.real + mean, (1j * w * x).real], np.shape(points))


def lyapunov_spectrum(shaken: Shaken) -> Iterator[Pair]:
    found = tn.lyapunov_spectrum(shaken.line(), 40, speed=SPEED, starts=1, transient=20)
    yield found.interval, period(shaken)
    yield from settled(shaken, found.runs[0].states[-1])
    yield found.sum, 2 * shaken.mode.real


def lyapunov_sweep(shaken: Shaken) -> Iterator[Pair]:
    found = tn.lyapunov_sweep(shaken.line(), "shaft.damping", [DAMPING], periods=20, transient=5, speed=SPEED)
    yield found.system.forcing_period, period(shaken)
    yield found.exponents.sum(axis=1), [2 * shaken.mode.real]


def lyapunov_map(shaken: Shaken) -> Iterator[Pair]:
    line, axes = shaken.line(), (("shaft.damping", 29.0, 30.0, 2), ("shaft.stiffness", 2e4, 2.1e4, 2))
    found = tn.lyapunov_map(line, *axes, periods=400, transient=2, speed=SPEED)
    yield found.system.forcing_period, period(shaken)
    assert np.all(np.abs(found.exponent - shaken.mode.real * found.x / DAMPING) <= found.half_width)


def poincare_map(shaken: Shaken) -> Iterator[Pair]:
    yield from settled(shaken, tn.poincare_map(shaken.line(), 10, speed=SPEED, transient=60).points)


def bifurcation_diagram(shaken: Shaken) -> Iterator[Pair]:
    path = inertia_of(shaken)
    found = tn.bifurcation_diagram(shaken.line(), path, [NEAR], points=8, transient=60, speed=SPEED).data
    points = [found[name][0, 0] for name in found.data_vars if name.startswith(("rotation", "rate"))]
    yield from settled(shaken, np.stack(points, axis=-1))


def certify_chaos(shaken: Shaken) -> Iterator[Pair]:
    found = tn.certify_chaos(shaken.line(), 40, speed=SPEED, starts=1, points=10, transient=60, sweep=False)
    yield found.spectrum.interval, period(shaken)
    yield from settled(shaken, found.spectrum.runs[0].states[-1])


def exact_motion(shaken: Shaken) -> Iterator[Pair]:
    w, x = shaken.turning(SPEED), complex(shaken.twist(SPEED))
    found = tn.exact_motion(shaken.line(), 0.1, speed=SPEED, start=[x.real, (1j * w * x).real])
    yield found.torque[:, 0], (shaken.torque(SPEED) * np.exp(1j * w * found.time)).real


def piecewise_orbit(shaken: Shaken) -> Iterator[Pair]:
    found = tn.piecewise_orbit(shaken.line(), speed=SPEED)
    yield found.period, period(shaken)
    yield (found.torque_high - found.torque_low)[0] / 2, shaken.swing(SPEED)


def at_value(shaken: Shaken, value: Any) -> Any:
    """Half of the swing at values of what turns the excitation: the speed, or a frequency in its place."""
    if shaken.by != "in time":
        return shaken.swing(value)
    with_frequency = [replace(shaken, frequency=float(one)).swing(SPEED) for one in np.atleast_1d(value)]
    return np.array(with_frequency)


def piecewise_branch(shaken: Shaken) -> Iterator[Pair]:
    found = tn.piecewise_branch(shaken.line(), *RANGE, longest_step=0.5)
    assert found.outcome.ok
    yield found.peak_to_peak[:, 0] / 2, at_value(shaken, found.parameter)


def sweep(shaken: Shaken) -> Iterator[Pair]:
    found = tn.sweep(shaken.line(), np.array(RANGE))
    yield found.torque_peak_to_peak[:, 0] / 2, at_value(shaken, found.value)


LINEAR = (
    order_response, speed_sweep, stability, campbell_diagram, assess, envelope, compare, sensitivity, optimise,
    fatigue, simulate,
)  # fmt: skip
"""Those that take every structure and every law of the amplitude."""
DRIVEN = (
    periodic_response, linearity_check, periodic_branch, harmonic_balance, frequency_response, lyapunov_spectrum,
    lyapunov_sweep, lyapunov_map, poincare_map, bifurcation_diagram, certify_chaos, run_up, safe_accelerations,
)  # fmt: skip
"""Those of driven lines alone."""
CONSTANT = (
    transient, exact_motion, piecewise_orbit, piecewise_branch, sweep, certify_peaks,
)  # fmt: skip
"""Those of driven lines and constant amplitudes."""
ELSEWHERE = {"coupling_temperatures", "measure", "compare_measured", "identify"}
"""Of lines with a coupling alone: compared with equations written out in ``known_answers/test_coupling_tables.py``.
What a bench shows, and what is laid over it, are amplitudes of ``order_response``: compared in ``tests/measured``."""
CLOSE = {exact_motion: 1e-9, piecewise_orbit: 1e-9, piecewise_branch: 1e-9, sweep: 1e-9} | dict.fromkeys(LINEAR, 1e-8)
CLOSE |= {assess: 1e-6, sensitivity: 1e-6, simulate: 1e-4, transient: 1e-4, run_up: 1e-3, certify_peaks: 1e-6}
"""Share of the largest of a quantity that it may be off by; the others, and ``simulate``, count the swing of the disk
that its torque follows, which is of second order."""


def cells() -> Iterator[Any]:
    for check in (*LINEAR, *DRIVEN, *CONSTANT):
        structures = STRUCTURES if check in LINEAR else STRUCTURES[:2]
        laws = tuple(AMPLITUDES) if check not in CONSTANT else ("constant",)
        for by in ANGLES:
            for structure in structures:
                for law in laws:
                    if (law != "constant" and by == "in time") or (law in BY_TORQUE and structure == "free"):
                        continue
                    elsewhere = law != "constant" and check not in (order_response, simulate)
                    if elsewhere and (structure != "geared" or law == BY_TORQUE[1]):
                        continue
                    name = "-".join((check.__name__, by, structure, law)).replace(" ", "_")
                    yield pytest.param(check, Shaken(by, structure, law), id=name)


@pytest.mark.parametrize(("check", "shaken"), list(cells()))
def test_value(check: Callable[[Shaken], Iterator[Pair]], shaken: Shaken) -> None:
    pairs = 0
    for found, so in check(shaken):
        found, so = np.asarray(found), np.asarray(so)
        assert found.shape == so.shape
        scale = np.abs(so).max(initial=0.0)
        np.testing.assert_allclose(found, so, rtol=0, atol=CLOSE.get(check, 1e-4) * scale + 1e-15)
        pairs += 1
    assert pairs


def test_every_analysis_that_counts_an_excitation_is_here() -> None:
    counting = {name for name, row in TABLE.items() if Treatment.COUNTED in {row[key].treatment for key in FEATURES}}
    assert counting == {check.__name__ for check in (*LINEAR, *DRIVEN, *CONSTANT)} | ELSEWHERE


FIRED = (0.0, 1.1, 2.9)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_cylinders(structure: str) -> None:
    shaken = Shaken("by turns", structure, "by the square of the speed", cylinders=FIRED)
    for found, so in (*order_response(shaken), *campbell_diagram(shaken), *stability(shaken), *simulate(shaken)):
        np.testing.assert_allclose(found, so, rtol=0, atol=1e-4 * np.abs(so).max(initial=0.0))


def test_misfire() -> None:
    """Of each cylinder in turn: the others are left."""
    shaken = Shaken("by turns", "geared", cylinders=FIRED)
    found = tn.misfire(shaken.line(), [SPEED])
    left = [replace(shaken, cylinders=FIRED[:i] + FIRED[i + 1 :]) for i in range(3)]
    np.testing.assert_allclose(found.vibratory_torque[:, 0], [one.swing(SPEED) for one in left], rtol=1e-9)
    np.testing.assert_allclose(found.normal[0], shaken.swing(SPEED), rtol=1e-9)


@pytest.mark.parametrize("by", ANGLES)
def test_exact_oscillator(by: str) -> None:
    shaken = Shaken(by)
    shaft = tn.PiecewiseShaft(breakpoints=[-1.0, 1.0], stiffnesses=[STIFFNESS] * 3, damping=DAMPING, name="shaft")
    line = shaken.line()
    found = tn.exact_oscillator(tn.Driveline([line.elements[0], shaft, line.elements[2]]), SPEED)
    assert found.frequency == pytest.approx(abs(shaken.turning(SPEED)))
    orbit = tn.piecewise_orbit(found)
    assert (orbit.highest - orbit.lowest) / 2 == pytest.approx(abs(shaken.twist(SPEED)), rel=1e-9)


OPPOSITE = {"order": -2.0, "frequency": 500.0, "phase": 0.4, "amplitude": 0.05}


def test_both_signs_turned_are_the_same_torque() -> None:
    """(k, ν, phase) and (−k, −ν, −phase)."""
    turned = {key: value if key == "amplitude" else -value for key, value in OPPOSITE.items()}
    for structure in STRUCTURES:
        lines = [Shaken(structure=structure).line().replace("shaken", excitation=[one]) for one in (OPPOSITE, turned)]
        one, other = (tn.order_response(line, [40.0, SPEED]) for line in lines)
        np.testing.assert_allclose(one.torque, other.torque, rtol=1e-12)
        assert [one.order.tolist(), one.frequency.tolist()] == [other.order.tolist(), other.frequency.tolist()]
        one, other = (tn.simulate(line, 0.05, speed=SPEED) for line in lines)
        np.testing.assert_allclose(one.torque, other.torque, rtol=0, atol=1e-8)
        one, other = (tn.campbell_diagram(line, [40.0, 90.0]) for line in lines)
        assert str(one) == str(other)


def added(excitations: list[dict[str, Any]], speed: float) -> tuple[np.ndarray, tn.OrderResponse]:
    """Torque of the driven line over a long time, each harmonic in closed form, and the order response."""
    time, whole = np.linspace(0.0, 20.0, 400001), 0.0
    for one in excitations:
        w = one.get("order", 0.0) * speed + one.get("frequency", 0.0)
        spring = STIFFNESS + 1j * w * DAMPING
        torque = spring * one["amplitude"] * np.exp(1j * one["phase"]) / (spring - w**2 * NEAR)
        whole = whole + (torque * np.exp(1j * w * time)).real
    return np.asarray(whole), tn.order_response(Shaken().line().replace("shaken", excitation=excitations), [speed])


def test_those_that_share_a_base_are_added_with_their_phases() -> None:
    """(−2, 500) and (−4, 1000) repeat after one period at every speed, (2, 0) with them does not."""
    double = {"order": -4.0, "frequency": 1000.0, "phase": -1.0, "amplitude": 0.04}
    for speed in (70.0, SPEED, 262.5):
        seen, found = added([OPPOSITE, double], speed)
        assert not found.sum_is_bound
        assert found.vibratory_torque[0, 0] == pytest.approx(np.ptp(seen) / 2, rel=1e-5)
        assert found.peak_torque[0, 0] == pytest.approx(np.abs(seen).max(), rel=1e-5)
    by_turns = {"order": 2.0, "phase": 0.3, "amplitude": 0.03}
    seen, found = added([OPPOSITE, double, by_turns], 71.7)
    alone = added([OPPOSITE, double], 71.7)[1].vibratory_torque + added([by_turns], 71.7)[1].vibratory_torque
    assert found.sum_is_bound
    np.testing.assert_allclose(found.vibratory_torque, alone, rtol=1e-9)
    assert np.ptp(seen) / 2 == pytest.approx(alone[0, 0], rel=1e-2)


SYNCHRONOUS = {"order": -4, "frequency": "100 Hz", "amplitude": 0.05, "phase": 0.4}
"""Stands still at 1500 rpm, which no two floating numbers are to the last figure."""


def test_what_stands_still_is_a_constant_torque() -> None:
    still, push = tn.rpm(1500), 0.05 * np.cos(0.4)
    for structure, ratio in (("driven", 1.0), ("geared", 2.0)):
        excitation = {**SYNCHRONOUS, "order": -4 / ratio}
        line = Shaken(structure=structure).line().replace("shaken", excitation=[excitation])
        found = tn.order_response(line, [0.99 * still, still])
        assert found.peak_torque[1, 0] == pytest.approx(ratio * push, rel=1e-9)
        assert found.vibratory_torque[1, 0] == 0 and found.speed_fluctuation[1, -1] == 0 and found.heat[1, 0] == 0
        assert "stands still at" in str(found) and "drives the line away" not in str(found)
        wave = found.wave(still)
        np.testing.assert_allclose(wave.torque[:, 0], ratio * push, rtol=1e-9)
        assert tn.stability(line, still).response.torque_amplitude[0] == 0
        run = tn.simulate(line, 1.0, speed=still)
        assert run.torque[-1, 0] == pytest.approx(ratio * push, rel=1e-3)
        orbit = tn.periodic_response(line, still)
        assert orbit.torque_peak_to_peak[0] < 1e-6 * push
        assert tn.exact_motion(line, 1.0, speed=still).torque[-1, 0] == pytest.approx(ratio * push, rel=1e-3)
        with pytest.raises(tn.InputError, match="stands still, so its motion has no period"):
            tn.piecewise_orbit(line, speed=still)
        for follow in (tn.piecewise_branch, lambda *a: tn.periodic_branch(a[0], "speed", *a[1:])):
            branch = follow(line, 0.9 * still, 1.1 * still)
            assert not branch.outcome.ok and branch.parameter.max() < still


def test_what_stands_still_drives_a_free_line_away() -> None:
    """Against its inertia, or against the loads that go with its speed: the twist is that of the steady push."""
    still, push = tn.rpm(1500), 0.05 * np.cos(0.4)
    for viscous, held in ((0.0, 0.1 / 0.3), (0.02, 1.0)):
        line = limited(Shaken(structure="free")).replace("shaken", excitation=[SYNCHRONOUS])
        line = line.replace(line.names[2], viscous_load=viscous)
        found = tn.order_response(line, [0.999999 * still, still])
        change = np.abs(found.torque[1, 0, 0].real) - held * push
        assert abs(change) < 1e-9
        assert np.isnan(found.speed_fluctuation[1]).all() and np.isfinite(found.peak_torque).all()
        assert "drives the line away from that speed" in str(found)
        if viscous:
            continue
        assert np.abs(found.torque[0, 0, 0]) == pytest.approx(0.05 * held, rel=1e-3)
        (check,) = (c for c in tn.assess(line, (50.0, still)).checks if c.name == "max torque of shaft")
        assert np.isfinite(check.value) and check.value > held * push


@pytest.mark.parametrize("order", [-2000.0, -7.0, 40.0])
def test_the_search_finds_resonances_beside_the_standstill(order: float) -> None:
    """|kΩ + ν| = ω at two speeds so close to one another that no grid sees either; the upper one is the largest."""
    still, size, shaken = 163.3, 1e-6, Shaken(damping=0.05)
    excitation = {"order": order, "frequency": -order * still, "quadratic_amplitude": size}
    line = limited(shaken).replace("shaken", excitation=[excitation])
    low, high = 20.0, 400.0
    apart = shaken.mode.imag / abs(order)
    meet = [still - apart, still + apart]
    assert sorted(resonances(Span(assemble(line), low, high)).speed) == pytest.approx(meet, rel=1e-9)
    (check,) = (one for one in tn.assess(line, (low, high)).checks if one.name == "max torque of shaft")
    w = np.linspace(0.999, 1.001, 20001) * abs(shaken.mode)
    spring = STIFFNESS + 1j * w * shaken.damping
    top = np.abs(spring * size * (still + w / abs(order)) ** 2 / (spring - w**2 * NEAR)).max()
    assert check.value == pytest.approx(top, rel=1e-5)
    assert check.speed == pytest.approx(meet[1], rel=1e-3)
    swept = tn.sweep_speeds(line, low, high)
    assert all(np.abs(swept - speed).min() < 1e-3 * apart for speed in meet)
    met = tn.campbell_diagram(line, [low, 0.5 * still, high]).crossings
    assert [one.speed for one in met] == pytest.approx(meet)


def test_what_has_no_common_period_is_refused_or_said() -> None:
    line = Shaken().line().replace("shaken", excitation=[OPPOSITE, {"order": 1.0, "amplitude": 0.05}])
    with pytest.raises(tn.InputError, match="without a common period"):
        tn.periodic_response(line, 71.7)
    for analysis in (tn.piecewise_branch, lambda *a: tn.sweep(a[0], [a[1]])):
        with pytest.raises(tn.InputError, match="by its rotation and in time"):
            analysis(line, 70.0, 80.0)
    assert tn.order_response(line, [71.7]).sum_is_bound
    with pytest.raises(tn.InputError, match="does not close"):
        tn.periodic_response(Shaken(structure="free").line(), SPEED)


def test_cylinders_repeat_orders_alone() -> None:
    with pytest.raises(tn.InputError, match="repeat orders, not a frequency"):
        tn.Disk(inertia=1.0, excitation=[OPPOSITE], firing_angles=[0.0, 1.0])


def test_bent_line_makes_side_orders_of_it() -> None:
    """As the nonlinear motion has them, to second order."""
    joint = tn.HookeJoint(angle=0.05, name="joint")
    start, shaft, disk = Shaken().line().elements
    for excitation in ({**OPPOSITE, "amplitude": 5.0}, {"order": 1.0, "frequency": 60.0, "amplitude": 5.0}):
        line = tn.Driveline([start, tn.Shaft(stiffness=3e4, damping=20), tn.Disk(inertia=0.1), joint, shaft, disk])
        line = line.replace("shaken", excitation=[excitation])
        checked = tn.linearity_check(line, SPEED)
        sides = tn.order_response(line, [SPEED])
        assert np.count_nonzero(sides.frequency) > 2
        assert checked.departure < 2e-3


def test_the_report_and_remedies_name_it() -> None:
    shaken = Shaken("by both, against each other", damping=3.0)
    limit = [tn.Limit(of="shaft", max_torque=0.3)]
    page = tn.report(shaken.line(limits=limit, operation=tn.Operation(speed=SPEED, speed_range=(20.0, 340.0)))).html
    (low, _) = shaken.meetings(20.0, 500.0)
    assert "79.5775 Hz -2 per turn" in page.replace("\u00a0", " ") and f"{low * 30 / np.pi:.4g}" in page
    found = str(tn.remedies(shaken.line(limits=limit), (90.0, 130.0)))
    assert f"moves the excitation at 79.5775 Hz -2 per turn on mode 1 from {low:.5g} rad/s" in found
