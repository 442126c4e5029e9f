"""The README's code, as type checkers read it: ``make check`` reads this file with mypy --strict."""

import trunnion as tn

line = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness="12 kN*m/rad", damping="1 N*m*s/rad"),
        tn.Disk(inertia="0.4 kg*m^2"),
        tn.HookeJoint(angle="20 deg"),
        tn.Shaft(stiffness="10 kN*m/rad", damping="1 N*m*s/rad"),
        tn.Disk(inertia="0.9 kg*m^2"),
    ]
)
print(tn.natural_frequencies(line))
for speed in (2250, 2350, 2450):
    result = tn.stability(line, speed=tn.rpm(speed))
    print(f"{speed} rpm: {result.verdict}, spectral radius {result.spectral_radius:.6f}")
print("at 2350 rpm:", tn.stability(line, speed=tn.rpm(2350)).resonance)
