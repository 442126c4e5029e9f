"""Exact motion of piecewise-linear systems."""
