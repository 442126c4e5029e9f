"""Stability of long lines from all their modes, against the matrices of the period and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.long_trees import random_tree
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import require_period
from trunnion.floquet.propagation import hill_line, tree_mode_motion, tree_modes, tree_propagation
from trunnion.floquet.propagation.tree_mode_motion import mode_motion
from trunnion.floquet.propagation.tree_modes import floquet_modes
from trunnion.floquet.ranges import exponents
from trunnion.floquet.ranges.collisions import exponent_collisions
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.stability import stability as judged
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.results.verdict import Verdict

SPEED = 150.0


def modes(line: tn.Driveline, speed: float) -> Any:
    assembly = assemble(line)
    co = assembly.coefficients(assembly.table(1, speed))
    return floquet_modes(assembly.topology, co, require_period(line, assembly.topology))


def by_the_period(line: tn.Driveline, speed: float) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged, "floquet_modes", lambda *asked: None)
        return tn.stability(line, speed)


@pytest.mark.parametrize("seed", quick_only((4, 13), range(200)))
def test_random_trees_against_the_matrices_of_the_period(seed: int) -> None:
    """The radius within both errors; every multiplier of the one among those of the other."""
    most = 21 if seed in (4, 13) else 120
    line = random_tree(seed, 20, most, driven=True)
    found = tn.stability(line, SPEED)
    other = by_the_period(line, SPEED)
    assert abs(found.spectral_radius - other.spectral_radius) <= found.error_estimate + other.error_estimate
    assert len(found.multipliers) == 2 * len(found.names)
    near = np.abs(other.multipliers[:, None] - found.multipliers)
    bound = other.multiplier_error[:, None] + found.multiplier_error
    assert ((near <= bound).sum(axis=1) > 0).all() and ((near <= bound).sum(axis=0) > 0).all()
    # The logarithm of a multiplier as small as its error is known to fewer digits: it may cost a millionth each.
    relative = np.minimum(found.multiplier_error / np.abs(found.multipliers), 1e-6).sum()
    assert found.verdict == other.verdict and found.liouville_defect < 1e-8 + relative


def uniform(inertias: int, damping: float = 0.0, angle: float | None = None) -> tn.Driveline:
    """Equal shafts and disks; two joints where an ``angle`` is given."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(inertias):
        elements += [tn.Shaft(stiffness=2e5, damping=damping), tn.Disk(inertia=0.1)]
        if angle and i in (2, inertias // 2):
            elements.append(tn.HookeJoint(angle=angle))
    return tn.Driveline(elements)


def test_a_uniform_chain_has_the_multipliers_of_its_closed_form() -> None:
    """ω_k = 2 √(k/J) sin((2k − 1)π / (4n + 2)), damping in proportion to stiffness; nothing integrated."""
    n, c = 100, 0.05
    found = tn.stability(uniform(n, c), SPEED)
    root = 2 * np.sqrt(2e5 / 0.1) * np.sin((2 * np.arange(1, n + 1) - 1) * np.pi / (4 * n + 2))
    decay = c / 2e5 * root**2 / 2
    exponent = -decay + 1j * np.sqrt(root**2 - decay**2)
    expected = np.exp(np.concatenate([exponent, exponent.conj()]) * found.period / SPEED)
    apart = np.abs(found.multipliers[:, None] - expected).min(axis=1)
    assert (apart <= found.multiplier_error).all() and found.multiplier_error.max() < 1e-10


@pytest.mark.parametrize("order, real", [(2, False), (3, True)])
def test_growth_where_modes_meet(order: int, real: bool) -> None:
    """At Ω = 2ω₁, ω₁ + ω₂ = 2Ω nearly, and at 3ω₁ = ω₂ nearly, where two multipliers meet on the real axis."""
    first = 2 * np.sqrt(2e5 / 0.1) * np.sin(np.pi / 66)
    line, speed = uniform(16, 1e-3, np.deg2rad(25.0)), order * first
    found, other = modes(line, speed), by_the_period(line, speed)
    radius = np.abs(found.multiplier).max()
    assert radius > 1.05 and (np.abs(found.multiplier[0].imag) < 1e-9) == real
    assert abs(radius - other.spectral_radius) <= found.error[0] + other.error_estimate


def test_two_modes_that_are_one_leave_states_to_be_carried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Followed twice, a mode counts once, and what it stands in the way of is found in time."""
    line = uniform(20, 0.05, 0.3)

    class Twice(tree_modes.HillLine):
        def starts(self) -> Any:
            value, shape = super().starts()
            value[3], shape[3] = value[4], shape[4]
            return value, shape

    right = modes(line, SPEED)
    monkeypatch.setattr(tree_modes, "HillLine", Twice)
    found = modes(line, SPEED)
    assert right.carried == 0 and found.carried in (2, 4)  # one of the two is taken, or neither
    apart = np.abs(found.multiplier[:, None] - right.multiplier)
    assert (apart.min(axis=1) <= found.error).all() and (apart.min(axis=0) <= right.error).all()


@pytest.mark.parametrize("angle, every", [(0.3, False), (0.3, True)])
def test_states_carried_in_time_against_modes_and_the_period(
    angle: float, every: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some beside most modes, whose parts are alike and modes close; all."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(20):
        elements += [tn.Shaft(stiffness=[2e5, 2e6][i % 4 == 0], damping=0.2), tn.Disk(inertia=[0.1, 1.0][i % 4 == 1])]
        if i == 9:
            elements.append(tn.HookeJoint(angle=angle))
    line = tn.Driveline(elements)
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: not every)
    found, other = modes(line, SPEED), by_the_period(line, SPEED)
    assert found.carried == 40 if every else found.carried < 40
    apart = np.abs(found.multiplier[:, None] - other.multipliers)
    bound = found.error[:, None] + other.multiplier_error
    assert (apart <= bound).any(axis=1).all() and (apart <= bound).any(axis=0).all()
    assert found.off < 1e-11 and found.error[0] < 1e-9


def test_a_step_that_is_too_long_is_in_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The series then ends before it has converged, by more than rounding."""
    line = uniform(20, 0.05, 0.3)
    right = modes(line, SPEED)
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: False)
    monkeypatch.setattr(tree_propagation, "REACH", 8.0)
    monkeypatch.setattr(tree_propagation, "CONVERGED", 1.0)
    found = modes(line, SPEED)
    off = np.abs(found.multiplier[:, None] - right.multiplier).min(axis=1)
    assert off.max() > 1e-9 and (off <= found.error + right.error).all()


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_a_free_uniform_chain_has_the_multipliers_of_its_closed_form(damping: float) -> None:
    """ω_k = 2 √(k/J) sin(kπ/2n), k = 0 … n − 1: the pair at 1 of its rigid rotation is set aside."""
    n = 80
    line = tn.Driveline(list(uniform(n, damping).elements[2:]))
    found = tn.stability(line, SPEED)
    root = 2 * np.sqrt(2e5 / 0.1) * np.sin(np.arange(1, n) * np.pi / (2 * n))
    decay = damping / 2e5 * root**2 / 2
    exponent = -decay + 1j * np.sqrt(root**2 - decay**2)
    expected = np.exp(np.concatenate([exponent, exponent.conj(), [0, 0]]) * found.period / SPEED)
    apart = np.abs(found.multipliers[:, None] - expected).min(axis=1)
    assert (apart <= found.multiplier_error + 1e-13).all() and found.multiplier_error.max() < 1e-10
    assert found.set_aside == 2 and found.verdict == (Verdict.STABLE if damping else Verdict.MARGINAL)
    rotation, rate = np.split(found.floquet_modes, 2)
    assert np.isfinite(rotation).all() and np.isfinite(rate).all()


