"""Lines to files of other programs and back: equal frequencies, and what such files cannot hold is refused."""

from __future__ import annotations

import csv
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import opentorsion as ot
import pytest
from pymoca.parser import parse
from scipy.io import loadmat
from scipy.linalg import eigh

import trunnion as tn
from trunnion.errors import ComputationError, InputError

EVIL = 'a, "b\\";\\n=1+1\'; end x; // \N{GREEK SMALL LETTER OMEGA} {0} %s </p>'


def driven(**operation: Any) -> tn.Driveline:
    """A drive, a load, a straight joint, gears of both senses, a branch, a tube, a mesh."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            tn.Shaft(stiffness=1.2e4, damping=3.0),
            tn.Disk(inertia=0.3, load_torque=20.0, name=EVIL),
            tn.HookeJoint(angle=0.0),
            tn.Shaft(stiffness=5e4, damping=2.0, name="=HYPERLINK(1)"),
            tn.Ratio(teeth_in=11, teeth_out=43),
            tn.Disk(inertia=2.0, viscous_load=0.4, name="gear"),
            tn.Shaft(stiffness=3e4),
            tn.Disk(inertia=1.1),
            tn.GearPair(
                teeth_in=25, teeth_out=40, module="3 mm", mesh_stiffness="2e8 N/m", mesh_damping=100, after="gear"
            ),
            tn.Disk(inertia=0.05),
            tn.TunedDamper(ring_inertia=0.004, stiffness=900.0, damping=0.7),
            tn.Ratio(ratio=-2.0),
            tn.Shaft(outer_diameter="90 mm", inner_diameter="84 mm", length="1.5 m", material="steel", damping=0.5),
            tn.Disk(inertia=0.2, load_torque=5.0),
        ],
        name='Prüfstand "7"',
        operation=tn.Operation(speed="1500 rpm", **operation),
    )


def free(seed: int = 4, loads: bool = False) -> tn.Driveline:
    """A free chain with gears and a branch, numbers at random."""
    rng = np.random.default_rng(seed)
    j, k, c = rng.uniform(0.05, 2, 8), rng.uniform(1e4, 1e6, 6), rng.uniform(0, 9, 6)
    shafts = [tn.Shaft(stiffness=k[i], damping=c[i]) for i in range(6)]
    return tn.Driveline(
        [
            tn.Disk(inertia=j[0], viscous_load=0.3 if loads else 0.0), shafts[0], tn.Disk(inertia=j[1]), shafts[1],
            tn.Disk(inertia=j[2], name="fork"), tn.Ratio(teeth_in=17, teeth_out=30), tn.Disk(inertia=j[3]), shafts[2],
            tn.Disk(inertia=j[4]), shafts[3], tn.Disk(inertia=j[5]),
            tn.Ratio(ratio=0.7, after="fork"), shafts[4], tn.Disk(inertia=j[6]), shafts[5], tn.Disk(inertia=j[7]),
        ],
        operation=tn.Operation(speed="900 rpm"),
    )  # fmt: skip


def looped() -> tn.Driveline:
    """Two ways from a disk to another."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=2e4), tn.Disk(inertia=0.4, name="here"), tn.Shaft(stiffness=7e4),
            tn.Disk(inertia=0.7), tn.Shaft(stiffness=3e4, damping=4.0), tn.Disk(inertia=0.2),
            tn.Shaft(stiffness=6e4, to="here"),
        ],
        operation=tn.Operation(speed="1500 rpm"),
    )  # fmt: skip


LINES = {"driven": driven(), "free": free(), "loaded": free(7, loads=True), "looped": looped()}


def exported(line: tn.Driveline, folder: Path, to: str) -> Path:
    path = folder / f"line{ {'csv': '.csv', 'matlab': '.mat', 'opentorsion': '.py', 'modelica': '.mo'}[to] }"
    tn.export_line(line, path, to)
    return path


def frequencies(line: tn.Driveline) -> np.ndarray[Any, Any]:
    return tn.natural_frequencies(line).undamped_frequency


