"""The report that is handed in: its numbers against a recursion and dense matrices, its pages, its title block."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from published.cases.forced import three_disks
from scipy.optimize import brentq
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app
from trunnion.equations.coefficients import assemble
from trunnion.modes.mass_elastic import holzer, masses, springs
from trunnion.pictures import driveline_sketch
from trunnion.reporting.barred_ranges import FIRING, HOLDS, NONE, SILENT, barred, barred_ranges
from trunnion.reporting.loads_table import loads
from trunnion.reporting.overview_assessment import capital
from trunnion.reporting.page import in_css
from trunnion.reporting.submission import Submission
from trunnion.reporting.submission_tables import (
    excitations,
    firing_checks,
    holzer_table,
    misfire_checks,
    misfires,
    particulars,
    rules,
    shafts,
)

TEXT = """
format = 1
name = "generator set <& co>"

[document]
number = "TV-2031"
revision = "B"
author = "the author"

[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "1800 rpm"]

[[limit]]
of = "shaft"
vibratory_torque = "6 kN*m"

[[element]]
type = "Disk"
name = "engine"
inertia = 3.0
drive_share = 1.0
firing_angles = ["0 deg", "540 deg", "180 deg", "360 deg"]
excitation = [
  { order = 0.5, amplitude = "120 N*m", phase = "20 deg" },
  { order = 1.0, amplitude = "160 N*m", phase = "50 deg" },
  { order = 1.5, amplitude = "170 N*m" },
  { order = 2.0, amplitude = "150 N*m" },
]
[[element]]
type = "Shaft"
name = "coupling"
stiffness = "21 kN*m/rad"
damping = "20 N*m*s/rad"
[[element]]
type = "Disk"
name = "flange"
inertia = 0.4
[[element]]
type = "Shaft"
name = "shaft"
damping = "5 N*m*s/rad"
outer_diameter = "90 mm"
length = "1.2 m"
shear_modulus = "80 GPa"
[[element]]
type = "Disk"
name = "rotor"
inertia = 5.0
viscous_load = "2 N*m*s/rad"
"""
SHEETS = (
    "first", "mass-elastic", "modes", "excitation", "critical", "torques", "malfunction", "barred", "heat", "rules",
    "assumptions",
)  # fmt: skip


@cache
def made() -> Submission:
    return tn.submission(tn.loads(TEXT))


def test_holzers_recursion_closes_at_every_frequency() -> None:
    """θ_{i+1} = θ_i − ω² Σ J θ / k from the free end, as he did it by hand (1921); a geared chain, by its input."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0, drive_share=1.0), tn.Shaft(stiffness=3e4), tn.Disk(inertia=0.7), tn.Ratio(ratio=-2.5),
            tn.Shaft(stiffness=9e4), tn.Disk(inertia=4.0), tn.Shaft(stiffness=5e4), tn.Disk(inertia=1.5),
        ]
    )  # fmt: skip
    found = tn.natural_frequencies(line)
    ratio = -1 / 2.5
    inertia, stiffness = [2.0, 0.7, 4.0 * ratio**2, 1.5 * ratio**2], [3e4, 9e4 * ratio**2, 5e4 * ratio**2]
    assert [one.referred for one in masses(found.assembly)] == pytest.approx(inertia)
    assert [one.referred for one in springs(found.assembly)] == pytest.approx(stiffness)
    for mode in range(2, 5):
        table = holzer(found, mode)
        theta, torque = [1.0], 0.0
        for i, k in enumerate(stiffness):
            torque += inertia[i] * table.frequency**2 * theta[i]
            theta.append(theta[i] - torque / k)
        torque += inertia[-1] * table.frequency**2 * theta[-1]
        assert abs(torque) < 1e-9 * table.frequency**2
        at_input = table.amplitude / np.array([1, 1, ratio, ratio])
        assert at_input / at_input[0] == pytest.approx(theta)
        behind, ahead = np.array(theta[1:]), np.array(theta[:-1])
        assert len(table.nodes) == mode - 1 == np.sum(behind * ahead < 0)
        crossing = np.flatnonzero(behind * ahead < 0)
        assert [share for _, share in table.nodes] == pytest.approx(list((ahead / (ahead - behind))[crossing]))


