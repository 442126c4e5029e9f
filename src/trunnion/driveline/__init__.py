"""What the user describes: elements, the driveline they form, its files, its units.

Importing this package loads pydantic and nothing heavier; pint is loaded when the first unit is read.
"""

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque, TorqueFunction
from trunnion.driveline.ball_joints import Ripple, RzeppaJoint
from trunnion.driveline.belts import Belt
from trunnion.driveline.brakes import Brake
from trunnion.driveline.clutches import Clutch, Slider
from trunnion.driveline.component_files import component, components
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.curve_points import TorquePoint
from trunnion.driveline.dampers import TunedDamper, ViscousDamper
from trunnion.driveline.differential import Differential
from trunnion.driveline.disturbances import Disturbance
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.duty import Duty, SpeedPassage
from trunnion.driveline.elements import ConstantSpeed, Disk, Element, Ratio
from trunnion.driveline.engine import Engine
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.files import dump, dumps, load, loads
from trunnion.driveline.flywheels import DualMassFlywheel
from trunnion.driveline.gears import GearPair, StiffnessVariation, TransmissionError
from trunnion.driveline.joints import DoubleCardanJoint, HookeJoint, IdealJoint, TripodJoint
from trunnion.driveline.limits import Limit
from trunnion.driveline.machines import Fan, Generator, Motor, Propeller, Pump
from trunnion.driveline.oil import OilPoint
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.pressure import PressureCurve
from trunnion.driveline.quantities import deg, hz, rpm
from trunnion.driveline.rules import SwitchedOff
from trunnion.driveline.scenarios import LevelCrossing, Scenario
from trunnion.driveline.schedules import Schedule
from trunnion.driveline.schema import json_schema
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.sheet import Sheet
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.sn_curves import SNCurve
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.starter import STARTERS, starter
from trunnion.driveline.title_block import TitleBlock
from trunnion.driveline.tolerances import Tolerance
from trunnion.driveline.torque_converters import ConverterPoint, TorqueConverter
from trunnion.driveline.torque_file import read_torque
from trunnion.driveline.vehicle import Tyre, Vehicle

__all__ = [
    "STARTERS",
    "CentrifugalPendulum",
    "AppliedTorque",
    "Disturbance",
    "TorqueFunction",
    "LevelCrossing",
    "FrictionTorque",
    "Scenario",
    "ConstantSpeed",
    "Differential",
    "Disk",
    "DoubleCardanJoint",
    "Driveline",
    "DualMassFlywheel",
    "Duty",
    "Element",
    "Engine",
    "Excitation",
    "Fan",
    "GearPair",
    "Generator",
    "HookeJoint",
    "IdealJoint",
    "Limit",
    "LoadCase",
    "Motor",
    "Operation",
    "Coupling",
    "SpeedPassage",
    "PiecewiseShaft",
    "Planetary",
    "PressureCurve",
    "Propeller",
    "Pump",
    "Ratio",
    "SNCurve",
    "Schedule",
    "Shaft",
    "Sheet",
    "StiffnessVariation",
    "SwitchedOff",
    "TitleBlock",
    "Tolerance",
    "TorquePoint",
    "TransmissionError",
    "Belt",
    "Brake",
    "Clutch",
    "Slider",
    "SlipClutch",
    "TorqueConverter",
    "ConverterPoint",
    "OilPoint",
    "Ripple",
    "RzeppaJoint",
    "TripodJoint",
    "TunedDamper",
    "Tyre",
    "Vehicle",
    "ViscousDamper",
    "component",
    "components",
    "deg",
    "dump",
    "dumps",
    "hz",
    "json_schema",
    "load",
    "loads",
    "read_torque",
    "rpm",
    "starter",
]
