"""Stability at one speed, at many, and of a steady response."""
