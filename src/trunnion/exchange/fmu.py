"""A line as an FMU: its equations in C with what FMI 2.0 or 3.0 asks for, their description, and a binary."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import tempfile
import uuid
import zipfile
from importlib.resources import files
from pathlib import Path

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.equations.line_regimes import staged_springs
from trunnion.equations.line_system import LineSystem
from trunnion.errors import ComputationError
from trunnion.exchange.c_source import equations_in_c, row_of, system_in_c, table, template, whole_rows
from trunnion.exchange.fmu_description import FmuDescription, build_description, description_of, model_description
from trunnion.laws.stages import GUARDS

VERSIONS = (2, 3)
"""Of FMI that are written."""
SOURCE = "fmu.c"
HEADERS = {
    2: ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
"""Of the Modelica Association, by the 2-clause BSD licence that each states."""
STANDARDS = {2: "C90", 3: "C99"}
NO_COMPILER = "a binary (no C compiler was found here; the sources are in it)"
_SECONDS_TO_COMPILE = 300
_DAY = (1980, 1, 1, 0, 0, 0)
"""Of every file in it, so that a line gives the same bytes twice."""


def write_fmu(line: Driveline, path: Path, fmi: int) -> tuple[str, ...]:
    """Write the FMU; returns what it lacks, a binary where no compiler is found.

    Raises
    ------
    InputError : no operating speed; what C does not hold, each by its name.
    """
    made = system_in_c(line, "an FMU")
    described = description_of(made)
    source = _source(made, described, fmi)
    token = str(uuid.uuid5(uuid.NAMESPACE_URL, source + str(described)))
    source = f'#define MODEL_TOKEN "{token}"\n' + source
    texts = {
        "modelDescription.xml": model_description(described, fmi, token, (SOURCE,)),
        f"sources/{SOURCE}": source,
        "documentation/licenses/license.txt": _licence(fmi),
        **{f"sources/{name}": _header(name) for name in HEADERS[fmi]},
    }
    if fmi == 3:
        texts["sources/buildDescription.xml"] = build_description(described, SOURCE, STANDARDS[fmi])
    binary = _binary(texts, described.identifier, fmi)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            archive.writestr(zipfile.ZipInfo(name, _DAY), text, zipfile.ZIP_DEFLATED)
        if binary is not None:
            folder, ending = platform_folder(fmi)
            info = zipfile.ZipInfo(f"binaries/{folder}/{described.identifier}{ending}", _DAY)
            info.external_attr = 0o755 << 16
            archive.writestr(info, binary, zipfile.ZIP_DEFLATED)
    return () if binary is not None else (NO_COMPILER,)


def _source(made: LineSystem, described: FmuDescription, fmi: int) -> str:
    """Everything in one file, so that any build is one call of a compiler."""
    about = [
        f"   An FMU of FMI {fmi}.0 for model exchange and co-simulation. Springs with stages keep the one they are in;",
        "   event indicators tell where it ends.",
    ]
    return (
        equations_in_c(made, about) + _model_tables(made, described) + template("fmu_model.c") + template(f"fmi{fmi}.c")
    )


def _model_tables(made: LineSystem, described: FmuDescription) -> str:
    """What an instance needs beside the equations: its start, what it takes and gives, and the ways between stages."""
    row = made.assembly.table(1)[0]
    springs = staged_springs(made.assembly, row)
    contacts = [e for e, one in springs.items() if one.stages > 1]
    then = np.concatenate([np.zeros((0, GUARDS)), *(one.law.then for one in springs.values())])
    states = 2 * made.assembly.topology.size
    start, nominal = row_of(made.rest()), row_of(np.asarray(made.system.scale))
    parts = [
        "",
        f"enum {{ CONTACTS = {len(contacts)}, INPUTS = {len(described.inputs)}, OUTPUTS = {len(described.outputs)} }};",
        "enum { ROTATION, TURNING, TWIST, CARRIED }; /* kinds of outputs */",
        f"#define STEP {1e-3 / abs(made.speed):.17g} /* the first one tried [s] */",
        f"static const double START[{states}] = {start};",
        f"static const double NOMINAL[{states}] = {nominal};",
        table("static const int CONTACT", 1, [f"{{{e}}}" for e in contacts], [springs[e].name for e in contacts],
              "springs with more than one stage"),
        table("static const int THEN", GUARDS, whole_rows(then), (),
              "the stage of its spring behind each guard of a row of STAGE, -1 where there is none"),
        table("static const int INPUT_AT", 1, [f"{{{one.place}}}" for one in described.inputs],
              [one.name for one in described.inputs], "stations on which torques act"),
        table("static const int OUTPUT", 2, [f"{{{one.kind}, {one.place}}}" for one in described.outputs],
              [one.name for one in described.outputs], "kind, station or spring"),
        "",
    ]  # fmt: skip
    return "\n".join(parts)


def _header(name: str) -> str:
    return files("trunnion.exchange").joinpath("c_templates", "fmi", name).read_text(encoding="utf-8")


def _licence(fmi: int) -> str:
    """What a receiver must be told: the headers' own words."""
    text = _header(HEADERS[fmi][0])
    words = text[text.index("Copyright") :].partition("*/")[0]
    return f"The headers fmi{fmi}*.h among the sources:\n\n{words.rstrip()}\n"


def platform_folder(fmi: int) -> tuple[str, str]:
    """The folder of this machine's binaries, and what they end in."""
    system = {"Windows": "windows", "Darwin": "darwin"}.get(platform.system(), "linux")
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    ending = {"windows": ".dll", "darwin": ".dylib", "linux": ".so"}[system]
    if fmi == 3:
        return f"{machine}-{system}", ending
    short = {"windows": "win", "darwin": "darwin", "linux": "linux"}[system]
    return (f"{short}64" if machine == "x86_64" or system == "darwin" else f"{machine}-{system}"), ending


def _binary(texts: dict[str, str], identifier: str, fmi: int) -> bytes | None:
    """The shared library that the machine's compiler makes of the sources; None where there is no compiler.

    Raises
    ------
    ComputationError : the compiler does not take the sources.
    """
    compiler = next((found for name in (os.environ.get("CC"), "cc", "gcc", "clang") if (found := _which(name))), None)
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        for name, text in texts.items():
            if name.startswith("sources/"):
                (Path(folder) / Path(name).name).write_text(text, encoding="utf-8", newline="\n")
        library = f"{identifier}{platform_folder(fmi)[1]}"
        flags = ["-O2", "-shared", f"-std={STANDARDS[fmi].lower()}", "-fvisibility=hidden", "-ffp-contract=off"]
        flags += [] if platform.system() == "Windows" else ["-fPIC"]
        command = [compiler, *flags, "-o", library, SOURCE, "-lm"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=_SECONDS_TO_COMPILE, check=False
        )
        if done.returncode:
            said = next((one for one in done.stderr.splitlines() if "error" in one), "it says nothing")
            raise ComputationError(
                f"{Path(compiler).name} does not compile the sources of the FMU ({said.strip()}); "
                f"name another compiler in CC"
            )
        return (Path(folder) / library).read_bytes()


def _which(name: str | None) -> str | None:
    return shutil.which(name) if name else None
