"""Stability over two parameters, as functions known to a stated error."""
