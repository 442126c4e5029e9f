"""Stability of long lines with loops and differentials, against own equations and the matrices of the period."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.long_tree_equations import LongTree
from oracles.long_trees import random_tree, with_rings
from oracles.multipliers import matched, multipliers

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import line_matrices
from trunnion.equations.tree_matrices import tree_matrices
from trunnion.floquet.propagation import tree_modes
from trunnion.floquet.stability import stability as judged
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.results.verdict import Verdict

SPEED = 150.0
RINGS, QUICK = 40, 13


def seeds() -> list[Any]:
    """One quick, every tenth slow, the others a study."""
    slow = pytest.mark.slow
    marks = [slow if s % 10 == 0 else (slow, pytest.mark.study) for s in range(RINGS)]
    return [s if s == QUICK else pytest.param(s, marks=marks[s]) for s in range(RINGS)]


@pytest.mark.parametrize("seed", seeds())
def test_random_rings_against_their_own_equations(seed: int) -> None:
    """One to three shafts close loops: the radius and every multiplier within both errors, none missed."""
    tree = random_tree(seed, 20, 24 if seed == QUICK else 120, driven=True)
    line = with_rings(tree, LongTree(tree).mean, seed)
    found, motion = tn.stability(line, SPEED), LongTree(line).motion(SPEED)
    true, error = multipliers(motion)
    critical = int(np.abs(true).argmax())
    assert abs(np.abs(true[critical]) - found.spectral_radius) <= found.error_estimate + error[critical]
    assert found.error_estimate < 1e-6 and found.liouville_defect < 1e-8
    assert str(found.verdict) == ("stable" if abs(true[critical]) < 1 else "unstable")
    matched(true, error, found.multipliers, found.multiplier_error)


def by_the_period(line: tn.Driveline, speed: float) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged, "floquet_modes", lambda *asked: None)
        return tn.stability(line, speed)


def chain(count: int, name: str, after: str | None = None, joint: int = -1) -> list[Any]:
    """Shafts and disks one behind the other, a joint behind one of them."""
    elements: list[Any] = []
    for i in range(count):
        k = 1e5 * (2 + np.sin(1.3 * i * i + len(name)))
        elements.append(tn.Shaft(stiffness=k, damping=2.0, after=after if not i else None))
        elements.append(tn.Disk(inertia=0.1, name=f"{name} {i}"))
        if i == joint:
            elements.append(tn.HookeJoint(angle=0.4))
    return elements


def with_differential(inertia: float | None, *, free: bool = False) -> tn.Driveline:
    """A shaft with a joint, a differential and its legs, 18 unknowns; of a free one the joint is straight and a mesh
    varies."""
    front: list[Any] = [tn.Disk(inertia=0.5, name="flywheel")] if free else [tn.ConstantSpeed()]
    front += chain(6, "front", joint=-1 if free else 2)
    if free:
        wave = [{"share": 0.3, "order": 1, "phase": 0.5}]
        front.append(tn.GearPair(teeth_in=3, teeth_out=3, module=0.03, mesh_stiffness=5e7, mesh_damping=20.0,
                                 stiffness_variation=wave))  # fmt: skip
        front.append(tn.Disk(inertia=0.1))
    legs = [tn.Differential(ratio=2.0, inertia=inertia, name="drive"), tn.Disk(inertia=0.05), *chain(5, "left")]
    legs += [tn.Disk(inertia=0.05, after="drive.right"), *chain(5, "right")]
    return tn.Driveline([*front, *legs])


@pytest.mark.parametrize("inertia, free", [(None, False), (0.3, False), (0.3, True)])
@pytest.mark.parametrize("in_time", [False, True])
def test_a_differential_joins_masses(
    inertia: float | None, free: bool, in_time: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its case turns by the mean of both legs; all modes by Hill's blocks, or all states carried in time."""
    line, carried = with_differential(inertia, free=free), list[int]()
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: not in_time)
    own = judged.floquet_modes

    def seen(*asked: Any) -> Any:
        found = own(*asked)
        assert found is not None
        carried.append(found.carried)
        return found

    monkeypatch.setattr(judged, "floquet_modes", seen)
    found, other = tn.stability(line, SPEED), by_the_period(line, SPEED)
    size = len(found.names)
    assert carried == [2 * size] if in_time else carried[0] < size
    assert len(found.multipliers) == 2 * size and found.set_aside == other.set_aside
    assert abs(found.spectral_radius - other.spectral_radius) <= found.error_estimate + other.error_estimate
    apart = np.abs(found.multipliers[:, None] - other.multipliers)
    bound = found.multiplier_error[:, None] + other.multiplier_error
    assert (apart <= bound).any(axis=1).all() and (apart <= bound).any(axis=0).all()
    assert found.verdict == other.verdict and found.liouville_defect < 1e-9


