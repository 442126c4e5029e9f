"""Periodic orbits by shooting: of any system, and of a line that starts free."""
