"""Drivelines as TOML files: read, write, and say in one line what is wrong and where.

::

    format = 1
    name = "..."

    [operation]
    speed = "1500 rpm"

    [[element]]
    type = "Shaft"
    stiffness = "12 kN*m/rad"

Reading, writing and reading again gives an equal driveline: units are written where they read back exactly.
"""

from __future__ import annotations

import os
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from trunnion.driveline.chain import refuse_too_many
from trunnion.driveline.component_files import find, with_sheet
from trunnion.driveline.curve_points import read_curve
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.duty import Duty, SpeedPassage
from trunnion.driveline.elements import Disk, Element, plain
from trunnion.driveline.excitation_file import read_excitation
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import LIMIT_KINDS, Limit
from trunnion.driveline.oil import read_oil
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.driveline.pressure import read_pressure
from trunnion.driveline.quantities import RATIO, SPEED, QuantityKind, written
from trunnion.driveline.record import Record, is_name
from trunnion.driveline.refusals import about, nearest
from trunnion.driveline.rules import SwitchedOff
from trunnion.driveline.scenarios import Scenario
from trunnion.driveline.schedules import FACTORS, FOLLOWING, OVER, Schedule
from trunnion.driveline.sn_curves import SNCurve
from trunnion.driveline.title_block import TitleBlock
from trunnion.driveline.tolerances import Tolerance
from trunnion.driveline.toml_file import read_text, toml_of
from trunnion.driveline.torque_converters import read_converter
from trunnion.driveline.torque_file import with_torque_files
from trunnion.errors import InputError, InputRemark, ShownValue, all_made, problems_of, short
from trunnion.reading import below
from trunnion.writing import written_whole

Made = TypeVar("Made", bound=Record)


@dataclass(frozen=True)
class Surroundings:
    """The folder of a description, and whether what it names may lie elsewhere."""

    folder: Path
    anywhere: bool

    def place_of(self, named: str) -> Path:
        """Where a table lies that it names; InputError where that may not be read."""
        return self.folder / named if self.anywhere else below(self.folder, named, ELSEWHERE)


ELSEWHERE = "put the table beside it, or allow it: tn.load(path, tables_anywhere=True), trunnion --tables-anywhere …"
FORMAT = 1
_DAMPING = ("damping_ratio", "damping_ratio_frequency")
TOP_KEYS = (
    "format",
    "name",
    "description",
    "damping_ratio",
    "damping_ratio_frequency",
    "document",
    "operation",
    "limit",
    "sn_curve",
    "tolerance",
    "scenario",
    "element",
)


def load(path: str | os.PathLike[str], *, tables_anywhere: bool = False) -> Driveline:
    """Read a driveline from a TOML file.

    Parameters
    ----------
    path : of the file.
    tables_anywhere : read tables of excitations wherever the file says they are; otherwise only below its own folder,
        so that the file of a stranger opens nothing else.

    Raises
    ------
    InputError : the file cannot be read, is not TOML or describes no driveline; names file and place.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "line.toml")
    ...     _ = path.write_text(tn.dumps(tn.catalogue("two-shaft-cardan")))
    ...     print(tn.load(path).names[3])
    HookeJoint 1
    """
    return _loads(read_text(Path(path)), Path(path).name, Surroundings(Path(path).parent, tables_anywhere))


def loads(text: str, *, source: str = "") -> Driveline:
    """Read a driveline from TOML text; `source` is what messages call it.

    Parameters
    ----------
    text : TOML.
    source : what messages call it; nothing by default.

    Examples
    --------
    >>> import trunnion as tn
    >>> text = tn.dumps(tn.catalogue("two-shaft-cardan"))
    >>> tn.loads(text, source="a driveline").names[3]
    'HookeJoint 1'
    """
    return _loads(text, source, None)


def _loads(text: str, source: str, around: Surroundings | None) -> Driveline:
    try:
        return _driveline(toml_of(text), source, around)
    except InputError as error:
        raise _located(error, source) from None


