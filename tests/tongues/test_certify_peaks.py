"""Proved peaks against closed forms, and against equations of the tests' own at random lines of the box."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.dense_scan import Sum
from oracles.line_equations import WIDEST, Steady
from oracles.scanned_lines import ScannedLine, scanned_line
from oracles.steady_orders import response
from typer.testing import CliRunner

import trunnion as tn
from trunnion.response.peaks import periodic_enclosure
from trunnion.response.peaks.certify_peaks import PeakCertificate

EXAMPLES = Path(__file__).parents[2] / "examples"

ASKED = (
    "vibratory_torque", "peak_torque", "vibratory_twist", "peak_twist", "rated_torque", "heat", "speed_fluctuation",
    "acceleration",
)  # fmt: skip
"""What is bounded."""
K, C, J1, J2, AMPLITUDE = 1e4, 20.0, 0.2, 0.8, 100.0


def two_disks(**more: object) -> tn.Driveline:
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": 2, "amplitude": AMPLITUDE}])
    shaft = tn.Shaft(name="shaft", stiffness=K, damping=C)
    return tn.Driveline([engine, shaft, tn.Disk(name="load", inertia=J2)], **more)


def torque(stiffness: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """|f| of the shaft: q̈ (1/(1/J₁ + 1/J₂)) + c q̇ + k q = −A J₂/(J₁ + J₂) e^{2iΩt}."""
    s, reduced = 2j * speed, J1 * J2 / (J1 + J2)
    q = AMPLITUDE * J2 / (J1 + J2) / (stiffness + C * s + reduced * s**2)
    return np.abs((stiffness + C * s) * q)


@pytest.mark.parametrize("share", [0.0, 0.1])
def test_a_resonance_in_closed_form(share: float) -> None:
    """The bound lies above the largest value of a fine grid over speed and stiffness, by less than the gap."""
    given = {"shaft.stiffness": share} if share else {}
    found = tn.certify_peaks(two_disks(), given, (60.0, 300.0), gap=0.03)
    speed, stiffness = np.meshgrid(np.linspace(60, 300, 40_001), K * np.linspace(1 - share, 1 + share, 11))
    largest = torque(stiffness, speed).max()
    assert found.verdict == "proved" and found.open_share == 0
    for bound, computed in (
        (found.vibratory_torque_bound[0], found.vibratory_torque[0]),
        (found.peak_torque_bound[0], found.peak_torque[0]),
    ):
        assert computed * (1 - 1e-5) <= largest <= bound <= 1.03 * computed * (1 + 1e-12)
    assert found.vibratory_twist_bound[0] >= largest / abs(K * (1 + share) + 2j * C * 300)


def test_limits_and_counterexamples() -> None:
    """A limit above the peak is proved; one between the nominal peak and that of the stiffest line is refuted by a line
    that exceeds it, and that line can be loaded."""
    speeds = (60.0, 300.0)
    given = {"shaft.damping": 0.3}
    largest = tn.certify_peaks(two_disks(), {}, speeds, gap=0.02).vibratory_torque[0]

    def judged(limit: float) -> PeakCertificate:
        limits = (tn.Limit(of="shaft", vibratory_torque=limit),)
        return tn.certify_peaks(two_disks(limits=limits), given, speeds)

    proved = judged(1.6 * largest)
    assert proved.verdict == "within limits" and proved.vibratory_torque_bound[0] <= 1.6 * largest
    assert str(proved).startswith("proved within limits: every line within 1 tolerance, from 60 rad/s to 300 rad/s")
    refuted = judged(1.1 * largest)
    assert refuted.verdict == "counterexample" and refuted.line is not None and refuted.counterexample is not None
    again = tn.order_response(refuted.line, refuted.counterexample["speed"])
    assert again.vibratory_torque[0, 0] > 1.1 * largest
    assert "of which 200.9 N m is allowed" in str(refuted).splitlines()[0]
    assert float(refuted.data["counterexample"].sel(variable="shaft.damping")) < C


def test_what_ends_early_still_holds() -> None:
    found = tn.certify_peaks(two_disks(), {"shaft.stiffness": 0.05}, (60.0, 300.0), most_boxes=3)
    assert found.verdict == "undecided" and "as many as most_boxes allows" in found.ended
    assert found.vibratory_torque_bound[0] > 1.05 * found.vibratory_torque[0]
    none = tn.certify_peaks(two_disks(), {}, (60.0, 300.0), within=1e-9)
    assert none.verdict == "undecided" and none.open_share == 1 and "nothing is bounded" in str(none)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (two_disks().replace("shaft", damping=0.0, loss_factor=0.1), "shaft"),
    ],
)  # fmt: skip
def test_refusals(given: tn.Driveline, message: str) -> None:
    with pytest.raises(tn.InputError, match=message):
        tn.certify_peaks(given, {}, (60.0, 300.0))


def test_gaps_are_positive() -> None:
    with pytest.raises(tn.InputError, match="gap = 0: must be positive"):
        tn.certify_peaks(two_disks(), {}, (60.0, 300.0), gap=0)


def attacked(kind: str, seed: int, boxes: int, points: int) -> tuple[int, float]:
    """A random box of a random line: how many of its springs are bounded, and how near the tests' own equations come to
    a bound at random lines and corners; fails where they lie above it."""
    rng = np.random.default_rng([7, seed])
    line = scanned_line(kind, seed)
    description = line.driveline.model_copy(update={"limits": ()})
    for name, element in description.parts:  # a rating that is exceeded would end the search
        if stated := {key: None for key in element.ratings if getattr(element, key) is not None}:
            description = description.replace(name, **stated)
    numbers: list[tuple[str, float]] = []
    for i, (mass, link) in enumerate(zip(line.masses, line.links, strict=True)):
        numbers.append((f"m{i}.inertia", mass.inertia))
        if link is not None and link.kind == "shaft":
            numbers += [(f"s{i}.stiffness", link.stiffness)]
            numbers += [(f"s{i}.damping", link.damping)] if link.damping and not link.loss else []
            numbers += [(f"j{i}.angle", link.angle)] if link.angle else []
    picked = [numbers[k] for k in rng.permutation(len(numbers))[: int(rng.integers(0, 4))]]
    shares = {path: 10 ** rng.uniform(-3, -1.3) for path, _ in picked}
    middle, wide = rng.uniform(line.low, line.high), 10 ** rng.uniform(-3, -0.7)
    speeds = middle * (1 - wide), middle * (1 + wide)
    try:
        found = tn.certify_peaks(description, shares, speeds, gap=0.1, most_boxes=boxes)
    except tn.InputError as error:
        assert any(why in str(error) for why in ("loss", "along a curve", "free–free", "not balance")), error
        return 0, 0.0
    best = {key: np.zeros(len(getattr(found, key))) for key in ASKED}
    for k in range(points):
        share = rng.uniform(-1, 1, 1 + len(picked))
        share = np.sign(share) if k % 3 == 0 else share  # corners, tops as they were found, and inside
        at = rng.choice(found.peak_speed) * (1 + 1e-3 * wide * share[0]) if k % 3 == 1 else np.nan
        speed = np.array([np.clip(at, *speeds) if np.isfinite(at) else middle * (1 + wide * share[0])])
        values = {path: number * (1 + shares[path] * s) for (path, number), s in zip(picked, share[1:], strict=True)}
        for key, value in _values(_changed(line, values), speed).items():
            best[key] = np.maximum(best[key], value)
    assert found.inertias == tuple(f"m{i}" for i in range(len(line.masses)))
    near = 0.0
    for key, value in best.items():
        bound = getattr(found, f"{key}_bound")
        assert not (value > bound * (1 + 1e-6) + 1e-9 * value.max()).any(), (kind, seed, key, value, bound)
        known = np.isfinite(bound) & (value > 1e-2 * value.max())
        near = max(near, (value[known] / bound[known]).max(initial=0.0)) if "torque" in key else near
    return int(np.isfinite(found.vibratory_torque_bound).sum()), float(near)


def _changed(line: ScannedLine, values: dict[str, float]) -> ScannedLine:
    masses, links = list(line.masses), list(line.links)
    for path, value in values.items():
        name, key = path.split(".")
        i = int(name[1:])
        if name[0] == "m":
            masses[i] = replace(masses[i], **{key: value})  # type: ignore[arg-type]
        else:
            links[i] = replace(links[i], **{key: value})  # type: ignore[arg-type,type-var]
    return replace(line, masses=tuple(masses), links=tuple(links))


def _values(line: ScannedLine, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Of every spring and of every inertia, by the names of what is bounded."""
    steady = Steady(line)
    own, (_, damping, _) = response(steady, speed, *WIDEST), steady.springs()
    found: dict[str, list[float]] = {key: [] for key in ASKED}
    for e in range(own.mean_torque.shape[1]):
        torque = {order: part[:, e] for order, part in own.torque.items()}
        twist = {order: part[:, e] for order, part in own.twist.items()}
        for name, mean, parts in (("torque", own.mean_torque, torque), ("twist", own.mean_twist, twist)):
            low, high = (float(end[0]) for end in Sum(mean[:, e], parts).extremes())
            found[f"vibratory_{name}"].append((high - low) / 2)
            found[f"peak_{name}"].append(max(abs(low), abs(high)))
        rate = {key: abs(float(key[0]) * speed[0] + key[1]) for key in torque}
        factor = {key: max(1.0, np.sqrt(nu / (2 * np.pi * 10))) for key, nu in rate.items()}
        found["rated_torque"].append(sum(factor[key] * abs(torque[key][0]) for key in torque))
        found["heat"].append(damping[e] / 2 * sum((nu * abs(twist[key][0])) ** 2 for key, nu in rate.items()))
    for i in range(len(line.masses)):
        for power, name in ((1, "speed_fluctuation"), (2, "acceleration")):
            parts = {
                key: part[:, i] * (1j * (float(key[0]) * speed + key[1])) ** power for key, part in own.rotation.items()
            }
            low, high = Sum(np.zeros(1), parts).extremes()
            found[name].append(float((high - low)[0] / 2))
    return {key: np.array(values) for key, values in found.items()}


