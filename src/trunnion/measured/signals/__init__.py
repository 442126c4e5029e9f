"""Signals of a test bench: pulse trains, sampled channels, and the files that hold them."""
