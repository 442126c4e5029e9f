"""Elements and the driveline they form: what follows from what is stated."""

import math
import pickle
import warnings
from fractions import Fraction

import numpy as np
import pytest
from element_examples import ELEMENTS, ONE_OF_EACH, PARTS, TUBE, WITH_STAGES

import trunnion as tn
from trunnion.driveline import (
    ConstantSpeed,
    Coupling,
    Disk,
    Driveline,
    HookeJoint,
    LoadCase,
    Operation,
    Ratio,
    Shaft,
    deg,
    rpm,
)
from trunnion.driveline.geometry import disk_inertia, tube_inertia, tube_stiffness
from trunnion.driveline.kinds import KINDS
from trunnion.errors import InputError, InputRemark


def small_line(**rest):
    return Driveline(
        [
            ConstantSpeed(),
            Shaft(stiffness=1.2e4),
            Disk(inertia=0.4),
            HookeJoint(angle=deg(12)),
            Shaft(stiffness=1.0e4, name="rear"),
            Disk(inertia=0.9, load_torque=20.0),
        ],
        **rest,
    )


@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: e.kind)
def test_every_element_is_a_frozen_value_made_from_what_it_states(element):
    assert KINDS[element.kind] is type(element)
    assert type(element)(**element.stated) == element
    assert hash(type(element)(**element.stated)) == hash(element)
    assert pickle.loads(pickle.dumps(element)) == element
    with pytest.raises(ValueError, match="frozen"):
        element.name = "other"


def test_units_and_numbers_give_the_same_element():
    assert Shaft(stiffness="12 kN*m/rad", fork_offset="90 deg") == Shaft(stiffness=12000, fork_offset=math.pi / 2)
    assert HookeJoint(angle="12 deg").angle == math.radians(12)


def test_tube_shaft():
    shaft = Shaft(**TUBE, density="7850 kg/m^3")
    area = math.pi / 32 * (0.11**4 - 0.1**4)
    assert shaft.stiffness is None
    assert shaft.torsional_stiffness == pytest.approx(79.3e9 * area / 1.3, rel=1e-15)
    assert shaft.moment_of_inertia == pytest.approx(7850 * area * 1.3, rel=1e-15)
    assert Shaft(**TUBE).moment_of_inertia == 0.0
    solid = Shaft(outer_diameter=0.1, length=1, shear_modulus=8e10)
    assert solid.inner_diameter == 0.0
    assert solid.torsional_stiffness == pytest.approx(8e10 * math.pi * 1e-4 / 32)


def test_keys_that_do_not_apply_stay_unset():
    """They would otherwise show up as parameters that change nothing."""
    shaft = Shaft(stiffness=1.0)
    assert shaft.inner_diameter is None and shaft.density is None
    assert Disk(inertia=1.0).inner_diameter is None


def test_loss_factor_is_a_damping_coefficient_at_its_frequency():
    shaft = Shaft(stiffness=1e4, loss_factor=0.02, loss_factor_frequency="50 Hz")
    assert shaft.damping_coefficient == pytest.approx(0.02 * 1e4 / (100 * math.pi))
    assert Shaft(stiffness=1e4, damping=3).damping_coefficient == 3.0


def test_disk_from_geometry():
    disk = Disk(outer_diameter=1.0, inner_diameter=0.5, thickness=0.1, density=7850)
    mass = 7850 * math.pi / 4 * (1 - 0.25) * 0.1
    assert disk.moment_of_inertia == pytest.approx(mass * (0.5**2 + 0.25**2) / 2)
    assert Disk(inertia=0.4).moment_of_inertia == 0.4


def test_geometry_takes_arrays():
    numpy = pytest.importorskip("numpy")
    outer = numpy.array([0.05, 0.1])
    stiffness = tube_stiffness(outer, 0.0, 1.0, 8e10)
    assert stiffness[1] == pytest.approx(16 * stiffness[0])
    assert tube_inertia(outer, 0.0, 2.0, 7850.0) == pytest.approx(disk_inertia(outer, 0.0, 2.0, 7850.0))


@pytest.mark.parametrize(
    ("ratio", "fraction"),
    [
        (Ratio(teeth_in=10, teeth_out=41), Fraction(41, 10)),
        (Ratio(teeth_in=11, teeth_out=37), Fraction(37, 11)),
        (Ratio(ratio=4.1), Fraction(41, 10)),
        (Ratio(ratio=-3.9), Fraction(-39, 10)),
        (Ratio(ratio=1e-5), Fraction(1, 100000)),
        (Ratio(ratio=2), Fraction(2)),
    ],
)
def test_ratio_is_exact(ratio, fraction):
    assert ratio.fraction == fraction
    assert ratio.speed_ratio == float(fraction)


