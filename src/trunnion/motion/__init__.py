"""Motions in time: simulated, periodic, swept, passing a resonance, chaotic."""
