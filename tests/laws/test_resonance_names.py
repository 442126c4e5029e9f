"""Resonances are named by the modes that the growing Floquet mode consists of, at any joint angle."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import periodic_linear_system


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


class Chain:
    """The same line from Hooke's formula alone: ½ k (δ_e − η δ_{e−1})² about the motion of rigid shafts."""

    def __init__(self, k: np.ndarray, c: np.ndarray, inertia: np.ndarray, angle: np.ndarray, fork: np.ndarray) -> None:
        self.k, self.c, self.inertia, self.angle, self.fork = k, c, inertia, angle, fork

    def line(self) -> tn.Driveline:
        return line(*(list(map(float, part)) for part in (self.k, self.c, self.inertia, self.angle, self.fork)))

    def matrices(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Σ k b bᵀ, Σ c b bᵀ and Σ c b b′ᵀ (time, n, n), b being the elongation by the rotations."""
        n, turn, speed = len(self.inertia), tau + self.fork[0], np.ones_like(tau)
        parts = np.zeros((3, len(tau), n, n))
        for e in range(n):
            b, slope = np.zeros((len(tau), n)), np.zeros((len(tau), n))
            b[:, e] = 1
            if e:
                beta = self.angle[e - 1]
                below = 1 - np.sin(beta) ** 2 * np.cos(turn) ** 2
                eta = np.cos(beta) / below
                b[:, e - 1] = -eta
                slope[:, e - 1] = eta * np.sin(beta) ** 2 * np.sin(2 * turn) / below * speed
                turn = np.arctan2(np.sin(turn), np.cos(turn) * np.cos(beta)) + np.pi / 2 + self.fork[e]
                speed = speed * eta
            parts[0] += self.k[e] * b[:, :, None] * b[:, None, :]
            parts[1] += self.c[e] * b[:, :, None] * b[:, None, :]
            parts[2] += self.c[e] * b[:, :, None] * slope[:, None, :]
        return parts[0], parts[1], parts[2]

    def modes(self) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies and shapes of the mean stiffness, of unit modal mass."""
        root = np.sqrt(self.inertia)
        mean = self.matrices(np.pi * np.arange(512) / 512)[0].mean(0)
        square, shape = np.linalg.eigh(mean / root[:, None] / root)
        return np.sqrt(square), shape / root[:, None]

    def growth(self, speed: float, mode: int, damping: float) -> float:
        """ln |σ| of what grows fastest where ``mode`` is damped by ``damping`` per τ, a step of order 4 at a time."""
        n, steps = len(self.inertia), 4096
        shape = self.modes()[1][:, mode]
        h = np.pi / steps
        stiffness, given, slip = self.matrices(h * np.arange(2 * steps + 1) / 2)
        a = np.zeros((2 * steps + 1, 2 * n, 2 * n))
        a[:, :n, n:] = np.eye(n)
        a[:, n:, :n] = -(stiffness / speed**2 + slip / speed) / self.inertia[:, None]
        a[:, n:, n:] = -given / speed / self.inertia[:, None] - damping * np.outer(shape, shape * self.inertia)
        carried = np.eye(2 * n)
        for m in range(steps):
            s1 = a[2 * m] @ carried
            s2 = a[2 * m + 1] @ (carried + h / 2 * s1)
            s3 = a[2 * m + 1] @ (carried + h / 2 * s2)
            carried = carried + h / 6 * (s1 + 2 * s2 + 2 * s3 + a[2 * m + 2] @ (carried + h * s3))
        return float(np.log(np.abs(np.linalg.eigvals(carried)).max()))

    def participation(self, speeds: np.ndarray) -> list[tuple[float, np.ndarray]]:
        """Of what grows fastest at each speed: |multiplier| σ, and by mode m −2 ∂ln σ / (π ∂d_m), d_m being damping of
        mode m alone, −d_m q̇_m: how far the growth per τ falls where that mode is damped.

        By left and right vector of the multiplier carried over the period, r(τ) = Φ r and l(τ) = l Φ⁻¹.
        """
        n, count = len(self.inertia), len(speeds)
        frequency, shape = self.modes()
        steps = 128 * int(np.ceil(max(256, 12 * np.pi * frequency[-1] / speeds.min()) / 128))
        h, omega = np.pi / steps, speeds[:, None, None]
        stiffness, damping, slip = self.matrices(h * np.arange(2 * steps + 1) / 2)
        inertia = self.inertia[:, None]

        def rate(i: int) -> np.ndarray:
            a = np.zeros((count, 2 * n, 2 * n))
            a[:, :n, n:] = np.eye(n)
            a[:, n:, :n] = -(stiffness[i] / omega**2 + slip[i] / omega) / inertia
            a[:, n:, n:] = -damping[i] / omega / inertia
            return a

        carried, path = np.tile(np.eye(2 * n), (count, 1, 1)), []
        for m in range(steps):
            if m % (steps // 128) == 0:
                path.append(carried)
            first, middle, last = rate(2 * m), rate(2 * m + 1), rate(2 * m + 2)
            s1 = first @ carried
            s2 = middle @ (carried + h / 2 * s1)
            s3 = middle @ (carried + h / 2 * s2)
            carried = carried + h / 6 * (s1 + 2 * s2 + 2 * s3 + last @ (carried + h * s3))
        modal = np.kron(np.eye(2), shape.T * self.inertia)
        found = []
        for b in range(count):
            values, vectors = np.linalg.eig(carried[b])
            i, along = int(np.abs(values).argmax()), np.stack(path)[:, b]
            left = np.linalg.inv(vectors)[i] @ np.linalg.inv(along) @ np.linalg.inv(modal)
            each = np.mean(left * (along @ vectors[:, i] @ modal.T), axis=0)
            found.append((float(np.abs(values[i])), 2 * each[n:].real))
        return found


def random_chain(rng: np.random.Generator) -> Chain:
    n = int(rng.integers(2, 5))
    return Chain(
        10 ** rng.uniform(3, 5, n), 10 ** rng.uniform(-2, -0.5, n), 10 ** rng.uniform(-1.5, 0.2, n),
        np.deg2rad(rng.uniform(20, 45, n - 1)), rng.uniform(0, 3, n),
    )  # fmt: skip


def names_against_participation(points: int, seed: int) -> tuple[int, int, int]:
    """Unstable points, those without a name, and those whose name a mode that takes more part contradicts."""
    rng = np.random.default_rng(seed)
    seen = unnamed = contradicted = 0
    while seen < points:
        chain = random_chain(rng)
        frequency = chain.modes()[0]
        speeds = rng.uniform(0.3, 1.2, 12) * rng.choice(frequency, 12)
        speeds = speeds[speeds > frequency[-1] / 60]
        assembly = assemble(chain.line())
        for speed, (radius, part) in zip(speeds, chain.participation(speeds) if len(speeds) else [], strict=True):
            if radius < 1.0005:
                continue
            # The equations of the line without its forced response, which takes longer than all the rest.
            found = tn.stability(periodic_linear_system(assembly, assembly.table(1, float(speed))))
            assert found.spectral_radius == pytest.approx(radius, rel=1e-3)
            seen += 1
            if found.resonance is None:
                unnamed += 1
                continue
            named = [m - 1 for m in found.resonance.modes]
            share = np.abs(part) / np.abs(part).sum()
            # What takes part by less than a tenth of the whole does not decide a name.
            contradicted += share[named].min() < np.delete(share, named).max(initial=0) - 0.1
    return seen, unnamed, contradicted


def test_participation_is_what_damping_one_mode_takes_from_the_growth() -> None:
    """The measure that names are held against, by growths at two dampings of one mode each."""
    rng = np.random.default_rng(6)
    seen = 0
    while seen < 1:
        chain = random_chain(rng)
        speed = float(rng.uniform(0.3, 1.2) * rng.choice(chain.modes()[0]))
        radius, part = chain.participation(np.array([speed]))[0]
        if radius < 1.01:
            continue
        seen += 1
        for mode in range(len(part)):
            fall = (chain.growth(speed, mode, -1e-4) - chain.growth(speed, mode, 1e-4)) / 2e-4 * 2 / np.pi
            assert fall == pytest.approx(part[mode], abs=2e-3)


def test_names_are_those_of_the_modes_that_grow() -> None:
    seen, unnamed, contradicted = names_against_participation(21, 4)
    assert contradicted == 0 and unnamed < 0.05 * seen


@pytest.mark.slow
def test_names_are_those_of_the_modes_that_grow_at_two_thousand_points() -> None:
    """1.6 % without a name and none contradicted; the rules were settled on 802 others, from seed 77."""
    seen, unnamed, contradicted = names_against_participation(2000, 20260)
    print(f"{seen} points, {unnamed} without a name, {contradicted} contradicted")
    assert contradicted == 0 and unnamed < 0.05 * seen
