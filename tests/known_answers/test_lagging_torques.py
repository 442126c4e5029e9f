"""Torques that lag behind the speed, in modes and stability, against equations of motion with a state more for each.

A motor on a speed controller drives a generator at constant power through gears. Its torque T follows Ṫ = ν_c (T₀ − T);
matrices are differences of these equations, growth is measured on their integral, ends of unstable ranges are bisected
on their eigenvalues.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import trunnion as tn
from trunnion.results.verdict import Verdict

NEAR, FAR, PINION, WHEEL = 0.5, 2.4, 0.05, 0.1
STIFF, SOFT, DAMPING = 9e4, 6e4, 0.04
GAIN, CORNER, RATIO = 20.0, 60.0, -1.5
N = 1 / abs(RATIO)
State = np.ndarray


def line(power: float, corner: float | None = CORNER, damping: float = DAMPING, limits=()) -> tn.Driveline:
    motor = tn.Motor(
        name="motor", inertia=NEAR, gain=GAIN, drive_share=1, corner_frequency=corner,
        excitation=[{"order": 2, "amplitude": 5.0}],
    )  # fmt: skip
    return tn.Driveline(
        [
            motor,
            tn.Shaft(name="input shaft", stiffness=STIFF, damping=damping),
            tn.Disk(name="pinion", inertia=PINION),
            tn.Ratio(ratio=RATIO),
            tn.Disk(name="wheel", inertia=WHEEL),
            tn.Shaft(name="output shaft", stiffness=SOFT, damping=damping),
            tn.Generator(name="generator", inertia=FAR, power=power),
        ],
        limits=limits,
    )


def motion(power: float, mean: float, corner: float = CORNER, damping: float = DAMPING) -> Callable[[State], State]:
    """Rates of (three rotations about the mean, three speeds, torque of the motor); both shafts in their own sense."""
    carried = power / mean

    def rate(x: State) -> State:
        angle, speed, torque = x[:3], x[3:6], x[6]
        front = STIFF * (angle[0] - angle[1]) + damping * (speed[0] - speed[1])
        rear = SOFT * (N * angle[1] - angle[2]) + damping * (N * speed[1] - speed[2])
        turned = (torque - front, front - N * rear, rear - power / speed[2])
        inertias = (NEAR, PINION + N**2 * WHEEL, FAR)
        wanted = carried + GAIN * (mean - speed[0])
        rates = [push / inertia for push, inertia in zip(turned, inertias, strict=True)]
        turning = speed - mean * np.array([1.0, 1.0, N])
        return np.array([*turning, *rates, corner * (wanted - torque)])

    return rate


def balance(power: float, mean: float) -> State:
    """The steady state: twists under the mean torque, speeds, torque."""
    carried = power / mean
    first = -carried / STIFF
    return np.array([0.0, first, N * first - carried / N / SOFT, mean, mean, N * mean, carried])


def differences(power: float, mean: float, **more: float) -> np.ndarray:
    rate, at = motion(power, mean, **more), balance(power, mean)
    assert np.abs(rate(at)).max() < 1e-6
    steps = np.diag([1e-5] * 3 + [1e-3] * 3 + [1e-3])
    return np.stack([(rate(at + step) - rate(at - step)) / (2 * step.sum()) for step in steps], axis=1)


@pytest.mark.parametrize(("power", "mean"), [(20e3, 150.0), (150e3, 120.0), (300e3, 110.0)])
def test_multipliers_have_the_lag(power: float, mean: float) -> None:
    """All seven, among them that of the torque; the turn of the whole line is set aside."""
    found = tn.stability(line(power), mean)
    values = np.linalg.eigvals(differences(power, mean))
    wanted = np.exp(values * found.period / mean)
    assert len(found.multipliers) == 7
    for one in wanted:
        assert np.abs(found.multipliers - one).min() < 1e-6
    growth = np.sort(values.real[np.argsort(np.abs(values))[1:]])[-1]
    assert found.growth_rate == pytest.approx(growth, abs=2e-4)
    assert found.verdict.name == ("UNSTABLE" if growth > 0 else "STABLE")
    at_once = tn.stability(line(power, corner=None), mean)
    assert len(at_once.multipliers) == 6


def test_a_disturbance_grows_as_said_in_time() -> None:
    """Measured on the nonlinear equations between two times, by the energy of the difference."""
    power, mean = 150e3, 110.0
    found = tn.stability(line(power), mean)
    assert found.verdict.name == "UNSTABLE" and tn.stability(line(power, corner=None), mean).verdict.name == "STABLE"
    rate, at = motion(power, mean), balance(power, mean)
    pushed = at + 1e-7 * np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    run = solve_ivp(
        lambda t, x: rate(x), (0.0, 3.0), pushed, rtol=1e-11, atol=1e-13, t_eval=np.linspace(1.0, 3.0, 20001)
    )
    swing = run.y[2] - run.y[1] * N
    swing -= swing.mean()
    tops = [np.abs(part).max() for part in np.array_split(swing, 20)]
    slope = np.polyfit(np.linspace(1.05, 2.95, 20), np.log(tops), 1)[0]
    assert found.growth_rate == pytest.approx(slope, rel=2e-2)


def test_the_unstable_range_is_that_of_the_lag() -> None:
    """Its upper end by bisection on the eigenvalues; a torque that follows at once is stable all over the range."""
    power = 150e3

    def growth(mean: float) -> float:
        values = np.linalg.eigvals(differences(power, mean))
        return float(values.real[np.abs(values.imag) > 50].max())

    end = brentq(growth, 105.0, 250.0, xtol=1e-9)
    limits = [tn.Limit(of="output shaft", max_torque=1e6)]
    judged = tn.assess(line(power, limits=limits), (105.0, 250.0))
    check = judged.check("parametric stability")
    assert check.status.name == "EXCEEDED" and "the torque of motor lags" in check.because
    doubling = float(check.because.split("doubles every ")[1].split(" s")[0])
    assert doubling == pytest.approx(np.log(2) / growth(105.0), rel=2e-2)
    ((low, high),) = check.barred
    assert high == pytest.approx(end, rel=1e-6) and low == 105.0
    at_once = tn.assess(line(power, corner=None, limits=limits), (105.0, 250.0))
    assert at_once.check("parametric stability").status.name == "NOT_APPLICABLE"
    found = tn.order_response(line(power), [0.99 * end, 1.01 * end])
    assert found.unstable.tolist() == [True, False]


def test_modes_of_the_loaded_line_have_the_lag() -> None:
    """Frequency and damping over speed, and critical speeds, where a slope taken as quasi-static is far off."""
    power, speeds = 20e3, np.linspace(100.0, 200.0, 5)
    found = tn.campbell_diagram(line(power, damping=0.5), speeds)
    for i, mean in enumerate(speeds):
        values = np.linalg.eigvals(differences(power, mean, damping=0.5))
        values = values[values.imag > 50]
        values = values[np.argsort(values.imag)]
        np.testing.assert_allclose(found.frequency[i], values.imag, rtol=1e-7)
        np.testing.assert_allclose(found.damping_ratio[i], -values.real / np.abs(values), rtol=2e-5)
    quasi = tn.campbell_diagram(line(power, corner=None, damping=0.5), speeds)
    assert quasi.damping_ratio[0, 0] > 5 * found.damping_ratio[0, 0]
    assert np.abs(quasi.frequency[0] / found.frequency[0] - 1).max() > 5e-3


def test_a_transient_of_the_lag_agrees() -> None:
    """The matrix exponential of the differences carries a small disturbance as the package's modes say."""
    power, mean = 150e3, 120.0
    found = tn.stability(line(power), mean)
    carried = expm(differences(power, mean) * found.period / mean)
    wanted = np.sort(np.abs(np.linalg.eigvals(carried)))
    np.testing.assert_allclose(np.sort(np.abs(found.multipliers)), wanted, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize(
    "question", [tn.tongues, lambda line, x, y: tn.stability_chart(line, (*x, 8), (*y, 8))], ids=["tongues", "chart"]
)
def test_charts_refuse_what_only_a_lagging_torque_decides(question: Callable[..., object]) -> None:
    axes = ("speed", 60.0, 90.0), ("input shaft.stiffness", 0.9 * STIFF, 1.1 * STIFF)
    # At constant power the generator drives; the motor makes up for it at once, but not with its lag.
    at_once, lags = line(40e3, None), line(40e3)
    assert (
        tn.stability(at_once, 75.0).verdict is Verdict.STABLE and tn.stability(lags, 75.0).verdict is Verdict.UNSTABLE
    )
    question(at_once, *axes)
    with pytest.raises(tn.InputError, match="motor.corner_frequency: has a torque that lags") as refused:
        question(lags, *axes)
    assert "ask stability() at single speeds" in str(refused.value)


def test_a_chart_shows_no_decay_that_a_lagging_torque_does_not_have() -> None:
    """Of a line that nothing feeds: stable with the lag or without, but not by as much; regions there are none."""
    parts = [
        tn.Motor(name="motor", inertia=NEAR, gain=GAIN, drive_share=1, corner_frequency=CORNER),
        tn.Shaft(name="shaft", stiffness=STIFF, damping=DAMPING),
        tn.Fan(name="fan", inertia=FAR, quadratic_load=0.01),
    ]
    own, axes = tn.Driveline(parts), (("speed", 60.0, 90.0), ("shaft.stiffness", 0.9 * STIFF, 1.1 * STIFF))
    with pytest.raises(tn.InputError, match="motor.corner_frequency: has a torque that lags behind the speed: charts"):
        tn.stability_chart(own, *((*axis, 8) for axis in axes))
    assert len(tn.tongues(own, *axes).tongues) == 0
    assert tn.stability(own, 75.0).verdict is Verdict.STABLE
    tn.stability_chart(own.replace("motor", corner_frequency=None), *((*axis, 8) for axis in axes))


NUMBERS = [
    *(("motor", key) for key in ("inertia", "gain", "corner_frequency")), ("input shaft", "stiffness"),
    ("input shaft", "damping"), ("output shaft", "stiffness"), ("pinion", "inertia"), ("generator", "inertia"),
    ("generator", "power"),
]  # fmt: skip


def test_sensitivities_of_growth_have_the_lag() -> None:
    own, speed = line(40e3), 75.0
    found = tn.sensitivity(own, speed)
    k = next(k for k, one in enumerate(found.quantities) if one.name.startswith("growth rate"))

    def grows(changed: tn.Driveline) -> float:
        """Its growth is checked against the integral above."""
        return float(tn.stability(changed, speed).growth_rate)

    for name, key in NUMBERS:
        value = getattr(dict(own.parts)[name], key)
        h = 1e-4
        sides = [grows(own.replace(name, **{key: value * (1 + sign * h)})) for sign in (-1, 1)]
        true = (sides[1] - sides[0]) / (2 * h * value)
        d = found.parameters.index(f"{name}.{key}")
        assert found.derivative[k, d] == pytest.approx(true, rel=2e-5, abs=1e-9 / value)


@pytest.mark.parametrize("power", [2e3, 12e3, 40e3])
def test_studies_of_many_lines_have_the_lag(power: float) -> None:
    """Growth of the worst line and the share of stable ones, against the stability of single lines; about what damps
    just enough both sides occur."""
    own, speed, width = line(power), 75.0, 0.4
    study = tn.tolerance_study(own, {"motor.gain": width, "output shaft.damping": width}, speed, samples=256)
    rng = np.random.default_rng(5)
    shares = 1 + width * rng.uniform(-1, 1, (60, 2))
    stable = 0
    for gain, damping in shares.tolist():
        changed = own.replace("motor", gain=GAIN * gain).replace("output shaft", damping=DAMPING * damping)
        stable += tn.stability(changed, speed).verdict is Verdict.STABLE
    assert abs(stable / len(shares) - study.probability) < 0.2
    worst = own
    for path, value in study.worst.values.items():
        name, _, key = path.rpartition(".")
        worst = worst.replace(name, **{key: value})
    found = tn.stability(worst, speed)
    assert found.growth_rate == pytest.approx(study.worst.growth_rate, rel=1e-6, abs=1e-9)


def growth_of(power: float, mean: float, **more: float) -> float:
    """Of the fastest disturbance [1/s], the turn of the whole line set aside."""
    values = np.linalg.eigvals(differences(power, mean, **more))
    return float(np.sort(values.real[np.argsort(np.abs(values))[1:]])[-1])


def test_a_tolerance_study_counts_lines_as_stability_judges_them() -> None:
    """The share of powers below that at which the equations begin to grow; slopes that follow at once leave all
    stable."""
    low, high, mean = 20e3, 60e3, 90.0
    begins = brentq(lambda power: growth_of(power, mean), low, high, xtol=1.0)
    share = (begins - low) / (high - low)
    found = tn.tolerance_study(line(40e3), {"generator.power": ("range", low, high)}, mean, samples=1 << 12)
    assert 0.1 < share < 0.9 and found.probability == pytest.approx(share, abs=1e-3)
    assert found.worst.growth_rate == pytest.approx(growth_of(high, mean), rel=1e-3)
    at_once = tn.tolerance_study(line(40e3, None), {"generator.power": ("range", low, high)}, mean, samples=1 << 8)
    assert at_once.probability == 1.0


def test_the_slope_of_growth_has_the_lag() -> None:
    """By the power, the corner frequency and a damping, against differences of the eigenvalues of the equations."""
    power, mean = 40e3, 75.0
    found = tn.sensitivity(line(power), mean, of=["growth", "checks"])
    (one,) = [i for i, each in enumerate(found.quantities) if each.name.startswith("growth rate")]
    assert found.quantities[one].value == pytest.approx(growth_of(power, mean), abs=2e-4)
    (check,) = [i for i, each in enumerate(found.quantities) if each.name == "parametric stability"]

    def by(name: str, size: float) -> float:
        def shifted(share: float) -> float:
            put = {"power": power, "corner": CORNER, "damping": DAMPING}
            put[name] += share * size
            return growth_of(put.pop("power"), mean, **put)

        return (shifted(1e-2) - shifted(-1e-2)) / (2e-2 * size)

    for path, name, size in (("generator.power", "power", power), ("motor.corner_frequency", "corner", CORNER)):
        column = found.parameters.index(path)
        wanted = by(name, size)
        assert found.derivative[one, column] == pytest.approx(wanted, rel=5e-3)
        assert found.derivative[check, column] == pytest.approx(wanted, rel=5e-3)
    both = [found.derivative[one, found.parameters.index(f"{side} shaft.damping")] for side in ("input", "output")]
    assert sum(both) == pytest.approx(by("damping", 1.0), rel=5e-3)


def test_a_remedy_makes_a_straight_line_grow_no_more() -> None:
    """By more inertia of the generator: at what is offered the equations grow nowhere in the range, a little less they
    do."""
    power, span = 40e3, (75.0, 90.0)
    limits = [tn.Limit(of="* shaft", max_torque=1e6)]
    found = tn.remedies(line(power, limits=limits), span)
    (one,) = [each for each in found.of("parametric stability") if each.variable == "generator.inertia"]
    assert "lets nothing grow" in one.sentence

    def most(inertia: float) -> float:
        line_of = line(power).replace_all({"generator": {"inertia": inertia}})
        return max(tn.stability(line_of, speed).growth_rate for speed in np.linspace(*span, 7))

    assert most(one.after) < 0 < most(0.97 * one.after)
