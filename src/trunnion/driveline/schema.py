"""JSON Schema of the file format with the SI unit of every quantity; editors complete and check by it."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.ball_joints import Ripple
from trunnion.driveline.clutches import Slider
from trunnion.driveline.curve_points import TorquePoint
from trunnion.driveline.disturbances import Disturbance
from trunnion.driveline.duty import Duty, SpeedPassage
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.files import FORMAT, TABLES
from trunnion.driveline.gears import StiffnessVariation, TransmissionError
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import Limit
from trunnion.driveline.machines import KLOSS
from trunnion.driveline.oil import OilPoint
from trunnion.driveline.operation import LoadCase, Operation
from trunnion.driveline.pressure import PressureCurve
from trunnion.driveline.quantities import FREQUENCY, RATIO, QuantityKind, json_schema_of
from trunnion.driveline.rules import SwitchedOff
from trunnion.driveline.scenarios import LevelCrossing, Scenario
from trunnion.driveline.schedules import Schedule
from trunnion.driveline.sheet import Sheet
from trunnion.driveline.sn_curves import SNCurve
from trunnion.driveline.title_block import TitleBlock
from trunnion.driveline.tolerances import SCATTERING, Tolerance
from trunnion.driveline.torque_converters import ConverterPoint

_TUBE = ["outer_diameter", "length"]
_SOLID = ["outer_diameter", "thickness"]
_ROLLING = ["mass", "radius"]
_TOOTHED = ["teeth_in", "teeth_out", "module"]
_SLIP = ["slip_stiffness", "radius", "travel_speed", "inertia"]
_BASE = ["base_radius_in", "base_radius_out"]
_RATED = ["rated_power", "rated_speed"]
_POWERS = ["load_torque", "viscous_load", "quadratic_load"]


def _geometry(sizes: list[str], property_: str) -> dict[str, Any]:
    """All sizes, and the property of the material or its name."""
    return {"required": sizes, "anyOf": [{"required": [property_]}, {"required": ["material"]}]}


_RULES: dict[str, dict[str, Any]] = {
    "Shaft": {
        "oneOf": [{"required": ["stiffness"]}, _geometry(_TUBE, "shear_modulus")],
        "dependentRequired": {
            "loss_factor_frequency": ["loss_factor"],
            **dict.fromkeys((*_TUBE, "inner_diameter", "material", "shear_modulus", "density", "young_modulus"), _TUBE),
        },
    },
    "Coupling": {"required": ["type", "stiffness"]},
    "Clutch": {
        "dependentRequired": {"linear_amplitude": ["linear_frequency"], "linear_frequency": ["linear_amplitude"]}
    },
    "SlipClutch": {
        "dependentRequired": {
            "sliding_torque": ["stribeck_speed"],
            "stribeck_speed": ["sliding_torque"],
            "clamping_times": ["clamping_shares"],
            "clamping_shares": ["clamping_times"],
        }
    },
    "ViscousDamper": {
        "oneOf": [{"required": ["damping"]}, {"required": ["oil"]}],
        "dependentRequired": {"oil": ["oil_frequency"], "oil_frequency": ["oil"], "oil_temperature": ["oil"]},
    },
    "Brake": {"dependentRequired": {"stribeck_speed": ["static_torque"]}},
    "CentrifugalPendulum": {"oneOf": [{"required": ["order"]}, {"required": ["length"]}]},
    "Disk": {
        "oneOf": [{"required": ["inertia"]}, _geometry(_SOLID, "density"), {"required": _ROLLING}],
        "dependentRequired": {
            **dict.fromkeys((*_SOLID, "inner_diameter", "material", "density"), _SOLID),
            **dict.fromkeys(_ROLLING, _ROLLING),
        },
    },
    **{
        kind: {"oneOf": [{"required": [*needed]} for needed in ways]}
        for kind, ways in {
            "Motor": (KLOSS, ("curve",), ("gain",)),
            "Generator": (KLOSS, ("curve",), ("gain", "set_speed"), ("power",)),
        }.items()
    },
    **{
        kind: {
            "anyOf": [{"required": [key]} for key in (_RATED[0], *_POWERS, "curve")],
            "dependentRequired": {_RATED[0]: [_RATED[1]], _RATED[1]: [_RATED[0]]},
        }
        for kind in ("Fan", "Pump", "Propeller")
    },
    "Ratio": {
        "oneOf": [{"required": ["ratio"]}, {"required": ["teeth_in", "teeth_out"]}],
        "dependentRequired": {"teeth_in": ["teeth_out"], "teeth_out": ["teeth_in"]},
    },
    "Differential": {
        "not": {"required": ["ratio", "teeth_in"]},
        "dependentRequired": {"teeth_in": ["teeth_out"], "teeth_out": ["teeth_in"]},
    },
    "Planetary": {
        "anyOf": [{"required": ["held"]}, {"required": ["output"]}],
        "dependentRequired": {"planet_mass": ["centre_distance"], "centre_distance": ["planet_mass"]},
    },
    "Tyre": {"dependentRequired": {key: [one for one in _SLIP if one != key] for key in _SLIP}},
    "GearPair": {
        "oneOf": [{"required": _TOOTHED}, {"required": _BASE}],
        "dependentRequired": {**dict.fromkeys(_TOOTHED, _TOOTHED), **dict.fromkeys(_BASE, _BASE)},
    },
}
"""Which keys go together; the classes check the same in words."""
_OF_COMPONENT = {
    "type": "object",
    "description": "An element of the catalogue of components; keys beside it go beside or in place of its sheet's.",
    "properties": {
        "component": {
            "type": "string",
            "pattern": "^[A-Za-z0-9][A-Za-z0-9._+-]*/[A-Za-z0-9][A-Za-z0-9._+-]*(@[1-9][0-9]*)?$",
            "description": "maker/type, or maker/type@2 for a version",
        },
        "type": {"enum": list(KINDS), "description": "that of the component, where it is written at all"},
    },
    "required": ["component"],
    "not": {"required": ["sheet"]},
}


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a driveline file read as TOML; quantities carry "unit", their SI unit."""
    definitions = {name: _element(name) for name in KINDS}
    operation = _model(Operation)
    for many, name in (("load_cases", "LoadCase"), ("schedules", "Schedule"), ("passages", "SpeedPassage")):
        stated = operation["properties"].pop(many)
        operation["properties"][many[:-1]] = {
            "type": "array",
            "items": {"$ref": f"#/$defs/{name}"},
            "description": stated["description"],
        }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Trunnion driveline",
        "description": "One [[element]] table per element of the driveline, from the drive to the load.",
        "type": "object",
        "properties": {
            "format": {"const": FORMAT, "description": "format of this file"},
            "name": {"type": "string", "description": "for titles and reports"},
            "description": {"type": "string", "description": "for titles and reports"},
            "damping_ratio": {
                **json_schema_of(RATIO),
                "description": "one damping ratio for the whole line instead of damping in the shafts",
            },
            "damping_ratio_frequency": {
                **json_schema_of(FREQUENCY),
                "description": "frequency at which damping_ratio holds; default: the lowest elastic mode",
            },
            "document": {"$ref": "#/$defs/TitleBlock"},
            "operation": {"$ref": "#/$defs/Operation"},
            "limit": {
                "type": "array",
                "items": {"$ref": "#/$defs/Limit"},
                "description": "what elements may bear, for assess",
            },
            "sn_curve": {
                "type": "array",
                "items": {"$ref": "#/$defs/SNCurve"},
                "description": "how many cycles elements bear, for fatigue",
            },
            "tolerance": {
                "type": "array",
                "items": {"$ref": "#/$defs/Tolerance"},
                "description": "how far numbers scatter, for tolerance_study",
            },
            "scenario": {
                "type": "array",
                "items": {"$ref": "#/$defs/Scenario"},
                "description": "what happens to the line when, for transient",
            },
            "element": {
                "type": "array",
                "minItems": 1,
                "items": {
                    "type": "object",
                    "oneOf": [
                        *({"$ref": f"#/$defs/{name}"} for name in definitions),
                        {"$ref": "#/$defs/ComponentElement"},
                    ],
                },
            },
        },
        "required": ["format", "element"],
        "additionalProperties": False,
        "$defs": {
            **definitions,
            "ComponentElement": _OF_COMPONENT,
            "Sheet": _model(Sheet),
            "TitleBlock": _model(TitleBlock),
            "Operation": operation,
            "LoadCase": _model(LoadCase),
            "Schedule": _model(Schedule),
            "SwitchedOff": _model(SwitchedOff),
            "Duty": _model(Duty),
            "SpeedPassage": _model(SpeedPassage),
            "Limit": _model(Limit),
            "SNCurve": _model(SNCurve),
            "Tolerance": _tolerance(),
            "Scenario": _model(Scenario),
            "AppliedTorque": _applied_torque(),
            "FrictionTorque": _model(FrictionTorque),
            "Disturbance": _model(Disturbance),
            "LevelCrossing": _model(LevelCrossing),
            "Excitation": _model(Excitation),
            "PressureCurve": _model(PressureCurve),
            "TransmissionError": _model(TransmissionError),
            "StiffnessVariation": _model(StiffnessVariation),
            "Ripple": _model(Ripple),
            "Slider": _model(Slider),
            "TorquePoint": _model(TorquePoint),
            "ConverterPoint": _model(ConverterPoint),
            "OilPoint": _model(OilPoint),
        },
    }


