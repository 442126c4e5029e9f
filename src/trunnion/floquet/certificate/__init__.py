"""Proofs of stability: the equations of a line enclosed over a box, and a Lyapunov function checked there."""
