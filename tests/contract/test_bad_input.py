"""Every refusal of the description, triggered: one line that names element, key, value and remedy."""

import os
import re

import numpy as np
import pytest

import trunnion as tn
from trunnion import (
    assess,
    damper_optimum,
    kinetostatics,
    natural_frequencies,
    order_response,
    simulate,
    stability,
)
from trunnion.driveline import (
    Belt,
    Brake,
    CentrifugalPendulum,
    ConstantSpeed,
    Coupling,
    Differential,
    Disk,
    Driveline,
    DualMassFlywheel,
    Engine,
    Fan,
    GearPair,
    Generator,
    HookeJoint,
    IdealJoint,
    Limit,
    LoadCase,
    Motor,
    Operation,
    Planetary,
    Propeller,
    Ratio,
    Schedule,
    Shaft,
    SlipClutch,
    SwitchedOff,
    TitleBlock,
    Tolerance,
    TorqueConverter,
    TunedDamper,
    Tyre,
    Vehicle,
    ViscousDamper,
    dump,
    load,
    loads,
    starter,
)
from trunnion.errors import InputError
from trunnion.response.speed_sweep import response_over

TUBE = {"outer_diameter": "76 mm", "length": "1 m", "shear_modulus": "79.3 GPa"}


def wheel():
    """Ninety-nine turns of a wheel of 20 teeth, five a second."""
    return tn.PulseTrain(np.arange(2000) / 100.0, 20, name="wheel")


def gauge():
    return tn.SampledSignal(np.sin(np.arange(2000.0)), 100.0, name="gauge")


def rotated():
    return tn.track_orders(tn.Measurement([wheel()]), [1])


def benched(**more):
    """A run-up of a line with a joint on a synthetic bench."""
    joint, tube = HookeJoint(angle=0.2, name="joint"), Shaft(stiffness=2e4, damping=25.0, name="tube")
    line = Driveline([ConstantSpeed(name="drive"), joint, tube, Disk(inertia=0.5, name="hub")])
    return line, tn.measure(line, **({"speeds": (60.0, 90.0), "duration": 3.0, "pickups": {"hub": 30}} | more))


def tracked(at="hub"):
    """Order 2 of its hub, the channel said to be at ``at``."""
    line, run = benched()
    train = tn.PulseTrain(run.pulses[0].times, 30, "CH1", at)
    return line, tn.track_orders(tn.Measurement([train]), [2])


def identified(free, **more):
    return tn.identify(*tracked(), free, **more)


def tube():
    return Shaft(stiffness=2e4, damping=9.0, name="tube")


def damped():
    """A damper at the middle of three equal disks that are free–free."""
    ends, shaft = Disk(inertia=1.0), Shaft(stiffness=100.0)
    return Driveline(
        [ends, shaft, Disk(inertia=1.0), ViscousDamper(ring_inertia=0.1, damping=1.0, name="damper"), shaft, ends]
    )


def on_a_bare_shaft():
    """A damper whose housing has no inertia, and nothing else where it sits."""
    return Driveline([Disk(inertia=1.0), Shaft(stiffness=100.0), ViscousDamper(ring_inertia=0.1, damping=1.0)])


def rubber(**changes):
    """A coupling whose factors go over temperature."""
    stated = {"stiffness": 1e4, "temperature": 310.0, "temperatures": [300.0, 350.0], "stiffness_factors": [1.0, 0.8]}
    return Coupling(**{k: v for k, v in (stated | {"name": "rubber"} | changes).items() if v is not None})


RUBS = {"torque": 1, "stiffness": 1}
KLOSS = {"breakdown_torque": 500.0, "breakdown_slip": 0.2, "synchronous_speed": 157.0}
CURVE = [{"speed": 0.0, "torque": 90.0}, {"speed": 150.0, "torque": 200.0}]
SADDLE = [{"speed": w, "torque": t} for w, t in ((0.0, 300.0), (60.0, 100.0), (120.0, 300.0), (160.0, 0.0))]


def motor(**changes):
    return Motor(**{"inertia": 0.4, "name": "motor"} | changes)


def fan(**changes):
    return Fan(**{"inertia": 3.0, "name": "fan"} | changes)


def propeller(**changes):
    return Propeller(**{"inertia": 60.0, "quadratic_load": 20.0, "name": "propeller"} | changes)


def driving(*ends):
    """Two machines and a shaft between them, the line free–free."""
    return Driveline([ends[0], Shaft(stiffness=1e4, damping=2.0), *ends[1:]])


DRAWN = {
    "throw_stiffness": None, "journal_diameter": 0.06, "journal_length": 0.03, "pin_diameter": 0.05, "pin_length": 0.03,
    "web_thickness": 0.02, "web_width": 0.08, "shear_modulus": 8e10,
}  # fmt: skip


def engine(**changes):
    """Of four cylinders; its pressure, where it has one, is 2 bar but for what is changed."""
    curve = {key: changes.pop(key) for key in ("angles", "pressures") if key in changes}
    stated = {"firing_order": "1-3-4-2", "throw_inertia": 0.02, "throw_stiffness": 6e5, **changes}
    if curve:
        sizes = {"bore": 0.08, "stroke": 0.09, "rod_length": 0.15}
        angles = curve.setdefault("angles", [f"{i} deg" for i in range(720)])
        curve.setdefault("pressures", [2e5] * len(angles))
        stated = {**sizes, "pressure": [curve], **stated}
    return Engine(**{key: value for key, value in stated.items() if value is not None})


def indicated(**changes):
    """Of four cylinders, by its mean indicated pressure."""
    stated = {
        "bore": 0.2, "stroke": 0.26, "rod_length": 0.5, "mean_indicated_pressure": "20 bar", "peak_pressure": "165 bar",
        "charge_pressure": "3.6 bar", "compression_ratio": 13.5, "polytropic_exponent": 1.36,
    }  # fmt: skip
    return engine(**{key: value for key, value in (stated | changes).items() if value is not None})


def dual_mass(**changes):
    return DualMassFlywheel(**{"primary_inertia": 0.1, "secondary_inertia": 0.05, "stiffnesses": [1e3]} | changes)


def pendulum(**changes: object) -> CentrifugalPendulum:
    stated = {"mass": 1.0, "radius": 0.1, "order": 2.0} | changes
    return CentrifugalPendulum(**{key: value for key, value in stated.items() if value is not None})


def belt(**changes):
    return Belt(**{"radius_in": 0.1, "radius_out": 0.2, "span_stiffness": 1e5} | changes)


def long_line(inertias: int) -> Driveline:
    """A chain with a joint at its front."""
    chain = [e for _ in range(inertias) for e in (Shaft(stiffness=1e5, damping=1.0), Disk(inertia=0.1))]
    return Driveline([tn.ConstantSpeed(), *chain[:2], tn.HookeJoint(angle=0.1), *chain[2:]])


def shaken_and_steep(inertias: int) -> Driveline:
    """The same with its joint at 80°, its last disk shaken by three orders."""
    shaken = [{"order": order, "amplitude": 50.0} for order in (1.5, 3.0, 4.5)]
    return long_line(inertias).replace("HookeJoint 1", angle=tn.deg(80)).replace(f"Disk {inertias}", excitation=shaken)


def meshed_and_free(inertias: int) -> Driveline:
    """The same without its drive, and with a mesh that varies at its end, which goes by whole matrices."""
    mesh = toothed(stiffness_variation=[{"order": 1, "share": 0.05}])
    return Driveline([*long_line(inertias).elements[2:], mesh, Disk(inertia=0.1)])


OIL = [{"frequency": w, "stiffness": 10 * w, "loss_stiffness": 30 * w} for w in (10.0, 100.0)]


def toothed(**changes: object) -> GearPair:
    return GearPair(**{"teeth_in": 20, "teeth_out": 40, "module": 0.003, "mesh_stiffness": 1e8} | changes)


def planetary(**changes: object) -> Planetary:
    return Planetary(**{"teeth_sun": 30, "teeth_ring": 72, "input": "sun", "held": "ring"} | changes)


def line(*elements, **rest):
    return Driveline(elements or [ConstantSpeed(), Shaft(stiffness=1e4), Disk(inertia=1)], **rest)


def with_play():
    """A gear pair whose teeth part."""
    return tn.GearPair(teeth_in=20, teeth_out=31, module=0.003, mesh_stiffness=1e7, backlash=1e-4)


def free(**engine):
    """A line with joint angles that nothing holds at a speed, with a load of 9 N m."""
    return Driveline(
        [
            Disk(inertia=1.0, name="engine", **engine),
            Shaft(stiffness=900.0, damping=0.5),
            Disk(inertia=0.5),
            HookeJoint(angle=0.3),
            Shaft(stiffness=900.0, damping=0.5),
            Disk(inertia=0.5, load_torque=9.0, name="pump"),
        ]
    )


OF_A_MOTOR = {"breakdown_torque": 9.0, "breakdown_slip": 0.2, "synchronous_speed": 100.0}


PUMP = Disk(inertia=1, name="pump")
SILENT = Disk(inertia=1, drive_share=1, firing_angles=[0, 1], excitation=[{"order": 2, "amplitude": 1}])


def torque(**given):
    return tn.AppliedTorque(on="pump", **given)


FAULT = {"case": "three-phase short circuit", "frequency": "50 Hz", "amplitude": 9, "decay": 0.2}


def disturbance(**given):
    return tn.Disturbance(on="pump", **given)


def unbalanced():
    """A straight line that nothing holds at a speed, excited by its rotation, whose drive is stronger than its load."""
    engine = Disk(inertia=1.0, load_torque=-30.0, excitation=[{"order": 2, "amplitude": 5.0}], name="engine")
    return Driveline([engine, Shaft(stiffness=900.0, damping=0.5), Disk(inertia=0.5, load_torque=9.0, name="pump")])


BEARS = {"torque_amplitude": 100.0, "cycles": 1e6, "slope": 5}
RUNS = {"first": 10.0, "last": 90.0, "acceleration": 5.0, "per_hour": 1}


def lasting(*curves, **operation):
    """A line with S–N curves, one that does by default."""
    curves = [tn.SNCurve(of="Shaft 1", **BEARS)] if not curves else [tn.SNCurve(**one) for one in curves]
    return line(sn_curves=curves, operation=Operation(**operation))


ANGLES = {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "20 deg", "points": 4}
STATED_ANGLES = {"path": "HookeJoint 1.angle", "values": [0.1, 0.2]}


def studied(given=True, **changes):
    """What a study of a small line would cost."""
    stated = {"line": "", "analysis": "stability", "quantities": ["growth_rate"], "store": "a.zarr"}
    parts = ConstantSpeed(), HookeJoint(angle=0.1), Shaft(stiffness=1e4, damping=2.0), Disk(inertia=0.8)
    asked = {**stated, "parameter": [ANGLES], "arguments": {"speed": 50.0}, **changes}
    return tn.study_cost(asked, line=line(*parts) if given else None)


def history(values, **rest):
    return tn.LoadHistory({"Shaft 1": values}, **rest)


AXLE = Schedule(name="axle", travel=[0, 1], angles={"joint": [0, 1]})

FATIGUE = [
    (lambda: tn.SNCurve(of="a", torque_amplitude=1, slope=5), "S-N curve of a.cycles: is missing", "slope = 5"),
    (lambda: tn.SNCurve(of="a", torque_amplitude=1, cycles=1e6), "S-N curve of a.slope: is missing", "slope = 5"),
    (lambda: tn.SNCurve(of="a", **BEARS | {"slope": 0}), "S-N curve of a.slope = 0: must be positive", "slope = 5"),
    (lambda: tn.SNCurve(of="a", **BEARS | {"cycles": -1}), "S-N curve of a.cycles = -1: must be positive", "2e6"),
    (
        lambda: tn.SNCurve(of="a", **BEARS | {"slope": float("nan")}),
        "S-N curve of a.slope = nan: must be finite",
        "0.02",
    ),
    (lambda: tn.SNCurve(of="a", cycles=1, slope=1), "S-N curve of a.stress_amplitude: is missing", "one of the two"),
    (
        lambda: tn.SNCurve(of="a", stress_amplitude=1e6, **BEARS),
        "S-N curve of a.stress_amplitude = 1e+06: conflicts with torque_amplitude",
        "one of the two",
    ),
    (
        lambda: tn.SNCurve(of="a", ultimate_stress=1e6, **BEARS),
        "S-N curve of a.ultimate_stress = 1e+06: conflicts with torque_amplitude",
        "ultimate_torque",
    ),
    (
        lambda: tn.SNCurve(of="a", ultimate_torque=1e6, mean_sensitivity=0.2, **BEARS),
        "S-N curve of a.mean_sensitivity = 0.2: conflicts with ultimate_torque",
        "leave one",
    ),
    (
        lambda: tn.SNCurve(of="a", ultimate_torque=90.0, **BEARS),
        "S-N curve of a.ultimate_torque = 90: does not lie above torque_amplitude",
        "check both",
    ),
    (lambda: tn.SNCurve(of="a", mean_sensitivity=2, **BEARS), "S-N curve of a.mean_sensitivity = 2: must not", "0.2"),
    (lambda: tn.SNCurve(of="a", miner="haibach", **BEARS), "S-N curve of a.miner = 'haibach': is not a form", "known"),
    (
        lambda: line(sn_curves=[tn.SNCurve(of="Shaft 1", stress_amplitude=1e8, cycles=1, slope=1)]),
        "S-N curve of Shaft 1.stress_amplitude = '100 MPa': needs the outer_diameter of the Shaft",
        "torque_amplitude",
    ),
    (
        lambda: line(sn_curves=[tn.SNCurve(of="Disk 1", **BEARS)]),
        "S-N curve of Disk 1.torque_amplitude = '100 N m': does not belong to a Disk",
        "name a shaft",
    ),
    (lambda: line(sn_curves=[tn.SNCurve(of="Shft 1", **BEARS)]), "S-N curve.of = 'Shft 1': is not an", "Shaft 1"),
    (lambda: line(sn_curves=[3]), "driveline.S-N curve 1 = 3: is not a stress-life curve", "torque_amplitude"),
    (lambda: tn.Duty(share=0, speed=1), "duty.share = 0: must lie above 0", "60 %"),
    (lambda: tn.Duty(share=1, speed=0), "duty.speed = 0: must be positive", "1500 rpm"),
    (lambda: tn.Duty(speed=1), "duty.share: is missing", "60 %"),
    (
        lambda: Operation(duty=[tn.Duty(share=0.5, speed=1), tn.Duty(share=0.4, speed=2)]),
        "operation.duty: has shares that add up to 0.9, not to 1",
        "those at rest left out",
    ),
    (
        lambda: Operation(duty=[tn.Duty(share=1, speed=1, load_case="full")]),
        "duty 1.load_case = 'full': is not a load case",
        "there are none",
    ),
    (lambda: Operation(life="-1 h"), "operation.life = '-1 h': must be positive", "20000 h"),
    (lambda: Operation(life="20000"), "operation.life = '20000': has no unit", "0.3 s"),
    (
        lambda: tn.SpeedPassage(name="up", **RUNS | {"per_hour": 0}),
        "passage up.per_hour = 0: must be positive",
        "start",
    ),
    (lambda: tn.SpeedPassage(name="up", **RUNS | {"last": 10.0}), "passage up.last = 10: is the speed", "raise it"),
    (
        lambda: Operation(passages=[tn.SpeedPassage(name="up", **RUNS)] * 2),
        "operation.passage = 'up': is the name of 2 passages",
        "rename one",
    ),
    (lambda: tn.fatigue(line()), "driveline.sn_curve: is not stated for any element", "[[sn_curve]]"),
    (lambda: tn.fatigue(lasting()), "operation.duty: is missing", "[[operation.passage]]"),
    (lambda: tn.fatigue(lasting(), []), "histories: is empty", "LoadHistory"),
    (lambda: tn.fatigue(lasting(), [history([0, 1, 0], per_hour=1)], life=0), "life = 0: must be positive", "20000 h"),
    (
        lambda: tn.fatigue(lasting(), [history([0, 1, 0], share=0.4, duration=1.0)]),
        "histories: have shares that add up to 0.4, not to 1",
        "those at rest",
    ),
    (
        lambda: tn.fatigue(lasting(), [tn.LoadHistory({"Shft 1": [0, 1, 0]}, per_hour=1)]),
        "history history 1.Shaft 1: has no torque of this element",
        "Shft 1",
    ),
    (lambda: history([0, 1], per_hour=1), "history.Shaft 1: is too short: 2 values", "comes back"),
    (lambda: history([0, float("nan"), 1], per_hour=1), "history.Shaft 1: is not finite at value 2", "fill it in"),
    (lambda: history([[0, 1, 0]], per_hour=1), "history.Shaft 1: is not a row of torques", "comes back"),
    (lambda: history([0, 1, 0]), "history.per_hour: is missing", "give one"),
    (lambda: history([0, 1, 0], per_hour=1, share=1), "history.per_hour = 1: conflicts with share", "give one"),
    (lambda: history([0, 1, 0], share=1), "history.duration: is needed with share", "seconds"),
    (lambda: history([0, 1, 0], share=2, duration=1.0), "history.share = 2: is more than the whole", "0.6"),
    (lambda: history([0, 1, 0], per_hour=-1, name="jam"), "history jam.per_hour = -1: must be positive", "0.5"),
    (lambda: tn.LoadHistory(3, per_hour=1), "history.source: is not a load history but of type int", "run_up"),
    (
        lambda: tn.fatigue(lasting(), [tn.LoadHistory(tn.order_response(lasting(), [50.0]), share=1, speed=60.0)]),
        "speed = 60: is not a speed of the response",
        "there are",
    ),
    (
        lambda: tn.fatigue(lasting(passages=[tn.SpeedPassage(name="up", **RUNS | {"acceleration": 1e-9})])),
        "passage up",
        "acceleration",
    ),
]
"""What fatigue refuses."""


def animate(what, **arguments):
    from trunnion import animate as shown

    return shown(free(), what, **arguments)


# (what is done, how the message starts, what it must also say)
def converter_points(**middle: object) -> list[dict[str, object]]:
    """Three points of a torque converter, of which the one between is changed."""
    between = {"speed_ratio": 0.8, "torque_ratio": 1.1, "capacity": 3e-3} | middle
    ends = [
        {"speed_ratio": 0, "torque_ratio": 2, "capacity": 4e-3},
        {"speed_ratio": 1, "torque_ratio": 1, "capacity": 0},
    ]
    if "pump_torque" in middle:
        between.pop("capacity")
    return [ends[0], between, ends[1]]


def converted(short: bool = False, twice: bool = False, joint: bool = False, **load: object) -> Driveline:
    """A line with a torque converter."""
    points = converter_points()
    if short:
        points = [points[0], {"speed_ratio": 0.4, "torque_ratio": 1.5, "capacity": 4e-3}, points[1]]
    converter = TorqueConverter(curves=points, name="converter")
    second = [Disk(inertia=0.1), converter.but(name="second")] if twice else []
    bend = [HookeJoint(angle=0.2, name="bend")] if joint else []
    end = Disk(inertia=0.2, name="load", **({"load_torque": 2.0} | load))
    drive = Disk(inertia=0.1, drive_share=1) if "drive_share" in load else ConstantSpeed()
    return Driveline(
        [drive, Shaft(stiffness=1e4), Disk(inertia=0.1), *bend, converter, *second, Disk(inertia=0.1),
         Shaft(stiffness=1e4), end]
    )  # fmt: skip