def _applied_torque() -> dict[str, Any]:
    schema = _model(AppliedTorque)
    schema["properties"]["file"] = {"type": "string", "description": "CSV table beside the file, instead of its points"}
    return schema


def _tolerance() -> dict[str, Any]:
    """One key a number that can scatter."""

    def forms(kind: QuantityKind) -> dict[str, Any]:
        size = {"anyOf": [json_schema_of(RATIO), json_schema_of(kind)]}
        ends = {"type": "array", "items": json_schema_of(kind), "minItems": 2, "maxItems": 2}
        normal = {"type": "object", "properties": {"deviation": size}, "required": ["deviation"]}
        return {"anyOf": [size, ends, {**normal, "additionalProperties": False}], "description": f"of its {kind.name}"}

    return {
        "type": "object",
        "description": (Tolerance.__doc__ or "").strip().partition("\n")[0],
        "properties": {
            "of": {"type": "string", "description": 'name of the element, or "Shaft *" for all of a kind'},
            **{key: forms(kind) for key, kind in SCATTERING.items()},
        },
        "required": ["of"],
        "additionalProperties": False,
    }


def _element(name: str) -> dict[str, Any]:
    schema = _model(KINDS[name])
    schema["properties"] = {"type": {"const": name}, **schema["properties"]}
    for key in TABLES.keys() & schema["properties"].keys():
        schema["properties"][key] = _or_a_file(schema["properties"][key])
    schema["required"] = ["type", *schema.get("required", [])]
    return schema | _RULES.get(name, {})


def _model(model: type[BaseModel]) -> dict[str, Any]:
    """pydantic's schema of one model without references, titles and null (TOML has no null)."""
    schema = model.model_json_schema()
    schema.pop("$defs", None)
    schema["description"] = (model.__doc__ or "").strip().partition("\n")[0]
    schema["properties"] = {key: _not_null(value) for key, value in schema["properties"].items()}
    return schema


def _or_a_file(field: dict[str, Any]) -> dict[str, Any]:
    """A list of tables, or the name of a CSV file that holds them."""
    listed = {key: field.pop(key) for key in ("type", "items") if key in field}
    return {"anyOf": [listed, {"type": "string", "pattern": r"\.[cC][sS][vV]$"}], **field}


def _not_null(field: dict[str, Any]) -> dict[str, Any]:
    plain = {key: value for key, value in field.items() if key != "title" and (key, value) != ("default", None)}
    options = [option for option in plain.get("anyOf", []) if option != {"type": "null"}]
    if len(options) == 1:
        plain.pop("anyOf")
        plain = {**options[0], **plain}
    return plain