def dumps(line: Driveline) -> str:
    """`line` as TOML text that reads back as an equal driveline.

    Parameters
    ----------
    line : any driveline; quantities are written as they were given, or in SI units.

    Examples
    --------
    >>> import trunnion as tn
    >>> print(tn.dumps(tn.Driveline([tn.ConstantSpeed(), tn.Disk(inertia="0.8 kg*m^2")])))
    format = 1
    <BLANKLINE>
    [[element]]
    type = "ConstantSpeed"
    <BLANKLINE>
    [[element]]
    type = "Disk"
    inertia = 0.8
    """
    top: dict[str, Any] = {"format": FORMAT}
    for key in ("name", "description", *_DAMPING):
        if (value := getattr(line, key)) is not None:
            top[key] = _written(value, line.quantity_of(key))
    blocks = [_block("", top)]
    if line.document is not None:
        blocks.append(_block("[document]", _table(line.document)))
    if line.operation is not None:
        blocks += _operation_blocks(line.operation)
    blocks += [_block("[[limit]]", _table(limit)) for limit in line.limits]
    blocks += [_block("[[sn_curve]]", _table(curve)) for curve in line.sn_curves]
    for tolerance in line.tolerances:
        blocks += _tolerance_blocks(tolerance)
    for scenario in line.scenarios:
        blocks += _scenario_blocks(scenario, line.operation.speed_unit if line.operation else None)
    for element in line.as_stated.elements:
        blocks += _element_blocks(element)
    return "\n".join(blocks)


def element_text(element: Element) -> str:
    """One element as a file states it, ``[[element]]`` and what belongs to it."""
    return "\n".join(_element_blocks(element))


def dump(line: Driveline, path: str | os.PathLike[str], *, comments_of: str | os.PathLike[str] | None = None) -> None:
    """Write `line` to a TOML file; the file appears whole or stays as it was.

    Parameters
    ----------
    line : any driveline; quantities are written with their units.
    path : of the file; one that is there is replaced.
    comments_of : a driveline file that ``line`` came from; its comments, order and layout stay where nothing changed,
        and what cannot be kept is said in a warning. By default there are none.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness="10 kN*m/rad"), tn.Disk(inertia=0.8)])
    >>> with TemporaryDirectory() as folder:
    ...     tn.dump(line, f"{folder}/line.toml")
    ...     print(tn.load(f"{folder}/line.toml") == line)
    True
    """
    if Path(path).is_dir():
        raise InputError("is a folder", key=str(path), remedy="name a file in it")
    text = dumps(line) if comments_of is None else _dumps_like(line, Path(comments_of), Path(path).parent)
    try:
        with written_whole(path) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
    except InputError as error:
        remedy = "check that the folder exists and that you may write there"
        raise InputError(error.problem, key=str(path), remedy=remedy) from None


