"""Torques as formulas and as functions, and disturbances by name: against closed forms and equations written out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.applied_torques import PlacedTorque
from trunnion.laws.formula import FUNCTIONS, formula

MOTOR, MILL, STIFFNESS, DAMPING = 0.5, 2.0, 2e4, 2.0
OMEGA = math.sqrt(STIFFNESS * (1 / MOTOR + 1 / MILL))
SUPPLY = 2 * math.pi * 50
Torque = Callable[[float, float, float], float]


def pair(damping: float = DAMPING) -> tn.Driveline:
    shaft = tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=damping)
    return tn.Driveline([tn.Disk(name="motor", inertia=MOTOR), shaft, tn.Disk(name="mill", inertia=MILL)])


def integrated(torque: Torque, speed: float, cuts: list[float]) -> np.ndarray:
    """Angles and speeds (4,) at the last of the times between which the torque on the motor is smooth in time."""
    x = np.array([0.0, 0.0, speed, speed])
    for low, high in zip(cuts, cuts[1:], strict=False):

        def rates(t: float, x: np.ndarray, low: float = low, high: float = high) -> list[float]:
            shaft = STIFFNESS * (x[1] - x[0]) + DAMPING * (x[3] - x[2])
            drive = torque(min(max(t, low), high - 1e-14), x[2], x[0])
            return [x[2], x[3], (drive + shaft) / MOTOR, -shaft / MILL]

        x = solve_ivp(rates, (low, high), x, "DOP853", rtol=1e-12, atol=1e-13, max_step=2e-4).y[:, -1]
    return x


def ends_as(run: tn.Transient, expected: np.ndarray, tolerance: float = 2e-8) -> None:
    np.testing.assert_allclose(run.angle[-1], expected[:2], atol=tolerance)
    np.testing.assert_allclose(run.speed[-1], expected[2:], atol=10 * tolerance)
    assert run.energy.error < 1e-9


CASES: list[tuple[str, Torque, list[float]]] = [
    (
        "300*exp(-t/0.2)*sin(2*pi*50*t) - 2^2*-1",
        lambda t, w, a: 300 * math.exp(-t / 0.2) * math.sin(SUPPLY * t) + 4,
        [0, 0.3],
    ),
    ("2*(50-speed)^2/10 + tanh(angle) + atan(t)*sqrt(1+t)*log(2+t)*tan(t)*cos(t)",
     lambda t, w, a: (50 - w) ** 2 / 5 + math.tanh(a) + math.atan(t) * math.sqrt(1 + t) * math.log(2 + t) * math.sin(t),
     [0, 0.3]),
    ("80*step(t-0.1)*step(0.2-t)", lambda t, w, a: 80.0 * (0.1 <= t < 0.2), [0, 0.1, 0.2, 0.3]),
    ("5*max(0, angle-1.5) - 9*abs(sin(3*angle)) + min(speed, 2e1)",
     lambda t, w, a: 5 * max(0.0, a - 1.5) - 9 * abs(math.sin(3 * a)) + min(w, 20.0), [0, 0.3]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "torque", "cuts"), CASES)
def test_a_formula_acts_as_the_same_written_out(text: str, torque: Torque, cuts: list[float]) -> None:
    run = tn.transient(pair(), 0.3, torque=[tn.AppliedTorque(on="motor", formula=text)], speed=10.0)
    ends_as(run, integrated(torque, 10.0, cuts))
    called = tn.TorqueFunction(on="motor", function=torque)
    by_function = tn.transient(pair(), 0.3, torque=[called], speed=10.0)
    np.testing.assert_allclose(by_function.speed[-1], run.speed[-1], atol=2e-6)


def test_since_and_until_are_exact() -> None:
    """A formula between two times, against the same torque as a table in steps."""
    window = tn.AppliedTorque(on="motor", formula="70", since=0.0123, until=0.0789)
    steps = tn.AppliedTorque(on="motor", time=[0.0123, 0.0789], torque=[70, 0], between="steps")
    function = tn.TorqueFunction(on="motor", function=lambda time, speed, angle: 70.0, since=0.0123, until=0.0789)
    expected = tn.transient(pair(), 0.2, torque=[steps], speed=10.0)
    for one in (window, function):
        run = tn.transient(pair(), 0.2, torque=[one], speed=10.0)
        for got, wanted in zip(run.at(np.linspace(0, 0.2, 41)), expected.at(np.linspace(0, 0.2, 41)), strict=True):
            np.testing.assert_allclose(got, wanted, atol=1e-8)


HOSTILE = [
    "__import__('os').system('true')", "t.__class__", "().__class__.__bases__[0]", "(lambda: 1)()", "[1]", "{t}",
    "a if b else c", "exec(1)", "eval(t)", "open(t)", "sin", "sin(1,2)", "min(1)", "", " ", "t t", "1+", "'a'", "t;t",
    "t\nt", "t=1", "t and t", "1_000", "0x10", "1j", "９*t", "ｔ", "\x00", "t\u200b", "1e999", "-" * 3000 + "t",
    "(" * 2100 + "t" + ")" * 2100, "sin(" * 900 + "t" + ")" * 900, "2" + "**2" * 900, "t+" * 3000 + "t", "9" * 4001,
    "%s", "t@t", "t//2", "t%2", "~t", "t<1", "print(t)", "getattr(t,t)", "time()", "pi()", "sin(t", "sin t", "#", "t#",
]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE)
def test_nothing_but_what_is_listed_is_read(text: str) -> None:
    begin = time.process_time()
    with pytest.raises(tn.InputError) as caught:
        tn.AppliedTorque(on="motor", formula=text)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400
    assert time.process_time() - begin < 2.0


def test_random_texts_are_read_or_refused() -> None:
    """What is read has the value of the same text by Python, whose operators it shares."""
    rng, read = np.random.default_rng(3), 0
    words = ["t", "speed", "angle", "pi", "2", "0.5", "1e1", *"+-*/().,", "**", "__", *FUNCTIONS]
    names = {name: getattr(math, name) for name in FUNCTIONS if hasattr(math, name)}
    names |= {"abs": abs, "min": min, "max": max, "step": lambda x: float(x >= 0), "pi": math.pi}
    for _ in range(6000):
        text = "".join(rng.choice(words, rng.integers(1, 7)))
        try:
            formula(text)
        except tn.InputError:
            continue
        stated = tn.AppliedTorque(on="motor", formula=text)
        value = PlacedTorque(stated, 0, 1.0, ()).value(0.3, 0.7, 1.1)
        try:
            known = eval(text, {"__builtins__": {}}, {**names, "t": 0.3, "speed": 0.7, "angle": 1.1})
        except (ZeroDivisionError, ValueError):
            known = math.nan
        if isinstance(known, complex):
            known = math.nan
        assert value == pytest.approx(known, rel=1e-14, nan_ok=True), text
        read += 1
    assert read > 250


def test_what_a_function_raises_ends_the_run_and_is_raised() -> None:
    def fails(time: float, speed: float, angle: float) -> float:
        if time > 0.05:
            raise ValueError("no data behind 50 ms")
        return 1.0

    with pytest.raises(ValueError, match="no data behind 50 ms"):
        tn.transient(pair(), 0.2, torque=[tn.TorqueFunction(on="motor", function=fails)], speed=1.0)
    with pytest.raises(tn.InputError, match="gives no number"):
        nothing = tn.TorqueFunction(on="motor", function=lambda time, speed, angle: "x")
        tn.transient(pair(), 0.2, torque=[nothing], speed=1.0)


def test_a_formula_without_a_value_ends_the_run() -> None:
    run = tn.transient(pair(), 0.5, torque=[tn.AppliedTorque(on="motor", formula="log(0.1-t)")], speed=1.0)
    assert not run.outcome.ok and run.end == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("text", ["1/0", "log(-1)", "sqrt(t-0.1)", "0^-1", "exp(800)", "log(speed-200)"])
def test_a_formula_without_a_value_at_the_start_is_refused_by_name(text: str) -> None:
    with pytest.raises(tn.InputError, match="ends where it begins: .* the formula .* of the torque on motor gives no"):
        tn.transient(pair(), 0.2, torque=[tn.AppliedTorque(on="motor", formula=text)], speed=100.0)


def test_a_run_that_ends_before_its_first_step_says_why() -> None:
    beyond = tn.AppliedTorque(on="motor", speed=[150.0, 200.0], torque=[1.0, 2.0])
    with pytest.raises(tn.InputError, match="the speed of motor leaves its table"):
        tn.transient(pair(), 0.2, torque=[beyond], speed=100.0)
    with pytest.raises(tn.InputError, match="nothing was computed"):
        tn.transient(pair(), 0.2, torque=[tn.AppliedTorque(on="motor", formula="1")], speed=100.0, within=1e-12)


def test_what_gives_no_number_on_the_way_is_named_and_the_run_kept() -> None:
    late = tn.AppliedTorque(on="motor", formula="sqrt(0-speed)", since=0.1)
    run = tn.transient(pair(), 0.2, torque=[late], speed=100.0)
    assert run.outcome.kind == "no number" and run.end == pytest.approx(0.1)
    assert "'sqrt(0-speed)' of the torque on motor" in run.outcome.sentence
    assert run.speed[-1] == pytest.approx(100.0)
    function = tn.TorqueFunction(on="motor", function=lambda time, speed, angle: math.nan if time > 0.1 else 1.0)
    ended = tn.transient(pair(), 0.2, torque=[function], speed=100.0)
    assert ended.outcome.kind == "no number" and "its function of the torque on motor" in ended.outcome.sentence


@pytest.mark.parametrize(
    ("text", "torque"),
    [
        ("-300-0.2*speed*abs(speed)^0.5", lambda t, s, a: -300 - 0.2 * s * abs(s) ** 0.5),
        ("-300+0.1*abs(speed)^1.5", lambda t, s, a: -300 + 0.1 * abs(s) ** 1.5),
        ("-300-10*sqrt(abs(angle-1))", lambda t, s, a: -300 - 10 * math.sqrt(abs(a - 1))),
    ],
)
def test_roots_and_powers_of_what_bends_go_through_zero(text: str, torque: Torque) -> None:
    run = tn.transient(pair(), 0.3, torque=[tn.AppliedTorque(on="motor", formula=text)], speed=20.0, tolerance=1e-11)
    assert run.outcome.kind == "reached", run.outcome.sentence
    known = integrated(torque, 20.0, [0.0, 0.3])
    assert run.speed[-1, 0] < 0 < run.speed[0, 0]
    assert np.concatenate([run.angle[-1], run.speed[-1]]) == pytest.approx(known, rel=1e-6, abs=1e-6)


def test_a_short_circuit_of_two_masses_in_closed_form() -> None:
    """q̈ + ω²q = T/J of a decaying sine: its particular part and the free one that starts it from rest."""
    size, decay = 900.0, 0.15
    for case, twice in (("three-phase short circuit", 0.0), ("two-phase short circuit", 450.0)):
        more = {"twice_amplitude": twice} if twice else {}
        fault = tn.Disturbance(on="motor", case=case, frequency="50 Hz", amplitude=size, decay=decay, **more)
        run = tn.transient(pair(0.0), 0.25, disturbance=[fault], speed=0.0)
        q = np.zeros(len(run.time))
        for amplitude, turns in ((size, 1), (-twice, 2)):  # q = mill − motor, T = −amplitude e^{st} on the motor
            s = -1 / decay + 1j * turns * SUPPLY
            part = amplitude / MOTOR / (s**2 + OMEGA**2)
            forced = part * np.exp(s * run.time)
            q += forced.imag - part.imag * np.cos(OMEGA * run.time) - (s * part).imag / OMEGA * np.sin(OMEGA * run.time)
        np.testing.assert_allclose(run.twist[:, 0], q, atol=2e-9)


def disturbed(**stated: object) -> tn.Disturbance:
    return tn.Disturbance(on="motor", **stated)


def decaying(t: float, since: float, size: float, decay: float, twice: float = 0.0) -> float:
    later = t - since
    return -math.exp(-later / decay) * (size * math.sin(SUPPLY * later) - twice * math.sin(2 * SUPPLY * later))


DISTURBANCES: list[tuple[dict[str, object], Torque, list[float]]] = [
    (
        {"case": "three-phase short circuit", "since": 0.05, "frequency": "50 Hz", "amplitude": 200, "decay": 0.1,
         "mean": 30, "mean_decay": 0.2, "lost": 40},
        lambda t, w, a: 0.0 if t < 0.05 else decaying(t, 0.05, 200, 0.1) - 30 * math.exp(-(t - 0.05) / 0.2) + 40,
        [0, 0.05, 0.3],
    ),
    (
        {"case": "reclosure", "since": 0.02, "frequency": "50 Hz", "amplitude": 200, "decay": 0.1, "cleared": 0.09,
         "reclosed": 0.2, "reclosing_amplitude": 350, "twice_amplitude": 100, "reclosing_twice_amplitude": 170,
         "lost": 25},
        lambda t, w, a: (decaying(t, 0.02, 200, 0.1, 100) if 0.02 <= t < 0.09 else 0.0)
        + (25 if 0.02 <= t < 0.2 else 0.0) + (decaying(t, 0.2, 350, 0.1, 170) if t >= 0.2 else 0.0),
        [0, 0.02, 0.09, 0.2, 0.3],
    ),
    (
        {"case": "synchronous start", "frequency": "50 Hz", "pole_pairs": 3, "speeds": [0, 8, 30],
         "amplitudes": [90, 60, 100], "phase": 0.4},
        lambda t, w, a: np.interp(w, [0, 8, 30], [90, 60, 100]) * math.cos(2 * (SUPPLY * t - 3 * a) + 0.4),
        [0, 0.3],
    ),
    (
        {"case": "bite and tail-out", "since": 0.04, "torque": 120, "rise": 0.03, "until": 0.15, "fall": 0.05},
        lambda t, w, a: -float(np.interp(t, [0.04, 0.07, 0.15, 0.2], [0, 120, 120, 0])),
        [0, 0.04, 0.07, 0.15, 0.2, 0.3],
    ),
    (
        {"case": "tip-in", "since": 0.1, "first": -20, "last": 90, "rise": 0.05},
        lambda t, w, a: float(np.interp(t, [0.1, 0.15], [-20, 90])), [0, 0.1, 0.15, 0.3],
    ),
    (
        {"case": "back-out", "since": 0.1, "first": 90, "last": -20, "rise": 0.0},
        lambda t, w, a: 90.0 if t < 0.1 else -20.0, [0, 0.1, 0.3],
    ),
    (
        {"case": "impacts", "peaks": [40, 90, 60], "width": 0.3, "spacing": 0.7, "angle": 0.5},
        lambda t, w, a: -sum(
            p * math.sin(math.pi / 0.3 * (a - b)) * (b <= a < b + 0.3)
            for p, b in ((40, 0.5), (90, 1.2), (60, 1.9))
        ),
        [0, 0.3],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("stated", "torque", "cuts"), DISTURBANCES, ids=[str(one[0]["case"]) for one in DISTURBANCES])
def test_disturbances_as_written_out(stated: dict[str, object], torque: Torque, cuts: list[float]) -> None:
    run = tn.transient(pair(), 0.3, disturbance=[disturbed(**stated)], speed=10.0)
    ends_as(run, integrated(torque, 10.0, cuts), 2e-7)


def test_many_impacts_take_what_their_half_sines_do() -> None:
    """40 of them on a heavy disk: each takes ∫ p sin dφ = 2 p w/π."""
    heavy = pair().replace("motor", inertia=1e5)
    series = disturbed(case="impacts", peaks=[70] * 40, width=0.2, spacing=0.25)
    run = tn.transient(heavy, 1.0, disturbance=[series], speed=11)
    assert run.energy.applied == pytest.approx(-40 * 70 * 2 * 0.2 / math.pi, rel=1e-9)


def test_an_emergency_brake_is_friction() -> None:
    brake = disturbed(case="emergency brake", torque=500, static=600, since=0.1, rise=0.05)
    friction = tn.FrictionTorque(on="motor", torque=500, static=600, since=0.1, rise=0.05)
    one = tn.transient(pair(), 0.5, disturbance=[brake], speed=20.0)
    other = tn.transient(pair(), 0.5, friction=[friction], speed=20.0)
    np.testing.assert_array_equal(one.speed, other.speed)
    assert one.energy.friction > 100


def test_a_scenario_of_a_file_and_back() -> None:
    text = """
