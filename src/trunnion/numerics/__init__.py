"""Numerical methods; they know no driveline."""