def test_entries_beside_the_tree_are_those_of_the_whole_matrices() -> None:
    """M, C, K of a differential, whose legs meet again behind."""
    line = tn.Driveline([*with_differential(0.3).elements,
                         tn.Shaft(stiffness=2e4, damping=1.0, after="left 4", to="right 4")])  # fmt: skip
    assembly, tau = assemble(line), np.linspace(0, 3, 7)
    co = assembly.coefficients(assembly.table(1, SPEED))
    entries, whole = tree_matrices(assembly.topology, co, tau), line_matrices(assembly.topology, co, tau)
    assert entries.beside
    for kind, (tree, matrix) in enumerate(zip((entries.stiffness, entries.damping, entries.mass),
                                              (whole.stiffness, whole.damping, whole.mass), strict=True)):  # fmt: skip
        made = np.zeros_like(matrix[0])
        for i, p in enumerate(entries.parent.tolist()):
            made[:, i, i] = tree.own[i, 0]
            if p >= 0:
                made[:, i, p], made[:, p, i] = tree.down[i, 0], tree.up[i, 0]
        for one in entries.beside:
            made[:, one.row, one.column] = one.parts[kind][0]
        assert np.abs(made - matrix[0]).max() <= 1e-14 * np.abs(matrix).max()


def ring(inertias: int, angle: float = 0.35, damping: float = 0.5) -> tn.Driveline:
    """Two joints in a row of disks whose end is led back to its beginning."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(inertias):
        k = 1e5 * (2 + np.sin(1.3 * i * i))
        elements += [tn.Shaft(stiffness=k, damping=damping), tn.Disk(inertia=0.1 * (1 + 0.3 * np.cos(i)), name=f"d{i}")]
        if i in (inertias // 4, inertias // 2):
            elements.append(tn.HookeJoint(angle=angle))
    elements.append(tn.Shaft(stiffness=1e5, damping=damping, after=f"d{inertias - 1}", to=f"d{inertias // 8}"))
    return tn.Driveline(elements)


def test_along_a_range_and_by_name_as_from_the_period() -> None:
    """At the sum of two frequencies of a ring it grows, and says so."""
    line = ring(16, 0.6, 1e-3)
    first, second = tn.natural_frequencies(line).undamped_frequency[:2]
    speeds = [(first + second) / 2, 1.3 * second]
    along = stability_along(assemble(line), speeds)
    for k, speed in enumerate(speeds):
        found, other = tn.stability(line, speed), by_the_period(line, speed)
        assert found.verdict == other.verdict and str(found.resonance) == str(other.resonance)
        assert abs(found.spectral_radius - other.spectral_radius) <= found.error_estimate + other.error_estimate
        assert abs(along.radius[k] - found.spectral_radius) <= along.error[k] + found.error_estimate
    assert tn.stability(line, speeds[0]).verdict == Verdict.UNSTABLE


@pytest.mark.slow
def test_a_ring_of_300_inertias_is_judged() -> None:
    """A hundred times as fast as by whole matrices, which it would take minutes for."""
    found = tn.stability(ring(300), SPEED)
    assert len(found.multipliers) == 600 and found.error_estimate < 1e-9 and found.liouville_defect < 1e-8
