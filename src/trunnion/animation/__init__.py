"""A line in motion: where its parts stand in space, how they turn, and pages and pictures that play it."""
