"""Tongues: every region, its edges, its tip, its name; against charts, tables and an integration of its own."""

from __future__ import annotations

import json

import numpy as np
import pytest
import two_shafts
from long_lines import long_line

import trunnion as tn
from trunnion.floquet.tongues.boundaries import boundary_functions
from trunnion.floquet.tongues.boundary_traces import joined
from trunnion.floquet.tongues.multiplier_collisions import multiplier_collisions
from trunnion.floquet.tongues.region import Region, patched
from trunnion.floquet.tongues.rows import TongueRow, looked_at, unstable_intervals
from trunnion.floquet.tongues.series_roots import row_roots
from trunnion.floquet.tongues.tongues import PATCH_TOLERANCE, task_of
from trunnion.numerics.bracketing import bracketed
from trunnion.results.verdict import Verdict

LINE = tn.catalogue("two-shaft-cardan")
BOX = (("speed", 0.05, 2.0), ("HookeJoint 1.angle", 0.05, 1.45))


@pytest.fixture(scope="module")
def gentle() -> tn.floquet.tongues.result.Tongues:
    return tn.tongues(LINE, ("speed", 0.25, 2.0), ("HookeJoint 1.angle", 0.0, 0.5), rows=17)


@pytest.mark.slow
def test_every_interval_of_fifteen_rows() -> None:
    """145 intervals, and every one that 8193 pixels show among them."""
    wide = tn.tongues(LINE, *BOX, rows=15)
    found = [wide.intervals_at(float(y)) for y in np.linspace(*BOX[1][1:], 15)]
    assert sum(map(len, found)) == 145
    chart = tn.stability_chart(LINE, (*BOX[0], 8193), (*BOX[1], 15))
    for row, (intervals, verdict) in enumerate(zip(found, chart.verdict, strict=True)):
        inside = np.zeros(len(chart.x), dtype=bool)
        for low, high in intervals:
            inside |= (chart.x >= low) & (chart.x <= high)
        near = np.abs(chart.x[:, None] - intervals.ravel()).min(axis=1) < 1e-7 if len(intervals) else False
        wrong = (verdict == Verdict.UNSTABLE) != inside
        assert not np.any(wrong & ~near), f"row {row}"


@pytest.mark.parametrize(
    ("gamma", "beta", "low", "high", "digits"),
    [
        (100.0, 0.3, 1.400251, 1.432358, 6), (100.0, 0.5, 1.372337, 1.464882, 6), (1.0, 0.3, 1.601913, 1.634565, 6),
        (1.0, 0.5, 1.572483, 1.666968, 6), (100.0, 0.5, 0.37045, 0.37365, 5), (1.0, 0.3, 0.61204, 0.62460, 5),
        (1.0, 0.3, 1.11078, 1.12580, 5),
    ],
)  # fmt: skip
def test_published_edges(gamma: float, beta: float, low: float, high: float, digits: int) -> None:
    line = tn.catalogue("two-shaft-cardan", inertia_of_disk_2=gamma)
    middle = (low + high) / 2
    found = tn.tongues(line, ("speed", 0.93 * middle, 1.07 * middle), ("HookeJoint 1.angle", beta - 0.05, beta), rows=3)
    best = min((t.interval_at(beta) for t in found if t.y[-1] == beta), key=lambda i: abs(sum(i) / 2 - middle))
    assert best == pytest.approx((low, high), abs=0.51 * 10.0**-digits)


