"""Certificates: nothing is proved that is not so, counterexamples are ones, and bounds bound."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.linear import periodic_linear_system
from trunnion.floquet.tolerance import floquet_form as floquet_form_module
from trunnion.floquet.tolerance import lyapunov
from trunnion.floquet.tolerance.bounds import Coefficients, over_boxes, ratios
from trunnion.floquet.tolerance.box_terms import BoxTerms
from trunnion.floquet.tolerance.floquet_form import floquet_form
from trunnion.floquet.tolerance.lyapunov import judge_boxes
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
    a = BoxTerms.of(assembly, co).matrix(at.b, at.slope)[0]
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


VARYING = ("Shaft 1.stiffness", "Shaft 2.damping", "Disk 1.inertia", "HookeJoint 1.angle")


def boxes_of(line: tn.Driveline, speeds: np.ndarray, half: float, paths: tuple[str, ...]) -> tuple[np.ndarray, ...]:
    """Tables at the low and high ends of boxes about speeds, all numbers within ± a share."""
    assembly = assemble(line)
    low, high = assembly.table(len(speeds)), assembly.table(len(speeds))
    low[:, 0], high[:, 0] = speeds * (1 - half), speeds * (1 + half)
    for path in paths:
        column = assembly.packed.resolve(path).index
        low[:, column], high[:, column] = (1 - half) * low[:, column], (1 + half) * high[:, column]
    return low, high


def matrix_in_box(assembly: Assembly, terms: BoxTerms, middle: Coefficients, row: np.ndarray, tau: np.ndarray):
    """A(τ) of one line, in the coordinates of the box about ``middle``, and its logarithms away from the middle."""
    own = over_boxes(assembly, row, row)
    there = ratios(assembly, row, own, tau)
    other = dataclasses.replace(terms, k=own.k * own.s[:, None] ** 2, c=own.c * own.s[:, None])
    a = other.matrix(there.b, there.slope)
    n = a.shape[-1] // 2
    a[..., n:, :] *= (own.g / middle.g)[:, None, :, None]
    logs = [np.log(getattr(own, key) / getattr(middle, key)) for key in ("k", "c", "g")]
    p = np.concatenate([*logs, np.log(own.s / middle.s)[:, None], own.angle - middle.angle], axis=1)
    return a, p[0]


def test_bounds_hold_within_boxes() -> None:
    """Random lines in a box differ from first and second order by no more than is said; derivatives are ones."""
    assembly = assemble(LINE)
    low, high = boxes_of(LINE, np.array([1.3]), 0.02, VARYING)
    co = over_boxes(assembly, low, high)
    tau = np.pi * np.arange(lyapunov.STEPS) / lyapunov.STEPS
    at = ratios(assembly, (low + high) / 2, co, tau)
    terms = BoxTerms.of(assembly, co)
    parts, turned = terms.parts(at.b, at.slope), terms.moved_parts(at).sum(axis=2)
    middle = terms.matrix(at.b, at.slope)
    fine = floquet_form(np.repeat(middle, 2, axis=1), terms.energy())
    crude = lyapunov.first_order(terms, co, at, fine).crude
    rng = np.random.default_rng(1)
    left = []
    for _ in range(100):
        row = low + rng.choice([0.0, 1.0, rng.random()], low.shape) * (high - low)
        a, p = matrix_in_box(assembly, terms, co, row, tau)
        theta = terms.power @ p[:-1]
        known = middle + np.einsum("t,bntij->bnij", theta + theta**2 / 2, parts) + p[-1] * turned
        left.append(np.linalg.norm(a - known, axis=(2, 3)).max())
    assert 0.02 * crude[0] < max(left) < crude[0]
    # Steepness of every term, against differences.
    for values, steepest in ((parts, terms.steepest(at)), (co.turned[0, 0] * terms.moved_parts(at), None)):
        bound = terms.moved_steepest(at) if steepest is None else steepest
        slope = np.linalg.norm(np.diff(values, axis=1), axis=(3, 4)).max(axis=1) / (tau[1] - tau[0])
        assert np.all(slope <= bound) and slope.max() > 0.1 * bound.max()


@pytest.mark.parametrize(
    ("line", "speeds", "paths"),
    [
        (LINE, (0.62, 1.119, 1.25, 1.612, 1.63), VARYING),
        (LINE.replace("HookeJoint 1", angle=0.6), (1.3, 2.2), VARYING),
        (THREE, (0.9, 1.4), ("Shaft 1.stiffness", "Disk 3.inertia")),
    ],
    ids=["two shafts", "steep", "three shafts"],
)
def test_the_bound_is_above_what_it_bounds(line: tn.Driveline, speeds: tuple[float, ...], paths) -> None:
    """The Hermitian part of (U′ + UA)U⁻¹ itself, for random lines and angles, in and beside resonances."""
    assembly = assemble(line)
    low, high = boxes_of(line, np.array(speeds), 0.004, paths)
    found = judge_boxes(assembly, low, high)
    shift = 0.3 * lyapunov.HALF_TURN / lyapunov.STEPS  # between samples
    tau = lyapunov.HALF_TURN * np.arange(2 * lyapunov.STEPS) / (2 * lyapunov.STEPS)
    co = over_boxes(assembly, low, high)
    at = ratios(assembly, (low + high) / 2, co, tau)
    terms = BoxTerms.of(assembly, co)
    form = floquet_form(terms.matrix(at.b, at.slope), terms.energy())
    first = lyapunov.first_order(terms, co, at.every_other(), form)
    here = tau[::2] + shift
    wave = np.exp(2j * np.outer(here, np.fft.fftfreq(lyapunov.STEPS) * lyapunov.STEPS)) / lyapunov.STEPS
    rng = np.random.default_rng(4)
    closest = 0.0
    for box in range(len(speeds)):
        w, w_slope, s = (np.tensordot(wave, np.fft.fft(x[box], axis=0), 1) for x in (form.w, form.slope, first.s))
        order = 2j * np.fft.fftfreq(lyapunov.STEPS) * lyapunov.STEPS
        harmonic = np.fft.fft(first.s[box], axis=0)
        s_slope = np.tensordot(wave * order, harmonic, 1)
        one = dataclasses.replace(terms, **{k: getattr(terms, k)[box : box + 1] for k in ("k", "c", "scale", "nu")})
        middle = dataclasses.replace(co, **{f.name: getattr(co, f.name)[box : box + 1] for f in dataclasses.fields(co)})
        for _ in range(20):
            row = low[box : box + 1] + rng.choice([0.0, 1.0, rng.random()], low[:1].shape) * (high - low)[box]
            a, p = matrix_in_box(assembly, one, middle, row, here)
            p = p[: s.shape[1]]
            t = np.eye(w.shape[-1]) + np.einsum("v,nvij->nij", p, s)
            u, u_slope = t @ w, np.einsum("v,nvij->nij", p, s_slope) @ w + t @ w_slope
            h = (u_slope + u @ a[0]) @ np.linalg.inv(u)
            top = np.linalg.eigvalsh((h + h.conj().swapaxes(1, 2)) / 2).max()
            assert top <= found.largest[box]
            closest = max(closest, top / found.largest[box] if found.largest[box] < 0 else 0.0)
    assert found.proved.any() and closest < 30


def test_rounding_is_a_thousandth_of_what_is_allowed_for() -> None:
    """W, W′, A and what is left of W's and S's equations again in 80-bit arithmetic, from the harmonics that define W
    and S."""
    exact = np.longdouble
    if np.finfo(exact).eps > 1e-18:
        pytest.skip("no extended precision on this processor")
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.02)
    assembly = assemble(line)
    rng = np.random.default_rng(5)
    table = assembly.table(12)
    table[:, 0] = rng.uniform(0.6, 2.0, 12)
    column = assembly.packed.resolve("HookeJoint 1.angle").index
    table[:, column] = rng.uniform(0.1, 0.9, (12, 1))
    co = over_boxes(assembly, table, table)
    tau = lyapunov.HALF_TURN * np.arange(2 * lyapunov.STEPS) / (2 * lyapunov.STEPS)
    at = ratios(assembly, table, co, tau)
    terms = BoxTerms.of(assembly, co)
    a = terms.matrix(at.b, at.slope)
    modes = floquet_form_module.harmonics(a, terms.energy())[0]
    form = floquet_form(a, terms.energy())
    allowed = lyapunov.SLACK * lyapunov.carried_size(a, form.lam, form.most, form.most_slope)
    first = lyapunov.first_order(terms, co, at.every_other(), form)
    turning, d = lyapunov.solved(first.b, form)
    places = np.arange(0, lyapunov.STEPS, 37)
    angle = exact(2) * np.arctan2(exact(1), exact(0)) * places / lyapunov.STEPS
    order = floquet_form_module.ORDERS.astype(exact)
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
        one = {key: getattr(terms, key)[k : k + 1].astype(exact) for key in ("k", "c", "scale", "nu")}
        a_exact, by_stiffness = extended(dataclasses.replace(terms, **one), b, b_slope)
        rest_exact = slope_exact + matmul(w_exact, a_exact) - matmul(form.lam[k][None], w_exact)
        here, w, slope = a[k, ::2][places], form.w[k, places], form.slope[k, places]
        rest = slope + w @ here - form.lam[k] @ w
        for mine, theirs in ((w, w_exact), (slope, slope_exact), (rest, rest_exact)):
            assert np.abs(mine - theirs).max() < 1e-3 * allowed[k]
        # The equation of S for the second shaft's stiffness.
        s, s_slope = (np.tensordot(waves * f, turning[k, :, 1].astype(np.clongdouble), 1) for f in (1, 2j * order))
        inner = s_slope + matmul(s, form.lam[k][None]) - matmul(form.lam[k][None], s) - d[k, 1]
        left = np.abs(matmul(inner, w_exact) + matmul(w_exact, by_stiffness)).max()
        joint = np.cos(float(beta[k, 0])) ** 8 * np.cos(np.pi * (lyapunov.HARMONICS + 4) / lyapunov.STEPS)
        assert left <= first.rest[k, 1] * joint


def matmul(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return (left[..., :, :, None] * right[..., None, :, :]).sum(axis=-2)


def extended(terms: BoxTerms, b: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """``BoxTerms.matrix`` of one box with an arithmetic of its own, K and C of every compliance added up; and its
    derivative by the logarithm of the second stiffness."""
    n, times = terms.size, b.shape[1]
    out, second = (np.zeros((times, 2 * n, 2 * n), dtype=b.dtype) for _ in range(2))
    out[:, :n, n:] = terms.nu[0] * np.eye(n)
    for e, (p, i) in enumerate(zip(terms.near, terms.far, strict=True)):
        u, v = np.zeros((times, n), dtype=b.dtype), np.zeros((times, n), dtype=b.dtype)
        u[:, i] = terms.scale[0, i]
        if p >= 0:
            u[:, p], v[:, p] = -b[0, :, e] * terms.scale[0, p], -slope[0, :, e] * terms.scale[0, p]
        straight, mixed = u[:, :, None] * u[:, None, :], u[:, :, None] * v[:, None, :]
        stiff = terms.k[0, e] * straight / terms.nu[0]
        out[:, n:, :n] -= stiff + terms.c[0, e] * mixed / terms.nu[0]
        out[:, n:, n:] -= terms.c[0, e] * straight
        if e == 1:
            second[:, n:, :n] = -stiff
    return out, second


def test_nothing_unstable_is_proved() -> None:
    """Random lines from proved boxes are stable, and boxes that hold an unstable line are never proved."""
    assembly = assemble(tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.02))
    rng = np.random.default_rng(2)
    speed = rng.uniform(0.5, 2.2, 48)
    half = 10 ** rng.uniform(-4, -2, 48)
    low, high = assembly.table(48), assembly.table(48)
    low[:, 0], high[:, 0] = speed * (1 - half), speed * (1 + half)
    for path in ("Shaft 1.stiffness", "Disk 2.inertia"):
        column = assembly.packed.resolve(path).index
        low[:, column] *= (1 - half)[:, None]
        high[:, column] *= (1 + half)[:, None]
    found = judge_boxes(assembly, low, high)
    assert 5 < found.proved.sum() < 45
    for k in np.flatnonzero(found.proved)[::4]:
        row = low[k] + rng.random(low.shape[1]) * (high[k] - low[k])
        assert tn.stability(assembly.packed.line_at(row), float(row[0])).verdict is Verdict.STABLE
    unstable = found.radius > 1
    assert unstable.any() and not (found.proved & unstable).any()


@pytest.mark.slow
def test_single_lines_are_proved_wherever_they_are_stable() -> None:
    """At resonances too, where modes share a block in a skewed basis; modes up to 15 times the speed."""
    rng, open_at, seen = np.random.default_rng(3), [], 0
    for _ in range(12):
        elements: list[tn.Element] = [tn.ConstantSpeed(), tn.HookeJoint(angle=0.4, plane=0.0)]
        for k in range(2):
            stiffness, damping, inertia = 10 ** rng.uniform([-0.7, -2.5, -0.4], [0.7, -1.5, 0.4])
            elements += [tn.Shaft(stiffness=stiffness, damping=damping), tn.Disk(inertia=inertia)]
            elements += [tn.HookeJoint(angle=rng.uniform(0.1, 0.8), plane=rng.uniform(0, 3))] * (k == 0)
        line = tn.Driveline(elements)
        frequency = tn.natural_frequencies(line).undamped_frequency
        speeds = np.concatenate([frequency / m * rng.uniform(0.99, 1.01) for m in (1, 2, 3)])
        table = boxes_of(line, speeds[speeds > frequency[-1] / 15], 0.0, ())[0]
        judged = judge_boxes(assemble(line), table, table)
        seen += int((judged.radius < 1).sum())
        open_at += [(line, speed) for speed in table[(judged.radius < 1) & ~judged.proved, 0]]
    assert seen > 30
    assert open_at == []


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


@pytest.mark.parametrize(("damping", "verdict"), [(-0.01, "proved stable"), (-0.1, "counterexample")])
def test_a_shaft_that_feeds_energy_is_not_taken_for_an_undamped_one(damping: float, verdict: str) -> None:
    with pytest.warns(tn.InputRemark, match="feeds energy"):
        line = LINE.replace_all({"Shaft 1": {"damping": 0.12}, "Shaft 2": {"damping": damping}})
        found = tn.certify_stability(line, {"Shaft 2.damping": 0.01}, (1.2, 1.22))
        judged = [tn.stability(line, float(speed)).verdict for speed in np.linspace(1.2, 1.22, 5)]
    assert found.verdict == verdict
    assert judged == [Verdict.STABLE if verdict == "proved stable" else Verdict.UNSTABLE] * 5


def test_what_is_left_open_is_said() -> None:
    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.2}, (0.5, 2.0), most_boxes=1)
    assert found.verdict == "undecided" and 0 < found.undecided_share <= 1
    assert found.data.sizes["open_box"] == len(found.undecided_low) > 0


EIGHT = {
    **dict.fromkeys((f"Shaft {i}.{key}" for i in (1, 2) for key in ("stiffness", "damping")), 0.01),
    **{"Disk 1.inertia": 0.01, "Disk 2.inertia": 0.01, "rim.inertia": 0.01, "HookeJoint 1.angle": 0.01},
}


def with_rim() -> tn.Driveline:
    """Two shafts with eight numbers that scatter: the last disk in two parts."""
    half = LINE.replace("Disk 2", inertia=0.5)
    return tn.Driveline([*half.elements, tn.Disk(inertia=0.5, name="rim")])


def test_eight_tolerances_are_proved() -> None:
    """Every number of the line, through the principal resonance of its second mode."""
    found = tn.certify_stability(with_rim(), EIGHT, (1.55, 1.65))
    assert found.verdict == "proved stable" and found.boxes < 40


@pytest.mark.slow
def test_a_hundred_thousand_lines_of_certified_boxes() -> None:
    """None is unstable: ±1 % on eight numbers over the speeds of all tongues, drawn all over what was proved."""
    from trunnion.floquet.tolerance.many_lines import ManyLines
    from trunnion.floquet.tolerance.spread import read_tolerances, tables

    line, speeds = with_rim(), (0.55, 1.75)
    assert tn.certify_stability(line, EIGHT, speeds).verdict == "proved stable"
    assembly = assemble(line)
    spreads, rng = read_tolerances(assembly, EIGHT), np.random.default_rng(3)
    shares = rng.random((100_000, 8))
    shares[::2] = np.round(shares[::2])  # corners
    table = tables(assembly, spreads, shares, 1.0)
    table[:, 0] = rng.uniform(*speeds, len(table))
    assert np.all(ManyLines(assembly, True, 2).judged(table, 1e-9).verdict == Verdict.STABLE)


@pytest.mark.slow
def test_what_stays_open_stands_beside_what_is_unstable() -> None:
    """Of a line with an unstable range, everything but its neighbourhood is proved, and lines from there are stable."""
    from trunnion.floquet.tolerance.many_lines import ManyLines

    line = LINE.replace("HookeJoint 1", angle=0.75)
    assembly = assemble(line)
    rng = np.random.default_rng(6)
    speed = rng.uniform(1.3, 1.9, 60)
    low, high = boxes_of(line, speed, 0.003, ("Shaft 1.stiffness", "Disk 2.inertia"))
    found = np.concatenate([judge_boxes(assembly, low[k : k + 12], high[k : k + 12]).proved for k in range(0, 60, 12)])
    assert 5 < found.sum() < 55
    rows = np.concatenate([low[k] + rng.random((2000, low.shape[1])) * (high - low)[k] for k in np.flatnonzero(found)])
    assert np.all(ManyLines(assembly, True, 2).judged(rows, 1e-9).verdict == Verdict.STABLE)


@pytest.mark.slow
def test_a_line_too_stiff_for_its_samples_stays_undecided() -> None:
    """Its fastest mode makes 8000 cycles a turn: integration leaves the numbers' range, which proves nothing."""
    line = tn.Driveline([*LINE.elements, tn.Shaft(stiffness=1e6, damping=1.0), tn.Disk(inertia=1e-2)])
    found = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (2.04, 2.08), most_boxes=20)
    assert found.verdict == "undecided" and found.undecided_share == 1


