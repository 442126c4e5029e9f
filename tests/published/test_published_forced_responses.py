"""Forced responses whose numbers others have printed, each with its source, what of it was read, and its precision.

Chains of masses and springs in a row are torsional chains with other names of the units. A chain that is held at both
ends, which analyses of drivelines have no use for, ends in an inertia of 1e12 times the others.
"""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

SPEED = 10.0
POUND_INCH = 0.11298
"""N m, as the source of the marine line converts."""


def at_frequencies(make, hertz):
    """Complex rotation (frequency, inertia) of a line whose torque is fixed in time at each of the frequencies."""
    found = []
    for frequency in hertz:
        result = tn.order_response(make(2 * np.pi * frequency), [SPEED])
        assert result.frequency.tolist() == [2 * np.pi * frequency]
        found.append(result.rotation[0, 0])
    return np.array(found)


def shaken(frequency, amplitude):
    return [{"frequency": frequency, "amplitude": amplitude}]


def test_marine_steam_turbine():
    """Gunter and Chen, Introduction to Dynamics of Rotor-Bearing Systems (2001), example 8.1, pp. 388-392.

    A propeller of five blades, 10 % of its mean torque at blade order, a bull gear, and two turbines behind double
    reductions. Read: the example that openTorsion distributes (``marine_steam_turbine_forced_response.py``), with the
    numbers of the model, the natural frequencies 177.7, 220.2 and 1282.6 1/min, and 12 of 55 points that it digitised
    from figure 8.10-5, the vibratory torque of the propeller shaft that DyRoBeS computed [rpm, lb in]. The book itself
    was not read; a modal damping of 0.398 % is openTorsion's. Precision: four figures of the frequencies; of the points
    as well as a drawing can be read, 5 % on the flanks, where a hundredth of the axis is 3 %, and 1 % at the peak.
    """
    u = POUND_INCH
    blades = [{"order": 5, "quadratic_amplitude": 0.1 * 22.24e6 * u / tn.rpm(85) ** 2}]
    line = tn.Driveline(
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
    modes = [w for w in tn.natural_frequencies(line).undamped_frequency if w > 0]
    assert np.array(modes[:3]) / tn.rpm(1) == pytest.approx([177.7, 220.2, 1282.6], abs=0.05)
    drawn = np.array(
        [
            (24.56, 0.3245e6), (28.11, 0.5957e6), (32.81, 1.8564e6), (34.37, 3.3191e6), (35.12, 3.9840e6),
            (35.46, 4.1489e6), (36.14, 3.9840e6), (36.82, 3.3191e6), (38.19, 2.2979e6), (40.64, 1.4362e6),
            (50.04, 0.6968e6), (97.11, 0.4096e6),
        ]
    )  # fmt: skip
    found = tn.order_response(line, tn.rpm(drawn[:, 0]))
    torque = found.vibratory_torque[:, found.springs.index("propeller shaft")] / u
    assert torque == pytest.approx(drawn[:, 1], rel=0.05)
    peak = tn.order_response(line, tn.rpm(np.linspace(35, 36, 201))).vibratory_torque[:, 0] / u
    assert peak.max() == pytest.approx(drawn[:, 1].max(), rel=0.01)


def eight_masses(frequency):
    parts = [tn.ConstantSpeed()]
    for i in range(1, 9):
        parts += [
            tn.Shaft(stiffness=1e5, damping=50.0),
            tn.Disk(inertia=10.0, excitation=shaken(frequency, 1.0) if i == 5 else []),
        ]
    return tn.Driveline([*parts, tn.Shaft(stiffness=1e5, damping=50.0), tn.Disk(inertia=1e13)])


def test_eight_masses_with_viscous_dampers():
    """Société française des mécaniciens, Guide de validation des progiciels de calcul de structures, SDLD21.

    Eight masses of 10 kg between nine springs of 1e5 N/m with dampers of 50 N s/m, held at both ends, a force of 1 N on
    the fifth. Read: the displacements [m] of the loaded mass that the guide's solution gives, as Code_Aster's test
    ``sdld21a`` quotes them; precision 5 figures.
    """
    published = {
        5.0: 1.0237e-04 - 8.5187e-06j,
        5.5: 4.5066e-04 - 7.7914e-04j,
        6.0: -9.4101e-05 - 1.0585e-05j,
        7.0: -2.4232e-05 - 1.2233e-06j,
        9.5: -1.7756e-06 - 6.3356e-07j,
        10.0: 8.4143e-07 - 1.0335e-06j,
        10.5: 5.1880e-06 - 3.4375e-06j,
        11.0: -7.3293e-06 - 1.2167e-05j,
        12.5: 1.1006e-06 - 8.4775e-07j,
        14.5: 8.6698e-06 - 2.7560e-06j,
        40.0: -2.5696e-06 - 2.7554e-07j,
    }
    found = at_frequencies(eight_masses, published)[:, 4]
    expected = np.array(list(published.values()))
    for part in (np.real, np.imag):
        assert part(found) == pytest.approx(part(expected), rel=6e-5)


def hysteretic(frequency):
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=28e3, loss_factor=0.1),
            tn.Disk(inertia=10.0),
            tn.Shaft(stiffness=28e3),
            tn.Disk(inertia=5.0, excitation=shaken(frequency, 100.0)),
        ]
    )


