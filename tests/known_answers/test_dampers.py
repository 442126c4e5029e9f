"""Viscous and tuned dampers against their closed forms and against equations written out here."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from pages import run_page
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.stability.stability_over_speed import stability_along

INERTIA, STIFFNESS = 0.12, 3e4
OMEGA = np.sqrt(STIFFNESS / INERTIA)


def single(damper: object, **more: object) -> tn.Driveline:
    """One disk on an undamped shaft, excited once a turn, with a damper on it."""
    excitation = [{"order": 1, "amplitude": 10.0}]
    elements = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=STIFFNESS, name="shaft"),
        tn.Disk(inertia=INERTIA, excitation=excitation, name="disk"),
        damper,
    ]
    return tn.Driveline(elements, **more)


def viscous(ratio: float, damping: float, **more: object) -> tn.ViscousDamper:
    return tn.ViscousDamper(ring_inertia=ratio * INERTIA, damping=damping, name="damper", **more)


def amplification(line: tn.Driveline, rates: np.ndarray) -> np.ndarray:
    """Twist of the shaft over the static one, by speed over ω_n."""
    found = tn.order_response(line, rates * OMEGA)
    return np.abs(found.torque[:, 0, list(found.springs).index("shaft")]) / 10.0


@pytest.mark.parametrize(("ratio", "best", "height"), [(1.0, 0.288675, 3.0), (0.2, 0.435194, 11.0)])
def test_houdaille_at_its_best(ratio: float, best: float, height: float) -> None:
    """ζ = 0.2887 and amplification 3 at inertia ratio 1; less and more damping are both worse."""
    found = tn.damper_optimum(single(viscous(ratio, 1.0)), "damper")
    assert found.frequency == pytest.approx(OMEGA, rel=1e-12)
    assert (found.inertia_ratio, found.damping_ratio) == pytest.approx((ratio, best), rel=2e-6)
    assert found.amplification == pytest.approx(height, rel=1e-12) and found.stiffness == 0.0
    assert found.damping == pytest.approx(2 * ratio * INERTIA * OMEGA * found.damping_ratio, rel=1e-12)
    rates = np.sqrt(2 / (2 + ratio)) * np.linspace(0.7, 1.3, 2001)  # the middle one is the fixed point
    peaks = {}
    for factor in (0.5, 0.8, 1.0, 1.25, 2.0):
        curve = amplification(single(viscous(ratio, factor * found.damping)), rates)
        assert curve[1000] == pytest.approx(height, rel=1e-10), "every curve goes through the fixed point"
        peaks[factor] = curve.max()
    assert peaks[1.0] == pytest.approx(height, rel=1e-7)
    assert all(peak > height * 1.0001 for factor, peak in peaks.items() if factor != 1.0)


@pytest.mark.parametrize("ratio", [0.05, 0.2, 1.0])
def test_den_hartogs_fixed_points(ratio: float) -> None:
    """All curves meet in two points, equally high, √((2 + μ)/μ), at the tuning 1/(1 + μ)."""
    line = single(tn.TunedDamper(ring_inertia=ratio * INERTIA, stiffness=1.0, damping=1.0, name="damper"))
    found = tn.damper_optimum(line, "damper")
    assert np.sqrt(found.stiffness / (ratio * INERTIA)) / OMEGA == pytest.approx(1 / (1 + ratio), rel=1e-12)
    # g² of the fixed points with f = 1/(1 + μ): g⁴ − 2g²(1 + f² + μf²)/(2 + μ) + 2f²/(2 + μ) = 0.
    f2 = 1 / (1 + ratio) ** 2
    middle = (1 + f2 + ratio * f2) / (2 + ratio)
    root = np.sqrt(middle**2 - 2 * f2 / (2 + ratio))
    rates = np.sqrt([middle - root, middle + root])
    for factor in (0.0, 0.6, 1.0, 3.0):
        tuned = line.replace("damper", stiffness=found.stiffness, damping=factor * found.damping)
        assert amplification(tuned, rates) == pytest.approx(found.amplification, rel=1e-9)
    assert found.amplification == pytest.approx(np.sqrt((2 + ratio) / ratio), rel=1e-12)
    best = line.replace("damper", stiffness=found.stiffness, damping=found.damping)
    assert amplification(best, np.linspace(0.3, 1.6, 4001)).max() < 1.02 * found.amplification
    if ratio == 1.0:
        assert found.damping_ratio == pytest.approx(0.216506, rel=2e-6)


def test_effective_inertia_of_a_mode_behind_gears() -> None:
    """μ of a geared line from kinetic energies of its modes, written out without the ring."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0, name="engine"),
            tn.Shaft(stiffness=8e4),
            tn.Disk(inertia=0.5, name="wheel"),
            tn.Ratio(ratio=3.0),
            tn.ViscousDamper(inertia=0.05, ring_inertia=0.2, damping=3.0, name="damper"),
            tn.Shaft(stiffness=5e3),
            tn.Disk(inertia=0.4),
        ]
    )
    wheel = 0.5 + 0.05 / 9
    mass = np.diag([2.0, wheel, 0.4])
    k1, k2 = 8e4, 5e3
    stiffness = np.array([[k1, -k1, 0], [-k1, k1 + k2 / 9, -k2 / 3], [0, -k2 / 3, k2]])
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    order = np.argsort(squares)[1:]
    for mode, at in enumerate(order, start=1):
        found, shape = tn.damper_optimum(line, "damper", mode), shapes[:, at]
        effective = (shape**2 @ np.diag(mass)) / (shape[1] / 3) ** 2
        assert found.frequency == pytest.approx(np.sqrt(squares[at]), rel=1e-10)
        assert found.effective_inertia == pytest.approx(effective, rel=1e-9)


