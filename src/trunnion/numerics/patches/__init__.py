"""Functions of two variables as Chebyshev patches."""