@pytest.mark.parametrize("loaded", [False, True])
def test_a_long_free_line_with_a_mesh_and_a_ring_in_oil_against_the_period(loaded: bool) -> None:
    """What turns as a whole, the ring by itself, and with a load by speed no longer the whole line's speed."""
    elements: list[Any] = []
    for i in range(22):
        if i == 11:
            wave = [{"share": 0.3, "order": 1, "phase": 0.5}]
            elements.append(tn.GearPair(teeth_in=3, teeth_out=3, module=0.03, mesh_stiffness=5e7, mesh_damping=20.0,
                                        stiffness_variation=wave))  # fmt: skip
        elif i:
            elements.append(tn.Shaft(stiffness=1e5 * (2 + np.sin(i * i)), damping=1.0))
        load: dict[str, Any] = {0: {"drive_share": 1}, 20: {"viscous_load": 0.4}}.get(i, {}) if loaded else {}
        elements.append(tn.Disk(inertia=0.1 * (1 + i % 3), **load))
        if i == 5:
            elements.append(tn.ViscousDamper(ring_inertia=0.05, damping=3.0))
    line = tn.Driveline(elements)
    found, other = tn.stability(line, SPEED), by_the_period(line, SPEED)
    assert found.set_aside == other.set_aside and len(found.multipliers) == len(other.multipliers)
    assert abs(found.spectral_radius - other.spectral_radius) <= found.error_estimate + other.error_estimate
    apart = np.abs(found.multipliers[:, None] - other.multipliers)
    bound = found.multiplier_error[:, None] + other.multiplier_error
    assert (apart <= bound).any(axis=1).all() and (apart <= bound).any(axis=0).all()
    assert found.error_estimate < 1e-8 and found.verdict == other.verdict


