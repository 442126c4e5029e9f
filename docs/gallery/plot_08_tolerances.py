"""
How sure is stability when parts scatter?
=========================================

Stiffness and damping scatter by 10 %: what is the probability that the line is stable?
"""

import numpy as np

import trunnion as tn

line = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness="12 kN*m/rad", damping="1.2 N*m*s/rad"),
        tn.Disk(inertia="0.4 kg*m^2"),
        tn.HookeJoint(angle="20 deg"),
        tn.Shaft(stiffness="10 kN*m/rad", damping="1.2 N*m*s/rad"),
        tn.Disk(inertia="0.9 kg*m^2"),
    ]
)
scatter = {"Shaft 1.stiffness": 0.1, "Shaft 2.stiffness": 0.1, "Shaft 2.damping": 0.3}
study = tn.tolerance_study(line, scatter, np.linspace(tn.rpm(2250), tn.rpm(2450), 9), samples=4096)
picture = study.plot()
print(str(study).splitlines()[0])
