"""Forced responses.

Chains of masses and springs in a row are torsional chains with other names of the units. A chain that is held at both
ends, which analyses of drivelines have no use for, ends in an inertia of 1e12 times the others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from published.cases.chains import POUND_INCH, marine_turbine
from published.printed_numbers import Batch, Source

import trunnion as tn

SPEED = 10.0
SOURCES = {
    "SFM SDLD21": Source(
        "Société française des mécaniciens, Guide de validation des progiciels de calcul de structures, SDLD21",
        "the displacements that the guide's solution gives, as Code_Aster's test sdld21a quotes them",
    ),
    "Code_Aster SDLD313": Source(
        "Code_Aster, handbook of validation V2.01.313, test SDLD313 (EDF), after the same guide",
        "the problem's page, and the reference displacements in sdld313a",
    ),
    "Thomson 1965": Source(
        "Thomson, Vibration Theory and Applications (1965), p. 178, example 6.6-1",
        "case VM90 of Ansys's verification manual, with its targets; not the book",
    ),
    "Thomson 1993": Source(
        "Thomson, Theory of Vibration with Applications, 4th edition (1993), example 12.4-1, pp. 388-389",
        "both pages of the book: the line of figure 12.4-2 and table 12.4-1",
    ),
}
EIGHT_MASSES = {
    5.0: ("1.0237e-04", "-8.5187e-06"), 5.5: ("4.5066e-04", "-7.7914e-04"), 6.0: ("-9.4101e-05", "-1.0585e-05"),
    7.0: ("-2.4232e-05", "-1.2233e-06"), 9.5: ("-1.7756e-06", "-6.3356e-07"), 10.0: ("8.4143e-07", "-1.0335e-06"),
    10.5: ("5.1880e-06", "-3.4375e-06"), 11.0: ("-7.3293e-06", "-1.2167e-05"), 12.5: ("1.1006e-06", "-8.4775e-07"),
    14.5: ("8.6698e-06", "-2.7560e-06"), 40.0: ("-2.5696e-06", "-2.7554e-07"),
}  # fmt: skip
"""Frequency [Hz]: real and imaginary part [m]."""
HYSTERETIC = {
    3.3687: ("9.388216e-3", "-7.31196e-4"), 6.4848: ("-5.0269e-3", "-7.07103e-2"),
    8.0006: ("-9.54931e-3", "-2.2154e-3"), 11.8746: ("-4.23259e-5", "-3.57193e-4"),
    13.4747: ("2.35524e-3", "-5.01765e-4"), 15.5802: ("-1.6395374e-2", "-6.871471e-2"),
    21.0543: ("-1.88977e-3", "-5.53314e-6"),
}  # fmt: skip
TWO_MASSES = {1.5: ("0.82272", "0.46274"), 4.0: ("-0.51145", "-1.2153"), 6.5: ("-0.58513", "0.26966")}
"""Frequency [Hz]: both masses [in], in phase with the force or against it."""
PROPELLER_SHAFT = {
    24.56: "0.3245e6", 28.11: "0.5957e6", 32.81: "1.8564e6", 34.37: "3.3191e6", 35.12: "3.9840e6", 35.46: "4.1489e6",
    36.14: "3.9840e6", 36.82: "3.3191e6", 38.19: "2.2979e6", 40.64: "1.4362e6", 50.04: "0.6968e6", 97.11: "0.4096e6",
}  # fmt: skip
"""Speed [rpm]: vibratory torque [lb in]."""

HOLZER = {
    20.0: (("0.980", "0.9484"), ("2.0e3", "6.312e3", "14.66e3")),
    40.0: (("0.920", "0.799"), ("8.0e3", "24.19e3", "52.32e3")),
}
"""Frequency [rad/s]: rotations of the second and the third disk [rad] where the first turns by 1 rad; torques [N m] of
both shafts and the one on the last disk that keeps all this up."""


def at_frequencies(make: Callable[[float], tn.Driveline], hertz: Iterable[float]) -> Any:
    """Complex rotation (frequency, inertia) of a line whose torque is fixed in time at each of the frequencies."""
    found = []
    for frequency in hertz:
        result = tn.order_response(make(2 * np.pi * frequency), [SPEED])
        assert result.frequency.tolist() == [2 * np.pi * frequency]
        found.append(result.rotation[0, 0])
    return np.array(found)


def shaken(frequency: float, amplitude: float) -> list[dict[str, float]]:
    """A force in time."""
    return [{"frequency": frequency, "amplitude": amplitude}]


def eight_masses(frequency: float) -> tn.Driveline:
    """Eight of 10 kg between nine springs of 1e5 N/m with dampers of 50 N s/m, 1 N on the fifth."""
    parts: list[Any] = [tn.ConstantSpeed()]
    for i in range(1, 9):
        parts += [
            tn.Shaft(stiffness=1e5, damping=50.0),
            tn.Disk(inertia=10.0, excitation=shaken(frequency, 1.0) if i == 5 else []),
        ]
    return tn.Driveline([*parts, tn.Shaft(stiffness=1e5, damping=50.0), tn.Disk(inertia=1e13)])


def hysteretic(frequency: float) -> tn.Driveline:
    """k₁ = k₂ = 28 kN/m, η₁ = 0.1, m₁ = 10 kg, m₂ = 5 kg, 100 N on the second."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=28e3, loss_factor=0.1),
            tn.Disk(inertia=10.0),
            tn.Shaft(stiffness=28e3),
            tn.Disk(inertia=5.0, excitation=shaken(frequency, 100.0)),
        ]
    )


