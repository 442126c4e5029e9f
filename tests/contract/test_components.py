"""The catalogue of components: found by name, kept beside what is made of them, refused in one line."""

from __future__ import annotations

import json
import random
import tomllib
import warnings
from pathlib import Path

import jsonschema
import pytest

import trunnion as tn
from trunnion.cli import main
from trunnion.driveline import json_schema
from trunnion.driveline.component_files import find
from trunnion.errors import InputError, InputRemark

LINE = """format = 1
[[element]]
type = "ConstantSpeed"
[[element]]
name = "coupling"
{component}
[[element]]
type = "Disk"
inertia = "3 kg*m^2"
"""
MAKER = """format = 1
source = "sheet 7, page 2"
date = "2020-03"

[[component]]
name = "EL-8"
type = "Coupling"
[component.printed]
"c (dyn)" = "8000 Nm/rad"
[component.numbers]
stiffness = "8 kN*m/rad"
relative_damping = 0.9

[[component]]
name = "EL-8"
version = 2
type = "Coupling"
source = "sheet 7a, page 2"
[component.numbers]
stiffness = "9 kN*m/rad"
relative_damping = 0.9

[[component]]
name = "disk-1"
type = "Clutch"
[component.numbers]
stiffnesses = ["800 N*m/rad"]
friction = [{ torque = "6 N*m", stiffness = "4 kN*m/rad" }]
"""


@pytest.fixture(autouse=True)
def no_files_of_the_user(tmp_path, monkeypatch):
    monkeypatch.setenv("TRUNNION_COMPONENTS", str(tmp_path / "own"))


def beside(folder: Path, text: str = MAKER, name: str = "works") -> None:
    (folder / "components").mkdir(exist_ok=True)
    (folder / "components" / f"{name}.toml").write_text(text, encoding="utf-8")


def line_of(folder: Path, component: str) -> tn.Driveline:
    path = folder / "line.toml"
    path.write_text(LINE.format(component=component), encoding="utf-8")
    return tn.load(path)


def test_a_line_has_the_numbers_of_the_sheet_and_says_where_they_come_from(tmp_path):
    beside(tmp_path)
    coupling = line_of(tmp_path, 'component = "works/EL-8@1"').elements[1]
    assert coupling == tn.Coupling(
        stiffness=8e3, relative_damping=0.9, name="coupling", sheet=coupling.sheet
    )  # the numbers by hand
    sheet = coupling.sheet
    assert (sheet.component, sheet.version, sheet.source, sheet.date) == (
        "works/EL-8", 1, "sheet 7, page 2", "2020-03",
    )  # fmt: skip
    assert sheet.printed == {"c (dyn)": "8000 Nm/rad"}
    assert sheet.numbers["stiffness"] == "8 kN*m/rad"  # as typed


def test_the_highest_version_is_taken_where_none_is_asked_for(tmp_path):
    beside(tmp_path)
    coupling = line_of(tmp_path, 'component = "works/EL-8"').elements[1]
    assert (coupling.stiffness, coupling.sheet.version, coupling.sheet.source) == (9e3, 2, "sheet 7a, page 2")


def test_a_saved_line_needs_the_catalogue_no_more_and_still_says_where_its_numbers_come_from(tmp_path):
    beside(tmp_path)
    for name in ("works/EL-8", "works/disk-1"):
        line = line_of(tmp_path, f'component = "{name}"')
        (tmp_path / "elsewhere").mkdir(exist_ok=True)
        tn.dump(line, tmp_path / "elsewhere" / "saved.toml")
        again = tn.load(tmp_path / "elsewhere" / "saved.toml")
        assert again == line and hash(again.elements[1]) == hash(line.elements[1])
        assert again.elements[1].sheet.component == name
        assert tn.dumps(again) == tn.dumps(line)


