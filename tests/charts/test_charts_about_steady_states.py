"""Charts about the motion that a line really makes against motions and multipliers integrated here, from equations
written here: shooting with steps of Dormand and Prince, nothing of the package."""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.results.verdict import Verdict

Array = NDArray[np.float64]
STEP = 1e-5
"""Of central differences, over the size of each state."""


def behind(chi: Array, angle: float) -> tuple[Array, Array]:
    """Output angle of a Hooke's joint and its slope: tan ψ = tan χ/cos β."""
    c, s2 = np.cos(angle), np.sin(angle) ** 2
    turned = np.arctan2((1 - c) * np.sin(chi) * np.cos(chi), c * np.cos(chi) ** 2 + np.sin(chi) ** 2)
    return chi + turned, c / (1 - s2 * np.cos(chi) ** 2)


@dataclass(frozen=True)
class Pair:
    """Drive – joint – spring – J₁ – joint – spring – J₂ with loads on J₂; ``driven``: the first turns by Ωt, else it is
    a disk J₀ that drives with a constant torque. Forks and planes are zero."""

    driven: bool
    speed: float
    angles: tuple[float, float]
    inertia: tuple[float, float, float] = (1.3, 0.7, 0.9)
    stiffness: tuple[float, float] = (9e3, 6e3)
    damping: tuple[float, float] = (3.0, 2.0)
    load: float = 0.0
    viscous: float = 0.0

    def description(self) -> tn.Driveline:
        first = tn.ConstantSpeed() if self.driven else tn.Disk(inertia=self.inertia[0], drive_share=1.0)
        return tn.Driveline([
            first,
            tn.HookeJoint(angle=self.angles[0]),
            tn.Shaft(stiffness=self.stiffness[0], damping=self.damping[0]),
            tn.Disk(inertia=self.inertia[1]),
            tn.HookeJoint(angle=self.angles[1]),
            tn.Shaft(stiffness=self.stiffness[1], damping=self.damping[1]),
            tn.Disk(inertia=self.inertia[2], load_torque=self.load, viscous_load=self.viscous),
        ])  # fmt: skip

    def rates(self, t: float, state: Array, torque: Array | float) -> Array:
        """Of angles and speeds (6, many) of all three, at time t."""
        q, v = state[:3], state[3:]
        if self.driven:
            q = np.stack([np.full_like(q[0], self.speed * t), q[1], q[2]])
            v = np.stack([np.full_like(v[0], self.speed), v[1], v[2]])
        # The shaft's fork at the second joint stands as that at the first, a quarter turn on from the drive's.
        (a, r), (b, s) = behind(q[0], self.angles[0]), behind(q[1] + np.pi / 2, self.angles[1])
        b = b - np.pi / 2
        (k1, k2), (c1, c2) = self.stiffness, self.damping
        one, two = k1 * (q[1] - a) + c1 * (v[1] - r * v[0]), k2 * (q[2] - b) + c2 * (v[2] - s * v[1])
        j = self.inertia
        first = np.zeros_like(one) if self.driven else (torque + r * one) / j[0]
        return np.concatenate([v, [first, (s * two - one) / j[1], (-two - self.load - self.viscous * v[2]) / j[2]]])

    def radius(self) -> float:
        """Largest multiplier of the motion over half a turn but that of a shift in time, and of the speed where no
        torque depends on it."""
        period = np.pi / self.speed
        own = slice(1, 3) if self.driven else slice(0, 3)
        places = np.r_[np.arange(3)[own], 3 + np.arange(3)[own]]
        size = np.where(np.arange(6) < 3, 1.0, self.speed)

        def after(states: Array, torque: Array | float) -> Array:
            run = solve_ivp(
                lambda t, x: self.rates(t, x.reshape(6, -1), torque).ravel(), (0.0, period), states.ravel(),
                method="DOP853", rtol=1e-11, atol=1e-11,
            )  # fmt: skip
            return run.y[:, -1].reshape(6, -1) - np.where(np.arange(6) < 3, np.pi, 0.0)[:, None]

        twist = -(self.load + self.viscous * self.speed)
        state = np.array([0.0, twist / self.stiffness[0], sum(twist / k for k in self.stiffness)] + 3 * [self.speed])
        torque = self.load + self.viscous * self.speed
        unknown = places if self.driven else places[1:]  # the first angle is held at zero, the torque is unknown
        for _ in range(25):
            step = STEP * size[unknown]
            moved = np.repeat(state[:, None], 2 * len(unknown) + 3, axis=1)
            for k, place in enumerate(unknown):
                moved[place, 2 * k] += step[k]
                moved[place, 2 * k + 1] -= step[k]
            torques = np.full(moved.shape[1], torque)
            torques[-3] += STEP * 100
            torques[-2] -= STEP * 100
            end = after(moved, torques)
            missing = (end[:, -1] - state)[places]
            slope = np.stack([(end[:, 2 * k] - end[:, 2 * k + 1])[places] / (2 * step[k]) for k in range(len(unknown))])
            slope = slope.T - np.eye(6)[np.ix_(places, unknown)]
            if not self.driven:
                slope = np.column_stack([slope, (end[:, -3] - end[:, -2])[places] / (200 * STEP)])
            found = np.linalg.solve(slope, -missing)
            state[unknown] += found[: len(unknown)]
            torque += 0.0 if self.driven else float(found[-1])
            if np.abs(found[: len(unknown)] / size[unknown]).max() < 1e-11:
                break
        else:
            raise AssertionError("no motion")
        step = STEP * size[places]
        moved = np.concatenate([state + np.eye(6)[places] * step[:, None], state - np.eye(6)[places] * step[:, None]]).T
        end = after(moved, torque)
        n = len(places)
        matrix = ((end[:, :n] - end[:, n:])[places] / (2 * step)).astype(float)
        values = np.linalg.eigvals(matrix)
        for _ in range(0 if self.driven else 1 if self.viscous else 2):
            values = np.delete(values, np.abs(values - 1).argmin())
        return float(np.abs(values).max())


