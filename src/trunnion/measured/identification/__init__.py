"""What measured orders say of the numbers of a line."""
