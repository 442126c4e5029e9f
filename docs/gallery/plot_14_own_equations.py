"""
How do I chart my own equations?
================================

Mathieu's equation as a function of the time and two parameters. Take this example away as a notebook.
"""

import numpy as np

import trunnion as tn


def mathieu(tau, a, q):
    return np.eye(1), np.zeros((1, 1)), (a - 2 * q * np.cos(2 * tau))[..., None, None]


family = tn.PeriodicLinearFamily(np.pi, mathieu, 1, {"a": 1.0, "q": 0.5})
chart = tn.stability_chart(family, ("a", -1.0, 6.0, 200), ("q", 0.0, 3.0, 120))
picture = chart.plot()
print("Tongues of instability start at a = 1, 4, …: the squares of whole numbers.")
