"""Nothing is silently left out: every cell of ``trunnion.features`` is seen to be true."""

from __future__ import annotations

import dataclasses
import inspect
import warnings
from functools import cache
from pathlib import Path

import feature_lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.driveline.elements import Element
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.features import FEATURES, NOT_FEATURES
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.features import NOT_ANALYSES, TABLE, Treatment, left_out, markdown

SPEED = 100.0
RANGE = (100.0, 101.0)


def least_damping(line: tn.Driveline, speeds: tuple[float, float], angle: float = 1.3, **more: float) -> object:
    """At an angle that asks for some damping."""
    return tn.minimum_damping(line.replace("joint 2", angle=angle), speeds, **{"maximum": 8.0, "rows": 4} | more)


def limited(line: tn.Driveline) -> tn.Driveline:
    """With a limit of torque for every spring that all lines have."""
    limits = tuple(tn.Limit(of=name, max_torque=500.0) for name in ("front", "rear"))
    return line.model_copy(update={"limits": limits})


def scheduled(line: tn.Driveline) -> tn.Driveline:
    """With a schedule of the angle of a joint that all lines have."""
    schedule = tn.Schedule(name="travel", travel=[0.0, 0.1], angles={"joint 2": [0.1, 0.4]})
    return line.model_copy(update={"operation": tn.Operation(schedules=[schedule])})


