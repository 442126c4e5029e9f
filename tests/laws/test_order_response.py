"""Linear steady response by order against closed forms, dense solutions and the nonlinear periodic motion."""

from __future__ import annotations

import tracemalloc
import warnings
from typing import Any

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.response.orders.response import response_of_table


def two_masses(**shaft: Any) -> tn.Driveline:
    engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0, "phase": 0.7}])
    return tn.Driveline([engine, tn.Shaft(stiffness=1e4, **shaft), tn.Disk(inertia=0.8)])


def test_two_masses_in_closed_form() -> None:
    """Relative motion: (−ν² J + iνc + k) q = −(J/J₁) T with J = J₁J₂/(J₁ + J₂); torque (k + iνc) q."""
    speed = np.array([20.0, 90.0, 125.0, 400.0])
    r = tn.order_response(two_masses(damping=3.0), speed)
    v, z, reduced = 2 * speed, 1e4 + 3j * 2 * speed, 0.2 * 0.8 / 1.0
    q = -(reduced / 0.2) * 100 * np.exp(0.7j) / (z - v**2 * reduced)
    assert list(r.order) == [2.0]
    assert r.torque[:, 0, 0] == pytest.approx(z * q, rel=1e-12)
    assert r.twist[:, 0, 0] == pytest.approx(q, rel=1e-12)
    assert r.vibratory_torque[:, 0] == pytest.approx(np.abs(z * q), rel=1e-12)
    whole = -100 * np.exp(0.7j) / (v**2 * 1.0)  # both turn as one under the torque, and about their centre
    assert r.rotation[:, 0, 0] * 0.2 + r.rotation[:, 0, 1] * 0.8 == pytest.approx(whole, rel=1e-10)
    assert r.heat[:, 0] == pytest.approx(3.0 * v**2 * np.abs(q) ** 2 / 2, rel=1e-12)
    assert r.acceleration[:, 0] == pytest.approx(v**2 * np.abs(r.rotation[:, 0, 0]), rel=1e-12)
    assert r.speed_fluctuation[:, 1] == pytest.approx(v * np.abs(r.rotation[:, 0, 1]), rel=1e-12)


def test_loss_factor_at_all_frequencies_in_closed_form() -> None:
    speed = np.array([20.0, 125.0, 400.0])
    r = tn.order_response(two_masses(loss_factor=0.08), speed)
    v, z, reduced = 2 * speed, 1e4 * (1 + 0.08j), 0.16
    q = -0.8 * 100 * np.exp(0.7j) / (z - v**2 * reduced)
    assert r.torque[:, 0, 0] == pytest.approx(z * q, rel=1e-12)
    # Loss per cycle over 2π times the largest elastic energy is the loss factor.
    assert r.heat[:, 0] / (v / (2 * np.pi)) / (1e4 * np.abs(q) ** 2 / 2) / (2 * np.pi) == pytest.approx(0.08)


def test_undamped_resonance_is_refused_at_its_speed() -> None:
    at = np.sqrt(1e4 / 0.16) / 2
    r = tn.order_response(two_masses(), [50.0, at, 200.0])
    assert np.isnan(r.peak_torque[1, 0]) and np.all(np.isfinite(r.peak_torque[[0, 2], 0]))
    assert any("No steady state exists" in f.sentence and "125 rad/s" in f.sentence for f in r.findings)


def test_unstable_speeds_are_named_and_agree_with_stability() -> None:
    line = tn.catalogue("two-shaft-cardan").replace("HookeJoint 1", angle=0.4)
    speed = np.linspace(1.4, 1.8, 9)
    r = tn.order_response(line, speed)
    assert [bool(u) for u in r.unstable] == [tn.stability(line, s).verdict == 1 for s in speed]
    assert r.unstable.any() and not r.unstable.all()
    (said,) = [f for f in r.findings if "unstable" in f.sentence]
    low, high = speed[r.unstable][[0, -1]]
    assert str(said.gravity) == "danger" and f"{low:.6g}" in said.sentence and f"{high:.6g} rad/s" in said.sentence
    calm = tn.order_response(line, [1.4, 1.8])
    assert not calm.unstable.any() and not any("unstable" in f.sentence for f in calm.findings)


