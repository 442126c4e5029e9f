"""Measured data: signals in, orders out, and what they say of a line."""
