"""Lines that first users wrote by hand, written again with components: the same where the model is, and shorter."""

from __future__ import annotations

import json
import shutil
import tomllib
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


@pytest.mark.parametrize("name", ["ship.toml", "marine.toml"])
def test_with_an_engine_and_one_element_a_line_a_file_is_less_than_half_as_long(name: str, tmp_path: Path) -> None:
    tables = tomllib.loads((WRITTEN_AGAIN / name).read_text(encoding="utf-8"))
    rows = [f"  {inline(one)}," for one in tables.pop("element")]
    rest = [f"{key} = {inline(value)}" for key, value in tables.items()]
    text = "\n".join([*rest, "element = [", *rows, "]", ""])
    listed = tmp_path / "components"
    listed.mkdir()
    shutil.copytree(BY_HAND, tmp_path / "lines")  # whose tables are named
    (listed / name).write_text(text, encoding="utf-8")
    assert lines_of(listed, name) < 0.5 * lines_of(BY_HAND, name)
    again = tn.load(listed / name, tables_anywhere=True)
    assert again == tn.load(WRITTEN_AGAIN / name, tables_anywhere=True)


def inline(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {inline(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(inline(one) for one in value) + "]"
    return json.dumps(value)


def test_the_tractor_with_a_slip_clutch() -> None:
    """Under load the clutch of the file as written slips away; in series it sticks, as if hub and yoke were one."""
    line = tn.load(WRITTEN_AGAIN / "tractor.toml")
    merged = [one for one in line.elements if one.name != "friction clutch"]
    modes = tn.natural_frequencies(line).elastic
    assert modes == pytest.approx(tn.natural_frequencies(tn.Driveline(merged)).elastic, rel=1e-12)
    by_hand = tn.natural_frequencies(tn.load(BY_HAND / "tractor.toml")).elastic
    assert modes[0] / by_hand[0] == pytest.approx(1, abs=0.05)
    assert lines_of(WRITTEN_AGAIN, "tractor.toml") < lines_of(BY_HAND, "tractor.toml")
