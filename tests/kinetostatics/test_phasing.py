"""Fork phasing: what can be cancelled is, what cannot is known beforehand, and errors cost what they cost."""

import lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.response.kinetostatics import equivalent, phasor_angle
from trunnion.response.kinetostatics.chain import chain
from trunnion.results.finding import Gravity


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("joints", [1, 3, 6])
def test_any_row_of_joints_is_one_joint(joints, seed):
    """The product of matrices against the walk through the turn."""
    rng = np.random.default_rng(seed)
    line = lines.row(*(list(rng.uniform(a, b, joints)) for a, b in ((3, 40), (-180, 180), (-90, 90))))
    product = equivalent.matrices(chain(line), 1)
    result = tn.kinetostatics(line)
    assert equivalent.irregularity(product)[0] == pytest.approx(result.irregularity, rel=1e-7)
    assert np.linalg.det(product[0]) == pytest.approx(1, abs=1e-13)


def test_small_angles_combine_as_phasors():
    line = lines.row([2, 3, 1.5], planes=[0, 40, -70], offsets=[10, 25, 60])
    rule = phasor_angle(*equivalent.phasors(chain(line)))
    assert rule == pytest.approx(tn.kinetostatics(line).equivalent_angle, rel=2e-3)


def test_two_joints_take_the_plane_as_offset():
    found = tn.phase_forks(lines.row([20, 20], planes=[0, 33], offsets=[0, 71]))
    assert found.offsets["Shaft 2"] == pytest.approx(np.radians(33), abs=1e-9)
    assert found.irregularity < 1e-12
    assert tn.kinetostatics(found.line).irregularity < 1e-12
    assert found.bound == 0


@pytest.mark.parametrize(
    "angles", [(20, 15), (10, 20, 17), (5, 25, 8), (18, 20, 17), (10, 20, 17, 12), (10, 20, 17, 12, 30, 25)]
)
def test_the_best_phasing_reaches_the_bound(angles):
    """ln sec β_eq = max(0, largest − sum of the others), by a search that does not know it."""
    rng = np.random.default_rng(len(angles))
    n = len(angles)
    line = lines.row(list(angles), list(rng.uniform(-90, 90, n)), list(rng.uniform(-90, 90, n)))
    found = tn.phase_forks(line)
    rapidity = -np.log(np.cos(np.radians(angles)))
    rest = max(0.0, 2 * rapidity.max() - rapidity.sum())
    assert found.bound == pytest.approx(2 * np.sinh(rest), abs=1e-15)
    assert found.irregularity == pytest.approx(found.bound, abs=1e-9)
    assert tn.kinetostatics(found.line).irregularity == pytest.approx(found.bound, abs=1e-9)
    assert found.irregularity <= found.before


def test_phasing_does_not_lose_against_a_fine_grid():
    """Three joints, all offsets in steps of a degree."""
    line = lines.row([12, 25, 9], planes=[0, 50, 20])
    train = chain(line)
    steps = np.radians(np.arange(0, 180, 1.0))
    grid = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
    shafts = dict(zip(train.shafts[1:3], grid.T, strict=True))
    best = equivalent.irregularity(equivalent.matrices(train, len(grid), fork_offset=shafts)).min()
    assert tn.phase_forks(line).irregularity <= best + 1e-13


def test_splines():
    line = lines.row([20, 18, 15], planes=[0, 33, 50])
    found = tn.phase_forks(line, pitch="10 deg")
    for offset in found.offsets.values():
        assert np.degrees(offset) / 10 == pytest.approx(round(np.degrees(offset) / 10), abs=1e-9)
    train = chain(line)
    steps = np.radians(np.arange(0, 180, 10.0))
    grid = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
    shafts = dict(zip(train.shafts[1:3], grid.T, strict=True))
    best = equivalent.irregularity(equivalent.matrices(train, len(grid), fork_offset=shafts)).min()
    assert found.irregularity == pytest.approx(best, rel=1e-12)
    free = tn.phase_forks(line)
    assert free.irregularity < found.irregularity < found.before
    mixed = tn.phase_forks(line, pitch={"Shaft 3": "10 deg"})
    tenths = np.degrees(mixed.offsets["Shaft 3"]) / 10
    assert tenths == pytest.approx(round(tenths), abs=1e-9)
    assert free.irregularity <= mixed.irregularity <= found.irregularity