def test_names_and_tips(gentle) -> None:
    """The resonances that open first, each at its speed; and their tips, against an integration of its own."""
    by_name = {t.name: t for t in gentle}
    assert {"subharmonic ω₁", "subharmonic ω₂", "sum (ω₁+ω₂)/2", "harmonic ω₁/2"} <= set(by_name)
    for name in ("subharmonic ω₂", "sum (ω₁+ω₂)/2", "harmonic ω₁/2"):
        tongue = by_name[name]
        assert tongue.tip is not None and tongue.resonance is not None
        x, y = tongue.tip
        assert x == pytest.approx(tongue.resonance.speed, rel=0.01)
        step = 0.2 * tongue.width_at(1.01 * y)
        low, here, high = (two_shafts.radius(x + d, y) - 1 for d in (-step, 0.0, step))
        slope = (two_shafts.radius(x, 1.001 * y) - 1 - here) / (0.001 * y)
        assert here < 2e-10 and max(low, high) < here, name
        assert abs(0.5 * step * (low - high) / (low - 2 * here + high)) < 1e-6  # where the parabola is highest
        assert abs(here / slope) < 1e-6


def test_edges_are_where_the_radius_is_one(gentle) -> None:
    rng, inside = np.random.default_rng(3), 0
    for tongue in list(gentle)[:6]:
        k = int(rng.integers(1, len(tongue.y) - 1))
        for x in (tongue.low[k], tongue.high[k]):
            if BOX[0][1] + 1e-9 < x < BOX[0][2] - 1e-9:
                assert two_shafts.radius(float(x), float(tongue.y[k])) == pytest.approx(1.0, abs=1e-9)
                inside += 1
    assert inside >= 6


@pytest.mark.parametrize("width", [1e-4, 1e-5, 1e-6])
def test_regions_however_narrow(gentle, width: float) -> None:
    """Rows so little above a tip that the region is ``width`` wide there: it is found, and as wide as it should be."""
    for tongue in [t for t in gentle if t.tip is not None][:5]:
        y0 = tongue.tip[1]
        near = y0 + 1e-3
        y = y0 + 1e-3 * (width / tongue.width_at(near)) ** 2
        found = gentle.intervals_at(y)
        own = [i for i in found if abs(i.mean() - tongue.tip[0]) < 1e-3]
        assert own and own[0][1] - own[0][0] == pytest.approx(width, rel=0.1), (tongue.name, y, found)


def mathieu(tau, a, q):
    return np.eye(1), np.zeros((1, 1)), (a - 2 * q * np.cos(2 * tau))[..., None, None]


@pytest.mark.slow
def test_mathieu() -> None:
    """Undamped: edges are the characteristic values (Abramowitz and Stegun, table 20.1)."""
    family = tn.PeriodicLinearFamily(np.pi, mathieu, 1, {"a": 1.0, "q": 0.5})
    found = tn.tongues(family, ("a", -0.3, 2.1), ("q", 0.9, 1.0), rows=3)
    assert found.intervals_at(1.0)[-1] == pytest.approx((-0.110249, 1.859108), abs=2e-6)
    assert all(t.resonance is None for t in found)


@pytest.mark.slow
def test_mathieu_with_narrow_gaps() -> None:
    """At q = 5 the first stable gap is 0.01 wide."""
    family = tn.PeriodicLinearFamily(np.pi, mathieu, 1, {"a": 1.0, "q": 0.5})
    found = tn.tongues(family, ("a", -6.0, 5.0), ("q", 0.8, 5.0), rows=4)
    edges = {1.0: (-0.455139, -0.110249, 1.859108, 3.917025), 5.0: (-5.800046, -5.790081, 1.858188, 2.099460)}
    for q, expected in edges.items():
        intervals = found.intervals_at(q)
        assert intervals.ravel()[1:5] == pytest.approx(expected, abs=2e-6)


def test_a_row_without_regions(gentle) -> None:
    assert len(gentle.intervals_at(0.01)) == 0
    assert gentle.complete and "completely" in gentle.search


def test_words_are_in_the_units_of_the_file() -> None:
    """Speeds in rpm, angles in degrees, whatever is computed with."""
    line = tn.Driveline(LINE.elements, operation=tn.Operation(speed="15 rpm"))
    said = str(tn.tongues(line, ("speed", 1.4, 1.8), ("HookeJoint *.angle", 0.05, 0.5), rows=5))
    assert "over input speed × angle" in said and " rpm, angle of all Hooke's joints" in said and "° apart" in said


