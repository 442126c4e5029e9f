"""Silicone oil by its complex stiffness over frequency and temperature, against dense solves of its own equations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import fsolve

import trunnion as tn
from trunnion.errors import InputError, InputRemark

pytestmark = pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
F = np.array([20.0, 60.0, 150.0, 400.0, 900.0]) * 2 * np.pi
STORAGE = np.array([500.0, 2400.0, 8000.0, 22000.0, 41000.0])
LOSS = np.array([3100.0, 8200.0, 17000.0, 31000.0, 42000.0])
RING, HUB, FAR, SHAFT = 0.12, 0.25, 0.9, 6e4


def oil(storage: np.ndarray = STORAGE, loss: np.ndarray = LOSS, **more: float) -> list[dict[str, float]]:
    rows = zip(F.tolist(), storage.tolist(), loss.tolist(), strict=True)
    return [{"frequency": f, "stiffness": k, "loss_stiffness": h} | more for f, k, h in rows]


def line(points: list[dict[str, float]], **more: float) -> tn.Driveline:
    """Shaken at the hub that the damper stands on; the far end is heavy and free."""
    damper = tn.ViscousDamper(name="damper", ring_inertia=RING, oil=points, **{"oil_frequency": "60 Hz"} | more)
    hub = tn.Disk(inertia=HUB, drive_share=1.0, excitation=[{"order": 3, "amplitude": 80.0, "phase": 0.4}])
    return tn.Driveline([hub, damper, tn.Shaft(stiffness=SHAFT, damping=4.0, name="shaft"), tn.Disk(inertia=FAR)])


def own(frequency: np.ndarray | float) -> np.ndarray:
    """K′ + iK″ by the rule that the page states, from the table alone."""
    curves = (np.exp(PchipInterpolator(np.log(F), np.log(part))(np.log(frequency))) for part in (STORAGE, LOSS))
    storage, loss = curves
    return storage + 1j * loss


def dense(w: float, k: complex) -> np.ndarray:
    """Rotations of hub, ring and far end under one N m at the hub."""
    s = SHAFT + 4j * w
    matrix = np.array([[k + s - HUB * w**2, -k, -s], [-k, k - RING * w**2, 0.0], [-s, 0.0, s - FAR * w**2]])
    return np.linalg.solve(matrix, [1.0, 0.0, 0.0])


def test_forced_responses_have_it_at_their_own_frequencies() -> None:
    """An order over a range, torque, twist and heat, against a dense solve at each frequency."""
    speeds = np.linspace(50.0, 500.0, 31)
    found = tn.order_response(line(oil()), speeds)
    place = found.springs.index("damper")
    for i, w in enumerate(3 * speeds):
        y = 80.0 * dense(w, own(w))
        twist = y[1] - y[0]
        assert abs(found.twist[i, 0, place]) == pytest.approx(abs(twist), rel=1e-10)
        assert found.vibratory_torque[i, place] == pytest.approx(abs(own(w) * twist), rel=1e-9)
        assert found.heat[i, place] == pytest.approx(0.5 * w * own(w).imag * abs(twist) ** 2, rel=1e-9)


def test_at_its_frequency_a_spring_and_a_damper_are_the_same() -> None:
    w, k = 2 * np.pi * 60.0, complex(own(2 * np.pi * 60.0))
    plain = line(oil()).replace("damper", oil=(), oil_frequency=None, stiffness=k.real, damping=k.imag / w)
    one, other = (tn.stability(each, 100.0) for each in (line(oil()), plain))
    assert one.growth_rate == pytest.approx(other.growth_rate, rel=1e-9)
    both = [tn.order_response(each, [w / 3]).vibratory_torque for each in (line(oil()), plain)]
    assert both[0] == pytest.approx(both[1], rel=1e-10)


def test_a_bent_line_takes_it_at_the_stated_frequency() -> None:
    bent = [tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=SHAFT, damping=4.0)]
    bent += [tn.Disk(inertia=HUB), line(oil()).elements[1]]
    k, w = complex(own(2 * np.pi * 60.0)), 2 * np.pi * 60.0
    plain = tn.ViscousDamper(name="damper", ring_inertia=RING, stiffness=k.real, damping=k.imag / w)
    one, other = (tn.order_response(tn.Driveline(each), [90.0]) for each in (bent, [*bent[:-1], plain]))
    assert one.vibratory_torque == pytest.approx(other.vibratory_torque, rel=1e-9)
    assert one.heat == pytest.approx(other.heat, rel=1e-9)


def test_modes_are_those_at_their_own_frequencies() -> None:
    """λ of each mode solves the equations whose oil is as at Im λ: by Newton's rule from beside it."""
    found = tn.natural_frequencies(line(oil()))

    def left(x: np.ndarray) -> list[float]:
        value = complex(x[0], x[1])
        k = own(x[1])
        k = k.real + value * k.imag / x[1]
        s = SHAFT + 4 * value
        matrix = np.array(
            [[k + s + HUB * value**2, -k, -s], [-k, k + RING * value**2, 0.0], [-s, 0, s + FAR * value**2]]
        )
        scaled = np.linalg.det(matrix / SHAFT)
        return [scaled.real, scaled.imag]

    oscillating = [j for j in range(1, 3) if not found.overdamped[j]]
    assert oscillating
    for j in oscillating:
        value = found.eigenvalue[j, 0]
        root = fsolve(left, [value.real * 1.01, value.imag * 1.01], xtol=1e-13)
        assert complex(root[0], root[1]) == pytest.approx(value, rel=1e-8)
    assert found.still == 1


