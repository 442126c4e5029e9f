"""Windows of a parameter in which a range of speeds is stable, and the damping that is enough."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import two_shafts
from two_disks import TwoDisks

import trunnion as tn
from trunnion.design.limits.result import LimitKind
from trunnion.floquet.tongues.region import Region
from trunnion.floquet.tongues.window_search import UNKNOWN
from trunnion.results.verdict import Verdict

LINE = tn.catalogue("two-shaft-cardan")
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def angles() -> tn.floquet.tongues.windows.StableWindows:
    return tn.stable_windows(LINE, "HookeJoint 1.angle", 0.0, 1.4, (0.75, 0.9), rows=33)


def test_largest_angle_is_a_tip(angles) -> None:
    """ω₂/2 opens at the tip that an integration of its own confirms."""
    assert angles.largest is not None and angles.ends[0][1].region == "harmonic ω₂/2"
    speed = angles.ends[0][1].speed
    assert two_shafts.radius(speed, angles.largest) == pytest.approx(1.0, abs=1e-9)
    assert "set by harmonic ω₂/2" in angles.sentence


def test_windows_are_stable_and_what_lies_between_is_not(angles) -> None:
    chart = tn.stability_chart(LINE, ("speed", 0.75, 0.9, 1200), ("HookeJoint 1.angle", 0.0, 1.4, 141))
    bad = (chart.verdict == Verdict.UNSTABLE).any(axis=1)
    inside = np.zeros(len(chart.y), dtype=bool)
    for low, high in angles.windows:
        inside |= (chart.y > low) & (chart.y < high)
    assert not np.any(bad & inside)
    # Regions narrower than a pixel are missed by the chart alone.
    assert np.count_nonzero(~bad & ~inside) <= 2


def test_margin_widens_the_speeds() -> None:
    near = tn.stable_windows(LINE, "HookeJoint 1.angle", 0.0, 0.5, (1.3, 1.5), rows=9)
    wide = tn.stable_windows(LINE, "HookeJoint 1.angle", 0.0, 0.5, (1.3, 1.5), rows=9, margin=0.1)
    assert wide.largest < near.largest and wide.margin == 0.1


def test_minimum_damping() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.3)
    found = tn.minimum_damping(line, (1.4, 1.8), maximum=40.0, rows=17)
    assert found.smallest is not None and found.smallest < 40 and len(found.windows) == 1
    zeta = 0.001 * found.smallest
    at = found.ends[0][0].speed
    assert two_shafts.radius(at, 0.3, zeta=zeta) == pytest.approx(1.0, abs=1e-8)
    speeds = np.linspace(1.4, 1.8, 41)
    assert max(two_shafts.radius(s, 0.3, zeta=1.001 * zeta) for s in speeds) < 1
    assert found.data["from"].attrs["units"] == "1" and "subharmonic ω₂" in str(found)


def test_undamped_no_angle_is_known_to_keep_a_resonance_stable() -> None:
    """ω₂ lies among the speeds: its region reaches down to the straight line, though its growth cannot be told."""
    line = tn.catalogue("two-shaft-cardan", damping_ratio=0.0)
    found = tn.stable_windows(line, "HookeJoint 1.angle", 0.0, 0.5, (1.4, 1.8), rows=5)
    assert not len(found.windows) and found.largest is None and "is known to keep" in found.sentence


def test_no_window_at_all() -> None:
    line = tn.catalogue("two-shaft-cardan", angle=0.5)
    found = tn.minimum_damping(line, (1.5, 1.6), maximum=2.0, rows=5)
    assert len(found.windows) == 0 and found.smallest is None and "No factor" in found.sentence


FAINT = TwoDisks(1.0, 1e-4, 1.0, 0.3, 1.0, 0.005, 1.0)


@pytest.mark.parametrize("maximum", [0.1, 100.0])
def test_damping_is_searched_over_decades(maximum: float) -> None:
    """Unstable from 0.00033 to 0.0135, which is less than a step of 65 even rows up to 100; its ends lie at the lowest
    speed."""
    found = tn.minimum_damping(FAINT.line(), (1.12774, 1.2), damping="Shaft 2.damping", maximum=maximum)
    assert found.complete and len(found.windows) == 2 and found.windows[-1, 1] == maximum
    ends = np.array([found.windows[0, 1], found.windows[1, 0]])
    assert ends == pytest.approx([0.00033, 0.0135], rel=0.01)
    assert FAINT.radius(np.full(2, 1.12774), c2=ends) == pytest.approx([1.0, 1.0], abs=1e-8)
    inside = FAINT.radius(np.full(3, 1.12774), c2=np.array([0.0004, 0.005, 0.01]))
    assert np.all(inside > 1 + 1e-6)
    assert f"; confirmed at {len(found.confirmed)} speeds." in found.sentence


def test_a_region_that_crosses_few_speeds_between_two_rows() -> None:
    """A box a thousandth wide: the region runs through it from side to side within half a row."""
    line = TwoDisks(1.0, 1e-3, 1.0, 0.2, 1.0, 1e-3, 1.0)
    found = tn.stable_windows(line.line(), "Shaft 2.stiffness", 0.3, 3.0, (1.1, 1.1011))
    (_, first), (second, _) = found.windows
    assert found.ends[0][1].speed == 1.1 and found.ends[1][0].speed == 1.1011
    assert line.radius(np.array([1.1, 1.1011]), k2=np.array([first, second])) == pytest.approx([1, 1], abs=1e-8)
    assert line.radius(np.array([1.1005]), k2=np.array([(first + second) / 2]))[0] > 1 + 1e-3


@pytest.mark.parametrize("rows", [pytest.param(17, marks=pytest.mark.slow), pytest.param(33, marks=pytest.mark.slow)])
def test_a_leaning_region_is_followed_to_its_tip(rows: int) -> None:
    """Its ridge leans by more than its width from row to row, so that the stretch about the last row's loses it."""
    line = TwoDisks(2.4188, 0.00932267, 0.476885, 0.3, 0.8158147, 0.00314435, 1.5236)
    found = tn.stable_windows(line.line(), "Shaft 2.stiffness", 0.2447, 2.4474, (0.3, 1.2), rows=rows)
    end = found.ends[0][1]
    assert end is not None and found.largest == pytest.approx(0.25479, abs=1e-5)
    assert line.radius(np.array([end.speed]), k2=np.array([found.largest]))[0] == pytest.approx(1.0, abs=1e-8)
    speeds = np.linspace(end.speed * 0.999, end.speed * 1.001, 401)
    above, below = (line.radius(speeds, k2=np.full(401, found.largest * (1 + k))).max() for k in (1e-4, -1e-4))
    assert below < 1 < above