def test_a_published_mass_elastic_table() -> None:
    """Thomson, Theory of Vibration with Applications (1993), table 12.4-1: its parameters as masses and springs, and of
    both modes what the recursion of its columns gives; its own numbers are in ``published/cases/forced.py``."""
    found = tn.natural_frequencies(three_disks(20.0))
    assert [one.inertia for one in masses(found.assembly)] == [5.0, 11.0, 22.0]
    assert [one.stiffness for one in springs(found.assembly)] == [0.10e6, 0.20e6]
    for mode in (2, 3):
        table = holzer(found, mode)
        squared, first = table.frequency**2, table.amplitude[0]
        torque_1 = squared * 5
        theta_2 = 1 - torque_1 / 0.10e6
        torque_2 = torque_1 + squared * 11 * theta_2
        theta_3 = theta_2 - torque_2 / 0.20e6
        assert table.amplitude / first == pytest.approx([1.0, theta_2, theta_3], rel=1e-9)
        assert np.abs(table.torque / first) == pytest.approx(np.abs([torque_1, torque_2]), rel=1e-9)
        assert abs(torque_2 + squared * 22 * theta_3) < 1e-9 * torque_1


@pytest.mark.parametrize("name", ["truck", "harbour-tug", "rolling-mill-spindle"])
def test_every_mass_is_in_balance(name: str) -> None:
    found = tn.natural_frequencies(tn.load(f"examples/{name}.toml"))
    for mode in range(1 + found.still, len(found.mode) + 1):
        table = holzer(found, mode)
        felt = found.assembly.topology.elongations.T @ table.torque
        assert felt == pytest.approx(table.inertia_torque, abs=1e-9 * np.abs(table.torque).max())


def dense(speed: np.ndarray, cylinders: list[int]) -> np.ndarray:
    """Vibratory torque of the two springs (speed, 2) with own matrices: order by order, then the sum over two turns."""
    orders, size, phase = [0.5, 1.0, 1.5, 2.0], [120, 160, 170, 150], np.deg2rad([20, 50, 0, 0])
    firing = np.deg2rad([0, 540, 180, 360])
    m = np.diag([3.0, 0.4, 5.0])
    tube = 80e9 * np.pi * 0.09**4 / 32 / 1.2
    k = np.array([[21e3, -21e3, 0], [-21e3, 21e3 + tube, -tube], [0, -tube, tube]])
    c = np.array([[20.0, -20, 0], [-20, 25, -5], [0, -5, 5 + 2]])
    turns = np.exp(1j * np.outer(orders, np.linspace(0, 4 * np.pi, 1440, endpoint=False)))
    found = []
    for omega in speed:
        torque = []
        for order, a, p in zip(orders, size, phase, strict=True):
            v = order * omega
            acting = a * np.exp(1j * p) * sum(np.exp(-1j * order * firing[n]) for n in cylinders)
            q = np.linalg.solve(k + 1j * v * c - v**2 * m, [acting, 0, 0])
            torque.append([(21e3 + 20j * v) * (q[1] - q[0]), (tube + 5j * v) * (q[2] - q[1])])
        wave = np.real(np.array(torque).T @ turns)
        found.append(np.ptp(wave, axis=1) / 2)
    return np.array(found)


def test_the_largest_torques_and_those_of_misfires_are_those_of_dense_matrices() -> None:
    """On a grid that the search knows nothing of: nothing lies above what is stated, and its own speed gives it."""
    speed = np.linspace(20 * np.pi, 60 * np.pi, 2003)
    every, contents = [0, 1, 2, 3], made().contents
    largest = dense(speed, every).max(axis=0)
    for s, shaft in enumerate(contents.shafts):
        assert largest[s] <= shaft.vibratory.value + shaft.vibratory.error + 1e-5 * largest[s]
        there = dense(np.array([shaft.vibratory.speed]), every)[0, s]
        assert shaft.vibratory.value == pytest.approx(there, rel=1e-4)
    assert [one.cylinder for one in contents.misfiring] == [f"cylinder {n} of engine" for n in (1, 2, 3, 4)]
    for n, case in enumerate(contents.misfiring):
        firing = [one for one in every if one != n]
        largest = dense(speed, firing).max(axis=0)
        for s, top in enumerate(case.vibratory):
            assert largest[s] <= top.value + top.error + 1e-5 * largest[s]
            assert top.value == pytest.approx(dense(np.array([top.speed]), firing)[0, s], rel=1e-4)
            assert top.value > 1.5 * contents.shafts[s].vibratory.value


