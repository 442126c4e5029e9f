"""
Which stiffness did the bench have?
===================================

A bench records pulses of two toothed wheels. Here the recording is made by :code:`tn.measure`, so that the true stiffness is
known. The line as it was drawn misses the measured resonance. The fitted line meets it.
"""

import trunnion as tn

true = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.HookeJoint(angle="12 deg", name="joint"),
        tn.Shaft(stiffness="20 kN*m/rad", damping=25, name="tube"),
        tn.Disk(inertia=0.5, name="hub"),
    ]
)
wheels = {"input": 60, "hub": 60}
bench = {"jitter": 2e-7, "pitch_error": 0.005}
straight = true.replace_all({"joint": {"angle": 0.0}})
calibration = tn.pitch_errors(tn.measure(straight, ("600 rpm", "900 rpm"), 10.0, wheels, seed=2, **bench))
recorded = tn.measure(true, ("600 rpm", "1800 rpm"), 15.0, wheels, seed=1, **bench)
measured = tn.track_orders(recorded, [2], line=true, reference="input", calibration=calibration)

drawn = true.replace_all({"tube": {"stiffness": "16 kN*m/rad"}, "joint": {"angle": "9 deg"}})
free = {"tube.stiffness": ("10 kN*m/rad", "40 kN*m/rad"), "joint.angle": ("2 deg", "25 deg")}
before = tn.compare_measured(drawn, measured).plot(channel="hub")
found = tn.identify(drawn, measured, free)
after = tn.compare_measured(found.line, measured).plot(channel="hub")
print(*found.changes, sep="\n")
