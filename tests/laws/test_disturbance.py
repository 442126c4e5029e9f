"""What ``Stability.disturbance`` starts is what the critical multiplier says, in the true motion of the line."""

import numpy as np
import pytest

import trunnion as tn


def chain(angle: float, damping: float = 3.0) -> list[object]:
    return [
        tn.Shaft(stiffness=2e4, damping=damping),
        tn.Disk(inertia=0.3),
        tn.HookeJoint(angle=angle),
        tn.Shaft(stiffness=1.5e4, damping=damping),
        tn.Disk(inertia=0.2),
    ]


HELD = tn.Driveline([tn.ConstantSpeed(), *chain(tn.deg(2))])
UNSTABLE = tn.Driveline([tn.ConstantSpeed(), *chain(tn.deg(8), 0.05)])
FREE = tn.Driveline([tn.Disk(inertia=0.5), *chain(0.0)])


@pytest.mark.parametrize(
    ("line", "speed", "within"),
    [(HELD, 130.0, 1e-5), (HELD, 250.0, 1e-5), (UNSTABLE, 176.5, 1e-3), (FREE, 200.0, 1e-8)],
)
def test_the_difference_of_two_motions_is_multiplied_once_a_period(
    line: tn.Driveline, speed: float, within: float
) -> None:
    judged = tn.stability(line, speed)
    period = judged.period / speed
    times = period * np.arange(7)
    given = judged.disturbance(1e-5)
    n = len(judged.names)
    assert np.abs(given[:n]).max() == pytest.approx(1e-5)
    begin = tn.simulate(line, times[-1], speed=speed).at(0.0)
    run = {"speed": speed, "times": times, "tolerance": 1e-13}
    without, with_it = tn.simulate(line, **run), tn.simulate(line, start=begin + given, **run)
    critical = judged.multipliers[np.abs(np.abs(judged.multipliers) - judged.spectral_radius).argmin()]
    found = (with_it.at(times) - without.at(times)) * np.repeat([1, 1 / speed], n)
    # A real disturbance of a pair obeys x(k + 1) = 2 Re σ x(k) − |σ|² x(k − 1), of one real σ x(k + 1) = σ x(k).
    if abs(critical.imag) > 0:
        expected = 2 * critical.real * found[1:-1] - abs(critical) ** 2 * found[:-2]
    else:
        expected = critical.real * found[1:-1]
    assert np.abs(found[2:] - expected).max() < within * np.abs(found).max()


def test_an_unstable_line_s_disturbance_grows() -> None:
    assert tn.stability(UNSTABLE, 176.5).spectral_radius > 1
