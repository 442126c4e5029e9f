"""No text and no picture of a line that states its speeds in rpm says rad/s, whatever the analysis.

Datasets stay in SI and say so by their ``units``. An analysis without an entry here fails by name.
"""

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import matplotlib.text
import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.features import TABLE
from trunnion.registry import PICTURES

RAD_PER_SECOND = re.compile(r"rad/s(?! ?(\^2|²))")
LOW, MIDDLE, HIGH = tn.rpm(1400), tn.rpm(1500), tn.rpm(1600)
GRID = np.linspace(LOW, HIGH, 5)
ANGLE = "joint.angle"


@cache
def bent(end: bool = False) -> tn.Driveline:
    last = [tn.HookeJoint(name="second", angle=0.15), tn.Shaft(name="third", stiffness=1e4, damping=5)] if end else []
    elements = [
        tn.ConstantSpeed(),
        tn.Shaft(name="first", stiffness=1e4, damping=5),
        tn.Disk(name="flange", inertia=0.1, excitation=[{"order": 1, "amplitude": 5.0}], firing_angles=[0.0, np.pi]),
        tn.HookeJoint(name="joint", angle=0.2),
        tn.Shaft(name="tube", stiffness=1e4, damping=5),
        *([tn.Disk(name="fork", inertia=0.05)] if end else []),
        *last,
        tn.Disk(name="load", inertia=0.2),
    ]
    operation = tn.Operation(
        speed="1500 rpm", speed_range=["1400 rpm", "1600 rpm"],
        load_cases=[tn.LoadCase(name="pull", loads={"load": 20.0})],
    )  # fmt: skip
    return tn.Driveline(elements, operation=operation)


@cache
def geared() -> tn.Driveline:
    elements = [
        tn.ConstantSpeed(),
        tn.Shaft(name="first", stiffness=1e4, damping=5),
        tn.Disk(name="pinion", inertia=0.1, excitation=[{"order": 1, "amplitude": 5.0}]),
        tn.GearPair(
            name="mesh", teeth_in=20, teeth_out=31, module=0.003, mesh_stiffness=1e7, mesh_damping=500.0, backlash=1e-4
        ),
        tn.Disk(name="load", inertia=0.2, load_torque=20),
    ]
    return tn.Driveline(elements, operation=tn.Operation(speed="1500 rpm", speed_range=["1400 rpm", "1600 rpm"]))


