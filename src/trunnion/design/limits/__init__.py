"""How far a parameter may go: stability by roots, and the limits that the description states."""
