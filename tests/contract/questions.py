"""What every analysis is asked by the tests that hold for all of them: one entry an analysis.

An analysis of ``trunnion.features`` without an entry here fails by name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import feature_lines
import numpy as np

import trunnion as tn


@dataclass(frozen=True)
class Question:
    """What one analysis is asked.

    ask : of a line that has a feature or has not. in_rpm : of a line that states its speeds in rpm. quick : features
    seen in the quick run, where the analysis takes long; all by default. line : what the features are put into.
    """

    ask: Callable[[tn.Driveline], Any]
    in_rpm: Callable[[], Any]
    quick: tuple[str, ...] | None = None
    line: Callable[[], tn.Driveline] = feature_lines.bent


SPEED = 100.0
RANGE = (100.0, 101.0)
LOW, MIDDLE, HIGH = tn.rpm(1400), tn.rpm(1500), tn.rpm(1600)
GRID = np.linspace(LOW, HIGH, 5)
ANGLE = "joint.angle"


def least_damping(line: tn.Driveline, speeds: tuple[float, float], angle: float = 1.3, **more: float) -> object:
    """At an angle that asks for some damping."""
    return tn.minimum_damping(line.replace("joint 2", angle=angle), speeds, **{"maximum": 8.0, "rows": 4} | more)


def limited(line: tn.Driveline) -> tn.Driveline:
    """With a limit of torque for every spring that all lines have."""
    limits = tuple(tn.Limit(of=name, max_torque=500.0) for name in ("front", "rear"))
    return line.model_copy(update={"limits": limits})


def heated(line: tn.Driveline) -> tn.Driveline:
    """With a coupling and a disk at the far end, which vibrate and warm it."""
    rubber = tn.Coupling(
        stiffness=9e3, relative_damping=0.5, loss_factor_frequency=200.0, temperature=310.0,
        temperatures=[300.0, 400.0], stiffness_factors=[1.0, 0.7], thermal_resistance=0.5, ambient_temperature=305.0,
        name="rubber",
    )  # fmt: skip
    if line.damping_ratio is not None:
        rubber = rubber.but(relative_damping=None, loss_factor_frequency=None)
    shaken = tn.Disk(inertia=0.15, excitation=[{"order": 2, "amplitude": 4.0}], name="shaken")
    return line.but(elements=[*line.elements, rubber.but(after="load"), shaken])


def shaken(line: tn.Driveline) -> tn.Driveline:
    """With a disk beside the hub that is shaken twice a turn, so that straight lines show orders too."""
    end = tn.Disk(inertia=0.05, excitation=[{"order": 2, "amplitude": 4.0}], name="shaken")
    return line.but(elements=[*line.elements, tn.Shaft(stiffness=2e4, after="hub", name="to the end"), end])


def with_duty(line: tn.Driveline) -> tn.Driveline:
    """With an S–N curve of all shafts, which counts means, and a duty."""
    curve = tn.SNCurve(of="Shaft *", torque_amplitude=50.0, cycles=1e6, slope=5, ultimate_torque=1e4)
    return line.but(sn_curves=[curve], operation=tn.Operation(duty=[tn.Duty(share=1.0, speed=SPEED)]))


def scheduled(line: tn.Driveline) -> tn.Driveline:
    """With a schedule of the angle of a joint that all lines have."""
    schedule = tn.Schedule(name="travel", travel=[0.0, 0.1], angles={"joint 2": [0.1, 0.4]})
    return line.model_copy(update={"operation": tn.Operation(schedules=[schedule])})


@cache
def in_rpm(end: bool = False) -> tn.Driveline:
    last = [tn.HookeJoint(name="second", angle=0.15), tn.Shaft(name="third", stiffness=1e4, damping=5)] if end else []
    elements = [
        tn.ConstantSpeed(),
        tn.Shaft(name="first", stiffness=1e4, damping=5),
        tn.Disk(name="flange", inertia=0.1, excitation=[{"order": 1, "amplitude": 5.0}], firing_angles=[0.0, np.pi]),
        tn.HookeJoint(name="joint", angle=0.2),
        tn.Shaft(name="tube", stiffness=1e4, damping=5),
        *([tn.Disk(name="fork", inertia=0.05)] if end else []),
        *last,
        tn.Disk(name="load", inertia=0.2),
    ]
    operation = tn.Operation(
        speed="1500 rpm", speed_range=["1400 rpm", "1600 rpm"],
        load_cases=[tn.LoadCase(name="pull", loads={"load": 20.0})],
    )  # fmt: skip
    return tn.Driveline(elements, operation=operation)


def in_rpm_for_life() -> tn.Driveline:
    """With an S–N curve, two speeds and a start."""
    stated = in_rpm()
    assert stated.operation is not None
    operation = stated.operation.but(
        duty=[tn.Duty(share=0.5, speed="1500 rpm"), tn.Duty(share=0.5, speed="1600 rpm", load_case="pull")],
        passages=[tn.SpeedPassage(name="start", first=LOW, last=HIGH, acceleration=200.0, per_hour=2)],
        life="10000 h",
    )
    curve = tn.SNCurve(of="tube", torque_amplitude=50.0, cycles=1e6, slope=5, ultimate_torque=1e3)
    return stated.but(sn_curves=[curve], operation=operation)


@cache
def measured_orders(of_line_in_rpm: bool) -> tn.MeasuredOrders:
    """Of a bench with a line that has no feature."""
    line, gauge = (in_rpm(), "tube") if of_line_in_rpm else (shaken(feature_lines.bent()), "rear")
    run = tn.measure(line, (LOW, HIGH) if of_line_in_rpm else (80.0, 110.0), 3.0, {"load": 30}, gauges=[gauge])
    return tn.track_orders(run, [1, 2], line=line)


@cache
def measured_mesh_order() -> tn.MeasuredOrders:
    """Order 25 of a bench with gears whose transmission error excites it."""
    line = feature_lines.unbent(feature_lines.CHANGES["transmission error"][1](feature_lines.bent()))
    run = tn.measure(line, (80.0, 110.0), 3.0, {"hub": 60}, gauges=["rear"], jitter=1e-8, pitch_error=0.0)
    return tn.track_orders(run, [25], line=line)


@cache
def geared_in_rpm() -> tn.Driveline:
    elements = [
        tn.ConstantSpeed(),
        tn.Shaft(name="first", stiffness=1e4, damping=5),
        tn.Disk(name="pinion", inertia=0.1, excitation=[{"order": 1, "amplitude": 5.0}]),
        tn.GearPair(
            name="mesh", teeth_in=20, teeth_out=31, module=0.003, mesh_stiffness=1e7, mesh_damping=500.0, backlash=1e-4
        ),
        tn.Disk(name="load", inertia=0.2, load_torque=20),
    ]
    return tn.Driveline(elements, operation=tn.Operation(speed="1500 rpm", speed_range=["1400 rpm", "1600 rpm"]))


QUESTIONS = {
    "assess": Question(
        lambda line: tn.assess(limited(line), (SPEED, SPEED)),
        lambda: tn.assess(in_rpm()),
        quick=tuple(key for key in feature_lines.CHANGES if key != "mesh-stiffness variation"),
    ),
    "campbell_diagram": Question(
        lambda line: tn.campbell_diagram(line, [20.0, 100.0, 180.0]),
        lambda: tn.campbell_diagram(in_rpm(), GRID),
    ),
    "envelope": Question(
        lambda line: tn.envelope(scheduled(limited(line)), (SPEED, SPEED), points=2),
        lambda: tn.envelope(in_rpm()),
        quick=("load torque", "Hooke's joint", "prescribed far end", "dry friction"),
    ),
    "stability": Question(
        lambda line: tn.stability(line, SPEED),
        lambda: tn.stability(in_rpm()),
    ),
    "stability_chart": Question(
        lambda line: tn.stability_chart(line, ("speed", 300, 330, 3), ("load.inertia", 0.15, 0.25, 3)),
        lambda: tn.stability_chart(in_rpm(), ("speed", LOW, HIGH, 8), (ANGLE, 0.0, 0.3, 6)),
        quick=("damping", "load torque", "excitation by order", "viscous load"),
    ),
    "natural_frequencies": Question(
        tn.natural_frequencies,
        lambda: tn.natural_frequencies(in_rpm()),
    ),
    "resonance_speeds": Question(
        tn.resonance_speeds,
        lambda: tn.resonance_speeds(in_rpm(), 1),
    ),
    "kinetostatics": Question(
        lambda line: tn.kinetostatics(line, SPEED, rigid=False, inertia=True, points=16),
        lambda: tn.kinetostatics(in_rpm(), tn.rpm(20000)),
    ),
    "phase_forks": Question(
        tn.phase_forks,
        lambda: tn.phase_forks(in_rpm(True)),
        quick=("Hooke's joint", "fork offset", "load torque", "branch"),
    ),
    "assembly_sensitivity": Question(
        tn.assembly_sensitivity,
        lambda: tn.assembly_sensitivity(in_rpm()),
    ),
    "bending_speeds": Question(
        tn.bending_speeds,
        lambda: tn.bending_speeds(in_rpm()),
        line=feature_lines.with_tube,
    ),
    "order_response": Question(
        lambda line: tn.order_response(line, [90.0, 100.0]),
        lambda: tn.order_response(in_rpm(), GRID),
    ),
    "measure": Question(
        lambda line: tn.measure(shaken(line), 95.0, 0.5, {"load": 30}, gauges=["rear"], accelerometers=["load"]),
        lambda: tn.measure(in_rpm(), MIDDLE, 0.5, {"load": 30}, gauges=["tube"]),
        quick=("load torque", "excitation by order", "dry friction", "backlash"),
    ),
    "compare_measured": Question(
        lambda line: tn.compare_measured(shaken(line), measured_orders(False)),
        lambda: tn.compare_measured(in_rpm(), measured_orders(True)),
        quick=("load torque", "excitation by order", "dry friction", "backlash"),
    ),
    "identify": Question(
        lambda line: tn.identify(shaken(line), measured_orders(False), {"joint 2.angle": (0.1, 0.2)}),
        lambda: tn.identify(in_rpm(), measured_orders(True), {"tube.stiffness": (5e3, 2e4)}),
        quick=("load torque", "dry friction", "transmission error", "torque converter"),
    ),
    "coupling_temperatures": Question(
        lambda line: tn.coupling_temperatures(heated(line), [90.0, 100.0]),
        lambda: tn.coupling_temperatures(heated(in_rpm()), GRID),
        quick=("load torque", "excitation by order", "stiffness over mean torque", "dry friction"),
    ),
    "speed_sweep": Question(
        lambda line: tn.speed_sweep(line, [90.0, 100.0]),
        lambda: tn.speed_sweep(in_rpm(), GRID),
    ),
    "stable_limit": Question(
        lambda line: tn.stable_limit(
            line, "joint 2.angle", [145.0, 150.0, 460.0, 627.0], scan=20, high=1.4, between=False
        ),
        lambda: tn.stable_limit(in_rpm(), ANGLE, [LOW, HIGH], scan=6, high=0.5),
        quick=("load torque", "tripod joint"),
    ),
    "tongues": Question(
        lambda line: tn.tongues(line, ("speed", 140.0, 150.0), ("joint 2.angle", 0.9, 1.4), rows=3),
        lambda: tn.tongues(in_rpm(), ("speed", LOW, HIGH), (ANGLE, 0.0, 0.6)),
        quick=("load torque",),
    ),
    "stable_windows": Question(
        lambda line: tn.stable_windows(line, "joint 2.angle", 0.2, 1.4, (140.0, 150.0), rows=5),
        lambda: tn.stable_windows(in_rpm(), ANGLE, 0.0, 0.3, (LOW, HIGH)),
        quick=("load torque",),
    ),
    "minimum_damping": Question(
        lambda line: least_damping(line, (140.0, 144.0)),
        lambda: tn.minimum_damping(in_rpm(), (LOW, HIGH)),
        quick=("load torque",),
    ),
    "compare": Question(
        lambda line: tn.compare(line, line.replace("load", inertia=0.21), (SPEED, SPEED)),
        lambda: tn.compare(in_rpm(), in_rpm().with_load("pull")),
        quick=("load torque", "angle of an ideal joint", "dry friction", "prescribed far end"),
    ),
    "optimise": Question(
        lambda line: tn.optimise(
            line, {"load.inertia": (0.15, 0.25)}, "peak torque of rear", (SPEED, SPEED), checks=False, designs=20
        ),
        lambda: tn.optimise(in_rpm(), {ANGLE: (0.1, 0.2)}, "growth rate", checks=False, designs=20),
        quick=("load torque", "excitation by order", "dry friction"),
    ),
    "sensitivity": Question(
        lambda line: tn.sensitivity(line, SPEED, ["load.inertia"], of=["frequencies", "growth", "torques"]),
        lambda: tn.sensitivity(in_rpm()),
        quick=("load torque", "angle of an ideal joint", "dry friction"),
    ),
    "certify_stability": Question(
        lambda line: tn.certify_stability(line, {"hub.inertia": 1e-4}, (100.0, 100.001), most_boxes=2),
        lambda: tn.certify_stability(in_rpm(), {ANGLE: 0.01}, speeds=(MIDDLE, MIDDLE * 1.001)),
        quick=("load torque", "stiffness", "ratio", "prescribed far end"),
    ),
    "certify_peaks": Question(
        lambda line: tn.certify_peaks(line, {"hub.inertia": 1e-4}, (100.0, 100.001), most_boxes=2),
        lambda: tn.certify_peaks(in_rpm(), {ANGLE: 0.01}, speeds=(MIDDLE, MIDDLE * 1.001), most_boxes=2),
        quick=("load torque", "ratio", "excitation by order"),
    ),
    "tolerance_study": Question(
        lambda line: tn.tolerance_study(line, {"hub.inertia": 0.1}, SPEED, samples=256),
        lambda: tn.tolerance_study(in_rpm(), {ANGLE: 0.05}, speeds=[LOW, HIGH], samples=256),
    ),
    "simulate": Question(
        lambda line: tn.simulate(line, 0.05, speed=SPEED),
        lambda: tn.simulate(in_rpm(), speed=MIDDLE, turns=20),
    ),
    "transient": Question(
        lambda line: tn.transient(line, 0.05, speed=SPEED),
        lambda: tn.transient(in_rpm(), 0.2, torque=[tn.AppliedTorque(on="load", time=[0, 1], torque=[0, -5])]),
        quick=("load torque", "dry friction"),
    ),
    "periodic_response": Question(
        lambda line: tn.periodic_response(line, SPEED),
        lambda: tn.periodic_response(in_rpm(), MIDDLE),
        quick=("load torque", "prescribed far end"),
    ),
    "linearity_check": Question(
        lambda line: tn.linearity_check(line, SPEED),
        lambda: tn.linearity_check(in_rpm(), MIDDLE),
        quick=("load torque", "dry friction", "prescribed far end"),
    ),
    "run_up": Question(
        lambda line: tn.run_up(line, 100, 110, acceleration=200, steady=2),
        lambda: tn.run_up(in_rpm(), LOW, MIDDLE, acceleration=200, steady=0),
        quick=("load torque",),
    ),
    "fatigue": Question(
        lambda line: tn.fatigue(with_duty(line)),
        lambda: tn.fatigue(in_rpm_for_life()),
    ),
    "safe_accelerations": Question(
        lambda line: tn.safe_accelerations(line, 100, 110, limit=1000.0, accelerations=(100, 200), points=2),
        lambda: tn.safe_accelerations(in_rpm(), LOW, MIDDLE, limit={"tube": 50.0}, accelerations=[100.0, 200.0]),
        quick=("load torque",),
    ),
    "periodic_branch": Question(
        lambda line: tn.periodic_branch(line, "speed", *RANGE, longest_step=0.5),
        lambda: tn.periodic_branch(in_rpm(), "speed", LOW, MIDDLE, most_points=4),
        quick=("viscous load", "free start"),
    ),
    "harmonic_balance": Question(
        lambda line: tn.harmonic_balance(line, "speed", *RANGE, longest_step=0.5),
        lambda: tn.harmonic_balance(in_rpm(), "speed", LOW, MIDDLE, most_points=4),
        quick=("excitation by order", "free start"),
    ),
    "frequency_response": Question(
        lambda line: tn.frequency_response(line, *RANGE, longest_step=0.5),
        lambda: tn.frequency_response(geared_in_rpm(), LOW, MIDDLE, method="exact", most_points=6),
        quick=("load torque", "free start"),
    ),
    "sweep": Question(
        lambda line: tn.sweep(line, [99.0, 100.0]),
        lambda: tn.sweep(geared_in_rpm(), GRID[:2]),
        quick=("transmission error", "angle of an ideal joint", "quadratic load"),
        line=feature_lines.straight,
    ),
    "exact_motion": Question(
        lambda line: tn.exact_motion(line, 0.05, speed=SPEED),
        lambda: tn.exact_motion(geared_in_rpm(), speed=MIDDLE, duration=0.1),
        line=feature_lines.straight,
    ),
    "piecewise_orbit": Question(
        lambda line: tn.piecewise_orbit(line, speed=SPEED),
        lambda: tn.piecewise_orbit(geared_in_rpm(), speed=MIDDLE),
        quick=("transmission error", "angle of an ideal joint", "quadratic load"),
        line=feature_lines.straight,
    ),
    "piecewise_branch": Question(
        lambda line: tn.piecewise_branch(line, *RANGE, longest_step=0.5),
        lambda: tn.piecewise_branch(geared_in_rpm(), LOW, MIDDLE, most_points=6),
        quick=("transmission error", "angle of an ideal joint", "quadratic load"),
        line=feature_lines.straight,
    ),
    "lyapunov_spectrum": Question(
        lambda line: tn.lyapunov_spectrum(line, 20, speed=SPEED, starts=1, transient=5),
        lambda: tn.lyapunov_spectrum(in_rpm(), speed=MIDDLE, periods=20),
        quick=("load torque", "prescribed far end"),
    ),
    "lyapunov_sweep": Question(
        lambda line: tn.lyapunov_sweep(line, "load.inertia", [0.2], periods=20, transient=5, speed=SPEED),
        lambda: tn.lyapunov_sweep(in_rpm(), "speed", GRID[:2], periods=20),
        quick=("damping", "prescribed far end"),
    ),
    "lyapunov_map": Question(
        lambda line: tn.lyapunov_map(
            line,
            ("load.inertia", 0.2, 0.21, 2),
            ("rear.stiffness", 1e4, 1.1e4, 2),
            periods=10,
            transient=2,
            speed=SPEED,
        ),
        lambda: tn.lyapunov_map(in_rpm(), ("speed", LOW, HIGH, 2), (ANGLE, 0.1, 0.2, 2), periods=20),
        quick=("damping", "prescribed far end"),
    ),
    "poincare_map": Question(
        lambda line: tn.poincare_map(line, 10, speed=SPEED, transient=5),
        lambda: tn.poincare_map(in_rpm(), speed=MIDDLE, points=10),
        quick=("excitation by order", "prescribed far end"),
    ),
    "bifurcation_diagram": Question(
        lambda line: tn.bifurcation_diagram(line, "load.inertia", [0.2], points=8, transient=5, speed=SPEED),
        lambda: tn.bifurcation_diagram(in_rpm(), "speed", GRID[:2], points=8),
        quick=("quadratic load", "prescribed far end"),
    ),
    "certify_chaos": Question(
        lambda line: tn.certify_chaos(line, 20, speed=SPEED, starts=1, points=10, transient=5, sweep=False),
        lambda: tn.certify_chaos(in_rpm(), speed=MIDDLE, periods=50),
        quick=("load torque", "prescribed far end"),
    ),
}
TUBES = (620.0, 640.0)
ASK_CELL = {
    **{
        ("stable_windows", key): lambda line: tn.stable_windows(line, "joint 2.angle", 0.2, 1.5, TUBES, rows=5)
        for key in ("tube inertia", "bending stiffness")
    },
    **{
        ("tongues", key): lambda line: tn.tongues(line, ("speed", *TUBES), ("joint 2.angle", 0.9, 1.5), rows=3)
        for key in ("tube inertia", "bending stiffness")
    },
    **{
        ("minimum_damping", key): lambda line: least_damping(line, TUBES, 1.05, maximum=40.0)
        for key in ("tube inertia", "bending stiffness")
    },
    ("tongues", "drive share"): lambda line: tn.tongues(
        line, ("speed", 104.0, 116.0), ("HookeJoint 2.angle", 0.4, 0.68), rows=3
    ),
    ("stable_windows", "drive share"): lambda line: tn.stable_windows(
        line, "HookeJoint 2.angle", 0.4, 0.68, (108.0, 112.0), rows=3
    ),
    ("minimum_damping", "drive share"): lambda line: tn.minimum_damping(
        line.replace("HookeJoint 2", angle=0.65), (108.0, 112.0), maximum=10.0, rows=3
    ),
    # It excites the order of the mesh, from which an inertia can be known with it, and nothing without it.
    ("identify", "transmission error"): lambda line: tn.identify(
        feature_lines.unbent(line), measured_mesh_order(), {"hub.inertia": (0.05, 0.2)}
    ),
    # Gears make long periods of a line with joint angles; a straight one asks as much of them.
    **{
        ("identify", key): lambda line: tn.identify(
            shaken(feature_lines.unbent(line)), measured_orders(False), {"rear.stiffness": (5e3, 2e4)}
        )
        for key in ("planetary set", "ratio", "gear mesh", "mesh damping", "mesh-stiffness variation", "belt")
    },
    # A stiff mesh moves where its own mode is excited.
    ("sweep", "mesh damping"): lambda line: tn.sweep(line, [2700.0, 2800.0]),
    ("minimum_damping", "loss factor"): lambda line: least_damping(line, (140.0, 150.0), 0.6, maximum=4.0),
}
"""Where ``ask`` would not show a feature."""
COSTLY = {
    (name, "mesh-stiffness variation") for name in ("stability", "order_response", "speed_sweep", "tolerance_study")
}
