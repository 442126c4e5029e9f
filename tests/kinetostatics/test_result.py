"""The result as a value: how it prints, what it holds, what it writes, how it draws."""

import csv
import warnings

import lines
import numpy as np
import pytest
from matplotlib.text import Text

import trunnion as tn
from trunnion.pictures import kinetostatics as pictures
from trunnion.pictures.draw_matplotlib import draw
from trunnion.pictures.looks import STYLES, curve, look
from trunnion.response.kinetostatics.measures import extremes, parts

LINE = lines.row([12, 15], planes=[0, 20], load=150.0)


@pytest.fixture(scope="module")
def result():
    return tn.kinetostatics(
        LINE,
        speed=tn.rpm(900),
        rigid=False,
        supports=[("Shaft 1", -0.3, -0.1), ("Shaft 3", 0.1, 0.4)],
        lengths={"Shaft 2": "800 mm"},
    )


def test_prints_a_summary(result):
    text = str(result)
    assert repr(result) == f"<Kinetostatics: {text.splitlines()[0]}>"
    for words in (
        "720 points",
        "elastic shafts",
        "irregularity",
        "drive torque",
        "secondary couple",
        "twice per turn",
    ):
        assert words in text
    assert text.count("bearing Shaft") == 4
    assert max(len(row) for row in text.splitlines()) < 220


def test_torque_has_the_sign_of_the_twist(result):
    assert np.all(result.torque < 0)
    assert np.all(result.twist < 0)
    assert np.all(result.transmitted > 0)
    assert np.all(result.drive_torque > 0)


def test_dataset_has_names_and_units(result):
    data = result.data
    assert all(v.attrs["units"] and v.attrs["long_name"] for v in data.data_vars.values())
    assert list(data["shaft"].values) == ["Shaft 1", "Shaft 2", "Shaft 3"]
    assert data["secondary_couple"].dims == ("fork", "standing", "input_angle")
    assert data["support_force"].sel(bearing="Shaft 1 at -0.3 m").shape == (2, 720)
    assert tn.loads(data.attrs["driveline"]) == LINE
    assert data.attrs["irregularity"] == result.irregularity


def test_dataset_is_a_netcdf_file(result, tmp_path):
    import xarray as xr

    result.data.to_netcdf(tmp_path / "turn.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "turn.nc", engine="h5netcdf") as again:
        assert again["speed"].equals(result.data["speed"])


def test_csv(result, tmp_path):
    result.to_csv(tmp_path / "turn.csv")
    with (tmp_path / "turn.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert len(rows) == 721
    column = rows[0].index("Shaft 2 speed [rad/s]")
    assert [float(row[column]) for row in rows[1:]] == list(result.speed[1])
    assert rows[0][0] == "input angle [rad]"
    assert all("[" in name for name in rows[0])


def test_table_rows(result):
    rows = result.table()
    assert [row["shaft"] for row in rows] == list(result.shafts)
    assert rows[1]["fastest [rad/s]"] == pytest.approx(result.speed[1].max(), rel=1e-6)


def test_result_does_not_change_its_line():
    before = tn.dumps(LINE)
    tn.kinetostatics(LINE, rigid=False)
    assert tn.dumps(LINE) == before


def test_turns_behind_a_ratio():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5),
            tn.HookeJoint(angle=0.2),
            tn.Ratio(teeth_in=2, teeth_out=3),
            tn.Shaft(stiffness=1e5),
            tn.HookeJoint(angle=0.3),
            tn.Disk(inertia=1, load_torque=30.0),
        ]
    )
    short = tn.kinetostatics(line, turns=1)
    assert any("repeats after 3 turns" in f.sentence for f in short.findings)
    whole = tn.kinetostatics(line)
    assert not whole.findings and (whole.turns, whole.repeats_after) == (3, 3)
    assert whole.irregularity >= short.irregularity
    assert whole.power_residual < 1e-12
    assert whole.output_angle[-1] + whole.output_speed[-1] * 2 * np.pi / 720 == pytest.approx(4 * np.pi, abs=1e-3)


