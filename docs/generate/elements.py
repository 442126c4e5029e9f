"""A page for every element and table of a file: keys with meaning, unit, default and example, a file, a picture."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import trunnion as tn
from generate.docstring import plain, sections
from generate.examples import example as file_with
from generate.markdown import table, write
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.schema import json_schema
from trunnion.pictures.driveline_sketch import draw

GROUPS = {
    "Drive": ("ConstantSpeed", "Engine", "Motor"),
    "Inertias and loads": ("Disk", "Generator", "Fan", "Pump", "Propeller", "Vehicle", "Tyre"),
    "Shafts, couplings and clutches": (
        "Shaft", "Coupling", "PiecewiseShaft", "Clutch", "SlipClutch", "DualMassFlywheel",
    ),
    "Joints": ("HookeJoint", "DoubleCardanJoint", "TripodJoint", "RzeppaJoint", "IdealJoint"),
    "Gears and belts": ("Ratio", "GearPair", "Planetary", "Differential", "Belt"),
    "Dampers": ("ViscousDamper", "TunedDamper", "CentrifugalPendulum"),
}  # fmt: skip
TABLES = {
    "TitleBlock": "[document]",
    "Operation": "[operation]",
    "LoadCase": "[[operation.load_case]]",
    "Schedule": "[[operation.schedule]]",
    "Duty": "[[operation.duty]]",
    "SpeedPassage": "[[operation.passage]]",
    "SwitchedOff": "[[operation.switched_off]]",
    "Limit": "[[limit]]",
    "SNCurve": "[[sn_curve]]",
    "Tolerance": "[[tolerance]]",
    "Scenario": "[[scenario]]",
    "AppliedTorque": "`torques` of a scenario",
    "FrictionTorque": "`friction` of a scenario",
    "LevelCrossing": "`events` of a scenario",
    "Excitation": "`excitation` of a Disk",
    "PressureCurve": "`pressure` of an Engine",
    "TransmissionError": "`transmission_error` of a GearPair",
    "StiffnessVariation": "`stiffness_variation` of a GearPair",
    "Ripple": "`ripple` of a RzeppaJoint",
    "Slider": "`friction` of a Clutch",
    "TorquePoint": "`curve` of a machine",
    "ConverterPoint": "`curves` of a torque converter",
    "OilPoint": "`oil` of a viscous damper",
}
"""Where each further table of a file stands."""
SHARED = ("type", "name", "after")


@cache
def schema() -> dict[str, Any]:
    """JSON Schema of files, which holds every key with its description and unit."""
    return json_schema()


def _variants(key: dict[str, Any]) -> list[dict[str, Any]]:
    return key.get("anyOf") or key.get("oneOf") or [key]


def example(key: dict[str, Any]) -> str:
    """A value a user could write."""
    for one in _variants(key):
        if examples := one.get("examples"):
            return f'`"{examples[0]}"`' if isinstance(examples[0], str) else f"`{examples[0]}`"
        if "enum" in one:
            return ", ".join(f"`{v!r}`".replace("'", '"') for v in one["enum"])
        if "$ref" in one.get("items", one):
            kind = one.get("items", one)["$ref"].rsplit("/", 1)[-1]
            return f"[{kind}](#key-{kind.lower()})"
        if one.get("type") == "boolean":
            return "`true`"
        if one.get("type") == "array" and (inner := example(one.get("items", {}))) != "text":
            return f"`[{inner.strip('`')}, …]`"
    kinds = {one.get("type") for one in _variants(key)}
    return "whole number" if "integer" in kinds else "number" if "number" in kinds else "text"


def unit(key: dict[str, Any]) -> str:
    """SI unit; empty of texts."""
    found = key.get("unit") or next((one["unit"] for one in _variants(key) if "unit" in one), None)
    found = found or key.get("items", {}).get("unit") or ""
    return {"1": "–"}.get(found, found.replace("*", " ").replace("^2", "²").replace("^3", "³"))


def default(key: dict[str, Any], needed: bool) -> str:
    """What holds where the key is left out."""
    if needed:
        return "**needed**"
    value = key.get("default")
    if value is None or value == []:
        return "–"
    return f"`{str(value).lower() if isinstance(value, bool) else value!r}`".replace("'", '"')


def keys(model: dict[str, Any], leave_out: tuple[str, ...] = ()) -> str:
    """Table of keys of one table of a file."""
    needed = model.get("required", [])
    rows = [
        [f"`{name}`", key.get("description", ""), unit(key), default(key, name in needed), example(key)]
        for name, key in model["properties"].items()
        if name not in leave_out
    ]
    return table(("key", "meaning", "unit", "default", "write"), rows)


def _picture(kind: str, folder: Path) -> str:
    """Sketch of the example, saved once."""
    path = folder / f"{kind}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    draw(tn.loads(file_with(kind))).savefig(path, dpi=110)
    return f"![Sketch of a line with a {kind}](pictures/{path.name})"


def element(kind: str, folder: Path) -> str:
    """The section of one element."""
    doc = dict(sections(KINDS[kind].__doc__ or ""))
    return "\n\n".join(
        [
            f"(key-{kind.lower()})=\n## {kind}",
            plain(doc[""]),
            keys(schema()["$defs"][kind], SHARED),
            f"In Python: [`tn.{kind}`](#tn-{kind.lower()}). In a file:",
            f"```toml\n{file_with(kind).strip()}\n```",
            _picture(kind, folder / "pictures"),
        ]
    )


def write_pages(folder: Path) -> None:
    """One page for every group of elements, one for the tables around them."""
    links = []
    grouped = {kind for kinds in GROUPS.values() for kind in kinds}
    more = tuple(kind for kind in KINDS if kind not in grouped)
    for title, kinds in {**GROUPS, **({"Further elements": more} if more else {})}.items():
        name = title.split(" ")[0].lower().strip(",")
        links.append((title, name, kinds))
        parts = [f"# {title}", *(element(kind, folder) for kind in kinds)]
        write(folder / f"{name}.md", "\n\n".join(parts))
    top = {key: value for key, value in schema()["properties"].items() if value.get("type") != "array"}
    parts = [
        "# The other tables of a file",
        "## At the top of the file",
        keys({"properties": top, "required": schema().get("required", [])}),
    ]
    others = [kind for kind in schema()["$defs"] if kind not in KINDS]
    for kind in others:
        model = schema()["$defs"][kind]
        head = f"(key-{kind.lower()})=\n## {kind}" + (f": {TABLES[kind]}" if kind in TABLES else "")
        parts += [head, plain(model.get("description", "")), keys(model)]
    write(folder / "tables.md", "\n\n".join(parts))
    rows = [
        (f"[{title}]({name}.md)", ", ".join(f"[{k}](#key-{k.lower()})" for k in kinds)) for title, name, kinds in links
    ]
    rows.append(("[The other tables of a file](tables.md)", ", ".join(f"[{k}](#key-{k.lower()})" for k in others)))
    write(
        folder / "index.md",
        "\n\n".join(
            [
                "# Elements and keys",
                "Every key that a file may hold. The package writes these pages from the classes that read the file, so "
                "they name what this version reads. A number without a unit is in the SI unit of its row; a text carries "
                'its unit: `"12 deg"`.',
                table(("page", "elements"), rows),
                "Every element also takes three keys:",
                keys(
                    {
                        "properties": {k: schema()["$defs"]["Shaft"]["properties"][k] for k in SHARED},
                        "required": ["type"],
                    }
                ),
                "```{toctree}\n:hidden:\n\n" + "\n".join([*(name for _, name, _ in links), "tables"]) + "\n```",
            ]
        ),
    )
