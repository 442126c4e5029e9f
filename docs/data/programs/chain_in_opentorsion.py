"""Torsional natural frequencies of a chain in openTorsion."""

from __future__ import annotations

import json
import sys
import time
from importlib.metadata import version

import numpy as np
import opentorsion as ot

case = json.loads(sys.argv[1])


def frequencies() -> list[float]:
    """Of disks between springs [Hz], the rigid body left out."""
    area = np.pi * np.array(case["diameters"]) ** 4 / 32
    stiffness = case["shear_modulus"] * area / np.array(case["lengths"])
    shafts = [ot.Shaft(i, i + 1, k=k) for i, k in enumerate(stiffness)]
    disks = [ot.Disk(i, I=inertia) for i, inertia in enumerate(case["inertias"])]
    squares = np.linalg.eigvals(np.linalg.solve((a := ot.Assembly(shafts, disk_elements=disks)).M, a.K)).real
    return [float(one) for one in np.sqrt(np.sort(squares)[1:]) / (2 * np.pi)]


frequencies()
begin = time.perf_counter()
found = frequencies()
print(json.dumps({"values": found, "seconds": time.perf_counter() - begin, "version": version("opentorsion")}))
