"""Reference of every public name: signature, parameters with units, what it returns, an example that the tests run."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from types import UnionType
from typing import get_args, get_type_hints

import trunnion as tn
from generate.docstring import body, sections
from generate.markdown import table, write
from trunnion.driveline.elements import Element

GROUPS = {
    "design": ("Fit for its speeds, and better", "Verdicts, limits, comparison, remedies, tolerances, life."),
    "driveline": ("Describe a line", "The line, its file, its tables and units. Elements have a page of their own."),
    "modes": ("Modes", "Natural frequencies, resonance speeds, dampers, bending."),
    "response": ("Forced response", "Orders, Campbell diagram, speed sweep, kinetostatics."),
    "floquet": ("Parametric stability", "Multipliers, charts, tongues, windows, certificates."),
    "motion": ("True motion", "Simulation, periodic motion, branches, sweeps, run-ups, chaos."),
    "systems": ("Your own equations", "Systems, oscillators and maps that the analyses take besides drivelines."),
    "reporting": ("Reports and studies", "Reports, published studies, pictures, errors."),
}
HOME = {"equations": "systems", "studies": "reporting", "pictures": "reporting"}
"""Rooms of the package whose names stand with another's."""


def room(name: str) -> str:
    """The page of a public name, by the module it lives in."""
    where = getattr(tn, name).__module__.split(".")[1]
    where = HOME.get(where, where)
    if isinstance(getattr(tn, name), type) and issubclass(getattr(tn, name), Element):
        return "elements"
    return where if where in GROUPS else "reporting"


def signature(name: str) -> str:
    """As it is called: without annotations, which stand in the list of parameters in words and units."""
    thing = getattr(tn, name)
    try:
        found = inspect.signature(thing)
    except ValueError:
        return "()"
    plain = [
        p.replace(annotation=inspect.Parameter.empty) for p in found.parameters.values() if not p.name.startswith("_")
    ]
    text = str(found.replace(parameters=plain, return_annotation=inspect.Signature.empty))
    return re.sub(r"<[^<>]*>", "…", text)


def returned(name: str) -> Iterator[type]:
    """Classes of the package that a function gives."""
    try:
        hint = get_type_hints(getattr(tn, name)).get("return")
    except NameError:
        return
    for one in get_args(hint) if isinstance(hint, UnionType) else (hint, *get_args(hint)):
        if inspect.isclass(one) and one.__module__.startswith("trunnion"):
            yield one


def _members(kind: type) -> str:
    """Public properties and methods of its own and of its parents in the package."""
    rows = []
    for name, thing in inspect.getmembers(kind):
        if name.startswith(("_", "model_")) or name in ("stated",) or not inspect.getdoc(thing):
            continue
        home = next((one for one in kind.__mro__ if name in vars(one)), kind)
        if not home.__module__.startswith("trunnion"):
            continue
        if isinstance(thing, property) or type(thing).__name__ == "cached_property":
            call = f"`{name}`"
        elif inspect.isfunction(thing) or inspect.ismethod(thing):
            call = f"`{name}()`"
        else:
            continue
        rows.append((call, (inspect.getdoc(thing) or "").split("\n\n")[0]))
    return table(("of it", "is"), rows)


def entry(name: str) -> str:
    """One public name."""
    thing = getattr(tn, name)
    directive = "class" if inspect.isclass(thing) else "function"
    text = body(inspect.getdoc(thing) or "")
    if inspect.isclass(thing) and issubclass(thing, Element):
        text += f"\n\nIts keys, with units and a picture: [{name}](#key-{name.lower()})."
    gives = [f"[`{one.__name__}`](#result-{one.__name__.lower()})" for one in _results_of(name)]
    if gives:
        text += f"\n\nGives {' or '.join(gives)}."
    return f"(tn-{name.lower()})=\n## {name}\n\n:::::{{py:{directive}}} trunnion.{name}{signature(name)}\n:nocontentsentry:\n\n{text}\n:::::\n"


def _results_of(name: str) -> list[type]:
    if not inspect.isfunction(getattr(tn, name)):
        return []
    return [one for one in returned(name) if one.__name__ not in tn.__all__]


def results() -> dict[str, type]:
    """Classes that functions give and that are not public names themselves."""
    return {one.__name__: one for name in sorted(tn.__all__) for one in _results_of(name)}


def result(kind: type) -> str:
    """What a result holds."""
    doc = re.sub(r"^#+ ", "", body(kind.__doc__ or ""), flags=re.M)
    return f"(result-{kind.__name__.lower()})=\n## {kind.__name__}\n\n{doc}\n\n{_members(kind)}"


def write_pages(folder: Path) -> None:
    """A page for every room, one for results, an index."""
    names = [name for name in sorted(tn.__all__, key=str.lower) if name != "__version__"]
    pages = {key: [name for name in names if room(name) == key] for key in (*GROUPS, "elements")}
    titles = {**GROUPS, "elements": ("Elements in Python", "Classes of elements; files name them by `type`.")}
    for key, (title, what) in titles.items():
        write(folder / f"{key}.md", "\n\n".join([f"# {title}", what, *(entry(name) for name in pages[key])]))
    parts = [
        "# What analyses give",
        "Every result prints itself, holds its numbers as fields and as `data` where they are arrays over axes, and saves itself.",
    ]
    write(folder / "results.md", "\n\n".join([*parts, *(result(one) for _, one in sorted(results().items()))]))
    rows = []
    for key, (title, _) in titles.items():
        for name in pages[key]:
            first = dict(sections(inspect.getdoc(getattr(tn, name)) or ""))[""].split("\n\n")[0]
            rows.append((f"[`{name}`](#tn-{name.lower()})", first, f"[{title}]({key}.md)"))
    write(
        folder / "index.md",
        "\n\n".join(
            [
                "# Python reference",
                "`import trunnion as tn` has these names. Numbers are SI and radians; a text carries its unit. Every example "
                "runs in the tests and gives what stands below it.",
                table(("name", "does", "page"), sorted(rows, key=lambda row: row[0].lower())),
                "```{toctree}\n:hidden:\n\n" + "\n".join([*titles, "results"]) + "\n```",
            ]
        ),
    )
