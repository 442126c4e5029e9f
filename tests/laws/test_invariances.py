"""What must not change the answer, and what must be there whatever the numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.chains import Chain, random_chain
from oracles.comparisons import set_distance
from oracles.package_kernels import chain_kernel
from oracles.sampling import quick_every

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.kinematics import base_motion
from trunnion.equations.linear import line_matrices


def multipliers(line: tn.Driveline, speed: float, **options: bool) -> np.ndarray:
    """Multipliers by the dense integrator."""
    return tn.stability(line, speed, **options).multipliers


CHAINS = [random_chain(np.random.default_rng(s)) for s in range(10)]
NUMBERS = quick_every(3, range(len(CHAINS)))


@pytest.mark.parametrize("angle", [0.2, 0.9])
@pytest.mark.parametrize("offset", [0.0, 0.4, -2.0])
def test_time_origin(angle: float, offset: float) -> None:
    """The first joint's fork offset only says when the clock starts."""
    paper = multipliers(tn.catalogue("two-shaft-cardan", angle=angle), 1.1)
    turned = multipliers(tn.catalogue("two-shaft-cardan", angle=angle, fork_offset=offset), 1.1)
    assert set_distance(paper, turned) < 1e-11


@pytest.mark.parametrize("number", NUMBERS)
def test_time_origin_of_chains(number: int) -> None:
    """Turning all forks of the first shaft turns nothing else, unless a gear stands between joints."""
    chain = replace(CHAINS[number], teeth=[])
    offset = [chain.fork_offset[0] + 1.234, *chain.fork_offset[1:]]
    here = multipliers(chain.line(), chain.speed)
    assert set_distance(here, multipliers(replace(chain, fork_offset=offset).line(), chain.speed)) < 1e-10


@pytest.mark.parametrize("number", NUMBERS)
def test_units(number: int) -> None:
    """Mass unit × 7 and time unit × 1/300: the same multipliers."""
    chain, heavy, fast = CHAINS[number], 7.0, 300.0
    other = Chain(
        speed=chain.speed * fast,
        stiffness=[k * heavy * fast**2 for k in chain.stiffness],
        damping=[c * heavy * fast for c in chain.damping],
        inertia=[j * heavy for j in chain.inertia],
        angle=chain.angle,
        fork_offset=chain.fork_offset,
        plane=chain.plane,
        teeth=chain.teeth,
        load=[m * heavy * fast**2 for m in chain.load],
    )
    here, there = tn.stability(chain.line(), chain.speed), tn.stability(other.line(), other.speed)
    assert set_distance(here.multipliers, there.multipliers) < 1e-11
    assert there.growth_rate == pytest.approx(here.growth_rate * fast, rel=1e-6)
    assert here.response is not None and there.response is not None
    assert there.response.twist_amplitude == pytest.approx(here.response.twist_amplitude, rel=1e-8)


@pytest.mark.parametrize("name", ["two-shaft-cardan", "three-shaft-cardan"])
def test_dimensional_twin(name: str) -> None:
    """The papers' lines with k₁ = 12 kN m/rad, J₁ = 0.4 kg m² at speeds × √(k₁/J₁)."""
    unit = np.sqrt(1.2e4 / 0.4)
    for speed in (0.31, 0.9, 1.6):
        plain = tn.catalogue(name)
        twin = tn.catalogue(name, stiffness=1.2e4, inertia=0.4)
        assert set_distance(multipliers(plain, speed), multipliers(twin, speed * unit)) < 1e-11
        assert tn.natural_frequencies(twin).undamped_frequency == pytest.approx(
            unit * tn.natural_frequencies(plain).undamped_frequency, rel=1e-12
        )
        a, b = chain_kernel(plain, speed)[0], chain_kernel(twin, speed * unit)[0]
        assert set_distance(np.linalg.eigvals(a[0]), np.linalg.eigvals(b[0])) < 1e-9