RUN = {
    "natural_frequencies": tn.natural_frequencies,
    "resonance_speeds": tn.resonance_speeds,
    "stability": lambda line: tn.stability(line, SPEED),
    "stability_chart": lambda line: tn.stability_chart(line, ("speed", 300, 330, 3), ("load.inertia", 0.15, 0.25, 3)),
    "stable_limit": lambda line: tn.stable_limit(
        line, "joint 2.angle", [145.0, 150.0, 460.0, 627.0], scan=20, high=1.4, between=False
    ),
    "tongues": lambda line: tn.tongues(line, ("speed", 140.0, 150.0), ("joint 2.angle", 0.9, 1.4), rows=3),
    "stable_windows": lambda line: tn.stable_windows(line, "joint 2.angle", 0.2, 1.4, (140.0, 150.0), rows=5),
    "minimum_damping": lambda line: least_damping(line, (140.0, 144.0)),
    "tolerance_study": lambda line: tn.tolerance_study(line, {"hub.inertia": 0.1}, SPEED, samples=256),
    "campbell_diagram": lambda line: tn.campbell_diagram(line, [20.0, 100.0, 180.0]),
    "assess": lambda line: tn.assess(limited(line), (SPEED, SPEED)),
    "envelope": lambda line: tn.envelope(scheduled(limited(line)), (SPEED, SPEED), points=2),
    "compare": lambda line: tn.compare(line, line.replace("load", inertia=0.21), (SPEED, SPEED)),
    "sensitivity": lambda line: tn.sensitivity(line, SPEED, ["load.inertia"], of=["frequencies", "growth", "torques"]),
    "optimise": lambda line: tn.optimise(
        line, {"load.inertia": (0.15, 0.25)}, "peak torque of rear", (SPEED, SPEED), checks=False, designs=20
    ),
    "certify_stability": lambda line: tn.certify_stability(line, {"hub.inertia": 1e-4}, (100.0, 100.001), most_boxes=1),
    "speed_sweep": lambda line: tn.speed_sweep(line, [90.0, 100.0]),
    "order_response": lambda line: tn.order_response(line, [90.0, 100.0]),
    "bending_speeds": tn.bending_speeds,
    "kinetostatics": lambda line: tn.kinetostatics(line, SPEED, rigid=False, inertia=True, points=16),
    "phase_forks": tn.phase_forks,
    "assembly_sensitivity": tn.assembly_sensitivity,
    "simulate": lambda line: tn.simulate(line, 0.05, speed=SPEED),
    "periodic_response": lambda line: tn.periodic_response(line, SPEED),
    "periodic_branch": lambda line: tn.periodic_branch(line, "speed", *RANGE, longest_step=0.5),
    "harmonic_balance": lambda line: tn.harmonic_balance(line, "speed", *RANGE, longest_step=0.5),
    "frequency_response": lambda line: tn.frequency_response(line, *RANGE, longest_step=0.5),
    "linearity_check": lambda line: tn.linearity_check(line, SPEED),
    "run_up": lambda line: tn.run_up(line, 100, 110, acceleration=200, steady=2),
    "safe_accelerations": lambda line: tn.safe_accelerations(
        line, 100, 110, limit=1000.0, accelerations=(100, 200), points=2
    ),
    "lyapunov_spectrum": lambda line: tn.lyapunov_spectrum(line, 20, speed=SPEED, starts=1, transient=5),
    "lyapunov_sweep": lambda line: tn.lyapunov_sweep(line, "load.inertia", [0.2], periods=20, transient=5, speed=SPEED),
    "lyapunov_map": lambda line: tn.lyapunov_map(
        line, ("load.inertia", 0.2, 0.21, 2), ("rear.stiffness", 1e4, 1.1e4, 2), periods=10, transient=2, speed=SPEED
    ),
    "poincare_map": lambda line: tn.poincare_map(line, 10, speed=SPEED, transient=5),
    "bifurcation_diagram": lambda line: tn.bifurcation_diagram(
        line, "load.inertia", [0.2], points=8, transient=5, speed=SPEED
    ),
    "certify_chaos": lambda line: tn.certify_chaos(
        line, 20, speed=SPEED, starts=1, points=10, transient=5, sweep=False
    ),
    "exact_motion": lambda line: tn.exact_motion(line, 0.05, speed=SPEED),
    "piecewise_orbit": lambda line: tn.piecewise_orbit(line, speed=SPEED),
    "piecewise_branch": lambda line: tn.piecewise_branch(line, *RANGE, longest_step=0.5),
    "sweep": lambda line: tn.sweep(line, [99.0, 100.0]),
}
TUBES = (620.0, 640.0)
RUN_CELL = {
    **{
        ("stable_windows", key): lambda line: tn.stable_windows(line, "joint 2.angle", 0.2, 1.5, TUBES, rows=5)
        for key in ("tube inertia", "bending stiffness")
    },
    **{
        ("tongues", key): lambda line: tn.tongues(line, ("speed", *TUBES), ("joint 2.angle", 0.9, 1.5), rows=3)
        for key in ("tube inertia", "bending stiffness")
    },
    **{
        ("minimum_damping", key): lambda line: least_damping(line, TUBES, 1.05, maximum=40.0)
        for key in ("tube inertia", "bending stiffness")
    },
    # A stiff mesh moves where its own mode is excited.
    ("sweep", "mesh damping"): lambda line: tn.sweep(line, [2700.0, 2800.0]),
    ("minimum_damping", "loss factor"): lambda line: least_damping(line, (140.0, 150.0), 0.6, maximum=4.0),
}
"""Where the settings of ``RUN`` would not show a feature."""
BASE = {
    **dict.fromkeys(("exact_motion", "piecewise_orbit", "piecewise_branch", "sweep"), feature_lines.straight),
    "bending_speeds": feature_lines.with_tube,
    "certify_stability": feature_lines.unloaded,
}
QUICK = {
    "phase_forks": ("Hooke's joint", "fork offset", "load torque", "branch"),
    "stability_chart": ("damping", "load torque", "excitation by order", "viscous load"),
    "stable_limit": ("load torque", "free start", "tripod joint"),
    **dict.fromkeys(("tongues", "stable_windows", "minimum_damping"), ("load torque", "free start")),
    "certify_stability": ("load torque", "stiffness", "ratio", "prescribed far end"),
    "assess": tuple(key for key in feature_lines.CHANGES if key != "mesh-stiffness variation"),
    "compare": ("load torque", "angle of an ideal joint", "dry friction", "prescribed far end"),
    "sensitivity": ("load torque", "angle of an ideal joint", "dry friction"),
    "optimise": ("load torque", "excitation by order", "dry friction"),
    "envelope": ("load torque", "Hooke's joint", "prescribed far end", "dry friction"),
    "periodic_response": ("load torque", "prescribed far end"),
    "periodic_branch": ("viscous load", "free start"),
    "harmonic_balance": ("excitation by order", "free start"),
    "frequency_response": ("load torque", "free start"),
    "linearity_check": ("load torque", "dry friction", "prescribed far end"),
    "run_up": ("load torque",),
    "safe_accelerations": ("load torque",),
    "lyapunov_spectrum": ("load torque", "prescribed far end"),
    "lyapunov_sweep": ("damping", "prescribed far end"),
    "lyapunov_map": ("damping", "prescribed far end"),
    "poincare_map": ("excitation by order", "prescribed far end"),
    "bifurcation_diagram": ("quadratic load", "prescribed far end"),
    "certify_chaos": ("load torque", "prescribed far end"),
    "piecewise_orbit": ("transmission error", "angle of an ideal joint", "quadratic load"),
    "piecewise_branch": ("transmission error", "angle of an ideal joint", "quadratic load"),
    "sweep": ("transmission error", "angle of an ideal joint", "quadratic load"),
}
"""Features seen in the quick run, where an analysis takes long; the others are seen in the slow one."""