def chain_matrix(inertias: list[float], stiffness: list[float], damping: list[float], *ring: float) -> np.ndarray:
    """ẋ = Ax of free disks in a row, a ring of inertia J dragged by c at the first: x = (φ, ω, ω_ring)."""
    n = len(inertias)
    k, c = np.zeros((n, n)), np.zeros((n, n))
    for i, (stiff, lossy) in enumerate(zip(stiffness, damping, strict=True)):
        for matrix, value in ((k, stiff), (c, lossy)):
            matrix[i : i + 2, i : i + 2] += value * np.array([[1, -1], [-1, 1]])
    over, (inertia, oil) = 1 / np.array(inertias)[:, None], ring
    a = np.zeros((2 * n + 1, 2 * n + 1))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n], a[n : 2 * n, n : 2 * n] = -k * over, -c * over
    a[n, n] -= oil / inertias[0]
    a[n, -1] = oil / inertias[0]
    a[-1, n], a[-1, -1] = oil / inertia, -oil / inertia
    return a


HUB, CRANK, RING, OIL = 3.0, 4.5, 9.0, 1500.0
CHAIN = [HUB, *[CRANK] * 6, 120.0]
SPRINGS = [6e6, *[8e6] * 5, 10e6]


def ship(damper: list[object]) -> tn.Driveline:
    """Crankshaft, flywheel and damper of a medium-speed diesel; its losses are those of the coupling behind."""
    names = ["damper hub", *(f"cylinder {i}" for i in range(1, 7)), "flywheel"]
    elements: list[object] = [tn.Disk(name=names[0], inertia=HUB), *damper]
    for name, inertia, stiffness in zip(names[1:], CHAIN[1:], SPRINGS, strict=True):
        elements += [tn.Shaft(name=f"to {name}", stiffness=stiffness), tn.Disk(name=name, inertia=inertia)]
    return tn.Driveline(elements)