def test_houdaille_by_a_table() -> None:
    """Oil that is all but a damper: at inertia ratio 1 the best has ζ = 0.2887 and an amplification of 3."""
    shaft, inertia = 1e4, 0.5
    free = np.sqrt(shaft / inertia)
    c = 2 * inertia * free * 0.288675
    f = np.geomspace(0.2, 4.0, 40) * free
    points = [{"frequency": w, "stiffness": 1e-6 * c * w, "loss_stiffness": c * w} for w in f]
    damper = tn.ViscousDamper(ring_inertia=inertia, oil=points, oil_frequency=free)
    disk = tn.Disk(inertia=inertia, excitation=[{"order": 1, "amplitude": 1.0}])
    subject = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=shaft, name="shaft"), disk, damper])
    speeds = free * np.linspace(0.5, 1.2, 141)
    found = tn.order_response(subject, speeds)
    top = found.vibratory_torque[:, found.springs.index("shaft")].max()
    assert top == pytest.approx(3.0, rel=2e-4)


def test_temperatures_and_a_table_beside_the_file(tmp_path: Path) -> None:
    """Between two temperatures logarithms follow a straight line; a CSV file says the same as points."""
    warm = [*oil(temperature=333.15), *oil(STORAGE / 3, LOSS / 2, temperature=363.15)]
    middle = line(warm, oil_temperature=348.15)
    w = 3 * 70.0
    k = np.exp(np.log(own(w).real) - np.log(3) / 2) + 1j * np.exp(np.log(own(w).imag) - np.log(2) / 2)
    twist = 80.0 * (lambda y: y[1] - y[0])(dense(w, k))
    found = tn.order_response(middle, [70.0])
    assert abs(found.twist[0, 0, found.springs.index("damper")]) == pytest.approx(abs(twist), rel=1e-10)
    head = "frequency [rad/s],stiffness [N*m/rad],loss_factor,temperature [K]"
    rows = [
        f"{p['frequency']!r},{p['stiffness']!r},{p['loss_stiffness'] / p['stiffness']!r},{p['temperature']}"
        for p in warm
    ]
    (tmp_path / "oil.csv").write_text("\n".join([head, *rows]))
    (tmp_path / "line.toml").write_text(
        'format = 1\n[[element]]\ntype = "Disk"\ninertia = 1\n[[element]]\ntype = "ViscousDamper"\nring_inertia = 0.1\n'
        'oil = "oil.csv"\noil_frequency = "60 Hz"\noil_temperature = "75 degC"\n'
    )
    read = tn.load(tmp_path / "line.toml").elements[1]
    assert isinstance(read, tn.ViscousDamper)
    assert read.complex_stiffness(300.0, 348.15) == pytest.approx(middle.elements[1].complex_stiffness(300.0, 348.15))
    assert tn.loads(tn.dumps(middle)).elements[1] == middle.elements[1]


