"""Stiffness of a crank from the middle of one journal to that of the next, by empirical formulas from its drawing.

Each is a length of plain shaft that yields as the throw does. With R half the stroke, D, d and L the outer and inner
diameter and the length of journal (j) and pin (p), t and W the thickness and the width of a web,

    k = πG/32 / (A_j + A_p + A_w)

    Carter       A_j = (L_j + 0.8 t)/(D_j⁴ − d_j⁴),     A_p = 0.75 L_p/(D_p⁴ − d_p⁴),
                 A_w = 1.5 R/(t W³)
    Ker Wilson   A_j = (L_j + 0.4 D_j)/(D_j⁴ − d_j⁴),   A_p = (L_p + 0.4 D_p)/(D_p⁴ − d_p⁴),
                 A_w = (R − 0.2 (D_j + D_p))/(t W³)

Both as handbooks of torsional vibration print them (W. Ker Wilson, Practical Solution of Torsional Vibration Problems,
vol. 1; E. J. Nestorides, A Handbook on Torsional Vibration); check your edition. They disagree by a tenth and more, and
webs unlike those they were fitted to lie outside either: a measured or computed stiffness comes first.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class CrankThrow:
    """Dimensions [m] of a throw; bores 0 where solid."""

    radius: float
    journal_diameter: float
    journal_bore: float
    journal_length: float
    pin_diameter: float
    pin_bore: float
    pin_length: float
    web_thickness: float
    web_width: float

    @property
    def journal(self) -> float:
        """D_j⁴ − d_j⁴ [m⁴]."""
        return self.journal_diameter**4 - self.journal_bore**4

    @property
    def pin(self) -> float:
        """D_p⁴ − d_p⁴ [m⁴]."""
        return self.pin_diameter**4 - self.pin_bore**4

    @property
    def web(self) -> float:
        """t W³ [m⁴]."""
        return self.web_thickness * self.web_width**3


def carter(throw: CrankThrow) -> float:
    """Yield A_j + A_p + A_w [1/m³] after Carter."""
    journal = (throw.journal_length + 0.8 * throw.web_thickness) / throw.journal
    return journal + 0.75 * throw.pin_length / throw.pin + 1.5 * throw.radius / throw.web


def ker_wilson(throw: CrankThrow) -> float:
    """The same after Ker Wilson."""
    journal = (throw.journal_length + 0.4 * throw.journal_diameter) / throw.journal
    pin = (throw.pin_length + 0.4 * throw.pin_diameter) / throw.pin
    return journal + pin + (throw.radius - 0.2 * (throw.journal_diameter + throw.pin_diameter)) / throw.web


FORMULAS = {"carter": carter, "ker wilson": ker_wilson}


def throw_stiffness(throw: CrankThrow, shear_modulus: float, formula: str) -> float:
    """k [N m/rad] by one of ``FORMULAS``; ``shear_modulus`` G [Pa]."""
    return pi * shear_modulus / 32 / FORMULAS[formula](throw)