def three_disks(**second: float) -> tn.Driveline:
    """Two joints of 30° with the intermediate shaft's forks in line, unless ``second`` says otherwise."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0, damping=0.01, fork_offset=0.7),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=tn.deg(30)),
            tn.Shaft(stiffness=2.0, damping=0.01, fork_offset=second.get("fork_offset", 0.0)),
            tn.Disk(inertia=0.5),
            tn.HookeJoint(angle=second.get("angle", tn.deg(30)), plane=second.get("plane", 0.0)),
            tn.Shaft(stiffness=1.5, damping=0.01),
            tn.Disk(inertia=2.0),
        ]
    )


def last_disk(line: tn.Driveline) -> tuple[np.ndarray, np.ndarray]:
    """Base speed of the last disk over a turn and the forcing on it."""
    assembly, tau = assemble(line), np.linspace(0, 2 * np.pi, 50)
    coefficients = assembly.coefficients(assembly.table(1, 1.0))
    motion = base_motion(assembly.topology, coefficients, tau)
    return motion.speed[0, :, -1], line_matrices(assembly.topology, coefficients, tau).forcing[0, :, -1]


def test_homokinetic_assembly() -> None:
    """Equal angles, forks in line, one plane: constant speed and no excitation behind the second joint."""
    speed, forcing = last_disk(three_disks())
    assert np.abs(speed - 1).max() < 1e-14 and np.abs(forcing).max() < 1e-13


@pytest.mark.parametrize("pair", [(0.6, 0.6), (-1.0, -1.0), (0.0, np.pi), (np.pi, 0.0)])
def test_fork_offset_makes_up_for_planes(pair: tuple[float, float]) -> None:
    """ν = ϑ modulo half a turn cancels."""
    speed, _ = last_disk(three_disks(fork_offset=pair[0], plane=pair[1]))
    assert np.abs(speed - 1).max() < 1e-13


@pytest.mark.parametrize("change", [{"fork_offset": np.pi / 2}, {"plane": 0.3}, {"angle": 0.4}])
def test_other_assemblies_do_not_cancel(change: dict[str, float]) -> None:
    speed, forcing = last_disk(three_disks(**change))
    assert np.abs(speed - 1).max() > 0.05 and np.abs(forcing).max() > 0.05


def test_crossed_forks_are_the_worst() -> None:
    """90° between the forks doubles the irregularity to first order: β_eq² = β₁² + β₂²."""
    offsets = np.linspace(0, np.pi, 37)
    swing = [np.ptp(last_disk(three_disks(fork_offset=float(o)))[0]) for o in offsets]
    assert int(np.argmax(swing)) == 18
    small = three_disks(fork_offset=np.pi / 2).replace("HookeJoint 1", angle=0.02).replace("HookeJoint 2", angle=0.02)
    assert np.ptp(last_disk(small)[0]) == pytest.approx(0.02**2 + 0.02**2, rel=1e-3)


def test_rigid_homokinetic_pair_is_an_ideal_joint() -> None:
    """Two equal joints in one group with nothing between: constant coefficients."""

    def line(joints: list[Any]) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1.0, damping=0.02, fork_offset=0.3),
                tn.Disk(inertia=1.0, load_torque=0.1),
                *joints,
                tn.Shaft(stiffness=0.7, damping=0.03),
                tn.Disk(inertia=0.6, load_torque=-0.02),
            ]
        )

    pair, ideal = [tn.HookeJoint(angle=0.8), tn.HookeJoint(angle=0.8)], [tn.IdealJoint(angle=0.8)]
    reference = multipliers(line([]), 0.9)
    assert set_distance(multipliers(line(ideal), 0.9), reference) < 1e-13
    assert set_distance(multipliers(line(pair), 0.9), reference) < 1e-10
    matrices = np.linalg.eigvals(chain_kernel(line(pair), 0.9)[0][0])
    assert set_distance(matrices, reference) < 1e-9


@pytest.mark.parametrize("number", NUMBERS)
def test_straight_joints_are_no_joints(number: int) -> None:
    chain = replace(CHAINS[number], teeth=[])
    bare = replace(chain, angle=[0.0] * (chain.size - 1))
    straight = [
        e.model_copy(update={"angle": 0.0}) if isinstance(e, tn.HookeJoint) else e for e in chain.line().elements
    ]
    here = multipliers(tn.Driveline(straight), chain.speed)
    assert set_distance(here, multipliers(bare.line(), chain.speed)) < 1e-11


def test_small_angles_act_with_their_fourth_power() -> None:
    """Away from resonance the excitation, of order β², moves multipliers in second order only."""
    reference = multipliers(tn.catalogue("two-shaft-cardan", angle=0.0), 0.77)
    far = [
        set_distance(multipliers(tn.catalogue("two-shaft-cardan", angle=b), 0.77), reference)
        for b in (0.1, 0.05, 0.025)
    ]
    assert far[0] / far[1] == pytest.approx(16, rel=0.02) and far[1] / far[2] == pytest.approx(16, rel=0.02)


def test_negative_angle_bends_the_other_way() -> None:
    """−β is the same joint seen from the other side."""
    here = multipliers(tn.catalogue("three-shaft-cardan", angle_1=0.3, angle_2=0.5), 0.8)
    there = multipliers(tn.catalogue("three-shaft-cardan", angle_1=-0.3, angle_2=0.5), 0.8)
    assert set_distance(here, there) < 1e-13


def test_massless_shafts_in_series() -> None:
    """Proportional damping: the pair equals one shaft with 1/k = Σ 1/k_i and the same c/k."""

    def line(shafts: list[tn.Shaft]) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1.0, damping=0.01),
                tn.Disk(inertia=1.0),
                tn.HookeJoint(angle=0.5),
                *shafts,
                tn.Disk(inertia=2.0, load_torque=0.05),
                tn.HookeJoint(angle=0.4),
                tn.Shaft(stiffness=0.9, damping=0.02),
                tn.Disk(inertia=0.7, load_torque=0.02),
            ]
        )

    two = [
        tn.Shaft(stiffness=3.0, damping=0.06, fork_offset=0.5),
        tn.Shaft(stiffness=1.5, damping=0.03, fork_offset=-0.2),
    ]
    one = [tn.Shaft(stiffness=1.0, damping=0.02, fork_offset=0.3)]
    a, b = tn.stability(line(two), 0.8), tn.stability(line(one), 0.8)
    assert set_distance(a.multipliers, b.multipliers) < 1e-13
    assert a.response is not None and b.response is not None
    assert a.response.torque == pytest.approx(b.response.torque, abs=1e-12)


def test_tooth_numbers_are_a_ratio() -> None:
    def line(ratio: tn.Ratio) -> tn.Driveline:
        chain = random_chain(np.random.default_rng(3), shafts=3, plain=True)
        elements = list(chain.line().elements)
        place = max(i for i, e in enumerate(elements) if isinstance(e, tn.Disk)) - 1
        return tn.Driveline([*elements[:place], ratio, *elements[place:]])

    teeth, plain = line(tn.Ratio(teeth_in=10, teeth_out=25)), line(tn.Ratio(ratio=2.5))
    assert set_distance(multipliers(teeth, 0.9), multipliers(plain, 0.9)) < 1e-14


def test_gear_reduces_what_lies_behind_it() -> None:
    """Behind a ratio N without joints: inertia/N², stiffness/N², damping/N² and load/N."""

    def line(ratio: float) -> tn.Driveline:
        n = ratio
        gear = [tn.Ratio(ratio=n)] if n != 1 else []
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1.0, damping=0.01, fork_offset=0.4),
                tn.Disk(inertia=1.0),
                tn.HookeJoint(angle=0.5),
                tn.Shaft(stiffness=0.9, damping=0.02),
                tn.Disk(inertia=0.7),
                *gear,
                tn.Shaft(stiffness=0.8 * n**2, damping=0.015 * n**2),
                tn.Disk(inertia=1.1 * n**2, load_torque=0.03 * abs(n)),
            ]
        )

    for ratio in (4.1, -2.0, 0.5):
        assert set_distance(multipliers(line(ratio), 0.7), multipliers(line(1.0), 0.7)) < 1e-12


@pytest.mark.parametrize("number", NUMBERS)
def test_undamped_chains_are_symplectic(number: int) -> None:
    """Without damping, loaded or not: multipliers in pairs σ, 1/σ and determinant 1."""
    chain = replace(CHAINS[number], damping=[0.0] * CHAINS[number].size)
    result = tn.stability(chain.line(), chain.speed)
    found = result.multipliers
    assert set_distance(found, 1 / found) < 1e-8 * result.spectral_radius
    assert abs(np.log(np.abs(found)).sum()) < 1e-10
    assert result.verdict.name in ("MARGINAL", "UNSTABLE")
    matrix, _, trace = chain_kernel(chain.line(), chain.speed)
    assert np.linalg.det(matrix[0]) == pytest.approx(1, abs=1e-9) and trace[0] == 0


@pytest.mark.parametrize("kernel", ["dense", "chain"])
@pytest.mark.parametrize(("angle", "speed"), [(0.3, 3.0), (0.7, 0.37), (1.1, 0.9), (1.1, 3.0)])
def test_undamped_line_with_a_disk_behind_its_joint_is_marginal(kernel: str, angle: float, speed: float) -> None:
    """Angle-dependent inertia gives M⁻¹C = J′w/J of mean zero: no damping, so marginal, not undecided."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=angle),
            tn.Disk(inertia=0.4),
            tn.Shaft(stiffness=1.0),
            tn.Disk(inertia=0.6),
        ]
    )
    if kernel == "dense":
        assert tn.stability(line, speed).verdict.name == "MARGINAL"
    else:
        chart = tn.stability_chart(line, x=("speed", speed, speed, 1), y=("Disk 1.inertia", 1.0, 1.0, 1))
        assert np.all(chart.verdict == 2)


def test_free_line_keeps_its_rigid_body_pair() -> None:
    line = tn.Driveline(
        [tn.Disk(inertia=1.0), tn.Shaft(stiffness=1.0, damping=0.05), tn.Disk(inertia=2.0), tn.IdealJoint()]
    )
    result = tn.stability(line, 1.0)
    assert result.set_aside == 2 and result.verdict.name == "STABLE"
    assert np.sort(np.abs(result.multipliers - 1))[:2].max() < 1e-6
    decay = 0.05 * (1 + 1 / 2) / 2
    assert result.growth_rate == pytest.approx(-decay, rel=1e-9)
