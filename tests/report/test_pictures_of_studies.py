"""Pictures of tolerances, comparisons, sensitivities and damping: what is drawn can be told apart and read."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import trunnion as tn
from trunnion.pictures.draw_matplotlib import settle


def plain_line(stiffness: float = 1e4, damping: float = 3.0, limit: float = 60.0) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=12e3, damping=damping, name="front"),
            tn.Disk(inertia=0.4, name="a hub whose name is as long as names in parts lists are"),
            tn.HookeJoint(angle=tn.deg(3)),
            tn.Shaft(stiffness=stiffness, damping=damping, name="rear"),
            tn.Disk(inertia=0.9, load_torque=250.0),
        ],
        limits=[tn.Limit(of="front", max_torque=limit), tn.Limit(of="rear", max_torque=limit)],
    )


@pytest.mark.parametrize("damping", [0.05, 3.0])
def test_a_distribution_far_from_the_limit_fills_its_axis(damping: float) -> None:
    """All lines are stable, and 0 many widths away."""
    line = plain_line(damping=damping)
    study = tn.tolerance_study(line, {"rear.stiffness": 0.01, "rear.damping": 1e-3 * damping}, 120.0, samples=256)
    assert study.probability == 1.0
    axes = study.plot()
    rates = study.growth_rate[0]
    low, high = axes.get_xlim()
    assert low < rates.min() and rates.max() < high < 0
    assert np.ptp(rates) > 0.8 * (high - low)
    [said] = [t.get_text() for t in axes.texts]
    widths = -rates.max() / np.ptp(rates)
    assert said.startswith("0, the limit") and float(said.split()[3]) == pytest.approx(widths, rel=0.06)
    assert not [one for one in axes.lines if np.allclose(one.get_xdata(), 0)]


def test_the_limit_is_drawn_where_lines_grow() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.3)
    study = tn.tolerance_study(line, {"Shaft 2.stiffness": 0.2}, 1.6, samples=256)
    assert 0 < study.probability < 1
    axes = study.plot()
    assert [one for one in axes.lines if np.allclose(one.get_xdata(), 0)] and not axes.texts


@pytest.mark.parametrize("limit", [60.0, 5.0])
def test_far_margins_do_not_fall_onto_one_another(limit: float) -> None:
    """Margins of −400 % to −6000 %, told apart by at least two pixels, in their order and within the frame."""
    found = tn.compare(plain_line(limit=limit), plain_line(14e3, limit=limit), (tn.rpm(600), tn.rpm(2400)))
    far = [one for one in found.of_kind("margin") if one.matters and max(abs(one.before), abs(one.after)) > 1]
    assert far
    axes = found.plot()
    settle(axes)
    rings: dict[float, list[tuple[float, float]]] = {}
    for line in (one for one in axes.lines if one.get_marker() == "o"):
        for x, row in line.get_xydata():
            rings.setdefault(row, []).append((x, axes.transData.transform((x, 0.0))[0]))
    assert len(rings) == len(axes.get_yticks())
    box, told_apart = axes.get_window_extent(), 0
    for (before, left), (after, right) in rings.values():
        assert box.x0 < min(left, right) < max(left, right) < box.x1
        if abs(before - after) > 1.0:  # percent
            assert abs(left - right) > 2
            told_apart += 1
    assert told_apart >= len(far)
    labels = [t.get_window_extent() for t in axes.get_xticklabels() if t.get_text()]
    assert all(a.x1 < b.x0 or b.x1 < a.x0 for k, a in enumerate(labels) for b in labels[:k])


@pytest.mark.parametrize("wide", [True, False])
def test_labels_of_a_tornado_stay_apart_and_inside(wide: bool) -> None:
    found = tn.sensitivity(
        plain_line(), tn.rpm(900), ["*.stiffness", "*.inertia", "*.angle", "*.damping"], of=["torques", "frequencies"]
    )
    for quantity in {one.name for one in found.quantities if found.ranked(one.name, 2)}:
        axes = found.plot(quantity) if wide else found.plot(quantity, most=3)
        figure = axes.figure
        settle(axes)
        frame = figure.bbox
        names = [t.get_window_extent() for t in axes.get_yticklabels()]
        low, high = axes.get_xlim()
        ticks = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
        numbers = [t.get_window_extent() for at, t in ticks if low <= at <= high]  # matplotlib draws no others
        assert all(box.x0 >= frame.x0 - 1 and box.x1 <= frame.x1 + 1 for box in (*names, *numbers))
        assert all(a.y0 >= b.y1 - 1 or b.y0 >= a.y1 - 1 for a, b in pairwise(names))
        assert all(b.x0 > a.x1 for a, b in pairwise(numbers))


def test_damping_over_powers_of_ten_has_a_logarithmic_axis() -> None:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1.0, damping=1e-4), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.3),
            tn.Shaft(stiffness=1.0, damping=0.005), tn.Disk(inertia=1.0),
        ]
    )  # fmt: skip
    found = tn.minimum_damping(line, (1.12774, 1.2), damping="Shaft 2.damping", maximum=0.1, rows=9)
    axes = found.plot()
    assert axes.get_yscale() == "log"
    assert axes.get_ylim() == pytest.approx(found.tongues.y_range)
    for tick in axes.get_yticklabels():
        assert "$" not in tick.get_text()
    few = tn.stable_windows(line, "Shaft 2.stiffness", 0.5, 1.5, (1.12774, 1.2), rows=5)
    assert few.plot().get_yscale() == "linear"
