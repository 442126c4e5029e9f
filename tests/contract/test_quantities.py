"""Quantities: what is read, exactly, and what the engineer gets to see."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trunnion.driveline import quantities as q

READ = [
    ("12 deg", q.ANGLE, math.radians(12)),
    ("-12.5°", q.ANGLE, math.radians(-12.5)),
    ("0.2 rad", q.ANGLE, 0.2),
    ("3 mrad", q.ANGLE, 0.003),
    ("0.25 turn", q.ANGLE, math.pi / 2),
    ("1500 rpm", q.SPEED, 1500 * 2 * math.pi / 60),
    ("1500 rev/min", q.SPEED, 1500 * 2 * math.pi / 60),
    ("1500 r/min", q.SPEED, 1500 * 2 * math.pi / 60),
    ("50 Hz", q.SPEED, 50 * 2 * math.pi),
    ("50 Hz", q.FREQUENCY, 50 * 2 * math.pi),
    ("1.2 kHz", q.FREQUENCY, 1.2 * (1000 * 2 * math.pi)),
    ("11.1 kN*m/rad", q.STIFFNESS, 11100.0),
    ("2.5e4 N*m/rad", q.STIFFNESS, 25000.0),
    ("2.5e4 Nm/rad", q.STIFFNESS, 25000.0),
    ("2.5e4 N m/rad", q.STIFFNESS, 25000.0),
    ("2.5e4 N·m/rad", q.STIFFNESS, 25000.0),
    ("2.5e4 N.m/rad", q.STIFFNESS, 25000.0),
    ("25kNm/rad", q.STIFFNESS, 25000.0),
    ("95 MN*m/rad", q.STIFFNESS, 95e6),
    ("9526895997 N*mm/rad", q.STIFFNESS, 9526895.997),
    ("20 N*m/deg", q.STIFFNESS, 20 / math.radians(1)),
    ("3 N*m*s/rad", q.DAMPING, 3.0),
    ("3 Nms/rad", q.DAMPING, 3.0),
    ("3 N*m/(rad/s)", q.DAMPING, 3.0),
    ("0.4 kg*m^2", q.INERTIA, 0.4),
    ("0.4 kg m²", q.INERTIA, 0.4),
    ("0.4 kg m2", q.INERTIA, 0.4),
    ("0.4 kg*m**2", q.INERTIA, 0.4),
    ("1.1 t*m^2", q.INERTIA, 1100.0),
    ("250 N*m", q.TORQUE, 250.0),
    ("6.2 kNm", q.TORQUE, 6200.0),
    ("76 mm", q.LENGTH, 0.076),
    ("110mm", q.LENGTH, 0.11),
    ("  4.35 cm ", q.LENGTH, 0.0435),
    ("3 in", q.LENGTH, 0.0762),
    ("79.3 GPa", q.PRESSURE, 79.3e9),
    ("7850 kg/m^3", q.DENSITY, 7850.0),
    ("7.85 g/cm^3", q.DENSITY, 7850.0),
    ("2 %", q.RATIO, 0.02),
    ("0.02", q.RATIO, 0.02),
    (".5 mm", q.LENGTH, 0.0005),
    ("5. mm", q.LENGTH, 0.005),
    (12, q.STIFFNESS, 12.0),
    (1.2e4, q.STIFFNESS, 1.2e4),
]


@pytest.mark.parametrize(("text", "kind", "value"), READ)
def test_reads_exactly(text, kind, value):
    assert q.parse(text, kind) == value


def test_numpy_numbers_are_numbers():
    numpy = pytest.importorskip("numpy")
    assert q.parse(numpy.float32(0.5), q.ANGLE) == 0.5
    assert q.parse(numpy.int64(3), q.LENGTH) == 3.0


@pytest.mark.parametrize("kind", q.KINDS, ids=lambda kind: kind.name)
def test_every_kind_reads_its_own_example_and_si_unit(kind):
    assert q.parse(kind.example, kind) > 0
    if kind is not q.RATIO:
        assert q.parse(f"7 {kind.unit}", kind) == 7.0


@pytest.mark.parametrize("kind", q.KINDS, ids=lambda kind: kind.name)
def test_printed_units_have_the_size_the_parser_gives_them(kind):
    for unit, size, _ in kind.shown:
        assert q.parse(f"1 {unit}", kind) == size


@pytest.mark.parametrize("kind", q.KINDS, ids=lambda kind: kind.name)
def test_usual_units_have_the_size_that_their_definitions_give_them(kind):
    for unit, size in q.USUAL[kind.unit].items():
        assert q.size_by_pint(unit, kind) == size, unit


def test_door_converters_agree_with_strings():
    assert q.deg(12) == q.parse("12 deg", q.ANGLE) == math.radians(12)
    assert q.rpm(1500) == q.parse("1500 rpm", q.SPEED)
    assert q.hz(50) == q.parse("50 Hz", q.SPEED)
    numpy = pytest.importorskip("numpy")
    assert (q.rpm(numpy.array([60.0, 120.0])) == numpy.array([2, 4]) * math.pi).all()


@given(
    st.floats(1e-30, 1e30) | st.floats(-1e30, -1e-30) | st.just(0.0),
    st.sampled_from(q.KINDS),
    st.sampled_from([None, "Hz", "rad/s"]),
)
def test_written_reads_back_exactly(value, kind, unit):
    if unit and kind not in (q.SPEED, q.FREQUENCY):
        unit = None
    assert q.parse(q.written(value, kind, unit), kind) == value


@given(st.integers(-10000, 10000).map(lambda n: n / 100), st.sampled_from(q.KINDS))
def test_written_keeps_round_engineering_numbers(number, kind):
    """What a person wrote as "12.25 deg" is written as "12.25 deg" again, not as 0.2138…"""
    for unit, _, smallest in kind.shown[-1:]:
        value = q.parse(f"{number} {unit}", kind)
        if value != 0 and smallest == 0 and unit in ("deg", "rpm", "Hz", "mm") and abs(value) < 1:
            assert q.written(value, kind) == f"{number:.12g} {unit}"


SHOWN = [
    (math.radians(12), q.ANGLE, None, "12 deg"),
    (q.rpm(1500), q.SPEED, None, "1500 rpm"),
    (q.hz(50), q.SPEED, "Hz", "50 Hz"),
    (3.0, q.SPEED, "rad/s", "3 rad/s"),
    (11100.0, q.STIFFNESS, None, "11.1 kN m/rad"),
    (140.0, q.STIFFNESS, None, "140 N m/rad"),
    (95e6, q.STIFFNESS, None, "95 MN m/rad"),
    (0.076, q.LENGTH, None, "76 mm"),
    (0.4, q.INERTIA, None, "0.4 kg m²"),
    (0.02, q.RATIO, None, "0.02"),
]


@pytest.mark.parametrize(("value", "kind", "unit", "text"), SHOWN)
def test_shown_in_engineering_units(value, kind, unit, text):
    assert q.shown(value, kind, unit) == text


@pytest.mark.parametrize("unit", ["m^9^9^9^9", "m**9**9**9", "m^99999", "a" * 200, "((((((((((m", "m " * 29 + "!"])
def test_hostile_units_are_refused_at_once(unit):
    with pytest.raises(q.InputError):
        q.parse(f"1 {unit}", q.LENGTH)


def test_importing_the_description_is_light():
    code = "import sys, trunnion.driveline; print(*sys.modules)"
    environment = os.environ | {"PYTHONPATH": str(Path(q.__file__).parents[2])}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert not {"numpy", "scipy", "numba", "xarray", "pint", "matplotlib"} & set(run.stdout.split())
