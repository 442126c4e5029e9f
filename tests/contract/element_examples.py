"""Elements of every kind, with as many of their keys as go together: what contracts of elements go through."""

from trunnion.driveline import (
    Belt,
    Brake,
    CentrifugalPendulum,
    Clutch,
    ConstantSpeed,
    Coupling,
    Differential,
    Disk,
    DoubleCardanJoint,
    DualMassFlywheel,
    Engine,
    Fan,
    GearPair,
    Generator,
    HookeJoint,
    IdealJoint,
    Motor,
    PiecewiseShaft,
    Planetary,
    Propeller,
    Pump,
    Ratio,
    RzeppaJoint,
    Shaft,
    SlipClutch,
    TorqueConverter,
    TripodJoint,
    TunedDamper,
    Tyre,
    Vehicle,
    ViscousDamper,
)

TUBE = {"outer_diameter": "110 mm", "inner_diameter": "100 mm", "length": 1.3, "shear_modulus": "79.3 GPa"}

ONE_OF_EACH = [
    ConstantSpeed(name="drive"),
    Shaft(stiffness="12 kN*m/rad", damping=3, fork_offset="90 deg"),
    Shaft(**TUBE, density=7850, young_modulus="206 GPa", loss_factor=0.02, loss_factor_frequency="50 Hz"),
    Disk(inertia=0.4, load_torque="250 N*m"),
    Disk(outer_diameter=0.3, thickness=0.02, density=7850, after="drive"),
    HookeJoint(angle="12 deg", plane="15 deg"),
    IdealJoint(),
    Ratio(ratio=-4.1),
    Ratio(teeth_in=10, teeth_out=41),
]
PARTS = [
    Shaft(outer_diameter="76 mm", inner_diameter="72 mm", length="1.4 m", material="C45", loss_factor=0.02),
    Coupling(stiffness="35 kN*m/rad", relative_damping=1.13, nominal_torque="5 kN*m", heat_rating="350 W"),
    Disk(mass="2.2 t", radius="0.35 m"),
    Disk(outer_diameter=0.3, thickness=0.02, material="steel"),
    Planetary(teeth_sun=30, teeth_ring=72, input="sun", held="ring", planet_mass="0.8 kg", centre_distance="80 mm"),
    Differential(teeth_in=10, teeth_out=41, inertia="0.05 kg*m^2"),
]
COMPONENTS = [
    ViscousDamper(inertia="0.05 kg*m^2", ring_inertia="0.12 kg*m^2", damping=45, heat_rating="400 W"),
    ViscousDamper(ring_inertia=0.12, damping=45, stiffness="2 kN*m/rad"),
    Belt(radius_in="60 mm", radius_out="150 mm", span_stiffness=4e5, damping=0.5, inertia_in=2e-3, inertia_out=0.05),
    DualMassFlywheel(
        primary_inertia=0.14,
        secondary_inertia=0.06,
        breakpoints=["-30 deg", "30 deg"],
        stiffnesses=[2e3, 800, 2e3],
        friction=[{"torque": "8 N*m", "stiffness": "4 kN*m/rad"}],
        damping=0.5,
    ),
    DualMassFlywheel(primary_inertia=0.14, secondary_inertia=0.06, stiffnesses=["15 N*m/deg"]),
    TunedDamper(ring_inertia=0.02, stiffness="1.5 kN*m/rad", damping=2),
    CentrifugalPendulum(mass="1.2 kg", radius="80 mm", length="20 mm", path="epicycloid", largest_travel="15 mm"),
    CentrifugalPendulum(mass=1.2, radius=0.08, order=1.95, damping=0.1),
    Engine(
        firing_order="1-3-4-2",
        throw_inertia=[0.02, 0.02, 0.02, 0.03],
        throw_stiffness="0.6 MN*m/rad",
        pressure=[{"angles": [0.02 * i for i in range(629)], "pressures": [2e5] * 629}],
        bore="80 mm",
        stroke="90 mm",
        rod_length="150 mm",
        reciprocating_mass="0.8 kg",
        strokes=4,
        misfiring=2,
        loss_factor=0.02,
        compression_ratio=12,
        charge_pressure="1 bar",
        polytropic_exponent=1.3,
    ),
    SlipClutch(
        torque="1200 N*m",
        sliding_torque="900 N*m",
        stribeck_speed="20 rpm",
        clamping_times=["0 s", "300 ms"],
        clamping_shares=[0.2, 1],
    ),
    Tyre(stiffness=15e3, damping=200, slip_stiffness="60 kN", radius=0.3, travel_speed="90 km/h", inertia=0.6),
    Vehicle(mass="1.6 t", wheel_radius=0.31, wheel_inertia=1.8, rolling_resistance="1.2 %", grade=0.05, drag_area=0.65),
]
JOINTS = [
    TripodJoint(angle=0.2, radius="60 mm", length="150 mm", spider="input"),
    DoubleCardanJoint(angle=0.4, distance_ratio=1.4),
]
ENGINES = [
    Engine(
        firing_order="1-3-4-2", throw_inertia=0.02, stroke="90 mm", journal_diameter="60 mm", journal_bore="10 mm",
        journal_length="30 mm", pin_diameter="50 mm", pin_bore="10 mm", pin_length="30 mm", web_thickness="20 mm",
        web_width="80 mm", shear_modulus="80 GPa",
    ),
    Engine(
        firing_order="1-2", strokes=2, throw_inertia=0.02, throw_stiffness=6e5, bore="200 mm", stroke="260 mm",
        rod_length="500 mm", mean_indicated_pressure=["10 bar", "20 bar"], peak_pressure=["140 bar", "165 bar"],
        charge_pressure="3.6 bar", compression_ratio=13.5, polytropic_exponent=1.36,
    ),
]  # fmt: skip
MACHINES = [
    Motor(inertia=0.4, breakdown_torque=500, breakdown_slip=0.2, synchronous_speed="1500 rpm", pole_pairs=2),
    Motor(inertia=0.4, gain=40, torque_limit="300 N*m", corner_frequency="80 Hz", drive_share=1),
    Generator(inertia=0.6, curve=[{"speed": "0 rpm", "torque": 0}, {"speed": "1500 rpm", "torque": "90 N*m"}]),
    Generator(inertia=0.6, power="30 kW", excitation=[{"order": 6, "share": 0.02}]),
    Fan(inertia=3, rated_power="30 kW", rated_speed="1480 rpm", load_torque=2),
    Pump(inertia=0.3, load_torque="120 N*m", viscous_load=0.2),
    Propeller(inertia=60, entrained_inertia=15, quadratic_load=20, damping_factor=2.9),
    TorqueConverter(
        curves=[
            {"speed_ratio": 0, "torque_ratio": 2.1, "pump_torque": "180 N*m"},
            {"speed_ratio": 0.85, "torque_ratio": 1, "pump_torque": "120 N*m"},
            {"speed_ratio": 1, "torque_ratio": 1, "pump_torque": 0},
        ],
        reference_speed="2000 rpm",
        inertia_in=0.15,
        inertia_out=0.05,
        heat_rating="20 kW",
    ),
    Brake(inertia=0.3, torque="200 N*m", static_torque="260 N*m", stribeck_speed="20 rpm", heat_rating="5 kW"),
]
WITH_STAGES = [
    RzeppaJoint(
        angle="8 deg",
        plane=0.1,
        reference_angle="10 deg",
        ripple=[{"order": 6, "amplitude": "0.01 deg", "phase": "30 deg", "growth": 2}],
    ),
    GearPair(
        teeth_in=20, teeth_out=31, module="4 mm", pressure_angle="22.5 deg", mesh_stiffness=2e8, mesh_damping=900,
        damping_law="in contact", backlash="0.1 mm", stiffness_ratio=0.05,
        transmission_error=[{"amplitude": "4 um", "phase": "30 deg"}], stiffness_variation=[{"share": 0.1, "order": 2}],
    ),
    GearPair(base_radius_in=0.04, base_radius_out=0.06, mesh_stiffness=2e8, angular_backlash="0.2 deg"),
    PiecewiseShaft(breakpoints=["-4 deg", "4 deg"], stiffnesses=[2e3, 0, 2.5e3], damping=0.3, fork_offset="90 deg"),
    Clutch(stiffnesses=["800 N*m/rad"], friction=[{"torque": "6 N*m", "stiffness": "4 kN*m/rad"}], damping=0.1),
    Clutch(
        stiffnesses=[800.0], friction=[{"torque": 6.0, "stiffness": 4e3}],
        linear_amplitude="1 deg", linear_frequency="30 Hz",
    ),
]  # fmt: skip

ELEMENTS = ONE_OF_EACH + PARTS + COMPONENTS + JOINTS + ENGINES + MACHINES + WITH_STAGES
