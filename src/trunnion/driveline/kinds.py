"""All kinds of element by the name that ``type`` gives them in a file."""

from __future__ import annotations

from trunnion.driveline.ball_joints import RzeppaJoint
from trunnion.driveline.belts import Belt
from trunnion.driveline.brakes import Brake
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.dampers import TunedDamper, ViscousDamper
from trunnion.driveline.differential import Differential
from trunnion.driveline.elements import ConstantSpeed, Disk, Element, Ratio
from trunnion.driveline.engine import Engine
from trunnion.driveline.flywheels import DualMassFlywheel
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import DoubleCardanJoint, HookeJoint, IdealJoint, TripodJoint
from trunnion.driveline.machines import Fan, Generator, Motor, Propeller, Pump
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.shafts import Shaft
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.driveline.vehicle import Tyre, Vehicle

KINDS: dict[str, type[Element]] = {
    kind.__name__: kind
    for kind in (
        ConstantSpeed,
        Shaft,
        Coupling,
        PiecewiseShaft,
        Clutch,
        SlipClutch,
        TorqueConverter,
        DualMassFlywheel,
        Disk,
        Engine,
        Motor,
        Generator,
        Fan,
        Pump,
        Propeller,
        Brake,
        ViscousDamper,
        TunedDamper,
        CentrifugalPendulum,
        HookeJoint,
        IdealJoint,
        TripodJoint,
        RzeppaJoint,
        DoubleCardanJoint,
        Ratio,
        Belt,
        GearPair,
        Planetary,
        Differential,
        Tyre,
        Vehicle,
    )
}
