"""Stiffness and inertia from drawings: tubes and disks. Pure functions of floats or arrays, SI units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Number = TypeVar("Number", float, "NDArray[np.float64]")


def tube_stiffness(outer_diameter: Number, inner_diameter: Number, length: Number, shear_modulus: Number) -> Number:
    """Torsional stiffness of a round tube [N m/rad], G·I_p/L with I_p = π(D⁴ − d⁴)/32.

    Parameters
    ----------
    outer_diameter, inner_diameter, length : D, d and L [m]; d = 0 for a solid bar.
    shear_modulus : G [Pa]; 79.3e9 for steel.
    """
    return shear_modulus * _polar_area(outer_diameter, inner_diameter) / length


def tube_inertia(outer_diameter: Number, inner_diameter: Number, length: Number, density: Number) -> Number:
    """Polar mass moment of inertia of a round tube about its axis [kg m²], ρ·I_p·L.

    Parameters
    ----------
    outer_diameter, inner_diameter, length : D, d and L [m]; d = 0 for a solid bar.
    density : ρ [kg/m³]; 7850 for steel.
    """
    return density * _polar_area(outer_diameter, inner_diameter) * length


def tube_stress(outer_diameter: Number, inner_diameter: Number) -> Number:
    """Shear stress at the outside of a round tube over its torque [1/m³], 16 D/(π(D⁴ − d⁴)); diameters D and d [m]."""
    return 16 * outer_diameter / (math.pi * (outer_diameter**4 - inner_diameter**4))


def disk_inertia(outer_diameter: Number, inner_diameter: Number, thickness: Number, density: Number) -> Number:
    """Polar moment of inertia of a flat disk with a bore [kg m²]: a tube as long as the disk is thick."""
    return tube_inertia(outer_diameter, inner_diameter, thickness, density)


def _polar_area(outer: Number, inner: Number) -> Number:
    """Polar second moment of area of a ring [m⁴], π(D⁴ − d⁴)/32."""
    return math.pi / 32 * (outer**4 - inner**4)
