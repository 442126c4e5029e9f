"""Verdicts on systems of known kind, criteria, and what is said where nothing can be decided."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.motion.chaos.certify_chaos import ChaosCertificate
from trunnion.motion.chaos.chaos_subject import clocks
from trunnion.papers.double_tripod.published import DoubleTripod
from trunnion.systems.reference import (
    dead_zone_oscillator,
    driven_pendulum,
    duffing,
    linear_oscillator,
    lorenz,
    mathieu_oscillator,
    rossler,
    ueda,
)
from trunnion.systems.system import System


@cache
def van_der_pol(force: float) -> System:
    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], p.mu * (1 - x[0] * x[0]) * x[1] - x[0] + p.force * np.cos(p.frequency * t)

    def alone(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], p.mu * (1 - x[0] * x[0]) * x[1] - x[0]

    if force == 0:
        return System.from_function(alone, ["x", "v"], parameters={"mu": 0.5}, start=[0.5, 0.0], name="van-der-pol")
    values = {"mu": 0.2, "force": force, "frequency": 1.618}
    return System.from_function(
        rate, ["x", "v"], parameters=values, period=lambda p: 2 * np.pi / p["frequency"], start=[0.5, 0.0],
        name="forced-van-der-pol",
    )  # fmt: skip


Make = Callable[[], System]
KNOWN: dict[str, tuple[Make, str, str, int]] = {
    "ueda": (ueda, "chaotic", "", 0),
    "driven pendulum, which turns over": (driven_pendulum, "chaotic", "", 0),
    "lorenz": (lorenz, "chaotic", "", 0),
    "rossler": (rossler, "chaotic", "", 0),
    "linear oscillator": (linear_oscillator, "regular", "periodic", 1),
    "duffing": (duffing, "regular", "periodic", 1),
    "dead zone": (dead_zone_oscillator, "regular", "periodic", 1),
    "rossler, period 4": (lambda: rossler(c=4.0), "regular", "periodic", 4),
    "van der pol": (lambda: van_der_pol(0.0), "regular", "periodic", 1),
    "forced van der pol, a torus": (lambda: van_der_pol(0.2), "regular", "quasi-periodic", 0),
    "undamped mathieu between tongues": (lambda: mathieu_oscillator(2.0, 0.2), "regular", "quasi-periodic", 0),
    "mathieu in its tongue": (mathieu_oscillator, "unbounded", "", 0),
    "undamped at resonance": (lambda: linear_oscillator(damping=0.0), "unbounded", "", 0),
    "lorenz at rest": (lambda: lorenz(rho=10.0), "regular", "at rest", 0),
    "decaying oscillator": (lambda: linear_oscillator(force=0.0), "regular", "periodic", 1),
}


QUICK = ("lorenz", "linear oscillator", "mathieu in its tongue", "lorenz at rest")
"""One of each verdict; of a torus there is the pendulum of ``test_shear_and_sections.py``."""


@pytest.mark.parametrize("name", quick_only(QUICK, KNOWN))
def test_known_kinds(name: str) -> None:
    make, verdict, kind, repeat = KNOWN[name]
    found = tn.certify_chaos(make(), tolerance=1e-9, sweep=False, **_effort(name))
    assert (found.verdict, found.kind, found.repeat) == (verdict, kind, repeat), str(found)


def _effort(name: str) -> dict[str, object]:
    """Chaos is plain long before its exponent is known to 2 %."""
    if name in ("ueda", "driven pendulum, which turns over"):
        return {"periods": 4000}
    if name in ("decaying oscillator", "forced van der pol, a torus"):
        return {"periods": 1500}
    return {"duration": 8000.0} if name == "rossler" else {"duration": 4000.0} if name == "van der pol" else {}


@pytest.mark.parametrize("force", [2.0, pytest.param(6.0, marks=pytest.mark.slow)])
def test_periodic_motions_of_a_chaotic_oscillator(force: float) -> None:
    found = tn.certify_chaos(ueda(force=force), 3000, sweep=False)
    assert found.verdict == "regular" and found.kind == "periodic"
    assert found.period == pytest.approx(2 * np.pi * found.repeat, rel=1e-9)


@pytest.mark.slow
def test_period_of_van_der_pol() -> None:
    found = tn.certify_chaos(van_der_pol(0.0), duration=2000.0, sweep=False)
    assert found.period == pytest.approx(6.3807, abs=2e-3)  # 2π(1 + μ²/16 − 5μ⁴/3072), μ = ½


@pytest.mark.slow
def test_which_criteria_discriminate() -> None:
    forced = tn.certify_chaos(linear_oscillator(), 500, sweep=False)
    first, second, third = forced.criteria
    assert (first.holds, first.discriminates) == (False, True)
    assert (second.holds, second.discriminates) == (True, False) and "phase" in second.why
    assert (third.holds, third.discriminates) == (True, False) and "shrink" in third.why
    rest = tn.certify_chaos(lorenz(rho=10.0), sweep=False)
    assert not rest.criteria[1].holds and rest.criteria[1].discriminates
    free = tn.certify_chaos(van_der_pol(0.0), duration=500.0, sweep=False)
    assert free.criteria[2].discriminates  # its volumes grow where |x| < 1


@pytest.mark.slow
def test_conservative_systems_preserve_volumes() -> None:
    def cubic(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -x[0] - x[0] ** 3

    free = System.from_function(cubic, ["x", "v"], start=[1.0, 0.0])
    for found in (
        tn.certify_chaos(free, duration=500.0, sweep=False),
        tn.certify_chaos(mathieu_oscillator(2.0, 0.2), 300, sweep=False),
    ):
        third = found.criteria[2]
        assert (third.holds, third.discriminates) == (False, False) and "preserved" in third.why
    assert "shrink at 0.05 1/s" in tn.certify_chaos(ueda(), 200, sweep=False).criteria[2].why


@pytest.mark.slow
def test_at_rest_on_a_saddle() -> None:
    def saddle(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], 0.5 * x[0] - 0.02 * x[1]

    system = System.from_function(saddle, ["x", "v"], start=[0.0, 0.0])
    found = tn.certify_chaos(system, duration=2000.0, starts=1, sweep=False)
    assert found.verdict == "undecided" and "unstable equilibrium" in found.reasons[0]
    second = found.criteria[1]
    assert (second.holds, second.discriminates) == (False, True) and "unstable equilibrium" in second.why
    both = tn.certify_chaos(system, duration=2000.0, sweep=False)
    assert both.verdict == "undecided" and len(both.reasons) == 3
    assert both.reasons[1].startswith("start 1: ") and "unstable" in both.reasons[1]
    assert both.reasons[2].startswith("start 2: ") and "blows up" in both.reasons[2]


@pytest.mark.slow
def test_a_phase_as_a_state_needs_no_jacobian() -> None:
    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], -0.05 * x[1] - x[0] ** 3 + 7.5 * np.cos(x[2]), p.frequency

    for compiled in (True, False):
        system = System.from_function(
            rate, ["x", "v", "phase"], parameters={"frequency": 1.0}, start=[0.0, 0.0, 0.0], compiled=compiled
        )
        assert clocks(system, np.random.default_rng(0).normal(size=(4, 3))) == {2: 1.0}
        if compiled:
            found = tn.certify_chaos(system, duration=8000.0, sweep=False)
            assert found.verdict == "chaotic", str(found)


def test_too_short_says_how_long() -> None:
    found = tn.certify_chaos(ueda(), 30, sweep=False)
    assert found.verdict == "undecided"
    assert "would decide" in found.reasons[0]
    length = int(found.reasons[0].split("about ")[1].split()[0])
    assert tn.certify_chaos(ueda(), length, sweep=False).verdict == "chaotic"


def test_between_lengths_is_undecided() -> None:
    found = tn.certify_chaos(ueda(), 150, sweep=False)
    assert found.verdict == "undecided" and "200" in found.reasons[-1]


@pytest.mark.slow
def test_starts_that_differ_are_undecided() -> None:
    """Ueda's oscillator at B = 5.5 has, by start, a chaotic and a periodic motion."""
    starts = {}
    for start in ((0.0, 0.0), (2.0, 0.0), (3.0, 4.0), (1.0, -2.0)):
        starts[start] = tn.certify_chaos(ueda(force=5.5), 1500, start=start, starts=1, sweep=False)
    kinds = {(c.verdict, c.kind) for c in starts.values()}
    both = tn.certify_chaos(ueda(force=5.5), 1500, start=list(starts), sweep=False)
    assert (both.verdict == "undecided") == (len(kinds) > 1)
    if len(kinds) > 1:
        assert "starts=1" in both.reasons[0]