def same(found: Any, expected: Any, share: float = 1e-12) -> None:
    """Equal to ``share``, what is zero to that share of the largest."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    assert np.all(np.abs(found - expected) <= share * np.where(expected == 0, np.abs(expected).max(), np.abs(expected)))


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("to", ["csv", "modelica"])
def test_round_trip(name: str, to: str, tmp_path: Path) -> None:
    line = LINES[name]
    back = tn.import_line(exported(line, tmp_path, to))
    same(frequencies(back), frequencies(line))
    one, other = (np.sort_complex(tn.natural_frequencies(each).eigenvalue.ravel()) for each in (back, line))
    assert np.abs(one - other).max() <= 1e-12 * np.abs(other).max()
    assert back.operation is not None and line.operation is not None
    assert back.operation.speed == pytest.approx(line.operation.speed, rel=1e-14)
    assert {n for n in line.names if n in back.names} >= {n for n, e in line.parts if isinstance(e, tn.Disk)}
    again = tn.import_line(exported(back, tmp_path, to))
    assert again == back  # what was read is written as it was


def test_loads_keep_their_sense(tmp_path: Path) -> None:
    """Behind a reversing gear a load is positive here, and turns with the other sign in Modelica."""
    for to in ("csv", "modelica"):
        back = tn.import_line(exported(driven(), tmp_path, to))
        assert [e.load_torque for n, e in back.parts if isinstance(e, tn.Disk) and e.load_torque] == [20.0, 5.0]
        assert [e.viscous_load for n, e in back.parts if isinstance(e, tn.Disk) and e.viscous_load] == [0.4]
    assert "tau_constant=5.0" in (tmp_path / "line.mo").read_text(encoding="utf-8")


def test_open_torsion_has_its_frequencies(tmp_path: Path) -> None:
    """Of the assembly that the script builds: of its matrices, and by its own modal analysis."""
    line = free()
    path = exported(line, tmp_path, "opentorsion")
    assembly = runpy.run_path(str(path))["assembly"]
    assert isinstance(assembly, ot.Assembly)
    expected = frequencies(line)
    found = np.sqrt(np.abs(eigh(assembly.K, assembly.M, eigvals_only=True)))
    assert found[0] < 1e-6 * found[1]
    same(found[1:], expected[1:])
    own = np.sort(np.abs(assembly.modal_analysis(C=0 * assembly.C)[0]))[2::2]
    same(own, expected[1:], 1e-10)
    same(frequencies(tn.import_line(path)), expected)
    damped = np.sort_complex(tn.natural_frequencies(line).eigenvalue.ravel())
    a, b = assembly.state_matrix()
    ends = np.sort(np.abs(np.linalg.eigvals(-np.linalg.solve(b, a))))
    assert ends[2:] == pytest.approx(np.sort(np.abs(damped))[2:], rel=1e-9)


@pytest.mark.parametrize("name", LINES)
def test_state_space_has_the_eigenvalues(name: str, tmp_path: Path) -> None:
    line = LINES[name]
    read = loadmat(exported(line, tmp_path, "matlab"))
    a, n = read["A"], len(read["A"]) // 2
    assert a.shape == (2 * n, 2 * n) and read["B"].shape == (2 * n, len(read["inputs"]))
    assert read["C"].shape == (len(read["outputs"]), 2 * n) and read["D"].shape == (
        len(read["outputs"]),
        len(read["inputs"]),
    )
    assert len(read["states"]) == 2 * n
    undamped = np.sqrt(np.abs(eigh(read["stiffness"], read["M"], eigvals_only=True)))
    expected = frequencies(line)
    moving = expected > 0
    same(undamped[moving], expected[moving])
    found, known = (
        np.sort(np.abs(np.linalg.eigvals(a))),
        np.sort(np.abs(tn.natural_frequencies(line).eigenvalue.ravel())),
    )
    assert found == pytest.approx(known, rel=1e-9, abs=1e-4 if not moving.all() else 0)


def test_state_space_answers_a_torque() -> None:
    """The static twist of two springs in a row, and the torque they carry, by A, B, C, D alone."""
    from trunnion.exchange.matlab import state_space
    from trunnion.exchange.network import network_of

    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=4e3, damping=1.0), tn.Disk(inertia=0.2), tn.Ratio(ratio=-2.5),
            tn.Shaft(stiffness=1e3), tn.Disk(inertia=0.1, load_torque=30.0),
        ],
        operation=tn.Operation(speed="600 rpm"),
    )  # fmt: skip
    s = state_space(network_of(line))
    twist = -s["C"] @ np.linalg.solve(s["A"], s["B"] @ s["u0"])
    outputs = dict(zip(s["outputs"].ravel(), twist.ravel(), strict=True))
    # the load resists the reversed rotation, so acts with +30 N m; the gear makes it −12 N m in front
    assert outputs["torque of Shaft 2 [N m]"] == pytest.approx(30.0)
    assert outputs["torque of Shaft 1 [N m]"] == pytest.approx(-12.0)
    assert outputs["rotation of Disk 1 [rad]"] == pytest.approx(-12.0 / 4e3)
    assert outputs["rotation of Disk 2 [rad]"] == pytest.approx(12.0 / 4e3 / 2.5 + 30.0 / 1e3)


def test_a_viscous_load_has_its_mean_torque(tmp_path: Path) -> None:
    """2 N m s/rad at 100 rad/s behind a step-down of 4 turns at 25 rad/s: 50 N m there, 12.5 in front."""
    from trunnion.exchange.matlab import state_space
    from trunnion.exchange.network import network_of

    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=4e3), tn.Disk(inertia=0.2), tn.Ratio(ratio=4.0)]
    parts += [tn.Shaft(stiffness=1e3), tn.Disk(inertia=0.1, viscous_load=2.0)]
    s = state_space(network_of(tn.Driveline(parts, operation=tn.Operation(speed=100.0))))
    carried = -s["C"] @ np.linalg.solve(s["A"], s["B"] @ s["u0"])
    outputs = dict(zip(s["outputs"].ravel(), carried.ravel(), strict=True))
    assert abs(outputs["torque of Shaft 2 [N m]"]) == pytest.approx(50.0)
    assert abs(outputs["torque of Shaft 1 [N m]"]) == pytest.approx(12.5)
    with pytest.raises(InputError, match=r"Disk 2.viscous_load = 2: acts by a speed that is not stated"):
        tn.export_line(tn.Driveline(parts), tmp_path / "line.mat", "matlab")


def test_another_parser_reads_the_model(tmp_path: Path) -> None:
    """Matrices from what pymoca reads, by unknowns of every port and Lagrange's constraints: the same frequencies."""
    line = driven()
    tree = parse(exported(line, tmp_path, "modelica").read_text(encoding="utf-8"))
    model = tree.classes["Prufstand_7"]
    ports: dict[str, int] = {}
    mass, stiff, rows = {}, [], []
    for key, symbol in model.symbols.items():
        kind = str(symbol.type).rpartition(".")[2]
        values = {
            str(one.value.component): one.value.modifications[0]
            for one in (symbol.class_modification.arguments if symbol.class_modification else [])
        }
        ends = [f"{key}.flange"] if kind.startswith(("Fixed", "Constant")) else [f"{key}.flange_a", f"{key}.flange_b"]
        a, *b = (ports.setdefault(end, len(ports)) for end in ends)
        if kind == "Inertia":
            mass[a] = values["J"].value
            rows.append({a: 1.0, b[0]: -1.0})
        elif kind == "SpringDamper":
            stiff.append((a, b[0], values["c"].value))
        elif kind == "IdealGear":
            rows.append({a: 1.0, b[0]: -number(values["ratio"])})
        elif kind in ("Fixed", "ConstantSpeed"):
            rows.append({a: 1.0})
    rows += [{ports[port(e.left)]: 1.0, ports[port(e.right)]: -1.0} for e in model.equations]
    size = len(ports)
    m, k, g = np.zeros((size, size)), np.zeros((size, size)), np.zeros((len(rows), size))
    for at, value in mass.items():
        m[at, at] = value
    for near, far, value in stiff:
        k[np.ix_([near, far], [near, far])] += value * np.array([[1, -1], [-1, 1]])
    for i, row in enumerate(rows):
        for at, value in row.items():
            g[i, at] = value
    _, s, v = np.linalg.svd(g)
    kept = v[np.sum(s > 1e-9) :].T
    found = np.sqrt(eigh(kept.T @ k @ kept, kept.T @ m @ kept, eigvals_only=True))
    assert found == pytest.approx(frequencies(line), rel=1e-11)


