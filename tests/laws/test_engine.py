"""The Engine: gas torques against the slider crank by Pythagoras, throws against lines by hand and dense solves,
misfires, pressure curves from files, what happens to the throws when their numbers change."""

from __future__ import annotations

import warnings
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import trunnion as tn
from trunnion.driveline.engine import Engine
from trunnion.errors import InputRemark

BORE, STROKE, ROD = 0.2, 0.26, 0.5
CYLINDER = {"bore": BORE, "stroke": STROKE, "rod_length": ROD}
FOUR_STROKE, TWO_STROKE = 4 * np.pi, 2 * np.pi
AIR = 101325.0
LOAD = 1.2


def piston(angle):
    """Distance of the pin from the crank's centre, by Pythagoras."""
    r = STROKE / 2
    return r * np.cos(angle) + np.sqrt(ROD**2 - (r * np.sin(angle)) ** 2)


def lever(angle):
    """−dx/dθ by a complex step."""
    return -piston(angle + 1e-30j).imag / 1e-30


def curve(peak, cycle=FOUR_STROKE, points=181, load=None):
    """Compression with a bump of combustion behind the top dead centre: (angles, pressures) of one cycle."""
    angles = np.linspace(-cycle / 2, cycle / 2, points)
    closed = np.where(np.abs(angles) < np.pi, (1 + np.cos(angles)) / 2, 0.0)
    burnt = np.exp(-(((angles - 0.25) / 0.35) ** 2))
    pressures = 2e5 + 40e5 * closed**4 + peak * burnt
    pressures[-1] = pressures[0]
    return tn.PressureCurve(load=load, angles=angles, pressures=pressures)


def engine(**changes) -> Engine:
    stated = {
        "firing_order": "1-5-3-6-2-4", "throw_inertia": 4.5, "throw_stiffness": 8e6, "drive_share": 1, "name": "engine",
    }  # fmt: skip
    return tn.Engine(**{key: value for key, value in {**stated, **changes}.items() if value is not None})


def ship(*parts, load=LOAD) -> tn.Driveline:
    """An engine on a flywheel, a soft coupling and a propeller."""
    tail = [
        tn.Shaft(stiffness=1e7, name="to flywheel"),
        tn.Disk(inertia=120.0, name="flywheel"),
        tn.Shaft(stiffness=1.5e5, damping=900.0, name="coupling"),
        tn.Disk(inertia=900.0, quadratic_load=load, name="propeller"),
    ]
    return tn.Driveline([*parts, *tail])


GAS = [
    {"order": k / 2, "amplitude": 3000.0 / k, "phase": 1.4 - 0.1 * k} for k in range(1, 13)
]  # fmt: skip


@pytest.mark.parametrize(("strokes", "cycle"), [(4, FOUR_STROKE), (2, TWO_STROKE)])
def test_gas_harmonics_are_those_of_the_exact_slider_crank(strokes, cycle):
    """Fourier integrals of p A (−dx/dθ) piece by piece, on uneven points, by adaptive quadrature, to 1e-10."""
    rng = np.random.default_rng(strokes)
    angles = -cycle / 2 + cycle * np.concatenate([[0.0], np.sort(rng.uniform(0.01, 0.99, 28)), [1.0]])
    pressures = rng.uniform(2e5, 90e5, 30)
    pressures[-1] = pressures[0]
    one = engine(
        firing_order=[1], strokes=strokes, pressure=[{"angles": angles, "pressures": pressures}], orders=9, **CYLINDER
    )
    found = {e.order: e.amplitude * np.exp(1j * e.phase) for e in one.made_of("engine")[0].excitation}
    area = np.pi / 4 * BORE**2

    def harmonic(order):
        def part(angle, turned):
            return (np.interp(angle, angles, pressures) - AIR) * area * lever(angle) * turned(order * angle)

        sums = [
            sum(quad(part, a, b, args=(turned,), epsabs=1e-9, epsrel=1e-12)[0] for a, b in pairwise(angles))
            for turned in (np.cos, np.sin)
        ]
        return 2 / cycle * (sums[0] - 1j * sums[1])

    assert list(found) == [k * 2 / strokes for k in range(1, int(9 * strokes / 2) + 1)]
    largest = max(map(abs, found.values()))
    for order in list(found)[::3]:
        assert abs(found[order] - harmonic(order)) < 1e-10 * largest


