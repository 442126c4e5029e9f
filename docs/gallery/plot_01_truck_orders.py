"""
Which order loads the shafts of a truck?
========================================

The torque of every shaft over the speed, order by order. File: :download:`truck.toml <../../../examples/truck.toml>`.
"""

import numpy as np

import trunnion as tn

line = tn.load("../../examples/truck.toml")
found = tn.order_response(line, np.linspace(tn.rpm(300), tn.rpm(2400), 200), load_case="climb")
picture = found.plot()
place = np.unravel_index(found.vibratory_torque.argmax(), found.vibratory_torque.shape)
torque, speed = found.vibratory_torque[place], found.speed[place[0]] / tn.rpm(1)
print(f"{found.springs[place[1]]} carries the most: ±{torque:.0f} N m at {speed:.0f} rpm.")