def test_negative_damping_is_a_remark():
    with pytest.warns(InputRemark, match=r"^Shaft\.damping = -3: is negative"):
        assert Shaft(stiffness=1e4, damping=-3).damping == -3.0
    with pytest.warns(InputRemark, match=r"^driveline\.damping_ratio = -0\.01: is negative"):
        small_line(damping_ratio=-0.01)


def test_large_angles_are_no_remark_in_python():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert HookeJoint(angle="60 deg").angle == pytest.approx(np.pi / 3)


def test_names_are_given_or_ordinal_per_kind():
    line = small_line()
    assert line.names == ("ConstantSpeed 1", "Shaft 1", "Disk 1", "HookeJoint 1", "rear", "Disk 2")
    assert line.index("rear") == 4
    third = Driveline([Shaft(stiffness=1, name="a"), Shaft(stiffness=1), Disk(inertia=1)])
    assert third.names[1] == "Shaft 2"  # the ordinal counts named ones too


def test_parents_form_a_tree():
    line = Driveline(
        [
            ConstantSpeed(),
            Shaft(stiffness=1e4),
            Disk(inertia=1, name="gear"),
            Shaft(stiffness=1e4),
            Disk(inertia=1),
            Shaft(stiffness=1e4, after="gear"),
            Disk(inertia=1),
            Shaft(stiffness=1e3, after="Disk 2"),
            ConstantSpeed(),
        ]
    )
    assert line.parents == (None, 0, 1, 2, 3, 2, 5, 4, 7)
    assert small_line().parents == (None, 0, 1, 2, 3, 4)


def test_elements_are_kept_as_given():
    elements = [ConstantSpeed(), Shaft(stiffness=1.0), Disk(inertia=1.0)]
    line = Driveline(elements)
    assert line.elements == tuple(elements)
    assert line == Driveline(iter(elements))
    assert hash(line) == hash(Driveline(elements))
    assert pickle.loads(pickle.dumps(line)) == line


def test_replace_leaves_the_original_alone():
    line = small_line(name="x", damping_ratio=0.02)
    other = line.replace("HookeJoint 1", angle="15 deg")
    assert other.elements[3].angle == math.radians(15)
    assert line.elements[3].angle == deg(12)
    assert (other.name, other.damping_ratio) == ("x", 0.02)
    tube = line.replace("rear", stiffness=None, **TUBE)
    assert tube.elements[4].torsional_stiffness == Shaft(**TUBE).torsional_stiffness


def test_load_case_replaces_the_torques_it_names():
    cases = (LoadCase(name="climb", loads={"Disk 2": "250 N*m"}),)
    line = small_line(operation=Operation(speed=rpm(1500), load_cases=cases))
    loaded = line.with_load("climb")
    assert loaded.elements[5].load_torque == 250.0
    assert line.elements[5].load_torque == 20.0
    assert loaded.elements[2] == line.elements[2]
    assert loaded.operation == line.operation


def test_operation_reads_units():
    operation = Operation(
        speed="1200 rpm", speed_range=["5 Hz", "40 Hz"], angle_range=("0 deg", "15 deg"), speed_unit="Hz"
    )
    assert operation.speed == rpm(1200)
    assert operation.speed_range == (10 * math.pi, 80 * math.pi)
    assert operation.angle_range == (0.0, math.radians(15))


def test_a_line_introduces_itself():
    line = Driveline(ONE_OF_EACH, name="everything")
    assert str(line).splitlines() == [
        "Driveline 'everything' of 9 elements",
        "  drive         ConstantSpeed",
        "  Shaft 1       stiffness 12 kN m/rad, damping 3 N m s/rad, fork offset 90 deg",
        "  Shaft 2       tube 110 mm with bore 100 mm, 1.3 m long, 277.9 kN m/rad, 0.0465 kg m², "
        "loss factor 0.02 at 50 Hz",
        "  Disk 1        inertia 0.4 kg m², load torque 250 N m",
        "  Disk 2        after drive, disk 300 mm, 20 mm long, 0.1248 kg m²",
        "  HookeJoint 1  angle 12 deg, plane 15 deg",
        "  IdealJoint 1",
        "  Ratio 1       ratio -4.1",
        "  Ratio 2       teeth in 10, teeth out 41",
    ]
    assert str(Driveline([ConstantSpeed(), *PARTS])).splitlines()[2:] == [
        "  Shaft 1          tube 76 mm with bore 72 mm, 1.4 m long, 36.08 kN m/rad, 0.007001 kg m², loss factor 0.02, "
        "material C45",
        "  Coupling 1       stiffness 35 kN m/rad, relative damping 1.13, nominal torque 5000 N m, heat rating 350 W",
        "  Disk 1           269.5 kg m², mass 2200 kg, radius 350 mm",
        "  Disk 2           disk 300 mm, 20 mm long, 0.1248 kg m², material steel",
        "  Planetary 1      teeth sun 30, teeth ring 72, input sun, held ring, planet mass 0.8 kg, "
        "centre distance 80 mm",
        "  Differential 1   teeth in 10, teeth out 41, inertia 0.05 kg m²",
    ]


