"""The files that engines, motors and propellers start from have a limit for whatever carries torque, and a verdict."""

from __future__ import annotations

import pytest

import trunnion as tn
from trunnion.driveline.starter import starter


@pytest.mark.parametrize("name", ["ship", "two-stroke", "electric-drive", "passenger-car"])
def test_a_starter_comes_to_a_verdict(name: str) -> None:
    judged = tn.assess(tn.loads(starter(name)))
    assert not [check.name for check in judged.checks if check.missing]
    assert str(judged.verdict).startswith("satisfied")
