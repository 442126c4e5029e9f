"""Kinetostatics: motion, torques, couples and support forces of a jointed line over a turn of its input."""

from trunnion.response.kinetostatics.friction import CrossFriction
from trunnion.response.kinetostatics.limits import check_limits
from trunnion.response.kinetostatics.measures import equivalent_angle, phasor_angle
from trunnion.response.kinetostatics.phasing import Phasing, phase_forks
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.response.kinetostatics.sensitivity import AssemblySensitivity, assembly_sensitivity
from trunnion.response.kinetostatics.turn import kinetostatics

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
