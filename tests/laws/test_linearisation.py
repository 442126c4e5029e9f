"""The linear equations are the derivatives of the nonlinear ones, and those are the laws of mechanics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from oracles.comparisons import set_distance
from oracles.package_kernels import chain_kernel
from oracles.random_lines import random_geared_line, random_line, random_uneven_line
from oracles.sampling import quick_every
from oracles.trees import Tree
from oracles.written_out import nonlinear_line

import trunnion as tn
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.kinematics import base_motion
from trunnion.equations.linear import line_matrices

SPEED = 37.0
TIMES = (0.0, 0.013, 0.071, 0.2)


def base(assembly: Assembly, time: float, *, twisted: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles, rates and accelerations of the unknowns in the base motion."""
    topo = assembly.topology
    coefficients = assembly.coefficients(assembly.table(1, SPEED), statically_twisted=twisted)
    motion = base_motion(topo, coefficients, np.array([SPEED * time]))
    stations = [topo.reference[g] for g, c in enumerate(topo.coordinate) if c >= 0]
    return (
        motion.angle[0, 0, stations],
        motion.speed[0, 0, stations] * SPEED,
        motion.acceleration[0, 0, stations] * SPEED**2,
    )


def test_without_joints_stations_keep_their_exact_ratios() -> None:
    """Two gears in a row, a branch, and a joint that stands straight on it or none."""
    speeds = []
    for joint in ([], [tn.HookeJoint(angle=0.0)]):
        parts = [
            *(tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1, name="first"), tn.Ratio(ratio=3.0)),
            *(tn.Disk(inertia=0.2), tn.Ratio(ratio=-0.7), tn.Shaft(stiffness=2e4), tn.Disk(inertia=0.3)),
            *(tn.Shaft(stiffness=3e4, after="first"), *joint, tn.Ratio(ratio=1.1), tn.Disk(inertia=0.1)),
        ]
        assembly = assemble(tn.Driveline(parts))
        topo, tau = assembly.topology, np.linspace(0.0, 3.0, 4)
        motion = base_motion(topo, assembly.coefficients(assembly.table(2, SPEED)), tau)
        speeds.append(motion.speed[..., topo.firsts])
        for found, exact in ((motion.speed, topo.mean_speeds), (motion.relative, topo.relative_ratios)):
            assert found.shape == (2, 4, len(topo.stations)) and found == pytest.approx(
                np.broadcast_to(exact, found.shape)
            )
        for part in (motion.acceleration, motion.relative_slope, motion.relative_curvature):
            assert not part.any()
    assert np.array_equal(*speeds)


@pytest.mark.parametrize("seed", quick_every(4, range(40)))
@pytest.mark.parametrize("twisted", [False, True])
@pytest.mark.parametrize("made", [random_line, random_geared_line, random_uneven_line])
def test_matrices_are_exact_derivatives(seed: int, twisted: bool, made: Callable[[int], tn.Driveline]) -> None:
    """M, C, K and the forcing against the complex-step derivatives of the virtual work.

    Untwisted, no torque acts in the base state: matrices are those of the line without its constant loads.
    """
    line = made(seed)
    assembly, tree = assemble(line), Tree(line, SPEED)
    unloaded = Tree(line if twisted else _without_loads(line), SPEED)
    coefficients = assembly.coefficients(assembly.table(1, SPEED), statically_twisted=twisted)
    assert assembly.topology.size == tree.size
    for time in TIMES:
        state = base(assembly, time, twisted=twisted)
        found = line_matrices(assembly.topology, coefficients, np.array([SPEED * time]))
        mass, damping, stiffness = unloaded.derivatives(time, *state)
        if not twisted:
            assert np.all(coefficients.torque == 0)
        forcing = tree.residual(time, *state)
        for ours, theirs in (
            (found.mass[0, 0], mass),
            (found.damping[0, 0], damping),
            (found.stiffness[0, 0], stiffness),
            (found.forcing[0, 0], forcing),
        ):
            assert np.abs(ours - theirs).max() < 1e-11 * max(1.0, np.abs(theirs).max())


@pytest.mark.parametrize("seed", quick_every(4, range(40)))
@pytest.mark.parametrize("made", [random_line, random_uneven_line])
def test_nonlinear_equations_do_no_virtual_work(seed: int, made: Callable[[int], tn.Driveline]) -> None:
    """``acceleration`` at random states, far from the base, leaves no residual."""
    line, rng = made(seed), np.random.default_rng(seed + 1000)
    assembly, tree = assemble(line), Tree(line, SPEED)
    equations = nonlinear_line(assembly, assembly.table(1, SPEED))
    for time in TIMES:
        angle, rate, _ = base(assembly, time, twisted=False)
        assert np.abs(equations.base_angles(SPEED * time) - angle).max() < 1e-13 * max(1, np.abs(angle).max())
        angle, rate = angle + rng.normal(0, 0.5, tree.size), rate + rng.normal(0, 20.0, tree.size)
        acceleration = equations.acceleration(time, angle, rate)
        left = tree.residual(time, angle, rate, acceleration)
        size = np.abs(tree.mass(time, angle) * acceleration).max()
        assert np.abs(left).max() < 1e-11 * max(1.0, size)


