"""What every analysis does with every feature of a line: counts, refuses, does not judge, or says it is left out.

One row for all analyses that treat features alike, which ``trunnion.registry`` names; what a row does not name is
*counted*. ``tests/contract/test_features.py`` builds a line for each cell, changes the feature and sees the answer
change, the refusal, the sentence, or that nothing changes; an analysis without a row fails there, and so does a field
of the description without a feature. ``docs/features.md`` prints the table. ``left_out`` makes the sentences that
results show.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.features import CONVERTER, CURVE, FEATURES, LOSSES, OVER_TORQUE, UNEVEN, feature
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.remarks import DRAGGED, HELD, LAG, OIL, SERIES
from trunnion.equations.linear_clutches import stand_ins
from trunnion.registry import ANALYSES
from trunnion.results.finding import Finding, Gravity
from trunnion.results.words import Words

_NUMBER = re.compile(r" \d+(-\d+)?$")
"""Of a throw, or of the crank between two."""


class Treatment(Enum):
    """What an analysis does with a feature."""

    COUNTED = "counted"
    REFUSED = "refused"
    SAID = "said"
    NOT_JUDGED = "not judged"
    INERT = "cannot matter"


@dataclass(frozen=True)
class Cell:
    """A treatment and its reason; ``quote`` is what the result prints where ``left_out`` does not say the reason."""

    treatment: Treatment
    reason: str = ""
    quote: str = ""


Row = dict[str, Cell]
Reason = str | tuple[str, str]
"""A reason, or a reason and the quote."""


def left_out(analysis: str, line: Driveline) -> tuple[Finding, ...]:
    """One finding for every feature of ``line`` that ``analysis`` leaves out, naming the places; the line's own remarks
    where they concern it."""
    said = {key for key, cell in TABLE[analysis].items() if cell.treatment is Treatment.SAID}
    own = tuple(Finding(Gravity.CAUTION, sentence) for key, sentence in line.own_remarks if key in said)
    if TABLE[analysis][OIL].treatment is Treatment.COUNTED:
        own += tuple(Finding(Gravity.NOTE, sentence) for key, sentence in line.own_remarks if key == OIL)
    if TABLE[analysis]["dry friction"].treatment in (Treatment.REFUSED, Treatment.NOT_JUDGED):
        own += tuple(Finding(Gravity.CAUTION, sentence) for sentence in stand_ins(line))
    if TABLE[analysis][DRAGGED].reason == SET_ASIDE:
        own += tuple(Finding(Gravity.NOTE, DRAGGED_ALONG.format(slip)) for slip in feature(DRAGGED).places(line))
    if TABLE[analysis][LOSSES].treatment is Treatment.COUNTED and analysis not in _MEAN_ONLY:
        lossy = (name for name, element in line.parts if element.losses)
        own += tuple(Finding(Gravity.NOTE, BY_MEAN.format(name)) for name in lossy)
    places: dict[str, dict[str, None]] = {}
    for key, cell in TABLE[analysis].items():
        if cell.treatment is Treatment.SAID and not cell.quote:
            places.setdefault(cell.reason, {}).update(dict.fromkeys(feature(key).places(line)))
    return own + tuple(
        Finding(
            Gravity.CAUTION,
            f"{', '.join(_together(where, line))} {'is' if len(where) == 1 else 'are'} left out: {reason}",
        )
        for reason, where in places.items()
        if where
    )


def _together(places: Iterable[str], line: Driveline) -> tuple[str, ...]:
    """The same, those of several parts of one engine as the pattern of their names: "engine.throw *.excitation"."""
    owned = {name for name, one in line.parts if one.part_of}
    alike: dict[str, list[str]] = {}
    for place in places:
        name, _, key = place.rpartition(".")
        alike.setdefault(f"{_NUMBER.sub(' *', name)}.{key}" if name in owned else place, []).append(place)
    return tuple(pattern if len(every) > 1 else every[0] for pattern, every in alike.items())


def as_it_operates(line: Driveline) -> tuple[Finding, ...]:
    """What is said where no speed is asked of: pendulums are held, and couplings loaded, as at the operating speed."""
    if line.operation is None or line.operation.speed is None:
        return ()
    at = Words(speed_unit(line)).rounded(line.operation.speed)
    loaded = any(isinstance(one, Rotor) and one.loaded_by_speed for one in line.elements)
    says = {PENDULUM: "is held", OVER_TORQUE: "is loaded"} if loaded else {PENDULUM: "is held"}
    there = f"as at {at}, where the line operates; campbell_diagram has every speed"
    return tuple(
        Finding(Gravity.CAUTION, f"{name.removesuffix('.stiffnesses')} {what} {there}")
        for key, what in says.items()
        for name in feature(key).places(line)
    )


_LIKE = {
    "rolling resistance": "load torque",
    "brake": "load torque",
    LOSSES: "load torque",
    "air drag": "quadratic load",
    "slip of a tyre": DRAGGED,
    OIL: "viscous damper",
    "elastic teeth of planets": "closed loop",
}
"""Features that every analysis treats as another, whose equations they share, but where a row names them."""
BY_MEAN = "{} loses by its mean torque, in the sense in which power flows; of what vibrates nothing is lost there"
"""What is said of gear losses by what counts them."""
SET_ASIDE = "the multiplier at 1 is set aside"
DRAGGED_ALONG = (
    "{} has no spring that holds it: its mode of frequency 0 (multiplier 1) is not an instability and does not count"
)
"""What is said of a damper without a spring by what judges disturbances."""
QUASI_STATIC: dict[str, Reason] = {
    LAG: (
        "forced responses of straight lines and transients have it; elsewhere the torque follows the speed at once, "
        "which holds well below the corner frequency",
        "quasi-static",
    )
}


def _row(
    *,
    refused: Mapping[str, Reason] | None = None,
    said: Mapping[str, Reason] | None = None,
    not_judged: Mapping[str, Reason] | None = None,
    inert: Mapping[str, Reason] | None = None,
    set_aside: tuple[str, ...] = (),
) -> Row:
    """Cells of all features: those named, the others counted; of those ``set_aside`` the multiplier at 1 is."""
    row = {f.key: Cell(Treatment.COUNTED, SET_ASIDE if f.key in set_aside else "") for f in FEATURES}
    treated = {
        Treatment.REFUSED: refused,
        Treatment.SAID: said,
        Treatment.NOT_JUDGED: not_judged,
        Treatment.INERT: inert,
    }
    for treatment, reasons in treated.items():
        for key, words in (reasons or {}).items():
            row[key] = Cell(treatment, *((words,) if isinstance(words, str) else words))
    named = {key for reasons in treated.values() for key in reasons or {}}
    row |= {key: row[other] for key, other in _LIKE.items() if key not in named}
    return {f.key: row[f.key] for f in FEATURES}


_MEAN_ONLY = ("kinetostatics",)
"""Analyses whose torques do not vibrate."""
_TORSION = {"bending stiffness": "torsion does not bend the tubes"}
_PLANE = "its plane, from which the next joint measures its own, counts as a joint plane"
_EVEN = {
    "angle of an ideal joint": f"at any angle it passes rotation unchanged; {_PLANE}",
    "double Cardan joint": f"centred, it passes rotation unchanged; {_PLANE}",
}
_STICKS = {"slip clutch": "it sticks, a rigid link; a line whose load lies beyond its capacity is refused"}
_NOT_SLIPPED = {"slip clutch": "it changes between sticking and slipping, which is not followed"}
PENDULUM = "centrifugal pendulum"
HEATED = "temperature of a coupling"
_NO_SPEED = {
    PENDULUM: "the square of the speed holds it; it is held as at the operating speed where that is stated",
    CONVERTER: "its ratio of speeds follows from the speed; it runs as at the operating speed where that is stated",
}
_OTHER_SPEEDS = {
    PENDULUM: "the square of the speed holds it, and equations here are of one speed",
    CONVERTER: "its ratio of speeds follows from the speed and the loads, and equations here are of one",
}
_NO_PATH = {PENDULUM: "it swings along a path, which is not followed"}
_NO_RATIO = {CONVERTER: "its turbine turns by a ratio that follows from the loads, so that no period is the line's"}
_PASSIVE = {**_TORSION, **_EVEN}
_FORCES = "a forcing, which moves no frequency and no multiplier of a linear line"
_FORCING = dict.fromkeys(
    (
        "excitation by order", "excitation that varies with speed or load", "cylinders", "excitation in time",
        "excitation by order and frequency", "excitation of a prescribed disk", "transmission error",
    ),
    _FORCES,
)  # fmt: skip
_HELD: dict[str, Reason] = {
    HELD: (
        "a ConstantSpeed holds its rotation",
        "does nothing, a ConstantSpeed holds its rotation",
    )
}
_SERIES: dict[str, Reason] = {
    SERIES: (
        "springs in series, with no inertia between and damping over stiffness different, count as one, "
        "to first order in damping",
        "they count as one shaft",
    )
}
_IN_ROWS = {**_HELD, **_SERIES}
_BY_PLACE = {**_IN_ROWS, **QUASI_STATIC}
_AT_ONE_SPEED = dict.fromkeys((CURVE, LAG), "its tangent holds at one speed, and the speed changes") | {
    OVER_TORQUE: "it holds for small motions about one mean torque, and the torque changes",
    LOSSES: "they are those of the mean torque, and the torque changes",
}
ONE_MOTION = "dry friction at one motion"
_DRY_FRICTION = {"dry friction": "linear equations have none; a clutch that states a motion counts by its mean there"}
_SLOWEST = {"dry friction": "the slowest mode, over whose periods it speeds up, is that of the linear line"}
_NOT_FOLLOWED = dict.fromkeys(
    ("dry friction", ONE_MOTION), "sliders change between sticking and slipping, which is not followed"
)
TIED = "shafts tied to two others"
_TREES = dict.fromkeys(
    (TIED, "closed loop"), "follows lines that branch, and none whose shaft is tied to two others or closes a loop"
)
_FAR_END = {**_DRY_FRICTION, "prescribed far end": "two prescribed speeds leave a line with joint angles nowhere to go"}
_UNANSWERED = {
    **_DRY_FRICTION,
    "prescribed far end": "two prescribed speeds leave a line with joint angles no linear response to judge",
}
_BASE = {
    **_DRY_FRICTION,
    "free start": "bent, it is judged about its own periodic motion",
    "drive share": "belongs to free–free lines",
    "prescribed far end": "two prescribed speeds leave a line with joint angles nowhere to go",
}
_EXCITED = {key: _FORCES for key in _FORCING if key != "transmission error"}
_UNPROVABLE = {
    **_BASE,
    **_TREES,
    **_NO_RATIO,
    DRAGGED: "what it drags may stand anywhere, so that one disturbance never dies out",
    **dict.fromkeys((CURVE, LAG), "a curve over the speed is not enclosed"),
    PENDULUM: "the square of the speed holds it, and the proof is of springs that do not follow the speed",
    OVER_TORQUE: "a table over the mean torque is not enclosed",
    LOSSES: "a torque by the sense in which power flows is not enclosed",
}
_ALIGNED = "frequencies are those of the aligned line, all joints straight"
_MODES_SAID: dict[str, Reason] = {
    **_SERIES,
    **dict.fromkeys(UNEVEN, (_ALIGNED, "joint angles zero")),
    "mesh-stiffness variation": "frequencies are those of the mean stiffness",
    **dict.fromkeys(
        ("quadratic load", CURVE),
        "damping ratios are those without it, for it goes with the speed; campbell_diagram has it",
    ),
}
_MODES_INERT = {
    **_TORSION,
    **_EVEN,
    **_STICKS,
    **_FORCING,
    "fork offset": _ALIGNED,
    "joint plane": _ALIGNED,
    "load torque": "moves no linear spring; a spring with stages takes the stage that the load holds it in",
    "drive share": "a constant torque",
    LAG: "belongs to a torque that goes with the speed, which is left out",
    "backlash": "the load presses the mesh together; without a load it is refused",
}
_DAMPINGS = (
    "damping", "loss factor", "damping ratio", "mesh damping", "impact damping", "damping in contact only", SERIES,
)  # fmt: skip
_UNDAMPED = "the names stand at the frequencies of the undamped line"
_ONE_DRIVE = {
    **_TREES,
    "prescribed far end": "the nonlinear equations have one prescribed speed",
}
_ANYWHERE = {DRAGGED: "what it drags may stand anywhere, so that no periodic motion is the only one"}
_DRIVEN = {
    **_ONE_DRIVE,
    **_NO_RATIO,
    **_NO_PATH,
    **_NOT_SLIPPED,
    **_NOT_FOLLOWED,
    **_ANYWHERE,
    "free start": "the speed follows from the torques",
    "drive share": "belongs to free–free lines",
}
_PASSING = {
    **_ONE_DRIVE,
    **_NO_RATIO,
    **_AT_ONE_SPEED,
}
_NOT_EXACT = {
    **_ONE_DRIVE,
    **_NO_RATIO,
    **_NO_PATH,
    **dict.fromkeys((CURVE, LAG), "its tangent goes with the speed that branches and sweeps follow"),
    **dict.fromkeys((OVER_TORQUE, LOSSES), "it goes with the loads at the speed that branches and sweeps follow"),
    **_NOT_SLIPPED,
    **_ANYWHERE,
    "excitation that varies with speed or load": "its amplitude changes with the speed that branches and sweeps follow",
    **dict.fromkeys(
        (*UNEVEN, "joint plane", "mesh-stiffness variation", "impact damping", "quadratic load"),
        "the stages are then not linear with constant coefficients",
    ),
}
_NO_ORDER = dict.fromkeys(
    ("excitation in time", "excitation by order and frequency"),
    "it excites at frequencies of its own, and what was measured is compared order by order of the rotation",
)
_UNBENT = {**_PASSIVE, "fork offset": "without an angled joint forks have no phase"}
_RIGID = dict.fromkeys(
    (
        "inertia", "stiffness", OVER_TORQUE, LOSSES, HEATED, "tube inertia", "bending stiffness", "damping",
        "loss factor", "damping ratio",
        "viscous damper", DRAGGED, "tuned damper", PENDULUM, "dual-mass flywheel", "tyre", "vehicle",
        "angle of an ideal joint",
        "mesh damping", "impact damping", "backlash", "transmission error",
        "mesh-stiffness variation", "stages", "dry friction", ONE_MOTION, "slip clutch", "locked torque converter",
        "damping in contact only", "load torque", "viscous load", "quadratic load", CURVE, LAG, "excitation by order",
        "excitation that varies with speed or load", "cylinders", "engine", "excitation in time",
        "excitation by order and frequency", "excitation of a prescribed disk",
        "unlike damping in series", "free start", "drive share",
    ),
    "rotations of rigid shafts follow from joints, forks and ratios alone",
) | {"branch": "not on the way to the output asked for"}  # fmt: skip
_TUBES = ("tube inertia", "bending stiffness", "ratio", "belt", "planetary set", TIED, "gear mesh")
_TUBE = "a tube whirls between its own joints, by its own dimensions"
_RIGID_MESH = ("a turn takes the mesh as a rigid pair in contact", "taken as a rigid pair in contact")
_STEADY = "torques are those of steady running; ask periodic_response() or simulate() for what it does"
_UNDAMPED_TURN = ("the turn is quasi-static", "damping left out")

ROWS: dict[str, Row] = {
    "modes": _row(refused={**_DRY_FRICTION, **_NO_SPEED}, said=_MODES_SAID, inert=_MODES_INERT, set_aside=(DRAGGED,)),
    "resonances": _row(
        refused={**_DRY_FRICTION, **_NO_SPEED},
        said={
            **dict.fromkeys(
                ("viscous load", "quadratic load", CURVE), "resonance speeds are those of the line without it"
            ),
        },
        inert={
            **_MODES_INERT,
            **dict.fromkeys(
                ("Hooke's joint", "double Cardan joint off centre"),
                "the speeds are those at which an angled joint of any angle can resonate",
            ),
            **dict.fromkeys(_DAMPINGS, _UNDAMPED),
        },
    ),
    "linear motion": _row(refused=_FAR_END, said=_BY_PLACE, inert={**_PASSIVE, **_STICKS}, set_aside=(DRAGGED,)),
    "measured orders": _row(
        refused=_FAR_END, said={**_BY_PLACE, **_NO_ORDER}, inert={**_PASSIVE, **_STICKS}, set_aside=(DRAGGED,)
    ),
    "fitted orders": _row(
        refused={**_FAR_END, CONVERTER: "its ratio of speeds follows from numbers that are fitted"},
        said={**_BY_PLACE, **_NO_ORDER},
        inert={**_PASSIVE, **_STICKS},
        set_aside=(DRAGGED,),
    ),
    "settled temperatures": _row(
        refused={
            **_FAR_END,
            CONVERTER: "its ratio of speeds follows from the loads, and many lines are solved together",
            "free start": "bent, it moves about its own periodic motion, which is found line by line",
            "drive share": "belongs to free–free lines, of which the bent ones are refused",
        },
        said=_BY_PLACE,
        inert={**_PASSIVE, **_STICKS},
        set_aside=(DRAGGED,),
    ),
    "multipliers": _row(
        refused={key: why for key, why in (_BASE | _OTHER_SPEEDS).items() if key not in ("free start", "drive share")},
        said={**_SERIES, **QUASI_STATIC},
        inert={**_TORSION, **_EVEN, **_STICKS, **_FORCING},
        set_aside=(DRAGGED,),
    ),
    "loaded modes": _row(
        set_aside=(DRAGGED,),
        refused=_DRY_FRICTION,
        said=_BY_PLACE,
        inert={
            **_TORSION,
            **_EVEN,
            **_STICKS,
            **{key: _MODES_INERT[key] for key in ("fork offset", "joint plane", "drive share", "backlash")},
            "load torque": _MODES_INERT["load torque"],
        },
    ),
    "judgement": _row(said=_BY_PLACE, not_judged=_UNANSWERED, inert=_EVEN, set_aside=(DRAGGED,)),
    "comparison": _row(
        set_aside=(DRAGGED,),
        said=_BY_PLACE,
        not_judged={
            key: (reason, "not compared: frequency, growth rate, torque") for key, reason in _DRY_FRICTION.items()
        },
        inert=_EVEN,
    ),
    "derivatives": _row(refused={**_DRY_FRICTION, **_OTHER_SPEEDS}, said=_BY_PLACE, inert={**_PASSIVE, **_STICKS}),
    "proof": _row(
        refused={
            **_UNPROVABLE,
            "free start": "bent, it is proved about its own periodic motion where a torque depends on its speed",
        },
        said=_SERIES,
        inert={**_TORSION, **_EVEN, **_STICKS, **_FORCING},
    ),
    "proof of peaks": _row(
        refused={
            **_UNPROVABLE,
            OIL: "it goes with the frequency along a curve, which is not enclosed",
        },
        said=_IN_ROWS,
        inert={**_TORSION, **_EVEN, **_STICKS},
    ),
    "whirl": _row(
        refused={CONVERTER: _NO_SPEED[CONVERTER]},
        inert={f.key: _TUBE for f in FEATURES if f.key not in (*_TUBES, CONVERTER)},
    ),
    "turn": _row(
        refused={
            **_TREES,
            CONVERTER: "its ratio of speeds follows from the loads at a speed, and a turn is that of rigid shafts",
            PENDULUM: "it swings with the orders of the rotation, and a turn is quasi-static",
            "prescribed far end": "the output follows from the input",
        },
        said={
            **QUASI_STATIC,
            "damping": _UNDAMPED_TURN,
            "loss factor": _UNDAMPED_TURN,
            "damping ratio": _UNDAMPED_TURN,
            "damping in contact only": _UNDAMPED_TURN,
            "mesh damping": _RIGID_MESH,
            "impact damping": _RIGID_MESH,
            "backlash": _RIGID_MESH,
            "transmission error": _RIGID_MESH,
            "mesh-stiffness variation": _RIGID_MESH,
            "excitation by order": _STEADY,
            "excitation that varies with speed or load": _STEADY,
            "cylinders": _STEADY,
            "excitation in time": _STEADY,
            "excitation by order and frequency": _STEADY,
            "excitation of a prescribed disk": _STEADY,
            "unlike damping in series": _UNDAMPED_TURN,
            "drive share": "the first element drives alone",
            **dict.fromkeys(
                ("dry friction", ONE_MOTION),
                "a turn has the springs of a clutch alone; its sliders hold it within a band of twist",
            ),
        },
        inert={**_TORSION, **_STICKS, "free start": "the first element is driven at the speed asked for"},
    ),
    "forks": _row(
        refused={**_TREES, **_NO_RATIO, "prescribed far end": "the output follows from the input"}, inert=_RIGID
    ),
    "motion": _row(refused=_ONE_DRIVE, said=_BY_PLACE, inert=_PASSIVE),
    "periodic motion": _row(
        refused={**_ONE_DRIVE, **_NO_RATIO, **_ANYWHERE},
        said=_BY_PLACE,
        inert={**_PASSIVE, "slip clutch": "it sticks, a rigid link; a motion in which it would slip is refused"},
    ),
    "passage": _row(refused={**_PASSING, **_SLOWEST, **_NO_PATH}, said=_IN_ROWS, inert=_PASSIVE),
    "transients": _row(
        refused={
            **_ONE_DRIVE,
            **{key: _AT_ONE_SPEED[key] for key in (OVER_TORQUE, LOSSES)},
            **_NO_PATH,
        },
        said=_IN_ROWS,
        inert=_PASSIVE,
    ),
    "long motion": _row(refused=_DRIVEN, said=_BY_PLACE, inert=_PASSIVE),
    "branch": _row(
        refused={**_ONE_DRIVE, **_NO_RATIO, **_NOT_FOLLOWED, **_NOT_SLIPPED, **_NO_PATH, **_ANYWHERE},
        said=_BY_PLACE,
        inert=_PASSIVE,
    ),
    "stages": _row(refused=_NOT_EXACT, said=_IN_ROWS, inert=_UNBENT),
    "branch by stages": _row(refused={**_NOT_EXACT, **_NOT_FOLLOWED}, said=_IN_ROWS, inert=_UNBENT),
}
"""How analyses treat features, by the word that ``trunnion.registry`` has for it; several may share a row."""
TABLE: dict[str, Row] = {one.name: ROWS[one.features] for one in ANALYSES if one.features}
"""The row of each analysis."""

NOT_ANALYSES = {
    "damper_optimum": "closed forms for one mode of natural_frequencies, which says what is left out",
    "capture_map": "passing over two parameters, which counts, refuses and says the same",
    "passing": "transient of a free–free line until it has a speed, which counts, refuses and says the same",
    "capture_map_cost": "asks passing at a few cells of a map, and multiplies",
    "least_acceleration": "passing over accelerations, which counts, refuses and says the same",
    "least_drive": "passing over factors of the torque, which counts, refuses and says the same",
    "misfire": "order_response of the line with each cylinder out of work",
    "remedies": "judges changed lines as assess does",
    "track_orders": "takes the speed ratios of a line, and nothing of what moves it",
    "identifiability": "identify without a fit, which counts, refuses and says the same",
    "study": "asks an analysis of the registry at many points, which counts, refuses and says the same",
    "study_cost": "asks an analysis of the registry at a few points, and multiplies",
    "report": "shows the analyses above, with what each of them says",
    "submission": "shows the analyses above as a document to sign",
    "sketch": "draws the description",
    "sweep_speeds": "a grid of speeds for speed_sweep",
    "exact_oscillator": "one spring with stages between two inertias as one equation; refuses every other line",
}
"""Public functions that take a line and need no row, and why."""

MARKS = {
    Treatment.COUNTED: "●",
    Treatment.REFUSED: "✕",
    Treatment.SAID: "said",
    Treatment.NOT_JUDGED: "not judged",
    Treatment.INERT: "–",
}


def groups() -> list[tuple[str, ...]]:
    """Analyses that treat every feature alike, for the same reasons, in the order of the table."""
    alike: dict[tuple[tuple[Treatment, str], ...], list[str]] = {}
    for name, row in TABLE.items():
        alike.setdefault(tuple((cell.treatment, cell.reason) for cell in row.values()), []).append(name)
    return [tuple(names) for names in alike.values()]


def markdown() -> str:
    """The table and its reasons, as ``docs/features.md`` prints them."""
    found, says = groups(), {one.name: one.sentence for one in ANALYSES}
    numbered = [
        f"{f'{i}.' if name == names[0] else '':3} - `{name}`: {says[name]}"
        for i, names in enumerate(found, start=1)
        for name in names
    ]
    head = "| feature | " + " | ".join(str(i + 1) for i in range(len(found))) + " |"
    rows = [
        f"| {f.key} | " + " | ".join(MARKS[TABLE[names[0]][f.key].treatment] for names in found) + " |"
        for f in FEATURES
    ]
    reasons = []
    for names in found:
        reasons += ["", f"**{', '.join(f'`{name}`' for name in names)}**", ""]
        by_reason: dict[tuple[str, str], list[str]] = {}
        for key, cell in TABLE[names[0]].items():
            if cell.treatment is not Treatment.COUNTED:
                by_reason.setdefault((cell.treatment.value, cell.reason), []).append(key)
        reasons += [
            f"- {what}: {', '.join(keys)}. {why[0].upper()}{why[1:]}." for (what, why), keys in by_reason.items()
        ]
    return "\n".join([*numbered, "", head, "|---|" + ":-:|" * len(found), *rows, *reasons])


if __name__ == "__main__":
    print(markdown())
