"""What generators in ``docs/data`` stored: a slice of each is generated again, and all of it has a date."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from as_printed import ROOT

DATA = ROOT / "docs/data"


def generator(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, DATA / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def stored(name: str) -> Any:
    return json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))


def test_a_study_is_as_stored() -> None:
    again = json.loads(json.dumps(generator("reproduced").told("bicardan-elastic")))
    kept = stored("reproduced")["bicardan-elastic"]
    assert {key: kept[key] for key in again if key != "seconds"} == {k: v for k, v in again.items() if k != "seconds"}


@pytest.mark.study
@pytest.mark.slow
@pytest.mark.parametrize("name", ["two-shaft-cardan", "three-shaft-cardan", "gear-rattle", "double-tripod"])
def test_every_study_is_as_stored(name: str) -> None:
    again = json.loads(json.dumps(generator("reproduced").told(name)))
    kept = stored("reproduced")[name]
    assert kept["conclusions"] == again["conclusions"]
    assert [[row[:2] for row in one["rows"]] for one in kept["tables"]] == [
        [row[:2] for row in one["rows"]] for one in again["tables"]
    ]


def test_studies_of_all_papers_are_stored() -> None:
    from trunnion.papers.reproduce import PAPERS

    assert set(stored("reproduced")) == set(PAPERS)
    assert all(one["tables"] and one["conclusions"] for one in stored("reproduced").values())


def test_open_torsion_gives_what_is_stored() -> None:
    beside = generator("beside")
    case = beside.chain_case()
    other = beside.theirs(sys.executable, "chain_in_opentorsion", case)
    assert other["values"] == pytest.approx(beside.chain(case), rel=1e-11)


def test_other_programs_agree_as_far_as_they_can() -> None:
    found = {one["program"]: one["value"] for one in stored("beside")["cases"]}
    assert found["openTorsion"] < 1e-11 and found["ROSS"] < 1e-9 and found["heyoka"] < 1e-10
    assert found["Exudyn"] < 1e-4  # second order in its 3 600 steps
    assert {path.stem for path in (DATA / "programs").glob("*.py")} == {
        one["case"] for one in stored("beside")["cases"]
    }


@pytest.mark.parametrize("name", ["reproduced", "beside", "printed_numbers"])
def test_stored_data_say_when_and_with_what(name: str) -> None:
    found = stored(name)
    parts = [found] if name == "beside" else found.values()
    assert all(one["on"] >= "2026" and (one.get("version") or one["versions"]["Trunnion"]) for one in parts)
    assert Path(DATA / f"{name}.py").exists()
