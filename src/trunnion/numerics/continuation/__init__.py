"""Roots and curves of roots."""
