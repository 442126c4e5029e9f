"""Tolerances and slopes of a driven line that its load twists far, about the motion that it really makes, against its
equations written out here: shooting and the variational equations, integrated by SciPy.

A drive turns by Ωt; behind a joint, shaft 1 and disk 1 that turns by x, behind another, shaft 2 and disk 2 that turns
by y under a load. Behind a joint at angle β what turns by a before it turns by g(a) = a + arg(cos a + i sin a / cos β)
− a + π/2, so that g′ = cos β/(1 − sin²β cos²a).

    F₁ = k₁(x − g₁(Ωt)) + c₁(ẋ − g₁′Ω),   F₂ = k₂(y − g₂(x)) + c₂(ẏ − g₂′ẋ)
    J₁ẍ = −F₁ + g₂′F₂,   J₂ÿ = −F₂ − T

Where shaft 2 has stages it is three times as stiff beyond a twist.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app

Array = np.ndarray
SPEED = 77.25
GIVEN = {
    "Shaft 2.stiffness": ("range", 2950.0, 3050.0),
    "Disk 2.inertia": ("range", 0.88, 0.92),
    "HookeJoint 2.angle": ("range", 0.40, 0.44),
}
PATHS = {
    "HookeJoint 1.angle": "angle_1", "HookeJoint 2.angle": "angle_2", "Shaft 1.stiffness": "k_1",
    "Shaft 2.stiffness": "k_2", "Shaft 2.damping": "c_2", "Disk 1.inertia": "j_1", "Disk 2.inertia": "j_2",
    "Disk 2.load_torque": "load",
}  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """The numbers of the line."""

    angle_1: float = 0.5
    angle_2: float = 0.42
    k_1: float = 4000.0
    k_2: float = 3000.0
    c_1: float = 0.35
    c_2: float = 0.25
    j_1: float = 0.6
    j_2: float = 0.9
    load: float = 1700.0
    stage: float = np.inf

    @property
    def line(self) -> tn.Driveline:
        """As the package knows it."""
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.HookeJoint(angle=self.angle_1),
                tn.Shaft(stiffness=self.k_1, damping=self.c_1),
                tn.Disk(inertia=self.j_1),
                tn.HookeJoint(angle=self.angle_2),
                self.shaft_2,
                tn.Disk(inertia=self.j_2, load_torque=self.load),
            ]
        )

    @property
    def shaft_2(self) -> tn.Shaft | tn.PiecewiseShaft:
        """With stages or without."""
        if np.isinf(self.stage):
            return tn.Shaft(stiffness=self.k_2, damping=self.c_2)
        return tn.PiecewiseShaft.symmetric([(self.k_2, self.stage), (3 * self.k_2, None)], damping=self.c_2)

    def at(self, values: dict[str, float]) -> Pair:
        """With other numbers, by the package's paths."""
        return replace(self, **{PATHS[path]: value for path, value in values.items()})

    def _rates(self, t: float, state: Array, speed: float) -> Array:
        whole = state.reshape(4, 5)
        (x, y, v, w), by = whole[:, 0], whole[:, 1:]
        n_1, d_1, _ = behind(speed * t, self.angle_1)
        n_2, d_2, dd_2 = behind(x, self.angle_2)
        first = self.k_1 * (x - n_1) + self.c_1 * (v - d_1 * speed)
        twist, beyond = y - n_2, max(abs(y - n_2) - self.stage, 0.0)
        second = self.k_2 * (twist + 2 * beyond * np.sign(twist)) + self.c_2 * (w - d_2 * v)
        k_2 = self.k_2 * (3 if beyond else 1)
        own = [v, w, (-first + d_2 * second) / self.j_1, (-second - self.load) / self.j_2]
        d_second = k_2 * (by[1] - d_2 * by[0]) + self.c_2 * (by[3] - d_2 * by[2] - dd_2 * v * by[0])
        d_first = self.k_1 * by[0] + self.c_1 * by[2]
        changes = [by[2], by[3], (-d_first + dd_2 * second * by[0] + d_2 * d_second) / self.j_1, -d_second / self.j_2]
        return np.column_stack([own, changes]).ravel()

    def growth(self, speed: float) -> float:
        """Of the fastest disturbance of the periodic motion that Newton's steps from the twisted line close [1/s]."""
        turn = np.pi
        x = behind(0.0, self.angle_1)[0] - self.load / self.k_1
        y = behind(x, self.angle_2)[0] - self.load / self.k_2
        start = np.array([x, y, speed, speed])
        for _ in range(30):
            begin = np.column_stack([start, np.eye(4)]).ravel()
            end = solve_ivp(
                self._rates, (0, turn / speed), begin, "DOP853", args=(speed,), rtol=1e-11, atol=1e-11
            ).y[:, -1].reshape(4, 5)  # fmt: skip
            matrix = end[:, 1:]
            change = np.linalg.solve(matrix - np.eye(4), start + [turn, turn, 0, 0] - end[:, 0])
            start = start + change
            if np.abs(change[:2]).max() < 1e-10:
                return float(np.log(np.abs(np.linalg.eigvals(matrix)).max()) * speed / turn)
        raise AssertionError("no periodic motion was found")


