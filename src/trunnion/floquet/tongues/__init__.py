"""Instability regions in a box as curves: found by roots along rows, joined, named."""