def two_masses(frequency: float) -> tn.Driveline:
    """m = 0.5 lb s²/in twice, k = 200 lb/in thrice, 200 lb on the first."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=200.0),
            tn.Disk(inertia=0.5, excitation=shaken(frequency, 200.0)),
            tn.Shaft(stiffness=200.0),
            tn.Disk(inertia=0.5),
            tn.Shaft(stiffness=200.0),
            tn.Disk(inertia=1e12),
        ]
    )


def three_disks(frequency: float) -> tn.Driveline:
    """J = 5, 11 and 22 kg m² with 0.1 and 0.2 MN m/rad between them; 1 N m on the third."""
    return tn.Driveline(
        [
            tn.Disk(inertia=5.0, drive_share=1.0),
            tn.Shaft(stiffness=0.1e6),
            tn.Disk(inertia=11.0),
            tn.Shaft(stiffness=0.2e6),
            tn.Disk(inertia=22.0, excitation=shaken(frequency, 1.0)),
        ]
    )


def _holzer() -> Iterator[tuple[Any, Any]]:
    """Rotations and torques at each frequency, by the one that the first disk turns by."""
    for frequency in HOLZER:
        result = tn.order_response(three_disks(frequency), [SPEED])
        first = result.rotation[0, 0, 0]
        turned = result.rotation[0, 0] / first
        yield turned[1:].real, np.abs([*(result.torque[0, 0] / first), 1.0 / first])


def _columns(part: int, names: tuple[str, ...]) -> dict[str, str]:
    return {
        f"{frequency:g} rad/s, {name}": text
        for frequency, both in HOLZER.items()
        for name, text in zip(names, both[part], strict=True)
    }


def _parts(table: dict[float, tuple[str, str]], words: tuple[str, str]) -> dict[str, str]:
    return {f"{f} Hz, {word}": text for f, pair in table.items() for word, text in zip(words, pair, strict=True)}


def _complex(values: Any) -> Any:
    return np.stack([values.real, values.imag], axis=-1).ravel()


def _propeller_shaft() -> Any:
    found = tn.order_response(marine_turbine(), tn.rpm(np.array([*PROPELLER_SHAFT])))
    return found.vibratory_torque[:, found.springs.index("propeller shaft")] / POUND_INCH


def _propeller_peak() -> list[float]:
    speeds = tn.rpm(np.linspace(35, 36, 201))
    return [float(tn.order_response(marine_turbine(), speeds).vibratory_torque[:, 0].max() / POUND_INCH)]


BATCHES = (
    Batch(
        "Gunter and Chen 2001", "figure 8.10-5, torque of the propeller shaft", "lb in",
        {f"{speed} rpm": text for speed, text in PROPELLER_SHAFT.items()}, _propeller_shaft,
        relative=0.05, precision="read off a drawing: 5 % on the flanks",
    ),
    Batch(
        "Gunter and Chen 2001", "figure 8.10-5, its peak", "lb in", {"peak": "4.1489e6"}, _propeller_peak,
        relative=0.01, precision="read off a drawing: 1 % at the peak",
    ),
    Batch(
        "SFM SDLD21", "loaded mass of eight", "m", _parts(EIGHT_MASSES, ("real part", "imaginary part")),
        lambda: _complex(at_frequencies(eight_masses, EIGHT_MASSES)[:, 4]),
    ),
    Batch(
        "Code_Aster SDLD313", "loaded mass of two, hysteretic", "m",
        _parts(HYSTERETIC, ("real part", "imaginary part")),
        lambda: _complex(at_frequencies(hysteretic, HYSTERETIC)[:, 1]),
        absolute=4e-5, relative=2e-3, precision="resonance frequencies with five figures; the handbook asks for 0.5 %",
    ),
    Batch(
        "Thomson 1965", "two masses between three springs", "in", _parts(TWO_MASSES, ("mass 1", "mass 2")),
        lambda: at_frequencies(two_masses, TWO_MASSES)[:, :2].real.ravel(),
        relative=5e-5, precision="five figures",
    ),
    Batch(
        "Thomson 1993", "table 12.4-1, rotations by that of the first disk", "rad/rad",
        _columns(0, ("disk 2", "disk 3")), lambda: np.concatenate([turned for turned, _ in _holzer()]),
    ),
    Batch(
        "Thomson 1993", "table 12.4-1, torques per radian of the first disk", "N m",
        _columns(1, ("first shaft", "second shaft", "left on disk 3")),
        lambda: np.concatenate([torques for _, torques in _holzer()]),
    ),
)  # fmt: skip
