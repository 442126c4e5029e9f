"""Results that would not fit are refused before anything is computed, with the memory they would need."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.numerics import memory
from trunnion.systems.reference import duffing

HUGE = 99_999_999
LINE = tn.Driveline(
    [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.3),
     tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=0.5)]
)  # fmt: skip
SPEED, ANGLE = ("speed", 20.0, 80.0), ("HookeJoint 1.angle", 0.0, 0.5)
PLAY = tn.PiecewiseOscillator.gap(half_gap=0.5, damping=0.05, force=1.0, frequency=1.0)


def chart() -> tn.StabilityChart:
    return tn.stability_chart(LINE, (*SPEED, 4), (*ANGLE, 4))


# (what is asked, the key that is named)
HUGE_ONES = {
    "stability_chart": (lambda: tn.stability_chart(LINE, (*SPEED, HUGE), (*ANGLE, HUGE)), "chart.points"),
    "stability_chart of one long axis": (lambda: tn.stability_chart(LINE, (*SPEED, HUGE), (*ANGLE, 2)), "chart.points"),
    "zoom": (lambda: chart().zoom((30, 40, HUGE), (0.1, 0.2, HUGE)), "chart.points"),
    "on": (lambda: chart().on(np.linspace(30, 40, 100_000), np.linspace(0.1, 0.2, 100_000)), "chart.points"),
    "stable_limit": (lambda: tn.stable_limit(LINE, "HookeJoint 1.angle", [20.0, 30.0], scan=HUGE), "chart.points"),
    "sweep_speeds": (lambda: tn.sweep_speeds(LINE, 10.0, 20.0, HUGE), "points"),
    "order_response": (lambda: tn.order_response(LINE, np.linspace(20, 80, 1_000_000)), "speeds"),
    "lyapunov_map": (
        lambda: tn.lyapunov_map(duffing(), ("force", 0, 1, 50_000), ("frequency", 1, 2, 50_000)),
        "x, y",
    ),
    "lyapunov_sweep": (lambda: tn.lyapunov_sweep(duffing(), "force", (0, 1, HUGE)), "force"),
    "bifurcation_diagram": (lambda: tn.bifurcation_diagram(duffing(), "force", (0, 1, 100), points=HUGE), "points"),
    "poincare_map": (lambda: tn.poincare_map(duffing(), HUGE), "points"),
    "sweep": (lambda: tn.sweep(PLAY, np.full(HUGE // 10, 1.0)), "frequencies"),
    "basins": (lambda: tn.basins(PLAY, np.linspace(-1, 1, 9000), np.linspace(-1, 1, 9000)), "position, velocity"),
}


@pytest.mark.parametrize("name", list(HUGE_ONES))
def test_refused_before_anything_is_allocated(name: str) -> None:
    ask, key = HUGE_ONES[name]
    with pytest.raises(tn.InputError) as caught:
        ask()
    said = str(caught.value)
    assert said.startswith(f"{key} = ") and "would need" in said and "of memory, at most 2 GB is taken" in said
    assert "ask for fewer" in said and "\n" not in said


def test_what_fits_is_taken() -> None:
    assert memory.require_memory(memory.MOST, key="points", value=1, remedy="") is None
    with pytest.raises(tn.InputError, match="would need"):
        memory.require_memory(1.01 * memory.MOST, key="points", value=1, remedy="")


@pytest.mark.parametrize(("size", "said"), [(2048, "2 kB"), (3.25 * 2**30, "3.25 GB"), (5e17, "444 PB")])
def test_sizes_in_words(size: float, said: str) -> None:
    assert memory.size_text(size) == said
