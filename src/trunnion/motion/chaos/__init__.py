"""Lyapunov exponents, Poincaré maps and the verdict on chaos."""