PYTHON = [
    *FATIGUE,
    # what moves
    (lambda: animate("mod"), "what = 'mod': is not a motion of a line", 'did you mean "mode"?'),
    (lambda: animate("turning", mode=1), "mode = 1: does not belong to turning", "turning takes speed"),
    (lambda: animate("mode", mode=9), "mode = 9: is not a mode that vibrates", "give 1 to"),
    (lambda: animate("mode", mode=True), "mode = True: is not a mode that vibrates", "give 1 to"),
    (
        lambda: animate("response", speed=90.0),
        "driveline.what = 'response': is free–free and has joint",
        "ask for motion",
    ),
    (lambda: animate("disturbance", speed=90.0), "driveline.what = 'disturbance': is free–free", "ask for motion"),
    (lambda: animate("transient"), "driveline.scenario: has no scenario", "[[scenario]]"),
    (lambda: animate("run-up"), "speeds: are not known", "give the lowest and the highest"),
    (lambda: animate("mode").save("line.mp4"), "output = 'line.mp4': is not a file", "end it in one of"),
    # excitations
    (lambda: Disk(inertia=1, excitation=[{"order": 2}]), "Disk.excitation 1 amplitude: is missing", "40 N*m"),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitude": 1, "quadratic_amplitude": 1}]),
        "Disk.excitation 1 quadratic_amplitude = 1: conflicts with amplitude",
        "leave one",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"frequency": 2, "quadratic_amplitude": 1}]),
        "Disk.excitation 1 quadratic_amplitude = 1: belongs to an order",
        "order instead",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitude": 1, "speeds": [1, 2]}]),
        "Disk.excitation 1 speeds = [1, 2]: has no amplitudes beside it",
        "amplitudes",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1, 2]}]),
        "Disk.excitation 1 speeds: is needed with amplitudes",
        "torques",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1, 2], "speeds": [1, 2], "torques": [1, 2]}]),
        "Disk.excitation 1 amplitudes = [1, 2]: must be 4 quantities, one for each of 2 speeds at each of 2 torques",
        "",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1], "speeds": [1]}]),
        "Disk.excitation 1 speeds = [1]: must have two points",
        "constant",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1, 2, 3], "speeds": [1, 2]}]),
        "Disk.excitation 1 amplitudes = [1, 2, 3]: must be 2 quantities, one for each of speeds",
        "",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1, 2], "speeds": [2, 2]}]),
        "Disk.excitation 1 speeds = [2, 2]: must rise",
        "sort",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": [1, 2], "speeds": [-2, 2]}]),
        "Disk.excitation 1 speeds = [-2, 2]: must not be negative",
        "",
    ),
    (
        lambda: Disk(inertia=1, excitation=[{"order": 2, "amplitudes": "1 N*m", "speeds": [-2, 2]}]),
        "Disk.excitation 1 amplitudes = '1 N*m': is not a list of quantities",
        "speeds",
    ),
    (
        lambda: Disk(inertia=1, excitation="engine.csv"),
        "Disk.excitation = 'engine.csv': names a file that is not known here",
        "tn.load",
    ),
    (lambda: engine(firing_order="1-3-4-5"), "Engine.firing_order = '1-3-4-5': must have every cylinder", "no 2"),
    (lambda: engine(firing_order="1-3-3-2"), "Engine.firing_order = '1-3-3-2': must have every cylinder", "no 4"),
    (lambda: engine(firing_order="A-B"), "Engine.firing_order = 'A-B': is not an order of cylinders", "1-5-3-6-2-4"),
    (lambda: engine(firing_order=[]), "Engine.firing_order = []: must have 1 to 48 cylinders", ""),
    (lambda: engine(firing_order="1-3-2", bank_angle=1), "Engine.bank_angle = 1: has two cylinders on every", "3"),
    (
        lambda: engine(firing_intervals=["90 deg"] * 4),
        "Engine.firing_intervals = ['90 deg', '90 deg', '90 deg', '90 deg']: make 360 deg together",
        "and a cycle has 720; check them, and strokes",
    ),
    (lambda: engine(firing_intervals=[1, 2]), "Engine.firing_intervals = [1, 2]: must be 4 angles", "leave them out"),
    (lambda: engine(strokes=3), "Engine.strokes = 3: is neither 2 nor 4", "strokes = 4"),
    (lambda: engine(throw_inertia=[]), "Engine.throw_inertia = []: has no quantities", "0.02 kg*m^2"),
    (lambda: engine(throw_inertia=[1, 2]), "Engine.throw_inertia = [1, 2]: must be one for all or 4", "each throw"),
    (lambda: engine(throw_inertia=[-1]), "Engine.throw_inertia = [-1]: must be positive", "kg*m^2"),
    (lambda: engine(throw_stiffness=None), "Engine.throw_stiffness: is missing", "rigid = true"),
    (lambda: engine(throw_stiffness=[1] * 4), "Engine.throw_stiffness = [1, 1, 1, 1]: must be one for all", "shaft"),
    (lambda: engine(damping=1, loss_factor=0.1), "Engine.damping = 1: conflicts with loss_factor", "leave one"),
    (lambda: engine(pin_length=0.03), "Engine.pin_length = 0.03: conflicts with throw_stiffness", "leave one"),
    (
        lambda: engine(throw_stiffness=None, pin_length=0.03),
        "Engine.journal_diameter: is needed with pin_length",
        "web_width",
    ),
    (
        lambda: engine(**DRAWN | {"pin_bore": 0.2, "stroke": 0.09}),
        "Engine.pin_bore = 0.2: must be smaller than pin_diameter",
        "units",
    ),
    (
        lambda: engine(**DRAWN, stroke=0.09, stiffness_formula="holzer"),
        "Engine.stiffness_formula = 'holzer': is not a formula",
        "ker wilson",
    ),
    (
        lambda: engine(**DRAWN | {"web_thickness": 1e-6}, stiffness_formula="ker wilson", stroke=0.01),
        "Engine.stiffness_formula = 'ker wilson': leaves a throw without stiffness",
        "carter",
    ),
    (lambda: engine(loss_factor_frequency=9), "Engine.loss_factor: is needed with loss_factor_frequency", "0.02"),
    (lambda: engine(stroke=0.4, rod_length=0.2), "Engine.rod_length = 0.2: must be longer than the crank", "200 mm"),
    (lambda: engine(reciprocating_mass=1), "Engine.stroke: is needed with reciprocating_mass", "rod_length"),
    (lambda: engine(orders=99), "Engine.orders = 99: must be from 1 to 24", "12"),
    (
        lambda: engine(pressures=[2e5] * 720, gas_torque=[{"order": 2, "amplitude": 1}]),
        "Engine.pressure = [{",
        "conflicts with gas_torque",
    ),
    (
        lambda: engine(gas_torque=[{"amplitude": 1, "frequency": 2}]),
        "Engine.gas_torque = [{'amplitude': 1, 'frequency': 2}]: repeats orders, not a frequency",
        "write orders",
    ),
    (
        lambda: engine(angles=[f"{i} deg" for i in range(540)]),
        "Engine.pressure = [{",
        ": covers 539 deg, and a cycle of 4 strokes has 720 deg; give one whole cycle",
    ),
    (
        lambda: engine(angles=[f"{i} deg" for i in range(360)]),
        "Engine.pressure = [{",
        ": covers 359 deg, and a cycle of 4 strokes has 720 deg; write strokes = 2, or give one whole cycle",
    ),
    (
        lambda: engine(angles=list(range(720))),
        "Engine.pressure = [{",
        "deg, and a cycle of 4 strokes has 720 deg; check the unit of its angles: deg read as rad, say",
    ),
    (
        lambda: engine(angles=[f"{np.deg2rad(i)} deg" for i in range(720)]),
        "Engine.pressure = [{",
        "deg, and a cycle of 4 strokes has 720 deg; check the unit of its angles: rad read as deg, say",
    ),
    (
        lambda: engine(angles=[f"{i} deg" for i in range(721)], pressures=[2e5] * 720 + [3e5]),
        "Engine.pressure = [{",
        ": does not close: 2 bar at its beginning and 3 bar a cycle later; give one cycle",
    ),
    (
        lambda: engine(pressures=[65.0] * 720),
        "Engine.pressure = [{",
        ": reaches 65 Pa, less than the pressure of the air; check its unit: bar read as Pa, say",
    ),
    (
        lambda: engine(pressures=[6.5e11] * 720),
        "Engine.pressure = [{",
        ": reaches 6.5e+06 bar, more than any engine; check its unit: Pa read as bar, say",
    ),
    (
        lambda: engine(pressures=[2e5, 3e5]),
        "Engine.pressure 1 pressures = [200000.0, 300000.0]: must be 720 quantities",
        "every angle",
    ),
    (lambda: engine(angles=[0, 1]), "Engine.pressure 1 angles = [0, 1]: has 2 points, and a curve needs 24", "2 deg"),
    (
        lambda: engine(angles=["0 deg"] * 720),
        "Engine.pressure 1 angles = ['0 deg', '0 deg', ",
        ": must rise: 0 deg after 0 deg; sort them; each once",
    ),
    (
        lambda: engine(pressures=[-1] * 720),
        "Engine.pressure 1 pressures = [-1, -1, ",
        ": must be positive; pressures are absolute",
    ),
    (
        lambda: engine(pressure=[{"angles": [0.1 * i for i in range(126)], "pressures": [2e5] * 126}]),
        "Engine.bore: is needed with pressure",
        "stroke",
    ),
    (lambda: indicated(peak_pressure=None), "Engine.peak_pressure: is needed with mean_indicated", "charge_pressure"),
    (lambda: indicated(charge_pressure=None), "Engine.charge_pressure: is needed with compression_ratio", "write"),
    (lambda: indicated(bore=None), "Engine.bore: is needed with compression_ratio", "stroke"),
    (
        lambda: engine(peak_pressure="90 bar"),
        "Engine.mean_indicated_pressure: is needed with peak_pressure",
        "write mean_indicated_pressure",
    ),
    (
        lambda: indicated(gas_torque=[{"order": 2, "amplitude": 9}]),
        "Engine.mean_indicated_pressure = '20 bar': conflicts with gas_torque",
        "leave one",
    ),
    (
        lambda: indicated(mean_indicated_pressure=["20 bar", "12 bar"]),
        "Engine.mean_indicated_pressure = ['20 bar', '12 bar']: must rise",
        "sort them",
    ),
    (
        lambda: indicated(peak_pressure=["165 bar", "120 bar"]),
        "Engine.peak_pressure = ['165 bar', '120 bar']: must be one for all or 1",
        "mean_indicated_pressure",
    ),
    (lambda: indicated(peak_pressure="-1 bar"), "Engine.peak_pressure = '-1 bar': must be positive", "150 bar"),
    (
        lambda: indicated(peak_pressure="100 bar"),
        "Engine.peak_pressure = '100 bar': has 100 bar, below the 124 bar of compression alone",
        "check compression_ratio",
    ),
    (
        lambda: indicated(mean_indicated_pressure="3 bar"),
        "Engine.mean_indicated_pressure = '3 bar': has 3 bar, less than the",
        "give the peak_pressure",
    ),
    (
        lambda: indicated(mean_indicated_pressure="900 bar"),
        "Engine.mean_indicated_pressure = '900 bar': has 900 bar, more than the",
        "give the peak_pressure",
    ),
    *(
        (
            lambda ratio=ratio: indicated(compression_ratio=ratio),
            f"Engine.compression_ratio = {ratio}: leaves no clearance volume",
            "14",
        )
        for ratio in (1, 0.5, 0, -14)
    ),
    (lambda: indicated(compression_ratio=1e6), "Engine.compression_ratio = 1e+06: is more than 200", "14"),
    *(
        (
            lambda key=key, exponent=exponent: indicated(**{key: exponent}),
            f"Engine.{key} = {exponent}: must be positive, and at most 3",
            "1.35",
        )
        for key in ("polytropic_exponent", "expansion_exponent")
        for exponent in (0, -1, 500)
    ),
    (
        lambda: engine(pressures=[2e5] * 720, compression_ratio=14, charge_pressure=1e5, polytropic_exponent=500),
        "Engine.polytropic_exponent = 500: must be positive, and at most 3",
        "1.35",
    ),
    (
        lambda: tn.Schedule(name="open", speed=[50, 90], factors={"fan": [0.2, 0]}),
        "schedule open.factors.fan = 0: must be positive",
        "write 0.01",
    ),
    (
        lambda: line(operation=tn.Operation(schedules=[tn.Schedule(name="a", speed=[5, 9], factors={"b": [1, 2]})])),
        "schedule a.b = (1.0, 2.0): is not a Fan, Pump, Propeller or Generator of this driveline",
        "leave factors out",
    ),
    (lambda: engine(damping_rule="archer"), "Engine.damping_rule = 'archer': is not a rule", 'write "mendes"'),
    (
        lambda: engine(damping_rule="mendes", loss_factor=0.1),
        "Engine.damping_rule = 'mendes': conflicts with loss_factor",
        "leave one",
    ),
    (
        lambda: engine(throw_viscous_load=[1, 2]),
        "Engine.throw_viscous_load = [1, 2]: must be one for all or 4",
        "each throw",
    ),
    (lambda: engine(misfiring=5), "Engine.misfiring = 5: is not the number of a cylinder", "1 to 4"),
    (lambda: engine(misfiring=2, cut_out=2), "Engine.misfiring = 2: names a cylinder that is cut out", "leave one"),
    (
        lambda: engine(pressures=[2e5] * 720, compression_ratio=0.9, charge_pressure=1e5, polytropic_exponent=1.3),
        "Engine.compression_ratio = 0.9: leaves no clearance volume",
        "14",
    ),
    (
        lambda: engine(pressures=[2e5] * 720, compression_ratio=14),
        "Engine.charge_pressure: is needed with compression_ratio",
        "polytropic_exponent",
    ),
    (
        lambda: engine(pressure="pressure.csv"),
        "Engine.pressure = 'pressure.csv': names a file that is not known here",
        "tn.load",
    ),
    (
        lambda: Disk(inertia=1, firing_angles=["0 deg"]),
        "Disk.firing_angles = ['0 deg']: have no excitation to repeat",
        "cylinder",
    ),
    (
        lambda: Disk(inertia=1, firing_angles="0 deg", excitation=[{"order": 2, "amplitude": 1}]),
        "Disk.firing_angles = '0 deg': is not a list of angles",
        "540 deg",
    ),
    (
        lambda: Disk(inertia=1, firing_angles=[0], excitation=[{"frequency": 2, "amplitude": 1}]),
        "Disk.firing_angles = [0]: repeat orders, not a frequency",
        "orders",
    ),
    (
        lambda: Disk(inertia=1, firing_angles=[0, 1], misfiring=3, excitation=[{"order": 2, "amplitude": 1}]),
        "Disk.misfiring = 3: is not the number of a cylinder",
        "from 1 to 2",
    ),
    (
        lambda: tn.misfire(line(Disk(inertia=1), Shaft(stiffness=1), Disk(inertia=1)), [1.0]),
        "driveline.firing_angles: has no cylinders that could misfire",
        "firing_angles",
    ),
    (
        lambda: tn.misfire(line(SILENT, Shaft(stiffness=1), Disk(inertia=1))),
        "operation.speed_range: has no range of speeds to search",
        "speed_range = ",
    ),
    (
        lambda: tn.misfire(line(SILENT, Shaft(stiffness=1), Disk(inertia=1)), speed_range=(20.0, 10.0)),
        "speed_range = (20.0, 10.0): must be a lowest and a highest speed",
        "2400 rpm",
    ),
    (
        lambda: tn.misfire(line(SILENT, Shaft(stiffness=1), Disk(inertia=1)), [10.0], speed_range=(10.0, 20.0)),
        "speed_range = (10.0, 20.0): is a range beside speeds",
        "leave one of them out",
    ),
    (lambda: tn.reciprocating_mass(0, 0.04, 0.15), "mass = 0: must be positive", "kg"),
    (lambda: tn.reciprocating_mass(1, 0.04, 0.03), "rod_length = 0.03: must be longer than the crank", "mm"),
    (lambda: tn.reciprocating_mass(1, 0.04, 0.15, orders=0), "orders = 0: must be from 1 to 24", "orders=6"),
    (
        lambda: tn.run_up(
            line(
                ConstantSpeed(),
                Shaft(stiffness=1e4, damping=1),
                Disk(inertia=1, excitation=[{"order": 2, "speeds": [90, 105], "amplitudes": [1, 2]}]),
            ),
            100,
            110,
            acceleration=200,
            steady=0,
        ),
        "Disk 1.excitation 1: is a table from 859.437 rpm to 1002.68 rpm, which does not cover 1050.4 rpm",
        "extend the table",
    ),
    (
        lambda: tn.run_up(
            line(
                ConstantSpeed(),
                Shaft(stiffness=1e4, damping=1),
                Disk(inertia=1, excitation=[{"order": 2, "quadratic_amplitude": 1}]),
                tn.SlipClutch(torque=50),
                Disk(inertia=1),
            ),
            100,
            110,
            acceleration=200,
            steady=0,
        ),
        "Disk 1.excitation: has an amplitude by its mean speed, which is not that of the whole line",
        "tn.transient",
    ),
    # limits
    (lambda: Limit(max_torque=1), "limit.of: is missing", 'of = "Shaft 1"'),
    (lambda: Limit(of="Shaft 1"), "limit of Shaft 1.of = 'Shaft 1': limits nothing", "max_torque"),
    (lambda: Limit(of="Shaft 1", max_torque="400"), "limit of Shaft 1.max_torque = '400': has no unit", "N*m"),
    (lambda: Limit(of="Shaft 1", max_torque="4 rpm"), "limit of Shaft 1.max_torque = '4 rpm': rpm is not", "N*m"),
    (lambda: Limit(of="Shaft 1", max_stress=0), "limit of Shaft 1.max_stress = 0: must be positive", "GPa"),
    (lambda: Limit(of="Shaft 1", max_toque=1), "limit of Shaft 1.max_toque = 1: unknown key", '"max_torque"'),
    (lambda: Limit(of="Shaft 1", max_torque=1, margin=10), "limit of Shaft 1.margin = 10: must be", "stay free"),
    (
        lambda: Limit(of="Shaft 1", transient_vibratory_torque=1),
        "limit of Shaft 1.vibratory_torque: is needed with transient",
        "continuous",
    ),
    (
        lambda: Limit(of="Shaft 1", vibratory_torque=2, transient_vibratory_torque=1),
        "limit of Shaft 1.transient_vibratory_torque = 1: is smaller than vibratory_torque",
        "swap",
    ),
    (
        lambda: Limit(of="Shaft 1", ship_shaft="flansh"),
        "limit of Shaft 1.ship_shaft = 'flansh': is not a design feature",
        '"flange"',
    ),
    (lambda: line(limits=[Limit(of="shaf", max_torque=1)]), "limit.of = 'shaf': is not an element", "Shaft 1"),
    (lambda: line(limits=[Limit(of="Coupling *", max_torque=1)]), "limit.of = 'Coupling *': has no el", "Shaft *"),
    (
        lambda: line(limits=[Limit(of="Disk 1", max_torque=1)]),
        "limit of Disk 1.max_torque = '1 N m': does not belong to a Disk",
        "max_acceleration",
    ),
    (
        lambda: line(limits=[Limit(of="Disk 1", max_twist="2 deg")]),
        "limit of Disk 1.max_twist = '2 deg': does not belong to a Disk",
        "max_acceleration",
    ),
    (
        lambda: line(limits=[Limit(of="Shaft *", max_stress="40 MPa")]),
        "limit of Shaft *.max_stress = '40 MPa': needs the outer_diameter",
        "outer_diameter, length",
    ),
    (
        lambda: line(limits=[Limit(of="Shaft 1", max_torque=1), Limit(of="Shaft 1", max_torque=2)]),
        "limit of Shaft 1.max_torque = '2 N m': is stated twice",
        "leave one",
    ),
    (lambda: line(limits={"of": "Shaft 1"}), "driveline.limits = ", "tn.Limit("),
    (lambda: line(limits=[3]), "driveline.limit 1 = 3: is not a limit", "tn.Limit("),
    (lambda: Tolerance(stiffness=0.1), "tolerance.of: is missing", 'of = "Shaft 1"'),
    (lambda: Tolerance(3, stiffness=0.1), "tolerance.of = 3: is not a name", 'of = "Shaft 1"'),
    (lambda: Tolerance("Shaft 1"), "tolerance of Shaft 1.of = 'Shaft 1': lets nothing scatter", "stiffness"),
    (lambda: Tolerance("Shaft 1", stifness=1), "tolerance of Shaft 1.stifness = 1: is not a number", '"stiffness"'),
    (lambda: Tolerance("Shaft 1", stiffness=2), "tolerance of Shaft 1.stiffness = 2: must lie between 0 and 1", "5 %"),
    (lambda: Tolerance("Shaft 1", stiffness="-5 %"), "tolerance of Shaft 1.stiffness = '-5 %': must lie", "5 %"),
    (lambda: Tolerance("Shaft 1", stiffness="5 mm"), "tolerance of Shaft 1.stiffness = '5 mm': mm is not", "N*m/rad"),
    (lambda: Tolerance("Shaft 1", stiffness="-1 N*m/rad"), "tolerance of Shaft 1.stiffness = '-1 N*m/rad': m", "5 %"),
    (lambda: Tolerance("Shaft 1", stiffness=[1, 2, 3]), "tolerance of Shaft 1.stiffness = [1, 2, 3]: must have", "["),
    (lambda: Tolerance("Shaft 1", stiffness=[2, 1]), "tolerance of Shaft 1.stiffness = [2, 1]: must rise", "["),
    (lambda: Tolerance("Shaft 1", stiffness={"sigma": 1}), "tolerance of Shaft 1.stiffness = {'sigma': 1}: is no", "d"),
    (
        lambda: Tolerance("Shaft 1", stiffness={"deviation": 0.4}),
        "tolerance of Shaft 1.stiffness = {'deviation': 0.4}: reaches zero",
        "2 %",
    ),
    (lambda: line(tolerances=[Tolerance("shaf", stiffness=0.1)]), "tolerance.of = 'shaf': is not an el", "Shaft 1"),
    (lambda: Tolerance("a", share=0.1), "tolerance of a.share = 0.1: is not a number that can scatter", "its own key"),
    (lambda: line(tolerances=[Tolerance("Clutch *", stiffness=0.1)]), "tolerance.of = 'Clutch *': has no", "Shaft *"),
    (
        lambda: line(tolerances=[Tolerance("Disk 1", stiffness=0.1)]),
        "tolerance of Disk 1.stiffness = 0.1: is not a number that Disk 1 states",
        "inertia",
    ),
    (
        lambda: line(tolerances=[Tolerance("Shaft 1", fork_offset="5 %")]),
        "tolerance of Shaft 1.fork_offset = 0.05: is a share of nothing: Shaft 1 states zero",
        "deg",
    ),
    (
        lambda: line(tolerances=[Tolerance("Shaft 1", stiffness="20 kN*m/rad")]),
        "tolerance of Shaft 1.stiffness = '20 kN*m/rad': lets Shaft 1 reach -10000 N*m/rad, which must be",
        "narrow the tolerance",
    ),
    (
        lambda: line(tolerances=[Tolerance("Disk 1", inertia=0.1), Tolerance("Disk 1", inertia=0.2)]),
        "tolerance of Disk 1.inertia = 0.2: is stated twice",
        "leave one",
    ),
    (lambda: line(tolerances={"of": "Shaft 1"}), "driveline.tolerances = ", "tn.Tolerance("),
    (lambda: line(tolerances=[3]), "driveline.tolerance 1 = 3: is not a tolerance", "tn.Tolerance("),
    (lambda: tn.tolerance_study(line(), speeds=10.0), "driveline.tolerances: are not stated", "[[tolerance]]"),
    # questions about a line or a system
    (
        lambda: tn.System.from_function(
            lambda t, x, p: (x[1], -x[0]),
            ("x", "v"),
            jacobian=lambda t, x, p: [[0, 1], [1, 0]],
            start=(0.5, 0),
            compiled=False,
        ),
        "<lambda>.jacobian: says ∂(v')/∂x = 1 where differences give -1",
        "row 2, column 1",
    ),
    (lambda: tn.run_up(line(), 10, 20, acceleration=5, ramp=9.0), "run_up.ramp = 9: does not fit", "0 to 4 s"),
    (lambda: tn.run_up(line(), 10, 20, acceleration=5, ramp=-1.0), "run_up.ramp = -1: does not fit", "0 to 4 s"),
    # free–free lines
    (
        lambda: tn.stability(free(load_torque=-5.0), 40.0),
        "driveline.load_torque: is free–free and its torques do not balance: the loads add up to 9 N m",
        'load_torque = "-9 N*m"',
    ),
    (
        lambda: tn.run_up(free(load_torque=-9.0), 30, 40, acceleration=5),
        "driveline.drive_share: is free–free, and no disk has a share",
        "drive_share = 1",
    ),
    (
        lambda: torque(time=[0, 1, 0.5], torque=[0, 1, 2]),
        "torque on pump.time = [0, 1, 0.5]: does not rise at point 3",
        "put the lowest",
    ),
    (
        lambda: torque(time=[0, 1, 1, 1], torque=[0, 1, 2, 3]),
        "torque on pump.time = [0, 1, 1, 1]: does not rise at point 3",
        "twice where the torque jumps",
    ),
    (
        lambda: torque(speed=[0, 9, 9], torque=[0, 1, 2]),
        "torque on pump.speed = [0, 9, 9]: does not rise at point 3",
        "put the lowest first, each once",
    ),
    (
        lambda: torque(time=["0 s", "1 rpm"], torque=[0, 1]),
        "torque on pump.time = ['0 s', '1 rpm']: rpm is not the unit of a time (s)",
        "such as",
    ),
    (lambda: torque(time=[0.0], torque=[1]), "torque on pump.time = [0.0]: has one point only", "two or more"),
    (
        lambda: torque(time=[0, 1], torque=[1]),
        "torque on pump.torque = [1]: must have one value for each of 2 points, and has 1",
        "one torque for each",
    ),
    (lambda: torque(), "torque on pump.torque: has neither time, speed nor angle", "give one of time, speed and angle"),
    (
        lambda: torque(time=[0, 1], speed=[0, 1], torque=[1, 2]),
        "torque on pump.torque = [1, 2]: goes over time and speed",
        "or two, and a table",
    ),
    (
        lambda: torque(time=[0, 1], table=[[1, 2]]),
        "torque on pump.table = [[1, 2]]: goes over two variables",
        "give two of",
    ),
    (
        lambda: torque(time=[0, 1], speed=[0, 1], table=[[1, 2]]),
        "torque on pump.table = [[1, 2]]: must have 2 rows of 2 torques",
        "one row for each time",
    ),
    (
        lambda: torque(time=[0, 1], speed=[0, 1], table=[[1, 2], [1, 2]], between="cubic"),
        "torque on pump.between = 'cubic': belongs to a table of one variable",
        "lines",
    ),
    (
        lambda: torque(time=[0, 1], table=1.0),
        "torque on pump.table = 1: is not a list of rows of torques",
        "write table",
    ),
    (
        lambda: torque(speed=[0, 1], torque=[1, 2], between="steps"),
        "torque on pump.between = 'steps': goes over time alone",
        "lines",
    ),
    (
        lambda: torque(speed=[0, 1], torque=[1, 2], between="line"),
        "torque on pump.between = 'line': is not a way between points",
        "lines",
    ),
    (
        lambda: torque(time=[0, 1], torque=[1, 2], factor=[1, 2]),
        "torque on pump.factor = [1, 2]: belongs to motors",
        "multiply",
    ),
    (
        lambda: torque(breakdown_torque=9.0),
        "torque on pump.breakdown_slip: is needed with breakdown_torque",
        "needed are",
    ),
    (
        lambda: torque(**OF_A_MOTOR, torque=[1.0]),
        "torque on pump.torque = [1.0]: conflicts with breakdown_torque",
        "leave one",
    ),
    (
        lambda: torque(**OF_A_MOTOR | {"breakdown_slip": 1.5}),
        "torque on pump.breakdown_slip = 1.5: must lie between 0 and 1",
        "0.2",
    ),
    (
        lambda: torque(**OF_A_MOTOR | {"synchronous_speed": -1.0}),
        "torque on pump.synchronous_speed = -1: must be positive",
        "",
    ),
    (
        lambda: torque(**OF_A_MOTOR, factor=[0.5]),
        "torque on pump.factor = [0.5]: must have one value for each of 0 points of time, and has 1",
        "one share",
    ),
    (lambda: tn.FrictionTorque(on="pump", torque=-1.0), "friction on pump.torque = -1: must not be negative", ""),
    (
        lambda: tn.FrictionTorque(on="pump", torque=2.0, static=1.0),
        "friction on pump.static = 1: is less than in motion",
        "2 N m",
    ),
    (lambda: tn.LevelCrossing(of="pump"), "crossing of pump.speed: watches nothing", "give one of"),
    (
        lambda: tn.LevelCrossing(of="pump", speed=1.0, angle=2.0),
        "crossing of pump.angle = 2: watches speed and angle",
        "give one of",
    ),
    (
        lambda: tn.LevelCrossing(of="pump", speed=1.0, direction="up"),
        "crossing of pump.direction = 'up': is not a direction",
        "rising",
    ),
    (lambda: tn.Scenario(name="a", duration=0.0), "scenario a.duration = 0: must be positive", "4 s"),
    (
        lambda: free().but(scenarios=2 * [tn.Scenario(name="a", duration=1.0)]),
        "driveline.scenario = 'a': is the name of two scenarios",
        "rename",
    ),
    (
        lambda: free().but(
            scenarios=[tn.Scenario(name="a", duration=1.0, crossing=[tn.LevelCrossing(of="pomp", speed=1)])]
        ),
        "scenario a, crossing.of = 'pomp': is not a Disk",
        "pump",
    ),
    (
        lambda: tn.transient(free(), 1.0, crossing=[tn.LevelCrossing(of="pump", torque=1)], speed=9.0),
        "crossing.of = 'pump': is not a spring",
        "Shaft",
    ),
    (lambda: free().scenario("start"), "scenario = 'start': is not a scenario of this driveline", "write [[scenario]]"),
    (
        lambda: tn.transient(free(), 1.0, torque=[torque(speed=[20, 30], torque=[0, 1])], speed=9.0),
        "run: ends where it begins: stopped at t = 0 s: the speed of",
        "extend it",
    ),
    (
        lambda: tn.transient(free(), 1.0, torque=[torque(formula="log(0)")], speed=9.0),
        "run: ends where it begins: stopped at t = 0 s, where the formula 'log(0)'",
        "look for roots",
    ),
    (lambda: tn.transient(free(), speed=9.0), "duration: must be a positive time", "name of a scenario"),
    (lambda: tn.transient(free(), 1.0, torque=["x"], speed=9.0), "torque = 'x': is not a list of", "tn.AppliedTorque"),
    (
        lambda: tn.transient(free(), tn.Scenario(name="a", duration=1.0), torque=[torque(**OF_A_MOTOR)], speed=9.0),
        "scenario = 'a': already says what acts",
        "give a duration",
    ),
    (
        lambda: tn.transient(free(), 2.0, torque=[torque(time=[0, 1], torque=[0, 1])], speed=9.0),
        "torque on pump.time: says nothing from t = 0 to 2 s, for its table goes from 0 to 1 s",
        "hold = true",
    ),
    (
        lambda: tn.transient(line(), 1.0, speed=0.0),
        "speed = 0: is prescribed by a ConstantSpeed and must be positive",
        "leave out the ConstantSpeed",
    ),
    (
        lambda: tn.transient(
            line(ConstantSpeed(), Disk(name="fixed", inertia=1.0), Shaft(stiffness=1e4), Disk(inertia=1)),
            1.0,
            torque=[tn.AppliedTorque(on="fixed", time=[0, 1], torque=[1, 1])],
            speed=9.0,
        ),
        "torque.on = 'fixed': moves nothing",
        "a disk behind a spring",
    ),
    (
        lambda: tn.transient(
            free(drive_share=1).replace("pump", drive_share=1.0),
            1.0,
            speed=9.0,
            torque=[tn.AppliedTorque(on="engine", time=[0, 1], torque=[1, 1])],
        ),
        "pump.drive_share: shares the drive with engine",
        "give pump a torque too",
    ),
    (
        lambda: tn.passing(free(), (9.0, 5.0), torque=[torque(**KLOSS)]),
        "speeds = [9.0, 5.0]: must be two rising speeds",
        "0 rpm",
    ),
    (lambda: tn.passing(free(), (5.0, 9.0), torque=[]), "torque: is missing", "tn.AppliedTorque"),
    (lambda: tn.PulseTrain([0.1, 0.3, 0.2], 1), "pulses.times = 0.2: must rise", "take each once"),
    (lambda: tn.PulseTrain([0.1, 0.2], 0), "pulses.pulses_per_turn = 0: must be a whole number", "1 or more"),
    (lambda: tn.PulseTrain([0.1, 0.2], 9), "pulses.times = 2: holds less than two turns of 9 pulses", "record longer"),
    (lambda: tn.PulseTrain(np.arange(9.0), 2, pitch_error=0.7), "pulses.pitch_error = 0.7: must be a share", "2 %"),
    (lambda: tn.SampledSignal([1.0, 2.0], 0.0), "signal.rate = 0: must be positive", "Hz"),
    (lambda: tn.SampledSignal([1.0, 2.0], 1.0, kind="torqe"), "signal.kind = 'torqe': is not a kind", '"torque"'),
    (
        lambda: tn.SampledSignal([1.0, np.nan], 1.0),
        "signal.values: has no number in 1 sample",
        "cut the gap out",
    ),
    (lambda: tn.Measurement([]), "measurement.channels: has no channel", "one or more"),
    (lambda: tn.Measurement([wheel(), wheel()]), "measurement.name = 'wheel': is the name of two", "name each"),
    (lambda: tn.track_orders(tn.Measurement([gauge()])), "measurement = '': has no pulse train", 'kind = "pulses"'),
    (lambda: tn.track_orders(tn.Measurement([wheel()]), [15]), "orders = 15: is not seen by wheel", "lower orders"),
    (lambda: tn.track_orders(tn.Measurement([wheel()]), [0]), "orders = [0.0]: must be positive", "[1, 2, 4]"),
    (
        lambda: tn.track_orders(tn.Measurement([wheel()]), [1], between=(33.0, 99.0)),
        "between = [33.0, 99.0]: is outside the recording, 0 to 19.99 s",
        "rising times",
    ),
    (lambda: benched(duration=0.0), "duration = 0: must be positive", "in seconds"),
    (lambda: benched(speeds=-5.0), "speeds = -5: must be positive", "tn.rpm(1500)"),
    (lambda: benched(jitter=-1e-6), "jitter = -1e-06: must not be negative", "0 for none"),
    (lambda: benched(missing=0.5), "missing = 0.5: must be a share below 0.2", "0.001"),
    (lambda: benched(pickups={"hob": 30}), "pickups = 'hob': is not a disk of the line", '"hub"'),
    (lambda: benched(pickups={"hub": 1}), "pickups.hub = 1: must be a whole number", "2 or more"),
    (lambda: benched(gauges=["tubes"]), "gauges = 'tubes': is not a spring of the line", '"tube"'),
    (lambda: tn.compare_measured(*tracked("hob")), "CH1.at = 'hob': is not a disk of the line", '"hub"'),
    (lambda: tn.compare_measured(*tracked("input")), "data: shows no place of the line that moves", 'at = "hub"'),
    (lambda: tn.compare_measured(*tracked()).plot(channel="hub"), "channel = 'hub': is not a channel", "there are CH1"),
    (lambda: identified({"tube.stifness": (1e4, 4e4)}), "tube.stifness: is not a parameter", '"tube.stiffness"'),
    (lambda: identified({"tube.stiffness": (4e4, 1e4)}), "tube.stiffness = (40000.0, 10000.0): must be", "free={"),
    (lambda: identified({}), "free: must name one parameter or more", "free={"),
    (lambda: identified({"tube.stiffness": (1e4, 4e4)}, seed=-1), "seed = -1: must be a whole number", "0 or more"),
    (lambda: tn.pitch_errors(tn.Measurement([gauge()])), "reference: has no pulse train", "wheels"),
    (lambda: rotated().cut(3, "wheel"), "order = 3: was not tracked", "there are 1"),
    (lambda: rotated().cut(1, "weel"), "channel = 'weel': is not a channel", '"wheel"'),
    (
        lambda: tn.vold_kalman(gauge(), rotated().rotation, [1], bandwidth=-1),
        "bandwidth = -1: must be positive",
        "",
    ),
    (
        lambda: tn.vold_kalman(gauge(), rotated().rotation, [60]),
        "gauge.rate = 100: is too low for order 60",
        "record faster",
    ),
    (
        lambda: tn.synchronous_average(gauge(), rotated().rotation, turns=90),
        "gauge.turns = 90: does not repeat within the recording",
        "record longer",
    ),
    (
        lambda: tn.measured_order_map(wheel(), rotated().rotation, highest=15.0),
        "wheel.highest = 15: is not seen by 20 pulses a turn",
        "below 10",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("factor", 1.0, 2.0, 9_000), ("pump.inertia", 1.0, 2.0, 9_000), torque=[torque(**KLOSS)]
        ),
        "y = 9000: would need 12.1 GB of memory",
        "ask for fewer values of x or y",
    ),
    (lambda: tn.Scenario(name="a", duration=1, per_hour=0), "scenario a.per_hour = 0: must be positive", "write 0.5"),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("speed", 1.0, 2.0, 2), ("factor", 1.0, 2.0, 2), torque=[torque(**KLOSS)]
        ),
        "x = 'speed': is the parameter that the line runs through",
        "another parameter",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("pump.inertia", 1.0, 2.0, 2), ("pump.inertia", 1.0, 2.0, 2), torque=[torque(**KLOSS)]
        ),
        "y = 'pump.inertia': is varied twice",
        "another parameter",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("pump.inertia", 1.0, 2.0, 2), ("factor", 0.0, 2.0, 2), torque=[torque(**KLOSS)]
        ),
        "y = ['factor', 0.0, 2.0, 2]: must rise from above 0",
        "12), say",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("pump.inertia", -1.0, 2.0, 2), ("factor", 1.0, 2.0, 2), torque=[torque(**KLOSS)]
        ),
        "pump.inertia = -1",
        "",
    ),
    (
        lambda: tn.capture_map(
            free(),
            (5.0, 9.0),
            ("pump.inertia", 1.0, 2.0, 2),
            ("factor", 1.0, 2.0, 2),
            torque=[torque(**KLOSS)],
            phases=0,
        ),
        "phases = 0: must be a whole number, 1 or more",
        "",
    ),
    (
        lambda: tn.capture_map(
            free(),
            (5.0, 9.0),
            ("pump.inertia", 1.0, 2.0, 2),
            ("factor", 1.0, 2.0, 2),
            torque=[torque(**KLOSS)],
            drive="engine",
        ),
        "drive = 'engine': is given no torque",
        "torques act on pump",
    ),
    (
        lambda: tn.capture_map(
            free(),
            (5.0, 9.0),
            ("pump.inertia", 1.0, 2.0, 2),
            ("factor", 1.0, 2.0, 2),
            torque=[torque(**KLOSS), tn.AppliedTorque(on="engine", **KLOSS)],
        ),
        "drive: is missing, for torques act on several disks",
        "name pump, engine",
    ),
    (lambda: studied(analysis="stabilty"), "analysis = 'stabilty': is not an analysis", 'did you mean "stability"?'),
    (lambda: studied(analysis="basins"), "analysis = 'basins': needs more than a driveline", "take assess"),
    (
        lambda: studied(arguments={"tolerence": 1e-6}),
        "arguments.tolerence = 1e-06: is not an argument of stability",
        'did you mean "tolerance"?',
    ),
    (
        lambda: studied(quantities=["growth_rat"]),
        "quantities = 'growth_rat': is not a quantity of Stability",
        'did you mean "growth_rate"?',
    ),
    (
        lambda: studied(quantities=["multipliers"]),
        "multipliers: is not a number, word or verdict but an array of shape (2,)",
        'write "multipliers.max", or "multipliers[0]"',
    ),
    (lambda: studied(quantities=[]), "study.quantities: are missing", 'write quantities = ["verdict"]'),
    (
        lambda: studied(parameter=[{**ANGLES, "path": "HookeJoint 1.angel"}]),
        "HookeJoint 1.angel: is not a parameter of this driveline",
        'did you mean "HookeJoint 1.angle"?',
    ),
    (lambda: studied(parameter=[]), "study.parameter: is empty", "write [[parameter]]"),
    (
        lambda: studied(parameter=[{"path": "HookeJoint 1.angle", "values": []}]),
        "parameter HookeJoint 1.angle.values: is empty",
        "give one value or more",
    ),
    (
        lambda: studied(parameter=[{**ANGLES, "points": 0}]),
        "parameter HookeJoint 1.angle.points = 0: must be a whole number from 1",
        "write points = 50",
    ),
    (
        lambda: studied(parameter=[{**ANGLES, "high": "1 deg"}]),
        "parameter HookeJoint 1.angle.high = '1 deg': must be above low",
        "exchange the two",
    ),
    (
        lambda: studied(parameter=[{**ANGLES, "high": "2 kN"}]),
        "parameter HookeJoint 1.angle.high = '2 kN'",
        "angle",
    ),
    (
        lambda: studied(parameter=[{**ANGLES, "high": "95 deg"}]),
        "parameter.HookeJoint 1.angle: would reach 1.65806, which no line can have",
        "narrow its range",
    ),
    (
        lambda: studied(parameter=[{"path": "HookeJoint 1.angle"}]),
        "parameter 1 HookeJoint 1.angle: needs low and high, or values, or a tolerance",
        "write path",
    ),
    (
        lambda: studied(parameter=[ANGLES, ANGLES]),
        "parameter.path = 'HookeJoint 1.angle': varies HookeJoint 1.angle, as",
        "once",
    ),
    (
        lambda: studied(parameter=[{"path": "Disk 1.inertia", "tolerance": "5 %"}]),
        "study.sampling: is missing",
        "write [sampling]",
    ),
    (lambda: studied(sampling={"points": 8}), "study.sampling: has no parameter to sample", "leave it out"),
    (
        lambda: studied(sampling={"method": "sobl", "points": 8}),
        "sampling.method = 'sobl': is not a sampling",
        'did you mean "sobol"?',
    ),
    (
        lambda: studied(sampling={"method": "saltelli", "points": 100}),
        "sampling.points = 100: must be a power of two",
        "write 128",
    ),
    (
        lambda: studied(tolerances=True),
        "study.tolerances = True: asks for tolerances, and the line states none",
        "[[tol",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rat"}),
        "boundary.quantity = 'growth_rat': is not a quantity of the study",
        'did you mean "growth_rate"?',
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "value": "unstable"}),
        "boundary.value = 'unstable': belongs to words and verdicts, and growth_rate is a number",
        "write level = 0.0",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "level": "3 mm"}),
        "boundary.level = '3 mm': must have no unit",
        "write a plain number",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "noise": -1.0}),
        "boundary.noise = -1: must not be negative",
        "leave it out",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "halvings": 0}),
        "boundary.halvings = 0: must be a whole number from 1 to 20",
        "write halvings",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "halvings": 20}, parameter=[{**ANGLES, "points": 40}]),
        "boundary.halvings = 20: make a grid too fine to count its points",
        "take fewer",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "most": 1.5}),
        "boundary.most = 1.5: must be a whole number",
        "write most",
    ),
    (
        lambda: studied(quantities=["verdict"], boundary={"quantity": "verdict"}),
        "boundary.value: is missing",
        'write value = "unstable"',
    ),
    (
        lambda: studied(quantities=["verdict"], boundary={"quantity": "verdict", "value": "unstabel"}),
        "boundary.value = 'unstabel': is nothing that verdict can be",
        'did you mean "unstable"?',
    ),
    (
        lambda: studied(quantities=["verdict"], boundary={"quantity": "verdict", "level": 0.0}),
        "boundary.level = 0: belongs to a number, and verdict is not one",
        'write value = "unstable"',
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate"}, parameter=[STATED_ANGLES]),
        "boundary.quantity = 'growth_rate': has no grid to refine",
        "give a parameter low, high and 2 points or more",
    ),
    (
        lambda: studied(boundary={"quantity": "growth_rate", "halving": 3}),
        "boundary.halving = 3: unknown key",
        'did you mean "halvings"?',
    ),
    (lambda: studied(block=0), "study.block = 0: must be a whole number from 1", "write block"),
    (lambda: studied(parametr=[]), "study.parametr = []: unknown key", 'did you mean "parameter"?'),
    (
        lambda: studied(line="two-shaft-carden", given=False),
        "study.line = 'two-shaft-carden': is neither a file nor a name of the catalogue",
        'did you mean "two-shaft-cardan"?',
    ),
    (lambda: studied(line="gear-rattle", given=False), "study.line = 'gear-rattle': is not a driveline", "two-shaft"),
    (
        lambda: tn.tolerance_study(line(), {"Shaft 1.stiffness": 0.1}, 10.0, client="tcp://far:1"),
        "client = 'str': is not a client of Dask",
        "give a distributed.Client",
    ),
    (
        lambda: tn.study({}, workers=1, scheduler="tcp://far:1"),
        "workers and scheduler: are two ways to compute",
        "give one",
    ),
    (
        lambda: tn.least_drive(free(), (5.0, 9.0), torque=[torque(**KLOSS)], factors=(2.0, 1.0)),
        "factors = [2.0, 1.0]: must be two rising positive numbers",
        "(0.5, 2.0)",
    ),
    (
        lambda: tn.least_acceleration(free(), (5.0, 9.0), (2.0, 1.0), drive="pump"),
        "accelerations = [2.0, 1.0]: must be two rising positive numbers",
        "(0.5, 2.0)",
    ),
    (
        lambda: tn.least_acceleration(free(), (5.0, 9.0), (1.0, 2.0), drive="pumpe"),
        "drive = 'pumpe': is not a disk of this line",
        "it has",
    ),
    (
        lambda: tn.least_drive(free(), (5.0, 9.0), torque=[torque(**KLOSS)], around=20_000),
        "around = 20000: are too many",
        "at most 10000",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("pump.inertia", 1.0, 2.0, 2), ("factor", 1.0, 2.0, 2), torque=[torque(**KLOSS)],
            store=os.devnull,
        ),
        f"store = {os.devnull!r}: is not a folder",
        "name a new folder",
    ),
    (
        lambda: tn.capture_map(
            free(), (5.0, 9.0), ("pump.inertia", 1.0, 2.0, 2), ("factor", 1.0, 2.0, 2), store="never made",
            torque=[tn.TorqueFunction(on="pump", function=lambda t, speed, angle: 1.0, until=1.0)],
        ),
        "torque on pump.store: is a function",
        "write a formula",
    ),
    (
        lambda: tn.least_drive(free(), (5.0, 9.0), torque=[torque(**KLOSS)], accuracy=0.0),
        "accuracy = 0: must lie between 1e-12 and 1",
        "0.01, say",
    ),
    (
        lambda: torque(time=[0, 1], torque=[0, 1], corner_frequency=0.0),
        "torque on pump.corner_frequency = 0: must be positive",
        'write "200 rad/s", say',
    ),
    (
        lambda: tn.passing(free(), (5.0, 9.0)),
        "torque: is missing",
        "or a Motor in the line",
    ),
    (
        lambda: tn.transient(line(engine(), Shaft(stiffness=1e4), Generator(inertia=1.0, power=1e3)), 1.0, speed=0.0),
        "Generator 1.power = 1000: takes constant power, which has no torque at standstill",
        "start at a positive speed",
    ),
    (
        lambda: tn.transient(line(motor(gain=9.0, drive_share=1), Shaft(stiffness=1e4), PUMP), 1.0, speed=0.0),
        "motor.drive_share = 1: is set by its converter to the speed at which the run begins",
        "leave out drive_share",
    ),
    (
        lambda: tn.transient(
            line(motor(gain=9.0, torque_limit=5.0, drive_share=1), Shaft(stiffness=1e4), fan(load_torque=9.0)),
            1.0,
            speed=9.0,
        ),
        "motor.torque_limit = 5: would have to drive with",
        "raise it, or lower the load",
    ),
    (
        lambda: tn.transient(
            line(engine(), Shaft(stiffness=1e4), propeller(damping_factor=3.0, quadratic_load=9.0)), 1.0, speed=9.0
        ),
        "propeller.damping_factor = 3: holds about one mean speed, which changes here",
        "leave it out",
    ),
    (
        lambda: torque(formula="__import__('os')"),
        "torque on pump.formula = \"__import__('os')\": cannot be read at character 12",
        "write numbers",
    ),
    (lambda: torque(formula="open(t)"), "torque on pump.formula = 'open(t)': calls open, which is not", "sin"),
    (lambda: torque(formula="x"), "torque on pump.formula = 'x': says x, which is not a name that it knows", "angle"),
    (lambda: torque(formula="min(t)"), "torque on pump.formula = 'min(t)': has a wrong number of", "min takes 2"),
    (lambda: torque(formula="1e999"), "torque on pump.formula = '1e999': has a number beyond 1e308", "smaller"),
    (
        lambda: torque(formula="step(speed)"),
        "torque on pump.formula = 'step(speed)': jumps where the speed does",
        "tanh",
    ),
    (
        lambda: torque(formula="t+" * 3000),
        "torque on pump.formula = 't+t+",
        "has more than 4000 characters; write a table",
    ),
    (lambda: torque(formula=3), "torque on pump.formula = 3: is not text", "write formula"),
    (
        lambda: torque(formula="-" * 99 + "t"),
        "torque on pump.formula = '---",
        "write it shorter",
    ),
    (lambda: torque(formula="t", time=[0, 1]), "torque on pump.time = [0, 1]: conflicts with formula", "leave one"),
    (
        lambda: torque(formula="t", between="cubic"),
        "torque on pump.between = 'cubic': belongs to tables",
        "leave it out beside formula",
    ),
    (
        lambda: torque(formula="t", since=2, until=1),
        "torque on pump.until = 1: must lie behind since",
        "leave it out, or raise it",
    ),
    (
        lambda: torque(time=[0, 1], torque=[0, 1], since=2),
        "torque on pump.since = 2: belongs to a formula",
        "put it into the points of time",
    ),
    (
        lambda: tn.passing(free(), (5.0, 9.0), torque=[torque(formula="sin(t)")]),
        "torque on pump.until: goes on changing with time",
        "say until when",
    ),
    (
        lambda: tn.transient(
            free(), 1.0, torque=[tn.TorqueFunction(on="pump", function=lambda t, w, a: "x")], speed=9.0
        ),
        "torque.function = 'str': gives no number",
        "let it return the torque in N m",
    ),
    (lambda: disturbance(case="earthquake"), "disturbance on pump.case = 'earthquake': is not a case", "tip-in"),
    (
        lambda: disturbance(case="tip-in", first=1, last=2),
        "tip-in on pump.rise: is missing",
        "needed are first, last, rise",
    ),
    (
        lambda: disturbance(case="tip-in", first=1, last=2, rise=0.1, fall=0.1),
        "tip-in on pump.fall = 0.1: belongs to another case",
        "it takes first, last, rise",
    ),
    (
        lambda: disturbance(case="tip-in", first=1, last=2, rise=-0.1),
        "tip-in on pump.rise = -0.1: must not be negative",
        "",
    ),
    (lambda: disturbance(**FAULT | {"decay": 0}), "three-phase short circuit on pump.decay = 0: must be positive", ""),
    (
        lambda: disturbance(**FAULT, since=2, until=1),
        "three-phase short circuit on pump.until = 1: must lie behind since",
        "times count from t = 0",
    ),
    (
        lambda: disturbance(case="synchronous start", frequency=9, pole_pairs=2, speeds=[1, 2], amplitudes=[1]),
        "synchronous start on pump.amplitudes = [1]: must have one value for each of 2 speeds, and has 1",
        "one for each speed",
    ),
    (
        lambda: disturbance(case="synchronous start", frequency=9, pole_pairs=2, speeds=[2, 1], amplitudes=[1, 1]),
        "synchronous start on pump.speeds = [2, 1]: does not rise at point 2",
        "put the lowest first",
    ),
    (
        lambda: disturbance(
            case="synchronous start", frequency=9, pole_pairs=2, speeds=range(20), amplitudes=range(20)
        ),
        "synchronous start on pump.speeds = range(0, 20): are more than 16",
        "give fewer points",
    ),
    (
        lambda: disturbance(case="impacts", peaks=[1, 1], width=0.2, spacing=0.1),
        "impacts on pump.spacing = 0.1: is less than width",
        "must not overlap",
    ),
    (
        lambda: tn.transient(free(), 1.0, disturbance=["x"], speed=9.0),
        "disturbance = 'x': is not a list of Disturbance",
        "tn.Disturbance",
    ),
    (
        lambda: torque(breakdown_torque=1, breakdown_slip=0.2, synchronous_speed=-5),
        "torque on pump.synchronous_speed = -5: must be positive",
        "write its magnitude",
    ),
    (
        lambda: tn.FrictionTorque(on="pump", torque=-5),
        "friction on pump.torque = -5: must not be negative",
        "write its magnitude",
    ),
    (
        lambda: tn.LevelCrossing(of="pump", speed=1, ends="no"),
        "crossing of pump.ends = 'no': is neither true nor false",
        "without quotes",
    ),
    (lambda: torque(power=9.0), "torque on pump.speed: must be two positive speeds beside power", "100 rpm"),
    (
        lambda: torque(power=9.0, speed=[1, 2], torque=[1, 2]),
        "torque on pump.torque = [1, 2]: conflicts with power",
        "leave one of the two out",
    ),
    (
        lambda: torque(power=9.0, speed=[1, 2], between="cubic"),
        "torque on pump.between = 'cubic': belongs to tables",
        "leave it out beside power",
    ),
    (
        lambda: tn.passing(
            line(ConstantSpeed(), Shaft(stiffness=1e4), Disk(inertia=1, name="pump")),
            (5.0, 9.0),
            torque=[torque(**KLOSS)],
        ),
        "driveline.ConstantSpeed: prescribes the speed, so that nothing can capture",
        "leave it out",
    ),
    (
        lambda: tn.safe_accelerations(free(drive_share=1), 30, 40, limit=9.0, accelerations=(1, 2), points=1),
        "points = 1: must be a whole number from 2",
        "13, say",
    ),
    (
        lambda: tn.order_map(tn.simulate(free(load_torque=0.0), 6.0, speed=20.0), window=1),
        "order map.run: has no orders: the line turns back at t = ",
        "start at a higher speed",
    ),
    (
        lambda: tn.simulate(
            free(load_torque=-5.0, excitation=[{"order": 2, "speeds": [40, 60], "amplitudes": [1, 2]}]), 1.0, speed=30.0
        ),
        "engine.excitation 1: is a table from 381.972 rpm to 572.958 rpm, which does not cover 286.48 rpm",
        "extend the table",
    ),
    (
        lambda: tn.exact_motion(unbalanced(), 1.0, speed=30.0),
        "driveline.load_torque: is free–free and its torques do not balance, so that it leaves the speed",
        "use tn.simulate",
    ),
    (
        lambda: tn.sweep(unbalanced(), [30.0, 40.0]),
        "driveline.load_torque: is free–free and its torques do not balance, so that it leaves the speed",
        "drive_share = 1",
    ),
    (
        lambda: tn.stability_chart(
            tn.Driveline([*free(drive_share=1).elements, with_play(), tn.Disk(inertia=0.3, load_torque=20.0)]),
            ("speed", 30, 60, 3), ("pump.inertia", 0.4, 0.6, 3),
        ),
        "driveline: is judged about its own periodic motion, and it has stages or play besides",
        "stability at single speeds",
    ),
    (
        lambda: tn.stability_chart(
            tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]),
            ("speed", 10, 20, 3), ("Disk 1.inertia", 0.5, 1.0, 3), about_steady_state=True,
        ),
        "driveline.about_steady_state = True: has straight joints",
        "leave it out",
    ),
    (
        lambda: tn.stability(
            tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]), 10.0,
            about_steady_state=True,
        ),
        "driveline.about_steady_state = True: has straight joints",
        "leave it out",
    ),
    (
        lambda: tn.tolerance_study(
            tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]),
            {"Shaft 1.stiffness": 0.1}, 10.0, about_steady_state=True,
        ),
        "driveline.about_steady_state = True: has straight joints",
        "leave it out",
    ),
    (
        lambda: tn.tolerance_study(
            tn.Driveline([
                tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), with_play(), tn.Disk(inertia=0.3, load_torque=20.0),
            ]),
            {"Disk 1.inertia": 0.1}, 30.0, about_steady_state=True,
        ),
        "driveline: is judged about its own periodic motion, and it has stages or play besides",
        "leave about_steady_state out",
    ),
    (
        lambda: tn.sensitivity(
            tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]), 10.0,
            about_steady_state=True,
        ),
        "driveline.about_steady_state = True: has straight joints",
        "leave it out",
    ),
    (
        lambda: tn.sensitivity(free(drive_share=1), 30.0, of=["frequencies"], about_steady_state=True),
        "about_steady_state = True: belongs to growth rates",
        "leave it out",
    ),
    (
        lambda: tn.stability_chart(
            tn.PeriodicLinearFamily(np.pi, lambda tau, a: (np.eye(1), np.eye(1), np.eye(1)), 1, {"a": 1.0}),
            ("a", 0.0, 1.0, 3), ("a", 0.0, 1.0, 3), about_steady_state=True,
        ),
        "about_steady_state = True: belongs to drivelines",
        "leave it out",
    ),
    (
        lambda: tn.stable_limit(
            tn.Driveline([*free(drive_share=1).elements, with_play(), tn.Disk(inertia=0.3, load_torque=20.0)]),
            "HookeJoint 1.angle", [30, 40],
        ),
        "driveline: is judged about its own periodic motion, and it has stages or play besides",
        "stability at single speeds",
    ),
    (
        lambda: tn.harmonic_balance(free(drive_share=1), "speed", 30, 40),
        "driveline: is free–free",
        "periodic_branch",
    ),
    (
        lambda: tn.lyapunov_spectrum(free(drive_share=1), 20, speed=30.0),
        "driveline: is free–free: its speed follows from its torques",
        "simulate it",
    ),
    (
        lambda: tn.periodic_response(free(drive_share=1, excitation=[{"frequency": 10.0, "amplitude": 1.0}]), 30.0),
        "driveline: is free–free and is excited in time",
        "orders instead of frequencies",
    ),
    (
        lambda: tn.linearity_check(free(drive_share=1), 30.0, allowed=1.5),
        "allowed = 1.5: must be between 0 and 1",
        "0.05 is 5 %",
    ),
    (
        lambda: tn.linearity_check(free(drive_share=1), 30.0, "hill"),
        "load_case = 'hill': is not a load case",
        "there are none",
    ),
    (lambda: tn.linearity_check(free(drive_share=1)), "operation.speed: is not given", "pass a speed"),
    # quantities
    (
        lambda: HookeJoint(angle="12 kg"),
        "HookeJoint.angle = '12 kg': kg is not the unit of an angle",
        '"12 deg"',
    ),
    (lambda: Shaft(stiffness="2e4 N*m"), "Shaft.stiffness = '2e4 N*m': N*m is not", "write N*m/rad"),
    (
        lambda: Shaft(outer_diameter=0.1, length=1, material="stel"),
        "Shaft.material = 'stel': is not a known",
        '"steel"',
    ),
    (lambda: Shaft(stiffness=1e4, material="steel"), "Shaft.material = 'steel': conflicts with stiffness", "leave out"),
    (lambda: Shaft(material="steel"), "Shaft.outer_diameter: is needed with material", "outer_diameter, length"),
    (lambda: Disk(mass="2 t"), "Disk.radius: is needed with mass", "mass, radius"),
    (lambda: Disk(mass="2 t", radius=0.3, density=7850), "Disk.density = 7850: conflicts with mass", "leave out"),
    (lambda: Disk(mass="2 kg*m^2", radius=0.3), "Disk.mass = '2 kg*m^2': kg*m^2 is not", '"1800 kg"'),
    (lambda: Coupling(relative_damping=1), "Coupling.stiffness: is missing", "relative_damping = 1.13"),
    (
        lambda: Coupling(stiffness=1, relative_damping=1, loss_factor=0.1),
        "Coupling.relative_damping = 1: conflicts with loss_factor",
        "ψ/2π",
    ),
    (
        lambda: Coupling(stiffness=1, relative_damping=1, damping=1),
        "Coupling.damping = 1: conflicts with relative_damping",
        "leave one",
    ),
    (lambda: Coupling(stiffness=1, nominal_torque=0), "Coupling.nominal_torque = 0: must be positive", "N*m"),
    (lambda: Coupling(stiffness=1, length=1), "Coupling.length", "unknown"),
    (lambda: Shaft(stiffness="2e4 Nm"), "Shaft.stiffness = '2e4 Nm': Nm is not", "write N*m/rad"),
    (lambda: Shaft(stiffness=1, damping="3 N*m*s"), "Shaft.damping = '3 N*m*s': ", "write N*m*s/rad"),
    (lambda: Operation(speed="1500 1/min"), "operation.speed = '1500 1/min': ", '"1500 rpm"'),
    (
        lambda: engine(firing_intervals=["180 deg", "-180 deg", "360 deg", "360 deg"]),
        "Engine.firing_intervals = ['180 deg', '-180 deg', '360 deg', '360 deg']: must not be negative",
        "crank angle from each firing",
    ),
    (
        lambda: Driveline(
            [ConstantSpeed(), Shaft(stiffness=1e4), Disk(inertia=1), planetary(name="set"), Disk(inertia=1)],
            limits=[tn.Limit(of="set", max_torque=5)],
        ),
        "limit of set.max_torque = '5 N m': needs the elastic teeth of a Planetary",
        "or limit the shafts on it",
    ),
    (lambda: ViscousDamper(ring_inertia=1), "ViscousDamper.damping: is missing", "45 N*m*s/rad"),
    (lambda: ViscousDamper(ring_inertia=1, oil=OIL), "ViscousDamper.oil_frequency: is needed with oil", "60 Hz"),
    (
        lambda: ViscousDamper(ring_inertia=1, damping=1, oil=OIL, oil_frequency=50),
        "ViscousDamper.damping = 1: conflicts with oil",
        "leave one of the two out",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, damping=1, oil_frequency=50),
        "ViscousDamper.oil_frequency = 50: belongs to oil",
        "or leave it out",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=OIL, oil_frequency=50, oil_temperature=300),
        "ViscousDamper.oil_temperature = 300: has no temperatures of oil beside it",
        "leave it out",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=[one | {"temperature": 300} for one in OIL], oil_frequency=50),
        "ViscousDamper.oil_temperature: is needed with temperatures of oil",
        "70 degC",
    ),
    (
        lambda: ViscousDamper(
            ring_inertia=1, oil=[one | {"temperature": 300} for one in OIL], oil_frequency=50, oil_temperature=310
        ),
        "ViscousDamper.oil_temperature = 310: lies beyond the temperatures of its oil",
        "add points",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=OIL, oil_frequency=5),
        "ViscousDamper.oil: is known from 1.592 Hz to 15.92 Hz, and 0.7958 Hz is asked of",
        "add points",
    ),
    (lambda: ViscousDamper(ring_inertia=1, oil="oil.csv"), "ViscousDamper.oil = 'oil.csv'", "tn.read_oil(path)"),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=OIL[:1]),
        "ViscousDamper.oil = [{'frequency': 10.0, 'loss",
        "must have two points",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=OIL[::-1]),
        "ViscousDamper.oil = [{'frequency': 100.0",
        "does not rise in frequency",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, oil=[OIL[0], OIL[1] | {"temperature": 300}]),
        "ViscousDamper.oil = [{'frequency': 10.0",
        "has points with and without a temperature; write it at all of them, or at none",
    ),
    (lambda: tn.OilPoint(frequency=1, stiffness=1), "oil.loss_stiffness: is missing", "loss_factor = 3.5"),
    (
        lambda: tn.OilPoint(frequency=1, stiffness=1, loss_stiffness=1, loss_factor=1),
        "oil.loss_stiffness = 1: conflicts with loss_factor",
        "or loss_factor",
    ),
    (lambda: tn.OilPoint(frequency=0, stiffness=1, loss_factor=1), "oil.frequency = 0: must be positive", "50 Hz"),
    (lambda: Ratio(ratio=2, efficiency=1.1), "Ratio.efficiency = 1.1: must be above 0, and at most 1", "0.98"),
    (lambda: Ratio(ratio=2, drag_torque=-1), "Ratio.drag_torque = -1: must not be negative", "either direction"),
    (lambda: Ratio(ratio=2, efficiency=0.9, heat_rating=0), "Ratio.heat_rating = 0: must be positive", "W"),
    (lambda: Differential(efficiency=0), "Differential.efficiency = 0: must be above 0", "loses nothing"),
    (
        lambda: planetary(
            sun_mesh_efficiency=0.99, sun_mesh_stiffness=1e8, ring_mesh_stiffness=1e8, module=0.003, planet_inertia=1e-3
        ),
        "Planetary.sun_mesh_efficiency = 0.99: belongs to rigid teeth",
        "leave out the mesh stiffnesses",
    ),
    (
        lambda: toothed(friction_coefficient=0.06, efficiency=0.99),
        "GearPair.friction_coefficient = 0.06: conflicts with efficiency",
        "leave out one",
    ),
    (
        lambda: toothed(friction_coefficient=50),
        "GearPair.friction_coefficient = 50: must be above 0, and below",
        "0.06",
    ),
    (
        lambda: GearPair(base_radius_in=1, base_radius_out=1, mesh_stiffness=1, friction_coefficient=0.1),
        "GearPair.friction_coefficient = 0.1: needs tooth numbers",
        "efficiency = 0.98",
    ),
    (lambda: Brake(inertia=1.0), "Brake.torque: is missing", 'write torque = "200 N*m"'),
    (lambda: Brake(inertia=1.0, torque=-5), "Brake.torque = -5: must not be negative", "either direction"),
    (lambda: Brake(inertia=0, torque=5), "Brake.inertia = 0: must be positive", "kg"),
    (
        lambda: Brake(inertia=1.0, torque=5, static_torque=4),
        "Brake.static_torque = 4: is less than torque",
        "leave it out",
    ),
    (
        lambda: Brake(inertia=1.0, torque=5, stribeck_speed=1),
        "Brake.static_torque: is needed with stribeck_speed",
        "at rest",
    ),
    (lambda: Coupling(), "Coupling.stiffness: is missing", "relative_damping = 1.13"),
    (
        lambda: Coupling(torques=[1, 2], stiffnesses=[3]),
        "Coupling.stiffnesses = [3]: must have one value for each of 2 torques, and has 1",
        "write one for each",
    ),
    (lambda: Coupling(torques=[1], stiffnesses=[3]), "Coupling.torques = [1]: must be two or more", "not a table"),
    (
        lambda: Coupling(torques=["3 N*m", "2 N*m"], stiffnesses=[1, 2]),
        "Coupling.torques = ['3 N*m', '2 N*m']: must rise: 2 N m after 3 N m",
        "sort them",
    ),
    (
        lambda: Coupling(torques=[-1, 2], stiffnesses=[1, 2]),
        "Coupling.torques = [-1, 2]: must not be negative",
        "0 or above",
    ),
    (lambda: Coupling(torques=[1, 2], stiffnesses=[0, 2]), "Coupling.stiffnesses = [0, 2]: must be positive", "leave"),
    (
        lambda: Coupling(stiffness=1, torques=[1, 2], stiffnesses=[1, 2]),
        "Coupling.torques = [1, 2]: conflicts with stiffness",
        "leave one of the two out",
    ),
    (lambda: Coupling(torques=5, stiffnesses=[1, 2]), "Coupling.torques = 5: is not a list of torques", "say"),
    (lambda: rubber(temperature=None), "rubber.temperature: is needed with temperatures", "coupling_temperatures"),
    (lambda: rubber(temperature=60), "rubber.temperature = 60: is -213.15 °C, and must lie", "in kelvin"),
    (lambda: rubber(temperature="90 degC"), "rubber.temperature = '90 degC': lies beyond temperatures", "add points"),
    (lambda: rubber(stiffness_factors=None), "rubber.temperatures = [300.0, 350.0]: have no factors", "write"),
    (lambda: rubber(temperatures=None), "rubber.stiffness_factors = [1.0, 0.8]: has no temperatures", "write"),
    (lambda: rubber(stiffness_factors=[1, 0]), "rubber.stiffness_factors = [1, 0]: must be", "0.6"),
    (
        lambda: rubber(damping_factors=[1]),
        "rubber.damping_factors = [1]: must have one value for each of 2 temperatures, and has 1",
        "one for",
    ),
    (lambda: rubber(thermal_resistance=0.1), "rubber.ambient_temperature: is needed with thermal_resistance", "30"),
    (
        lambda: rubber(ambient_temperature=300),
        "rubber.thermal_resistance: is needed with ambient_temperature",
        "K/W",
    ),
    (
        lambda: Coupling(stiffness=1.0, thermal_resistance=0.1, ambient_temperature=300.0),
        "Coupling.temperature: is needed with thermal_resistance",
        "write temperature",
    ),
    (lambda: Shaft(stiffness="5 foo"), "Shaft.stiffness = '5 foo': unknown unit 'foo'", "known are rad deg"),
    (lambda: Shaft(stiffness="5 N*m/("), "Shaft.stiffness = '5 N*m/(': unknown unit", "12 kN*m/rad"),
    (lambda: Shaft(stiffness="5 __import__('os')"), "Shaft.stiffness = ", "unknown unit"),
    (
        lambda: Shaft(stiffness="stiff"),
        "Shaft.stiffness = 'stiff': does not start with a number",
        "12 kN*m/rad",
    ),
    (lambda: Shaft(stiffness=""), "Shaft.stiffness = '': does not start with a number", "12 kN*m/rad"),
    (lambda: HookeJoint(angle="12"), "HookeJoint.angle = '12': has no unit", "without quotes for SI"),
    (
        lambda: HookeJoint(angle="1,5 deg"),
        "HookeJoint.angle = '1,5 deg': has a decimal comma",
        "decimal point",
    ),
    (lambda: Ratio(ratio="4 deg"), "Ratio.ratio = '4 deg': must have no unit", "plain number"),
    (lambda: Disk(inertia=True), "Disk.inertia = True: must be a number", "not true or false"),
    (lambda: HookeJoint(angle=None), "HookeJoint.angle: must be a number", "not nothing (None)"),
    (lambda: Disk(inertia=[1.0]), "Disk.inertia = [1.0]: must be a number", "not a list"),
    (lambda: Disk(inertia=1 + 2j), "Disk.inertia = (1+2j): must be a number", "not a complex"),
    (lambda: Disk(inertia=float("nan")), "Disk.inertia = nan: must be finite", "0.4 kg*m^2"),
    (lambda: Disk(inertia="nan kg*m^2"), "Disk.inertia = 'nan kg*m^2': must be finite", "0.4 kg*m^2"),
    (lambda: Shaft(stiffness=float("inf")), "Shaft.stiffness = inf: must be finite", "12 kN*m/rad"),
    (lambda: Shaft(stiffness="1e999 N*m/rad"), "Shaft.stiffness = '1e999 N*m/rad': must be finite", "kN"),
    (lambda: Shaft(stiffness=10**400), "Shaft.stiffness = a number of 401 digits: must be finite", "kN"),
    (lambda: Shaft(stiffness="1e31 N*m/rad"), "Shaft.stiffness = '1e31 N*m/rad': is larger than 1e+30", "exponent"),
    (lambda: Disk(inertia=1e-31), "Disk.inertia = 1e-31: is smaller than 1e-30 kg m²", "check the exponent"),
    (lambda: Shaft(stiffness="1e99999999999999999999 kN*m/rad"), "Shaft.stiffness = '1e9999", "must be finite"),
    (lambda: Shaft(stiffness="9" * 5_000_000), "Shaft.stiffness = '999", "has 5000000 characters"),
    (lambda: Shaft(stiffness="1 " + "N" * 150), "Shaft.stiffness = '1 NNN", "unknown unit 'NNN"),
    (
        lambda: Ratio(teeth_in=10**5000, teeth_out=3),
        "Ratio.teeth_in = a number of 5001 digits: must be at most",
        "100000",
    ),
    (lambda: Disk(name="n" * 81, inertia=1), "Disk.name = 'nnn", "at most 80 characters"),
    # keys
    (lambda: Shaft(stifness=1e4), "Shaft.stifness = 10000: unknown key", 'did you mean "stiffness"?'),
    (lambda: HookeJoint(angel="12 deg"), "HookeJoint.angel = '12 deg': unknown key", 'did you mean "angle"?'),
    (lambda: ConstantSpeed(rpm=3), "ConstantSpeed.rpm = 3: unknown key", "known: name, after"),
    (lambda: HookeJoint(), "HookeJoint.angle: is missing", 'write angle = "12 deg"'),
    (lambda: HookeJoint(name="front"), "front.angle: is missing", 'write angle = "12 deg"'),
    (lambda: Shaft(name="a*"), "Shaft.name = 'a*': is not a name", "without *"),
    (lambda: Shaft(name="two\nlines", stiffness=1), "Shaft.name = 'two\\nlines': is not a name", "one line"),
    (lambda: Shaft(name=3, stiffness=1), "Shaft.name = 3: is not a name", "one line of text"),
    (lambda: Shaft(after="", stiffness=1), "Shaft.after = '': is not a name", "one line of text"),
    # shafts
    (lambda: Shaft(), "Shaft.stiffness: is missing", "or outer_diameter, length, shear_modulus"),
    (lambda: Shaft(stiffness=0), "Shaft.stiffness = 0: must be positive", '"12 kN*m/rad"'),
    (
        lambda: Shaft(stiffness="-3 kN*m/rad"),
        "Shaft.stiffness = '-3 kN*m/rad': must be positive",
        "12 kN*m/rad",
    ),
    (lambda: Shaft(stiffness=1, length=1), "Shaft.length = 1: conflicts with stiffness", "leave out either"),
    (lambda: Shaft(stiffness=1, density=0), "Shaft.density = 0: conflicts with stiffness", "leave out either"),
    (lambda: Shaft(outer_diameter=1), "Shaft.length: is needed with outer_diameter", "needed are outer_d"),
    (lambda: Shaft(density=7850), "Shaft.outer_diameter: is needed with density", "needed are outer_d"),
    (lambda: Shaft(**TUBE | {"length": 0}), "Shaft.length = 0: must be positive", '"76 mm"'),
    (lambda: Shaft(**TUBE | {"shear_modulus": -1}), "Shaft.shear_modulus = -1: must be positive", "79.3 GPa"),
    (
        lambda: Shaft(**TUBE, inner_diameter="80 mm"),
        "Shaft.inner_diameter = '80 mm': must be smaller",
        "0.076 m",
    ),
    (
        lambda: Shaft(**TUBE, inner_diameter=-0.01),
        "Shaft.inner_diameter = -0.01: must not be negative",
        "76 mm",
    ),
    (lambda: Shaft(**TUBE, density=-1), "Shaft.density = -1: must not be negative", "7850 kg/m^3"),
    (lambda: Shaft(**TUBE, young_modulus=0), "Shaft.young_modulus = 0: must be positive", "GPa"),
    (
        lambda: tn.stability(line(ConstantSpeed(), Shaft(stiffness=1, loss_factor=0.02), Disk(inertia=1)), 10.0),
        "Shaft 1.loss_factor = 0.02: holds at all frequencies, which equations in time do not have",
        'write loss_factor_frequency = "50 Hz"',
    ),
    (
        lambda: tn.periodic_response(
            line(ConstantSpeed(), Shaft(stiffness=1, loss_factor=0.02), Disk(inertia=1)), 10.0
        ),
        "Shaft 1.loss_factor = 0.02: holds at all frequencies, which equations in time do not have",
        "tn.order_response",
    ),
    (
        lambda: tn.order_response(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), [-3.0]),
        "speeds: must be positive and finite",
        "tn.rpm",
    ),
    (
        lambda: tn.order_response(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), [3.0], orders=[0.0]),
        "orders: must be positive and finite",
        "orders=[0.5, 1, 2]",
    ),
    (
        lambda: tn.order_response(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), [3.0]).plot(
            spring="Shaft 2"
        ),
        "spring = 'Shaft 2': is not a shaft or mesh of this result",
        "Shaft 1",
    ),
    (
        lambda: tn.remedies(line(Disk(inertia=1), Shaft(stiffness=1), Disk(inertia=1)), (1, 2), near=1.0),
        "near = 1: must be at least 0 and below 1",
        "near=0.1",
    ),
    (
        lambda: tn.remedies(line(Disk(inertia=1), Shaft(stiffness=1), Disk(inertia=1)), (1, 2), checks=["wear"]),
        "checks = 'wear': is not a check of this line",
        "nothing is judged",
    ),
    (
        lambda: tn.remedies(
            line(Disk(inertia=1), Shaft(stiffness=1), Disk(inertia=1)), (1, 2), checks=["torque without limit"]
        ),
        "checks = 'torque without limit': is not judged",
        "limits",
    ),
    (
        lambda: Shaft(stiffness=1, loss_factor_frequency=3),
        "Shaft.loss_factor: is needed with loss_factor_frequency",
        "0.02",
    ),
    (
        lambda: Shaft(stiffness=1, loss_factor=0.02, loss_factor_frequency=0),
        "Shaft.loss_factor_frequency = 0: must be positive",
        '"50 Hz"',
    ),
    (
        lambda: Shaft(stiffness=1, loss_factor=-0.02, loss_factor_frequency=3),
        "Shaft.loss_factor = -0.02: must not be negative",
        "0.02",
    ),
    (
        lambda: Shaft(stiffness=1, damping=3, loss_factor=0.02, loss_factor_frequency=3),
        "Shaft.damping = 3: conflicts with loss_factor",
        "leave one of the two out",
    ),
    (
        lambda: tn.Clutch(stiffnesses=[1.0], friction=[{"torque": 1, "stiffness": 1}], linear_amplitude=0.1),
        "Clutch.linear_frequency: is needed with linear_amplitude",
        '"30 Hz"',
    ),
    (
        lambda: tn.Clutch(
            stiffnesses=[1.0], friction=[{"torque": 1, "stiffness": 1}], linear_amplitude=0, linear_frequency=9
        ),
        "Clutch.linear_amplitude = 0: must be positive",
        '"12 deg"',
    ),
    (
        lambda: tn.Clutch(stiffnesses=[1.0], friction=[{"torque": 1, "stiffness": 1}]).linear(),
        "Clutch.linear_amplitude: is not stated",
        "frequency=",
    ),
    (
        lambda: tn.natural_frequencies(
            line(
                ConstantSpeed(),
                Shaft(stiffness=1e-23),
                Disk(inertia=1),
                Shaft(stiffness=1),
                Disk(inertia=1),
                damping_ratio=0.05,
            )
        ),
        "driveline.damping_ratio: holds at the lowest elastic mode, which is lost in rounding",
        "damping_ratio_frequency",
    ),
    # disks, joints, ratios
    (lambda: Disk(), "Disk.inertia: is missing", "or outer_diameter, thickness, density"),
    (lambda: Disk(inertia=0), "Disk.inertia = 0: must be positive", "0.4 kg*m^2"),
    (lambda: Disk(inertia="-1 kg*m^2"), "Disk.inertia = '-1 kg*m^2': must be positive", "0.4 kg*m^2"),
    (lambda: Disk(inertia=1, thickness=1), "Disk.thickness = 1: conflicts with inertia", "leave out either"),
    (lambda: Disk(thickness=1), "Disk.outer_diameter: is needed with thickness", "needed are"),
    (
        lambda: Disk(outer_diameter=1, inner_diameter=1, thickness=1, density=1),
        "Disk.inner_diameter = 1: must be smaller than outer_diameter = 1 m",
        "check the units",
    ),
    (lambda: HookeJoint(angle="90 deg"), "HookeJoint.angle = '90 deg': must be less than 90 deg", "radians"),
    (
        lambda: HookeJoint(angle="-95 deg"),
        "HookeJoint.angle = '-95 deg': must be less than 90 deg",
        "radians",
    ),
    (lambda: HookeJoint(angle=12), "HookeJoint.angle = 12: must be less than 90 deg", "tn.deg(12)"),
    (lambda: IdealJoint(angle=12), "IdealJoint.angle = 12: must be less than 90 deg", "tn.deg(12)"),
    (lambda: Ratio(), "Ratio.ratio: is missing", "teeth_in = 10 and teeth_out = 41, or ratio = 4.1"),
    (lambda: Ratio(ratio=0), "Ratio.ratio = 0: must not be zero", "input speed over output speed"),
    (lambda: Ratio(ratio=4.1, teeth_in=10), "Ratio.teeth_in = 10: conflicts with ratio", "leave out either"),
    (
        lambda: Ratio(teeth_in=10),
        "Ratio.teeth_out: is needed with teeth_in",
        "needed are teeth_in, teeth_out",
    ),
    (
        lambda: Ratio(teeth_in=0, teeth_out=4),
        "Ratio.teeth_in = 0: must be a whole number of teeth",
        "positive",
    ),
    (lambda: Ratio(teeth_in="20", teeth_out=4), "Ratio.teeth_in = '20': must be a whole", "write 20 without quotes"),
    (lambda: Ratio(teeth_in=1.5, teeth_out=4), "Ratio.teeth_in = 1.5: must be a whole number", "positive"),
    (lambda: Ratio(teeth_in=True, teeth_out=4), "Ratio.teeth_in = True: must be a whole number", "positive"),
    (lambda: Belt(radius_in=0.1, radius_out=0.1), "Belt.span_stiffness: is missing", 'span_stiffness = "4e5 N/m"'),
    (lambda: pendulum(order=None), "CentrifugalPendulum.order: is missing", "order = 2, or length"),
    (lambda: pendulum(length=0.02), "CentrifugalPendulum.length = 0.02: conflicts with order", "leave out either"),
    (lambda: pendulum(mass=0), "CentrifugalPendulum.mass = 0: must be positive", '"1800 kg"'),
    (lambda: pendulum(radius=-1), "CentrifugalPendulum.radius = -1: must be positive", '"76 mm"'),
    (lambda: pendulum(damping=-1), "CentrifugalPendulum.damping = -1: must not be negative", '"3 N*m*s/rad"'),
    (lambda: pendulum(path="line"), "CentrifugalPendulum.path = 'line': is not a path", 'write "circle"'),
    (
        lambda: pendulum(order=None, length=0.2),
        "CentrifugalPendulum.length = 0.2: is longer than the radius of 0.1 m that it hangs on",
        "check which is which",
    ),
    (
        lambda: pendulum(largest_travel=1, path="epicycloid"),
        "CentrifugalPendulum.largest_travel = 1: is more than the 0.02795 m that its path has",
        "check the unit",
    ),
    (lambda: TorqueConverter(), "TorqueConverter.curves: is missing", "speed_ratio = 0"),
    (lambda: TorqueConverter(curves=converter_points()[:2]), "TorqueConverter.curves = [{", "must have three"),
    (
        lambda: TorqueConverter(curves=converter_points()[::-1]),
        "TorqueConverter.curves = [{",
        "does not rise in speed_ratio: 0.8 after 1; sort the points",
    ),
    (
        lambda: TorqueConverter(curves=[{"speed_ratio": -0.1, "torque_ratio": 2, "capacity": 1}, *converter_points()]),
        "TorqueConverter.curves = [{",
        "must not be negative; begin at 0",
    ),
    (lambda: TorqueConverter(curves="sheet.csv"), "TorqueConverter.curves = 'sheet.csv': names", "read_converter"),
    (
        lambda: TorqueConverter(curves=[*converter_points()[:2], {"speed_ratio": 1, "torque_ratio": 1}]),
        "TorqueConverter.curves 3 capacity: is missing",
        "pump_torque",
    ),
    (
        lambda: TorqueConverter(curves=converter_points(torque_ratio=1.5)),
        "TorqueConverter.curves = [{",
        "gives more power than it takes at a speed ratio of 0.8: torque_ratio is 1.5; write 1.25 or less",
    ),
    (
        lambda: TorqueConverter(curves=converter_points(capacity=0)),
        "TorqueConverter.curves = [{",
        "must be positive at a speed ratio of 0.8; only at",
    ),
    (
        lambda: TorqueConverter(
            curves=[*converter_points(), {"speed_ratio": 1.2, "torque_ratio": 1, "capacity": 1e-3}]
        ),
        "TorqueConverter.curves = [{",
        "is positive at a speed ratio of 1.2; write it negative",
    ),
    (
        lambda: TorqueConverter(curves=converter_points(capacity=None, pump_torque=90)),
        "TorqueConverter.reference_speed: is needed with pump_torque",
        '"2000 rpm"',
    ),
    (
        lambda: TorqueConverter(curves=converter_points(), reference_speed=200),
        "TorqueConverter.reference_speed = 200: conflicts with capacity",
        "leave it out",
    ),
    (
        lambda: TorqueConverter(curves=converter_points()).at(1.1, 200.0),
        "TorqueConverter.speed_ratio = 1.1: lies beyond its points, 0 to 1",
        "add points",
    ),
    (
        lambda: order_response(converted(load_torque=400), [100.0]),
        "converter.curves: stalls at 954.93 rpm of the input: its turbine would have to carry 400 N m, and gives",
        "lower the load",
    ),
    (
        lambda: order_response(converted(short=True), [100.0]),
        "converter.curves: ends at a speed ratio of 0.8, where its turbine still gives more",
        "add points up to",
    ),
    (
        lambda: order_response(converted(drive_share=1), [100.0]),
        "load.drive_share: holds a speed behind converter",
        "locked = true",
    ),
    (lambda: natural_frequencies(converted()), "converter.curves: runs at a ratio of speeds that", "[operation]"),
    (
        lambda: tn.stability_chart(converted(), ("speed", 90, 110, 3), ("load.inertia", 0.1, 0.2, 3)),
        "converter.locked: turns its turbine by a ratio that follows from the loads at each speed, which charts do not",
        "locked = true",
    ),
    (
        lambda: order_response(converted(twice=True), [100.0]),
        "converter, second: are several torque converters",
        "locked = true",
    ),
    (
        lambda: order_response(converted(joint=True), [100.0]),
        "converter.curves: turns unevenly with bend at its side",
        "put a Shaft between",
    ),
    (lambda: SlipClutch(), "SlipClutch.torque: is missing", 'torque = "1200 N*m"'),
    (lambda: SlipClutch(torque=0), "SlipClutch.torque = 0: must be positive", '"250 N*m"'),
    (lambda: SlipClutch(torque=9, sliding_torque=-1, stribeck_speed=1), "SlipClutch.sliding_torque = -1: must", "250"),
    (lambda: SlipClutch(torque=9, sliding_torque=5), "SlipClutch.stribeck_speed: is needed with", '"30 rpm"'),
    (lambda: SlipClutch(torque=9, stribeck_speed=5), "SlipClutch.sliding_torque: is needed with", '"900 N*m"'),
    (
        lambda: SlipClutch(torque=9, clamping_times=[0, 1], clamping_shares=[1]),
        "SlipClutch.clamping_shares = [1]: are 1 for 2 clamping_times",
        'clamping_times = ["0 s", "0.3 s"]',
    ),
    (
        lambda: SlipClutch(torque=9, clamping_times=[1, 1], clamping_shares=[0, 1]),
        "SlipClutch.clamping_times = [1, 1]: must rise",
        "write times from the start on, each later than the one before",
    ),
    (
        lambda: SlipClutch(torque=9, clamping_times=[0], clamping_shares=[-0.1]),
        "SlipClutch.clamping_shares = [-0.1]: must not be negative",
        "write 0 for an open clutch",
    ),
    (lambda: Vehicle(mass=900), "Vehicle.wheel_radius: is missing", ""),
    (lambda: Vehicle(mass=900, wheel_radius=0), "Vehicle.wheel_radius = 0: must be positive", '"76 mm"'),
    (
        lambda: Vehicle(mass=900, wheel_radius=1, grade=-0.1),
        "Vehicle.grade = -0.1: must not be negative",
        "load_torque",
    ),
    (lambda: Vehicle(mass=900, wheel_radius=1, drag_area="2 m"), "Vehicle.drag_area = '2 m'", "m^2"),
    (lambda: Tyre(stiffness=0), "Tyre.stiffness = 0: must be positive", "write for example"),
    (lambda: Tyre(stiffness=1, radius=0.3), "Tyre.slip_stiffness: is needed with radius", "needs slip_stiffness"),
    (lambda: line(Vehicle(mass=9, wheel_radius=1, name="car")), "car: has no wheels", "behind a Tyre"),
    (
        lambda: line(motor(curve=CURVE), propeller()),
        "propeller.type = 'Propeller': is tied rigidly to motor: no shaft leads out to it",
        "put a Shaft in front of it",
    ),
    (lambda: line(propeller()), "propeller.type = 'Propeller': stands alone: no shaft leads out to it", "put a Shaft"),
    (
        lambda: line(Disk(inertia=1), Tyre(stiffness=1, name="tyre"), Disk(inertia=1)),
        "tyre: carries no vehicle",
        "put a Vehicle behind it",
    ),
    (
        lambda: line(
            Disk(inertia=1, name="hub"), Shaft(stiffness=1), Disk(inertia=1), Tyre(stiffness=1, name="tyre", to="hub")
        ),
        "tyre.to = 'hub': is not a Vehicle",
        "name a Vehicle",
    ),
    (lambda: belt(radius_in=0), "Belt.radius_in = 0: must be positive", '"76 mm"'),
    (lambda: belt(radius_out=-0.1), "Belt.radius_out = -0.1: must be positive", '"76 mm"'),
    (lambda: belt(span_stiffness=0), "Belt.span_stiffness = 0: must be positive", "write for example"),
    (lambda: belt(damping=-1), "Belt.damping = -1: must not be negative", "write for example"),
    (lambda: belt(inertia_out=0), "Belt.inertia_out = 0: must be positive", "write for example"),
    (lambda: belt(span_stiffness="4 N*m"), "Belt.span_stiffness = '4 N*m'", "N/m"),
    (lambda: dual_mass(primary_inertia=None), "DualMassFlywheel.primary_inertia: must be a number", "kg*m^2"),
    (lambda: dual_mass(secondary_inertia=0), "DualMassFlywheel.secondary_inertia = 0: must be positive", "write for"),
    (lambda: dual_mass(stiffnesses=[0]), "DualMassFlywheel.stiffnesses = [0]: are all zero", "give a stage stiffness"),
    (lambda: dual_mass(breakpoints=[0.1]), "DualMassFlywheel.stiffnesses", "must be 2 quantities"),
    (lambda: dual_mass(breakpoints=[0.2, 0.1], stiffnesses=[1, 2, 3]), "DualMassFlywheel.breakpoints", "must rise"),
    (lambda: dual_mass(friction=[{**RUBS, "torque": 0}]), "DualMassFlywheel.friction 1 torque = 0: must be", "15 N*m"),
    (lambda: dual_mass(friction=[RUBS] * 9), "DualMassFlywheel.friction = [{", "at most 8 sliders; leave friction out"),
    (
        lambda: dual_mass(linear_amplitude=1, linear_frequency=9),
        "DualMassFlywheel.linear_amplitude = 1: is given without",
        "stage",
    ),
    (lambda: motor(), "motor.breakdown_torque: is missing", 'synchronous_speed = "1500 rpm", or curve'),
    (lambda: motor(breakdown_torque=9.0), "motor.breakdown_slip: is needed with breakdown_torque", "needed are"),
    (lambda: motor(**KLOSS, gain=3.0), "motor.gain = 3: conflicts with breakdown_torque", "leave out gain or"),
    (
        lambda: motor(**KLOSS | {"breakdown_slip": 1.2}),
        "motor.breakdown_slip = 1.2: must lie between 0 and 1",
        "write 0.15, say",
    ),
    (lambda: motor(**KLOSS | {"breakdown_slip": 0.0}), "motor.breakdown_slip = 0: must lie between 0 and 1", "0.15"),
    (lambda: motor(**KLOSS | {"breakdown_torque": "5 N/m"}), "motor.breakdown_torque = '5 N/m'", "N*m"),
    (lambda: motor(**KLOSS, pole_pairs=0), "motor.pole_pairs = 0: must be 1 or more", "write 2, say"),
    (lambda: motor(curve=CURVE, pole_pairs=2), "motor.pole_pairs = 2: belongs to Kloss's formula", "leave it out"),
    (lambda: motor(**KLOSS, corner_frequency=0.0), "motor.corner_frequency = 0: must be positive", "write for"),
    (lambda: motor(gain=3.0), "motor.set_speed: is needed with gain", "needed are gain, set_speed"),
    (
        lambda: motor(gain=3.0, set_speed=9.0, drive_share=1),
        "motor.drive_share = 1: conflicts with set_speed",
        "leave out set_speed",
    ),
    (lambda: motor(curve=CURVE, drive_share=1), "motor.drive_share = 1: conflicts with curve", "leave it out"),
    (lambda: motor(**KLOSS, drive_share=-1), "motor.drive_share = -1: must not be negative", "write for"),
    (lambda: motor(**KLOSS, inertia=0), "motor.inertia = 0: must be positive", "write for"),
    (lambda: motor(curve=CURVE[:1]), "motor.curve", "must have two points at least"),
    (
        lambda: motor(curve=CURVE[::-1]),
        "motor.curve",
        "does not rise in speed: 0 rpm after 1432.39 rpm; sort the points",
    ),
    (lambda: motor(curve=[*CURVE, CURVE[1]]), "motor.curve", "does not rise in speed"),
    (lambda: motor(curve=[{"speed": -1.0, "torque": 3.0}, *CURVE]), "motor.curve", "must not be negative; begin at 0"),
    (lambda: motor(curve=[{"speed": "1 Nm", "torque": 3.0}, *CURVE]), "motor.curve 1 speed = '1 Nm'", "rad/s"),
    (lambda: motor(curve=[{"speed": 1.0, "torque": float("nan")}, *CURVE]), "motor.curve 1 torque = nan", "finite"),
    (lambda: motor(curve="motor.csv"), "motor.curve = 'motor.csv': names a file", "tn.read_curve(path)"),
    (lambda: motor(curve=3), "motor.curve = 3: is not a list of points", "or the name of a CSV file"),
    (lambda: Generator(inertia=1.0), "Generator.power: is missing", 'power = "30 kW"'),
    (lambda: Generator(inertia=1.0, power=0), "Generator.power = 0: must be positive", "write for"),
    (lambda: fan(), "fan.rated_power: is missing", 'rated_speed = "1480 rpm"'),
    (lambda: fan(rated_power=3.0), "fan.rated_speed: is needed with rated_power", "needed are"),
    (lambda: fan(rated_power=300.0, rated_speed=0), "fan.rated_speed = 0: must be positive", "write for"),
    (lambda: fan(quadratic_load=-1), "fan.quadratic_load = -1: must not be negative", "write for"),
    (
        lambda: fan(rated_power=300.0, rated_speed=100.0, load_torque=4.0),
        "fan.load_torque = 4: is more than the 3 N m",
        "check the units",
    ),
    (lambda: fan(curve=CURVE, load_torque=4.0), "fan.curve", "conflicts with load_torque; leave out curve or"),
    (lambda: propeller(entrained_inertia=-1), "propeller.entrained_inertia = -1: must not be negative", "write for"),
    (lambda: propeller(damping_factor=0), "propeller.damping_factor = 0: must be positive", "write for"),
    (
        lambda: propeller(damping_factor=3, viscous_load=1),
        "propeller.damping_factor = 3: conflicts with viscous_load",
        "leave out one of the two",
    ),
    (
        lambda: order_response(driving(Disk(inertia=9.0, name="engine"), propeller()), [30.0]),
        "driveline.load_torque: is free–free and its torques do not balance",
        'and nothing drives; give the driving disk, "engine" say, drive_share = 1',
    ),
    (
        lambda: order_response(
            Driveline([Disk(inertia=1.0), Shaft(stiffness=1e4), engine(), Shaft(stiffness=1e4), propeller()]), [30.0]
        ),
        "driveline.load_torque: is free–free and its torques do not balance",
        'and nothing drives; give the engine, "Engine 1" say, drive_share = 1',
    ),
    (
        lambda: order_response(driving(motor(**KLOSS), fan(quadratic_load=0.01)), [120.0]),
        "driveline.load_torque: is free–free and its torques do not balance",
        "leave the speed out, so that it runs where they do, at 1428.405 rpm (stable)",
    ),
    (
        lambda: stability(driving(motor(curve=CURVE), fan(load_torque=150.0))),
        "operation.speed: is not given, and the line lasts at no speed: at 781.",
        "drives it away; take a drive whose torque falls",
    ),
    (
        lambda: stability(driving(motor(**KLOSS), fan(load_torque=600.0))),
        "operation.speed: is not given, and the torques of the line balance at no speed",
        "drive_share = 1, or check the signs",
    ),
    (
        lambda: stability(driving(motor(curve=SADDLE), fan(load_torque=200.0))),
        "operation.speed: balances the torques of the line at 167.8155 rpm, 1347.261 rpm",
        "each stable; choose one: pass speed=141.08",
    ),
    (
        lambda: order_response(driving(motor(**KLOSS, drive_share=1), fan(quadratic_load=0.04)), [100.0, 120.0]),
        "motor.breakdown_torque = 500: would have to drive with 576 N m at 1145.9 rpm of the input",
        "lower the load, or narrow",
    ),
    (
        lambda: order_response(driving(motor(curve=CURVE), fan(load_torque=150.0)), [160.0]),
        "motor.curve: is a curve from 0 rpm to 1432.4 rpm, which does not cover 1527.9 rpm",
        "add points, or narrow",
    ),
    (
        lambda: kinetostatics(driving(Disk(inertia=9.0), Generator(inertia=1.0, curve=CURVE, name="generator")), 200.0),
        "generator.curve: is a curve that does not cover 1909.9 rpm",
        "add points",
    ),
    (
        lambda: simulate(
            driving(motor(**KLOSS, drive_share=1), fan(quadratic_load=0.01)),
            0.1,
            speed=tn.SpeedProfile((0, 1), (90, 99)),
        ),
        "motor.curve: has a torque over speed that equations of motion take by its tangent",
        "use tn.order_response at several speeds",
    ),
    (
        lambda: Driveline([ConstantSpeed(), Shaft(stiffness=1e4), motor(**KLOSS, drive_share=1)]),
        "motor.drive_share = 1: shares the drive of a line that a ConstantSpeed drives",
        "leave out the ConstantSpeed, or drive_share",
    ),
    (lambda: ViscousDamper(damping=1), "ViscousDamper.ring_inertia: is missing", 'ring_inertia = "0.12 kg*m^2"'),
    (lambda: ViscousDamper(ring_inertia=0.1), "ViscousDamper.damping: is missing", 'damping = "45 N*m*s/rad"'),
    (
        lambda: ViscousDamper(ring_inertia=0.1, damping=0),
        "ViscousDamper.damping = 0: must be positive",
        '"3 N*m*s/rad"',
    ),
    (lambda: ViscousDamper(ring_inertia=0, damping=1), "ViscousDamper.ring_inertia = 0: must be positive", "write for"),
    (
        lambda: ViscousDamper(ring_inertia=1, damping=1, stiffness=0),
        "ViscousDamper.stiffness = 0: must be positive",
        "write for",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, damping=1, inertia=-1),
        "ViscousDamper.inertia = -1: must be positive",
        "write for",
    ),
    (
        lambda: ViscousDamper(ring_inertia=1, damping=1, heat_rating=0),
        "ViscousDamper.heat_rating = 0: must be positive",
        "write for",
    ),
    (lambda: TunedDamper(ring_inertia=1, damping=1), "TunedDamper.stiffness: is missing", '"1.5 kN*m/rad"'),
    (
        lambda: TunedDamper(ring_inertia=1, stiffness=1, damping=-1),
        "TunedDamper.damping = -1: must not be negative",
        "write for",
    ),
    (lambda: natural_frequencies(on_a_bare_shaft()), "ViscousDamper 1: has no inertia in front", "Disk in front of"),
    (lambda: damper_optimum(line(), "damper"), "damper = 'damper': is not a damper of this driveline", ""),
    (lambda: damper_optimum(damped(), "dampr"), "damper = 'dampr': is not a damper", "damper"),
    (lambda: damper_optimum(damped(), "damper", 3), "mode = 3: is not an elastic mode", "from 1 to 2"),
    (lambda: damper_optimum(damped(), "damper", 1), "damper: stands in a node of mode 1", "free end"),
    (lambda: planetary(held="planets"), "Planetary.held = 'planets': is not a shaft", '"sun", "carrier", "ring"'),
    (lambda: planetary(held=["sun", "ring"]), "Planetary.held = ['sun', 'ring']: holds two shafts", 'held = "sun"'),
    (lambda: planetary(held="sun"), "Planetary.held = 'sun': is the input", "hold carrier or ring"),
    (lambda: planetary(held=None), "Planetary.held: is missing", 'hold carrier or ring, or write output = "carrier"'),
    (lambda: planetary(output="ring"), "Planetary.output = 'ring': is held", "leave one of the two out"),
    (lambda: planetary(held=None, output="sun"), "Planetary.output = 'sun': is the input", "write carrier or ring"),
    (
        lambda: planetary(held=None, output="carrier", free_speed=-30 / 72),
        "Planetary.free_speed = -0.416667: lets the output stand still",
        "hold the carrier",
    ),
    (lambda: Differential(ratio=0), "Differential.ratio = 0: must not be zero", "over that of the case"),
    (lambda: Differential(teeth_in=10), "Differential.teeth_out: is needed with teeth_in", "needed are teeth_in"),
    (lambda: Differential(ratio=4.1, teeth_in=10), "Differential.teeth_in = 10: conflicts with ratio", "leave out"),
    (lambda: Differential(inertia=-1), "Differential.inertia = -1: must be positive", "write for example"),
    (lambda: planetary(teeth_ring=30), "Planetary.teeth_ring = 30: leaves no planets", "more teeth than the sun"),
    (lambda: planetary(planet_mass=1.0), "Planetary.centre_distance: is missing", "or neither"),
    (lambda: planetary(free_speed=0.5), "Planetary.free_speed = 0.5: conflicts with held", "all speeds follow"),
    (
        lambda: planetary(sun_mesh_stiffness=1e8),
        "Planetary.ring_mesh_stiffness: is needed with sun_mesh_stiffness",
        "module and planet_inertia",
    ),
    (lambda: planetary(module=0.003), "Planetary.module = 0.003: belongs to elastic teeth", "or leave it out"),
    (
        lambda: planetary(
            sun_mesh_stiffness=1e8, ring_mesh_stiffness=1e8, module=0.003, planet_inertia=1e-3, pressure_angle=1.0
        ),
        "Planetary.pressure_angle = 1: must lie between 0 and 45 deg",
        '"20 deg"',
    ),
    (lambda: planetary(planet_inertia=0.0), "Planetary.planet_inertia = 0: must be positive", "write for example"),
    # the line
    (lambda: Driveline([]), "driveline: has no elements", "tn.Driveline(["),
    (
        lambda: Driveline([Shaft(stiffness=1.0)] * 100_000),
        "driveline: has 100000 elements, at most 5000 are taken; stability would need 1.6e+03 GB and 7.5e+02 h",
        "join neighbouring parts",
    ),
    (
        lambda: tn.stability_chart(long_line(300), ("speed", 60, 300, 200), ("HookeJoint 1.angle", 0.0, 0.4, 150)),
        "driveline: has 300 unknowns: a chart of 30000 points would take about",
        "stability() at single speeds",
    ),
    (
        lambda: tn.stability(meshed_and_free(500), 2.0),
        "driveline: has 501 unknowns: stability about its own periodic motion would take about",
        "join neighbouring parts",
    ),
    (
        lambda: tn.order_response(meshed_and_free(500), np.linspace(60.0, 90.0, 50)),
        "driveline: has 501 unknowns: its own periodic motion in 30 harmonics at 50 points would take about",
        "ask for fewer points, or join neighbouring parts",
    ),
    (
        lambda: tn.stability(long_line(1900), 150.0),
        "driveline: has 1900 unknowns: stability would take about",
        "join neighbouring parts",
    ),
    (
        lambda: response_over(shaken_and_steep(30), 60.0, 300.0),
        "driveline: has 30 unknowns: its response over a range, at some",
        "ask for a number of speeds",
    ),
    (
        lambda: tn.sweep_speeds(shaken_and_steep(30), 60.0, 300.0),
        "driveline: has 30 unknowns: its response over a range, at some",
        "ask for a number of speeds",
    ),
    *(
        (
            lambda over=over: over(
                line(
                    ConstantSpeed(),
                    HookeJoint(angle=0.1),
                    Shaft(stiffness=1e4, damping=1),
                    Disk(inertia=1, excitation=[{"order": 2, "speeds": [90, 105], "amplitudes": [1, 2]}]),
                ),
                120.0,
                130.0,
            ),
            "Disk 1.excitation 1: is a table from 859.437 rpm to 1002.68 rpm, which does not cover 1241.4 rpm",
            "extend the table",
        )
        for over in (response_over, tn.sweep_speeds)
    ),
    (lambda: Driveline(3), "elements: must be a list, not of type int", "tn.Driveline(["),
    (lambda: Driveline(Disk(inertia=1)), "elements: must be a list, not of type Disk", "tn.Driveline(["),
    (
        lambda: Driveline([Disk(inertia=1), "Shaft"]),
        "element 2 = 'Shaft': is not an element",
        "tn.Driveline([",
    ),
    (
        lambda: line(Disk(inertia=1, name="a"), Shaft(stiffness=1), Disk(inertia=1, name="a")),
        "a.name: names elements 1 and 3",
        "rename one",
    ),
    (
        lambda: line(Disk(inertia=1, name="Disk 2"), Shaft(stiffness=1), Disk(inertia=1)),
        "Disk 2.name: names elements 1 and 3",
        "rename one",
    ),
    (
        lambda: line(Disk(inertia=1, name="gear"), Shaft(stiffness=1, after="gaer")),
        "Shaft 1.after = 'gaer': is not an earlier element",
        'did you mean "gear"?',
    ),
    (
        lambda: line(Shaft(stiffness=1, after="Disk 1"), Disk(inertia=1)),
        "Shaft 1.after = 'Disk 1': does not come earlier",
        "move Shaft 1 behind Disk 1",
    ),
    (
        lambda: line(Disk(inertia=1), Shaft(stiffness=1), Disk(inertia=1), Shaft(stiffness=1, after="Shaft 1")),
        "Shaft 2.after = 'Shaft 1': is a Shaft",
        "branches leave from a Disk",
    ),
    (
        lambda: line(Disk(inertia=1), ConstantSpeed(), Shaft(stiffness=1)),
        "ConstantSpeed 1: stands in the middle of the line",
        "hang Shaft 1 elsewhere",
    ),
    (
        lambda: line(Shaft(stiffness=1, damping=3), damping_ratio=0.02),
        "Shaft 1.damping = 3: conflicts with the line's damping_ratio",
        "leave out one",
    ),
    (
        lambda: line(Shaft(stiffness=1, loss_factor=0.1, loss_factor_frequency=3), damping_ratio="2 %"),
        "Shaft 1.loss_factor = 0.1: conflicts with the line's damping_ratio",
        "leave out one",
    ),
    (lambda: line(damping_ratio="x"), "driveline.damping_ratio = 'x': does not start with a number", "0.02"),
    (
        lambda: line(damping_ratio_frequency="50 Hz"),
        "driveline.damping_ratio_frequency = '50 Hz': is given without damping_ratio",
        "leave it out",
    ),
    (
        lambda: line(damping_ratio=0.02, damping_ratio_frequency=0),
        "driveline.damping_ratio_frequency = 0: must be positive",
        '"50 Hz"',
    ),
    (lambda: line(name=""), "driveline.name = '': is not a name", "one line of text"),
    (lambda: line(description=3), "driveline.description = 3: must be text", "in quotes"),
    (lambda: engine(rigid=3), "Engine.rigid = 3: is neither true nor false", "write true or false"),
    (lambda: planetary(planets=1.5), "Planetary.planets = 1.5: must be a whole number", "write 3, say"),
    (lambda: Operation(load_cases=3), "operation.load_cases = 3: must be a list", "in square brackets"),
    (lambda: Operation(load_cases=[3]), "operation.load_cases = [3]: is not a table", "write a table of its keys"),
    (lambda: tn.TorqueFunction(on="a", function=3), "torque on a.function = 3: must be a function", "lambda time"),
    (lambda: line(operation="fast"), "driveline.operation = 'fast': is not an Operation", "tn.Operation("),
    (lambda: line().index("Dsk 1"), "Dsk 1: is not an element of this driveline", 'did you mean "Disk 1"?'),
    (lambda: line().replace("Disk 1", inertia=-1), "Disk 1.inertia = -1: must be positive", "0.4 kg*m^2"),
    (lambda: line().replace("Disk 1", inerta=1), "Disk 1.inerta = 1: unknown key", '"inertia"'),
    (lambda: line().replace("Shaft 9", stiffness=1), "Shaft 9: is not an element", "Shaft 1"),
    (lambda: line().with_load("climb"), "load_case = 'climb': is not a load case", "there are none"),
    (
        lambda: line(Disk(inertia=1, after="a")),
        "Disk 1.after = 'a': is not an earlier element",
        "there are none",
    ),
    # operation
    (lambda: Operation(speed=0), "operation.speed = 0: must be positive", "at rest"),
    (lambda: line(document="TV-1"), "driveline.document = 'TV-1': is not a TitleBlock", "tn.TitleBlock("),
    (lambda: TitleBlock(numbr="TV-1"), "document.numbr = 'TV-1': unknown key", 'did you mean "number"?'),
    (lambda: engine(misfiring=True), "Engine.misfiring = True: must be a whole number", "write 2, say"),
    (lambda: engine(cut_out="2"), "Engine.cut_out = '2': must be a whole number", "write 2, say"),
    (lambda: motor(**KLOSS, pole_pairs=True), "motor.pole_pairs = True: must be a whole number", "write 2, say"),
    (lambda: TitleBlock(revision=2), "document.revision = 2: is not a name", "one line of text"),
    (lambda: Operation(sped=1), "operation.sped = 1: unknown key", 'did you mean "speed"?'),
    (lambda: Operation(speed_unit="RPM"), "operation.speed_unit = 'RPM': is not a speed unit", '"rpm"'),
    (
        lambda: Operation(speed_range=["300 rpm", "300 rpm"]),
        "operation.speed_range = ['300 rpm', '300 rpm']: is a range of zero size",
        "the lower first",
    ),
    (
        lambda: Operation(speed_range=["600 rpm", "300 rpm"]),
        "operation.speed_range = ['600 rpm', '300 rpm']: is reversed",
        "the lower first",
    ),
    (
        lambda: Operation(angle_range=["15 deg", "0 deg"]),
        "operation.angle_range = ['15 deg', '0 deg']: is reversed",
        "the lower first",
    ),
    (
        lambda: Operation(speed_range=3),
        "operation.speed_range = 3: must have a lower and an upper end",
        "rpm",
    ),
    (
        lambda: Operation(speed_range=["1 kg", 3]),
        "operation.speed_range = ['1 kg', 3]: kg is not the unit",
        "rpm",
    ),
    (
        lambda: Operation(speed_range=[-1, 3]),
        "operation.speed_range = [-1, 3]: must not go below zero",
        "0 rpm",
    ),
    (
        lambda: Operation(angle_range=[0, 2]),
        "operation.angle_range = [0, 2]: must stay below 90 deg",
        "15 deg",
    ),
    (lambda: Operation(application="boat"), "operation.application = 'boat': is not an application", "mill, ship, in"),
    (lambda: Operation(application=3), "operation.application = 3: is not an application", "known: road, steering"),
    (
        lambda: Operation(switched_off=[{"rule": "bending"}]),
        "switched-off rule bending.reason: is missing",
        'reason = "measured on the vehicle"',
    ),
    (
        lambda: SwitchedOff(rule="bending", reason=" "),
        "switched-off rule bending.reason = ' ': gives no reason",
        "why the rule does not fit",
    ),
    (
        lambda: SwitchedOff(rule="bending", reason=3),
        "switched-off rule bending.reason = 3: gives no reason",
        "sentence",
    ),
    (
        lambda: SwitchedOff(rule="bending", reason="x" * 301),
        "switched-off rule bending.reason = 'xxx",
        "is not one line of text; write one line of at most 300 characters",
    ),
    (
        lambda: SwitchedOff(rule="bending", reason="two\nlines"),
        "switched-off rule bending.reason = 'two\\nlines': is not one line of text",
        "300 characters",
    ),
    (
        lambda: SwitchedOff(rule="bendig", reason="x"),
        "switched-off rule bendig.rule = 'bendig': is not a rule of assess",
        'did you mean "bending"?',
    ),
    (lambda: SwitchedOff(reason="x"), "switched-off rule.rule: is missing", 'rule = "bending"'),
    (
        lambda: SwitchedOff(rule="stability", reason="x"),
        "switched-off rule stability.rule = 'stability': cannot be switched off",
        "change the line or its speed_range",
    ),
    (
        lambda: SwitchedOff(rule="own-limits", reason="x"),
        "switched-off rule own-limits.rule = 'own-limits': cannot be switched off",
        "change or remove the [[limit]]",
    ),
    (
        lambda: Operation(switched_off=[{"rule": "m68", "reason": "a"}, {"rule": "m68", "reason": "b"}]),
        "operation.switched_off = 'm68': is switched off 2 times",
        "keep one of them",
    ),
    (
        lambda: Operation(switched_off="bending"),
        "operation.switched_off = 'bending': is not a list of switched-off rules",
        'write switched_off = [{ rule = "bending", reason = "measured on the vehicle" }]',
    ),
    (
        lambda: Operation(switched_off=["bending"]),
        "operation.switched_off 1 = 'bending': is not a switched-off rule",
        "write switched_off = [",
    ),
    (lambda: LoadCase(loads={}), "load case.name: is missing", "full load"),
    (lambda: LoadCase(name="x"), "load case x.loads: is missing", "250 N*m"),
    (
        lambda: LoadCase(name="x", loads={"Disk 1": "3 kg"}),
        "load case x.loads.Disk 1 = '3 kg': kg is not",
        "250 N*m",
    ),
    (
        lambda: Operation(load_cases=[LoadCase(name="a", loads={}), LoadCase(name="a", loads={})]),
        "operation.load_case = 'a': is the name of 2 load cases",
        "rename one",
    ),
    (
        lambda: line(operation=Operation(load_cases=[LoadCase(name="a", loads={"Dsk 1": 1})])),
        "load case a.Dsk 1 = 1: is not a Disk of this driveline",
        'did you mean "Disk 1"?',
    ),
    (
        lambda: line(operation=Operation(load_cases=[LoadCase(name="a", loads={"Shaft 1": 1})])),
        "load case a.Shaft 1 = 1: acts on a Shaft, not on a Disk",
        "Disk 1",
    ),
    (
        lambda: line(operation=Operation(load_cases=[LoadCase(name="a", factors={"Disk 1": 2})])),
        "load case a.Disk 1 = 2: is a factor on a Disk",
        "loads = {",
    ),
    (
        lambda: line(operation=Operation(load_cases=[LoadCase(name="a", factors={"Shaft 1": 2})])),
        "load case a.Shaft 1 = 2: is not a Fan, Pump, Propeller or Generator",
        "leave factors out",
    ),
    (lambda: LoadCase(name="a", factors={"fan": -1}), "load case a.factors.fan = -1: must not be negative", "write 0"),
    (lambda: LoadCase(name="a", factors=3), "load case a.factors = 3: is not a table of factors", "fan = 1.2"),
    (lambda: Schedule(travel=[0, 1], angles={"a": [0, 1]}), "schedule.name: is missing", "axle travel"),
    (lambda: Schedule(name="x", angles={"a": [0, 1]}), "schedule x.travel: has neither travel nor speed", "or speed"),
    (
        lambda: Schedule(name="x", travel=[0, 1], speed=[1, 2], angles={"a": [0, 1]}),
        "schedule x.travel = [0, 1]: has travel and speed at once",
        "or speed",
    ),
    (lambda: Schedule(name="x", travel=[0, 1]), "schedule x.angles: lets nothing follow", "loads by element"),
    (lambda: Schedule(name="x", travel=3), "schedule x.travel = 3: is not a list of values", "76 mm"),
    (lambda: Schedule(name="x", travel=[1, 0]), "schedule x.travel = [1, 0]: does not rise", "lowest first"),
    (
        lambda: Schedule(name="x", speed=[0, 9], loads={"a": [0, 1]}),
        "schedule x.speed = [0, 9]: must be positive",
        "still",
    ),
    (
        lambda: Schedule(name="x", travel=[0, 1], loads=[1]),
        "schedule x.loads = [1]: is not a table of lists",
        "250 N*m",
    ),
    (
        lambda: Schedule(name="x", travel=[0, 1], loads={"a": ["1 kg", 2]}),
        "schedule x.loads.a = ['1 kg', 2]: kg is not",
        "N*m",
    ),
    (
        lambda: Schedule(name="x", travel=[0, 1], loads={"a": 5}),
        "schedule x.loads.a = 5: is not a list of values",
        "250 N*m",
    ),
    (
        lambda: Schedule(name="x", travel=[0, 1], loads={"a": [1, 2, 3]}),
        "schedule x.loads.a: must have one value for each of 2 points, and has 3",
        "one value for each",
    ),
    (lambda: Operation(schedules=[AXLE, AXLE]), "operation.schedule = 'axle': is the name of 2", "rename one"),
    (
        lambda: line(operation=Operation(schedules=[AXLE])),
        "schedule axle.joint: is not a joint with an angle of this driveline",
        "there are none",
    ),
    (
        lambda: tn.stability_chart(
            line(operation=Operation(schedules=[Schedule(name="p", speed=[1, 2], loads={"Disk 1": [1, 2]})])),
            ("speed", 1, 2, 2),
            ("p", 1, 2, 2),
        ),
        "p: is a schedule, which moves several numbers along straight pieces, not a parameter",
        'ask line.at_schedule("p", value)',
    ),
    (
        lambda: line(operation=Operation(schedules=[Schedule(name="p", speed=[1, 2], loads={"Dsk 1": [1, 2]})])),
        "schedule p.Dsk 1: is not a Disk of this driveline",
        'did you mean "Disk 1"?',
    ),
    (
        lambda: line(
            ConstantSpeed(),
            Shaft(stiffness=1e4),
            Disk(inertia=1),
            HookeJoint(angle=0.1, name="joint"),
            Shaft(stiffness=1e4),
            Disk(inertia=1),
            operation=Operation(schedules=[Schedule(name="p", travel=[0, 1], angles={"joint": [0, 2]})]),
        ),
        "schedule p, joint.angle = 2",
        "deg",
    ),
    (lambda: line().at_schedule("axle", 0.0), "schedule = 'axle': is not a schedule", "there are none"),
    (lambda: tn.envelope(line(), points=1), "points = 1: must be a whole number, 2 or more", ""),
    (lambda: starter("tow-shaft"), "new = 'tow-shaft': is not a starter", 'did you mean "two-shaft"?'),
    (
        lambda: tn.export_line(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), "l.csv", "cvs"),
        "to = 'cvs': is not a target", 'did you mean "csv"?',
    ),
    (
        lambda: tn.export_line(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), "l.txt", "csv"),
        "output = 'l.txt': does not end in .csv", "a file for csv does",
    ),
    (
        lambda: tn.export_line(line(Disk(inertia=1), HookeJoint(angle=0.1), Disk(inertia=1)), "l.csv", "csv"),
        "HookeJoint 1.angle = 0.1: is bent", "write angle = 0",
    ),
    (
        lambda: tn.export_line(line(ConstantSpeed(), Shaft(stiffness=1), Disk(inertia=1)), "l.py", "opentorsion"),
        "ConstantSpeed 1: holds a rotation, which openTorsion does not", "a Disk with its inertia",
    ),
    (lambda: tn.import_line("l.mat"), "l.mat: cannot be imported", "export the line to csv"),
    (lambda: tn.import_line("none.csv"), "none.csv: file not found", "check the path"),
]  # fmt: skip


