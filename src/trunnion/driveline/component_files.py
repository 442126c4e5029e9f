"""The catalogue of components: a maker's sheet typed in once, as a TOML file of its maker.

::

    format = 1
    source = "Couplings, edition 3, page 14"
    date = "2019-05"

    [[component]]
    name = "rubber-16"
    type = "Coupling"
    [component.printed]
    "C_Tdyn at 50 %" = "65 kNm/rad"
    [component.numbers]
    stiffness = "65 kN*m/rad"

The file is called after its maker: ``example.toml`` holds "example/rubber-16". Files lie in a folder ``components``
beside the line that asks for one, in the user's own folder (``TRUNNION_COMPONENTS``, or ``trunnion/components`` where
the system keeps a user's data), and in the package; the first of these that has the component counts.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import Any

from trunnion.driveline.elements import Element
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.refusals import about, nearest
from trunnion.driveline.sheet import Sheet
from trunnion.driveline.toml_file import read_text, toml_of
from trunnion.errors import InputError, all_made, short
from trunnion.reading import below

FORMAT = 1
FOLDER = "components"
MOST_FILES = 1000
_WORD = re.compile(r"[A-Za-z0-9][A-Za-z0-9._+-]{0,59}")
_NAME = re.compile(rf"({_WORD.pattern})/({_WORD.pattern})(?:@([1-9][0-9]{{0,3}}))?")
_TOP = ("format", "source", "date", "component")
_KEYS = ("name", "type", "version", "source", "date", "note", "printed", "numbers")
_OUTSIDE = "put the file into the folder components beside the line"
EXAMPLE = 'write component = "example/rubber-16", say; trunnion components lists them'


@dataclass(frozen=True)
class Component:
    """An entry of the catalogue.

    Attributes
    ----------
    sheet : where its numbers come from; ``sheet.component`` is its name.
    kind : of the element, as ``type`` says it in a file.
    place : "beside the line", "of the user" or "of Trunnion".
    """

    sheet: Sheet
    kind: str
    place: str

    @property
    def fields(self) -> dict[str, Any]:
        """What an element of it is made with."""
        return {**self.sheet.numbers, "sheet": self.sheet}

    @property
    def table(self) -> dict[str, Any]:
        """The same as a table of a file, its kind first."""
        return {"type": self.kind, **self.sheet.numbers, "sheet": self.sheet.stated}

    def element(self, **changes: Any) -> Element:
        """The element, with fields beside or in place of those typed; None takes one away."""
        stated = {**self.fields, **changes}
        return KINDS[self.kind](**{key: value for key, value in stated.items() if value is not None})


def component(name: str, /, **changes: Any) -> Element:
    """An element of the catalogue of components, its numbers as typed from the maker's sheet.

    Parameters
    ----------
    name : "maker/type", or "maker/type@2" for version 2; by default the highest.
    **changes : fields of the element beside those of the sheet or in place of them, as ``name``.

    Raises
    ------
    InputError : no such component (the nearest are named), or fields that its kind refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> coupling = tn.component("example/rubber-16", name="coupling")
    >>> coupling.kind, coupling.sheet.component
    ('Coupling', 'example/rubber-16')
    """
    return find(name).element(**changes)


def with_sheet(table: dict[str, Any], folder: Path | None = None) -> dict[str, Any]:
    """What an element states, with the numbers of its sheet in place of the name of a component, if it has one."""
    if "component" not in table:
        return table
    stated = {key: value for key, value in table.items() if key != "component"}
    return deepcopy(find(table["component"], folder).table) | stated


def components() -> tuple[Component, ...]:
    """All components of the user's folder and of the package, by name, versions rising.

    Raises
    ------
    InputError : a file that cannot be read, or whose entries make no element.

    Examples
    --------
    >>> import trunnion as tn
    >>> "example/rubber-16" in [one.sheet.component for one in tn.components()]
    True
    """
    found: dict[tuple[str, int], Component] = {}
    for place in _places(None):
        for one in all_made(partial(place.read, maker) for maker in place.makers()):
            for entry in one:
                found.setdefault((entry.sheet.component, entry.sheet.version), entry)
    return tuple(found[key] for key in sorted(found))


def find(name: object, line_folder: Path | None = None) -> Component:
    """The component called ``name``, also in the folder ``components`` of the ``line_folder``.

    Raises
    ------
    InputError : so.
    """
    match = _NAME.fullmatch(name) if isinstance(name, str) else None
    if match is None:
        problem = "is not the name of a component, maker/type"
        if isinstance(name, str) and (".." in name or "\\" in name or name.startswith(("/", "~"))):
            problem = "leads out of the folders of components, and is not a maker/type"
        raise InputError(problem, key="component", value=name, remedy=EXAMPLE)
    maker, kind, version = match.groups()
    known: list[str] = []
    for place in _places(line_folder):
        if maker not in place.makers():
            continue
        entries = place.read(maker)
        known += [f"{one.sheet.component}@{one.sheet.version}" if version else one.sheet.component for one in entries]
        mine = [one for one in entries if one.sheet.component == f"{maker}/{kind}"]
        if version:
            mine = [one for one in mine if one.sheet.version == int(version)]
        if mine:
            return max(mine, key=lambda one: one.sheet.version)
    remedy = nearest(name, dict.fromkeys(known or _all_names(line_folder)))
    raise InputError("is not in the catalogue of components", key="component", value=name, remedy=remedy)


def user_folder() -> Path | None:
    """Where a user's own components lie, there or not; None without a home."""
    from platformdirs import user_data_dir

    chosen = os.environ.get("TRUNNION_COMPONENTS")
    if chosen:
        return Path(chosen)
    try:
        text = user_data_dir("trunnion", appauthor=False)
    except RuntimeError:
        return None
    return None if text.startswith("~") else Path(text, FOLDER)


