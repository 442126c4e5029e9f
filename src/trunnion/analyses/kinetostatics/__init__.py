"""Kinetostatics: motion, torques, couples and support forces of a jointed line over a turn of its input."""

from trunnion.analyses.kinetostatics.friction import CrossFriction
from trunnion.analyses.kinetostatics.result import Kinetostatics
from trunnion.analyses.kinetostatics.turn import kinetostatics

__all__ = ["CrossFriction", "Kinetostatics", "kinetostatics"]