def dumps_alone(line: Driveline, file: Path) -> str:
    """``line`` in the text of the file that it came from, as text that needs nothing beside it: tables and components
    that the file names are written out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputRemark)
        try:
            if loads(text := read_text(file)) == line:
                return text
        except InputError:
            pass  # what it names is not found from elsewhere
    return _dumps_like(line, file, None)


def _dumps_like(line: Driveline, file: Path, folder: Path | None) -> str:
    """``line`` in the text of a file that it came from, to be read in ``folder``, or anywhere."""
    from trunnion.driveline.rewriting import rewritten
    from trunnion.driveline.texts_kept import quantities_kept, texts_kept

    before, plain = read_text(file), dumps(line)
    expand = partial(with_sheet, folder=file.parent)
    old = tomllib.loads(before)
    old["element"] = [expand(table) for table in old.get("element", [])]
    data = quantities_kept(texts_kept(tomllib.loads(plain), old, line), old, texts=True)
    around = None if folder is None else Surroundings(folder, False)
    # Elsewhere the file of a component or table may not be found.
    beside = folder is not None and file.parent.resolve() == folder.resolve()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputRemark)
        for table, one, element in zip(data["element"], old["element"], line.as_stated.elements, strict=False):
            _state_as(table, one, element, around if beside else None)
    found = rewritten(before, data, expand=expand if beside else None)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputRemark)
        same = _loads(found.text, file.name, around) == line
    lost = found.lost if same else f"comments of {file.name} could not be kept, its numbers are written another way"
    if lost:
        warnings.warn(InputRemark(f"{file.name}: {lost}"), stacklevel=3)
    return found.text if same else f"# {lost}\n{plain}"


def _state_as(table: dict[str, Any], before: dict[str, Any], element: Element, around: Surroundings | None) -> None:
    """Write the fields of an element as they were ``before`` wherever that makes the same element."""
    for key in dict.fromkeys([*before, *table]):
        if table.get(key) == before.get(key):
            continue
        tried = {one: value for one, value in table.items() if one != key}
        if key in before:
            tried[key] = before[key]
        try:
            if _element(tried, 1, Counter(), "", around) == element:
                table.clear()
                table.update(tried)
        except InputError:
            continue


def _driveline(table: dict[str, Any], source: str, around: Surroundings | None) -> Driveline:
    """The driveline of a file's content, its tables and components found ``around`` it, or everything that is
    wrong with it."""
    wrong = [
        InputError("unknown key", key=key, value=value, remedy=nearest(key, [k for k in TOP_KEYS if k not in table]))
        for key, value in table.items()
        if key not in TOP_KEYS
    ]
    if "format" in table or not wrong:  # "formt = 1" is a slip of the pen, not a missing format
        wrong += problems_of([lambda: _check_format(table)])
    rest: dict[str, Any] = {k: v for k, v in table.items() if k in ("name", "description", *_DAMPING)}
    found: dict[str, Any] = {}

    def read(key: str, value: Any, reader: Callable[[Any], Any]) -> None:
        try:
            found[key] = reader(value)
        except InputError as error:
            wrong.extend(error.problems)

    if "element" in table or not wrong:
        read("elements", table.get("element"), lambda value: _elements(value, source, around))
    if "document" in table:
        read("document", table["document"], _document)
    if "operation" in table:
        read("operation", table["operation"], _operation)
    if "limit" in table:
        read("limits", table["limit"], lambda value: _each(value, "limit", Limit))
    if "sn_curve" in table:
        read("sn_curves", table["sn_curve"], lambda value: _each(value, "sn_curve", SNCurve))
    if "tolerance" in table:
        read("tolerances", table["tolerance"], lambda value: _each(value, "tolerance", Tolerance))
    if "scenario" in table:
        read("scenarios", table["scenario"], lambda value: _scenarios(value, around))
    if wrong:
        wrong += problems_of([lambda: Driveline([Disk(inertia=1.0)], **rest)])  # its own keys
        raise InputError.together(wrong)
    return Driveline(**found, **rest)


def _scenarios(tables: Any, around: Surroundings | None) -> list[Scenario]:
    if around is not None and isinstance(tables, list):
        tables = [with_torque_files(table, around.place_of) if isinstance(table, dict) else table for table in tables]
    return _each(tables, "scenario", Scenario)


def _check_format(table: dict[str, Any]) -> None:
    number = table.get("format")
    if "format" not in table:
        raise InputError("is missing", key="format", remedy=f"write format = {FORMAT} in the first line")
    if isinstance(number, int) and not isinstance(number, bool) and number > FORMAT:
        remedy = f"this version reads format = {FORMAT}; install a newer Trunnion"
        raise InputError("is a later format", key="format", value=number, remedy=remedy)
    if type(number) is not int or number != FORMAT:
        raise InputError("is not a known format", key="format", value=number, remedy=f"write format = {FORMAT}")


def _elements(tables: Any, source: str, around: Surroundings | None) -> list[Element]:
    if isinstance(tables, dict):
        raise InputError("is a single table", key="element", remedy="write [[element]] with double brackets")
    if not isinstance(tables, list) or not tables:
        remedy = 'write one [[element]] table per element, each with type = "Shaft", "Disk", "HookeJoint", ...'
        raise InputError("has no elements", key="element", value=tables, remedy=remedy)
    refuse_too_many(len(tables))
    seen: Counter[str] = Counter()
    return all_made(partial(_element, table, i, seen, source, around) for i, table in enumerate(tables, start=1))


def _element(table: Any, place: int, seen: Counter[str], source: str, around: Surroundings | None) -> Element:
    if not isinstance(table, dict):
        raise InputError("is not a table", element=f"element {place}", value=table, remedy="write [[element]]")
    data = dict(table)
    name = data.get("name")
    own = name if is_name(name) else None
    if "component" in data:
        try:
            data = _of_component(data, around)
        except InputError as error:
            raise _about_component(error, f"{own} (element {place})" if own else f"element {place}") from None
    kind = data.pop("type", None)
    if kind is None:
        near = [key for key in data if key.lower() in ("typ", "kind", "types", "element")]
        remedy = f"write type instead of {near[0]}" if near else 'write type = "Shaft", say'
        label = f"{own} (element {place})" if own else f"element {place}"
        raise InputError("is missing", element=label, key="type", remedy=remedy)
    if not isinstance(kind, str) or kind not in KINDS:
        label = f"{own} (element {place})" if own else f"element {place}"
        remedy = nearest(str(kind), KINDS)
        raise InputError("unknown element type", element=label, key="type", value=kind, remedy=remedy)
    seen[kind] += 1
    label = f"{own or f'{kind} {seen[kind]}'} (element {place})"
    stated = dict(data)
    try:
        with warnings.catch_warnings():
            # said again below, with the place in the file
            warnings.simplefilter("ignore", InputRemark)
            for key in TABLES:
                if around is not None and isinstance(named := data.get(key), str):
                    data[key] = _table_of(key, named, around)
            element = KINDS[kind](**data)
    except InputError as error:
        raise about(error, label).each(lambda one: _limit_elsewhere(_as_stated(one, data, stated), own)) from None
    for key, problem, remedy in (*element.doubts(), *element.file_doubts()):
        remark = InputError(problem, element=label, key=key, value=plain(stated.get(key)), remedy=remedy)
        warnings.warn(InputRemark(str(_located(remark, source))), stacklevel=2)
    return element


def _of_component(data: dict[str, Any], around: Surroundings | None) -> dict[str, Any]:
    """What an element states that names a component: what was typed of its sheet, and what stands beside it."""
    found = find(data["component"], around.folder if around is not None else None)
    stated = {key: value for key, value in data.items() if key != "component"}
    if stated.get("type", found.kind) != found.kind:
        remedy = f'write type = "{found.kind}", or leave it out'
        raise InputError(f"is a {found.kind}", key="component", value=data["component"], remedy=remedy)
    if "sheet" in stated:
        remedy = "leave one of the two out: component reads the sheet anew, and sheet says what was read"
        raise InputError("conflicts with sheet", key="component", value=data["component"], remedy=remedy)
    return {"type": found.kind, **found.fields, **stated}


def _about_component(error: InputError, label: str) -> InputError:
    """The same about the element that names a component; of a file of components the place, never its content."""

    def one(found: InputError) -> InputError:
        if not found.element:
            return found.but(element=label)
        where = ".".join(part for part in (found.element, found.key) if part)
        return found.but(element=label, key="component", value=None, problem=f"{short(where, 100)} {found.problem}")

    return error.each(one)


TABLES: dict[str, Callable[[Path], tuple[Record, ...]]] = {
    "excitation": read_excitation,
    "gas_torque": read_excitation,
    "pressure": read_pressure,
    "compression": read_pressure,
    "curve": read_curve,
    "curves": read_converter,
    "oil": read_oil,
}
"""What reads the table that a key of an element may name."""


def _table_of(key: str, named: str, around: Surroundings) -> tuple[Record, ...]:
    """What the table holds that an element names; complaints say the place in the table, about that element."""
    try:
        return TABLES[key](around.place_of(named))
    except InputError as error:
        where = ".".join(part for part in (error.element, error.key) if part)
        problem = f"{short(where)} {error.problem}"
        raise error.but(element="", key=key, value=None, problem=problem) from None


def _as_stated(error: InputError, read: dict[str, Any], stated: dict[str, Any]) -> InputError:
    """With the name of a table instead of what was read of it."""
    table = error.key in TABLES and isinstance(stated.get(error.key), str) and error.value is read[error.key]
    return error.but(value=stated[error.key]) if table else error


def _limit_elsewhere(error: InputError, name: str | None) -> InputError:
    """Of a limit written into an element, where it belongs."""
    if error.key not in LIMIT_KINDS:
        return error
    of = f'of = "{name}" and ' if name else "of and "
    return error.but(remedy=f"limits stand in tables of their own: write [[limit]] with {of}{error.key}")


def _document(table: Any) -> TitleBlock:
    if not isinstance(table, dict):
        raise InputError("is not a table", key="document", value=table, remedy="write [document] on its own line")
    return TitleBlock(**table)


def _operation(table: Any) -> Operation:
    if not isinstance(table, dict):
        raise InputError("is not a table", key="operation", value=table, remedy="write [operation] on its own line")
    data = dict(table)
    wrong: list[InputError] = []
    made: dict[str, Any] = {}
    kinds: dict[str, tuple[type[Record], str]] = {
        "load_case": (LoadCase, "load_cases"),
        "schedule": (Schedule, "schedules"),
        "switched_off": (SwitchedOff, "switched_off"),
        "duty": (Duty, "duty"),
        "passage": (SpeedPassage, "passages"),
    }
    for key, (kind, many) in kinds.items():
        if many != key and many in data:  # the name in Python; a file repeats [[operation.load_case]]
            raise InputError("unknown key", element="operation", key=many, remedy=f'did you mean "{key}"?')
        try:
            made[many] = _each(data.pop(key, []), key, kind, "operation")
        except InputError as error:
            wrong += error.problems
    wrong += problems_of([lambda: Operation(**data, **({} if wrong else made))])
    if wrong:
        raise InputError.together(wrong)
    return Operation(**data, **made)


def _each(tables: Any, key: str, kind: type[Made], owner: str = "") -> list[Made]:
    """Every ``[[key]]`` of a file, or of a table of it that is its ``owner``."""
    header = f"[[{owner}.{key}]]" if owner else f"[[{key}]]"
    if not isinstance(tables, list):
        problem, value = ("is a single table", None) if isinstance(tables, dict) else ("is no table", tables)
        remedy = f"write {header} with double brackets"
        raise InputError(problem, element=owner, key=key, value=value, remedy=remedy)

    def one(place: int, table: Any) -> Made:
        label = f"{kind.what} {place}"
        if not isinstance(table, dict):
            raise InputError("is not a table", element=label, value=table, remedy=f"write {header}")
        try:
            return kind(**table)
        except InputError as error:
            raise (error if kind.called(table) != kind.what else about(error, label)) from None

    return all_made(partial(one, place, table) for place, table in enumerate(tables, start=1))


def _located(error: InputError, source: str) -> InputError:
    """The same complaints with the file's name in front."""
    return error.each(lambda one: _located_one(one, source)) if source else error