def agrees(pair: Pair, chart: tn.StabilityChart, points: list[tuple[int, int]], **at: str) -> None:
    """``at``: which field of ``Pair`` y is."""
    period = chart.period / np.pi
    for row, column in points:
        own = {
            "angle": lambda y: {"angles": (pair.angles[0], y)},
            "load": lambda y: {"load": y},
            "viscous": lambda y: {"viscous": y},
        }[at["y"]]
        one = Pair(**{**vars(pair), "speed": float(chart.x[column]), **own(float(chart.y[row]))})
        true = one.radius() ** period
        off = abs(chart.spectral_radius[row, column] - true)
        assert off <= chart.error_estimate[row, column] + 3e-7, (row, column, true)
        if abs(true - 1) > 1e-5:
            assert Verdict(int(chart.verdict[row, column])) is (Verdict.UNSTABLE if true > 1 else Verdict.STABLE)


def test_a_free_line_over_speed_and_angle() -> None:
    pair = Pair(False, 1.0, (0.35, 0.2), viscous=0.8)
    chart = tn.stability_chart(pair.description(), ("speed", 60.0, 130.0, 6), ("HookeJoint 2.angle", 0.0, 0.5, 5))
    agrees(pair, chart, [(0, 0), (2, 3), (4, 5), (4, 1)], y="angle")
    assert chart.spot_check is not None and chart.spot_check.points > 0
    here = chart.at(83.0, 0.31)
    one = Pair(**{**vars(pair), "speed": 83.0, "angles": (0.35, 0.31)})
    assert here.spectral_radius == pytest.approx(one.radius() ** (chart.period / np.pi), abs=here.error_estimate + 3e-7)
    assert np.abs(here.multipliers - 1).min() == 0  # the shift in time
    assert "own periodic motion" in str(chart)


def test_a_load_by_speed_that_comes_to_nothing() -> None:
    """There the speed changes without end, which is not a disturbance; elsewhere it counts."""
    pair = Pair(False, 80.0, (0.3, 0.2), viscous=0.5)
    chart = tn.stability_chart(pair.description(), ("speed", 70.0, 90.0, 3), ("Disk 3.viscous_load", 0.0, 0.4, 3))
    agrees(pair, chart, [(0, 0), (0, 1), (1, 1), (2, 2)], y="viscous")


def test_a_driven_line_whose_load_twists_it_far() -> None:
    """Beyond small twist the motion of rigid shafts and the one that the line makes have other multipliers."""
    pair = Pair(True, 1.0, (0.5, 0.6), damping=(1.0, 0.5))
    axes = ("speed", 35.0, 90.0, 5), ("Disk 2.load_torque", 0.0, 2500.0, 4)
    chart = tn.stability_chart(pair.description(), *axes, about_steady_state=True)
    agrees(pair, chart, [(0, 1), (3, 4), (2, 2), (3, 0)], y="load")
    rigid = tn.stability_chart(pair.description(), *axes)
    assert np.nanmax(np.abs(rigid.spectral_radius - chart.spectral_radius)) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("free", [True, False])
