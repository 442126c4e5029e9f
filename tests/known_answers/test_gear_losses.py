"""What gears lose: power in is power out and losses, through trains and planetary sets, whichever way power flows."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import trunnion as tn
from trunnion.driveline.gear_losses import friction_losses
from trunnion.equations.coefficients import assemble
from trunnion.equations.gear_losses import lost_power
from trunnion.equations.loads import gear_losses
from trunnion.errors import InputRemark

SPEED = 150.0
SHAFTS = ("sun", "carrier", "ring")


def carried(line: tn.Driveline, speed: float = SPEED) -> np.ndarray:
    """Mean torque of every spring [N m]."""
    assembly = assemble(line).at(speed)
    return assembly.static_torque(assembly.table(1, speed))[0]


def lost(line: tn.Driveline, speed: float = SPEED) -> float:
    """Power lost in all gears [W]."""
    assembly = assemble(line).at(speed)
    found = gear_losses(assembly.topology, assembly.packed.column, assembly.table(1, speed))
    return sum(float(one[0]) for one in lost_power(assembly.topology, found, np.array([speed])).values())


def train(load: float, **front: float) -> list[object]:
    """Two stages, 3 and 2, of 97 and 90 %, with 2 N m of drag in front of the first."""
    return [
        tn.Shaft(stiffness=1e4, name="in"),
        tn.Disk(inertia=0.1, **front),
        tn.Ratio(ratio=3, efficiency=0.97, drag_torque=2.0),
        tn.Shaft(stiffness=1e4, name="between"),
        tn.Disk(inertia=0.1),
        tn.GearPair(teeth_in=20, teeth_out=40, module="3 mm", mesh_stiffness=1e8, efficiency=0.9, name="mesh"),
        tn.Disk(inertia=0.2),
        tn.Shaft(stiffness=1e4, name="out"),
        tn.Disk(inertia=0.2, load_torque=load),
    ]


@pytest.mark.parametrize("load", [600.0, -600.0])
def test_two_stages_by_hand(load: float) -> None:
    """600 N m behind 6 : 1, forward and back, from the ends to a prescribed input."""
    line = tn.Driveline([tn.ConstantSpeed(), *train(load)])
    flows = (lambda torque, eta: torque / eta) if load > 0 else (lambda torque, eta: torque * eta)
    between = flows(load / 2, 0.9)
    first = flows(between / 3, 0.97) + 2.0
    found = dict(zip(("in", "between", "mesh", "out"), carried(line), strict=True))
    assert found["in"] == pytest.approx(-first, rel=1e-13)
    assert found["between"] == pytest.approx(-between, rel=1e-13)
    assert abs(found["mesh"]) in (pytest.approx(abs(load)), pytest.approx(abs(load) / 2))
    assert found["out"] == pytest.approx(-load, rel=1e-13)
    assert lost(line) == pytest.approx((first - load / 6) * SPEED, rel=1e-12)
    assert lost(line) > 0


@pytest.mark.parametrize("behind", [False, True])
def test_drives_of_a_free_line_carry_the_losses(behind: bool) -> None:
    """In front of the gears, or behind them, where what it gives follows from the losses and these from it."""
    parts = [tn.Disk(inertia=0.3, load_torque=0.0 if not behind else 40.0, drive_share=0.0 if behind else 1.0)]
    parts += train(-1.0 if behind else 600.0)
    if behind:
        parts[-1] = parts[-1].but(load_torque=0.0, drive_share=1.0)
    line = tn.Driveline(parts)
    found = carried(line)
    power = [found[0] * SPEED, found[-1] * SPEED / 6]
    assert power[0] - power[1] == pytest.approx(-lost(line) if not behind else -lost(line), rel=1e-12)
    if behind:
        assert found[0] == pytest.approx(40.0, rel=1e-13)
        assert found[-1] == pytest.approx(6 * 42.0 / 0.97 / 0.9, rel=1e-12)


def by_mueller(
    sun: float, ring: float, load: float, output: str, speeds: dict[str, float], eta: float
) -> dict[str, float]:
    """Torques on the three shafts, by equilibrium and T_r/T_s = (z_r/z_s) η₀^w, w = 1 where the sun's rolling power
    T_s (ω_s − ω_c) enters; the torque on the output is −``load``."""
    consistent = []
    for w in (1, -1):
        over = ring / sun * eta**w
        shares = {"sun": 1.0, "ring": over, "carrier": -1 - over}
        scale = -load / shares[output]
        torque = {name: scale * share for name, share in shares.items()}
        if w * torque["sun"] * (speeds["sun"] - speeds["carrier"]) > 0:
            consistent.append(torque)
    assert len(consistent) == 1
    return consistent[0]


@pytest.mark.parametrize(("given", "held"), list(itertools.permutations(SHAFTS, 2)))
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("heavy", [False, True])
def test_six_arrangements_both_ways(given: str, held: str, sign: float, heavy: bool) -> None:
    """30 and 72 teeth, 98 and 99 %: shaft torques as Müller's rule has them, and the balance of power."""
    more = {"planet_inertia": 1e-4} if heavy else {}
    gears = tn.Planetary(
        teeth_sun=30, teeth_ring=72, input=given, held=held, sun_mesh_efficiency=0.98, ring_mesh_efficiency=0.99, **more
    )
    front, back = (tn.Shaft(stiffness=1e4, name=name) for name in ("front", "back"))
    line = tn.Driveline(
        [tn.ConstantSpeed(), front, tn.Disk(inertia=0.1), gears, back, tn.Disk(inertia=0.1, load_torque=sign * 50.0)]
    )
    speeds = {name: float(speed) for name, speed in gears.speeds.items()}
    sense = np.sign(speeds[gears.driven])
    # A load resists the mean rotation; on the output acts −(−load).
    torque = by_mueller(30, 72, sign * 50.0 * sense, gears.driven, speeds, 0.98 * 0.99)
    found = carried(line)
    assert -found[0] == pytest.approx(torque[given], rel=1e-12)
    assert -found[1] == pytest.approx(-torque[gears.driven], rel=1e-12)
    into = (torque[given] + torque[gears.driven] * speeds[gears.driven]) * SPEED
    assert lost(line) == pytest.approx(into, rel=1e-11)
    assert into > 0