def test_mean_torque_of_a_curve_is_its_work():
    """2 T̄ π per turn is ∮ p dV, with volumes from Pythagoras: the points of the table over torque."""
    curves = [curve(10e5), curve(60e5)]
    one = engine(pressure=curves, **CYLINDER)
    angles = np.linspace(-2 * np.pi, 2 * np.pi, 200001)
    volume = np.pi / 4 * BORE**2 * -piston(angles)
    work = [np.trapezoid(np.interp(angles, c.angles, c.pressures), volume) for c in curves]
    assert one.made_of("engine")[0].excitation[0].torques == pytest.approx(np.array(work) / FOUR_STROKE, rel=1e-7)


def test_throws_are_those_written_by_hand():
    """Also behind a damper, with a pump on throw 2, banks, and all in one."""
    fired = {1: 0, 5: 120, 3: 240, 6: 360, 2: 480, 4: 600}
    disks = [
        tn.Disk(inertia=4.5, drive_share=1, excitation=GAS, firing_angles=[f"{fired[n]} deg"], name=f"engine.throw {n}")
        for n in range(1, 7)
    ]
    cranks = [tn.Shaft(stiffness=8e6, damping=40.0, name=f"engine.crank {n}-{n + 1}") for n in range(1, 6)]
    by_hand = [part for pair in zip(disks, [*cranks, None], strict=True) for part in pair if part]
    pump = tn.Disk(inertia=2.0, after="engine.throw 2", name="pump")
    ours = ship(engine(gas_torque=GAS, damping=40.0))
    written = ship(*by_hand)
    assert ours.names == written.names
    one, other = (tn.order_response(line, [30.0, 78.0]) for line in (ours, written))
    assert np.abs(one.torque - other.torque).max() < 1e-12 * np.abs(other.torque).max()
    one, other = (tn.natural_frequencies(tn.Driveline([*line.elements, pump])) for line in (ours, written))
    assert one.elastic == pytest.approx(other.elastic, rel=1e-12) and len(one.elastic) == 7
    rigid = tn.order_response(ship(engine(gas_torque=GAS, rigid=True)), [30.0])
    disk = tn.Disk(inertia=27.0, drive_share=1, excitation=GAS, firing_angles=[f"{a} deg" for a in fired.values()])
    lumped = tn.order_response(ship(disk), [30.0])
    assert rigid.torque == pytest.approx(lumped.torque, rel=1e-12)


def test_two_banks_fire_from_one_throw():
    """V8 at 90°: each throw bears cylinders j and j + 4, which fire the bank angle apart, by number."""
    order = "1-5-4-2-6-3-7-8"
    vee = engine(firing_order=order, bank_angle="90 deg", gas_torque=GAS)
    fired = {c: k * np.pi / 2 for k, c in enumerate([1, 5, 4, 2, 6, 3, 7, 8])}
    disks = [e for e in vee.made_of("engine") if isinstance(e, tn.Disk)]
    assert [d.firing_angles for d in disks] == [pytest.approx([fired[j], fired[j + 4]]) for j in range(1, 5)]
    with pytest.warns(InputRemark, match="does not fit the firing order: cylinders 2 and 6 share a throw"):
        engine(firing_order="1-5-2-4-6-3-7-8", bank_angle="90 deg")


def dense(speed, order, torques, masses, stiffnesses, dampings, grounded):
    """Twists of a chain under torques at its first inertias: (−ω²M + iωC + K) y = T with matrices of one's own."""
    n, w = len(masses), order * speed
    matrix = -(w**2) * np.diag(masses).astype(complex)
    matrix[-1, -1] += 1j * w * grounded
    for i, (k, c) in enumerate(zip(stiffnesses, dampings, strict=True)):
        z = k + 1j * w * c
        matrix[i : i + 2, i : i + 2] += z * np.array([[1, -1], [-1, 1]])
    y = np.linalg.solve(matrix, np.concatenate([torques, np.zeros(n - len(torques))]))
    return np.diff(y)