@pytest.mark.parametrize("ratio", [1.0, 10.0, -10.0, 7.5, 1000.0])
def test_a_joint_behind_a_gear_is_as_uneven_as_in_front_of_it(ratio):
    """U = tan β sin β wherever its plane lies, though a turn of the input is a part of a turn of the joint."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Ratio(ratio=ratio),
            tn.Disk(inertia=0.01, name="fork"),
            tn.HookeJoint(angle=tn.deg(10), plane=tn.deg(60), name="joint"),
            tn.Shaft(stiffness=1e4, damping=1.0),
            tn.Disk(inertia=0.1),
        ],
        operation=tn.Operation(speed_range=(100.0, 200.0)),
    )
    uneven = np.tan(tn.deg(10)) * np.sin(tn.deg(10))
    result = tn.kinetostatics(line)
    assert result.irregularity == pytest.approx(uneven, rel=1e-5)
    ends = [panel.items[0].x[-1] for panel in pictures.kinetostatics(result).panels]
    assert ends == [360.0 * result.turns] * 2
    if ratio == 10.0:
        judged = tn.assess(line).check("uniformity")
        assert judged.because.startswith("U = 0.03062 against")


def test_joints_that_never_meet_again_are_all_turned():
    """437 turns until both repeat are cut at 100: each joint has been everywhere, the two together nearly."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=tn.deg(5)),
            tn.Shaft(stiffness=1e4),
            tn.Ratio(teeth_in=43, teeth_out=19),
            tn.HookeJoint(angle=tn.deg(9)),
            tn.Ratio(teeth_in=13, teeth_out=23),
            tn.HookeJoint(angle=tn.deg(7)),
            tn.Disk(inertia=0.1),
        ]
    )
    result = tn.kinetostatics(line)
    fast = np.prod([1 / np.cos(tn.deg(b)) for b in (5, 9, 7)])
    slow = np.prod([np.cos(tn.deg(b)) for b in (5, 9, 7)])
    low, high = result.speed_ratio
    ratio = result.mean_ratio
    assert result.turns < result.repeats_after and any("repeats after" in one.sentence for one in result.findings)
    assert slow <= low / ratio < 1.0005 * slow and 0.9995 * fast < high / ratio <= fast


def test_no_torque_draws_no_empty_panels():
    assert len(pictures.kinetostatics(tn.kinetostatics(LINE)).panels) == 4
    unloaded = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.HookeJoint(angle=0.1), tn.Disk(inertia=1)])
    assert len(pictures.kinetostatics(tn.kinetostatics(unloaded)).panels) == 2


def test_negative_ratio_turns_the_load_with_it():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=0.3),
            tn.Ratio(ratio=-2.0),
            tn.Disk(inertia=1, load_torque=30.0),
        ]
    )
    result = tn.kinetostatics(line, friction=tn.CrossFriction(0.01, 0.01, 0.04))
    assert np.all(result.output_speed < 0)
    assert np.all(result.drive_torque > 0)
    assert result.power_residual < 1e-12
    assert result.irregularity == pytest.approx(np.tan(0.3) * np.sin(0.3), rel=1e-6)


def test_branches_share_the_drive():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Disk(inertia=1, name="hub"),
            tn.HookeJoint(angle=0.3),
            tn.Disk(inertia=1, load_torque=20.0),
            tn.HookeJoint(angle=0.2, after="hub"),
            tn.Disk(inertia=1, load_torque=30.0),
        ]
    )
    result = tn.kinetostatics(line)
    assert np.allclose(result.drive_torque, result.joint_torque_in.sum(axis=0))
    assert result.drive_torque.mean() == pytest.approx(50, rel=0.05)
    assert result.power_residual < 1e-12


def test_load_cases_and_outer_torque_are_the_same_thing():
    loaded = tn.kinetostatics(lines.row([20, 10], load=75.0))
    pulled = tn.kinetostatics(lines.row([20, 10]), output_torque="75 N*m")
    assert np.array_equal(loaded.drive_torque, pulled.drive_torque)


def test_extremes_are_finer_than_the_grid():
    x = np.arange(60) * 2 * np.pi / 60
    low, high = extremes(np.stack([np.sin(x + 0.03), 5 + 0.1 * np.cos(x - 0.05)]))
    assert np.allclose(high, [1, 5.1], atol=2e-6)
    assert np.allclose(low, [-1, 4.9], atol=2e-6)
    assert extremes(np.linspace(0, 1, 50))[1] == 1  # does not close: nothing beyond the last point


def test_parts_of_a_vector():
    x = np.arange(360) * 2 * np.pi / 360
    z = (3 - 2j) + 1.5 * np.exp(1j * (x + 1)) + 0.7 * np.exp(2j * x) + 0.2 * np.exp(-2j * x)
    split = parts(np.stack([z.real, z.imag]), x)
    assert split.steady == pytest.approx((3, -2))
    assert (split.once, split.twice, split.twice_back) == pytest.approx((1.5, 0.7, 0.2))
    assert split.two_per_turn == pytest.approx(0.9)


def texts(figure):
    return [t.get_text() for ax in figure.axes for t in (ax.xaxis.label, ax.yaxis.label, ax.title) if t.get_text()]


@pytest.mark.parametrize("described", [pictures.kinetostatics, pictures.polar, pictures.paper])
def test_figures(described, result):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = draw(described(result)).figure
        figure.canvas.draw()
    assert any("[" in text for text in texts(figure))
    box, size = figure.get_tightbbox(), figure.get_size_inches()
    assert box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < size[0] + 0.01 and box.y1 < size[1] + 0.01


