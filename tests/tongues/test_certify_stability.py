"""Certificates: nothing is proved that is not so, counterexamples are ones, and bounds bound."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.analyses.tolerance import lyapunov
from trunnion.analyses.tolerance.bounds import over_boxes, ratios
from trunnion.analyses.tolerance.lyapunov import _Model, judge_boxes
from trunnion.equations.coefficients import assemble
from trunnion.equations.linear import periodic_linear_system
from trunnion.results.verdict import Verdict

LINE = tn.catalogue("two-shaft-cardan", angle=0.2, damping_ratio=0.02)
THREE = tn.catalogue("three-shaft-cardan", damping_ratio=0.02)


@pytest.mark.parametrize("line", [LINE, THREE], ids=["two shafts", "three shafts"])
def test_the_model_is_the_line(line: tn.Driveline) -> None:
    """A(τ) that is bounded has the multipliers' equations: the package's own matrices, scaled back."""
    assembly = assemble(line)
    table = assembly.table(1, 1.3)
    co = over_boxes(assembly, table, table)
    tau = np.linspace(0, np.pi, 17)
    at = ratios(assembly, table, co, tau)
    a = _Model.of(assembly, co).matrix(at.b, at.slope)[0]
    system = periodic_linear_system(assembly, table).coefficients(tau)
    n = a.shape[1] // 2
    mass = system.mass
    whole = np.zeros_like(a)
    whole[:, :n, n:] = np.eye(n)
    whole[:, n:, :n], whole[:, n:, n:] = (
        -np.linalg.solve(mass, system.stiffness),
        -np.linalg.solve(mass, system.damping),
    )
    for mine, theirs in zip(a, whole, strict=True):
        assert np.sort_complex(np.linalg.eigvals(mine)) == pytest.approx(
            np.sort_complex(np.linalg.eigvals(theirs)), rel=1e-9
        )


def test_bounds_hold_within_boxes() -> None:
    """Random lines in a box differ from its middle by no more than first order and remainder."""
    assembly = assemble(LINE)
    low, high = assembly.table(1, 1.3), assembly.table(1, 1.31)
    for path in ("Shaft 1.stiffness", "Shaft 2.damping", "Disk 1.inertia", "HookeJoint 1.angle"):
        column = assembly.packed.resolve(path).index
        low[:, column], high[:, column] = 0.98 * low[:, column], 1.02 * high[:, column]
    co = over_boxes(assembly, low, high)
    tau = np.linspace(0, np.pi, 33)
    at = ratios(assembly, (low + high) / 2, co, tau)
    model = _Model.of(assembly, co)
    middle = model.matrix(at.b, at.slope)
    first = sum(r[:, None, None, None] * np.abs(m) for r, m, _, _ in model.first_order(at, co))
    second = model.second_order(at, co)
    rng = np.random.default_rng(1)
    for _ in range(200):
        row = low + rng.random(low.shape) * (high - low)
        own = over_boxes(assembly, row, row)
        there = ratios(assembly, row, own, tau)
        # The same scales, other numbers.
        other = _Model(
            model.near, model.far, own.k * own.s[:, None] ** 2, own.c * own.s[:, None], model.scale, model.nu
        )
        a = other.matrix(there.b, there.slope)
        n = a.shape[-1] // 2
        a[..., n:, :] *= np.tile(np.sqrt(own.g / co.g), 2)[:, None, None, :n].swapaxes(2, 3) ** 2
        beyond = np.maximum(np.abs(a - middle) - first, 0)
        assert np.linalg.norm(beyond, axis=(2, 3)).max() <= second[0]


def test_rounding_is_a_thousandth_of_what_is_allowed_for() -> None:
    """W, W′, A and the residual W′ + WA − ΛW again in 80-bit arithmetic, from the harmonics that define W."""
    exact = np.longdouble
    if np.finfo(exact).eps > 1e-18:
        pytest.skip("no extended precision on this processor")
    assembly = assemble(tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.02))
    rng = np.random.default_rng(5)
    table = assembly.table(12)
    table[:, 0] = rng.uniform(0.6, 2.0, 12)
    column = assembly.packed.resolve("HookeJoint 1.angle").index
    table[:, column] = rng.uniform(0.1, 0.9, (12, 1))
    co = over_boxes(assembly, table, table)
    tau = lyapunov.HALF_TURN * np.arange(2 * lyapunov.STEPS) / (2 * lyapunov.STEPS)
    at = ratios(assembly, table, co, tau)
    model = _Model.of(assembly, co)
    a = model.matrix(at.b, at.slope)
    modes, lam, _ = lyapunov._modes(a)
    w, slope, _, _, most_w, most_slope = lyapunov._floquet(a)
    allowed = lyapunov.SLACK * lyapunov._carried(a, lam, most_w, most_slope)
    places = np.arange(0, lyapunov.STEPS, 37)
    angle = exact(2) * np.arctan2(exact(1), exact(0)) * places / lyapunov.STEPS
    order = np.round(np.fft.fftfreq(lyapunov.HARMONICS) * lyapunov.HARMONICS).astype(exact)
    turn = 2 * order[None, :] * angle[:, None]
    waves = np.cos(turn) + 1j * np.sin(turn)
    beta = table[:, column].astype(exact)
    chi = angle[None, :] + exact(table[0, assembly.packed.resolve("Shaft 1.fork_offset").index[0]])
    whole = 1 - np.sin(beta) ** 2 * np.cos(chi) ** 2
    eta, bend = np.cos(beta) / whole, -np.cos(beta) * np.sin(beta) ** 2 * np.sin(2 * chi) / whole**2
    for k in range(12):
        wide = modes[k].astype(np.clongdouble)
        w_exact = np.tensordot(waves, wide, 1)
        slope_exact = np.tensordot(waves * (2j * order), wide, 1)
        b, b_slope = (part[k : k + 1, ::2][:, places].astype(exact) for part in (at.b, at.slope))
        assert np.abs(b[0, :, 1] - eta[k]).max() < 2e-15 and np.abs(b_slope[0, :, 1] - bend[k]).max() < 1e-14
        b[0, :, 1], b_slope[0, :, 1] = eta[k], bend[k]
        one = [part[k : k + 1].astype(exact) for part in (model.k, model.c, model.scale, model.nu)]
        a_exact = extended(_Model(model.near, model.far, *one), b, b_slope)
        rest_exact = slope_exact + matmul(w_exact, a_exact) - lam[k][None, :, None] * w_exact
        here = a[k, ::2][places]
        rest = slope[k, places] + w[k, places] @ here - lam[k][None, :, None] * w[k, places]
        for mine, theirs in ((w[k, places], w_exact), (slope[k, places], slope_exact), (rest, rest_exact)):
            assert np.abs(mine - theirs).max() < 1e-3 * allowed[k]


def matmul(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return (left[..., :, :, None] * right[..., None, :, :]).sum(axis=-2)


def extended(model: _Model, b: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """``_Model.matrix`` of one box with an arithmetic of its own: K and C of every compliance, added up."""
    n, times = model.size, b.shape[1]
    out = np.zeros((times, 2 * n, 2 * n), dtype=b.dtype)
    out[:, :n, n:] = model.nu[0] * np.eye(n)
    for e, (p, i) in enumerate(zip(model.near, model.far, strict=True)):
        u, v = np.zeros((times, n), dtype=b.dtype), np.zeros((times, n), dtype=b.dtype)
        u[:, i] = model.scale[0, i]
        if p >= 0:
            u[:, p], v[:, p] = -b[0, :, e] * model.scale[0, p], -slope[0, :, e] * model.scale[0, p]
        straight, mixed = u[:, :, None] * u[:, None, :], u[:, :, None] * v[:, None, :]
        out[:, n:, :n] -= (model.k[0, e] * straight + model.c[0, e] * mixed) / model.nu[0]
        out[:, n:, n:] -= model.c[0, e] * straight
    return out


def test_nothing_unstable_is_proved() -> None:
    """Random lines from proved boxes are stable, and boxes that hold an unstable line are never proved."""
    assembly = assemble(tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.02))
    rng = np.random.default_rng(2)
    speed = rng.uniform(0.5, 2.2, 150)
    half = 10 ** rng.uniform(-4, -2, 150)
    low, high = assembly.table(150), assembly.table(150)
    low[:, 0], high[:, 0] = speed * (1 - half), speed * (1 + half)
    for path in ("Shaft 1.stiffness", "Disk 2.inertia"):
        column = assembly.packed.resolve(path).index
        low[:, column] *= (1 - half)[:, None]
        high[:, column] *= (1 + half)[:, None]
    found = judge_boxes(assembly, low, high)
    assert 10 < found.proved.sum() < 140
    for k in np.flatnonzero(found.proved)[::4]:
        row = low[k] + rng.random(low.shape[1]) * (high[k] - low[k])
        assert tn.stability(assembly.packed.line_at(row), float(row[0])).verdict is Verdict.STABLE
    unstable = found.radius > 1
    assert unstable.any() and not (found.proved & unstable).any()


def test_a_narrow_range_is_proved() -> None:
    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.001}, (1.2, 1.22))
    assert found.verdict == "proved stable" and found.undecided_share == 0 and len(found.undecided_low) == 0
    assert str(found).startswith("proved stable: every line within 1 tolerance")


def test_a_counterexample_is_one() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.002)
    found = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (1.55, 1.65), most_boxes=2000)
    assert found.verdict == "counterexample"
    example = dict(found.counterexample)
    speed = example.pop("speed")
    worse = line.replace("Shaft 1", stiffness=example["Shaft 1.stiffness"])
    assert tn.stability(worse, speed).verdict is Verdict.UNSTABLE
    assert "is unstable" in str(found)


def test_what_is_left_open_is_said() -> None:
    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.05}, (1.2, 1.4), most_boxes=1)
    assert found.verdict == "undecided" and 0 < found.undecided_share <= 1
    assert found.data.sizes["open_box"] == len(found.undecided_low) > 0


@pytest.mark.slow
def test_a_hundred_thousand_lines_of_certified_boxes() -> None:
    """None is unstable: ±1 % on three numbers over a quarter of the speeds, drawn all over what was proved."""
    from trunnion.analyses.tolerance.many_lines import ManyLines
    from trunnion.analyses.tolerance.spread import read_tolerances, tables

    tolerances = {"Shaft 1.stiffness": 0.01, "Shaft 2.stiffness": 0.01, "Disk 2.inertia": 0.01}
    assert tn.certify_stability(LINE, tolerances, (1.2, 1.5)).verdict == "proved stable"
    assembly = assemble(LINE)
    spreads, rng = read_tolerances(assembly, tolerances), np.random.default_rng(3)
    table = tables(assembly, spreads, rng.random((100_000, 3)), 1.0)
    table[:, 0] = rng.uniform(1.2, 1.5, len(table))
    assert np.all(ManyLines(assembly, True, 2).judged(table, 1e-9).verdict == Verdict.STABLE)


LOADED = LINE.replace("Disk 2", load_torque=1e-3)
BAD = [
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.01}, (2.0, 1.0)), "speeds = (2.0, 1.0): must be two"),
    (lambda: tn.certify_stability(LOADED, {"Shaft 1.stiffness": 0.01}, (1.0, 2.0)), "driveline: carries loads"),
    (
        lambda: tn.certify_stability(LINE, {"Shaft 1.fork_offset": ("range", 0, 1)}, (1.0, 2.0)),
        "Shaft 1.fork_offset: c",
    ),
    (lambda: tn.certify_stability(LINE, {"HookeJoint 1.angle": ("range", 0, 1.2)}, (1.0, 2.0)), "HookeJoint 1.angle"),
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.1}, (1.0, 2.0), most_boxes=0), "most_boxes = 0: must"),
]


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)