def test_motions_in_time_have_a_maxwell_element() -> None:
    """Shaken at its frequency the settled twist is that of the oil; and the element's own equations, integrated."""
    speed = 2 * np.pi * 60.0 / 3
    subject = line(oil())
    maxwell = subject.elements[1].maxwell
    run = tn.simulate(subject, 0.6, speed=speed, tolerance=1e-10)
    names = list(run.shafts)
    assert "oil of damper" in names and "damper" in names
    w, at = 3 * speed, run.time > 0.5
    both = run.twist[at, names.index("oil of damper")] + run.twist[at, names.index("damper")]
    wave = np.stack([np.cos(w * run.time[at]), np.sin(w * run.time[at]), np.ones(at.sum()), run.time[at]], axis=1)
    parts = np.linalg.lstsq(wave, both, rcond=None)[0]
    y = 80.0 * dense(w, own(w))
    assert np.hypot(*parts[:2]) == pytest.approx(abs(y[1] - y[0]), rel=0.01)
    k, c = maxwell.stiffness, maxwell.damping
    assert 1 / (1 / k + 1 / (1j * w * c)) == pytest.approx(complex(own(w)), rel=1e-12)

    def rates(t: float, z: np.ndarray) -> list[float]:
        hub, between, ring, far, v_hub, v_between, v_ring, v_far = z
        spring, drag = k * (hub - between), c * (v_between - v_ring)
        shaft = SHAFT * (far - hub) + 4.0 * (v_far - v_hub)
        push = 80.0 * np.cos(3 * speed * t + 0.4 + 3 * hub)
        return [
            v_hub, v_between, v_ring, v_far, (push + shaft - spring) / HUB, (spring - drag) / maxwell.oil_inertia,
            drag / RING, -shaft / FAR,
        ]  # fmt: skip

    alone = solve_ivp(rates, (0, 0.05), np.zeros(8), method="LSODA", rtol=1e-10, atol=1e-13)
    short = tn.simulate(subject, 0.05, speed=speed, tolerance=1e-10, times=[0.05])
    assert short.twist[-1, names.index("damper")] == pytest.approx(alone.y[2, -1] - alone.y[1, -1], rel=1e-5)
    assert short.twist[-1, names.index("shaft")] == pytest.approx(alone.y[3, -1] - alone.y[0, -1], rel=1e-5)


def test_a_start_from_rest_drags_the_ring_along() -> None:
    """Nothing holds the ring for good: after a blow both come to one speed, by their momentum."""
    hub, damper, shaft, far = line(oil()).elements
    free = tn.Driveline([hub.but(excitation=(), drive_share=None), damper, shaft, far])
    blow = tn.AppliedTorque(on="Disk 1", time=[0.0, 0.01], torque=[300.0, 0.0], between="steps", hold=True)
    run = tn.transient(free, 1.0, torque=[blow], speed=20.0)
    assert run.energy.error < 1e-6
    gained = 300.0 * 0.01 / (HUB + RING + FAR)
    assert run.speed[-1] == pytest.approx(np.full(run.speed.shape[1], 20.0 + gained), rel=2e-3)


def test_what_its_points_do_not_reach() -> None:
    with pytest.raises(InputError, match="damper.oil: is known from 20 Hz to 900 Hz, and 9.549 Hz is asked of"):
        tn.order_response(line(oil()), [20.0])
    with pytest.warns(InputRemark, match="in series, up to [0-9.]+ % off within"):
        line(oil()).replace("damper", ring_inertia=0.2)