def port(reference: Any) -> str:
    """``component.flange`` of a reference of pymoca."""
    return f"{reference.name}.{reference.child[0].name}"


def number(tree: Any) -> float:
    """A literal, its negative, or a quotient of two, as pymoca has it."""
    if hasattr(tree, "operands"):
        values = [number(one) for one in tree.operands]
        return -values[0] if len(values) == 1 else values[0] / values[1]
    return float(tree.value)


REFUSED = [
    (tn.HookeJoint(angle="3 deg"), "HookeJoint 1.angle", "write angle = 0"),
    (tn.TripodJoint(angle="3 deg", radius="30 mm", length="200 mm"), "TripodJoint 1.angle", "write angle = 0"),
    (
        tn.GearPair(teeth_in=20, teeth_out=30, module="2 mm", mesh_stiffness=1e8, backlash="0.1 mm"),
        "GearPair 1.backlash", "take the backlash away",
    ),
    (tn.PiecewiseShaft(breakpoints=["1 deg"], stiffnesses=[1e3, 2e3]), "PiecewiseShaft 1", "a Shaft of one stiffness"),
    (tn.ViscousDamper(ring_inertia=0.1, damping=4.0), "ring of ViscousDamper 1", "write its stiffness"),
    (tn.Disk(inertia=1.0, excitation=[{"order": 2, "amplitude": 3.0}]), "Disk 2.excitation", "take it away"),
    (tn.Shaft(stiffness=1e4, loss_factor=0.1), "Shaft 2.loss_factor = 0.1", "write loss_factor_frequency"),
    (tn.Disk(inertia=1.0, quadratic_load=0.1), "Disk 2.quadratic_load", "leave it out"),
]  # fmt: skip


