"""Ranges of speed searched: resonances, largest values, unstable speeds."""
