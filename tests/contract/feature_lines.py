"""A line with and without each feature of ``trunnion.driveline.features``.

The lines that features are put into have a Shaft "front", a Disk "hub", a shaft "rear" and a Disk "load".
"""

from __future__ import annotations

from collections.abc import Callable

from joints import JOINTS

import trunnion as tn
from trunnion.driveline.features import FEATURES

Change = Callable[[tn.Driveline], tn.Driveline]


def bent() -> tn.Driveline:
    """Two Hooke's joints."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            tn.HookeJoint(angle=0.2, name="joint"),
            tn.Shaft(stiffness=1e4, damping=5, name="front"),
            tn.Disk(inertia=0.1, name="hub"),
            tn.HookeJoint(angle=0.15, plane=0.3, name="joint 2"),
            tn.Shaft(stiffness=1e4, damping=5, name="rear"),
            tn.Disk(inertia=0.2, load_torque=20, name="load"),
        ]
    )


def straight() -> tn.Driveline:
    """A shaft with stages and an excitation, for what is exact stage by stage."""
    stages = [(5e3, 0.001), (1e4, None)]
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            tn.Shaft(stiffness=1e4, damping=5, name="front"),
            tn.Disk(inertia=0.1, name="hub"),
            tn.PiecewiseShaft.symmetric(stages, damping=5, name="rear"),
            tn.Disk(inertia=0.2, load_torque=20, excitation=[{"order": 1, "amplitude": 3.0}], name="load"),
        ]
    )


def with_tube() -> tn.Driveline:
    """A steel tube behind the hub."""
    steel = {"shear_modulus": 8e10, "density": 7850.0}
    return swap(bent(), "rear", tn.Shaft(outer_diameter=0.05, length=0.5, damping=5, name="rear", **steel))


def same(line: tn.Driveline) -> tn.Driveline:
    return line


def put(name: str, **changes: object) -> Change:
    return lambda line: line.replace(name, **changes)


def swap(line: tn.Driveline, name: str, *new: tn.Driveline) -> tn.Driveline:
    place = line.index(name)
    return tn.Driveline([*line.elements[:place], *new, *line.elements[place + 1 :]])


def swinging(share: float) -> tn.Driveline:
    """Free–free, unstable about its own motion beside 110 rad/s; ``share`` of its middle disk in the drive."""
    return tn.Driveline([
        tn.Disk(inertia=1.3, drive_share=1.0), tn.HookeJoint(angle=0.35), tn.Shaft(stiffness=9e3, damping=3.0),
        tn.Disk(inertia=0.7, drive_share=share), tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=6e3, damping=2.0),
        tn.Disk(inertia=0.9, viscous_load=0.8),
    ])  # fmt: skip


def front(shaft: tn.Shaft | tn.PiecewiseShaft) -> Change:
    return lambda line: swap(line, "front", shaft)


def behind(name: str, *new: object) -> Change:
    def change(line: tn.Driveline) -> tn.Driveline:
        place = line.index(name) + 1
        return tn.Driveline([*line.elements[:place], *new, *line.elements[place:]])

    return change


def meshed(**more: object) -> Change:
    gears = {"teeth_out": 40, "mesh_damping": 500.0, "name": "mesh"} | more
    pair = tn.GearPair(teeth_in=25, module="3 mm", mesh_stiffness=1e8, **gears)
    return behind("hub", pair, tn.Disk(inertia=0.05, name="pinion"))


def planetary() -> tn.Planetary:
    """A step down with heavy planets."""
    return tn.Planetary(
        teeth_sun=30, teeth_ring=72, input="sun", held="ring", planet_inertia=1e-3, planet_mass=0.8,
        centre_distance=0.08, name="gears",
    )  # fmt: skip


def unbent(line: tn.Driveline) -> tn.Driveline:
    """All joints straight and linear springs alone."""
    elements = [tn.IdealJoint(name=name) if "joint" in name else element for name, element in line.parts]
    springs = [tn.Shaft(stiffness=1e4, damping=5, name=e.name) if e.kind == "PiecewiseShaft" else e for e in elements]
    return tn.Driveline(springs, operation=line.operation, limits=line.limits, tolerances=line.tolerances)


def tied(line: tn.Driveline, straight: bool = True) -> tn.Driveline:
    """The same with a differential behind the hub, whose right leg carries what the left one does."""
    line = unbent(line) if straight else line
    place, load = line.index("hub") + 1, line.elements[-1]
    legs = (
        tn.Differential(ratio=2, inertia=0.02, name="gears"),
        tn.Disk(inertia=0.03, name="right", after="gears.right"),
        tn.Shaft(stiffness=8e3, damping=5, name="axle"),
        tn.Disk(inertia=0.2, load_torque=getattr(load, "load_torque", 0.0), name="wheel"),
        tn.Disk(inertia=0.03, name="left", after="gears.left"),
    )
    return line.but(elements=[*line.elements[:place], *legs, *line.elements[place:]])


def tube(**more: float) -> Change:
    return front(tn.Shaft(outer_diameter=0.05, length=0.5, shear_modulus=8e10, density=800.0, name="front", **more))


def staged(**more: object) -> Change:
    return front(tn.PiecewiseShaft.symmetric([(5e3, 0.01), (1e4, None)], damping=5, name="front", **more))


def jointed(joint: object) -> Change:
    """Behind the hub, an element of its own for the joint to hang on."""
    return behind("front", tn.Disk(inertia=0.05, name="carrier"), joint, tn.Shaft(stiffness=2e4, name="middle"))


def flywheel(**more: object) -> Change:
    """A disk that the drive holds."""
    return behind("drive", tn.Disk(inertia=0.5, name="flywheel", **more))


def in_series(first: float, second: float) -> Change:
    """Two equal shafts in place of the front one, by their damping."""
    half = [tn.Shaft(stiffness=2e4, damping=c, name=n) for c, n in ((first, "front"), (second, "front 2"))]
    return lambda line: swap(line, "front", *half)


def undamped(ratio: float | None) -> Change:
    def change(line: tn.Driveline) -> tn.Driveline:
        elements = [type(e)(**{k: v for k, v in e.stated.items() if k != "damping"}) for e in line.elements]
        return tn.Driveline(elements, damping_ratio=ratio)

    return change


def free(line: tn.Driveline) -> tn.Driveline:
    return swap(line, "drive", tn.Disk(inertia=0.3, drive_share=1.0, name="engine"))


def beside_the_hub(*side: object) -> Change:
    """A branch at the hub; the last element stays the last."""

    def change(line: tn.Driveline) -> tn.Driveline:
        place = line.index("hub") + 1
        onward = line.elements[place]
        onward = type(onward)(**{**onward.stated, "after": "hub"})
        return line.but(elements=[*line.elements[:place], *side, onward, *line.elements[place + 1 :]])

    return change


branched = beside_the_hub(tn.Shaft(stiffness=1e4, damping=5, name="side"), tn.Disk(inertia=0.05, name="pump"))
SIDE = tn.Shaft(stiffness=1e4, damping=5, name="side")
TYRE = tn.Tyre(stiffness=1e4, damping=5, name="tyre")
SLIP = TYRE.but(slip_stiffness=4e3, radius=0.1, travel_speed=8.0, inertia=0.01)


def rolling(tyre: object = SIDE, **vehicle: float) -> Change:
    """A vehicle beside the hub."""
    return beside_the_hub(tyre, tn.Vehicle(**{"mass": 8.0, "wheel_radius": 0.1, "name": "car"} | vehicle))


HEAVY = {"mass": 200.0, "wheel_radius": 0.02}


def clutch(rubs: bool = False, **more: float) -> Change:
    stages = {"breakpoints": [-0.002, 0.002], "stiffnesses": [1.2e4, 1e4, 1.2e4], "damping": 5, "name": "front"}
    if not rubs:
        return front(tn.PiecewiseShaft(**stages))
    return front(tn.Clutch(**stages, friction=[{"torque": 0.5, "stiffness": 2e4}], **more))


def coupled(**more: object) -> Change:
    """An elastic coupling in front."""
    return front(tn.Coupling(damping=5, name="front", **more))


def clutched(**more: float) -> Change:
    """A slip clutch behind the hub."""
    return behind("hub", tn.SlipClutch(name="slips", **more), tn.Disk(inertia=0.05, name="plate"))


def rippled() -> Change:
    ripple = [{"order": 1, "amplitude": 0.01}, {"order": 6, "amplitude": 2e-3, "phase": 0.3}]
    return jointed(tn.RzeppaJoint(angle=0.3, ripple=ripple, name="extra"))


def damped_by(damper: object) -> Change:
    """A damper on the hub."""
    return behind("hub", damper)


def oiled() -> tn.ViscousDamper:
    """With oil by its complex stiffness over all frequencies that are asked of."""
    table = [{"frequency": 10.0**k, "stiffness": 3.0 * 2**k, "loss_stiffness": 12.0 * 3**k} for k in range(-2, 8)]
    return tn.ViscousDamper(ring_inertia=0.03, oil=table, oil_frequency=200.0)


def pendulum() -> tn.CentrifugalPendulum:
    """One that counts beside the hub."""
    return tn.CentrifugalPendulum(mass=2.0, radius=0.1, order=2.0, damping=0.05, name="pendulum")


def machine(one: object) -> Change:
    """On the hub."""
    return behind("hub", one)


def flanged(one: object) -> Change:
    """Behind the hub."""
    return behind("hub", one)


def asynchronous(**more: int) -> tn.Generator:
    """By Kloss's formula."""
    numbers = {"breakdown_torque": 40.0, "breakdown_slip": 0.3, "synchronous_speed": 120.0}
    return tn.Generator(inertia=0.05, name="pump", **numbers, **more)


