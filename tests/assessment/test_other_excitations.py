"""A cylinder out of work takes over what follows from the line without its excitations, and nothing else."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import trunnion as tn
from trunnion.design.assessment.assess import of_response
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse, cases_of, with_torques
from trunnion.design.assessment.other_excitations import with_other_excitations
from trunnion.equations.coefficients import assemble

LOW, HIGH = tn.rpm(600), tn.rpm(1600)
GAS = [{"order": k / 2, "torques": [0.0, 90.0, 400.0], "amplitudes": [20.0, 260.0 / k, 900.0 / k]} for k in (1, 3, 4)]


def engine_set(angle: str = "0 deg", **engine: object) -> tn.Driveline:
    """A four-cylinder engine with tables of gas torque over load that have a point within the range."""
    given: dict[str, object] = {
        "firing_order": "1-3-4-2", "throw_inertia": 0.05, "throw_stiffness": 2e5, "gas_torque": GAS, "drive_share": 1.0,
        "name": "engine",
    }  # fmt: skip
    return tn.Driveline(
        [
            tn.Engine(**{**given, **engine}),
            tn.Coupling(stiffness=3e3, damping=2.0, nominal_torque=400.0, vibratory_torque=90.0, name="coupling"),
            tn.Disk(inertia=0.3, name="flange"),
            *([tn.HookeJoint(angle=angle), tn.Shaft(stiffness=2e4, damping=1.0), tn.HookeJoint(angle=angle)]
              if angle != "0 deg" else [tn.Shaft(stiffness=2e4, damping=1.0, name="shaft")]),
            tn.Disk(inertia=1.5, quadratic_load=0.03, name="pump"),
        ],
        limits=[tn.Limit(of="engine.crank *", vibratory_torque=600.0)],
        operation=tn.Operation(speed=HIGH, speed_range=[LOW, HIGH]),
    )  # fmt: skip


def case_of(line: tn.Driveline) -> LoadCaseResponse:
    (case,) = cases_of(line, LOW, HIGH)
    springs = range(len(case.assembly.topology.compliances))
    (found,) = with_torques([case], tuple(("vibratory", s) for s in springs))
    return found


@cache
def firing() -> LoadCaseResponse:
    return case_of(engine_set())


def values(case: LoadCaseResponse, line: tn.Driveline) -> dict[str, float]:
    """Of every check and every torque."""
    subject = AssessmentInput(line, LOW, HIGH, HIGH, "rpm", (case,))
    judged = [check for check in of_response(subject, case) if check.judged]
    checks = {f"{c.name}, {key}": getattr(c, key) for c in judged for key in ("value", "margin")}
    return {**checks, **{one.name: case.largest(one).value for one in case.measures}}


@pytest.mark.parametrize("key", ["misfiring", "cut_out"])
def test_its_values_are_those_of_the_line_looked_at_by_itself(key: str) -> None:
    line = engine_set(**{key: 3})
    found, alone = with_other_excitations(firing(), assemble(line)), case_of(line)
    assert found.alike is firing() and alone.alike is None
    assert len(found.stable_pieces) > 1  # a point of the tables lies within the range
    assert values(found, line) == pytest.approx(values(alone, line), rel=1e-9)
    assert values(found, line) != pytest.approx(values(firing(), engine_set()), rel=1e-2)


def test_all_cylinders_are_the_sum_of_each() -> None:
    """Of N cylinders each is missing once in the N lines that have one cut out: together they make N − 1 times all."""
    orders, speeds = [0.5, 1.5, 2.0], [LOW, tn.rpm(911), HIGH]
    every = tn.order_response(engine_set(), speeds, orders).torque
    cut = [tn.order_response(engine_set(cut_out=number), speeds, orders).torque for number in (1, 2, 3, 4)]
    assert np.abs(every).max() > 10.0
    np.testing.assert_allclose(sum(cut), 3 * every, rtol=1e-10, atol=1e-10 * np.abs(cut).max())


@pytest.mark.slow
def test_about_the_periodic_motion_of_joints_too() -> None:
    """The motion and its stability are those of all firing; the response is the failing line's own."""
    line = engine_set("20 deg", misfiring=2)
    found, alone = with_other_excitations(case_of(engine_set("20 deg")), assemble(line)), case_of(line)
    assert found.alike is not None and found.costly
    assert found.motions is found.alike.motions
    assert values(found, line) == pytest.approx(values(alone, line), rel=1e-5)


@pytest.mark.parametrize(
    "changed",
    [
        engine_set(misfiring=2).replace("pump", quadratic_load=0.02),  # another balance of torques
        engine_set(misfiring=2).replace("coupling", stiffness=2.9e3),
        engine_set(misfiring=2, throw_inertia=0.06),
        engine_set(misfiring=2, drive_share=0.9).replace("pump", drive_share=0.1),
        engine_set(gas_torque=[*GAS, {"order": 2.5, "amplitude": 3.0}]),  # an order that was not there
        engine_set(gas_torque=[{**one, "torques": [0.0, 80.0, 400.0]} for one in GAS]),  # points elsewhere
    ],
)
def test_a_line_that_differs_otherwise_is_looked_at_by_itself(changed: tn.Driveline) -> None:
    assert with_other_excitations(firing(), assemble(changed)).alike is None
