"""Motions in time: simulation, run-up, exact motion of lines with stages."""
