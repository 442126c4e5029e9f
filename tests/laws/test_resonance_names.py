"""Resonances are named by the modes that the growing Floquet mode consists of, at any joint angle."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def line(stiffness: list[float], damping: list[float], inertia: list[float], angle: list[float], fork: list[float]):
    elements: list[object] = [tn.ConstantSpeed()]
    for i, (k, c, j, f) in enumerate(zip(stiffness, damping, inertia, fork, strict=True)):
        elements += [tn.Shaft(stiffness=k, damping=c, fork_offset=f), tn.Disk(inertia=j)]
        elements += [tn.HookeJoint(angle=angle[i])] if i < len(angle) else []
    return tn.Driveline(elements)


@pytest.mark.parametrize("speed", [675.0, 681.0])
def test_one_tongue_has_one_name(speed: float) -> None:
    """Within one tongue a review found two names, one of a mode that carries nothing."""
    steep = line(
        [3410, 4130, 87900, 13900], [0.0439, 0.0532, 1.13, 0.179], [0.0598, 1.24, 0.1, 0.179],
        list(np.deg2rad([40, 39, 24])), [0, np.pi / 2, 0, np.pi / 2],
    )  # fmt: skip
    assert str(tn.stability(steep, speed).resonance) == "sum (ω₂+ω₄)/2"


def participation(found: tn.Stability, modes: tn.NaturalFrequencies, mass: np.ndarray) -> np.ndarray:
    """Shares of the energy by mode of the straight line, of the critical Floquet mode where the period begins."""
    n = len(mass)
    shapes = modes.shape / np.sqrt(np.einsum("im,i,im->m", modes.shape, mass, modes.shape))
    state = found.floquet_modes[:, 0]
    q, rate = shapes.T @ (mass * state[:n]), shapes.T @ (mass * state[n:]) * found.speed
    held = np.abs(rate) ** 2 + np.abs(modes.frequency * q) ** 2
    return np.asarray(held / held.sum())


def check_names(points: int) -> None:
    rng = np.random.default_rng(1)
    seen = unnamed = 0
    while seen < points:
        n = int(rng.integers(2, 5))
        inertia = 10 ** rng.uniform(-1.5, 0.2, n)
        case = line(
            list(10 ** rng.uniform(3, 5, n)), list(10 ** rng.uniform(-2, -0.5, n)), list(inertia),
            list(np.deg2rad(rng.uniform(20, 45, n - 1))), list(rng.uniform(0, 3, n)),
        )  # fmt: skip
        modes = tn.natural_frequencies(case)
        for speed in rng.uniform(0.3, 1.2, 6) * rng.choice(modes.frequency, 6):
            found = tn.stability(case, float(speed))
            if found.verdict.name != "UNSTABLE":
                continue
            seen += 1
            if found.resonance is None:
                unnamed += 1
                continue
            share = participation(found, modes, inertia)
            named = [m - 1 for m in found.resonance.modes]
            # At one instant and by modes of the straight line, so roughly: by energy, or by energy over frequency.
            # The modes of a sum hold energies as their frequencies.
            action = share / modes.frequency / np.sum(share / modes.frequency)
            least = 0.1 * modes.frequency[named] / modes.frequency[named].sum()
            held = max(share[named].sum(), action[named].sum())
            assert held > 0.4 and np.all(share[named] > least), (str(found.resonance), share)
    assert unnamed <= 0.05 * seen


def test_names_are_those_of_the_modes_that_grow() -> None:
    check_names(25)
