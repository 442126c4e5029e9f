"""What a description accepts, as type checkers read it: ``make check`` reads this file with mypy --strict."""

import trunnion as tn

line = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.Shaft(name="input shaft", stiffness="12 kN*m/rad", damping=1),
        tn.Disk(
            name="hub",
            inertia="0.4 kg*m^2",
            excitation=[
                {"order": 2, "amplitude": "4 N*m"},
                tn.Excitation(order="0.5", speeds=["300 rpm", 200.0], amplitudes=["1 N*m", 2], phases=[0, "30 deg"]),
            ],
        ),
        tn.HookeJoint(angle="20 deg", plane=0.1),
        tn.PiecewiseShaft(breakpoints=["-4 deg", 0.07], stiffnesses=["2 kN*m/rad", 0, "2 kN*m/rad"]),
        tn.Disk(inertia=0.9),
        tn.GearPair(
            teeth_in=20,
            teeth_out=30,
            module="4 mm",
            mesh_stiffness="200 N/um",
            transmission_error=({"amplitude": "10 um"},),
            stiffness_variation=[tn.StiffnessVariation(share="2 %")],
        ),
        tn.Disk(inertia="0.5 kg*m^2", load_torque="40 N*m"),
        tn.Clutch(stiffnesses=[800], friction=[{"torque": "40 N*m", "stiffness": 3e3}]),
        tn.Disk(inertia="0.1 kg*m^2"),
    ],
    operation=tn.Operation(speed_range=("300 rpm", "900 rpm"), angle_range=[0, "25 deg"]),
    limits=[tn.Limit(of="input shaft", max_torque="4 kN*m", margin="10 %")],
)
shaft = tn.Shaft(stiffness="12 kN*m/rad")
stiffness: float | None = shaft.stiffness
damping: float = shaft.damping
stiffnesses: tuple[float, ...] = tn.Clutch(
    stiffnesses=["800 N*m/rad"], friction=[tn.Slider(torque=40, stiffness=3e3)]
).stiffnesses
speeds: tuple[float, float] | None = tn.Operation(speed_range=["300 rpm", 90]).speed_range