def test_a_ship_has_no_false_mode() -> None:
    """The same frequencies as with a ring on a shaft of 1 N m/rad, without that shaft's mode, in two elements less."""
    damper = tn.ViscousDamper(name="damper", ring_inertia=RING, damping=OIL)
    found = tn.natural_frequencies(ship([damper]))
    values = np.linalg.eigvals(chain_matrix(CHAIN, SPRINGS, [0.0] * 7, RING, OIL))
    expected = values[values.imag > 1.0]
    expected = expected[np.argsort(expected.imag)]
    own = found.eigenvalue[found.still :, 0]
    assert found.still == 2 and found.rigid_body and len(own) == len(expected) == 7
    assert own == pytest.approx(expected, rel=1e-9)
    assert found.decay_rate[1] == pytest.approx([0.0, -values.real[np.abs(values.imag) < 1.0].min()], rel=1e-9)
    assert "mode 2: 0, ring of damper (oil alone drags it along" in str(found)
    assert "is not an instability and does not count" in str(found)

    old = [tn.Shaft(name="silicone", stiffness=1.0, damping=OIL), tn.Disk(name="ring", inertia=RING)]
    line = ship([])
    first, *rest = line.elements
    rest[0] = type(rest[0])(**rest[0].stated, after="damper hub")
    false = tn.natural_frequencies(tn.Driveline([first, *old, *rest]))
    with_spring = false.eigenvalue[~false.overdamped, 0]
    with_spring = np.sort_complex(1j * with_spring[with_spring.imag > 1.0].imag)
    assert with_spring.imag == pytest.approx(own.imag, rel=1e-6)
    assert false.undamped_frequency[1] == pytest.approx(np.sqrt(1.0 / RING), rel=0.1), "the mode that is false"
    campbell = tn.campbell_diagram(ship([damper]), np.linspace(30.0, 90.0, 5))
    assert campbell.mode[0] == 3 and campbell.frequency[0] == pytest.approx(own.imag, rel=1e-9)


def test_heavy_oil_locks_the_ring() -> None:
    """However strong the oil, the mode that belongs to the ring is the one at 0."""
    for damping in (0.1, 40.0, 1e3, 1e6):
        found = tn.natural_frequencies(single(viscous(3.0, damping)))
        assert found.eigenvalue[0, 0] == 0 and found.undamped_frequency[1] == pytest.approx(OMEGA)
    assert found.frequency[1] == pytest.approx(OMEGA / 2, rel=1e-4)


BENT = {"J1": 0.1, "J2": 0.2, "k1": 1e4, "c1": 0.2, "k2": 6e3, "c2": 0.3, "angle": 0.6, "Jr": 0.08, "cr": 3.0}


def bent(**more: object) -> tn.Driveline:
    b = BENT
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=b["k1"], damping=b["c1"], name="front"),
            tn.Disk(inertia=b["J1"], name="hub", **more),
            tn.ViscousDamper(ring_inertia=b["Jr"], damping=b["cr"], name="damper"),
            tn.HookeJoint(angle=b["angle"], name="joint"),
            tn.Shaft(stiffness=b["k2"], damping=b["c2"], name="rear"),
            tn.Disk(inertia=b["J2"], name="load"),
        ]
    )


def bent_multipliers(speed: float) -> np.ndarray:
    """Of the linearised equations written out, the ring by its speed alone: x = (δ₁, δ₂, ω₁, ω₂, ω_ring)."""
    b, cosine = BENT, np.cos(BENT["angle"])

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        d1, d2, w1, w2, wr = x.reshape(5, -1)
        # η of the Hooke joint and its rate, fork in the joint plane at t = 0.
        chi = speed * t
        down = 1 - (1 - cosine**2) * np.cos(chi) ** 2
        eta = cosine / down
        slope = -cosine * (1 - cosine**2) * np.sin(2 * chi) / down**2 * speed
        q, q_rate = d2 - eta * d1, w2 - eta * w1 - slope * d1
        torque, oil = b["k2"] * q + b["c2"] * q_rate, b["cr"] * (w1 - wr)
        first = (-b["k1"] * d1 - b["c1"] * w1 - oil + eta * torque) / b["J1"]
        return np.concatenate([w1, w2, first, -torque / b["J2"], oil / b["Jr"]])

    run = solve_ivp(rate, (0, np.pi / speed), np.eye(5).ravel(), method="DOP853", rtol=1e-12, atol=1e-13)
    return np.linalg.eigvals(run.y[:, -1].reshape(5, 5))