def test_what_lies_in_the_dark_is_not_called_high(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stretch of which no point can be computed: no region in it, and no warning either."""
    task = task_of(LINE, *BOX, None, False, "tongues")
    region = patched(task.family, task.x.values, task.y.values, PATCH_TOLERANCE, 1, lambda share: None)
    (row,) = unstable_intervals(region, np.array([0.2]))
    judged = Region.judged

    def blind(self: Region, u, v):
        found = judged(self, u, v)
        found.radius[:] = np.nan
        return found

    monkeypatch.setattr(Region, "judged", blind)
    middle = (region.box.u0 + region.box.u1) / 2
    (found,) = looked_at(region, [row], [np.array([[middle, middle * 1.001]])])
    assert not len(found)


def test_damping_as_the_second_axis() -> None:
    """The tip is then the least damping that removes the tongue."""
    found = tn.tongues(
        tn.catalogue("two-shaft-cardan", angle=0.3),
        ("speed", 1.4, 1.8),
        ("factor of Shaft *.damping", 0.2, 40.0),
        rows=9,
    )
    (one,) = found
    assert one.tip is not None and one.tip[1] == one.y[-1] and one.name == "subharmonic ω₂"
    assert two_shafts.radius(one.tip[0], 0.3, zeta=0.001 * one.tip[1]) == pytest.approx(1.0, abs=1e-9)


def test_undamped_regions_have_no_tip_but_an_angle_from_which_on_they_are_known() -> None:
    """They reach down to the straight line, however little they grow there; one comes in through a side of the box."""
    undamped = tn.catalogue("two-shaft-cardan", damping_ratio=0.0)
    found = tn.tongues(undamped, ("speed", 0.7, 1.9), ("HookeJoint 1.angle", 0.0, 1.0), rows=9)
    by_name = {t.name: t for t in found}
    assert set(by_name) == {"subharmonic ω₂", "sum (ω₁+ω₂)/2", "subharmonic ω₁", "harmonic ω₂/2"}  # no shreds
    assert all(t.tip is None for t in found) and "without damping" in found.search
    aside = by_name.pop("subharmonic ω₁")
    assert not aside.fades and "low speed" in aside.cut and aside.low[0] == aside.high[0] == 0.7
    assert two_shafts.radius(0.7, aside.y[0] - 1e-4, zeta=0.0) < 1 + 1e-9
    assert two_shafts.radius(0.7, aside.y[0] + 1e-4, zeta=0.0) > 1 + 1e-5
    for tongue in by_name.values():
        assert tongue.fades == ("below",) and f"{tongue.name}: known from" in str(found)
        assert two_shafts.radius(float(tongue.low[0]), float(tongue.y[0]), zeta=0.0) < 1 + 1e-5


def row_of(line: tn.Driveline, low: float, high: float, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Unstable intervals of speed (intervals, 2) at one angle of all joints, and a point inside each."""
    task = task_of(line, ("speed", low, high), ("HookeJoint *.angle", 0.9 * angle, 1.1 * angle), None, True, "tongues")
    region = patched(task.family, task.x.values, task.y.values, PATCH_TOLERANCE, 2, lambda share: None)
    assert not region.by_coefficients
    row = unstable_intervals(region, task.family.to_patch(np.array([angle]), False))[0]
    return region.in_x(row.low, row.high), np.sort(region.x(row.inside))


@pytest.mark.parametrize(("seed", "shafts"), [(3, 5), (0, 4), (8, 6)])
@pytest.mark.slow
def test_long_lines_miss_no_resonance_of_first_order(seed: int, shafts: int) -> None:
    """Undamped, every pair of modes opens a region at (ωᵢ + ωⱼ)/2, of width β² at a small angle β."""
    angle, line = 0.02, long_line(seed, shafts, 0.0)
    w = tn.natural_frequencies(line).undamped_frequency
    low, high = 0.9 * w[0], 0.8 * w[-1]
    intervals, inside = row_of(line, low, high, angle)
    pairs = [(w[i] + w[j]) / 2 for i in range(shafts) for j in range(i, shafts)]
    expected = [x for x in pairs if low * 1.001 < x < high * 0.999]
    assert len(expected) >= 6
    for x in expected:
        apart = np.abs(intervals - x).max(axis=1)  # both edges lie close by
        assert apart.min() < angle**2 * x, (x, intervals)
    changed = line.replace_all({f"HookeJoint {k}": {"angle": angle} for k in (1, 2)})
    for x in inside:
        assert tn.stability(changed, float(x), tolerance=1e-13).spectral_radius > 1


@pytest.mark.slow
def test_rounding_of_undamped_rows_hides_no_region() -> None:
    """Every interval of a row is one where ``stability`` grows, and between them nothing does."""
    line, angle = long_line(0, 4, 0.0), 0.17
    intervals, _ = row_of(line, 220.0, 300.0, angle)
    changed = line.replace_all({f"HookeJoint {k}": {"angle": angle} for k in (1, 2)})
    assert any(low < 284.514 and high > 285.05 for low, high in intervals)  # missed, though 0.54 rad/s wide
    for speed in np.linspace(220.5, 299.5, 80):
        inside = any(low < speed < high for low, high in intervals)
        assert (tn.stability(changed, float(speed), tolerance=1e-12).verdict is Verdict.UNSTABLE) == inside, speed


def test_meetings_of_multipliers_are_closed_in_on() -> None:
    """Two that pass each other on the circle, one that meets its conjugate, and none that decays."""
    theta = np.linspace(0.0, 3.0, 200)

    def multipliers(at: np.ndarray, row: np.ndarray, decay: float = 1e-3) -> np.ndarray:
        phases = np.stack([0.5 + 0.4 * at, 2.5 - 0.7 * at + 0.05 * at**2, 2.9 + 0.2 * at], axis=1)
        half = np.exp(1j * phases - decay)
        return np.concatenate([half, half.conj()], axis=1)

    row, met = multiplier_collisions(multipliers, theta, multipliers(theta, theta)[None])
    one = np.roots([0.05, -1.1, 2.0]).min()
    other, third = np.roots([0.05, -0.5, -0.4 - 0.0]), (np.pi - 2.9) / 0.2
    assert not row.any() and np.abs(met - one).min() < 1e-12 and np.abs(met - third).min() < 1e-12
    conjugates = [x for x in other.real if 0 < x < 3]
    assert len(met) == 2 + len(conjugates)
    assert not len(multiplier_collisions(multipliers, theta, multipliers(theta, theta, 0.2)[None])[0])


@pytest.mark.slow
def test_more_than_three_unknowns_are_sampled() -> None:
    parts = [tn.ConstantSpeed()]
    for k, j in ((1e4, 0.1), (2e4, 0.15), (1.5e4, 0.12), (3e4, 0.2)):
        parts += [tn.Shaft(stiffness=k, damping=k * 2e-6), tn.Disk(inertia=j), tn.HookeJoint(angle=0.2)]
    line = tn.Driveline(parts[:-1])
    found = tn.tongues(line, ("speed", 250.0, 700.0), ("HookeJoint *.angle", 0.05, 0.4), rows=5)
    assert not found.complete and "sampled" in found.search and len(found) > 0
    assert "came from both searches" in found.search
    chart = tn.stability_chart(line, ("speed", 250.0, 700.0, 400), ("HookeJoint *.angle", 0.05, 0.4, 5))
    for y, verdict in zip(chart.y, chart.verdict, strict=True):
        intervals = found.intervals_at(float(y))
        for x in chart.x[verdict == Verdict.UNSTABLE]:
            assert any(low - 1e-6 <= x <= high + 1e-6 for low, high in intervals)


def test_result_as_data_and_table(gentle, tmp_path) -> None:
    data = gentle.data
    assert data.tip_y.attrs["units"] == "rad" and data.sizes["tongue"] == len(gentle)
    gentle.to_csv(tmp_path / "t.csv")
    lines = (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "tongue,name,speed [rad/s],HookeJoint 1.angle [rad]" and len(lines) == 1 + data.sizes["point"]
    assert json.loads(gentle.to_json())["complete"] == 1
    assert "closes below at input speed" in str(gentle)
    with pytest.raises(tn.InputError, match="beyond this tongue"):
        gentle[0].interval_at(0.6)
    with pytest.raises(tn.InputError, match="outside the box"):
        gentle.intervals_at(0.6)


def test_drawn_alone_and_over_a_chart(gentle) -> None:
    axes = gentle.plot()
    assert any("ω₂" in text.get_text() for text in axes.texts)
    chart = tn.stability_chart(LINE, ("speed", 0.25, 2.0, 12), ("HookeJoint 1.angle", 0.0, 0.5, 6))
    over = chart.plot(tongues=gentle)
    assert any("narrower than a pixel" in text.get_text() for text in over.get_legend().get_texts())


@pytest.mark.parametrize("m", [2, 4, 6])
def test_boundary_functions_are_products_of_multipliers(m: int) -> None:
    rng = np.random.default_rng(m)
    for _ in range(20):
        pairs = rng.normal(size=m // 2) + 1j * rng.normal(size=m // 2)
        values = np.concatenate([pairs, pairs.conj()])
        e = ((-1.0) ** np.arange(1, m + 1)) * np.poly(values).real[1:]
        at_one, at_minus, pair = boundary_functions(e, False)
        assert at_one == pytest.approx(np.prod(1 - values).real, rel=1e-9)
        assert at_minus == pytest.approx(np.prod(1 + values).real, rel=1e-9)
        product = np.prod([1 - values[i] * values[j] for i in range(m) for j in range(i)]).real
        assert pair / 2.0 ** (m * (m - 1) / 2) == pytest.approx(product, rel=1e-7)


def test_no_zero_of_a_row_is_passed_over() -> None:
    """Random cosine series with planted zeros, pairs as close as 1e-4: each is found once, or said to be touched."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        roots = np.sort(rng.uniform(-0.99, 0.99, 12))
        roots[3] = roots[4] - 1e-4
        c = np.polynomial.chebyshev.chebfromroots(roots)
        c /= np.abs(c).max()
        found = row_roots(c[None, None], np.full((1, 1), 1e-17), lambda e: e, 1)
        places = np.cos(found.theta)
        assert len(places) <= 12 and all(np.abs(roots - p).min() < 1e-6 for p in places)
        for root in roots:
            close = found.touched[:, 0] - 1e-9 <= np.arccos(root)
            close &= np.arccos(root) <= found.touched[:, 1] + 1e-9
            assert close.any() or np.abs(places - root).min() < 1e-6
    touching = np.polynomial.chebyshev.chebfromroots([0.3, 0.3])
    found = row_roots(touching[None, None], np.full((1, 1), 1e-12), lambda e: e, 1)
    assert len(found.theta) == 0 and len(found.touched) == 1
    assert found.touched[0, 0] <= np.arccos(0.3) <= found.touched[0, 1]


def test_bracketing() -> None:
    powers = np.array([1.0, 3.0, 5.0, 0.5])
    zeros = bracketed(
        lambda x, k: np.sign(x - 0.3) * np.abs(x - 0.3) ** powers[k], np.full(4, -1.0), np.full(4, 2.0), 1e-12
    )
    assert zeros == pytest.approx(0.3, abs=1e-3) and zeros[[0, 3]] == pytest.approx(0.3, abs=1e-10)
    # Flat on one side, as ρ − 1 without damping: the zero is where the sign changes, not where it is nearest to none.
    flat = bracketed(
        lambda x, k: np.where(x > 0.3, np.sqrt(np.abs(x - 0.3)), np.where(x < -0.5, -1e-300, -1e-12)),
        np.full(1, -1.0), np.full(1, 2.0), 1e-12,
    )  # fmt: skip
    assert flat == pytest.approx(0.3, abs=1e-11)


BAD = [
    (lambda: tn.tongues(LINE, "speed", BOX[1]), "x = 'speed': must be (parameter, low, high)"),
    (lambda: tn.tongues(LINE, ("speed", 1, 2, 3), BOX[1]), "x = ('speed', 1, 2, 3): must be"),
    (lambda: tn.tongues(LINE, *BOX, rows=2), "rows = 2: must be a whole number"),
    (lambda: tn.tongues(LINE, *BOX, speed=3.0), "speed = 3: is an axis already"),
    (lambda: tn.tongues(LINE, ("speed", 2, 1), BOX[1]), "speed.range: runs from 2 to 1"),
    (lambda: tn.tongues(LINE, BOX[0], ("sped", 1, 2)), "sped: is not a parameter"),
]


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


@pytest.mark.slow
def test_regions_that_close_beside_a_wider_one_keep_their_tips() -> None:
    """A geared line whose stiffness moves regions past each other: each interval of a row belongs to a region there."""
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1000, damping=0.3), tn.Disk(inertia=0.5), tn.HookeJoint(angle=0.5)]
    parts += [tn.Ratio(ratio=2.0), tn.Shaft(stiffness=800, damping=0.25, fork_offset=0.3), tn.Disk(inertia=0.7)]
    parts += [tn.HookeJoint(angle=0.4, plane=0.2), tn.Shaft(stiffness=900, damping=0.2, fork_offset=1.0)]
    line = tn.Driveline([*parts, tn.Disk(inertia=1.0, load_torque=60.0)])
    found = tn.tongues(line, ("speed", 20.0, 36.0), ("Shaft 2.stiffness", 300.0, 700.0), rows=3)
    for tongue in found:
        below = tongue.tip or tongue.parts or {"low Shaft 2.stiffness", "low speed"} & {*tongue.cut}
        assert below and (tongue.tip or tongue.joins or "high Shaft 2.stiffness" in tongue.cut), tongue.name
    for y in (350.0, 430.0, 452.0, 500.0, 540.0, 551.5, 560.0, 620.0, 650.0):
        for low, high in found.intervals_at(y):
            alive = [(np.interp(y, t.y, t.low), np.interp(y, t.y, t.high)) for t in found if t.y[0] <= y <= t.y[-1]]
            assert any(left < high + 0.02 and low - 0.02 < right for left, right in alive), (y, low)


def test_a_region_that_another_parts_from_goes_on() -> None:
    """Where a wide one falls into two, an edge of either leaps; both go on from row to row."""

    def search(v: np.ndarray) -> list[TongueRow]:
        return [made(float(x), [(0.1, 0.9)] if x < 0.5 else [(0.1, 0.15), (0.2, 0.9)]) for x in v]

    def made(v: float, intervals: list[tuple[float, float]]) -> TongueRow:
        low, high = np.array(intervals).T
        some = len(low)
        return TongueRow(
            v, low, high, (low + high) / 2, np.zeros(some, np.int8), np.zeros((some, 2), bool), np.zeros((0, 2)),
            np.ones(some, np.int8), (frozenset(),) * some,
        )  # fmt: skip

    strands, _ = joined(search, np.linspace(0.0, 1.0, 5), lambda share: None)
    assert len(strands) == 2 and all(s.intervals[-1].v == 1.0 for s in strands)
    assert strands[1].into[0] is strands[0] and strands[0].beyond[1] is None