@pytest.mark.parametrize("seed", quick_every(2, range(0, 40, 4)))
def test_matrices_are_finite_differences_of_acceleration(seed: int) -> None:
    """J(a)(ä − base) of the package's nonlinear equations: −C by the rates, −K by the angles."""
    line = random_line(seed)
    assembly, tree = assemble(line), Tree(line, SPEED)
    equations = nonlinear_line(assembly, assembly.table(1, SPEED))
    coefficients = assembly.coefficients(assembly.table(1, SPEED))
    time, h = 0.043, 1e-6
    angle, rate, acceleration = base(assembly, time, twisted=True)
    found = line_matrices(assembly.topology, coefficients, np.array([SPEED * time]))

    def force(angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
        return tree.mass(time, angle) * (equations.acceleration(time, angle, rate) - acceleration)

    assert force(angle, rate) == pytest.approx(found.forcing[0, 0], rel=1e-9, abs=1e-8)
    for j in range(tree.size):
        step = h * np.eye(tree.size)[j]
        by_angle = (force(angle + step, rate) - force(angle - step, rate)) / (2 * h)
        by_rate = (force(angle, rate + 1e3 * step) - force(angle, rate - 1e3 * step)) / (2e3 * h)
        assert np.abs(by_angle + found.stiffness[0, 0, :, j]).max() < 1e-6 * np.abs(found.stiffness).max()
        assert np.abs(by_rate + found.damping[0, 0, :, j]).max() < 1e-6 * max(1.0, np.abs(found.damping).max())


@pytest.mark.parametrize("seed", quick_every(4, range(40)))
def test_static_torque_balances_mean_power(seed: int) -> None:
    """Mean power into the line is the loads' mean power, whatever ratios lie between."""
    line = random_line(seed)
    assembly = assemble(line)
    topo = assembly.topology
    coefficients = assembly.coefficients(assembly.table(1, SPEED))
    ratio = np.array([float(r) for r in topo.speed_ratio])
    drawn = float(np.abs(ratio) @ coefficients.load[0])
    entering = [
        -coefficients.torque[0, e] * ratio[topo.reference[c.far_group]]
        for e, c in enumerate(topo.compliances)
        if topo.coordinate[topo.group_of(c.near)] < 0
    ]
    assert sum(entering) == pytest.approx(drawn, rel=1e-12, abs=1e-10)


@pytest.mark.parametrize("seed", quick_every(4, range(40)))
@pytest.mark.parametrize("made", [random_line, random_uneven_line])
def test_chain_kernel_integrates_the_same_matrices(seed: int, made: Callable[..., tn.Driveline]) -> None:
    """The compiled kernel and the dense integrator on the same trees, loads and angle-dependent inertia."""
    line = made(seed, steepest=0.5)
    if assemble(line).topology.period_turns() > 8:
        line = _without_odd_teeth(line)
    matrix, _, trace = chain_kernel(line, SPEED)
    dense = tn.stability(line, SPEED)
    # An error of the matrix grows in its determinant by its condition.
    allowed = 1e-12 * max(np.linalg.cond(matrix[0]), 1e3)
    assert np.linalg.slogdet(matrix[0])[1] == pytest.approx(-trace[0], abs=allowed)
    found = np.linalg.eigvals(matrix[0])
    assert np.abs(found).max() == pytest.approx(dense.spectral_radius, abs=1e-9)
    assert set_distance(found, dense.multipliers) < 1e-9


def _without_loads(line: tn.Driveline) -> tn.Driveline:
    for element, name in zip(line.elements, line.names, strict=True):
        if isinstance(element, tn.Disk):
            line = line.replace(name, load_torque=0.0)
    return line


def _without_odd_teeth(line: tn.Driveline) -> tn.Driveline:
    """31 teeth exchanged for 20, to keep the period short."""
    for element, name in zip(line.elements, line.names, strict=True):
        if isinstance(element, tn.Ratio) and element.teeth_out == 31:
            line = line.replace(name, teeth_out=20)
        elif isinstance(element, tn.Ratio) and element.teeth_out == 2:
            line = line.replace(name, teeth_in=1)
        elif isinstance(element, tn.Ratio) and element.ratio == -1.5:
            line = line.replace(name, ratio=-2.0)
    return line