def test_power_and_heat_by_hand() -> None:
    contents = made().contents
    most = max(contents.powers, key=lambda one: one.power)
    assert most.speed == pytest.approx(60 * np.pi)
    assert most.torque == pytest.approx(2 * 60 * np.pi) and most.power == pytest.approx(2 * (60 * np.pi) ** 2)
    warm = next(one for one in contents.shafts if one.spring == "coupling")
    assert warm.heat.value > 0 and contents.shafts[1].stress == pytest.approx(
        contents.shafts[1].vibratory.value * 16 / (np.pi * 0.09**3)
    )


def test_sheets_and_what_they_say() -> None:
    page = made().html
    assert [page.index(f'id="{name}"') for name in SHEETS] == sorted(page.index(f'id="{name}"') for name in SHEETS)
    for words in ("TV-2031", "the author", "generator set &lt;&amp; co&gt;", "approved", "cylinder 1 of engine"):
        assert words in page
    assert "http" not in page.replace("http-equiv", "") and "<script" not in page
    malfunction = page.split('id="malfunction"')[1].split("</section>")[0]
    worst = max(case.vibratory[1].value for case in made().contents.misfiring)
    assert worst < 6e3 and "vibratory torque of shaft" in malfunction and ">satisfied<" in malfunction


def test_title_block_goes_through_files_and_changes_no_number() -> None:
    line = tn.loads(TEXT)
    assert line.document == tn.TitleBlock(number="TV-2031", revision="B", author="the author")
    assert tn.loads(tn.dumps(line)) == line
    without = line.but(document=None)
    assert without.document is None and "[document]" not in tn.dumps(without)
    same = [tn.natural_frequencies(one).undamped_frequency for one in (line, without)]
    assert np.array_equal(*same) and assemble(without) is not None


def test_a_line_without_cylinders_and_response_says_so() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=1.0)])
    page = tn.submission(line, speed="900 rpm").html
    assert "The description has no cylinders that could misfire." in page and "Nothing excites the line." in page


def test_the_command_writes_it_and_json_stays_alone(tmp_path) -> None:
    file, folder = tmp_path / "set.toml", tmp_path / "out"
    file.write_text(TEXT)
    run = CliRunner().invoke(app, ["analyze", str(file), "--submission", "-o", str(folder), "--json"])
    assert run.exit_code == 0, run.output
    said = json.loads(run.stdout)
    assert said["written"] == [str(folder / "set-submission.html")]
    assert "Torsional vibration calculation" in (folder / "set-submission.html").read_text()
    assert list(folder.iterdir()) == [folder / "set-submission.html"]


ENGINE = """
format = 1
[operation]
speed = "900 rpm"
speed_range = ["700 rpm", "1000 rpm"]
MORE
[[element]]
type = "Engine"
name = "main.engine"
firing_order = "1-3-4-2"
throw_inertia = 0.3
throw_stiffness = "2 MN*m/rad"
loss_factor = 0.02
loss_factor_frequency = "50 Hz"
gas_torque = [{ order = 0.5, amplitude = "90 N*m" }, { order = 2, amplitude = "150 N*m", phase = "40 deg" }]
drive_share = 1
OWN
[[element]]
type = "Coupling"
name = "coupling"
stiffness = "9 kN*m/rad"
damping = 8
vibratory_torque = "120 N*m"
[[element]]
type = "Fan"
name = "fan"
inertia = 2.0
quadratic_load = 0.03
excitation = [{ order = 10, share = 0.02 }]
"""


@pytest.mark.parametrize(
    ("more", "own"), [pytest.param("misfiring = true", "", marks=pytest.mark.slow), ("", "misfiring = 1")]
)
def test_all_firing_is_with_all_firing_whatever_the_file_puts_out_of_work(more: str, own: str) -> None:
    contents = tn.submission(tn.loads(ENGINE.replace("MORE", more).replace("OWN", own))).contents
    usual = tn.loads(ENGINE.replace("MORE", "").replace("OWN", ""))
    speed = np.linspace(70 * np.pi / 3, 100 * np.pi / 3, 801)
    found = tn.order_response(usual, speed).vibratory_torque.max(axis=0)
    stated = np.array([one.value for one in contents.firing])
    assert np.all(found <= stated * (1 + 1e-5)) and stated == pytest.approx(found, rel=2e-3)
    assert len(contents.misfiring) == 4