@pytest.mark.parametrize(("element", "where", "remedy"), REFUSED, ids=[row[1] for row in REFUSED])
@pytest.mark.parametrize("to", ["csv", "matlab", "opentorsion", "modelica"])
def test_what_no_file_holds(element: Any, where: str, remedy: str, to: str, tmp_path: Path) -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=1.0),
            element,
            tn.Shaft(stiffness=2e4),
            tn.Disk(inertia=1.0),
        ]
        if not isinstance(element, tn.GearPair | tn.PiecewiseShaft | tn.Shaft)
        else [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0), element, tn.Disk(inertia=1.0)]
    )
    with pytest.raises(InputError) as caught:
        exported(line, tmp_path, to)
    assert where in str(caught.value) and remedy in str(caught.value)
    assert list(tmp_path.iterdir()) == []  # nothing is written


def test_a_loss_factor_at_a_frequency_is_a_damping(tmp_path: Path) -> None:
    shaft = tn.Shaft(stiffness=1e4, loss_factor=0.1, loss_factor_frequency="50 Hz")
    line = tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=1.0)])
    back = tn.import_line(exported(line, tmp_path, "csv"))
    assert back.elements[1].damping == pytest.approx(0.1 * 1e4 / (2 * np.pi * 50), rel=1e-14)  # type: ignore[attr-defined]
    same(tn.natural_frequencies(back).damping_ratio, tn.natural_frequencies(line).damping_ratio, 1e-10)


