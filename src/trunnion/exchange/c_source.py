"""A line as ANSI C: its nonlinear equations of motion x' = f(t, x), joints, loads, meshes and stages as they are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib.resources import files

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.features import feature
from trunnion.equations.line_regimes import line_kernel
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.errors import InputError
from trunnion.exchange.held import schedules_refused

NOT_IN_C = {
    "slip clutch": "leave it out, for the line while it sticks",
    "torque converter": "write locked = true, for the line with its clutch shut",
    "centrifugal pendulum": "describe it by a TunedDamper at the speed that matters",
    "dry friction": "leave its sliders out",
    "dry friction at one motion": "leave its sliders out",
    "lag of a motor": "leave corner_frequency and pole_pairs out: its torque follows the speed at once",
}
"""Features that the function of states and time alone does not hold, and what to do."""
PER_LINE = 3
"""Numbers of a row in a line of the file; each stands with all its digits."""


def refuse_c(line: Driveline, what: str = "C") -> None:
    """Refuse at once everything that the C function does not hold; ``what`` names what is written of it.

    Raises
    ------
    InputError : names each.
    """
    wrong = schedules_refused(line)
    for key, remedy in NOT_IN_C.items():
        for place in feature(key).places(line):
            element, _, field = place.rpartition(".")
            wrong.append(InputError(f"is not written as {what} ({key})", element=element, key=field, remedy=remedy))
    if wrong:
        raise InputError.together(wrong)


def c_source_of(line: Driveline) -> str:
    """The text of a file of ANSI C: numbers of the line in tables, and the function ``line_rate`` that reads them.

    Raises
    ------
    InputError : no operating speed; what ``refuse_c`` and ``line_system`` refuse.
    """
    made = system_in_c(line)
    system = made.system
    states = [
        f"   x[{i}]  {comment(s)} [{u}]" for i, (s, u) in enumerate(zip(system.states, system.units, strict=True))
    ]
    about = [
        "   int line_rate(double t, const double *x, double *dx)",
        "",
        "   x' = f(t, x); t in s. States are deviations from uniform rotation:",
        *states,
    ]
    return equations_in_c(made, about) + template("line_rate.c")


def system_in_c(line: Driveline, what: str = "C") -> LineSystem:
    """The line at its operating speed, where C holds it.

    Raises
    ------
    InputError : no operating speed; what ``refuse_c`` and ``line_system`` refuse.
    """
    refuse_c(line, what)
    speed = line.operation.speed if line.operation else None
    if not speed:
        raise InputError(
            "is missing", element="operation", key="speed", remedy='write speed = "1500 rpm": the equations are of it'
        )
    return line_system(line, float(speed), leaves=True)


def template(name: str) -> str:
    """A file of C that does not depend on the line."""
    return files("trunnion.exchange").joinpath("c_templates", name).read_text(encoding="utf-8")


def equations_in_c(made: LineSystem, about: Sequence[str]) -> str:
    """A comment with the lines ``about``, the numbers of the line in tables, and the equations that read them."""
    name = made.assembly.line.name or "driveline"
    lines = [
        f"/* {comment(name)}: equations of motion at the input speed of {made.speed:.10g} rad/s, written by Trunnion.",
        "",
        *about,
        "*/",
        "#include <math.h>",
        "",
    ]
    return "\n".join(lines) + _tables(made) + template("line_equations.c")


def _tables(made: LineSystem) -> str:
    core, p = line_kernel(), made.system.numbers
    n, stations, joined, harmonics = (
        int(p[i]) for i in (core.UNKNOWNS, core.STATIONS, core.COMPLIANCES, core.HARMONICS)
    )
    first, shaken, _, _ = core.places(p)
    station = p[core.HEAD : first].reshape(stations, core.PER_STATION)
    spring = p[first:shaken].reshape(joined, core.PER_COMPLIANCE)
    torque = p[shaken : shaken + harmonics * core.PER_HARMONIC].reshape(harmonics, core.PER_HARMONIC)
    assert not np.any(station[:, [core.BY_SPEED, core.BY_SQUARE, core.STANDS]]) and not np.any(torque[:, core.PIECES])
    ripples, rows = _ripples(p, station)
    stages, waves, laws = _laws(p, spring)
    whole = [core.BEFORE, core.LINK, core.COORDINATE, core.REFERENCE]
    real = [
        core.MEAN, core.PHASE, core.SIZE, core.COSINE, core.SQUARE, core.OVER, core.INERTIA, core.LOAD, core.VISCOUS,
        core.QUADRATIC, core.SHARE,
    ]  # fmt: skip
    ends = [core.NEAR, core.FAR, core.NEAR_COORDINATE, core.FAR_COORDINATE]
    topo, turning = made.assembly.topology, p[[core.THETA, core.OMEGA, core.ALPHA]]
    places = [f"{name or 'flange'}" for name in _station_names(made)]
    parts = [
        f"enum {{ UNKNOWNS = {n}, STATIONS = {stations}, SPRINGS = {joined}, TORQUES = {harmonics} }};",
        f"enum {{ SPRINGS_OR_ONE = {max(joined, 1)} }}; /* C has no array of none */",
        f"static const double INPUT[3] = {row_of(turning)}; /* angle, speed, its rate */",
        table("static const int STATION_PLACES", 4, whole_rows(station[:, whole]), places,
               "before, link, coordinate, first of its group"),
        table("static const double STATION", len(real), map(row_of, rows[:, real]), places,
               "mean ratio, phase, t, cos, 4t/(1+t)^2, 1/ratio, inertia, load, viscous, quadratic, share"),
        table("static const int SPRING_ENDS", 4, whole_rows(spring[:, ends]), made.shafts,
               "near, far, their coordinates"),
        table("static const double SPRING", 2, map(row_of, spring[:, [core.STIFFNESS, core.DAMPING]]), made.shafts,
               "stiffness [N m/rad], damping [N m s/rad]"),
        table("static const int SPRING_LAW", 5, whole_rows(laws), made.shafts,
               "first stage, stages, first harmonic of the mesh, of its error, of its stiffness"),
        table("static const double STAGE", core.PER_STAGE, map(row_of, stages), (), "see springs with stages below"),
        table("static const double WAVE", 3, map(row_of, waves), (), "amplitude, cycles per turn of the input, phase"),
        table("static const double RIPPLE", 3, map(row_of, ripples), (), "order, amplitude, phase of a joint"),
        table("static const double TORQUE", 5, map(row_of, torque[:, : core.ANGLE_COSINE]), (),
               "station, amplitude [N m], order, frequency [rad/s], phase"),
        "",
    ]  # fmt: skip
    assert len(topo.stations) == stations
    return "\n".join(parts)


def _station_names(made: LineSystem) -> list[str]:
    """What turns at each station, where it has a name."""
    found = [""] * len(made.assembly.topology.stations)
    for station, name in made.assembly.topology.points:
        found[station] = found[station] or name
    return found


def _ripples(p: Array, station: Array) -> tuple[Array, Array]:
    """Harmonics of all joints that are Fourier series, and the stations with their first row in place of that of p."""
    core, own, rows, count = line_kernel(), station.copy(), [], 0
    for s in np.flatnonzero(station[:, core.LINK] == core.FOURIER):
        at, many = int(station[s, core.SIZE]), int(station[s, core.COSINE])
        rows.append(p[at : at + core.PER_RIPPLE * many].reshape(many, core.PER_RIPPLE))
        own[s, core.SIZE] = count
        count += many
    return np.concatenate([np.zeros((0, core.PER_RIPPLE)), *rows]), own


def _laws(p: Array, spring: Array) -> tuple[Array, Array, Array]:
    """Stages of all springs, harmonics of their meshes, and where each spring's begin and how many (spring, 5)."""
    core, stages, waves = line_kernel(), [], []
    laws, first, wave = np.zeros((len(spring), 5)), 0, 0
    for e, row in enumerate(spring):
        if row[core.LAW] == 0.0:
            continue
        at, many, errors, swells = (int(row[k]) for k in (core.LAW, core.STAGES, core.ERRORS, core.WAVES))
        end = at + many * core.PER_STAGE
        stages.append(p[at:end].reshape(many, core.PER_STAGE))
        waves.append(p[end : end + core.PER_WAVE * (errors + swells)].reshape(-1, core.PER_WAVE))
        laws[e] = first, many, wave, errors, swells
        first, wave = first + many, wave + errors + swells
    return (
        np.concatenate([np.zeros((0, core.PER_STAGE)), *stages]),
        np.concatenate([np.zeros((0, core.PER_WAVE)), *waves]),
        laws,
    )


def table(head: str, columns: int, rows: Iterable[str], names: Sequence[str], what: str) -> str:
    """A table of C; one row of zeros where there is none, which C asks for and nothing reads."""
    every = list(rows) or ["{" + ", ".join(["0"] * columns) + "}"]
    labels = [f" /* {comment(name)} */" for name in names] + [""] * (len(every) - len(names))
    body = ",\n".join(f"  {row}{label}" for row, label in zip(every, labels, strict=True))
    return f"/* {what} */\n{head}[{len(every)}][{columns}] = {{\n{body}\n}};"


def row_of(values: Array) -> str:
    words = [f"{float(value):.17g}" for value in values]
    words = [word.replace("inf", "HUGE_VAL") for word in words]
    lines = [", ".join(words[i : i + PER_LINE]) for i in range(0, len(words), PER_LINE)]
    return "{" + ",\n   ".join(lines) + "}"


def whole_rows(values: Array) -> list[str]:
    return ["{" + ", ".join(str(int(one)) for one in row) + "}" for row in values]


def comment(text: str) -> str:
    """A name as it may stand in a comment of ANSI C."""
    plain = "".join(c if c.isascii() and c.isprintable() else "?" for c in text)
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").rstrip("\\")