def test_two_hundred_points(free: bool) -> None:
    pair = Pair(not free, 1.0, (0.35, 0.25), viscous=0.8 if free else 0.0, load=0.0)
    y = ("HookeJoint 2.angle", 0.02, 0.5, 40) if free else ("Disk 2.load_torque", 0.0, 1200.0, 40)
    chart = tn.stability_chart(pair.description(), ("speed", 60.0, 130.0, 40), y, about_steady_state=True)
    rng = np.random.default_rng(8)
    points = [(int(a), int(b)) for a, b in rng.integers(0, 40, (200, 2)) if np.isfinite(chart.spectral_radius[a, b])]
    assert len(points) > 150
    agrees(pair, chart, points, y="angle" if free else "load")


def test_a_chart_is_read_again(tmp_path: Path) -> None:
    pair = Pair(False, 1.0, (0.35, 0.2), viscous=0.8)
    chart = tn.stability_chart(pair.description(), ("speed", 60.0, 130.0, 4), ("HookeJoint 2.angle", 0.1, 0.5, 3))
    path = f"{tmp_path}/chart.nc"
    chart.save(path)
    again = tn.load_chart(path)
    assert again.way == "periodic steady states"
    assert again.at(83.0, 0.31).spectral_radius == pytest.approx(chart.at(83.0, 0.31).spectral_radius, rel=1e-9)
    closer = again.zoom((70.0, 90.0, 3), (0.2, 0.3, 2))
    assert closer.at(80.0, 0.2).spectral_radius == pytest.approx(float(closer.spectral_radius[0, 1]), rel=1e-9)


def test_a_chart_answers_in_another_process(tmp_path: Path) -> None:
    """Compiled equations stand elsewhere there."""
    pair = Pair(False, 1.0, (0.35, 0.2), viscous=0.8)
    chart = tn.stability_chart(pair.description(), ("speed", 70.0, 90.0, 2), ("HookeJoint 2.angle", 0.1, 0.3, 2))
    (tmp_path / "chart").write_bytes(pickle.dumps(chart))
    asked = "import pickle, sys; print(pickle.load(open(sys.argv[1], 'rb')).at(80.0, 0.2).spectral_radius)"
    there = subprocess.run(
        [sys.executable, "-c", asked, str(tmp_path / "chart")], capture_output=True, text=True, check=True
    )
    assert float(there.stdout) == pytest.approx(chart.at(80.0, 0.2).spectral_radius, rel=1e-12)


def test_straight_lines_have_no_other_motion() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)])
    with pytest.raises(tn.InputError, match="has straight joints"):
        tn.stability_chart(
            line, ("speed", 10.0, 20.0, 3), ("Disk 1.inertia", 0.5, 1.0, 3), about_steady_state=True
        )  # fmt: skip


def test_loads_that_the_drive_does_not_balance_are_refused() -> None:
    pair = Pair(False, 1.0, (0.35, 0.2), load=20.0)
    line = tn.Driveline([tn.Disk(inertia=1.3), *pair.description().elements[1:]])
    with pytest.raises(tn.InputError, match="do not balance"):
        tn.stability_chart(line, ("speed", 60.0, 130.0, 3), ("HookeJoint 2.angle", 0.1, 0.5, 3))


def beside(pair: Pair, angle: float, by: float = 1e-5) -> tuple[float, float]:
    """Radii just below and just above an angle of the second joint."""
    one, other = (Pair(**{**vars(pair), "angles": (pair.angles[0], angle + part)}).radius() for part in (-by, by))
    return one, other


def test_the_largest_angle_of_a_free_line() -> None:
    pair = Pair(False, 110.0, (0.35, 0.2), viscous=0.8)
    found = tn.stable_limit(pair.description(), "HookeJoint 2.angle", [110.0], high=0.7, between=False)
    below, above = beside(pair, float(found.limit[0]))
    assert below < 1 < above
    assert "own motion" in found.search and not found.complete


def test_the_worst_free_line_within_its_tolerances() -> None:
    pair = Pair(False, 110.0, (0.35, 0.6), viscous=0.8)
    tolerances = {"Shaft 1.stiffness": 0.1, "HookeJoint 2.angle": 0.05}
    found = tn.tolerance_study(pair.description(), tolerances, speeds=[110.0], samples=256, checks=False)
    worst = found.worst.values
    own = {"stiffness": (worst["Shaft 1.stiffness"], 6e3), "angles": (0.35, worst["HookeJoint 2.angle"])}
    growth = np.log(Pair(**{**vars(pair), **own}).radius()) * 110.0 / np.pi
    assert found.worst.growth_rate == pytest.approx(growth, rel=2e-3)
    assert 0.1 < found.probability < 0.9