@pytest.mark.parametrize(("action", "start", "also"), PYTHON, ids=[row[1] for row in PYTHON])
def test_python(action, start, also):
    check(action, start, also)


HEAD = "format = 1\n"
JOINT = '[[element]]\ntype = "HookeJoint"\nangle = "12 deg"\n'
SHAFT = '[[element]]\ntype = "Shaft"\nstiffness = 1e4\n'
DISK = '[[element]]\ntype = "Disk"\ninertia = 1\n'

# (content of bad.toml, how the message starts, what it must also say)
FILES = [
    (HEAD + DISK + '[limit]\nof = "a"\n', "bad.toml: limit: is a single table", "[[limit]]"),
    ("limit = [3]\n" + HEAD + DISK, "bad.toml: limit 1 = 3: is not a table", "[[limit]]"),
    (HEAD + DISK + '[tolerance]\nof = "a"\n', "bad.toml: tolerance: is a single table", "[[tolerance]]"),
    ("tolerance = [3]\n" + HEAD + DISK, "bad.toml: tolerance 1 = 3: is not a table", "[[tolerance]]"),
    (
        HEAD + DISK + '[[tolerance]]\nof = "Disk 1"\ninertia = "5 kg"\n',
        "bad.toml: tolerance of Disk 1.inertia = '5 kg': kg is not",
        "kg*m^2",
    ),
    (HEAD + DISK + "[[limit]]\nmax_torque = 3\n", "bad.toml: limit 1.of: is missing", "of ="),
    (
        HEAD + DISK + '[[limit]]\nof = "Disk 1"\nmax_acceleration = "300"\n',
        "bad.toml: limit of Disk 1.max_acceleration = '300': has no unit",
        "rad/s^2",
    ),
    (HEAD + DISK + '[[limit]]\nof = "Disk"\nmax_acceleration = 3\n', "bad.toml: limit.of = 'Disk': is not", "Disk 1"),
    (b"", "bad.toml: is empty", "trunnion new two-shaft"),
    (b" \n\n", "bad.toml: is empty", "trunnion new two-shaft"),
    (b"\x89PNG\r\n\x1a\n\x00", "bad.toml: is not a text file in UTF-8", "save it as UTF-8"),
    (b"format = 1\x00", "bad.toml: is not a text file in UTF-8", "save it as UTF-8"),
    ('name = "Müller"'.encode("latin-1"), "bad.toml: is not a text file in UTF-8", "save it as UTF-8"),
    ((HEAD + DISK).encode("utf-16"), "bad.toml: is not a text file in UTF-8", "save it as UTF-8"),
    ("format 1", "bad.toml: is not valid TOML: Expected", "line 1, column 8"),
    (HEAD + JOINT + "plane = 12 deg\n", "bad.toml: is not valid TOML", "line 5, column 12"),
    ("format = 1\nformat = 1\n", "bad.toml: is not valid TOML", "line 2, column"),
    (
        HEAD + 'element = [\n  { type = "Disk",\n    inertia = 1 },\n]\n',
        "bad.toml: is not valid TOML: ",
        "write what stands in braces on one line",
    ),
    ("a = " + "[" * 5000, "bad.toml: is not valid TOML", ""),
    (DISK, "bad.toml: format: is missing", "write format = 1 in the first line"),
    ("format = 2\n" + DISK, "bad.toml: format = 2: is a later format", "install a newer Trunnion"),
    ("format = 0\n" + DISK, "bad.toml: format = 0: is not a known format", "write format = 1"),
    ('format = "1"\n' + DISK, "bad.toml: format = '1': is not a known format", "write format = 1"),
    ("format = true\n" + DISK, "bad.toml: format = true: is not a known format", "write format = 1"),
    ("formt = 1\n" + DISK, "bad.toml: formt = 1: unknown key", 'did you mean "format"?'),
    (HEAD + "[[elements]]\n", "bad.toml: elements = [{}]: unknown key", 'did you mean "element"?'),
    (HEAD, "bad.toml: element: has no elements", "[[element]]"),
    (HEAD + "element = []", "bad.toml: element = []: has no elements", "[[element]]"),
    (
        HEAD + "[[element]]\n" * 100_000,
        "bad.toml: driveline: has 100000 elements, at most 5000 are taken",
        "join neighbouring parts",
    ),
    (
        HEAD + DISK.replace("[[", "[").replace("]]", "]"),
        "bad.toml: element: is a single table",
        "double brackets",
    ),
    (HEAD + "element = [1]", "bad.toml: element 1 = 1: is not a table", "[[element]]"),
    (HEAD + SHAFT + "[[element]]\n", "bad.toml: element 2.type: is missing", 'type = "Shaft"'),
    (
        HEAD + '[[element]]\nkind = "Disk"\n',
        "bad.toml: element 1.type: is missing",
        "write type instead of kind",
    ),
    (
        HEAD + '[[element]]\ntype = "Shfat"\n',
        "bad.toml: element 1.type = 'Shfat': unknown element type",
        '"Shaft"',
    ),
    (HEAD + '[[element]]\ntype = "shaft"\n', "bad.toml: element 1.type = 'shaft': unknown", '"Shaft"'),
    (HEAD + "[[element]]\ntype = 3\n", "bad.toml: element 1.type = 3: unknown", "known: ConstantSpeed, Shaft"),
    (
        HEAD + '[[element]]\ntype = "Xyz"\nname = "rear"\n',
        "bad.toml: rear (element 1).type = 'Xyz': unknown element type",
        "known: ConstantSpeed, Shaft",
    ),
    (
        HEAD + SHAFT + DISK + SHAFT.replace("1e4", '"3 N*m"'),
        "bad.toml: Shaft 2 (element 3).stiffness = '3 N*m': N*m is not",
        "write N*m/rad",
    ),
    (
        HEAD + SHAFT + 'name = "rear tube"\ndampng = 3\n',
        "bad.toml: rear tube (element 1).dampng = 3: unknown key",
        'did you mean "damping"?',
    ),
    (
        HEAD + SHAFT + 'name = "rear tube"\nmax_torque = "2 kN*m"\n',
        "bad.toml: rear tube (element 1).max_torque = '2 kN*m': unknown key",
        'write [[limit]] with of = "rear tube" and max_torque',
    ),
    (
        HEAD + JOINT.replace("12", "95"),
        "bad.toml: HookeJoint 1 (element 1).angle = '95 deg': must be less",
        "deg",
    ),
    (
        HEAD + JOINT + "plane = nan\n",
        "bad.toml: HookeJoint 1 (element 1).plane = nan: must be finite",
        "12 deg",
    ),
    (
        HEAD + JOINT + "plane = -inf\n",
        "bad.toml: HookeJoint 1 (element 1).plane = -inf: must be finite",
        "12 deg",
    ),
    (HEAD + JOINT + "plane = 1979-05-27\n", "bad.toml: HookeJoint 1 (element 1).plane = ", "not a date"),
    (HEAD + JOINT + "name = 3\n", "bad.toml: HookeJoint 1 (element 1).name = 3: is not a name", "one line"),
    (
        HEAD + DISK + 'name = "a"\n' + SHAFT + 'name = "a"\n',
        "bad.toml: a.name: names elements 1 and 2",
        "rename",
    ),
    (
        HEAD + DISK + SHAFT + 'after = "Dsk 1"\n',
        "bad.toml: Shaft 1.after = 'Dsk 1': is not an earlier",
        '"Disk 1"',
    ),
    (HEAD + "operation = 3\n" + DISK, "bad.toml: operation = 3: is not a table", "[operation]"),
    (HEAD + "[operation]\nsped = 3\n" + DISK, "bad.toml: operation.sped = 3: unknown key", '"speed"'),
    (
        HEAD + '[operation]\nspeed_range = ["600 rpm", "300 rpm"]\n' + DISK,
        "bad.toml: operation.speed_range = ['600 rpm', '300 rpm']: is reversed",
        "the lower first",
    ),
    (
        HEAD + "[[operation]]\nspeed = 3\n" + DISK,
        "bad.toml: operation = [{'speed': 3}]: is not a table",
        "[operation]",
    ),
    (
        HEAD + "[operation.load_case]\n" + DISK,
        "bad.toml: operation.load_case: is a single table",
        "double brackets",
    ),
    (
        HEAD + "[[operation.load_cases]]\n" + DISK,
        "bad.toml: operation.load_cases: unknown key",
        '"load_case"',
    ),
    (
        HEAD + "[operation]\nload_case = [1]\n" + DISK,
        "bad.toml: load case 1 = 1: is not a table",
        "load_case]]",
    ),
    (
        HEAD + '[[operation.load_case]]\nname = "a"\n' + DISK,
        "bad.toml: load case a.loads: is missing",
        "250 N*m",
    ),
    (
        HEAD + "[[operation.load_case]]\nloads = {}\n" + DISK,
        "bad.toml: load case 1.name: is missing",
        "full load",
    ),
    (
        HEAD + '[[operation.load_case]]\nname = "a"\nloads = 3\n' + DISK,
        "bad.toml: load case a.loads = 3: is not a table of torques",
        "250 N*m",
    ),
    (
        HEAD + '[[operation.load_case]]\nname = "a"\nload = {}\n' + DISK,
        "bad.toml: load case a.load = {}: unknown key",
        'did you mean "loads"?',
    ),
    (
        HEAD + '[[operation.load_case]]\nname = "a"\nloads = { "Disk 2" = 1 }\n' + DISK,
        "bad.toml: load case a.Disk 2 = 1: is not a Disk of this driveline",
        'did you mean "Disk 1"?',
    ),
    (
        HEAD + '[operation]\napplication = "boat"\n' + DISK,
        "bad.toml: operation.application = 'boat': is not an",
        "road",
    ),
    (
        HEAD + '[[operation.switched_off]]\nrule = "bending"\n' + DISK,
        "bad.toml: switched-off rule bending.reason: is missing",
        'reason = "measured on the vehicle"',
    ),
    (
        HEAD + '[[operation.switched_off]]\nrule = "stability"\nreason = "it is fine"\n' + DISK,
        "bad.toml: switched-off rule stability.rule = 'stability': cannot be switched off",
        "breaks the line",
    ),
    (
        HEAD + '[operation.switched_off]\nrule = "bending"\nreason = "x"\n' + DISK,
        "bad.toml: operation.switched_off: is a single table",
        "double brackets",
    ),
    (
        HEAD + "[operation.schedule]\n" + DISK,
        "bad.toml: operation.schedule: is a single table",
        "double brackets",
    ),
    (
        HEAD + '[[operation.duty]]\nshare = "90 %"\nspeed = "900 rpm"\n' + DISK,
        "bad.toml: operation.duty: has shares that add up to 0.9, not to 1",
        "rest",
    ),
    (HEAD + '[[operation.duty]]\nshare = "90 %"\n' + DISK, "bad.toml: duty 1.speed: is missing", "1500 rpm"),
    (HEAD + "[operation.passage]\n" + DISK, "bad.toml: operation.passage: is a single table", "double brackets"),
    (HEAD + "[operation]\npassages = []\n" + DISK, "bad.toml: operation.passages: unknown key", 'mean "passage"'),
    (
        HEAD + '[[sn_curve]]\nof = "Disk 1"\ncycles = 1e6\n' + DISK,
        "bad.toml: S-N curve of Disk 1.slope: is missing",
        "2e6",
    ),
    (HEAD + "[operation]\nschedule = [1]\n" + DISK, "bad.toml: schedule 1 = 1: is not a table", "schedule]]"),
    (
        HEAD + '[[operation.schedule]]\ntravel = [0, 1]\nloads = { "Disk 1" = [1, 2] }\n' + DISK,
        "bad.toml: schedule 1.name: is missing",
        "axle travel",
    ),
    (
        HEAD + "damping_ratio = 0.02\n" + SHAFT + "damping = 3\n",
        "bad.toml: Shaft 1.damping = 3: conflicts with",
        "out",
    ),
]


