"""Machines with a torque over speed against nonlinear equations of motion, written out and differenced."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import trunnion as tn

STIFFNESS, DAMPING, MOTOR, LOAD = 2e4, 6.0, 0.4, 3.0
POINTS = ((0.0, 620.0), (60.0, 560.0), (110.0, 700.0), (140.0, 610.0), (157.0, 0.0))
Torque = Callable[[float], float]


def line(drive: tn.Element, load: tn.Element) -> tn.Driveline:
    """A drive, a shaft, gears that halve and reverse the speed, a load."""
    return tn.Driveline([drive, tn.Shaft(stiffness=STIFFNESS, damping=DAMPING, name="shaft"), tn.Ratio(ratio=-2), load])


def kloss(speed: float, top: float, slip: float, synchronous: float) -> float:
    s = 1 - speed / synchronous
    return 2 * top * s * slip / (s**2 + slip**2)


def set_kloss(at: float, torque: float) -> Torque:
    """V/f control: the curve moved along the speed as it is, its slip in rad/s kept."""
    width, top = 0.2 * 157.0, 900.0

    def moved(speed: float, synchronous: float) -> float:
        x = synchronous - speed
        return 2 * top * x * width / (x**2 + width**2)

    there = brentq(lambda w: moved(at, w) - torque, at, at + width, xtol=1e-13)
    return lambda speed: moved(speed, there)


def by_points(speed: float) -> float:
    from scipy.interpolate import PchipInterpolator

    return float(PchipInterpolator(*np.transpose(POINTS))(speed))


def square(speed: float) -> float:
    return 0.09 * speed**2


MOTOR_OF_KLOSS = {"breakdown_torque": 900.0, "breakdown_slip": 0.2, "synchronous_speed": 157.0}
FAN = tn.Fan(inertia=LOAD, quadratic_load=0.09)
TABLE = [{"speed": w, "torque": t} for w, t in POINTS]
RATED = tn.Pump(inertia=LOAD, rated_power=30e3, rated_speed=74.0, load_torque=50.0)
CASES: dict[str, tuple[tn.Element, tn.Element, float | None, Callable[[float, float], Torque], Torque]] = {
    "mains": (
        tn.Motor(inertia=MOTOR, **MOTOR_OF_KLOSS), FAN, None, lambda w, t: lambda v: kloss(v, 900, 0.2, 157), square,
    ),
    "voltage over frequency": (
        tn.Motor(inertia=MOTOR, **MOTOR_OF_KLOSS, drive_share=1), FAN, 110.0, set_kloss, square,
    ),
    "points": (tn.Motor(inertia=MOTOR, curve=TABLE), FAN, None, lambda w, t: by_points, square),
    "controller": (
        tn.Motor(inertia=MOTOR, gain=35.0, torque_limit=400.0, drive_share=1), FAN, 130.0,
        lambda w, t: lambda v: float(np.clip(t + 35.0 * (w - v), -400, 400)), square,
    ),
    "controller at its own speed": (
        tn.Motor(inertia=MOTOR, gain=35.0, set_speed=140.0, torque_limit=400.0), FAN, None,
        lambda w, t: lambda v: float(np.clip(35.0 * (140.0 - v), -400, 400)), square,
    ),
    "constant power": (
        tn.Motor(inertia=MOTOR, gain=9.0, drive_share=1), tn.Generator(inertia=LOAD, power=20e3), 100.0,
        lambda w, t: lambda v: t + 9.0 * (w - v), lambda v: 20e3 / v,
    ),
    "asynchronous generator": (
        tn.Disk(inertia=MOTOR, load_torque=-200.0),
        tn.Generator(inertia=LOAD, breakdown_torque=900.0, breakdown_slip=0.2, synchronous_speed=70.0), 0.0,
        lambda w, t: lambda v: 200.0, lambda v: -kloss(v, 900, 0.2, 70),
    ),
    "rated pump": (
        tn.Motor(inertia=MOTOR, **MOTOR_OF_KLOSS), RATED, None, lambda w, t: lambda v: kloss(v, 900, 0.2, 157),
        lambda v: 50.0 + (30e3 / 74.0 - 50.0) * (v / 74.0) ** 2,
    ),
}  # fmt: skip
"""Drive, load, speed asked for, the drive's torque by its speed once it runs at one with a torque, the load's."""


def jacobian(speed: float, drive: Torque, load: Torque) -> np.ndarray:
    """Of θ₁, φ, ω₁, φ̇ by central differences of the nonlinear equations; φ the shaft's end, half of which turns the
    load."""

    def rate(x: np.ndarray) -> np.ndarray:
        twist = STIFFNESS * (x[0] - x[1]) + DAMPING * (x[2] - x[3])
        return np.array([
            x[2], x[3], (drive(x[2]) - twist) / MOTOR, (twist - load(x[3] / 2) / 2) / (LOAD / 4),
        ])  # fmt: skip

    at = np.array([drive(speed) / STIFFNESS, 0.0, speed, speed])
    np.testing.assert_allclose(rate(at)[2:], 0.0, atol=1e-6)
    steps = np.diag([1e-6, 1e-6, 1e-4, 1e-4])
    return np.stack([(rate(at + step) - rate(at - step)) / (2 * step.sum()) for step in steps], axis=1)


@pytest.mark.parametrize("name", CASES)
def test_slopes_are_those_of_the_nonlinear_equations(name: str) -> None:
    """Multipliers over the period, of lines at the speed asked for or at that which an own root finder finds."""
    drive, load, asked, driven, resisted = CASES[name]
    built = line(drive, load)
    if asked is None:
        asked = float(brentq(lambda w: driven(w, 0.0)(w) - resisted(w / 2) / 2, 110.0, 156.9, xtol=1e-13))
        found = tn.stability(built)
        assert found.speed == pytest.approx(asked, rel=1e-10)
    elif not asked:
        asked = float(brentq(lambda w: driven(w, 0.0)(w) - resisted(w / 2) / 2, 140.0, 165.0, xtol=1e-13))
        found = tn.stability(built, asked)
    else:
        found = tn.stability(built, asked)
    system = jacobian(asked, driven(asked, resisted(asked / 2) / 2), resisted)
    wanted = np.linalg.eigvals(expm(system * 2 * np.pi * 0.5 / asked))
    for one in found.multipliers:
        assert np.abs(wanted - one).min() < 2e-7
    assert len(found.multipliers) == len(wanted)


def test_a_propeller_is_what_its_numbers_say() -> None:
    """Against the disk that one writes by hand; at constant speed of advance a more of its torque over speed damps."""
    engine = tn.Disk(inertia=9.0, drive_share=1)
    blades = {"order": 4, "phase": 0.3}
    by_hand = tn.Disk(
        inertia=75.0, quadratic_load=20.0, excitation=[blades | {"quadratic_amplitude": 1.6}], name="propeller"
    )
    made = tn.Propeller(
        inertia=60.0,
        entrained_inertia=15.0,
        quadratic_load=20.0,
        excitation=[blades | {"share": 0.08}],
        name="propeller",
    )
    speeds = np.linspace(10.0, 60.0, 11)
    one, other = (tn.order_response(line(engine, end), speeds) for end in (by_hand, made))
    np.testing.assert_allclose(one.torque, other.torque, rtol=1e-12)
    np.testing.assert_allclose(one.mean_torque, other.mean_torque, rtol=1e-12)
    # The slope: 2c₂ω of the square, (2 + 0.9)c₂ω with the flow held, as a disk with a viscous load for the rest.
    flow, at = line(engine, made.but(damping_factor=2.9)), 40.0
    rest = line(engine, by_hand.but(viscous_load=0.9 * 20.0 * at / 2, load_torque=-0.9 * 20.0 * (at / 2) ** 2))
    np.testing.assert_allclose(tn.order_response(flow, [at]).torque, tn.order_response(rest, [at]).torque, rtol=1e-12)
    held, square = (np.abs(tn.order_response(one, [at]).torque).max() for one in (flow, line(engine, made)))
    assert held < 0.99 * square


def test_the_mean_speed_is_where_the_nonlinear_line_settles() -> None:
    """Two machines that each have a balance, run from below and above through their own nonlinear equations."""
    motor, fan = tn.Motor(inertia=MOTOR, curve=TABLE), FAN
    settled = tn.stability(line(motor, fan)).speed
    for start in (30.0, 156.0):
        run = solve_ivp(
            lambda t, x: [(by_points(x[0]) - square(x[0] / 2) / 2) / (MOTOR + LOAD / 4)], (0.0, 6.0), [start], rtol=1e-9
        )
        assert run.y[0, -1] == pytest.approx(settled, rel=1e-6)


def test_a_share_is_of_the_own_torque() -> None:
    """Ripple of a motor that sits on one shaft with a brake: of its own mean torque, not of what is left of both."""
    brake = tn.Disk(inertia=0.1, load_torque=150.0)
    motor = tn.Motor(inertia=MOTOR, gain=9.0, drive_share=1, excitation=[{"order": 6, "share": 0.02}], name="motor")
    both = tn.Driveline(
        [motor, brake, tn.Shaft(stiffness=STIFFNESS, damping=DAMPING), tn.Disk(inertia=LOAD, load_torque=50)]
    )
    listed = both.replace("motor", excitation=[{"order": 6, "amplitude": 0.02 * 200.0}])
    np.testing.assert_allclose(
        tn.order_response(both, [80.0]).torque, tn.order_response(listed, [80.0]).torque, rtol=1e-12
    )


def test_a_table_beside_the_file(tmp_path: Path) -> None:
    """Read with its units; complaints name row and column, never what stands there."""
    text = 'format = 1\n[[element]]\ntype = "Motor"\ninertia = 0.4\ncurve = "motor.csv"\n[[element]]\ntype = "Shaft"\n'
    (tmp_path / "line.toml").write_text(
        text + 'stiffness = 1e4\n[[element]]\ntype = "Fan"\ninertia = 1.0\nload_torque = 3.0\n'
    )
    table = tmp_path / "motor.csv"
    table.write_text("speed [rpm];torque [kN*m]\n# nameplate\n0;0.2\n1500;0.09\n")
    motor = tn.load(tmp_path / "line.toml").elements[0]
    assert motor.curve == tn.read_curve(table)
    assert [one.speed for one in motor.curve] == pytest.approx([0.0, tn.rpm(1500)])
    assert [one.torque for one in motor.curve] == [200.0, 90.0]
    for bad, words in (
        ("speed,torque [N*m]\n0,1\n1,2\n", "motor.csv.speed has no unit"),
        ("speed [N*m],torque [N*m]\n0,1\n1,2\n", "motor.csv.speed has no unit of a speed"),
        ("speed [rpm],torque [N*m]\n0,1\n0,2\n", "motor.csv.speed does not rise in speed"),
        ("speed [rpm],torque [N*m]\n0,1\n9,nan\n", "motor.csv: row 3.torque is not a number"),
        ("speed [rpm],torque [N*m]\n0,1\n", "motor.csv.speed must have two points"),
        ("speed [rpm]\n0\n", "motor.csv.torque is missing among the columns"),
    ):
        table.write_text(bad)
        with pytest.raises(tn.InputError) as caught:
            tn.load(tmp_path / "line.toml")
        assert words in str(caught.value) and "curve" in str(caught.value)


@pytest.mark.parametrize("geared", [False, True], ids=["tree", "differential"])
def test_a_lag_in_closed_form(geared: bool) -> None:
    """Two inertias and a shaft, the slope k of the motor k/(1 + iν/ν_c): solved by hand at every order and speed.

    The same behind a differential whose other leg is a brake of its own, against a dense solution with k in its place.
    """
    corner, gain = 260.0, 35.0
    shaken = [{"order": n, "amplitude": 12.0, "phase": 0.2 * n} for n in (1, 3, 8)]
    motor = tn.Motor(inertia=MOTOR, gain=gain, drive_share=1, corner_frequency=corner, excitation=shaken, name="motor")
    shaft, load = tn.Shaft(stiffness=STIFFNESS, damping=DAMPING, name="shaft"), tn.Disk(inertia=LOAD, load_torque=80)
    speeds = np.linspace(20.0, 150.0, 14)
    nu = np.array([1.0, 3.0, 8.0])[:, None] * speeds
    k = gain / (1 + 1j * nu / corner)
    force = 12.0 * np.exp(0.2j * np.array([1, 3, 8]))[:, None]
    spring = STIFFNESS + 1j * nu * DAMPING
    if not geared:
        found = tn.order_response(tn.Driveline([motor, shaft, load]), speeds)
        far = LOAD
    else:
        legs = [tn.Differential(ratio=1, inertia=1e-9, name="d"), tn.Disk(inertia=1.5, load_torque=40, name="left"),
                tn.Disk(inertia=1.5, load_torque=40, name="right", after="d.right")]  # fmt: skip
        found = tn.order_response(tn.Driveline([motor, shaft, tn.Disk(inertia=1e-9), *legs]), speeds)
        far = 3.0 + 2e-9  # equal legs turn as one
    near = -(nu**2) * MOTOR + 1j * nu * k + spring
    end = -(nu**2) * far + spring
    twist = force * (end - spring) / (near * end - spring**2)
    wanted = -spring * twist
    order = {o: i for i, o in enumerate(np.round(found.order, 9).tolist())}
    got = np.stack([found.torque[:, order[float(n)], 0] for n in (1, 3, 8)])
    np.testing.assert_allclose(got, wanted, rtol=2e-8)
    quasi = tn.order_response(tn.Driveline([motor.but(corner_frequency=None), shaft, load]), speeds)
    assert np.abs(quasi.torque - found.torque).max() > 0.02 * np.abs(wanted).max() or geared


def test_the_lag_of_an_asynchronous_machine() -> None:
    """First order with the breakdown slip times the angular frequency of the supply, as its torque in time has it."""
    motor = tn.Motor(inertia=MOTOR, **MOTOR_OF_KLOSS, pole_pairs=2)
    assert motor.lag_frequency == pytest.approx(0.2 * 2 * 157.0)
    stated = motor.but(pole_pairs=None, corner_frequency=62.8)
    shaken = FAN.but(excitation=[{"order": 4, "amplitude": 20.0}])
    one, other = (
        tn.order_response(line(drive, shaken), [tn.stability(line(drive, shaken)).speed]) for drive in (motor, stated)
    )
    np.testing.assert_allclose(one.torque, other.torque, rtol=1e-12)


def test_a_lag_behind_gears() -> None:
    """A motor behind gears of ratio i, turning 1/i times as fast: what it carries counts by 1/i² on the shaft."""
    far = tn.Disk(inertia=LOAD, load_torque=80, excitation=[{"order": 3, "amplitude": 9.0}])
    shaft = tn.Shaft(stiffness=STIFFNESS, damping=DAMPING)
    geared = tn.Motor(inertia=MOTOR * 16, gain=35.0 * 16, drive_share=1, corner_frequency=260.0)
    beside = tn.Motor(inertia=MOTOR, gain=35.0, drive_share=1, corner_frequency=260.0)
    speeds = np.linspace(20.0, 150.0, 6)
    one = tn.order_response(tn.Driveline([far, shaft, tn.Disk(inertia=1e-3), tn.Ratio(ratio=-4), geared]), speeds)
    other = tn.order_response(tn.Driveline([far, shaft, tn.Disk(inertia=1e-3), beside]), speeds)
    np.testing.assert_allclose(one.torque, other.torque, rtol=1e-11)


def test_a_mean_speed_that_nothing_keeps_is_said() -> None:
    """Constant power behind a drive of constant torque: the slope −P/ω² at the input, and the drive that keeps it."""
    generator = tn.Generator(inertia=LOAD, power=20e3, excitation=[{"order": 2, "amplitude": 5.0}], name="generator")
    found = tn.order_response(line(tn.Disk(inertia=MOTOR, drive_share=1), generator), [100.0, 140.0])
    (said,) = [str(one) for one in found.findings if "Nothing keeps the mean speed" in str(one)]
    assert f"at 100 rad/s least: what resists falls with it by {20e3 / 50.0**2 / 4:.4g} N m s/rad" in said
    assert "(generator). Give the drive a torque that falls more steeply" in said
    assert not tn.stability(line(tn.Disk(inertia=MOTOR, drive_share=1), generator), 100.0).verdict.name == "STABLE"
    kept = tn.order_response(line(tn.Motor(inertia=MOTOR, gain=9.0, drive_share=1), generator), [100.0, 140.0])
    assert not [one for one in kept.findings if "Nothing keeps" in str(one)]


def test_a_motor_tied_rigidly_to_its_load() -> None:
    """Torques that cancel on one shaft balance as they do through a spring; what is left over is still refused."""
    motor = tn.Motor(name="motor", inertia=1.0, breakdown_torque=300.0, breakdown_slip=0.1, synchronous_speed=157.0)
    fan = tn.Fan(name="fan", inertia=1.0, quadratic_load=0.005)
    encoder = [tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=0.01)]
    for elements in ([motor, fan], [motor, fan, *encoder], [motor, tn.Ratio(ratio=3), fan, *encoder]):
        tied = tn.Driveline(elements)
        (balance,) = tn.mean_speeds(tied)
        found = tn.stability(tied)
        # The whole line turns as one inertia, whose swing dies out by the slope over it; the encoder is light.
        ratio = 1 / 3 if len(elements) == 5 else 1.0
        rate = -balance.slope / (1.0 + ratio**2 * (1.01 if len(elements) > 2 else 1.0))
        assert found.growth_rate == pytest.approx(rate, rel=2e-3)
        with pytest.raises(tn.InputError, match=r"loads add up to .* \(fan .*\), the drives to .* \(motor "):
            tn.stability(tied, 0.99 * balance.speed)


def test_the_speed_as_printed_is_the_balance() -> None:
    """A speed rounded to five figures runs at the balance and says so; one that differs by more is refused."""
    motor = tn.Motor(inertia=0.45, breakdown_torque=520, breakdown_slip=0.12, synchronous_speed="1500 rpm")
    fan = tn.Fan(inertia=3.2, rated_power="30 kW", rated_speed="1460 rpm", excitation=[{"order": 8, "share": 0.03}])
    elements = [motor, tn.Shaft(stiffness="22 kN*m/rad", damping=4), fan]
    by_itself = tn.Driveline(elements)
    (own,) = (one.speed for one in tn.mean_speeds(by_itself) if one.stable)
    assert tn.rpm(1464.5) != own == pytest.approx(tn.rpm(1464.5), rel=1e-6)
    stated = tn.Driveline(elements, operation=tn.Operation(speed="1464.5 rpm"))
    with pytest.warns(tn.InputRemark, match=r"operation.speed = .*1464.5 rpm.*: agrees .* 1464.500339 rpm, where"):
        assert tn.stability(stated).speed == own
    for near in (tn.rpm(1464.5), own * (1 + 9e-5)):
        with pytest.warns(tn.InputRemark, match="is taken to run there"):
            found = tn.order_response(by_itself, [near])
        assert found.speed.tolist() == [own]
    with pytest.raises(tn.InputError, match="torques do not balance"):
        tn.order_response(by_itself, [own * (1 + 2e-4)])


FACTORED = {
    "fan": tn.Fan(inertia=0.8, rated_power="30 kW", rated_speed="1480 rpm", load_torque=5.0, name="load"),
    "pump": tn.Pump(inertia=0.8, load_torque=90.0, viscous_load=0.2, name="load"),
    "curve": tn.Pump(
        inertia=0.8, curve=[{"speed": w, "torque": t} for w, t in ((0, 10), (100, 60), (160, 150))], name="load"
    ),
    "propeller": tn.Propeller(inertia=0.8, quadratic_load=0.007, damping_factor=2.7, name="load"),
    "power": tn.Generator(inertia=0.8, power="18 kW", name="load"),
    "kloss": tn.Generator(
        inertia=0.8, breakdown_torque=300.0, breakdown_slip=0.15, synchronous_speed="1400 rpm", name="load"
    ),
    "controller": tn.Generator(inertia=0.8, gain=20.0, set_speed="1400 rpm", torque_limit=150.0, name="load"),
}


@pytest.mark.parametrize("name", FACTORED)
def test_a_load_case_multiplies_the_torque_of_a_machine(name: str) -> None:
    """By its factor at every speed, with its slope: the torque, the mean speed and a response of the same line written
    out with a motor against a balance by Brent's method."""
    one, factor, speeds = FACTORED[name], 0.6, np.linspace(20.0, 155.0, 7)
    motor = tn.Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    case = tn.LoadCase(name="less", factors={"load": factor})
    shaft = tn.Shaft(stiffness=2e4, damping=3.0)
    line = tn.Driveline([motor, shaft, one], operation=tn.Operation(load_cases=[case]))
    loaded = line.with_load("less")
    assert tn.loads(tn.dumps(line)) == line and loaded.elements[2].but() == loaded.elements[2]
    np.testing.assert_allclose(loaded.elements[2].load.value(speeds), factor * one.load.value(speeds), rtol=1e-12)
    np.testing.assert_allclose(loaded.elements[2].load.slope(speeds), factor * one.load.slope(speeds), rtol=1e-12)
    best = [found.speed for found in tn.mean_speeds(loaded) if found.stable][-1]

    def left(w: float) -> float:
        return float(factor * one.load.value(w) + motor.load.value(w))

    assert best == pytest.approx(brentq(left, 0.999 * best, 1.001 * best, xtol=1e-12), rel=1e-9)