@pytest.mark.parametrize(
    ("pitch", "splines"), [("10 deg", 36), (2 * np.pi / 46, 46), ("7.826 deg", 46), ("24 deg", 15)]
)
def test_pitch_is_a_whole_part_of_a_turn(pitch, splines):
    """Its rounding on a drawing is taken out."""
    found = tn.phase_forks(lines.row([20, 18], planes=[0, 33]), pitch)
    assert found.pitch == pytest.approx(2 * np.pi / splines, rel=1e-14)
    places = np.array(list(found.offsets.values())) / found.pitch
    assert places == pytest.approx(np.round(places), abs=1e-9)


@pytest.mark.slow
def test_phasing_with_a_tripod_is_sampled():
    """No matrix for a tripod: the search walks the turn instead, and still cancels the Hooke's joints."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5),
            tn.HookeJoint(angle="15 deg"),
            tn.Shaft(stiffness=1e5, fork_offset="20 deg"),
            tn.HookeJoint(angle="15 deg"),
            tn.Shaft(stiffness=1e5),
            tn.TripodJoint(angle="10 deg", radius=0.03, length=0.6),
            tn.Disk(inertia=1),
        ]
    )
    found = tn.phase_forks(line)
    assert found.bound is None
    assert found.irregularity < 1.2 * 6 * 0.5 * 0.05 * np.tan(np.radians(10)) * np.tan(np.radians(5)) ** 2
    assert found.before > 0.02


def test_sensitivity_against_changed_lines():
    line = tn.phase_forks(lines.row([10, 20, 17], planes=[0, 20, 50])).line
    found = tn.assembly_sensitivity(line, "0.5 deg")
    assert found.nominal == pytest.approx(tn.kinetostatics(line).irregularity, rel=1e-6)
    for name, below, above in zip(found.names, found.below, found.above, strict=True):
        owner, key = name.rsplit(".", 1)
        value = getattr(line.elements[line.index(owner)], key)
        for change, irregularity in ((-1, below), (1, above)):
            changed = line.replace(owner, **{key: value + change * np.radians(0.5)})
            assert tn.kinetostatics(changed).irregularity == pytest.approx(irregularity, rel=1e-6)
    assert found.worst >= max(found.below.max(), found.above.max())
    assert "HookeJoint 1.plane" not in found.names


def test_limits_are_sentences():
    line = lines.row([5, 4], load=100.0)
    bearings = [("Shaft 1", -0.4, -0.1), ("Shaft 3", 0.1, 0.4)]
    result = tn.kinetostatics(line, speed=tn.rpm(2000), supports=bearings, lengths={"Shaft 2": 0.8})
    assert [f.gravity for f in tn.check_limits(result)] == [Gravity.CAUTION]
    failed = str(tn.check_limits(result)[0])
    assert "fail: irregularity of the output 0.002747 is 1.02 times the limit of 0.0027" in failed
    found = tn.check_limits(
        result,
        irregularity=0.003,
        output_acceleration=50,
        shaft_acceleration=500,
        deviation="0.1 deg",
        secondary_couple="5 N*m",
        support_force=1e4,
    )
    assert found[0].gravity == Gravity.CAUTION
    assert found[-1].gravity == Gravity.NOTE
    assert all(f.sentence.startswith(("pass: ", "fail: ")) for f in found)
    assert sum("bearing" in f.sentence for f in found) == 4
    assert sum("acceleration of Shaft" in f.sentence for f in found) == 1
    assert tn.check_limits(result, irregularity=None) == ()