def test_lists_of_harmonics_and_sliders_are_counted():
    listed = str(Driveline([ConstantSpeed(), WITH_STAGES[0], WITH_STAGES[-1], Disk(inertia=1)]))
    assert "ripple of 1 harmonic, reference angle 10 deg" in listed
    assert "friction of 1 slider" in listed


def test_a_material_gives_what_is_not_stated_and_is_all_that_is_written():
    named = Shaft(outer_diameter="76 mm", inner_diameter="72 mm", length="1.4 m", material="steel")
    spelt = Shaft(
        outer_diameter=0.076, inner_diameter=0.072, length=1.4, shear_modulus=79.3e9, density=7850, young_modulus=206e9
    )
    assert named.torsional_stiffness == spelt.torsional_stiffness
    assert named.moment_of_inertia == spelt.moment_of_inertia > 0
    assert "shear_modulus" not in named.stated and named.stated["material"] == "steel"
    light = Shaft(outer_diameter="76 mm", length="1.4 m", material="steel", density=0)
    assert light.moment_of_inertia == 0 and light.stated["density"] == 0
    assert Shaft(outer_diameter=0.05, length=1, material="42CrMo4").tensile_strength == 900e6
    assert named.tensile_strength is None
    wheel = Disk(outer_diameter=0.3, thickness=0.02, material="aluminium")
    assert wheel.moment_of_inertia == disk_inertia(0.3, 0.0, 0.02, 2700.0)


def test_mass_on_wheels_is_an_inertia():
    assert Disk(mass="2.2 t", radius="0.35 m").moment_of_inertia == pytest.approx(2200 * 0.35**2)


def test_a_coupling_damps_by_its_relative_damping():
    """ψ = 2πη; at a frequency it is the coefficient ηk/ω."""
    rubber = Coupling(stiffness=35e3, relative_damping=2 * math.pi * 0.15, loss_factor_frequency="20 Hz")
    shaft = Shaft(stiffness=35e3, loss_factor=0.15, loss_factor_frequency="20 Hz")
    assert rubber.damping_coefficient == pytest.approx(shaft.damping_coefficient, rel=1e-14)
    assert Coupling(stiffness=35e3, relative_damping=1.0).loss == pytest.approx(1 / (2 * math.pi))


def test_a_coupling_is_a_shaft_to_every_analysis():
    def line(spring):
        return Driveline(
            [
                ConstantSpeed(),
                spring,
                Disk(inertia=0.4),
                HookeJoint(angle=0.3),
                Shaft(stiffness=1e4, damping=1.0),
                Disk(inertia=0.9),
            ]
        )

    rubber = line(Coupling(stiffness=35e3, relative_damping=2 * math.pi * 0.15, loss_factor_frequency="20 Hz"))
    shaft = line(Shaft(stiffness=35e3, loss_factor=0.15, loss_factor_frequency="20 Hz"))
    here, there = (tn.stability(one, speed=90.0) for one in (rubber, shaft))
    np.testing.assert_allclose(here.multipliers, there.multipliers, rtol=1e-12)
    both = [tn.kinetostatics(one, speed=90.0, output_torque=30.0).data for one in (rubber, shaft)]
    np.testing.assert_allclose(both[0].torque, both[1].torque, rtol=1e-12)
    axis = ("Coupling 1.relative_damping", 0.1, 1.0, 3)
    chart = tn.stability_chart(rubber, ("speed", 80.0, 100.0, 3), axis)
    assert np.all(np.diff(chart.spectral_radius, axis=0) < 0), "more damping, smaller radius"
    forever = line(Coupling(stiffness=35e3, relative_damping=0.9))
    with pytest.raises(InputError, match="relative_damping.*holds at all frequencies"):
        tn.stability(forever, speed=90.0)
    assert np.isfinite(tn.order_response(forever, [90.0]).torque).all()
