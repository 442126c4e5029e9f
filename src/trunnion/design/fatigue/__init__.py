"""How long the shafts of a line last: cycles of its torques, damage, life."""