SPEEDS = (150.0, 232.0, 300.0)


@pytest.mark.parametrize("speed", SPEEDS)
def test_multipliers_of_a_bent_line(speed: float) -> None:
    """Those of the reduced equations, and exactly one at 1 that is set aside."""
    found, expected = tn.stability(bent(), speed), bent_multipliers(speed)
    others = found.multipliers[np.abs(found.multipliers - 1).argsort()]
    assert abs(others[0] - 1) < 1e-9 and found.set_aside == 1
    assert np.sort_complex(others[1:]) == pytest.approx(np.sort_complex(expected), abs=1e-8)
    assert found.spectral_radius == pytest.approx(np.abs(expected).max(), rel=1e-9)
    assert found.verdict is (tn.stability(bent(), speed).verdict)
    assert (found.spectral_radius > 1) is bool(np.abs(expected).max() > 1)


def test_charts_set_it_aside() -> None:
    """A chart's radius at its own points is that without the multiplier of the ring's position."""
    chart = tn.stability_chart(bent(), x=("speed", 140.0, 310.0, 60), y=("joint.angle", 0.5, 0.7, 41))
    for i in (0, 13, 30, 47, 59):
        expected = np.abs(bent_multipliers(float(chart.x[i]))).max()
        assert chart.y[20] == pytest.approx(BENT["angle"]) and chart.spectral_radius[20, i] == pytest.approx(
            expected, rel=1e-7
        )


NONLINEAR = 2e-4
"""Share by which twists of some 0.2 mrad behind a joint of 0.1 rad move the response away from the linear one."""


def test_response_and_heat_of_a_bent_line() -> None:
    """Amplitude of the oil's torque over all orders against a simulation that has settled, and the heat of the slip."""
    speed = 150.0
    line = bent(excitation=[{"order": 3, "amplitude": 0.2}]).replace("joint", angle=0.1)
    orders = tn.order_response(line, [speed])
    place = list(orders.springs).index("damper")
    turn = 2 * np.pi / speed
    run = tn.simulate(line, 400 * turn, speed=speed)
    torque = run.torque_at(turn * (399 + np.arange(4000) / 4000))[:, place]
    assert orders.peak_torque[0, place] == pytest.approx(np.abs(torque).max(), rel=NONLINEAR)
    assert orders.heat[0, place] == pytest.approx(np.mean(torque**2) / BENT["cr"], rel=NONLINEAR)


def test_the_heat_of_slip_in_closed_form() -> None:
    """½ c |Δω|² of one disk and a ring."""
    c, speed = 7.0, 420.0
    found = tn.order_response(single(viscous(0.6, c)), [speed])
    ring = 0.6 * INERTIA
    # (−ω²J_r + iωc) φ_r = iωc φ.
    through = 1j * speed * c / (1j * speed * c - speed**2 * ring)
    disk = 10.0 / (STIFFNESS - speed**2 * INERTIA + 1j * speed * c * (1 - through))
    slip = abs(speed * disk * (through - 1))
    assert found.heat[0, list(found.springs).index("damper")] == pytest.approx(0.5 * c * slip**2, rel=1e-10)