LOADED = LINE.replace("Disk 2", load_torque=1e-3)
BAD = [
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.01}, (2.0, 1.0)), "speeds = (2.0, 1.0): must be two"),
    (lambda: tn.certify_stability(LOADED, {"Shaft 1.stiffness": 0.01}, (1.0, 2.0)), "driveline: carries loads"),
    (
        lambda: tn.certify_stability(LINE, {"Shaft 1.fork_offset": ("range", 0, 1)}, (1.0, 2.0)),
        "Shaft 1.fork_offset: c",
    ),
    (lambda: tn.certify_stability(LINE, {"HookeJoint 1.angle": ("range", 0, 1.2)}, (1.0, 2.0)), "HookeJoint 1.angle"),
    (
        lambda: tn.certify_stability(LINE, {"Shaft 1.damping": ("range", 0, 0.1)}, (1.0, 2.0)),
        "Shaft 1.damping: would go from 0 to 0.1, and damping that reaches zero cannot be certified",
    ),
    (lambda: tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.1}, (1.0, 2.0), most_boxes=0), "most_boxes = 0: must"),
]


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


def test_drawn_over_the_directions_split_most() -> None:
    """Boxes, proved and open, fill the volume once; the picture has both, and marks the line that is unstable."""
    from trunnion.pictures.design import most_split

    found = tn.certify_stability(LINE, {"Shaft 1.stiffness": 0.5, "Disk 1.inertia": 0.01}, (1.2, 1.25), most_boxes=30)
    assert found.verdict == "undecided" and len(found.proved_low) and most_split(found) == (0, 1)
    low, high = found.ends
    every = [
        (np.log(h[0] / b[0]), h[1:] - b[1:])
        for b, h in zip(
            np.vstack([found.proved_low, found.undecided_low]),
            np.vstack([found.proved_high, found.undecided_high]),
            strict=True,
        )
    ]
    volume = sum(speed * sides.prod() for speed, sides in every)
    assert volume == pytest.approx(np.log(high[0] / low[0]) * (high - low)[1:].prod(), rel=1e-9)
    axes = found.plot()
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == [f"proved stable ({len(found.proved_low)} boxes)", f"left open ({len(found.undecided_low)} boxes)"]
    assert axes.get_xlabel() == "input speed [rad/s]" and axes.get_ylabel() == "stiffness of Shaft 1 [N·m/rad]"
    assert "1 other direction" in axes.get_title(loc="left")
    line = tn.catalogue("two-shaft-cardan", angle=0.6, damping_ratio=0.002)
    unstable = tn.certify_stability(line, {"Shaft 1.stiffness": 0.01}, (1.5, 1.7))
    words = [text.get_text() for text in unstable.plot().get_legend().get_texts()]
    assert unstable.verdict == "counterexample" and words[-1] == "unstable line"
