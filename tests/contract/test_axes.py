"""Axes of charts: values that an element or the line would refuse, refused at once with the end that is impossible."""

from __future__ import annotations

import pytest

import trunnion as tn
from trunnion.driveline.parameters import pack
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts.axes import axis

LINE = tn.Driveline([
    tn.ConstantSpeed(),
    tn.Shaft(name="inner shaft", outer_diameter=0.06, inner_diameter=0.05, length=1.0, material="steel"),
    tn.Disk(name="outer disk", outer_diameter=0.2, inner_diameter=0.05, thickness=0.02, material="steel",
            excitation=[{"order": 2, "amplitude": 5.0}, {"frequency": 20.0, "amplitude": 5.0}]),
    tn.HookeJoint(angle=0.4),
    tn.Coupling(name="coupling", stiffness=1e4, relative_damping=0.8),
    tn.Disk(name="vehicle", mass=30.0, radius=0.1),
    tn.Shaft(name="lossy", stiffness=1e4, loss_factor=0.02, loss_factor_frequency=100.0),
    tn.Disk(name="pinion", inertia=0.1),
    tn.GearPair(name="pair", teeth_in=25, teeth_out=40, module=3e-3, mesh_stiffness=1e8, mesh_damping=5.0,
                stiffness_variation=[{"share": 0.2}]),
    tn.Disk(name="wheel", inertia=1.0),
    tn.Shaft(name="plain", stiffness=1e4, damping=1.0),
    tn.Disk(name="end", inertia=0.2),
])  # fmt: skip
STAGES = tn.Driveline([
    tn.ConstantSpeed(),
    tn.PiecewiseShaft(name="stages", breakpoints=[0.05, 0.1], stiffnesses=[10.0, 100.0, 1000.0]),
    tn.Disk(inertia=1.0),
])  # fmt: skip
MODAL = tn.Driveline(
    [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)],
    damping_ratio=0.02,
    damping_ratio_frequency=50.0,
)

# (line, parameter, low, high, the end that is refused, what it would make and why)
REFUSED = [
    (LINE, "inner shaft.inner_diameter", 0.01, 0.07, "high", "inner_diameter 0.07, which must be smaller than outer"),
    (LINE, "inner shaft.inner_diameter", -0.01, 0.05, "low", "inner_diameter -0.01, which must not be negative"),
    (LINE, "inner shaft.outer_diameter", 0.04, 0.08, "low", "inner_diameter 0.05, which must be smaller than outer"),
    (LINE, "inner shaft.outer_diameter", -0.04, 0.08, "low", "outer_diameter -0.04, which must be positive"),
    (LINE, "inner shaft.length", 0, 1, "low", "length 0, which must be positive"),
    (LINE, "inner shaft.density", -1, 1, "low", "density -1, which must not be negative"),
    (LINE, "inner shaft.shear_modulus", 0, 1e9, "low", "shear_modulus 0, which must be positive"),
    (LINE, "outer disk.inner_diameter", 0.1, 0.3, "high", "inner_diameter 0.3, which must be smaller than outer"),
    (LINE, "outer disk.outer_diameter", 0.01, 0.3, "low", "inner_diameter 0.05, which must be smaller than outer"),
    (LINE, "outer disk.thickness", 0, 1, "low", "thickness 0, which must be positive"),
    (LINE, "outer disk.density", 0, 1, "low", "density 0, which must be positive"),
    (LINE, "outer disk.excitation 2 frequency", -1, 1, "low", "excitation 2 frequency -1, which must be positive"),
    (LINE, "outer disk.drive_share", 0, 1, "high", "drive_share 1, which shares the drive"),
    (LINE, "coupling.stiffness", -1, 1, "low", "stiffness -1, which must be positive"),
    (LINE, "coupling.relative_damping", -1, 1, "low", "relative_damping -1, which must not be negative"),
    (LINE, "coupling.damping", 1, 2, "low", "damping 1, which conflicts with relative_damping"),
    (LINE, "vehicle.mass", -1, 1, "low", "mass -1, which must be positive"),
    (LINE, "vehicle.radius", 0, 1, "low", "radius 0, which must be positive"),
    (LINE, "lossy.loss_factor", -1, 1, "low", "loss_factor -1, which must not be negative"),
    (LINE, "lossy.loss_factor_frequency", 0, 1, "low", "loss_factor_frequency 0, which must be positive"),
    (LINE, "pair.mesh_stiffness", -1e8, 1e8, "low", "mesh_stiffness -1e+08, which must be positive"),
    (LINE, "pair.mesh_damping", -1, 1, "low", "mesh_damping -1, which must not be negative"),
    (LINE, "pair.stiffness_variation 1 share", 0.1, 3, "high", "stiffness_variation, which lets the stiffness vanish"),
    (LINE, "wheel.inertia", -1, 1, "low", "inertia -1, which must be positive"),
    (LINE, "plain.stiffness", 0, 1, "low", "stiffness 0, which must be positive"),
    (LINE, "factor of plain.stiffness", 0, 1, "low", "stiffness 0, which must be positive"),
    (LINE, "factor of inner shaft.outer_diameter", 0.5, 1, "low", "inner_diameter 0.05, which must be smaller"),
    (LINE, "factor of inner shaft.density", -1, 1, "low", "density -7850, which must not be negative"),
    (LINE, "factor of Disk *.inertia", -1, 1, "low", "inertia -0.1, which must be positive"),
    (STAGES, "stages.breakpoint 1", 0, 0.2, "high", "breakpoints, which must rise"),
    (STAGES, "stages.stiffness 2", -1, 1, "low", "stiffnesses, which must not be negative"),
    (MODAL, "damping_ratio_frequency", 0, 1, "low", "damping_ratio_frequency 0, which must be positive"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "path", "low", "high", "end", "words"), REFUSED, ids=[f"{r[1]}-{r[4]}" for r in REFUSED]
)
def test_an_impossible_end_is_refused(
    line: tn.Driveline, path: str, low: float, high: float, end: str, words: str
) -> None:
    with pytest.raises(tn.InputError) as caught:
        axis(assemble(line), (path, low, high, 5), "x")
    said = str(caught.value)
    assert said.startswith(f"{path}.{end} = {low if end == 'low' else high:g}: would make ") and words in said
    assert said.endswith("let the axis end where the line is still possible") and "\n" not in said


