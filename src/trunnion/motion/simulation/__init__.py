"""Motions in time from a start."""
