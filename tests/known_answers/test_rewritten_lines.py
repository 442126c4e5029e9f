"""Lines that first users wrote by hand, written again with components: the same where the model is, and shorter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import trunnion as tn

DATA = Path(__file__).parents[1] / "data"
BY_HAND, WRITTEN_AGAIN = DATA / "lines", DATA / "components"


def lines_of(folder: Path, name: str) -> int:
    return len((folder / name).read_text(encoding="utf-8").splitlines())


def test_the_ship_with_a_viscous_damper() -> None:
    """A ring on a shaft of 1 N m/rad has a false mode at 0.05 Hz; in oil it has none, and the others are the same."""
    by_hand = tn.natural_frequencies(tn.load(BY_HAND / "ship.toml"))
    again = tn.natural_frequencies(tn.load(WRITTEN_AGAIN / "ship.toml", tables_anywhere=True))
    assert by_hand.elastic[0] < 0.4
    assert again.elastic == pytest.approx(by_hand.elastic[1:], rel=1e-6)
    assert lines_of(WRITTEN_AGAIN, "ship.toml") < 0.6 * lines_of(BY_HAND, "ship.toml")


def test_the_ship_with_an_engine() -> None:
    """Six throws by hand and the engine that stands for them answer alike, but for the ring's shaft of 1 N m/rad."""
    speeds = np.linspace(tn.rpm(300), tn.rpm(800), 41)
    by_hand = tn.order_response(tn.load(BY_HAND / "ship.toml"), speeds)
    again = tn.order_response(tn.load(WRITTEN_AGAIN / "ship.toml", tables_anywhere=True), speeds)
    names = {f"engine.crank {n}-{n + 1}": f"crank {n} to {n + 1}" for n in range(1, 6)} | {"damper": "damper silicone"}
    for s, name in enumerate(again.springs):
        other = by_hand.vibratory_torque[:, by_hand.springs.index(names.get(name, name))]
        assert again.vibratory_torque[:, s] == pytest.approx(other, rel=1e-5)


def test_the_fishing_vessel_with_an_engine() -> None:
    """Its throws bear unlike torques by hand, so frequencies alone are the same."""
    by_hand = tn.natural_frequencies(tn.load(BY_HAND / "marine.toml")).elastic
    again = tn.natural_frequencies(tn.load(WRITTEN_AGAIN / "marine.toml")).elastic
    assert again == pytest.approx(by_hand, rel=1e-9)
    assert lines_of(WRITTEN_AGAIN, "marine.toml") < lines_of(BY_HAND, "marine.toml")


def test_the_tractor_with_a_slip_clutch() -> None:
    """Under load the clutch of the file as written slips away; in series it sticks, as if hub and yoke were one."""
    line = tn.load(WRITTEN_AGAIN / "tractor.toml")
    merged = [one for one in line.elements if one.name != "friction clutch"]
    modes = tn.natural_frequencies(line).elastic
    assert modes == pytest.approx(tn.natural_frequencies(tn.Driveline(merged)).elastic, rel=1e-12)
    by_hand = tn.natural_frequencies(tn.load(BY_HAND / "tractor.toml")).elastic
    assert modes[0] / by_hand[0] == pytest.approx(1, abs=0.05)
    assert lines_of(WRITTEN_AGAIN, "tractor.toml") < lines_of(BY_HAND, "tractor.toml")