def test_keys_beside_the_component_stand_in_place_of_its_own_with_a_remark(tmp_path):
    beside(tmp_path)
    with pytest.warns(InputRemark, match="coupling .element 2..stiffness = '8.4 kN.m/rad': differs from 9 kN.m/rad"):
        coupling = line_of(tmp_path, 'component = "works/EL-8"\nstiffness = "8.4 kN*m/rad"').elements[1]
    assert coupling.stiffness == 8.4e3
    assert coupling.departures == {"stiffness": "9 kN*m/rad"}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        same = line_of(tmp_path, 'component = "works/EL-8"\nfork_offset = "10 deg"').elements[1]
    assert same.departures == {} and same.fork_offset == pytest.approx(tn.deg(10))
    assert same.but(stiffness=1e3).departures == {"stiffness": "9 kN*m/rad"}


def test_the_nearest_folder_counts(tmp_path):
    own = MAKER.replace("8 kN*m/rad", "11 kN*m/rad").replace("9 kN*m/rad", "12 kN*m/rad")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "works.toml").write_text(own, encoding="utf-8")
    assert tn.component("works/EL-8").stiffness == 12e3
    assert [one.place for one in tn.components() if one.sheet.component == "works/EL-8"] == ["of the user"] * 2
    assert line_of(tmp_path, 'component = "works/EL-8"').elements[1].stiffness == 12e3
    beside(tmp_path)
    assert line_of(tmp_path, 'component = "works/EL-8"').elements[1].stiffness == 9e3
    assert find("works/EL-8").place == "of the user"
    assert find("works/EL-8", tmp_path).place == "beside the line"


def test_every_component_of_the_package_makes_its_element_and_has_a_source():
    shipped = [one for one in tn.components() if one.place == "of Trunnion"]
    assert shipped
    for one in shipped:
        made = one.element()
        assert made.kind == one.kind and made.departures == {}
        assert one.sheet.source and one.sheet.date and one.sheet.printed
        assert tn.component(one.sheet.component) == made


REFUSED = [
    ('component = "works/EL-9"', 'did you mean "works/EL-8"?'),
    ('component = "works/EL-8@3"', 'did you mean "works/EL-8@2"?'),
    ('component = "wroks/EL-8"', 'did you mean "works/EL-8"?'),
    ('component = "../works/EL-8"', "leads out of the folders of components"),
    ('component = "/etc/passwd"', "leads out of the folders of components"),
    ('component = "..\\\\works/EL-8"', "leads out of the folders of components"),
    ('component = "EL-8"', "is not the name of a component, maker/type"),
    ("component = 8", "is not the name of a component, maker/type"),
    ('component = "works/EL-8"\ntype = "Shaft"', 'is a Coupling; write type = "Coupling"'),
    ('component = "works/EL-8"\nsheet = { component = "a/b" }', "conflicts with sheet"),
    ('component = "works/EL-8"\nstifness = 3', "unknown key; did you mean"),
]


@pytest.mark.parametrize(("stated", "words"), REFUSED, ids=[row[0] for row in REFUSED])
def test_what_names_no_component_is_refused_in_one_line(stated, words, tmp_path):
    beside(tmp_path)
    with pytest.raises(InputError) as caught:
        line_of(tmp_path, stated)
    message = str(caught.value)
    assert message.startswith("line.toml: coupling (element 2)") and words in message and "\n" not in message


def test_a_link_that_leads_out_of_the_folder_of_the_line_is_refused(tmp_path):
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "works.toml").write_text(MAKER, encoding="utf-8")
    (tmp_path / "near" / "components").mkdir(parents=True)
    (tmp_path / "near" / "components" / "works.toml").symlink_to(tmp_path / "far" / "works.toml")
    with pytest.raises(InputError, match="lies outside the folder of the file that names it; put the file into"):
        line_of(tmp_path / "near", 'component = "works/EL-8"')
    (tmp_path / "linked").mkdir()
    (tmp_path / "linked" / "components").symlink_to(tmp_path / "far")
    with pytest.raises(InputError, match="lies outside the folder"):
        line_of(tmp_path / "linked", 'component = "works/EL-8"')