def test_ratings_decide_when_a_cylinder_misfires_and_machines_excite() -> None:
    line = tn.loads(ENGINE.replace("MORE", "").replace("OWN", ""))
    made = tn.submission(line)
    failing = [tn.assess(line.replace("main.engine", misfiring=n)) for n in range(1, 5)]
    rated = max(check.value for found in failing for check in found.checks if "rated torque" in check.name)
    of_report = [check for one in made.contents.misfiring for check in one.checks if "rated torque" in check.name]
    assert max(check.value for check in of_report) == pytest.approx(rated, rel=1e-5)
    malfunction = made.html.split('id="malfunction"')[1].split("</section>")[0]
    assert (">exceeded<" in malfunction) is (rated > 120.0) and "rated torque of coupling" in malfunction
    assert ("out of work exceeded (section 6): rated torque of coupling" in made.html) is (rated > 120.0)
    first, rest = made.html.split('id="mass-elastic"')
    exceeded = [check.name for check in made.contents.seen.assessment.checks if check.exceeded]
    for name in exceeded:  # a row of the table there, a sentence among the findings
        assert name in first and f"{capital(name)} is exceeded:" not in first
        assert f"{capital(name)} is exceeded:" in rest
    excitation = made.html.split('id="excitation"')[1].split("</section>")[0]
    assert "2\u00a0% of the mean torque" in excitation and "main.engine, each cylinder" in excitation
    assert excitation.count(">order 0.5<") == 1 and "throw 2" not in excitation


def test_what_stands_still_has_no_node_beside_it_and_lines_without_springs_are_documents_too() -> None:
    disks = [tn.Disk(inertia=1.0, name=f"disk {i}") for i in range(3)]
    damper = tn.ViscousDamper(ring_inertia=0.5, damping=3.0, name="damper", after="disk 0")
    line = tn.Driveline(
        [disks[0], damper, tn.Shaft(stiffness=1e4, after="disk 0"), disks[1], tn.Shaft(stiffness=3e4), disks[2]]
    )
    found = tn.natural_frequencies(line)
    nodes = [len(holzer(found, mode).nodes) for mode in range(1 + found.still, len(found.mode) + 1)]
    assert nodes == [1, 2]
    alone = tn.Driveline([tn.Disk(inertia=1.0, drive_share=1.0, viscous_load=1.0)])
    assert "Torsional vibration calculation" in tn.submission(alone, speed="900 rpm").html


INDICATED = """
bore = "130 mm"
stroke = "150 mm"
rod_length = "250 mm"
mean_indicated_pressure = ["2 bar", "20 bar"]
peak_pressure = ["66 bar", "160 bar"]
charge_pressure = ["1.5 bar", "3 bar"]
compression_ratio = 15
polytropic_exponent = 1.35
"""


def test_a_signer_reads_what_cylinders_do_at_the_operating_speed_and_out_of_work() -> None:
    """Harmonics of one cylinder at the mean torque it drives with, interpolated here; cut out beside misfiring; what is
    exceeded then stands on the first sheet; what gas torque, stiffness and damping follow from; sheets are numbered."""
    gas = ENGINE.split("gas_torque = ")[1].split("\n")[0]
    text = ENGINE.replace(f"gas_torque = {gas}\n", "").replace("MORE", "").replace("OWN", INDICATED)
    line = tn.loads(text.replace('speed_range = ["700 rpm", "1000 rpm"]', 'speed_range = ["900 rpm", "901 rpm"]'))
    made = tn.submission(line)
    ways = [str(one) for one in made.contents.misfiring]
    assert ways == [f"cylinder {n} of main.engine, {how}" for how in ("misfiring", "cut out") for n in (1, 2, 3, 4)]
    engine = line.as_stated.elements[0]
    torque = 0.03 * (30 * np.pi) ** 2 / 4
    rows = {row[1]: row for row in excitations(made.contents).rows if row[0].startswith("main.engine")}
    for one in engine.of_one_cylinder:
        ends = np.array(one.amplitudes) * np.exp(1j * np.array(one.phases))
        there = ends[0] + (torque - one.torques[0]) / (one.torques[1] - one.torques[0]) * (ends[1] - ends[0])
        size, phase = (float(text.replace("−", "-")) for text in rows[f"order {one.order:g}"][4:])
        assert size == pytest.approx(abs(there), rel=6e-4) and phase == pytest.approx(
            np.angle(there, deg=True), abs=0.06
        )
    over = sorted({check.name for one in made.contents.misfiring for check in one.checks if check.exceeded})
    first = made.html.split('id="first"')[1].split("</section>")[0]
    assert (
        over and "With one cylinder out of work exceeded (section 6): " in first and all(name in first for name in over)
    )
    assert "the ideal cycle of mean indicated pressure 2, 20 bar; no table" in made.html
    assert "counter(page)" in made.html
    torques = made.html.split('id="malfunction"')[1]
    assert "one misfiring [N" in torques and "one cut out [N" in torques


