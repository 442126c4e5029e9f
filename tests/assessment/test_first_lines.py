"""Lines as engineers wrote them who did not know the package: each ends in a verdict that says what it lacks."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.analyses.assessment.check import Status

LINES = Path(__file__).parents[1] / "data" / "lines"
APPLICATION = {
    "4x4-free": "road", "car": "road", "engine-held": "road", "low-speed-ship": "industrial",
    "low-speed-steering": "steering", "marine": "industrial", "ship": "ship", "steering": "steering",
    "tolerances": "mill", "tractor": "pto",
}  # fmt: skip
SLOW = ("4x4-free", "car", "marine")


def read(name: str) -> tn.Driveline:
    return tn.load(LINES / f"{name}.toml")


def unjudged(found: tn.Assessment) -> list:
    return [one for one in found.checks if one.status is Status.NOT_JUDGED]


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=pytest.mark.slow) if one in SLOW else one for one in APPLICATION]
)
@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
def test_what_is_not_judged_says_what_is_missing(name: str) -> None:
    line = read(name)
    found = tn.assess(line)
    assert not any("; " not in one.because or "\n" in one.because for one in unjudged(found))
    low, high = line.operation.speed_range or (line.operation.speed,) * 2
    for one in found.checks:
        if one.value is not None and one.covered:
            assert one.covered[0][0] <= low * (1 + 1e-9) and one.covered[-1][1] >= high * (1 - 1e-9), one.name


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=pytest.mark.slow) if one in SLOW else one for one in APPLICATION]
)
@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
def test_with_one_key_for_each_element_everything_is_judged(name: str, tmp_path: Path) -> None:
    line = read(name)
    stated = {one.element for one in line.limits_by_element}
    sprung = [
        n
        for n, one in zip(line.names, line.elements, strict=True)
        if isinstance(one, tn.Shaft | tn.Coupling | tn.GearPair | tn.Clutch) and n not in stated
    ]
    limits = "".join(f'[[limit]]\nof = "{one}"\nmax_torque = "1 MN*m"\n' for one in sprung)
    text = (LINES / f"{name}.toml").read_text(encoding="utf-8")
    if "application" not in text and "[operation]" in text:
        text = text.replace("[operation]", f'[operation]\napplication = "{APPLICATION[name]}"', 1)
    elif "[operation]" not in text:
        limits += f'[operation]\napplication = "{APPLICATION[name]}"\nspeed_range = ["300 rpm", "1500 rpm"]\n'
    for table in LINES.glob("*.csv"):
        shutil.copy(table, tmp_path)
    (tmp_path / "line.toml").write_text(f"{text}\n{limits}", encoding="utf-8")
    found = tn.assess(tn.load(tmp_path / "line.toml"))
    assert not unjudged(found), [(one.name, one.because) for one in unjudged(found)]
    assert str(found.verdict) in ("satisfied", "exceeded")