def test_a_schedule_is_refused(tmp_path: Path) -> None:
    way = tn.Schedule(name="way", travel=["0 mm", "9 mm"], angles={"HookeJoint 1": [0.0, 0.1]})
    with pytest.raises(InputError, match=r"schedule\.way.*at_schedule\('way'"):
        exported(driven(schedules=[way]), tmp_path, "csv")
    exported(driven(schedules=[way]).at_schedule("way", 0.0), tmp_path, "csv")  # the remedy


def test_what_else_is_left_out_is_said(tmp_path: Path) -> None:
    line = driven(load_cases=[tn.LoadCase(name="towing", loads={"gear": 30.0})])
    assert tn.export_line(line, tmp_path / "line.csv", "csv") == ("load cases",)


def test_a_table_computes_nothing_in_a_spreadsheet(tmp_path: Path) -> None:
    with exported(driven(), tmp_path, "csv").open(encoding="utf-8", newline="") as stream:
        names = [row[0] for row in csv.reader(stream)]
    assert EVIL in names and "'=HYPERLINK(1)" in names
    assert not [name for name in names if name[:1] in ("=", "+", "-", "@")]


def test_names_stay_texts_in_a_script(tmp_path: Path) -> None:
    """A hostile name is read back as it was and does nothing where the script runs."""
    name = "'''\" + __import__('os').abort() # {NAME}"
    line = tn.Driveline([tn.Disk(inertia=1.0, name=name), tn.Shaft(stiffness=1e3), tn.Disk(inertia=2.0)], name=name)
    path = exported(line, tmp_path, "opentorsion")
    assert runpy.run_path(str(path))["NAME"] == name
    assert tn.import_line(path).names[0] == name


def test_a_script_is_not_run(tmp_path: Path) -> None:
    path = exported(free(), tmp_path, "opentorsion")
    path.write_text(path.read_text() + "\nraise SystemExit(3)\n")
    assert len(tn.import_line(path).elements) == len(free().elements)


SHORT = "model L Modelica.Mechanics.Rotational.Components."
BAD = [
    ("l.csv", "", "does not begin with the columns of a line"),
    ("l.csv", "name,kind\n", "does not begin with the columns of a line"),
    ("l.csv", "{head}x,inertia,0,,two\n", "l.csv: row 2.inertia: is not a number"),
    ("l.csv", "{head}x,inertia,-1,,2\n", "l.csv: row 2.from: is not a number of a flange"),
    ("l.csv", "{head}x,gear,0,1,,,,0\n", "l.csv: row 2.ratio: is not a ratio"),
    ("l.csv", "{head}x,gear,0,1,,,,1e999999999\n", "l.csv: row 2.ratio: is not a ratio"),
    ("l.csv", "{head}x,gear,0,1,,,,3/0\n", "l.csv: row 2.ratio: is not a ratio"),
    ("l.csv", "{head}x,rope,0,1\n", "l.csv: row 2.kind: is not a kind of part"),
    ("l.csv", "{head}x,inertia,0,,nan\n", "x.inertia"),
    ("l.csv", "{head}x,inertia,0,,-2\n", "x.inertia = -2: must be positive"),
    ("l.csv", "{head}x,inertia,0,,2\ny,inertia,1,,2\n", "y: hangs on nothing"),
    ("l.csv", "{head}x,spring,0,1,,3\n", "has neither a drive nor an inertia"),
    (
        "l.csv",
        "{head}x,inertia,0,,2\ns,spring,0,1,,3\ny,inertia,1,,2\ng,gear,0,1,,,,2\n",
        "s: closes a loop whose ends",
    ),
    ("l.csv", "{head}x,inertia,0,,2\nf,gear,0,1,,,,2\ny,inertia,1,,2\ng,gear,0,1,,,,2\n", "g: closes a loop; leave it"),
    (
        "l.csv",
        "{head}a,drive,0,,,,,,,,10\nx,inertia,1,,2\ns,spring,0,1,,3\nt,spring,1,2,,3\nb,drive,2,,,,,,,,11\n",
        "contradicts",
    ),
    ("l.mo", "model L", "is not a model of a line: cannot be read at its end"),
    ("l.mo", "model L\n ? end L;", "cannot be read in line 2"),
    ("l.mo", SHORT + "Clutch c; end L;", "Clutch, which lines do not have"),
    ("l.mo", SHORT + "Inertia i(J=1, K=2); end L;", "i.K: is not read"),
    ("l.mo", SHORT + "Inertia i; end L;", "i.J: is missing"),
    ("l.mo", SHORT + "Inertia i(J=one); end L;", "i.J = 'one': is not a number"),
    ("l.mo", SHORT + "Inertia i(J=1); equation connect(i.flange_a, k.flange_a); end L;", "k.flange_a: is not a flange"),
    ("l.mo", SHORT + 'Inertia i(J=1) "a* b"; end L;', "is not a name"),
    ("l.py", "x = (", "cannot be read"),
    ("l.py", "DISKS = [(1, 2)]\nSHAFTS = []\nGEARS = []", "DISKS cannot be read"),
    ("l.py", "DISKS = [('a', 0, 1e999)]\nSHAFTS = []\nGEARS = []", "the numbers of a"),
    ("l.py", "DISKS = __import__('os').listdir()\nSHAFTS = []\nGEARS = []", "DISKS cannot be read"),
    ("l.mat", "", "a state space does not say what it is made of"),
    ("l.toml", "", "cannot be imported"),
]
HEAD = (
    "name,kind,from,to,inertia [kg m^2],stiffness [N m/rad],damping [N m s/rad],ratio [1],load_torque [N m],"
    "viscous_load [N m s/rad],speed [rad/s]\n"
)


