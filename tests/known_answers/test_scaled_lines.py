"""A line with every inertia and torque times λ and every rate times μ answers the same but for those factors.

Dimensional analysis: with inertias λ, dampings λμ, stiffnesses and torques λμ², powers λμ³ and speeds μ times as large,
rates are μ times as large, torques λμ² times, and verdicts and shares stay. No speed of the package's own may show.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import trunnion as tn

SPEEDS = np.linspace(60.0, 150.0, 7)
ITS_OWN = ("angle of", "smallest angle of", "acceleration")
"""Rules that state speeds, angles or accelerations in units."""
Scaled = Callable[[float, float], tn.Driveline]


def driven(power: float, angle: float, corner: float | None, ratio: float = 1.0) -> Scaled:
    """A motor that drives a generator at constant power through joints."""

    def line(lam: float, mu: float) -> tn.Driveline:
        stiff, damp = lam * mu**2, lam * mu
        motor = tn.Motor(
            name="motor", inertia=0.6 * lam, breakdown_torque=450.0 * stiff, breakdown_slip=0.1, drive_share=1,
            synchronous_speed=155.0 * mu, corner_frequency=corner and corner * mu,
            excitation=[{"order": 2, "amplitude": 6.0 * stiff}],
        )  # fmt: skip
        return tn.Driveline(
            [
                motor,
                tn.Shaft(name="front", stiffness=6e4 * stiff, damping=4.0 * damp),
                tn.Disk(name="near", inertia=0.2 * lam),
                tn.Ratio(ratio=ratio),
                tn.Disk(name="far", inertia=0.3 * lam),
                tn.HookeJoint(name="joint", angle=angle),
                tn.Shaft(name="rear", stiffness=3e4 * stiff, loss_factor=0.05, loss_factor_frequency=200.0 * mu),
                tn.Generator(name="generator", inertia=2.0 * lam, power=power * stiff * mu),
            ],
            limits=[
                tn.Limit(of="front", max_torque=400.0 * stiff),
                tn.Limit(of="rear", vibratory_torque=90.0 * stiff),
            ],
        )

    return line


LINES = {
    # At 1 rad/s neither motor could carry its generator: no question asks for that speed.
    "bent": driven(9e3, 0.3, None),
    "bent, geared": driven(9e3, 0.25, None, -1.5),
    "straight, lagging": driven(12e3, 0.0, 60.0, -1.5),
    "straight": driven(12e3, 0.0, None),
}


def answers(line: tn.Driveline, lam: float, mu: float) -> dict[str, np.ndarray | str]:
    """Of every room what it says, in units of the line with λ = μ = 1."""
    torque = lam * mu**2
    modes = tn.natural_frequencies(line)
    found: dict[str, np.ndarray | str] = {
        "frequencies": modes.undamped_frequency / mu,
        "loaded": tn.campbell_diagram(line, SPEEDS * mu).frequency / mu,
    }
    for speed in (75.0, 130.0):
        judged = tn.stability(line, speed * mu)
        found[f"verdict at {speed}"] = judged.verdict.name
        found[f"growth at {speed}"] = np.array([judged.growth_rate / mu, judged.spectral_radius])
    response = tn.order_response(line, SPEEDS * mu)
    found["torques"] = np.stack([response.peak_torque, response.vibratory_torque]) / torque
    study = tn.tolerance_study(line, {"rear.stiffness": 0.1}, 75.0 * mu, samples=256)
    found["probability"] = np.array([study.probability, study.worst.growth_rate / mu])
    for check in tn.assess(line, (60.0 * mu, 150.0 * mu)).checks:
        if not check.name.startswith(ITS_OWN):
            found[f"{check.name}: status"] = check.status.name
            found[f"{check.name}: margin"] = np.array([np.nan if check.margin is None else check.margin], dtype=float)
            found[f"{check.name}: barred"] = np.ravel(check.barred) / mu
    return found


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize(("lam", "mu"), [(2.0, 1.0), (3.7, 0.31), (0.2, 2.5)])
def test_answers_scale(name: str, lam: float, mu: float) -> None:
    """Of every room, and none is refused for a speed that was not asked for."""
    line = LINES[name]
    plain, scaled = answers(line(1.0, 1.0), 1.0, 1.0), answers(line(lam, mu), lam, mu)
    assert plain.keys() == scaled.keys()
    for what, value in plain.items():
        if isinstance(value, str):
            assert scaled[what] == value, what
        else:
            np.testing.assert_allclose(scaled[what], value, rtol=2e-5, atol=1e-7, err_msg=what)
