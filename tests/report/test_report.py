"""The report: every section, nothing fetched, the same numbers as the results."""

from __future__ import annotations

import hashlib
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.driveline.starter import starter
from trunnion.equations.coefficients import assemble
from trunnion.pictures.driveline_sketch import draw as draw_sketch
from trunnion.reporting.overview_findings import response_findings
from trunnion.reporting.report import Report
from trunnion.reporting.tables import TIED, checks, with_signs
from trunnion.reporting.under_load import loaded_motions
from trunnion.results.words import Words

TEXT = """
format = 1
name = "test line <& co>"
[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "3000 rpm"]
angle_range = ["0 deg", "40 deg"]
[[element]]
type = "ConstantSpeed"
name = "motor"
[[element]]
type = "Shaft"
name = "front shaft"
stiffness = "12 kN*m/rad"
damping = "1 N*m*s/rad"
[[element]]
type = "Disk"
name = "fork"
inertia = "0.2 kg*m^2"
[[element]]
type = "HookeJoint"
angle = "2 deg"
[[element]]
type = "Shaft"
name = "tube"
outer_diameter = "76 mm"
inner_diameter = "71 mm"
length = "1.6 m"
shear_modulus = "79.3 GPa"
density = "7850 kg/m^3"
[[element]]
type = "Disk"
name = "pump"
inertia = "0.4 kg*m^2"
load_torque = "100 N*m"
"""
SECTIONS = (
    "verdict", "findings", "campbell", "driveline", "modes", "irregularity", "torque", "stability", "under-load",
    "limit", "bending", "provenance",
)  # fmt: skip


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "line.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def mild() -> tn.Driveline:
    """The line, at an angle that exceeds nothing, so that nothing need be sought that helps."""
    return tn.loads(TEXT)


@pytest.fixture(scope="module")
def made(file: Path) -> Report:
    return tn.report(tn.load(file), points=(60, 40), source=file)


@pytest.fixture(scope="module")
def loaded(mild: tn.Driveline) -> Report:
    """Of the mild line, with speeds in Hz."""
    return tn.report(mild, unit="Hz", points=(12, 9))


@pytest.fixture(scope="module")
def unloaded(mild: tn.Driveline) -> Report:
    """Of the mild line without its load, with speeds in rad/s."""
    return tn.report(mild.replace("pump", load_torque=None), unit="rad/s", points=(12, 9))


