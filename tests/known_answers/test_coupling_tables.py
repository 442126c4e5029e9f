"""Couplings over mean torque and temperature against closed forms, and where they settle against own equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import trunnion as tn
from trunnion.errors import InputError

TORQUES, STIFFNESSES = [100.0, 400.0, 1000.0], [2e4, 5e4, 6e4]


def loaded(load: float = 0.0, **more: object) -> tn.Driveline:
    coupling = tn.Coupling(torques=TORQUES, stiffnesses=STIFFNESSES, name="rubber", **more)
    return tn.Driveline([tn.ConstantSpeed(), coupling, tn.Disk(inertia=2.0, load_torque=load, name="load")])


@pytest.mark.parametrize("load", [-1000.0, -250.0, 0.0, 60.0, 100.0, 333.0, 400.0, 777.0, 1000.0])
def test_the_stiffness_is_that_at_the_mean_torque(load):
    """Between its points on a straight line, at either sign; below the first that of the first."""
    stiffness = np.interp(abs(load), TORQUES, STIFFNESSES)
    found = tn.natural_frequencies(loaded(load)).undamped_frequency
    assert found == pytest.approx([np.sqrt(stiffness / 2.0)], rel=1e-12)


def test_the_stiffness_follows_a_load_over_the_speed():
    """T = c ω² at every speed of its own, also where another speed stands first in the list."""
    line = loaded().replace("load", quadratic_load=0.01, excitation=[{"order": 2, "amplitude": 30.0}])
    line = line.replace("rubber", relative_damping=0.6)
    speeds = np.array([60.0, 300.0, 150.0, 220.0])
    found = tn.order_response(line, speeds)
    for i, speed in enumerate(speeds):
        k = np.interp(0.01 * speed**2, TORQUES, STIFFNESSES)
        nu = 2 * speed
        slope = 2 * 0.01 * speed
        expected = (
            30.0 * k * abs(1 + 0.6j / (2 * np.pi)) / abs(k * (1 + 0.6j / (2 * np.pi)) - 2 * nu**2 + 1j * nu * slope)
        )
        assert found.vibratory_torque[i, 0] == pytest.approx(expected, rel=1e-9)


def test_largest_torques_are_found_where_stiffness_moves_the_resonance():
    """A search over the range against a scan of the closed form."""
    line = loaded().replace("load", quadratic_load=0.01, excitation=[{"order": 2, "amplitude": 30.0}])
    line = line.replace("rubber", relative_damping=0.3)
    line = line.but(
        limits=[tn.Limit(of="rubber", vibratory_torque=5e3)], operation=tn.Operation(speed_range=(20.0, 310.0))
    )
    speed = np.linspace(20.0, 310.0, 400_001)
    k = np.interp(0.01 * speed**2, TORQUES, STIFFNESSES) * (1 + 0.3j / (2 * np.pi))
    torque = 30.0 * np.abs(k / (k - 2 * (2 * speed) ** 2 + 1j * 2 * speed * 0.02 * speed))
    check = tn.assess(line).check("vibratory torque of rubber")
    assert check.value == pytest.approx(torque.max(), rel=1e-6)


def test_a_mean_torque_beyond_the_table_is_refused_with_both():
    with pytest.raises(InputError) as caught:
        tn.natural_frequencies(loaded(1200.0))
    assert str(caught.value).startswith("rubber.torques: end at 1000 N m, and it carries a mean torque of 1200 N m; ")
    line = loaded().replace("load", quadratic_load=0.01)
    with pytest.raises(InputError, match=r"rubber.stiffnesses: follows the mean torque, which loads over speed leave"):
        tn.natural_frequencies(line)
    operating = line.but(operation=tn.Operation(speed=200.0))
    found = tn.natural_frequencies(operating)
    assert found.undamped_frequency == pytest.approx([np.sqrt(5e4 / 2.0)], rel=1e-12)
    assert any("rubber is loaded as at 1910 rpm" in one.sentence for one in found.findings)


def test_factors_of_temperature_multiply_stiffness_and_damping():
    heat = {"temperatures": [300.0, 340.0], "stiffness_factors": [1.0, 0.6], "damping_factors": [1.0, 0.8]}
    for damping in ({"relative_damping": 0.8, "loss_factor_frequency": 150.0}, {"damping": 40.0}, {"loss_factor": 0.1}):
        line = loaded(250.0, temperature=330.0, **heat, **damping)
        k, factor = np.interp(250.0, TORQUES, STIFFNESSES) * 0.7, 0.85
        response = tn.order_response(line.replace("load", excitation=[{"order": 1, "amplitude": 7.0}]), [55.0])
        lost = {
            "relative_damping": 0.8 / (2 * np.pi) * factor * k / 150.0 * 55.0,
            "damping": 40.0 * factor * 55.0,
            "loss_factor": 0.1 * factor * k,
        }[next(iter(damping))]
        expected = 7.0 * abs((k + 1j * lost) / (k + 1j * lost - 2.0 * 55.0**2))
        assert response.vibratory_torque[0, 0] == pytest.approx(expected, rel=1e-10)


def own_heat(line: tn.Driveline, speed: float, temperatures: dict[str, float]) -> dict[str, float]:
    """P [W] of every coupling of a chain of disks and couplings, by dense matrices written out here."""
    disks = [e for e in line.elements if isinstance(e, tn.Disk)]
    couplings = [e for e in line.elements if isinstance(e, tn.Coupling)]
    mass = np.diag([e.inertia for e in disks])
    total = np.zeros((len(disks), len(disks)), dtype=complex)
    each = []
    for i, one in enumerate(couplings):
        at = temperatures[one.name]
        k = one.stiffness * np.interp(at, one.temperatures, one.stiffness_factors)
        eta = one.relative_damping / (2 * np.pi) * np.interp(at, one.temperatures, one.damping_factors)
        total[np.ix_([i, i + 1], [i, i + 1])] += k * (1 + 1j * eta) * np.array([[1, -1], [-1, 1]])
        each.append(eta * k)
    heat = dict.fromkeys((one.name for one in couplings), 0.0)
    for order in {e.order for d in disks for e in d.excitation}:
        force = np.array([sum(e.amplitude for e in d.excitation if e.order == order) for d in disks])
        nu = order * speed
        # one rotation is free of springs: fixed by the sum of moments
        x = np.linalg.solve(total - nu**2 * mass, force.astype(complex))
        for i, one in enumerate(couplings):
            heat[one.name] += 0.5 * each[i] * nu * abs(x[i] - x[i + 1]) ** 2
    return heat


def rubber(name: str, draw: np.random.Generator, resistance: float) -> tn.Coupling:
    soft = np.sort(draw.uniform(0.3, 1.0, 2))[::-1]
    thin = np.sort(draw.uniform(0.4, 1.0, 2))[::-1]
    return tn.Coupling(
        stiffness=float(draw.uniform(1e4, 4e4)), relative_damping=float(draw.uniform(0.4, 1.4)), name=name,
        temperature=310.0, temperatures=[290.0, 330.0, 370.0], stiffness_factors=[1.05, *soft],
        damping_factors=[1.02, *thin], thermal_resistance=resistance, ambient_temperature=float(draw.uniform(292, 305)),
    )  # fmt: skip


def one_coupling(seed: int) -> tuple[tn.Driveline, float]:
    draw = np.random.default_rng(seed)
    shaken = [{"order": k, "amplitude": float(draw.uniform(50 * (4 - k), 900 / k))} for k in (2, 3)]
    engine = tn.Disk(inertia=float(draw.uniform(1, 4)), drive_share=1, excitation=shaken)
    line = tn.Driveline(
        [engine, rubber("rubber", draw, float(draw.uniform(0.05, 1.0))), tn.Disk(inertia=float(draw.uniform(1, 5)))]
    )
    own = np.sqrt(line.elements[1].stiffness * (1 / engine.inertia + 1 / line.elements[2].inertia))
    return line, float(draw.uniform(0.25, 1.0) * own / 2)


def own_roots(line: tn.Driveline, speed: float) -> list[float]:
    """Every balance between cold and the end of the table, on a grid that the product does not have."""
    one = line.elements[1]

    def excess(at: float) -> float:
        return one.ambient_temperature + one.thermal_resistance * own_heat(line, speed, {"rubber": at})["rubber"] - at

    grid = np.linspace(one.ambient_temperature, 370.0, 1237)
    values = [excess(at) for at in grid]
    return [
        float(brentq(excess, a, b, xtol=1e-11))
        for a, b, fa, fb in zip(grid, grid[1:], values, values[1:], strict=False)
        if (fa > 0) != (fb > 0)
    ]


@pytest.mark.parametrize("seed", range(40))
def test_settled_temperatures_against_own_equations(seed):
    line, speed = one_coupling(seed)
    roots = own_roots(line, speed)
    found = tn.coupling_temperatures(line, [speed])
    stays, lost = roots[0::2], roots[1::2]
    assert found.settled[0] == len(stays)
    if stays:
        assert found.temperature[0, 0] == pytest.approx(stays[0], abs=1e-6)
        assert found.hottest[0, 0] == pytest.approx(stays[-1], abs=1e-6)
        heat = own_heat(line, speed, {"rubber": stays[0]})["rubber"]
        assert found.heat[0, 0] == pytest.approx(heat, rel=1e-7)
    else:
        assert np.isnan(found.temperature[0, 0])
        assert any("settles at no temperature" in one.sentence for one in found.findings)
    if len(lost) == len(stays) and stays:
        assert found.runaway[0] == pytest.approx(lost[-1], abs=1e-6)
    else:
        assert np.isnan(found.runaway[0])


def test_the_random_couplings_settle_nowhere_once_and_twice():
    """So that the test before has seen them all: balances of 0, 1, 2 and 3."""
    assert [len(own_roots(*one_coupling(seed))) for seed in (1, 0, 10, 38)] == [0, 1, 2, 3]


@pytest.mark.parametrize("seed", range(12))
def test_two_couplings_settle_together(seed):
    """They change each other's heat: residuals and neighbours by own equations."""
    draw = np.random.default_rng(1000 + seed)
    engine = tn.Disk(inertia=2.0, drive_share=1, excitation=[{"order": 2, "amplitude": float(draw.uniform(50, 300))}])
    names = ("first", "second")
    couplings = [rubber(name, draw, float(draw.uniform(0.02, 0.2))) for name in names]
    line = tn.Driveline([engine, couplings[0], tn.Disk(inertia=1.5), couplings[1], tn.Disk(inertia=3.0)])
    speed = float(draw.uniform(20.0, 80.0))
    found = tn.coupling_temperatures(line, [speed])
    start = [one.ambient_temperature for one in couplings]

    def excess(at: np.ndarray) -> np.ndarray:
        heat = own_heat(line, speed, dict(zip(names, at, strict=True)))
        sums = [c.ambient_temperature + c.thermal_resistance * heat[c.name] for c in couplings]
        return np.array(sums) - at

    at = np.array(start)
    for _ in range(200_000):  # in time, by small steps, from cold
        step = 0.02 * excess(at)
        at = at + step
        if (at > 370.0).any() or np.abs(step).max() < 1e-9:
            break
    if (at > 370.0).any():
        assert np.isnan(found.temperature[0]).all()
    else:
        assert found.temperature[0] == pytest.approx(at, abs=1e-5)
        assert np.abs(excess(found.temperature[0])).max() < 1e-6
        warm = tn.order_response(found.line_at(speed), [speed]).heat[0]
        assert warm == pytest.approx(found.heat[0], rel=1e-6)


