"""
What torque does a direct start make?
=====================================

An asynchronous motor starts a mill from rest through a joint of 8°.
"""

import trunnion as tn

disks = tn.Disk(name="motor", inertia=0.5), tn.Disk(name="mill", inertia=2.0)
shaft = tn.Shaft(name="spindle", stiffness="20 kN*m/rad", damping=6.0)
line = tn.Driveline([disks[0], tn.HookeJoint(angle="8 deg"), shaft, disks[1]])
motor = tn.AppliedTorque(on="motor", breakdown_torque=300.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
run = tn.transient(line, 2.0, torque=[motor], speed=0.0)
picture = run.plot()
print(f"The spindle carries up to {run.peak_torque.max():.0f} N m; the motor's breakdown torque is 300 N m.")