BROKEN = [
    (("format = 1", "format = 2"), "format is not a known format of components"),
    (("format = 1", ""), "format is missing; write format = 1"),
    (("format = 1", "format = 1\nmaker = 2"), "maker unknown key"),
    (('name = "EL-8"', 'name = "EL 8"'), "component EL 8.name is not a type of a maker"),
    (('type = "Coupling"', 'type = "Copling"'), 'unknown element type; did you mean "Coupling"?'),
    (('stiffness = "8 kN*m/rad"', ""), "component EL-8.stiffness is missing"),
    (('stiffness = "8 kN*m/rad"', 'stiffness = "8 kN*m"'), "is not the unit of a stiffness"),
    (('stiffness = "8 kN*m/rad"', 'name = "x"'), "component EL-8.name belongs to a line, not to its maker"),
    (("version = 2", "version = 1"), "works/EL-8 stands twice with version 1"),
    (("version = 2", 'version = "b"'), "component EL-8.version must be a whole number from 1"),
    (("version = 2", "stiffness = 3"), "stiffness unknown key; write stiffness under [component.numbers]"),
    (('date = "2020-03"', ""), "component EL-8.date is missing"),
    (('source = "sheet 7, page 2"', "source = 3"), "component EL-8.source is not a line of text"),
    (('"c (dyn)" = "8000 Nm/rad"', '"c (dyn)" = [1]'), "component EL-8.printed is not a table of texts"),
    (("[component.numbers]", "[component.number]"), 'number unknown key; did you mean "numbers"?'),
    (("[[component]]", "[component"), "is not valid TOML"),
]


@pytest.mark.parametrize(("change", "words"), BROKEN, ids=[repr(row[0][1]) for row in BROKEN])
def test_a_damaged_file_of_components_is_refused_with_its_place(change, words, tmp_path):
    beside(tmp_path, MAKER.replace(*change, 1))
    with pytest.raises(InputError) as caught:
        line_of(tmp_path, 'component = "works/EL-8"')
    for one in str(caught.value).splitlines():
        assert one.startswith("line.toml: coupling (element 2).component: components/works.toml")
    assert words in str(caught.value), caught.value
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("seed", range(60))
def test_a_mutated_file_of_components_is_read_or_refused(seed, tmp_path):
    draw = random.Random(seed)
    text = list(MAKER)
    for _ in range(draw.randint(1, 6)):
        place = draw.randrange(len(text))
        text[place : place + draw.randint(0, 3)] = draw.choice(["", "=", '"', "[", "]", "0", "\n", "é", ".", "-1", "{"])
    beside(tmp_path, "".join(text))
    try:
        line = line_of(tmp_path, 'component = "works/EL-8"')
    except InputError as error:
        assert str(error) and error.exit_code == 2
    else:
        assert line.elements[1].sheet is not None


def test_the_schema_takes_components_and_saved_sheets():
    check = jsonschema.Draft202012Validator(json_schema())
    named = tomllib.loads(LINE.format(component='component = "example/rubber-16"'))
    assert not list(check.iter_errors(named))
    saved = tomllib.loads(tn.dumps(tn.loads(LINE.format(component='component = "example/rubber-16"'))))
    assert not list(check.iter_errors(saved))
    wrong = tomllib.loads(LINE.format(component='component = "rubber-16"'))
    assert list(check.iter_errors(wrong))


def run(*arguments: str, capsys) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    said = capsys.readouterr()
    return ended.value.code, said.out, said.err


def test_the_command_lists_components_and_prints_one_that_reads_back(capsys):
    code, out, _ = run("components", capsys=capsys)
    assert code == 0 and "example/rubber-16" in out and "Coupling" in out and "components beside a line" in out
    code, out, _ = run("components", "example/rubber-16", capsys=capsys)
    assert code == 0
    printed = tn.loads(
        f'format = 1\n[[element]]\ntype = "ConstantSpeed"\n{out}\n[[element]]\ntype = "Disk"\ninertia = 1'
    )
    assert printed.elements[1] == tn.component("example/rubber-16")
    code, out, _ = run("components", "example/rubber-16", "--json", capsys=capsys)
    assert code == 0 and json.loads(out)["sheet"]["component"] == "example/rubber-16"
    code, out, _ = run("components", "--json", capsys=capsys)
    assert "example/rubber-16" in [one["component"] for one in json.loads(out)["components"]]
    code, out, err = run("components", "example/ruber-16", capsys=capsys)
    assert (code, out) == (2, "") and 'did you mean "example/rubber-16"?' in err