@dataclass(frozen=True)
class _Place:
    """A folder of components: what it is called, and how the file of a maker is found in it."""

    called: str
    folder: Path
    file: Callable[[str], Path]

    def makers(self) -> list[str]:
        """Names of the files in it."""
        try:
            names = sorted(one.name for one in self.folder.iterdir())[:MOST_FILES]
        except OSError:  # there is none
            return []
        return [name[:-5] for name in names if name.endswith(".toml") and _WORD.fullmatch(name[:-5])]

    def read(self, maker: str) -> tuple[Component, ...]:
        """The entries of a maker."""
        path = self.file(maker)
        try:
            return tuple(_entries(toml_of(read_text(path, _OUTSIDE)), maker, self.called))
        except InputError as error:
            where = f"{FOLDER}/{path.name}"
            located = error.each(lambda one: one.but(element=f"{where}: {one.element}" if one.element else where))
            raise located from None


def _places(line_folder: Path | None) -> Iterator[_Place]:
    """Where components lie, nearest first."""
    if line_folder is not None:
        # A line of a stranger opens nothing outside its own folder, links followed.
        beside = partial(_below, line_folder)
        yield _Place("beside the line", line_folder / FOLDER, beside)
    own = user_folder()
    if own is not None:
        yield _Place("of the user", own, lambda maker: own / f"{maker}.toml")
    shipped = Path(str(files("trunnion.driveline").joinpath(FOLDER)))
    yield _Place("of Trunnion", shipped, lambda maker: shipped / f"{maker}.toml")


def _below(folder: Path, maker: str) -> Path:
    return below(folder, f"{FOLDER}/{maker}.toml", _OUTSIDE)


def _all_names(line_folder: Path | None) -> list[str]:
    found: list[str] = []
    for place in _places(line_folder):
        for maker in place.makers():
            try:
                found += [one.sheet.component for one in place.read(maker)]
            except InputError:  # a file of another maker is not what is asked for
                continue
    return found


def _entries(table: dict[str, Any], maker: str, place: str) -> list[Component]:
    for key, value in table.items():
        if key not in _TOP:
            raise InputError("unknown key", key=key, value=value, remedy=nearest(key, _TOP))
    if table.get("format") != FORMAT or isinstance(table["format"], bool):
        problem = "is not a known format of components" if "format" in table else "is missing"
        raise InputError(problem, key="format", value=table.get("format"), remedy=f"write format = {FORMAT}")
    entries = table.get("component")
    if not isinstance(entries, list) or not entries or not all(isinstance(one, dict) for one in entries):
        raise InputError("has no components", key="component", remedy="write [[component]] for each")
    made = all_made(partial(_entry, one, i, maker, table, place) for i, one in enumerate(entries, start=1))
    seen: set[tuple[str, int]] = set()
    for one in made:
        called = (one.sheet.component, one.sheet.version)
        if called in seen:
            remedy = "write version = 2, say, in the later one"
            raise InputError(f"stands twice with version {called[1]}", element=called[0], remedy=remedy)
        seen.add(called)
    return made


def _entry(entry: dict[str, Any], number: int, maker: str, whole: dict[str, Any], place: str) -> Component:
    name = entry.get("name")
    label = f"component {short(str(name))}" if isinstance(name, str) else f"component {number}"
    for key, value in entry.items():
        if key not in _KEYS:
            remedy = nearest(key, _KEYS)
            if key in {field for kind in KINDS.values() for field in kind.model_fields}:
                remedy = f"write {key} under [component.numbers]"
            raise InputError("unknown key", element=label, key=key, value=value, remedy=remedy)
    if not isinstance(name, str) or not _WORD.fullmatch(name):
        remedy = "write letters, digits, points and hyphens, without blanks"
        raise InputError("is not a type of a maker", element=label, key="name", value=name, remedy=remedy)
    kind = entry.get("type")
    if not isinstance(kind, str) or kind not in KINDS:
        problem = "is missing" if kind is None else "unknown element type"
        raise InputError(problem, element=label, key="type", value=kind, remedy=nearest(str(kind), KINDS))
    numbers = entry.get("numbers")
    if not isinstance(numbers, dict) or not numbers:
        raise InputError("are missing", element=label, key="numbers", remedy="write [component.numbers] below it")
    for key in ("name", "after", "sheet", "to"):
        if key in numbers:
            raise InputError("belongs to a line, not to its maker", element=label, key=key, remedy="leave it out")
    stated = {key: entry.get(key, whole.get(key)) for key in ("source", "date")}
    more = {key: entry[key] for key in ("version", "printed", "note") if key in entry}
    version = more.get("version", 1)
    if isinstance(version, bool) or not isinstance(version, int) or version < 1:
        raise InputError("must be a whole number from 1", element=label, key="version", value=version)
    try:
        found = {key: value for key, value in stated.items() if value is not None}
        made = Component(Sheet(component=f"{maker}/{name}", numbers=numbers, **found, **more), kind, place)
        made.element()
    except InputError as error:
        raise about(error, label) from None
    return made
