"""The Mathieu oscillator y″ + 2ζy′ + (a − 2q cos 2x) y = 0, period π.

Its printed characteristic values stand in ``tests/published``.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import trunnion as tn
from trunnion.systems.reference import mathieu


@pytest.mark.parametrize(("a", "verdict"), [(1.2, "MARGINAL"), (1.0, "UNSTABLE")])
def test_undamped_verdict(a: float, verdict: str) -> None:
    """q = 0.1: a = 1 lies between b₁ and a₁, a = 1.2 outside."""
    result = tn.stability(mathieu(a, 0.1))
    assert result.verdict.name == verdict
    assert np.prod(result.multipliers).real == pytest.approx(1, abs=1e-11)


PRECISE = {
    (1.2, 0.6, 0.05): (-2.2803450955772008, 0.7304026910486456),
    (4.1, 1.5, 0.01): (2.0742127212708896, 0.9391013674242926),
    (0.3, 0.4, 0.2): (-0.38708965902764631, 0.28460954333602926),
}
"""(a, q, ζ): trace and determinant of Z, from ``_taylor`` with 40 digits."""


@pytest.mark.parametrize(("a", "q", "zeta"), PRECISE)
def test_damped_against_high_precision(a: float, q: float, zeta: float) -> None:
    trace, determinant = PRECISE[a, q, zeta]
    result = tn.stability(mathieu(a, q, zeta), tolerance=1e-12)
    assert result.multipliers.sum().real == pytest.approx(trace, abs=2e-12)
    assert np.prod(result.multipliers).real == pytest.approx(determinant, abs=2e-12)
    roots = np.abs(np.roots([1, -trace, determinant]))
    assert abs(result.spectral_radius - roots.max()) <= result.error_estimate + 1e-15
    again = _taylor(a, q, zeta)
    assert [float(v) for v in again] == pytest.approx([trace, determinant], abs=1e-15)


def _taylor(a: float, q: float, zeta: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Trace and determinant of Z by 80-term power series over 32 equal steps, in 40 digits."""
    with mpmath.workdps(40):
        steps, terms = 32, 80
        h, x = mpmath.pi / steps, mpmath.mpf(0)
        columns = [[mpmath.mpf(1), mpmath.mpf(0)], [mpmath.mpf(0), mpmath.mpf(1)]]
        a, q, zeta = mpmath.mpf(a), mpmath.mpf(q), mpmath.mpf(zeta)
        for _ in range(steps):
            cosine, sine = [mpmath.cos(2 * x)], [mpmath.sin(2 * x)]
            for m in range(terms):
                cosine.append(-2 * sine[m] / (m + 1))
                sine.append(2 * cosine[m] / (m + 1))
            after = []
            for y, rate in columns:
                series = [y, rate]
                for m in range(terms):
                    force = a * series[m] - 2 * q * mpmath.fsum(cosine[j] * series[m - j] for j in range(m + 1))
                    series.append(-(2 * zeta * (m + 1) * series[m + 1] + force) / ((m + 1) * (m + 2)))
                powers = [h**m for m in range(len(series))]
                after.append(
                    [
                        mpmath.fdot(series, powers),
                        mpmath.fsum(m * series[m] * powers[m - 1] for m in range(1, len(series))),
                    ]
                )
            columns, x = after, x + h
        (p, r), (s, t) = columns
        return p + t, p * t - r * s
