"""Proved twist, rated torque, heat and acceleration against closed forms, and what is stated of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

K, C, J1, J2, AMPLITUDE, SPEEDS = 1e4, 40.0, 0.2, 0.8, 100.0, (60.0, 300.0)
S_T = 1.25


def peaks() -> dict[str, float]:
    """Largest values over the speeds: q̈/(1/J₁ + 1/J₂) + c q̇ + k q = −A J₂/(J₁ + J₂) e^{2iΩt}, J₂ φ̈₂ = ∓T."""
    nu, reduced = 2 * np.linspace(*SPEEDS, 40_001), J1 * J2 / (J1 + J2)
    q = np.abs(AMPLITUDE * J2 / (J1 + J2) / (K + 1j * C * nu - reduced * nu**2))
    torque = np.abs(K + 1j * C * nu) * q
    factor = np.sqrt(np.maximum(nu / (20 * np.pi), 1.0))
    values = {"peak_twist": q, "rated_torque": factor * torque, "heat": C / 2 * (nu * q) ** 2,
              "peak_torque": torque, "acceleration": torque / J2}  # fmt: skip
    return {key: float(value.max()) for key, value in values.items()}


def coupled(share: float, **more: object) -> tn.Driveline:
    """Everything that may be stated of the coupling and the load, ``share`` times the largest value."""
    true = peaks()
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": 2, "amplitude": AMPLITUDE}])
    coupling = tn.Coupling(
        name="coupling", stiffness=K, damping=C, maximum_torque=S_T * share * true["peak_torque"],
        vibratory_torque=S_T * share * true["rated_torque"], heat_rating=S_T * share * true["heat"],
    )  # fmt: skip
    limits = [tn.Limit(of="coupling", max_twist=share * true["peak_twist"], temperature_factor=S_T, **more),
              tn.Limit(of="load", max_acceleration=share * true["acceleration"])]  # fmt: skip
    return tn.Driveline([engine, coupling, tn.Disk(name="load", inertia=J2)], limits=limits)


def test_bounds_in_closed_form() -> None:
    """Every stated limit 5 % above the peak is proved, so each bound lies between both."""
    found = tn.certify_peaks(coupled(1.05), {}, SPEEDS)
    assert found.verdict == "within limits"
    for key, true in peaks().items():
        at = 1 if key == "acceleration" else 0
        bound, computed = getattr(found, f"{key}_bound")[at], getattr(found, key)[at]
        assert computed * (1 - 1e-4) <= true <= bound * (1 + 1e-9) and bound <= 1.05 * true * (1 + 1e-9), key
    assert "heat of coupling: " in str(found) and "rated torque of coupling: " in str(found)


@pytest.mark.parametrize("key", ["rated_torque", "heat", "peak_twist", "acceleration"])
def test_each_is_refuted_alone(key: str) -> None:
    """A limit 1 % below the peak is exceeded by a line of the box."""
    line = coupled(1.5)
    low = 0.99 * peaks()[key]
    if key == "rated_torque":
        line = line.replace("coupling", vibratory_torque=S_T * low)
    elif key == "heat":
        line = line.replace("coupling", heat_rating=S_T * low)
    else:
        of, stated = {"peak_twist": ("coupling", "max_twist"), "acceleration": ("load", "max_acceleration")}[key]
        limits = tuple(tn.Limit(of=one.of, **{stated: low}) if one.of == of else one for one in line.limits)
        line = line.model_copy(update={"limits": limits})
    found = tn.certify_peaks(line, {}, SPEEDS)
    assert found.verdict == "counterexample", str(found)
    assert {"rated_torque": "rated torque", "heat": "heat", "peak_twist": "largest twist"}.get(
        key, key
    ) in found.exceeded


def test_a_margin_must_stay_free() -> None:
    assert tn.certify_peaks(coupled(1.1), {}, SPEEDS).verdict == "within limits"
    assert tn.certify_peaks(coupled(1.1, margin=0.15), {}, SPEEDS).verdict == "counterexample"


def test_assess_proves_ratings_too() -> None:
    judged = tn.assess(coupled(1.5), SPEEDS)
    ratings = [f"{rating} of coupling" for rating in ("maximum torque rating", "rated torque", "heat rating")]
    for name in (*ratings, "max twist of coupling", "max acceleration of load"):
        check = judged.check(name)
        assert check.words == "satisfied, proved", (name, check.because)
        assert check.value * (1 - 1e-9) <= check.bound <= check.limit


def test_limits_exceeded_are_named_in_words() -> None:
    """The angle in degrees, as a user reads it."""
    line = coupled(1.5)
    limits = (tn.Limit(of="coupling", max_twist=0.9 * peaks()["peak_twist"]),)
    found = tn.certify_peaks(line.model_copy(update={"limits": limits}), {}, SPEEDS)
    assert " deg in coupling" in found.exceeded


def driven(law: dict[str, object], **load: float) -> tn.Driveline:
    drives = {"drive_share": 1.0} if load else {}
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": 2, **law}], **drives)
    return tn.Driveline([engine, tn.Shaft(name="shaft", stiffness=K, damping=C), tn.Disk(inertia=J2, **load)])


SPEEDS_AT = {"speeds": [5.0, 100.0, 150.0, 500.0], "amplitudes": [10.0, 90.0, 40.0, 120.0], "phases": [0, 1, 0.5, 0]}
TORQUES_AT = {"torques": [0.0, 20.0, 60.0, 200.0], "amplitudes": [5.0, 60.0, 30.0, 100.0]}


def by_speed(speed: np.ndarray) -> np.ndarray:
    complex_ones = np.array(SPEEDS_AT["amplitudes"]) * np.exp(1j * np.array(SPEEDS_AT["phases"]))
    points = SPEEDS_AT["speeds"]
    return np.abs(np.interp(speed, points, complex_ones.real) + 1j * np.interp(speed, points, complex_ones.imag))


@pytest.mark.parametrize(
    ("law", "load", "amplitude"),
    [
        (SPEEDS_AT, {}, by_speed),
        ({"share": 0.5}, {"quadratic_load": 1e-3, "viscous_load": 0.1}, lambda w: 0.5 * (1e-3 * w**2 + 0.1 * w)),
        (TORQUES_AT, {"quadratic_load": 1e-3},
         lambda w: np.interp(1e-3 * w**2, TORQUES_AT["torques"], TORQUES_AT["amplitudes"])),
    ],
)  # fmt: skip
def test_amplitudes_that_follow_speed_or_torque(law: dict[str, object], load: dict[str, float], amplitude) -> None:  # type: ignore[no-untyped-def]
    """Piecewise in the speed, against the closed form; the load damps what it goes with."""
    found = tn.certify_peaks(driven(law, **load), {}, SPEEDS, gap=0.05)
    speed = np.linspace(*SPEEDS, 20_001)
    s, own = 2j * speed, load.get("viscous_load", 0.0) + 2 * load.get("quadratic_load", 0.0) * speed
    # J₁ s² φ₁ = A + T, (J₂ s² + d s) φ₂ = −T, T = (k + c s)(φ₂ − φ₁), seen from the shaft
    compliance = 1 / (K + C * s) + 1 / (J1 * s**2) + 1 / (J2 * s**2 + own * s)
    true = float(np.abs(amplitude(speed) / (J1 * s**2) / compliance).max())
    assert found.verdict == "proved"
    assert found.vibratory_torque[0] * (1 - 1e-4) <= true <= found.vibratory_torque_bound[0] <= 1.06 * true


def test_what_a_torque_that_scatters_makes_is_refused() -> None:
    line = driven({"share": 0.5}, quadratic_load=1e-3)
    with pytest.raises(
        tn.InputError, match=r"engine\.excitation 1 = 'Disk 2\.quadratic_load': goes with the mean torque"
    ):
        tn.certify_peaks(line, {"Disk 2.quadratic_load": 0.05}, SPEEDS)
    with pytest.raises(tn.InputError, match="does not cover"):
        tn.certify_peaks(driven(SPEEDS_AT), {}, (60.0, 600.0))


def test_bounds_above_the_motion_in_time() -> None:
    """A disk behind a shaft that a joint drives: J φ̈ = −T, T = k(φ − θ) + c(φ̇ − θ̇), tan θ = tan Ωt/cos β, integrated
    until it repeats. Nothing of it is small: joint and shaft are exact. At the top of the resonance the bounds of
    what swings are near."""
    beta, inertia, speeds = 0.5, 0.5, (55.0, 85.0)
    line = tn.Driveline([
        tn.ConstantSpeed(), tn.HookeJoint(angle=beta), tn.Shaft(name="shaft", stiffness=K, damping=C),
        tn.Disk(name="disk", inertia=inertia),
    ])  # fmt: skip
    found = tn.certify_peaks(line, {}, speeds, gap=0.02)
    for speed in (speeds[0], float(found.peak_speed[0]), 77.3):
        seen = moved(beta, inertia, speed)
        for key, value in seen.items():
            bound = getattr(found, f"{key}_bound")
            bound = bound[found.inertias.index("disk")] if key in ("speed_fluctuation", "acceleration") else bound[0]
            near = 0.95 if speed == found.peak_speed[0] and "vibratory" in key else 0.0
            assert near * bound <= value <= bound * (1 + 1e-6), (speed, key)


def moved(beta: float, inertia: float, speed: float) -> dict[str, float]:
    """Over the last turn of many, by Runge and Kutta's rule of fourth order."""
    steps, turns = 1500, 14
    h = 2 * np.pi / speed / steps
    t = 0.5 * h * np.arange(2 * steps * turns + 3)
    angle, cosine = speed * t, np.cos(beta)
    theta = np.arctan2(np.sin(angle), cosine * np.cos(angle))
    theta = angle + (theta - angle + np.pi) % (2 * np.pi) - np.pi
    rate = speed * cosine / (cosine**2 * np.cos(angle) ** 2 + np.sin(angle) ** 2)
    x, v, kept = 0.0, speed, []

    def pull(at: int, x: float, v: float) -> float:
        return -(K * (x - theta[at]) + C * (v - rate[at])) / inertia

    for k in range(steps * turns):
        at = 2 * k
        a1 = pull(at, x, v)
        a2 = pull(at + 1, x + h / 2 * v, v + h / 2 * a1)
        a3 = pull(at + 1, x + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
        a4 = pull(at + 2, x + h * (v + h / 2 * a2), v + h * a3)
        if k >= steps * (turns - 1):
            kept.append((-inertia * a1, x - theta[at], v - rate[at], v, a1))
        x += h * v + h * h / 6 * (a1 + a2 + a3)
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    torque, twist, slip, turning, pulled = np.array(kept).T
    return {
        "vibratory_torque": np.ptp(torque) / 2, "peak_torque": np.abs(torque).max(),
        "vibratory_twist": np.ptp(twist) / 2, "peak_twist": np.abs(twist).max(), "heat": C * np.mean(slip**2),
        "speed_fluctuation": np.ptp(turning) / 2, "acceleration": np.ptp(pulled) / 2,
    }  # fmt: skip


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("share", [0.0, 0.05])
def test_a_drive_behind_its_loads_carries_what_they_take_at_every_speed(turned: bool, share: float) -> None:
    """Springs with the drive behind them carry as much as those with it in front, to the end of the range; by hand."""
    parts = [
        tn.Disk(inertia=1.0, viscous_load=2.0, name="load", excitation=[{"order": 2, "amplitude": 1.0}]),
        tn.Shaft(stiffness=1e4, damping=20.0, name="near"),
        tn.Disk(inertia=1.0, viscous_load=1.0, name="middle"),
        tn.Shaft(stiffness=1e4, damping=20.0, name="far"),
        tn.Disk(inertia=2.0, drive_share=1.0, name="motor"),
    ]
    line = tn.Driveline(parts[::-1] if turned else parts)
    found = tn.certify_peaks(line, {"load.viscous_load": share} if share else {}, (40.0, 80.0), most_boxes=60)
    nu, twist = 160.0, np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    resists = np.diag([2.0 * (1 + share), 1.0, 0.0])
    stiff = (1e4 + 20j * nu) * (twist.T @ twist) + 1j * nu * resists - nu**2 * np.diag([1.0, 1.0, 2.0])
    swing = np.abs((1e4 + 20j * nu) * (twist @ np.linalg.solve(stiff, [1.0, 0.0, 0.0])))
    mean = {"near": 160.0 * (1 + share), "far": 160.0 * (1 + share) + 80.0}
    for k, (name, own) in enumerate(mean.items()):
        bound = float(found.peak_torque_bound[found.springs.index(name)])
        assert own + swing[k] <= bound < 1.03 * own, (name, bound)


def plate(angle: float) -> tn.Driveline:
    """Stiffer from 0.065 rad and 130 N m on, where its load of 150 N m and more holds it."""
    spring = tn.PiecewiseShaft.symmetric([(2e3, 0.065), (9e3, None)], damping=40.0, name="plate")
    load = tn.Disk(inertia=0.8, load_torque=150.0, viscous_load=0.2, name="load")
    limits = [tn.Limit(of="plate", max_torque=2000.0)]
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.HookeJoint(angle=angle), spring, load],
        limits=limits, operation=tn.Operation(speed=60.0, speed_range=(20.0, 160.0)),
    )  # fmt: skip