def test_a_drive_that_grows_with_the_speed_makes_a_straight_line_unstable() -> None:
    """J q'' + (c + v) q' + k q = 0 grows where the slope v of the drive is below −c."""

    def line(slope: float) -> tn.Driveline:
        disk = tn.Disk(inertia=0.5, viscous_load=slope, excitation=[{"order": 1, "amplitude": 1.0}])
        return tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e3, damping=2.0), disk])

    assert tn.order_response(line(-2.1), [10.0, 20.0]).unstable.all()
    assert not tn.order_response(line(-1.9), [10.0, 20.0]).unstable.any()


def test_a_sweep_over_speed_says_where_it_is_not_reached() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=0.1), tn.Disk(inertia=0.5), tn.HookeJoint(angle=0.5),
            tn.Shaft(stiffness=1.2e4, damping=0.1), tn.Disk(inertia=0.4),
        ]
    )  # fmt: skip
    unstable, stable = tn.speed_sweep(line, [176.051]), tn.speed_sweep(line, [190.0])
    assert tn.stability(line, 176.051).growth_rate > 0 > tn.stability(line, 190.0).growth_rate
    assert "danger: The steady motion is unstable at 176.051 rad/s" in str(unstable)
    assert "unstable" not in str(stable) and "not judged" not in str(stable)


@pytest.mark.parametrize("damping", [-0.3, 0.3])
def test_negative_damping_makes_a_straight_line_unstable(damping: float) -> None:
    """Two masses in relative motion grow by −c(1/J₁ + 1/J₂)/2, at every speed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", tn.InputRemark)
        line = two_masses(damping=damping)
    found, judged = tn.order_response(line, [60.0, 70.0]), tn.assess(line, (60.0, 70.0)).check("parametric stability")
    assert tn.stability(line, 60.0).growth_rate == pytest.approx(-damping * (1 / 0.2 + 1 / 0.8) / 2, rel=1e-9)
    if damping < 0:
        assert list(found.unstable) == [True, True]
        assert any("The steady motion is unstable at 60 to 70 rad/s" in str(f) for f in found.findings)
        assert judged.value == pytest.approx(-damping * (1 / 0.2 + 1 / 0.8) / 2, rel=1e-9)
        assert "exceeded" in str(judged.status) and "unstable between 60 rad/s and 70 rad/s" in judged.because
    else:
        assert not found.unstable.any() and "not applicable" in str(judged.status)


def test_a_line_too_stiff_to_be_judged_is_not_said_to_have_a_loss_factor() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e12, damping=1.0), tn.Disk(inertia=1e-9), tn.HookeJoint(angle=0.3),
            tn.Shaft(stiffness=1.0, damping=1e-3), tn.Disk(inertia=1e6),
        ]
    )  # fmt: skip
    found = tn.order_response(line, [50.0])
    said = " ".join(map(str, found.findings))
    assert "was not judged: the multipliers could not be computed" in said and "loss factor" not in said


def test_stability_behind_a_loss_factor_is_said_not_to_be_judged() -> None:
    line = tn.catalogue("two-shaft-cardan").replace("HookeJoint 1", angle=0.4)
    line = line.replace("Shaft 1", damping=0.0, loss_factor=0.02)
    r = tn.order_response(line, [1.0])
    assert any("not judged" in f.sentence for f in r.findings) and not r.unstable.any()


def branched(rng: np.random.Generator) -> tn.Driveline:
    def shaken() -> list[dict[str, float]]:
        return [
            {"order": float(order), "amplitude": float(rng.uniform(5, 50)), "phase": float(rng.uniform(-3, 3))}
            for order in rng.choice([0.5, 1, 1.5, 2, 3], 2, replace=False)
        ]

    def shaft(after: str | None = None) -> tn.Shaft:
        return tn.Shaft(stiffness=float(rng.uniform(5e3, 5e4)), damping=float(rng.uniform(1, 9)), after=after)

    return tn.Driveline(
        [
            tn.Disk(inertia=0.3, excitation=shaken(), name="engine"), shaft(), tn.Disk(inertia=0.1, name="gear"),
            tn.Ratio(ratio=-2.5), tn.Disk(inertia=0.2, excitation=shaken()), shaft(), tn.Disk(inertia=0.4),
            shaft(after="gear"), tn.Disk(inertia=0.5, excitation=shaken()), shaft(), tn.Disk(inertia=0.1),
        ]
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
def test_straight_branched_line_against_dense_matrices(seed: int) -> None:
    """Rotations R_i of the groups' first disks; the matrices are written here once more, from energies."""
    line = branched(np.random.default_rng(seed))
    speed = np.array([15.0, 60.0, 170.0])
    r = tn.order_response(line, speed)
    e = [x for x in line.elements if not isinstance(x, tn.Ratio)]
    disks, shafts = [x for x in e if isinstance(x, tn.Disk)], [x for x in e if isinstance(x, tn.Shaft)]
    rho = -1 / 2.5
    mass = np.diag([0.3, 0.1 + 0.2 * rho**2, 0.4, 0.5, 0.1])
    # Twists of the shafts over the unknowns: engine, gear (first disk of its group), output, branch, branch end.
    twist = np.array(
        [[-1, 1, 0, 0, 0], [0, -rho, 1, 0, 0], [0, -1, 0, 1, 0], [0, 0, 0, -1, 1]], dtype=float
    )  # fmt: skip
    assert r.inertias[1] == "gear"
    where = {0: (0, 1.0, 1.0), 2: (1, rho, -1.0), 4: (3, 1.0, 1.0)}
    total = np.zeros((len(speed), len(r.order), 4), dtype=complex)
    for place, (unknown, arm, sense) in where.items():
        for h in disks[place].excitation:
            assert h.order is not None
            own = h.order * abs(arm)
            k = int(np.flatnonzero(np.abs(r.order - own) < 1e-12)[0])
            for s, w in enumerate(speed):
                v = own * w
                z = np.array([x.torsional_stiffness + 1j * v * x.damping for x in shafts])
                a = twist.T @ (z[:, None] * twist) - v**2 * mass
                b = np.zeros(5, dtype=complex)
                b[unknown] = arm * sense * h.amplitude * np.exp(1j * h.phase)
                total[s, k] += z * (twist @ np.linalg.solve(a, b))
    assert r.torque == pytest.approx(total, rel=1e-10, abs=1e-12 * np.abs(total).max())