def test_two_masses_with_hysteretic_damping():
    """Code_Aster, handbook of validation V2.01.313, test SDLD313 (EDF), after the guide of the same society.

    k₁ = k₂ = 28 kN/m, η₁ = 0.1, m₁ = 10 kg, m₂ = 5 kg, 100 N on the second. Read: the problem's page, and the reference
    displacements [m] of the loaded mass in ``sdld313a``. Precision: the handbook's own 0.5 %; its figures agree to five
    away from the resonances and to 4e-4 at them, whose frequencies it gives with five figures.
    """
    published = {
        3.3687: 9.388216e-3 - 7.31196e-4j,
        6.4848: -5.0269e-3 - 7.07103e-2j,
        8.0006: -9.54931e-3 - 2.2154e-3j,
        11.8746: -4.23259e-5 - 3.57193e-4j,
        13.4747: 2.35524e-3 - 5.01765e-4j,
        15.5802: -1.6395374e-2 - 6.871471e-2j,
        21.0543: -1.88977e-3 - 5.53314e-6j,
    }
    found = at_frequencies(hysteretic, published)[:, 1]
    expected = np.array(list(published.values()))
    assert np.all(np.abs(found - expected) < 5e-4 * np.abs(expected))


def two_masses(frequency):
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


def test_two_masses_between_three_springs():
    """Thomson, Vibration Theory and Applications (1965), p. 178, example 6.6-1.

    m = 0.5 lb s²/in, k = 200 lb/in thrice, 200 lb on the first mass. Read: case VM90 of Ansys's verification manual,
    with these targets [in] at 1.5, 4 and 6.5 Hz, in phase or against the force; the book itself was not read. Precision
    five figures.
    """
    found = at_frequencies(two_masses, (1.5, 4.0, 6.5))[:, :2]
    targets = [[0.82272, 0.46274], [-0.51145, -1.2153], [-0.58513, 0.26966]]
    assert found.real == pytest.approx(np.array(targets), rel=5e-5)
    assert np.abs(found.imag).max() < 1e-12


def test_wind_turbine_recomputed():
    """*Recomputed, the article was not read*: Sopanen, Ruuskanen, Nerg and Pyrhönen, IEEE Trans. Ind. Electron. 58
    (2011), a turbine with a direct-driven generator.

    Read: openTorsion's notebook on it, with the model, table III of the article (torque ripple of the generator by
    order, as shares of its torque) and the eigenfrequencies 58.34 and 1034.115 rad/s. Its responses are drawn only, so
    that they are compared with the three equations solved here.
    """
    k1, k2, j = 3.67e8, 5.496e9, np.array([1e7, 5770.0, 97030.0])
    share = {4: 0.0018, 6: 0.0179, 8: 0.0024, 10: 0.0034, 12: 0.0117, 14: 0.0018, 16: 0.0011}
    ripple = [{"order": 60 * v, "amplitude": 2.9e6 * a} for v, a in share.items()]
    c1, c2 = 4e-4 * k1, 4e-5 * k2
    line = tn.Driveline(
        [
            tn.Disk(inertia=j[0], drive_share=1),
            tn.Shaft(stiffness=k1, damping=c1),
            tn.Disk(inertia=j[1]),
            tn.Shaft(stiffness=k2, damping=c2),
            tn.Disk(inertia=j[2], load_torque=2.9e6, excitation=ripple),
        ]
    )
    assert tn.natural_frequencies(line).undamped_frequency[1:] == pytest.approx([58.34, 1034.115], abs=5e-3)
    speed = tn.rpm(np.array([1.5, 4.0, 15.0]))
    found = tn.order_response(line, speed)
    assert found.order.tolist() == [60.0 * v for v in share]
    for s, w in enumerate(speed):
        for k, (v, a) in enumerate(share.items()):
            nu = 60 * v * w
            z1, z2 = k1 + 1j * nu * c1, k2 + 1j * nu * c2
            matrix = np.array([[z1, -z1, 0], [-z1, z1 + z2, -z2], [0, -z2, z2]]) - nu**2 * np.diag(j)
            # The ripple follows the generator, which the load holds back by its static twist.
            behind = 60 * v * 2.9e6 * (1 / k1 + 1 / k2)
            y = np.linalg.solve(matrix, [0, 0, 2.9e6 * a * np.exp(-1j * behind)])
            assert found.torque[s, k] == pytest.approx([z1 * (y[1] - y[0]), z2 * (y[2] - y[1])], rel=1e-8)
