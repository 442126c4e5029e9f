"""Linear analyses of a line: natural frequencies, resonances, stability, forced response."""