COSTLY = {
    (name, "mesh-stiffness variation") for name in ("stability", "order_response", "speed_sweep", "tolerance_study")
}


def cells():
    for analysis, row in TABLE.items():
        for key in row:
            slow = key not in QUICK.get(analysis, (key,)) or (analysis, key) in COSTLY
            yield pytest.param(analysis, key, marks=[pytest.mark.slow] if slow else [], id=f"{analysis}-{key}")


@dataclasses.dataclass
class Answer:
    refusal: str
    text: str
    numbers: dict[str, np.ndarray]


@cache
def answer(analysis: str, written: str, key: str = "") -> Answer:
    run = RUN_CELL.get((analysis, key), RUN[analysis])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        line = tn.loads(written)
        try:
            result = run(line)
        except tn.InputError as error:
            return Answer(str(error), "", {})
    said = [str(result), *map(str, getattr(result, "findings", ())), *(str(w.message) for w in caught)]
    return Answer("", "\n".join(said), numbers(result))


SETTINGS = ("error", "defect", "residual", "seconds", "steps", "evaluations", "offsets", "line")


def numbers(result: object, depth: int = 0) -> dict[str, np.ndarray]:
    """The numbers of a result by name: of its dataset, or of its fields."""
    data = getattr(result, "data", None)
    if hasattr(data, "data_vars"):
        named = {k: np.asarray(v.values) for k, v in {**data.data_vars, **data.coords}.items()}
        return {k: v for k, v in named.items() if v.dtype.kind in "fcib" and not any(s in k for s in SETTINGS)}
    if isinstance(result, int | float | complex | np.ndarray):
        return {"": np.asarray(result)}
    parts: dict[str, object] = {}
    if isinstance(result, tuple | list):
        parts = {str(i): part for i, part in enumerate(result)}
    elif dataclasses.is_dataclass(result) and depth < 3:
        parts = {f.name: getattr(result, f.name) for f in dataclasses.fields(result)}
    return {
        f"{k}.{name}": value
        for k, part in parts.items()
        if not any(s in k for s in SETTINGS)
        for name, value in numbers(part, depth + 1).items()
        if value.dtype.kind in "fcib"
    }


def differ(one: dict[str, np.ndarray], other: dict[str, np.ndarray], tolerance: float) -> list[str]:
    """Names of the numbers that differ by more than ``tolerance`` of their size."""
    if one.keys() != other.keys():
        return sorted(one.keys() ^ other.keys())
    found = []
    for name, a in one.items():
        b = other[name]
        if a.shape != b.shape:
            found.append(name)
            continue
        finite = np.isfinite(a) & np.isfinite(b)
        size = max(np.abs(a[finite]).max(initial=0.0), np.abs(b[finite]).max(initial=0.0))
        near = np.isclose(a, b, rtol=0, atol=tolerance * size, equal_nan=True)
        if not near.all():
            found.append(name)
    return found


