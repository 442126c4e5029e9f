"""A line's equations over harmonics of its period: whole, along the tree, and of the straight line."""