def behind(a: float, angle: float) -> tuple[float, float, float]:
    """Rotation behind a joint and its first two derivatives by that before it."""
    c, s_2 = np.cos(angle), np.sin(angle) ** 2
    below = 1 - s_2 * np.cos(a) ** 2
    ahead = np.arctan2(np.sin(a) * np.cos(a) * (1 - c), c * np.cos(a) ** 2 + np.sin(a) ** 2)
    return a + ahead + np.pi / 2, c / below, -c * 2 * s_2 * np.sin(a) * np.cos(a) / below**2


def test_the_worst_line_is_that_of_the_true_motion() -> None:
    """About the twisted line the line is stable and the worst one grows half as fast. The worst line grows as its
    equations say, no corner grows faster, and the share of stable lines is that of lines drawn by lot."""
    pair, rng = Pair(), np.random.default_rng(5)
    study = tn.tolerance_study(pair.line, GIVEN, [SPEED], samples=512, about_steady_state=True)
    about_twist = tn.tolerance_study(pair.line, GIVEN, [SPEED], samples=512)
    assert study.about_steady_state and not about_twist.about_steady_state
    worst = pair.at(study.worst.values).growth(SPEED)
    assert study.worst.growth_rate == pytest.approx(worst, rel=1e-6)
    assert worst > 1.3 * about_twist.worst.growth_rate
    corners = product(*(one[1:] for one in GIVEN.values()))
    every = [pair.at(dict(zip(GIVEN, corner, strict=True))).growth(SPEED) for corner in corners]
    drawn = [
        pair.at({path: rng.uniform(low, high) for path, (_, low, high) in GIVEN.items()}).growth(SPEED)
        for _ in range(24)
    ]
    assert max(every + drawn) < worst * (1 + 1e-6)
    share = np.mean(np.array(drawn) < 0)
    assert study.interval[0] - 0.3 < share < study.interval[1] + 0.3
    assert "each line is judged about its own periodic motion" in str(study)
    assert "own periodic motion" not in str(about_twist)


@pytest.mark.parametrize(
    "pair",
    [pytest.param(Pair(), id="shafts"), pytest.param(Pair(stage=0.6), id="through stages", marks=pytest.mark.slow)],
)
def test_slopes_are_those_of_the_true_motion(pair: Pair) -> None:
    """Against differences of the equations written out; about the twisted line some are quite different."""
    own = list(PATHS if np.isinf(pair.stage) else ("HookeJoint 2.angle", "Disk 2.inertia", "Disk 2.load_torque"))
    found = tn.sensitivity(pair.line, [SPEED], own, of=["growth"], about_steady_state=True)
    about_twist = tn.sensitivity(pair.line, [SPEED], own, of=["growth"])
    name = found.quantities[0].name
    assert found.quantity(name).value == pytest.approx(pair.growth(SPEED), rel=1e-7)
    assert any("own periodic motion" in finding.sentence for finding in found.findings)
    far = 0
    for path, slope in found.derivatives(name).items():
        value = getattr(pair, PATHS[path])
        step = 1e-3 * (1.0 if path.endswith("angle") else value)
        near, wide = (
            (pair.at({path: value + s * step}).growth(SPEED) - pair.at({path: value - s * step}).growth(SPEED))
            / (2 * s * step)
            for s in (1, 2)
        )
        mine, off = (4 * near - wide) / 3, abs(wide - near) / 3
        stated = float(found.error[0, list(found.parameters).index(path)])
        assert abs(slope - mine) < 2 * stated + 0.1 * off + 1e-7 / step, path
        far += abs(about_twist.derivatives(name)[path] - mine) > 0.3 * abs(mine)
    assert far >= len(own) / 2


def test_both_commands_take_the_option(tmp_path: Path) -> None:
    file = tmp_path / "line.toml"
    tn.dump(Pair().line, file)
    asked = ["--speed", f"{SPEED}rad/s", "--about-steady-state"]
    study = CliRunner().invoke(
        app, ["tolerance-study", str(file), "-t", "Shaft 2.stiffness=1%", "--samples", "256", *asked]
    )
    assert study.exit_code == 0 and "about its own periodic motion" in study.output
    slopes = CliRunner().invoke(app, ["sensitivity", str(file), "-p", "Shaft 2.stiffness", "--of", "growth", *asked])
    true = tn.stability(Pair().line, SPEED, about_steady_state=True).growth_rate
    assert slopes.exit_code == 0 and f"{true:.4g}" in slopes.output