def _located_one(error: InputError, source: str) -> InputError:
    element = f"{source}: {error.element}" if error.element else ""
    key = error.key if error.element else f"{source}: {error.key}" if error.key else source
    value = ShownValue(str(error.value).lower()) if isinstance(error.value, bool) else error.value
    return error.but(element=element, key=key, value=value)


def _element_blocks(element: Element) -> list[str]:
    stated = element.stated
    nested = {key: v for key, v in stated.items() if isinstance(v, tuple) and isinstance(v[0], Record)}
    table = {"type": element.kind, **_table(element, *nested, "sheet")}
    return [
        _block("[[element]]", table),
        *(_block(f"[[element.{key}]]", _table(one)) for key, several in nested.items() for one in several),
        *(_table_blocks("element.sheet", element.sheet.stated) if element.sheet is not None else ()),
    ]


def _table_blocks(header: str, table: dict[str, Any]) -> list[str]:
    """A table, and the tables in it below it."""
    below_it = {key: one for key, one in table.items() if isinstance(one, dict)}
    lists = {key: one for key, one in table.items() if isinstance(one, list) and one and isinstance(one[0], dict)}
    blocks = [_block(f"[{header}]", {key: one for key, one in table.items() if key not in (*below_it, *lists)})]
    for key, one in below_it.items():
        blocks += _table_blocks(f"{header}.{key}", one)
    for key, several in lists.items():
        blocks += [_block(f"[[{header}.{key}]]", one) for one in several]
    return blocks