def test_what_side_orders_leave_out_is_in_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a third of them, wrong by more than rounding and known to be."""
    line = uniform(20, 0.05, 0.6)
    right = np.abs(modes(line, 80.0).multiplier[0])
    monkeypatch.setattr(hill_line, "DECADES", (6.0,))
    monkeypatch.setattr(hill_line, "POOR", np.inf)
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: True)
    found = modes(line, 80.0)
    assert 1e-12 < abs(np.abs(found.multiplier[0]) - right) < found.error[0]


def test_harmonics_that_meet_other_modes_fall_slowly(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a slow speed many do: modes by Hill's blocks against all states carried in time, within both errors."""
    rng, elements = np.random.default_rng(50), list[Any]([tn.ConstantSpeed()])
    for i in range(50):
        k = float(rng.uniform(1e5, 1e6))
        elements += [tn.Shaft(stiffness=k, damping=2e-5 * k), tn.Disk(inertia=float(rng.uniform(0.05, 0.3)))]
        if i in (15, 31):
            elements.append(tn.HookeJoint(angle=np.deg2rad(45.0)))
    line = tn.Driveline(elements)
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: True)
    found = modes(line, 80.0)
    monkeypatch.setattr(tree_modes, "_blocks_pay", lambda line: False)
    carried = modes(line, 80.0)
    assert found.carried < 40 and carried.carried == 100 and found.off < 1e-8
    apart = np.abs(found.multiplier[:, None] - carried.multiplier)
    bound = found.error[:, None] + carried.error
    assert (apart <= bound).any(axis=1).all() and (apart <= bound).any(axis=0).all()


def test_lengths_of_a_basis_are_those_of_the_rows_of_its_inverse() -> None:
    """Two real modes among pairs, and two states beside them: dual vectors of the complex basis."""
    rng, pair = np.random.default_rng(3), np.array([True, False, True, True, False])
    modes = rng.normal(size=(10, 5)) + 1j * rng.normal(size=(10, 5)) * pair
    others = np.linalg.qr(rng.normal(size=(10, 10)))[0][:, :2]
    basis = tree_modes._Basis(np.zeros(5, complex), np.zeros(5, complex), modes, pair, np.zeros(5), others)
    dual = np.linalg.inv(np.concatenate([modes, modes[:, pair].conj(), others], axis=1))
    lengths = basis.lengths(np.linalg.inv(basis.whole))
    assert lengths == pytest.approx(np.linalg.norm(dual[:5], axis=1), rel=1e-12)