@pytest.mark.parametrize(("content", "start", "also"), FILES, ids=[f"{i}: {row[1]}" for i, row in enumerate(FILES)])
def test_file(content, start, also, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "bad.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    before = path.read_bytes()
    check(lambda: load("bad.toml"), start, also)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["bad.toml"]


MILL = """
[[element]]
type = "Disk"
name = "motor"
inertia = "1 kg*m^2"
drive_share = 1
{motor}
[[element]]
type = "Shaft"
name = "spindle"
stiffness = "1 kN*m/rad"
damping = "2 N*m*s/rad"

[[element]]
type = "Disk"
name = "roll"
inertia = "1 kg*m^2"
"""
HELD = """
[[element]]
type = "ConstantSpeed"

[[element]]
type = "Disk"
name = "flywheel"
inertia = "1 kg*m^2"
excitation = [{ order = 2, amplitude = "40 N*m" }]

[[element]]
type = "HookeJoint"
angle = "5 deg"
""" + MILL.split("drive_share = 1\n{motor}")[1]
TORQUES = 'excitation = [{ order = 2, speeds = ["600 rpm", "900 rpm"], amplitudes = ["3 N*m", "4 N*m"] }]'
RANGE = """
[operation]
speed = "800 rpm"
speed_range = ["600 rpm", "1500 rpm"]
"""

# What an engineer leaves out or mistakes of excitations and limits: the file, and what `assess` answers. What is wrong
# is refused where the file is read; what makes an answer empty is said in it.
ENGINEER = [
    (
        MILL.format(motor="excitation = [{ order = 2 }]"),
        "refused",
        "motor (element 1).excitation 1 amplitude: is missing",
    ),
    (
        '[[limit]]\nof = "spindle"\nmax_torque = "400"\n' + MILL.format(motor=""),
        "refused",
        "has no unit; write a torque",
    ),
    (
        '[[limit]]\nof = "roll"\nmax_torque = "400 N*m"\n' + MILL.format(motor=""),
        "refused",
        "does not belong to a Disk; it limits Shaft",
    ),
    (
        '[[limit]]\nof = "spindle"\nmax_acceleration = "400 rad/s^2"\n' + MILL.format(motor=""),
        "refused",
        "does not belong to a Shaft; it limits Disk",
    ),
    (
        '[[limit]]\nof = "spindle"\nmax_torque = "400 N*m"\n' + MILL.format(motor=TORQUES),
        "not judged",
        "900 rpm to 1500 rpm not judged: the table of motor covers 600 rpm to 900 rpm; extend it",
    ),
    (MILL.format(motor=""), "said", "Nothing excites this line."),
    (HELD.replace("excitation", "# excitation"), "said", "Nothing excites this line but its joints."),
    (
        HELD,
        "said",
        "flywheel.excitation: does nothing, a ConstantSpeed holds its rotation; leave out the ConstantSpeed",
    ),
]


@pytest.mark.parametrize(("content", "how", "words"), ENGINEER, ids=[row[2] for row in ENGINEER])
@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
def test_what_an_engineer_leaves_out(content, how, words):
    text = HEAD + RANGE + content
    if how == "refused":
        check(lambda: loads(text), "", words)
        return
    judged = assess(loads(text))
    if how == "said":
        assert any(words in finding.sentence for finding in judged.findings), judged.findings
        return
    assert str(judged.verdict) == "not judged"
    assert words in judged.check("max torque of spindle").because


def test_text_without_a_file_has_no_prefix():
    check(lambda: loads(HEAD), "element: has no elements", "[[element]]")


def test_file_not_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    check(lambda: load("truck.toml"), "truck.toml: file not found", "trunnion new two-shaft")
    (tmp_path / "truck.toml").write_text(starter("truck"))
    check(lambda: load("trukc.toml"), "trukc.toml: file not found", 'did you mean "truck.toml"?')
    check(lambda: load("no/such/folder.toml"), "no/such/folder.toml: file not found", "check the path")


def test_a_folder_is_not_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drives").mkdir()
    check(lambda: load("drives"), "drives: is a folder", "name the driveline file in it")
    check(lambda: dump(line(), "drives"), "drives: is a folder", "name a file in it")
    assert os.listdir("drives") == []


def test_output_not_writable(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    check(lambda: dump(line(), "no/such/a.toml"), "no/such/a.toml: cannot be written", "check that the folder")
    (tmp_path / "file").write_text("x")
    check(lambda: dump(line(), "file/a.toml"), "file/a.toml: cannot be written", "check that the folder")
    assert os.listdir(tmp_path) == ["file"]


def test_missing_permissions(tmp_path, monkeypatch):
    def deny(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pathlib.Path.open", deny)  # real modes would not bind an administrator
    monkeypatch.setattr("pathlib.Path.write_text", deny)
    check(lambda: load("secret.toml"), "secret.toml: cannot be read (Permission denied)", "check")
    check(lambda: dump(line(), "new.toml"), "new.toml: cannot be written (Permission denied)", "may write")


def check(action, start, also):
    with pytest.raises(InputError) as caught:
        action()
    message = str(caught.value)
    assert message.startswith(start)
    assert also in message
    assert "\n" not in message
    assert len(message) < 320
    assert not re.search(r"pydantic|Traceback|validation error", message)
    assert caught.value.exit_code == 2
    assert caught.value.__suppress_context__ or caught.value.__context__ is None
