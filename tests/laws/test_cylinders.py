"""Excitation by cylinders: slider crank by its exact mechanism, firing angles, tables over speed and load, misfire."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trunnion as tn
from trunnion.laws.slider_crank import inertia_harmonics


def piston(angle, r, length):
    """Distance of the pin from the crank's centre, by Pythagoras."""
    return r * np.cos(angle) + np.sqrt(length**2 - (r * np.sin(angle)) ** 2)


@pytest.mark.parametrize("share", [0.05, 0.25, 0.4, 0.7])
def test_inertia_torque_by_fft_of_the_exact_mechanism(share):
    """Power balance: the crank gives what the kinetic energy of the piston takes, −d/dt ½ m ẋ² = T ω.

    ẋ from a difference of complex steps, the torque from a difference of the kinetic energy: no formula is shared.
    """
    m, r, w, count = 1.3, 0.045, 180.0, 256
    angle = 2 * np.pi * np.arange(count) / count
    energy = m * ((piston(angle + 1e-30j, r, r / share).imag / 1e-30) * w) ** 2 / 2
    spectrum = np.fft.fft(energy) / count
    orders = np.fft.fftfreq(count, 1 / count)
    torque = -np.fft.ifft(1j * orders * spectrum * count).real
    sines = 2 * np.fft.rfft(torque)[1:9] / count
    found, inertia = tn.reciprocating_mass(m, r, r / share, orders=8)
    assert np.abs(sines.real).max() < 1e-9 * np.abs(sines).max()
    by_mechanism = -sines.imag
    ours = np.array([one.quadratic_amplitude for one in found]) * w**2
    assert ours == pytest.approx(by_mechanism, rel=1e-9, abs=1e-10 * np.abs(by_mechanism).max())
    assert inertia == pytest.approx(2 * energy.mean() / w**2, rel=1e-12)
    if share <= 0.4:
        every, _ = tn.reciprocating_mass(m, r, r / share, orders=24)
        wave = sum(one.quadratic_amplitude * w**2 * np.cos(one.order * angle + one.phase) for one in every)
        assert wave == pytest.approx(torque, abs=1e-9 * np.abs(torque).max())


def test_the_leading_terms_are_those_of_the_textbooks():
    """T/(m r² ω²) = λ/4 sin θ − ½ sin 2θ − ¾ λ sin 3θ − λ²/4 sin 4θ + …, errors of higher order in λ."""
    for share in (0.05, 0.1, 0.2):
        b, mean = inertia_harmonics(share, 4)
        assert b == pytest.approx([share / 4, -0.5, -0.75 * share, -(share**2) / 4], abs=0.6 * share**3)
        assert mean == pytest.approx(0.5 * (1 + share**2 / 4), abs=share**4)


def engine(**changes):
    parts = [
        tn.Disk(inertia=0.4, name="engine", **changes),
        tn.Shaft(stiffness=2e4, damping=6.0, name="shaft"),
        tn.Disk(inertia=1.1, name="machine"),
    ]
    return tn.Driveline(parts)


GAS = [{"order": k / 2, "amplitude": 300.0 / k, "phase": 0.3 * k} for k in range(1, 9)]
FOUR = [0.0, math.pi, 3 * math.pi, 2 * math.pi]


def test_cylinders_repeat_what_is_listed_once():
    """Four strokes, four cylinders: half orders and odd ones cancel, orders 2 and 4 add up fourfold."""
    found = tn.order_response(engine(excitation=GAS, firing_angles=FOUR), [150.0])
    assert list(found.order) == [2.0, 4.0]
    fourfold = [dict(one, amplitude=4 * one["amplitude"]) for one in GAS if one["order"] in (2.0, 4.0)]
    same = tn.order_response(engine(excitation=fourfold), [150.0])
    assert found.torque == pytest.approx(same.torque, rel=1e-12)