POSSIBLE = [
    (LINE, "inner shaft.inner_diameter", 0, 0.059), (LINE, "inner shaft.density", 0, 8000),
    (LINE, "outer disk.excitation 1 amplitude", -1, 1), (LINE, "outer disk.load_torque", -5, 5),
    (LINE, "plain.damping", -1, 1), (LINE, "plain.fork_offset", -9, 9), (LINE, "HookeJoint 1.plane", -4, 4),
    (LINE, "factor of HookeJoint *.angle", -2, 3), (STAGES, "stages.breakpoint 2", 0.06, 0.2),
    (MODAL, "damping_ratio", 0, 0.5),
]  # fmt: skip


@pytest.mark.parametrize(("line", "path", "low", "high"), POSSIBLE, ids=[r[1] for r in POSSIBLE])
def test_a_possible_range_is_taken(line: tn.Driveline, path: str, low: float, high: float) -> None:
    found, said = axis(assemble(line), (path, low, high, 5), "x")
    assert (found.values[0], found.values[-1], said) == (low, high, None)


def test_both_axes_together() -> None:
    """A bore and a tube that are possible one by one."""
    axes = ("inner shaft.inner_diameter", 0.0, 0.058, 5), ("inner shaft.outer_diameter", 0.052, 0.08, 5)
    with pytest.raises(tn.InputError, match=r"range = \(0.058, 0.052\): would make inner shaft.inner_diameter 0.058"):
        tn.stability_chart(LINE, *axes, speed=100.0)


def test_speed_has_no_factor() -> None:
    with pytest.raises(tn.InputError, match='factor of speed: belongs to the analysis.*vary "speed" itself'):
        axis(assemble(LINE), ("factor of speed", 1, 2, 5), "x")


@pytest.mark.parametrize("line", [LINE, STAGES, MODAL], ids=["line", "stages", "modal"])
def test_the_line_of_a_row_has_the_numbers_of_the_row(line: tn.Driveline) -> None:
    packed = pack(line)
    assert packed.line_at(packed.values) == line
    for column, (_, key) in enumerate(packed.place):
        if key == "speed" or not packed.values[column]:
            continue
        row = packed.values.copy()
        row[column] *= 1.001
        assert pack(packed.line_at(row)).values[1:] == pytest.approx(row[1:], rel=1e-14)
