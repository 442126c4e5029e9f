"""The largest values of a response over a range of speeds."""