def test_a_limit_is_judged_under_a_factor() -> None:
    """``assess`` finds the mean torque of the heavier case, in closed form, and its derivative by the rated power."""
    fan = tn.Fan(inertia=3.0, rated_power="30 kW", rated_speed="1480 rpm", name="fan")
    cases = [tn.LoadCase(name="cold air", factors={"fan": 1.25})]
    drive = [tn.ConstantSpeed(), tn.Shaft(stiffness=2e4, damping=3.0, name="shaft"), fan]
    line = tn.Driveline(
        drive, operation=tn.Operation(speed="1480 rpm", load_cases=cases),
        limits=[tn.Limit(of="shaft", max_torque=400.0)],
    )  # fmt: skip
    judged = next(check for check in tn.assess(line).checks if check.name == "max torque of shaft")
    expected = 1.25 * 30e3 / (1480 * np.pi / 30)
    assert judged.load_case == "cold air" and judged.value == pytest.approx(expected, rel=1e-9)
    found = tn.sensitivity(line, parameters=["fan.rated_power"], of=["checks"], checks=["max torque of shaft"])
    one = next(row for row in found.ranked("max torque of shaft") if "rated_power" in row.parameter)
    assert one.derivative == pytest.approx(expected / 30e3, rel=1e-6)


def test_each_load_case_is_judged_where_the_line_then_runs() -> None:
    """A motor without a converter turns faster under less load: the torque there is the motor's, by its formula."""
    motor = tn.Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    fan = tn.Fan(inertia=3.0, rated_power="30 kW", rated_speed="1480 rpm", name="fan")
    line = tn.Driveline(
        [motor, tn.Shaft(stiffness=2e4, damping=3.0, name="shaft"), fan],
        operation=tn.Operation(load_cases=[tn.LoadCase(name="dense", factors={"fan": 1.5})]),
        limits=[tn.Limit(of="shaft", max_torque=400.0)],
    )
    w0 = 1500 * np.pi / 30

    def drives(w: float) -> float:
        s = 1 - w / w0
        return 2 * 500.0 * s * 0.2 / (s**2 + 0.04)

    c = 30e3 / (1480 * np.pi / 30) ** 3
    at = brentq(lambda w: drives(w) - 1.5 * c * w**2, 0.9 * w0, w0, xtol=1e-13)
    check = next(one for one in tn.assess(line).checks if one.name == "max torque of shaft")
    assert check.load_case == "dense" and check.speed == pytest.approx(at, rel=1e-9)
    assert check.value == pytest.approx(drives(at), rel=1e-8)
    stalled = line.but(operation=tn.Operation(load_cases=[tn.LoadCase(name="jam", factors={"fan": 9.0})]))
    assert len(tn.mean_speeds(stalled.with_load("jam"))) == 1  # it creeps, and stays judged there
    assert next(one for one in tn.assess(stalled).checks if one.name == "max torque of shaft").load_case == "jam"


