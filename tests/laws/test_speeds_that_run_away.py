"""Free–free lines whose loads do not hold the speed, or whose meshes hold the phase: what their critical multiplier is.

The whole line changes its speed as one inertia: dΩ/dt = −cΩ/J, whatever its shafts and joints do.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.stability import stability as judged
from trunnion.floquet.stability.own_speed import is_of_speed

SPEED = 50.0
WAYS = pytest.mark.parametrize("long", [2, 1000], ids=["along the tree", "whole matrices"])


def line(viscous: float, *, angle: float = 0.3, variation: float | None = None, inertias: int = 4) -> tn.Driveline:
    """J = 0.1 + 0.2 + …; ``variation`` : of a mesh 1 : 1 behind the second disk."""
    elements: list[Any] = []
    for i in range(inertias):
        load = {0: {"drive_share": 1}, inertias - 1: {"load_torque": 20.0, "viscous_load": viscous}}.get(i, {})
        elements.append(tn.Disk(inertia=0.1 * (i + 1), **load))
        if i == 0:
            elements.append(tn.HookeJoint(angle=angle))
        if i == 1 and variation is not None:
            share = [{"order": 1, "share": variation}] if variation else ()
            mesh = {"mesh_stiffness": 1e8, "mesh_damping": 500.0, "stiffness_variation": share}
            elements += [tn.GearPair(teeth_in=20, teeth_out=20, module=0.005, **mesh), tn.Disk(inertia=0.05)]
        if i < inertias - 1:
            elements.append(tn.Shaft(stiffness=1e4, damping=1.0))
    return tn.Driveline(elements)


@WAYS
@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("viscous", [-0.5, -8.0])
def test_a_speed_that_no_load_holds(viscous: float, angle: float, long: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Called that of the speed, near 1 and far from it; it grows with −c/J."""
    monkeypatch.setattr(judged, "LONG", long)
    found = tn.stability(line(viscous, angle=angle), SPEED)
    assert found.verdict.name == "UNSTABLE" and found.growth_rate == pytest.approx(-viscous / 1.0, rel=4e-3)
    assert found.resonance is None and "line's own speed" in str(found) and "divergence" not in str(found)


@pytest.mark.parametrize("variation", [0.0, 0.2])
def test_a_varying_mesh_holds_the_phase(variation: float) -> None:
    """No multiplier is set aside where none is exactly 1 by a shift of the phase: it counts, and says why."""
    found = tn.stability(line(0.5, variation=variation), SPEED)
    held = variation > 0
    assert found.set_aside == (not held) and found.phase_is_held == held
    assert ("holds the phase" in str(found)) == held and ("set aside" in str(found)) != held
    assert found.resonance is None and not found.speed_sentence
    # With its phase free or held, the line loses a change of its speed as one inertia does.
    decay = np.exp(-0.5 / 1.05 * found.period / SPEED)
    assert np.abs(found.multipliers - decay).min() < 2e-4
    assert found.spectral_radius == pytest.approx(1.0 if held else decay, abs=2e-4)


def test_what_bends_within_itself_is_no_change_of_the_speed() -> None:
    """Shapes orthogonal to a turn of the whole line, pairs that oscillate, and those of a line that is held."""
    assembly = assemble(line(0.0, angle=0.0))
    mass = 0.1 * np.arange(1.0, 5.0)
    turn = np.ones(4)
    bent = np.array([1.0, 0.2, -0.5, 2.0])
    bent -= turn * (turn @ (mass * bent)) / mass.sum()
    co = assembly.coefficients(assembly.table(1, SPEED))
    assert is_of_speed(assembly.topology, co, 1.5, turn + 0.1 * bent)
    assert not is_of_speed(assembly.topology, co, 1.5, bent + 0.1 * turn)
    assert not is_of_speed(assembly.topology, co, 1.5 + 0.1j, turn) and not is_of_speed(
        assembly.topology, co, -1.5, turn
    )
    held = assemble(tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1)]))
    assert not is_of_speed(held.topology, held.coefficients(held.table(1, SPEED)), 1.5, turn[:1])
