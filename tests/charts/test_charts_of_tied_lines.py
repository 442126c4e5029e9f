"""Lines whose shafts are tied to two others, or close a loop, over two parameters: charts, tongues, limits, damping and
tolerances.

An axle behind one Hooke's joint, whose wheels drive one car, has its equations written out here, legs and side gears by
Lagrange's, and is integrated by SciPy; one whose wheels may turn against each other is compared with ``stability``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

RATIO, PINION, CASE, SIDE, WHEELS = 2.5, 0.02, 0.05, (0.03, 0.03), (0.9, 0.8)
CAR = 3.0
STIFFNESS, DAMPING = (9e3, 6e3, 5e3, 4e3, 7e3, 6e3), (0.2, 0.15, 0.2, 0.15, 0.3, 0.3)
"""In front of the joint, behind it, of both half shafts and both tyres."""
SPEEDS, ANGLES = ("speed", 126.0, 141.0, 31), ("joint.angle", 0.3, 0.6, 5)


@dataclass(frozen=True)
class Axle:
    """A driven disk, a joint, a propeller shaft, and a differential with two wheels."""

    speed: float = 100.0
    angle: float = 0.3
    front: float = 0.15
    stiffness: tuple[float, ...] = STIFFNESS
    damping: tuple[float, ...] = DAMPING

    def line(self) -> tn.Driveline:
        """As the package has it."""
        k, c = self.stiffness, self.damping
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=k[0], damping=c[0], name="front shaft"),
                tn.Disk(inertia=self.front, name="flange"),
                tn.HookeJoint(angle=self.angle, name="joint"),
                tn.Shaft(stiffness=k[1], damping=c[1], name="propeller shaft"),
                tn.Disk(inertia=PINION, name="pinion"),
                tn.Differential(ratio=RATIO, inertia=CASE, name="axle"),
                tn.Disk(inertia=SIDE[0], name="left side gear"),
                tn.Shaft(stiffness=k[2], damping=c[2], name="left half shaft"),
                tn.Disk(inertia=WHEELS[0], name="left wheel"),
                tn.Disk(inertia=SIDE[1], name="right side gear", after="axle.right"),
                tn.Shaft(stiffness=k[3], damping=c[3], name="right half shaft"),
                tn.Disk(inertia=WHEELS[1], name="right wheel"),
                tn.Shaft(stiffness=k[4], damping=c[4], name="left tyre", after="left wheel"),
                tn.Disk(inertia=CAR, name="car"),
                tn.Shaft(stiffness=k[5], damping=c[5], name="right tyre", after="right wheel", to="car"),
            ]
        )

    def radius(self) -> float:
        """Largest modulus of a multiplier over half a turn, after which the joint repeats."""
        run = solve_ivp(
            self.slope, (0, np.pi / self.speed), np.eye(12).ravel(), "DOP853", rtol=1e-11, atol=1e-13
        )  # fmt: skip
        return float(np.abs(np.linalg.eigvals(run.y[:, -1].reshape(12, 12))).max())

    def slope(self, t: float, states: np.ndarray) -> np.ndarray:
        """Disturbances of flange, side gears, wheels and car about the motion of rigid shafts, twelve at once."""
        x, v = states.reshape(12, 12)[:6], states.reshape(12, 12)[6:]
        turned, cosine = self.speed * t, np.cos(self.angle)
        below = np.cos(turned) ** 2 + (cosine * np.sin(turned)) ** 2  # tan of one fork is cos β times that of the other
        eta = cosine / below
        bend = cosine * (1 - cosine**2) * np.sin(2 * turned) / below**2
        k, c = self.stiffness, self.damping
        into, rate = RATIO * (x[1] + x[2]) / 2, RATIO * (v[1] + v[2]) / 2  # of the pinion
        torque = k[1] * (into - eta * x[0]) + c[1] * (rate - eta * v[0] - bend * self.speed * x[0])
        legs = [k[2 + i] * (x[3 + i] - x[1 + i]) + c[2 + i] * (v[3 + i] - v[1 + i]) for i in range(2)]
        shared = RATIO**2 * PINION / 4 + CASE / 4
        mass = np.array([[SIDE[0] + shared, shared], [shared, SIDE[1] + shared]])
        gears = np.linalg.solve(mass, np.array([legs[0] - RATIO / 2 * torque, legs[1] - RATIO / 2 * torque]))
        flange = (-k[0] * x[0] - c[0] * v[0] + eta * torque) / self.front
        tyres = [k[4 + i] * (x[5] - x[3 + i]) + c[4 + i] * (v[5] - v[3 + i]) for i in range(2)]
        wheels = [(tyres[i] - legs[i]) / WHEELS[i] for i in range(2)]
        return np.concatenate([v, [flange], gears, wheels, [-(tyres[0] + tyres[1]) / CAR]]).ravel()


@cache
def chart() -> tn.StabilityChart:
    return tn.stability_chart(Axle().line(), SPEEDS, ANGLES)


def test_a_chart_behind_a_joint_is_that_of_equations_written_out() -> None:
    found, rng = chart(), np.random.default_rng(3)
    unstable = np.argwhere(found.spectral_radius > 1)
    assert 10 < len(unstable) < found.spectral_radius.size / 2
    for i, j in [*unstable[rng.integers(len(unstable), size=6)], *rng.integers((5, 31), size=(10, 2))]:
        own = Axle(speed=float(found.x[j]), angle=float(found.y[i])).radius()
        assert abs(own - found.spectral_radius[i, j]) < 1e-8 + found.error_estimate[i, j]
    assert found.error_estimate.max() < 1e-7


def test_points_between_those_of_a_chart(tmp_path) -> None:
    """Also of one that was read from a file."""
    found = chart()
    found.save(tmp_path / "axle.nc")
    for one in (found, tn.load_chart(tmp_path / "axle.nc")):
        point = one.at(133.7, 0.47)
        assert abs(point.spectral_radius - Axle(speed=133.7, angle=0.47).radius()) < 1e-8 + point.error_estimate


@pytest.mark.slow
def test_ranges_of_an_axle_end_where_its_own_radius_is_one() -> None:
    """Of tongues and of the search over speed alone."""
    found = tn.tongues(Axle().line(), ("speed", 134.0, 140.0), ("joint.angle", 0.45, 0.55), rows=3)
    ranges = found.intervals_at(0.5)
    assert len(ranges)
    for low, high in ranges:
        assert Axle(speed=(low + high) / 2, angle=0.5).radius() > 1
        for end, out in ((low, -1e-6), (high, 1e-6)):
            if 134.01 < end < 139.99:
                assert Axle(speed=end * (1 + out), angle=0.5).radius() < 1
                assert Axle(speed=end * (1 - out), angle=0.5).radius() > 1
    scan = np.linspace(134.0, 140.0, 121)
    inside = np.any([(low <= scan) & (scan <= high) for low, high in ranges], axis=0)
    assert not any(Axle(speed=s, angle=0.5).radius() > 1 for s in scan[~inside])


def test_a_limit_of_an_axle_is_where_its_own_radius_is_one() -> None:
    limit = tn.stable_limit(Axle().line(), "joint.angle", [136.0], low=0.1, high=0.6, scan=24)
    edge = float(limit.limit[0])
    assert Axle(speed=136.0, angle=edge * (1 - 1e-5)).radius() < 1 < Axle(speed=136.0, angle=edge * (1 + 1e-5)).radius()


def test_the_share_of_stable_axles_and_the_worst() -> None:
    given = {"joint.angle": (0.3, 0.5), "front shaft.stiffness": (0.97 * STIFFNESS[0], 1.03 * STIFFNESS[0])}
    ranges = {key: ("range", *ends) for key, ends in given.items()}
    study = tn.tolerance_study(Axle().line(), ranges, [136.0], samples=256)
    rng = np.random.default_rng(8)

    def own(angle: float, stiffness: float) -> float:
        return Axle(speed=136.0, angle=angle, stiffness=(stiffness, *STIFFNESS[1:])).radius()

    drawn = np.array([own(*(rng.uniform(*ends) for ends in given.values())) for _ in range(60)])
    share, scatter = float((drawn < 1).mean()), 4 * np.sqrt(0.25 / len(drawn))
    assert 0.05 < share < 0.95 and study.interval[0] - scatter < share < study.interval[1] + scatter
    values = study.worst.values
    worst = own(values["joint.angle"], values["front shaft.stiffness"])
    assert np.log(worst) * 136.0 / np.pi == pytest.approx(study.worst.growth_rate, rel=1e-4)
    assert np.log(drawn.max()) * 136.0 / np.pi < study.worst.growth_rate * (1 + 1e-6)


def test_an_axle_whose_wheels_may_turn_against_each_other() -> None:
    """Those two multipliers are set aside; at single points ``stability`` says the same."""
    whole = Axle().line()
    line = tn.Driveline(list(whole.elements)[:-3])
    found = tn.stability_chart(line, ("speed", 126.0, 141.0, 4), ("joint.angle", 0.3, 0.6, 3))
    for i, angle in enumerate(found.y):
        for j, speed in enumerate(found.x):
            own = tn.stability(tn.Driveline(list(Axle(angle=float(angle)).line().elements)[:-3]), float(speed))
            assert own.set_aside == 2
            off = abs(own.spectral_radius - found.spectral_radius[i, j])
            assert off < own.error_estimate + found.error_estimate[i, j] + 1e-9


def test_lines_that_are_too_long_or_free_are_refused() -> None:
    whole = list(Axle().line().elements)
    train = [part for k in range(20) for part in (tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=0.1))]
    long = tn.Driveline([whole[0], *train, *whole[1:]])
    said = r"^axle: ties one shaft to two others in a line of 26 unknowns, of which charts and studies take 24; join "
    with pytest.raises(tn.InputError, match=said):
        tn.stability_chart(long, SPEEDS, ANGLES)
    with pytest.raises(tn.InputError, match=said):
        tn.tolerance_study(long, {"joint.angle": 0.1}, [136.0])
    free = tn.Driveline([tn.Disk(inertia=1.0, drive_share=1.0), *whole[1:]])
    with pytest.raises(tn.InputError, match="ties one shaft to two others, which charts do not follow, as a free–free"):
        tn.stability_chart(free, SPEEDS, ANGLES)
