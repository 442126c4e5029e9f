"""The best numbers of a line within bounds."""
