"""An order of a mode in a run whose speed changes evenly, in closed form.

A mode y′ = λy + f e^{iψ}, ψ″ = nα, that has run for ever is y = f e^{iψ} ∫ e^{−(iν − λ)s + inαs²/2} ds over the past
s, which is √(π/2q) e^{z²} erfc(z) with q = −inα and z = (iν − λ)/√(2q) (Abramowitz and Stegun 7.4.2; the scaled
function is w(iz) of Faddeeva).
"""

from __future__ import annotations

import numpy as np
from scipy.special import wofz


def mode_on_run(eigenvalue: complex, order: float, speed: np.ndarray, acceleration: float) -> np.ndarray:
    """y over f e^{iψ} (speed,)."""
    root = np.sqrt(-2j * order * acceleration + 0j)
    root = np.where(root.real < 0, -root, root)
    return np.sqrt(np.pi) / root * wofz(1j * (1j * order * speed - eigenvalue) / root)


def states_on_run(
    matrix: np.ndarray, drive: np.ndarray, rate_drive: np.ndarray, order: float, speed: np.ndarray, acceleration: float
) -> np.ndarray:
    """States (speed, state) over e^{iψ} of y′ = A y + (drive + iν rate_drive) e^{iψ}, which a rotation e^{iψ} of a
    spring and a damper gives: ν as it was at each instant of the past.

    ∫ s e^{−as + ibs²/2} ds = (a I − 1)/(ib), where I is the integral without s.
    """
    eigenvalues, right = np.linalg.eig(matrix)
    constant, by_rate = (
        np.linalg.solve(right, drive.astype(complex)),
        np.linalg.solve(right, rate_drive.astype(complex)),
    )
    nu, found = order * speed, np.zeros((len(speed), len(matrix)), dtype=complex)
    for k, eigenvalue in enumerate(eigenvalues):
        now = mode_on_run(eigenvalue, order, speed, acceleration)
        past = ((1j * nu - eigenvalue) * now - 1) / (1j * order * acceleration)
        own = (constant[k] + 1j * nu * by_rate[k]) * now - 1j * order * acceleration * by_rate[k] * past
        found += own[:, None] * right[:, k]
    return found


def disk_on_run(
    stiffness: float, damping: float, inertia: float, order: float, speed: np.ndarray, acceleration: float
) -> np.ndarray:
    """Rotation of a disk behind a shaft whose other end turns by e^{iψ}."""
    matrix = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
    drive, rate = np.array([0.0, stiffness / inertia]), np.array([0.0, damping / inertia])
    return states_on_run(matrix, drive, rate, order, speed, acceleration)[:, 0]
