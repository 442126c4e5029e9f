"""Proved twist, rated torque, heat and acceleration against closed forms, and what is stated of them."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

K, C, J1, J2, AMPLITUDE, SPEEDS = 1e4, 40.0, 0.2, 0.8, 100.0, (60.0, 300.0)
S_T = 1.25


def peaks() -> dict[str, float]:
    """Largest values over the speeds: q̈/(1/J₁ + 1/J₂) + c q̇ + k q = −A J₂/(J₁ + J₂) e^{2iΩt}, J₂ φ̈₂ = ∓T."""
    nu, reduced = 2 * np.linspace(*SPEEDS, 40_001), J1 * J2 / (J1 + J2)
    q = np.abs(AMPLITUDE * J2 / (J1 + J2) / (K + 1j * C * nu - reduced * nu**2))
    torque = np.abs(K + 1j * C * nu) * q
    factor = np.sqrt(np.maximum(nu / (20 * np.pi), 1.0))
    values = {"peak_twist": q, "rated_torque": factor * torque, "heat": C / 2 * (nu * q) ** 2,
              "peak_torque": torque, "acceleration": torque / J2}  # fmt: skip
    return {key: float(value.max()) for key, value in values.items()}


def coupled(share: float, **more: object) -> tn.Driveline:
    """Everything that may be stated of the coupling and the load, ``share`` times the largest value."""
    true = peaks()
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": 2, "amplitude": AMPLITUDE}])
    coupling = tn.Coupling(
        name="coupling", stiffness=K, damping=C, maximum_torque=S_T * share * true["peak_torque"],
        vibratory_torque=S_T * share * true["rated_torque"], heat_rating=S_T * share * true["heat"],
    )  # fmt: skip
    limits = [tn.Limit(of="coupling", max_twist=share * true["peak_twist"], temperature_factor=S_T, **more),
              tn.Limit(of="load", max_acceleration=share * true["acceleration"])]  # fmt: skip
    return tn.Driveline([engine, coupling, tn.Disk(name="load", inertia=J2)], limits=limits)


def test_bounds_in_closed_form() -> None:
    """Every stated limit 5 % above the peak is proved, so each bound lies between both."""
    found = tn.certify_peaks(coupled(1.05), {}, SPEEDS)
    assert found.verdict == "within limits"
    for key, true in peaks().items():
        at = 1 if key == "acceleration" else 0
        bound, computed = getattr(found, f"{key}_bound")[at], getattr(found, key)[at]
        assert computed * (1 - 1e-4) <= true <= bound * (1 + 1e-9) and bound <= 1.05 * true * (1 + 1e-9), key
    assert "heat of coupling: " in str(found) and "rated torque of coupling: " in str(found)


@pytest.mark.parametrize("key", ["rated_torque", "heat", "peak_twist", "acceleration"])
def test_each_is_refuted_alone(key: str) -> None:
    """A limit 1 % below the peak is exceeded by a line of the box."""
    line = coupled(1.5)
    low = 0.99 * peaks()[key]
    if key == "rated_torque":
        line = line.replace("coupling", vibratory_torque=S_T * low)
    elif key == "heat":
        line = line.replace("coupling", heat_rating=S_T * low)
    else:
        of, stated = {"peak_twist": ("coupling", "max_twist"), "acceleration": ("load", "max_acceleration")}[key]
        limits = tuple(tn.Limit(of=one.of, **{stated: low}) if one.of == of else one for one in line.limits)
        line = line.model_copy(update={"limits": limits})
    found = tn.certify_peaks(line, {}, SPEEDS)
    assert found.verdict == "counterexample", str(found)
    assert {"rated_torque": "rated torque", "heat": "heat", "peak_twist": "largest twist"}.get(
        key, key
    ) in found.exceeded


def test_a_margin_must_stay_free() -> None:
    assert tn.certify_peaks(coupled(1.1), {}, SPEEDS).verdict == "within limits"
    assert tn.certify_peaks(coupled(1.1, margin=0.15), {}, SPEEDS).verdict == "counterexample"


def test_assess_proves_ratings_too() -> None:
    judged = tn.assess(coupled(1.5), SPEEDS)
    ratings = [f"rating: {rating} of coupling" for rating in ("maximum torque", "rated torque", "heat rating")]
    for name in (*ratings, "max twist of coupling", "max acceleration of load"):
        check = judged.check(name)
        assert check.words == "satisfied, proved", (name, check.because)
        assert check.value * (1 - 1e-9) <= check.bound <= check.limit


def test_limits_exceeded_are_named_in_words() -> None:
    """The angle in degrees, as a user reads it."""
    line = coupled(1.5)
    limits = (tn.Limit(of="coupling", max_twist=0.9 * peaks()["peak_twist"]),)
    found = tn.certify_peaks(line.model_copy(update={"limits": limits}), {}, SPEEDS)
    assert " deg in coupling" in found.exceeded
