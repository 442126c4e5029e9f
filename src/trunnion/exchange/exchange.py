"""Lines as files of other programs, and back."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.refusals import nearest
from trunnion.driveline.toml_file import LARGEST_FILE
from trunnion.errors import InputError
from trunnion.exchange.c_source import c_source_of
from trunnion.exchange.fmu import VERSIONS, write_fmu
from trunnion.exchange.held import not_written, refuse_unheld
from trunnion.exchange.matlab import write_state_space
from trunnion.exchange.modelica import model_of
from trunnion.exchange.modelica_reader import read_model
from trunnion.exchange.network import Network, network_of
from trunnion.exchange.opentorsion import read_script, script_of
from trunnion.exchange.rebuild import line_of
from trunnion.exchange.tables import read_table, table_of
from trunnion.reading import regular_bytes
from trunnion.writing import written_whole

ENDINGS: Mapping[str, str] = {
    "csv": ".csv",
    "matlab": ".mat",
    "opentorsion": ".py",
    "modelica": ".mo",
    "c": ".c",
    "fmu": ".fmu",
}
"""Targets, and what their files end in."""
_TEXTS: Mapping[str, Callable[[Network], str]] = {"csv": table_of, "opentorsion": script_of, "modelica": model_of}
_READERS: Mapping[str, Callable[[str, str], Network]] = {".csv": read_table, ".py": read_script, ".mo": read_model}


def export_line(line: Driveline, path: str | os.PathLike[str], to: str, *, fmi: int | None = None) -> tuple[str, ...]:
    """Write a line to a file of another program; it appears whole or stays as it was.

    Parameters
    ----------
    line : any driveline of inertias, springs with one stiffness, rigid gears, and constant and viscous loads, its
        joints straight; for "c" and "fmu" any whose nonlinear equations have no friction that sticks.
    path : of the file, ending in .csv, .mat, .py, .mo, .c or .fmu; one that is there is replaced.
    to : the kind of file. "csv": a table with a row for each part, in SI units. "matlab": a state space A, B, C, D
        with the names of its states, inputs and outputs. "opentorsion": a script that builds the assembly.
        "modelica": a model of Modelica.Mechanics.Rotational. "c": the equations of motion x' = f(t, x) at the
        operating speed in ANSI C, with joints, excitations, meshes and stages. "fmu": an FMU for model exchange and
        co-simulation, these equations in C with contacts as event indicators, and a binary by the machine's C compiler
        (cc, gcc, clang or that of CC).
    fmi : version of FMI of an FMU, 2 (by default) or 3.

    Returns what the description says besides and the file does not: ratings, limits, duty, scenarios and the like; and
    a binary, where an FMU is written and no compiler is found.

    Raises
    ------
    InputError : names every element that such a file cannot hold (a bent joint, backlash, an excitation …) and the
        remedy; a target or an ending that is unknown; a file that cannot be written.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness="10 kN*m/rad"), tn.Disk(inertia=0.8)])
    >>> with TemporaryDirectory() as folder:
    ...     _ = tn.export_line(line, f"{folder}/line.mo", "modelica")
    ...     print(tn.import_line(f"{folder}/line.mo").names)
    ('ConstantSpeed 1', 'Shaft 1', 'Disk 1')
    """
    if to not in ENDINGS:
        raise InputError("is not a target", key="to", value=to, remedy=nearest(str(to), list(ENDINGS)))
    if Path(path).suffix.lower() != ENDINGS[to]:
        raise InputError(
            f"does not end in {ENDINGS[to]}", key="output", value=str(path), remedy=f"a file for {to} does"
        )
    if fmi is not None and to != "fmu":
        raise InputError("belongs to an FMU", key="fmi", value=fmi, remedy=f"leave it out of an export to {to}")
    if to == "fmu":
        if fmi not in (None, *VERSIONS):
            raise InputError("is not a version of FMI that is written", key="fmi", value=fmi, remedy="write 2 or 3")
        with written_whole(path) as temporary:
            lacks = write_fmu(line, temporary, fmi or VERSIONS[0])
        return (*not_written(line), *lacks)
    if to == "c":
        _write(c_source_of(line), path)
        return not_written(line)
    refuse_unheld(line)
    network = network_of(line)
    if to in _TEXTS:
        _write(_TEXTS[to](network), path)
    else:
        with written_whole(path) as temporary:
            write_state_space(network, temporary)
    return not_written(line)


def _write(text: str, path: str | os.PathLike[str]) -> None:
    with written_whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def import_line(path: str | os.PathLike[str]) -> Driveline:
    """Read a line from a file that ``export_line`` wrote, or another program in the same form.

    Parameters
    ----------
    path : of a table (.csv), of a script for openTorsion (.py), which is read and not run, or of a model of
        Modelica.Mechanics.Rotational (.mo). A state space (.mat) does not say what it is made of.

    Natural frequencies are those of the exported line to rounding. A tube comes back as a stiffness between two disks,
    a gear mesh as a gear and a shaft.

    Raises
    ------
    InputError : names the file, the place in it and what cannot be read.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> line = tn.Driveline([tn.Disk(inertia=0.3), tn.Shaft(stiffness="10 kN*m/rad"), tn.Disk(inertia=0.8)])
    >>> with TemporaryDirectory() as folder:
    ...     _ = tn.export_line(line, f"{folder}/line.csv", "csv")
    ...     print(tn.import_line(f"{folder}/line.csv").elements[1].stiffness)
    10000.0
    """
    place = Path(path)
    if place.suffix.lower() not in _READERS:
        remedy = "name a file that ends in .csv, .py or .mo"
        if place.suffix.lower() == ".c":
            remedy = "a function in C does not say what it is made of; export the line to csv"
        if place.suffix.lower() == ".fmu":
            remedy = "an FMU does not say what it is made of; export the line to csv"
        if place.suffix.lower() == ".mat":
            remedy = "a state space does not say what it is made of; export the line to csv"
        raise InputError("cannot be imported", key=str(path), remedy=remedy)
    return line_of(_READERS[place.suffix.lower()](_text(place), place.name))


def _text(place: Path) -> str:
    try:
        return regular_bytes(place, LARGEST_FILE, what="a file that describes a line").decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError("file not found", key=str(place), remedy="check the path") from None
    except InputError:
        raise
    except (OSError, ValueError):
        raise InputError("cannot be read as text in UTF-8", key=str(place), remedy="check the file") from None