def test_power_of_two_drives_in_a_planetary_set() -> None:
    """None held: motors at sun and ring carry the carrier's load, by Müller's rule with the losses of both meshes."""
    gears = tn.Planetary(
        teeth_sun=30, teeth_ring=72, input="sun", output="carrier", free_speed=0.25, name="set",
        sun_mesh_efficiency=0.97, ring_mesh_efficiency=0.98,
    )  # fmt: skip
    line = tn.Driveline([
        tn.Disk(inertia=0.2, drive_share=1.0), tn.Shaft(stiffness=1e4, name="sun shaft"), tn.Disk(inertia=0.05), gears,
        tn.Disk(inertia=0.1), tn.Shaft(stiffness=1e4, name="carrier shaft"), tn.Disk(inertia=0.5, load_torque=300.0),
        tn.Disk(inertia=0.1, after="set.ring"), tn.Shaft(stiffness=1e4, name="ring shaft"),
        tn.Disk(inertia=0.2, drive_share=1.0),
    ])  # fmt: skip
    assembly = assemble(line)
    springs = [line.names[c.shafts[0]] for c in assembly.topology.compliances]
    found = dict(zip(springs, carried(line), strict=True))
    speeds = {name: float(speed) for name, speed in gears.speeds.items()}
    torque = by_mueller(30, 72, 300.0, "carrier", speeds, 0.97 * 0.98)
    assert found["carrier shaft"] == pytest.approx(-300.0, rel=1e-12)
    assert found["sun shaft"] == pytest.approx(-torque["sun"], rel=1e-10)
    assert found["ring shaft"] == pytest.approx(torque["ring"], rel=1e-10)
    powers = [torque[name] * speeds[name] * SPEED for name in SHAFTS]
    assert lost(line) == pytest.approx(sum(powers), rel=1e-9)