def test_sum_over_the_cycle_is_that_of_the_wave() -> None:
    r = tn.order_response(branched(np.random.default_rng(5)), [40.0, 90.0])
    for at, speed in enumerate(r.speed):
        wave = r.wave(float(speed))
        half = np.ptp(wave.torque, axis=0) / 2
        assert np.all(half <= r.vibratory_torque[at] * (1 + 1e-12))
        assert half == pytest.approx(r.vibratory_torque[at], rel=3e-3)
        assert wave.torque[0] == pytest.approx(wave.torque[-1], rel=1e-9)


def test_excitation_on_a_held_disk_is_said() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Disk(inertia=1.0, excitation=[{"order": 2, "amplitude": 50.0}], name="engine"),
            tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=1.0),
        ]
    )  # fmt: skip
    r = tn.order_response(line, [30.0])
    assert r.peak_torque[0, 0] == 0
    said = [f.sentence for f in r.findings]
    assert any("engine.excitation: does nothing, a ConstantSpeed holds its rotation" in s for s in said)
    assert any("Nothing excites this line" in s for s in said)


def test_frequencies_in_time_and_orders_add_to_a_bound() -> None:
    both = [{"order": 2, "amplitude": 30.0}, {"frequency": 77.7, "amplitude": 20.0, "phase": 0.3}]
    line = tn.Driveline(
        [tn.Disk(inertia=0.2, excitation=both), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]
    )
    r = tn.order_response(line, [50.0, 100.0])
    assert r.sum_is_bound and any("more than 60 turns" in f.sentence for f in r.findings)
    assert list(r.order) == [2.0, 0.0] and list(r.frequency) == [0.0, 77.7]
    z = 1e4 + 2j * 77.7
    q = -0.8 * 20 * np.exp(0.3j) / (z - 77.7**2 * 0.16)
    assert r.torque[:, 1, 0] == pytest.approx([z * q, z * q], rel=1e-12)
    assert r.vibratory_torque[:, 0] == pytest.approx(np.abs(r.torque[:, :, 0]).sum(axis=1), rel=1e-12)