class Page(HTMLParser):
    """Tags with attributes, and the text of the page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data + " "


def test_sections(made: Report) -> None:
    ids = [attrs["id"] for tag, attrs in Page(made.html).tags if tag == "section"]
    assert ids == list(SECTIONS)


@pytest.mark.slow
def test_a_line_that_exceeds_its_checks() -> None:
    """What helps is sought."""
    steep = tn.report(tn.loads(TEXT.replace('angle = "2 deg"', 'angle = "20 deg"')), points=(12, 9))
    test_sections(steep)
    test_findings_come_gravest_first(steep)
    test_pictures(steep)
    assert steep.contents.helped is not None


def test_fetches_nothing(made: Report) -> None:
    page = Page(made.html)
    assert not {"script", "link", "iframe", "object", "base", "form"} & {tag for tag, _ in page.tags}
    for _, attrs in page.tags:
        for key in ("src", "href", "srcset", "action", "poster"):
            assert attrs.get(key) is None or str(attrs[key]).startswith("data:image/")
        assert "url(" not in str(attrs.get("style"))
    assert not re.search(r"https?://|url\(|@import", made.html)
    assert len(made.html.encode()) < 5e6


def test_pictures(made: Report) -> None:
    images = [attrs for tag, attrs in Page(made.html).tags if tag == "img"]
    assert len(images) == 10
    assert all(str(a["src"]).startswith("data:image/svg+xml;base64,") and a["alt"] for a in images)


def test_names_are_escaped(made: Report) -> None:
    assert "<& co>" not in made.html and "test line &lt;&amp; co&gt;" in made.html


def test_numbers_are_those_of_the_results(made: Report) -> None:
    text = Page(made.html).text
    line = made.contents.overview.line
    for hertz in tn.natural_frequencies(line).hertz:
        assert f"{hertz:.4g}" in text
    beta = np.deg2rad(2)
    assert f"{100 * np.tan(beta) * np.sin(beta):.4g}" in text
    (tube,) = tn.bending_speeds(line)
    assert f"{tube.critical_speed * 30 / np.pi:.4g}" in text
    response = tn.stability(line).response
    assert response is not None and f"{response.torque_amplitude[0]:.4g}" in text


def test_findings_come_gravest_first(made: Report) -> None:
    gravities = [f.gravity for f in made.contents.findings]
    assert gravities == sorted(gravities)
    text = Page(made.html).text
    places = [text.index(with_signs(f.sentence)) for f in made.contents.findings]
    assert places == sorted(places)


def test_limit_angle_agrees_with_stability(made: Report) -> None:
    limit = made.contents.limit
    assert limit is not None and limit.critical_speed is not None
    line = made.contents.overview.line
    for offset, verdict in ((-0.003, "STABLE"), (0.003, "UNSTABLE")):
        bent = line.replace("HookeJoint 1", angle=limit.smallest + offset)
        assert tn.stability(bent, limit.critical_speed).verdict.name == verdict


def test_provenance(made: Report, file: Path) -> None:
    text = Page(made.html).text
    assert hashlib.sha256(file.read_bytes()).hexdigest() in text
    assert tn.__version__ in text and "line.toml" in text and str(file.parent) not in made.html
    assert "Lateral vibration" in text and "outside this torsional model" in text


@pytest.mark.parametrize(
    ("of", "shown"),
    [
        pytest.param("loaded", "10 to 50 Hz", marks=pytest.mark.slow),
        ("unloaded", "62.83 to 314.2 rad/s"),
    ],
)
@pytest.mark.slow
def test_speed_unit(of: str, shown: str, request: pytest.FixtureRequest) -> None:
    text = Page(request.getfixturevalue(of).html).text
    assert shown in text and "rpm" not in text


def test_print_style(made: Report) -> None:
    assert "size: A4" in made.html and "@media print" in made.html


def test_saves_whole(made: Report, tmp_path: Path) -> None:
    path = made.save(tmp_path / "report.html")
    assert path.read_text(encoding="utf-8") == made.html
    with pytest.raises(tn.InputError, match="folder"):
        made.save(tmp_path / "none" / "report.html")


def test_line_without_joints_and_with_a_branch() -> None:
    line = tn.Driveline([
        tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1, name="hub"),
        tn.Ratio(teeth_in=10, teeth_out=31), tn.Shaft(stiffness=2e4), tn.Disk(inertia=1.0, name="left"),
        tn.Shaft(stiffness=2e4, after="hub"), tn.Disk(inertia=2.0, name="right"),
    ])  # fmt: skip
    page = Page(tn.report(line, speed=50.0).html)
    ids = [attrs["id"] for tag, attrs in page.tags if tag == "section"]
    assert "torque" not in ids and "limit" not in ids and {"driveline", "modes", "bending"} <= set(ids)


@pytest.mark.slow
def test_line_too_slow_for_a_chart(mild: tn.Driveline) -> None:
    """Far below every resonance there is no chart, but the forced torques are still given."""
    slow = tn.Driveline(mild.elements, operation=tn.Operation(speed="1 rpm", speed_range=["0.2 rpm", "2 rpm"]))
    made = tn.report(slow)
    assert made.contents.overview.chart is None and made.contents.sweep is not None
    assert "no chart" in Page(made.html).text


@pytest.mark.slow
def test_motion_under_load_is_that_of_the_function(mild: tn.Driveline, loaded: Report, unloaded: Report) -> None:
    """The section shows the true motion's growth rate and torque; a line without load has no such section."""
    (motion,) = loaded.contents.loaded
    expected = tn.periodic_response(mild)
    assert motion.case == "as described"
    assert motion.response.growth_rate == pytest.approx(expected.growth_rate, rel=1e-9)
    section = loaded.html.split('id="under-load"')[1].split("</section>")[0]
    assert f"{float(f'{expected.torque_peak_to_peak.max():.4g}'):.10g}" in section
    assert section.count("<img") == 2
    assert 'id="under-load"' not in unloaded.html and unloaded.contents.loaded == ()


