"""Floquet theory: what grows, where, and how sure that is."""