def _table(record: Record, *without: str, speed_unit: str | None = None) -> dict[str, Any]:
    """What it states, as a file does; speeds in their own unit."""
    stated = {key: value for key, value in record.stated.items() if key not in without}
    return {key: _written(value, record.quantity_of(key), speed_unit) for key, value in stated.items()}


def _scenario_blocks(scenario: Scenario, unit: str | None) -> list[str]:
    nested = ("torque", "friction", "disturbance", "crossing")
    blocks = [_block("[[scenario]]", _table(scenario, *nested, speed_unit=unit))]
    for key in nested:
        blocks += [_block(f"[[scenario.{key}]]", _table(one, speed_unit=unit)) for one in getattr(scenario, key)]
    return blocks


def _tolerance_blocks(tolerance: Tolerance) -> list[str]:
    stated = tolerance.written
    normal = {key: value for key, value in stated.items() if isinstance(value, dict)}
    plain = {key: value for key, value in stated.items() if key not in normal}
    return [_block("[[tolerance]]", plain), *(_block(f"[tolerance.{key}]", value) for key, value in normal.items())]


def _written(value: Any, kind: QuantityKind | None, speed_unit: str | None = None) -> Any:
    if isinstance(value, tuple):
        return [_written(v, kind, speed_unit) for v in value]
    return value if kind is None else written(value, kind, speed_unit if kind is SPEED else None)


