"""Tolerances against every check of ``assess``."""
