"""Kinetostatics: motion, torques, couples and support forces of a jointed line over a turn of its input."""

from trunnion.analyses.kinetostatics.friction import CrossFriction
from trunnion.analyses.kinetostatics.limits import check_limits
from trunnion.analyses.kinetostatics.measures import equivalent_angle, phasor_angle
from trunnion.analyses.kinetostatics.phasing import Phasing, phase_forks
from trunnion.analyses.kinetostatics.result import Kinetostatics
from trunnion.analyses.kinetostatics.sensitivity import AssemblySensitivity, assembly_sensitivity
from trunnion.analyses.kinetostatics.turn import kinetostatics

__all__ = [
    "AssemblySensitivity",
    "CrossFriction",
    "Kinetostatics",
    "Phasing",
    "assembly_sensitivity",
    "check_limits",
    "equivalent_angle",
    "kinetostatics",
    "phase_forks",
    "phasor_angle",
]
