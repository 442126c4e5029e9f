"""Monodromy matrices of chains and trees of unknowns."""