def test_value_and_limit_stand_in_one_unit_and_a_barred_range_once() -> None:
    """7.5 kN m beside 12 kN m, not 7500 N m; two checks that bar the same speeds share a line."""
    contents = made().contents
    for table, at in ((misfire_checks(contents), 4), (rules(contents), 4)):
        pairs = [(row[at], row[at + 1]) for row in table.rows if str(row[at])[:1].isdigit()]
        assert pairs
        for value, limit in pairs:
            assert str(value).partition(" ")[2] == str(limit).partition(" ")[2]
    first, *others = contents.seen.assessment.checks
    twice = [replace(first, name=name, barred=((50.0, 60.0),), decides=True) for name in ("one", "two")]
    judged = replace(contents.seen.assessment, checks=(*twice, replace(first, name="three", barred=((70.0, 71.0),))))
    found = barred(replace(contents, seen=replace(contents.seen, assessment=judged))).rows
    assert [row[1] for row in found if row[2] == FIRING] == ["one, two", "three"]


def test_words_in_a_style_sheet_end_nothing() -> None:
    assert in_css('a"}</style>') == r"a\000022\00007d\00003c\00002fstyle\00003e"


@pytest.mark.parametrize("searches", [0, 1, 3])
def test_what_time_did_not_allow_is_said_and_not_denied(monkeypatch: pytest.MonkeyPatch, searches: int) -> None:
    """The time ends before anything, after the torques, after two cylinders: none of the rest is called absent."""
    seen = made().contents.seen
    with tn.time_limit() as limit:
        if not searches:
            limit.stop()
        shares: list[float] = []

        def count(share: float) -> None:
            shares.append(share)
            if len(shares) == searches:
                limit.stop()

        page = tn.submission(seen, progress=count)
    contents = page.contents
    assert len(contents.misfiring) == max(searches - 1, 0)
    assert len(contents.misfiring) + len(contents.unsearched) == 4
    assert shares == sorted(shares) and shares[-1] == 1.0
    for one, whole in zip(contents.misfiring, made().contents.misfiring, strict=False):
        assert [top.value for top in one.vibratory] == [top.value for top in whole.vibratory]
    assert contents.complete is bool(searches)
    assert bool(contents.shafts) is bool(searches)
    for name in contents.unsearched:
        assert any(name in sentence and "not computed" in sentence for sentence in contents.left_out) or not searches
        assert page.html.count(name) == 1  # named once, where the reason stands
    assert f"Not computed: {len(contents.unsearched)} of 4 cases with a cylinder out of work" in page.html
    assert "not all judged, see section 6" in page.html and "not all computed, see section 10" in page.html
    assert "has no cylinders" not in page.html and "Nothing becomes warm" not in page.html
    assert ("Every torque is searched over the whole range" in page.html) is bool(searches)