@pytest.mark.parametrize(
    "machine",
    [
        tn.Fan(inertia=3.0, rated_power="30 kW", rated_speed="1480 rpm", name="load"),
        tn.Fan(inertia=3.0, curve=[{"speed": 0, "torque": 10.0}, {"speed": 400.0, "torque": 100.0}], name="load"),
        tn.Generator(inertia=3.0, power="30 kW", name="load"),
        tn.Propeller(inertia=3.0, quadratic_load=0.02, damping_factor=2.9, name="load"),
    ],
    ids=lambda one: one.kind,
)
def test_a_machine_with_the_factor_0_is_its_disk(machine: tn.Fan) -> None:
    """Mean torques and vibration of the line with a disk of its inertia in its place."""

    def line(one: object, cases: list[tn.LoadCase]) -> tn.Driveline:
        engine = tn.Disk(inertia=0.3, drive_share=1, excitation=[{"order": 2, "amplitude": 80.0}])
        shafts = tn.Shaft(stiffness=3e4, damping=4.0), tn.Shaft(stiffness=1e4, damping=2.0)
        elements = [engine, shafts[0], one, shafts[1], tn.Disk(inertia=1.0, load_torque=5.0)]
        return tn.Driveline(elements, operation=tn.Operation(speed=150.0, load_cases=cases))

    idle = tn.order_response(line(machine, [tn.LoadCase(name="idle", factors={"load": 0})]), [150.0], load_case="idle")
    disk = tn.order_response(line(tn.Disk(inertia=3.0, name="load"), []), [150.0])
    np.testing.assert_allclose(idle.mean_torque, disk.mean_torque, atol=1e-10)
    np.testing.assert_allclose(idle.vibratory_torque, disk.vibratory_torque, rtol=1e-12)