QUESTIONS: dict[str, Callable[[], Any]] = {
    "natural_frequencies": lambda: tn.natural_frequencies(bent()),
    "resonance_speeds": lambda: tn.resonance_speeds(bent(), 1),
    "stability": lambda: tn.stability(bent()),
    "stability_chart": lambda: tn.stability_chart(bent(), ("speed", LOW, HIGH, 8), (ANGLE, 0.0, 0.3, 6)),
    "stable_limit": lambda: tn.stable_limit(bent(), ANGLE, [LOW, HIGH], scan=6, high=0.5),
    "tongues": lambda: tn.tongues(bent(), ("speed", LOW, HIGH), (ANGLE, 0.0, 0.6)),
    "stable_windows": lambda: tn.stable_windows(bent(), ANGLE, 0.0, 0.3, (LOW, HIGH)),
    "minimum_damping": lambda: tn.minimum_damping(bent(), (LOW, HIGH)),
    "tolerance_study": lambda: tn.tolerance_study(bent(), {ANGLE: 0.05}, speeds=[LOW, HIGH], samples=256),
    "campbell_diagram": lambda: tn.campbell_diagram(bent(), GRID),
    "assess": lambda: tn.assess(bent()),
    "envelope": lambda: tn.envelope(bent()),
    "compare": lambda: tn.compare(bent(), bent().with_load("pull")),
    "sensitivity": lambda: tn.sensitivity(bent()),
    "optimise": lambda: tn.optimise(bent(), {ANGLE: (0.1, 0.2)}, "growth rate", checks=False, designs=20),
    "certify_stability": lambda: tn.certify_stability(bent(), {ANGLE: 0.01}, speeds=(MIDDLE, MIDDLE * 1.001)),
    "speed_sweep": lambda: tn.speed_sweep(bent(), GRID),
    "order_response": lambda: tn.order_response(bent(), GRID),
    "bending_speeds": lambda: tn.bending_speeds(bent()),
    "kinetostatics": lambda: tn.kinetostatics(bent(), tn.rpm(20000)),
    "phase_forks": lambda: tn.phase_forks(bent(True)),
    "assembly_sensitivity": lambda: tn.assembly_sensitivity(bent()),
    "simulate": lambda: tn.simulate(bent(), speed=MIDDLE, turns=20),
    "periodic_response": lambda: tn.periodic_response(bent(), MIDDLE),
    "linearity_check": lambda: tn.linearity_check(bent(), MIDDLE),
    "run_up": lambda: tn.run_up(bent(), LOW, MIDDLE, acceleration=200, steady=0),
    "safe_accelerations": lambda: tn.safe_accelerations(
        bent(), LOW, MIDDLE, limit={"tube": 50.0}, accelerations=[100.0, 200.0]
    ),
    "lyapunov_spectrum": lambda: tn.lyapunov_spectrum(bent(), speed=MIDDLE, periods=20),
    "lyapunov_sweep": lambda: tn.lyapunov_sweep(bent(), "speed", GRID[:2], periods=20),
    "lyapunov_map": lambda: tn.lyapunov_map(bent(), ("speed", LOW, HIGH, 2), (ANGLE, 0.1, 0.2, 2), periods=20),
    "poincare_map": lambda: tn.poincare_map(bent(), speed=MIDDLE, points=10),
    "bifurcation_diagram": lambda: tn.bifurcation_diagram(bent(), "speed", GRID[:2], points=8),
    "certify_chaos": lambda: tn.certify_chaos(bent(), speed=MIDDLE, periods=50),
    "periodic_branch": lambda: tn.periodic_branch(bent(), "speed", LOW, MIDDLE, most_points=4),
    "harmonic_balance": lambda: tn.harmonic_balance(bent(), "speed", LOW, MIDDLE, most_points=4),
    "frequency_response": lambda: tn.frequency_response(geared(), LOW, MIDDLE, method="exact", most_points=6),
    "exact_motion": lambda: tn.exact_motion(geared(), speed=MIDDLE, duration=0.1),
    "piecewise_orbit": lambda: tn.piecewise_orbit(geared(), speed=MIDDLE),
    "piecewise_branch": lambda: tn.piecewise_branch(geared(), LOW, MIDDLE, most_points=6),
    "sweep": lambda: tn.sweep(geared(), GRID[:2]),
}


def test_every_analysis_is_asked() -> None:
    assert QUESTIONS.keys() == TABLE.keys()


@pytest.mark.parametrize("analysis", quick_only([name for name in QUESTIONS if name != "certify_chaos"], QUESTIONS))
def test_nothing_says_radians_per_second(analysis: str) -> None:
    result = QUESTIONS[analysis]()
    said = [str(result), *sentences(result), *drawn(result)]
    assert said[0] and not [text for text in said if RAD_PER_SECOND.search(text)]


def sentences(result: Any) -> Iterator[str]:
    for name in ("findings", "outcome"):
        found = getattr(result, name, ())
        yield from map(str, found if isinstance(found, tuple) else (found,))


def drawn(result: Any) -> Iterator[str]:
    """All text of all pictures that there are of ``result``."""
    for kind in type(result).__mro__:
        for name in (key.partition(".")[2] for key in PICTURES if key.startswith(f"{kind.__name__}.")):
            try:
                picture = getattr(result, name)()
            except tn.InputError:
                continue  # nothing to draw in so small a case
            figure = picture if isinstance(picture, Figure) else picture.figure
            yield from (text.get_text() for text in figure.findobj(matplotlib.text.Text))