def test_complex_stiffness_against_a_dense_solution() -> None:
    """k′ + iωc′ between housing and ring."""
    k, c, ring = 2.2e3, 5.0, 0.05
    line = single(tn.ViscousDamper(inertia=0.02, ring_inertia=ring, damping=c, stiffness=k, name="damper"))
    speeds = np.array([120.0, 300.0, 480.0, 700.0])
    found = tn.order_response(line, speeds)
    for row, w in enumerate(speeds):
        link = k + 1j * w * c
        matrix = np.array([[STIFFNESS + link - w**2 * (INERTIA + 0.02), -link], [-link, link - w**2 * ring]])
        disk, out = np.linalg.solve(matrix, [10.0, 0.0])
        torque = np.abs(found.torque[row, 0])
        assert torque == pytest.approx([abs(STIFFNESS * disk), abs(link * (out - disk))], rel=1e-10)
    assert tn.stability(line, 200.0).set_aside == 0


def test_a_spun_line_shares_its_momentum_with_the_ring() -> None:
    """Free of outer torques, housing and ring end at one speed; the oil takes what energy is lost."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="one"),
            tn.Shaft(stiffness=4e3, damping=1.0),
            tn.Disk(inertia=0.2, name="two"),
            tn.ViscousDamper(ring_inertia=0.5, damping=2.0, name="damper"),
        ]
    )
    run = tn.simulate(line, 4.0, speed=100.0, start=[0, 0, 0, 5.0, 5.0, -5.0])
    end = run.final
    assert end[3:] == pytest.approx(0.0, abs=1e-6), "momentum is kept: (0.3 + 0.2) 5 − 0.5 5 = 0"
    slip = 10.0 * 0.25 / 2.0  # of two inertias of 0.5: slip over its decay rate c/J, J = 0.25
    assert end[0] - end[2] == pytest.approx(slip, rel=5e-3)


def test_what_needs_one_periodic_motion_is_refused_with_a_remedy() -> None:
    line = bent()
    for ask in (
        lambda: tn.periodic_response(line, 150.0),
        lambda: tn.periodic_branch(line, "speed", 150.0, 160.0, speed=150.0),
        lambda: tn.certify_chaos(line, speed=150.0),
        lambda: tn.exact_motion(single(viscous(1.0, 5.0)), 1.0, speed=150.0),
    ):
        with pytest.raises(tn.InputError, match="has no spring, so that its ring may stand anywhere") as caught:
            ask()
        assert "tn.simulate" in str(caught.value)
    stiff = line.replace("damper", stiffness=500.0)
    assert tn.periodic_response(stiff, 150.0).orbit.outcome.ok


def test_a_damper_is_a_branch_by_itself() -> None:
    """What follows hangs on the shaft in front of it, and several stand side by side."""
    first = tn.ViscousDamper(ring_inertia=0.05, damping=1.0)
    second = tn.TunedDamper(ring_inertia=0.02, stiffness=900.0)
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1), first, second])
    line = tn.Driveline([*line.elements, tn.Shaft(stiffness=2e4), tn.Disk(inertia=0.3)])
    found = tn.natural_frequencies(line)
    assert found.names == ("Disk 1", "ring of ViscousDamper 1", "ring of TunedDamper 1", "Disk 2")
    k = np.array([[1e4 + 900 + 2e4, -900, -2e4], [-900, 900, 0], [-2e4, 0, 2e4]])
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.diag(1 / np.array([0.1, 0.02, 0.3])) @ k).real))
    assert found.undamped_frequency == pytest.approx([0.0, *expected], rel=1e-9)
    assert all(a < b for a, b in pairwise(found.undamped_frequency))
    again = tn.loads(tn.dumps(line))
    assert again == line


def chain(ends: str, stiffness: float | None, count: int = 20, angle: float = 0.0) -> tn.Driveline:
    """Some twenty inertias with a ring in mid-line and one at the end; the first disk is shaken, at one speed by a
    torque that stands still."""
    link = {} if stiffness is None else {"stiffness": stiffness}
    shaken = [{"order": 2, "amplitude": 10.0}, {"order": 1, "frequency": -100.0, "amplitude": 4.0}]
    elements: list[object] = [tn.ConstantSpeed()] if ends == "driven" else []
    for i in range(count):
        elements += [tn.Shaft(stiffness=3e4, damping=3.0, name=f"s{i}")] if elements else []
        more = {"excitation": shaken} if i == 1 else {"viscous_load": 0.05} if i == count - 1 else {}
        elements.append(tn.Disk(inertia=0.3 + 0.02 * i, drive_share=float(not elements), name=f"d{i}", **more))
        if angle and i == 5:
            elements += [tn.HookeJoint(angle=angle, name="joint"), tn.Disk(inertia=0.05, name="yoke")]
        if i in (3, count - 1):
            elements.append(tn.ViscousDamper(ring_inertia=0.2, damping=20.0, name=f"r{i}", **link))
    return tn.Driveline(elements)


@pytest.mark.parametrize("ends", ["driven", "free"])
def test_long_lines_with_rings_are_the_limit_of_soft_oil(ends: str) -> None:
    """Orders of a straight line, one of them a torque that stands still, against rings on ever softer springs."""
    speeds = [80.0, 100.0, 130.0]
    found = tn.order_response(chain(ends, None), speeds).data["torque"].to_numpy()
    off = [
        np.abs(tn.order_response(chain(ends, k), speeds).data["torque"].to_numpy() - found).max() for k in (1e-1, 1e-3)
    ]
    assert np.isfinite(found).all() and off[1] < 1.1e-2 * off[0] < 1e-3 * np.abs(found).max()


def test_multipliers_of_a_long_line_with_rings() -> None:
    """Against e^{λT} of the eigenvalues of the matrices written out."""
    speed, n = 150.0, 20
    line = chain("driven", None)
    inertia = np.array([0.3 + 0.02 * i for i in range(n)] + [0.2, 0.2])
    k, c = np.zeros((n + 2, n + 2)), np.zeros((n + 2, n + 2))
    for i in range(n):
        one = np.eye(n + 2)[i] - (np.eye(n + 2)[i - 1] if i else 0.0)
        k, c = k + 3e4 * np.outer(one, one), c + 3.0 * np.outer(one, one)
    for ring, on in ((n, 3), (n + 1, n - 1)):
        one = np.eye(n + 2)[ring] - np.eye(n + 2)[on]
        c = c + 20.0 * np.outer(one, one)
    c[n - 1, n - 1] += 0.05
    state = np.block([[np.zeros_like(k), np.eye(n + 2)], [-k / inertia[:, None], -c / inertia[:, None]]])
    values = np.linalg.eigvals(state)
    left = np.abs(values).argsort()[2:]
    assert np.abs(np.delete(values, left)).max() < 1e-9
    found = tn.stability(line, speed)
    assert found.set_aside == 2
    expected = np.exp(values[left].real.max() * found.period / speed)
    assert found.spectral_radius == pytest.approx(expected, abs=1e-9)


def test_a_long_bent_line_with_rings_is_judged_alike_everywhere() -> None:
    """One speed by its matrix over the period, many by the chain kernel, and soft oil mode by mode."""
    line, soft = (chain("driven", k, 42, np.deg2rad(12)) for k in (None, 1e-3))
    one = tn.stability(line, 150.0)
    along = stability_along(assemble(line), [150.0])
    assert one.set_aside == 2 and along.radius == pytest.approx(one.spectral_radius, abs=1e-7)
    every = np.sort(np.abs(tn.stability(soft, 150.0).multipliers))[::-1]
    assert every[2] == pytest.approx(one.spectral_radius, abs=1e-6), "behind those of both rings"


def test_a_ring_behind_a_differential() -> None:
    """Legs turn against each other, rings are dragged along: each is one mode at 0, and none is another's."""

    def car(free: bool, load: float, **link: float) -> tn.Driveline:
        first = tn.Disk(inertia=0.5, drive_share=1.0) if free else tn.ConstantSpeed()
        ring = {"ring_inertia": 0.2, "damping": 20.0, **link}
        return tn.Driveline(
            [
                first, tn.Shaft(stiffness=3e4, damping=3.0), tn.Disk(inertia=0.3), tn.ViscousDamper(**ring),
                tn.Differential(name="drive", ratio=3.5), tn.Disk(inertia=0.05),
                tn.Shaft(stiffness=2e4, damping=2.0), tn.Disk(inertia=0.4, viscous_load=load), tn.ViscousDamper(**ring),
                tn.Disk(inertia=0.05, after="drive.right"),
                tn.Shaft(stiffness=2e4, damping=2.0), tn.Disk(inertia=0.6, viscous_load=load),
            ]
        )  # fmt: skip

    for free in (False, True):
        for load in (0.0, 2.0):
            found, soft = (tn.natural_frequencies(car(free, load, **link)) for link in ({}, {"stiffness": 1e-4}))
            assert (found.rigid_motions, found.still) == (1 + free, 3 + free)
            assert soft.still == 1 + free
            assert found.eigenvalue == pytest.approx(soft.eigenvalue, abs=2e-5)
            judged = tn.stability(car(free, load), 100.0)
            assert judged.set_aside == found.still + (0 if load else found.rigid_motions)
            assert "set aside" in str(judged)
            slowest = np.sort(found.decay_rate.ravel())[judged.set_aside]
            assert judged.growth_rate == pytest.approx(-slowest, abs=1e-6)


