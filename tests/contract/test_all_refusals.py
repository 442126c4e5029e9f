"""A description with several mistakes is refused with all of them, a line each, whatever its size."""

from __future__ import annotations

import time
import tomllib

import pytest

from trunnion.driveline import toml_file
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.driveline.files import loads
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.shafts import Shaft
from trunnion.errors import LONGEST, InputError

FIVE = """\
format = 1
damping_ratio = "a lot"
[operation]
speed = "0 rpm"
speed_range = ["300 rpm", "100 rpm"]
[[operation.load_case]]
name = "climb"
loads = { "Disk 1" = "3 kg", "Disk 2" = "x" }
[[element]]
type = "Shaft"
stifness = 1
dampng = 2
[[element]]
type = "Disk"
inertia = -1
[[element]]
type = "Dsik"
"""


def lines_of(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        loads(text, source="bad.toml")
    assert str(caught.value).splitlines() == [str(one) for one in caught.value.problems]
    assert all(one.startswith("bad.toml") for one in str(caught.value).splitlines())
    return [str(one).removeprefix("bad.toml: ") for one in caught.value.problems]


def test_every_mistake_of_a_file_has_its_line():
    starts = [line.partition(";")[0] for line in lines_of(FIVE)]
    assert starts == [
        "Shaft 1 (element 1).stifness = 1: unknown key",
        "Shaft 1 (element 1).dampng = 2: unknown key",
        "Disk 1 (element 2).inertia = -1: must be positive",
        "element 3.type = 'Dsik': unknown element type",
        "load case climb.loads.Disk 1 = '3 kg': kg is not the unit of a torque (N*m)",
        "load case climb.loads.Disk 2 = 'x': does not start with a number",
        "operation.speed = '0 rpm': must be positive",
        "operation.speed_range = ['300 rpm', '100 rpm']: is reversed",
        "driveline.damping_ratio = 'a lot': does not start with a number",
    ]


def test_mistakes_between_elements_have_theirs():
    text = (
        'format = 1\nname = "line"\ndamping_ratio_frequency = 3\n[[element]]\ntype = "Disk"\nname = "a"\ninertia = 1\n'
        '[[element]]\ntype = "Disk"\nname = "a"\ninertia = 1\nafter = "b"\n'
        '[[operation.load_case]]\nname = "c"\nloads = { d = 1 }\n'
    )
    found = lines_of(text)
    assert [line.partition(";")[0] for line in found] == [
        "a.name: names elements 1 and 2",
        "a.after = 'b': is not an earlier element",
        "driveline.damping_ratio_frequency = 3: is given without damping_ratio",
        "load case c.d = 1: is not a Disk of this driveline",
    ]


def test_in_python_too():
    with pytest.raises(InputError) as caught:
        HookeJoint(angle="95 deg", plane="x")
    assert [one.key for one in caught.value.problems] == ["angle", "plane"]
    with pytest.raises(InputError) as caught:
        Disk(inertia=1, excitation=[{"order": 2}, 3, {"order": -1, "amplitude": 1}])
    assert [one.key.partition("n ")[2] for one in caught.value.problems] == ["1 amplitude", "2", "3 order"]
    with pytest.raises(InputError) as caught:
        GearPair(teeth_in=20, teeth_out=30, module=1e-3, mesh_stiffness=1e8, transmission_error=[{"order": 0}, 1])
    assert [one.key.partition("r ")[2] for one in caught.value.problems] == ["1 amplitude", "2"]
    with pytest.raises(InputError) as caught:
        Driveline([1, Shaft(stiffness=1), "a"])
    assert [one.element for one in caught.value.problems] == ["element 1", "element 3"]
    assert caught.value.exit_code == 2 and caught.value.key == caught.value.problems[0].key


def test_a_text_lists_a_page_and_the_error_all():
    with pytest.raises(InputError) as caught:
        loads("format = 1\n" + '[[element]]\ntype = "Dsk"\n' * 1000)
    assert len(caught.value.problems) == 1000
    *first, last = str(caught.value).splitlines()
    assert len(first) == 3 and last.startswith("and 997 more of the same, the last at element 1000")
    with pytest.raises(InputError) as caught:
        loads('format = 1\n[[element]]\ntype = "Disk"\ninertia = 1\n' + "".join(f"a{i} = 1\n" for i in range(1000)))
    assert len(str(caught.value).splitlines()) == 21 and str(caught.value).endswith("\nand 980 more")


def test_of_many_that_differ_in_their_place_alone_three_are_written_out():
    shafts = "".join(f'[[element]]\ntype = "Shaft"\nstifness = {k}\n' for k in range(1, 8))
    text = f'format = 1\n{shafts}[[element]]\ntype = "Disk"\ninertia = -1\n'
    with pytest.raises(InputError) as caught:
        loads(text)
    lines = str(caught.value).splitlines()
    assert [line.partition(":")[0] for line in lines[:3]] == [
        f"Shaft {k} (element {k}).stifness = {k}" for k in (1, 2, 3)
    ]
    assert lines[3] == "and 4 more of the same, the last at Shaft 7 (element 7).stifness"
    assert "must be" in lines[4] and len(lines) == 5
    with pytest.raises(InputError) as caught:
        loads(text.replace("stifness", "stiffness", 3))
    assert len(str(caught.value).splitlines()) == 5 and "of the same" not in str(caught.value)


LONG = "x" * 5000
HUGE = {
    "integer": "format = 1\nname = " + "9" * 5000,
    "hexadecimal": "format = 0x" + "f" * 5000,
    "exponent": f'{FIVE}[[element]]\ntype = "Disk"\ninertia = "1e{"9" * 100} kg*m^2"',
    "nines": f'{FIVE}[[element]]\ntype = "Disk"\ninertia = "{"9" * 1_000_000} kg*m^2"',
    "nested headers": "[" + ".".join("a" * 20_000) + "]\n",
    "key of many parts": ".".join("a" * 100_000) + " = 1",
    "key of many quoted parts": ".".join(['"ä"'] * 100_000) + " = 1",
    "nested lists": "format = " + "[" * 200_000,
    "nested tables": "format = " + "{a = " * 5000,
    "deep enough to be read": "format = " + "[" * 150 + "]" * 150,
    "large": "#" * 5_000_000,
    "key": f"{LONG} = 1",
    "value": f'{LONG} = "{LONG}"',
    "name": f'format = 1\n[[element]]\ntype = "{LONG}"\nname = "{LONG}"',
    "unit": f'format = 1\n[[element]]\ntype = "Shaft"\nstiffness = "1 {LONG[:190]}"',
    "load": f'format = 1\n[[operation.load_case]]\nname = "a"\nloads = {{ "{LONG}" = 1 }}\n[[element]]\ntype = "Disk"\n'
    "inertia = 1",
    "twice": f"{LONG} = 1\n{LONG} = 2",
    "list": f"format = [{'1, ' * 100_000}]",
}


@pytest.mark.parametrize("text", HUGE.values(), ids=HUGE.keys())
def test_what_is_huge_is_refused_in_a_few_words(text):
    for line in lines_of(text):
        assert len(line) < 500
        assert "x" * (LONGEST + 1) not in line and "9" * (LONGEST + 1) not in line


def test_keys_and_texts_with_dots_are_read():
    text = (
        'format = 1\ndescription = """\n'
        + "x. " * 500
        + "\n"
        + "." * 500
        + '"""\n[[element]]\ntype = "Disk"\ninertia = 1'
    )
    assert len(loads(text).elements) == 1


DOTS = ".".join("x" * 100)
READ = {
    "comment": f"# {DOTS} it's",
    "comment with an open text": f'# """ {DOTS}\nname = "a" # \'\'\' {DOTS}',
    "basic text": f'description = "a \\" {DOTS}"',
    "literal text": f"description = '{DOTS} \\'  # {DOTS}",
    "text with a sharp": f'description = "# {DOTS}" # "{DOTS}',
    "texts of several lines": f'description = """{DOTS}\n\\"""{DOTS}\n"" {DOTS}"""""',
    "literal texts of several lines": f"description = '''{DOTS}\n'' # {DOTS}\\''''' # {DOTS}",
    "empty text of several lines": f'description = """"""  # {DOTS}',
    "empty text": f'description = ""  # {DOTS}',
}
DEEP = {
    "after a comment": f'# it is 6"\n{DOTS} = 1',
    "after a text": f'name = "a \\" b"\n{DOTS} = 1',
    "after a long text": f'description = """ ""\\""" """""\n{DOTS} = 1',
    "quoted with signs": ".".join(["'#'", '"\\""'] * 50) + " = 1",
    "spaced": " . ".join("x" * 100) + " = 1",
    "in a header": f"[[{DOTS}]]",
    "in a table of one line": f"name = {{ {DOTS} = 1 }}",
}
PARTS = ['\n\\"""', '""', "'''", '"\\', "a", "a.", "a ", "a\n", "#\n", " ", ".", '"a".', "''."]


@pytest.mark.parametrize("head", READ.values(), ids=READ.keys())
def test_dots_outside_keys_are_read(head):
    assert len(loads(f'format = 1\n{head}\n[[element]]\ntype = "Disk"\ninertia = 1').elements) == 1


@pytest.mark.parametrize("head", DEEP.values(), ids=DEEP.keys())
def test_a_key_of_many_parts_is_refused_wherever_it_stands(head):
    tomllib.loads(head)  # it is valid
    (line,) = lines_of(head)
    assert line.endswith("is not valid here: a key of more than 60 parts; remove the extra dots")


@pytest.mark.parametrize("part", PARTS)
def test_large_files_of_one_part_are_gone_through_once(part):
    """Four times the size takes about four times as long, not sixteen times."""
    times = []
    for size in (200_000, 800_000):
        text = "x" + part * (size // len(part))
        begin = time.process_time()
        toml_file._DEEP_KEY.search(toml_file._without_texts(text))
        times.append(time.process_time() - begin)
    assert times[1] < 10 * max(times[0], 0.05)