def test_a_printed_holzer_table_adds_up() -> None:
    """θ, Σ J ω² θ and twists by hand from what is printed, mass by mass, to the four digits there (Holzer 1921)."""
    contents = made().contents
    (first, *_), found = contents.holzer, contents.seen.natural_frequencies
    on_masses, in_springs = holzer_table(contents, first)
    assert on_masses.heads == ("no.", "mass", "J [kg m²]", "amplitude", "J ω² θ [N m]")
    assert in_springs.heads == ("spring", "masses", "k [kN m/rad]", "torque [N m]", "twist [mrad]", "node [%]")

    def printed(text: object) -> float:
        return float(str(text).replace("−", "-"))

    square = float(found.elastic[0]) ** 2
    inertia, amplitude, inertial = (np.array([printed(row[i]) for row in on_masses.rows]) for i in (2, 3, 4))
    stiffness, torque, twist = (np.array([printed(row[i]) for row in in_springs.rows]) for i in (2, 3, 4))
    close = {"rtol": 2e-3, "atol": 2e-3 * float(np.abs(inertial).max())}
    np.testing.assert_allclose(inertia * square * amplitude * 1e-3, inertial, **close)
    np.testing.assert_allclose(np.cumsum(inertial)[:-1], -torque, **close)
    np.testing.assert_allclose(torque / stiffness, twist, rtol=2e-3)
    np.testing.assert_allclose(np.diff(amplitude), twist, rtol=2e-3, atol=2e-3)
    assert abs(inertial.sum()) < 2e-3 * np.abs(inertial).max()
    assert [row[1] for row in in_springs.rows] == ["1 – 2", "2 – 3"]
    nodes = [printed(row[5]) for row in in_springs.rows if row[5]]
    (at,) = np.flatnonzero(amplitude[1:] * amplitude[:-1] < 0)
    assert nodes == [round(100 * abs(amplitude[at] / (amplitude[at + 1] - amplitude[at])))]


def test_of_cylinders_that_do_the_same_the_first_is_named() -> None:
    """Rounding would name any: ``misfire`` and the sheets name the same one."""
    contents = made().contents
    table = misfires(contents)
    named = {row[table.heads.index("misfiring, worst")] for row in table.rows}
    assert named == {"cylinder 1 of engine"}
    found = tn.misfire(contents.seen.line)
    assert found.worst == ("engine", 1)
    for s, spring in enumerate(found.springs):
        sheets = max(case.vibratory[s].value for case in contents.misfiring if case.how == "misfiring")
        assert found.vibratory_torque[:, s].max() == pytest.approx(sheets, rel=1e-5), spring


def test_a_tall_sketch_shows_numbers_alone_on_the_first_sheet() -> None:
    """Its names would be too small to read there; they stand in section 1."""
    named, alone = (driveline_sketch.draw(made().contents.seen.line, named=named) for named in (True, False))
    words = [[text.get_text() for text in one.axes[0].texts] for one in (named, alone)]
    assert "1 engine" in words[0] and "1 engine" not in words[1] and "1" in words[1]
    assert alone.get_size_inches()[1] < named.get_size_inches()[1]


ONE_SPEED = """
format = 1

[[element]]
type = "Motor"
name = "motor"
inertia = "0.45 kg*m^2"
breakdown_torque = "720 N*m"
breakdown_slip = 0.12
synchronous_speed = "1500 rpm"
excitation = [{ order = 2, amplitude = "4 N*m" }]

[[element]]
type = "Shaft"
name = "coupling"
stiffness = "STIFFNESS kN*m/rad"
damping = "6 N*m*s/rad"

[[element]]
type = "Pump"
name = "pump"
inertia = "0.25 kg*m^2"
rated_power = "30 kW"
rated_speed = "1460 rpm"
"""


@pytest.mark.parametrize(
    ("stiffness", "said"),
    [("30", "No excitation meets a mode from 77.2 rad/s to 185.3 rad/s"), ("18", "Critical speeds from")],
)
def test_a_line_that_runs_at_one_speed_has_critical_speeds_about_it(tmp_path, stiffness: str, said: str) -> None:
    """Order 2 of the second meets its mode, which the reduced inertia gives by hand, a tenth above the speed."""
    path = tmp_path / "pump.toml"
    path.write_text(ONE_SPEED.replace("STIFFNESS", stiffness))
    page = tn.submission(tn.load(path)).html
    assert said in page and "The line runs at one speed" in page and "must be two or more" not in page
    result = CliRunner().invoke(app, ["campbell-diagram", str(path), "--json", "-o", str(tmp_path / "modes.png")])
    assert result.exit_code == 0, result.output
    crossings = tn.campbell_diagram(tn.load(path), np.linspace(77.2, 185.3, 101)).crossings
    stated = np.sqrt(float(stiffness) * 1e3 * (1 / 0.45 + 1 / 0.25)) / 2
    assert [one.speed == pytest.approx(stated, rel=0.02) for one in crossings] == [True] * int(stated < 185.3)