def test_firing_angles_are_phases_of_minus_k_alpha():
    nonuniform = [0.0, 1.1, 5.0]
    written = [
        dict(one, phase=one["phase"] - one["order"] * angle) for angle in nonuniform for one in GAS
    ]  # fmt: skip
    ours = tn.order_response(engine(excitation=GAS, firing_angles=nonuniform), [90.0, 150.0])
    by_hand = tn.order_response(engine(excitation=written), [90.0, 150.0])
    assert ours.torque == pytest.approx(by_hand.torque, rel=1e-11)
    line = engine(excitation=GAS, firing_angles=nonuniform).replace("engine", drive_share=1.0)
    twin = engine(excitation=written).replace("engine", drive_share=1.0)
    one, other = (tn.simulate(each, 0.3, speed=90.0) for each in (line, twin))
    assert one.torque[-1] == pytest.approx(other.torque[-1], rel=1e-5), "the nonlinear equations count them too"


def test_amplitudes_over_speed_by_hand():
    """Half-way between two points of the table A e^{i phase} is the mean of both; it scales the constant response."""
    table = {"order": 2, "speeds": [100.0, 200.0], "amplitudes": [10.0, 30.0], "phases": [0.0, math.pi / 2]}
    unit = tn.order_response(engine(excitation=[{"order": 2, "amplitude": 1.0}]), [100.0, 150.0, 200.0]).torque
    found = tn.order_response(engine(excitation=[table]), [100.0, 150.0, 200.0]).torque
    assert found[:, 0, 0] == pytest.approx(unit[:, 0, 0] * np.array([10.0, 5 + 15j, 30j]), rel=1e-12)
    squares = tn.order_response(engine(excitation=[{"order": 2, "quadratic_amplitude": 2e-3}]), [100.0, 150.0, 200.0])
    assert squares.torque == pytest.approx(unit * (2e-3 * np.array([1e4, 2.25e4, 4e4]))[:, None, None], rel=1e-12)


@pytest.mark.parametrize("keys", [{"speeds": [20.0, 60.0, 100.0], "amplitudes": [10.0, 80.0, 10.0]},
                                  {"quadratic_amplitude": 0.01}])  # fmt: skip