END = (tn.Shaft(stiffness=1e4, damping=5, name="end"), tn.ConstantSpeed(name="far"))
STRAIGHT_JOINT = jointed(tn.IdealJoint(name="extra"))
OWN = {one.key for one in FEATURES}
"""Among them the names of joints that are features of their own."""
CENTRED = jointed(tn.DoubleCardanJoint(angle=0.3, name="extra"))


YIELDING = planetary().but(sun_mesh_stiffness=1e7, ring_mesh_stiffness=1e7, module=0.002)
PINION = tn.Disk(inertia=0.01, name="behind gears")


def behind_hub(*elements: object) -> Change:
    """Behind the hub of a straight line."""
    return lambda line: behind("hub", *elements)(unbent(line))


def looped(line: tn.Driveline, straight: bool = True) -> tn.Driveline:
    """The same with a second shaft beside the rear one, from the hub to the load."""
    line = unbent(line) if straight else line
    place = line.index("load") + 1
    second = tn.Shaft(stiffness=4e3, damping=3, name="second", after="hub", to="load")
    return line.but(elements=[*line.elements[:place], second, *line.elements[place:]])


CONVERTER = tn.TorqueConverter(
    curves=[
        {"speed_ratio": v, "torque_ratio": m, "capacity": k}
        for v, m, k in ((0.0, 2.0, 6e-3), (0.6, 1.3, 5.5e-3), (0.85, 1.0, 4e-3), (1.0, 1.0, 0.0))
    ],
    inertia_in=0.03,
    inertia_out=0.02,
    name="converter",
)
"""One that carries 20 N m at 100 rad/s."""