@pytest.mark.parametrize(("name", "content", "words"), BAD, ids=[row[2] for row in BAD])
def test_files_that_are_no_lines(name: str, content: str, words: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content.replace("{head}", HEAD))
    with pytest.raises(InputError) as caught:
        tn.import_line(tmp_path / name)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value) and "; " in str(caught.value)


def test_what_one_target_alone_lacks(tmp_path: Path) -> None:
    for to, line, words in (
        ("opentorsion", driven(), "drive: holds a rotation, which openTorsion does not"),
        ("opentorsion", free(7, loads=True), "Disk 1.viscous_load = 0.3: is a load"),
        ("modelica", driven().but(operation=None), "gear.viscous_load = 0.4: acts by a speed that is not stated"),
    ):
        with pytest.raises(InputError) as caught:
            exported(line, tmp_path, to)
        assert words in str(caught.value)
    row = [tn.Disk(inertia=1.0), tn.Shaft(stiffness=1e4), tn.Shaft(stiffness=2e4), tn.Disk(inertia=2.0)]
    for to in ("matlab", "opentorsion"):
        with pytest.raises(InputError, match="Shaft 1: ends where nothing is heavy"):
            exported(tn.Driveline(row), tmp_path, to)
    for to in ("csv", "modelica"):
        same(frequencies(tn.import_line(exported(tn.Driveline(row), tmp_path, to))), frequencies(tn.Driveline(row)))


def test_targets_and_endings(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="to = 'simulink': is not a target"):
        tn.export_line(free(), tmp_path / "l.mdl", "simulink")
    with pytest.raises(InputError, match=r"does not end in \.csv"):
        tn.export_line(free(), tmp_path / "l.toml", "csv")
    with pytest.raises(InputError, match="its folder does not exist"):
        tn.export_line(free(), tmp_path / "none" / "l.csv", "csv")


def test_a_file_that_was_there_stays_where_writing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "l.mat"
    path.write_bytes(b"old")

    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("scipy.io.savemat", full)
    with pytest.raises(ComputationError, match="nothing was changed there"):
        tn.export_line(free(), path, "matlab")
    assert path.read_bytes() == b"old" and list(tmp_path.iterdir()) == [path]