@pytest.mark.parametrize(("kind", "seed"), [("straight", 1), ("bent", 2), ("branched", 4)])
def test_random_lines_stay_below(kind: str, seed: int) -> None:
    attacked(kind, seed, 12, 4)


@pytest.mark.parametrize(("kind", "seed"), [pytest.param("bent", 10, marks=pytest.mark.slow), ("branched", 12)])
def test_random_lines_stay_below_by_energy_alone(kind: str, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where harmonics do not contract, as of slow lines with stiff springs, a Lyapunov function bounds the error."""
    monkeypatch.setattr(periodic_enclosure, "_grown", lambda gain: None)
    springs, near = attacked(kind, seed, 12, 4)
    assert springs and near > 0.5


def test_a_slow_line_with_a_light_fork() -> None:
    """The steering column's first mode lies at the 200th harmonic of its joints."""
    found = tn.certify_peaks(tn.load(EXAMPLES / "steering-column.toml"), {}, (1.0, 1.05))
    speeds = np.linspace(1.0, 1.05, 7)
    seen = tn.order_response(tn.load(EXAMPLES / "steering-column.toml"), speeds)
    assert found.open_share == 0 and found.largest_gap < 0.05
    assert np.all(seen.vibratory_torque.max(axis=0) <= found.vibratory_torque_bound)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["straight", "bent", "geared", "branched"])
def test_many_random_lines_stay_below(kind: str) -> None:
    every = [attacked(kind, seed, 60, 12) for seed in range(10, 27)]
    bounded = [near for count, near in every if count]
    assert len(bounded) >= 8 and max(bounded) > 0.95  # some random line comes close to its bound


def test_the_command_answers_and_writes(tmp_path: Path) -> None:
    """Bounds in words, in data and as bars with what was reached."""
    from trunnion.cli import app

    asked = ["certify-peaks", str(EXAMPLES / "pto-shaft.toml"), "--speed", "300rpm:310rpm"]
    files = [str(tmp_path / name) for name in ("peaks.png", "peaks.nc")]
    said = CliRunner().invoke(app, [*asked, "-o", files[0], "-o", files[1]])
    assert said.exit_code == 0 and "is not exceeded" in said.output, said.output
    assert all(Path(name).stat().st_size > 1000 for name in files)
    answer = json.loads(CliRunner().invoke(app, [*asked, "--json", "-o", files[0]]).stdout)
    assert all(a >= b for a, b in zip(answer["vibratory_torque_bound"], answer["vibratory_torque"], strict=True))