@pytest.mark.parametrize(("angle", "leaves"), [(0.17, True), (0.02, False)])
def test_bounds_say_where_a_swing_may_leave_the_stage(angle: float, leaves: bool) -> None:
    """By an integration of the line's own at 57 rad/s, and the bounds; ``assess`` proves nothing of such a line."""
    speed, c, s = 57.0, np.cos(angle), np.sin(angle)

    def torque(phi: float, x: np.ndarray) -> tuple[float, float]:
        """Of the spring, and how fast its far end turns beyond its near one; x: turned beyond that, speed."""
        relative = x[1] - speed * c / (1 - (s * np.cos(phi)) ** 2)
        inside = 2e3 * x[0] if abs(x[0]) < 0.065 else np.sign(x[0]) * 130.0 + 9e3 * (x[0] - np.sign(x[0]) * 0.065)
        return inside, relative

    def rates(phi: float, x: np.ndarray) -> list[float]:
        elastic, relative = torque(phi, x)
        return [relative / speed, (-elastic - 40.0 * relative - 150.0 - 0.2 * x[1]) / 0.8 / speed]

    run = solve_ivp(rates, (0, 40 * np.pi), [-0.07, speed], rtol=1e-8, atol=1e-10, dense_output=True)
    elastic = [torque(phi, run.sol(phi))[0] for phi in np.linspace(36 * np.pi, 40 * np.pi, 400)]
    assert (max(elastic) > -130.0) == leaves
    found = tn.certify_peaks(plate(angle), {}, (20.0, 160.0), most_boxes=40)
    assert ("plate works in its stage 1 of 3, up to -130 N m, and may swing beyond it" in str(found)) == leaves
    check = next(one for one in tn.assess(plate(angle)).checks if "plate" in one.name)
    assert check.proof == "searched, not proved" or not leaves


@pytest.mark.parametrize(("stiffness", "leaves"), [(None, False), (0.2, True)])
def test_stages_of_teeth_end_at_other_torques_where_their_stiffness_scatters(stiffness, leaves: bool) -> None:
    """The play ends at 50 N m, and at 40 with a fifth less stiffness; the swing of 22 N m lies between their halves."""
    teeth = tn.GearPair(
        base_radius_in=0.05, base_radius_out=0.1, mesh_stiffness=1e7, mesh_damping=100.0, backlash=2e-4,
        stiffness_ratio=0.5,
    )  # fmt: skip
    shaken = tn.Disk(inertia=1.0, excitation=[{"order": 1, "amplitude": 21.0}])
    shaft = tn.Shaft(stiffness=2e4, damping=2.0)
    line = tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.5), teeth, shaken])
    tolerances = {} if stiffness is None else {"GearPair 1.mesh_stiffness": stiffness}
    found = tn.certify_peaks(line, tolerances, speeds=(90.0, 91.0), gap=0.1)
    assert any("may swing beyond it" in one.sentence for one in found.findings) == leaves