def test_amplitudes_over_speed_behind_bent_joints_are_those_of_each_speed_by_itself(keys):
    """Many speeds of a line with joint angles share its equations, but not what shakes it from a table."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=5e3, damping=5.0),
            tn.Disk(inertia=0.2, excitation=[{"order": 3} | keys]), tn.HookeJoint(angle=0.2),
            tn.Shaft(stiffness=5e3, damping=5.0), tn.Disk(inertia=0.3, load_torque=20.0),
        ]
    )  # fmt: skip
    speeds = np.linspace(30.0, 90.0, 7)
    alone = [tn.order_response(line, [speed]).vibratory_torque[0] for speed in speeds]
    assert tn.order_response(line, speeds).vibratory_torque == pytest.approx(np.array(alone), rel=1e-9)


def test_amplitudes_behind_a_reduction_go_by_the_disks_own_speed():
    def geared(excitation):
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1e5, damping=20.0),
                tn.Disk(inertia=0.1),
                tn.Ratio(ratio=4),
                tn.Shaft(stiffness=2e4, damping=6.0),
                tn.Disk(inertia=0.5, name="fan", excitation=[excitation]),
            ]
        )

    by_square = tn.order_response(geared({"order": 5, "quadratic_amplitude": 0.01}), [120.0]).torque
    constant = tn.order_response(geared({"order": 5, "amplitude": 0.01 * 30.0**2}), [120.0]).torque
    assert by_square == pytest.approx(constant, rel=1e-12)
    table = {"order": 5, "speeds": [20.0, 40.0], "amplitudes": [9.0, 9.0]}
    assert tn.order_response(geared(table), [120.0]).torque == pytest.approx(constant, rel=1e-12)


def test_amplitudes_over_the_mean_torque_of_the_disk():
    """It drives with what its share of the load is: 80 N m at every speed, a quarter of the way from 60 to 140 N m."""
    table = {"order": 2, "torques": [60.0, 140.0], "amplitudes": [20.0, 60.0]}
    loaded = engine(excitation=[table], drive_share=1.0).replace("machine", load_torque=80.0)
    constant = engine(excitation=[{"order": 2, "amplitude": 30.0}], drive_share=1.0)
    constant = constant.replace("machine", load_torque=80.0)
    ours, theirs = (tn.order_response(line, [150.0]) for line in (loaded, constant))
    assert ours.torque == pytest.approx(theirs.torque, rel=1e-12)


def test_the_nonlinear_motion_takes_the_amplitude_of_its_speed():
    line = engine(excitation=[{"order": 2, "quadratic_amplitude": 1e-3}], drive_share=1.0)
    same = engine(excitation=[{"order": 2, "amplitude": 1e-3 * 150.0**2}], drive_share=1.0)
    one, other = (tn.periodic_response(each, 150.0) for each in (line, same))
    assert one.torque_peak_to_peak == pytest.approx(other.torque_peak_to_peak, rel=1e-9)


def test_a_table_is_not_extrapolated():
    table = {"order": 2, "speeds": [100.0, 200.0], "amplitudes": [10.0, 30.0]}
    with pytest.raises(
        tn.InputError, match="engine.excitation 1: is a table from 954.93 rpm to 1909.86 rpm, which does"
    ):
        tn.order_response(engine(excitation=[table]), [150.0, 210.0])
    judged = tn.assess(tn.Driveline(engine(excitation=[table]).elements, limits=[tn.Limit(of="shaft", max_torque=1.0)]),
                       (150.0, 210.0))  # fmt: skip
    said = "200 rad/s to 210 rad/s not judged: the table of engine covers 954.93 rpm to 1909.86 rpm; extend it"
    assert said in judged.check("max torque of shaft").because


def test_a_misfire_brings_half_orders_and_the_worst_is_found():
    line = engine(excitation=GAS, firing_angles=FOUR)
    speeds = np.linspace(200.0, 400.0, 61)
    found = tn.misfire(line, speeds)
    assert found.vibratory_torque.shape == (4, 1)
    by_hand = []
    for number in range(4):
        left = [angle for c, angle in enumerate(FOUR) if c != number]
        by_hand.append(
            np.nanmax(tn.order_response(engine(excitation=GAS, firing_angles=left), speeds).vibratory_torque)
        )
    assert found.vibratory_torque[:, 0] == pytest.approx(by_hand, rel=1e-9)
    assert found.vibratory_torque.min() > found.normal[0]
    assert "the largest of the 61 speeds asked for" in str(found) and "up to" not in str(found)
    assert "asked for" not in str(tn.misfire(line, [300.0]))
    name, number = found.worst
    assert name == "engine" and found.line.elements[0].misfiring == number
    assert 0.5 in found.response.order
    masses, _ = tn.reciprocating_mass(1.0, 0.05, 0.17)
    only = engine(excitation=masses, firing_angles=FOUR)
    silent = tn.misfire(only, [150.0])
    assert silent.vibratory_torque == pytest.approx(np.full((4, 1), silent.normal[0])), "masses go on moving"


BENT = """format = 1
[operation]
speed_range = ["900 rpm", "2000 rpm"]
[[element]]
type = "Engine"
name = "engine"
firing_order = "1-3-2"
bore = "110 mm"
stroke = "130 mm"
rod_length = "220 mm"
reciprocating_mass = "2.2 kg"
throw_inertia = "0.05 kg*m^2"
throw_stiffness = "1.2 MN*m/rad"
loss_factor = 0.01
mean_indicated_pressure = ["2 bar", "20 bar"]
peak_pressure = ["50 bar", "120 bar"]
charge_pressure = ["1 bar", "2 bar"]
compression_ratio = 14
polytropic_exponent = 1.35
drive_share = 1
[[element]]
type = "Shaft"
name = "coupling"
stiffness = "9 kN*m/rad"
damping = "6 N*m*s/rad"
[[element]]
type = "HookeJoint"
angle = "9 deg"
[[element]]
type = "Disk"
name = "middle"
inertia = "0.6 kg*m^2"
[[element]]
type = "Shaft"
name = "tail"
stiffness = "60 kN*m/rad"
damping = "8 N*m*s/rad"
[[element]]
type = "Disk"
name = "screw"
inertia = "1.5 kg*m^2"
quadratic_load = "0.008 N*m*s^2/rad^2"
"""


def test_largest_torques_of_a_bent_engine_line_are_searched_between_two_speeds(tmp_path):
    """Against a grid of its own, closer than the search looks, and closer still about its highest speed."""
    (tmp_path / "line.toml").write_text(BENT)
    line = tn.load(tmp_path / "line.toml")
    found = tn.misfire(line)
    low, high = line.operation.speed_range
    assert 0 <= found.missing < 1e-4
    assert found.response.speed[[0, -1]] == pytest.approx([low, high])
    number = found.worst[1]
    seen = {0: found.normal, number: found.vibratory_torque[found.cylinders.index(found.worst)]}
    for cylinder, largest in seen.items():
        one = line.replace("engine", misfiring=cylinder) if cylinder else line
        speeds = np.linspace(low, high, 367)
        torque = tn.order_response(one, speeds).vibratory_torque
        for spring in range(len(found.springs)):
            top = speeds[torque[:, spring].argmax()]
            near = np.linspace(max(low, top - 0.5), min(high, top + 0.5), 61)
            by_grid = max(torque[:, spring].max(), tn.order_response(one, near).vibratory_torque[:, spring].max())
            assert largest[spring] == pytest.approx(by_grid, rel=1e-4), found.springs[spring]
            assert largest[spring] >= by_grid * (1 - found.missing - 1e-9)
    assert f"the largest over {found.words.ranges([(low, high)])}, searched: short by" in str(found)
    within = tn.misfire(line, speed_range=(low, 1.1 * low))
    assert within.speed.max() <= 1.1 * low and np.all(within.normal <= found.normal * (1 + 1e-4))
    drawn = found.plot()
    assert f"cylinder {number} of engine misfiring" in drawn.get_title(loc="left") + drawn.get_title()


def test_every_cylinder_is_named_with_what_it_does_most():
    line = engine(excitation=GAS, firing_angles=FOUR)
    found = tn.misfire(line, np.linspace(200.0, 400.0, 61))
    rows = found.by_cylinder()
    assert [row["cylinder"] for row in rows] == [f"cylinder {n} of engine" for n in (1, 2, 3, 4)]
    times = [row["times that of all firing"] for row in rows]
    assert times == pytest.approx(found.vibratory_torque[:, 0] / found.normal[0])
    assert times[found.worst[1] - 1] == pytest.approx(max(times), rel=1e-6)
    assert all(row["cylinder"] in str(found) for row in rows) and found.findings == ()


def test_an_undamped_resonance_under_misfire_is_said_and_not_skipped():
    """Order 0.5 meets the mode of a line without damping at the first of two speeds."""
    even, half = [f"{k} deg" for k in (0, 180, 360, 540)], [{"order": k / 2, "amplitude": 9.0} for k in (1, 4)]
    drive = tn.Disk(inertia=1.0, drive_share=1, excitation=half, firing_angles=even, name="engine")
    line = tn.Driveline([drive, tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)])
    found = tn.misfire(line, [np.sqrt(2e4) / 0.5, 200.0])
    assert list(found.unsettled) == [1, 1, 1, 1] and np.isfinite(found.vibratory_torque).all()
    said = [one.sentence for one in found.findings]
    for n in (1, 2, 3, 4):
        assert (
            f"With engine {n} out of work no steady state exists at 1 of the speeds, undamped resonances: left out."
            in said
        )
    nowhere = tn.misfire(line, [np.sqrt(2e4) / 0.5])
    assert np.isnan(nowhere.vibratory_torque).all() and len(nowhere.findings) >= 4


CSV = """order,speed [rpm],amplitude [N*m],phase [deg]
# measured
2,600,180,-90
2,1800,240,-84
4,1800,35,10
4,600,30,0
"""


def test_a_table_beside_the_file(tmp_path):
    (tmp_path / "engine.csv").write_text(CSV, encoding="utf-8")
    text = tn.dumps(engine()).replace('name = "engine"', 'name = "engine"\nexcitation = "engine.csv"')
    (tmp_path / "line.toml").write_text(text, encoding="utf-8")
    line = tn.load(tmp_path / "line.toml")
    two, four = line.elements[0].excitation
    assert (two.order, four.amplitudes) == (2.0, (30.0, 35.0))
    assert two.speeds == pytest.approx([20 * math.pi, 60 * math.pi]) and two.phases[0] == pytest.approx(-math.pi / 2)
    assert tn.loads(tn.dumps(line)) == line, "written in full, it needs no second file"
    assert tn.read_excitation(tmp_path / "engine.csv") == line.elements[0].excitation
    semicolons = CSV.replace(",", ";")
    (tmp_path / "semicolons.csv").write_text(semicolons, encoding="utf-8-sig")
    assert tn.read_excitation(tmp_path / "semicolons.csv") == line.elements[0].excitation
    (tmp_path / "plain.csv").write_text("order,amplitude [kN*m]\n0.5,0.02\n1,0.01\n", encoding="utf-8")
    assert [one.amplitude for one in tn.read_excitation(tmp_path / "plain.csv")] == [20.0, 10.0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("order,amplitude\n2,3\n", 'table.csv.amplitude: has no unit; write "amplitude [N*m]"'),
        ("order,amplitud [N*m]\n2,3\n", "table.csv.column 2: is not a column of such a table; write one of order"),
        ("order,speed [rpm]\n2,3\n", "table.csv.amplitude: is missing among the columns"),
        ("order,amplitude [N*m]\n2,\n", "table.csv: row 2.amplitude: is missing"),
        ("order,amplitude [N*m]\n2,x\n", "table.csv: row 2.amplitude: is not a number"),
        ("order,amplitude [rpm]\n2,3\n", "table.csv.amplitude: has no unit of a torque; write"),
        ("order,amplitude [N*m]\ntwo,3\n", "table.csv: row 2.order: is not a number"),
        ("order,amplitude [N*m]\n2,3\n2,4\n", "table.csv.order 2: stands in several rows"),
        ("order,speed [rpm],amplitude [N*m]\n2,600,4\n", "table.csv.order 2: has one speed only"),
        ("order,speed [rpm],amplitude [N*m]\n2,600,4\n2,600,5\n", "table.csv.order 2: has two rows for one speed"),
        (
            "order,speed [rpm],torque [N*m],amplitude [N*m]\n2,600,10,1\n2,900,10,1\n2,600,20,1\n",
            "table.csv.order 2: has no row at 900 rpm and 20 N m; give every speed a row at every torque",
        ),
        ("order,order,amplitude [N*m]\n2,2,1\n", "table.csv.order: stands twice"),
        ("order,amplitude [N*m]\n", "table.csv: has no rows below its first line"),
        ("order,amplitude [N*m]\n-2,3\n", "must be positive"),
        ("", "table.csv: is empty"),
    ],
)
def test_what_is_wrong_with_a_table_is_said_in_one_line(tmp_path, content, message):
    (tmp_path / "table.csv").write_text(content, encoding="utf-8")
    with pytest.raises(tn.InputError) as caught:
        tn.read_excitation(tmp_path / "table.csv")
    assert message in str(caught.value) and "\n" not in str(caught.value)


BOTH = """order,speed [rpm],torque [N*m],amplitude [N*m],phase [deg]
1.5,300,50,40,-30
1.5,300,400,210,20
1.5,900,50,60,10
1.5,900,400,260,75
1.5,600,50,45,-10
1.5,600,400,300,40
"""
"""Rows in any order."""


def fan_line(tmp_path, load=0.05):
    """An engine of three cylinders whose one gas order goes by speed and load, on a fan."""
    (tmp_path / "gas.csv").write_text(BOTH, encoding="utf-8")
    gas = tn.read_excitation(tmp_path / "gas.csv")
    return tn.Driveline(
        [
            tn.Engine(
                firing_order="1-2-3",
                throw_inertia=0.2,
                throw_stiffness=3e5,
                gas_torque=gas,
                drive_share=1,
                name="engine",
            ),
            tn.Shaft(stiffness=2e4, damping=6.0, name="shaft"),
            tn.Disk(inertia=1.1, quadratic_load=load, name="fan"),
        ]
    )


def test_an_engine_by_speed_and_load_against_a_dense_solve(tmp_path):
    """Its cylinders are read at their actual speed and share of the load: bilinear by hand, solved as one matrix."""
    load = 0.1
    line = fan_line(tmp_path, load)
    speeds = np.linspace(tn.rpm(400), tn.rpm(880), 7)
    found = tn.order_response(line, speeds)
    n, w, torques = np.array([300.0, 600.0, 900.0]) * math.pi / 30, 1.5, (50.0, 400.0)
    table = np.array(
        [[40 * np.exp(-1j * np.pi / 6), 45 * np.exp(-1j * np.pi / 18), 60 * np.exp(1j * np.pi / 18)],
         [210 * np.exp(1j * np.pi / 9), 300 * np.exp(2j * np.pi / 9), 260 * np.exp(1j * 5 * np.pi / 12)]]
    )  # fmt: skip
    mass = np.diag([0.2, 0.2, 0.2, 1.1])
    for i, omega in enumerate(speeds):
        own = load * omega**2 / 3  # of each cylinder
        k = np.searchsorted(n, omega) - 1
        across = (omega - n[k]) / (n[k + 1] - n[k])
        up = (own - torques[0]) / (torques[1] - torques[0])
        assert 0 < up < 1
        low, high = ((1 - across) * row[k] + across * row[k + 1] for row in table)
        gas = (1 - up) * low + up * high
        twisted = -own / 3e5 * np.array([0, 1, 3])  # a throw fires at its own angle, behind the mean twist
        turned = np.exp(1j * w * (twisted - np.radians(240 * np.arange(3))))
        force = np.append(gas * turned, 0)
        stiffness, damping = np.zeros((4, 4)), np.zeros((4, 4))
        for a, (spring, damper) in enumerate([(3e5, 0.0), (3e5, 0.0), (2e4, 6.0)]):
            pair = np.ix_([a, a + 1], [a, a + 1])
            stiffness[pair] += spring * np.array([[1, -1], [-1, 1]])
            damping[pair] += damper * np.array([[1, -1], [-1, 1]])
        damping[3, 3] += 2 * load * omega
        nu = w * omega
        x = np.linalg.solve(stiffness + 1j * nu * damping - nu**2 * mass, force)
        by_hand = (2e4 + 6j * nu) * (x[3] - x[2])
        order = found.order.tolist().index(w)
        ours = found.torque[i, order, found.springs.index("shaft")]
        assert ours == pytest.approx(by_hand, rel=1e-9)


def test_a_table_over_speed_and_load_is_read_inside_it_alone(tmp_path):
    """Each end is named with its range; the search over the range leaves out what the table does not hold."""
    line = fan_line(tmp_path)
    with pytest.raises(
        tn.InputError, match=r"a table from 300 rpm to 900 rpm and 50 N m to 400 N m, .* 950 rpm of its"
    ):
        tn.order_response(line, [tn.rpm(950)])
    with pytest.raises(tn.InputError, match=r"50 N m to 400 N m, which does not cover 27\.416 N m"):
        tn.order_response(line, [tn.rpm(387.3)])
    limited = tn.Driveline(line.elements, limits=[tn.Limit(of="shaft", max_torque=5e3)])
    judged = tn.assess(limited, (tn.rpm(450), tn.rpm(860)))
    check = next(one for one in judged.checks if one.name == "max torque of shaft")
    assert str(check.status) == "not judged" and "covers 300 rpm to 900 rpm and 50 N m to 400 N m" in check.because


def test_a_table_over_speed_and_load_is_written_and_read(tmp_path):
    line = fan_line(tmp_path)
    assert tn.loads(tn.dumps(line)) == line
    law = line.as_stated.elements[0].gas_torque[0]
    assert law.speeds == pytest.approx([10 * math.pi, 20 * math.pi, 30 * math.pi]) and law.torques == (50.0, 400.0)
    assert law.amplitudes == (40.0, 45.0, 60.0, 210.0, 300.0, 260.0)


def test_a_run_follows_a_table_over_speed_and_load_at_its_constant_load(tmp_path):
    """With a constant load a run through the speeds is that of the table over the speed which this load picks."""
    (tmp_path / "gas.csv").write_text(BOTH, encoding="utf-8")
    (both,) = tn.read_excitation(tmp_path / "gas.csv")
    rows = np.array(both.amplitudes) * np.exp(1j * np.array(both.phases))
    middle = (rows[:3] + rows[3:]) / 2
    alone = tn.Excitation(order=1.5, speeds=both.speeds, amplitudes=abs(middle), phases=np.angle(middle))
    runs = []
    for law in (both, alone):
        parts = [
            tn.Disk(inertia=0.4, load_torque=-225.0, excitation=[law], name="engine"),
            tn.Shaft(stiffness=2e4, damping=6.0, name="shaft"),
            tn.Disk(inertia=1.1, load_torque=200.0, name="machine"),
        ]
        runs.append(tn.transient(tn.Driveline(parts), 0.3, speed=tn.rpm(400)))
    assert runs[0].torque[:, 0] == pytest.approx(runs[1].torque[:, 0], rel=1e-9)


def test_a_table_that_is_not_there(tmp_path):
    text = tn.dumps(engine()).replace('name = "engine"', 'name = "engine"\nexcitation = "engin.csv"')
    (tmp_path / "line.toml").write_text(text, encoding="utf-8")
    (tmp_path / "engine.csv").write_text(CSV, encoding="utf-8")
    with pytest.raises(tn.InputError, match='file not found; did you mean "engine.csv"'):
        tn.load(tmp_path / "line.toml")
    with pytest.raises(tn.InputError, match="names a file that is not known here"):
        tn.loads(text)


def test_torques_at_an_undamped_resonance_within_the_range_are_without_bound():
    """Order 0.5, which cancels while all four cylinders fire, meets the mode of a line without damping."""
    even, half = [f"{k} deg" for k in (0, 180, 360, 540)], [{"order": k / 2, "amplitude": 9.0} for k in (1, 4)]
    drive = tn.Disk(inertia=1.0, drive_share=1, excitation=half, firing_angles=even, name="engine")
    line = tn.Driveline([drive, tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)])
    met = np.sqrt(2e4) / 0.5
    found = tn.misfire(line, speed_range=(0.8 * met, 1.3 * met))
    assert np.all(np.isinf(found.vibratory_torque)) and found.speed == pytest.approx(met, rel=1e-9)
    assert found.unsettled_as_stated == 0 and np.isfinite(found.normal).all()
    assert "without bound at" in str(found) and len(found.findings) == 4
    assert all("torques there are without bound" in one.sentence for one in found.findings)
    assert tn.order_response(line, [met]).vibratory_torque[0, 0] > 0  # nothing is excited but order 2
    found.plot()


def test_a_range_of_one_speed_is_that_speed_and_ends_may_be_texts():
    line = engine(excitation=GAS, firing_angles=FOUR)
    one, same = tn.misfire(line, speed_range=(300.0, 300.0)), tn.misfire(line, [300.0])
    assert one.vibratory_torque == pytest.approx(same.vibratory_torque) and np.isnan(one.missing)
    written = tn.misfire(line, speed_range=("2000 rpm", "3000 rpm"))
    assert written.response.speed[[0, -1]] == pytest.approx([tn.rpm(2000), tn.rpm(3000)])