def test_load_cases_of_a_line_that_runs_at_one_speed_have_speeds_of_their_own() -> None:
    """Where the motor's curve meets the pump's square, by a root of the test's own; the torque that swings most and the
    largest one are of two cases, and each is named."""
    cases = "".join(
        f'[[operation.load_case]]\nname = "{name}"\nfactors = {{ "pump" = {share} }}\n'
        for name, share in (("in parallel", 1.15), ("closed valve", 0.4))
    )
    made = tn.submission(tn.loads(ONE_SPEED.replace("STIFFNESS", "30") + cases))
    contents, synchronous, rated = made.contents, tn.rpm(1500), tn.rpm(1460)

    def left(speed: float, share: float) -> float:
        slip = (synchronous - speed) / synchronous
        return 720 * 2 * slip * 0.12 / (slip**2 + 0.12**2) - share * 30e3 / rated * (speed / rated) ** 2

    own = [brentq(left, 0.95 * synchronous, 0.9999 * synchronous, args=(share,)) for share in (1.0, 1.15, 0.4)]
    assert [one.speed for one in contents.powers] == pytest.approx(own, rel=1e-6)
    stated, slow, fast = (one / tn.rpm(1) for one in own)
    said = dict(particulars(contents).rows)["running range"]
    assert said == f"{stated:.6g} rpm, load cases {slow:.4g} rpm to {fast:.4g} rpm"
    (coupling,) = shafts(contents).rows
    assert coupling[-1] == "closed valve; peak: in parallel"
    assert "judged from" not in made.html and "at one speed" in made.html


def own_swing(speed: float, silent: int | None) -> float:
    """Half of peak to peak in the coupling of ``TEXT`` [N m], by dense matrices and a fine cycle."""
    stiffness = np.array([21e3, 80e9 * np.pi * 0.09**4 / 32 / 1.2])
    rows = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    k, c = (rows.T @ np.diag(one) @ rows for one in (stiffness, [20.0, 5.0]))
    c[2, 2] += 2.0
    angle = np.linspace(0.0, 4 * np.pi, 4000, endpoint=False)
    wave = np.zeros_like(angle)
    for order, size, phase in ((0.5, 120.0, 20.0), (1.0, 160.0, 50.0), (1.5, 170.0, 0.0), (2.0, 150.0, 0.0)):
        firing = [at for number, at in enumerate((0.0, 540.0, 180.0, 360.0), start=1) if number != silent]
        torque = sum(size * np.exp(1j * np.deg2rad(phase - order * at)) for at in firing)
        nu = order * speed
        swing = np.linalg.solve(k + 1j * nu * c - nu**2 * np.diag([3.0, 0.4, 5.0]), [torque, 0.0, 0.0])
        wave += np.real((stiffness[0] + 20j * nu) * (rows[0] @ swing) * np.exp(1j * order * angle))
    return float(np.ptp(wave) / 2)