def test_speeds_may_be_texts() -> None:
    found = tn.stable_windows(LINE, "HookeJoint 1.angle", 0.0, 0.1, ("1.3 rad/s", "1.4 rad/s"), rows=3)
    assert found.speeds == (1.3, 1.4)


@pytest.mark.slow
def test_short_lines_of_stiff_shafts_need_no_patches() -> None:
    """A spindle that turns slowly: hundreds of cycles a turn, of which patches took minutes."""
    line = tn.load(EXAMPLES / "rolling-mill-spindle.toml")
    found = tn.minimum_damping(line, (tn.rpm(20), tn.rpm(120)))
    assert found.windows[0] == pytest.approx([1e-4, 100.0]) and not found.complete and "checked at" in found.sentence
    for factor in (1e-4, 0.02, 1.0, 80.0):
        damped = line.replace_all(
            {
                name: {key: factor * value}
                for name, one in zip(line.names, line.elements, strict=True)
                for key in ("damping", "loss_factor", "relative_damping")
                if (value := getattr(one, key, None))
            }
        )
        for speed in (2.5, 5.1, 9.3, 12.5):
            assert tn.stability(damped, speed).spectral_radius <= 1 + 1e-9


@pytest.mark.slow
def test_a_long_line_takes_seconds() -> None:
    """Six unknowns, without patches: the least damping is where ``stability`` changes, at the speed named."""
    line = tn.load(EXAMPLES / "truck.toml")
    found = tn.minimum_damping(line, ("300 rpm", "2400 rpm"))
    end, needed = found.ends[0][0], found.smallest
    assert end is not None and needed is not None and not found.complete
    assert f"; checked at {len(found.confirmed)} speeds." in found.sentence

    def radius(factor: float) -> float:
        damps = {
            name: {key: getattr(e, key) * factor for key in ("damping", "loss_factor") if getattr(e, key, None)}
            for name, e in zip(line.names, line.elements, strict=True)
        }
        return tn.stability(line.replace_all(damps), end.speed, tolerance=1e-12).spectral_radius

    assert radius(needed * 0.99) > 1 > radius(needed * 1.01)


