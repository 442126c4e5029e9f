"""How what a line does follows the numbers of its description."""