def test_a_shaft_that_stands_still_on_average_asks_for_nothing_amiss() -> None:
    """The ring, free on average at rest, on a shaft of its own: the sun's power is the carrier's over η of its path."""
    gears = tn.Planetary(
        teeth_sun=30, teeth_ring=72, input="sun", output="carrier", free_speed=0.0, name="set",
        sun_mesh_efficiency=0.97, ring_mesh_efficiency=0.98,
    )  # fmt: skip
    line = tn.Driveline([
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, name="sun shaft"), tn.Disk(inertia=0.05), gears,
        tn.Disk(inertia=0.1, load_torque=300.0),
        tn.Disk(inertia=0.1, after="set.ring"), tn.Shaft(stiffness=1e4, name="ring shaft"), tn.Disk(inertia=0.2),
    ])  # fmt: skip
    assembly = assemble(line)
    found = gear_losses(assembly.topology, assembly.packed.column, assembly.table(1, SPEED))
    assert np.isfinite(found.resists).all()
    assert (found.friction > 0).all()


@pytest.mark.parametrize(("one", "other", "angle"), [(20, 40, 20.0), (25, 25, 20.0), (34, 71, 25.0)])
def test_friction_along_the_path_of_contact(one: int, other: int, angle: float) -> None:
    """Ohlendorf's formula against the integral of μ F |v_s| over a base pitch, teeth in contact sharing the load."""
    alpha = np.radians(angle)
    radii = np.array([one, other]) / 2
    base, outside = radii * np.cos(alpha), radii + 1  # in modules
    ends = np.sqrt(outside**2 - base**2) - radii * np.sin(alpha)  # from the pitch point
    pitch = np.pi * np.cos(alpha)
    x = -ends[1] + pitch * (np.arange(20000) + 0.5) / 20000
    teeth = [x + shift * pitch for shift in range(4)]
    inside = [at <= ends[0] for at in teeth]
    slides = np.sum([np.where(on, np.abs(at), 0.0) for on, at in zip(inside, teeth, strict=True)], axis=0)
    # v_s = (ω₁ + ω₂)|x| at each tooth, which bears the load over their number; the power is F ω₁ r_b1.
    lost = np.mean(slides / np.sum(inside, axis=0)) * (1 + one / other) / base[0]
    assert friction_losses(one, other, alpha) == pytest.approx(lost, rel=1e-4)


def test_a_friction_coefficient_is_an_efficiency() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), *train(600.0)])
    loss = 0.06 * friction_losses(20, 40, np.radians(20))
    stated = line.replace("mesh", efficiency=None, friction_coefficient=0.06)
    assert carried(stated) == pytest.approx(carried(line.replace("mesh", efficiency=1 - loss)), rel=1e-12)


def test_a_line_left_free_runs_where_torques_and_losses_balance() -> None:
    """A motor of Kloss's formula, a fan that at low speeds is helped along: 90 % and 5 N m of drag."""
    motor = tn.Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    fan = tn.Disk(inertia=3.0, quadratic_load=0.05, load_torque=-20.0)
    line = tn.Driveline(
        [motor, tn.Shaft(stiffness=2e4), tn.Disk(inertia=0.1), tn.Ratio(ratio=2, efficiency=0.9, drag_torque=5.0), fan]
    )
    (found,) = tn.mean_speeds(line)
    torque = 0.05 * (found.speed / 2) ** 2 - 20.0
    assert torque > 0
    drives = -float(motor.load.value(found.speed))
    assert drives == pytest.approx(5.0 + torque / 2 / 0.9, rel=1e-9)
    assert carried(line, found.speed)[0] == pytest.approx(-drives, rel=1e-9)
    overrun = line.replace("Disk 2", load_torque=-900.0)
    for one in tn.mean_speeds(overrun):
        pushed = 900.0 - 0.05 * (one.speed / 2) ** 2
        share = 0.9 if pushed > 0 else 1 / 0.9
        assert float(motor.load.value(one.speed)) == pytest.approx(share * pushed / 2 - 5.0, rel=1e-8)


