"""sensitivity and its neighbours: text, JSON, pictures and tables; refusals before computing."""

from __future__ import annotations

import json

import pytest

import trunnion as tn


def test_sensitivity(run, here):
    call = ("sensitivity", "two-shaft-cardan", "-s", "1.2", "-p", "HookeJoint 1.angle", "-p", "Shaft 1.stiffness")
    done = run(*call, "-o", "s.csv", "-o", "s.png", "-o", "s.nc")
    assert (
        done.exit_code == 0 and done.stdout.startswith("sensitivity of ") and "growth rate at 1.2 rad/s" in done.stdout
    )
    head = (here / "s.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head.startswith("quantity,quantity_unit,kind,method,value,HookeJoint 1.angle: derivative")
    shown = json.loads(run(*call, "--of", "growth", "--json", "-o", "t.nc").stdout)
    assert shown["quantity"] == ["growth rate at 1.2 rad/s", "spectral radius at 1.2 rad/s"]
    assert shown["parameter"] == ["HookeJoint 1.angle", "Shaft 1.stiffness"] and len(shown["derivative"][0]) == 2


def test_compare(run, here):
    from trunnion.driveline.starter import starter

    (here / "one.toml").write_text(starter("two-shaft"), encoding="utf-8")
    (here / "other.toml").write_text(starter("two-shaft").replace("12 deg", "5 deg"), encoding="utf-8")
    done = run("compare", "one.toml", "other.toml", "-o", "c.png", "-o", "c.nc", "-o", "c.csv")
    assert done.exit_code == 0 and done.stdout.startswith("one → other: 1 change: ")
    assert "HookeJoint 1, angle: 12 deg → 5 deg" in done.stdout and (here / "c.png").exists()
    assert (here / "c.csv").read_text(encoding="utf-8").startswith("quantity,kind,")
    shown = json.loads(run("compare", "one.toml", "other.toml", "--json").stdout)
    assert shown["names"] == ["one", "other"] and shown["value_after"] == ["5 deg"]
    assert run("compare", "one.toml", "one.toml").stdout.strip().endswith("the two descriptions are alike")


def test_optimise(run, here):
    call = ("optimise", "three-shaft-cardan", "-f", "Shaft 2.fork_offset:-60deg:100deg", "-a", "irregularity")
    done = run(*call, "--designs", "40", "-o", "o.png", "-o", "o.nc", "--write", "best.toml")
    assert done.exit_code == 0 and "Shaft 2.fork_offset = 0 deg (90 deg before)" in done.stdout
    assert (here / "o.png").exists() and "HookeJoint" in (here / "best.toml").read_text(encoding="utf-8")
    shown = json.loads(run(*call, "--designs", "40", "--json", "-o", "p.nc").stdout)
    assert shown["free"] == ["Shaft 2.fork_offset"] and shown["aim_value"][0] < 1e-9


REFUSED = [
    (("optimise", "two-shaft-cardan", "-f", "HookeJoint 1.angle", "-a", "irregularity"), "needs two bounds"),
    (("optimise", "two-shaft-cardan", "-f", "HookeJoint 1.angle:0:1", "-a", "evenness"), "is not an aim"),
    (
        ("optimise", "two-shaft-cardan", "-f", "HookeJoint 1.angle:0:1", "-a", "irregularity", "--write", "best.txt"),
        "is not a place for a driveline file",
    ),
    (("compare", "two-shaft-cardan"), "AFTER"),
    (("compare", "two-shaft-cardan", "nowhere.toml"), "nowhere.toml"),
    (("compare", "two-shaft-cardan", "three-shaft-cardan", "--speed", "2:1"), "is not a rising range"),
    (("sensitivity", "two-shaft-cardan", "--of", "orders"), "is nothing to differentiate"),
    (("sensitivity", "two-shaft-cardan", "-p", "Shaft 9.stiffness"), "is not a parameter"),
    (("sensitivity", "two-shaft-cardan", "-s", "-1"), "must be positive"),
    (("sensitivity", "two-shaft-cardan", "-s", "1", "--check", "U"), "is not a check of this line"),
    (("sensitivity", "two-shaft-cardan", "--tips", "HookeJoint 1.angle:20deg:2deg"), "is a reversed range"),
    (("sensitivity", "two-shaft-cardan", "--load-case", "hill"), "hill"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[" ".join(call) for call, _ in REFUSED])
def test_one_line_exit_code_2_and_nothing_written(run, here, call, words):
    result = run(*call)
    assert result.exit_code == 2, result.output
    assert result.stdout == "" and words in result.stderr
    assert result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert not (here / "trunnion-out").exists()


def test_damper_optimum_names_the_damper_or_asks_for_it(run) -> None:
    """As the function; by itself with the only damper, refused with none or several."""
    ring = {"ring_inertia": 0.05, "damping": 1.0}
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.5, name="disk")]
    one = tn.Driveline([*parts, tn.ViscousDamper(name="front", **ring)])
    two = tn.Driveline([*one.elements, tn.TunedDamper(name="rear", stiffness=9.0, after="disk", **ring)])
    for name, line in (("one", one), ("two", two), ("none", tn.Driveline(parts))):
        tn.dump(line, f"{name}.toml")
    best = tn.damper_optimum(one, "front")
    result = run("damper-optimum", "one.toml")
    assert result.exit_code == 0 and str(best).splitlines()[0][:60] in result.stdout
    data = json.loads(run("damper-optimum", "two.toml", "--damper", "rear", "--json").stdout)
    assert data["damper"] == "rear" and data["stiffness"] == tn.damper_optimum(two, "rear").stiffness
    assert "--damper: is missing; name one of front, rear" in run("damper-optimum", "two.toml").stderr
    assert "driveline: has no damper; add a ViscousDamper" in run("damper-optimum", "none.toml").stderr
