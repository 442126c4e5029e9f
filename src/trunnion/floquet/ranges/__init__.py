"""Ranges of speed searched: resonances, unstable speeds."""
