"""Files that a description names: regular, bounded, below its folder, and nothing of them in any message."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.driveline.csv_table import LARGEST_TABLE

posix = pytest.mark.skipif(os.name != "posix", reason="pipes, devices and links")
TABLE = "order,amplitude [N*m]\n2,30\n"
SECRET = "s3cret-h4sh"
LINE = """\
format = 1
[[element]]
type = "ConstantSpeed"
[[element]]
type = "Shaft"
stiffness = 1e4
[[element]]
type = "Disk"
inertia = 0.4
excitation = {named}
"""


def line_naming(folder: Path, named: str) -> Path:
    path = folder / "line.toml"
    path.write_text(LINE.format(named=f"'{named}'"), encoding="utf-8")
    return path


def refused(path: Path, **options: bool) -> str:
    with pytest.raises(tn.InputError) as caught:
        tn.load(path, **options)
    line = str(caught.value)
    assert "\n" not in line and len(line) < 400 and SECRET not in line
    return line


@pytest.fixture
def lines(tmp_path: Path) -> Path:
    folder = tmp_path / "lines"
    (folder / "tables").mkdir(parents=True)
    for path in (tmp_path / "outside.csv", folder / "beside.csv", folder / "tables" / "below.csv"):
        path.write_text(TABLE, encoding="utf-8")
    (tmp_path / "shadow").write_text(f"root:{SECRET}:19000:0:99999:7:::\n", encoding="utf-8")
    return folder


@pytest.mark.parametrize("named", ["beside.csv", "tables/below.csv", "./tables/../beside.csv", "{folder}/beside.csv"])
def test_below_the_folder_it_is_read(lines: Path, named: str) -> None:
    line = tn.load(line_naming(lines, named.format(folder=lines)))
    assert line.elements[2].excitation[0].amplitude == 30.0


def test_the_folder_may_be_a_link_and_a_link_may_stay_below(lines: Path, tmp_path: Path) -> None:
    (tmp_path / "linked").symlink_to(lines)
    (lines / "again.csv").symlink_to(lines / "tables" / "below.csv")
    line_naming(lines, "again.csv")
    assert tn.load(tmp_path / "linked" / "line.toml").elements[2].excitation


def test_the_working_folder_does_not_matter(lines: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    line_naming(lines, "beside.csv")
    monkeypatch.chdir(lines)
    assert tn.load("line.toml").elements[2].excitation
    monkeypatch.chdir(lines / "tables")
    assert tn.load("../line.toml").elements[2].excitation


OUTSIDE = [
    "../outside.csv",
    "{outside}",
    "tables/../../outside.csv",
    "../lines-too/a.csv",
    "..",
    "../shadow",
    "link.csv",
]


@posix
@pytest.mark.parametrize("named", [*OUTSIDE, "folder/outside.csv", "/etc/shadow", "/dev/zero", "/proc/self/environ"])
def test_outside_the_folder_it_is_refused_and_with_the_option_read(lines: Path, tmp_path: Path, named: str) -> None:
    (tmp_path / "lines-too").mkdir()
    (tmp_path / "lines-too" / "a.csv").write_text(TABLE, encoding="utf-8")
    (lines / "link.csv").symlink_to(tmp_path / "outside.csv")
    (lines / "folder").symlink_to(tmp_path)
    path = line_naming(lines, named.format(outside=tmp_path / "outside.csv"))
    said = refused(path)
    assert "lies outside the folder of the file that names it" in said and "tables_anywhere=True" in said
    if named.endswith(".csv") or named == "{outside}":
        assert tn.load(path, tables_anywhere=True).elements[2].excitation[0].amplitude == 30.0
    else:
        refused(path, tables_anywhere=True)


@posix
@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "/dev/random", "pipe", "socket", "folder"])
def test_what_is_no_regular_file_is_refused_at_once(lines: Path, device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    there = lines / "table.csv"
    if device == "pipe":
        os.mkfifo(there)
    elif device == "socket":
        import socket

        with socket.socket(socket.AF_UNIX) as one:
            monkeypatch.chdir(lines)  # such names are short
            one.bind("table.csv")
    elif device == "folder":
        there.mkdir()
    else:
        there.symlink_to(device)
    path = line_naming(lines, "table.csv")
    assert "is not a regular file" in refused(path, tables_anywhere=True)
    with pytest.raises(tn.InputError):
        tn.read_excitation(there)
    if not there.is_symlink():
        assert "is not a regular file" in refused(path)


@posix
@pytest.mark.parametrize("special", ["/dev/zero", "pipe", "folder"])
def test_charts_are_regular_files_too(tmp_path: Path, special: str) -> None:
    path = Path(special)
    if special == "pipe":
        os.mkfifo(path := tmp_path / "chart.nc")
    elif special == "folder":
        path = tmp_path
    with pytest.raises(tn.InputError, match="is not a regular file"):
        tn.load_chart(path)


HOSTILE = {
    "one line": SECRET,
    "a header": f"{SECRET} [N*m],order\n1,2\n",
    "a known name and a unit": f"order,amplitude [{SECRET}]\n2,3\n",
    "a number": f"order,amplitude [N*m]\n2,{SECRET}\n",
    "an order": f"order,amplitude [N*m]\n{SECRET},3\n",
    "a number and more": f"order,amplitude [N*m]\n2,3 {SECRET}\n",
    "nothing to number": "order,amplitude [N*m]\n2,nan\n",
    "a long cell": f'order,amplitude [N*m]\n2,"{SECRET * 20_000}\n',
    "cells without end": "order,amplitude [N*m]\n" + "," * 400_000,
    "a text left open": 'order,amplitude [N*m]\n2,"3\n' + f"{SECRET}\n" * 10,
    "a null": f"order,amplitude [N*m]\n2,\0{SECRET}\n",
    "no text": "\udcff".join(SECRET),
    "too large": f"order,amplitude [N*m]\n{SECRET}" + "2,3\n" * LARGEST_TABLE,
}


@pytest.mark.parametrize("content", HOSTILE.values(), ids=HOSTILE.keys())
def test_nothing_of_a_table_is_quoted(lines: Path, content: str) -> None:
    (lines / "table.csv").write_bytes(content.encode("utf-8", "surrogateescape"))
    assert "table.csv" in refused(line_naming(lines, "table.csv"))


@pytest.mark.skipif(sys.platform != "linux", reason="processes are counted there")
def test_a_file_that_grows_while_it_is_read_is_bounded(lines: Path) -> None:
    """A file of /proc says that it has no bytes, and has some."""
    assert Path("/proc/self/maps").stat().st_size == 0
    said = refused(line_naming(lines, "/proc/self/maps"), tables_anywhere=True)
    assert "is not a column of such a table" in said


def test_the_command_has_the_option_too(run, here: Path, tmp_path: Path) -> None:
    (here / "below").mkdir()
    line_naming(here / "below", "../outside.csv")
    (here / "outside.csv").write_text(TABLE, encoding="utf-8")
    refusal = run("natural-frequencies", "below/line.toml")
    assert refusal.exit_code == 2 and "trunnion --tables-anywhere" in refusal.output
    assert run("--tables-anywhere", "natural-frequencies", "below/line.toml").exit_code == 0
    assert run("natural-frequencies", "below/line.toml").exit_code == 2