def _operation_blocks(operation: Operation) -> list[str]:
    unit = operation.speed_unit
    table = _table(operation, "load_cases", "schedules", "switched_off", "duty", "passages", speed_unit=unit)
    blocks = [_block("[operation]", table)]
    blocks += [_block("[[operation.switched_off]]", _table(one)) for one in operation.switched_off]
    for case in operation.load_cases:
        blocks.append(_block("[[operation.load_case]]", {"name": case.name}))
        if case.loads or not case.factors:
            blocks.append(_block("[operation.load_case.loads]", dict(case.loads)))
        if case.factors:
            blocks.append(_block("[operation.load_case.factors]", dict(case.factors)))
    blocks += [_block("[[operation.duty]]", _table(one, speed_unit=unit)) for one in operation.duty]
    blocks += [_block("[[operation.passage]]", _table(one, speed_unit=unit)) for one in operation.passages]
    for one in operation.schedules:
        points = _written(one.points, OVER[one.over], unit)
        blocks.append(_block("[[operation.schedule]]", {"name": one.name, one.over: points}))
        for key, kind in {**FOLLOWING, FACTORS: RATIO}.items():
            columns = {n: _written(numbers, kind) for n, numbers in getattr(one, key).items()}
            if columns:
                blocks.append(_block(f"[operation.schedule.{key}]", columns))
    return blocks


def _block(header: str, table: dict[str, Any]) -> str:
    import tomli_w

    # one table at a time: given the whole document, tomli_w writes short tables inline
    body = tomli_w.dumps(table)
    return f"{header}\n{body}" if header else body