@pytest.fixture(scope="module")
def pendulum() -> ChaosCertificate:
    return tn.certify_chaos(driven_pendulum(), 1000, sweep=("force", 2.0, 2.6, 4))


def test_one_figure(pendulum: ChaosCertificate) -> None:
    figure = pendulum.plot()
    portrait, exponents, few, all_points = figure.axes
    assert exponents.get_xlabel() == "force"
    counts = [len(axes.lines[0].get_xdata()) for axes in (few, all_points)]  # type: ignore[arg-type]
    assert counts[0] < counts[1] and counts[1] == len(pendulum.map.points)  # type: ignore[union-attr]
    low, high = few.get_xlim()
    assert -4 < low < high < 4  # the pendulum turns over: its angle is drawn modulo 2π
    assert portrait.get_xlabel() == "x"


def test_dataset_carries_the_verdict(pendulum: ChaosCertificate, tmp_path) -> None:  # type: ignore[no-untyped-def]
    import xarray as xr

    pendulum.data.to_netcdf(tmp_path / "c.nc", engine="h5netcdf")
    back = xr.open_dataset(tmp_path / "c.nc", engine="h5netcdf")
    assert back.attrs["verdict"] == "chaotic" and back.attrs["zero_one_test"] > 0.9
    assert "chaotic" in str(pendulum)


@pytest.mark.parametrize("sweep", [("mass", 1.0, 2.0, 3), ("force", 1.0), ("force", 2.0, 1.0, 3)])
def test_bad_sweep(sweep: object) -> None:
    with pytest.raises(tn.InputError):
        tn.certify_chaos(ueda(), 200, sweep=sweep)  # type: ignore[arg-type]


def test_intervals_as_wide_as_the_damping_decide_nothing():
    """The double tripod over 200 periods: shear alone could show ±16 1/s where all damping is 31 1/s."""
    system = DoubleTripod().system("input")
    short, longer = (tn.certify_chaos(system, periods=n, sweep=False) for n in (200, 800))
    assert (short.verdict, longer.verdict) == ("undecided", "regular")
    assert "average over" in str(short) and "periods or more" in str(short)
