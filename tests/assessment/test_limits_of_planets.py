"""Permissible torques in the meshes of planets: the static one by hand, the largest of both meshes over speed."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.design.assessment.check import Status

SUN, RING, MODULE, PLANETS = 30, 72, 0.003, 3


def line(load: float, limits: tuple[tn.Limit, ...] = (), shaken: float = 0.0) -> tn.Driveline:
    gears = tn.Planetary(
        name="set", teeth_sun=SUN, teeth_ring=RING, input="sun", held="ring", planets=PLANETS, planet_inertia=2e-4,
        sun_mesh_stiffness=2e8, ring_mesh_stiffness=3e8, mesh_damping=3e3, module=MODULE,
    )  # fmt: skip
    shake = [{"order": 4, "amplitude": shaken}] if shaken else []
    return tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=4e4, damping=20.0, name="input"), tn.Disk(inertia=0.02), gears,
            tn.Disk(inertia=0.1), tn.Shaft(stiffness=8e4, damping=40.0, name="output"),
            tn.Disk(inertia=1.0, load_torque=load, excitation=shake),
        ],
        operation=tn.Operation(speed=120.0, application="industrial"),
        limits=(tn.Limit(of="Shaft *", max_torque=1e5), *limits),
    )  # fmt: skip


def test_the_static_torque_by_hand() -> None:
    """Each mesh bears F = T_s/(N r_bs); about their axes all planets feel F N r_bp = T_s z_p/z_s."""
    load = 680.0
    on_sun = load / (1 + RING / SUN)
    by_hand = on_sun * ((RING - SUN) / 2) / SUN
    allowed = tn.Limit(of="set", max_torque=1.25 * by_hand)
    check = tn.assess(line(load, (allowed,)), (120.0, 120.0)).check("max torque of set")
    assert check.status is Status.SATISFIED
    assert check.value == pytest.approx(by_hand, rel=1e-9)
    assert check.margin == pytest.approx(0.2, rel=1e-9)


def test_the_larger_of_both_meshes_over_speed() -> None:
    limits = (tn.Limit(of="Planetary *", max_torque=1e4, vibratory_torque=1e4),)
    subject = line(680.0, limits, shaken=90.0)
    found = tn.assess(subject, (60.0, 260.0))
    speeds = np.linspace(60.0, 260.0, 4001)
    response = tn.order_response(subject, speeds)
    both = [response.springs.index(f"{mesh} mesh of set") for mesh in ("sun", "ring")]
    for name, values in (("max torque", response.peak_torque), ("vibratory torque", response.vibratory_torque)):
        check = found.check(f"{name} of set")
        assert check.value == pytest.approx(values[:, both].max(), rel=1e-5)
    assert response.vibratory_torque[:, both[0]].max() != pytest.approx(response.vibratory_torque[:, both[1]].max())


def test_a_set_of_elastic_teeth_without_a_limit_is_named_once() -> None:
    found = tn.assess(line(680.0), (120.0, 120.0))
    assert found.verdict is Status.NOT_JUDGED
    assert found.check("torque without limit").because.startswith("set: no limit of torque")
