"""Names are the field's words: each class has one of its own, and the glossary defines each noun once."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.driveline.elements import Element

ROOT = Path(tn.__file__).parent
GLOSSARY = Path(__file__).parents[2] / "docs" / "glossary.md"
FILES = sorted(ROOT.rglob("*.py"))
CLASS = re.compile(r"^ *class (\w+)[(:\[]", re.M)
ENTRY = re.compile(r"- \*\*(.+?)\*\*: (.+)", re.S)
PUBLIC = sorted(re.findall(r" as (\w+)$", (ROOT / "__init__.pyi").read_text(encoding="utf-8"), re.M))
NOUNS = """
    angled joint, backlash, base motion, basin of attraction, batch, bend angle, boundary trace, branch, Campbell
    diagram, certificate, chart, check, compliance, coordinate, cost model, Coulomb friction, critical speed,
    damping, data variable, decay transient, disk, drive share, element, excitation line, fallback, finding, Floquet
    mode, fold, fork offset, free–free line, frequency, friction capacity, growth rate, guard, harmonic, harmonic
    balance, independent variable, inertia, irregularity, joint plane, limit, line, load, load-case response, loss
    factor, Lyapunov exponent, map evaluation, margin, mean twist, mesh stiffness, mode, mode shape, monodromy
    matrix, multiplier, multiplier collision, multiplier interpolation, natural frequency, orbit, order, oscillator,
    outcome, patch, period, periodic steady state, phase, play, prescribed disk, regime, reserve, resonance,
    response curve, rotation, rule, run-up, section, shooting problem, side order, slip, Sommerfeld capture,
    spectral radius, speed, speed ramp, speed ratio, stability classification, stage, station, step halving,
    stiffness, strategy, tongue, torque, transmission error, trivial multiplier, twist, unconverged box, undecided,
    unexcited line, verdict, vibratory torque, window
"""
RETIRED = """
    Answer Asked Bounded Built Case ChainLanes Closing Course ExactClosing Followed FreeMotions Given Hanging
    Held Help IntegratedClosing Judged KnownMotion LADDER LANES Lost Mode MotionsBySpeed Neutral NoSharedMotion
    OwnBase OwnFamily OwnLine OwnMotion OwnMotions OwnOrders Passage PlainPoints QUIET Question Quiet Seen
    Settling Side Spots StabilityAlong Strand Subject TOLD Trial Tried Turning UNTOLD Wanted Way at_hand
    by_halving by_meetings carried_mode carried_modes chain_lanes closing_of few_nodes fields_over hindered
    kernel_price lanes lanes_of meeting_exponents meetings moves_by_itself own_axis own_growth own_limits
    own_line own_motion own_motions own_motions_of pixel_price plain_pixels plain_radii prices refuse_own_motion
    require_closing rows_by_meetings rubbing step_price strand strands stubborn told told_apart uneven untold
    way_named
"""
"""What only their author understood, with the field's word in place of it."""


@cache
def names_in(path: Path) -> frozenset[str]:
    """Identifiers of a file, those between the braces of formatted strings among them."""
    tokens = tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline)
    names = {token.string for token in tokens if token.type == tokenize.NAME}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FormattedValue):
            names |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
            names |= {one.attr for one in ast.walk(node) if isinstance(one, ast.Attribute)}
    return frozenset(names)


@cache
def entries() -> list[tuple[str, str]]:
    """Terms of the glossary and what they mean, in its order."""
    rows = re.split(r"\n(?=- )", GLOSSARY.read_text(encoding="utf-8").split("\n\n", 2)[2].strip())
    found = [ENTRY.fullmatch(row) for row in rows]
    assert all(found), [row for row, one in zip(rows, found, strict=True) if not one]
    return [one.groups() for one in found if one]  # type: ignore[misc]


def is_element(name: str) -> bool:
    """Elements have their pages and their sketches; words of the field stand in the glossary."""
    one = getattr(tn, name)
    return isinstance(one, type) and issubclass(one, Element)


def test_no_two_classes_share_a_name() -> None:
    homes: dict[str, list[Path]] = {}
    for path in FILES:
        for name in CLASS.findall(path.read_text(encoding="utf-8")):
            homes.setdefault(name, []).append(path)
    assert len(homes) > 300
    # What looks like a class may be words of a docstring: files that have a name twice, or one of others, are parsed.
    shared = {name for name, paths in homes.items() if len(paths) > 1}
    made = Counter(
        node.name
        for path in {path for name in shared for path in homes[name]}
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and node.name in shared
    )
    assert not {name: homes[name] for name, number in made.items() if number > 1}


def test_retired_names_stay_away() -> None:
    retired = set(RETIRED.split())
    word = re.compile(rf"\b(?:{'|'.join(retired)})\b")  # few files have one, in a comment mostly: only they are parsed
    told = [path for path in FILES if word.search(path.read_text(encoding="utf-8"))]
    found = {path.relative_to(ROOT).as_posix(): names_in(path) & retired for path in told}
    assert not {name: words for name, words in found.items() if words}
    assert not {path.stem for path in FILES} & retired


def test_the_look_at_identifiers_sees_what_it_looks_for(tmp_path: Path) -> None:
    file = tmp_path / "one.py"
    file.write_text('''"""told"""\nheld = f"{strand.low} lanes"  # quiet\n''', encoding="utf-8")
    assert names_in(file) == {"held", "strand", "low"}


def test_the_glossary_defines_each_term_once() -> None:
    terms = [term if term.startswith("`") else term.lower() for term, _ in entries()]
    assert not [term for term, count in Counter(terms).items() if count > 1]
    order = [(re.sub(r"[^a-z0-9]", "", term.lower()), term.startswith("`")) for term, _ in entries()]
    assert order == sorted(order), "terms stand in the order of their letters"
    assert all(meaning.rstrip().endswith(".") for _, meaning in entries())


@pytest.mark.parametrize("name", [one for one in PUBLIC if not is_element(one)])
def test_public_names_are_in_the_glossary(name: str) -> None:
    assert f"`{name}`" in {term for term, _ in entries()}, f"say in docs/glossary.md what {name} is"


def test_public_names_of_the_glossary_exist() -> None:
    assert {term.strip("`") for term, _ in entries() if term.startswith("`")} <= set(PUBLIC)


def test_the_nouns_of_the_field_are_in_the_glossary() -> None:
    terms = {term.strip("`").lower() for term, _ in entries()}
    assert not {noun.strip().lower() for noun in " ".join(NOUNS.split()).split(",")} - terms