def test_along_a_range_as_at_single_speeds() -> None:
    """Radius and verdict of a line that the kernel would have known to 1e-4."""
    line = uniform(44, 0.2, 0.3)
    along = stability_along(assemble(line), [900.0, 1500.0])
    for radius, error, speed in zip(along.radius, along.error, along.speed, strict=True):
        one = tn.stability(line, speed)
        assert abs(radius - one.spectral_radius) <= error + one.error_estimate and error < 1e-9


def test_meetings_of_exponents_along_the_tree_and_by_whole_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    """Speeds at which modes may grow together: three speeds beside each tell them to the square of 1e-3."""
    line = uniform(12, 0.1, 0.3)
    for i, name in enumerate(line.names):
        if name.startswith("Shaft"):  # unlike each other, so that no more than two modes meet
            line = line.replace(name, stiffness=2e5 * (1.5 + np.sin(i)))
    span = Span(assemble(line), 200.0, 320.0)
    along = exponent_collisions(span, 200.0, 320.0).speed
    monkeypatch.setattr(exponents, "LONG", 10**9)
    whole = exponent_collisions(span, 200.0, 320.0).speed
    assert len(along) > 3 and along == pytest.approx(whole, rel=1e-7)


@pytest.mark.parametrize("speed, name", [(2.0, "sum (ω₁+ω₂)/2"), (3.0, "subharmonic ω₂")])
def test_names_of_what_grows_as_the_matrices_of_the_period_tell_them(speed: float, name: str) -> None:
    """From right and left null vectors of Hill's blocks, of a line that needs no propagator any more."""
    first = 2 * np.sqrt(2e5 / 0.1) * np.sin(np.pi / 66)
    line = uniform(16, 1e-3, np.deg2rad(25.0))
    found, other = tn.stability(line, speed * first), by_the_period(line, speed * first)
    assert str(found.resonance) == str(other.resonance) == name
    assert found.resonance is not None and other.resonance is not None
    assert found.resonance.speed == pytest.approx(other.resonance.speed, rel=1e-9)


def test_what_grows_in_a_line_of_160_inertias_has_a_name() -> None:
    """That of two modes whose sum its speed meets."""
    elements: list[Any] = [tn.ConstantSpeed()]
    for i in range(160):
        elements += [tn.Shaft(stiffness=1e5 * (2 + np.sin(1.3 * i * i)), damping=0.02), tn.Disk(inertia=0.1)]
        if i in (2, 5):
            elements.append(tn.HookeJoint(angle=0.6))
    line = tn.Driveline(elements)
    found, frequency = tn.stability(line, 1000.0), tn.natural_frequencies(line).undamped_frequency
    assert found.verdict == Verdict.UNSTABLE and found.resonance is not None and found.resonance.kind == "sum"
    i, j = (m - 1 for m in found.resonance.modes)
    assert (frequency[i] + frequency[j]) / 2 == pytest.approx(1000.0, rel=0.03)


def test_an_adjoint_that_does_not_belong_to_its_mode_names_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """l·r is constant of the true one alone."""
    line, first = uniform(16, 1e-3, np.deg2rad(25.0)), 2 * np.sqrt(2e5 / 0.1) * np.sin(np.pi / 66)
    assembly = assemble(line)
    co, turns = assembly.coefficients(assembly.table(1, 2 * first)), require_period(line, assembly.topology)
    exponent = complex(modes(line, 2 * first).exponent[0])
    assert mode_motion(assembly.topology, co, turns, exponent) is not None
    own = tree_mode_motion._null_vector

    def reversed_in_time(matrix: Any, slope: Any, transposed: bool) -> Any:
        return own(matrix, slope, transposed)[:, :: -1 if transposed else 1]

    monkeypatch.setattr(tree_mode_motion, "_null_vector", reversed_in_time)
    assert mode_motion(assembly.topology, co, turns, exponent) is None
