"""Continuation on curves whose folds and lengths are known."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.numerics.continuation.arclength import Ending, correct, follow, locate

ONE = np.ones(2)


def circle(z):
    x, p = z
    return np.array([x * x + p * p - 1]), np.array([[2 * x, 2 * p]])


def cubic(z):
    """p = x³ − x: folds at x = ±1/√3, p = ∓2/(3√3)."""
    x, p = z
    return np.array([x**3 - x - p]), np.array([[3 * x * x - 1, -1.0]])


def helix(z):
    """Two unknowns: x = sin 5p, y = cos 5p."""
    x, y, p = z
    return np.array([x - np.sin(5 * p), y - np.cos(5 * p)]), np.array(
        [[1.0, 0.0, -5 * np.cos(5 * p)], [0.0, 1.0, 5 * np.sin(5 * p)]]
    )


def test_folds_of_a_cubic_to_rounding():
    curve = follow(cubic, np.array([-1.5, -1.8]), scale=ONE, bounds=(-2.0, 2.0))
    assert curve.ending is Ending.BOUND
    assert curve.z[-1, 1] == 2.0
    (_, first), (_, second) = curve.folds
    assert first.z == pytest.approx([-1 / np.sqrt(3), 2 / (3 * np.sqrt(3))], abs=1e-8)
    assert second.z == pytest.approx([1 / np.sqrt(3), -2 / (3 * np.sqrt(3))], abs=1e-8)
    assert max(abs(float(cubic(z)[0][0])) for z in curve.z) < 1e-9


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_circle_closes(direction):
    curve = follow(circle, np.array([1.0, 0.0]), scale=ONE, bounds=(-2.0, 2.0), direction=direction)
    assert curve.ending is Ending.CLOSED
    assert sorted(fold.parameter for _, fold in curve.folds) == pytest.approx([-1, 1], abs=1e-9)
    steps = np.linalg.norm(np.diff(curve.z, axis=0), axis=1)
    assert 6.0 < steps.sum() < 6.5
    assert np.sign(curve.z[1, 1]) == direction


def test_several_unknowns_without_a_fold():
    curve = follow(helix, np.array([0.0, 1.0, 0.0]), scale=np.ones(3), bounds=(0.0, 2.0), largest_step=0.2)
    assert curve.ending is Ending.BOUND
    assert not curve.folds
    assert curve.z[:, 0] == pytest.approx(np.sin(5 * curve.z[:, 2]), abs=1e-9)


def test_the_scale_changes_the_points_but_not_the_curve():
    wide = follow(cubic, np.array([-1.5, -1.8]), scale=np.array([3.0, 0.5]), bounds=(-2.0, 2.0))
    assert [fold.parameter for _, fold in wide.folds] == pytest.approx([2 / (3 * np.sqrt(3)), -2 / (3 * np.sqrt(3))])


def test_points_asked_for_and_callers_stop():
    short = follow(circle, np.array([1.0, 0.0]), scale=ONE, bounds=(-2.0, 2.0), most_points=7)
    assert short.ending is Ending.POINTS
    assert len(short.points) == 7
    seen = []
    stopped = follow(
        circle, np.array([1.0, 0.0]), scale=ONE, bounds=(-2, 2), on_point=lambda p: seen.append(p) or len(seen) == 3
    )
    assert stopped.ending is Ending.STOPPED
    assert [p.z.tolist() for p in stopped.points] == [p.z.tolist() for p in seen]


def test_a_stall_keeps_what_was_found():
    def vanishing(z):
        residual, jacobian = cubic(z)
        return (residual, jacobian) if z[0] < -0.9 else (residual * np.nan, jacobian)

    curve = follow(vanishing, np.array([-1.5, -1.8]), scale=ONE, bounds=(-2.0, 2.0))
    assert curve.ending is Ending.STALLED
    assert -0.9 - 1e-6 < curve.z[-1, 0] < -0.9


def test_nowhere_near_the_curve():
    nothing = follow(lambda z: (np.array([z[0] ** 2 + 1]), np.array([[2 * z[0], 0.0]])), np.array([3.0, 0.0]),
                     scale=ONE, bounds=(-1.0, 1.0))  # fmt: skip
    assert nothing.ending is Ending.STALLED
    assert not nothing.points


def test_any_test_function_is_located():
    a = correct(circle, np.array([1.0, 0.0]), np.array([0.0, 1.0]), scale=ONE)
    b = correct(circle, np.array([0.8, 0.6]), np.array([0.0, 1.0]), scale=ONE)
    found = locate(circle, a, b, lambda p: p.z[0] - np.cos(0.3), scale=ONE)
    assert found.z == pytest.approx([np.cos(0.3), np.sin(0.3)], abs=1e-9)
    assert locate(circle, a, b, lambda p: p.z[0] + 2, scale=ONE) is None