BAD = [
    (
        lambda: tn.stable_windows(LINE, "HookeJoint 1.angle", 0, 1, (2.0, 1.0)),
        "speeds = (2.0, 1.0): must be two rising",
    ),
    (lambda: tn.stable_windows(LINE, "HookeJoint 1.angle", 0, 1, (1.0, 2.0), margin=2.0), "margin = 2: must lie"),
    (lambda: tn.minimum_damping(LINE, (1.0, 2.0), damping="Shaft 1.stiffness"), "damping = 'Shaft 1.stiffness': is no"),
]


@pytest.mark.slow
def test_all_damping_is_that_however_it_is_stated() -> None:
    """A common ratio, a loss factor and a coefficient: the edge found is where ``stability`` changes."""

    def line(factor: float, common: bool) -> tn.Driveline:
        loss = {} if common else {"loss_factor": 2e-4 * factor, "loss_factor_frequency": 1.0}
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1.0, **({} if common else {"damping": 2e-4 * factor})),
                tn.Disk(inertia=1.0),
                tn.HookeJoint(angle=0.5),
                tn.Shaft(stiffness=1.0, **loss),
                tn.Disk(inertia=1.0),
            ],
            damping_ratio=1e-4 * factor if common else None,
        )

    for common in (False, True):
        found = tn.minimum_damping(line(1.0, common), (1.55, 1.65), maximum=1000.0, rows=9)
        assert found.parameter == "factor of all damping"
        needed = float(found.windows[-1, 0])
        assert 1 < needed < 1000
        speeds = np.linspace(1.55, 1.65, 41)
        above, below = (
            max(tn.stability(line(needed * k, common), speed=s).spectral_radius for s in speeds) for k in (1.001, 0.98)
        )
        assert above <= 1 < below


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_region_that_enters_through_the_side_of_the_speeds() -> None:
    """A resonance just outside the speeds: the angle that it allows is the one at the nearest speed."""
    for speeds, side in (((1.64, 1.7), 0), ((1.5, 1.6), -1)):
        found = tn.stable_windows(LINE, "HookeJoint 1.angle", 0.0, 0.6, speeds, rows=4)
        end = found.ends[0][1]
        assert found.largest is not None and end is not None and end.speed == speeds[side], found
        assert two_shafts.radius(end.speed, found.largest) == pytest.approx(1.0, abs=1e-9)
        inside = [two_shafts.radius(s, found.largest * (1 - 1e-6)) for s in np.linspace(*speeds, 21)]
        assert max(inside) < 1


