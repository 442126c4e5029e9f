"""
Where are the critical speeds of a two-stroke ship?
===================================================

Modes over the speed, and the orders that excite them. File: :download:`two-stroke-ship.toml <../../../examples/two-stroke-ship.toml>`.
"""

import numpy as np

import trunnion as tn

line = tn.load("../../examples/two-stroke-ship.toml")
low, high = line.operation.speed_range
diagram = tn.campbell_diagram(line, np.linspace(low, high, 60))
picture = diagram.plot()
print(str(diagram).splitlines()[0])
