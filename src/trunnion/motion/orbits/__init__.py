"""Periodic motions, their branches, sweeps and basins."""