@pytest.mark.parametrize("joint", [tn.HookeJoint(angle=0.3), tn.IdealJoint()])
def test_a_line_without_shafts_still_shows_itself(joint, tmp_path):
    result = tn.kinetostatics(tn.Driveline([tn.ConstantSpeed(), joint, tn.Disk(inertia=1)]))
    assert ("turns uniformly" if result.irregularity == 0 else "irregularity") in str(result)
    assert result.data["speed"].shape == (0, 720)
    result.to_csv(tmp_path / "turn.csv")
    for described in (pictures.kinetostatics, pictures.polar):
        draw(described(result)).figure.canvas.draw()


@pytest.mark.parametrize("what", ["line", "layout", "tripod"])
def test_sketches(what):
    subject = {
        "line": LINE,
        "layout": tn.layout([(0, 0, 0), (1, 0, 0.1), (2, 0.2, 0)], (1, 0.2, 0), (1, 0, 0.3), right_handed=False),
        "tripod": tn.Driveline(
            [tn.Shaft(stiffness=1), tn.TripodJoint(angle=0.2, radius=0.03, length=0.5), tn.Shaft(stiffness=1)]
        ),
    }[what]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = tn.sketch(subject, input_angle=0.3)
        figure.canvas.draw()
    shown = " ".join(t.get_text() for t in figure.findobj(Text))
    joints = {"line": 2, "layout": 3, "tripod": 1}[what]
    kind = "TripodJoint" if what == "tripod" else "HookeJoint"
    assert all(f"{kind} {k}" in shown for k in range(1, joints + 1)) and "Shaft 1" in shown


SIX = tn.layout(
    [(0, 0, 0), (1, 0.1, -0.15), (2, 0.1, -0.05), (3, 0.3, -0.3), (4, 0.2, -0.1), (5, 0.3, -0.35)],
    (1, 0, 0.1),
    (1, 0, 0),
)


@pytest.mark.parametrize("subject", [SIX, LINE, tn.load("examples/truck.toml")], ids=["six", "two", "truck"])
def test_labels_of_a_sketch_stay_apart(subject):
    figure = tn.sketch(subject)
    figure.canvas.draw()
    boxes = [t.get_window_extent() for t in figure.texts]
    assert len(boxes) >= 5
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
    assert all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= figure.bbox.x1 and b.y1 <= figure.bbox.y1 for b in boxes)


def test_curves_of_many_forks_differ():
    result = tn.kinetostatics(SIX.driveline(load_torque=100.0, fork_offsets=np.linspace(0.1, 1.3, 5)))
    drawn = result.plot().axes[3].get_lines()
    assert len(drawn) == 12
    assert len({(c.get_color(), str(c._unscaled_dash_pattern), c.get_marker()) for c in drawn}) == 12
    in_grey = [(look(curve(k)).dash, look(curve(k)).marker) for k in range(STYLES)]
    assert len(set(in_grey)) == STYLES >= 16


def test_irregularity_of_more_shafts_than_colours():
    line: list = [tn.ConstantSpeed()]
    for number in range(1, 9):
        line += [tn.HookeJoint(angle=0.02 * number), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1)]
    result = tn.kinetostatics(tn.Driveline(line))
    drawn = [c for c in draw(pictures.irregularity(result)).get_lines() if not c.get_label().startswith("_")]
    assert len(drawn) == 8
    assert len({(str(c._unscaled_dash_pattern), c.get_marker()) for c in drawn}) == 8


@pytest.mark.slow
def test_pictures_speak_the_unit_of_the_text(result):
    for described in (pictures.kinetostatics, pictures.polar):
        assert "input 94.2478 rad/s" in draw(described(result)).figure.get_suptitle()
        assert "input 900 rpm" in draw(described(result, unit="rpm")).figure.get_suptitle()


def test_title_breaks_in_front_of_a_quantity():
    title = draw(pictures.polar(tn.kinetostatics(tn.catalogue("bicardan-elastic")))).figure.get_suptitle()
    assert "input 1 rad/s" in title
    assert "\n" in title


def test_names_in_the_package():
    for name in (
        "kinetostatics",
        "CrossFriction",
        "phase_forks",
        "assembly_sensitivity",
        "check_limits",
        "layout",
        "combined_angle",
        "cardan_line",
        "sketch",
        "TripodJoint",
        "DoubleCardanJoint",
    ):
        assert getattr(tn, name) is not None
        assert name in tn.__all__


def test_joints_that_cancel_turn_uniformly_at_the_operating_speed():
    """Rounding is not an irregularity, and the speed is the one that the description operates at."""
    parts = [
        tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), tn.Shaft(stiffness=1e4), tn.HookeJoint(angle=0.2),
        tn.Disk(inertia=1.0, load_torque=5.0),
    ]  # fmt: skip
    result = tn.kinetostatics(tn.Driveline(parts, operation=tn.Operation(speed="900 rpm")))
    assert (result.irregularity, result.equivalent_angle) == (0.0, 0.0) and "turns uniformly" in str(result)
    assert result.input_speed == pytest.approx(tn.rpm(900))
    assert tn.kinetostatics(tn.Driveline(parts)).input_speed == 1.0
