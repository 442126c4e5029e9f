"""What a driveline can have that an analysis may count, refuse or leave out: one list, by field of the description.

``trunnion.features`` crosses it with the analyses. Every field of every element belongs to a feature (or to
``NOT_FEATURES``, with the reason), which the tests hold.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from trunnion.driveline.belts import Belt
from trunnion.driveline.brakes import Brake
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.dampers import Damper, TunedDamper, ViscousDamper
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.duty import Duty, SpeedPassage
from trunnion.driveline.elements import ConstantSpeed, Element, Rotor
from trunnion.driveline.engine import Engine
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.flywheels import DualMassFlywheel
from trunnion.driveline.joints import Joint
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import Limit
from trunnion.driveline.machines import KLOSS, lagging
from trunnion.driveline.parts import Tied
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.remarks import DRAGGED, HELD, LAG, OIL, SERIES, prescribed_excitations, unlike_in_series
from trunnion.driveline.shafts import SpringElement
from trunnion.driveline.sheet import Sheet
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.sn_curves import SNCurve
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.title_block import TitleBlock
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.driveline.vehicle import Tyre, Vehicle

Finder = Callable[[Driveline], list[str]]


@dataclass(frozen=True)
class Feature:
    """One thing that a line may have.

    ``key`` names it in tables; ``fields`` are those of the description that state it, as "Disk.load_torque";
    ``find`` gives where a line has it ("flywheel.load_torque"), by default where a field is neither empty nor zero.
    """

    key: str
    fields: tuple[str, ...] = ()
    find: Finder | None = None

    def places(self, line: Driveline) -> tuple[str, ...]:
        """Where ``line`` has it: "element.key", or the element alone."""
        if self.find is not None:
            return tuple(self.find(line))
        return tuple(
            f"{name}.{key}"
            for name, element in line.parts
            for kind, key in (field.split(".") for field in self.fields)
            if element.kind == kind and getattr(element, key, None)
        )


def _where(kind: type[Element], key: str, test: Callable[[Any], object]) -> Finder:
    """Finds elements of a kind that pass a test, and names their ``key``."""
    return lambda line: [f"{name}.{key}" for name, e in line.parts if isinstance(e, kind) and test(e)]


def _excited(test: Callable[[Excitation], object]) -> Finder:
    return _where(Rotor, "excitation", lambda rotor: any(map(test, rotor.excitation)))


def _dry_friction(at_one_motion: bool) -> Finder:
    return _where(
        Clutch, "friction", lambda one: bool(one.friction) and (one.linear_amplitude is not None) is at_one_motion
    )


def _kind(kind: type[Element]) -> Finder:
    return lambda line: [name for name, element in line.parts if isinstance(element, kind)]


def _curves(line: Driveline) -> list[str]:
    return [f"torque of {name}" for name, element in line.parts if isinstance(element, Rotor) and element.tangent]


def _lags(line: Driveline) -> list[str]:
    return [f"lag of {name}" for name in lagging(line.parts)]


def _dragged(line: Driveline) -> list[str]:
    rings = [f"ring of {name}" for name, element in line.parts if isinstance(element, Damper) and element.dragged]
    return rings + [line.spring_name((i,), 1) for i, e in enumerate(line.elements) if isinstance(e, Tyre) and e.slips]


def _branches(line: Driveline) -> list[str]:
    return [n for n, p, i in zip(line.names, line.parents, range(len(line.names)), strict=True) if i and p != i - 1]


def _free(line: Driveline) -> list[str]:
    return [] if isinstance(line.elements[0], ConstantSpeed) else [line.names[0]]


def _prescribed_end(line: Driveline) -> list[str]:
    return [n for n, e in zip(line.names[1:], line.elements[1:], strict=True) if isinstance(e, ConstantSpeed)]


SPRINGS = [name for name, kind in KINDS.items() if issubclass(kind, SpringElement | PiecewiseShaft)]
JOINTS = {name: kind for name, kind in KINDS.items() if issubclass(kind, Joint)}
_LISTED = ("HookeJoint", "IdealJoint", "TripodJoint", "RzeppaJoint", "DoubleCardanJoint")
"""Joints whose features stand in the list; one of another kind is a feature of its own, called as the kind."""
_OTHER_JOINTS = tuple(
    Feature(name, tuple(f"{name}.{key}" for key in kind.model_fields if key not in (*Element.model_fields, "plane")))
    for name, kind in JOINTS.items()
    if name not in _LISTED
)
UNEVEN = (
    "Hooke's joint", "tripod joint", "ripple of a Rzeppa joint", "double Cardan joint off centre",
    *(one.key for one in _OTHER_JOINTS),
)  # fmt: skip
"""Features of joints that do not pass rotation unchanged."""


MACHINES = ("Motor", "Generator", "Fan", "Pump", "Propeller")
_STAGED = ("PiecewiseShaft", "Clutch", "DualMassFlywheel")
_MESHED = ("Ratio", "GearPair", "Belt", "Differential")
_DAMPER = ("inertia", "ring_inertia", "damping", "stiffness")


def _of(name: str, *keys: str) -> tuple[str, ...]:
    """Some fields of a kind of element."""
    return tuple(f"{name}.{key}" for key in keys)


def _of_springs(*keys: str) -> tuple[str, ...]:
    """Some fields of every kind of spring that has them."""
    return tuple(f"{name}.{key}" for name in SPRINGS for key in keys if key in KINDS[name].model_fields)


def _of_loaded(key: str) -> tuple[str, ...]:
    """A field of every kind of element that carries outer torques, and of machines that have it."""
    kinds = KINDS.items()
    return tuple(f"{name}.{key}" for name, kind in kinds if issubclass(kind, Rotor) and key in kind.model_fields)


CURVE = "torque curve"
CONVERTER = "torque converter"
OVER_TORQUE = "stiffness over mean torque"
LOSSES = "gear losses"
FEATURES = (
    Feature(
        "inertia",
        (
            "Disk.inertia", "Disk.outer_diameter", "Disk.inner_diameter", "Disk.thickness", "Disk.density",
            "Disk.material", "Disk.mass", "Disk.radius", "Propeller.entrained_inertia",
            *(f"{kind}.inertia" for kind in (*MACHINES, "Brake")),
        ),
    ),
    Feature(
        "stiffness",
        (
            *_of_springs("stiffness"), "Shaft.outer_diameter", "Shaft.inner_diameter", "Shaft.length",
            "Shaft.shear_modulus", "Shaft.material",
        ),
    ),
    Feature(
        OVER_TORQUE, _of("Coupling", "torques", "stiffnesses"), _where(Coupling, "stiffnesses", lambda one: one.torques)
    ),
    Feature(
        "temperature of a coupling",
        _of("Coupling", "temperature", "temperatures", "stiffness_factors", "damping_factors"),
        _where(Coupling, "temperature", lambda one: one.temperatures),
    ),
    Feature("viscous damper", _of("ViscousDamper", *_DAMPER), _kind(ViscousDamper)),
    Feature(
        OIL,
        (
            *_of("ViscousDamper", "oil", "oil_frequency", "oil_temperature"),
            *_of("OilPoint", "frequency", "stiffness", "loss_stiffness", "loss_factor", "temperature"),
        ),
    ),
    Feature(DRAGGED, (), _dragged),
    Feature("tuned damper", _of("TunedDamper", *_DAMPER), _kind(TunedDamper)),
    Feature(
        "centrifugal pendulum",
        _of("CentrifugalPendulum", "mass", "radius", "length", "order", "path", "damping"),
        _kind(CentrifugalPendulum),
    ),
    Feature("tube inertia", ("Shaft.density",)),
    Feature("bending stiffness", ("Shaft.young_modulus",)),
    Feature("damping", _of_springs("damping")),
    Feature("loss factor", _of_springs("loss_factor", "loss_factor_frequency", "relative_damping")),
    Feature(
        "damping ratio",
        ("Driveline.damping_ratio", "Driveline.damping_ratio_frequency"),
        lambda line: ["driveline.damping_ratio"] if line.damping_ratio else [],
    ),
    Feature("Hooke's joint", ("HookeJoint.angle",)),
    Feature("fork offset", _of_springs("fork_offset")),
    Feature("joint plane", tuple(f"{name}.plane" for name, kind in JOINTS.items() if "plane" in kind.model_fields)),
    Feature("angle of an ideal joint", ("IdealJoint.angle",)),
    Feature(
        "tripod joint", ("TripodJoint.angle", "TripodJoint.radius", "TripodJoint.length", "TripodJoint.spider")
    ),
    Feature(
        "ripple of a Rzeppa joint",
        (
            "RzeppaJoint.angle", "RzeppaJoint.ripple", "RzeppaJoint.reference_angle", "Ripple.amplitude",
            "Ripple.order", "Ripple.phase", "Ripple.growth",
        ),
    ),
    Feature("double Cardan joint", ("DoubleCardanJoint.angle", "DoubleCardanJoint.yoke_length")),
    Feature("double Cardan joint off centre", ("DoubleCardanJoint.distance_ratio",)),
    *_OTHER_JOINTS,
    Feature("ratio", ("Ratio.ratio", "Ratio.teeth_in", "Ratio.teeth_out")),
    Feature(
        "dual-mass flywheel",
        _of("DualMassFlywheel", "primary_inertia", "secondary_inertia"),
        _kind(DualMassFlywheel),
    ),
    Feature(
        "belt",
        _of("Belt", "radius_in", "radius_out", "span_stiffness", "damping", "inertia_in", "inertia_out"),
        _kind(Belt),
    ),
    Feature("tyre", _of("Tyre", "stiffness", "damping"), _kind(Tyre)),
    Feature(
        "slip of a tyre",
        _of("Tyre", "slip_stiffness", "radius", "travel_speed", "inertia"),
        _where(Tyre, "slip_stiffness", lambda tyre: tyre.slips),
    ),
    Feature("vehicle", _of("Vehicle", "mass", "wheel_radius", "wheel_inertia"), _kind(Vehicle)),
    Feature("rolling resistance", _of("Vehicle", "rolling_resistance", "grade")),
    Feature(
        "air drag", _of("Vehicle", "drag_area", "air_density"), _where(Vehicle, "drag_area", lambda one: one.drag_area)
    ),
    Feature(
        "planetary set",
        (
            *(f"Planetary.{key}" for key in ("teeth_sun", "teeth_ring", "input", "held")),
            *(f"Planetary.{key}" for key in ("planets", "planet_inertia", "planet_mass", "centre_distance")),
            "Planetary.teeth_planet",
        ),
    ),
    Feature(
        "elastic teeth of planets",
        _of("Planetary", "sun_mesh_stiffness", "ring_mesh_stiffness", "mesh_damping", "module", "pressure_angle"),
        _where(Planetary, "sun_mesh_stiffness", lambda one: one.elastic),
    ),
    Feature("closed loop", (*_of_springs("to"), "Tyre.to")),
    Feature(
        "shafts tied to two others",
        (
            *(f"Planetary.{key}" for key in ("output", "free_speed")),
            *(f"Differential.{key}" for key in ("ratio", "teeth_in", "teeth_out", "inertia")),
        ),
        lambda line: [n for n, e in line.parts if any(isinstance(part, Tied) for part in e.parts())],
    ),
    Feature(
        "gear mesh",
        (
            "GearPair.mesh_stiffness", "GearPair.teeth_in", "GearPair.teeth_out", "GearPair.module",
            "GearPair.pressure_angle", "GearPair.base_radius_in", "GearPair.base_radius_out",
        ),
    ),
    Feature("mesh damping", ("GearPair.mesh_damping",)),
    Feature("impact damping", ("GearPair.impact_damping",)),
    Feature("backlash", ("GearPair.backlash", "GearPair.angular_backlash", "GearPair.stiffness_ratio")),
    Feature(
        "transmission error",
        (
            "GearPair.transmission_error", "TransmissionError.amplitude", "TransmissionError.order",
            "TransmissionError.phase",
        ),
    ),
    Feature(
        "mesh-stiffness variation",
        (
            "GearPair.stiffness_variation", "StiffnessVariation.share", "StiffnessVariation.order",
            "StiffnessVariation.phase",
        ),
    ),
    Feature(
        LOSSES,
        (
            *(f"{kind}.{key}" for kind in _MESHED for key in ("efficiency", "drag_torque")),
            *_of("Planetary", "sun_mesh_efficiency", "ring_mesh_efficiency", "drag_torque"),
            "GearPair.friction_coefficient",
        ),
    ),
    Feature(
        "stages",
        tuple(f"{kind}.{key}" for kind in _STAGED for key in ("breakpoints", "stiffnesses")),
    ),
    Feature(
        "damping in contact only", ("GearPair.damping_law", *(f"{kind}.damping_law" for kind in _STAGED))
    ),
    Feature(
        "dry friction",
        ("Clutch.friction", "DualMassFlywheel.friction", "Slider.torque", "Slider.stiffness"),
        _dry_friction(False),
    ),
    Feature(
        "slip clutch",
        _of("SlipClutch", "torque", "sliding_torque", "stribeck_speed", "clamping_times", "clamping_shares"),
        _kind(SlipClutch),
    ),
    Feature(
        CONVERTER,
        (
            *_of("TorqueConverter", "curves", "reference_speed", "inertia_in", "inertia_out"),
            *_of("ConverterPoint", "speed_ratio", "torque_ratio", "capacity", "pump_torque"),
        ),
        _where(TorqueConverter, "curves", lambda one: not one.locked),
    ),
    Feature(
        "locked torque converter",
        _of("TorqueConverter", "locked"),
        _where(TorqueConverter, "locked", lambda one: one.locked),
    ),
    Feature(
        "dry friction at one motion",
        tuple(f"{kind}.linear_{key}" for kind in _STAGED[1:] for key in ("amplitude", "frequency")),
        _dry_friction(True),
    ),
    Feature("load torque", _of_loaded("load_torque")),
    Feature("drive share", _of_loaded("drive_share")),
    Feature("brake", _of("Brake", "torque"), _kind(Brake)),
    Feature("viscous load", _of_loaded("viscous_load")),
    Feature(
        "quadratic load",
        (*_of_loaded("quadratic_load"), *_of_loaded("rated_power"), *_of_loaded("rated_speed")),
    ),
    Feature(
        CURVE,
        (
            *_of_loaded("curve"), "TorquePoint.speed", "TorquePoint.torque", "Generator.power",
            *(one for key in (*KLOSS, "gain", "set_speed", "torque_limit") for one in _of_loaded(key)),
            "Propeller.damping_factor", "Brake.static_torque", "Brake.stribeck_speed",
        ),
        _curves,
    ),
    Feature(LAG, (*_of_loaded("corner_frequency"), *_of_loaded("pole_pairs")), _lags),
    Feature(
        "excitation by order",
        (*_of_loaded("excitation"), "Excitation.order", "Excitation.amplitude"),
        _excited(lambda one: not one.frequency),
    ),
    Feature(
        "excitation that varies with speed or load",
        (
            "Excitation.quadratic_amplitude", "Excitation.share", "Excitation.speeds",
            "Excitation.torques", "Excitation.amplitudes", "Excitation.phases",
        ),
        _excited(lambda one: one.varies),
    ),
    Feature("cylinders", ("Disk.firing_angles", "Disk.misfiring")),
    Feature(
        "engine",
        (
            *(f"Engine.{key}" for key in Engine.model_fields if key not in Element.model_fields),
            *(f"PressureCurve.{key}" for key in ("angles", "pressures")),
        ),
        lambda line: [name for name, one in line.as_stated.parts if isinstance(one, Engine)],
    ),
    Feature("excitation in time", ("Excitation.frequency", "Excitation.phase"), _excited(lambda one: not one.order)),
    Feature("excitation by order and frequency", (), _excited(lambda one: one.order and one.frequency)),
    Feature(HELD, (), lambda line: [f"{name}.excitation" for name in prescribed_excitations(line)]),
    Feature(
        SERIES,
        (),
        lambda line: [f"{name}.damping" for names, _ in unlike_in_series(line) for name in names],
    ),
    Feature("branch", ("Element.after",), _branches),
    Feature("free start", (), _free),
    Feature("prescribed far end", (), _prescribed_end),
)  # fmt: skip

RATINGS = (
    "Shaft.tensile_strength",
    *_of("Coupling", *Coupling.ratings, "highest_temperature"),
    *(f"{kind}.heat_rating" for kind in (*_MESHED, "Planetary", "Brake", "TorqueConverter")),
    *("ViscousDamper.heat_rating", "TunedDamper.heat_rating", "CentrifugalPendulum.largest_travel"),
)
"""What elements bear, by field: numbers that no motion has to do with."""
NOT_FEATURES = {
    "Element.name": "a label",
    "Element.sheet": "where its numbers come from",
    **dict.fromkeys((f"Sheet.{key}" for key in Sheet.model_fields), "where numbers come from"),
    "PressureCurve.load": "a label",
    **dict.fromkeys(RATINGS, "a rating, which checks, responses and motions compare with"),
    **dict.fromkeys(
        ("Coupling.thermal_resistance", "Coupling.ambient_temperature"),
        "coupling_temperatures finds by them where the temperature settles",
    ),
    "Driveline.elements": "the elements themselves",
    "Driveline.name": "a label",
    "Driveline.description": "a label",
    "Driveline.operation": "where the line runs: the question an analysis is asked by default",
    "Driveline.document": "the title block of the report that is handed in",
    "Driveline.limits": "what elements may bear, which assess compares with",
    "Driveline.sn_curves": "how many cycles elements bear, which fatigue and assess go by",
    "Driveline.tolerances": "how far numbers scatter, which tolerance_study and certify_stability go by",
    "Driveline.scenarios": "what happens to the line when, which transient follows",
    **dict.fromkeys((f"TitleBlock.{key}" for key in TitleBlock.model_fields), "in the title block of the report"),
    **dict.fromkeys((f"Limit.{key}" for key in Limit.model_fields), "a limit, which assess compares with"),
    **dict.fromkeys((f"SNCurve.{key}" for key in SNCurve.model_fields), "an S–N curve, which fatigue goes by"),
    **dict.fromkeys(
        ("Operation.life", "Operation.duty", "Operation.passages"),
        "what the line does in its life, which fatigue goes by",
    ),
    **dict.fromkeys(
        (f"{kind.__name__}.{key}" for kind in (Duty, SpeedPassage) for key in kind.model_fields),
        "fatigue asks for the motion at that speed or on that passage",
    ),
    "Operation.speed": "the default of every speed asked for",
    "Operation.speed_range": "the default range of reports",
    "Operation.angle_range": "the default range of charts in reports",
    "Operation.speed_unit": "how speeds are read and printed",
    "Operation.application": "which guidelines of assess decide",
    "Operation.switched_off": "which rules of assess are not to judge",
    **dict.fromkeys(("SwitchedOff.rule", "SwitchedOff.reason"), "a rule of assess that is not to judge, and why"),
    **dict.fromkeys(
        ("Operation.misfiring", "Operation.cut_out"),
        "line.with_load puts a cylinder out of work; assess judges every one",
    ),
    "Operation.load_cases": "line.with_load(case) puts a case's torques into the line",
    "Operation.schedules": "line.at_schedule(name, value) puts a point's angles and torques into the line",
    "Schedule.name": "a label",
    **dict.fromkeys(
        (f"Schedule.{key}" for key in ("travel", "speed", "angles", "loads", "factors")),
        "line.at_schedule(name, value) puts them into angle, load_torque and torques; envelope judges every point",
    ),
    "LoadCase.name": "a label",
    "LoadCase.loads": "line.with_load(case) puts them into load_torque",
    "LoadCase.factors": "line.with_load(case) multiplies the torques of machines by them",
}


def feature(key: str) -> Feature:
    """The feature called ``key``."""
    return next(f for f in FEATURES if f.key == key)