def test_gears_behind_a_torque_converter() -> None:
    """Its turbine carries the load and what the final drive loses of it."""
    points = ((0, 2, 6e-3), (0.6, 1.3, 5.5e-3), (0.85, 1, 4e-3), (1, 1, 0))
    curves = [{"speed_ratio": v, "torque_ratio": m, "capacity": k} for v, m, k in points]
    parts = [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.TorqueConverter(curves=curves, inertia_in=0.1, inertia_out=0.1),
        tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1), tn.Differential(ratio=4.0, efficiency=0.95, drag_torque=1.0),
        tn.Disk(inertia=1.0, load_torque=60.0), tn.Disk(inertia=1.0, load_torque=60.0, after="Differential 1.right"),
    ]  # fmt: skip
    line = tn.Driveline(parts)
    assembly = assemble(line).at(100.0)
    run = next(one.run for one in assembly.line.elements if isinstance(one, tn.TorqueConverter))
    assert run.turbine_torque == pytest.approx(120.0 / 4 / 0.95 + 1.0, rel=1e-9)
    assert abs(carried(line, 100.0)[0]) == pytest.approx(run.pump_torque, rel=1e-9)


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
def test_a_turn_and_a_motion_in_time_have_them() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), *(one.but(damping=40.0) if isinstance(one, tn.Shaft) else one
                                              for one in train(600.0))])  # fmt: skip
    turn = tn.kinetostatics(line)
    assert turn.drive_torque == pytest.approx(600.0 / 6 / 0.97 / 0.9 + 2.0, rel=1e-12)
    damped = line.replace("mesh", mesh_damping=2e4)
    with pytest.warns(InputRemark, match="mesh: equations of motion have its losses by the mean torque"):
        run = tn.simulate(damped, 4.0, speed=SPEED)
    assert any("mesh loses by its mean torque" in str(one) for one in tn.order_response(line, [SPEED]).findings)
    assert float(run.torque[-1, 0]) == pytest.approx(carried(line)[0], rel=1e-6)


def test_heat_and_its_rating() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), *train(600.0)]).replace("mesh", heat_rating="1 kW")
    line = line.but(limits=[tn.Limit(of="*", max_torque=1e5)], operation=tn.Operation(speed=SPEED))
    check = next(one for one in tn.assess(line).checks if one.name == "heat of mesh")
    assert check.value == pytest.approx(600.0 * SPEED / 6 * (1 / 0.9 - 1), rel=1e-12)
    assert check.status.value == "exceeded"


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
def test_what_is_not_followed() -> None:
    """Torques that change, loops, and a free shaft where the speed is to follow from the torques."""
    line = tn.Driveline([tn.ConstantSpeed(), *train(600.0)])
    with pytest.raises(tn.InputError, match="holds by the torque of steady running"):
        tn.transient(line, 0.1, speed=SPEED)
    with pytest.raises(tn.InputError, match="holds by the torque of steady running"):
        tn.run_up(line, 50.0, 100.0, acceleration=10.0)
    looped = tn.Driveline([*line.elements, tn.Shaft(stiffness=1e3, after="Disk 1", to="Disk 2")])
    with pytest.raises(tn.InputError, match="closes a loop"):
        carried(looped)
    gears = tn.Planetary(teeth_sun=30, teeth_ring=72, input="sun", output="carrier", sun_mesh_efficiency=0.98)
    motor = tn.Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    brake = tn.Disk(inertia=1.0, viscous_load=0.1, after="Planetary 1.ring")
    free = tn.Driveline([motor, gears, tn.Disk(inertia=1.0, load_torque=10.0), brake])
    with pytest.raises(tn.InputError, match="hold a shaft"):
        tn.mean_speeds(free)
