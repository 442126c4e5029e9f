"""Pairs of joints in space: what cancels, and how far."""

import lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.laws import hooke


def test_equal_angles_cancel():
    result = tn.kinetostatics(lines.row([30, 30], planes=[0, 77], offsets=[13, 77], load=10.0))
    assert result.irregularity < 1e-12
    assert np.abs(result.output_speed - 1).max() < 1e-12
    assert np.abs(result.drive_torque - 10).max() < 1e-11


def test_equal_angles_a_quarter_turn_off_are_the_worst():
    """Both joints add: the output runs from cos² β to 1/cos² β."""
    beta = np.radians(20)
    slow, fast = tn.kinetostatics(lines.row([20, 20], offsets=[0, 90])).speed_ratio
    assert slow == pytest.approx(np.cos(beta) ** 2, rel=1e-12)
    assert fast == pytest.approx(1 / np.cos(beta) ** 2, rel=1e-12)


def test_spatial_pair_of_a_drawing():
    """(+15°, +7°) and (−11.5°, +12°) in side and plan view, both seen from the shaft between."""
    first, plane_1 = tn.combined_angle("15 deg", "7 deg")
    second, plane_2 = tn.combined_angle("-11.5 deg", "12 deg")
    assert np.degrees([first, second]) == pytest.approx([16.42, 16.40], abs=0.005)
    assert np.degrees([plane_1, plane_2]) == pytest.approx([24.6, 133.7], abs=0.05)

    def slope(degrees):
        return np.tan(np.radians(degrees))

    drawn = tn.layout([(0, 0, 0), (1, 0, 0)], (1, slope(15), slope(7)), (1, slope(-11.5), slope(12)))
    assert np.allclose(drawn.angles, [first, second], atol=1e-14)
    assert (drawn.planes[1] - (plane_2 - plane_1)) % np.pi == pytest.approx(0, abs=1e-12)
    result = tn.kinetostatics(drawn.driveline())
    assert np.abs(result.output_speed - 1).max() < 2e-4
    assert result.irregularity == pytest.approx(2.758e-4, rel=1e-3)


def test_layout_does_not_care_where_the_line_lies():
    """Turning and moving everything changes nothing; a mirror image turning the other way neither."""
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(5)
    for _ in range(10):
        points = np.cumsum(rng.normal(size=(4, 3)) * 0.3 + [1, 0, 0], axis=0)
        ends = rng.normal(size=(2, 3)) * 0.3 + [1, 0, 0]
        plain = tn.layout(points, *ends)
        turn = Rotation.random(random_state=1)
        moved = tn.layout(turn.apply(points) + 3, turn.apply(ends[0]), turn.apply(ends[1]))
        mirrored = tn.layout(points * [1, -1, 1], ends[0] * [1, -1, 1], ends[1] * [1, -1, 1], right_handed=False)
        for other in (moved, mirrored):
            assert np.allclose(other.angles, plain.angles, atol=1e-12)
            assert np.allclose(np.exp(1j * other.planes), np.exp(1j * plain.planes), atol=1e-12)


def test_layout_agrees_with_the_line_it_describes():
    """The line's own axes, rebuilt from angles and planes, enclose the angles of the drawing."""
    from trunnion.response.kinetostatics.chain import chain
    from trunnion.response.kinetostatics.frames import member_frames

    rng = np.random.default_rng(6)
    points = np.cumsum(rng.normal(size=(5, 3)) * 0.3 + [1, 0, 0], axis=0)
    drawn = tn.layout(points, (1, 0.2, 0), (1, 0, 0.3))
    axes = member_frames(chain(drawn.driveline()))[:, 0]
    assert np.allclose(axes @ axes.T, drawn.axes @ drawn.axes.T, atol=1e-12)


def test_straight_joint_keeps_the_plane_before_it():
    drawn = tn.layout([(0, 0, 0), (1, 0, 0), (2, 0, 0.1)], (1, 0.1, 0), (1, 0, 0.3))
    through = tn.layout([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0.1)], (1, 0.1, 0), (1, 0, 0.3))
    assert list(through.straight) == [False, True, False, False]
    assert np.allclose(through.planes[[0, 2, 3]], drawn.planes, atol=1e-12)
    assert tn.kinetostatics(through.driveline()).irregularity < 1


def initial_phases(alpha, nu, beta, start=0.0):
    """φ⁰_i1 of every joint [rad] by S2's relation (2), unwrapped: what it starts from at input angle 0."""
    phases = [start]
    for a, v, b in zip(alpha[:-1], nu, beta, strict=True):
        phases.append(b + float(hooke.law(a).at(phases[-1]).output) - v - np.pi / 2)
    return phases


def test_initial_phases_of_the_cardan_literature():
    """S2's relation (2): what our joints see at input angle 0, mod half a turn."""
    rng = np.random.default_rng(7)
    alpha, nu, beta = rng.uniform(0.1, 0.8, 4), rng.uniform(-3, 3, 3), rng.uniform(-3, 3, 3)
    start = 0.4
    line = tn.cardan_line(alpha, nu, beta, start=start)
    ours = tn.kinetostatics(line).joint_angle[:, 0]
    theirs = initial_phases(alpha, nu, beta, start)
    assert np.allclose(np.exp(2j * ours), np.exp(2j * np.array(theirs)), atol=1e-12)


def test_formulas_of_the_cardan_literature():
    """S2's (3), (5) and (6), written out for a tricardan transmission with an accelerated input."""
    alpha, nu, beta = [0.3, 0.5, 0.2], [0.4, -1.0], [2.0, 0.7]
    speed, acceleration = 3.0, 5.0
    result = tn.kinetostatics(tn.cardan_line(alpha, nu, beta), speed=speed, acceleration=acceleration)
    phi, w, eps = result.input_angle, np.full(720, speed), np.full(720, acceleration)
    for i, start in enumerate(initial_phases(alpha, nu, beta)):
        a = 1 / np.cos(alpha[i])
        chi = phi + start
        d = 1 + (a**2 - 1) * np.sin(chi) ** 2
        behind = w * a / d
        eps = (a * eps + w * behind * (1 - a**2) * np.sin(2 * chi)) / d
        turned = np.unwrap(np.arctan2(np.sin(chi) * a, np.cos(chi)))
        phi, w = turned - turned[0], behind
        assert np.allclose(result.angle[i + 1], phi, atol=1e-12)
        assert np.allclose(result.speed[i + 1], w, atol=1e-12)
        assert np.allclose(result.acceleration[i + 1], eps, atol=1e-11)


def test_angles_of_the_literature_may_be_texts():
    said = tn.cardan_line(["10 deg", "12 deg"], ["5 deg"], ["7 deg"], start="3 deg", stiffness="20 kN*m/rad")
    meant = tn.cardan_line(np.radians([10, 12]), np.radians([5]), (tn.deg(7),), start=tn.deg(3), stiffness=2e4)
    assert said == meant
