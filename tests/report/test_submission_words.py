"""What a reviewer recomputes from the printed tables alone, and sentences that are true of the line they stand on."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.cli import output
from trunnion.modes.mass_elastic import holzer, masses, springs
from trunnion.pictures.looks import curve, look
from trunnion.pictures.orders import same_looks
from trunnion.pictures.picture import Axis, Line, single
from trunnion.reporting.page import formula, with_units
from trunnion.reporting.submission import Submission
from trunnion.reporting.submission_tables import excitations
from trunnion.reporting.tables import Table, four
from trunnion.results.counts import few
from trunnion.results.words import Words

EXAMPLES = Path(__file__).parents[2] / "examples"
LINES = ["passenger-car", "two-stroke-ship", "six-cylinder-ship", "harbour-tug", "truck"]


TWO_DISKS = """
format = 1
[operation]
speed = "900 rpm"
[[limit]]
of = "coupling"
vibratory_torque = "LIMIT"
FACTORS
[[element]]
type = "Disk"
name = "engine"
inertia = "2 kg*m^2"
drive_share = 1
excitation = [{ order = 2, amplitude = "1 kN*m" }]
[[element]]
type = "Coupling"
name = "coupling"
stiffness = "20 kN*m/rad"
relative_damping = 0.8
loss_factor_frequency = "10 Hz"
maximum_torque = "5 kN*m"
[[element]]
type = "Disk"
name = "load"
inertia = "3 kg*m^2"
load_torque = "200 N*m"
"""


@cache
def found(name: str) -> tn.NaturalFrequencies:
    return tn.natural_frequencies(tn.load(EXAMPLES / f"{name}.toml"))


@cache
def handed_in() -> Submission:
    """A car at one speed, with a differential, a rigid crank, loss factors at a frequency and load cases."""
    line = tn.load(EXAMPLES / "passenger-car.toml")
    at_one = line.operation.model_copy(update={"speed_range": (262.0, 263.0), "load_cases": ()})
    return tn.submission(line.but(operation=at_one))


def independent(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """P (mass, free), inertias and K of the tables: masses by name, springs between them at the speed of the second."""
    rows = masses(found(name).assembly)
    free = [row.name for row in rows if not row.sum_of]
    turn = np.array([[dict(row.sum_of or ((row.name, 1.0),)).get(one, 0.0) for one in free] for row in rows])
    of = {row.name: (turn[i], row.speed_ratio) for i, row in enumerate(rows)}
    drive = (np.zeros(len(free)), 1.0)
    stiffness = np.zeros((len(free), len(free)))
    for spring in springs(found(name).assembly):
        (ahead, fast), (behind, slow) = (of.get(end, drive) for end in spring.between)
        twist = behind - ahead * slow / fast
        stiffness += spring.stiffness * np.outer(twist, twist)
    return turn, np.array([row.inertia for row in rows]), stiffness


@pytest.mark.parametrize("name", LINES)
def test_the_printed_masses_and_springs_have_the_printed_frequencies(name: str) -> None:
    """Of a differential too, whose second leg turns by a sum and is tied to no crankshaft."""
    turn, inertia, stiffness = independent(name)
    squares = np.linalg.eigvals(np.linalg.solve(turn.T @ np.diag(inertia) @ turn, stiffness)).real
    own = np.sqrt(np.sort(np.abs(squares)))
    assert own == pytest.approx(found(name).undamped_frequency, rel=1e-6, abs=1e-4 * own[-1])
    for mode in range(1 + found(name).still, len(found(name).mode) + 1):
        table = holzer(found(name), mode)
        whole = turn.T @ table.inertia_torque
        assert whole == pytest.approx(found(name).assembly.topology.elongations.T @ table.torque, abs=1e-9 * max(
            np.abs(table.torque).max(), np.abs(whole).max()
        ))  # fmt: skip


def test_a_leg_of_a_differential_stands_in_the_table_with_what_it_turns_by() -> None:
    rows = {row.name: row for row in masses(found("passenger-car").assembly)}
    left = rows["left side gear"]
    assert left.inertia == pytest.approx(0.003) and rows["right side gear"].inertia == pytest.approx(0.003)
    assert dict(left.sum_of) == pytest.approx({"pinion": 2 * 11 / 37, "right side gear": -1.0})
    between = {row.name: row.between for row in springs(found("passenger-car").assembly)}
    assert between["half shaft left"] == ("left side gear", "wheel left")
    assert "left side gear turns by 0.5946 × pinion − 1 × right side gear" in handed_in().html


def test_a_loss_factor_is_printed_as_it_was_stated() -> None:
    spring = next(row for row in springs(found("two-stroke-ship").assembly) if row.name == "intermediate shaft")
    assert (spring.stated_loss, spring.loss_frequency) == pytest.approx((0.015, 12 * np.pi))
    assert spring.damping == pytest.approx(0.015 * spring.stiffness / (12 * np.pi))
    page = handed_in().html
    assert "0.02 at 50\u00a0Hz" in page and "0.01 at 50\u00a0Hz" in page
    assert "a loss factor stated at a frequency as the viscous damping that has it there" in page


def test_every_order_of_a_cylinder_has_its_size_though_the_cylinders_cancel() -> None:
    rows = {row[1]: row for row in excitations(handed_in().contents).rows if row[0] == "engine, each cylinder"}
    at = [float(rows[order][4]) for order in ("order 0.5", "order 1", "order 1.5", "order 2")]
    assert at == pytest.approx([140 + 0.75 * 10, 160, 140, 110], rel=5e-4)  # tables at 2500 of 1000 to 3000 rpm


def test_only_what_the_line_has_is_said_of_it() -> None:
    page = handed_in().html
    assert "none, taken as rigid" in page and "misfiring, with no gas torque left" in page
    for words in ("all load cases", "every load case", "meshes stay in contact", "bore [mm]", "S_t", "C_K"):
        assert words not in page
    assert "constant-velocity joint" in page and "IdealJoint" not in page
    assert not re.search(r"\d[ed][-−+]\d\d[ <]", page), "a number as programs print it"


def test_ranges_to_bar_are_rounded_outward() -> None:
    rpm = np.pi / 30
    assert Words("rpm").barred([(62.0849 * rpm, 73.0766 * rpm)]) == "62.08 rpm to 73.08 rpm"
    assert Words("rpm").barred([(300 * rpm, 700 * rpm), (1071.96 * rpm, 1295.81 * rpm)]) == (
        "300 rpm to 700 rpm and 1071 rpm to 1296 rpm"
    )


def test_indices_are_set_low_and_names_with_commas_told_apart() -> None:
    assert formula("±τ ≤ 1.7 τ_C/√C_K, T_Kmax") == "±τ ≤ 1.7 τ<sub>C</sub>/√C<sub>K</sub>, T<sub>Kmax</sub>"
    assert few(["a", "b"]) == "a, b" and few(["a, passing", "b"]) == "a, passing; b"


def test_small_numbers_read_as_powers_of_ten_and_stand_in_columns_of_numbers() -> None:
    assert [four(v) for v in (-2.399e-5, 0.5, 1.2e-11)] == ["−2.399·10⁻⁵", "0.5", "1.2·10⁻¹¹"]
    assert Table.of([{"a": 5.983e-5}, {"a": 2.0}]).numeric == (True,)


def test_a_table_of_the_command_line_has_a_dash_for_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    output.table([{"mode": 1, "frequency [Hz]": float("nan"), "said": None}])
    assert "nan" not in capsys.readouterr().out


def test_an_order_looks_the_same_in_every_picture() -> None:
    """Whatever other orders a picture shows; what is no order keeps its look."""
    at = np.linspace(1.0, 2.0, 3)
    drawn = [("order 3", "order 4"), ("order 1", "order 4", "order 6"), ("order 6", "order 3")]
    axis = Axis("torque", "N m")
    before = [
        single(axis, axis, [Line(at, at, "sum", "all"), *(Line(at, at, curve(i), one) for i, one in enumerate(names))])
        for names in drawn
    ]
    after = same_looks(before)
    roles = [{item.name: item.role for item in one.panel.items} for one in after]
    assert [set(one) for one in roles] == [{"all", *names} for names in drawn]
    looks = {name: {one[name] for one in roles if name in one} for name in {"all"}.union(*drawn)}
    assert all(len(one) == 1 for one in looks.values()) and looks["all"] == {"sum"}
    assert len(set.union(*looks.values())) == 5
    assert len({(look(role).colour, look(role).dash) for role in set.union(*looks.values())}) == 5


def test_progress_says_which_cylinder_is_searched() -> None:
    """In turn, each before its search."""
    engine = tn.Disk(
        inertia=0.2, excitation=[{"order": 1, "amplitude": 10.0}], firing_angles=["0 deg", "360 deg"], name="engine"
    )
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), engine])
    said: list[str] = []
    shares: list[float] = []
    tn.submission(line, speed=30.0, progress=shares.append, doing=said.append)
    assert said == [f"cylinder {number} of engine, misfiring" for number in (1, 2)]
    assert shares == [1 / 3, 2 / 3, 1.0]


def test_no_line_ends_between_a_number_and_its_unit() -> None:
    tied = with_units("12.85 kN m against 16 kN m at 780 rpm, 19.7 % free, mode 5 (61.08 Hz), Shaft 2 means 5 mm")
    assert tied == (
        "12.85\u00a0kN\u00a0m against 16\u00a0kN\u00a0m at 780\u00a0rpm, 19.7\u00a0% free, mode 5 (61.08\u00a0Hz), "
        "Shaft 2 means 5\u00a0mm"
    )


def test_a_result_says_exceeded_once() -> None:
    line = tn.loads(TWO_DISKS.replace("LIMIT", "100 N*m").replace("FACTORS", ""))
    made = tn.submission(line)
    assert made.contents.seen.assessment.check("vibratory torque of coupling").exceeded
    assert "exceeded, exceeded" not in made.html and "exceeded by" in made.html


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ("", "largest, mean included"),
        ("temperature_factor = 1.2", "largest, mean included, times the temperature factor"),
        (
            "temperature_factor = 1.2\nstarting_factor = 1.1",
            "largest, mean included, times the temperature and starting factor",
        ),
    ],
)
def test_service_factors_are_named_where_they_are_stated(factors: str, words: str) -> None:
    judged = tn.assess(tn.loads(TWO_DISKS.replace("LIMIT", "1 MN*m").replace("FACTORS", factors)))
    course = judged.check("maximum torque rating of coupling").course
    assert course is not None and course.says == words