format = 1

[[element]]
type = "Disk"
name = "motor"
inertia = 0.5

[[element]]
type = "Shaft"
stiffness = 2e4
damping = 2.0

[[element]]
type = "Disk"
name = "mill"
inertia = 2.0

[[scenario]]
name = "fault"
duration = "0.2 s"
speed = "10 rad/s"

[[scenario.torque]]
on = "mill"
formula = "-3*speed"

[[scenario.disturbance]]
on = "motor"
case = "two-phase short circuit"
frequency = "50 Hz"
amplitude = "0.2 kN*m"
twice_amplitude = "100 N*m"
decay = "0.1 s"
"""
    line = tn.loads(text)
    again = tn.loads(tn.dumps(line))
    assert again == line and again.scenario("fault").disturbance[0].twice_amplitude == 100.0
    run = tn.transient(again, "fault")
    fault = disturbed(
        case="two-phase short circuit", frequency=SUPPLY, amplitude=200, twice_amplitude=100, decay=0.1
    )  # fmt: skip
    load = tn.AppliedTorque(on="mill", formula="-3*speed")
    np.testing.assert_array_equal(
        run.speed, tn.transient(pair(), 0.2, torque=[load], disturbance=[fault], speed=10).speed
    )


def test_passing_takes_formulas_that_settle() -> None:
    bent = tn.Driveline(
        [tn.Disk(name="motor", inertia=1.0), tn.HookeJoint(angle="15 deg"), tn.Shaft(stiffness=2e3, damping=1.0),
         tn.Disk(name="load", inertia=4.0)]
    )  # fmt: skip
    weak = tn.AppliedTorque(on="motor", formula="2.5*min(1, max(0, (60-speed)*1e3))")
    assert tn.passing(bent, (15.0, 40.0), torque=[weak]).outcome.kind == "captured"
    found = tn.least_drive(bent, (15.0, 40.0), torque=[weak], factors=(1.0, 8.0), points=2, accuracy=0.9, phases=1)
    assert 2.0 < found.least <= 8.0
    with pytest.raises(tn.InputError, match="goes on changing with time"):
        tn.passing(bent, (15.0, 40.0), torque=[tn.AppliedTorque(on="motor", formula="2.5*sin(t)")])


def test_passing_ends_where_a_formula_gives_no_number() -> None:
    """The rigid line is integrated first; a value that is not a number once kept it from ending."""
    for low, text in ((100.0, "50*log(speed - 120)"), (125.0, "10 + 8*sqrt(130 - speed)")):
        torque = tn.AppliedTorque(on="motor", formula=text)
        with pytest.raises(tn.InputError, match="no finite number"):
            tn.passing(pair(), (low, 200.0), torque=[torque])
