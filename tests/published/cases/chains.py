"""Natural frequencies of torsional chains, geared and branched ones among them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from published.printed_numbers import Batch, Source

import trunnion as tn

POUND_INCH = 0.11298
"""N m, as the source of the marine line converts."""
SOURCES = {
    "Friswell 2010": Source(
        "Friswell, Penny, Garvey and Lees, Dynamics of Rotating Machines (2010)",
        "the cases as openTorsion's tests have them, with inertias, tubes, radii and frequencies; not the book",
    ),
    "openTorsion": Source("openTorsion, its own tests", "the test of a shaft between two disks"),
    "IEEE 1977": Source(
        "IEEE task force, First benchmark model for computer simulation of subsynchronous resonance, "
        "Trans. PAS-96 (1977)",
        "two transcriptions of the model in public programs, which agree but for the last figure of the exciter's "
        "shaft (2.822 and 2.82), and the frequencies it is quoted with; not the article",
    ),
    "Gunter and Chen 2001": Source(
        "Gunter and Chen, Introduction to Dynamics of Rotor-Bearing Systems (2001), example 8.1, pp. 388-392",
        "the example that openTorsion distributes (marine_steam_turbine_forced_response.py), with the model, the "
        "frequencies and points digitised from figure 8.10-5; not the book",
    ),
    "Sopanen 2011": Source(
        "Sopanen, Ruuskanen, Nerg and Pyrhönen, IEEE Trans. Ind. Electron. 58 (2011)",
        "openTorsion's notebook on it, with the model and its eigenfrequencies; not the article",
    ),
    "Biedenkopf 2020": Source(
        "Biedenkopf, Torsional oscillator model for a 4-cylinder crankshaft, a program in a public repository (2020)",
        "the program, with inertias and stiffnesses in N m per degree, and the frequencies in its legends",
    ),
}


def chain(inertias: Sequence[float], stiffnesses: Sequence[float | str]) -> tn.Driveline:
    """Disks with a shaft between every two."""
    elements: list[Any] = [tn.Disk(inertia=inertias[0])]
    for stiffness, inertia in zip(stiffnesses, inertias[1:], strict=True):
        elements += [tn.Shaft(stiffness=stiffness), tn.Disk(inertia=inertia)]
    return tn.Driveline(elements)


def hertz(line: tn.Driveline) -> Any:
    """Natural frequencies but that of the rigid body [Hz]."""
    return tn.natural_frequencies(line).hertz[1:]


def geared_branch() -> tn.Driveline:
    """A 1:1 gear pair whose second gear drives two shafts, one of them a branch."""
    return tn.Driveline(
        [
            tn.Disk(inertia=400e-6),
            tn.Shaft(stiffness=10e3),
            tn.Disk(inertia=25e-6),
            tn.Ratio(teeth_in=20, teeth_out=20, name="mesh"),
            tn.Disk(inertia=25e-6, name="second gear"),
            tn.Shaft(stiffness=5e3),
            tn.Disk(inertia=700e-6),
            tn.Shaft(stiffness=5e3, after="second gear"),
            tn.Disk(inertia=700e-6),
        ]
    )


def ship() -> tn.Driveline:
    """A machine that drives two equal branches over gears of 1.6."""

    def branch(after: dict[str, str]) -> list[Any]:
        return [
            tn.Ratio(ratio=0.8 / 0.5, **after),
            tn.Disk(inertia=800.0),
            tn.Shaft(outer_diameter=0.25, length=3.5, shear_modulus=68e9),
            tn.Disk(inertia=450.0),
        ]

    first = [
        tn.Disk(inertia=3200.0),
        tn.Shaft(outer_diameter=0.2, length=2.5, shear_modulus=68e9),
        tn.Disk(inertia=200.0, name="first gear"),
        tn.Ratio(ratio=1.0),
        tn.Disk(inertia=200.0),
    ]
    return tn.Driveline([*first, *branch({}), *branch({"after": "first gear"})])


def turbine_generator() -> tn.Driveline:
    """HP and IP turbine, two LP turbines, generator and exciter: inertia constants H [s], stiffness per unit."""
    base = 2 * np.pi * 60.0
    h = np.array([0.092897, 0.155589, 0.858670, 0.884215, 0.868495, 0.0342165])
    return chain(2 * h / base, [19.303, 34.929, 52.038, 70.858, 2.822])


def marine_turbine() -> tn.Driveline:
    """A propeller of five blades, a bull gear, and two turbines behind double reductions; modal damping 0.398 %."""
    u = POUND_INCH
    blades = [{"order": 5, "quadratic_amplitude": 0.1 * 22.24e6 * u / tn.rpm(85) ** 2}]
    return tn.Driveline(
        [
            tn.Disk(name="propeller", inertia=2.454e6 * u, viscous_load=3.86e6 * u, excitation=blades),
            tn.Shaft(name="propeller shaft", stiffness=826e6 * u),
            tn.Disk(name="bull gear", inertia=0.826e6 * u),
            tn.Ratio(ratio=1 / 9.4094),
            tn.Shaft(stiffness=203.94e6 * u),
            tn.Disk(inertia=1.283e4 * u),
            tn.Ratio(ratio=9.4094 / 40.0424),
            tn.Shaft(stiffness=30.51e6 * u),
            tn.Disk(name="low pressure", inertia=1.509e4 * u, viscous_load=108.77 * u, drive_share=1),
            tn.Ratio(ratio=1 / 9.4094, after="bull gear"),
            tn.Shaft(stiffness=24.17e6 * u),
            tn.Disk(inertia=2.723e4 * u),
            tn.Ratio(ratio=9.4094 / 78.2365),
            tn.Shaft(stiffness=14.26e6 * u),
            tn.Disk(name="high pressure", inertia=2.612e2 * u, viscous_load=42.738 * u, drive_share=1),
        ],
        damping_ratio=0.00398,
    )


def wind_turbine() -> tn.Driveline:
    """A turbine with a direct-driven generator, and its torque ripple by order (table III of the article)."""
    k1, k2 = 3.67e8, 5.496e9
    share = {4: 0.0018, 6: 0.0179, 8: 0.0024, 10: 0.0034, 12: 0.0117, 14: 0.0018, 16: 0.0011}
    ripple = [{"order": 60 * v, "amplitude": 2.9e6 * a} for v, a in share.items()]
    return tn.Driveline(
        [
            tn.Disk(inertia=1e7, drive_share=1),
            tn.Shaft(stiffness=k1, damping=4e-4 * k1),
            tn.Disk(inertia=5770.0),
            tn.Shaft(stiffness=k2, damping=4e-5 * k2),
            tn.Disk(inertia=97030.0, load_torque=2.9e6, excitation=ripple),
        ]
    )


def motorcycle_crank() -> tn.Driveline:
    """Four throws of a crank of a Honda CBR600RR and its two ends, from a scanned part."""
    inertias = [0.0000199, 0.0016958, 0.0021595, 0.0018157, 0.0012602, 0.0000154]
    return chain(inertias, [f"{k} N*m/deg" for k in (3014, 2562, 2430, 2636, 2562)])


def _marine_speeds() -> Any:
    modes = tn.natural_frequencies(marine_turbine()).undamped_frequency
    return modes[modes > 0][:3] / tn.rpm(1)


BATCHES = (
    Batch(
        "Friswell 2010", "five disks", "Hz",
        {"mode 1": "81.21", "mode 2": "141.21", "mode 3": "378.95", "mode 4": "536.36"},
        lambda: hertz(chain([3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3])),
    ),
    Batch(
        "Friswell 2010", "geared system with a branch", "Hz",
        {"mode 1": "425.4", "mode 2": "634.1", "mode 3": "3247.2"},
        lambda: hertz(geared_branch()),
    ),
    Batch(
        "Friswell 2010", "section 9.6.3, geared branches of a ship", "Hz",
        {"mode 1": "10.304", "mode 2": "20.479", "mode 3": "24.423"},
        lambda: hertz(ship()),
    ),
    Batch(
        "openTorsion", "a shaft between two disks", "Hz", {"mode 1": "176.1"},
        lambda: hertz(chain([211.4, 8.3], [9.775e6])),
    ),
    Batch(
        "IEEE 1977", "turbine-generator of six masses", "Hz",
        {"mode 1": "15.71", "mode 2": "20.21", "mode 3": "25.55", "mode 4": "32.28", "mode 5": "47.46"},
        lambda: hertz(turbine_generator()),
    ),
    Batch(
        "Gunter and Chen 2001", "natural frequencies", "1/min",
        {"mode 1": "177.7", "mode 2": "220.2", "mode 3": "1282.6"},
        _marine_speeds,
    ),
    Batch(
        "Sopanen 2011", "eigenfrequencies", "rad/s",
        {"mode 1": "58.34", "mode 2": "1034.115"},
        lambda: tn.natural_frequencies(wind_turbine()).undamped_frequency[1:],
    ),
    Batch(
        "Biedenkopf 2020", "six masses of a motorcycle's crank", "Hz", {"mode 1": "1169", "mode 2": "2085"},
        lambda: hertz(motorcycle_crank())[:2],
    ),
)  # fmt: skip