def converting(locked: bool) -> Change:
    """Behind the hub of a straight line."""
    return lambda line: behind("hub", CONVERTER.but(locked=locked))(unbent(line))


def excited(change: Change) -> Change:
    return lambda line: change(line).replace("load", excitation=[{"order": 2, "amplitude": 5.0}])


OTHERS: dict[tuple[str, str], tuple[Change, Change]] = {
    **{
        (name, "drive share"): (
            lambda line: put("load", load_torque=80.0)(free(line)),
            lambda line: put("load", load_torque=80.0)(free(line)).replace("hub", drive_share=0.5),
        )
        for name in ("stability_chart", "stable_limit", "tolerance_study")
    },
    **{
        (name, "drive share"): (lambda line: swinging(0.0), lambda line: swinging(0.5))
        for name in ("tongues", "stable_windows", "minimum_damping")
    },
    ("resonance_speeds", "shafts tied to two others"): (same, lambda line: tied(line, straight=False)),
    ("resonance_speeds", "closed loop"): (same, lambda line: looped(line, straight=False)),
    ("phase_forks", "centrifugal pendulum"): (same, damped_by(pendulum())),
    ("assembly_sensitivity", "centrifugal pendulum"): (same, damped_by(pendulum())),
    ("optimise", "centrifugal pendulum"): (excited(unbent), excited(lambda line: damped_by(pendulum())(unbent(line)))),
    ("fatigue", "centrifugal pendulum"): (excited(unbent), excited(lambda line: damped_by(pendulum())(unbent(line)))),
    ("optimise", "closed loop"): (excited(unbent), excited(looped)),
    ("resonance_speeds", "elastic teeth of planets"): (behind("hub", planetary()), behind("hub", YIELDING, PINION)),
    ("optimise", "elastic teeth of planets"): (excited(behind_hub(planetary())), excited(behind_hub(YIELDING, PINION))),
    ("fatigue", "elastic teeth of planets"): (excited(behind_hub(planetary())), excited(behind_hub(YIELDING, PINION))),
    ("optimise", "shafts tied to two others"): (excited(unbent), excited(tied)),
    **{
        (name, "torque converter"): (excited(converting(locked=True)), excited(converting(locked=False)))
        for name in ("optimise", "fatigue")
    },
    **{
        (name, "slip clutch"): (clutched(torque=1e3), clutched(torque=900.0))
        for name in ("periodic_response", "linearity_check")
    },
    ("campbell_diagram", "torque converter"): (
        lambda line: put("load", load_torque=0.5)(converting(locked=True)(line)),
        lambda line: put("load", load_torque=0.5)(converting(locked=False)(line)),
    ),
}
"""Where an analysis asks about something else than the lines below have."""
CHANGES: dict[str, tuple[Change, Change]] = {
    "inertia": (same, put("hub", inertia=0.15)),
    "stiffness": (same, put("front", stiffness=2e4)),
    "stiffness over mean torque": (
        coupled(stiffness=1e4), coupled(torques=[0.0, 30.0, 200.0], stiffnesses=[4e3, 2.5e4, 3e4])
    ),
    "temperature of a coupling": (
        coupled(stiffness=1e4),
        coupled(stiffness=1e4, temperature=350.0, temperatures=[300.0, 360.0], stiffness_factors=[1.0, 0.6]),
    ),
    "viscous damper": (same, damped_by(tn.ViscousDamper(ring_inertia=0.03, damping=4.0, stiffness=900.0))),
    "oil over frequency": (
        damped_by(tn.ViscousDamper(ring_inertia=0.03, damping=4.0, stiffness=900.0)), damped_by(oiled())
    ),
    "damper without a spring": (same, damped_by(tn.ViscousDamper(inertia=0.02, ring_inertia=0.03, damping=4.0))),
    "tuned damper": (same, damped_by(tn.TunedDamper(ring_inertia=0.03, stiffness=2e3, damping=1.0))),
    "centrifugal pendulum": (unbent, lambda line: damped_by(pendulum())(unbent(line))),
    "tube inertia": (tube(), lambda line: tube()(line).replace("front", density=7850.0)),
    "bending stiffness": (tube(), tube(young_modulus=1e11)),
    "damping": (same, put("front", damping=9.0)),
    "loss factor": (
        put("front", damping=None),
        put("front", damping=None, loss_factor=0.1, loss_factor_frequency=200.0),
    ),
    "damping ratio": (undamped(0.02), undamped(0.05)),
    "Hooke's joint": (STRAIGHT_JOINT, jointed(tn.HookeJoint(angle=0.3, name="extra"))),
    "fork offset": (same, put("front", fork_offset=0.5)),
    "joint plane": (
        jointed(tn.HookeJoint(angle=0.3, name="extra")), jointed(tn.HookeJoint(angle=0.3, plane=1.0, name="extra"))
    ),
    "angle of an ideal joint": (STRAIGHT_JOINT, jointed(tn.IdealJoint(angle=0.3, name="extra"))),
    "tripod joint": (STRAIGHT_JOINT, jointed(tn.TripodJoint(angle=0.3, radius=0.05, length=0.5, name="extra"))),
    "ripple of a Rzeppa joint": (STRAIGHT_JOINT, rippled()),
    "double Cardan joint": (STRAIGHT_JOINT, CENTRED),
    "double Cardan joint off centre": (
        CENTRED, jointed(tn.DoubleCardanJoint(angle=0.3, distance_ratio=1.3, name="extra"))
    ),
    **{name: (STRAIGHT_JOINT, jointed(joint.but(name="extra"))) for name, joint in JOINTS.items() if name in OWN},
    "ratio": (same, behind("hub", tn.Ratio(ratio=2, name="gears"))),
    "dual-mass flywheel": (
        same,
        front(tn.DualMassFlywheel(
            primary_inertia=0.1, secondary_inertia=0.04, stiffnesses=[1e4], damping=5, name="front"
        )),
    ),
    "belt": (
        same, behind("hub", tn.Belt(radius_in=0.06, radius_out=0.12, span_stiffness=1e6, damping=2.0, inertia_out=0.02))
    ),
    "tyre": (same, rolling(TYRE)),
    "slip of a tyre": (rolling(TYRE), rolling(SLIP)),
    "vehicle": (same, rolling()),
    "rolling resistance": (rolling(**HEAVY), rolling(**HEAVY, rolling_resistance=0.05, grade=2.0)),
    "air drag": (rolling(), rolling(drag_area=8.0)),
    "planetary set": (same, behind("hub", planetary())),
    "shafts tied to two others": (unbent, tied),
    "closed loop": (unbent, looped),
    "elastic teeth of planets": (behind_hub(planetary()), behind_hub(YIELDING, PINION)),
    "gear mesh": (same, meshed()),
    "gear losses": (meshed(teeth_out=25), meshed(teeth_out=25, efficiency=0.8, drag_torque=3.0)),
    "mesh damping": (meshed(), meshed(mesh_damping=5000.0)),
    "impact damping": (
        meshed(teeth_out=25, backlash=1e-4),
        meshed(teeth_out=25, backlash=1e-4, impact_damping=1e9),
    ),
    "backlash": (meshed(teeth_out=25), meshed(teeth_out=25, backlash=1e-4)),  # 1:1, so that the phases of joints tell
    "transmission error": (meshed(), meshed(transmission_error=[{"amplitude": 1e-5}])),
    "mesh-stiffness variation": (meshed(), meshed(stiffness_variation=[{"share": 0.2}])),
    "stages": (same, staged()),
    "damping in contact only": (staged(), staged(damping_law="in contact")),
    "dry friction": (clutch(), clutch(True)),
    "dry friction at one motion": (clutch(), clutch(True, linear_amplitude=0.001, linear_frequency=200.0)),
    "slip clutch": (clutched(torque=1e3), clutched(torque=24.0, sliding_torque=20.0, stribeck_speed=0.5)),
    "torque converter": (converting(locked=True), converting(locked=False)),
    "locked torque converter": (same, behind("hub", CONVERTER.but(locked=True))),
    "load torque": (same, put("load", load_torque=80.0)),
    "brake": (
        flanged(tn.Disk(inertia=0.02, name="brake")), flanged(tn.Brake(inertia=0.02, torque=15.0, name="brake"))
    ),
    "viscous load": (same, put("load", viscous_load=0.5)),
    "quadratic load": (same, put("load", quadratic_load=0.005)),
    "torque curve": (machine(tn.Pump(inertia=0.05, load_torque=15.0, name="pump")), machine(asynchronous())),
    "lag of a motor": (machine(asynchronous()), machine(asynchronous(pole_pairs=2))),
    "excitation by order": (same, put("load", excitation=[{"order": 2, "amplitude": 5.0}])),
    "excitation in time": (same, put("load", excitation=[{"frequency": 100.0, "amplitude": 9.0}])),
    "excitation by order and frequency": (
        same, put("load", excitation=[{"order": -1, "frequency": 300.0, "amplitude": 9.0}])
    ),
    "excitation of a prescribed disk": (flywheel(), flywheel(excitation=[{"order": 2, "amplitude": 50.0}])),
    "unlike damping in series": (in_series(10.0, 10.0), in_series(16.0, 4.0)),
    "excitation that varies with speed or load": (
        same, put("load", excitation=[{"order": 2, "quadratic_amplitude": 5e-4}])
    ),
    "cylinders": (
        put("load", excitation=[{"order": 2, "amplitude": 5.0}]),
        put("load", excitation=[{"order": 2, "amplitude": 5.0}], firing_angles=[0.0, 0.3]),
    ),
    "engine": (
        same,
        behind(
            "load",
            tn.Shaft(stiffness=3e4, damping=5, name="coupling"),
            tn.Engine(
                firing_order="1-2", throw_inertia=[0.05, 0.06], throw_stiffness=2e4, damping=3, name="engine",
                gas_torque=[{"order": 1, "amplitude": 4.0}],
            ),
        ),
    ),
    "branch": (same, branched),
    "free start": (same, free),
    "drive share": (free, lambda line: free(line).replace("hub", drive_share=0.5)),
    "prescribed far end": (same, lambda line: tn.Driveline([*line.elements, *END])),
}  # fmt: skip
