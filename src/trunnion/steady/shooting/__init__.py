"""Periodic orbits by shooting: of any system, and of a free–free line."""