@pytest.mark.parametrize("asked", ["", "misfiring = true\n"])
def test_a_range_that_only_a_misfire_bars_says_so(asked: str) -> None:
    """Ends by bisection on dense matrices; also where the verdict is about firing cylinders alone. Only what has a
    limit for transients that holds may be passed."""
    speeds = np.linspace(tn.rpm(600), tn.rpm(1800), 601)
    normal = np.array([own_swing(speed, None) for speed in speeds])
    silent = np.array([[own_swing(speed, number) for speed in speeds] for number in (1, 2, 3, 4)])
    limit = float(0.5 * normal.max() + 0.5 * silent.max()) if silent.max() > 1.1 * normal.max() else np.nan
    assert normal.max() < limit < silent.max()
    over = []
    for number, swing in enumerate(silent, start=1):
        changes = np.flatnonzero(np.diff(swing > limit))
        ends = [brentq(lambda w, n=number: own_swing(w, n) - limit, *speeds[i : i + 2], xtol=1e-10) for i in changes]
        ends = [*([speeds[0]] if swing[0] > limit else []), *ends, *([speeds[-1]] if swing[-1] > limit else [])]
        over += list(zip(ends[::2], ends[1::2], strict=True))
    wanted: list[list[float]] = []
    for low, high in sorted(over):
        if wanted and low <= wanted[-1][1]:
            wanted[-1][1] = max(high, wanted[-1][1])
        else:
            wanted.append([low, high])
    text = TEXT.replace('[[limit]]\nof = "shaft"\nvibratory_torque = "6 kN*m"', "LIMIT").replace(
        'speed = "1500 rpm"\n', f'speed = "1500 rpm"\n{asked}'
    )
    for transient, passing in (("", NONE), (f"transient_vibratory_torque = {10 * silent.max()}", HOLDS)):
        stated = f'[[limit]]\nof = "coupling"\nvibratory_torque = {limit}\n{transient}\n'
        contents = tn.submission(tn.loads(text.replace("LIMIT", stated))).contents
        found = barred_ranges(contents)
        assert {(one.state, one.passing, one.names) for one in found} == {
            (SILENT, passing, ("vibratory torque of coupling",))
        }
        np.testing.assert_allclose([(one.low, one.high) for one in found], wanted, rtol=1e-6)
        assert {row[2:] for row in barred(contents).rows} == {("one cylinder out of work", passing)}
        assert (contents.normal is None) == (not asked)
        one = next(check for check in contents.firing_checks if check.name == "vibratory torque of coupling")
        assert one.satisfied and one.value == pytest.approx(normal.max(), rel=1e-4)
        assert bool(firing_checks(contents).rows) == bool(asked)


def test_drives_and_loads_stand_there_with_their_slopes() -> None:
    """Torque and slope at the operating speed against differences of the formulas, behind gears of 2.5."""
    speed, own = tn.rpm(1450), tn.rpm(580)
    motor = tn.Motor(
        name="motor", inertia=1.2, breakdown_torque=1100, breakdown_slip=0.09, synchronous_speed="1500 rpm",
        pole_pairs=2, drive_share=1,
    )  # fmt: skip
    propeller = tn.Propeller(name="screw", inertia=9.0, rated_power="60 kW", rated_speed="600 rpm", damping_factor=2.6)
    parts = [
        motor, tn.Shaft(name="shaft", stiffness=2e4, damping=5.0), tn.Disk(name="wheel", inertia=0.2),
        tn.Ratio(ratio=-2.5), tn.Disk(name="brake", inertia=0.2, load_torque=12.0, viscous_load=0.5), propeller,
    ]  # fmt: skip
    line = tn.Driveline(parts, operation=tn.Operation(speed=speed, speed_range=(100.0, 157.0), speed_unit="rpm"))
    table = loads(tn.submission(line).contents)
    assert table.heads[-1] == "lags above"
    found = {row[0]: row for row in table.rows}

    def screw(w: float) -> float:
        return 60e3 / tn.rpm(600) ** 3 * w**2

    carried = (screw(own) + 12.0 + 0.5 * own) / 2.5

    def kloss(slip: float) -> float:
        return 2 * 1100 * slip * 0.09 / (slip**2 + 0.09**2)

    slip = brentq(lambda s: kloss(s) - carried, 0.0, 0.09, xtol=1e-15)
    steep = (kloss(slip + 1e-6) - kloss(slip - 1e-6)) / 2e-6 / tn.rpm(1500)
    lag = 0.09 * 2 * 25.0  # of its supply of 50 Hz
    for name, torque, slope in (
        ("motor", -carried, steep), ("screw", screw(own), 2.6 * screw(own) / own), ("brake", 12.0 + 0.5 * own, 0.5)
    ):  # fmt: skip
        at, by = (float(str(one).replace("−", "-")) for one in found[name][2:4])
        assert at == pytest.approx(torque, rel=1e-3) and by == pytest.approx(slope, rel=1e-3), name
    assert found["motor"][4] == f"{lag:.4g} Hz" and found["screw"][4] == "–"
    assert "Kloss, 1100 N m at the slip 0.09, 1500 rpm without slip" in str(found["motor"][1])
    assert "60 kW at 600 rpm" in str(found["screw"][1]) and "2.6 times" in str(found["screw"][1])
