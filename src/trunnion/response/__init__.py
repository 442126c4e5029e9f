"""Responses of a stable line: by order and speed, over a turn, and their largest values."""
