"""What of a line does nothing, or holds in part only, is said when the line is made."""

from __future__ import annotations

import warnings

import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble

SHAKEN = {"excitation": [{"order": 2, "amplitude": 50.0}]}


def said(*elements: object, **line: object) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        tn.Driveline(list(elements), **line)  # type: ignore[arg-type]
    return [str(one.message) for one in caught if issubclass(one.category, tn.InputRemark)]


def shaft(damping: float, **more: object) -> tn.Shaft:
    return tn.Shaft(stiffness=2e4, damping=damping, **more)


def test_an_excitation_that_a_constant_speed_holds() -> None:
    """Rigidly behind it, through joints and ratios, or in front of one at the far end."""
    drive, engine, load = tn.ConstantSpeed(), tn.Disk(inertia=1.0, name="engine", **SHAKEN), tn.Disk(inertia=1.0)
    (found,) = said(drive, engine, shaft(1.0), load)
    assert found.startswith("engine.excitation: does nothing") and "drive_share = 1" in found
    assert said(drive, tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.2), tn.Ratio(ratio=2), engine, shaft(1.0), load)
    assert said(drive, shaft(1.0), load, shaft(1.0), engine, tn.ConstantSpeed())
    assert not said(engine, shaft(1.0), load)
    assert not said(drive, shaft(1.0), engine)
    assert not said(drive, tn.Disk(inertia=1.0, excitation=[{"order": 2, "amplitude": 0.0}]), shaft(1.0), load)


def test_shafts_in_series_with_unlike_damping() -> None:
    drive, load = tn.ConstantSpeed(), tn.Disk(inertia=1.0)
    (found,) = said(drive, shaft(16.0, name="a"), shaft(4.0, name="b"), shaft(4.0, name="c"), load)
    assert found.startswith("a and b and c: in series") and "k/c = 1.25e+03 rad/s" in found
    assert not said(drive, shaft(10.0), shaft(10.0), load)
    assert not said(drive, tn.Shaft(stiffness=1e4, damping=5.0), shaft(10.0), load)
    assert not said(drive, shaft(16.0), tn.Disk(inertia=0.1), shaft(4.0), load)
    assert not said(drive, tn.Shaft(stiffness=1e4), tn.Shaft(stiffness=3e4), load, damping_ratio=0.02)
    tube = {"outer_diameter": 0.05, "length": 0.5, "shear_modulus": 8e10}
    assert not said(drive, shaft(16.0), tn.Shaft(**tube, damping=4.0, density=7850.0), load)
    assert said(drive, shaft(16.0), tn.Shaft(**tube, damping=4.0), load)
    lossy = {"stiffness": 2e4, "loss_factor": 0.1}
    (found,) = said(drive, tn.Shaft(**lossy), tn.Shaft(stiffness=2e4, loss_factor=0.2), load)
    assert "for small loss factors" in found
    assert not said(drive, tn.Shaft(**lossy), tn.Coupling(stiffness=1e4, loss_factor=0.1), load)


def test_a_line_that_begins_with_shafts_is_made() -> None:
    tube = tn.Shaft(outer_diameter=0.05, length=0.5, shear_modulus=8e10, damping=4.0, density=7850.0)
    for first in (shaft(1.0), tube, tn.Coupling(stiffness=1e4, loss_factor=0.1)):
        assert not said(first)
        assert not said(first, tn.Disk(inertia=1.0))
        assert not said(first, tn.HookeJoint(angle=0.2), shaft(1.0), tn.Disk(inertia=1.0))
    assert said(shaft(16.0), shaft(4.0), tn.Disk(inertia=1.0))


@pytest.mark.parametrize(("frequency", "most"), [(12.5, 1e-4), (125.0, 1e-2), (1250.0, 1.0)])
def test_one_shaft_holds_well_below_the_frequency_said(frequency: float, most: float) -> None:
    """Complex stiffness of the two in series against k + iωc of the one: off by about (ωc/k)² of it."""
    with pytest.warns(tn.InputRemark, match="k/c = 1.25e\\+03"):
        line = tn.Driveline([tn.ConstantSpeed(), shaft(16.0), shaft(4.0), tn.Disk(inertia=1.0)])
    assembly = assemble(line)
    one = assembly.coefficients(assembly.table(1))
    first, second = 2e4 + 16j * frequency, 2e4 + 4j * frequency
    off = (one.stiffness[0, 0] + 1j * frequency * one.damping[0, 0]) / (first * second / (first + second)) - 1
    assert most * 1e-2 < abs(off) < most