def test_transmission_error_in_closed_form() -> None:
    """Two gears between two clamps' shafts would do; here the mesh is the only spring: q = −e ν² J / (…)."""
    mesh = tn.GearPair(
        teeth_in=20, teeth_out=30, module=0.003, mesh_stiffness=1e8, mesh_damping=400.0,
        transmission_error=[{"amplitude": 1e-5, "order": 1, "phase": 0.4}],
    )  # fmt: skip
    line = tn.Driveline([tn.Disk(inertia=0.01), mesh, tn.Disk(inertia=0.02)])
    speed = np.array([30.0, 90.0])
    r = tn.order_response(line, speed)
    r1, r2 = mesh.radii
    v = 20 * speed
    z, reduced = 1e8 + 400j * v, 1 / (r1**2 / 0.01 + r2**2 / 0.02)
    e = 1e-5 * np.exp(0.4j)
    # u = r₁φ₁ − r₂φ₂ − e carries z u; m(u″ + e″) = −z u with m the reduced mass along the line of action.
    u = v**2 * reduced * e / (z - v**2 * reduced)
    assert list(r.order) == [20.0]
    assert r.torque[:, 0, 0] == pytest.approx(-r2 * z * u, rel=1e-10)


def bent_line(**changes: float) -> tn.Driveline:
    engine = tn.Disk(inertia=0.2, name="hub", excitation=[{"order": 1.5, "amplitude": 20.0, "phase": 0.3}])
    return tn.Driveline([
        tn.ConstantSpeed(), tn.Shaft(stiffness=8e3, damping=2.0, name="front"), engine,
        tn.HookeJoint(angle=changes.pop("angle", 0.3), name="joint"),
        tn.Shaft(stiffness=changes.pop("stiffness", 5e3), damping=1.0, name="rear"),
        tn.Disk(inertia=0.3, load_torque=changes.pop("load_torque", 30.0), name="load"),
    ])  # fmt: skip


def test_cases_of_a_table_are_those_lines_by_themselves() -> None:
    """Angle (from straight on), stiffness and load differ from case to case, each at its own speed."""
    cases = [(0.0, 5e3, 30.0, 80.0), (0.2, 4e3, 0.0, 95.0), (0.7, 9e3, 60.0, 140.0), (0.2, 4e3, 10.0, 60.0)]
    assembly = assemble(bent_line())
    table = assembly.table(len(cases))
    for k, path in enumerate(("joint.angle", "rear.stiffness", "load.load_torque", "speed")):
        assembly.packed.resolve(path).put(table, [case[k] for case in cases])
    together = response_of_table(assembly, table)
    assert np.isnan(together.vibratory_stress).all()
    for i, (angle, stiffness, load, speed) in enumerate(cases):
        alone = tn.order_response(bent_line(angle=angle, stiffness=stiffness, load_torque=load), [speed])
        for name in ("peak_torque", "vibratory_torque", "vibratory_twist", "heat", "speed_fluctuation", "acceleration"):
            assert getattr(together, name)[i] == pytest.approx(getattr(alone, name)[0], rel=1e-9, abs=1e-12), name


def test_a_table_refuses_what_cannot_be_solved_together() -> None:
    in_time = tn.Disk(inertia=0.2, excitation=[{"frequency": 50.0, "amplitude": 20.0}], name="hub")
    assembly = assemble(tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1.0), in_time]))
    table = assembly.table(2)
    assembly.packed.resolve("hub.excitation 1 frequency").put(table, [50.0, 60.0])
    table[:, 0] = 100.0
    with pytest.raises(tn.InputError, match="is a frequency of excitation"):
        response_of_table(assembly, table)
    share = {"drive_share": 1.0}
    free = assemble(tn.Driveline([
        tn.Disk(inertia=0.2, **share), tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=0.1),
        tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=0.2),
    ]))  # fmt: skip
    table = free.table(2)
    table[:, 0] = 100.0
    with pytest.raises(tn.InputError, match="is free–free and has joint angles"):
        response_of_table(free, table)


