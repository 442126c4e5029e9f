"""Systems: every reference system keeps the contract; a user's function becomes one, however it is written."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import trunnion as tn
from trunnion.systems.reference import SYSTEMS


def differenced(system: tn.System, t: float, x: np.ndarray, v: np.ndarray, regime: int) -> np.ndarray:
    rates = [system.rate_at(t, x + m * 1e-3 * v, regime) for m in (-2, -1, 1, 2)]
    return (rates[0] - 8 * rates[1] + 8 * rates[2] - rates[3]) / 12e-3


@pytest.mark.parametrize("name", SYSTEMS)
def test_reference_systems_keep_the_contract(name: str) -> None:
    """Tangents are the derivative, the divergence is its trace, and the right-hand side repeats after a period."""
    system = tn.reference_system(name)
    rng = np.random.default_rng(3)
    for regime in range(len(system.regimes.names) if system.regimes else 1):
        x, v, t = rng.normal(size=system.size), rng.normal(size=system.size), float(rng.uniform(0, 9))
        np.testing.assert_allclose(
            system.jacobian_times(t, x, v, regime), differenced(system, t, x, v, regime), atol=3e-11, rtol=1e-10
        )
        if system.divergence is not None:
            assert np.trace(system.jacobian(t, x, regime)) == pytest.approx(
                system.divergence(system.parameters), abs=1e-13
            )
        if system.forcing_period is not None:
            later = system.rate_at(t + system.forcing_period, x, regime)
            np.testing.assert_allclose(later, system.rate_at(t, x, regime), atol=1e-13)
        else:
            np.testing.assert_array_equal(system.rate_at(t, x), system.rate_at(0.0, x))
    assert name in repr(system)


def test_parameters_change_nothing_else() -> None:
    system = tn.reference_system("duffing", frequency=2.0)
    assert system.forcing_period == pytest.approx(np.pi)
    assert system.but(frequency=4.0).forcing_period == pytest.approx(np.pi / 2)
    assert system.forcing_period == pytest.approx(np.pi)
    assert system.but(frequency=4.0).rate.address == system.rate.address


def array_style(t, x, p):
    return np.array([x[1], -p[0] * x[1] - np.sin(x[0]) + p.force * np.cos(t)])


def tuple_style(t, state, p):
    angle, speed = state
    damping, force = p
    return speed, -damping * speed - np.sin(angle) + force * np.cos(t)


def list_style(t, x, p):
    return [x[1], -p.damping * x[1] - np.sin(x[0]) + p.force * np.cos(t)]


def interpreted_style(t, x, p):
    numbers = {"rate": float(str(x[1]))}  # nothing numba would compile
    return numbers["rate"], -p.damping * x[1] - np.sin(x[0]) + p.force * np.cos(t)


def jacobian(t, x, p):
    return np.array([[0.0, 1.0], [-np.cos(x[0]), -p.damping]])


@pytest.mark.parametrize(
    ("function", "exact"),
    [
        pytest.param(array_style, False, marks=pytest.mark.slow),
        (tuple_style, True),
        pytest.param(interpreted_style, False, marks=pytest.mark.slow),
        (interpreted_style, True),
        pytest.param(list_style, False, marks=pytest.mark.slow),
        pytest.param(tuple_style, False, marks=pytest.mark.slow),
        pytest.param(array_style, True, marks=pytest.mark.slow),
    ],
)
def test_a_users_function_however_written(function: Any, exact: bool) -> None:
    """All ways of writing one pendulum give one motion and one monodromy matrix."""
    system = tn.System.from_function(
        function,
        ["angle", "speed"],
        parameters={"damping": 0.1, "force": 0.4},
        period=2 * np.pi,
        jacobian=jacobian if exact else None,
    )
    assert system.compiled == (function is not interpreted_style)
    assert system.exact_tangents == exact
    known = tn.reference_system("driven-pendulum", force=0.4)
    # Its forcing is a sine: a quarter period later it is this cosine.
    image = tn.StroboscopicMap(system).apply([0.3, 0.1], np.eye(2))
    other = tn.StroboscopicMap(known, phase=np.pi / 2).apply([0.3, 0.1], np.eye(2))
    np.testing.assert_allclose(image.state, other.state, atol=2e-9)
    np.testing.assert_allclose(image.tangents, other.tangents, atol=2e-9)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"states": []}, "states"),
    ({"states": ["x", "x"]}, "twice"),
    ({"states": "xv"}, "list of names"),
    ({"states": 2, "scale": [1.0]}, "scale"),
    ({"states": 2, "scale": [1.0, 0.0]}, "scale"),
    ({"states": 2, "parameters": {"k": np.nan}}, "finite"),
    ({"states": 2, "period": 0.0}, "period"),
    ({"states": 2, "period": -1.0}, "period"),
    ({"states": 2, "period": lambda p: np.nan}, "period"),
    ({"states": 2, "start": [1.0]}, "2 finite numbers"),
    ({"states": 2, "start": [1.0, np.inf]}, "2 finite numbers"),
]


@pytest.mark.parametrize(("given", "words"), WRONG, ids=[w + str(i) for i, (_, w) in enumerate(WRONG)])
def test_wrong_descriptions_are_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(tn.InputError, match=words):
        tn.System.from_function(lambda t, x, p: (x[1], -x[0]), **given)


def test_other_refusals() -> None:
    with pytest.raises(tn.InputError, match="2 arguments where 3 or 4"):
        tn.System.from_function(lambda t, x: x, 1)
    with pytest.raises(tn.InputError, match="frequency"):
        tn.reference_system("duffing", speed=1.0)
    with pytest.raises(tn.InputError, match="lorenz"):
        tn.reference_system("lorentz")
    with pytest.raises(tn.InputError, match="must be positive"):
        tn.reference_system("duffing").but(frequency=0.0)
    with pytest.raises(tn.InputError, match="no forcing period"):
        tn.StroboscopicMap(tn.reference_system("lorenz"))
    with pytest.raises(tn.InputError, match="direction"):
        tn.SectionMap(tn.reference_system("lorenz"), tn.Event("z", 27.0))
    with pytest.raises(tn.InputError, match="one of gap, contact"):
        tn.Regimes(("gap", "contact"), ("g",), lambda t, x, p: x, (tn.Switch("gap", "g", 1, "air"),), lambda t, x, p: 0)