def test_a_free_line_that_its_tolerances_alone_bend() -> None:
    """Straight in the middle of them: about rigid shafts its two disks would seem to run away from each other."""
    line = tn.Driveline([
        tn.Disk(inertia=1.0, drive_share=1.0), tn.HookeJoint(angle=0.0), tn.Shaft(stiffness=1e4, damping=20.0),
        tn.Disk(inertia=1.0, viscous_load=0.5),
    ])  # fmt: skip
    angles = {"HookeJoint 1.angle": ("range", -0.1, 0.1)}
    found = tn.tolerance_study(line, angles, speeds=[40.0], samples=256, checks=False)
    one = tn.stability(line.replace("HookeJoint 1", angle=found.worst.values["HookeJoint 1.angle"]), 40.0)
    assert found.probability == 1 and found.worst.growth_rate == pytest.approx(one.growth_rate, rel=2e-3)


@pytest.mark.slow
def test_regions_and_windows_of_a_free_line() -> None:
    pair = Pair(False, 110.0, (0.35, 0.2), viscous=0.8)
    line = pair.description()
    found = tn.tongues(line, ("speed", 104.0, 116.0), ("HookeJoint 2.angle", 0.4, 0.68), rows=3)
    (tongue,) = found
    for y in (tongue.y[-1], tongue.y[len(tongue.y) // 2]):
        for edge in tongue.interval_at(float(y)):
            if 104.0 < edge < 116.0:
                radii = [
                    Pair(**{**vars(pair), "speed": edge + part, "angles": (0.35, float(y))}).radius()
                    for part in (-2e-4, 2e-4)
                ]
                assert min(radii) < 1 < max(radii)
    windows = tn.stable_windows(line, "HookeJoint 2.angle", 0.4, 0.68, (108.0, 112.0), rows=3)
    (end,) = windows.windows[:, 1]
    grid = np.linspace(108.0, 112.0, 9)
    assert all(Pair(**{**vars(pair), "speed": s, "angles": (0.35, end - 1e-4)}).radius() < 1 for s in grid)
    assert any(Pair(**{**vars(pair), "speed": s, "angles": (0.35, end + 2e-2)}).radius() > 1 for s in grid)
    damped = tn.minimum_damping(line, (108.0, 112.0), maximum=10.0, rows=3)
    assert damped.smallest is not None


@pytest.mark.parametrize(
    "pair",
    [
        Pair(True, 63.0, (0.35, 0.3), load=700.0),
        Pair(True, 110.0, (0.5, 0.45), load=-1200.0, viscous=2.0),
        Pair(True, 41.0, (0.6, 0.2), damping=(40.0, 30.0), load=2000.0),
        Pair(True, 63.0, (0.35, 0.3), load=2500.0),
    ],
)
def test_single_speeds_are_judged_about_the_motion_too(pair: Pair) -> None:
    """Also where rigid shafts give another radius by far more than the error."""
    one = tn.stability(pair.description(), pair.speed, about_steady_state=True)
    true = pair.radius() ** (one.period / np.pi)
    assert abs(one.spectral_radius - true) <= one.error_estimate + 3e-7
    assert abs(tn.stability(pair.description(), pair.speed).spectral_radius - true) > 1e-5
    assert one.set_aside == 0
    assert "judged about the line's own periodic motion\n" in str(one)


def test_stages_are_judged_where_the_motion_meets_them() -> None:
    """A spring whose stages lie beyond the motion is judged as the stage that it stays in; one whose motion goes
    through two stages, by both."""
    pair = Pair(True, 63.0, (0.35, 0.3), load=700.0)
    parts = list(pair.description().elements)

    def radius(knee: float) -> float:
        staged = tn.PiecewiseShaft.symmetric([(12e3, knee), (6e3, 1.0)], damping=2.0)
        line = tn.Driveline([*parts[:5], staged, parts[6]])
        return tn.stability(line, pair.speed, about_steady_state=True).spectral_radius

    stiff = tn.Driveline([*parts[:5], tn.Shaft(stiffness=12e3, damping=2.0), parts[6]])
    one = tn.stability(stiff, pair.speed, about_steady_state=True).spectral_radius
    assert radius(0.9) == pytest.approx(one, abs=1e-8)
    mean = 700.0 / 12e3
    assert abs(radius(mean) - one) > 1e-4