@pytest.mark.parametrize(("analysis", "key"), list(cells()))
def test_cell(analysis: str, key: str) -> None:
    cell = TABLE[analysis][key]
    line = BASE.get(analysis, feature_lines.bent)()
    without, with_it = (tn.dumps(change(line)) for change in feature_lines.CHANGES[key])
    own = key if (analysis, key) in RUN_CELL else ""
    after = answer(analysis, with_it, own)
    if cell.treatment is Treatment.REFUSED:
        assert "; " in after.refusal and "\n" not in after.refusal, f"not refused with a remedy: {after.refusal!r}"
        return
    assert not after.refusal, after.refusal
    before = answer(analysis, without, own)
    assert before.numbers, "nothing to compare"
    if cell.treatment is Treatment.COUNTED:
        assert differ(before.numbers, after.numbers, 1e-7), "nothing changes: count it, or write why it cannot matter"
        return
    if cell.treatment is Treatment.NOT_JUDGED:
        words = cell.quote or "not judged: max torque of front: no linear response"
        assert words in after.text, "it is judged: count it"
        return
    changed = differ(before.numbers, after.numbers, 1e-6)
    assert not changed, f"changes {changed}: it is counted"
    if cell.treatment is Treatment.SAID:
        said = [str(f) for f in left_out(analysis, tn.loads(with_it))]
        words = [cell.quote] if cell.quote else [s for s in said if cell.reason in s]
        assert words and words[0] in after.text, f"not said: {words}"


ROOMS = ("equations", "modes", "steady", "floquet", "response", "motion", "design", "reporting", "plots")
"""Where what takes a driveline to answer something stands."""


def test_every_analysis_has_a_row() -> None:
    """Every public function that takes a driveline is in the table, or has a reason not to be."""
    public = {name: getattr(tn, name) for name in tn.__all__ if name != "__version__"}
    taking = {
        name
        for name, one in public.items()
        if inspect.isfunction(one)
        and one.__module__.startswith(tuple(f"trunnion.{room}." for room in ROOMS))
        and any("Driveline" in str(p.annotation) for p in inspect.signature(one).parameters.values())
    }
    assert taking == set(TABLE) | set(NOT_ANALYSES)
    assert set(TABLE) == set(RUN)


def test_every_field_belongs_to_a_feature() -> None:
    models = [*KINDS.values(), Element, Excitation, tn.TransmissionError, tn.StiffnessVariation, tn.Ripple, tn.Slider]
    models += [tn.Driveline, tn.Limit, Operation, LoadCase, tn.Schedule, tn.SwitchedOff]
    common = set(Element.model_fields)
    fields = {
        f"{model.__name__}.{key}"
        for model in models
        for key in model.model_fields
        if model is Element or not (issubclass(model, Element) and key in common)
    }
    known = [field for one in FEATURES for field in one.fields]
    assert len(known) == len(set(known))
    assert fields == set(known) | set(NOT_FEATURES)
    assert {one.key for one in FEATURES} == set(feature_lines.CHANGES)


@pytest.mark.parametrize("one", FEATURES, ids=lambda one: one.key)
def test_places(one) -> None:
    """A feature is found where it is, and named."""
    with_it = feature_lines.CHANGES[one.key][1](feature_lines.bent())
    places = one.places(with_it)
    assert places
    assert all(place.rpartition(".")[0] in (*with_it.names, "driveline", "") for place in places)


def test_the_page_prints_the_table() -> None:
    """``python -m trunnion.features`` prints what belongs below the page's first lines."""
    page = (Path(__file__).parents[2] / "docs" / "features.md").read_text(encoding="utf-8")
    assert page.endswith(f"\n{markdown()}\n")