def test_reasons_without_a_margin_keep_their_commas() -> None:
    """What is not judged has no margin to take out of its reason."""
    line = tn.loads(starter("two-shaft"))
    rows = {row[1]: row for row in checks(tn.assess(line)).rows}
    assert rows["torque without limit"][4] == "Shaft 1, Shaft 2: no limit of torque or stress is stated"
    assert rows["uniformity"][2] == "1540 % beyond".replace(" ", TIED)
    assert rows["uniformity"][4].endswith("as one joint of 12°")


def test_names_of_a_row_end_above_its_branch():
    trunk = [tn.ConstantSpeed()]
    for number in range(1, 6):
        trunk += [tn.Shaft(stiffness=1e4, name=f"a long name of shaft {number}"), tn.Disk(inertia=1.0)]
    branch = [tn.HookeJoint(angle=0.1, name="front", after="Disk 2"), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)]
    figure = draw_sketch(tn.Driveline([*trunk, *branch]))
    figure.canvas.draw()
    texts = {t.get_text(): t.get_window_extent() for t in figure.axes[0].texts}
    bend = next(box for text, box in texts.items() if text.startswith("β"))
    names = [box for text, box in texts.items() if "shaft" in text and box.x1 > bend.x0]
    assert len(names) >= 3 and all(box.y0 > bend.y1 for box in names)


def test_load_cases_without_a_motion_for_one_reason_are_told_together() -> None:
    mill = tn.loads(starter("rolling-mill"))
    assert mill.operation is not None
    cases = ", ".join(["as described", *(case.name for case in mill.operation.load_cases)])
    (told,) = loaded_motions(mill, None)[1]
    assert told.startswith(f"Motion under load ({cases}): strip: closes a loop")


def test_what_joints_force_is_told_as_a_part_where_something_else_excites() -> None:
    mill = tn.loads(starter("rolling-mill"))
    alone = mill.replace("upper pinion", excitation=())
    for line, part in ((mill, "their part of the torque"), (alone, "the torque")):
        (told,) = response_findings(assemble(line), tn.resonance_speeds(line), (6.3, 44.0), Words("rpm"))
        assert f": under the loads as described {part} of motor shaft rises to" in told.sentence


def test_crossings_that_are_left_out_are_said() -> None:
    """Those far from the operating speed; here two modes meet forty orders each, and the line turns at the top."""
    shaken = [{"order": k / 2, "amplitude": 1.0} for k in range(1, 41)]
    parts = [
        tn.Disk(name="engine", inertia=1.0, drive_share=1.0, excitation=shaken),
        tn.Shaft(stiffness=4e5, damping=20.0),
        tn.Disk(inertia=1.0),
        tn.Shaft(stiffness=4e5, damping=20.0),
        tn.Disk(inertia=1.0, viscous_load=0.1),
    ]
    line = tn.Driveline(parts, operation=tn.Operation(speed=290.0, speed_range=[60.0, 300.0]))
    text = tn.report(line).html
    every = tn.campbell_diagram(line, np.linspace(60.0, 300.0, 201)).crossings
    assert len(every) > 30
    assert f"; the 30 nearest to the operating speed of {len(every)}, and trunnion campbell-diagram has all" in text
    table = text.split("Crossings in the speed range")[1].split("</table>")[0]
    last = max(one.speed for one in every) * 30 / np.pi
    assert f"{last:.4g}" in table and f"{min(one.speed for one in every) * 30 / np.pi:.4g}" not in table
    assert "the prescribed speed" not in text  # the line has none