def test_assess_judges_the_settled_temperature_and_not_the_stated_one():
    """The same line, allowed a little more and a little less than its hottest; and one that heats on."""
    engine = tn.Disk(inertia=2.0, drive_share=1, excitation=[{"order": 2, "amplitude": 300.0}])
    soft = tn.Coupling(
        stiffness=2e4, relative_damping=1.0, temperature="40 degC", temperatures=["20 degC", "60 degC", "100 degC"],
        stiffness_factors=[1.1, 1, 0.5], damping_factors=[1, 0.9, 0.5], thermal_resistance=0.3,
        ambient_temperature="30 degC", name="rubber",
    )  # fmt: skip
    line = tn.Driveline(
        [engine, soft, tn.Disk(inertia=3.0)],
        limits=[tn.Limit(of="rubber", max_torque=1e9)],
        operation=tn.Operation(speed_range=(56.0, 90.0)),
    )
    scan = [own_roots(line, speed)[0] for speed in np.linspace(56.0, 90.0, 103)]
    hottest = max(scan)
    for allowed, status in ((hottest + 0.2, "satisfied"), (hottest - 0.2, "exceeded")):
        check = tn.assess(line.replace("rubber", highest_temperature=allowed)).check("temperature of rubber")
        assert str(check.status) == status
        assert check.value == pytest.approx(hottest, abs=1e-3) and check.speed == pytest.approx(56.0)
        assert "all other checks take it at 40 °C, as stated" in check.because
    lost = line.replace("rubber", thermal_resistance=2.0, highest_temperature="95 degC")
    check = tn.assess(lost).check("temperature of rubber")
    assert str(check.status) == "exceeded" and "settles at no temperature up to 100 °C" in check.because