@pytest.mark.parametrize("silent", [None, "misfiring", "cut_out"])
@pytest.mark.parametrize("cylinder", [1, 4])
def test_a_silent_cylinder_against_a_dense_solve(silent, cylinder):
    """Six throws with masses and gas; the gas of the one that misfires is compressed and expands: all by numpy."""
    speed, m, ratio, charge, exponent = 71.0, 30.0, 14.0, 2.1e5, 1.34
    one = curve(60e5, points=721)
    stated = {"compression_ratio": ratio, "charge_pressure": charge, "polytropic_exponent": exponent}
    made = engine(
        pressure=[one], damping=300.0, reciprocating_mass=m, orders=6, **stated, **CYLINDER,
        **({silent: cylinder} if silent else {}),
    )  # fmt: skip
    found = tn.order_response(ship(made), [speed], orders=np.arange(1, 13) / 2)

    count = 1 << 14
    angle = FOUR_STROKE * np.arange(count) / count - 2 * np.pi
    area, clearance = np.pi / 4 * BORE**2, np.pi / 4 * BORE**2 * STROKE / (ratio - 1)
    volume = clearance + area * (piston(0.0) - piston(angle))
    shut = charge * ((clearance + area * STROKE) / volume) ** exponent
    pressures = {
        "fires": np.interp(angle, one.angles, one.pressures),
        "misfiring": np.where(np.abs(angle) <= np.pi, shut, charge),
        "cut_out": np.full(count, AIR),
    }
    kinetic = m * lever(angle) ** 2 / 2
    inertia = kinetic.mean() * 2
    spectrum = {}
    for kind, p in pressures.items():
        gas = np.fft.rfft((p - AIR) * area * lever(angle)) / count * 2
        # angle begins at −2π: no phase, as half orders turn by −2π k = whole turns of π: (−1)^(2k)
        gas *= np.exp(2j * np.pi * np.arange(len(gas)) / 2)
        energy = np.fft.rfft(kinetic) / count * 2 * np.exp(1j * np.pi * np.arange(count // 2 + 1))
        spectrum[kind] = gas - 1j * (np.arange(len(gas)) / 2) * energy * speed**2
    # each throw stands behind the one in front by the twist under the mean torque, a sixth more from throw to throw
    behind = np.cumsum([0, *(np.arange(1, 6) * LOAD * speed**2 / 6 / 8e6)])
    fired = np.deg2rad([0, 480, 240, 600, 120, 360]) + behind
    masses = [*np.full(6, 4.5 + inertia), 120.0, 900.0]
    stiffnesses, dampings = [*np.full(5, 8e6), 1e7, 1.5e5], [*np.full(5, 300.0), 0.0, 900.0]
    largest = np.abs(found.torque).max()
    for i, order in enumerate(found.order):
        n = round(2 * order)
        kinds = [silent if silent and c == cylinder else "fires" for c in range(1, 7)]
        torques = np.array([spectrum[k][n] * np.exp(-1j * order * a) for k, a in zip(kinds, fired, strict=True)])
        twist = dense(speed, order, torques, masses, stiffnesses, dampings, 2 * LOAD * speed)
        by_hand = (np.array(stiffnesses) + 1j * order * speed * np.array(dampings)) * twist
        assert np.abs(found.torque[0, i] - by_hand).max() < 1e-5 * largest


def test_between_two_loads_harmonics_are_linear_in_the_mean_torque():
    """At the load of a curve they are those of the curve alone; beyond the curves the response is refused."""
    curves = [curve(10e5, load=0.25), curve(60e5, load=1.0)]
    both = engine(pressure=curves, **CYLINDER)
    low, high = both.made_of("engine")[0].excitation[0].torques
    w = 60.0

    def response(one, torque):
        return tn.order_response(ship(one, load=6 * torque / w**2), [w], orders=[3.0]).torque[0, 0]

    ends = [response(engine(pressure=[c], **CYLINDER), t) for c, t in zip(curves, (low, high), strict=True)]
    for share in (0.0, 0.4, 1.0):
        torque = low + (high - low) * (share * (1 - 2e-9) + 1e-9)
        # the damping that the load's slope adds differs by the load: compare at one load
        mixed = response(both, torque)
        apart = [response(engine(pressure=[c], **CYLINDER), torque) for c in curves]
        assert mixed == pytest.approx((1 - share) * apart[0] + share * apart[1], rel=1e-6)
    assert np.abs(ends[1][0]) > np.abs(ends[0][0])
    with pytest.raises(tn.InputError, match=r"engine\.throw 1\.excitation 1: is a table .* which does not cover"):
        response(both, 1.05 * high)


def test_pressures_from_a_file(tmp_path):
    """CSV beside the description; written again it needs no second file. Bar read as Pa is refused."""
    rows = ["load,angle [deg],pressure [bar]"]
    for load, peak in ((0.5, 30e5), (1.0, 60e5)):
        one = curve(peak, points=181)
        rows += [f"{load},{np.rad2deg(a):.6f},{p / 1e5:.6f}" for a, p in zip(one.angles, one.pressures, strict=True)]
    (tmp_path / "pressure.csv").write_text("\n".join(rows), encoding="utf-8")
    text = tn.dumps(ship(engine(**CYLINDER))).replace('name = "engine"', 'name = "engine"\npressure = "pressure.csv"')
    (tmp_path / "ship.toml").write_text(text, encoding="utf-8")
    line = tn.load(tmp_path / "ship.toml")
    made = line.as_stated.elements[0]
    assert [c.load for c in made.pressure] == [0.5, 1.0] and len(made.pressure[0].angles) == 181
    assert tn.read_pressure(tmp_path / "pressure.csv") == made.pressure
    assert tn.loads(tn.dumps(line)) == line
    wrong = "\n".join(rows).replace("[bar]", "[Pa]")
    (tmp_path / "pressure.csv").write_text(wrong, encoding="utf-8")
    refused = r"engine \(element 1\)\.pressure = 'pressure.csv': reaches .* Pa at load .*, less than.*bar read as Pa"
    with pytest.raises(tn.InputError, match=refused):
        tn.load(tmp_path / "ship.toml")
    (tmp_path / "pressure.csv").write_text("\n".join(rows[:20]), encoding="utf-8")
    with pytest.raises(tn.InputError, match=r"pressure: pressure\.csv: load 0\.5.*has 19 points"):
        tn.load(tmp_path / "ship.toml")


def test_its_throws_are_elements_and_it_takes_their_numbers_over():
    limits = [tn.Limit(of="engine.crank *", vibratory_torque="12 kN*m")]
    line = tn.Driveline(ship(engine(gas_torque=GAS)).as_stated.elements, limits=limits)
    assert len(line.limits_by_element) == 5
    changed = line.replace("engine.throw 3", inertia=5.0).replace("engine.crank 1-2", stiffness=9e6)
    stated = changed.as_stated.elements[0]
    assert stated.throw_inertia == (4.5, 4.5, 5.0, 4.5, 4.5, 4.5) and stated.throw_stiffness[0] == 9e6
    assert tn.loads(tn.dumps(changed)) == changed
    packed = tn.pack(line)
    assert packed.value("engine.throw 2.inertia") == 4.5
    moved = packed.line_at(packed.values * np.where([x == "engine.throw 2.inertia" for x in packed.labels], 1.1, 1.0))
    assert moved.as_stated.elements[0].throw_inertia == pytest.approx((4.5, 4.95, 4.5, 4.5, 4.5, 4.5))
    assert line.replace("engine", misfiring=2).as_stated.elements[0].misfiring == 2
    alone = line.within("engine")
    assert alone.names == line.names[:11] and tn.natural_frequencies(alone).elastic[0] == pytest.approx(
        2 * np.sqrt(8e6 / 4.5) * np.sin(np.pi / 12), rel=1e-12
    )
    with pytest.raises(tn.InputError, match="flywheel: is made of no other elements; known: engine"):
        line.within("flywheel")


def test_what_it_cannot_state_dissolves_it_and_keeps_every_name():
    line = tn.Driveline([engine(gas_torque=GAS), tn.Shaft(stiffness=1e5), tn.Disk(inertia=9.0), tn.Disk(inertia=1.0)])
    assert line.names[-3:] == ("Shaft 1", "Disk 1", "Disk 2")
    dissolved = line.replace("engine.throw 3", drive_share=0.5)
    assert dissolved.names == line.names == dissolved.as_stated.names
    assert tn.loads(tn.dumps(dissolved)) == dissolved
    hung = tn.Driveline([*line.as_stated.elements, tn.Disk(inertia=1.0, after="engine", name="gear")])
    assert hung.elements[-1].after == "engine.throw 6" and hung.as_stated.parents[-1] == 0


def test_assess_finds_the_worst_cylinder():
    """Of every check the worst over all cylinders out of work in turn, with and without a load case, at one speed."""
    loads = [tn.LoadCase(name="towing", loads={"propeller": 4e3})]
    limits = [tn.Limit(of=of, vibratory_torque="12 kN*m") for of in ("coupling", "engine.crank 2-3")]
    one = engine(
        pressure=[curve(60e5)], compression_ratio=14, charge_pressure=2e5, polytropic_exponent=1.34, **CYLINDER
    )
    asked = tn.Operation(speed=70.0, misfiring=True, load_cases=loads)
    line = tn.Driveline(ship(one).as_stated.elements, operation=asked, limits=limits)
    assert len(line.cases) == 13
    judged = tn.assess(line, (70.0, 70.0))
    responses = {
        (case, n): tn.order_response(
            (line.with_load(case) if case else line).replace("engine", **({"misfiring": n} if n else {})), 70.0
        )
        for case in ("", "towing") for n in range(7)
    }  # fmt: skip
    for limit in limits:
        spring = responses["", 0].springs.index(limit.of)
        largest = {key: r.vibratory_torque[0, spring] for key, r in responses.items()}
        check = judged.check(f"vibratory torque of {limit.of}")
        assert check.value == pytest.approx(max(largest.values()), rel=1e-9)
        case, n = max(largest, key=largest.__getitem__)
        assert check.load_case.endswith(f"engine cylinder {n} misfiring") and n
    found = tn.misfire(line, [70.0])
    spring = found.springs.index("coupling")
    assert found.vibratory_torque[2, spring] == responses["", 3].vibratory_torque[0, spring]
    quiet = tn.misfire(line, [70.0], cut_out=True)
    assert quiet.line.as_stated.elements[0].cut_out == quiet.worst[1] and "cut-out: cylinder" in str(quiet)
    assert line.with_load("towing, engine cylinder 2 cut out").elements[-1].load_torque == 4e3
    with pytest.raises(tn.InputError, match="is not a load case"):
        line.with_load("engine cylinder 9 misfiring")


def test_stiffness_from_dimensions():
    """Carter and Ker Wilson by hand; a throw without webs and pins is near the plain shaft that it then is."""
    sizes = {
        "journal_diameter": 0.06, "journal_length": 0.03, "pin_diameter": 0.05, "pin_bore": 0.02, "pin_length": 0.032,
        "web_thickness": 0.02, "web_width": 0.09, "shear_modulus": 8e10, "stroke": 0.09,
    }  # fmt: skip
    journal, pin, web = 0.06**4, 0.05**4 - 0.02**4, 0.02 * 0.09**3
    by_hand = {
        "carter": 0.046 / journal + 0.024 / pin + 0.0675 / web,
        "ker wilson": 0.054 / journal + 0.052 / pin + 0.023 / web,
    }
    for formula, yields in by_hand.items():
        one = engine(throw_stiffness=None, stiffness_formula=formula, **sizes)
        shafts = [e for e in one.made_of("engine") if isinstance(e, tn.Shaft)]
        assert [s.stiffness for s in shafts] == pytest.approx([np.pi * 8e10 / 32 / yields] * 5, rel=1e-12)
    line = ship(one)
    stiffer = line.replace("engine.crank 2-3", stiffness=2e6).as_stated.elements[0]
    assert stiffer.journal_diameter is None and stiffer.throw_stiffness[1] == 2e6
    heavier = line.replace("engine.throw 2", inertia=5.0).as_stated.elements[0]
    assert heavier.journal_diameter == 0.06 and heavier.throw_inertia[1] == 5.0
    assert tn.loads(tn.dumps(line)) == line
    plain = engine(
        throw_stiffness=None, **sizes | {"pin_bore": 0.0, "pin_length": 1e-6, "web_thickness": 0.1, "web_width": 9}
    )
    shaft = tn.Shaft(outer_diameter=0.06, length=0.03 + 0.08, shear_modulus=8e10)
    assert plain.stiffnesses[0] == pytest.approx(shaft.torsional_stiffness, rel=1e-3)


def test_a_share_of_the_mean_torque_counts_that_of_one_cylinder():
    """However many cylinders a disk bears; at one load the same as an amplitude of as much."""
    crank = {"firing_order": "1-3-4-2", "throw_stiffness": 1e9, "throw_inertia": 0.05}

    def response(gas, **how):
        made = tn.Engine(gas_torque=[{"order": 2, **gas}], drive_share=1, **crank, **how)
        disk = tn.Disk(inertia=3.0, load_torque=400.0)
        return tn.order_response(tn.Driveline([made, tn.Shaft(stiffness=1e5, damping=5), disk]), [50.0]).torque

    for how in ({}, {"rigid": True}, {"bank_angle": "180 deg"}, {"rigid": True, "misfiring": 2}):
        assert response({"share": 0.5}, **how) == pytest.approx(response({"amplitude": 50.0}, **how), rel=1e-9)


def test_a_load_on_a_throw_leaves_a_misfire_its_compression():
    """A misfire under a load case of a throw is a misfire, not a cut-out."""
    numbers = {"compression_ratio": 14, "charge_pressure": 2e5, "polytropic_exponent": 1.34}
    one = engine(pressure=[curve(60e5)], damping=300.0, **numbers, **CYLINDER)
    asked = tn.Operation(speed=70.0, misfiring=True, load_cases=[tn.LoadCase(name="30", loads={"engine.throw 1": 30})])
    line = tn.Driveline(ship(one).as_stated.elements, operation=asked)
    plain, loaded = tn.misfire(line, [70.0]), tn.misfire(line, [70.0], load_case="30")
    assert loaded.vibratory_torque == pytest.approx(plain.vibratory_torque, rel=1e-2)
    cut = tn.misfire(line, [70.0], load_case="30", cut_out=True)
    assert np.abs(cut.vibratory_torque / loaded.vibratory_torque - 1).max() > 0.05
    alone = tn.order_response(line.with_load("30, engine cylinder 3 misfiring"), [70.0])
    assert alone.vibratory_torque[0] == pytest.approx(loaded.vibratory_torque[2], rel=1e-12)


def test_what_auxiliaries_take_from_a_throw_stays_with_the_engine():
    """A load of a throw that is changed keeps the Engine, its misfire the compression, and its gas the torque that the
    cylinders drive with, as against a pump on a shaft of its own."""
    numbers = {"compression_ratio": 14, "charge_pressure": 2e5, "polytropic_exponent": 1.34}
    two, speed = [curve(10e5, load=0.5), curve(60e5, load=1.0)], 70.0
    one = engine(pressure=two, damping=300.0, **numbers, **CYLINDER)
    low, high = one.made_of("engine")[0].excitation[0].torques
    plain = ship(one, load=6 * (0.5 * low + 0.5 * high) / speed**2)
    line = plain.replace("engine.throw 3", load_torque=500.0)
    stated = line.as_stated.elements[0]
    assert isinstance(stated, tn.Engine) and stated.throw_load_torque == (0, 0, 500.0, 0, 0, 0)
    assert tn.loads(tn.dumps(line)) == line
    assert line.replace("engine.throw 3", load_torque=0.0).as_stated.elements[0].throw_load_torque == ()
    stiff = tn.Shaft(stiffness=1e13, damping=1e4, after="engine.throw 3", name="stub")
    apart = tn.Driveline([*plain.as_stated.elements, stiff, tn.Disk(inertia=1e-6, load_torque=500.0, name="pump")])
    for asked in ({}, {"misfiring": 2}, {"cut_out": 3}):
        found, expected = (
            tn.order_response(x.replace("engine", **asked) if asked else x, [speed]) for x in (line, apart)
        )
        other = [expected.springs.index(name) for name in found.springs]
        np.testing.assert_allclose(found.vibratory_torque, expected.vibratory_torque[:, other], rtol=1e-5)
    before = tn.order_response(plain, [speed]).vibratory_torque
    assert np.abs(tn.order_response(line, [speed]).vibratory_torque / before - 1).max() > 0.01
    rigid = tn.Driveline([engine(pressure=two, rigid=True, **CYLINDER), *plain.as_stated.elements[1:]])
    kept = rigid.replace("engine.crankshaft", load_torque=77.7).as_stated.elements[0]
    assert kept.rigid and kept.made_of("engine")[0].load_torque == 77.7
    with pytest.raises(tn.InputError, match="throw_load_torque = .1.0, 2.0.: must be one for all or 6"):
        engine(throw_load_torque=[1.0, 2.0])


def test_a_cylinder_out_of_work_in_the_other_way_is_left_out_and_a_line_needs_springs():
    line = ship(engine(gas_torque=GAS, damping=300.0, cut_out=3))
    assert [number for _, number in tn.misfire(line, [70.0]).cylinders] == [1, 2, 4, 5, 6]
    assert not [name for name in line.replace("engine", cut_out=None, misfiring=3)._silent if "cylinder 3 cut" in name]
    found = tn.misfire(line, [70.0])
    assert found.stated == "engine cylinder 3 cut out" and "all firing" not in str(found)
    assert "engine cylinder 3 cut out [N m]" in found.table()[0]
    rigid = tn.Driveline([engine(gas_torque=GAS, rigid=True), tn.Disk(inertia=2.0, load_torque=30.0)])
    with pytest.raises(tn.InputError, match="has no springs"):
        tn.misfire(rigid, [70.0])


def test_what_a_turn_leaves_out_of_its_throws_is_said_once():
    """Not throw by throw; what belongs to another part by its own name."""
    ship = [engine(gas_torque=[{"order": 3, "amplitude": 100.0}]), tn.Shaft(stiffness=1e6), tn.Disk(inertia=9.0)]
    parts = [*ship, tn.HookeJoint(angle=0.1), tn.Shaft(stiffness=1e6), tn.Disk(inertia=3.0, viscous_load=1.0)]
    said = " ".join(str(one) for one in tn.kinetostatics(tn.Driveline(parts)).findings)
    assert "engine.throw *.drive_share are left out: the first element drives alone" in said
    assert "engine.throw *.excitation, engine.throw *.firing_angles are left out" in said and "throw 2" not in said


def test_odd_numbers_of_a_cylinder_are_said():
    """A bore in mm read as m, a curve with a hole, and one whose angles stand half a turn off and that brakes."""
    with pytest.warns(InputRemark, match=r"bore = 200: is 200 m, more than any engine has"):
        engine(pressure=[curve(60e5)], **CYLINDER | {"bore": 200.0})
    full = curve(60e5, points=181)
    kept = [i for i, angle in enumerate(full.angles) if not np.deg2rad(101) < angle < np.deg2rad(199)]
    holed = tn.PressureCurve(angles=[full.angles[i] for i in kept], pressures=[full.pressures[i] for i in kept])
    with pytest.warns(InputRemark, match=r"has no point from 100 deg to 200 deg; it is taken as linear"):
        engine(pressure=[holed], **CYLINDER)
    mirrored = tn.PressureCurve(angles=full.angles, pressures=full.pressures[::-1])
    work = -np.trapezoid(
        np.interp(np.array(full.angles), full.angles, full.pressures[::-1]), piston(np.array(full.angles))
    )
    mean = work * np.pi / 4 * BORE**2 / FOUR_STROKE
    assert mean < 0
    with pytest.warns(InputRemark, match="brakes: its mean torque over the cycle is -") as said:
        engine(pressure=[mirrored], **CYLINDER)
    (one,) = said
    assert float(str(one.message).split("cycle is ")[1].split(" N m")[0]) == pytest.approx(mean, rel=0.01)
    engine(pressure=[mirrored], **CYLINDER, drive_share=None)  # a compressor takes it


@pytest.mark.parametrize(
    ("bore", "mass", "said"),
    [
        (0.08, 0.5, ""),
        (0.23, 38.0, ""),
        (0.9, 5000.0, ""),
        (0.08, 500.0, "too heavy for a bore of 80 mm"),
        (0.23, 0.038, "too light for a bore of 230 mm"),
    ],
)
def test_a_reciprocating_mass_of_another_unit_is_said(bore, mass, said):
    """Of a car, a medium-speed engine and a slow two-stroke none; g read as kg, and kg as g."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputRemark)
        engine(gas_torque=GAS, reciprocating_mass=mass, **CYLINDER | {"bore": bore})
    found = [str(one.message) for one in caught if "reciprocating_mass" in str(one.message)]
    assert len(found) == bool(said)
    assert not said or said in found[0]


@pytest.mark.parametrize(("share", "doubted"), [(0.09, False), (1.0, False), (9.0, True)])
def test_a_share_above_the_mean_torque_is_said(share, doubted):
    """9 for 9 %."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputRemark)
        tn.Propeller(name="screw", inertia=3.0, quadratic_load=1.0, excitation=[{"order": 4, "share": share}])
    said = [str(one.message) for one in caught]
    assert len(said) == doubted
    assert not doubted or "has a share of 9, that many times the mean torque; check it: 9 %" in said[0]
