"""Motion of two disks and a Hooke's joint in heyoka: Taylor series of the equations, written out."""

from __future__ import annotations

import json
import sys
import time

import heyoka as hy
import numpy as np

case = json.loads(sys.argv[1])
p1, p2, v1, v2 = hy.make_vars("p1", "p2", "v1", "v2")
k, c, j, speed, beta = case["stiffness"], case["damping"], case["inertia"], case["speed"], case["angle"]
cosine = float(np.cos(beta))
# The rotation of disk 1, the output of the joint and its speed ratio; the fork starts square to the joint plane.
turned = speed * hy.time + p1
below = hy.cos(turned) ** 2 + cosine * hy.sin(turned) ** 2
ahead = hy.atan2(-(1.0 - cosine) * hy.sin(turned) * hy.cos(turned), below)
ratio = cosine / (1.0 - float(np.sin(beta) ** 2) * hy.sin(turned) ** 2)
torque = k[1] * (p2 - p1 - ahead) + c[1] * (speed + v2 - ratio * (speed + v1))
rates = [(p1, v1), (p2, v2), (v1, (ratio * torque - k[0] * p1 - c[0] * v1) / j[0]), (v2, -torque / j[1])]
solver = hy.taylor_adaptive(rates, [0.0] * 4, tol=1e-15)


def motion() -> list[list[float]]:
    """Deviations from uniform rotation of both disks at even times."""
    solver.time = 0.0
    solver.state[:] = 0.0
    *_, states = solver.propagate_grid(np.linspace(0.0, case["duration"], case["points"]))
    return np.asarray(states)[:, :2].tolist()


motion()
begin = time.perf_counter()
found = motion()
print(json.dumps({"values": found, "seconds": time.perf_counter() - begin, "version": hy.__version__}))
