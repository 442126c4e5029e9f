"""Materials by name: elastic moduli, density, and a tensile strength where a grade fixes one.

Moduli and densities are those of common handbooks. Strengths are minimum values of the standard named, for the
sizes named; a certificate of the part at hand goes before them. Plain "steel" has no strength: it is not a grade.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError


@dataclass(frozen=True)
class Material:
    """G, E [Pa], ρ [kg/m³], tensile strength σ_B [Pa] or None, and where the strength is from."""

    shear_modulus: float
    young_modulus: float
    density: float
    tensile_strength: float | None = None
    source: str = ""


_STEEL = (79.3e9, 206e9, 7850.0)
MATERIALS = {
    "steel": Material(*_STEEL),
    "S355": Material(*_STEEL, 470e6, "EN 10025-2, up to 100 mm"),
    "C45": Material(*_STEEL, 630e6, "EN 10083-2, quenched and tempered, 40 to 100 mm"),
    "42CrMo4": Material(*_STEEL, 900e6, "EN 10083-3, quenched and tempered, 40 to 100 mm"),
    "34CrNiMo6": Material(*_STEEL, 1000e6, "EN 10083-3, quenched and tempered, 40 to 100 mm"),
    "stainless steel": Material(76.9e9, 200e9, 7900.0, 500e6, "X5CrNi18-10, EN 10088-3"),
    "nodular cast iron": Material(66.3e9, 169e9, 7100.0, 500e6, "EN-GJS-500-7, EN 1563"),
    "aluminium": Material(26.3e9, 70e9, 2700.0, 310e6, "EN AW-6082 T6, EN 755-2"),
    "titanium": Material(44e9, 114e9, 4430.0, 895e6, "Ti-6Al-4V, annealed, ASTM B348 grade 5"),
}


def of_material(data: Any, keys: tuple[str, ...]) -> Any:
    """``data`` with what its ``material`` says for ``keys`` that are not given.

    Raises
    ------
    InputError : an unknown material.
    """
    if not isinstance(data, dict) or data.get("material") is None:
        return data
    material = _named(data["material"])
    return data | {key: getattr(material, key) for key in keys if data.get(key) is None}


def without_material(stated: dict[str, Any]) -> dict[str, Any]:
    """What a user stated, without what follows from the material named."""
    if stated.get("material") is None:
        return stated
    material = _named(stated["material"])
    return {key: value for key, value in stated.items() if getattr(material, key, None) != value}


def _named(name: object) -> Material:
    if isinstance(name, str) and name in MATERIALS:
        return MATERIALS[name]
    remedy = nearest(name, list(MATERIALS)) if isinstance(name, str) else 'write "steel"'
    raise InputError("is not a known material", key="material", value=name, remedy=remedy)
