"""Every public result pickles and copies: it comes back from a process pool, and answers there as before."""

from __future__ import annotations

import copy
import dataclasses
import multiprocessing
import pickle
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from typing import Any

import feature_lines
import numpy as np
import pytest
from questions import QUESTIONS

import trunnion as tn
from trunnion.systems.second_order import Spring


def own_family() -> tn.PeriodicLinearFamily:
    """Coefficients that no module has by a name."""
    two = 2.0
    return tn.PeriodicLinearFamily(
        np.pi,
        lambda tau, a, q: (np.eye(1), np.zeros((1, 1)), (a - two * q * np.cos(two * tau))[..., None, None]),
        1,
        {"a": 1.0, "q": 0.5},
    )


def own_system() -> tn.System:
    """Functions that no module has by a name, and a switch."""
    pull = 3.0
    regimes = tn.Regimes(
        names=("free", "contact"),
        guards=("x = 1",),
        guard=lambda t, x, p: (x[0] - 1.0,),
        switches=(tn.Switch("free", "x = 1", +1, "contact"), tn.Switch("contact", "x = 1", -1, "free")),
        locate=lambda t, x, p: int(x[0] > 1.0),
    )
    return tn.System.from_function(
        lambda t, x, p, regime: (x[1], p.force * np.cos(t) - 0.1 * x[1] - (x[0] if regime == 0 else pull * x[0] - 2.0)),
        2,
        parameters={"force": 0.5},
        period=2 * np.pi,
        regimes=regimes,
        compiled=False,
    )


def staged() -> tn.Driveline:
    return feature_lines.clutch(True)(feature_lines.straight())


def gap() -> tn.PiecewiseOscillator:
    return dataclasses.replace(tn.PiecewiseOscillator.gap(1.0, 1.0), force=0.5)


def limited() -> tn.Driveline:
    limits = [tn.Limit(of="rear", max_torque=5.0)]
    return tn.Driveline(feature_lines.bent().elements, limits=limits)


OWN: dict[str, Callable[[], Any]] = {
    "chart of a family": lambda: tn.stability_chart(own_family(), ("a", 0.5, 1.5, 4), ("q", 0.1, 0.4, 3)),
    "system of one's own": own_system,
    "motion of it": lambda: tn.simulate(own_system(), 3.0, start=[0.0, 0.0]),
    "motion with dry friction": lambda: tn.simulate(staged(), 0.02, speed=100.0),
    "family": own_family,
    "member": lambda: own_family().system(a=1.2),
    "duffing": lambda: tn.poincare_map(tn.reference_system("duffing"), 5, transient=2),
    "springs": lambda: tn.cubic_spring([1.0], 2.0),
    "layout": lambda: tn.layout([[0, 0, 0], [1, 0, 0], [2, 0.1, 0]], [1, 0, 0], [1, 0, 0]),
    "packed line": lambda: tn.pack(feature_lines.bent()),
    "line": feature_lines.bent,
    "assessment with limits": lambda: tn.assess(limited(), (99.0, 101.0)),
    "basins": lambda: tn.basins(gap(), np.linspace(-1.0, 1.0, 2), np.linspace(-1.0, 1.0, 2), most=20),
    "averaging": lambda: tn.averaging(gap()),
    "misfire": lambda: tn.misfire(
        feature_lines.bent().replace(
            "load", excitation=[{"order": 0.5, "amplitude": 5.0}], firing_angles=[0.0, 6.283185307179586]
        ),
        [90.0, 100.0],
    ),
    "order map": lambda: tn.order_map(tn.simulate(feature_lines.bent(), 2.0, speed=100.0)),
    "refusal": lambda: tn.InputError("must be positive", element="Shaft 1", key="stiffness", value=-1, remedy="write"),
    "refusal of a function": lambda: tn.InputError("is not a number", key="x", value=len),
    "several refusals": lambda: tn.InputError.together([tn.InputError("is a"), tn.InputError("is b", key="k")]),
    "failure": lambda: tn.ComputationError("did not converge"),
}  # fmt: skip
LONG = ("motion with dry friction", "duffing", "misfire", "order map", "assessment with limits")
QUICK = ["stability_chart", "simulate", "periodic_response", "run_up", "certify_stability"]


@cache
def computed(name: str) -> Any:
    return OWN[name]() if name in OWN else QUESTIONS[name].ask(QUESTIONS[name].line())


def answers(found: Any) -> Any:
    """What is asked of a result, beside its words: also what it computes for."""
    said: list[Any] = [re.sub(" at 0x[0-9a-f]+", "", str(found))]
    if isinstance(found, tn.InputError):
        said += [found.element, found.key, found.value, found.remedy, [str(one) for one in found.problems]]
    if hasattr(found, "to_dict"):
        said.append(found.to_dict())
    if type(found).__name__ == "StabilityChart":
        x, y = ((axis[0] + axis[-1]) / 2 for axis in (found.x, found.y))
        point = found.at(x, y)
        zoomed = found.zoom((x, found.x[-1], 3), (y, found.y[-1], 2))
        said += [
            point.spectral_radius,
            point.multipliers.tolist(),
            zoomed.spectral_radius.tolist(),
            zoomed.verdict.tolist(),
        ]
    if isinstance(found, tn.System):
        said += [
            found.rate_at(0.3, [1.1, 0.2], found.regime_at(0.3, [1.1, 0.2])).tolist(),
            found.but(force=1.0).numbers,
        ]
    if isinstance(getattr(found, "system", None), tn.System):
        said.append(found.system.rate_at(0.3, np.full(found.system.size, 1e-4)).tolist())
    if isinstance(found, tn.PeriodicLinearSystem):
        said.append(found.coefficients(np.array([0.3])).stiffness.tolist())
    if isinstance(found, Spring):
        said.append(found.force(np.array([0.3])).tolist())
    if isinstance(found, tn.PeriodicLinearFamily):
        said.append(found.matrices(np.zeros(2), {"a": np.array([2.0])})[2].tolist())
    return said


@pytest.fixture(scope="module")
def pool() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as made:
        yield made


NOW = [name for name in (*QUICK, *OWN) if name not in LONG]
EVERY = [pytest.param(name, marks=() if name in NOW else pytest.mark.slow) for name in (*QUESTIONS, *OWN)]


@pytest.mark.parametrize("name", EVERY)
def test_it_comes_back_from_a_process_pool(name: str, pool: ProcessPoolExecutor) -> None:
    found = pool.submit(computed, name).result(timeout=600)
    there = pool.submit(answered, name).result(timeout=600)
    assert repr(answers(found)) == repr(there)


def answered(name: str) -> Any:
    return answers(computed(name))


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_answers_as_the_original(name: str, way: Callable[[Any], Any]) -> None:
    found = computed(name)
    again = way(found)
    assert type(again) is type(found) and (again is not found or isinstance(found, tuple))
    assert repr(answers(again)) == repr(answers(found))


def test_copies_are_apart() -> None:
    found = computed("stability_chart")
    again = copy.deepcopy(found)
    again.spectral_radius[:] = 7.0
    assert not (found.spectral_radius == 7.0).any() and copy.copy(found).spectral_radius is found.spectral_radius