@pytest.mark.slow
def test_patches_that_never_settle_are_asked_for_less() -> None:
    """A stiff mesh: its coefficients are not known to what patches are asked for, and halving them goes on for ever."""
    elements = [
        tn.ConstantSpeed(),
        tn.HookeJoint(angle=0.2),
        tn.Shaft(stiffness=1e4, damping=5),
        tn.Disk(inertia=0.1),
        tn.GearPair(teeth_in=25, teeth_out=40, module="3 mm", mesh_stiffness=1e8, mesh_damping=5000.0),
        tn.Disk(inertia=0.05),
        tn.HookeJoint(angle=1.3, plane=0.3),
        tn.Shaft(stiffness=1e4, damping=5),
        tn.Disk(inertia=0.2, load_torque=20),
    ]
    line = tn.Driveline(elements)
    found = tn.minimum_damping(line, (140.0, 144.0), damping="factor of Shaft *.damping", maximum=8.0, rows=4)
    needed = float(found.windows[0, 0])
    for factor, stable in ((1.001, True), (0.999, False)):
        changed = [
            e.model_copy(update={"damping": 5 * needed * factor}) if isinstance(e, tn.Shaft) else e for e in elements
        ]
        assert (tn.stability(tn.Driveline(changed), 144.0).spectral_radius < 1) is stable


@pytest.fixture
def untold(monkeypatch: pytest.MonkeyPatch) -> tuple[float, float]:
    """Angles between which every integration is too inaccurate to tell."""
    band, judged = (0.61, 0.73), Region.judged

    def blind(self: Region, u, v):
        found = judged(self, u, v)
        hidden = np.zeros(len(u), dtype=bool)
        for angle in (self.x(u), self.y(v)):  # the speeds below lie outside the band
            hidden |= (angle > band[0]) & (angle < band[1])
        found.error[hidden] = 1e-3
        found.verdict[hidden] = Verdict.UNDECIDED
        return found

    monkeypatch.setattr(Region, "judged", blind)
    return band


def test_no_window_where_stability_is_not_known(untold: tuple[float, float]) -> None:
    """Speeds without an instability at these angles: what cannot be told ends the window, and is said."""
    found = tn.stable_windows(LINE, "HookeJoint 1.angle", 0.5, 0.8, (0.82, 0.83), rows=9)
    assert not len(found.tongues) and found.largest <= untold[0] and found.smallest >= untold[1]
    assert found.ends[0][1].region == UNKNOWN and f"set by {UNKNOWN}" in found.sentence
    rows = [y for y in np.linspace(0.5, 0.8, 9).tolist() if untold[0] < y < untold[1]]
    assert sorted({u.y for u in found.tongues.unknown}) == pytest.approx(rows, rel=1e-12)
    assert "could not be told" in str(found.tongues)
    assert found.tongues.data.sizes["unknown"] == len(found.tongues.unknown)


def test_a_limit_is_unknown_where_part_of_its_range_is(untold: tuple[float, float]) -> None:
    """The row of a speed runs through angles that cannot be told, though nothing was found unstable."""
    known = tn.stable_limit(LINE, "HookeJoint 1.angle", [0.825], low=0.5, high=0.6)
    assert known.smallest == 0.6 and known.sentence.startswith("Stable at")
    found = tn.stable_limit(LINE, "HookeJoint 1.angle", [0.825], low=0.5, high=0.8)
    assert found.kind.tolist() == [LimitKind.UNKNOWN] and np.isnan(found.smallest)
    assert not len(found.windows[0]) and not len(found.common_windows)
    assert "it is not known" in found.sentence


@pytest.mark.slow
def test_damping_of_a_gear_stage_reaches_to_the_tip() -> None:
    """The bound of ρ, of a stiff mesh a hundred times its error, does not cut the tongue short: with a little less
    damping than stated the line is unstable, by single integrations, with a little more it is stable."""
    line = tn.load(EXAMPLES / "gear-stage.toml")
    found = tn.minimum_damping(line, ("1070 rpm", "1085 rpm"), maximum=1.0, rows=5)
    ((end, _),) = found.ends
    assert found.smallest is not None and end is not None

    def radius(share: float) -> float:
        factor = share * found.smallest
        damped = line.replace("coupling", damping=1.2 * factor).replace("gears", mesh_damping=1500 * factor)
        return float(tn.stability(damped.replace("mixer shaft", loss_factor=0.03 * factor), end.speed).spectral_radius)

    assert radius(1 - 2e-6) > 1 > radius(1 + 2e-6)