def test_the_page_runs() -> None:
    """Its numbers are those of its table."""
    printed, names = run_page("components")
    assert names["best"].damping_ratio == pytest.approx(0.288675, abs=1e-6)
    assert "amplification 3" in printed and "oil alone drags it along" in printed


def test_the_optimum_on_a_leg_of_a_differential_is_that_of_masses_that_are_coupled() -> None:
    """Case a, right leg r and wheel w: the left leg turns 2a − r (with the final drive 1), so M couples a and r."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1), tn.Differential(name="d"),
            tn.Disk(inertia=0.2, name="left"), tn.Disk(inertia=0.3, name="right", after="d.right"),
            tn.Shaft(stiffness=2e3), tn.Disk(inertia=0.5),
            tn.ViscousDamper(name="damper", ring_inertia=0.05, damping=1.0, after="right"),
        ]
    )  # fmt: skip
    mass = np.array([[0.9, -0.4, 0.0], [-0.4, 0.5, 0.0], [0.0, 0.0, 0.5]])
    stiffness = np.array([[1e4, 0.0, 0.0], [0.0, 2e3, -2e3], [0.0, -2e3, 2e3]])
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    order = np.argsort(squares)
    for mode, k in enumerate(order[1:], start=1):
        shape = shapes[:, k] / shapes[1, k]
        found, effective = tn.damper_optimum(line, "damper", mode), shape @ mass @ shape
        assert found.frequency == pytest.approx(np.sqrt(squares[k]), rel=1e-9)
        assert found.effective_inertia == pytest.approx(effective, rel=1e-9)


@pytest.mark.parametrize("mode", ["x", None, 1.0, True, [1], 0, 2])
def test_a_mode_is_a_number_of_one(mode: object) -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1),
            tn.ViscousDamper(name="damper", ring_inertia=0.05, damping=1.0),
        ]
    )  # fmt: skip
    with pytest.raises(tn.InputError, match="is not an elastic mode"):
        tn.damper_optimum(line, "damper", mode)  # type: ignore[arg-type]


def test_a_loop_onto_its_own_shaft_and_a_belt_to_nothing_are_refused() -> None:
    front = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1, name="a")]
    with pytest.raises(tn.InputError, match="closes onto the shaft that it starts from"):
        tn.natural_frequencies(tn.Driveline([*front, tn.Shaft(name="x", stiffness=1e6, to="a")]))
    with pytest.raises(tn.InputError, match="Belt 1: has no inertia behind it; put a Disk behind Belt 1"):
        tn.natural_frequencies(tn.Driveline([*front, tn.Belt(radius_in=0.1, radius_out=0.1, span_stiffness=1e5)]))