def test_the_drawing_shows_the_limits_of_the_description() -> None:
    parts = [
        tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}]),
        tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"),
        tn.Disk(inertia=0.8),
    ]
    limits = [tn.Limit(of="shaft", vibratory_torque=300.0, transient_vibratory_torque=800.0, max_torque="1 kN*m")]
    found = tn.order_response(tn.Driveline(parts, limits=limits), [80.0, 100.0, 140.0])
    drawn = {line.get_label(): line.get_ydata()[0] for line in found.plot().get_lines()}
    assert drawn["vibratory torque 300 N m"] == 300.0 and drawn["max torque 1000 N m"] == 1000.0
    assert drawn["transient vibratory torque 800 N m"] == 800.0
    bare = tn.order_response(tn.Driveline(parts), [80.0, 100.0, 140.0])
    assert not any("N m" in str(line.get_label()) for line in bare.plot().get_lines())
    asked = bare.plot(limits={"rating": 50.0})
    assert any(line.get_label() == "rating 50 N m" for line in asked.get_lines())


def test_orders_that_would_not_fit_are_refused_before_anything_is_solved():
    """By what they need, not by their number: with straight joints each is solved by itself, and all are taken."""
    orders = [{"order": 5.0 * k + 1.0, "amplitude": 1.0} for k in range(2000)]

    def line(angle: float) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1e4, damping=5.0),
                tn.Disk(inertia=0.1),
                tn.HookeJoint(angle=angle),
                tn.Shaft(stiffness=1e4, damping=5.0),
                tn.Disk(name="load", inertia=0.2, excitation=orders),
            ]
        )

    tracemalloc.start()
    try:
        with pytest.raises(tn.InputError, match="would need .* GB of memory, at most 2 GB") as caught:
            tn.order_response(line(0.2), [90.0, 100.0])
        assert tracemalloc.get_traced_memory()[1] < 2**29
    finally:
        tracemalloc.stop()
    assert (caught.value.element, caught.value.key, caught.value.value) == ("load", "excitation", "2000 orders")
    assert "leave out the orders" in caught.value.remedy and "\n" not in str(caught.value)
    found = tn.order_response(line(0.0), [90.0])
    assert len(found.order) >= 2000


@pytest.mark.parametrize("speed", [2e-4, 2e-3, 0.2])
def test_a_free_line_that_hardly_turns_is_swung_as_a_whole_and_does_not_resonate(speed):
    """The shaft carries the share of the torque that the inertia behind it takes, and both swing by T/((J₁ + J₂)w²)."""
    shaken = tn.Disk(inertia=0.3, drive_share=1, excitation=[tn.Excitation(order=0.5, amplitude=60.0)])
    line = tn.Driveline([shaken, tn.Shaft(stiffness=3e5, damping=0.1), tn.Disk(inertia=1.2)])
    found = tn.order_response(line, [speed])
    assert found.vibratory_torque[0, 0] == pytest.approx(60 * 1.2 / 1.5, rel=1e-2)
    assert np.abs(found.rotation[0, 0]) == pytest.approx(60 / (1.5 * (0.5 * speed) ** 2), rel=1e-2)


def test_a_free_line_is_judged_from_standstill_on():
    shaken = tn.Disk(inertia=0.3, drive_share=1, excitation=[tn.Excitation(order=0.5, amplitude=60.0)])
    line = tn.Driveline(
        [shaken, tn.Shaft(stiffness=3e5, damping=0.1, name="shaft"), tn.Disk(inertia=1.2, load_torque=50.0)],
        limits=[tn.Limit(of="shaft", vibratory_torque=55.0)],
    )  # fmt: skip
    check = tn.assess(line, (0.0, 200.0)).check("vibratory torque of shaft")
    assert check.satisfied and check.value == pytest.approx(60 * 1.2 / 1.5, rel=0.05)
