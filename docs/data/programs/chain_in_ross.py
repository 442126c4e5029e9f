"""Torsional natural frequencies of a chain in ROSS: the torsional part of its 6-degree-of-freedom elements."""

from __future__ import annotations

import json
import sys
import time

import numpy as np
import ross as rs
import scipy.linalg

case = json.loads(sys.argv[1])
TORSION, DEGREES = 5, 6


def frequencies() -> list[float]:
    """Of disks between massless tubes [Hz], the rigid body left out."""
    steel = rs.Material(name="light", rho=1e-6, E=211e9, G_s=case["shear_modulus"])
    shafts = [
        rs.ShaftElement(L=length, idl=0.0, odl=diameter, material=steel)
        for length, diameter in zip(case["lengths"], case["diameters"], strict=True)
    ]
    disks = [rs.DiskElement(n=i, m=1.0, Id=inertia / 2, Ip=inertia) for i, inertia in enumerate(case["inertias"])]
    bearings = [rs.BearingElement(n=i, kxx=1e8, cxx=0.0) for i in (0, len(disks) - 1)]
    rotor = rs.Rotor(shafts, disks, bearings)
    which = np.arange(len(disks)) * DEGREES + TORSION
    mass, stiffness = rotor.M(0.0)[np.ix_(which, which)], rotor.K(0.0)[np.ix_(which, which)]
    squares = np.sort(scipy.linalg.eigvalsh(stiffness, mass))[1:]
    return [float(one) for one in np.sqrt(squares) / (2 * np.pi)]


frequencies()
begin = time.perf_counter()
found = frequencies()
print(json.dumps({"values": found, "seconds": time.perf_counter() - begin, "version": rs.__version__}))
